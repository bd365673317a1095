"""Instantaneous events: first contact, unstable edge motion, lift-off. Nothing is committed here.

Penetration positive downwards, force positive in compression.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

from scipy.optimize import brentq

from bem_solver.control import StepStart
from bem_solver.history import SurfaceHistory
from bem_solver.root_search import first_stable, rising_root
from bem_solver.start import contact_scale, equilibrium
from bem_solver.surface import ContactSurface
from bem_solver.surface_points import HalfSpaceState
from bem_solver.trial import EDGE_ACCURACY, TrialContact, evaluate
from contact_scene import Outcome, OutcomeKind, TabulatedProfile

_STEPS_WITHOUT_CONTACT = 64
"""Steps per interval in which an indenter without contact looks for the first one."""
_FIRST_CONTACT_STEP = 1e-6
"""First step into contact, relative to the interval: positive beyond rounding, too short for the history."""
_SCAN = 1.02, 4
"""Ratio of neighbouring contact radii in the search for the next stable one, and how many are passed at once
where the residual is nowhere near zero."""
_TOUCHING = 1e-12
"""Distance from the touch, relative to the interval, that is rounding."""
_ZERO_RESIDUAL = 1e-9
"""Residual, relative to the work of adhesion or the mean pressure, below which it may be rounding."""
_SMALLEST_CONTACT, _LARGEST_CONTACT = 1e-3, 1e3
"""Radii between which a stable contact is sought, in estimated largest contact radii."""
_STEP_AFTER_EVENT = 1e-3
"""First step after an unstable motion, relative to the interval."""
LOST_FORCE = 1e-9
"""Contact counts as lost below this fraction of the largest force: steep profiles keep a small radius."""
LOST_RADIUS = 2e-3
"""Contact of an adhesionless indenter counts as lost below this fraction of its largest radius."""


@dataclass(frozen=True)
class FreeMotion:
    """A step without contact: the parameter and state it ends with."""

    parameter: float
    contact: HalfSpaceState


@dataclass(frozen=True)
class EdgeJump:
    """A stable contact of another radius at the load of ``parameter``, and the step to continue with.

    ``event``: the jump is an event of its own rather than the motion of a step.
    """

    parameter: float
    trial: TrialContact
    next_step: float
    event: bool = False


def without_contact(start: StepStart) -> FreeMotion | EdgeJump | Outcome:
    """Without contact, move until the load turns positive, then make the first contact, or end the run."""
    problem, state, interval = start.problem, start.state, start.interval
    contact, parameter, length = state.contact, state.parameter, interval.length
    if interval.control == "force" and interval.prescribed(length) < 0.0:
        return Outcome(OutcomeKind.DETACHED, "pulled without contact", contact.time)
    later = min(parameter + length / _STEPS_WITHOUT_CONTACT, length)
    if interval.prescribed(later) <= 0.0:
        return _moved(start, later, contact.penetration)
    if interval.prescribed(parameter) < 0.0:
        touch = brentq(interval.prescribed, parameter, later, xtol=1e-14 * length)
        if touch > parameter + _TOUCHING * length:
            return _moved(start, touch, 0.0)
        parameter = touch
    if interval.control == "force" and contact.penetration < 0.0:
        return _moved(start, parameter, 0.0)
    if problem.scene.bare_plane_tip > 0.0:
        whole = evaluate(problem, contact, 0.0, problem.scene.bare_plane_tip, interval.control, 0.0)
        return EdgeJump(parameter, whole, _FIRST_CONTACT_STEP * length)
    first = min(parameter + _FIRST_CONTACT_STEP * length, length)
    while interval.prescribed(first) <= 0.0 and first < length:
        first = min(parameter + 2.0 * (first - parameter), length)
    load = interval.prescribed(first)
    scale = start.settings.scale if interval.control == "force" else contact_scale(problem.scene, load)
    trial = equilibrium(problem, contact, interval.control, load, scale)
    if trial is None:
        return Outcome(OutcomeKind.NO_EQUILIBRIUM, "no first contact found", contact.time)
    return EdgeJump(first, trial, max(first - parameter, _FIRST_CONTACT_STEP * length))


def _moved(start: StepStart, parameter: float, held: float) -> FreeMotion:
    """The indenter without contact, taken to a parameter; ``held`` is its penetration if that is free."""
    contact, interval = start.state.contact, start.interval
    penetration = held if interval.control == "force" else interval.prescribed(parameter)
    free = ContactSurface.free(start.problem.annuli)
    return FreeMotion(parameter, HalfSpaceState(interval.time(parameter), penetration, free, contact.history))


def unstable_motion(start: StepStart, receding: bool) -> EdgeJump | Outcome:
    """The next stable contact at the present load, in the direction in which the edge moves unstably."""
    problem, settings, state, interval = start.problem, start.settings, start.state, start.interval
    contact, parameter = state.contact, state.parameter
    limit = problem.scene.indenter.edge
    load = interval.prescribed(parameter)

    def trial(edge: float) -> TrialContact:
        return evaluate(problem, contact, 0.0, edge, interval.control, load)

    rounding = _ZERO_RESIDUAL * (problem.work or 0.5 * state.largest_force / contact.edge)
    reach = problem.length_at(contact.edge) / settings.divisions
    # Start outside the interval already searched, to avoid an endless loop.
    searched = start.smallest_travel
    edge = contact.edge - searched if receding else min(contact.edge + searched, limit)
    smallest = max(_SMALLEST_CONTACT * settings.scale, problem.zone)  # shorter than the zone: no contact
    end = smallest if receding else min(_LARGEST_CONTACT * settings.scale, limit, problem.body.largest)
    way_ahead = edge > end if receding else edge < end
    places = [rest + beyond for rest in contact.history.past_kinks for beyond in (0.0, problem.zone)]
    if isinstance(problem.scene.indenter, TabulatedProfile):
        places += problem.scene.indenter.radii
    found = first_stable(trial, edge, end, *_SCAN, rounding, places) if way_ahead else None
    if found is not None or (way_ahead and end == limit):
        if found is None:
            reached = trial(limit)
        else:
            low, high = sorted(found)
            accuracy = EDGE_ACCURACY * settings.tolerance * problem.length_at(high if receding else low)
            reached = rising_root(trial, found[1], 0.0, low, high, accuracy).trial
        far = abs(reached.motion.new_edge - contact.edge) > reach
        return EdgeJump(parameter, reached, _STEP_AFTER_EVENT * interval.length, far)
    if receding:
        reason = f"no stable contact at {interval.control} {load:.6g}"
        return Outcome(OutcomeKind.DETACHED, reason, contact.time)
    return Outcome(OutcomeKind.OUT_OF_RANGE, "the contact spreads without bound", contact.time)


def contact_lost(start: StepStart) -> bool:
    """Whether an adhesionless contact has become too small to follow, or has shrunk to a plane tip."""
    problem, state = start.problem, start.state
    edge, before = state.contact.edge, state.accepted.rows[-2:][0].edge
    return problem.work == 0.0 and (
        edge < LOST_RADIUS * state.largest_edge
        or edge <= problem.scene.bare_plane_tip < before
        or abs(state.contact.surface.force) < LOST_FORCE * state.largest_force
    )


def lift_off(start: StepStart) -> HalfSpaceState:
    """State when the last, vanishing contact of an adhesionless indenter is gone."""
    problem, state, interval = start.problem, start.state, start.interval
    before, last = state.accepted.rows[-2:][0], state.accepted.rows[-1]
    high, low = (float(problem.scene.indenter.height(row.edge)) for row in (before, last))
    ahead = low / (high - low) if high > low and problem.scene.ends_in_a_point else 0.0
    contact, penetration = state.contact, last.load + ahead * (last.load - before.load)
    if interval.control == "force" and ahead > 0.0:  # contact ends with the force
        forces = interval.prescribed(before.parameter), interval.prescribed(last.parameter)
        ahead = forces[1] / (forces[0] - forces[1]) if forces[0] > forces[1] else ahead
    end = min(last.parameter + ahead * (last.parameter - before.parameter), interval.length)
    if interval.control != "force":
        penetration = interval.prescribed(end)
    history = replace(SurfaceHistory.blank(len(problem.chain)), outer=contact.history.outer)
    free = ContactSurface.free(problem.annuli)
    return HalfSpaceState(interval.time(end), penetration, free, history)


def released(start: StepStart) -> HalfSpaceState:
    """State when contact is lost at once on a spring: the indenter goes to where the stage is."""
    state, interval = start.state, start.interval
    free = ContactSurface.free(start.problem.annuli)
    stage = interval.prescribed(state.parameter)
    contact = state.contact
    return HalfSpaceState(contact.time, stage, free, contact.history, contact.closure)
