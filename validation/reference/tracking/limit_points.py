"""Steps of a prescribed distance, towards and at limit points, where time is no measure.

An edge that would travel too far has its distance prescribed and its time sought: loss of contact and snaps
are approached in distance, where nothing is singular. Where no longer step is stable the edge runs free.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from contact_scene import Event, Segment
from validation.reference.tracking import instantaneous
from validation.reference.tracking.law import Griffith
from validation.reference.tracking.rounding import few_digits
from validation.reference.tracking.step_history import FORCE, RADIUS
from validation.reference.tracking.trial import Attempt

if TYPE_CHECKING:
    from validation.reference.tracking.stepping import Run

FOLD = 1e-4  # of the largest travel: the limit point counts as reached when no longer step is stable
AHEAD = 1e-2  # of the distance: how far beyond it the law has to hold the edge


def by_distance(run: Run, attempt: Attempt, radius: float, longest: float) -> float:
    """The edge wants to go beyond ``radius`` within ``longest``: find when it passes there.

    Returns the duration to be proposed next.
    """
    a0 = run.surface.radius
    if radius == a0:
        run.lost("the contact has shrunk to the length of the process zone")
        return longest
    turn = run.trail.to_extremum(FORCE, RADIUS) / (radius - a0)
    if 0.1 < turn < 1.0 and radius > 0.0:
        radius = a0 + few_digits(turn) * (radius - a0)
    h = attempt.duration_to(radius, longest)
    if h is not None and h > 0.0:
        probe = radius + AHEAD * (radius - a0)
        onwards = attempt.residual(h, probe) if probe > run.law.lowest else 0.0
        if onwards * (radius - a0) >= 0.0:
            return _passing(run, attempt, radius, h, longest)
    run.counters.rejected_steps += 1
    if abs(radius - a0) > FOLD * run.largest_travel:
        run.travel = 0.5 * abs(radius - a0)
        return longest
    return _at_limit(run, attempt, radius, longest)


def _passing(run: Run, attempt: Attempt, radius: float, h: float, longest: float) -> float:
    """The edge is at ``radius`` after ``h`` and goes on from there: commit that, if it is straight enough."""
    surface = attempt.surface_at(h, radius)
    force = surface.force(run.body)
    row = (run.time + h, radius, force, surface.penetration)
    deviation = run.judge(attempt.segment, surface, force).along_edge(row)
    change = min(2.0, 0.95 / math.sqrt(max(deviation, 1e-6)))
    travel = few_digits(max(change, 0.2) * abs(radius - run.surface.radius), run.largest_travel)
    run.travel = min(run.largest_travel, travel)
    if deviation > 2.0 and radius > 0.0:
        run.counters.rejected_steps += 1
        return longest
    run.commit(run.time + h, surface, force)
    if radius == 0.0:
        run.lost()
    return 1.5 * h


def _at_limit(run: Run, attempt: Attempt, radius: float, longest: float) -> float:
    """No step towards ``radius`` is stable, however short: the edge runs."""
    a0 = run.surface.radius
    outward = _outward(run, attempt, radius)
    event = Event("snap-in" if outward else "pull-off", run.time, run.surface.penetration, run.force, a0)
    instantaneous.run_free(run, attempt, outward)
    run.travel = run.largest_travel
    if run.outcome is None and run.surface.radius == a0:  # it holds for now, though not for so long
        tick = 4.0 * math.ulp(run.time)
        if longest > tick:
            return max(0.25 * longest, tick)
        run.commit(run.time + longest, attempt.surface_at(longest, a0))
    far = abs(run.surface.radius - a0) > run.largest_travel
    if far and isinstance(run.law, Griffith) and run.outcome is None:
        run.events.append(event)
    return longest


def _outward(run: Run, attempt: Attempt, radius: float) -> bool:
    """Whether an edge that cannot stay runs outward: towards ``radius``, or on as before.

    The latter if both ways are open: it has overstepped a limit point by a hair, where a step back may be
    noise.
    """
    a0 = run.surface.radius
    opposite = 2.0 * a0 - radius
    if run.heading != 0.0 and run.law.lowest < opposite < run.scene.indenter.edge:
        pull = attempt.residual(0.0, opposite)
        if (pull < -run.law.closed) if opposite > a0 else (pull > run.law.closed):
            return run.heading > 0.0
    return radius > a0


def let_go(run: Run, segment: Segment, longest: float) -> float:
    """Without adhesion the contact shrinks to a point as the force goes to zero, within ``longest``."""
    ends = [segment.value(run.time), segment.value(run.time + longest)]
    h = longest * ends[0] / (ends[0] - ends[1])
    attempt = run.attempt(segment)
    a0 = run.surface.radius
    if a0 > run.travel:
        return by_distance(run, attempt, a0 - run.travel, h)
    run.commit(run.time + h, attempt.surface_at(h, 0.0))
    run.lost()
    return h
