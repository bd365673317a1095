"""What branches in contact gain by the penetration in a step: ``g_k(t) = E_k int exp(-(t - s)/tau_k) dD(s)``.

It is the same for every radius in contact; so are, on a layer, those by each of the coefficients ``C`` of its
image: all of them are the penetrations (K + 1,). Over one step the time is a polynomial of ``u`` in [0, 1].
If the penetration of a half-space is linear in time, ``g`` is known in closed form. Otherwise, and where time
stands while the load jumps, it follows by collocation of

    dg/du + (t'(u)/tau_k) g = E_k D'(u),    g(0) = 0,

which is as good for branches much faster than the step as for slow ones. It is linear in ``D``, so that a
penetration known but for its end value, under a force or a spring, costs a second right-hand side; for more
of them it is the same one.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from validation.reference.path.numerics import DEGREE, powers

Array = NDArray[np.float64]

COLLOCATION = 8
"""Points besides the first. Twice the degree of the path: a branch ten times as fast as the step is then
followed to 1e-8 of what it gains."""
FAST = 30.0
"""Length of a step in relaxation times from which on a branch follows its smooth solution, beside a layer: by
collocation from its start it would be off by 1e-3. At less, collapses that a spring feeds are not passed."""
NODES = 0.5 * (1.0 - np.cos(np.pi * np.arange(COLLOCATION + 1) / COLLOCATION))
_NODE_POWERS = powers(NODES, COLLOCATION)
PATH_AT_NODES = _NODE_POWERS[:, : DEGREE + 1]
_TO_POWERS = np.linalg.inv(_NODE_POWERS)
_SLOPES = (
    np.hstack(
        (
            np.zeros((COLLOCATION + 1, 1)),
            powers(NODES, COLLOCATION - 1) * np.arange(1, COLLOCATION + 1),
        )
    )
    @ _TO_POWERS
)


@dataclass(frozen=True, eq=False)
class Clock:
    """The time of a step, whose coefficients are ``clock``."""

    times: Array
    clock: Array

    @cached_property
    def duration(self) -> float:
        """Length of the step."""
        return float(self.clock.sum())

    def elapsed(self, u_powers: Array) -> Array:
        """Times (m, 1) since the step began; not outside of it, where rounding would grow without bound."""
        elapsed = u_powers[:, : DEGREE + 1] @ self.clock
        return np.minimum(np.maximum(elapsed, 0.0), self.duration)[:, None]


class OnCourse(Protocol):
    """Points (m,) on the way."""

    @property
    def course(self) -> Array:
        """Powers of ``u`` times functions (m, c (K + 1))."""
        ...


@dataclass(frozen=True, eq=False)
class ConstantRate(Clock):
    """A step during which the penetration of a half-space is linear in time; ``moduli``: ``E_k``."""

    moduli: Array
    depth: float
    rate: float

    @cached_property
    def _pace(self) -> Array:
        return -self.rate * self.moduli * self.times

    def during(self, _: OnCourse, elapsed: Array, faded: Array) -> tuple[Array, Array]:
        """Gains (m, n) and ``D`` (m,) on the way; ``faded``: ``exp(-t/tau) - 1``."""
        return self._pace * faded, self.depth + self.rate * elapsed[:, 0]

    @cached_property
    def end(self) -> tuple[Array, Array]:
        """Gains (1, n) and penetration (1,) at the end."""
        gained = self._pace * np.expm1(-self.duration / self.times)
        return gained[None], np.array([self.depth + self.rate * self.duration])

    def depth_slopes(self) -> Array:
        """Coefficients (c, 1) of what the penetration changes by."""
        return self.rate * self.clock[:, None]


@dataclass(frozen=True, eq=False)
class Collocated(Clock):
    """A step with penetrations (c, K + 1) that are polynomials of ``u``, as are the gains (c, K + 1, n).

    ``layers`` (K + 1, n): what fades as ``exp(-t/tau)`` from the start, beside these. ``end``: gains and
    penetrations at the end.
    """

    gains: Array
    layers: Array
    depths: Array
    end: tuple[Array, Array]

    def during(self, points: OnCourse, _: Array, faded: Array) -> tuple[Array, Array]:
        """As of :class:`ConstantRate`."""
        course = points.course
        gains = course @ self.gains.reshape(course.shape[1], -1)
        if self.layers.any():
            gains += course[:, : len(self.layers)] @ self.layers * (1.0 + faded)
        return gains, course @ self.depths.ravel()

    def depth_slopes(self) -> Array:
        """As of :class:`ConstantRate`."""
        slopes = self.depths.copy()
        slopes[0] = 0.0
        return slopes


Motion = ConstantRate | Collocated


@dataclass(frozen=True)
class Collocation:
    """Steps with the penetrations ``given``, and to each of them a multiple of the one of ``free``."""

    given: Collocated
    free: Collocated

    def motion(self, v: Array) -> Collocated:
        """The motion with the multiples ``v`` (K + 1,)."""
        given, free, each = self.given, self.free, v[:, None]
        end = given.end[0] + free.end[0] * each, given.end[1] + free.end[1] * v
        gains, layers = given.gains + free.gains * each, given.layers + free.layers * each
        return Collocated(given.times, given.clock, gains, layers, given.depths + free.depths * v, end)


def through_nodes(value: Callable[[float], float], start: float, clock: Array) -> Array:
    """Coefficients of a load that is given over the time, along a step."""
    return _in_powers(np.array([[value(time)] for time in (start + PATH_AT_NODES @ clock).tolist()]))[:, 0]


def _in_powers(values: Array) -> Array:
    """Coefficients (..., 9, m) through values at the nodes: of their change, as its rounding grows."""
    first = values[..., :1, :]
    coefficients = np.asarray(_TO_POWERS @ (values - first))
    coefficients[..., :1, :] += first
    return coefficients


def collocation(
    times: Array, clock: Array, moduli: Array, depths: Array, given: Array, free: Array
) -> Collocation:
    """Gains under penetrations ``given`` (9, K + 1) and ``free`` (9,) at the nodes, relative to the first.

    A branch slower than the step starts from nothing. A faster one has a smooth solution of its own, which it
    falls onto: that is collocated at all nodes, and what it begins with fades.
    """
    count = COLLOCATION + 1
    rates = PATH_AT_NODES @ clock @ _SLOPES.T  # t'(u)
    duration = clock.sum()
    fast = duration > FAST * times
    matrix = np.empty((len(times), count, count))
    matrix[:] = _SLOPES
    matrix.reshape(-1, count * count)[:, :: count + 1] += rates / times[:, None]
    matrix[~fast, 0] = np.eye(1, count)
    values = np.column_stack((given, free))
    right = np.empty((len(times), *values.shape))
    right[:] = _SLOPES @ values
    right[~fast, 0] = 0.0
    gains = (np.linalg.solve(matrix, right) if len(times) else right) * moduli[:, None, None]
    layers = np.where(fast[:, None], -gains[:, 0], 0.0).T
    ends = gains[:, -1].T + layers * np.exp(-duration / times), values[-1]
    paths = _in_powers(gains).transpose(1, 2, 0), _in_powers(values)
    known, rest = (
        Collocated(
            times, clock, paths[0][:, part], layers[part], paths[1][:, part], (ends[0][part], ends[1][part])
        )
        for part in (slice(None, -1), slice(-1, None))
    )
    known.depths[0] += depths
    return Collocation(replace(known, end=(known.end[0], depths + known.end[1])), rest)
