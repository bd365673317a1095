"""``crosscontact study``: refinement and run time, Poisson's ratio, or shorter process zones."""

from __future__ import annotations

import argparse
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from contact_scene import SceneError
from crosscontact import arguments
from crosscontact.commands import shared
from validation.cases import Case
from validation.report import terminal
from validation.runs.folder import claim, output_folder, scene_question
from validation.runs.pool import processes
from validation.runs.progress import Progress
from validation.runs.store import Store
from validation.solvers import REFERENCE, SOLVERS, solvers
from validation.studies import page
from validation.studies.knobs import Poisson, Zones
from validation.studies.study import study

_bulk = shared.number(lambda value: 2.0 / 3.0 < value < 1e6, "a number above 2/3, below 1e6")
_ratio = shared.number(lambda value: 2e-9 <= value <= 0.2, "a number from 2e-9 to 0.2")


def add_arguments(command: argparse.ArgumentParser) -> None:
    """Scenes, and the study to make of them."""
    shared.scene_argument(command, many=True)
    command.add_argument("--out", metavar="DIR", help="write page, Markdown, JSON and figures there")
    command.add_argument(
        "--poisson",
        type=_bulk,
        nargs="*",
        metavar="K/G",
        help="instead: elastic bulk of these ratios to the relaxed shear modulus (10 to 1000), against a "
        "constant Poisson's ratio",
    )
    command.add_argument(
        "--zones",
        type=_ratio,
        nargs="*",
        metavar="RATIO",
        help="instead: steps, points, time and error of every solver with process zones of these ratios to "
        "the contact radius (5e-2 to 5e-9)",
    )
    shared.run_options(command, jobs="processes for what is not timed", max_steps=True)


def run(options: argparse.Namespace, jobs: int) -> int:
    """Make one of the studies of every solver; 1 if a run does not finish or solvers disagree."""
    if options.poisson is not None and options.zones is not None:
        raise SceneError("--zones", "given beside --poisson", "one of the two, each a study of its own")
    arguments.usable()  # names those that cannot be loaded
    if options.poisson is None and options.zones is None:
        return _refinement(options, jobs)
    return _turned(options, jobs)


@contextmanager
def _prepared(options: argparse.Namespace, cases: list[Case]) -> Iterator[tuple[Path | None, Store]]:
    """Folder and finished runs of a study of these scenes."""
    folder = None if options.out is None else output_folder(options.out)
    if folder is not None:
        question = scene_question(*((case.name, case.scene) for case in cases))
        claim(folder, "a study", question, fresh=options.fresh)
    store = Store(folder, options.fresh)
    with shared.telling_what_is_kept(folder, store):
        yield folder, store
    store.clear()


def _refinement(options: argparse.Namespace, jobs: int) -> int:
    """Refine every solver on the given scenes."""
    loaded = shared.load_taken(options.scenes, lambda case: solvers())
    with _prepared(options, loaded) as (folder, store):
        progress = Progress("study")
        progress.phase("runs")
        result = study(loaded, jobs, progress, store, options.max_steps)
        print(terminal.text(page.short(result)))
        if folder is not None:
            with Progress("study") as writing:
                writing.phase("drawing and writing")
                page.write(result, folder)
            print(f"written to {folder / 'index.html'}")
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
    knob, given = (Poisson(), options.poisson) if options.zones is None else (Zones(), options.zones)
    asked = solvers() if options.zones is None else (SOLVERS[REFERENCE],)
    loaded, failures = shared.load_taken(options.scenes, lambda case: asked), list[str]()
    workers = processes(jobs) if options.zones is None else processes(1, isolated=True, tasks_per_process=1)
    with _prepared(options, loaded) as (folder, store), workers as executor:
        for case in loaded:
            with Progress(f"{case.name} {knob.name}") as progress:
                progress.phase("runs")
                runs = knob.runs(case, given or knob.values, progress, executor, store, options.max_steps)
            print(terminal.text(knob.section(case.name, runs)))
            if folder is not None:
                print(f"written to {knob.write(case, runs, folder)}")
            failures += knob.failures(runs)
    return shared.failed(failures)
