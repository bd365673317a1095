"""Twelve contacts that start under tension, in SI units: ``python -m benchmarks.starts_under_tension``.

Process zones from a tenth to a millionth of the contact. Printed are start radius, pull-off and work of a
retraction, and what the others differ by from the first solver. Finite elements are left out over zones below
a ten-thousandth, which take them minutes.
"""

from __future__ import annotations

import sys
import time

import numpy as np

from contact_scene import (
    Adhesion,
    Branch,
    Cone,
    Indenter,
    Loading,
    Material,
    PowerLaw,
    Ramp,
    Scene,
    Sphere,
    TabulatedProfile,
)
from validation.measure.observables import observe
from validation.reference.jkr import JKR
from validation.solvers import solver

MATERIALS = {
    "gel, 1 branch": Material(2e4, 0.49, (Branch(1.8e5, 0.1),)),
    "PDMS, 3 branches": Material(1.2e6, 0.5, (Branch(4e5, 1e-3), Branch(3e5, 0.1), Branch(2e5, 10.0))),
    "rubber, 6 branches": Material(5e5, 0.5, tuple(Branch(4e5, 10.0**n) for n in range(-3, 3))),
}
_R = np.linspace(0.0, 4e-4, 41)
SHAPES: dict[str, tuple[Indenter, Indenter]] = {  # with the one whose JKR limit it has
    "sphere 1 mm": (Sphere(1e-3), Sphere(1e-3)),
    "cone 80 deg": (Cone(80.0), Cone(80.0)),
    "r^4": (PowerLaw(4.0, 1e9), PowerLaw(4.0, 1e9)),
    "table": (TabulatedProfile(tuple(_R), tuple(_R**2 / 2e-3)), Sphere(1e-3)),
}
STARTS = (
    ("sphere 1 mm", "gel, 1 branch", 1e-1, 0.3), ("sphere 1 mm", "PDMS, 3 branches", 1e-3, 0.6),
    ("sphere 1 mm", "rubber, 6 branches", 1e-5, 0.9), ("sphere 1 mm", "PDMS, 3 branches", 1e-6, 0.99),
    ("cone 80 deg", "gel, 1 branch", 1e-2, 0.5), ("cone 80 deg", "PDMS, 3 branches", 1e-4, 0.2),
    ("cone 80 deg", "rubber, 6 branches", 1e-6, 0.8), ("r^4", "gel, 1 branch", 1e-2, 0.9),
    ("r^4", "PDMS, 3 branches", 1e-4, 0.5), ("r^4", "rubber, 6 branches", 1e-6, 0.2),
    ("table", "PDMS, 3 branches", 1e-2, 0.7), ("table", "rubber, 6 branches", 1e-5, 0.4),
)  # fmt: skip
WORK = 0.05  # J/m^2
SHORTEST = {"fem": 1e-4}
"""Shortest zone that a solver is asked for, in contact radii."""


def start(shape: str, material: str, share: float, part: float) -> Scene:
    """From that part of the least penetration, pulled off over ten times it in two seconds."""
    indenter, like = SHAPES[shape]
    modulus = MATERIALS[material].relaxed_plane_modulus
    limit = JKR(like, modulus, WORK).pull_off_penetration_control()
    depth = part * limit.penetration
    pull = Ramp(10.0 * limit.penetration, 5.0 * abs(limit.penetration))
    return Scene(
        MATERIALS[material],
        indenter,
        Loading("relaxed", depth, (pull,)),
        Adhesion(WORK, share * limit.contact_radius),
    )


def main(names: list[str]) -> None:
    """Print a line for every start and solver."""
    head = ("shape", "material", "zone/a", "D/D_min", "solver", "a, m", "pull-off, N", "work, J", "s")
    print("{:18}{:20}{:>8}{:>8} {:10}{:>12}{:>13}{:>12}{:>7}".format(*head))
    for case in STARTS:
        scene, known = start(*case), None
        for name in names:
            if case[2] < SHORTEST.get(name, 0.0):
                continue
            began = time.perf_counter()
            trace = solver(name).solve(scene)
            took = time.perf_counter() - began
            told = "{:18}{:20}{:8.0e}{:8.2f} {:10}".format(*case, name)
            if not len(trace):
                print(f"{told} {trace.outcome.reason}", flush=True)
                continue
            seen = observe(trace)
            found = np.array([seen.start_radius, seen.pull_off_force, seen.loop_energy], float)
            apart = "" if known is None else "  " + " ".join(f"{x:+.1e}" for x in found / known - 1.0)
            known = found if known is None else known
            print(told + "{:12.5e}{:13.5e}{:12.4e}{:7.1f}".format(*found, took) + apart, flush=True)


if __name__ == "__main__":
    main(sys.argv[1:] or ["reference", "bem", "fem"])
