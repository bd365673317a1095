"""How far the answers of two reports lie apart, over the error estimates of both: what a change has moved.

    python -m validation.compare.moved OLD/report.json NEW/report.json

Scenes and solvers that both hold; a report of any earlier version will do, for it is read by names alone.
Exit code 1 if an answer has moved by more than both estimates together.
"""

from __future__ import annotations

import math
import sys
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from contact_scene import SceneError
from validation.compare.regression import read
from validation.measure.scaling import Magnitudes

OBSERVED = (
    "start_radius",
    "pull_off_force",
    "pull_off_penetration",
    "detachment_time",
    "detachment_radius",
    "loop_energy",
    "branch_dissipation",
)
ROUNDING = 1e-12
"""Difference, relative to its scale, that is none."""


@dataclass(frozen=True)
class MovedAnswer:
    """What of one solver's answers to a scene lies farthest apart, in error estimates of both.

    Parameters
    ----------
    scene, solver : str
    quantity : str
        Empty where no two answers differ.
    difference : float
        Relative, see :mod:`validation.measure.scaling`.
    estimates : float
        Of both runs together.
    """

    scene: str
    solver: str
    quantity: str = ""
    difference: float = 0.0
    estimates: float = 0.0

    @property
    def share(self) -> float:
        """Of the estimates; infinite where there are none."""
        if self.difference == 0.0:
            return 0.0
        return self.difference / self.estimates if self.estimates > 0.0 else math.inf


def moved(old: Mapping[str, Any], new: Mapping[str, Any]) -> list[MovedAnswer]:
    """The answers of two reports, as read from their JSON files, scene by scene.

    Parameters
    ----------
    old, new : mapping
        Contents of ``report.json``.

    Returns
    -------
    list of MovedAnswer
        One for each scene and solver that both have.
    """
    earlier = {scene["name"]: scene["runs"] for scene in old["scenes"]}
    return [
        max(_answers(scene["name"], solver, before, run), key=lambda one: one.share)
        for scene in new["scenes"]
        for solver, run in scene["runs"].items()
        if (before := earlier.get(scene["name"], {}).get(solver)) is not None
    ]


def _answers(
    scene: str, solver: str, before: Mapping[str, Any], after: Mapping[str, Any]
) -> Iterator[MovedAnswer]:
    yield MovedAnswer(scene, solver)
    sizes = Magnitudes.of_measures(after)
    for name in OBSERVED:
        was, now = before.get(name), after.get(name)
        if was is None or now is None:
            continue
        size = sizes.scale(name, now)
        difference = abs(was - now) / size if size > 0.0 else 0.0
        if difference > ROUNDING:
            estimates = sum((run.get("error_estimates") or {}).get(name, 0.0) for run in (before, after))
            yield MovedAnswer(scene, solver, name, difference, estimates)


def table(found: Sequence[MovedAnswer]) -> str:
    """As Markdown, a row a scene: the worst of every solver, its share of the estimates, its difference."""
    solvers = list(dict.fromkeys(one.solver for one in found))
    cells = {(one.scene, one.solver): one for one in found}
    lines = [f"| scene | {' | '.join(solvers)} |", "|---" * (len(solvers) + 1) + "|"]
    for scene in dict.fromkeys(one.scene for one in found):
        row = [_cell(cells.get((scene, solver))) for solver in solvers]
        lines.append(f"| {scene} | {' | '.join(row)} |")
    return "\n".join(lines)


def _cell(one: MovedAnswer | None) -> str:
    if one is None:
        return ""
    return f"{one.share:.2g} ({one.quantity} {one.difference:.1e})" if one.quantity else "0"


def main(files: Sequence[str]) -> int:
    """Print the table; the exit code."""
    if len(files) != 2:
        print("usage: python -m validation.compare.moved OLD.json NEW.json", file=sys.stderr)
        return 2
    try:
        found = moved(*(read(file) for file in files))
    except SceneError as error:
        print(f"error: {error}", file=sys.stderr)
        return 2
    print(table(found))
    return 1 if any(one.share > 1.0 for one in found) else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
