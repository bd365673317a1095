"""The map behind ``docs/explanation/small-scale.md``: ``python -m benchmarks.small_scale FILE [--points N]``.

A contact that rests until all has relaxed is pulled off. A point of the map is the ratio ``k`` of relaxed
and glassy modulus, the radius at rest over the threshold radius, the process zone over it, the exponent of
the indenter and ``N = V tau/Delta``, where ``Delta`` is how far the frozen contact is withdrawn until its
pull-off. Four runs of the batch solver make it: as asked, with a zone of a millionth of the radius at the
same speed over the zone, frozen, and pressed in at the same speed instead of rested; what it leaves open the
reference solves. ``FILE`` (.npz) receives their forces, and lengths of the contact.

``--check N``: solve N points of a file again by each solver, of those with zones that all resolve fast.
"""

from __future__ import annotations

import argparse
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from scipy.stats import qmc

from contact_scene import Adhesion, Branch, Loading, Material, PowerLaw, Ramp, Scene, SceneError
from validation.reference.batch import Solution, solve
from validation.reference.frozen import FrozenRetraction
from validation.reference.jkr import JKR
from validation.reference.sneddon import shape_factor
from validation.solvers import SOLVERS

RANGES = {
    "k": (0.005, 0.5),
    "reach": (0.5, 3.0),
    "zone": (1e-4, 3e-2),
    "N": (0.05, 20.0),
    "exponent": (1.0, 6.0),
}
"""What is drawn, even in the logarithm but for the exponent."""
RUNS = "force", "small", "frozen", "cycle"
"""Pull-off forces over that of JKR and the relaxed modulus."""
LENGTHS = "pull", "griffith", "depth"
"""``Delta``, the pull that brings the edge of the frozen contact to the glassy Griffith limit, and the
penetration at rest, all over the radius at rest."""
THRESHOLD, SMALL, FROZEN = 0.1, 1e-6, 1e3
"""Threshold radius, and penetration over it, of every point; zone over radius of the small-scale limit, and
``N`` of the frozen one."""
TOGETHER = 512
"""Points solved together."""
CHECKED = 3e-3
"""Shortest zone over radius of the points that are checked."""


@dataclass(frozen=True)
class Point:
    """A contact of relaxed plane modulus and relaxation time one."""

    k: float
    reach: float
    zone: float
    N: float
    exponent: float

    @property
    def indenter(self) -> PowerLaw:
        """Of penetration ``THRESHOLD^2`` at the threshold radius without adhesion."""
        return PowerLaw(self.exponent, THRESHOLD ** (2.0 - self.exponent) / shape_factor(self.exponent))

    @property
    def work(self) -> float:
        """By ``w/k`` an elastic contact of the relaxed modulus comes off at the threshold radius."""
        unit = JKR(self.indenter, 1.0, 1.0).pull_off_force_control().contact_radius
        return self.k * (THRESHOLD / unit) ** (2.0 * self.exponent - 1.0)

    @property
    def at_rest(self) -> FrozenRetraction:
        """The contact, and how it comes off frozen."""
        material = Material(0.75, 0.5, (Branch(0.75 * (1.0 / self.k - 1.0), 1.0),))
        depth = JKR(self.indenter, 1.0, self.work).penetration(self.reach * THRESHOLD)
        return FrozenRetraction(material, self.indenter, self.work, float(depth))

    def scenes(self, contact: FrozenRetraction) -> list[Scene]:
        """Of the four runs; of three where nothing presses the contact that rests."""
        radius, pull = self.reach * THRESHOLD, contact.start - contact.pull_off().penetration
        rate, end = self.N * pull, min(0.0, contact.start) - 50.0 * pull - 10.0 * radius
        found = []
        for zone, speed in ((self.zone, rate), (SMALL, rate * SMALL / self.zone), (self.zone, FROZEN * pull)):
            loading = Loading("relaxed", contact.start, (Ramp(end, speed),))
            adhesion = Adhesion(self.work, zone * radius)
            found.append(Scene(contact.material, self.indenter, loading, adhesion))
        if contact.start > 0.0:
            pressed = Loading("jump-in", 0.0, (Ramp(contact.start, rate), Ramp(end, rate)))
            found.append(replace(found[0], loading=pressed))
        return found

    @property
    def unit(self) -> float:
        """JKR's pull-off force by the relaxed modulus."""
        return -JKR(self.indenter, 1.0, self.work).pull_off_force_control().force


def drawn(count: int) -> list[Point]:
    """Points of a Sobol sample."""
    shares = qmc.Sobol(len(RANGES), seed=1).random_base2((count - 1).bit_length())[:count]
    low, high = np.array(list(RANGES.values())).T
    values = low * (high / low) ** shares
    values[:, -1] = low[-1] + (high - low)[-1] * shares[:, -1]
    return [Point(*row) for row in values.tolist()]


def pull_off_force(scene: Scene, answer: Solution) -> float:
    """Of an answer; without one by the reference, not a number where contact begins shorter than its zone."""
    if answer.answered:
        return answer.pull_off_force
    try:
        return -float(SOLVERS["reference"].solve(scene).force.min())
    except SceneError:
        return np.nan


def solved(points: list[Point]) -> dict[str, np.ndarray]:
    """Columns of the file; not a number where there is no cycle."""
    rows = []
    for first in range(0, len(points), TOGETHER):
        some = points[first : first + TOGETHER]
        contacts = [point.at_rest for point in some]
        scenes = [point.scenes(contact) for point, contact in zip(some, contacts, strict=True)]
        answers = iter(solve([scene for each in scenes for scene in each]))
        for point, contact, each in zip(some, contacts, scenes, strict=True):
            forces = [pull_off_force(scene, next(answers)) / point.unit for scene in each]
            forces += [np.nan] * (len(RUNS) - len(each))
            states = contact.pull_off().penetration, contact.release().penetration, 0.0
            lengths = [(contact.start - one) / (point.reach * THRESHOLD) for one in states]
            rows.append([*vars(point).values(), *forces, *lengths])
        print(f"{len(rows)} of {len(points)}", flush=True)
    columns = np.array(rows, np.float32).T
    return dict(zip((*RANGES, *RUNS, *LENGTHS), columns, strict=True))


def check(file: Path, count: int) -> None:
    """Print how far each solver is from the rows of a file."""
    with np.load(file) as kept:
        columns = dict(kept)
    rows = np.flatnonzero((columns["zone"] > CHECKED) & np.isfinite(columns["force"]))
    for row in rows[np.linspace(0, len(rows) - 1, count).astype(int)]:
        point = Point(*(float(columns[name][row]) for name in RANGES))
        scene, told = point.scenes(point.at_rest)[0], columns["force"][row] * point.unit
        apart = {name: -SOLVERS[name].solve(scene).force.min() / told - 1.0 for name in SOLVERS}
        print(point, *(f"{name} {value:.1e}" for name, value in apart.items()), flush=True)


def main() -> None:
    """Make the map, or check one."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("file", type=Path)
    parser.add_argument("--points", type=int, default=20_000)
    parser.add_argument("--check", type=int, default=0)
    asked = parser.parse_args()
    if asked.check:
        check(asked.file, asked.check)
    else:
        columns: dict[str, Any] = solved(drawn(asked.points))
        np.savez_compressed(asked.file, **columns)


if __name__ == "__main__":
    main()
