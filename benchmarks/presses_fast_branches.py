"""Presses without adhesion, in SI units, with branches far faster than the run: the solvers side by side.

``python -m benchmarks.presses_fast_branches [NAME ...]`` prints largest force and radius, when contact
is lost, and by how much boundary and finite elements differ from the reference in each.
"""

from __future__ import annotations

import math
import sys
import time

from contact_scene import (
    Branch,
    Cone,
    FlatPunch,
    ForceRamp,
    Hold,
    Indenter,
    Loading,
    Machine,
    Material,
    Oscillate,
    PowerLaw,
    Ramp,
    Scene,
    Sphere,
    Step,
    Table,
    TabulatedProfile,
    Trace,
)
from validation import solvers


def power_law_gel(modulus: float, exponent: float = 0.3, first: float = 1e-6, last: float = 1e3) -> Material:
    """``E(t) ~ t^-exponent`` between two times, two branches a decade, on a modulus as at the last time."""
    count = 2 * round(math.log10(last / first)) + 1
    times = [first * (last / first) ** (k / (count - 1)) for k in range(count)]
    return Material(modulus, 0.5, tuple(Branch(modulus * (last / t) ** exponent / 4.0, t) for t in times))


def rubber(fastest: float) -> Material:
    """A rubber of 1 MPa with three branches from ``fastest`` on."""
    return Material(1e6, 0.49, tuple(Branch(2e6, fastest * 30.0**k) for k in range(3)))


def gel(fastest: float) -> Material:
    """A gel of 5 kPa with one branch, nine times as stiff."""
    return Material(5e3, 0.5, (Branch(4.5e4, fastest),))


def press(
    material: Material, indenter: Indenter, depth: float, speed: float, *between: Step, **more: object
) -> Scene:
    """Pressed in from just above the surface, and pulled off."""
    steps = (Ramp(depth, speed), *between, Ramp(-depth, speed))
    return Scene(material, indenter, Loading("relaxed", -0.1 * depth, steps, **more))  # type: ignore[arg-type]


WORN = TabulatedProfile((0.0, 2e-5, 5e-5, 1e-4, 3e-4), (0.0, 2e-7, 2e-6, 1.2e-5, 1.2e-4))
SINE = Table(
    tuple(k * 0.125 for k in range(9)),
    tuple(2e-6 * math.sin(k * math.pi / 16) ** 2 - 1e-7 * (k == 0) for k in range(9)),
    interpolation="cubic",
)
SCENES: dict[str, Scene] = {
    "bead 10um power gel 1e-7": press(power_law_gel(200.0), Sphere(1e-5), 5e-7, 1e-7),
    "bead 10um power gel 1e-6": press(power_law_gel(200.0), Sphere(1e-5), 5e-7, 1e-6),
    "bead 10um power gel 3e-6": press(power_law_gel(200.0), Sphere(1e-5), 5e-7, 3e-6),
    "bead 10um power gel 1e-5": press(power_law_gel(200.0), Sphere(1e-5), 5e-7, 1e-5),
    "bead 10um power gel 1e-8": press(power_law_gel(200.0), Sphere(1e-5), 5e-7, 1e-8),
    "bead 10um power gel 1e-2": press(power_law_gel(200.0), Sphere(1e-5), 5e-7, 1e-2),
    "bead 1um gel": press(gel(1e-7), Sphere(1e-6), 5e-8, 1e-8),
    "bead 1um gel held": press(gel(1e-6), Sphere(1e-6), 5e-8, 1e-7, Hold(1.0)),
    "bead 100um gel": press(gel(1e-5), Sphere(1e-4), 5e-6, 1e-6),
    "bead 5mm rubber": press(rubber(1e-6), Sphere(5e-3), 1e-4, 1e-5),
    "bead 5mm rubber fast": press(rubber(1e-9), Sphere(5e-3), 1e-4, 1e-2),
    "bead 5mm rubber reload": press(
        rubber(1e-7), Sphere(5e-3), 5e-5, 1e-5, Ramp(3e-5, 1e-5), Ramp(1e-4, 1e-5)
    ),
    "bead 1mm rubber swung": press(rubber(1e-8), Sphere(1e-3), 2e-5, 1e-5, Oscillate(2e-6, 6.283, 2.0)),
    "bead 20um gel spring": press(gel(1e-8), Sphere(2e-5), 1e-6, 1e-6, machine=Machine(0.05)),
    "bead 20um gel trigger": Scene(
        gel(1e-8),
        Sphere(2e-5),
        Loading("relaxed", -2e-7, (Ramp(2e-6, 1e-6, until_force=2e-8), Ramp(-1e-6, 1e-6))),
    ),
    "bead 20um gel force": Scene(
        gel(1e-8), Sphere(2e-5), Loading("relaxed", 0.0, (ForceRamp(2e-8, 2e-8), ForceRamp(-1e-9, 2e-8)))
    ),
    "cone gel": press(gel(1e-8), Cone(70.0), 2e-6, 1e-6),
    "cone rubber": press(rubber(1e-9), Cone(80.0), 2e-5, 1e-4),
    "cone rubber force": Scene(
        rubber(1e-8), Cone(80.0), Loading("relaxed", 0.0, (ForceRamp(1e-3, 1e-3), ForceRamp(-1e-4, 1e-3)))
    ),
    "punch gel": press(gel(1e-8), FlatPunch(5e-6), 5e-7, 1e-7),
    "punch rubber held": press(rubber(1e-8), FlatPunch(5e-4), 1e-5, 1e-5, Hold(1.0)),
    "blunt rubber": press(rubber(1e-8), PowerLaw(4.0, 1e9), 1e-5, 1e-5),
    "profile gel": press(gel(1e-7), WORN, 4e-6, 1e-6),
    "bead 50um gel table": Scene(
        gel(1e-6), Sphere(5e-5), Loading("relaxed", -1e-7, (SINE, Ramp(-1e-6, 2e-6)))
    ),
}


def cells(trace: Trace) -> tuple[str, float, float, float]:
    """Outcome, largest force and radius, and the time at which the run ends."""
    return (
        str(trace.outcome.kind),
        float(trace.force.max()),
        float(trace.contact_radius.max()),
        float(trace.time[-1]),
    )


def main(names: list[str]) -> None:
    """Print the rows of some scenes, of all without names."""
    for name in names or SCENES:
        base: tuple[str, float, float, float] | None = None
        for solver in ("reference", "bem", "fem"):
            begin = time.perf_counter()
            try:
                found = cells(solvers.solver(solver).solve(SCENES[name]))
            except Exception as error:
                print(f"{name:26} {solver:9} {type(error).__name__}: {error}"[:150], flush=True)
                continue
            base = base or found
            apart = [abs(one - other) / abs(other) for one, other in zip(found[1:], base[1:], strict=True)]
            print(
                f"{name:26} {solver:9} {found[0]:9} F {found[1]:.6e} a {found[2]:.6e} t {found[3]:.6e}  "
                + " ".join(f"{one:7.1e}" for one in apart)
                + f"  {time.perf_counter() - begin:5.1f} s",
                flush=True,
            )


if __name__ == "__main__":
    main(sys.argv[1:])
