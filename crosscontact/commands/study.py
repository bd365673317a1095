"""``crosscontact study``: refinement and run time, Poisson's ratio, or shorter process zones."""

from __future__ import annotations

import argparse

from contact_scene import SceneError
from contact_scene.value_checks import Range
from crosscontact import arguments
from crosscontact.arguments import option_type
from crosscontact.commands import shared
from crosscontact.commands.shared import value
from validation.report.texts import for_terminal
from validation.runs.pool import processes
from validation.runs.progress import Progress
from validation.solvers import REFERENCE, SOLVERS, solvers
from validation.studies import page
from validation.studies.knobs import Poisson, Zones, write
from validation.studies.study import study

BULK = Range("a number above 2/3, below 1e6", 2.0 / 3.0, 1e6, open=True)
RATIO = Range("a number from 2e-9 to 0.2", 2e-9, 0.2)
OPTIONS = {
    **shared.SCENES,
    "--out": value("DIR", "write page, Markdown, JSON and figures there"),
    "--poisson": value(
        "K/G",
        "instead: elastic bulk of these ratios to the relaxed shear modulus (10 to 1000), against a constant "
        "Poisson's ratio",
        type=option_type(BULK),
        nargs="*",
    ),
    "--zones": value(
        "RATIO",
        "instead: steps, points, time and error of every solver with process zones of these ratios to the "
        "contact radius (5e-2 to 5e-9)",
        type=option_type(RATIO),
        nargs="*",
    ),
    **shared.MAX_STEPS,
    **shared.jobs("processes for what is not timed"),
    **shared.FRESH,
}


def run(options: argparse.Namespace, jobs: int) -> int:
    """Make one of the studies of every solver; 1 if a run does not finish or solvers disagree."""
    if options.poisson is not None and options.zones is not None:
        raise SceneError("--zones", "given beside --poisson", "one of the two, each a study of its own")
    arguments.usable()  # names those that cannot be loaded
    if options.poisson is None and options.zones is None:
        return _refinement(options, jobs)
    return _turned(options, jobs)


def _refinement(options: argparse.Namespace, jobs: int) -> int:
    """Refine every solver on the given scenes."""
    loaded = shared.load_taken(options.scenes, lambda case: solvers())
    with shared.long_work("study", options, "a study", loaded) as work:
        result = study(loaded, jobs, work.runs(), work.store, options.max_steps)
        print(for_terminal(page.short(result)))
        work.write(lambda folder, writing: page.write(result, folder))
    return shared.failed(
        [
            f"failed: {scene.case.name}: {ladder.ladder.scheme}: {ladder.ladder.kind} {level.level.label}: "
            f"{level.failure}"
            for scene in result.scenes
            for ladder, level in scene.failed
        ]
    )


def _turned(options: argparse.Namespace, jobs: int) -> int:
    """Turn a knob of the model; zones one after the other, for the time of their runs is measured."""
    knob: Zones | Poisson = Poisson() if options.zones is None else Zones()
    given = options.poisson if options.zones is None else options.zones
    asked = solvers() if options.zones is None else (SOLVERS[REFERENCE],)
    loaded, failures = shared.load_taken(options.scenes, lambda case: asked), list[str]()
    for source, case in zip(dict.fromkeys(options.scenes), loaded, strict=True):
        if isinstance(knob, Poisson) and case.scene.body is not None:
            problem = "bulk relaxes apart from shear in this study, and on a layer it cannot"
            raise SceneError("body", problem, "no [body]: a half-space", source)
    workers = processes(jobs) if options.zones is None else processes(1, isolated=True, tasks_per_process=1)
    with shared.long_work("study", options, "a study", loaded) as work, workers as executor:
        for case in loaded:
            with Progress(f"{case.name} {knob.name}", "runs") as progress:
                values, how = given or knob.values, (progress, executor, work.store, options.max_steps)
                runs = knob.runs(case, values, *how)
            print(for_terminal(knob.section(case.name, runs)))
            if work.folder is not None:
                print(f"written to {write(knob, case, runs, work.folder)}")
            failures += knob.failures(runs)
    return shared.failed(failures)
