"""Approach, retraction, and what comes of them."""

from __future__ import annotations

import math
from collections import defaultdict
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from contact_scene import Material, Scene
from contact_scene.run_control import single_threaded
from validation.reference.batch.answers import Part, Solution, answers
from validation.reference.batch.grid import Grid, Kind, grid
from validation.reference.batch.machine import AtRest, Covering, OnSpring
from validation.reference.batch.march import (
    DETACHED,
    ENDED,
    FAILED,
    GOING,
    HANDED,
    JUMPED,
    MISSED,
    REASONS,
    ROUNDING,
    SHORT,
    SOFT,
    Closing,
    Drive,
    March,
    Opening,
    begun,
    secants,
    start_radius,
)
from validation.reference.batch.scenes import Bodies, LoadRamp, SideBySide, filled, refusal, turns
from validation.reference.batch.turn import Held, Left, turned
from validation.reference.batch.zone import COUNT, SHORTEST
from validation.reference.path.rheology import Rheology, rheology

Array = NDArray[np.float64]
Whole = NDArray[np.intp]

RESOLUTION = 16
"""Default of :func:`solve`."""
LARGEST, ANY = 1024, 30
"""Scenes taken together, and a size of the grid without bound, of edges that close."""
FAR, SHARE = 2.0, 0.6
"""Travel from which on the place from which the edge closed has rows of its own, and the part of it that the
edge goes before: more than a zone, so that all it opens over then has been in contact."""
SOFTEST = 5.0
"""Relaxed stiffness of the contact where the load turns, over that of the spring, beyond which there is no
answer: the edge goes on closing for long while the load hardly falls, and errors are up to 2e-3."""
RESTING = np.linspace(0.0, 1.0, 17)[1:] ** 2
"""Shares of the time before an edge opens at which there are rows: branches relax at once, or slowly."""


def approach(bodies: Bodies, stage: Array, start: Array, steps: Grid) -> tuple[March, LoadRamp]:
    """Follow the edge until the load turns; some leave nothing to follow."""
    leg = LoadRamp(bodies, stage, bodies.approach, np.zeros_like(bodies.moduli))
    total = bodies.glassy * bodies.moduli * (bodies.depth * start - bodies.volume(start))
    rows = March.empty(steps, leg, start, bodies.turn)
    rows.ending[bodies.turn == 0.0] = ENDED
    none = 0.0 * total
    rows.add(0, 0.0 * start, start, (bodies.depth, none + 1.0, none), total, bodies.depth + none)
    for k in range(1, len(steps.g)):
        if not rows.going.any():
            break
        a = np.where(rows.going, start + steps.g[k] * bodies.zone, start)
        travel, before = steps.step(k), rows.time[k - 1]
        times, depths, forces, radii = rows.columns[:, k + 1 - len(travel.rows) : k]
        driving = radii * depths - bodies.volume(radii)
        cover = Covering(leg, travel, a, times, forces, rows.lags[k - 1], rows.wholes[k - 1], driving)
        drive: Drive = cover if bodies.compliance.any() else leg
        t, going = rows.root(k, Closing(bodies, drive, travel, a), 0.0 * start)
        D, _, b = state = drive(t)
        rows.add(k, t, a, state, cover.whole(t, D, cover.faded(t)) - a * b, D - b / bodies.moduli)
        jumps = going & (t <= before) | (rows.ending == JUMPED)
        rows.ending[jumps] = np.where(bodies.compliance > 0.0, JUMPED, FAILED)[jumps]
        rows.ending[going & (t > before) & ((t >= bodies.turn) | (rows.force[k] >= bodies.level))] = ENDED
    return rows, leg


def turn(bodies: Bodies, rows: March) -> tuple[Bodies, Array]:
    """The bodies with the time at which the approach ends, by its ramp or by a force, and the travel then."""
    last, scenes = rows.last, np.arange(len(rows.last))
    place = np.where(last > 0, rows.reached(rows.time, bodies.turn), 0.0)
    pressed = (rows.force[0] < bodies.level) & (rows.force[last, scenes] >= bodies.level)
    rows.ending[~pressed & np.isfinite(bodies.level)] = MISSED
    level = np.where(pressed, rows.reached(rows.force, bodies.level), np.inf)
    place, sooner = np.minimum(place, level), level < place
    time = np.where(sooner, rows.at(rows.time, place), bodies.turn)
    duration = bodies.duration + (bodies.turn - time) * bodies.approach / bodies.rate
    return replace(bodies, turn=time, duration=duration), place


def retract(
    leg: LoadRamp, start: Array, duration: Array, steps: Grid, left: Left | None, until: Array | float
) -> March:
    """Follow the edge until contact is lost, the ramp ends, or it has gone as far as is asked.

    ``left``: in contact as it begins.
    """
    bodies = leg.bodies
    rows, none = March.empty(steps, leg, start, duration), np.zeros_like(bodies.moduli)
    rest, total, behind, own = 0.0 * start, none, None, none
    if left is not None:
        behind, own, total = left.at(steps.step(0))
    lag = none if left is None else left.held.lag
    drive: Drive = AtRest(leg, start, leg.branches - lag, total) if bodies.compliance.any() else leg
    opens = bodies.closing < bodies.work
    if opens.any():
        first = Opening(bodies, drive, steps.step(0), start, behind, own)
        guess, slope = begun(first, rest, rows.quick, -1.0)
        noise = ROUNDING * start / bodies.zone
        t, _, found = secants(first, guess, slope, rows.lost, noise, opens)
        rest = np.where(opens & found, t, 0.0)
        now = rest * RESTING[:, None]
        D, faded, b = drive(now)
        rows.resting = np.array(
            [now, D, bodies.force(D, b, start, total[:, None] * faded), start + 0.0 * now]
        )
        rows.ending[(opens & ~found) | (rest >= duration)] = FAILED
    state = drive(rest)
    rows.add(0, rest, start, state, total * state[1], bodies.released(state[0], state[2] + own * state[1]))
    rows.ending[rows.force[0] <= bodies.least] = MISSED  # it begins at less
    follow(rows, start, duration, left, rest, until)
    return rows


def follow(
    rows: March, origin: Array, duration: Array, left: Left | None, rest: Array, until: Array | float
) -> None:
    """Add rows to those that are given, from a row of each scene on; travels count from ``origin``."""
    bodies, leg, steps, start = rows.leg.bodies, rows.leg, rows.grid, rows.radius[0]
    total = own = np.zeros_like(bodies.moduli)
    behind, handed = None, rows.ending == HANDED
    first = int(rows.given[handed].min()) if handed.any() else 0
    for k in range(first + 1, len(steps.g)):
        rows.ending[handed & (rows.given == k - 1)] = GOING
        a = origin - steps.g[k] * bodies.zone
        rows.ending[rows.going & (a < SHORTEST * bodies.zone)] = SHORT
        if not (rows.going | (handed & (rows.given >= k))).any():
            break
        a, travel, before = np.where(rows.going, a, start), steps.step(k), rows.time[k - 1]
        if left is not None:
            behind, own, total = left.at(travel)
        drive: Drive = leg
        if bodies.compliance.any():
            window = slice(k + 1 - len(travel.rows), k)
            drive = OnSpring(leg, travel, a, rows.time[window], rows.force[window], rows.lags[k - 1], total)
        t, going = rows.root(k, Opening(bodies, drive, travel, a, behind, own), rest)
        state = drive(t)
        left_there = bodies.released(state[0], state[2] + own * state[1])
        rows.add(k, t, a, state, total * state[1], left_there)
        lost = going & (t <= before) | (rows.ending == JUMPED)
        rows.ending[lost] = np.where(rows.force[k - 1] < 0.0, DETACHED, FAILED)[lost]  # it adheres
        rows.ending[going & (t > before) & ((t >= duration) | (rows.force[k] <= bodies.least))] = ENDED
        rows.ending[rows.going & (steps.g[k] >= until)] = HANDED
    rows.ending[rows.going] = SHORT


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
    solutions = [Solution(reason) for reason in reasons]
    known: dict[Material, Rheology] = {}
    alike: dict[tuple[int, bool, bool], list[int]] = defaultdict(list)
    for i, scene in enumerate(scenes):
        if reasons[i]:
            continue
        if scene.material not in known:
            known[scene.material] = rheology(scene.material)
        alike[len(known[scene.material].times), turns(scene), scene.loading.compliance > 0.0].append(i)
    for (_, cycle, _), numbers in alike.items():
        for part in np.array_split(np.array(numbers), math.ceil(len(numbers) / LARGEST)):
            part = filled(part)
            bodies = Bodies.of([scenes[i] for i in part], [known[scenes[i].material] for i in part])
            for i, answer in zip(part.tolist(), _solved(bodies, resolution, cycle), strict=True):
                solutions[i] = answer
    return solutions


@dataclass(frozen=True)
class Retraction(SideBySide):
    """The last ramp of scenes, how long it takes, the radius and time it begins at, and what went before."""

    leg: LoadRamp
    duration: Array
    radius: Array
    when: Array
    held: Held | None
    approach: March | None
    travel: Array

    @cached_property
    def corner(self) -> Array:
        """The row (4, B) where the load turns, or starts."""
        bodies, before = self.leg.bodies, self.approach
        if self.held is None or before is None:
            none = np.zeros_like(bodies.moduli)
            force = bodies.force(bodies.depth, none, self.radius, none)
            return np.array([bodies.turn, bodies.depth, force, self.radius])
        edge = before.radius[0] + self.travel * bodies.zone
        force = before.at(before.force, self.travel)
        return np.array([bodies.turn, self.held.second.depth - bodies.compliance * force, force, edge])

    @classmethod
    def of(cls, bodies: Bodies, start: Array, resolution: int, count: int, cycle: bool) -> Retraction:
        """From the start, or as the approach leaves it."""
        none = np.zeros_like(bodies.moduli)
        held = bodies.glassy * bodies.moduli * (bodies.depth * start - bodies.volume(start))
        deflected = bodies.compliance * bodies.force(bodies.depth, none, start, held)
        stage, approaches = bodies.depth + deflected, bodies.turn > 0.0
        if not cycle:
            leg, duration = (
                LoadRamp(bodies, stage, bodies.rate, none),
                bodies.duration - deflected / bodies.rate,
            )
            return cls(leg, duration, start, 0.0 * start, None, None, 0.0 * start)
        duration = bodies.duration - np.where(approaches, 0.0, deflected / bodies.rate)
        turning = np.where(approaches, bodies.turn - deflected / bodies.approach, 0.0)
        bodies = replace(bodies, turn=turning, duration=duration)
        before, first = approach(bodies, stage, start, grid(resolution, ANY, "closing", count))
        bodies, travel = turn(bodies, before)
        left, when = turned(bodies, replace(first, bodies=bodies), before, travel, resolution)
        since = when - bodies.turn
        leg, duration = left.second.after(since, bodies.rate), bodies.duration + bodies.hold - since
        return cls(leg, duration, left.edge, when, left, before, travel)

    def before(self, left: Left | None) -> list[Part]:
        """Rows until the load turns, and until the edge rests."""
        rows, there = self.corner[:, None], np.ones((1, len(self.when)), bool)
        if self.approach is None or left is None:
            return [(rows, there)]
        last = self.approach.last
        earlier, crept = self.approach.columns[:, : int(last.max())], left.crept(last)
        there = np.concatenate((np.arange(earlier.shape[1])[:, None] < last, there))
        return [(np.concatenate((earlier, rows), axis=1), there), (crept, ~np.isnan(crept[0]))]

    @property
    def ahead(self) -> Array:
        """Travel to where the edge closed from."""
        return self.travel if self.held is None else (self.held.edge - self.held.start) / self.leg.bodies.zone

    def begun(self, steps: Grid) -> tuple[March, Left | None]:
        """The rows, of some as far as they do not come by where the edge closed from; and what is left in
        contact."""
        if self.held is None:
            return retract(self.leg, self.radius, self.duration, steps, None, np.inf), None
        left = Left(self.held, steps.depths, self.held.edge)
        until = np.where(self.ahead >= FAR, SHARE * self.ahead, np.inf)
        return retract(self.leg, self.radius, self.duration, steps, left, until), left

    def carried_out(self, found: March) -> tuple[March, LoadRamp, Array]:
        """How rows to the last end, their ramp and how long it takes."""
        bodies, duration = self.leg.bodies, self.duration
        low = found.force[found.last, np.arange(len(duration))] <= bodies.least
        met = found.at(found.time, found.reached(-found.force, -bodies.least))
        duration = np.where(low, np.minimum(duration, met), duration)
        found.ending[(found.ending == ENDED) & ~low & np.isfinite(bodies.least)] = MISSED
        if self.approach is not None:
            ending = self.approach.ending
            found.ending[ending != ENDED] = np.where(np.isin(ending, (MISSED, JUMPED)), ending, FAILED)[
                ending != ENDED
            ]
            soft = 2.0 * self.radius * bodies.relaxed * bodies.compliance > SOFTEST
            found.ending[soft & (bodies.turn > 0.0)] = SOFT
        return found, self.leg, duration


def _past_corner(whole: Retraction, groups: list[tuple[Whole, March]], size: int) -> list[March]:
    """All rows of groups of ``whole``, by their numbers, of starts from ``2^size`` zones.

    Scenes that come by where the edge closed from go on together, on whatever grids they began.
    """
    marches = [found for _, found in groups]
    waiting = [i for i, found in enumerate(marches) if (found.ending == HANDED).any()]
    if not waiting or whole.held is None:
        return marches
    ahead = max(whole.ahead[some[found.ending == HANDED]].max(initial=1.0) for some, found in groups)
    steps, numbers = marches[0].grid, [groups[i][0] for i in waiting]
    beside = grid(
        int(steps.breaks[1]), size, "corner", steps.count, steps.sprung, math.ceil(math.log2(ahead))
    )
    starts = [whole.held.start[some] for some in numbers]
    given = [marches[i].handed_over(beside, start) for i, start in zip(waiting, starts, strict=True)]
    joint = whole.of_some(np.concatenate(numbers))
    assert joint.held is not None
    later, start = March.side_by_side(given, joint.leg), joint.held.start
    left = Left(joint.held, beside.depths, start)
    follow(later, start, joint.duration, left, 0.0 * start, np.inf)
    ends = np.cumsum([len(start) for start in starts])
    for i, start, end in zip(waiting, starts, ends, strict=True):
        marches[i] = marches[i].joined(later.of_some(np.arange(end - len(start), end)), start)
    return marches


def _solved(bodies: Bodies, resolution: int, cycle: bool) -> list[Solution]:
    """Answers of scenes; their errors are the change from half as many rows, and a point of Gauss less."""
    start = start_radius(bodies)
    solutions = [Solution(REASONS[FAILED])] * len(start)
    touching = np.flatnonzero(np.isfinite(start))
    if not len(touching):
        return solutions
    touching = filled(touching)
    bodies, start = bodies.of_some(touching), start[touching]
    pair = (resolution, COUNT), (resolution // 2, COUNT - 1)
    whole = [Retraction.of(bodies, start, *each, cycle) for each in pair]
    sizes = np.floor(np.log2(np.array([whole[0].radius, start]) / bodies.zone))
    kind: Kind = "turned" if cycle else "opening"
    alike: dict[int, list[tuple[Whole, list[March], list[Part]]]] = defaultdict(list)
    for size in np.unique(sizes[0, np.isfinite(sizes).all(axis=0)]):
        some = filled(np.flatnonzero((sizes[0] == size) & np.isfinite(sizes[1])))
        steps = [grid(n, int(size), kind, count, bool(bodies.compliance.any())) for n, count in pair]
        both = [one.of_some(some) for one in whole]
        (fine, left), (coarse, _) = (one.begun(each) for one, each in zip(both, steps, strict=True))
        before = both[0].before(left)
        for least in np.unique(sizes[1, some]):
            those = filled(np.flatnonzero(sizes[1, some] == least))
            parts = [(rows[..., those], there[..., those]) for rows, there in before]
            alike[int(least)].append((some[those], [fine.of_some(those), coarse.of_some(those)], parts))
    for start_size, groups in alike.items():
        marches = [
            _past_corner(one, [(some, rows[i]) for some, rows, _ in groups], start_size)
            for i, one in enumerate(whole)
        ]
        for k, (some, _, parts) in enumerate(groups):
            ones = [one.of_some(some) for one in whole]
            runs = [one.carried_out(rows[k]) for one, rows in zip(ones, marches, strict=True)]
            found = answers(runs, ones[0].when, ones[1].when, parts)
            for i, answer in zip(touching[some].tolist(), found, strict=True):
                solutions[i] = answer
    return solutions
