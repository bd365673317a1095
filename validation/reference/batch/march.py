"""The march of the edges: rows, the root of a step, and the polynomials through rows."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, fields, replace
from typing import Any

import numpy as np
from numpy.polynomial.polynomial import polyval
from numpy.typing import NDArray

from validation.reference.batch.grid import ROWS, Grid, Travel, panels
from validation.reference.batch.scenes import Bodies, LoadRamp, SideBySide, State
from validation.reference.batch.zone import SHORTEST, quadrature
from validation.reference.path.numerics import derivative

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
GOING, DETACHED, ENDED, SHORT, FAILED, MISSED, SOFT, HANDED, JUMPED = range(9)
REASONS = {
    SHORT: "the contact shrinks to one and a half process zones before it is lost",
    FAILED: "the time at which the edge gets somewhere is not found",
    MISSED: "the force that ends a ramp is not reached",
    SOFT: "a spring so much softer than the contact that the edge hardly knows when the load turns",
    JUMPED: "a spring so soft that the edge jumps as it closes",
}


Drive = Callable[[Array], State]
"""Where the indenter is at a time (B,) since the ramp began."""


class StepResidual:
    """``I/w - 1`` at the radii of a step, of any time at which the edge gets there.

    ``still``: sums of the forms, and of them times ``G`` at their points. Those that the edge has passed
    carry what it left them, less ``carried G``: known of the rows before, and given for where it is now.
    """

    carried: Array | float
    rates: Array
    weights: Array | float

    def __init__(self, bodies: Bodies, state: Drive, travel: Travel, forms: Array, shape: Array) -> None:
        self.bodies, self.state, self.travel = bodies, state, travel
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
        new, earliest = self.travel.new, self.bodies.earliest
        elapsed = np.maximum((1.0 - new) * t - self.when, earliest)
        fields = (self.left + new[:, None] * left) * np.exp(elapsed[:, None] * self.rates) * self.weights
        near = (self.forms[:, : len(new)] * fields.sum(axis=1)).sum(axis=1)
        return np.asarray(
            near + (self.far * np.exp(np.maximum(t - self.before, earliest) * self.rates)).sum(axis=1)
        )


class Opening(StepResidual):
    """``held``, ``edge``: branch forces beside ``E_k M_k`` behind the edge and at it, when the leg begins."""

    def __init__(
        self, bodies: Bodies, state: Drive, travel: Travel, radius: Array, held: Array | None, edge: Array
    ) -> None:
        forms, ahead = travel.points.forms(bodies, radius)
        if held is not None:
            forms = np.concatenate((forms, travel.points.stressed(bodies, radius, held)))
        super().__init__(bodies, state, travel, forms, ahead)
        self.edge, self.carried = edge, bodies.compliances * bodies.relaxed
        self.rates, self.weights = -1.0 / bodies.retardation, 1.0

    def __call__(self, t: Array) -> Array:
        bodies, (D, faded, b) = self.bodies, self.state(t)
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

    def __init__(self, bodies: Bodies, state: Drive, travel: Travel, radius: Array) -> None:
        forms, behind = travel.points.forms(bodies, radius)
        super().__init__(bodies, state, travel, forms, behind)
        inside = forms[:, travel.passed :], (forms * behind)[:, travel.passed :]
        self.rates, self.weights = -1.0 / bodies.times, bodies.moduli
        self.start = bodies.glassy * (bodies.depth * inside[0].sum(axis=1) - inside[1].sum(axis=1))

    def __call__(self, t: Array) -> Array:
        bodies, (D, faded, b) = self.bodies, self.state(t)
        sums = (bodies.relaxed * D + b.sum(axis=0)) * self.still[0] - bodies.relaxed * self.still[1]
        sums += self.start * (bodies.moduli * faded).sum(axis=0)
        sums += self.passed(t, D - b / bodies.moduli)
        return (sums[1] - D * sums[0]) / (-(math.pi**2) * bodies.closing) - 1.0


def secants(
    residual: Callable[[Array], Array], one: Array, slope: Array, scale: Array, noise: Array, asked: Flags
) -> tuple[Array, Array, Flags]:
    """Roots, slopes and whether they are found, of those asked for; each scene stops by itself.

    A residual below its ``noise`` is none. Once its sign has changed, the next place is in the middle where a
    secant leads out of the two places between which it does, or where three places do not lie on a curve that
    has an inverse of second order (Chandrupatla, Adv. Eng. Softw. 28, 145, 1997): over a layer that relaxes
    the residual bends sharply, and secants from its flat side creep.
    """
    f, done = residual(one), ~asked
    far, third, at_far, at_third = np.full((4, *one.shape), np.nan)  # of the other sign, and the one before
    two = np.where(asked, one - f / slope, one)
    done |= np.abs(two - one) <= CONVERGED * (np.abs(two) + scale)
    for _ in range(ITERATIONS):
        if done.all():
            break
        value = residual(two)
        same = value * f > 0.0
        third, at_third = np.where(same, one, far), np.where(same, f, at_far)
        far, at_far = np.where(same, far, one), np.where(same, at_far, f)
        moving = ~done & (two != one) & (value != f)
        slope = np.where(moving, (value - f) / (two - one), slope)
        change = np.where(moving, value / slope, 0.0)
        place, share = (two - far) / (third - far), (value - at_far) / (at_third - at_far)
        bent = (share**2 >= place) | ((1.0 - share) ** 2 >= 1.0 - place)
        out = (change * (two - far) < 0.0) | (np.abs(change) > np.abs(two - far))
        change = np.where(moving & (bent | out), 0.5 * (two - far), change)
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
class March(SideBySide):
    """Rows (S, B) of time, penetration, force and radius, ``last`` of each scene, and how it ended.

    ``left`` (S, n, B): what the edge left where it was; ``resting`` (4, m, B): rows before the first.
    ``quick``: a time in which it gets nowhere; ``lost``: one that is lost in the rounding of the penetration,
    as a scale of the convergence of secants. ``g``, ``breaks``: travels of the rows, and rows of corners, of
    each scene or of all. ``given``: the last row of those that are known before. ``lags``: branch
    forces (S, n, B) that a spring has taken of those of the stage; ``wholes``: integrals over the contact.
    """

    grid: Grid
    g: Array
    breaks: Whole
    given: Whole
    leg: LoadRamp
    columns: Array
    left: Array
    last: Whole
    ending: Whole
    slope: Array
    quick: Array
    lost: Array
    resting: Array
    lags: Array
    wholes: Array

    @classmethod
    def empty(cls, steps: Grid, leg: LoadRamp, start: Array, duration: Array) -> March:
        """Before the first row."""
        bodies, count = leg.bodies, len(start)
        usable = np.isfinite(start) & np.isfinite(duration) & (duration >= 0.0)
        quick = 1e-4 * np.minimum(bodies.zone / np.abs(leg.rate), bodies.times.min(axis=0, initial=np.inf))
        depths = np.abs(leg.depth) + bodies.shape(start[None])[0]
        return cls(
            steps,
            steps.g[:, None],
            steps.breaks[:, None],
            np.full(count, -1),
            leg,
            np.zeros((4, ROOM, count)),
            np.zeros((ROOM, len(bodies.moduli), count)),
            np.zeros(count, np.intp),
            np.where(usable, GOING, FAILED),
            np.ones(count),
            quick,
            ROUNDED / CONVERGED * depths / np.abs(leg.rate),
            np.zeros((4, 0, count)),
            np.zeros((ROOM, len(bodies.moduli), count)),
            np.zeros((ROOM, len(bodies.moduli), count)),
        )

    @classmethod
    def side_by_side(cls, parts: list[March], leg: LoadRamp) -> March:
        """Rows of one grid, of the scenes of several."""
        most = max(len(one.left) for one in parts)
        for one in parts:
            while len(one.left) < most:
                one.grow()
        each = {part.name: [getattr(one, part.name) for one in parts] for part in fields(cls)}
        joint: dict[str, Any] = {
            name: np.concatenate(values, axis=-1)
            for name, values in each.items()
            if isinstance(values[0], np.ndarray) and values[0].shape[-1] > 1
        }
        return replace(parts[0], leg=leg, **joint)

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
        """The time of a row, that of the row before where none is found, and of which scenes it is.

        Where none is, as ``I > w`` there already at the row before, the edge jumps.
        """
        travel, going = step.travel, self.going
        step.follow(self.time[travel.first : k], self.left[travel.first : k])
        if k == 1:
            sign = 1.0 if isinstance(step, Closing) else -1.0
            guess, self.slope = begun(step, first, self.quick, sign)
        else:
            guess = travel.guess @ self.time[k - len(travel.guess) : k]
            if k > 2:  # a polynomial through times of several decades may come too early, or before the last
                g, before, now = self.grid.g, *self.time[k - 2 : k]
                straight = now + (now - before) * (g[k] - g[k - 1]) / (g[k - 1] - g[k - 2])
                early = guess < straight if isinstance(step, Closing) else guess <= now
                guess = np.where(early, straight, guess)
        noise = ROUNDING * self.radius[0] / self.leg.bodies.zone
        t, slope, found = secants(step, guess, self.slope, self.lost, noise, going)
        none, going = going & ~found, going & found
        if none.any():
            self.ending[none] = np.where(step(self.time[k - 1]) > 0.0, JUMPED, FAILED)[none]
        self.slope = np.where(going & (slope != 0.0), slope, self.slope)
        self.last[going] = k
        return np.where(going, t, self.time[k - 1]), going

    def grow(self) -> None:
        """Make room for twice as many rows."""
        self.columns = np.concatenate((self.columns, np.zeros_like(self.columns)), axis=1)
        for name in ("left", "lags", "wholes"):
            part = getattr(self, name)
            setattr(self, name, np.concatenate((part, np.zeros_like(part))))

    def add(self, k: int, t: Array, radius: Array, state: State, held: Array, left: Array) -> None:
        """A row; ``held``: integrals over the contact of branch forces beside ``E_k M_k``."""
        if k == len(self.left):
            self.grow()
        D, _, b = state
        given, row = k <= self.given, np.array([t, D, self.leg.bodies.force(D, b, radius, held), radius])
        self.columns[:, k] = np.where(given, self.columns[:, k], row)
        self.left[k] = np.where(given, self.left[k], left)
        self.lags[k] = np.where(given, self.lags[k], self.leg(t)[2] - b)
        self.wholes[k] = held + radius * b

    def polynomials(self, values: Array, panel: Whole) -> Array:
        """Coefficients (ROWS, ..., B) of rows in panels of each scene, in shares of them, by differences."""
        breaks = self.breaks.reshape(-1, *[1] * (panel.ndim - 1), self.breaks.shape[1])
        first, count = panels(breaks, panel, self.last)
        orders = np.arange(ROWS).reshape(-1, *[1] * panel.ndim)
        rows, scenes = first + np.minimum(orders, count - 1), np.arange(panel.shape[-1])
        travels = np.broadcast_to(self.g, (len(self.g), len(scenes)))
        begin, end = travels[panel, scenes], travels[panel + 1, scenes]
        u = (travels[rows, scenes] - begin) / (end - begin)
        table, curve = values[rows, scenes], np.zeros(rows.shape)
        for order in range(1, ROWS):
            known = orders[order:] < count
            table[order:] = np.where(
                known, np.diff(table[order - 1 :], axis=0) / (u[order:] - u[:-order]), 0.0
            )
        for i in range(ROWS - 1, -1, -1):
            curve = np.concatenate((table[i : i + 1], curve[:-1])) - u[i] * curve
        return curve

    def travel(self, row: Whole) -> Array:
        """Travels (..., B) of rows of each scene."""
        return np.asarray(
            np.broadcast_to(self.g, (len(self.g), len(self.last)))[row, np.arange(len(self.last))]
        )

    def panel(self, place: Array) -> tuple[Whole, Array]:
        """The panels in which travels (..., B) lie, and shares of them there."""
        below = (self.g.reshape(len(self.g), *[1] * (place.ndim - 1), -1) < place).sum(axis=0) - 1
        panel = np.minimum(np.maximum(below, 0), np.maximum(self.last - 1, 0))
        begin = self.travel(panel)
        return panel, (place - begin) / (self.travel(panel + 1) - begin)

    def at(self, values: Array, place: Array) -> Array:
        """Values at travels (..., B) of each scene."""
        panel, u = self.panel(place)
        return np.asarray(polyval(u, self.polynomials(values, panel), tensor=False), float)

    def largest(self, values: Array) -> tuple[Array, Array]:
        """Travel and value (B,) where rows are largest, between them too."""
        scenes = np.arange(len(self.last))
        row = np.where(np.arange(len(values))[:, None] <= self.last, values, -np.inf).argmax(axis=0)
        place, most = self.travel(row), values[row, scenes]
        u = np.linspace(0.0, 1.0, 65)[:, None]
        for panel in (row - 1, row):
            panel = np.minimum(np.maximum(panel, 0), np.maximum(self.last - 1, 0))
            curve = self.polynomials(values, panel)
            slopes, bends = derivative(curve), derivative(derivative(curve))
            near = polyval(u, curve, tensor=False).argmax(axis=0)
            middle = np.clip(near, 1, len(u) - 2) / (len(u) - 1.0)
            for _ in range(3):
                slope, bend = polyval(middle, slopes, tensor=False), polyval(middle, bends, tensor=False)
                middle = np.where(bend < 0.0, np.clip(middle - slope / bend, 0.0, 1.0), middle)
            middle = np.where((near == 0) | (near == len(u) - 1), near / (len(u) - 1.0), middle)
            value, begin = polyval(middle, curve, tensor=False), self.travel(panel)
            better = value > most
            place = np.where(better, begin + middle * (self.travel(panel + 1) - begin), place)
            most = np.where(better, value, most)
        return place, most

    def reached(self, values: Array, level: Array) -> Array:
        """Travel (B,) at which rows come to a level in the last panel."""
        panel = np.maximum(self.last - 1, 0)
        curve, low, high = self.polynomials(values, panel), np.zeros(len(panel)), np.ones(len(panel))
        for _ in range(50):
            middle = 0.5 * (low + high)
            above = polyval(middle, curve, tensor=False) > level
            low, high = np.where(above, low, middle), np.where(above, middle, high)
        begin = self.travel(panel)
        return begin + high * (self.travel(panel + 1) - begin)

    def handed_over(self, steps: Grid, origin: Array) -> March:
        """Rows of a grid whose travels count from a radius, as far as they are known of those here."""
        bodies = self.leg.bodies
        offset, reached = (self.radius[0] - origin) / bodies.zone, self.travel(self.last)
        found = March.empty(steps, self.leg, self.radius[0], self.time[0])
        found.ending, found.slope, found.lost = self.ending.copy(), self.slope, self.lost
        waits = self.ending == HANDED
        found.given = np.where(waits, steps.g.searchsorted(reached - offset, side="right") - 1, 0)
        found.last = found.given.copy()
        most, least = int(found.given.max()), int(found.given[waits].min())
        begin = max(int(steps.g.searchsorted(steps.g[least] - 1.0)) - ROWS, 0)
        while len(found.left) <= most:
            found.grow()
        some = slice(begin, most + 1)
        place = np.clip(steps.g[some, None] + offset, 0.0, reached)
        t, force = self.at(self.time, place), self.at(self.force, place)
        depth = self.leg.at(t)[0] - bodies.compliance * force
        found.columns[:, some] = t, depth, force, self.radius[0] - place * bodies.zone
        for j in range(self.left.shape[1]):
            found.left[some, j] = self.at(self.left[:, j], place)
            found.lags[some, j] = self.at(self.lags[:, j], place)
        found.radius[0] = self.radius[0]
        return found

    def joined(self, later: March, origin: Array) -> March:
        """These rows, and those of another that follow: a few of those given, which lie on the same curve."""
        scenes, offset = np.arange(len(self.last)), (self.radius[0] - origin) / self.leg.bodies.zone
        waited = self.ending == HANDED
        first = np.where(waited, np.maximum(later.given - ROWS // 2, 0), later.last + 1)
        begin = np.where(waited, later.travel(np.minimum(first, later.last)) + offset, np.inf)
        known = np.minimum((self.g < begin).sum(axis=0) - 1, self.last)
        shift = first - known - 1
        last = later.last - shift
        rows = np.arange(int(last.max()) + 1)[:, None]
        own, here, there = rows <= known, np.minimum(rows, known), np.clip(rows + shift, 0, later.last)
        g = np.where(own, self.travel(here), later.travel(there) + offset)
        columns = np.where(own, self.columns[:, here, scenes], later.columns[:, there, scenes])
        breaks = np.where(later.breaks >= first, later.breaks - shift, 0)
        breaks = np.concatenate((np.minimum(self.breaks, known), breaks))
        g, ending = np.where(rows <= last, g, np.inf), later.ending
        return replace(self, g=g, columns=columns, breaks=breaks, last=last, ending=ending, given=last)
