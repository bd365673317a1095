"""The march of the edges: rows, the root of a step, and the polynomials through rows."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from validation.reference.batch.grid import ROWS, Grid, Travel
from validation.reference.batch.scenes import Bodies, LoadRamp
from validation.reference.batch.zone import SHORTEST, quadrature
from validation.reference.path.numerics import derivative, horner

Array = NDArray[np.float64]
Whole = NDArray[np.intp]
Flags = NDArray[np.bool_]

CONVERGED, ITERATIONS = 1e-7, 20
"""Relative change of the time at which secants end (its error is the product of the last two), and most."""
ROUNDING = 16.0 * np.finfo(float).eps
"""Of a place in the zone, over the radius: times radius over zone, that of a residual."""
ROUNDED = 1e-15
"""Share of the penetration that is lost in rounding, and so the time in which it is driven."""
ROOM = 128
"""Rows for which there is room at first."""
GOING, DETACHED, ENDED, SHORT, FAILED, MISSED = range(6)
REASONS = {
    SHORT: "the contact shrinks to one and a half process zones before it is lost",
    FAILED: "the time at which the edge gets somewhere is not found",
    MISSED: "the force that ends the approach is not reached from below",
}


class StepResidual:
    """``I/w - 1`` at the radii of a step, of any time at which the edge gets there.

    ``still``: sums of the forms, and of them times ``G`` at their points. Those that the edge has passed
    carry what it left them, less ``carried G``: known of the rows before, and given for where it is now.
    """

    carried: Array | float
    rates: Array
    weights: Array | float

    def __init__(self, leg: LoadRamp, travel: Travel, forms: Array, shape: Array) -> None:
        self.bodies, self.leg, self.travel = leg.bodies, leg, travel
        self.still = forms.sum(axis=1), (forms * shape).sum(axis=1)
        self.forms, self.shape = forms[:, : travel.passed], shape[: travel.passed, None]

    def follow(self, times: Array, left: Array) -> None:
        """Take over the rows before; what was left at points not near fades alike in all time to come."""
        travel, flat, near = self.travel, left.reshape(len(left), left[0].size), self.travel.near
        when = travel.old @ times
        fields = (travel.old @ flat).reshape(travel.passed, *left.shape[1:]) - self.carried * self.shape
        self.when, self.left, self.before = when[:near], fields[:near], times[-1]
        faded = fields[near:] * np.exp((self.before - when[near:])[:, None] * self.rates) * self.weights
        self.far = np.einsum("fmb,mnb->fnb", self.forms[:, near:], faded)

    def passed(self, t: Array, left: Array) -> Array:
        """What the forms make of the points passed."""
        new = self.travel.new
        elapsed = np.maximum((1.0 - new) * t - self.when, 0.0)
        fields = (self.left + new[:, None] * left) * np.exp(elapsed[:, None] * self.rates) * self.weights
        near = (self.forms[:, : len(new)] * fields.sum(axis=1)).sum(axis=1)
        return np.asarray(
            near + (self.far * np.exp(np.maximum(t - self.before, 0.0) * self.rates)).sum(axis=1)
        )


class Opening(StepResidual):
    """``held``, ``edge``: branch forces beside ``E_k M_k`` behind the edge and at it, when the leg begins."""

    def __init__(self, leg: LoadRamp, travel: Travel, radius: Array, held: Array | None, edge: Array) -> None:
        forms, ahead = travel.points.forms(leg.bodies, radius)
        if held is not None:
            forms = np.concatenate((forms, travel.points.stressed(leg.bodies, radius, held)))
        super().__init__(leg, travel, forms, ahead)
        self.edge, self.carried = edge, leg.bodies.compliances * leg.bodies.relaxed
        self.rates, self.weights = -1.0 / leg.bodies.retardation, 1.0

    def left_behind(self, t: Array) -> Array:
        """``A_j`` (n, B) of what is released at a time."""
        faded, b = self.leg.faded(t)
        return self.bodies.released(self.leg.depth + self.leg.rate * t, b + self.edge * faded)

    def __call__(self, t: Array) -> Array:
        bodies, D, (faded, b) = self.bodies, self.leg.depth + self.leg.rate * t, self.leg.faded(t)
        factors = [bodies.relaxed * D + b.sum(axis=0), -bodies.relaxed]
        if len(self.forms) > 2:
            factors += list(faded)
        sums = self.still[1] - D * self.still[0]
        if self.travel.passed:
            sums += self.passed(t, bodies.released(D, b + self.edge * faded))
        return (np.array(factors) * sums).sum(axis=0) / (-(math.pi**2) * bodies.work) - 1.0


class Closing(StepResidual):
    """Of an edge that closes over a surface never touched."""

    carried = 1.0

    def __init__(self, leg: LoadRamp, travel: Travel, radius: Array) -> None:
        forms, behind = travel.points.forms(leg.bodies, radius)
        super().__init__(leg, travel, forms, behind)
        inside = forms[:, travel.passed :], (forms * behind)[:, travel.passed :]
        bodies = leg.bodies
        self.rates, self.weights = -1.0 / bodies.times, bodies.moduli
        self.start = bodies.glassy * (bodies.depth * inside[0].sum(axis=1) - inside[1].sum(axis=1))

    def left_behind(self, t: Array) -> Array:
        """``D - M_k`` (n, B) of what is covered at a time."""
        D, b = self.leg.at(t)
        return D - b / self.bodies.moduli

    def __call__(self, t: Array) -> Array:
        bodies, D, (faded, b) = self.bodies, self.leg.depth + self.leg.rate * t, self.leg.faded(t)
        sums = (bodies.relaxed * D + b.sum(axis=0)) * self.still[0] - bodies.relaxed * self.still[1]
        sums += self.start * (bodies.moduli * faded).sum(axis=0)
        sums += self.passed(t, D - b / bodies.moduli)
        return (sums[1] - D * sums[0]) / (-(math.pi**2) * bodies.closing) - 1.0


def secants(
    residual: Callable[[Array], Array], one: Array, slope: Array, scale: Array, noise: Array, asked: Flags
) -> tuple[Array, Array, Flags]:
    """Roots, slopes and whether they are found, of those asked for; each scene stops by itself.

    A residual below its ``noise`` is none. Where a secant leads out of the two places between which the sign
    changes, the next one is in their middle: over a layer that relaxes the residual bends sharply.
    """
    f, done = residual(one), ~asked
    rising = np.sign(slope)
    low, high = np.where(rising * f < 0.0, one, -np.inf), np.where(rising * f < 0.0, np.inf, one)
    two = np.where(asked, one - f / slope, one)
    done |= np.abs(two - one) <= CONVERGED * (np.abs(two) + scale)
    for _ in range(ITERATIONS):
        if done.all():
            break
        value = residual(two)
        low, high = np.where(rising * value < 0.0, two, low), np.where(rising * value < 0.0, high, two)
        moving = ~done & (two != one) & (value != f)
        slope = np.where(moving, (value - f) / (two - one), slope)
        change = np.where(moving, value / slope, 0.0)
        astray = moving & np.isfinite(high - low) & ((two - change - low) * (two - change - high) > 0.0)
        change = np.where(astray, two - 0.5 * (low + high), change)
        one, f, two = np.where(done, one, two), np.where(done, f, value), two - change
        done = done | ~(np.abs(change) > CONVERGED * (np.abs(two) + scale)) | (np.abs(value) < noise)
    return two, slope, done & np.isfinite(two)


def begun(residual: Callable[[Array], Array], first: Array, quick: Array, sign: float) -> tuple[Array, Array]:
    """A time beyond which an edge is where it is after its first step, and the slope up to there."""
    apart, value = quick, residual(first)
    low = value
    for _ in range(64):
        now = residual(first + apart)
        behind = sign * now > 0.0
        if not behind.any():
            break
        low, apart = np.where(behind, now, low), np.where(behind, 2.0 * apart, apart)
    since = np.where(apart > quick, 0.5 * apart, 0.0)
    return first + apart, (residual(first + apart) - low) / (apart - since)


def start_radius(bodies: Bodies) -> Array:
    """Of the elastic contact: secants from a sharp edge, beyond the outermost root of which ``I`` rises."""
    D, n, w = bodies.depth, bodies.exponent, bodies.closing
    E = bodies.relaxed + bodies.glassy * bodies.moduli.sum(axis=0)
    points = quadrature(())

    def released(radius: Array) -> Array:
        (M, N), ahead = points.forms(bodies, radius)
        return -E * ((D * M - N) * (ahead - D)).sum(axis=0) / (math.pi**2 * w) - 1.0

    alone = 9.0 * math.pi * w / (2.0 * E * bodies.coefficient**2)
    radius = (np.maximum(D, 0.0) / bodies.coefficient) ** (1.0 / n) + 1.5 * alone ** (1.0 / (2.0 * n - 1.0))
    for _ in range(ITERATIONS):
        G, root = bodies.shape(radius[None])[0], np.sqrt(2.0 * math.pi * radius * w / E)
        radius = np.maximum(radius - (G - D - root) / ((n * G - 0.5 * root) / radius), 0.3 * radius)
    radius = np.maximum(radius, SHORTEST * bodies.zone)
    slope = (released(radius * (1.0 + 1e-3)) - released(radius)) / (1e-3 * radius)
    return secants(released, radius, slope, 0.0 * radius, ROUNDING * radius / bodies.zone, radius > 0.0)[0]


@dataclass(eq=False)
class March:
    """Rows (S, B) of time, penetration, force and radius, ``last`` of each scene, and how it ended.

    ``left`` (S, n, B): what the edge left where it was; ``resting`` (4, m, B): rows before the first.
    ``quick``: a time in which it gets nowhere; ``lost``: one that is lost in the rounding of the penetration,
    as a scale of the convergence of secants.
    """

    grid: Grid
    leg: LoadRamp
    columns: Array
    left: Array
    last: Whole
    ending: Whole
    slope: Array
    quick: Array
    lost: Array
    resting: Array

    @classmethod
    def empty(cls, steps: Grid, leg: LoadRamp, start: Array, duration: Array) -> March:
        """Before the first row."""
        bodies, count = leg.bodies, len(start)
        usable = np.isfinite(start) & np.isfinite(duration)
        quick = 1e-4 * np.minimum(bodies.zone / np.abs(leg.rate), bodies.times.min(axis=0, initial=np.inf))
        depths = np.abs(leg.depth) + bodies.shape(start[None])[0]
        return cls(
            steps,
            leg,
            np.zeros((4, ROOM, count)),
            np.zeros((ROOM, len(bodies.moduli), count)),
            np.zeros(count, np.intp),
            np.where(usable, GOING, FAILED),
            np.ones(count),
            quick,
            ROUNDED / CONVERGED * depths / np.abs(leg.rate),
            np.zeros((4, 0, count)),
        )

    @property
    def going(self) -> Flags:
        """Scenes that have not ended."""
        return self.ending == GOING

    @property
    def time(self) -> Array:
        """Times."""
        return self.columns[0]

    @property
    def force(self) -> Array:
        """Forces."""
        return self.columns[2]

    @property
    def radius(self) -> Array:
        """Radii."""
        return self.columns[3]

    def root(self, k: int, step: Opening | Closing, first: Array) -> tuple[Array, Flags]:
        """The time of a row, that of the row before where none is found, and of which scenes it is."""
        travel, going = step.travel, self.going
        step.follow(self.time[travel.first : k], self.left[travel.first : k])
        if k == 1:
            sign = 1.0 if isinstance(step, Closing) else -1.0
            guess, self.slope = begun(step, first, self.quick, sign)
        else:
            guess = travel.guess @ self.time[k - len(travel.guess) : k]
            if k > 2:  # a polynomial through times of several decades may come before the last of them
                g, before, now = self.grid.g, *self.time[k - 2 : k]
                straight = now + (now - before) * (g[k] - g[k - 1]) / (g[k - 1] - g[k - 2])
                guess = np.where(guess > now, guess, straight)
        noise = ROUNDING * self.radius[0] / self.leg.bodies.zone
        t, slope, found = secants(step, guess, self.slope, self.lost, noise, going)
        self.ending[going & ~found] = FAILED
        going = going & found
        self.slope = np.where(going & (slope != 0.0), slope, 1.0)
        self.last[going] = k
        return np.where(going, t, self.time[k - 1]), going

    def add(self, k: int, t: Array, radius: Array, held: Array, left: Array) -> None:
        """A row; ``held``: integrals over the contact of branch forces beside ``E_k M_k``."""
        if k == len(self.left):
            self.columns = np.concatenate((self.columns, np.zeros_like(self.columns)), axis=1)
            self.left = np.concatenate((self.left, np.zeros_like(self.left)))
        D, b = self.leg.at(t)
        self.columns[:, k] = t, D, self.leg.bodies.force(D, b, radius, held), radius
        self.left[k] = left

    def polynomials(self, values: Array, panel: Whole) -> Array:
        """Coefficients (ROWS, B) of rows in a panel of each scene, in shares of it, by differences."""
        first, count = self.grid.panels(panel, self.last)
        rows = first + np.minimum(np.arange(ROWS)[:, None], count - 1)
        begin, end = self.grid.g[panel], self.grid.g[panel + 1]
        u = (self.grid.g[rows] - begin) / (end - begin)
        table, curve = values[rows, np.arange(len(panel))], np.zeros(rows.shape)
        for order in range(1, ROWS):
            known = np.arange(order, ROWS)[:, None] < count
            table[order:] = np.where(
                known, np.diff(table[order - 1 :], axis=0) / (u[order:] - u[:-order]), 0.0
            )
        for i in range(ROWS - 1, -1, -1):
            curve = np.concatenate((table[i : i + 1], curve[:-1])) - u[i] * curve
        return curve

    def panel(self, place: Array) -> tuple[Whole, Array]:
        """The panel in which a travel lies, and its share there."""
        g = self.grid.g
        panel = np.minimum(np.maximum(g.searchsorted(place) - 1, 0), np.maximum(self.last - 1, 0))
        return panel, (place - g[panel]) / (g[panel + 1] - g[panel])

    def at(self, values: Array, place: Array) -> Array:
        """Values (B,) at a travel of each scene."""
        panel, u = self.panel(place)
        return horner(self.polynomials(values, panel), u)

    def largest(self, values: Array) -> tuple[Array, Array]:
        """Travel and value (B,) where rows are largest, between them too."""
        scenes, g = np.arange(len(self.last)), self.grid.g
        row = np.where(np.arange(len(values))[:, None] <= self.last, values, -np.inf).argmax(axis=0)
        place, most = g[row], values[row, scenes]
        u = np.linspace(0.0, 1.0, 65)[:, None]
        for panel in (row - 1, row):
            panel = np.minimum(np.maximum(panel, 0), np.maximum(self.last - 1, 0))
            curve = self.polynomials(values, panel)
            slopes, bends = derivative(curve), derivative(derivative(curve))
            near = horner(curve, u).argmax(axis=0)
            middle = np.clip(near, 1, len(u) - 2) / (len(u) - 1.0)
            for _ in range(3):
                slope, bend = horner(slopes, middle), horner(bends, middle)
                middle = np.where(bend < 0.0, np.clip(middle - slope / bend, 0.0, 1.0), middle)
            middle = np.where((near == 0) | (near == len(u) - 1), near / (len(u) - 1.0), middle)
            value = horner(curve, middle)
            better = value > most
            place = np.where(better, g[panel] + middle * (g[panel + 1] - g[panel]), place)
            most = np.where(better, value, most)
        return place, most

    def reached(self, values: Array, level: Array) -> Array:
        """Travel (B,) at which rows come to a level in the last panel."""
        panel = np.maximum(self.last - 1, 0)
        curve, low, high = self.polynomials(values, panel), np.zeros(len(panel)), np.ones(len(panel))
        for _ in range(50):
            middle = 0.5 * (low + high)
            above = horner(curve, middle) > level
            low, high = np.where(above, low, middle), np.where(above, middle, high)
        g = self.grid.g
        return g[panel] + high * (g[panel + 1] - g[panel])
