"""What comes of a batch: pull-off, the end of contact, rows, and how far two resolutions differ in them."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from validation.reference.batch.march import DETACHED, ENDED, FAILED, REASONS, SHORT, March
from validation.reference.batch.scenes import Bodies, LoadRamp
from validation.reference.path.numerics import gauss

Array = NDArray[np.float64]
Whole = NDArray[np.intp]
Flags = NDArray[np.bool_]
Part = tuple[Array, Flags]
"""Rows (4, m, B), and which of them there are."""

LEAST_ERROR = 5e-7
"""Least estimate: by up to half of it two resolutions that agree are off from a finer reference."""
LARGEST_ERROR, LEAST_SHARE = 1e-2, 0.05
"""Of an answer, relative to the pull-off force or that part of the largest force: beyond, it is none."""
DOUBTFUL = "two resolutions differ by more than a hundredth"
OTHERWISE = "two resolutions end differently"
NO_TENSION = 1e-12
"""Pull-off force, in the largest force, below which there is none."""
SAME = 1e-9
"""Time between two rows that are one, in the time of the ramp: rounding moves an extremum by its root."""
SINCE = np.array([[1.0], [0.0], [0.0], [0.0]])
"""What a later beginning adds to rows."""
_U, WEIGHTS = gauss(3)
VALUES = np.array(
    [(1 + 2 * _U) * (1 - _U) ** 2, _U**2 * (3 - 2 * _U), _U * (1 - _U) ** 2, _U**2 * (_U - 1)]
).T
RATES = np.array([6 * _U * (_U - 1), 6 * _U * (1 - _U), (1 - _U) * (1 - 3 * _U), _U * (3 * _U - 2)]).T
"""Values and slopes, at points between two rows, of cubics by their values and slopes at the rows."""


def _none() -> Array:
    return np.zeros(0)


@dataclass(frozen=True)
class Solution:
    """What came of a scene: rows, pull-off, detachment, errors; or the reason why there is none.

    ``errors``: relative, by the names of a trace; times and penetrations relative to the largest of the run.
    The rows hold the pull-off, and end, where contact is lost, with the free surface at the time of the row
    before. Where contact shrinks to one and a half zones they end there, with that ``reason``.
    """

    reason: str = ""
    time: Array = field(default_factory=_none)
    penetration: Array = field(default_factory=_none)
    force: Array = field(default_factory=_none)
    contact_radius: Array = field(default_factory=_none)
    external_work: Array = field(default_factory=_none)
    pull_off_force: float = math.nan
    pull_off_time: float = math.nan
    detached: bool = False
    errors: dict[str, float] = field(default_factory=dict)

    @property
    def answered(self) -> bool:
        """Whether there is one."""
        return bool(len(self.time))


@dataclass(frozen=True)
class Events:
    """Travel (B,) at pull-off; time, penetration, force and radius (4, B) there and where contact ends."""

    travel: Array
    pull_off: Array
    end: Array

    @property
    def tension(self) -> Array:
        """The pull-off force, not negative."""
        return np.maximum(-self.pull_off[2], 0.0)


def events(found: March, leg: LoadRamp, duration: Array) -> Events:
    """Largest time, or the end of the ramp, and the least force up to there."""
    ended = found.ending == ENDED
    place, time = found.largest(found.time)
    last = np.where(ended, found.reached(found.time, duration), place)
    time = np.where(ended, duration, time)
    force = found.at(found.force, last)
    place, tension = found.largest(-found.force)
    later = (place > last) | (tension <= -force)
    pulled = np.where(later, time, found.at(found.time, place))
    place, tension = np.where(later, last, place), np.where(later, -force, tension)

    def state(time: Array, force: Array, travel: Array) -> Array:
        radius = found.radius[0] - travel * leg.bodies.zone
        return np.array([time, leg.depth + leg.rate * time - leg.bodies.compliance * force, force, radius])

    return Events(place, state(pulled, -tension, place), state(time, force, last))


def answers(
    runs: list[tuple[March, LoadRamp, Array]], when: Array, other: Array, before: list[Part]
) -> list[Solution]:
    """Of scenes of one loop, of two resolutions, ``when`` the retraction begins at one and at the other.

    ``before``: rows until the load turns, and until the edge rests.
    """
    (fine, leg, _), (coarse, *_) = runs
    one, two = (events(*run) for run in runs)
    end = one.end[0] + when
    depths = np.maximum(np.abs(leg.depth), np.abs(one.end[1]))
    tension = np.maximum(one.tension, NO_TENSION * np.abs(fine.force).max(axis=0))
    apart = _apart(fine, coarse, one, tension)
    found = {
        "pull_off_force": np.maximum(np.abs(one.tension - two.tension), apart) / tension,
        "pull_off_time": np.abs(one.pull_off[0] + when - two.pull_off[0] - other) / end,
        "detachment_time": np.abs(end - two.end[0] - other) / end,
        "detachment_penetration": np.abs(one.end[1] - two.end[1]) / depths,
    }
    found["detachment_time"] = np.maximum(found["detachment_time"], found["pull_off_time"])  # it comes first
    size = np.maximum(tension, LEAST_SHARE * np.abs(fine.force).max(axis=0))
    doubtful = found["pull_off_force"] * tension > LARGEST_ERROR * size
    passed = (one.travel < fine.travel(fine.last)) & (two.travel < coarse.travel(coarse.last))
    endings = [dict.fromkeys(ends) for ends in zip(fine.ending.tolist(), coarse.ending.tolist(), strict=True)]
    reasons = [
        REASONS[FAILED]
        if FAILED in ends
        else OTHERWISE
        if len(ends) > 1 and not (beyond and ENDED not in ends)
        else DOUBTFUL
        if doubt
        else REASONS.get(max(ends), "")
        for ends, doubt, beyond in zip(endings, doubtful.tolist(), passed.tolist(), strict=True)
    ]
    table, counts = _table(fine, leg.bodies, one, when, before)
    errors = np.maximum(list(found.values()), LEAST_ERROR).T.tolist()
    solutions = [Solution(reason) for reason in reasons]
    for j, why in enumerate(reasons):
        if why and not (why == REASONS[SHORT] and passed[j]):
            continue
        lost = fine.ending[j] == DETACHED and not why
        told = zip(found, errors[j], strict=True)
        solutions[j] = Solution(
            why,
            *table[j, :, : counts[j] + lost].copy(),  # type: ignore[misc]
            pull_off_force=float(one.tension[j]),
            pull_off_time=float(one.pull_off[0, j] + when[j]),
            detached=bool(lost),
            errors={name: error for name, error in told if lost or not name.startswith("detachment")},
        )
    return solutions


def _apart(fine: March, coarse: March, found: Events, tension: Array) -> Array:
    """Largest distance (B,) of two curves of the force over time within a zone of the pull-off.

    Both are taken relative to their ranges. A feature of the surface acts on the force as long as
    it lies within the process zone; at a single place of that travel two resolutions may agree by chance.
    """
    scenes, place = np.arange(len(tension)), found.travel
    travels = np.broadcast_to(fine.g, (len(fine.g), len(scenes)))
    low = np.maximum((travels < place - 1.0).sum(axis=0) - 1, 0)
    high = np.minimum((travels < place + 1.0).sum(axis=0), fine.last)
    row = low + np.arange(max(int((high - low).max()), 0) + 1)[:, None]
    known, row = row <= high, np.minimum(row, fine.last)
    after, before = np.minimum(row + 1, fine.last), np.maximum(row - 1, 0)
    (time, rise), (force, climb) = (
        (curve[row, scenes], curve[after, scenes] - curve[before, scenes])
        for curve in (fine.time, fine.force)
    )
    g = travels[row, scenes]
    other, another = (coarse.at(curve, g) for curve in (coarse.time, coarse.force))
    slope = np.where(rise > 0.0, climb / np.where(rise > 0.0, rise, 1.0), 0.0)
    steep = slope * found.end[0] / tension
    apart = np.abs(force - another - slope * (time - other)) / np.sqrt(1.0 + steep * steep)
    known &= (row < fine.last) & (g <= coarse.travel(coarse.last))
    return np.asarray(np.where(known, apart, 0.0).max(axis=0))


def _table(
    found: March, bodies: Bodies, events: Events, when: Array, before: list[Part]
) -> tuple[Array, Whole]:
    """Rows (B, 5, m), with the work done; the free surface comes after as many as are told."""
    zone, compliance = bodies.zone, bodies.compliance
    end, pulled, later = events.end[:, None], events.pull_off[:, None], (when * SINCE)[:, None]
    rows = found.columns[:, : int(found.last.max()) + 1]
    there = (rows[0] < end[0]) & (rows[3] > end[3]) & (np.abs(rows[0] - pulled[0]) > SAME * end[0])
    there &= np.arange(rows.shape[1])[:, None] <= found.last
    rows = np.concatenate((rows, pulled, end), axis=1)
    there = np.concatenate((there, pulled[0] < end[0] * (1.0 - SAME), end[0] == end[0]))
    near = rows[3] >= found.radius[0] - zone  # later the fields it set off with are left
    resting, rows = found.resting + later, rows + later
    legs = [*before, (resting, resting[0] > when), (rows, there & near), (rows, there & ~near)]
    until, which = np.full(len(when), -np.inf), []
    for number, (leg, there) in enumerate(legs):
        some = there & (leg[0] > until)
        until = np.maximum(until, np.where(some, leg[0], -np.inf).max(axis=0, initial=-np.inf))
        which.append(np.where(some, number, len(legs)))
    columns, numbers = np.concatenate([leg for leg, _ in legs], axis=1), np.concatenate(which)
    order = np.where(numbers < len(legs), columns[0], np.inf).argsort(axis=0, kind="stable")
    counts = (numbers < len(legs)).sum(axis=0)
    order = np.take_along_axis(order, np.minimum(np.arange(len(order) + 1)[:, None], counts - 1), axis=0)
    columns, numbers = np.take_along_axis(columns, order[None], axis=1), np.take_along_axis(numbers, order, 0)
    inside = np.arange(1, len(order) - 1)[:, None] < counts - 1
    done = _works(columns, (numbers[1:-1] == numbers[2:]) & inside)
    scenes, (_, depth, force, _) = np.arange(len(counts)), columns
    done += 0.5 * compliance * (force**2 - force[0] ** 2)
    depth[counts, scenes] += compliance * force[counts, scenes]
    columns[2:, counts, scenes] = 0.0
    return np.ascontiguousarray(np.concatenate((columns, done[None])).transpose(2, 0, 1)), counts


def _works(rows: Array, smooth: Flags) -> Array:
    """``int F dD`` (m, B) up to rows: cubics over the length of the path, but for its corners.

    ``smooth`` (m - 2, B): whether the path is at the rows between the first and the last.
    """
    rise, size = np.diff(rows[1:3], axis=1), np.ptp(rows[1:], axis=1)
    step = np.linalg.norm(np.diff(rows[1:], axis=1) / np.maximum(size, 1e-300)[:, None], axis=0)
    step = np.maximum(step, 1e-300)
    slope = (rise[:, :-1] * step[1:] / step[:-1] + rise[:, 1:] * step[:-1] / step[1:]) / (
        step[:-1] + step[1:]
    )
    none = np.full_like(rise[:, :1], np.nan)
    late = np.concatenate((np.where(smooth, slope * step[:-1], np.nan), none), axis=1)
    early = np.concatenate((none, np.where(smooth, slope * step[1:], np.nan)), axis=1)
    first, last = (
        np.where(np.isnan(one), np.where(np.isnan(other), rise, 2.0 * rise - other), one)
        for one, other in ((early, late), (late, early))
    )
    depth, force = np.array([rows[1:3, :-1], rows[1:3, 1:], first, last]).swapaxes(0, 1).reshape(2, 4, -1)
    done = WEIGHTS @ ((VALUES @ force) * (RATES @ depth))
    return np.concatenate((np.zeros_like(step[:1]), done.reshape(step.shape).cumsum(axis=0)))
