"""A process zone of fixed stress against Lennard-Jones tractions: pull-off force over speed, ``python -m``.

``python -m benchmarks.lennard_jones`` withdraws a sphere from rest on a standard linear solid, by
Lennard-Jones tractions (:mod:`benchmarks.lennard_jones_sphere`), by the reference with ``stress = s``, the
largest tension of that law, and by the reference with a zone of the fixed length it has at rest. The process
zone is a model of the traction: the differences are of the models.
"""

from __future__ import annotations

import argparse
import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product

import numpy as np

from benchmarks.lennard_jones_sphere import LennardJonesSphere
from contact_scene import Adhesion, Branch, Loading, Material, Ramp, Scene, Sphere
from validation.solvers import REFERENCE, SOLVERS

WORK, DEPTH, RATIO = 5.026548e-4, 0.032, 10.0
"""Work of adhesion and start penetration of the paper's cycles; glassy over relaxed modulus."""
TABOR = (3.0, 5.0, 10.0)
SPEEDS = (6e-4, 2e-3, 6e-3, 2e-2, 6e-2, 0.2)
AWAY = -0.5
"""Penetration by which contact is lost at any speed."""


@dataclass(frozen=True)
class PullOffComparison:
    """Pull-off forces of one withdrawal by the three, in ``pi w R``."""

    lennard_jones: float
    fixed_stress: float
    fixed_length: float

    @property
    def differences(self) -> tuple[float, float]:
        """Of fixed stress and of fixed length, relative to Lennard-Jones."""
        return self.fixed_stress / self.lennard_jones - 1.0, self.fixed_length / self.lennard_jones - 1.0


def material(ratio: float = RATIO) -> Material:
    """``E0* = 1``, one branch of time 1; elastic where the ratio is 1."""
    return Material(0.75, 0.5, (Branch(0.75 * (ratio - 1.0), 1.0),) if ratio > 1.0 else ())


def compared(
    tabor: float, speed: float, ratio: float = RATIO, resolution: int | None = None, divisions: int = 4
) -> PullOffComparison:
    """One withdrawal at Tabor's parameter and a speed in radii per relaxation time."""
    law = LennardJonesSphere(material(ratio), 1.0, WORK, math.cbrt(WORK**2) / tabor)
    unit = math.pi * WORK

    def by_zone(adhesion: Adhesion) -> float:
        loading = Loading("relaxed", DEPTH, (Ramp(AWAY, speed),))
        scene = Scene(law.material, Sphere(1.0), loading, adhesion)
        return -float(SOLVERS[REFERENCE].solve(scene, resolution).force.min()) / unit

    return PullOffComparison(
        law.pull_off(DEPTH, speed, divisions).force / unit,
        by_zone(Adhesion(WORK, stress=law.stress)),
        by_zone(Adhesion(WORK, law.zone_at_rest)),
    )


def main(arguments: Sequence[str] | None = None) -> None:
    """Print a row for each withdrawal, and the mean size of the differences with its deviation."""
    parser = argparse.ArgumentParser(description="fixed cohesive stress against Lennard-Jones tractions")
    parser.add_argument("--tabor", type=float, nargs="+", default=TABOR)
    parser.add_argument("--speed", type=float, nargs="+", default=SPEEDS, help="radii per relaxation time")
    parser.add_argument("--ratio", type=float, default=RATIO, help="glassy over relaxed modulus; 1: elastic")
    parser.add_argument("--resolution", type=int, help="of the reference")
    chosen = parser.parse_args(arguments)
    print("| Tabor | speed | Lennard-Jones | fixed stress | | fixed length | |\n" + "|---" * 7 + "|")
    found = []
    for tabor, speed in product(chosen.tabor, chosen.speed):
        row = compared(tabor, speed, chosen.ratio, chosen.resolution)
        stress, length = row.differences
        found.append((abs(stress), abs(length)))
        print(
            f"| {tabor:g} | {speed:g} | {row.lennard_jones:.3f} | {row.fixed_stress:.3f} "
            f"| {100 * stress:+.1f} % | {row.fixed_length:.3f} | {100 * length:+.1f} % |",
            flush=True,
        )
    for kind, sizes in zip(("stress", "length"), 100.0 * np.array(found).T, strict=True):
        print(f"Mean difference, fixed {kind}: {sizes.mean():.0f} % (sd {sizes.std():.0f} %)")


if __name__ == "__main__":
    main()
