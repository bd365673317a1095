"""The end of a contact whose edge takes up more the faster it opens, but runs away all the same.

No edge with a law without an upper bound moves at fixed time: every driving force gives it a finite speed.
That speed is a high power of the force, and a collapse may take less time than floating point can tell from
none. A law with an upper bound has limit points beyond it, as without a law.
"""

from __future__ import annotations

import math

import numpy as np

from contact_scene import Segment
from validation.reference.rated_edge import opening_speed
from validation.reference.tracking.law import Griffith
from validation.reference.tracking.problem import FrontProblem
from validation.reference.tracking.state import FrontState
from validation.reference.tracking.step_history import TIME
from validation.reference.tracking.surface import Surface

COLLAPSE_TICKS = 1024.0
"""Time in which the edge would run over the whole contact, in units of the last place of the time, below
which no step follows it: fewer could not be divided into steps."""
RECENT_TICKS = 1e6
"""Longest last step, in the same units, after which an edge may be so fast; longer ones are not looked
into."""
RADII_ON_THE_WAY = 96
"""Smaller radii at which the edge has to be driven on, and which are recorded: the energy it takes up is an
integral over them."""


def collapse_at_once(problem: FrontProblem, state: FrontState, segment: Segment) -> tuple[Surface, ...]:
    """Where an edge with a rate law passes if it runs over the whole contact within the rounding of the time.

    Parameters
    ----------
    problem, state : FrontProblem, FrontState
        Present state.
    segment : Segment
        Load step.

    Returns
    -------
    tuple of Surface
        At smaller and smaller radii, down to that at which the contact is as small as its process zone; empty
        if the edge does not run so fast, or comes to rest on the way.
    """
    condition, surface, rows = problem.condition, state.surface, state.history.rows
    tick = math.ulp(state.time)
    if not isinstance(condition, Griffith) or surface.radius <= condition.smallest_radius:
        return ()
    if math.isfinite(condition.adhesion.opening(math.inf)):
        return ()  # beyond that the edge moves at fixed time, and contact is lost all at once
    if len(rows) > 1 and rows[-1][TIME] - rows[-2][TIME] > RECENT_TICKS * tick:
        return ()
    speed = opening_speed(condition.adhesion, condition.closure(surface, problem.body))
    if surface.radius >= COLLAPSE_TICKS * tick * speed:
        return ()
    trial = problem.trial(state, segment)
    radii = np.geomspace(surface.radius, condition.smallest_radius, RADII_ON_THE_WAY + 1)[1:]
    smaller = tuple(trial.surface_at(0.0, float(radius)) for radius in radii)
    work = condition.adhesion.work
    return smaller if all(condition.closure(one, problem.body) > work for one in smaller) else ()
