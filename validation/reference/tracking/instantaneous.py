"""What happens in no time: the load jumps, an edge runs, contact begins or ends.

At a fixed moment the half-space is glassy and its answer reversible, so a jump of the load is a path of
equilibria, all of them made from the state before it. Its rows share one time; the work is done along them.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from typing import TYPE_CHECKING

from contact_scene import Segment
from validation.reference.tracking.law import Griffith, NoTension
from validation.reference.tracking.surface import Surface
from validation.reference.tracking.trial import Attempt

if TYPE_CHECKING:
    from validation.reference.tracking.stepping import Run

State = Callable[[float, float], "Surface | None"]
PARTS = 32  # of a jump during which the edge moves
STRIDE = 0.15  # of the process zone: how far an edge on the run looks
PLAIN_STRIDE = 0.02  # of the radius: the same without adhesion
TOUCHING = 1e-12  # stress relative to the largest: face to face
NOTHING = 1e-11  # of the largest force: no contact carries as little while it lets go
HALVINGS = 24  # of the part of a jump in which contact begins or is lost


def held(segment: Segment, value: float) -> Segment:
    """The control of a segment, at rest at a value."""
    return Segment(segment.control, segment.start, segment.end, lambda time: value, lambda time: 0.0)


def jump(run: Run, segment: Segment) -> None:
    """The load goes from where it is to the first value of the segment."""
    before = run.surface.penetration if segment.control == "penetration" else run.force
    change = segment.value(segment.start) - before
    whole = run.attempt(segment)
    if run.surface.radius == 0.0 and segment.control == "force":
        moves = True
    else:
        moves = max(whole.tendencies(0.0)) > run.law.closed
    if not moves:
        run.commit(run.time, whole.surface_at(0.0, run.surface.radius))
        return
    begins = run.surface.radius == 0.0

    def state(share: float, begin: float) -> Surface | None:
        attempt = run.attempt(held(segment, before + share * change) if share < 1.0 else segment)
        radius = settled(run, attempt, begin)
        return None if radius is None else attempt.surface_at(0.0, radius)

    rows, last, end = _march(state, run.surface, _shares(0.0, 1.0, begins, False))
    if rows and begins and last == 1.0:  # contact begins on the way: from there on the parts are small
        first = _first_contact(state, run.surface) if segment.control == "penetration" else 0.0
        rows, last, end = _march(state, run.surface, _shares(first, 1.0, True, False))
    elif last < 1.0:
        last = _halved(state, rows[-1] if rows else run.surface, last, end)
        rows, _, _ = _march(state, run.surface, _shares(0.0, last, begins, True))
    for row in rows[:-1]:
        run.record.add(run.time, row, row.force(run.body))
    run.commit(run.time, rows[-1] if rows else run.surface)
    if last == 1.0:
        run.kink()
    else:
        run.lost()


def _shares(first: float, last: float, begins: bool, ends: bool) -> list[float]:
    """Shares of a jump; crowded where a contact begins or ends, for there it is a root of the load."""
    parts = [part / PARTS for part in range(1, PARTS + 1)]
    if begins:
        parts = [part**2 for part in parts]
    if ends:
        parts = [1.0 - (1.0 - part) ** 2 for part in parts]
    shares = [first + (last - first) * part for part in parts]
    return ([first] if first > 0.0 else []) + shares[:-1] + [last]


def _march(state: State, start: Surface, shares: list[float]) -> tuple[list[Surface], float, float]:
    """The equilibria at the shares as far as there is contact, the last such share and the one after."""
    rows: list[Surface] = []
    last = 0.0
    for share in shares:
        found = state(share, rows[-1].radius if rows else start.radius)
        if found is None:
            return rows, last, share
        rows.append(found)
        last = share
    return rows, last, last


def _halved(state: State, reached: Surface, low: float, high: float) -> float:
    """The last share with contact, between one with and one without."""
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        found = state(middle, reached.radius)
        if found is None:
            high = middle
        else:
            low, reached = middle, found
    return low


def _first_contact(state: State, start: Surface) -> float:
    """The last share without contact, of a jump that makes one."""
    low, high = 0.0, 1.0
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        found = state(middle, start.radius)
        if found is not None and found.radius > 0.0:
            high = middle
        else:
            low = middle
    return low


def settled(run: Run, attempt: Attempt, begin: float) -> float | None:
    """Where an edge that is at ``begin`` comes to rest at fixed time; ``None`` if contact is lost."""
    untied = isinstance(run.law, NoTension) and attempt.segment.control == "force"
    if untied and attempt.segment.value(run.time) <= 0.0:
        return None
    if begin == run.surface.radius:
        inward, outward = attempt.tendencies(0.0)
    else:
        inward = attempt.residual(0.0, begin)
        outward = -inward if begin < run.scene.indenter.edge else -1.0
    if max(inward, outward) <= run.law.closed:
        return begin
    return runs_to(run, attempt, begin, outward > inward)


def runs_to(run: Run, attempt: Attempt, begin: float, outward: bool) -> float | None:
    """The next stable place of an edge that runs at fixed time; ``None`` if contact is lost."""
    far = 1e3 * max(begin, run.radius_scale)
    limit = min(run.scene.indenter.edge, far) if outward else min(run.law.rest, begin)
    adhesive = isinstance(run.law, Griffith)
    stride = STRIDE * run.law.reach if adhesive else PLAIN_STRIDE * max(begin, run.radius_scale)
    radius = attempt.run_to_rest(begin, stride, outward, limit)
    return None if radius is None or radius == 0.0 else radius


def run_free(run: Run, attempt: Attempt, outward: bool) -> None:
    """The edge runs at fixed time and load to the next stable place, or contact is lost."""
    radius = runs_to(run, attempt, run.surface.radius, outward)
    if radius is None:
        run.lost()
        return
    surface = attempt.surface_at(0.0, radius)
    bears = isinstance(run.law, Griffith) or surface.force(run.body) > NOTHING * run.force_scale
    if outward or bears:
        run.commit(run.time, surface)
    else:  # a face lets go at once; where it seems to hold, it does so by round-off
        run.lost()


def lands_flat(run: Run, segment: Segment) -> None:
    """A punch that has just come to touch does so on all of its face."""
    edge = run.scene.indenter.edge
    if math.isinf(edge) or run.surface.radius > 0.0 or isinstance(run.law, Griffith):
        return
    attempt = run.attempt(held(segment, run.surface.penetration if segment.control == "penetration" else 0.0))
    if abs(attempt.residual(0.0, edge)) <= TOUCHING:
        run.commit(run.time, attempt.surface_at(0.0, edge))


def hangs_free(run: Run, segment: Segment) -> Segment | None:
    """What a force does to an indenter that touches nothing: ``None`` if it pulls the indenter away.

    One that presses lowers the indenter until it touches; none at all leaves it where it is.
    """
    force, rate = segment.value(segment.start), segment.rate(segment.start)
    if force < 0.0 or (force == 0.0 and rate < 0.0):
        return None
    if force == rate == 0.0:
        depth = run.surface.penetration
        return replace(held(segment, depth), control="penetration")
    touch = float(run.surface.units[0].sum())
    if touch != run.surface.penetration:
        run.commit(run.time, replace(run.surface, penetration=touch))
    lands_flat(run, segment)
    return segment
