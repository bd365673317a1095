"""What branches in contact gain by the penetration in a step: ``g_k(t) = E_k int exp(-(t - s)/tau_k) dD(s)``.

It is the same for every radius in contact; so are, on a layer, those by each of the coefficients ``C`` of its
image: all of them are the penetrations (K + 1,). Over one step the time is a polynomial of ``u`` in [0, 1].
If the penetration of a half-space is linear in time, ``g`` is known in closed form. Otherwise, and where time
stands while the load jumps, it follows by collocation of

    dg/du + (t'(u)/tau_k) g = E_k D'(u),    g(0) = 0,

which is as good for branches much faster than the step as for slow ones. It is linear in ``D``, and solved
for each power of ``u``: a point of a layer, which has a penetration ``phi . (D, C)`` of its own, is one of a
half-space then, and of a penetration known but for its end value, under a force or a spring, both parts gain
alike.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from validation.reference.path.numerics import DEGREE, powers, total

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
_RATES = np.roll(_NODE_POWERS, 1, axis=1) * np.arange(COLLOCATION + 1)
_FROM_NOTHING = np.vstack((0.0 * _RATES[:1], _RATES[1:]))


@dataclass(frozen=True, eq=False)
class Clock:
    """The time of a step, whose coefficients are ``clock``."""

    times: Array
    clock: Array

    @cached_property
    def duration(self) -> float:
        """Length of the step."""
        return float(self.clock.sum())

    @cached_property
    def fading(self) -> Array:
        """What is left of branch forces (n,) at the end."""
        return np.asarray(np.exp(-self.duration / self.times))

    def elapsed(self, u_powers: Array) -> Array:
        """Times (m, 1) since the step began; not outside of it, where rounding would grow without bound."""
        elapsed = u_powers[:, : DEGREE + 1] @ self.clock
        return np.minimum(np.maximum(elapsed, 0.0), self.duration)[:, None]


class OnTheWay(Protocol):
    """Points (m,) on the way, by powers of ``u`` (m, 9) and functions (m, K + 1)."""

    @property
    def u_powers(self) -> Array: ...

    @property
    def phi(self) -> Array: ...


@dataclass(frozen=True, eq=False)
class ConstantRate(Clock):
    """A step during which the penetration of a half-space is linear in time; ``moduli``: ``E_k``."""

    moduli: Array
    depth: float
    rate: float

    @cached_property
    def _pace(self) -> Array:
        return -self.rate * self.moduli * self.times

    def during(self, _: OnTheWay, elapsed: Array, faded: Array) -> tuple[Array, Array]:
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
    """A step of penetrations ``depths`` (c + 1, K + 1) in powers of ``u``.

    ``gains`` (9 c, n): by each of these powers but the first, as polynomials of ``u``. ``layers`` (c, n):
    what fades as ``exp(-t/tau)`` from the start, beside them, if any does. ``ends`` (c, n): all of it at the
    end.
    """

    gains: Array
    layers: Array | None
    ends: Array
    depths: Array

    def under(self, depths: Array) -> Collocated:
        """The step in the same time under others."""
        return Collocated(self.times, self.clock, self.gains, self.layers, self.ends, depths)

    def during(self, points: OnTheWay, _: Array, faded: Array) -> tuple[Array, Array]:
        """As of :class:`ConstantRate`."""
        u_powers, each = points.u_powers, points.phi @ self.depths.T
        depth = total(u_powers[:, : each.shape[1]] * each)
        each = each[:, 1:]
        course = (u_powers[:, :, None] * each[:, None, :]).reshape(len(each), len(self.gains))
        gained = course @ self.gains
        if self.layers is not None:
            gained += each @ self.layers * (1.0 + faded)
        return gained, depth

    @cached_property
    def end(self) -> tuple[Array, Array]:
        """Gains (K + 1, n) and penetrations (K + 1,) at the end."""
        return self.depths[1:].T @ self.ends, self.depths.sum(axis=0)

    @cached_property
    def gained(self) -> float:
        """Gain of all branches together at the end, by the first penetration."""
        return float(self.depths[1:, 0] @ total(self.ends))

    def depth_slopes(self) -> Array:
        """As of :class:`ConstantRate`."""
        return np.vstack((0.0 * self.depths[:1], self.depths[1:]))


Motion = ConstantRate | Collocated


def through_nodes(value: Callable[[float], float], start: float, clock: Array) -> Array:
    """Coefficients of a load that is given over the time, along a step."""
    return _in_powers(np.array([[value(time)] for time in (start + PATH_AT_NODES @ clock).tolist()]))[:, 0]


def _in_powers(values: Array) -> Array:
    """Coefficients (..., 9, m) through values at the nodes: of their change, as its rounding grows."""
    first = values[..., :1, :]
    coefficients = np.asarray(_TO_POWERS @ (values - first))
    coefficients[..., :1, :] += first
    return coefficients


def collocated(times: Array, clock: Array, moduli: Array, depths: Array) -> Collocated:
    """The step of those penetrations.

    A branch slower than the step starts from nothing. A faster one has a smooth solution of its own, which it
    falls onto: that is collocated at all nodes, and what it begins with fades.
    """
    duration, count = clock.sum(), len(depths) - 1
    slow = duration <= FAST * times
    all_slow = bool(slow.all())
    pace = _RATES[:, : len(clock)] @ clock
    matrix = _RATES + (pace / times[:, None])[:, :, None] * _NODE_POWERS
    matrix[slow, 0] = _NODE_POWERS[0]
    rates = _FROM_NOTHING if all_slow else np.where(slow[:, None, None], _FROM_NOTHING, _RATES)
    gains = (np.linalg.solve(matrix, rates[..., 1 : count + 1]) * moduli[:, None, None]).transpose(1, 2, 0)
    ends, layers = gains.sum(axis=0), None
    if not all_slow:
        layers = np.where(slow, 0.0, -gains[0])
        ends += layers * np.exp(-duration / times)
    gains = gains.reshape((COLLOCATION + 1) * count, len(times))
    return Collocated(times, clock, gains, layers, ends, depths)
