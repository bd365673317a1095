"""Every invariant with the strategy of its arguments and its numbers of examples."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from hypothesis import strategies as st
from support.invariants import checks

from benchmarks.strategies import (
    DEPTH,
    adhesions,
    decades,
    in_units,
    indenters,
    instruments,
    irreversible,
    materials,
    modelled,
    scenes,
    shares,
    smooth_indenters,
    spectra,
)
from contact_scene import FlatPunch, Loading, PowerLaw, Scene, Table


@dataclass(frozen=True)
class Invariant:
    """A check, the strategy of its arguments, and the number of examples by default and in the slow suite."""

    check: Callable[..., None]
    arguments: st.SearchStrategy[tuple]
    examples: int
    slow_examples: int


ZONES = (-1.4, -0.7)
ANY = scenes(adhesion=adhesions(ZONES))
ONE = st.tuples(ANY)
"""Of the invariants that are asked of the same examples: as many of each, so that none is solved twice."""
PRESSED = shares(0.3, 1.5, DEPTH)
CALM = scenes(
    material=materials(spectra(6, (-2.0, 2.0))),
    indenter=smooth_indenters(),
    adhesion=adhesions(ZONES, (-3.0, 0.0)),
    loading=st.builds(Loading, st.just("relaxed"), PRESSED),
)


def _cycles() -> st.SearchStrategy[Loading]:
    """Around and back, through one or two corners."""

    def build(start: float, corners: list[float], span: float) -> Loading:
        depths = (start, *corners, start)
        times = tuple(span * i for i in range(len(depths)))
        return Loading("relaxed", start, (Table(times, depths),))

    return st.builds(build, PRESSED, st.lists(PRESSED, min_size=1, max_size=2), decades(-2.0, 2.0))


def _histories() -> st.SearchStrategy[tuple]:
    """Common times, two rows of penetrations, and the shares they are added with."""

    def build(rises: list[float], rows: list[tuple[float, float]], shares: tuple[float, float]) -> tuple:
        count = min(len(rises), len(rows))
        times = [0.0]
        for rise in rises[1:count]:
            times.append(times[-1] + rise)
        return tuple(times), [r[0] for r in rows[:count]], [r[1] for r in rows[:count]], shares

    row = st.tuples(shares(-1.0, 1.5, DEPTH), shares(-1.0, 1.5, DEPTH))
    size = {"min_size": 2, "max_size": 5}
    parts = st.tuples(shares(-1.0, 1.0), shares(-1.0, 1.0))
    return st.builds(build, st.lists(decades(-2.0, 2.0), **size), st.lists(row, **size), parts)


def _with_units(scene: Scene, length: float, modulus: float, time: float) -> tuple:
    return scene, *in_units(scene, length, modulus, time)


# Powers of two are exact, powers of a radius are not: with others the last bits differ, and a decision of the
# step control or a contact that begins (its radius goes as the root of the penetration) makes more of them. A
# punch that lands does so by rounding.
UNITS = st.builds(
    _with_units,
    scenes(
        adhesion=adhesions(ZONES),
        indenter=indenters().filter(lambda shape: not isinstance(shape, (PowerLaw, FlatPunch))),
    ),
    st.sampled_from([2.0**-30, 2.0**-10, 2.0**10]),
    st.sampled_from([2.0**-10, 2.0**20, 2.0**30]),
    st.sampled_from([2.0**-30, 2.0**-10, 2.0**20]),
)
RESTED = scenes(
    material=materials(spectra(6, (-2.0, 2.0))),
    indenter=smooth_indenters(),
    adhesion=adhesions(ZONES, (-3.0, 0.0)),
    loading=st.builds(
        lambda start, to, span: Loading("relaxed", start, (Table((0.0, span), (start, to)),)),
        PRESSED,
        PRESSED,
        decades(-2.0, 2.0),
    ),
)

INSTRUMENT = scenes(adhesion=adhesions(ZONES), loading=instruments())
ALL_OF_AN_INSTRUMENT = scenes(
    material=st.one_of(materials(spectra(6)), modelled()), adhesion=irreversible(), loading=instruments()
)

INVARIANTS: dict[str, Invariant] = {
    "clear answer": Invariant(checks.answers_or_refuses, ONE, 3, 5),
    "budget": Invariant(checks.stays_within_the_step_budget, st.tuples(ANY, st.integers(1, 60)), 2, 4),
    "interface": Invariant(
        checks.accounts_for_the_interface, st.tuples(scenes(adhesion=irreversible())), 1, 5
    ),
    "instrument: interface": Invariant(
        checks.accounts_for_the_interface, st.tuples(ALL_OF_AN_INSTRUMENT), 1, 3
    ),
    "energy gained": Invariant(checks.gains_no_energy, ONE, 3, 5),
    "energy balance": Invariant(checks.closes_the_energy_balance, ONE, 3, 5),
    "touch": Invariant(checks.separates_contact_from_gap, ONE, 3, 5),
    "slow limit": Invariant(checks.is_relaxed_when_slow, st.tuples(CALM, PRESSED), 1, 3),
    "fast limit": Invariant(checks.is_glassy_when_fast, st.tuples(CALM, PRESSED), 1, 3),
    "closed cycle": Invariant(
        checks.dissipates_over_a_closed_cycle,
        st.tuples(scenes(loading=_cycles(), adhesion=adhesions(ZONES, (-3.0, 0.0)))),
        1,
        4,
    ),
    "units": Invariant(checks.is_independent_of_units, UNITS, 1, 3),
    "rest": Invariant(checks.is_independent_of_a_relaxed_hold, st.tuples(RESTED, decades(-3.0, 3.0)), 1, 3),
    "superposition": Invariant(
        checks.superposes_at_fixed_radius,
        st.tuples(materials(spectra(8)), _histories(), st.sampled_from(["jump-in", "relaxed"])),
        1,
        4,
    ),
    "instrument: clear answer": Invariant(checks.answers_or_refuses, st.tuples(INSTRUMENT), 1, 3),
    "instrument: energy balance": Invariant(checks.closes_the_energy_balance, st.tuples(INSTRUMENT), 1, 3),
    "no weight": Invariant(
        checks.ignores_a_branch_without_modulus,
        st.tuples(ANY, decades(-8.0, 8.0), st.integers(0, 30)),
        1,
        3,
    ),
}
