"""Instantaneous events: load jumps, unstable motion of the edge, first contact.

At a fixed time the half-space is glassy and its response reversible, so a jump of the load is a path of
equilibria, all computed from the state before it. Its rows share one time; the work is done along them.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from itertools import pairwise

from contact_scene import Segment
from validation.reference.tracking.arrest import arrest_radius
from validation.reference.tracking.law import Griffith, NoTension
from validation.reference.tracking.problem import FrontProblem
from validation.reference.tracking.state import FrontState
from validation.reference.tracking.step_outcome import NO_STABLE_CONTACT, FrontCandidate, StepOutcome
from validation.reference.tracking.surface import Body, Surface
from validation.reference.tracking.trial import Trial

Equilibrium = Callable[..., "Surface | None"]
"""Surface at a share of a load jump, searched from a radius, in finer intervals if a third number says by how
much; ``None`` where contact is lost."""
JUMP_PARTS = 32
"""Parts of a load jump during which the edge moves."""
ADHESIVE_STRIDE = 0.15
"""Search interval for the arrest of an unstable edge, in process zones."""
ELASTIC_STRIDE = 0.02
"""The same for an elastic half-space, in radii: no field varies there within a process zone."""
ADHESIONLESS_STRIDE = 0.02
"""The same without adhesion, in radii."""
TOUCHING_STRESS = 1e-12
"""Edge stress, relative to the largest, below which two plane faces just touch."""
LOST_FORCE = 1e-11
"""Contact that is being lost counts as lost below this fraction of the peak force."""
AT_SMALLEST_RADIUS = 1e-6
"""Distance from the smallest radius, relative to it, below which a jump has shrunk the contact that far."""
EVEN_RELEASE = 0.03
"""Change of the energy release rate of the glassy tip from row to row of a jump, relative to the largest, up
to which its path is smooth: where an edge that has rested sets off, it changes within a process zone."""
HALVINGS = 8
"""Halvings of parts of a jump in which it changes by more."""
BISECTIONS = 24
"""Bisections of the part of a jump in which contact begins or is lost."""
FINER_SEARCHES = (1.0, 1.0 / 16.0, 1.0 / 256.0)
"""Search intervals in turn where contact is lost, relative to the usual one: the stable radius and the
unstable one below it come together there, and an interval that holds both shows neither."""
FINER_REACH = 32.0
"""Finer intervals searched: two of those before, in one of which the stable radius must be."""


def at_rest(segment: Segment, value: float) -> Segment:
    """The control of a segment, held at a value."""
    return replace(segment, value=lambda time: value, rate=lambda time: 0.0, kinks=(), linear=True)


def load_jump(problem: FrontProblem, state: FrontState, segment: Segment) -> StepOutcome:
    """The load jumps to the first value of the segment.

    Parameters
    ----------
    problem, state : FrontProblem, FrontState
        Present state.
    segment : Segment
        Load step that begins now.

    Returns
    -------
    StepOutcome
    """
    start, force_controlled = state.surface, segment.control == "force"
    before = segment.present(start.penetration, state.force)
    change = segment.value(segment.start) - before
    begins = start.radius == 0.0
    whole = problem.trial(state, segment)
    if not (begins and force_controlled) and _rests_at_once(whole, start.radius):
        end = problem.candidate(state.time, whole.surface_at(0.0, start.radius))
        return StepOutcome(candidates=(end,), reversible=True)

    def equilibrium(share: float, begin: float, finer: float = 1.0) -> Surface | None:
        load = at_rest(segment, before + share * change) if share < 1.0 else segment
        trial = problem.trial(state, load)
        radius = equilibrium_radius(problem, state, trial, begin, finer)
        return None if radius is None else trial.surface_at(0.0, radius)

    def along(shares: list[float], contact: bool = False) -> tuple[list[Surface], float, float, int | None]:
        return _equilibria(problem, equilibrium, start, shares, contact)

    rows, last, lost, runs = along(_shares(0.0, 1.0, begins, False), not begins)
    if rows and begins and last == 1.0:  # contact begins on the way: the parts are refined from there on
        first = 0.0 if force_controlled else _first_contact(equilibrium, start)
        rows, last, lost, runs = along(_shares(first, 1.0, True, False))
    elif last < 1.0:
        last, farthest = _last_contact(equilibrium, rows[-1] if rows else start, last, lost)
        rows, _, _, runs = along(_shares(0.0, last, begins, True)[:-1], True)
        rows.append(farthest)
        shortest = problem.condition.smallest_radius
        if rows and rows[-1].radius - shortest < AT_SMALLEST_RADIUS * shortest:
            return StepOutcome(
                candidates=(problem.candidate(state.time, rows[-1]),),
                equilibria=tuple(rows[:-1]),
                reversible=True,
                unstable_row=runs,
                below_zone=True,
            )
    return StepOutcome(
        candidates=(problem.candidate(state.time, rows[-1] if rows else start),),
        equilibria=tuple(rows[:-1]),
        reversible=True,
        unstable_row=0 if begins and isinstance(problem.condition, Griffith) else runs,
        kink=last == 1.0,
        detachment="" if last == 1.0 else NO_STABLE_CONTACT,
    )


def _rests_at_once(trial: Trial, radius: float) -> bool:
    """Whether the edge stays where it is at fixed time."""
    return max(_forces_at_once(trial, radius)) <= trial.condition.tolerance


def _forces_at_once(trial: Trial, radius: float) -> tuple[float, float]:
    """Inward and outward driving force on an edge that has come to ``radius`` at fixed time."""
    if isinstance(trial.condition, Griffith):
        return trial.forces_at_once(radius)
    if radius == trial.surface.radius:
        return trial.driving_forces(0.0)
    inward = trial.residual(0.0, radius)
    return inward, -inward if radius < trial.largest_radius else -1.0


def _shares(first: float, last: float, begins: bool, ends: bool) -> list[float]:
    """Shares of a jump; graded where contact begins or ends, for there the radius is a root of the load."""
    parts = [part / JUMP_PARTS for part in range(1, JUMP_PARTS + 1)]
    if begins:
        parts = [part**2 for part in parts]
    if ends:
        parts = [1.0 - (1.0 - part) ** 2 for part in parts]
    shares = [first + (last - first) * part for part in parts]
    return ([first] if first > 0.0 else []) + shares[:-1] + [last]


def _equilibria(
    problem: FrontProblem,
    equilibrium: Equilibrium,
    start: Surface,
    shares: list[float],
    contact: bool = False,
) -> tuple[list[Surface], float, float, int | None]:
    """Equilibria at the shares as far as there is contact, the last such share and the one after.

    With ``contact`` from the start on, rows before and after the largest unstable motion are among them, and
    the number of the row after it is told.
    """
    rows: list[Surface] = []
    last = 0.0
    lost = None
    for share in shares:
        surface = equilibrium(share, rows[-1].radius if rows else start.radius)
        if surface is None:
            lost = share
            break
        rows.append(surface)
        last = share
    unstable = None
    if contact and rows:
        rows, shares = [start, *rows], [0.0, *shares[: len(rows)]]
        if isinstance(problem.condition, Griffith):
            rows, shares = _where_release_changes(problem.body, equilibrium, rows, shares)
        rows, unstable = _around_unstable_motion(equilibrium, rows, shares)
    return rows, last, last if lost is None else lost, unstable


def _where_release_changes(
    body: Body, equilibrium: Equilibrium, rows: list[Surface], shares: list[float]
) -> tuple[list[Surface], list[float]]:
    """Rows and shares of a jump with those between which the release rate of the tip would change by much."""
    for _ in range(HALVINGS):
        rate = [row.edge_stress(body) ** 2 / row.radius for row in rows]
        allowed, added = EVEN_RELEASE * max(rate), 0
        for late in range(len(rows) - 1, 0, -1):
            moves = rows[late].radius != rows[late - 1].radius
            if not moves or abs(rate[late] - rate[late - 1]) <= allowed:
                continue
            middle = 0.5 * (shares[late - 1] + shares[late])
            surface = equilibrium(middle, rows[late - 1].radius)
            if surface is not None:
                rows, shares = [*rows[:late], surface, *rows[late:]], [*shares[:late], middle, *shares[late:]]
                added += 1
        if not added:
            break
    return rows, shares


def _around_unstable_motion(
    equilibrium: Equilibrium, rows: list[Surface], shares: list[float]
) -> tuple[list[Surface], int | None]:
    """Rows at shares of a jump after the first, those beside an unstable motion too, and which ends it.

    It may be in the part in which the edge goes farther than in both beside it. The load is constant in an
    unstable motion: a chord over that part would count the work of one that moves evenly with the load.
    """
    travel = [abs(late.radius - early.radius) for early, late in pairwise(rows)]
    farthest = max(range(len(travel)), key=travel.__getitem__)
    if travel[farthest] <= sum(travel[max(farthest - 1, 0) : farthest + 2]) - travel[farthest]:
        return rows[1:], None
    before, after = rows[farthest], rows[farthest + 1]
    low, high = shares[farthest], shares[farthest + 1]
    for _ in range(BISECTIONS):
        middle = 0.5 * (low + high)
        surface = equilibrium(middle, before.radius)
        if surface is None:
            return rows[1:], None
        if abs(surface.radius - before.radius) < abs(after.radius - surface.radius):
            low, before = middle, surface
        else:
            high, after = middle, surface
    if abs(after.radius - before.radius) <= 0.5 * travel[farthest]:
        return rows[1:], None
    return [*rows[1 : farthest + 1], before, after, *rows[farthest + 1 :]], farthest + 1


def _last_contact(
    equilibrium: Equilibrium, reached: Surface, low: float, lost: float
) -> tuple[float, Surface]:
    """The last share with contact, between one with and one without, and the surface there."""
    for finer in FINER_SEARCHES:
        high = lost
        for _ in range(BISECTIONS):
            middle = 0.5 * (low + high)
            surface = equilibrium(middle, reached.radius, finer)
            if surface is None:
                high = middle
            else:
                low, reached = middle, surface
    return low, reached


def _first_contact(equilibrium: Equilibrium, start: Surface) -> float:
    """The last share without contact, of a jump during which contact begins."""
    low, high = 0.0, 1.0
    for _ in range(BISECTIONS):
        middle = 0.5 * (low + high)
        surface = equilibrium(middle, start.radius)
        if surface is not None and surface.radius > 0.0:
            high = middle
        else:
            low = middle
    return low


def equilibrium_radius(
    problem: FrontProblem, state: FrontState, trial: Trial, begin: float, finer: float = 1.0
) -> float | None:
    """Radius at which an edge that is at ``begin`` comes to rest at fixed time.

    Parameters
    ----------
    problem, state : FrontProblem, FrontState
        Present state.
    trial : Trial
        Trial step from it, whose duration will be zero.
    begin : float
        Radius from which to search.
    finer : float
        Search intervals, relative to the usual ones.

    Returns
    -------
    float or None
        ``None`` if contact is lost.
    """
    without_adhesion = isinstance(problem.condition, NoTension) and trial.segment.control == "force"
    if without_adhesion and trial.segment.value(state.time) <= 0.0:
        return None
    inward, outward = _forces_at_once(trial, begin)
    if max(inward, outward) <= problem.condition.tolerance:
        return begin
    return _arrest(problem, state, trial, begin, outward > inward, finer)


def _arrest(
    problem: FrontProblem, state: FrontState, trial: Trial, begin: float, outward: bool, finer: float = 1.0
) -> float | None:
    """The next stable radius of an unstable edge at fixed time; ``None`` if contact is lost."""
    far = 1e3 * max(begin, state.largest_radius)
    limit = min(problem.edge_radius, far) if outward else min(problem.condition.smallest_radius, begin)
    if isinstance(problem.condition, Griffith):
        stride = ADHESIVE_STRIDE * problem.condition.zone_length
        if problem.elastic:
            stride = max(stride, ELASTIC_STRIDE * begin)
    else:
        stride = ADHESIONLESS_STRIDE * max(begin, state.largest_radius)
    if finer < 1.0 and not outward:
        limit = max(limit, begin - FINER_REACH * finer * stride)
    radius = arrest_radius(trial, begin, finer * stride, outward, limit)
    return None if radius is None or radius == 0.0 else radius


def unstable_edge(
    problem: FrontProblem, state: FrontState, trial: Trial, outward: bool
) -> FrontCandidate | None:
    """State after unstable motion of the edge at fixed time and load.

    Parameters
    ----------
    problem, state : FrontProblem, FrontState
        Present state.
    trial : Trial
        Trial step from it.
    outward : bool
        Whether the edge runs outward.

    Returns
    -------
    FrontCandidate or None
        ``None`` if contact is lost.
    """
    radius = _arrest(problem, state, trial, state.surface.radius, outward)
    if radius is None:
        return None
    end = problem.candidate(state.time, trial.surface_at(0.0, radius))
    bears = isinstance(problem.condition, Griffith) or end.force > LOST_FORCE * state.largest_force
    return end if outward or bears else None  # a plane face releases at once; else it holds by round-off only


def flat_first_contact(problem: FrontProblem, state: FrontState, segment: Segment) -> FrontCandidate | None:
    """Contact over the whole face of a punch that has just come to touch; ``None`` if it has not.

    Parameters
    ----------
    problem, state : FrontProblem, FrontState
        Present state.
    segment : Segment
        Load step.

    Returns
    -------
    FrontCandidate or None
    """
    edge = problem.edge_radius
    if math.isinf(edge) or state.surface.radius > 0.0 or isinstance(problem.condition, Griffith):
        return None
    load = at_rest(segment, segment.present(state.surface.penetration, 0.0))
    trial = problem.trial(state, load)
    if abs(trial.residual(0.0, edge)) > TOUCHING_STRESS:
        return None
    return problem.candidate(state.time, trial.surface_at(0.0, edge))


def force_without_contact(segment: Segment, surface: Surface) -> tuple[Segment, Surface] | None:
    """Load and surface when a force begins to act on an indenter that touches nothing.

    Pressing lowers the indenter until it touches; no force leaves it where it is, at a held penetration.
    ``None`` if the force pulls.
    """
    force, rate = segment.value(segment.start), segment.rate(segment.start)
    if force < 0.0 or (force == 0.0 and rate < 0.0):
        return None
    if force == rate == 0.0:
        return replace(at_rest(segment, surface.penetration), control="penetration"), surface
    return segment, replace(surface, penetration=float(surface.units[0].sum()))
