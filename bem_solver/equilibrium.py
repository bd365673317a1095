"""Equilibria at one instant: roots over the edge, starts, first contact, what follows an unstable motion.

The root through which the residual rises is found by secants, safeguarded by a bracket once there is one;
the way of an unstable edge is looked over in equal ratios of the radius. Nothing is committed here.
Penetration positive downwards, force positive in compression.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cache
from typing import Literal

import numpy as np
from scipy.optimize import brentq

from bem_solver.control import StepStart
from bem_solver.creep import Chain
from bem_solver.history import SurfaceHistory
from bem_solver.problem import Problem
from bem_solver.surface import ContactSurface
from bem_solver.surface_points import HalfSpaceState
from bem_solver.trial import EDGE_ACCURACY, TrialContact, evaluate
from contact_scene import Indenter, Material, Outcome, OutcomeKind, Scene, TabulatedProfile

_ITERATIONS = 200
"""Evaluations before the search is given up; bisection alone would need about 60."""
_ROUNDING = 4e-16
"""Relative width of a bracket that holds no further floating-point number."""


@dataclass(frozen=True)
class RootSearchResult:
    """Last trial at ``x``, and the position of the root: there, below ``low``, or above ``high``.

    ``slope`` is the derivative as measured in the search; zero if it was not.
    """

    position: Literal["converged", "below", "above"]
    x: float
    trial: TrialContact
    slope: float


def rising_root(
    evaluate: Callable[[float], TrialContact],
    guess: float,
    slope: float,
    low: float,
    high: float,
    accuracy: float,
    residual: float = math.inf,
) -> RootSearchResult:
    """Root of ``evaluate(x).residual`` in [low, high], where the residual rises through zero.

    Beyond an edge at rest the residual rises as a root of the distance: a slope over less than ``accuracy``
    tells nothing there, so that of the last secant over more judges the radius, or a change of sign.
    """
    negative: float | None = None  # largest x known with residual < 0
    positive: float | None = None  # smallest x known with residual > 0
    wide, measured = slope, 0.0  # over at least the accuracy
    x = min(max(guess, low), high)
    trial = evaluate(x)
    for iteration in range(_ITERATIONS):
        r = trial.residual
        if not math.isfinite(r):
            raise FloatingPointError(f"the closure is not finite at contact radius {x:.6g}")
        if r < 0.0:
            if x >= high:
                return RootSearchResult("above", x, trial, measured)
            negative = x if negative is None else max(negative, x)
        elif r > 0.0:
            if x <= low:
                return RootSearchResult("below", x, trial, measured)
            positive = x if positive is None else min(positive, x)
        if r == 0.0 or (iteration > 0 and abs(r) <= min(slope * accuracy, wide * accuracy, residual)):
            return RootSearchResult("converged", x, trial, measured)
        left = low if negative is None else negative
        right = high if positive is None else positive
        near = abs(r) <= residual or right - left <= _ROUNDING * abs(x)
        if near and right - left <= accuracy:
            return RootSearchResult("converged", x, trial, measured)
        new = min(max(x - r / slope, left), right) if slope > 0.0 else (right if r < 0.0 else left)
        bracketed = negative is not None and positive is not None
        if not bracketed and (iteration > 0 or new == x) and abs(new - x) < accuracy:
            new = min(max(x - math.copysign(accuracy, r), left), right)
        if bracketed and (not left < new < right or iteration % 6 == 5):
            new = 0.5 * (left + right)
        if new == x:
            return RootSearchResult("converged", x, trial, measured)
        new_trial = evaluate(new)
        secant = (new_trial.residual - r) / (new - x)
        slope = max(secant, 0.0)
        if abs(new - x) >= accuracy:
            wide = measured = slope
        x, trial = new, new_trial
    raise FloatingPointError("the search for the edge did not converge")


def first_stable(
    trial: Callable[[float], TrialContact],
    edge: float,
    end: float,
    ratio: float,
    stride: int,
    rounding: float = 0.0,
    places: Sequence[float] = (),
) -> tuple[float, float] | None:
    """Two radii between which the contact becomes stable first on the way of an unstable edge."""
    way = 1.0 if end > edge else -1.0
    count = math.ceil(abs(math.log(end / edge)) / math.log(ratio))
    radii = [edge * ratio ** (way * n) for n in range(count)] + [end]
    known: dict[int, float] = {}

    def excess(n: int) -> float:
        """How strongly the edge is driven on; negative where it is stable."""
        if n not in known:
            known[n] = -way * trial(radii[n]).residual
        return known[n]

    for first in range(0, count, stride):
        last, before = min(first + stride, count), max(first - stride, 0)
        one, two, three = (first, last, min(last + stride, count)) if first == 0 else (before, first, last)
        # where it bends by as much as is left, it may fall to zero between
        least = min(excess(one), excess(two), excess(three))
        bent = three == two or abs(excess(one) - 2.0 * excess(two) + excess(three)) >= least
        low, high = sorted((radii[before], radii[last]))
        if bent or any(low <= place <= high for place in places):
            below = (n for n in range(before + 1, last + 1) if excess(n) < -rounding)
            if (n := next(below, None)) is not None:
                return radii[n - 1], radii[n]
    return None


_SCAN_RATIO, _SCAN_STRIDE = 1.04, 5
"""Ratio of neighbouring radii in the scan for the largest stable contact, and how many are passed at once
where the residual is nowhere near zero."""
_SCAN_START, _SCAN_START_ON_LAYER, _SCAN_END = 64.0, 4.0, 1e-6
"""Largest and smallest radius of the scan, in the estimated contact radius. The rank of a layer grows with
the radius: there the scan starts at the second, doubled while the edge advances from it."""


def elastic_problem(problem: Problem, modulus: float) -> Problem:
    """The same problem on an elastic half-space with the given Young's modulus."""
    material = Material(modulus, problem.scene.material.poisson)
    return replace(problem, chain=Chain(material), scene=replace(problem.scene, material=material))


def untouched_state(problem: Problem, penetration: float) -> HalfSpaceState:
    """The state at time 0 without contact and history."""
    blank = SurfaceHistory.blank(len(problem.chain))
    return HalfSpaceState(0.0, penetration, ContactSurface.free(problem.annuli), blank)


def equilibrium(
    problem: Problem, state: HalfSpaceState, control: str, value: float, scale: float
) -> TrialContact | None:
    """The largest stable contact at once under the given control, or ``None``.

    Edges from far above ``scale`` downwards are looked over for where the residual falls below zero, which
    brackets the stable root. A flat face, which touches as a whole, is in full contact unless its edge opens.
    On a layer a contact that would be larger than any that is taken stands for itself.
    """
    trial = cache(lambda edge: evaluate(problem, state, 0.0, edge, control, value))
    indenter = problem.scene.indenter
    edge = limit = min(indenter.edge, _SCAN_START * scale, problem.body.largest)
    if problem.scene.body is not None:
        edge = min(_SCAN_START_ON_LAYER * scale, limit)
    while edge < limit and trial(edge).residual <= 0.0:
        edge = min(2.0 * edge, limit)
    end, largest = _SCAN_END * scale, trial(edge)
    if edge == problem.body.largest and largest.residual <= 0.0:
        return largest
    if edge == indenter.edge and min(largest.residual, largest.closure - problem.work) <= 0.0:
        return largest
    while edge > end and trial(edge).residual <= 0.0:
        edge /= _SCAN_RATIO
    places = indenter.radii if isinstance(indenter, TabulatedProfile) else ()
    found = first_stable(trial, edge, end, _SCAN_RATIO, _SCAN_STRIDE, places=places) if edge > end else None
    if found is None:
        return None
    high, low = found
    return rising_root(trial, low, 0.0, low, high, 1e-11 * high).trial


def radius_where(indenter: Indenter, reached: Callable[[float], bool]) -> float:
    """Smallest radius at which a condition that grows with radius holds (by halving in log radius)."""
    small, large = 1e-100, 1e100
    for _ in range(200):
        middle = float(np.sqrt(small) * np.sqrt(large))
        small, large = (small, middle) if reached(middle) else (middle, large)
    return large


def contact_scale(scene: Scene, penetration: float) -> float:
    """Order of magnitude of the contact radius at a penetration.

    Where the profile is as high; with adhesion at least where ``E0* h dh/dr = dgamma`` of its height h.
    """
    indenter = scene.indenter
    if np.isfinite(indenter.edge):
        return indenter.edge
    depth = abs(penetration)
    geometric = radius_where(indenter, lambda r: float(indenter.height(r)) >= depth) if depth > 0 else 0.0
    if scene.adhesion is None or not scene.is_adhesive:
        return geometric
    balance = scene.adhesion.work / scene.material.relaxed_plane_modulus
    adhesive = radius_where(indenter, lambda r: float(indenter.height(r) * indenter.slope(r)) >= balance)
    return max(geometric, adhesive)


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
    scale = start.problem.scale if interval.control == "force" else contact_scale(problem.scene, load)
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
    problem, state, interval = start.problem, start.state, start.interval
    contact, parameter = state.contact, state.parameter
    limit = problem.scene.indenter.edge
    load = interval.prescribed(parameter)

    def trial(edge: float) -> TrialContact:
        return evaluate(problem, contact, 0.0, edge, interval.control, load)

    rounding = _ZERO_RESIDUAL * (problem.work or 0.5 * state.largest_force / contact.edge)
    reach = problem.length_at(contact.edge) / problem.divisions
    # Start outside the interval already searched, to avoid an endless loop.
    searched = start.smallest_travel
    edge = contact.edge - searched if receding else min(contact.edge + searched, limit)
    smallest = max(_SMALLEST_CONTACT * problem.scale, problem.zone)  # shorter than the zone: no contact
    end = smallest if receding else min(_LARGEST_CONTACT * problem.scale, limit, problem.body.largest)
    way_ahead = edge > end if receding else edge < end
    places = [rest + beyond for rest in contact.history.past_kinks for beyond in (0.0, problem.zone)]
    if isinstance(problem.scene.indenter, TabulatedProfile):
        places += problem.scene.indenter.radii
    found = first_stable(trial, edge, end, *_SCAN, rounding, places) if way_ahead else None
    reached = None
    if found is not None:
        low, high = sorted(found)
        accuracy = EDGE_ACCURACY * problem.tolerance * problem.length_at(high if receding else low)
        reached = rising_root(trial, found[1], 0.0, low, high, accuracy).trial
    elif way_ahead and end == limit:
        reached = trial(limit)
    if reached is not None and (not receding or reached.zone < reached.motion.new_edge):
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
