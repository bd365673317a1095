"""Random scenes that go to and fro several times: the edge meets the places again where it turned before.

Drawn by generators of their own, so that the scenes of :mod:`random_scenes` stay those of their seeds.
Adhesion and process zones from a hundredth to a millionth of the contact radius, all in SI units.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

from contact_scene import (
    Adhesion,
    Branch,
    ForceRamp,
    Hold,
    Loading,
    Material,
    Oscillate,
    Ramp,
    Scene,
    Step,
    Sweep,
)
from validation.stability.random_numbers import RandomNumbers, SceneSizes
from validation.stability.random_scenes import RandomScene, drawn_indenter, drawn_work

STREAM = 4
"""Second number of the generators' seeds."""
SHARE_OF_HOLDS = 0.4
"""Of the loadings that rest at their turns."""


def random_swing(seed: int) -> RandomScene:
    """The scene of a seed, always the same."""
    random = RandomNumbers((seed, STREAM))
    time, radius = random.decades(-2.0, 2.0), random.decades(-4.0, -2.0)
    material = _material(random, time)
    contact = random.between(0.05, 0.25) * radius
    depth = contact**2 / radius
    sizes = SceneSizes(contact, depth, 2.0 * contact * material.relaxed_plane_modulus * depth, time)
    kind = random.one_of(tuple(LOADINGS))
    start = random.one_of(("jump-in", "relaxed", "relaxed"))
    loading = Loading(start, depth * random.between(0.5, 1.0), LOADINGS[kind](random, sizes))
    adhesion = Adhesion(drawn_work(random, material, sizes), contact * random.decades(-6.0, -2.0))
    scene = Scene(material, drawn_indenter(random, radius, sizes), loading, adhesion)
    return RandomScene(seed, kind, scene, ())


def _material(random: RandomNumbers, time: float) -> Material:
    """A rubber of one to three branches within two decades of ``time``."""
    modulus = random.decades(4.0, 7.0)
    branches = tuple(
        Branch(modulus * random.decades(-0.5, 1.0), time * random.decades(-2.0, 0.0))
        for _ in range(random.count(1, 3))
    )
    return Material(modulus, random.one_of((0.45, 0.49, 0.5)), branches)


def _speed(random: RandomNumbers, sizes: SceneSizes) -> float:
    """The depth in a third of a relaxation time to thirty of them."""
    return sizes.depth / (sizes.time * random.decades(-0.5, 1.5))


def _swing(random: RandomNumbers, sizes: SceneSizes) -> float:
    """Amplitude of a swing of the penetration."""
    return sizes.depth * random.decades(-1.5, -0.4)


def _with_holds(random: RandomNumbers, ramps: Sequence[Step], sizes: SceneSizes) -> tuple[Step, ...]:
    """The ramps, in some loadings with rests at their turns."""
    if not random.happens(SHARE_OF_HOLDS):
        return tuple(ramps)
    rest = Hold(sizes.time * random.decades(-2.0, 0.5))
    return tuple(step for ramp in ramps for step in (ramp, rest))


def _triangles(random: RandomNumbers, sizes: SceneSizes) -> tuple[Step, ...]:
    """Penetration between levels that stay, grow apart or approach each other."""
    middle = sizes.depth * random.between(0.5, 1.0)
    swing, speed = _swing(random, sizes), _speed(random, sizes)
    growth = random.one_of((1.0, random.between(0.6, 1.5)))
    levels = [
        middle + side * swing * growth**turn for turn in range(random.count(2, 4)) for side in (1.0, -1.0)
    ]
    return _with_holds(random, [Ramp(float(f"{level:.4g}"), speed) for level in levels], sizes)


def _oscillation(random: RandomNumbers, sizes: SceneSizes) -> tuple[Step, ...]:
    """Swings of the penetration, in some scenes drifting."""
    frequency, cycles = random.decades(-0.7, 1.3) / sizes.time, random.between(1.5, 4.0)
    duration = 2.0 * math.pi * cycles / frequency
    drift = sizes.depth * random.between(-0.1, 0.1) / duration if random.happens(0.4) else 0.0
    return (Oscillate(_swing(random, sizes), frequency, duration, drift),)


def _sweep(random: RandomNumbers, sizes: SceneSizes) -> tuple[Step, ...]:
    """Swings of rising frequency."""
    duration = sizes.time * random.decades(-0.5, 1.0)
    chirp = 4.0 * math.pi * random.between(1.0, 4.0) / duration**2
    return (Sweep(_swing(random, sizes), chirp, duration),)


def _forces(random: RandomNumbers, sizes: SceneSizes) -> tuple[Step, ...]:
    """Force between two levels."""
    levels = (sizes.force * random.between(0.6, 1.2), sizes.force * random.between(-0.1, 0.4))
    rate = sizes.force / (sizes.time * random.decades(-0.5, 1.0))
    ramps = [ForceRamp(level, rate) for _ in range(random.count(2, 3)) for level in levels]
    return _with_holds(random, ramps, sizes)


LOADINGS: dict[str, Callable[[RandomNumbers, SceneSizes], tuple[Step, ...]]] = {
    "triangles": _triangles,
    "oscillation": _oscillation,
    "sweep": _sweep,
    "forces": _forces,
}
"""Load steps by their kind in words."""
