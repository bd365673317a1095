"""What is prescribed during a step: the penetration, or the force, and then the penetration is sought."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from contact_scene import Segment
from validation.reference.tracking.penetration_path import Drive, cubic, straight
from validation.reference.tracking.step_history import Course
from validation.reference.tracking.surface import Body, Path, Surface, moved, step

Array = NDArray[np.float64]

APART = 1e-3  # of the force: two trial penetrations nearer than that lose digits


def prescribed(segment: Segment, time: float, duration: float, surface: Surface) -> Drive:
    """Penetration under penetration control: exact where it is linear, else its Hermite cubic."""
    first = segment.value(time)
    start, jump = surface.penetration, first - surface.penetration
    if duration == 0.0:
        return straight(0.0, start, jump, first)
    last = segment.value(time + duration)
    if segment.linear:
        return straight(duration, start, jump, last)
    shape = cubic(duration, first, last, segment.rate(time), segment.rate(time + duration))
    return replace(shape, start=start, jump=jump)


def balanced(
    surface: Surface, body: Body, target: float, duration: float, depths: Course, path: Path, marks: Array
) -> Surface:
    """The moved surface that carries the force ``target``.

    For a given path every field is affine in the penetration at the end of the step, so that the surfaces for
    two penetrations give the one that is sought. ``depths`` is how the penetration has run so far.
    """

    def measure(state: Surface) -> float:
        # A contact that ends in a point carries no force; there the stress at the point has to vanish.
        return state.force(body) if state.radius > 0.0 else state.edge_stress(body)

    def attempt(end: float) -> Surface:
        sag = 0.5 * depths.curvature(duration, end)
        drive = _parabola(duration, surface.penetration, end, sag)
        return moved(surface, body, step(surface, body, drive), path, marks)

    wanted = target if path.start + path.travel > 0.0 else 0.0
    one = attempt(surface.penetration)
    lacking = wanted - measure(one)
    if lacking == 0.0:
        return one
    apart = math.copysign(max(abs(lacking), APART * abs(wanted)), lacking)
    two = attempt(surface.penetration + _first_guess(body, duration, path, apart))
    gained = measure(two) - measure(one)
    if gained == 0.0:  # a force too small for its own round-off
        return two
    share = lacking / gained
    return Surface(
        one.penetration + share * (two.penetration - one.penetration),
        one.inside,
        one.branches + share * (two.branches - one.branches),
        one.outside,
        one.units + share * (two.units - one.units),
    )


def _first_guess(body: Body, duration: float, path: Path, lacking: float) -> float:
    """Change of penetration for a change of force, were the edge to stay."""
    y = duration / body.rheology.times
    shared = np.where(y > 0.0, -np.expm1(-y) / np.where(y > 0.0, y, 1.0), 1.0)
    radius = max(path.start, path.start + path.travel)
    return lacking / (2.0 * radius * (body.rheology.relaxed + float((body.rheology.moduli * shared).sum())))


def _parabola(duration: float, start: float, end: float, sag: float) -> Drive:
    if duration == 0.0:
        return straight(0.0, start, end - start, end)
    rate = (end - start) / duration
    return Drive(duration, start, 0.0, (rate - sag * duration, sag, 0.0))
