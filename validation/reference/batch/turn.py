"""What an edge that closed has left in contact, and how it comes to rest after the turn of the load.

It goes on closing there where the layer it has just covered relaxes faster than the load falls. Then time
rules its steps: at rest the radius does not tell it.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from validation.reference.batch.grid import Depths, Travel, gained
from validation.reference.batch.machine import AtRest, fading
from validation.reference.batch.march import CONVERGED, ENDED, FAILED, ROUNDING, March, secants
from validation.reference.batch.scenes import Bodies, LoadRamp, SideBySide, filled
from validation.reference.batch.zone import LAYERED, NEAR, quadrature

Array = NDArray[np.float64]
Whole = NDArray[np.intp]
Flags = NDArray[np.bool_]

LONGEST, STEADY, WINDOW, ROOM = 16, 0.02, 60, 64
"""Steps in time of an edge that goes on closing after the turn, times the resolution (fourteen decades); the
first of them; rows in its zone; rows for which there is room at first."""
CREPT = 0.2, 0.4, 0.6, 0.8, 1.0
"""Shares of these steps at which there are rows of the answer."""
NEARER, AT_REST = 0.6, 1e-5
"""Of the time that is left until an edge rests, the part that a step takes at most; and the travel, in zones,
that is left where it is extrapolated."""
NO_TIME = 1e-9
"""Of the shortest relaxation time: a step that takes none."""


@dataclass(frozen=True, eq=False)
class Held(SideBySide):
    """What an edge that closed has left in contact: rows (3 + n, S, B) of radius, time, and of what a spring
    takes of the penetration and of branch forces; ``last`` of each scene.

    What stands after the last counts for nothing: it is room for :meth:`onward`. ``whole`` (n, B): integrals
    of branch forces over the contact in the last row. ``start``: radius at the start; ``first``, ``second``:
    the legs before and after the turn of the load; ``kinks`` (l, B): rows, in rising order.
    """

    bodies: Bodies
    first: LoadRamp
    second: LoadRamp
    start: Array
    rows: Array
    whole: Array
    last: Whole
    kinks: Whole

    @property
    def radius(self) -> Array:
        """Radii (S, B)."""
        return self.rows[0]

    @property
    def time(self) -> Array:
        """Times (S, B)."""
        return self.rows[1]

    @cached_property
    def newest(self) -> Array:
        """The last row (3 + n, B)."""
        return np.asarray(self.rows[:, self.last, np.arange(len(self.last))])

    @property
    def edge(self) -> Array:
        """Radius of the last row."""
        return np.asarray(self.newest[0])

    @property
    def when(self) -> Array:
        """Time of the last row."""
        return np.asarray(self.newest[1])

    @property
    def lag(self) -> Array:
        """What a spring has taken of the branch forces (n, B) in the last row."""
        return np.asarray(self.newest[3:])

    def onward(self, row: Array, whole: Array, asked: Flags) -> Held:
        """With one more row of those asked for."""
        some = np.flatnonzero(asked)
        self.rows[:, self.last[some] + 1, some] = row[:, some]
        return replace(self, whole=np.where(asked, whole, self.whole), last=self.last + asked)

    def last_rows(self, count: int) -> Held:
        """With that many rows before the last."""
        scenes = np.arange(len(self.last))
        old = np.maximum(self.last - count + np.arange(count + 1)[:, None], 0)
        kinks = np.clip(self.kinks - self.last + count, 0, count)
        return replace(self, rows=self.rows[:, old, scenes], last=np.full(len(scenes), count), kinks=kinks)

    def with_room(self, most: int) -> Held:
        """With room for rows up to that one."""
        if most < self.rows.shape[1]:
            return self
        room = np.zeros((len(self.rows), max(ROOM, most + 1 - self.rows.shape[1]), len(self.last)))
        return replace(self, rows=np.concatenate((self.rows, room), axis=1))

    def stage(self, t: Array) -> tuple[Array, Array]:
        """Where the stage is at times (m, B), and the branch forces (n, m, B) that it would cause."""
        turn = self.bodies.turn
        one, two = self.first.at(np.minimum(t, turn)), self.second.at(np.maximum(t - turn, 0.0))
        return np.where(t > turn, two[0], one[0]), np.where(t > turn, two[1], one[1])

    @cached_property
    def places(self) -> tuple[Array, Array, Array]:
        """Where rows begin, how far they go, and shares of that, scene after scene from even numbers."""
        scenes = np.arange(len(self.last))
        begin, end = self.radius[0], self.edge
        whole = np.where(end > begin, end - begin, 1.0)
        known = np.arange(self.last.max() + 1)[:, None] <= self.last
        place = np.where(known, np.minimum((self.radius[: len(known)] - begin) / whole, 1.0), 1.0)
        return begin, whole, (place + 2.0 * scenes).T.ravel()

    def strain(self, x: Array) -> tuple[Array, Array]:
        """When radii (m, B) were covered, and branch forces (n, m, B) beside ``E_k M_k`` just after.

        Times are roots of cubics through rows; on cubics lies what a spring takes too.
        """
        scenes, count, (begin, whole, flat) = np.arange(len(self.last)), len(self.last), self.places
        shares = np.clip((x - begin) / whole, 0.0, 1.0) + 2.0 * scenes
        row = flat.searchsorted(shares, side="right") - 1 - (self.last.max() + 1) * scenes
        row = np.minimum(np.maximum(row, 0), np.maximum(self.last - 1, 0))
        low, high = np.zeros_like(row), self.last
        for kink in self.kinks:
            low, high = np.where(kink <= row, kink, low), np.where(kink > row, np.minimum(kink, high), high)
        first = np.maximum(np.minimum(np.maximum(np.minimum(row - 1, high - 3), low), self.last - 3), 0)
        places = [np.minimum(first + i, self.last) * count + scenes for i in range(4)]
        places += [row * count + scenes, np.minimum(row + 1, self.last) * count + scenes]
        *times, early, late = (self.time.ravel().take(place) for place in places)
        *table, near, far = (self.radius.ravel().take(place) for place in places)

        def differences(table: list[Array]) -> list[Array]:
            for order in range(1, 4):
                for i in range(3, order - 1, -1):
                    apart = times[i] - times[i - order]
                    table[i] = (table[i] - table[i - 1]) / np.where(apart > 0.0, apart, np.inf)
            return table

        def cubic(table: list[Array], t: Array) -> tuple[Array, Array]:
            value, slope = table[3], 0.0 * t
            for i in (2, 1, 0):
                since = t - times[i]
                value, slope = value * since + table[i], slope * since + value
            return value, slope

        table = differences(table)
        t = early + (late - early) * np.clip((x - near) / np.where(far > near, far - near, 1.0), 0.0, 1.0)
        for _ in range(3):
            value, slope = cubic(table, t)
            t = np.minimum(np.maximum(t - (value - x) / np.where(slope > 0.0, slope, np.inf), early), late)
        D, b = self.stage(t)
        if self.bodies.compliance.any():
            taken = self.rows[2:].reshape(len(self.rows) - 2, -1)
            u, *lags = cubic(differences([taken.take(place, axis=1) for place in places[:4]]), t)[0]
            D, b = D - u, b - np.array(lags).reshape(b.shape)
        bodies, covered = self.bodies, np.where(x > self.start, 1.0, self.bodies.glassy)
        return t, covered * ((D - bodies.shape(x)) * bodies.moduli[:, None] - b)

    def branches(self, x: Array, now: Array) -> Array:
        """What is left (n, m, B) at a time beside ``E_k M_k``."""
        t, strain = self.strain(x)
        return np.asarray(strain * np.exp((t - now) / self.bodies.times[:, None]))


class Left:
    """What is left in contact, at depths behind a radius that all scenes share.

    ``table`` (m, 1 + n, B): when they were covered, and branch forces beside ``E_k M_k`` just after.
    """

    def __init__(self, held: Held, depths: Depths, edge: Array) -> None:
        self.held, self.depths, bodies = held, depths, held.bodies
        self.edge, self.when = edge, held.when
        t, strain = held.strain(np.maximum(self.edge - depths.s[:, None] * bodies.zone, 0.0))
        self.table = np.concatenate((t[:, None], strain.swapaxes(0, 1)), axis=1)
        self.within = self.total(self.when)

    def total(self, now: Array) -> Array:
        """``int_0^x`` (m, n, B) up to the depths of what is left at a time."""
        bodies, start = self.held.bodies, self.held.start
        since = np.minimum(self.table[:, :1] - now, 0.0)
        left = self.table[:, 1:] * np.exp(since / bodies.times)
        running = self.depths.running(left.reshape(len(left), -1)).reshape(left.shape)
        before = self.depths.at(running, (self.edge - start) / bodies.zone)
        inside = bodies.glassy * bodies.moduli * (bodies.depth * start - bodies.volume(start))
        return inside * np.exp(-now / bodies.times) + (before - running) * bodies.zone

    def at(self, travel: Travel) -> tuple[Array, Array, Array]:
        """Branch forces behind an edge (m, n, B) and at it (n, B), and their integrals (n, B)."""
        bodies = self.held.bodies
        near = slice(travel.first_depth, travel.first_depth + travel.behind.shape[1])
        table, within = self.table[near], self.within[near]
        values = (travel.behind @ table.reshape(len(table), -1)).reshape(-1, *table.shape[1:])
        left = values[:, 1:] * np.exp((values[:, :1] - self.when) / bodies.times)
        total = travel.behind[-1] @ within.reshape(len(within), -1)
        return left[:-1], left[-1], total.reshape(within.shape[1:])

    def crept(self, turned: Whole) -> Array:
        """Some rows (4, m, B) after that of the turn of the load, to the last."""
        held, scenes = self.held, np.arange(len(turned))
        found = np.zeros((4, len(CREPT), len(turned)))
        if not (held.last > turned).any():
            return found
        for m, share in enumerate(CREPT):
            row = turned + np.rint(share * (held.last - turned)).astype(np.intp)
            radius, now, u, *lag = held.rows[:, row, scenes]
            D, b = held.second.at(now - held.bodies.turn)
            D, b = D - u, b - np.array(lag).reshape(b.shape)
            total = self.depths.at(self.total(now), (self.edge - radius) / held.bodies.zone)
            found[:, m] = now, D, held.bodies.force(D, b, radius, total), radius
        return found


def turned(
    bodies: Bodies, first: LoadRamp, closing: March, travel: Array, resolution: int
) -> tuple[Held, Array]:
    """What an edge leaves that has come to rest some time after the turn of the load, and when that was."""
    scenes, last = np.arange(len(bodies.zone)), closing.last
    second = first.after(bodies.turn, bodies.rate, bodies.hold if bodies.hold.any() else None)
    start = closing.radius[0]
    edge = start + travel * bodies.zone
    ends = [bodies.hold, np.full(len(last), np.inf)] if bodies.hold.any() else [np.full(len(last), np.inf)]
    deflection = bodies.compliance * closing.at(closing.force, travel)
    memory = [
        [closing.at(part, travel) for part in parts.swapaxes(0, 1)]
        for parts in (closing.lags, closing.wholes)
    ]
    lag, whole = np.array(memory).reshape(2, len(bodies.moduli), len(last))
    size = int(last.max()) + 1
    rows = np.empty((3 + len(lag), size, len(last)))
    rows[:2] = closing.columns[[3, 0], :size]
    rows[2] = bodies.compliance * closing.force[:size]
    rows[3:] = closing.lags[:size].swapaxes(0, 1)
    rows[:, last, scenes] = edge, bodies.turn, deflection, *lag
    kinks = np.array([np.minimum(row, last) for row in (*closing.grid.breaks, last)])
    held = Held(bodies, first, second, start, rows, whole, last, kinks)
    for until in ends:
        held = _gone_on(held, closing, until, resolution)
    held = replace(held, rows=held.rows[:, : int(held.last.max()) + 1])
    return held, held.when


def _gone_on(held: Held, closing: March, until: Array, resolution: int) -> Held:
    """With rows up to where an edge rests, or to a time since the turn of the load, which has a row then."""
    last, bodies, since = held.last, held.bodies, held.when - held.bodies.turn
    held = held.with_room(int(last.max()) + 1)
    if len(bodies.moduli):
        step = np.minimum(_first_step(held), until - since)
        falls = AfterTurn(held, since + step)(held.edge) < AfterTurn(held, since)(held.edge)
        some = filled(np.flatnonzero((closing.ending == ENDED) & falls & (step > 0.0)))
        if len(some):
            closing.ending[some] = FAILED
            few, top, wholes = held.of_some(some), last.copy(), held.whole.copy()
            for those, found, whole in _closing_on(few, step[some], until[some], resolution):
                out, count = some[those], found.shape[1] - 1
                held = held.with_room(int(last[out].max()) + count + 1)
                held.rows[:, last[out] + np.arange(count + 1)[:, None], out] = found
                top[out], wholes[:, out], closing.ending[out] = last[out] + count, whole, ENDED
            held = replace(held, last=top, whole=wholes)
    if np.isfinite(until).all():
        held = _held_until(held.with_room(int(held.last.max()) + 1), until)
    return replace(held, kinks=np.concatenate((held.kinks, held.last[None])))


def _held_until(held: Held, until: Array) -> Held:
    """With a row at the end of a hold, up to which the edge rests."""
    edge, since = held.edge, held.when - held.bodies.turn
    leg, end = held.second.after(since, 0.0 * since), held.bodies.turn + until
    b, left = leg.branches - held.lag, np.maximum(end - held.when, 0.0)
    beside = held.whole - edge * b
    D, faded, b = AtRest(leg, edge, b, beside)(left)
    row = np.array([edge, end, leg.depth - D, *(leg(left)[2] - b)])
    return held.onward(row, beside * faded + edge * b, left > 0.0)


def _first_step(held: Held) -> Array:
    """A part of the shortest relaxation time, and of that in which the edge came through its zone."""
    before = replace(held, last=np.maximum(held.last - 1, 0))
    speed = (held.edge - before.edge) / np.maximum(held.when - before.when, 1e-300)
    return STEADY * np.minimum(held.bodies.times.min(axis=0), held.bodies.zone / np.maximum(speed, 1e-300))


class AfterTurn:
    """``I/w - 1`` at radii at a time after the turn, which are taken for one more row."""

    def __init__(self, held: Held, elapsed: Array) -> None:
        self.held, self.elapsed, self.now = held, elapsed, held.bodies.turn + elapsed
        self.stage, self.branches = held.second.at(elapsed)
        if held.bodies.compliance.any():
            self.lag, self.whole, self.own = self._remembered()

    def _remembered(self) -> tuple[Array, Array, Array]:
        """Branch forces without the new row: what a spring takes, the whole contact; and what it counts."""
        held, bodies = self.held, self.held.bodies
        places, last = held.last - np.arange(3)[::-1, None], np.arange(len(held.last))
        radius, then, taken = held.rows[:3, places, last]
        length = np.maximum(self.now - held.when, NO_TIME * bodies.times.min(axis=0))
        known, nodes = places >= held.kinks[-1], np.concatenate((then, (held.when + length)[None]))
        known = np.concatenate((known, known[-1:]))
        at = held.when + length * LAYERED[:, None]
        parts = gained(nodes, known)[1]
        faded = fading(held.when + length - at, bodies.times)
        left = np.exp(-length / bodies.times)
        driving = radius * (held.stage(then)[0] - taken) - bodies.volume(radius)
        old, new = parts[:3], parts[3]
        sums = (old * taken[:, None]).sum(axis=0), (old * driving[:, None]).sum(axis=0), new
        lag, whole, own = (bodies.moduli * (faded * one[:, None]).sum(axis=0) for one in sums)
        return lag + held.lag * left, whole + held.whole * left, own

    def row(self, radius: Array) -> tuple[Array, Array]:
        """The row (3 + n, B), and integrals of the branch forces over the contact (n, B)."""
        bodies, none = self.held.bodies, 0.0 * self.branches
        if not bodies.compliance.any():
            return np.array([radius, self.now, 0.0 * radius, *none]), none
        V, S = bodies.volume(radius), bodies.relaxed + self.own.sum(axis=0)
        soft = 2.0 * bodies.compliance
        D = (self.stage + soft * (S * V - self.whole.sum(axis=0))) / (1.0 + soft * S * radius)
        u = self.stage - D
        return np.array([radius, self.now, u, *(self.lag + self.own * u)]), self.whole + self.own * (
            radius * D - V
        )

    def __call__(self, radius: Array) -> Array:
        held, bodies = self.held, self.held.bodies
        row, whole = self.row(np.maximum(radius, held.edge))
        held, D, b = (
            held.onward(row, whole, np.isfinite(radius)),
            self.stage - row[2],
            self.branches - row[3:],
        )
        points = quadrature(tuple(NEAR), True)
        forms, G = points.forms(bodies, radius)
        left = held.branches(radius - bodies.zone * (1.0 - points.v), self.now).sum(axis=0)
        q = bodies.relaxed * (D - G) + b.sum(axis=0) + left
        return (q * (forms[1] - D * forms[0])).sum(axis=0) / (-(math.pi**2) * bodies.closing) - 1.0


def _closing_on(
    held: Held, step: Array, until: Array, resolution: int
) -> Iterator[tuple[Whole, Array, Array]]:
    """Edges that go on closing and rest, or whose time is over; their rows from the last on; and the wholes.

    The fall of the speed from row to row tells when an edge will rest, and the next row is no farther than
    ``NEARER`` of the way. Where the edge would have come back there is no row: it opens, which no closure of
    an edge that closes tells; a nearer one is tried.
    """
    scenes, zone = np.arange(len(step)), held.bodies.zone
    local = held.last_rows(WINDOW).with_room(WINDOW + 1)
    edge, rounding = local.edge, ROUNDING * local.edge / zone
    error = AfterTurn(local, local.when - local.bodies.turn)(edge)  # of the place of the last
    first = step
    since, speed, fall, slope = np.zeros((4, len(step)))
    for _ in range(LONGEST * resolution):
        local = local.with_room(int(local.last.max()) + 3)
        y, elapsed = (local.edge - edge) / zone, local.when - local.bodies.turn
        over = elapsed + step >= until
        step = np.where(over, until - elapsed, step)
        residual = AfterTurn(local, np.where(over, until, elapsed + step))

        def at(y: Array, residual: AfterTurn = residual, edge: Array = edge, error: Array = error) -> Array:
            return residual(edge + y * residual.held.bodies.zone) - error

        guess = y + np.where(since > 0.0, np.maximum(speed - 0.5 * fall * (since + step), 0.0) * step, 1e-4)
        if not slope.any():
            slope = (at(guess + 1e-4) - at(guess)) * 1e4
        place, slope, known = secants(
            at, guess, slope, np.full(len(step), 0.1 * AT_REST / CONVERGED), rounding, np.isfinite(guess)
        )
        rises = known & (place > y)
        now = (place - y) / step
        fall = np.where(since > 0.0, 2.0 * (speed - now) / (since + step), 0.0)
        left = np.where(fall > 0.0, np.maximum(now / fall - 0.5 * step, 0.0), np.inf)
        over &= rises
        summit = rises & np.isinf(until) & np.isfinite(left) & (fall * left * left < 2.0 * AT_REST)
        local = local.onward(*residual.row(edge + place * zone), rises)
        place = place + 0.5 * fall * left * left
        if summit.any():
            later = AfterTurn(local, elapsed + step + np.where(summit, left, 0.0))
            local = local.onward(*later.row(edge + place * zone), summit)
        still = ~rises & (np.where(since > 0.0, speed * step, step / first * AT_REST / 1e-3) < AT_REST)
        ended = summit | still | over
        speed, since = np.where(rises, now, speed), np.where(rises, step, since)
        step = np.where(rises, np.minimum(step * (1.0 + 2.0 / resolution), NEARER * left), 0.25 * step)
        if ended.any():
            for last in np.unique(local.last[ended]):
                those = ended & (local.last == last)
                yield scenes[those], local.rows[:, WINDOW : last + 1, those], local.whole[:, those]
            some = filled(np.flatnonzero(~ended))
            scenes = scenes[some]
            edge, zone, rounding, error, since, speed, fall, slope, step, first, until = (
                part[some]
                for part in (edge, zone, rounding, error, since, speed, fall, slope, step, first, until)
            )
            local = local.of_some(some)
        if not len(scenes):
            break
