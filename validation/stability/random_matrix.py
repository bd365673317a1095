"""Random scenes through all solvers, each answer judged by the invariants and against the reference.

``python -m validation.stability.random_matrix --out DIR --first 1 --count 2000`` goes on where an earlier
call with the same folder stopped. ``scenes.jsonl`` holds a line for every scene that is done, ``table.md``
the findings so far, ``scenes/`` the scene file of every scene with a finding.
"""

from __future__ import annotations

import argparse
import json
from collections.abc import Callable, Sequence
from dataclasses import asdict, replace
from pathlib import Path

from contact_scene import SceneError
from contact_scene.scenefile import write_scene
from validation.cases import Case
from validation.execution.files import output_folder
from validation.execution.processes import processes
from validation.execution.solver_tasks import run_task
from validation.execution.tasks import Task, run_tasks
from validation.solvers import SOLVERS
from validation.solvers.contact_range import largest_contact_radius
from validation.stability.random_answers import (
    FAULTS,
    AnswerFinding,
    JudgedScene,
    RandomSceneAnswer,
    examine,
)
from validation.stability.random_instruments import random_instrument
from validation.stability.random_scenes import RandomScene, random_scene

FAMILIES: dict[str, Callable[[int], RandomScene]] = {"usual": random_scene, "instruments": random_instrument}
"""What makes the scene of a seed, by the family of scenes."""


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
    folder: Path,
    seeds: Sequence[int],
    jobs: int = 1,
    seconds: float = 60.0,
    resolution: int | None = None,
    family: str = "usual",
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
    family : str
        One of ``FAMILIES``; a folder holds one of them.

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
            batch = [_possible(seed, family) for seed in missing[begin : begin + jobs]]
            chosen = [one for one in batch if one is not None]
            results = run_tasks(_tasks(chosen, seconds, resolution), executor)
            for index, one in enumerate(chosen):
                judged.append(examine(one, results[index * len(SOLVERS) : (index + 1) * len(SOLVERS)]))
                _append(folder, one, judged[-1])
            (folder / "table.md").write_text(table(judged), encoding="utf-8")
    return judged


def _possible(seed: int, family: str = "usual") -> RandomScene | None:
    """The scene of a seed; ``None`` where its loading never touches or a number is out of range."""
    try:
        chosen = FAMILIES[family](seed)
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
    parser.add_argument("--family", choices=FAMILIES, default="usual", help="scenes; one family a folder")
    chosen = parser.parse_args(arguments)
    seeds = range(chosen.first, chosen.first + chosen.count)
    judged = run(
        output_folder(chosen.out), seeds, chosen.jobs, chosen.seconds, chosen.resolution, chosen.family
    )
    print(table(judged), end="")
    return 1 if any(answer.finding in FAULTS for one in judged for answer in one.answers) else 0


if __name__ == "__main__":
    raise SystemExit(main())
