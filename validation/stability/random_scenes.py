"""Random scenes over wide ranges, each from a seed of its own: what nobody had thought of.

Sizes follow from a contact of radius ``a``: the radius of the indenter, its depth ``D = a^2/R``, the force
``2 a E0* D``, the work of adhesion that holds such a contact, the process zone from a tenth to a
ten-thousandth of ``a``, or from a thousandth to a ten-millionth. Units are SI in half of the scenes,
otherwise those of the indenter.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from contact_scene import (
    Adhesion,
    Branch,
    Cone,
    FlatPunch,
    Force,
    ForceRamp,
    Hold,
    Indenter,
    Loading,
    Material,
    Oscillate,
    PowerLaw,
    PowerRate,
    Ramp,
    RateTable,
    Scene,
    Sphere,
    Step,
    Sweep,
    Table,
    TabulatedProfile,
)
from validation.cases import Case
from validation.stability.random_numbers import RandomNumbers, SceneSizes

SHARE_WITHOUT_ADHESION = 0.2
SHARE_OF_LONG_ZONES = 0.8
"""Scenes whose process zone is no shorter than a hundredth of the contact: the others cost much more."""
SHORT_ZONES = 3
"""Second number of the generators' seeds of scenes with short zones; 1 is that of the laws of adhesion."""
SHARE_OF_HYSTERESIS = 0.3
SHARE_OF_RATES = 0.3


@dataclass(frozen=True)
class RandomScene:
    """A scene, the loading it was made for in words, and times at which the surface is asked for."""

    seed: int
    kind: str
    scene: Scene
    profile_times: tuple[float, ...]

    @property
    def case(self) -> Case:
        """The scene as the solvers are asked it."""
        return Case(f"seed-{self.seed}", self.scene, profile_times=self.profile_times)


def random_scene(seed: int) -> RandomScene:
    """The scene of a seed, always the same."""
    random = RandomNumbers(seed)
    material, radius, sizes = drawn_sizes(random)
    kind = random.one_of(tuple(LOADINGS))
    loading = LOADINGS[kind](random, sizes)
    indenter, adhesion = drawn_indenter(random, radius, sizes), drawn_adhesion(random, material, sizes)
    if adhesion is not None:  # by numbers of its own, so that the others stay those of the seed
        adhesion = drawn_law(RandomNumbers((seed, 1)), adhesion, sizes)
    scene = Scene(material, indenter, loading, adhesion)
    return RandomScene(seed, kind, scene, _stops(random, loading))


def random_short_zone(seed: int) -> RandomScene:
    """The scene of a seed whose process zone is as short as real ones, always the same."""
    random = RandomNumbers((seed, SHORT_ZONES))
    material, radius, sizes = drawn_sizes(random)
    kind = random.one_of(tuple(LOADINGS))
    loading, indenter = LOADINGS[kind](random, sizes), drawn_indenter(random, radius, sizes)
    zone = sizes.radius * random.decades(-7.0, -3.0)
    adhesion = drawn_law(random, Adhesion(drawn_work(random, material, sizes), zone), sizes)
    return RandomScene(seed, kind, Scene(material, indenter, loading, adhesion), _stops(random, loading))


def drawn_sizes(random: RandomNumbers) -> tuple[Material, float, SceneSizes]:
    """Material, radius of the indenter, and the contact they make."""
    si = random.happens(0.5)
    time = random.decades(-4.0, 2.0) if si else 1.0
    radius = random.decades(-6.0, -2.0) if si else 1.0
    material = drawn_material(random, random.decades(3.0, 9.0) if si else 1.0, time)
    contact = random.between(0.03, 0.3) * radius
    depth = contact**2 / radius
    force = 2.0 * contact * material.relaxed_plane_modulus * depth
    return material, radius, SceneSizes(contact, depth, force, time)


def drawn_material(random: RandomNumbers, modulus: float, time: float) -> Material:
    """None to six branches over six decades of time, in one scene of three close together.

    Parameters
    ----------
    random : RandomNumbers
    modulus : float
        Relaxed modulus.
    time : float
        In the middle of the decades of the relaxation times.

    Returns
    -------
    Material
    """
    poisson = random.one_of((0.0, 0.3, 0.45, 0.49, 0.5, 0.5))
    spread = 0.02 if random.happens(0.33) else 3.0
    branches = tuple(
        Branch(modulus * random.decades(-1.0, 1.3), time * random.decades(-spread, spread))
        for _ in range(random.one_of((0, 1, 1, 1, 2, 3, 6)))
    )
    return Material(modulus, poisson, branches)


def drawn_indenter(random: RandomNumbers, radius: float, sizes: SceneSizes) -> Indenter:
    """About as wide as ``sizes.radius`` at ``sizes.depth``.

    Parameters
    ----------
    random : RandomNumbers
    radius : float
        Of a sphere.
    sizes : SceneSizes
        Of the contact.

    Returns
    -------
    Indenter
    """
    shape = random.one_of(("sphere", "sphere", "sphere", "cone", "punch", "power", "profile"))
    if shape == "cone":
        return Cone(math.degrees(math.atan(sizes.radius / sizes.depth)))
    if shape == "punch":
        return FlatPunch(sizes.radius)
    if shape == "power":
        exponent = random.between(1.2, 6.0)
        return PowerLaw(exponent, sizes.depth / sizes.radius**exponent)
    if shape == "profile":
        nodes = np.linspace(0.0, 4.0, random.count(8, 30))
        rises = np.diff(0.5 * nodes**2) * np.array([random.between(0.7, 1.3) for _ in nodes[1:]])
        heights = sizes.depth * np.concatenate(([0.0], np.cumsum(rises)))
        return TabulatedProfile(tuple((sizes.radius * nodes).tolist()), tuple(heights.tolist()))
    return Sphere(radius)


def drawn_adhesion(random: RandomNumbers, material: Material, sizes: SceneSizes) -> Adhesion | None:
    """``work`` in decades of what holds the contact against its depth; zones of the contact radius."""
    if random.happens(SHARE_WITHOUT_ADHESION):
        return None
    zone = random.decades(-2.0, -1.0) if random.happens(SHARE_OF_LONG_ZONES) else random.decades(-4.0, -2.0)
    return Adhesion(drawn_work(random, material, sizes), sizes.radius * zone)


def drawn_work(random: RandomNumbers, material: Material, sizes: SceneSizes) -> float:
    """Work of adhesion, in decades of what holds the contact against its depth."""
    held = material.relaxed_plane_modulus * sizes.depth**2 / (2.0 * math.pi * sizes.radius)
    return held * random.decades(-2.5, 0.5)


def drawn_law(random: RandomNumbers, adhesion: Adhesion, sizes: SceneSizes) -> Adhesion:
    """The same, in part closing at less than it opens, and taking up more the faster it opens.

    Parameters
    ----------
    random : RandomNumbers
    adhesion : Adhesion
        With a work and a zone only.
    sizes : SceneSizes
        Of the contact.

    Returns
    -------
    Adhesion
    """
    if random.happens(SHARE_OF_HYSTERESIS):
        adhesion = replace(adhesion, work_closing=adhesion.work * random.decades(-1.5, 0.0))
    if random.happens(SHARE_OF_RATES):
        speed = sizes.radius / (sizes.time * random.decades(-2.0, 4.0))
        if random.happens(0.7):
            rate: PowerRate | RateTable = PowerRate(speed, random.between(0.1, 1.5))
        else:
            factors = (random.between(1.1, 2.0), random.between(2.0, 10.0))
            rate = RateTable((speed, 100.0 * speed), tuple(adhesion.work * factor for factor in factors))
        adhesion = replace(adhesion, rate=rate)
    return adhesion


def _start(random: RandomNumbers) -> str:
    return random.one_of(("jump-in", "relaxed"))


def _speed(random: RandomNumbers, sizes: SceneSizes) -> float:
    """The depth in a thousandth to a thousand relaxation times."""
    return sizes.depth / (sizes.time * random.decades(-3.0, 3.0))


def _cycle(random: RandomNumbers, sizes: SceneSizes) -> Loading:
    """Pressed in, held or not, withdrawn until contact is lost."""
    speed = _speed(random, sizes)
    hold = (Hold(sizes.time * random.decades(-3.0, 3.0)),) if random.happens(0.5) else ()
    away = Ramp(-4.0 * sizes.depth, speed * random.decades(-1.0, 1.0))
    return Loading(
        _start(random), sizes.depth * random.between(0.0, 0.9), (Ramp(sizes.depth, speed), *hold, away)
    )


def _retraction(random: RandomNumbers, sizes: SceneSizes) -> Loading:
    """Withdrawn from rest, mostly fast: the edge is frozen up to a corner of the force."""
    speed = sizes.depth / (sizes.time * random.decades(-3.5, 0.5))
    return Loading("relaxed", sizes.depth, (Ramp(-4.0 * sizes.depth, speed),))


def _oscillation(random: RandomNumbers, sizes: SceneSizes) -> Loading:
    """Small swings about a depth, at rest or on the way out."""
    amplitude = sizes.depth * random.decades(-3.0, -0.3)
    frequency = random.decades(-1.5, 2.0) / sizes.time
    cycles = random.between(1.0, 12.0)
    drift = sizes.depth * random.between(-0.2, 0.6) * frequency / (2.0 * math.pi * cycles)
    step = Oscillate(
        amplitude, frequency, 2.0 * math.pi * cycles / frequency, drift if random.happens(0.5) else 0.0
    )
    return Loading(_start(random), sizes.depth * random.between(0.3, 1.0), (step,))


def _sweep(random: RandomNumbers, sizes: SceneSizes) -> Loading:
    """Swings of rising frequency."""
    duration = sizes.time * random.decades(-1.0, 1.5)
    chirp = 4.0 * math.pi * random.between(1.0, 8.0) / duration**2
    step = Sweep(sizes.depth * random.decades(-3.0, -0.5), chirp, duration)
    return Loading(_start(random), sizes.depth * random.between(0.3, 1.0), (step,))


def _table(random: RandomNumbers, sizes: SceneSizes) -> Loading:
    """Up and down through a few depths: the edge passes places where it lingered."""
    start = sizes.depth * random.between(0.2, 0.8)
    times, depths = [0.0], [start]
    for _ in range(random.count(2, 6)):
        times.append(times[-1] + sizes.time * random.decades(-2.0, 1.0))
        depths.append(sizes.depth * random.between(0.0, 1.2))
    return Loading(_start(random), start, (Table(tuple(times), tuple(depths)),))


def _dead_load(random: RandomNumbers, sizes: SceneSizes) -> Loading:
    """A load put on at once, then another."""
    first = sizes.force * random.between(-0.5, 1.5)
    second = sizes.force * random.between(-1.0, 1.0)
    spans = sizes.time * random.decades(-1.0, 2.0), sizes.time * random.decades(-1.0, 2.0)
    return Loading(
        _start(random),
        sizes.depth * random.between(0.3, 1.0),
        (Force(first, spans[0]), Force(second, spans[1])),
    )


def _force_ramp(random: RandomNumbers, sizes: SceneSizes) -> Loading:
    """Pressed by a growing load, then pulled by a growing tension."""
    rate = sizes.force / (sizes.time * random.decades(-2.0, 2.0))
    down = ForceRamp(-2.0 * sizes.force, rate * random.decades(-1.0, 1.0))
    return Loading(
        _start(random), sizes.depth * random.between(0.3, 1.0), (ForceRamp(sizes.force, rate), down)
    )


def _mixed(random: RandomNumbers, sizes: SceneSizes) -> Loading:
    """Two or three of the others, one after the other."""
    start = sizes.depth * random.between(0.3, 1.0)
    steps: list[Step] = []
    for _ in range(random.count(2, 3)):
        make = random.one_of((_cycle, _oscillation, _dead_load, _force_ramp))
        steps += make(random, sizes).steps[: random.count(1, 2)]
    return Loading(_start(random), start, tuple(steps))


LOADINGS: dict[str, Callable[[RandomNumbers, SceneSizes], Loading]] = {
    "cycle": _cycle,
    "retraction": _retraction,
    "oscillation": _oscillation,
    "sweep": _sweep,
    "table": _table,
    "dead load": _dead_load,
    "force ramp": _force_ramp,
    "mixed": _mixed,
}
"""Loading by its kind in words."""


def _stops(random: RandomNumbers, loading: Loading) -> tuple[float, ...]:
    """None to three times within the loading, as far as it is known before the run."""
    ends = [segment.end for _, segment in loading.segments() if math.isfinite(segment.end)]
    if not ends or random.happens(0.5):
        return ()
    return tuple(sorted(ends[-1] * random.between(0.0, 1.0) for _ in range(random.count(1, 3))))
