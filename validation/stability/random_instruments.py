"""Random scenes of an instrument: springs, levels that end a step, recorded motion, laws of adhesion.

Drawn by generators of their own, so that the scenes of :mod:`random_scenes` stay those of their seeds.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace

from contact_scene import (
    WLF,
    Adhesion,
    Approach,
    Force,
    Hold,
    Loading,
    Machine,
    Material,
    PowerLawRelaxation,
    Ramp,
    Scene,
    Step,
    Table,
    TabulatedProfile,
    at_temperature,
)
from validation.stability.random_numbers import RandomNumbers, SceneSizes
from validation.stability.random_scenes import (
    RandomScene,
    drawn_adhesion,
    drawn_indenter,
    drawn_law,
    drawn_sizes,
)

STREAM = 2
"""Second number of the generators' seeds; that of the laws of adhesion in ``random_scenes`` is 1."""
SHARE_OF_SPRINGS = 0.75
SHARE_OF_STRESS = 0.3
SHARE_OF_MODELS = 0.2
"""Of a power law, and of a shift by temperature, each."""
FAR = 50.0
"""Bound of a ramp to a force, and of an approach where the scene cannot state one, in depths."""


def random_instrument(seed: int) -> RandomScene:
    """The instrument's test of a seed, always the same."""
    random = RandomNumbers((seed, STREAM))
    material, radius, sizes = drawn_sizes(random)
    material = _modelled(random, material, sizes)
    indenter, adhesion = drawn_indenter(random, radius, sizes), drawn_adhesion(random, material, sizes)
    if adhesion is not None:
        adhesion = _stressed(random, drawn_law(random, adhesion, sizes), material, sizes)
    machine = None
    if random.happens(SHARE_OF_SPRINGS):
        machine = Machine(sizes.force / sizes.depth * random.decades(-2.0, 2.0))
    kind = random.one_of(tuple(LOADINGS))
    start, depth, steps = LOADINGS[kind](random, sizes)
    bounded = isinstance(indenter, TabulatedProfile)
    steps = tuple(
        replace(s, to=FAR * sizes.depth) if isinstance(s, Approach) and bounded else s for s in steps
    )
    away = -4.0 * sizes.depth - (2.0 * sizes.force / machine.stiffness if machine is not None else 0.0)
    loading = Loading(start, depth, (*steps, Ramp(away, _speed(random, sizes))), machine)
    return RandomScene(seed, kind, Scene(material, indenter, loading, adhesion), ())


def _modelled(random: RandomNumbers, material: Material, sizes: SceneSizes) -> Material:
    """The same, in part a power law above its relaxed modulus, or at another temperature."""
    if random.happens(SHARE_OF_MODELS):
        law = PowerLawRelaxation(
            random.between(0.1, 0.7),
            material.modulus * random.decades(-1.0, 1.0),
            sizes.time,
            (sizes.time * 1e-2, sizes.time * 1e2),
            error=0.05,
            relaxed=material.modulus,
        )
        modulus, branches = law.series()
        material = replace(material, modulus=modulus, branches=branches)
    if random.happens(SHARE_OF_MODELS):
        material = at_temperature(material, WLF(17.44, 51.6, 20.0), random.between(15.0, 25.0))
    return material


def _stressed(random: RandomNumbers, adhesion: Adhesion, material: Material, sizes: SceneSizes) -> Adhesion:
    """The same with a zone of a hundredth of the contact or more, in part one of fixed stress."""
    zone = max(adhesion.zone, 1e-2 * sizes.radius)
    if not random.happens(SHARE_OF_STRESS):
        return replace(adhesion, zone=zone)
    stress = math.sqrt(math.pi * material.relaxed_plane_modulus * adhesion.work / (4.0 * zone))
    return replace(adhesion, zone=0.0, stress=float(f"{stress:.3g}"))


_Drawn = tuple[str, float, tuple[Step, ...]]


def _start(random: RandomNumbers) -> str:
    return random.one_of(("jump-in", "relaxed"))


def _speed(random: RandomNumbers, sizes: SceneSizes) -> float:
    """The depth in a thousandth to a hundred relaxation times."""
    return sizes.depth / (sizes.time * random.decades(-3.0, 2.0))


def _approach(random: RandomNumbers, sizes: SceneSizes) -> _Drawn:
    """The usual test: until a force, a dwell or none."""
    dwell = sizes.time * random.decades(-2.0, 2.0) if random.happens(0.6) else 0.0
    level = sizes.force * random.between(0.1, 1.5)
    test = Approach(_speed(random, sizes), level, dwell=dwell, retract=_speed(random, sizes))
    return _start(random), sizes.depth * random.between(0.0, 0.4), (test,)


def _to_a_radius(random: RandomNumbers, sizes: SceneSizes) -> _Drawn:
    """Pressed until the contact has a radius, held."""
    ramp = Ramp(
        4.0 * sizes.depth, _speed(random, sizes), until_radius=sizes.radius * random.between(0.8, 1.5)
    )
    hold = Hold(sizes.time * random.decades(-2.0, 2.0))
    return _start(random), sizes.depth * random.between(0.0, 0.6), (ramp, hold)


def _relaxation(random: RandomNumbers, sizes: SceneSizes) -> _Drawn:
    """Pressed to a force, held until some of it has relaxed."""
    level = sizes.force * random.between(0.1, 1.5)
    ramp = Ramp(FAR * sizes.depth, _speed(random, sizes), until_force=level)
    hold = Hold(sizes.time * random.decades(0.0, 3.0), until_force=level * random.between(0.7, 0.99))
    return _start(random), sizes.depth * random.between(0.0, 0.5), (ramp, hold)


def _creep(random: RandomNumbers, sizes: SceneSizes) -> _Drawn:
    """Loaded until the indenter has come to a depth, at most that of a relaxed sphere without adhesion."""
    share = random.between(0.3, 1.5)
    relaxed = sizes.depth * (1.5 * share) ** (2.0 / 3.0)
    force = Force(
        sizes.force * share,
        sizes.time * random.decades(-1.0, 2.0),
        until_penetration=relaxed * random.between(0.6, 1.0),
    )
    return _start(random), relaxed * random.between(0.1, 0.5), (force,)


def _recorded(random: RandomNumbers, sizes: SceneSizes) -> _Drawn:
    """A smooth record of stage or force by many rows, read as cubics."""
    rows, cycles = random.count(20, 60), random.between(0.3, 2.0)
    begin, swing = random.between(0.3, 0.8), random.between(0.05, 0.5)
    span = sizes.time * random.decades(-1.0, 1.5)
    phases = [2.0 * math.pi * cycles * row / (rows - 1) for row in range(rows)]
    times = tuple(span * row / (rows - 1) for row in range(rows))
    of_force = random.happens(0.4)
    unit = sizes.force if of_force else sizes.depth
    values = tuple(unit * (begin + swing * math.sin(phase)) for phase in phases)
    record = Table(times, values, quantity="force" if of_force else "penetration", interpolation="cubic")
    return _start(random), sizes.depth * begin, (record,)


def _snap_in(random: RandomNumbers, sizes: SceneSizes) -> _Drawn:
    """Contact made at constant stage, then pressed in."""
    return "snap-in", sizes.depth * random.between(0.0, 0.3), (Ramp(sizes.depth, _speed(random, sizes)),)


LOADINGS: dict[str, Callable[[RandomNumbers, SceneSizes], _Drawn]] = {
    "approach": _approach,
    "to a radius": _to_a_radius,
    "relaxation": _relaxation,
    "creep": _creep,
    "recorded": _recorded,
    "snap-in": _snap_in,
}
"""Start, penetration there and steps, each followed by a withdrawal, by kind in words."""
