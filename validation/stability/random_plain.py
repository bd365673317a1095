"""Random scenes as a first-time user writes them: SI units, round numbers, the usual tests.

Numbers are 1, 2 or 5 times a power of ten. Two thirds are without adhesion; elsewhere process zones are from
a tenth to a thousandth of the contact radius. Drawn by generators of their own, so that the scenes of
:mod:`random_scenes` stay those of their seeds.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from typing import Literal

import numpy as np

from contact_scene import (
    Adhesion,
    Approach,
    Branch,
    Cone,
    FlatPunch,
    Force,
    ForceRamp,
    Hold,
    Indenter,
    Loading,
    Machine,
    Material,
    Oscillate,
    PowerLaw,
    PowerLawRelaxation,
    Ramp,
    Scene,
    Sphere,
    Step,
    Table,
    TabulatedProfile,
)
from validation.stability.random_numbers import RandomNumbers, SceneSizes, rounded
from validation.stability.random_scenes import RandomScene, drawn_work

STREAM = 5
"""Second number of the generators' seeds."""
SHARE_OF_ADHESION = 1.0 / 3.0
SHARE_OF_LONG_ZONES = 0.5
"""Of the zones from a tenth to a hundredth of the contact radius; the others go down to a thousandth."""
BOUND = 5.0
"""Of a press until a force, over the penetration under the largest such force: a spring yields as well."""
PROFILE = 5.0
"""Largest radius of a tabulated tip, over that of the contact."""


def random_plain(seed: int) -> RandomScene:
    """The scene of a seed, always the same."""
    random = RandomNumbers((seed, STREAM))
    time = random.near(1.0, -2.0, 2.0)
    material = _material(random, time)
    indenter, contact, depth = _tip(random)
    force = rounded(2.0 * contact * material.relaxed_plane_modulus * depth)
    sizes = SceneSizes(contact, depth, force, time)
    kind = random.one_of(tuple(LOADINGS))
    loading = LOADINGS[kind](random, sizes)
    adhesion = None
    if random.happens(SHARE_OF_ADHESION):
        decades = (-2.0, -1.0) if random.happens(SHARE_OF_LONG_ZONES) else (-3.0, -2.0)
        adhesion = Adhesion(rounded(drawn_work(random, material, sizes)), random.near(contact, *decades))
    return RandomScene(seed, kind, Scene(material, indenter, loading, adhesion), ())


def _material(random: RandomNumbers, time: float) -> Material:
    """Elastic, a rubber of one to three branches about ``time``, or a power law above a relaxed modulus."""
    modulus, poisson = random.near(1.0, 4.0, 7.0), random.one_of((0.5, 0.5, 0.45, 0.3))
    kind = random.one_of(("elastic", "one", "one", "several", "several", "power law"))
    if kind == "power law":
        exponent, span = random.one_of((0.2, 0.3, 0.5)), (rounded(time / 100.0), rounded(time * 100.0))
        law = PowerLawRelaxation(exponent, modulus, time, span, error=0.05, relaxed=modulus)
        return law.material(poisson)
    if kind == "elastic":
        return Material(modulus, poisson)
    count = 1 if kind == "one" else random.count(2, 3)
    branches = tuple(
        Branch(random.near(modulus, -0.5, 1.0), rounded(time * 10.0 ** (place - count // 2)))
        for place in range(count)
    )
    return Material(modulus, poisson, branches)


def _tip(random: RandomNumbers) -> tuple[Indenter, float, float]:
    """A tip, the radius of its contact without adhesion, and the penetration there."""
    size = random.near(1.0, -6.0, -2.0)
    shape = random.one_of(("sphere", "sphere", "sphere", "cone", "punch", "power", "profile"))
    if shape == "cone":
        half_angle = random.one_of((45.0, 60.0, 70.0, 80.0))
        return Cone(half_angle), size * 2.0 / math.pi * math.tan(math.radians(half_angle)), size
    depth = random.near(size, -2.0, -1.0)
    if shape == "punch":
        return FlatPunch(size), size, depth
    if shape == "power":  # Sneddon: the depth is this multiple of the height at the edge
        exponent = random.one_of((1.5, 3.0, 4.0))
        multiple = math.sqrt(math.pi) * math.gamma(0.5 * exponent + 1.0) / math.gamma(0.5 * exponent + 0.5)
        coefficient = rounded(depth / (multiple * size**exponent))
        return PowerLaw(exponent, coefficient), (depth / (multiple * coefficient)) ** (1.0 / exponent), depth
    contact = math.sqrt(size * depth)
    if shape == "profile":
        return _profile(random, size, contact), contact, depth
    return Sphere(size), contact, depth


def _profile(random: RandomNumbers, size: float, contact: float) -> TabulatedProfile:
    """A table of a paraboloid, or of a cone of 70 degrees with a blunt end, to three digits.

    Parameters
    ----------
    random : RandomNumbers
    size : float
        Radius of curvature at the lowest point.
    contact : float
        Radius of the contact.

    Returns
    -------
    TabulatedProfile
    """
    radii = np.linspace(0.0, rounded(PROFILE * contact), random.one_of((11, 21, 51)))
    heights = radii**2 / (2.0 * size)
    if random.happens(0.5):
        slope = 1.0 / math.tan(math.radians(70.0))
        blunt = size * slope  # (slope^2 r^2 + (slope blunt)^2)^(1/2) curves by slope/blunt = 1/size
        heights = slope * (np.hypot(radii, blunt) - blunt)
    return TabulatedProfile(tuple(map(_digits, radii.tolist())), tuple(map(_digits, heights.tolist())))


def _digits(value: float) -> float:
    """Without the dust of a product of decimal fractions."""
    return float(f"{value:.3g}")


def _start(random: RandomNumbers, sizes: SceneSizes) -> tuple[str, float]:
    """Mostly the first touch, else in contact."""
    start = random.one_of(("jump-in", "jump-in", "relaxed"))
    return start, 0.0 if random.happens(0.7) else _digits(sizes.depth * random.one_of((0.1, 0.2, 0.5)))


def _speed(random: RandomNumbers, sizes: SceneSizes) -> float:
    """The depth in a thirtieth of a relaxation time to thirty of them."""
    return random.near(sizes.depth / sizes.time, -1.5, 1.5)


def _span(random: RandomNumbers, sizes: SceneSizes) -> float:
    """A third of a relaxation time to thirty of them."""
    return random.near(sizes.time, -0.5, 1.5)


def _press(random: RandomNumbers, sizes: SceneSizes) -> Loading:
    """Pressed in and withdrawn."""
    speed = _speed(random, sizes)
    return Loading(*_start(random, sizes), (Ramp(sizes.depth, speed), Ramp(_away(random, sizes), speed)))


def _away(random: RandomNumbers, sizes: SceneSizes) -> float:
    """Where a withdrawal ends: where it began, or above."""
    return random.one_of((0.0, -sizes.depth, -sizes.depth))


def _press_hold(random: RandomNumbers, sizes: SceneSizes) -> Loading:
    """Pressed in, held, withdrawn."""
    speed, hold = _speed(random, sizes), Hold(_span(random, sizes))
    return Loading(
        *_start(random, sizes), (Ramp(sizes.depth, speed), hold, Ramp(_away(random, sizes), speed))
    )


def _two_speeds(random: RandomNumbers, sizes: SceneSizes) -> Loading:
    """Pressed in at one speed and withdrawn at another."""
    ramps = Ramp(sizes.depth, _speed(random, sizes)), Ramp(_away(random, sizes), _speed(random, sizes))
    return Loading(*_start(random, sizes), ramps)


def _to_a_force(random: RandomNumbers, sizes: SceneSizes) -> Loading:
    """Pressed until a force, held or not, withdrawn; written as three steps or as one."""
    speed, level = _speed(random, sizes), random.near(sizes.force, -1.0, 0.0)
    dwell = random.one_of((0.0, _span(random, sizes)))
    if random.happens(0.5):
        steps: tuple[Step, ...] = (Approach(speed, level, BOUND * sizes.depth, dwell),)
    else:
        press = Ramp(BOUND * sizes.depth, speed, until_force=level)
        steps = (press, Hold(dwell), Ramp(_away(random, sizes), speed))
    return Loading("jump-in", 0.0, steps)


def _force_ramp(random: RandomNumbers, sizes: SceneSizes) -> Loading:
    """A force that grows, and falls to nothing or beyond."""
    rate = random.near(sizes.force / sizes.time, -1.5, 1.5)
    back = random.one_of((0.0, -sizes.force))
    return Loading(*_start(random, sizes), (ForceRamp(sizes.force, rate), ForceRamp(back, rate)))


def _dead_load(random: RandomNumbers, sizes: SceneSizes) -> Loading:
    """A load put on, and in part taken off or lessened."""
    steps: tuple[Step, ...] = (Force(sizes.force, _span(random, sizes)),)
    if random.happens(0.5):
        rest = _digits(sizes.force * random.one_of((0.0, 0.1, 0.5)))
        steps = (*steps, Force(rest, _span(random, sizes)))
    return Loading(*_start(random, sizes), steps)


def _oscillation(random: RandomNumbers, sizes: SceneSizes) -> Loading:
    """Swings of the penetration about one that is pressed to first, or at rest."""
    frequency = random.near(1.0 / sizes.time, -1.0, 1.0)
    duration = rounded(2.0 * math.pi * random.between(2.0, 8.0) / frequency)
    swing = Oscillate(random.near(sizes.depth, -2.0, -0.5), frequency, duration)
    if random.happens(0.5):
        return Loading("relaxed", sizes.depth, (swing,))
    return Loading("jump-in", 0.0, (Ramp(sizes.depth, _speed(random, sizes)), swing))


def _repressed(random: RandomNumbers, sizes: SceneSizes) -> Loading:
    """Pressed in twice, the second time as deep or deeper."""
    speed = _speed(random, sizes)
    shares = (1.0, random.one_of((0.0, 0.2, 0.5)), random.one_of((1.0, 2.0)), -1.0)
    return Loading(
        *_start(random, sizes), tuple(Ramp(_digits(sizes.depth * share), speed) for share in shares)
    )


def _table(random: RandomNumbers, sizes: SceneSizes) -> Loading:
    """Five or six rows of penetration or force, up and down from nothing."""
    quantity: Literal["penetration", "force"] = random.one_of(("penetration", "penetration", "force"))
    interpolation: Literal["linear", "cubic"] = random.one_of(("linear", "linear", "cubic"))
    shares = random.one_of(
        ((0.0, 0.5, 1.0, 1.0, 0.5, 0.0), (0.0, 1.0, 0.2, 1.0, 0.0), (0.0, 0.2, 0.5, 1.0, 0.5))
    )
    unit, interval = sizes.depth if quantity == "penetration" else sizes.force, _span(random, sizes)
    times = tuple(_digits(interval * row) for row in range(len(shares)))
    values = tuple(_digits(unit * share) for share in shares)
    return Loading("jump-in", 0.0, (Table(times, values, quantity=quantity, interpolation=interpolation),))


def _spring(random: RandomNumbers, sizes: SceneSizes) -> Loading:
    """A test by the stage of a spring, from the first touch or from where the tip snaps in."""
    loading = random.one_of((_press, _press_hold, _two_speeds, _to_a_force))(random, sizes)
    machine = Machine(random.near(sizes.force / sizes.depth, -0.3, 1.5))
    start = "snap-in" if loading.penetration == 0.0 and random.happens(0.5) else loading.start
    return replace(loading, start=start, machine=machine)


LOADINGS: dict[str, Callable[[RandomNumbers, SceneSizes], Loading]] = {
    "press": _press,
    "press, hold": _press_hold,
    "two speeds": _two_speeds,
    "to a force": _to_a_force,
    "force ramp": _force_ramp,
    "dead load": _dead_load,
    "oscillation": _oscillation,
    "repressed": _repressed,
    "table": _table,
    "spring": _spring,
}
"""Loading by its kind in words."""
