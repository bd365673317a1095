"""Approach, retraction, and what comes of them."""

from __future__ import annotations

import math
from collections import defaultdict
from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from contact_scene import Material, Scene
from contact_scene.run_control import single_threaded
from validation.reference.batch.grid import Grid, Kind, grid
from validation.reference.batch.march import (
    DETACHED,
    ENDED,
    FAILED,
    REASONS,
    ROUNDING,
    SHORT,
    Closing,
    March,
    Opening,
    begun,
    secants,
    start_radius,
)
from validation.reference.batch.scenes import Bodies, LoadRamp, refusal
from validation.reference.batch.turn import Held, turned
from validation.reference.batch.zone import POINTS, SHARES, SHORTEST, SWEPT, WEIGHTS
from validation.reference.path.rheology import Rheology, rheology

Array = NDArray[np.float64]
Whole = NDArray[np.intp]

RESOLUTION = 16
"""Default of :func:`solve`."""
CHUNK = 256
"""Scenes of one loop: their arrays stay in the cache."""
LARGEST, ANY = 1024, 60
"""Scenes taken together, and a size of the grid that has no bound: of edges that close."""
LEAST_ERROR = 1e-7
"""Least estimate: no better is the reference known by default."""
COMPARED = 0.4, 0.6, 0.8, 1.0
"""Shares of the travel at pull-off where the forces of two resolutions are compared: no pull-off is held to
be better than the curve in the mean, though it may agree by chance."""
GAIN = 0.1
"""What is at least gained by a doubled resolution."""
NO_TENSION = 1e-12
"""Pull-off force, in the largest force, below which there is none."""


def approach(bodies: Bodies, start: Array, steps: Grid) -> tuple[March, LoadRamp]:
    """Follow the edge until the load turns; some leave nothing to follow."""
    leg = LoadRamp(bodies, bodies.depth, bodies.approach, np.zeros_like(bodies.moduli))
    total = bodies.glassy * bodies.moduli * (bodies.depth * start - bodies.volume(start))
    rows = March.empty(steps, leg, start, bodies.turn)
    rows.ending[bodies.turn <= 0.0] = ENDED
    rows.add(0, 0.0 * start, start, total, leg.depth - 0.0 * total)
    for k in range(1, len(steps.g)):
        if not rows.going.any():
            break
        a, past = np.where(rows.going, start + steps.g[k] * bodies.zone, start), rows.radius[k - 1]
        travel, before = steps.step(k), rows.time[k - 1]
        step = Closing(leg, travel, a)
        t, going = rows.root(k, step, 0.0 * start)
        window = np.concatenate((rows.time[k + 1 - travel.within.shape[1] : k], t[None]))
        passed = travel.within @ window
        D, b = leg.at(passed)
        strain = (D - bodies.shape(past + (a - past) * SWEPT[:, None])) * bodies.moduli[:, None] - b
        strain *= np.exp((passed - t) / bodies.times[:, None]) * SHARES[:, None]
        total = total * np.exp((before - t) / bodies.times) + strain.sum(axis=1) * np.where(
            going, a - past, 0.0
        )
        rows.add(k, t, a, total, step.left_behind(t))
        rows.ending[going & (t <= before)] = FAILED
        rows.ending[going & (t > before) & (t >= bodies.turn)] = ENDED
    return rows, leg


def retract(
    leg: LoadRamp, start: Array, duration: Array, steps: Grid, held: Held | None, now: Array
) -> March:
    """Follow the edge until contact is lost, or the ramp ends; ``held``: in contact, ``now``."""
    bodies = leg.bodies
    rows, none = March.empty(steps, leg, start, duration), np.zeros_like(bodies.moduli)
    rest, total, own = 0.0 * start, none, none
    if held is not None:
        own, total = held.branches(start[None], now)[:, 0], held.integral(now)
    opens = bodies.closing < bodies.work
    if opens.any():
        travel, behind = steps.step(0), None
        if held is not None:
            behind = held.branches(travel.points.behind(bodies, start), now)
        guess, slope = begun(Opening(leg, travel, start, behind, own), rest, rows.quick, -1.0)
        noise = ROUNDING * start / bodies.zone
        t, _, found = secants(Opening(leg, travel, start, behind, own), guess, slope, rows.lost, noise, opens)
        rest = np.where(opens & found, t, 0.0)
        rows.ending[(opens & ~found) | (rest >= duration)] = FAILED
    rows.add(
        0,
        rest,
        start,
        total * np.exp(-rest / bodies.times),
        Opening(leg, steps.step(0), start, None, own).left_behind(rest),
    )
    for k in range(1, len(steps.g)):
        a = start - steps.g[k] * bodies.zone
        rows.ending[rows.going & (a < SHORTEST * bodies.zone)] = SHORT
        if not rows.going.any():
            break
        a, past = np.where(rows.going, a, start), rows.radius[k - 1]
        travel, before, behind = steps.step(k), rows.time[k - 1], None
        if held is not None:
            passed = a + np.where(rows.going, past - a, 0.0) * POINTS[:, None]
            places = travel.points.behind(bodies, a), a[None], passed
            values = held.branches(np.concatenate(places), now)
            m = len(places[0])
            behind, own, lost = values[:, :m], values[:, m], values[:, m + 1 :] * WEIGHTS[:, None]
            total = total - lost.sum(axis=1) * np.where(rows.going, past - a, 0.0)
        step = Opening(leg, travel, a, behind, own)
        t, going = rows.root(k, step, rest)
        rows.add(k, t, a, total * np.exp(-t / bodies.times), step.left_behind(t))
        rows.ending[going & (t <= before)] = DETACHED
        rows.ending[going & (t > before) & (t >= duration)] = ENDED
    rows.ending[rows.going] = SHORT
    return rows


def _none() -> Array:
    return np.zeros(0)


@dataclass(frozen=True)
class Solution:
    """What came of a scene: rows, pull-off, detachment, errors; or why there is none.

    ``errors``: relative, by the names of a trace; times and penetrations relative to the largest of the run.
    The rows end, where contact is lost, with the free surface at the time of the row before.
    """

    reason: str = ""
    time: Array = field(default_factory=_none)
    penetration: Array = field(default_factory=_none)
    force: Array = field(default_factory=_none)
    contact_radius: Array = field(default_factory=_none)
    pull_off_force: float = math.nan
    pull_off_time: float = math.nan
    detached: bool = False
    errors: dict[str, float] = field(default_factory=dict)

    @property
    def answered(self) -> bool:
        """Whether there is one."""
        return not self.reason


@dataclass(frozen=True)
class Events:
    """Of each scene (B,): pull-off, its travel and time, and the last state in contact."""

    travel: Array
    pull_off_force: Array
    pull_off_time: Array
    time: Array
    depth: Array
    force: Array
    radius: Array


def events(found: March, leg: LoadRamp, duration: Array) -> Events:
    """Largest time, or the end of the ramp, and the least force up to there."""
    bodies = leg.bodies
    place, time = found.largest(found.time)
    ended = found.ending == ENDED
    end = np.where(ended, found.reached(found.time, duration), place)
    time = np.where(ended, duration, time)
    force, radius = found.at(found.force, end), found.radius[0] - end * bodies.zone
    place, tension = found.largest(-found.force)
    later = (place > end) | (tension <= -force)
    tension = np.where(later, -force, tension)
    pulled = np.where(later, time, found.at(found.time, place))
    place = np.where(later, end, place)
    return Events(place, np.maximum(tension, 0.0), pulled, time, leg.depth + leg.rate * time, force, radius)


@single_threaded()
@np.errstate(over="ignore", under="ignore", invalid="ignore", divide="ignore")
def solve(scenes: Sequence[Scene], resolution: int = RESOLUTION) -> list[Solution]:
    """Solve scenes together; one that is refused, or fails, costs no other.

    Parameters
    ----------
    scenes : sequence of Scene
        In any order, with any numbers of branches.
    resolution : int
        Steps of the edge in a process zone, and in five sixths of what it has gone, from 8.

    Returns
    -------
    list of Solution
        In the order of the scenes; of what is refused the ``reason``, before anything is computed.

    Examples
    --------
    >>> import crosscontact as cc
    >>> from validation.reference.batch import solve
    >>> [answer] = solve([cc.builtin("retraction-v0.02")])
    >>> print(f"{answer.pull_off_force:.6f}", answer.detached, answer.errors["pull_off_force"] < 1e-5)
    0.022283 True True
    """
    reasons = [refusal(scene) for scene in scenes]
    answers = [Solution(reason) for reason in reasons]
    known: dict[Material, Rheology] = {}
    alike: dict[tuple[int, bool], list[int]] = defaultdict(list)
    for i, scene in enumerate(scenes):
        if reasons[i]:
            continue
        if scene.material not in known:
            known[scene.material] = rheology(scene.material)
        cycle = scene.loading.start == "jump-in" or len(scene.loading.steps) == 2
        alike[len(known[scene.material].times), cycle].append(i)
    for (_, cycle), numbers in alike.items():
        for part in np.array_split(np.array(numbers), math.ceil(len(numbers) / LARGEST)):
            bodies = Bodies.of([scenes[i] for i in part], [known[scenes[i].material] for i in part])
            for i, answer in zip(part.tolist(), _solved(bodies, resolution, cycle), strict=True):
                answers[i] = answer
    return answers


@dataclass(frozen=True)
class Retraction:
    """The last ramp of scenes, how long it takes, the radius and time it begins at, and what went before."""

    leg: LoadRamp
    duration: Array
    radius: Array
    when: Array
    held: Held | None
    approach: March | None

    @cached_property
    def corner(self) -> Array:
        """The row (4, B) where the load turns, or starts."""
        bodies, before = self.leg.bodies, self.approach
        if self.held is None or before is None:
            none = np.zeros_like(bodies.moduli)
            force = bodies.force(bodies.depth, none, self.radius, none)
            return np.array([bodies.turn, bodies.depth, force, self.radius])
        place = np.where(before.last > 0, before.reached(before.time, bodies.turn), 0.0)
        edge = before.radius[0] + place * bodies.zone
        return np.array([bodies.turn, self.held.second.depth, before.at(before.force, place), edge])

    def approached(self, i: int) -> Array:
        """Rows (4, m) of a scene up to there."""
        rows = np.zeros((4, 0))
        if self.approach is not None:
            rows = self.approach.columns[:, : self.approach.last[i], i]
        return np.column_stack((rows, self.corner[:, i]))

    @classmethod
    def of(cls, bodies: Bodies, start: Array, resolution: int, cycle: bool) -> Retraction:
        """From the start, or as the approach leaves it."""
        none = np.zeros_like(bodies.moduli)
        if not cycle:
            leg = LoadRamp(bodies, bodies.depth, bodies.rate, none)
            return cls(leg, bodies.duration, start, 0.0 * start, None, None)
        before, first = approach(bodies, start, grid(resolution, ANY, "closing"))
        held, when = turned(bodies, first, before, resolution)
        leg = held.second.after(when - bodies.turn, bodies.rate)
        radius = held.radius[held.last, np.arange(len(start))]
        return cls(leg, bodies.duration - (when - bodies.turn), radius, when, held, before)

    def carried_out(self, chosen: Whole, steps: Grid) -> tuple[March, LoadRamp, Array]:
        """The rows of some of the scenes."""
        bodies = self.leg.bodies.of_some(chosen)
        leg = self.leg.of_some(chosen, bodies)
        held = None if self.held is None else self.held.of_some(chosen, bodies)
        duration = self.duration[chosen]
        found = retract(leg, self.radius[chosen], duration, steps, held, self.when[chosen])
        if self.approach is not None:
            found.ending[self.approach.ending[chosen] != ENDED] = FAILED
        return found, leg, duration


def _solved(bodies: Bodies, resolution: int, cycle: bool) -> list[Solution]:
    """Answers of scenes, with the change from half the resolution as their errors."""
    start = start_radius(bodies)
    fine, coarse = (Retraction.of(bodies, start, n, cycle) for n in (resolution, resolution // 2))
    answers = [Solution(REASONS[FAILED])] * len(start)
    sizes = np.floor(2.0 * np.log2(fine.radius / bodies.zone))
    alike: dict[tuple[int, Kind], list[int]] = defaultdict(list)
    for i in np.flatnonzero(np.isfinite(sizes)).tolist():
        later = fine.when[i] > bodies.turn[i] and coarse.when[i] > bodies.turn[i]
        alike[int(sizes[i]), ("smooth" if later else "sharp") if cycle else "opening"].append(i)
    for (size, kind), numbers in alike.items():
        for chosen in np.array_split(np.array(numbers), math.ceil(len(numbers) / CHUNK)):
            steps = [grid(n, size, kind) for n in (resolution, resolution // 2)]
            runs = [one.carried_out(chosen, each) for one, each in zip((fine, coarse), steps, strict=True)]
            found = _answers(runs, fine, coarse, chosen)
            for i, answer in zip(chosen.tolist(), found, strict=True):
                answers[i] = answer
    return answers


def _answers(
    runs: list[tuple[March, LoadRamp, Array]], first: Retraction, second: Retraction, chosen: Whole
) -> list[Solution]:
    """Answers of scenes of one loop, of two resolutions."""
    (fine, leg, _), (coarse, *_) = runs
    one, two = (events(*run) for run in runs)
    when, other = first.when[chosen], second.when[chosen]
    end = one.time + when
    depths = np.maximum(np.abs(leg.depth), np.abs(one.depth))
    tension = np.maximum(one.pull_off_force, NO_TENSION * np.abs(fine.force).max(axis=0))
    places = [share * one.travel for share in COMPARED]
    apart = [fine.at(fine.force, place) - coarse.at(coarse.force, place) for place in places]
    apart = GAIN * np.sqrt(np.mean(np.square(apart), axis=0))
    errors = {
        "pull_off_force": np.maximum(np.abs(one.pull_off_force - two.pull_off_force), apart) / tension,
        "pull_off_time": np.abs(one.pull_off_time + when - two.pull_off_time - other) / end,
        "detachment_time": np.abs(one.time + when - two.time - other) / end,
        "detachment_penetration": np.abs(one.depth - two.depth) / depths,
    }
    return [
        _answer(j, fine, one, errors, int(coarse.ending[j]), float(when[j]), first.approached(i))
        for j, i in enumerate(chosen)
    ]


def _answer(
    j: int, found: March, events: Events, errors: dict[str, Array], other: int, when: float, before: Array
) -> Solution:
    """Of one scene; ``other``: how it ends at the other resolution; ``before``: rows until the load turns.

    The edge opens ``when`` the retraction of its rows begins, or later.
    """
    ending, detached = int(found.ending[j]), found.ending[j] == DETACHED
    if ending in REASONS or other != ending:
        return Solution(REASONS.get(ending) or REASONS.get(other, "two resolutions end differently"))
    end = np.array([part[j] for part in (events.time, events.depth, events.force, events.radius)])
    rows = found.columns[:, : found.last[j] + 1, j]
    columns = np.column_stack((rows[:, (rows[0] < end[0]) & (rows[3] > end[3])], end))
    if detached:
        columns = np.column_stack((columns, (end[0], end[1], 0.0, 0.0)))
    told = [name for name in errors if detached or not name.startswith("detachment")]
    columns[0] += when
    columns = np.column_stack((before, columns[:, columns[0] > before[0, -1]]))
    time, depth, force, radius = columns
    return Solution(
        "",
        time,
        depth,
        force,
        radius,
        pull_off_force=float(events.pull_off_force[j]),
        pull_off_time=float(events.pull_off_time[j]) + when,
        detached=bool(detached),
        errors={name: max(float(errors[name][j]), LEAST_ERROR) for name in told},
    )
