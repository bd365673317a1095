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
from dataclasses import dataclass
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
_PACE, _EYE = _SLOPES @ PATH_AT_NODES, np.eye(COLLOCATION + 1)


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
    """A step on which gains and penetrations, ``paths`` (c, K + 1, n + 1), are polynomials of ``u``.

    ``layers`` (K + 1, n): what fades as ``exp(-t/tau)`` from the start, beside the gains. ``ends``
    (K + 1, n + 1): all of it at the end.
    """

    paths: Array
    layers: Array
    ends: Array

    def during(self, points: OnCourse, _: Array, faded: Array) -> tuple[Array, Array]:
        """As of :class:`ConstantRate`."""
        course = points.course
        found = course @ self.paths.reshape(course.shape[1], -1)
        if self.layers.any():
            found[:, :-1] += course[:, : len(self.layers)] @ self.layers * (1.0 + faded)
        return found[:, :-1], found[:, -1]

    @property
    def end(self) -> tuple[Array, Array]:
        """Gains (K + 1, n) and penetrations (K + 1,) at the end."""
        return self.ends[:, :-1], self.ends[:, -1]

    def depth_slopes(self) -> Array:
        """As of :class:`ConstantRate`."""
        slopes = self.paths[:, :, -1].copy()
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
        parts = (
            given.paths + free.paths * each,
            given.layers + free.layers * each,
            given.ends + free.ends * each,
        )
        return Collocated(given.times, given.clock, *parts)


def through_nodes(value: Callable[[float], float], start: float, clock: Array) -> Array:
    """Coefficients of a load that is given over the time, along a step."""
    return _in_powers(np.array([[value(time)] for time in (start + PATH_AT_NODES @ clock).tolist()]))[:, 0]


def _in_powers(values: Array) -> Array:
    """Coefficients (..., 9, m) through values at the nodes: of their change, as its rounding grows."""
    first = values[..., :1, :]
    coefficients = np.asarray(_TO_POWERS @ (values - first))
    coefficients[..., :1, :] += first
    return coefficients


def collocation(times: Array, clock: Array, moduli: Array, depths: Array, values: Array) -> Collocation:
    """Gains under penetrations ``values`` (9, K + 2) at the nodes, relative to the first: the last is free.

    A branch slower than the step starts from nothing. A faster one has a smooth solution of its own, which it
    falls onto: that is collocated at all nodes, and what it begins with fades.
    """
    duration, count = clock.sum(), len(times)
    slow = duration <= FAST * times
    matrix = _SLOPES + (_PACE @ clock / times[:, None])[:, :, None] * _EYE  # with t'(u) on the diagonal
    matrix[slow, 0] = _EYE[0]
    whole = np.empty((count + 1, *values.shape))
    whole[:] = _SLOPES @ values
    whole[:-1][slow, 0] = 0.0
    if count:
        whole[:-1] = np.linalg.solve(matrix, whole[:-1]) * moduli[:, None, None]
    whole[-1] = values
    layers = np.where(slow[:, None], 0.0, -whole[:-1, 0]).T
    paths, ends = _in_powers(whole).transpose(1, 2, 0), whole[:, -1].T.copy()
    ends[:, :-1] += layers * np.exp(-duration / times)
    paths[0, :-1, -1] += depths
    ends[:-1, -1] += depths
    given = Collocated(times, clock, paths[:, :-1], layers[:-1], ends[:-1])
    return Collocation(given, Collocated(times, clock, paths[:, -1:], layers[-1:], ends[-1:]))
