"""What comes of a batch: pull-off, the end of contact, rows, and how far two resolutions differ in them."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from validation.reference.batch.march import DETACHED, ENDED, FAILED, REASONS, SHORT, March
from validation.reference.batch.scenes import LoadRamp
from validation.reference.path.numerics import gauss

Array = NDArray[np.float64]

LEAST_ERROR = 1e-7
"""Least estimate: no better is the reference known by default."""
LARGEST_ERROR, LEAST_SHARE = 1e-2, 0.05
"""Of an answer, relative to the pull-off force or that part of the largest force: beyond, it is none."""
DOUBTFUL = "two resolutions differ by more than a hundredth"
OTHERWISE = "two resolutions end differently"
COMPARED = 0.4, 0.6, 0.8, 1.0
"""Shares of the travel at pull-off where the forces of two resolutions are compared: no pull-off is held to
be better than the curve in the mean, though it may agree by chance."""
GAIN = 0.1
"""What is at least gained by a doubled resolution."""
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
        return np.array([time, leg.depth + leg.rate * time, force, radius])

    return Events(place, state(pulled, -tension, place), state(time, force, last))


def answers(
    runs: list[tuple[March, LoadRamp, Array]], when: Array, other: Array, before: list[list[Array]]
) -> list[Solution]:
    """Of scenes of one loop, of two resolutions, ``when`` the retraction begins at one and at the other."""
    (fine, leg, _), (coarse, *_) = runs
    one, two = (events(*run) for run in runs)
    end = one.end[0] + when
    depths = np.maximum(np.abs(leg.depth), np.abs(one.end[1]))
    tension = np.maximum(one.tension, NO_TENSION * np.abs(fine.force).max(axis=0))
    places = [share * one.travel for share in COMPARED]
    apart = [fine.at(fine.force, place) - coarse.at(coarse.force, place) for place in places]
    apart = GAIN * np.sqrt(np.mean(np.square(apart), axis=0))
    errors = {
        "pull_off_force": np.maximum(np.abs(one.tension - two.tension), apart) / tension,
        "pull_off_time": np.abs(one.pull_off[0] + when - two.pull_off[0] - other) / end,
        "detachment_time": np.abs(end - two.end[0] - other) / end,
        "detachment_penetration": np.abs(one.end[1] - two.end[1]) / depths,
    }
    size = np.maximum(tension, LEAST_SHARE * np.abs(fine.force).max(axis=0))
    doubtful = errors["pull_off_force"] * tension > LARGEST_ERROR * size
    passed = (one.travel < fine.grid.g[fine.last]) & (two.travel < coarse.grid.g[coarse.last])
    reasons = [
        REASONS[FAILED]
        if FAILED in ends
        else OTHERWISE
        if ends[0] != ends[1]
        else DOUBTFUL
        if doubt
        else REASONS.get(ends[0], "")
        for *ends, doubt in zip(fine.ending.tolist(), coarse.ending.tolist(), doubtful.tolist(), strict=True)
    ]
    answered = [j for j, why in enumerate(reasons) if not why or (why == REASONS[SHORT] and passed[j])]
    paths = [_path(fine, one, j, float(when[j]), before[j]) for j in answered]
    solutions = [Solution(reason) for reason in reasons]
    for j, (columns, _), done in zip(answered, paths, works(paths), strict=True):
        columns, lost = np.vstack((columns, done)), fine.ending[j] == DETACHED
        if lost:
            columns = np.column_stack((columns, [*columns[:2, -1], 0.0, 0.0, columns[4, -1]]))
        told = [name for name in errors if lost or not name.startswith("detachment")]
        solutions[j] = Solution(
            reasons[j],
            *columns,  # type: ignore[misc]
            pull_off_force=float(one.tension[j]),
            pull_off_time=float(one.pull_off[0, j] + when[j]),
            detached=bool(lost),
            errors={name: max(float(errors[name][j]), LEAST_ERROR) for name in told},
        )
    return solutions


def _path(found: March, events: Events, j: int, when: float, before: list[Array]) -> tuple[Array, list[int]]:
    """Rows (4, m) of a scene, and which of them are corners of the curves.

    The retraction of its rows begins ``when``; ``before``: legs up to there.
    """
    end, pulled = events.end[:, j], events.pull_off[:, j]
    rows = found.columns[:, : found.last[j] + 1, j]
    apart = np.abs(rows[0] - pulled[0]) > SAME * end[0]
    rows = rows[:, (rows[0] < end[0]) & (rows[3] > end[3]) & apart]
    rows = np.column_stack((rows, pulled) if pulled[0] < end[0] * (1.0 - SAME) else (rows,))
    rows = np.column_stack((rows[:, rows[0].argsort()], end))
    near = rows[3] >= found.radius[found.grid.breaks[1], j]  # later the fields it set off with are left
    opened = [leg + when * SINCE for leg in (found.resting[:, :, j], rows[:, near], rows[:, ~near])]
    legs = before[:1]
    for leg in (before[1], *opened):
        later = leg[:, leg[0] > legs[-1][0, -1]]
        if later.size:
            legs.append(later)
    return np.hstack(legs), [sum(leg.shape[1] for leg in legs[:n]) - 1 for n in range(1, len(legs) + 1)]


def works(paths: list[tuple[Array, list[int]]]) -> list[Array]:
    """``int F dD`` up to the rows of each path: cubics over the length of the path, but for its corners."""
    if not paths:
        return []
    rows = np.hstack([columns for columns, _ in paths])
    ends = np.cumsum([columns.shape[1] for columns, _ in paths])
    begins = ends - [columns.shape[1] for columns, _ in paths]
    corners = np.zeros(rows.shape[1], bool)
    corners[begins] = True
    corners[[begin + i for begin, (_, which) in zip(begins, paths, strict=True) for i in which]] = True
    most, least = (up.reduceat(rows[1:], begins, axis=1) for up in (np.maximum, np.minimum))
    size = np.repeat(np.maximum(most - least, 1e-300), ends - begins, axis=1)[:, 1:]
    step = np.maximum(np.linalg.norm(np.diff(rows[1:]) / size, axis=0), 1e-300)
    rise = np.diff(rows[1:3])
    slope = (rise[:, :-1] * step[1:] / step[:-1] + rise[:, 1:] * step[:-1] / step[1:]) / (
        step[:-1] + step[1:]
    )
    smooth = ~corners[1:-1]
    late = np.column_stack((np.where(smooth, slope * step[:-1], np.nan), [np.nan, np.nan]))
    early = np.column_stack(([np.nan, np.nan], np.where(smooth, slope * step[1:], np.nan)))
    first, last = (
        np.where(np.isnan(one), np.where(np.isnan(other), rise, 2.0 * rise - other), one)
        for one, other in ((early, late), (late, early))
    )
    depth, force = np.array([rows[1:3, :-1], rows[1:3, 1:], first, last]).swapaxes(0, 1)
    done = np.append(0.0, WEIGHTS @ ((VALUES @ force) * (RATES @ depth)))
    return [np.append(0.0, done[begin + 1 : end].cumsum()) for begin, end in zip(begins, ends, strict=True)]
