"""Random scenes through all solvers, each answer judged by the invariants and against the reference.

``python -m validation.stability.random_matrix --out DIR --first 1 --count 2000`` goes on where an earlier
call with the same folder stopped. ``scenes.jsonl`` holds a line for every scene that is done, ``table.md``
the findings so far, ``scenes/`` the scene file of every scene with a finding.

A curve is compared relative to what it does in the run, its excursion, so that a small oscillation on a
large mean counts in full; a scalar relative to what :mod:`validation.measure.scaling` says.
"""

from __future__ import annotations

import argparse
import json
import math
from collections.abc import Sequence
from dataclasses import asdict, dataclass, replace
from enum import StrEnum
from pathlib import Path

import numpy as np

from contact_scene import SceneError, Trace
from contact_scene.scenefile import write_scene
from validation.cases import Case
from validation.execution.files import output_folder
from validation.execution.processes import processes
from validation.execution.runs import Run
from validation.execution.solver_tasks import run_task
from validation.execution.tasks import Task, TaskEnding, TaskResult, run_tasks
from validation.measure.norms import distance
from validation.measure.scaling import scale
from validation.solvers import REFERENCE, SOLVERS
from validation.solvers.contact_range import largest_contact_radius
from validation.stability import trace_invariants
from validation.stability.random_scenes import RandomScene, random_scene

WRONG = 0.05
"""Difference from which an answer counts as wrong whatever it says of itself, beyond the reference's own
error: ten times what the solvers are held to in the built-in scenes."""
NOTICEABLE = 2e-3
"""Difference below which an estimate that falls short of it is not reported."""
LOOSE = 0.1
"""Estimate of a curve from which on a run counts as not resolved, although it ends well."""
LEAST_MOVEMENT = 5e-3
"""Excursion of a curve, relative to its largest magnitude, below which it is at rest and compared
relative to that magnitude: what the solvers are held to in a curve by default."""
STEP_ACCURACY = 4e-3
"""Of an energy, relative to the effort of the run: the coarsest step tolerance of any solver."""
CURVES = ("force", "contact_radius")
SCALARS = (
    "start_force",
    "start_radius",
    "pull_off_force",
    "detachment_time",
    "detachment_penetration",
    "loop_energy",
    "branch_dissipation",
)
"""Numbers that belong to the scene, not to which row comes next to an extremum."""


class AnswerFinding(StrEnum):
    """What is said of an answer, the worst that applies; the last two are as they should be."""

    CRASHED = "crashed"
    HUNG = "no answer in time"
    IMPROPER = "breaks an invariant"
    OTHER_ENDING = "ends otherwise"
    WRONG = "silently wrong"
    UNDERSTATED = "off by more than its estimate"
    LOOSE = "estimate is large"
    NO_REFERENCE = "nothing to compare with"
    DECLINED = "reports no answer"
    AGREES = "agrees"


FAULTS = (
    AnswerFinding.CRASHED,
    AnswerFinding.IMPROPER,
    AnswerFinding.OTHER_ENDING,
    AnswerFinding.WRONG,
    AnswerFinding.UNDERSTATED,
)
"""Judgements after which the scene is written to a file."""


@dataclass(frozen=True)
class RandomSceneAnswer:
    """What became of one solver on one scene.

    Parameters
    ----------
    solver : str
    finding : AnswerFinding
    ending : str
        How the run ended.
    quantity : str
        The worst one.
    difference, allowed : float
        Of that quantity: from the reference, and the sum of both estimates.
    seconds : float
        Processor time, the coarser run for the estimate included.
    note : str
    """

    solver: str
    finding: AnswerFinding
    ending: str
    quantity: str = ""
    difference: float = 0.0
    allowed: float = 0.0
    seconds: float = 0.0
    note: str = ""


@dataclass(frozen=True)
class JudgedScene:
    """A random scene and every solver's answer."""

    seed: int
    kind: str
    indenter: str
    zone: float
    answers: tuple[RandomSceneAnswer, ...]


def examine(chosen: RandomScene, results: Sequence[TaskResult]) -> JudgedScene:
    """Judge the runs of one scene, in the order of ``SOLVERS``."""
    runs = dict(zip(SOLVERS, results, strict=True))
    base = runs[REFERENCE].value
    answers = tuple(_answer(chosen, solver, result, base) for solver, result in runs.items())
    scene = chosen.scene
    zone = scene.adhesion.zone / largest_contact_radius(scene) if scene.adhesion is not None else 0.0
    return JudgedScene(chosen.seed, chosen.kind, scene.indenter.shape, zone, answers)


def _answer(chosen: RandomScene, solver: str, result: TaskResult, base: Run | None) -> RandomSceneAnswer:
    if result.ending is TaskEnding.TIMED_OUT:
        return RandomSceneAnswer(solver, AnswerFinding.HUNG, "", note=result.failure)
    run: Run | None = result.value
    if run is None or (run.trace is None and not run.refused):
        note = result.failure if run is None else run.failure
        return RandomSceneAnswer(solver, AnswerFinding.CRASHED, "", note=note)
    trace, seconds = run.trace, run.cpu_seconds + run.estimate_seconds
    if trace is None:
        return RandomSceneAnswer(solver, AnswerFinding.DECLINED, "refused", note=run.failure)
    ending = str(trace.outcome.kind)
    wrong = trace_invariants.broken(chosen.scene, trace)
    wrong += trace_invariants.energy_gained(chosen.scene, trace, STEP_ACCURACY)
    if wrong:
        return RandomSceneAnswer(
            solver, AnswerFinding.IMPROPER, ending, seconds=seconds, note="; ".join(wrong)
        )
    if not run.finished:
        return RandomSceneAnswer(
            solver, AnswerFinding.DECLINED, ending, seconds=seconds, note=trace.outcome.reason
        )
    if solver == REFERENCE:
        return RandomSceneAnswer(solver, AnswerFinding.AGREES, ending, seconds=seconds)
    if base is None or base.trace is None or not base.finished:
        return RandomSceneAnswer(solver, AnswerFinding.NO_REFERENCE, ending, seconds=seconds)
    if base.trace.outcome.kind is not trace.outcome.kind:
        note = f"the reference: {base.trace.outcome.kind} at t = {base.trace.outcome.time:.4g}"
        return RandomSceneAnswer(solver, AnswerFinding.OTHER_ENDING, ending, seconds=seconds, note=note)
    return _compared(run, trace, base, base.trace, seconds)


def _compared(run: Run, trace: Trace, base: Run, base_trace: Trace, seconds: float) -> RandomSceneAnswer:
    ending = str(trace.outcome.kind)
    worst: tuple[float, str, float, float] = (-math.inf, "", 0.0, 0.0)
    finding = AnswerFinding.AGREES
    for name, difference, own, others in _differences(run, trace, base, base_trace):
        allowed = own + others
        now = AnswerFinding.AGREES
        if difference > WRONG + others:
            now = AnswerFinding.WRONG
        elif difference > max(allowed, NOTICEABLE):
            now = AnswerFinding.UNDERSTATED
        elif name in CURVES and LOOSE < own < math.inf:
            now = AnswerFinding.LOOSE
        ranks = list(AnswerFinding)
        key = (difference, name, difference, allowed)
        if ranks.index(now) < ranks.index(finding) or (now is finding and key > worst):
            finding, worst = now, key
    return RandomSceneAnswer(run.solver, finding, ending, worst[1], worst[2], worst[3], seconds)


def _differences(
    run: Run, trace: Trace, base: Run, base_trace: Trace
) -> list[tuple[str, float, float, float]]:
    """Name, difference, own estimate (infinite if there is none), the reference's; relative to one size."""
    found = []
    for column in CURVES:
        apart = distance(trace, base_trace, column)
        values = base_trace.columns()[column]
        largest, excursion = float(np.abs(values).max(initial=0.0)), float(np.ptp(values))
        if apart is None or largest == 0.0:
            continue
        factor = largest / excursion if excursion > LEAST_MOVEMENT * largest else 1.0
        own, others = run.errors.get(column, math.inf), base.errors.get(column, 0.0)
        found.append((column, factor * apart.rms, factor * own, factor * others))
    for name in SCALARS:
        expected, measured = base.measures.get(name), run.measures.get(name)
        if expected is None or measured is None:
            continue
        size = scale(name, expected, base_trace)
        if size > 0.0:
            difference = abs(measured - expected) / size
            found.append((name, difference, run.errors.get(name, math.inf), base.errors.get(name, 0.0)))
    return found


def table(judged: Sequence[JudgedScene]) -> str:
    """Findings by solver, then the worst scenes of every finding, as Markdown."""
    lines = [f"{len(judged)} random scenes", "", "| finding | " + " | ".join(SOLVERS) + " |"]
    lines.append("|---" * (len(SOLVERS) + 1) + "|")
    for finding in AnswerFinding:
        counts = [
            sum(answer.finding is finding for one in judged for answer in one.answers if answer.solver == s)
            for s in SOLVERS
        ]
        lines.append(f"| {finding} | " + " | ".join(map(str, counts)) + " |")
    lines += ["", "| finding | solver | seed | loading | indenter | zone/radius | what |", "|---" * 7 + "|"]
    rows = [
        (list(AnswerFinding).index(answer.finding), answer.solver, -answer.difference, one, answer)
        for one in judged
        for answer in one.answers
        if answer.finding not in (AnswerFinding.AGREES, AnswerFinding.DECLINED, AnswerFinding.NO_REFERENCE)
    ]
    for *_, one, answer in sorted(rows, key=lambda row: row[:3]):
        what = (
            answer.note or f"{answer.quantity} off by {answer.difference:.2g}, allowed {answer.allowed:.2g}"
        )
        cells = (answer.finding, answer.solver, one.seed, one.kind, one.indenter, f"{one.zone:.1g}", what)
        lines.append("| " + " | ".join(map(str, cells)) + " |")
    return "\n".join(lines) + "\n"


def read(file: Path) -> list[JudgedScene]:
    """Scenes that are done; none where there is no file."""
    if not file.exists():
        return []
    judged = []
    for line in file.read_text("utf-8").splitlines():
        entry = json.loads(line)
        answers = tuple(
            RandomSceneAnswer(**(answer | {"finding": AnswerFinding(answer["finding"])}))
            for answer in entry["answers"]
        )
        judged.append(JudgedScene(**(entry | {"answers": answers})))
    return judged


def run(
    folder: Path, seeds: Sequence[int], jobs: int = 1, seconds: float = 60.0, resolution: int | None = None
) -> list[JudgedScene]:
    """Examine the scenes of the seeds that the folder does not hold yet.

    Parameters
    ----------
    folder : Path
        Receives ``scenes.jsonl``, ``table.md`` and ``scenes/``.
    seeds : sequence of int
    jobs : int
        Processes.
    seconds : float
        Processor time after which a run is given up.
    resolution : int or None
        Divisions per process zone; ``None``: each solver's own.

    Returns
    -------
    list of JudgedScene
        All that the folder holds.
    """
    file = folder / "scenes.jsonl"
    judged = read(file)
    done = {one.seed for one in judged}
    missing = [seed for seed in seeds if seed not in done]
    with processes(jobs, isolated=True) as executor:
        for begin in range(0, len(missing), jobs):
            batch = [_possible(seed) for seed in missing[begin : begin + jobs]]
            chosen = [one for one in batch if one is not None]
            results = run_tasks(_tasks(chosen, seconds, resolution), executor)
            for index, one in enumerate(chosen):
                judged.append(examine(one, results[index * len(SOLVERS) : (index + 1) * len(SOLVERS)]))
                _append(folder, one, judged[-1])
            (folder / "table.md").write_text(table(judged), encoding="utf-8")
    return judged


def _possible(seed: int) -> RandomScene | None:
    """The scene of a seed; ``None`` where its loading never touches or a number is out of range."""
    try:
        chosen = random_scene(seed)
        largest_contact_radius(chosen.scene)
    except SceneError:
        return None
    return chosen


def _tasks(chosen: Sequence[RandomScene], seconds: float, resolution: int | None) -> list[Task]:
    return [
        replace(
            run_task(
                Case(f"seed-{one.seed}", one.scene, profile_times=one.profile_times),
                solver,
                resolution,
                estimate=True,
            ),
            time_limit=seconds,
        )
        for one in chosen
        for solver in SOLVERS
    ]


def _append(folder: Path, chosen: RandomScene, judged: JudgedScene) -> None:
    with (folder / "scenes.jsonl").open("a", encoding="utf-8") as lines:
        lines.write(json.dumps(asdict(judged)) + "\n")
    if any(answer.finding in FAULTS for answer in judged.answers):
        (folder / "scenes").mkdir(exist_ok=True)
        write_scene(chosen.scene, folder / "scenes" / f"seed-{chosen.seed}.toml")


def main(arguments: Sequence[str] | None = None) -> int:
    """Command line; the exit code is 1 if an answer is at fault."""
    parser = argparse.ArgumentParser(description="random scenes through all solvers, judged")
    parser.add_argument("--out", required=True, help="folder, of an earlier call to go on with it")
    parser.add_argument("--first", type=int, default=1, help="first seed")
    parser.add_argument("--count", type=int, default=2000, help="number of seeds")
    parser.add_argument("--jobs", type=int, default=1, help="processes")
    parser.add_argument("--seconds", type=float, default=60.0, help="processor time limit of a run")
    parser.add_argument("--resolution", type=int, help="divisions per process zone, of every solver")
    chosen = parser.parse_args(arguments)
    seeds = range(chosen.first, chosen.first + chosen.count)
    judged = run(output_folder(chosen.out), seeds, chosen.jobs, chosen.seconds, chosen.resolution)
    print(table(judged), end="")
    return 1 if any(answer.finding in FAULTS for one in judged for answer in one.answers) else 0


if __name__ == "__main__":
    raise SystemExit(main())
