"""Scenes in SI units that have been hard for one of the solvers, as a family of random scenes draws them.

``python -m benchmarks.random_matrix --family hard`` runs them: presses without adhesion, with branches far
faster than the run, and withdrawals from starts under tension, with process zones from a tenth to a millionth
of the contact.
"""

from __future__ import annotations

import math

import numpy as np

import contact_scene as cs
from validation.reference.jkr import JKR


def power_law_gel(first: float) -> cs.Material:
    """``E(t) ~ t^-0.3`` from a time to 1000 s, two branches a decade, on 200 Pa."""
    last, modulus = 1e3, 200.0
    count = 2 * round(math.log10(last / first)) + 1
    times = [first * (last / first) ** (k / (count - 1)) for k in range(count)]
    return cs.Material(modulus, 0.5, tuple(cs.Branch(modulus * (last / t) ** 0.3 / 4.0, t) for t in times))


def rubber(fastest: float) -> cs.Material:
    """A rubber of 1 MPa with three branches from ``fastest`` on."""
    return cs.Material(1e6, 0.49, tuple(cs.Branch(2e6, fastest * 30.0**k) for k in range(3)))


def gel(fastest: float) -> cs.Material:
    """A gel of 5 kPa with one branch, nine times as stiff."""
    return cs.Material(5e3, 0.5, (cs.Branch(4.5e4, fastest),))


def press(
    material: cs.Material,
    indenter: cs.Indenter,
    depth: float,
    speed: float,
    *between: cs.Step,
    machine: cs.Machine | None = None,
) -> cs.Scene:
    """Pressed in from just above the surface, and pulled off."""
    steps = (cs.Ramp(depth, speed), *between, cs.Ramp(-depth, speed))
    return cs.Scene(material, indenter, cs.Loading("relaxed", -0.1 * depth, steps, machine))


def loaded(material: cs.Material, indenter: cs.Indenter, start: float, *steps: cs.Step) -> cs.Scene:
    """From the relaxed state at a penetration on."""
    return cs.Scene(material, indenter, cs.Loading("relaxed", start, steps))


WORN = cs.TabulatedProfile((0.0, 2e-5, 5e-5, 1e-4, 3e-4), (0.0, 2e-7, 2e-6, 1.2e-5, 1.2e-4))
SINE = cs.Table(
    tuple(k * 0.125 for k in range(9)),
    tuple(2e-6 * math.sin(k * math.pi / 16) ** 2 - 1e-7 * (k == 0) for k in range(9)),
    interpolation="cubic",
)
BEAD, TIP = cs.Sphere(1e-5), cs.Sphere(2e-5)
PRESSES: dict[str, cs.Scene] = {
    **{f"power gel {t:g}": press(power_law_gel(t), BEAD, 5e-7, 1e-7) for t in (1e-8, 1e-7, 1e-6, 3e-6, 1e-2)},
    "bead 1um gel": press(gel(1e-7), cs.Sphere(1e-6), 5e-8, 1e-8),
    "bead 1um gel held": press(gel(1e-6), cs.Sphere(1e-6), 5e-8, 1e-7, cs.Hold(1.0)),
    "bead 100um gel": press(gel(1e-5), cs.Sphere(1e-4), 5e-6, 1e-6),
    "bead 5mm rubber": press(rubber(1e-6), cs.Sphere(5e-3), 1e-4, 1e-5),
    "bead 5mm rubber fast": press(rubber(1e-9), cs.Sphere(5e-3), 1e-4, 1e-2),
    "bead 5mm rubber reload": press(
        rubber(1e-7), cs.Sphere(5e-3), 5e-5, 1e-5, cs.Ramp(3e-5, 1e-5), cs.Ramp(1e-4, 1e-5)
    ),
    "bead 1mm rubber swung": press(rubber(1e-8), cs.Sphere(1e-3), 2e-5, 1e-5, cs.Oscillate(2e-6, 6.283, 2.0)),
    "bead 20um gel spring": press(gel(1e-8), TIP, 1e-6, 1e-6, machine=cs.Machine(0.05)),
    "bead 20um gel trigger": loaded(
        gel(1e-8), TIP, -2e-7, cs.Ramp(2e-6, 1e-6, until_force=2e-8), cs.Ramp(-1e-6, 1e-6)
    ),
    "bead 20um gel force": loaded(gel(1e-8), TIP, 0.0, cs.ForceRamp(2e-8, 2e-8), cs.ForceRamp(-1e-9, 2e-8)),
    "cone gel": press(gel(1e-8), cs.Cone(70.0), 2e-6, 1e-6),
    "cone rubber": press(rubber(1e-9), cs.Cone(80.0), 2e-5, 1e-4),
    "cone rubber force": loaded(
        rubber(1e-8), cs.Cone(80.0), 0.0, cs.ForceRamp(1e-3, 1e-3), cs.ForceRamp(-1e-4, 1e-3)
    ),
    "punch gel": press(gel(1e-8), cs.FlatPunch(5e-6), 5e-7, 1e-7),
    "punch rubber held": press(rubber(1e-8), cs.FlatPunch(5e-4), 1e-5, 1e-5, cs.Hold(1.0)),
    "blunt rubber": press(rubber(1e-8), cs.PowerLaw(4.0, 1e9), 1e-5, 1e-5),
    "profile gel": press(gel(1e-7), WORN, 4e-6, 1e-6),
    "bead 50um gel table": loaded(gel(1e-6), cs.Sphere(5e-5), -1e-7, SINE, cs.Ramp(-1e-6, 2e-6)),
}

MATERIALS = {
    "gel": cs.Material(2e4, 0.49, (cs.Branch(1.8e5, 0.1),)),
    "PDMS": cs.Material(1.2e6, 0.5, (cs.Branch(4e5, 1e-3), cs.Branch(3e5, 0.1), cs.Branch(2e5, 10.0))),
    "rubber": cs.Material(5e5, 0.5, tuple(cs.Branch(4e5, 10.0**n) for n in range(-3, 3))),
}
_R = np.linspace(0.0, 4e-4, 41)
SHAPES: dict[str, tuple[cs.Indenter, cs.Indenter]] = {  # with the one whose JKR limit it has
    "sphere": (cs.Sphere(1e-3), cs.Sphere(1e-3)),
    "cone": (cs.Cone(80.0), cs.Cone(80.0)),
    "r^4": (cs.PowerLaw(4.0, 1e9), cs.PowerLaw(4.0, 1e9)),
    "table": (cs.TabulatedProfile(tuple(_R), tuple(_R**2 / 2e-3)), cs.Sphere(1e-3)),
}
STARTS = (  # shape, material, zone over contact radius, part of the least penetration
    ("sphere", "gel", 1e-1, 0.3), ("sphere", "PDMS", 1e-3, 0.6), ("sphere", "rubber", 1e-5, 0.9),
    ("sphere", "PDMS", 1e-6, 0.99), ("cone", "gel", 1e-2, 0.5), ("cone", "PDMS", 1e-4, 0.2),
    ("cone", "rubber", 1e-6, 0.8), ("r^4", "gel", 1e-2, 0.9), ("r^4", "PDMS", 1e-4, 0.5),
    ("r^4", "rubber", 1e-6, 0.2), ("table", "PDMS", 1e-2, 0.7), ("table", "rubber", 1e-5, 0.4),
)  # fmt: skip


def start(shape: str, material: str, share: float, part: float) -> cs.Scene:
    """From that part of the least penetration, pulled off over ten times it in two seconds."""
    indenter, like = SHAPES[shape]
    work = 0.05  # J/m^2
    limit = JKR(like, MATERIALS[material].relaxed_plane_modulus, work).pull_off_penetration_control()
    pull = cs.Ramp(10.0 * limit.penetration, 5.0 * abs(limit.penetration))
    loading = cs.Loading("relaxed", part * limit.penetration, (pull,))
    return cs.Scene(MATERIALS[material], indenter, loading, cs.Adhesion(work, share * limit.contact_radius))


HARD = (*PRESSES.items(), *((" ".join(map(str, one)), start(*one)) for one in STARTS))
"""Name and scene of each."""
