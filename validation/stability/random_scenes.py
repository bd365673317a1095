"""Random scenes over wide ranges, each from a seed of its own: what nobody had thought of.

Sizes follow from a contact of radius ``a``: the radius of the indenter, its depth ``D = a^2/R``, the force
``2 a E0* D``, the work of adhesion that holds such a contact, the process zone from a tenth to a
ten-thousandth of ``a``. Units are SI in half of the scenes, otherwise those of the indenter.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import TypeVar

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
    Ramp,
    Scene,
    Sphere,
    Step,
    Sweep,
    Table,
    TabulatedProfile,
)

Value = TypeVar("Value")
SHARE_WITHOUT_ADHESION = 0.2
SHARE_OF_LONG_ZONES = 0.8
"""Scenes whose process zone is no shorter than a hundredth of the contact: the others cost much more."""


@dataclass(frozen=True)
class RandomScene:
    """A scene, the loading it was made for in words, and times at which the surface is asked for."""

    seed: int
    kind: str
    scene: Scene
    profile_times: tuple[float, ...]


@dataclass(frozen=True)
class _Sizes:
    """What everything is measured in: contact radius, penetration, force, relaxation time."""

    radius: float
    depth: float
    force: float
    time: float


class _Dice:
    """Random numbers of a seed, rounded to a few digits so that a scene can be read."""

    def __init__(self, seed: int) -> None:
        self._generator = np.random.default_rng(seed)

    def decades(self, low: float, high: float) -> float:
        """Evenly over powers of ten."""
        return float(f"{10.0 ** self._generator.uniform(low, high):.3g}")

    def between(self, low: float, high: float) -> float:
        """Evenly."""
        return float(f"{self._generator.uniform(low, high):.3g}")

    def one_of(self, values: tuple[Value, ...]) -> Value:
        """One of several, all alike."""
        return values[int(self._generator.integers(len(values)))]

    def count(self, low: int, high: int) -> int:
        """A whole number, both ends included."""
        return int(self._generator.integers(low, high + 1))

    def happens(self, share: float) -> bool:
        """True in that share of the cases."""
        return bool(self._generator.uniform() < share)


def random_scene(seed: int) -> RandomScene:
    """The scene of a seed, always the same."""
    dice = _Dice(seed)
    si = dice.happens(0.5)
    time = dice.decades(-4.0, 2.0) if si else 1.0
    radius = dice.decades(-6.0, -2.0) if si else 1.0
    material = _material(dice, dice.decades(3.0, 9.0) if si else 1.0, time)
    contact = dice.between(0.03, 0.3) * radius
    depth = contact**2 / radius
    sizes = _Sizes(contact, depth, 2.0 * contact * material.relaxed_plane_modulus * depth, time)
    kind = dice.one_of(tuple(LOADINGS))
    loading = LOADINGS[kind](dice, sizes)
    scene = Scene(material, _indenter(dice, radius, sizes), loading, _adhesion(dice, material, sizes))
    return RandomScene(seed, kind, scene, _stops(dice, loading))


def _material(dice: _Dice, modulus: float, time: float) -> Material:
    """None to six branches over six decades of time, in one scene of three close together."""
    poisson = dice.one_of((0.0, 0.3, 0.45, 0.49, 0.5, 0.5))
    spread = 0.02 if dice.happens(0.33) else 3.0
    branches = tuple(
        Branch(modulus * dice.decades(-1.0, 1.3), time * dice.decades(-spread, spread))
        for _ in range(dice.one_of((0, 1, 1, 1, 2, 3, 6)))
    )
    return Material(modulus, poisson, branches)


def _indenter(dice: _Dice, radius: float, sizes: _Sizes) -> Indenter:
    """About as wide as ``sizes.radius`` at ``sizes.depth``."""
    shape = dice.one_of(("sphere", "sphere", "sphere", "cone", "punch", "power", "profile"))
    if shape == "cone":
        return Cone(math.degrees(math.atan(sizes.radius / sizes.depth)))
    if shape == "punch":
        return FlatPunch(sizes.radius)
    if shape == "power":
        exponent = dice.between(1.2, 6.0)
        return PowerLaw(exponent, sizes.depth / sizes.radius**exponent)
    if shape == "profile":
        nodes = np.linspace(0.0, 4.0, dice.count(8, 30))
        rises = np.diff(0.5 * nodes**2) * np.array([dice.between(0.7, 1.3) for _ in nodes[1:]])
        heights = sizes.depth * np.concatenate(([0.0], np.cumsum(rises)))
        return TabulatedProfile(tuple((sizes.radius * nodes).tolist()), tuple(heights.tolist()))
    return Sphere(radius)


def _adhesion(dice: _Dice, material: Material, sizes: _Sizes) -> Adhesion | None:
    """``work`` in decades of what holds the contact against its depth; zones of the contact radius."""
    if dice.happens(SHARE_WITHOUT_ADHESION):
        return None
    held = material.relaxed_plane_modulus * sizes.depth**2 / (2.0 * math.pi * sizes.radius)
    zone = dice.decades(-2.0, -1.0) if dice.happens(SHARE_OF_LONG_ZONES) else dice.decades(-4.0, -2.0)
    return Adhesion(held * dice.decades(-2.5, 0.5), sizes.radius * zone)


def _start(dice: _Dice) -> str:
    return dice.one_of(("jump-in", "relaxed"))


def _speed(dice: _Dice, sizes: _Sizes) -> float:
    """The depth in a thousandth to a thousand relaxation times."""
    return sizes.depth / (sizes.time * dice.decades(-3.0, 3.0))


def _cycle(dice: _Dice, sizes: _Sizes) -> Loading:
    """Pressed in, held or not, withdrawn until contact is lost."""
    speed = _speed(dice, sizes)
    hold = (Hold(sizes.time * dice.decades(-3.0, 3.0)),) if dice.happens(0.5) else ()
    away = Ramp(-4.0 * sizes.depth, speed * dice.decades(-1.0, 1.0))
    return Loading(
        _start(dice), sizes.depth * dice.between(0.0, 0.9), (Ramp(sizes.depth, speed), *hold, away)
    )


def _retraction(dice: _Dice, sizes: _Sizes) -> Loading:
    """Withdrawn from rest, mostly fast: the edge is frozen up to a corner of the force."""
    speed = sizes.depth / (sizes.time * dice.decades(-3.5, 0.5))
    return Loading("relaxed", sizes.depth, (Ramp(-4.0 * sizes.depth, speed),))


def _oscillation(dice: _Dice, sizes: _Sizes) -> Loading:
    """Small swings about a depth, at rest or on the way out."""
    amplitude = sizes.depth * dice.decades(-3.0, -0.3)
    frequency = dice.decades(-1.5, 2.0) / sizes.time
    cycles = dice.between(1.0, 12.0)
    drift = sizes.depth * dice.between(-0.2, 0.6) * frequency / (2.0 * math.pi * cycles)
    step = Oscillate(
        amplitude, frequency, 2.0 * math.pi * cycles / frequency, drift if dice.happens(0.5) else 0.0
    )
    return Loading(_start(dice), sizes.depth * dice.between(0.3, 1.0), (step,))


def _sweep(dice: _Dice, sizes: _Sizes) -> Loading:
    """Swings of rising frequency."""
    duration = sizes.time * dice.decades(-1.0, 1.5)
    chirp = 4.0 * math.pi * dice.between(1.0, 8.0) / duration**2
    step = Sweep(sizes.depth * dice.decades(-3.0, -0.5), chirp, duration)
    return Loading(_start(dice), sizes.depth * dice.between(0.3, 1.0), (step,))


def _table(dice: _Dice, sizes: _Sizes) -> Loading:
    """Up and down through a few depths: the edge passes places where it lingered."""
    start = sizes.depth * dice.between(0.2, 0.8)
    times, depths = [0.0], [start]
    for _ in range(dice.count(2, 6)):
        times.append(times[-1] + sizes.time * dice.decades(-2.0, 1.0))
        depths.append(sizes.depth * dice.between(0.0, 1.2))
    return Loading(_start(dice), start, (Table(tuple(times), tuple(depths)),))


def _dead_load(dice: _Dice, sizes: _Sizes) -> Loading:
    """A load put on at once, then another."""
    first = sizes.force * dice.between(-0.5, 1.5)
    second = sizes.force * dice.between(-1.0, 1.0)
    spans = sizes.time * dice.decades(-1.0, 2.0), sizes.time * dice.decades(-1.0, 2.0)
    return Loading(
        _start(dice), sizes.depth * dice.between(0.3, 1.0), (Force(first, spans[0]), Force(second, spans[1]))
    )


def _force_ramp(dice: _Dice, sizes: _Sizes) -> Loading:
    """Pressed by a growing load, then pulled by a growing tension."""
    rate = sizes.force / (sizes.time * dice.decades(-2.0, 2.0))
    down = ForceRamp(-2.0 * sizes.force, rate * dice.decades(-1.0, 1.0))
    return Loading(_start(dice), sizes.depth * dice.between(0.3, 1.0), (ForceRamp(sizes.force, rate), down))


def _mixed(dice: _Dice, sizes: _Sizes) -> Loading:
    """Two or three of the others, one after the other."""
    start = sizes.depth * dice.between(0.3, 1.0)
    steps: list[Step] = []
    for _ in range(dice.count(2, 3)):
        make = dice.one_of((_cycle, _oscillation, _dead_load, _force_ramp))
        steps += make(dice, sizes).steps[: dice.count(1, 2)]
    return Loading(_start(dice), start, tuple(steps))


LOADINGS: dict[str, Callable[[_Dice, _Sizes], Loading]] = {
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


def _stops(dice: _Dice, loading: Loading) -> tuple[float, ...]:
    """None to three times within the loading, as far as it is known before the run."""
    ends = [segment.end for _, segment in loading.segments() if math.isfinite(segment.end)]
    if not ends or dice.happens(0.5):
        return ()
    return tuple(sorted(ends[-1] * dice.between(0.0, 1.0) for _ in range(dice.count(1, 3))))
