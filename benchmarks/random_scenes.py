"""Random scenes by family and seed: strategies of hypothesis, composed of those of the invariants' tests.

A scene is drawn about a contact of radius ``WIDTH`` pressed in by ``DEPTH`` on a half-space of ``E0* = 1``,
times in relaxation times, and put into units afterwards; then its numbers are rounded so that it can be read.
"""

from __future__ import annotations

import dataclasses
import math
import random
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Literal

from hypothesis import given
from hypothesis import strategies as st

import contact_scene as cs
from benchmarks.hard_scenes import HARD
from benchmarks.strategies import (
    DEPTH,
    HELD,
    LOAD,
    WIDTH,
    adhesions,
    decades,
    in_units,
    indenters,
    irreversible,
    materials,
    modelled,
    oscillation,
    scenes,
    shares,
    spectra,
    swept,
)
from validation.cases import Case
from validation.solvers.contact_range import largest_contact_radius

BYTES = 16384
"""Of a seed's stream: more than any scene draws."""
FAR = 50.0 * DEPTH
"""Bound of a press to a force."""
Steps = tuple[cs.Step, ...]
Drawn = st.SearchStrategy


@dataclass(frozen=True)
class RandomScene:
    """A scene, the loading it was made for in words, and times at which the surface is asked for."""

    seed: int
    kind: str
    scene: cs.Scene
    profile_times: tuple[float, ...] = ()

    @property
    def case(self) -> Case:
        """The scene as the solvers are asked it."""
        return Case(f"seed-{self.seed}", self.scene, profile_times=self.profile_times)


def random_scene(family: str, seed: int) -> RandomScene | None:
    """The scene of a seed, always the same; ``None`` where there is none or its loading never touches.

    A test function of hypothesis is fed with bytes of the seed's generator, which decide every draw.
    """
    drawn: list[RandomScene] = []

    @given(FAMILIES[family])
    def keep(one: tuple[str, cs.Scene, list[float]]) -> None:
        kind, scene, moments = one
        ends = [segment.end for _, segment in scene.loading.segments() if math.isfinite(segment.end)]
        times = tuple(three_digits(share * ends[-1]) for share in sorted(moments)) if ends else ()
        largest_contact_radius(scene)
        drawn.append(RandomScene(seed, kind, scene, times))

    try:
        fuzz = keep.hypothesis.fuzz_one_input  # type: ignore[attr-defined]
        fuzz(random.Random(f"{family} {seed}").randbytes(BYTES))
    except cs.SceneError:
        return None
    return drawn[0] if drawn else None


def three_digits(value: float) -> float:
    """A number that can be read."""
    return float(f"{value:.3g}")


def rounded(value: float) -> float:
    """The nearest of 1, 2, 5 times a power of ten in the logarithm, with its sign; 0 stays."""
    if value == 0.0 or not math.isfinite(value):
        return value
    power = math.floor(math.log10(abs(value)))
    near = [float(f"{digit}e{power}") for digit in (1, 2, 5, 10)]
    return math.copysign(min(near, key=lambda one: abs(math.log(one / abs(value)))), value)


def with_numbers(part: Any, change: Callable[[float], float]) -> Any:
    """A scene with every number changed but Poisson's ratio; angles and tables to three digits."""
    if isinstance(part, float):
        return change(part)
    if isinstance(part, tuple):
        return tuple(with_numbers(one, change) for one in part)
    if not dataclasses.is_dataclass(part) or isinstance(part, type):
        return part
    inside = three_digits if isinstance(part, (cs.Cone, cs.Table, cs.TabulatedProfile)) else change
    names = [field.name for field in dataclasses.fields(part) if field.init and field.name != "poisson"]
    if isinstance(part, cs.Adhesion) and part.stress is not None:
        names.remove("zone")  # the scene sets it
        return cs.Adhesion(**{name: with_numbers(getattr(part, name), inside) for name in names})
    return dataclasses.replace(part, **{name: with_numbers(getattr(part, name), inside) for name in names})


def maybe(strategy: Drawn[Any]) -> Drawn[tuple[Any, ...]]:
    """None or one."""
    return st.one_of(st.just(()), strategy.map(lambda one: (one,)))


def speeds(low: float, high: float) -> Drawn[float]:
    """The depth in decades of a relaxation time."""
    return decades(low, high).map(lambda span: DEPTH / span)


def holds(low: float, high: float) -> Drawn[cs.Hold]:
    """Rests of decades of a relaxation time."""
    return decades(low, high).map(cs.Hold)


def adhesive(zones: tuple[float, float], strengths: tuple[float, float] = (-2.5, 0.5)) -> Drawn[cs.Adhesion]:
    """``zones`` in decades of ``WIDTH``, ``strengths`` of ``HELD``."""
    work, zone = decades(*strengths).map(lambda x: x * HELD), decades(*zones).map(lambda x: x * WIDTH)
    return st.builds(cs.Adhesion, work, zone)


def with_rates(plain: Drawn[Any]) -> Drawn[Any]:
    """The same, and in part with the hysteresis and the law of the rate that :func:`irreversible` draws."""

    def build(adhesion: cs.Adhesion | None, law: cs.Adhesion) -> cs.Adhesion | None:
        if adhesion is None or adhesion.work == 0.0 or law.stress is not None:
            return adhesion
        scale = adhesion.work / law.work
        rate = law.rate
        if isinstance(rate, cs.RateTable):
            rate = dataclasses.replace(rate, works=tuple(scale * work for work in rate.works))
        return cs.Adhesion(adhesion.work, adhesion.zone, (law.work_closing or law.work) * scale, rate)

    return st.one_of(plain, plain, st.builds(build, plain, irreversible()))


STARTS = st.sampled_from(["jump-in", "relaxed"])
PRESSED = shares(0.3, 1.0, DEPTH)
SPEEDS = speeds(-3.0, 3.0)
PERIODS = decades(-1.2, 2.3)


def loading(
    steps: Drawn[Steps], at: Drawn[float] = PRESSED, starts: Drawn[str] = STARTS
) -> Drawn[cs.Loading]:
    """Steps from a start at a penetration."""
    return st.builds(cs.Loading, starts, at, steps)


def single(step: Drawn[Any]) -> Drawn[Steps]:
    """A loading's only step."""
    return step.map(lambda one: (one,))


def table(span: tuple[float, float]) -> Drawn[Steps]:
    """Up and down through a few depths: the edge passes places where it lingered."""

    def build(rows: list[tuple[float, float]]) -> Steps:
        times = [sum(rest for rest, _ in rows[:n]) for n in range(len(rows))]
        return (cs.Table(tuple(times), tuple(depth for _, depth in rows)),)

    return st.lists(st.tuples(decades(*span), shares(0.0, 1.2, DEPTH)), min_size=3, max_size=7).map(build)


CYCLE = st.builds(
    lambda v, rest, slower: (cs.Ramp(DEPTH, v), *rest, cs.Ramp(-4.0 * DEPTH, v * slower)),
    SPEEDS, maybe(holds(-3.0, 3.0)), decades(-1.0, 1.0),
)  # fmt: skip
OSCILLATION = single(
    st.builds(oscillation, decades(-3.0, -0.3).map(lambda x: x * DEPTH), PERIODS, shares(1.0, 12.0),
              st.one_of(st.just(0.0), shares(-0.2, 0.6)))
)  # fmt: skip
SWEEP = single(
    st.builds(swept, decades(-3.0, -0.5).map(lambda x: x * DEPTH), decades(-1.0, 1.5), shares(1.0, 8.0))
)
DEAD_LOAD = st.builds(
    lambda one, two, first, second: (cs.Force(one, first), cs.Force(two, second)),
    shares(-0.5, 1.5, LOAD), shares(-1.0, 1.0, LOAD), decades(-1.0, 2.0), decades(-1.0, 2.0),
)  # fmt: skip
FORCE_RAMP = st.builds(
    lambda span, slower: (cs.ForceRamp(LOAD, LOAD / span), cs.ForceRamp(-2.0 * LOAD, slower * LOAD / span)),
    decades(-2.0, 2.0), decades(-1.0, 1.0),
)  # fmt: skip
USUAL = {
    "cycle": loading(CYCLE, shares(0.0, 0.9, DEPTH)),
    "retraction": loading(
        single(speeds(-0.5, 3.5).map(lambda v: cs.Ramp(-4.0 * DEPTH, v))), st.just(DEPTH), st.just("relaxed")
    ),
    "oscillation": loading(OSCILLATION),
    "sweep": loading(SWEEP),
    "table": loading(table((-2.0, 1.0))),
    "dead load": loading(DEAD_LOAD),
    "force ramp": loading(FORCE_RAMP),
    "mixed": loading(
        st.lists(st.one_of(CYCLE, OSCILLATION, DEAD_LOAD, FORCE_RAMP), min_size=2, max_size=3).map(
            lambda several: tuple(step for steps in several for step in steps[:2])
        )
    ),
}
"""Eight kinds of loading."""


def triangles(rests: Drawn[tuple[cs.Hold, ...]]) -> Drawn[Steps]:
    """Penetration between levels that stay, grow apart or approach each other."""

    def build(
        middle: float, swing: float, v: float, growth: float, turns: int, rest: tuple[cs.Hold, ...]
    ) -> Steps:
        levels = [middle + side * swing * growth**turn for turn in range(turns) for side in (1.0, -1.0)]
        return tuple(step for level in levels for step in (cs.Ramp(level, v), *rest))

    swings = decades(-1.5, -0.4).map(lambda x: x * DEPTH)
    growths = st.one_of(st.just(1.0), shares(0.6, 1.5))
    return st.builds(
        build, shares(0.5, 1.0, DEPTH), swings, speeds(-0.5, 1.5), growths, st.integers(2, 4), rests
    )


def forces(rests: Drawn[tuple[cs.Hold, ...]]) -> Drawn[Steps]:
    """Force between two levels."""

    def build(high: float, low: float, rate: float, turns: int, rest: tuple[cs.Hold, ...]) -> Steps:
        return tuple(s for _ in range(turns) for to in (high, low) for s in (cs.ForceRamp(to, rate), *rest))

    rates = decades(-0.5, 1.0).map(lambda span: LOAD / span)
    return st.builds(build, shares(0.6, 1.2, LOAD), shares(-0.1, 0.4, LOAD), rates, st.integers(2, 3), rests)


RESTS = maybe(holds(-2.0, 0.5))
SWINGS = {
    "triangles": loading(triangles(RESTS)),
    "forces": loading(forces(RESTS)),
    "oscillation": loading(
        single(st.builds(oscillation, decades(-1.5, -0.4).map(lambda x: x * DEPTH), decades(-0.5, 1.5),
                         shares(1.5, 4.0), st.one_of(st.just(0.0), shares(-0.1, 0.1))))
    ),
    "sweep": loading(
        single(st.builds(swept, decades(-1.5, -0.4).map(lambda x: x * DEPTH), decades(-0.5, 1.0),
                         shares(1.0, 4.0)))
    ),
}  # fmt: skip
"""To and fro two to four times: the edge meets the places again where it has turned."""

LEVELS = shares(0.1, 1.5, LOAD)
SLOWER = speeds(-2.0, 3.0)


def _recorded(rows: int, cycles: float, begin: float, swing: float, span: float, of_force: bool) -> Steps:
    """A smooth record of stage or force by many rows, read as cubics."""
    unit, moments = LOAD if of_force else DEPTH, [row / (rows - 1) for row in range(rows)]
    values = tuple(unit * (begin + swing * math.sin(2.0 * math.pi * cycles * t)) for t in moments)
    quantity: Literal["force", "penetration"] = "force" if of_force else "penetration"
    return (cs.Table(tuple(span * t for t in moments), values, quantity=quantity, interpolation="cubic"),)


def _creep(share: float, span: float, reached: float) -> Steps:
    """Loaded until a depth, at most that of a relaxed sphere without adhesion."""
    return (cs.Force(LOAD * share, span, until_penetration=reached * DEPTH * (1.5 * share) ** (2.0 / 3.0)),)


TESTS: dict[str, Drawn[Steps]] = {
    "approach": single(
        st.builds(lambda v, level, dwell, back: cs.Approach(v, level, FAR, dwell, back), SLOWER, LEVELS,
                  st.one_of(st.just(0.0), decades(-2.0, 2.0)), SLOWER)
    ),
    "to a radius": st.builds(
        lambda v, radius, rest: (cs.Ramp(4.0 * DEPTH, v, until_radius=radius), rest), SLOWER,
        shares(0.8, 1.5, WIDTH), holds(-2.0, 2.0)
    ),
    "relaxation": st.builds(
        lambda v, level, span, share: (cs.Ramp(FAR, v, until_force=level), cs.Hold(span, share * level)),
        SLOWER, LEVELS, decades(0.0, 3.0), shares(0.7, 0.99)
    ),
    "creep": st.builds(_creep, shares(0.3, 1.5), decades(-1.0, 2.0), shares(0.6, 1.0)),
    "recorded": st.builds(_recorded, st.integers(20, 60), shares(0.3, 2.0), shares(0.3, 0.8),
                          shares(0.05, 0.5), decades(-1.0, 1.5), st.booleans()),
    "press": single(st.builds(lambda v: cs.Ramp(DEPTH, v), SLOWER)),
}  # fmt: skip
"""An instrument's tests, each followed by a withdrawal."""


def on_a_machine(steps: Drawn[Steps], stiffness: tuple[float, float]) -> Drawn[cs.Loading]:
    """Steps and a withdrawal, on a spring or a rigid machine, from contact or from where the tip snaps in."""

    def build(start: str, at: float, test: Steps, v: float, machine: tuple[cs.Machine, ...]) -> cs.Loading:
        spring = machine[0] if machine else None
        away = -4.0 * DEPTH - (2.0 * LOAD / spring.stiffness if spring else 0.0)
        return cs.Loading(start, at, (*test, cs.Ramp(away, v)), spring)

    springs = decades(*stiffness).map(lambda x: cs.Machine(x * LOAD / DEPTH))
    starts = st.sampled_from(["jump-in", "relaxed", "snap-in"])
    return st.builds(build, starts, shares(0.0, 0.4, DEPTH), steps, SLOWER, maybe(springs))


INSTRUMENTS = {name: on_a_machine(steps, (-2.0, 2.0)) for name, steps in TESTS.items()}
PLAIN = {
    "press": loading(
        st.builds(lambda v, rest, slower, to: (cs.Ramp(DEPTH, v), *rest, cs.Ramp(-to * DEPTH, slower * v)),
                  speeds(-1.5, 1.5), maybe(holds(-0.5, 1.5)), st.sampled_from([1.0, 1.0, 0.1, 10.0]),
                  st.sampled_from([0.0, 1.0])),
        st.sampled_from([0.0, 0.0, 0.2 * DEPTH]),
    ),
    "twice": loading(
        st.builds(lambda v, between, again: tuple(cs.Ramp(x * DEPTH, v) for x in (1.0, between, again, -1.0)),
                  speeds(-1.5, 1.5), st.sampled_from([0.0, 0.2, 0.5]), st.sampled_from([1.0, 2.0])),
        st.just(0.0),
    ),
    "force ramp": loading(FORCE_RAMP, st.just(0.0)),
    "dead load": loading(
        st.builds(lambda span, rest: (cs.Force(LOAD, span), cs.Force(rest * LOAD, span)), decades(-0.5, 1.5),
                  st.sampled_from([0.0, 0.1, 0.5])),
        st.just(0.0),
    ),
    "oscillation": loading(OSCILLATION, st.just(DEPTH), st.just("relaxed")),
    "table": loading(table((-0.5, 1.5)), st.just(0.0)),
    **{f"{test}, stage": on_a_machine(TESTS[test], (-0.3, 1.5))
       for test in ("approach", "relaxation", "press")},
}  # fmt: skip
"""What a first scene looks like."""


def family(
    loadings: dict[str, Drawn[cs.Loading]],
    adhesion: Drawn[cs.Adhesion | None],
    material: Drawn[cs.Material],
    units: Drawn[tuple[float, float, float]],
    change: Callable[[float], float] = three_digits,
    moments: int = 0,
    body: Drawn[cs.Layer | None] = st.none(),  # noqa: B008 - a strategy has no state
) -> Drawn[tuple[str, cs.Scene, list[float]]]:
    """Kind of loading, scene in its units, and shares of the loading at which the surface is asked for."""

    def build(named: tuple[str, cs.Loading], scene: cs.Scene, units: tuple, moments: list[float]) -> tuple:
        whole = dataclasses.replace(scene, loading=named[1])
        return named[0], with_numbers(in_units(whole, *units)[0], change), moments

    kinds = st.one_of(*(st.tuples(st.just(kind), one) for kind, one in loadings.items()))
    parts = scenes(
        material=material,
        indenter=indenters(),
        loading=st.just(cs.Loading("relaxed", DEPTH)),
        adhesion=adhesion,
        body=body,
    )
    return st.builds(build, kinds, parts, units, st.lists(shares(0.0, 1.0), max_size=moments))


SI = st.tuples(decades(-6.0, -2.0), decades(3.0, 9.0), decades(-4.0, 2.0))
UNITS = st.one_of(st.just((1.0, 1.0, 1.0)), SI)
"""Units of length, modulus and time."""
ANY = materials(spectra(6, (-3.0, 3.0)))
LONG = st.one_of(st.none(), adhesive((-2.0, -1.0)), adhesive((-2.0, -1.0)), adhesive((-4.0, -2.0)))
FEW = materials(
    st.lists(st.builds(cs.Branch, decades(-0.5, 1.0), decades(-2.0, 0.0)), min_size=1, max_size=3).map(tuple)
)
FAMILIES: dict[str, Drawn[tuple[str, cs.Scene, list[float]]]] = {
    "usual": family(USUAL, with_rates(LONG), ANY, UNITS, moments=3),
    "instruments": family(
        INSTRUMENTS, st.one_of(adhesions((-2.0, -1.0)), irreversible()), st.one_of(ANY, ANY, modelled()),
        UNITS,
    ),
    "short-zones": family(USUAL, with_rates(adhesive((-7.0, -3.0))), ANY, UNITS, moments=3),
    "swings": family(SWINGS, adhesive((-6.0, -2.0)), FEW, SI),
    "plain": family(
        PLAIN, st.one_of(st.none(), st.none(), adhesive((-3.0, -1.0))),
        st.one_of(materials(st.just(())), FEW, FEW, modelled()), SI, change=rounded,
    ),
    "layer": family(
        USUAL | INSTRUMENTS, with_rates(LONG), ANY, UNITS, moments=3, body=st.builds(
            cs.Layer, decades(-1.3, 1.6).map(lambda x: x * WIDTH), st.sampled_from(["bonded", "frictionless"])
        ),
    ),
    "hard": st.sampled_from([(name, scene, []) for name, scene in HARD]),
}  # fmt: skip
"""Strategies of the families of scenes."""
