"""What an edge that closed has left in contact, and how it comes to rest after the turn of the load.

It goes on closing there where the layer it has just covered relaxes faster than the load falls. Then time
rules its steps: at rest the radius does not tell it.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from validation.reference.batch.march import ENDED, FAILED, ROUNDING, March, secants
from validation.reference.batch.scenes import Bodies, LoadRamp
from validation.reference.batch.zone import SHARES, SWEPT, quadrature

Array = NDArray[np.float64]
Whole = NDArray[np.intp]

LONGEST, STEADY, WINDOW = 140, 0.02, 60
"""Steps in time of an edge that goes on closing after the turn, the first of them, and rows in its zone."""
FINER = 0.002, 0.008, 0.015, 0.05, 0.08, 0.12, 0.3, 0.4, 0.8
"""More breaks in this case: the place of the turn is somewhere in the zone."""


@dataclass(frozen=True, eq=False)
class Held:
    """What an edge that closed has left in contact: rows (S, B) of its radius and time, ``last`` of each.

    ``start``: radius at the start; ``first``, ``second``: the legs before and after the turn of the load;
    ``kinks`` (l, B): rows, in rising order.
    """

    bodies: Bodies
    first: LoadRamp
    second: LoadRamp
    start: Array
    radius: Array
    time: Array
    last: Whole
    kinks: Whole

    def of_some(self, chosen: Whole, bodies: Bodies) -> Held:
        """Of some scenes."""
        first, second = (one.of_some(chosen, bodies) for one in (self.first, self.second))
        radius, time, kinks = self.radius[:, chosen], self.time[:, chosen], self.kinks[:, chosen]
        return Held(bodies, first, second, self.start[chosen], radius, time, self.last[chosen], kinks)

    @cached_property
    def places(self) -> tuple[Array, Array, Array]:
        """Where rows begin, how far they go, and shares of that, scene after scene from even numbers."""
        scenes = np.arange(len(self.last))
        begin, end = self.radius[0], self.radius[self.last, scenes]
        whole = np.where(end > begin, end - begin, 1.0)
        rows = np.arange(len(self.radius))[:, None] <= self.last
        place = np.where(rows, np.minimum((self.radius - begin) / whole, 1.0), 1.0)
        return begin, whole, (place + 2.0 * scenes).T.ravel()

    def passed(self, x: Array) -> Array:
        """Times at which radii (m, B) were covered: roots of cubics through rows."""
        scenes, (begin, whole, flat) = np.arange(len(self.last)), self.places
        shares = np.clip((x - begin) / whole, 0.0, 1.0) + 2.0 * scenes
        row = flat.searchsorted(shares, side="right") - 1 - len(self.radius) * scenes
        row = np.clip(row, 0, np.maximum(self.last - 1, 0))
        low = np.where(self.kinks[:, None] <= row, self.kinks[:, None], 0).max(axis=0)
        high = np.where(self.kinks[:, None] > row, self.kinks[:, None], self.last).min(axis=0)
        first = np.clip(row - 1, low, np.maximum(high - 3, low))
        first = np.maximum(np.minimum(first, self.last - 3), 0)
        nodes = [np.minimum(first + i, self.last) for i in range(4)]
        times = [self.time[node, scenes] for node in nodes]
        radii = [self.radius[node, scenes] for node in nodes]
        table = list(radii)
        for order in range(1, 4):
            for i in range(3, order - 1, -1):
                apart = times[i] - times[i - order]
                table[i] = np.where(
                    apart > 0.0, (table[i] - table[i - 1]) / np.where(apart > 0.0, apart, 1.0), 0.0
                )
        early, late = self.time[row, scenes], self.time[np.minimum(row + 1, self.last), scenes]
        near, far = self.radius[row, scenes], self.radius[np.minimum(row + 1, self.last), scenes]
        t = early + (late - early) * np.clip((x - near) / np.where(far > near, far - near, 1.0), 0.0, 1.0)
        for _ in range(4):
            value, slope = table[3], 0.0
            for i in (2, 1, 0):
                slope = slope * (t - times[i]) + value
                value = value * (t - times[i]) + table[i]
            better = t - (value - x) / np.where(slope > 0.0, slope, np.inf)
            t = np.clip(better, early, late)
        return t

    def integral(self, now: Array) -> Array:
        """``int_0^a`` (n, B) of what is left at a time."""
        bodies, start, rows = self.bodies, self.start, self.radius
        width = np.where(np.arange(1, len(rows))[:, None] <= self.last, np.diff(rows, axis=0), 0.0)
        x = (rows[:-1, None] + width[:, None] * SWEPT[:, None]).reshape(-1, len(start))
        values = self.branches(x, now).reshape(len(bodies.moduli), len(width), -1, len(start))
        inside = bodies.glassy * bodies.moduli * (bodies.depth * start - bodies.volume(start))
        inside = inside * np.exp(-now / bodies.times)
        return np.asarray(inside + (values * SHARES[:, None] * width[:, None]).sum(axis=(1, 2)))

    def branches(self, x: Array, now: Array) -> Array:
        """What is left (n, m, B) at a time beside ``E_k M_k``."""
        bodies, t = self.bodies, self.passed(x)
        turn = bodies.turn
        one, two = self.first.at(np.minimum(t, turn)), self.second.at(np.maximum(t - turn, 0.0))
        moduli = bodies.moduli[:, None]
        D, b = np.where(t > turn, two[0], one[0]), np.where(t > turn, two[1], one[1])
        covered = np.where(x > self.start, 1.0, bodies.glassy)
        strain = covered * (D - bodies.shape(x)) * moduli - covered * b
        return np.asarray(strain * np.exp((t - now) / bodies.times[:, None]))


def turned(bodies: Bodies, first: LoadRamp, closing: March, resolution: int) -> tuple[Held, Array]:
    """What an edge leaves that has come to rest some time after the turn of the load, and when that was."""
    scenes, last = np.arange(len(bodies.zone)), closing.last
    second = first.after(bodies.turn, bodies.rate)
    start = closing.radius[0]
    edge = start + np.where(last > 0, closing.reached(closing.time, bodies.turn), 0.0) * bodies.zone
    empty = np.zeros((LONGEST, len(last)))
    size = int(last.max()) + 1
    radius, time = (np.concatenate((part[:size], empty)) for part in (closing.radius, closing.time))
    radius[last, scenes], time[last, scenes] = edge, bodies.turn
    kinks = np.array([np.minimum(row, last) for row in (*closing.grid.breaks, last)])
    held, top = Held(bodies, first, second, start, radius, time, last, kinks), last.copy()
    if len(bodies.moduli):
        step = _first_step(held)
        moves = (closing.ending == ENDED) & (AfterTurn(held, step)(edge) < AfterTurn(held, 0.0 * step)(edge))
        some = np.flatnonzero(moves)
        if len(some):
            found = _closing_on(held.of_some(some, bodies.of_some(some)), step[some], resolution)
            rows = last[some] + np.arange(LONGEST)[:, None]
            radius[rows, some], time[rows, some] = found[:2]
            top[some] += found[2]
            closing.ending[some[found[2] < 0]] = FAILED
    return Held(bodies, first, second, start, radius, time, top, kinks), time[top, scenes]


def _first_step(held: Held) -> Array:
    """A part of the shortest relaxation time, and of that in which the edge came through its zone."""
    scenes, last = np.arange(len(held.last)), held.last
    before = np.maximum(last - 1, 0)
    since = held.time[last, scenes] - held.time[before, scenes]
    speed = (held.radius[last, scenes] - held.radius[before, scenes]) / np.maximum(since, 1e-300)
    return STEADY * np.minimum(held.bodies.times.min(axis=0), held.bodies.zone / np.maximum(speed, 1e-300))


class AfterTurn:
    """``I/w - 1`` at radii at a time after the turn, which are taken for one more row."""

    def __init__(self, held: Held, elapsed: Array) -> None:
        self.held, self.elapsed, self.now = held, elapsed, held.bodies.turn + elapsed

    def __call__(self, radius: Array) -> Array:
        held, bodies, scenes = self.held, self.held.bodies, np.arange(len(radius))
        rows, times, next_row = held.radius.copy(), held.time.copy(), held.last + 1
        rows[next_row, scenes] = np.maximum(radius, rows[held.last, scenes])
        times[next_row, scenes] = self.now
        held = replace(held, radius=rows, time=times, last=next_row)
        points = quadrature(FINER, True)
        forms, G = points.forms(bodies, radius)
        D, b = held.second.at(self.elapsed)
        left = held.branches(radius - bodies.zone * (1.0 - points.v), self.now).sum(axis=0)
        q = bodies.relaxed * (D - G) + b.sum(axis=0) + left
        return (q * (forms[1] - D * forms[0])).sum(axis=0) / (-(math.pi**2) * bodies.closing) - 1.0


def _closing_on(held: Held, step: Array, resolution: int) -> tuple[Array, Array, Whole]:
    """Rows from the turn on of edges that go on closing; the last, where they rest, or -1."""
    bodies, scenes, window = held.bodies, np.arange(len(step)), WINDOW
    old = held.last - window + np.arange(window + 1)[:, None]
    empty = np.zeros((LONGEST, len(step)))
    radius, time = (
        np.concatenate((part[np.maximum(old, 0), scenes], empty)) for part in (held.radius, held.time)
    )
    kinks = np.clip(held.kinks - held.last + window, 0, window)
    top, edge = np.full(len(step), window), radius[window].copy()
    elapsed, moves, found = 0.0 * step, np.ones(len(step), bool), np.full(len(step), -1)
    error, rounding = 0.0 * step, ROUNDING * edge / bodies.zone
    for k in range(1, LONGEST):
        if not moves.any():
            break
        elapsed = elapsed + step
        step = step * (1.0 + 2.0 / resolution)
        local = Held(bodies, held.first, held.second, held.start, radius, time, top, kinks)
        residual = AfterTurn(local, elapsed)
        if k == 1:
            error = AfterTurn(local, 0.0 * step)(edge)  # of the place of the turn
        y = (radius[window : window + k] - edge) / bodies.zone
        guess = np.where(moves, 2.0 * y[-1] - y[-2] if k > 1 else 1e-4, y[-1])

        def at(y: Array, residual: AfterTurn = residual, error: Array = error) -> Array:
            return residual(edge + y * bodies.zone) - error

        slope = (at(guess + 1e-4) - at(guess)) * 1e4
        place, _, done = secants(at, guess, slope, np.full(len(step), 1e-3), rounding, moves)
        rises = moves & done & (place > y[-1])
        turns = moves & ~rises & np.isfinite(place)
        row = window + k
        radius[row], time[row] = edge + np.where(rises, place, y[-1]) * bodies.zone, residual.now
        if k > 1 and turns.any():
            t = time[row - 2 : row + 1]
            one = (y[-1] - y[-2]) / (t[1] - t[0])
            bend = ((place - y[-1]) / (t[2] - t[1]) - one) / (t[2] - t[0])
            summit = 0.5 * (t[0] + t[1] - one / bend)
            peak = y[-2] + (summit - t[0]) * (one + bend * (summit - t[1]))
            at_row = np.where(summit < t[1], row - 1, row)[turns]
            radius[at_row, scenes[turns]] = (edge + peak * bodies.zone)[turns]
            time[at_row, scenes[turns]] = summit[turns]
            found[turns] = at_row - window
        elif k == 1:
            found[turns] = 0
        top, moves = np.where(rises, row, top), rises
    return radius[window : window + LONGEST], time[window : window + LONGEST], found
