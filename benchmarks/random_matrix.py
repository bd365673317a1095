"""Random scenes through all solvers, each answer judged by the invariants and against the reference.

    python -m benchmarks.random_matrix --out DIR --family usual --first 1 --count 2000 --shard 0/2

goes on where an earlier call with the same folder stopped: ``*.jsonl`` hold a line for every seed that is
done, ``scenes/`` the file of every scene with a fault, ``table.md`` all findings. Shards run side by side.

A curve is compared relative to what it does in the run, its excursion, so that a small oscillation on a large
mean counts in full; a scalar relative to what :mod:`validation.measure.scaling` says.
"""

from __future__ import annotations

import argparse
import json
import math
import sys
from collections.abc import Iterator, Mapping, Sequence
from concurrent.futures import Executor
from dataclasses import asdict, dataclass, replace
from enum import StrEnum
from pathlib import Path

import numpy as np

from benchmarks.random_scenes import FAMILIES, RandomScene, random_scene
from benchmarks.trace_invariants import broken, energy_gained
from contact_scene import SceneError
from contact_scene.scene import write_scene
from contact_scene.trace import Array
from validation.compare.checks import check_case
from validation.measure.curves import CURVES
from validation.measure.difference import of_curves, of_numbers
from validation.measure.windows import windows
from validation.runs.folder import output_folder
from validation.runs.pool import Engine, TaskEnding, TaskResult, completed_tasks, processes, run_of, run_task
from validation.runs.run import Run
from validation.solvers import REFERENCE, SOLVERS, solver

WRONG = 0.05
"""Difference from which an answer counts as wrong, beyond the reference's own error: ten times what the
solvers are held to in the built-in scenes. An estimate that holds the difference makes it no better, but
then the run says so."""
NOTICEABLE = 2e-3
"""Difference below which an estimate that falls short of it is not reported."""
LOOSE = 0.1
"""Estimate of a curve from which on a run counts as not resolved, although it ends well."""
LEAST_MOVEMENT = 5e-3
"""Excursion of a curve, relative to its largest magnitude, below which it is at rest and compared
relative to that magnitude: what the solvers are held to in a curve by default."""
STEP_ACCURACY = 4e-3
"""Of an energy, relative to the effort of the run: the coarsest step tolerance of any solver."""
WITH_ESTIMATE = 4.0
"""Time limit of a run with its estimate over that of the run alone: the second run may be twice as fine."""
SUSPENDED = 1e4
"""Wall time over processor time after which a run is given up: solvers do not sleep, and hours in which a
machine is suspended are no fault of the run that was going on."""
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


class Finding(StrEnum):
    """What is said of an answer, the worst that applies; the last two are as they should be."""

    CRASHED = "crashed"
    HUNG = "no answer in time"
    IMPROPER = "breaks an invariant"
    OTHER_ENDING = "ends otherwise"
    WRONG = "silently wrong"
    TOLD = "wrong, and says so"
    UNDERSTATED = "off by more than its estimate"
    FAILED = "fails a check"
    LOOSE = "estimate is large"
    NO_REFERENCE = "nothing to compare with"
    DECLINED = "reports no answer"
    AGREES = "agrees"


RANKS = list(Finding)
FAULTS = (*RANKS[:1], *RANKS[2:8])
"""Findings after which the scene is written to a file."""
OTHERWISE_WELL = (Finding.AGREES, Finding.LOOSE, Finding.DECLINED)
"""Findings of an answer that may still fail a check of the comparison."""


@dataclass(frozen=True)
class Answer:
    """What became of one solver on one scene: the worst quantity, its difference from the reference, the sum
    of both estimates."""

    solver: str
    finding: Finding
    ending: str = ""
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
    answers: tuple[Answer, ...]


def judge(chosen: RandomScene, runs: Mapping[str, TaskResult], compared: bool = False) -> JudgedScene:
    """Judge the runs of one scene, that of the reference among them; ``compared``: by ``compare`` as well."""
    base = runs[REFERENCE].value
    answers = [_answer(chosen, name, result, base) for name, result in runs.items()]
    taken = {name: run_of(result) for name, result in runs.items()}
    if compared and not all(run.refused for run in taken.values()):
        failed = [check for check in check_case(chosen.case, taken) if not check.passed]
        answers = [_with_failed(one, [c for c in failed if c.solver == one.solver]) for one in answers]
    return JudgedScene(chosen.seed, chosen.kind, chosen.scene.indenter.shape, tuple(answers))


def _with_failed(answer: Answer, failed: Sequence) -> Answer:
    """The answer with the checks of the comparison that it fails."""
    if not failed:
        return answer
    words = [f"{check.quantity}: {check.note or f'{check.found}, not {check.expected}'}" for check in failed]
    answer = replace(answer, note="; ".join(filter(None, (answer.note, *words))))
    if answer.finding not in OTHERWISE_WELL:
        return answer
    worst = max(failed, key=lambda check: abs(check.difference or 0.0))
    size, limit = abs(worst.difference or 0.0), worst.limit or 0.0
    return replace(answer, finding=Finding.FAILED, quantity=worst.quantity, difference=size, allowed=limit)


def _answer(chosen: RandomScene, name: str, result: TaskResult, base: Run | None) -> Answer:
    if result.ending is TaskEnding.TIMED_OUT:
        return Answer(name, Finding.HUNG, note=result.failure)
    run: Run | None = result.value
    if run is None or (run.trace is None and not run.refused):
        return Answer(name, Finding.CRASHED, note=result.failure if run is None else run.failure)
    trace, seconds = run.trace, run.cpu_seconds + run.estimate_seconds
    if trace is None:
        return Answer(name, Finding.DECLINED, "refused", note=run.failure)
    told = Answer(name, Finding.AGREES, str(trace.outcome.kind), seconds=seconds)
    wrong = broken(chosen.scene, trace) + energy_gained(chosen.scene, trace, STEP_ACCURACY)
    if wrong:
        return replace(told, finding=Finding.IMPROPER, note="; ".join(wrong))
    if not run.finished:
        return replace(told, finding=Finding.DECLINED, note=trace.outcome.reason)
    if name == REFERENCE:
        return told
    if base is None or base.trace is None or not base.finished:
        return replace(told, finding=Finding.NO_REFERENCE)
    if base.trace.outcome.kind is not trace.outcome.kind:
        note = f"the reference: {base.trace.outcome.kind} at t = {base.trace.outcome.time:.4g}"
        return replace(told, finding=Finding.OTHER_ENDING, note=note)
    worst = (-RANKS.index(Finding.AGREES), -math.inf, "", 0.0)
    spans = windows(chosen.scene.loading, trace)
    for quantity, difference, own, others in _differences(run, base, spans):
        now = _finding(quantity, difference, own, others)
        worst = max(worst, (-RANKS.index(now), difference, quantity, own + others))
    rank, difference, quantity, allowed = worst
    return replace(
        told, finding=RANKS[-rank], quantity=quantity, difference=max(difference, 0.0), allowed=allowed
    )


def _finding(quantity: str, difference: float, own: float, others: float) -> Finding:
    """Of one quantity, from its difference and the estimates of the run and of the reference."""
    if difference > WRONG + others:
        return Finding.TOLD if difference <= own + others < math.inf else Finding.WRONG
    if difference > max(own + others, NOTICEABLE):
        return Finding.UNDERSTATED
    return Finding.LOOSE if quantity in CURVES and LOOSE < own < math.inf else Finding.AGREES


def _differences(run: Run, base: Run, spans: Array) -> Iterator[tuple[str, float, float, float]]:
    """Name, difference, own estimate (infinite if there is none), the reference's; relative to one size."""
    assert base.trace is not None
    for one in (*of_curves(run, base, spans), *of_numbers(run, base, SCALARS)):
        factor = 1.0
        if one.quantity in CURVES:
            values = base.trace.columns()[one.quantity]
            largest, excursion = float(np.abs(values).max(initial=0.0)), float(np.ptp(values))
            factor = largest / excursion if excursion > LEAST_MOVEMENT * largest else 1.0
        if math.isfinite(one.error):
            own = math.inf if one.own is None else one.own
            yield one.quantity, factor * abs(one.error), factor * own, factor * (one.known_to or 0.0)


@dataclass(frozen=True)
class Settings:
    """How scenes are drawn, run and judged.

    ``seconds`` is the processor time (s) after which a run is given up; ``resolution`` divisions per process
    zone (``None``: each solver's own); ``coarse`` the coarse resolution of each solver instead; ``screened``
    asks for estimates only where an answer differs by more than its solver may at that resolution.
    """

    family: str = "usual"
    seconds: float = 60.0
    resolution: int | None = None
    coarse: bool = False
    screened: bool = False
    compared: bool = False
    solvers: tuple[str, ...] = tuple(SOLVERS)


def answers(chosen: RandomScene, settings: Settings, executor: Executor | None) -> JudgedScene:
    """Run a scene by every solver and judge the answers."""
    first = {name: not settings.screened or name == REFERENCE for name in settings.solvers}
    results = _results(chosen, settings, executor, first)
    judged = judge(chosen, results, settings.compared)
    undecided = {
        one.solver: True
        for one in judged.answers
        if settings.screened
        and one.solver != REFERENCE
        and one.finding in (Finding.AGREES, Finding.WRONG)
        and one.difference > solver(one.solver).coarse_tolerance
    }
    for name, result in _results(chosen, settings, executor, undecided, WITH_ESTIMATE).items():
        if result.ending is TaskEnding.ANSWERED:  # otherwise the run before it stands
            results[name] = result
    return judge(chosen, results, settings.compared)


def _results(
    chosen: RandomScene,
    settings: Settings,
    executor: Executor | None,
    estimates: Mapping[str, bool],
    times: float = 1.0,
) -> dict[str, TaskResult]:
    tasks = []
    for name, estimate in estimates.items():
        coarse = solver(name).coarse_resolution(chosen.scene.is_adhesive)
        task = run_task(
            chosen.case, name, coarse if settings.coarse else settings.resolution, estimate=estimate
        )
        tasks.append(replace(task, time_limit=times * settings.seconds))
    done = dict(completed_tasks(enumerate(tasks), Engine(executor)))
    return {name: done[number] for number, name in enumerate(estimates)}


def read(folder: Path) -> list[JudgedScene]:
    """Scenes that are done, of all shards."""
    judged = []
    for file in sorted(folder.glob("*.jsonl")):
        for line in file.read_text("utf-8").splitlines():
            entry = json.loads(line)
            said = tuple(Answer(**(a | {"finding": Finding(a["finding"])})) for a in entry["answers"])
            judged.append(JudgedScene(**(entry | {"answers": said})))
    return judged


def run(folder: Path, seeds: Sequence[int], settings: Settings, shard: tuple[int, int] = (0, 1)) -> None:
    """Judge the scenes of a shard's seeds that the folder does not hold yet; refuse one of other settings."""
    kept = folder / "settings.json"
    asked = json.dumps(asdict(settings) | {"seconds": None})
    if kept.exists() and kept.read_text("utf-8") != asked:
        raise SceneError(
            "--out", f"holds scenes of {kept.read_text('utf-8')}", "another folder, or the same settings"
        )
    kept.write_text(asked, encoding="utf-8")
    done = {one.seed for one in read(folder)}
    number, count = shard
    with (
        (folder / f"shard-{number}-of-{count}.jsonl").open("a", encoding="utf-8") as lines,
        processes(1, isolated=True, wall_per_processor_second=SUSPENDED) as executor,
    ):
        for seed in seeds:
            if (
                seed in done
                or seed % count != number
                or (chosen := random_scene(settings.family, seed)) is None
            ):
                continue
            judged = answers(chosen, settings, executor)
            lines.write(json.dumps(asdict(judged)) + "\n")
            lines.flush()
            if any(answer.finding in FAULTS for answer in judged.answers):
                (folder / "scenes").mkdir(exist_ok=True)
                write_scene(chosen.scene, folder / "scenes" / f"seed-{seed}.toml")


def table(judged: Sequence[JudgedScene]) -> str:
    """Findings by solver, then the answers worth a look, worst first, as Markdown."""
    said = [(one, answer) for one in judged for answer in one.answers]
    lines = [f"{len(judged)} random scenes", "", f"| finding | {' | '.join(SOLVERS)} |"]
    lines.append("|---" * (len(SOLVERS) + 1) + "|")
    for finding in Finding:
        counts = [sum(a.finding is finding and a.solver == name for _, a in said) for name in SOLVERS]
        lines.append(f"| {finding} | {' | '.join(map(str, counts))} |")
    lines += ["", "| finding | solver | seed | loading | indenter | what |", "|---" * 6 + "|"]
    rows = [(RANKS.index(a.finding), a.solver, -a.difference, one.seed, one, a) for one, a in said]
    for rank, name, _, seed, one, a in sorted(rows, key=lambda row: row[:4]):
        if rank < RANKS.index(Finding.NO_REFERENCE):
            what = a.note or f"{a.quantity} off by {a.difference:.2g}, allowed {a.allowed:.2g}"
            lines.append(f"| {a.finding} | {name} | {seed} | {one.kind} | {one.indenter} | {what} |")
    return "\n".join(lines) + "\n"


def main(arguments: Sequence[str] | None = None) -> int:
    """Command line; the exit code is 1 if an answer is at fault."""
    parser = argparse.ArgumentParser(description="random scenes through all solvers, judged")
    parser.add_argument("--out", required=True, help="folder, of an earlier call to go on with it")
    parser.add_argument("--family", choices=FAMILIES, default="usual", help="scenes; one family a folder")
    parser.add_argument("--first", type=int, default=1, help="first seed")
    parser.add_argument("--count", type=int, default=2000, help="number of seeds")
    parser.add_argument("--seeds", type=int, nargs="+", help="these seeds instead")
    parser.add_argument("--shard", default="0/1", help="I/N: the seeds whose remainder by N is I")
    parser.add_argument("--seconds", type=float, default=60.0, help="processor time limit of a run")
    sizes = parser.add_mutually_exclusive_group()
    sizes.add_argument("--resolution", type=int, help="divisions per process zone, of every solver")
    sizes.add_argument("--coarse", action="store_true", help="the coarse resolution of each solver")
    estimates = parser.add_mutually_exclusive_group()
    estimates.add_argument("--screened", action="store_true", help="estimates only where they decide")
    estimates.add_argument("--compared", action="store_true", help="the checks of compare as well")
    parser.add_argument(
        "--solvers", nargs="+", choices=SOLVERS, default=list(SOLVERS), help="beside the reference"
    )
    chosen = parser.parse_args(arguments)
    names = tuple(name for name in SOLVERS if name == REFERENCE or name in chosen.solvers)
    settings = Settings(
        chosen.family,
        chosen.seconds,
        chosen.resolution,
        chosen.coarse,
        chosen.screened,
        chosen.compared,
        names,
    )
    seeds = chosen.seeds or range(chosen.first, chosen.first + chosen.count)
    number, count = map(int, chosen.shard.split("/"))
    try:
        folder = output_folder(chosen.out)
        run(folder, seeds, settings, (number, count))
    except SceneError as error:
        print(error, file=sys.stderr)
        return 2
    judged = read(folder)
    (folder / "table.md").write_text(table(judged), encoding="utf-8")
    print(table(judged), end="")
    return 1 if any(answer.finding in FAULTS for one in judged for answer in one.answers) else 0


if __name__ == "__main__":
    raise SystemExit(main())
