"""What branches in contact remember of the penetration: ``M_k(t) = int exp(-(t - s)/tau_k) dD(s)``.

It is the same for every radius in contact. Over one step the time is a polynomial of ``u`` in [0, 1]. If the
penetration is linear in time, ``M`` is known in closed form. Otherwise, and where time stands while the load
jumps, it follows by collocation of

    dM/du + (t'(u)/tau_k) M = D'(u)

which is as good for branches much faster than the step as for slow ones. It is linear in ``D``, so that a
penetration known but for its end value, under a force or a spring, costs a second right-hand side.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from validation.reference.path.polynomials import DEGREE, powers

Array = NDArray[np.float64]

COLLOCATION = 8
"""Points besides the first. Twice the degree of the path: a branch ten times as fast as the step is then
followed to 1e-8 of what it gains."""
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


@dataclass(frozen=True)
class Ramp:
    """A step during which the penetration is linear in time."""

    times: Array
    clock: Array
    memory: Array
    depth: float
    rate: float

    def during(self, u_powers: Array) -> tuple[Array, Array]:
        """``M`` (m, n) and ``D`` (m,) on the way, at powers of ``u``."""
        elapsed = u_powers[:, : DEGREE + 1] @ self.clock
        faded = np.expm1(-elapsed[:, None] / self.times)
        return (
            self.memory * (1.0 + faded) - self.rate * self.times * faded,
            self.depth + self.rate * elapsed,
        )

    def end(self) -> tuple[Array, float]:
        """``M`` and ``D`` at the end."""
        elapsed = float(self.clock.sum())
        faded = np.expm1(-elapsed / self.times)
        return self.memory * (1.0 + faded) - self.rate * self.times * faded, self.depth + self.rate * elapsed

    def depth_slope(self) -> Array:
        """Coefficients of ``D(u) - D(0)``."""
        return self.rate * self.clock


@dataclass(frozen=True)
class Collocated:
    """A step during which penetration (c,) and memory (c, n) are polynomials of ``u``."""

    clock: Array
    memories: Array
    depths: Array

    def during(self, u_powers: Array) -> tuple[Array, Array]:
        """As of :class:`Ramp`."""
        return u_powers @ self.memories, u_powers @ self.depths

    def end(self) -> tuple[Array, float]:
        """As of :class:`Ramp`."""
        return self.memories.sum(axis=0), float(self.depths.sum())

    def depth_slope(self) -> Array:
        """As of :class:`Ramp`."""
        return np.concatenate(([0.0], self.depths[1:]))


Motion = Ramp | Collocated


@dataclass(frozen=True)
class Collocation:
    """Steps with penetrations ``D(0) + given + v free`` at the nodes: affine in ``v``."""

    clock: Array
    memory: Array
    depth: float
    given: Array
    free: Array
    _given_memory: Array
    _free_memory: Array

    def motion(self, v: float = 0.0) -> Collocated:
        """The motion of one of them."""
        memories = _TO_POWERS @ (self._given_memory + v * self._free_memory)
        depths = _TO_POWERS @ (self.given + v * self.free)
        memories[0] += self.memory
        depths[0] += self.depth
        return Collocated(self.clock, memories, depths)


def collocation(
    times: Array, clock: Array, memory: Array, depth: float, given: Array, free: Array
) -> Collocation:
    """Memories under two penetrations relative to the first, given at the nodes."""
    rates = _SLOPES[1:] @ (PATH_AT_NODES @ clock)  # t'(u)
    matrix = np.broadcast_to(_SLOPES[1:, 1:], (len(times), COLLOCATION, COLLOCATION)).copy()
    at = np.arange(COLLOCATION)
    matrix[:, at, at] += rates / times[:, None]
    right = np.empty((len(times), COLLOCATION, 2))
    right[:, :, 0] = (_SLOPES @ given)[1:] - (memory / times)[:, None] * rates
    right[:, :, 1] = (_SLOPES @ free)[1:]
    solved = np.zeros((COLLOCATION + 1, len(times), 2))
    if len(times):
        solved[1:] = np.linalg.solve(matrix, right).transpose(1, 0, 2)
    return Collocation(clock, memory, depth, given, free, solved[:, :, 0], solved[:, :, 1])
