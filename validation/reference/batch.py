"""Many scenes at once: the path of the edge, stepped from radius to radius on a grid that all of them share.

This is the method of :mod:`validation.reference.path`, not a fourth opinion: the same closure of the same
Prony elements in Abel space, and its kernel. What differs is who chooses the steps. There the loop does, for
one scene; here a grid of travels ``g``, in process zones since the edge set off, is the same for all scenes,
fine where the edge sets off and where the fields it set off with leave the zone (``g = 1``), and coarser by a
ratio from there on. At a given travel quadrature points, passing order and interpolation do not depend on the
scene, so a step costs one set-up shared by all, and each scene a root in one scalar: the time at which its
edge gets there.

With ``v`` the share of the zone, ``x = a - d (1 - v)`` behind and ``y = a + d v`` ahead of the edge, and the
openings ``D - G(y)`` less than ``w(y)``,

    I = -(1/pi^2) int_0^1 (w(y) - D + G(y)) (alpha(t) M(v) - Einf0 N(v)) dv

where ``M`` and ``N`` are what the closure makes of the stresses ``1`` and ``G(x)`` behind the edge, and
``alpha = E0 D + sum_k b_k(t)``. What the edge has let go recovers by itself,

    w(y, t) = sum_j (A_j(t_r) - J_j E0 G(y)) exp(-(t - t_r)/theta_j),    A_j = J_j E0 D + sum_k U_kj b_k,

with the time ``t_r(y)`` at which it was passed. ``t_r`` and ``A_j`` are polynomials over the rows, the last
of which is unknown: one more evaluation is as many exponentials as points, and sums. An error is the change
from a grid of half as many travels.
"""

from __future__ import annotations

import math
from collections import defaultdict
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, fields
from functools import cached_property, lru_cache

import numpy as np
from numpy.typing import NDArray

from contact_scene import Material, Ramp, Scene
from validation.reference.path.closure import kernel_slopes
from validation.reference.path.numerics import chebyshev_series, gauss, horner
from validation.reference.path.rheology import Rheology, rheology
from validation.reference.sneddon import PowerTransform, transform

Array = NDArray[np.float64]
Whole = NDArray[np.intp]
Flags = NDArray[np.bool_]

RESOLUTION = 16
"""Default of :func:`solve`."""
CHUNK = 256
"""Scenes of one loop: their arrays stay in the cache."""
SHORTEST = 1.5
"""Process zones in the radius down to which the series of the kernel reaches."""
WIDEST = 1.2
"""Steps of a grid in travels or radii, times the resolution."""
ROWS = 5
"""Rows of a polynomial over the travel."""
LAYERS = (4e-3, 3e-2, 0.2, 0.6)
"""Breaks of the quadrature, from the edge: a layer that recovers behind a slow edge is an exponential."""
POINTS, WEIGHTS = gauss(4)
SERIES, PLACES, NODES = 12, 10, 6
"""Terms of the kernel in zone over radius, in the places in the zone, and of a stress behind the edge."""
CONVERGED, ITERATIONS = 1e-8, 20
"""Relative change of the time at which secants end (its error is the product of the last two), and most."""
LEAST_ERROR = 1e-7
"""Least estimate: no better is the reference known by default."""
COMPARED = 0.4, 0.6, 0.8, 1.0
"""Shares of the travel at pull-off where the forces of two resolutions are compared: no pull-off is held to
be better than the curve in the mean, though it may agree by chance."""
GAIN = 0.1
"""What is at least gained by a doubled resolution."""
NO_TENSION = 1e-12
"""Pull-off force, in the largest force, below which there is none."""
ROUNDED = 1e-15
"""Share of the penetration that is lost in rounding, and so the time in which it is driven."""


# the scenes ---


def refusal(scene: Scene) -> str:
    """Why a scene is none of those that are solved here; empty if it is."""
    adhesion, loading = scene.adhesion, scene.loading
    if not scene.is_adhesive or adhesion is None:
        return "no adhesion"
    if adhesion.stress is not None:
        return "a cohesive stress: its zone has no fixed length"
    if adhesion.rate is not None:
        return "a work of adhesion that depends on the speed"
    if scene.body is not None:
        return "a layer"
    shape = transform(scene.indenter)
    if not isinstance(shape, PowerTransform) or shape.coefficient == 0.0:
        return "an indenter that is no power of the radius"
    if loading.compliance > 0.0:
        return "a spring"
    if loading.start != "relaxed":
        return f"the start {loading.start!r}"
    if len(loading.steps) != 1 or not isinstance(loading.steps[0], Ramp):
        return "other load steps than one ramp"
    if loading.has_triggers:
        return "a level that ends a load step"
    if loading.steps[0].to >= loading.penetration:
        return "a ramp that does not retract"
    return ""


def _numbers(scene: Scene) -> tuple[float, ...]:
    """Shape, zone, work, penetrations at the start and the end, and speed of a scene that is solved here."""
    shape, adhesion, ramp = transform(scene.indenter), scene.adhesion, scene.loading.steps[0]
    assert isinstance(shape, PowerTransform)
    assert isinstance(ramp, Ramp)
    assert adhesion is not None
    parts = shape.coefficient, shape.exponent, adhesion.zone, adhesion.work
    return *parts, scene.loading.penetration, ramp.to, ramp.rate


@dataclass(frozen=True, eq=False)
class Bodies:
    """Scenes side by side, along the last axis: plane moduli, times and shape as in the reference."""

    relaxed: Array
    moduli: Array
    times: Array
    compliances: Array
    retardation: Array
    units_of_branches: Array
    coefficient: Array
    exponent: Array
    zone: Array
    work: Array
    depth: Array
    rate: Array
    duration: Array

    @classmethod
    def of(cls, scenes: Sequence[Scene], rheologies: Sequence[Rheology]) -> Bodies:
        """Of scenes with as many branches each."""
        names = "moduli", "times", "compliances", "retardation", "units_of_branches"
        found = [np.array([getattr(one, name) for one in rheologies]) for name in names]
        moduli, times, compliances, retardation, mixing = (
            np.ascontiguousarray(np.moveaxis(spectrum, 0, -1)) for spectrum in found
        )
        numbers = np.array([_numbers(scene) for scene in scenes]).T
        coefficient, exponent, zone, work, depth, to, speed = np.ascontiguousarray(numbers)
        rate = np.sign(to - depth) * speed
        relaxed = np.array([one.relaxed for one in rheologies])
        spectra = relaxed, moduli, times, compliances, retardation, mixing
        return cls(*spectra, coefficient, exponent, zone, work, depth, rate, (to - depth) / rate)

    @cached_property
    def forgetting(self) -> Array:
        """``-1/theta_j``."""
        return -1.0 / self.retardation

    def of_some(self, chosen: Whole) -> Bodies:
        """Some of them."""
        return Bodies(*(np.ascontiguousarray(getattr(self, part.name)[..., chosen]) for part in fields(self)))

    def shape(self, x: Array) -> Array:
        """``G`` (m, B) at radii."""
        return self.coefficient * (x * x if (self.exponent == 2.0).all() else x**self.exponent)

    def load(self, t: Array) -> tuple[Array, Array]:
        """Penetration (B,) and branch forces (n, B) of what has been in contact from the start."""
        branches = -self.moduli * self.rate * self.times * np.expm1(-t / self.times)
        return self.depth + self.rate * t, branches

    def released(self, depth: Array, branches: Array) -> Array:
        """``A_j`` (n, B)."""
        strain = self.compliances * (self.relaxed * depth)
        return np.asarray(strain + (self.units_of_branches * branches[:, None]).sum(axis=0))

    def force(self, depth: Array, branches: Array, radius: Array) -> Array:
        """``2 int_0^a q dx``."""
        volume = self.coefficient * radius ** (self.exponent + 1.0) / (self.exponent + 1.0)
        return 2.0 * ((self.relaxed * depth + branches.sum(axis=0)) * radius - self.relaxed * volume)


# the closure ---


@lru_cache
def _kernel() -> Array:
    """Coefficients (r, p, q) of ``a^2 dK/dx`` in zone over radius, in place behind and place ahead."""
    knots, places = chebyshev_series(PLACES)
    share, zones = 0.5 * (1.0 + knots), 0.5 * (1.0 + chebyshev_series(SERIES)[0]) / SHORTEST
    x = 1.0 - zones[:, None] * (1.0 - share)
    slopes = kernel_slopes(x[:, None, :], x[:, :, None], zones[:, None, None, None])
    return np.einsum("sr,qj,pi,rji->spq", chebyshev_series(SERIES)[1], places, places, slopes)


def _polynomials(u: Array, order: int) -> Array:
    """Chebyshev's (order, ...), in the dtype and shape of ``u``."""
    table = [np.ones_like(u), u]
    while len(table) < order:
        table.append(2.0 * u * table[-1] - table[-2])
    return np.array(table)


def _inner(v: Array) -> Array:
    """What the kernel makes at shares (m,) of stresses at nodes behind: (m, NODES * SERIES).

    ``int_v^1 f(v') kernel(v', v) dv'``: products of Chebyshev's polynomials are sums of two.
    """
    order = NODES + PLACES
    at, end = _polynomials(2.0 * v - 1.0, order + 1), np.ones(order + 1)
    rest = np.empty((order, len(v)))
    rest[0], rest[1] = end[0] - at[1], 0.25 * (end[0] - at[2])
    for m in range(2, order):
        rest[m] = 0.5 * ((1.0 - at[m + 1]) / (m + 1) - (1.0 - at[m - 1]) / (m - 1))
    one, two = np.arange(NODES)[:, None], np.arange(PLACES)
    products = 0.25 * (rest[one + two] + rest[np.abs(one - two)])
    kernel = np.einsum("spq,qm->spm", _kernel(), at[:PLACES])
    series = np.einsum("lpm,spm->lsm", products, kernel)
    nodes = np.einsum("ln,lsm->mns", chebyshev_series(NODES)[1], series)
    return np.ascontiguousarray(nodes.reshape(len(v), -1))


@dataclass(frozen=True)
class Quadrature:
    """Points of the zone, and what the closure needs at them."""

    v: Array
    weight: Array
    inner: Array

    def forms(self, bodies: Bodies, radius: Array) -> tuple[Array, Array]:
        """``M`` and ``N`` (2, m, B), and ``G(y)`` (m, B)."""
        zone = bodies.zone
        behind, ahead = radius - zone * (1.0 - self.v), radius + zone * self.v
        nodes = radius - zone * (0.5 * (1.0 - chebyshev_series(NODES)[0]))[:, None]
        series = _polynomials(2.0 * SHORTEST * zone / radius - 1.0, SERIES)
        stresses = np.empty((NODES, SERIES, 2, len(radius)))
        stresses[:, :, 0] = series
        np.multiply(bodies.shape(nodes)[:, None], series, out=stresses[:, :, 1])
        forms = (self.inner @ stresses.reshape(NODES * SERIES, -1)).reshape(len(ahead), 2, -1)
        forms *= zone / (radius * radius)
        main = 0.5 * math.pi / np.sqrt(behind * ahead)
        forms[:, 0] += main
        forms[:, 1] += main * bodies.shape(behind)
        forms *= self.weight[:, None]
        return np.ascontiguousarray(forms.swapaxes(0, 1)), bodies.shape(ahead)


@lru_cache(maxsize=1024)
def quadrature(corners: tuple[float, ...]) -> Quadrature:
    """By Gauss between breaks, some of which are corners."""
    breaks = np.unique(np.concatenate(([0.0, 1.0], LAYERS, corners)))
    width = np.diff(breaks)[:, None]
    v = (breaks[:-1, None] + width * POINTS).ravel()
    return Quadrature(v[:, None], (width * WEIGHTS).ravel()[:, None], _inner(v))


# the grid ---


@dataclass(frozen=True)
class Travel:
    """A step of the grid: points, and how they and the first guess follow from the rows before."""

    points: Quadrature
    released: int
    first: int
    old: Array
    new: Array
    guess: Array


@dataclass
class Grid:
    """Travels ``g``, and the rows ``breaks`` at which the path has corners."""

    g: Array
    breaks: Whole
    steps: dict[int, Travel] = field(default_factory=dict)

    def panels(self, panel: Whole, newest: Whole | int) -> tuple[Whole, Whole]:
        """First row and number of rows of the polynomials in panels, of rows up to ``newest``."""
        after = self.breaks.searchsorted(panel, side="right")
        low = self.breaks[after - 1]
        high = np.minimum(np.append(self.breaks, len(self.g))[after], newest)
        count = np.minimum(ROWS, high - low + 1)
        return np.minimum(np.maximum(panel - (count - 2) // 2, low), high - count + 1), count

    def step(self, k: int) -> Travel:
        """Made when it is first asked for."""
        if k not in self.steps:
            self.steps[k] = self._made(k)
        return self.steps[k]

    def _made(self, k: int) -> Travel:
        now = self.g[k]
        corners = now - self.g[self.breaks]
        corners = corners[(corners > 0.0) & (corners < 1.0)]
        points = quadrature(tuple(corners.tolist()))
        passed = now - points.v[:, 0]
        passed = passed[passed > 0.0]
        panel = np.minimum(self.g.searchsorted(passed) - 1, k - 1)
        first, count = self.panels(panel, k)
        begin = int(first.min())
        weights = np.zeros((len(passed), k + 1 - begin))
        for i in np.unique(count):
            those = np.flatnonzero(count == i)
            rows = first[those, None] + np.arange(i)
            weights[those[:, None], rows - begin] = lagrange(self.g[rows], passed[those])
        low = max(int(self.breaks[self.breaks.searchsorted(k - 1) - 1]), k - ROWS) if k > 1 else 0
        guess = lagrange(self.g[None, low:k], np.array([now]))[0]
        old, new = np.ascontiguousarray(weights[:, :-1]), weights[:, -1:]
        return Travel(points, len(passed), begin, old, new, guess)


def lagrange(nodes: Array, at: Array) -> Array:
    """Weights (m, n) of values at nodes (m, n) for places (m,)."""
    weights = np.ones(nodes.shape)
    for i in range(nodes.shape[1]):
        for j in range(nodes.shape[1]):
            if i != j:
                weights[:, i] *= (at - nodes[:, j]) / (nodes[:, i] - nodes[:, j])
    return weights


@lru_cache(maxsize=128)
def grid(resolution: int, size: int) -> Grid:
    """For radii from ``2^(size/2)`` zones to 1.4 times that.

    A corner is followed by a quarter of a ``resolution``-th of a zone, and steps that grow by a ratio to such
    a part of the travel, or of what is left of the radius.
    """
    least, ratio, radius = 0.25 / resolution, 1.0 + 1.6 / resolution, 2.0 ** (0.5 * size)
    g, breaks = [np.zeros(1)], [0]
    for begin in (0.0, 1.0):
        steps = np.minimum(least * ratio ** np.arange(8 * resolution), 0.25)
        ends = steps.cumsum()
        last = int(ends.searchsorted(1.0)) + 1
        g.append(begin + ends[:last] / ends[last - 1])
        breaks.append(breaks[-1] + last)
    travel, step, rest = 2.0, 2.0 * least, []
    while travel < math.sqrt(2.0) * radius:
        travel += step
        rest.append(travel)
        step = min(step * ratio, WIDEST / resolution * min(travel, max(radius - travel, 0.25 * radius)))
    return Grid(np.concatenate((*g, rest)), np.array(breaks))


# the march ---

GOING, DETACHED, ENDED, SHORT, FAILED = range(5)
REASONS = {
    SHORT: "the contact shrinks to one and a half process zones before it is lost",
    FAILED: "the time at which the edge gets somewhere is not found",
}


@dataclass(frozen=True)
class March:
    """Rows (S, B) of time, penetration, force and radius, ``last`` of each scene, and how it ended."""

    grid: Grid
    time: Array
    depth: Array
    force: Array
    radius: Array
    last: Whole
    ending: Whole

    @property
    def rows(self) -> tuple[Array, Array, Array, Array]:
        """In the order of the columns of an answer."""
        return self.time, self.depth, self.force, self.radius

    def polynomials(self, values: Array, panel: Whole) -> Array:
        """Coefficients (ROWS, B) of rows in a panel of each scene, in shares of the panel."""
        first, count = self.grid.panels(panel, self.last)
        scenes, rows = np.arange(len(panel)), first[:, None] + np.arange(ROWS)
        within = np.arange(ROWS) < count[:, None]
        rows = np.where(within, rows, first[:, None])
        begin, end = self.grid.g[panel], self.grid.g[panel + 1]
        u = (self.grid.g[rows] - begin[:, None]) / (end - begin)[:, None]
        matrix = u[:, :, None] ** np.arange(ROWS) * within[:, None, :]
        matrix[~within] = np.eye(ROWS)[(~within).nonzero()[1]]
        right = np.where(within, values[rows, scenes[:, None]], 0.0)
        return np.linalg.solve(matrix, right[:, :, None])[:, :, 0].T

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
            near = horner(curve, u).argmax(axis=0)
            middle = np.clip(near, 1, len(u) - 2) / (len(u) - 1.0)
            for _ in range(3):
                slope, bend = (horner(each, middle) for each in _derivatives(curve))
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


def _derivatives(curve: Array) -> tuple[Array, Array]:
    """Coefficients of the first and the second."""
    orders = np.arange(1.0, len(curve))[:, None]
    slope = curve[1:] * orders
    return slope, slope[1:] * orders[:-1]


def start_radius(bodies: Bodies) -> Array:
    """Of the relaxed contact: secants from a sharp edge, beyond the outermost root of which ``I`` rises."""
    E, D, n, w = bodies.relaxed, bodies.depth, bodies.exponent, bodies.work
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
    return _secants(released, radius, slope, 0.0 * radius, radius > 0.0)[0]


class Opening:
    """``I/w - 1`` at the radii of a step, of any time at which the edge gets there."""

    def __init__(self, bodies: Bodies, step: Travel, radius: Array, times: Array, left: Array) -> None:
        forms, ahead = step.points.forms(bodies, radius)
        self.bodies, self.new, self.since = bodies, step.new[:, None], 1.0 - step.new
        self.still = forms.sum(axis=1), (forms * ahead).sum(axis=1)
        self.forms = forms[:, : step.released]
        self.passed = step.old @ times
        kept = (step.old @ left.reshape(len(left), left[0].size)).reshape(step.released, *left.shape[1:])
        self.left = kept - bodies.compliances * bodies.relaxed * ahead[: step.released, None]

    def __call__(self, t: Array) -> Array:
        bodies = self.bodies
        D, b = bodies.load(t)
        alpha = bodies.relaxed * D + b.sum(axis=0)
        elapsed = np.maximum(self.since * t - self.passed, 0.0)
        units = self.left + self.new * bodies.released(D, b)
        units *= np.exp(elapsed[:, None] * bodies.forgetting)
        opened, shaped = (units.sum(axis=1) * self.forms).sum(axis=1) + self.still[1] - D * self.still[0]
        return np.asarray((bodies.relaxed * shaped - alpha * opened) / (math.pi**2 * bodies.work) - 1.0)


def _secants(
    residual: Callable[[Array], Array], one: Array, slope: Array, scale: Array, asked: Flags
) -> tuple[Array, Array, Flags]:
    """Roots, slopes and whether they are found, of those asked for; each scene stops by itself."""
    f, done = residual(one), ~asked
    two = one - f / slope
    for _ in range(ITERATIONS):
        value = residual(two)
        moving = ~done & (two != one) & (value != f)
        slope = np.where(moving, (value - f) / (two - one), slope)
        change = np.where(moving, value / slope, 0.0)
        one, f, two = np.where(done, one, two), np.where(done, f, value), two - change
        done = done | ~(np.abs(change) > CONVERGED * (np.abs(two) + scale))
        if done.all():
            break
    return two, slope, done & np.isfinite(two)


def march(bodies: Bodies, start: Array, resolution: int, size: int) -> March:
    """Retract from a radius until contact is lost, or the ramp ends."""
    steps, count = grid(resolution, size), len(bodies.zone)
    size = 128
    rows = np.zeros((4, size, count))
    time, depth, force, radius = rows
    left = np.zeros((size, len(bodies.moduli), count))
    last, ending = np.zeros(count, np.intp), np.full(count, GOING)
    D, b = bodies.load(time[0])
    depth[0], radius[0], force[0], left[0] = D, start, bodies.force(D, b, start), bodies.released(D, b)
    ending[~np.isfinite(start)] = FAILED
    slope = np.zeros(count)
    lost = ROUNDED / CONVERGED * (np.abs(bodies.depth) + bodies.shape(start[None])[0]) / np.abs(bodies.rate)
    for k in range(1, len(steps.g)):
        a = start - steps.g[k] * bodies.zone
        ending[(ending == GOING) & (a < SHORTEST * bodies.zone)] = SHORT
        going = ending == GOING
        if not going.any():
            break
        if k == len(time):
            rows, left = (
                np.concatenate((one, np.zeros_like(one)), axis=axis) for one, axis in ((rows, 1), (left, 0))
            )
            time, depth, force, radius = rows
        a = np.where(going, a, start)
        step = steps.step(k)
        residual = Opening(bodies, step, a, time[step.first : k], left[step.first : k])
        before = time[k - 1]
        if k == 1:
            guess = 1e-2 * steps.g[1] * np.sqrt(bodies.zone / start) * bodies.zone / np.abs(bodies.rate)
            slope = (residual(1.001 * guess) - residual(guess)) / (1e-3 * guess)
        else:
            guess = step.guess @ time[k - len(step.guess) : k]
        t, slope, found = _secants(residual, guess, slope, lost, going)
        ending[going & ~found] = FAILED
        going &= found
        t = np.where(going, t, before)
        D, b = bodies.load(t)
        time[k], depth[k], radius[k], force[k], left[k] = (
            t,
            D,
            a,
            bodies.force(D, b, a),
            bodies.released(D, b),
        )
        last[going] = k
        ending[going & (t <= before)] = DETACHED
        ending[going & (t >= bodies.duration)] = ENDED
        slope = np.where(going & (slope != 0.0), slope, 1.0)
    else:
        ending[ending == GOING] = SHORT
    return March(steps, time, depth, force, radius, last, ending)


# what comes of it ---


def _none() -> Array:
    return np.zeros(0)


@dataclass(frozen=True)
class Answer:
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


def events(found: March, bodies: Bodies) -> Events:
    """Largest time, or the end of the ramp, and the least force up to there."""
    place, time = found.largest(found.time)
    ended = found.ending == ENDED
    end = np.where(ended, found.reached(found.time, bodies.duration), place)
    time = np.where(ended, bodies.duration, time)
    force, radius = found.at(found.force, end), found.radius[0] - end * bodies.zone
    place, tension = found.largest(-found.force)
    later = (place > end) | (tension <= -force)
    tension = np.where(later, -force, tension)
    pulled = np.where(later, time, found.at(found.time, place))
    place = np.where(later, end, place)
    return Events(
        place, np.maximum(tension, 0.0), pulled, time, bodies.depth + bodies.rate * time, force, radius
    )


@np.errstate(over="ignore", under="ignore", invalid="ignore", divide="ignore")
def solve(scenes: Sequence[Scene], resolution: int = RESOLUTION) -> list[Answer]:
    """Solve scenes together; one that is refused, or fails, costs no other.

    Parameters
    ----------
    scenes : sequence of Scene
        In any order, with any numbers of branches.
    resolution : int
        Steps of the edge in a process zone, and in five sixths of what it has gone, from 8.

    Returns
    -------
    list of Answer
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
    answers = [Answer(reason) for reason in reasons]
    known: dict[Material, Rheology] = {}
    alike: dict[int, list[int]] = defaultdict(list)
    for i, scene in enumerate(scenes):
        if reasons[i]:
            continue
        if scene.material not in known:
            known[scene.material] = rheology(scene.material)
        alike[len(known[scene.material].times)].append(i)
    for numbers in alike.values():
        bodies = Bodies.of([scenes[i] for i in numbers], [known[scenes[i].material] for i in numbers])
        radius = start_radius(bodies)
        sizes = np.floor(2.0 * np.log2(radius / bodies.zone))
        for size in np.unique(sizes):
            those = np.flatnonzero(sizes == size)
            for chosen in np.array_split(those, math.ceil(len(those) / CHUNK)):
                found = _answers(bodies.of_some(chosen), radius[chosen], resolution, int(size))
                for i, answer in zip(chosen.tolist(), found, strict=True):
                    answers[numbers[i]] = answer
    return answers


def _answers(bodies: Bodies, radius: Array, resolution: int, size: int) -> list[Answer]:
    """Answers of scenes of one loop, with the change from half the resolution as their errors."""
    fine, coarse = (march(bodies, radius, n, size) for n in (resolution, resolution // 2))
    one, two = events(fine, bodies), events(coarse, bodies)
    depths = np.maximum(np.abs(bodies.depth), np.abs(one.depth))
    tension = np.maximum(one.pull_off_force, NO_TENSION * np.abs(fine.force).max(axis=0))
    places = [share * one.travel for share in COMPARED]
    apart = [fine.at(fine.force, place) - coarse.at(coarse.force, place) for place in places]
    apart = GAIN * np.sqrt(np.mean(np.square(apart), axis=0))
    errors = {
        "pull_off_force": np.maximum(np.abs(one.pull_off_force - two.pull_off_force), apart) / tension,
        "pull_off_time": np.abs(one.pull_off_time - two.pull_off_time) / one.time,
        "detachment_time": np.abs(one.time - two.time) / one.time,
        "detachment_penetration": np.abs(one.depth - two.depth) / depths,
    }
    return [_answer(j, fine, one, errors, int(coarse.ending[j])) for j in range(len(radius))]


def _answer(j: int, found: March, events: Events, errors: dict[str, Array], other: int) -> Answer:
    """Of one scene; ``other``: how it ends at the other resolution."""
    ending, detached = int(found.ending[j]), found.ending[j] == DETACHED
    if ending in REASONS or other != ending:
        return Answer(REASONS.get(ending) or REASONS.get(other, "two resolutions end differently"))
    end = np.array([part[j] for part in (events.time, events.depth, events.force, events.radius)])
    rows = np.array([part[: found.last[j] + 1, j] for part in found.rows])
    columns = np.column_stack((rows[:, (rows[0] < end[0]) & (rows[3] > end[3])], end))
    if detached:
        columns = np.column_stack((columns, (end[0], end[1], 0.0, 0.0)))
    told = [name for name in errors if detached or not name.startswith("detachment")]
    time, depth, force, radius = columns
    return Answer(
        "",
        time,
        depth,
        force,
        radius,
        pull_off_force=float(events.pull_off_force[j]),
        pull_off_time=float(events.pull_off_time[j]),
        detached=bool(detached),
        errors={name: max(float(errors[name][j]), LEAST_ERROR) for name in told},
    )
