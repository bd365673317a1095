"""Jumps of the load.

At a fixed time the half-space is glassy and its response reversible, so a jump of the load is a path of
equilibria, all computed from the state before it. Its rows share one time; the work is done along them.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from itertools import pairwise

from contact_scene import Segment
from validation.reference.path.rheology import Body
from validation.reference.tracking.instantaneous import (
    at_rest,
    equilibrium_radius,
    forces_at_once,
    is_over,
)
from validation.reference.tracking.law import Griffith
from validation.reference.tracking.problem import FrontProblem
from validation.reference.tracking.state import FrontState
from validation.reference.tracking.step_outcome import NO_STABLE_CONTACT, StepOutcome
from validation.reference.tracking.surface import Surface
from validation.reference.tracking.trial import Trial

Equilibrium = Callable[..., "Surface | None"]
"""Surface at a share of a load jump, searched from a radius, in finer intervals if a third number says by how
much; ``None`` where contact is lost."""
JUMP_PARTS = 32
"""Parts of a load jump during which the edge moves."""
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
        over = NO_STABLE_CONTACT if is_over(problem, state, end) else ""
        return StepOutcome(candidates=(end,), reversible=True, detachment=over)

    def equilibrium(share: float, begin: float, finer: float = 1.0) -> Surface | None:
        load = at_rest(segment, before + share * change) if share < 1.0 else segment
        trial = problem.trial(state, load)
        radius = equilibrium_radius(problem, state, trial, begin, finer)
        return None if radius is None else trial.surface_at(0.0, radius)

    shares, unstable = _shares(0.0, 1.0, begins, False), None
    rows, last, lost = _equilibria(equilibrium, start, shares)
    if rows and begins and last == 1.0:  # contact begins on the way: the parts are refined from there on
        first = 0.0 if force_controlled else _first_contact(equilibrium, start)
        rows, last, lost = _equilibria(equilibrium, start, _shares(first, 1.0, True, False))
    elif last == 1.0:
        rows, unstable = _refined(problem, equilibrium, start, rows, shares)
    else:
        last, farthest = _last_contact(equilibrium, rows[-1] if rows else start, last, lost)
        shares = _shares(0.0, last, begins, True)[:-1]
        rows, _, _ = _equilibria(equilibrium, start, shares)
        if rows:
            rows, unstable = _refined(problem, equilibrium, start, rows, shares)
        rows.append(farthest)
    outcome = StepOutcome(
        candidates=(problem.candidate(state.time, rows[-1] if rows else start),),
        equilibria=tuple(rows[:-1]),
        reversible=True,
        unstable_row=0 if begins and isinstance(problem.condition, Griffith) else unstable,
    )
    if last == 1.0:
        return replace(outcome, kink=True)
    shortest = problem.condition.smallest_radius
    if rows[-1].radius - shortest < AT_SMALLEST_RADIUS * shortest:
        return replace(outcome, below_zone=True)
    return replace(outcome, detachment=NO_STABLE_CONTACT)


def _rests_at_once(trial: Trial, radius: float) -> bool:
    """Whether the edge stays where it is at fixed time."""
    return max(forces_at_once(trial, radius)) <= trial.condition.tolerance


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
    equilibrium: Equilibrium, start: Surface, shares: list[float]
) -> tuple[list[Surface], float, float]:
    """Equilibria at the shares as far as there is contact, the last such share and the one after."""
    rows: list[Surface] = []
    last = 0.0
    for share in shares:
        surface = equilibrium(share, rows[-1].radius if rows else start.radius)
        if surface is None:
            return rows, last, share
        rows.append(surface)
        last = share
    return rows, last, last


def _refined(
    problem: FrontProblem, equilibrium: Equilibrium, start: Surface, rows: list[Surface], shares: list[float]
) -> tuple[list[Surface], int | None]:
    """The rows with others between them where the edge sets off and beside the largest unstable motion.

    Parameters
    ----------
    problem : FrontProblem
    equilibrium : Equilibrium
    start : Surface
        Before the jump.
    rows : list of Surface
        At the first of the shares.
    shares : list of float

    Returns
    -------
    rows : list of Surface
    unstable : int or None
        The row to which an unstable motion leads.
    """
    rows, shares = [start, *rows], [0.0, *shares[: len(rows)]]
    if isinstance(problem.condition, Griffith):
        rows, shares = _where_release_changes(problem.body, equilibrium, rows, shares)
    return _around_unstable_motion(equilibrium, rows, shares)


def _where_release_changes(
    body: Body, equilibrium: Equilibrium, rows: list[Surface], shares: list[float]
) -> tuple[list[Surface], list[float]]:
    """Rows and shares of a jump with those between which the release rate of the tip would change by much."""
    for _ in range(HALVINGS):
        rate = [row.edge_stress(body) ** 2 / row.radius if row.radius > 0.0 else 0.0 for row in rows]
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
