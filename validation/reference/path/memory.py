"""What branches in contact remember of the penetration: ``M_k(t) = int exp(-(t - s)/tau_k) dD(s)``.

It is the same for every radius in contact. Over one step the time is a polynomial of ``u`` in [0, 1]. If the
penetration is linear in time, ``M`` is known in closed form. Otherwise, and where time stands while the load
jumps, it follows by collocation of

    dM/du + (t'(u)/tau_k) M = D'(u)

which is as good for branches much faster than the step as for slow ones. It is linear in ``D``, so that a
penetration known but for its end value, under a force or a spring, costs a second right-hand side.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from validation.reference.path.polynomials import DEGREE, powers

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


def times_since(clock: Array, u_powers: Array) -> Array:
    """Times (m, 1) since a step began; not outside of it, where rounding would grow without bound."""
    return np.minimum(np.maximum(u_powers[:, : DEGREE + 1] @ clock, 0.0), clock.sum())[:, None]


@dataclass(frozen=True, eq=False)
class Ramp:
    """A step during which the penetration is linear in time."""

    times: Array
    clock: Array
    memory: Array
    depth: float
    rate: float

    def during(self, u_powers: Array) -> tuple[Array, Array, Array]:
        """Time since the step began (m, 1), ``M`` (m, n) and ``D`` (m,) on the way, at powers of ``u``."""
        elapsed = times_since(self.clock, u_powers)
        faded = np.expm1(-elapsed / self.times)
        memories = self.memory * (1.0 + faded) - self.rate * self.times * faded
        return elapsed, memories, self.depth + self.rate * elapsed[:, 0]

    @cached_property
    def end(self) -> tuple[Array, float]:
        """``M`` and ``D`` at the end."""
        elapsed = float(self.clock.sum())
        faded = np.expm1(-elapsed / self.times)
        return self.memory * (1.0 + faded) - self.rate * self.times * faded, self.depth + self.rate * elapsed

    def depth_slope(self) -> Array:
        """Coefficients of ``D(u) - D(0)``."""
        return self.rate * self.clock


@dataclass(frozen=True, eq=False)
class Collocated:
    """A step with a penetration (c,) that is a polynomial of ``u``, as is the memory (c, n) beside a layer.

    ``layer`` (n,): what fades as ``exp(-t/tau)`` from the start; ``end``: memory and penetration at the end.
    """

    times: Array
    clock: Array
    memories: Array
    layer: Array
    depths: Array
    end: tuple[Array, float]

    def during(self, u_powers: Array) -> tuple[Array, Array, Array]:
        """As of :class:`Ramp`."""
        elapsed = times_since(self.clock, u_powers)
        memories = u_powers @ self.memories
        if self.layer.any():
            memories += self.layer * np.exp(-elapsed / self.times)
        return elapsed, memories, u_powers @ self.depths

    def depth_slope(self) -> Array:
        """As of :class:`Ramp`."""
        return np.concatenate(([0.0], self.depths[1:]))


Motion = Ramp | Collocated


@dataclass(frozen=True)
class Collocation:
    """Steps with penetrations ``D(0) + given + v free`` at nodes; memory and layer are affine in ``v``."""

    times: Array
    clock: Array
    depth: float
    depths: tuple[Array, Array]
    memories: tuple[Array, Array]
    layers: tuple[Array, Array]

    def motion(self, v: float = 0.0) -> Collocated:
        """The motion of one of them."""
        memories, depths, layer = (
            given + v * free for given, free in (self.memories, self.depths, self.layers)
        )
        faded = layer * np.exp(-self.clock.sum() / self.times)
        depths = self.depth + depths
        last = memories[-1] + faded, float(depths[-1])
        return Collocated(self.times, self.clock, _in_powers(memories), layer, _in_powers(depths), last)


def through_nodes(value: Callable[[float], float], start: float, clock: Array) -> Array:
    """Coefficients of a load that is given over the time, along a step."""
    return _in_powers(np.array([value(time) for time in (start + PATH_AT_NODES @ clock).tolist()]))


def _in_powers(values: Array) -> Array:
    """Coefficients through values at the nodes: of their change, as it is their rounding that grows."""
    coefficients = np.asarray(_TO_POWERS @ (values - values[0]))
    coefficients[0] += values[0]
    return coefficients


def collocation(
    times: Array, clock: Array, memory: Array, depth: float, given: Array, free: Array
) -> Collocation:
    """Memories under two penetrations relative to the first, given at the nodes.

    A branch slower than the step starts from its memory. A faster one has a smooth solution of its own, which
    it falls onto: that is collocated at all nodes, and what the memory differs from it by fades.
    """
    count = COLLOCATION + 1
    rates = PATH_AT_NODES @ clock @ _SLOPES.T  # t'(u)
    fast = clock.sum() > FAST * times
    matrix = np.broadcast_to(_SLOPES, (len(times), count, count)).copy()
    at = np.arange(count)
    matrix[:, at, at] += rates / times[:, None]
    right = np.empty((len(times), count, 2))
    right[:, :, 0], right[:, :, 1] = _SLOPES @ given, _SLOPES @ free
    slow = ~fast
    matrix[slow, 0] = np.eye(count)[0]
    right[slow, 0, 0], right[slow, 0, 1] = memory[slow], 0.0
    solved = np.linalg.solve(matrix, right).transpose(1, 0, 2) if len(times) else np.zeros((count, 0, 2))
    layers = np.where(fast, memory - solved[0, :, 0], 0.0), np.where(fast, -solved[0, :, 1], 0.0)
    return Collocation(times, clock, depth, (given, free), (solved[:, :, 0], solved[:, :, 1]), layers)
