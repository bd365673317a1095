"""Step error estimator on graded annuli: departures of edge and load from their extrapolations."""

from __future__ import annotations

import math
from collections.abc import Callable

from bem_solver.half_space_state import HalfSpaceState
from bem_solver.loading_intervals import LoadingInterval
from bem_solver.options import DEFAULT_RESOLUTION
from bem_solver.run_state import StepStart
from bem_solver.step_control import departure_from_line
from bem_solver.surface import ContactSurface
from bem_solver.trial import TrialContact

_BENT_SHARE_OF_ZONE = 0.04
"""Travel of a step, in process zones, from which on its path is a parabola through another row and it is
judged by that: a quarter of the longest step within a zone at the default resolution, and at finer ones that
quarter, too. Below it an edge sets out or turns, and earlier rows tell little; steady steps are longer."""
_SHARE_OF_TRAVEL = 2.0
"""Error of extrapolating the edge that is allowed, in step tolerances of its travel: the speed of the edge,
on which the closure depends, is then met to less than half as much. Within a zone the closure depends on
the place of the edge, too."""
_SHARE_OF_FREE_TRAVEL = 0.5
"""The same within a zone under a controlled force: no prescribed penetration holds the edge back there, and
the errors of its speed add up to one of the time at which contact is lost."""
_LEAST_SHARE_OF_ZONE = 0.5
"""Least travel for that, in process zones: the closure sees no less of the path than about as much."""
_LEAST_SHARE_OF_RADIUS = 1e-3
"""Least travel for that of an edge that passes over zones, in contact radii: an edge that misses its place by
that part of a tolerance changes the force by three times as much. The annuli it passes leave it uneven by
millionths of the radius, and no shorter step is more even."""
_SHARE_OF_WORK = 0.2
"""Change of the closure that is allowed over the error of extrapolating an edge that may pass over zones, in
step tolerances of the work of adhesion, where that is more than the travel allows: a closure that hardly
changes with the place of the edge tells it no closer, and shorter steps follow its unevenness."""
_MOST_SHARE_OF_RADIUS = 1e-2
"""Upper bound on that error as on that of a step over this part of the contact radius: where the closure is
level, as at a limit point, the force is to be right still."""
_LOAD_WEIGHT = 4.0
"""Weight of the departure of the load from a straight line against that of the edge in the step error."""
_LOAD_WEIGHT_AT_LIMIT = 16.0
"""The same weight where the edge travels its limit before the end of the step. The load may have a corner
there, the largest tension of the run; an eighth of the departure understates how far a row may miss it."""
_SCALE_OF_FIRST_LOAD = 0.01
"""Part of the load to be expected in an interval against which a load that starts from zero is measured."""
_SHARE_OF_TIP_FORCE = 0.1
"""Part of the force of a tip without load, the flat punch's at the work of adhesion, against which a load is
measured at least: near zero it is the difference of two such forces, and no rounder than they are."""
_RATED_WEIGHT = 5.0
"""Weight of the departure from a straight line relative to the length the edge is resolved on against that
relative to its travel, where the speed counts, of an opening edge: it may then change its speed by a sixth in
a step."""
_LEAST_RATED_TRAVEL = 1e-4
"""Least travel for that, in contact radii: below it an edge is about to set out."""


def free_load(interval: LoadingInterval, contact: HalfSpaceState) -> float:
    """The quantity that is not prescribed: penetration under a controlled force, otherwise the force."""
    return contact.penetration if interval.control == "force" else contact.surface.force


def free_load_of(interval: LoadingInterval, trial: TrialContact) -> float:
    """The same of a trial."""
    return trial.motion.new_penetration if interval.control == "force" else trial.surface.force


def least_bent_travel(start: StepStart, edge: float) -> float:
    """Travel of a step from which on the path of an edge is a parabola."""
    finer = min(1.0, DEFAULT_RESOLUTION / start.settings.divisions)
    return _BENT_SHARE_OF_ZONE * finer * start.problem.length_at(edge)


def step_error(
    start: StepStart,
    trial: TrialContact,
    step: float,
    slope: float = 0.0,
    rate_step: float | None = None,
) -> float:
    """Departure of edge and load from straight lines, in tolerances.

    Parameters
    ----------
    start : StepStart
    trial : TrialContact
        At the end of the step.
    step : float
    slope : float, optional
        Derivative of the residual with the edge at the end of the step, that of the last one by default (0).
    rate_step : float, optional
        Step for which rates are taken, ``step`` itself by default.

    Returns
    -------
    float
    """
    rates = start.state.accepted.rates(step if rate_step is None else rate_step)
    of_edge, of_load, _ = _departures(start, trial, step, rates, slope)
    return max(of_edge, _LOAD_WEIGHT * of_load) / start.settings.tolerance


def load_error(start: StepStart, trial: TrialContact, step: float) -> float:
    """Departure of the load alone from a straight line, in tolerances."""
    rates = start.state.accepted.rates(step)
    return _LOAD_WEIGHT * _departures(start, trial, step, rates)[1] / start.settings.tolerance


def error_in_the_middle(start: StepStart, trial: TrialContact, middle: TrialContact, step: float) -> float:
    """Departure of the load from a straight line where it is known in the middle of a step, in tolerances.

    After a kink no rate is known. A load that goes on as before and then turns may end near where it began.

    Parameters
    ----------
    start : StepStart
    trial, middle : TrialContact
        At the end of the step, and of half of it.
    step : float

    Returns
    -------
    float
    """
    before, after = free_load(start.interval, start.state.contact), free_load_of(start.interval, trial)
    missed = abs(free_load_of(start.interval, middle) - 0.5 * (before + after))
    scale = _load_scale(start, trial.surface, step)
    return _LOAD_WEIGHT * missed / scale / start.settings.tolerance if scale > 0.0 else 0.0


def error_at_limit(
    start: StepStart, trial: TrialContact, step: float, at_rest: Callable[[], TrialContact]
) -> float:
    """Step error where the edge has travelled as far as it may: of the load, which may have a corner.

    It misses no more than by what the load would have changed without one, however fast the edge runs. The
    edge counts as anywhere: one that has set off within the step has not moved evenly. Where rates are
    unknown, after a kink, it does so in steps in which a branch relaxes: none of them is told by its start.

    Parameters
    ----------
    start : StepStart
    trial : TrialContact
        At the end of the step.
    step : float
    at_rest : callable() -> TrialContact
        At the same time with the edge where it stands. Where rates are unknown, it tells how the load changes
        until the edge sets off.

    Returns
    -------
    float
    """
    rates = start.state.accepted.rates(step)
    known = len(start.state.accepted.rows) > 1
    if not known:
        before = free_load(start.interval, start.state.contact)
        rates = rates[0], (free_load_of(start.interval, at_rest()) - before) / step
    of_edge, of_load, change = _departures(start, trial, step, rates)
    of_load = min(of_load, 0.125 * change)
    if not known and trial.motion.duration <= start.problem.chain.relaxation.min(initial=math.inf):
        of_edge = 0.0
    return max(of_edge, _LOAD_WEIGHT_AT_LIMIT * of_load) / start.settings.tolerance


def _departures(
    start: StepStart, trial: TrialContact, step: float, rates: tuple[float, float], slope: float = 0.0
) -> tuple[float, float, float]:
    """Departures of edge and load from lines of these rates, and the change of load on its line, to scale."""
    problem, interval, contact = start.problem, start.interval, start.state.contact
    (edge_rate, load_rate), edge = rates, trial.motion.new_edge
    load, scale = free_load_of(interval, trial), _load_scale(start, trial.surface, step)
    missed = edge - contact.edge - edge_rate * step
    of_edge = departure_from_line(missed, problem.length_at(edge))
    if problem.rated and edge < contact.edge:
        travel = max(abs(edge - contact.edge), _LEAST_RATED_TRAVEL * contact.edge)
        of_edge = max(of_edge, departure_from_line(missed, _RATED_WEIGHT * travel))
    passes = abs(edge - contact.edge) >= least_bent_travel(start, edge)
    if passes and problem.curves and start.state.accepted.curved:
        of_path = _departure_from_path(start, edge, step)
        of_edge = min(of_edge, of_path) if problem.over_zones(contact.edge) else of_path
    if problem.over_zones(contact.edge) and not problem.rated:  # a rated edge is told by its speed
        if start.state.accepted.curved:
            missed = edge - start.state.accepted.edge_after(step)
        of_edge = min(of_edge, _departure_of_closure(start, edge, abs(missed), slope))
    of_load = departure_from_line(load - free_load(interval, contact) - load_rate * step, scale)
    return of_edge, of_load, abs(load_rate * step) / scale if scale > 0.0 else 0.0


def _load_scale(start: StepStart, surface: ContactSurface, step: float) -> float:
    """What the departure of the free load is measured against, at the end of a step.

    What a relaxing contact bears when it is pulled follows from the steps before, and after a hard press it
    is far less than the largest force of the run. There departures are relative to the larger of the force
    and its part due to the singularity of the edge. Without adhesion or history the largest force serves.
    """
    problem, interval, edge = start.problem, start.interval, surface.edge
    stiffness = 2.0 * edge * problem.chain.relaxed
    softer = problem.scene.loading.compliance * stiffness if interval.control == "stage" else 0.0
    to_come = interval.span * (1.0 if interval.control == "force" else stiffness / (1.0 + softer))
    tip = math.sqrt(8.0 * math.pi * problem.work * problem.chain.relaxed * edge**3)
    force = max(start.state.largest_force, abs(surface.force))
    if problem.work > 0.0 and problem.viscoelastic:
        opens = edge < start.state.contact.edge  # behind a closing edge the singularity may be a thin layer's
        singular = min(abs(surface.singular_force), math.inf if opens else tip)
        force = min(force, max(abs(surface.force), singular))
    scale = max(force, _SCALE_OF_FIRST_LOAD * to_come, _SHARE_OF_TIP_FORCE * tip)
    if interval.control == "force":  # a penetration that misses its line does so over this step
        return scale * problem.chain.relaxed / (stiffness * problem.chain.modulus_of_ramp(step))
    return scale / max(softer, 1.0)  # on a soft spring it is the penetration that misses its line the farther


def _departure_of_closure(start: StepStart, edge: float, missed: float, slope: float) -> float:
    """Change of the closure over the error of extrapolating the edge, relative to what is allowed.

    Or that error itself, if it is larger relative to what is allowed of it. The ``slope`` of the closure is
    that at the end of the step: before a place where the edge has rested, or after its load has turned, it
    is many times that of the step before.
    """
    problem = start.problem
    slope = slope or start.state.last_slope
    if slope <= 0.0:
        return math.inf
    of_radius = missed / (_SHARE_OF_TRAVEL * _MOST_SHARE_OF_RADIUS * edge)
    return max(of_radius, slope * missed / (_SHARE_OF_WORK * problem.work))


def _departure_from_path(start: StepStart, edge: float, step: float) -> float:
    """Error of extrapolating the path of the edge to the end of a step, relative to what is allowed."""
    travel = abs(edge - start.state.contact.edge)
    passed = travel > start.problem.zone
    travel = max(
        travel, _LEAST_SHARE_OF_RADIUS * edge if passed else _LEAST_SHARE_OF_ZONE * start.problem.zone
    )
    missed = abs(edge - start.state.accepted.edge_after(step))
    free = start.interval.control == "force" and not start.problem.over_zones(start.state.contact.edge)
    share = _SHARE_OF_FREE_TRAVEL if free else _SHARE_OF_TRAVEL
    advancing = edge > start.state.contact.edge
    allowed = min(share * travel, start.problem.longest_travel(edge, advancing))
    return missed / allowed if allowed > 0.0 else math.inf
