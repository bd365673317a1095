"""Scenes in SI units that have been hard for one of the solvers, as a family of random scenes draws them.

``python -m benchmarks.random_matrix --family hard`` runs them: presses without adhesion, with branches far
faster than the run, and withdrawals from starts under tension, with process zones from a tenth to a millionth
of the contact.
"""

from __future__ import annotations

import math

import numpy as np

from contact_scene import (
    Adhesion,
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
)
from validation.reference.jkr import JKR


def power_law_gel(first: float) -> Material:
    """``E(t) ~ t^-0.3`` from a time to 1000 s, two branches a decade, on 200 Pa."""
    last, modulus = 1e3, 200.0
    count = 2 * round(math.log10(last / first)) + 1
    times = [first * (last / first) ** (k / (count - 1)) for k in range(count)]
    return Material(modulus, 0.5, tuple(Branch(modulus * (last / t) ** 0.3 / 4.0, t) for t in times))


def rubber(fastest: float) -> Material:
    """A rubber of 1 MPa with three branches from ``fastest`` on."""
    return Material(1e6, 0.49, tuple(Branch(2e6, fastest * 30.0**k) for k in range(3)))


def gel(fastest: float) -> Material:
    """A gel of 5 kPa with one branch, nine times as stiff."""
    return Material(5e3, 0.5, (Branch(4.5e4, fastest),))


def press(
    material: Material,
    indenter: Indenter,
    depth: float,
    speed: float,
    *between: Step,
    machine: Machine | None = None,
) -> Scene:
    """Pressed in from just above the surface, and pulled off."""
    steps = (Ramp(depth, speed), *between, Ramp(-depth, speed))
    return Scene(material, indenter, Loading("relaxed", -0.1 * depth, steps, machine))


def loaded(material: Material, indenter: Indenter, start: float, *steps: Step) -> Scene:
    """From the relaxed state at a penetration on."""
    return Scene(material, indenter, Loading("relaxed", start, steps))


WORN = TabulatedProfile((0.0, 2e-5, 5e-5, 1e-4, 3e-4), (0.0, 2e-7, 2e-6, 1.2e-5, 1.2e-4))
SINE = Table(
    tuple(k * 0.125 for k in range(9)),
    tuple(2e-6 * math.sin(k * math.pi / 16) ** 2 - 1e-7 * (k == 0) for k in range(9)),
    interpolation="cubic",
)
BEAD, TIP = Sphere(1e-5), Sphere(2e-5)
PRESSES: dict[str, Scene] = {
    **{f"power gel {t:g}": press(power_law_gel(t), BEAD, 5e-7, 1e-7) for t in (1e-8, 1e-7, 1e-6, 3e-6, 1e-2)},
    "bead 1um gel": press(gel(1e-7), Sphere(1e-6), 5e-8, 1e-8),
    "bead 1um gel held": press(gel(1e-6), Sphere(1e-6), 5e-8, 1e-7, Hold(1.0)),
    "bead 100um gel": press(gel(1e-5), Sphere(1e-4), 5e-6, 1e-6),
    "bead 5mm rubber": press(rubber(1e-6), Sphere(5e-3), 1e-4, 1e-5),
    "bead 5mm rubber fast": press(rubber(1e-9), Sphere(5e-3), 1e-4, 1e-2),
    "bead 5mm rubber reload": press(
        rubber(1e-7), Sphere(5e-3), 5e-5, 1e-5, Ramp(3e-5, 1e-5), Ramp(1e-4, 1e-5)
    ),
    "bead 1mm rubber swung": press(rubber(1e-8), Sphere(1e-3), 2e-5, 1e-5, Oscillate(2e-6, 6.283, 2.0)),
    "bead 20um gel spring": press(gel(1e-8), TIP, 1e-6, 1e-6, machine=Machine(0.05)),
    "bead 20um gel trigger": loaded(
        gel(1e-8), TIP, -2e-7, Ramp(2e-6, 1e-6, until_force=2e-8), Ramp(-1e-6, 1e-6)
    ),
    "bead 20um gel force": loaded(gel(1e-8), TIP, 0.0, ForceRamp(2e-8, 2e-8), ForceRamp(-1e-9, 2e-8)),
    "cone gel": press(gel(1e-8), Cone(70.0), 2e-6, 1e-6),
    "cone rubber": press(rubber(1e-9), Cone(80.0), 2e-5, 1e-4),
    "cone rubber force": loaded(rubber(1e-8), Cone(80.0), 0.0, ForceRamp(1e-3, 1e-3), ForceRamp(-1e-4, 1e-3)),
    "punch gel": press(gel(1e-8), FlatPunch(5e-6), 5e-7, 1e-7),
    "punch rubber held": press(rubber(1e-8), FlatPunch(5e-4), 1e-5, 1e-5, Hold(1.0)),
    "blunt rubber": press(rubber(1e-8), PowerLaw(4.0, 1e9), 1e-5, 1e-5),
    "profile gel": press(gel(1e-7), WORN, 4e-6, 1e-6),
    "bead 50um gel table": loaded(gel(1e-6), Sphere(5e-5), -1e-7, SINE, Ramp(-1e-6, 2e-6)),
}

MATERIALS = {
    "gel": Material(2e4, 0.49, (Branch(1.8e5, 0.1),)),
    "PDMS": Material(1.2e6, 0.5, (Branch(4e5, 1e-3), Branch(3e5, 0.1), Branch(2e5, 10.0))),
    "rubber": Material(5e5, 0.5, tuple(Branch(4e5, 10.0**n) for n in range(-3, 3))),
}
_R = np.linspace(0.0, 4e-4, 41)
SHAPES: dict[str, tuple[Indenter, Indenter]] = {  # with the one whose JKR limit it has
    "sphere": (Sphere(1e-3), Sphere(1e-3)),
    "cone": (Cone(80.0), Cone(80.0)),
    "r^4": (PowerLaw(4.0, 1e9), PowerLaw(4.0, 1e9)),
    "table": (TabulatedProfile(tuple(_R), tuple(_R**2 / 2e-3)), Sphere(1e-3)),
}
STARTS = (  # shape, material, zone over contact radius, part of the least penetration
    ("sphere", "gel", 1e-1, 0.3), ("sphere", "PDMS", 1e-3, 0.6), ("sphere", "rubber", 1e-5, 0.9),
    ("sphere", "PDMS", 1e-6, 0.99), ("cone", "gel", 1e-2, 0.5), ("cone", "PDMS", 1e-4, 0.2),
    ("cone", "rubber", 1e-6, 0.8), ("r^4", "gel", 1e-2, 0.9), ("r^4", "PDMS", 1e-4, 0.5),
    ("r^4", "rubber", 1e-6, 0.2), ("table", "PDMS", 1e-2, 0.7), ("table", "rubber", 1e-5, 0.4),
)  # fmt: skip


def start(shape: str, material: str, share: float, part: float) -> Scene:
    """From that part of the least penetration, pulled off over ten times it in two seconds."""
    indenter, like = SHAPES[shape]
    work = 0.05  # J/m^2
    limit = JKR(like, MATERIALS[material].relaxed_plane_modulus, work).pull_off_penetration_control()
    pull = Ramp(10.0 * limit.penetration, 5.0 * abs(limit.penetration))
    loading = Loading("relaxed", part * limit.penetration, (pull,))
    return Scene(MATERIALS[material], indenter, loading, Adhesion(work, share * limit.contact_radius))


HARD = (*PRESSES.items(), *((" ".join(map(str, one)), start(*one)) for one in STARTS))
"""Name and scene of each."""
