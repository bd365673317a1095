"""Random scenes through all solvers, each answer judged by the invariants and against the reference.

``python -m validation.stability.random_matrix --out DIR --first 1 --count 2000`` goes on where an earlier
call with the same folder stopped. ``scenes.jsonl`` holds a line for every scene that is done, ``table.md``
the findings so far, ``scenes/`` the scene file of every scene with a finding.
"""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Callable, Iterable, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

from contact_scene import SceneError
from contact_scene.scene_writer import write_scene
from validation.execution.files import output_folder
from validation.execution.processes import processes
from validation.solvers import REFERENCE, SOLVERS
from validation.solvers.contact_range import largest_contact_radius
from validation.stability.random_answers import (
    FAULTS,
    AnswerFinding,
    JudgedScene,
    RandomSceneAnswer,
)
from validation.stability.random_instruments import random_instrument
from validation.stability.random_plain import random_plain
from validation.stability.random_runs import RandomRunSettings, judged_scenes
from validation.stability.random_scenes import RandomScene, random_scene, random_short_zone
from validation.stability.random_swings import random_swing

FAMILIES: dict[str, Callable[[int], RandomScene]] = {
    "usual": random_scene,
    "instruments": random_instrument,
    "short-zones": random_short_zone,
    "swings": random_swing,
    "plain": random_plain,
}
"""What makes the scene of a seed, by the family of scenes."""

TABLE_EVERY = 20
"""Scenes after which the table is written anew."""
SUSPENDED = 1e4
"""Wall time over processor time after which a run is given up: solvers do not sleep, and hours in which a
matrix is suspended from outside are no fault of the run that was going on."""


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
    seeds: Iterable[int],
    jobs: int = 1,
    settings: RandomRunSettings | None = None,
    family: str = "usual",
) -> list[JudgedScene]:
    """Examine the scenes of the seeds that the folder does not hold yet.

    Parameters
    ----------
    folder : Path
        Receives ``settings.json``, ``scenes.jsonl``, ``table.md`` and ``scenes/``.
    seeds : iterable of int
    jobs : int
        Processes.
    settings : RandomRunSettings, optional
    family : str
        One of ``FAMILIES``.

    Returns
    -------
    list of JudgedScene
        All that the folder holds.

    Raises
    ------
    SceneError
        If the folder holds scenes of other settings; the time limit alone may change.
    """
    settings = settings or RandomRunSettings()
    _keep_settings(folder, {"family": family, **asdict(settings)})
    judged = read(folder / "scenes.jsonl")
    done = {one.seed for one in judged}
    possible = (_possible(seed, family) for seed in seeds if seed not in done)
    scenes = (chosen for chosen in possible if chosen is not None)
    with processes(jobs, isolated=True, wall_per_processor_second=SUSPENDED) as executor:
        for chosen, one in judged_scenes(scenes, settings, executor, jobs):
            judged.append(one)
            _append(folder, chosen, one)
            if len(judged) % TABLE_EVERY == 0:
                (folder / "table.md").write_text(table(judged), encoding="utf-8")
    (folder / "table.md").write_text(table(judged), encoding="utf-8")
    return judged


def _keep_settings(folder: Path, settings: dict[str, Any]) -> None:
    file = folder / "settings.json"
    if file.exists():
        before = json.loads(file.read_text("utf-8"))
        for name in settings.keys() - {"seconds"}:
            if before.get(name) != settings[name]:
                problem = f"holds scenes with {name} = {before.get(name)}, not {settings[name]}"
                raise SceneError("--out", problem, "another folder, or the same settings")
        settings["seconds"] = max(settings["seconds"], before["seconds"])
    file.write_text(json.dumps(settings) + "\n", encoding="utf-8")


def _possible(seed: int, family: str = "usual") -> RandomScene | None:
    """The scene of a seed; ``None`` where its loading never touches or a number is out of range."""
    try:
        chosen = FAMILIES[family](seed)
        largest_contact_radius(chosen.scene)
    except SceneError:
        return None
    return chosen


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
    parser.add_argument("--seeds", type=int, nargs="+", help="these seeds instead")
    sizes = parser.add_mutually_exclusive_group()
    sizes.add_argument("--resolution", type=int, help="divisions per process zone, of every solver")
    sizes.add_argument("--coarse", action="store_true", help="the coarse resolution of each solver")
    estimates = parser.add_mutually_exclusive_group()
    estimates.add_argument(
        "--screened", action="store_true", help="estimates only where an answer is off by more than it may be"
    )
    estimates.add_argument(
        "--compared", action="store_true", help="the checks of `crosscontact compare` as well"
    )
    parser.add_argument(
        "--solvers",
        nargs="+",
        choices=SOLVERS,
        default=list(SOLVERS),
        help="beside the reference",
    )
    parser.add_argument("--family", choices=FAMILIES, default="usual", help="scenes; one family a folder")
    chosen = parser.parse_args(arguments)
    seeds = chosen.seeds or range(chosen.first, chosen.first + chosen.count)
    asked = [name for name in SOLVERS if name == REFERENCE or name in chosen.solvers]
    settings = RandomRunSettings(
        chosen.seconds, chosen.resolution, chosen.coarse, chosen.screened, asked, chosen.compared
    )
    try:
        judged = run(output_folder(chosen.out), seeds, chosen.jobs, settings, chosen.family)
    except SceneError as error:
        print(error, file=sys.stderr)
        return 2
    print(table(judged), end="")
    return 1 if any(answer.finding in FAULTS for one in judged for answer in one.answers) else 0


if __name__ == "__main__":
    raise SystemExit(main())
