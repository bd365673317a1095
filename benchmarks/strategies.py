"""Strategies of hypothesis for scenes: every indenter, step, start and spectrum a scene file can say.

Lengths come from a contact of radius ``WIDTH`` pressed in by ``DEPTH``, forces and the work of adhesion from
the elastic contact of that size, times from decades about 1. The half-space is linear: heights, penetrations
and forces may be scaled together without changing the problem, so more sizes would be no other problems;
units are scaled in a test of their own.
"""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from typing import Any

import numpy as np
from hypothesis import strategies as st

import contact_scene as cs
from contact_scene.checked import Checked, fields_of

WIDTH, DEPTH = 0.2, 0.02
LOAD = 2.0 * WIDTH * DEPTH  # of a flat punch on a half-space of E0* = 1
HELD = DEPTH**2 / (2.0 * math.pi * WIDTH)  # work of adhesion that holds a contact of WIDTH against DEPTH


def shares(low: float, high: float, unit: float = 1.0) -> st.SearchStrategy[float]:
    """Thousandths of a unit, evenly; nothing that is almost zero and not zero."""
    return st.integers(round(1e3 * low), round(1e3 * high)).map(lambda n: 1e-3 * n * unit)


def decades(low: float, high: float) -> st.SearchStrategy[float]:
    """Numbers spread evenly over powers of ten."""
    return shares(low, high).map(lambda k: 10.0**k)


def spectra(most: int = 30, times: tuple[float, float] = (-4.0, 4.0)) -> st.SearchStrategy:
    """Prony branches of a material with ``E0 = 1``: none to many, over decades of time and modulus."""
    branch = st.builds(cs.Branch, decades(-3.0, 1.0), decades(*times))
    few = st.lists(branch, max_size=3)
    many = st.lists(branch, min_size=4, max_size=most) if most > 3 else few
    return st.one_of(few, few, many).map(tuple)


def materials(branches: st.SearchStrategy | None = None) -> st.SearchStrategy[cs.Material]:
    """``E0* = 1`` for every Poisson's ratio: moduli carry ``1 - nu^2``."""
    ratios = st.sampled_from([0.0, 0.3, 0.49, 0.4999, 0.5])

    def build(poisson: float, spectrum: tuple[cs.Branch, ...]) -> cs.Material:
        plane = 1.0 - poisson**2
        return cs.Material(plane, poisson, tuple(cs.Branch(b.modulus * plane, b.time) for b in spectrum))

    return st.builds(build, ratios, spectra() if branches is None else branches)


def modelled() -> st.SearchStrategy[cs.Material]:
    """A power law over four decades above ``E0 = 1``, at some temperature."""

    def build(exponent: float, share: float, time: float, temperature: float) -> cs.Material:
        law = cs.PowerLawRelaxation(exponent, share, time, (1e-2 * time, 1e2 * time), error=0.1, relaxed=1.0)
        return cs.at_temperature(law.material(0.5), cs.WLF(17.44, 51.6, 20.0), temperature)

    return st.builds(build, shares(0.1, 0.7), decades(-1.0, 1.0), decades(-2.0, 2.0), shares(15.0, 25.0))


def rough_tables() -> st.SearchStrategy[cs.TabulatedProfile]:
    """A paraboloid as measured: scattered heights, kept from falling."""

    def build(scatter: list[float]) -> cs.TabulatedProfile:
        radii = np.linspace(0.0, 4.0 * WIDTH, len(scatter) + 1)
        rises = np.diff(DEPTH * (radii / WIDTH) ** 2) * np.array(scatter)
        heights = np.concatenate(([0.0], np.cumsum(rises)))
        return cs.TabulatedProfile(tuple(radii.tolist()), tuple(heights.tolist()))

    return st.lists(shares(0.7, 1.3), min_size=6, max_size=24).map(build)


def indenters() -> st.SearchStrategy:
    """All shapes, as wide as ``WIDTH`` at about ``DEPTH``."""
    angles = shares(0.3, 3.0).map(lambda x: math.degrees(math.atan(x * WIDTH / DEPTH)))
    powers = shares(1.0, 8.0).map(lambda n: cs.PowerLaw(n, DEPTH / WIDTH**n))
    return st.one_of(
        shares(0.3, 3.0, WIDTH**2 / DEPTH).map(cs.Sphere),
        angles.map(cs.Cone),
        st.just(cs.FlatPunch(WIDTH)),
        powers,
        rough_tables(),
    )


def smooth_indenters() -> st.SearchStrategy:
    """Shapes with one equilibrium at a penetration: neither a sharp edge nor the bumps of a table."""
    return indenters().filter(lambda shape: not isinstance(shape, (cs.FlatPunch, cs.TabulatedProfile)))


def adhesions(
    zones: tuple[float, float] = (-1.7, -0.6), strengths: tuple[float, float] = (-4.0, 0.7)
) -> st.SearchStrategy:
    """None, of no work, and of ``strengths`` in decades of ``HELD``; ``zones`` in decades of ``WIDTH``."""
    work = decades(*strengths).map(lambda x: x * HELD)
    zone = decades(*zones).map(lambda x: x * WIDTH)
    sticky = st.builds(cs.Adhesion, work, zone)
    return st.one_of(st.none(), st.builds(cs.Adhesion, st.just(0.0), zone), sticky, sticky, sticky)


def irreversible() -> st.SearchStrategy:
    """Adhesions that close at less than they open, take up more the faster, or have a fixed stress."""
    work = decades(-2.0, 0.3).map(lambda x: x * HELD)
    speeds = decades(-4.0, 2.0).map(lambda v: v * WIDTH)
    powers = st.builds(cs.PowerRate, speeds, shares(0.1, 1.5))

    def table(work: float, speed: float, rises: tuple[float, float]) -> cs.RateTable:
        return cs.RateTable((speed, 1e3 * speed), (rises[0] * work, rises[0] * rises[1] * work))

    def build(work: float, zone: float, share: float, law: cs.PowerRate | tuple | None) -> cs.Adhesion:
        rate = table(work, *law) if isinstance(law, tuple) else law
        return cs.Adhesion(work, zone, share * work, rate)

    laws = st.none() | powers | st.tuples(speeds, st.tuples(shares(1.0, 3.0), shares(1.0, 5.0)))
    zones = decades(-1.4, -0.7).map(lambda x: x * WIDTH)
    pinned = st.builds(build, work, zones, shares(0.02, 1.0), laws)
    stressed = st.builds(
        lambda work, da: cs.Adhesion(work, stress=math.sqrt(math.pi * work / (4.0 * da))), work, zones
    )
    return st.one_of(pinned, pinned, stressed)


DEPTHS = shares(-1.0, 1.5, DEPTH)
FORCES = shares(-0.7, 2.0, LOAD)
SPANS = decades(-4.0, 4.0)  # times that a step takes
RESTS = st.one_of(st.just(0.0), decades(-6.0, 6.0))
SWINGS = decades(-3.0, -0.3).map(lambda x: x * DEPTH)


def oscillation(swing: float, period: float, cycles: float, drift: float) -> cs.Oscillate:
    frequency = 2.0 * math.pi / period
    return cs.Oscillate(swing, frequency, cycles * period, drift * DEPTH / (cycles * period))


def swept(swing: float, duration: float, cycles: float) -> cs.Sweep:
    return cs.Sweep(swing, 4.0 * math.pi * cycles / duration**2, duration)


def _table(rests: list[float], depths: list[float]) -> cs.Table:
    count = min(len(rests), len(depths))
    return cs.Table(tuple(np.cumsum(rests[:count]).tolist()), tuple(depths[:count]))


STEPS: dict[str, st.SearchStrategy] = {
    "ramp": st.builds(lambda to, span: cs.Ramp(to, DEPTH / span), DEPTHS, SPANS),
    "hold": st.builds(cs.Hold, RESTS),
    "force": st.builds(cs.Force, FORCES, RESTS),
    "force-ramp": st.builds(lambda to, span: cs.ForceRamp(to, LOAD / span), FORCES, SPANS),
    "oscillate": st.builds(oscillation, SWINGS, SPANS, shares(0.1, 3.0), shares(-0.5, 0.5)),
    "sweep": st.builds(swept, SWINGS, SPANS, shares(0.1, 3.0)),
    "table": st.builds(
        _table, st.lists(SPANS, min_size=2, max_size=6), st.lists(DEPTHS, min_size=2, max_size=6)
    ),
}


TRIGGERED: dict[str, st.SearchStrategy[cs.Step]] = {
    "ramp to a force": st.builds(
        lambda to, span, until: cs.Ramp(to, DEPTH / span, until_force=until), DEPTHS, SPANS, FORCES
    ),
    "ramp to a radius": st.builds(
        lambda to, span, until: cs.Ramp(to, DEPTH / span, until_radius=until),
        DEPTHS,
        SPANS,
        shares(0.2, 1.5, WIDTH),
    ),
    "hold": st.builds(cs.Hold, RESTS, FORCES),
    "force": st.builds(cs.Force, FORCES, RESTS, DEPTHS),
    "table of forces": st.builds(
        lambda table, forces: cs.Table(
            table.times, tuple(f * LOAD / DEPTH for f in table.values), "", *forces
        ),
        STEPS["table"],
        st.sampled_from([("force", "linear"), ("force", "cubic"), ("penetration", "cubic")]),
    ),
}
"""Steps that end at a level, and tables of another kind than those of ``STEPS``."""


def machines() -> st.SearchStrategy[cs.Machine | None]:
    """Rigid, and springs of any stiffness about that of the contact."""
    return st.one_of(st.none(), decades(-3.0, 3.0).map(lambda x: cs.Machine(x * 2.0 * WIDTH)))


def instruments() -> st.SearchStrategy[cs.Loading]:
    """What only an instrument can do: one to four steps, some of which end at a level, on a machine."""
    steps = st.lists(st.one_of(*STEPS.values(), *TRIGGERED.values()), min_size=1, max_size=4)
    starts = st.sampled_from(["jump-in", "relaxed", "snap-in"])
    return st.builds(cs.Loading, starts, shares(-0.3, 1.0, DEPTH), steps, machines())


def loadings(*kinds: str) -> st.SearchStrategy[cs.Loading]:
    """One to four steps of the given kinds (all, if none is named), from either start."""
    steps = st.lists(st.one_of(*(STEPS[kind] for kind in kinds or STEPS)), min_size=1, max_size=4)
    return st.builds(cs.Loading, st.sampled_from(["jump-in", "relaxed"]), shares(-0.3, 1.0, DEPTH), steps)


def scenes(**parts: st.SearchStrategy) -> st.SearchStrategy[cs.Scene]:
    """Whole scenes; parts may be given."""
    usual = {
        "material": materials(),
        "indenter": indenters(),
        "loading": loadings(),
        "adhesion": adhesions(),
    }
    return st.builds(cs.Scene, **(usual | parts))


def in_units(
    scene: cs.Scene, length: float, modulus: float, time: float
) -> tuple[cs.Scene, dict[str, float]]:
    """The scene in other units (each given in the old ones), and the units of the trace's columns."""
    force = modulus * length**2
    energy = force * length
    energies = dict.fromkeys(("stored_energy", "external_work", "dissipated_energy"), energy)
    columns = {"time": time, "penetration": length, "force": force, "contact_radius": length}
    return _scaled(scene, {"length": length, "force": force, "time": time}), columns | energies


def _scaled(part: Any, units: Mapping[str, float]) -> Any:
    """The same with every number in the unit that its declaration states, as a product of powers."""
    if isinstance(part, tuple):
        return tuple(_scaled(one, units) for one in part)
    if not isinstance(part, Checked):
        return part
    changed = {}
    for name, value in part.stated().items():
        unit = fields_of(type(part))[name].key.unit
        if isinstance(part, cs.Table) and name == "values":
            unit = "force" if part.quantity == "force" else "length"
        elif isinstance(part, cs.PowerLaw) and name == "coefficient":
            unit = f"length{1.0 - part.exponent}"
        powers = [re.fullmatch(r"(length|force|time)(.*)", word) for word in unit.split()]
        size = math.prod(units[one[1]] ** float(one[2] or 1.0) for one in powers if one is not None)
        if isinstance(value, float):
            changed[name] = value * size
        elif isinstance(value, tuple) and value and isinstance(value[0], float):
            changed[name] = tuple(one * size for one in value)
        else:
            changed[name] = _scaled(value, units)
    return type(part)(**changed)
