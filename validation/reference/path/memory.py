"""What branches in contact gain by the penetration in a step: ``g_k(t) = E_k int exp(-(t - s)/tau_k) dD(s)``.

It is the same for every radius in contact. Over one step the time is a polynomial of ``u`` in [0, 1]. If the
penetration is linear in time, ``g`` is known in closed form. Otherwise, and where time stands while the load
jumps, it follows by collocation of

    dg/du + (t'(u)/tau_k) g = E_k D'(u),    g(0) = 0,

which is as good for branches much faster than the step as for slow ones. It is linear in ``D``, so that a
penetration known but for its end value, under a force or a spring, costs a second right-hand side.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

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


@dataclass(frozen=True, eq=False)
class ConstantRate(Clock):
    """A step during which the penetration is linear in time; ``moduli``: ``E_k``."""

    moduli: Array
    depth: float
    rate: float

    @cached_property
    def _pace(self) -> Array:
        return -self.rate * self.moduli * self.times

    def during(self, _: Array, elapsed: Array, faded: Array) -> tuple[Array, Array]:
        """Gains (m, n) and ``D`` (m,) on the way; ``faded``: ``exp(-t/tau) - 1``."""
        return self._pace * faded, self.depth + self.rate * elapsed[:, 0]

    @cached_property
    def end(self) -> tuple[Array, float]:
        """Gains and ``D`` at the end."""
        return self._pace * np.expm1(-self.duration / self.times), self.depth + self.rate * self.duration

    def depth_slope(self) -> Array:
        """Coefficients of ``D(u) - D(0)``."""
        return self.rate * self.clock


@dataclass(frozen=True, eq=False)
class Collocated(Clock):
    """A step with a penetration (c,) that is a polynomial of ``u``, as are the gains (c, n) beside a layer.

    ``layer`` (n,): what fades as ``exp(-t/tau)`` from the start; ``end``: gains and penetration at the end.
    """

    gains: Array
    layer: Array
    depths: Array
    end: tuple[Array, float]

    def during(self, u_powers: Array, _: Array, faded: Array) -> tuple[Array, Array]:
        """As of :class:`ConstantRate`."""
        gains = u_powers @ self.gains
        if self.layer.any():
            gains += self.layer * (1.0 + faded)
        return gains, u_powers @ self.depths

    def depth_slope(self) -> Array:
        """As of :class:`ConstantRate`."""
        return np.concatenate(([0.0], self.depths[1:]))


Motion = ConstantRate | Collocated


@dataclass(frozen=True)
class Collocation(Clock):
    """Steps with penetrations ``D(0) + given + v free`` at nodes; gains and layer are affine in ``v``."""

    depth: float
    depths: tuple[Array, Array]
    gains: tuple[Array, Array]
    layers: tuple[Array, Array]

    def motion(self, v: float = 0.0) -> Collocated:
        """The motion of one of them."""
        gains, depths, layer = (given + v * free for given, free in (self.gains, self.depths, self.layers))
        return self._made(gains, self.depth + depths, layer)

    @property
    def free(self) -> Collocated:
        """What ``v`` adds to them."""
        return self._made(self.gains[1], self.depths[1], self.layers[1])

    def _made(self, gains: Array, depths: Array, layer: Array) -> Collocated:
        end = gains[-1] + layer * np.exp(-self.duration / self.times), float(depths[-1])
        return Collocated(self.times, self.clock, _in_powers(gains), layer, _in_powers(depths), end)


def through_nodes(value: Callable[[float], float], start: float, clock: Array) -> Array:
    """Coefficients of a load that is given over the time, along a step."""
    return _in_powers(np.array([value(time) for time in (start + PATH_AT_NODES @ clock).tolist()]))


def _in_powers(values: Array) -> Array:
    """Coefficients through values at the nodes: of their change, as it is their rounding that grows."""
    coefficients = np.asarray(_TO_POWERS @ (values - values[0]))
    coefficients[0] += values[0]
    return coefficients


def collocation(
    times: Array, clock: Array, moduli: Array, depth: float, given: Array, free: Array
) -> Collocation:
    """Gains under two penetrations relative to the first, given at the nodes.

    A branch slower than the step starts from nothing. A faster one has a smooth solution of its own, which it
    falls onto: that is collocated at all nodes, and what it begins with fades.
    """
    count = COLLOCATION + 1
    rates = PATH_AT_NODES @ clock @ _SLOPES.T  # t'(u)
    fast = clock.sum() > FAST * times
    matrix = np.broadcast_to(_SLOPES, (len(times), count, count)).copy()
    at = np.arange(count)
    matrix[:, at, at] += rates / times[:, None]
    matrix[~fast, 0] = at == 0
    right = np.empty((len(times), count, 2))
    right[:, :, 0], right[:, :, 1] = _SLOPES @ given, _SLOPES @ free
    right[~fast, 0] = 0.0
    solved = np.linalg.solve(matrix, right) if len(times) else right
    first, second = (solved * moduli[:, None, None]).transpose(2, 1, 0)
    layers = np.where(fast, -first[0], 0.0), np.where(fast, -second[0], 0.0)
    return Collocation(times, clock, depth, (given, free), (first, second), layers)
