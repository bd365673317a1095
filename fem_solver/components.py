"""Internal variables of the surface components ``v = L^-1 u``, each of which has a history of its own.

With the compliance ``C = L L^T`` of a solid whose moduli relax alike, ``u = C w`` and ``f = G * w`` (a
hereditary product) read, in the components ``v = L^-1 u`` and ``y = L^T f``,

    ``y_j = G_0 v_j + sum_k b_kj``,   ``b_kj' = -b_kj/tau_k + G_k v_j'``,

one by one. As ``L`` is triangular, ``y_j = 0`` for every node outside the contact, and inside it ``v_j``
follows from the displacements imposed on the nodes up to j: what a component has been through is known from
the penetration and from the moment at which the edge passed its node. Energies are sums over components.

Where shear and bulk relax apart, the modulus is that of the surface, with the energies of the body (see
``moduli``), and ``C`` the compliance at the glassy ``G/K``.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from fem_solver.moduli import Prony, mean_phi, phi

Array = NDArray[np.float64]
VariablesOfParts = tuple[Array, Array]
"""``v`` (m,) and ``b`` (branches, m) of one part of each component."""


class Components:
    """Laws of single components; ``v`` has shape (m,), ``b`` (branches, m), durations are (m,) or numbers."""

    def __init__(self, modulus: Prony) -> None:
        self.modulus = modulus
        self._moduli, self._times = modulus.moduli[:, None], modulus.times[:, None]
        self._prony = Prony(modulus.relaxed, self._moduli, self._times)
        # without force b' = -M b/(G tau) with M = diag(G) - G G^T/G(0): symmetric in b/sqrt(G tau)
        self._root = np.sqrt(self._moduli * self._times)
        matrix = np.diag(modulus.moduli) - np.outer(modulus.moduli, modulus.moduli) / modulus.glassy
        self._rates, self._modes = np.linalg.eigh(matrix / (self._root * self._root.T))
        # what a jump of the force adds to each mode
        self._pull = self._modes.T @ (self._moduli / (self.modulus.glassy * self._root))

    def linear(self, v: Array, b: Array, dt: Array | float, reached: Array) -> Array:
        """Branch variables after a time in which ``v`` goes linearly to ``reached``."""
        y = dt / self._times
        return np.exp(-y) * b + self._moduli * phi(y) * (reached - v)

    def relieved(self, v: Array, b: Array, dt: Array | float) -> Array:
        """The value that ``v`` goes to linearly where the force has vanished after a time."""
        y = dt / self._times
        gain = (self._moduli * phi(y)).sum(axis=0)
        memory = (np.exp(-y) * b).sum(axis=0) - gain * v
        return -memory / (self.modulus.relaxed + gain)

    def recovered(self, b: Array, dt: Array | float) -> tuple[Array, Array]:
        """``v`` and ``b`` after a time without force, exactly."""
        amplitudes = np.exp(-self._rates[:, None] * dt) * (self._modes.T @ (b / self._root))
        after = self._root * (self._modes @ amplitudes)
        return -after.sum(axis=0) / self.modulus.relaxed, after

    def crept(self, v: Array, b: Array, dt: Array, force: Array) -> tuple[Array, Array]:
        """``v`` and ``b`` after a time in which the force goes linearly to ``force``, exactly."""
        y, change = self._rates[:, None] * dt, force - self.force(v, b)
        after = self._root * (self._modes @ (np.exp(-y) * self._amplitudes(b) + phi(y) * self._pull * change))
        return (force - after.sum(axis=0)) / self.modulus.relaxed, after

    def work_of_creep(self, v: Array, b: Array, dt: Array, force: Array, reached: Array) -> Array:
        """Work of the force on the way of :meth:`crept`; shape (m,)."""
        before, relaxed = self.force(v, b), self.modulus.relaxed
        y, change = self._rates[:, None] * dt, force - before
        # mean of v over the time: the work is what it does not lose while the force changes
        amplitudes = phi(y) * self._amplitudes(b) + mean_phi(y) * self._pull * change
        mean = self._root * (self._modes @ amplitudes)
        return np.asarray(
            force * reached - before * v - change * (0.5 * (before + force) - mean.sum(axis=0)) / relaxed
        )

    def lost_by_release(
        self,
        dt: tuple[Array, Array],
        shares: tuple[Array, Array],
        contact: VariablesOfParts,
        reached: Array,
        free: Array,
    ) -> tuple[Array, VariablesOfParts]:
        """What the radii of nodes dissipate, each of which is released all at once in its turn.

        The radii in contact follow ``v`` linearly, they are released one after the other, evenly over the
        time, and creep from the jump of their own release. What the free radii hold beyond the mean of their
        node goes on creeping. Times are those of the release and of what is left of the step, shares those of
        each node in contact before and after; the second of the results holds what is beyond the means.
        """
        (time, later), (before, after) = dt, shares
        y, left = self._rates[:, None] * time, _excess(before, after)
        end = self.linear(*contact, time, reached)
        jump = 0.5 * (self._once_released(*contact) + self._once_released(reached, end))
        earlier = self._amplitudes(free)
        apart = np.sqrt(_shared(1.0 - before, left)) * (phi(y) * jump - np.exp(-y) * earlier)
        uneven = np.sqrt(left * _variance_of_decay(y)) * jump
        decayed = left * (1.0 - phi(2.0 * y)) * jump**2 + (1.0 - before) * -np.expm1(-2.0 * y) * earlier**2
        decayed += -np.expm1(-2.0 * self._rates[:, None] * later) * (apart**2 + uneven**2)
        held = after * self.loss(*contact, time, reached) + left * self.mean_loss(*contact, time, reached)
        lost = held + (decayed / (2.0 * self._rates[:, None])).sum(axis=0)
        kept = _as_one(np.exp(-self._rates[:, None] * later), apart, uneven)
        return np.asarray(lost), self.recovered(self._root * (self._modes @ kept), 0.0)

    def lost_by_cover(
        self,
        dt: tuple[Array, Array],
        shares: tuple[Array, Array],
        contact: VariablesOfParts,
        reached: Array,
        free: Array,
    ) -> tuple[Array, VariablesOfParts]:
        """What the radii of nodes dissipate, each of which is covered all at once in its turn.

        The reverse of :meth:`lost_by_release`: the free radii recover, are covered one after the other and
        relax from the jump of their own covering. What the radii in contact hold beyond the mean of their
        node goes on relaxing.
        """
        (time, later), (before, after) = dt, shares
        y, z, covered = time / self._times, self._rates[:, None] * time, _excess(after, before)
        jump = 0.5 * (self._once_covered(free, 0.0, contact[0]) + self._once_covered(free, time, reached))
        drift = self._moduli * (reached - contact[0])
        earlier = self.linear(*contact, time, reached)
        apart = np.sqrt(_shared(before, covered)) * (phi(y) * jump + mean_phi(y) * drift - earlier)
        uneven = np.sqrt(covered * _variance_of_decay(y)) * jump
        relaxed = -np.expm1(-2.0 * later / self._times) * (apart**2 + uneven**2) / (2.0 * self._moduli)
        held = before * self.loss(*contact, time, reached)
        held += covered * self.mean_loss(contact[0], jump, time, reached)
        decayed = (1.0 - after) * -np.expm1(-2.0 * z) + covered * (1.0 - phi(2.0 * z))
        recovered = decayed * self._amplitudes(free) ** 2 / (2.0 * self._rates[:, None])
        lost = held + (recovered + relaxed).sum(axis=0)
        return np.asarray(lost), (np.zeros(1), _as_one(np.exp(-later / self._times), apart, uneven))

    def _amplitudes(self, b: Array) -> Array:
        """Modes of what creeps under a constant force; the sum of their squares is the dissipation."""
        return np.asarray(self._modes.T @ (b / self._root))

    def _once_released(self, v: Array, b: Array) -> Array:
        """Amplitudes of components in contact right after their release."""
        return self._amplitudes(b) - self._pull * self.force(v, b)

    def _once_covered(self, free: Array, dt: Array | float, imposed: Array) -> Array:
        """Branch variables of components right after they have been covered, after a time without force."""
        v, b = self.recovered(free, dt)
        return b + self._moduli * (imposed - v)

    def free_energies(self, b: Array) -> Array:
        """Energy that components without force hold in each mode, all of them together; shape (branches,)."""
        amplitudes = self._modes.T @ (b / self._root)
        return np.asarray((amplitudes**2).sum(axis=1) / (2.0 * self._rates))

    def remaining(self, energies: Array, dt: float) -> Array:
        """What is left after a time of the energies of :meth:`free_energies`."""
        return energies * np.exp(-2.0 * self._rates * dt)

    def uneven_energies(self, spread: Array, unit: Array) -> Array:
        """Energy of each branch that components hold beyond that of their means; shape (branches,)."""
        return np.asarray((spread * unit**2).sum(axis=1) / (2.0 * self.modulus.moduli))

    def remaining_in_contact(self, energies: Array, dt: float) -> Array:
        """What is left after a time of the energies of :meth:`uneven_energies`: a strain that is the same."""
        return energies * np.exp(-2.0 * dt / self.modulus.times)

    def force(self, v: Array, b: Array) -> Array:
        """``y``."""
        return self.modulus.relaxed * v + b.sum(axis=0)

    def mean_force(self, v: Array, b: Array, dt: Array | float, reached: Array) -> Array:
        """Mean of ``y`` over a time in which ``v`` goes linearly to ``reached``."""
        y = dt / self._times
        branches = phi(y) * b + self._moduli * mean_phi(y) * (reached - v)
        return np.asarray(0.5 * self.modulus.relaxed * (v + reached) + branches.sum(axis=0))

    def stored(self, v: Array, b: Array) -> Array:
        """Energy of the springs of each component."""
        return 0.5 * (self.modulus.relaxed * v**2 + (b**2 / self._moduli).sum(axis=0))

    def loss(self, v: Array, b: Array, dt: Array | float, reached: Array) -> Array:
        """Energy dissipated in each component while ``v`` goes linearly to ``reached`` in a finite time."""
        return self._weighted_loss(self._prony.loss_weights(dt), b, reached - v)  # type: ignore[arg-type]

    def mean_loss(self, v: Array, b: Array, dt: Array | float, reached: Array) -> Array:
        """Mean of :meth:`loss` over shares of the time, evenly distributed, at the same rate of ``v``."""
        return self._weighted_loss(self._prony.mean_loss_weights(dt), b, reached - v)  # type: ignore[arg-type]

    def _weighted_loss(self, weights: Array, b: Array, change: Array) -> Array:
        parts = weights[0] * b**2 / self._moduli + weights[1] * b * change
        return np.asarray((parts + weights[2] * self._moduli * change**2).sum(axis=0))


def _variance_of_decay(y: Array) -> Array:
    """Variance of ``exp(-x)`` with x evenly distributed from 0 to y."""
    return np.maximum(phi(2.0 * y) - phi(y) ** 2, 0.0)


def _as_one(decay: Array, apart: Array, uneven: Array) -> Array:
    """Amplitudes (branches, m) of parts of many components as those of one with all their energy."""
    signs = np.where((decay * (apart + uneven)).sum(axis=1) < 0.0, -1.0, 1.0)
    return np.asarray((signs * np.sqrt((decay**2 * (apart**2 + uneven**2)).sum(axis=1)))[:, None])


def _excess(larger: Array, smaller: Array) -> Array:
    """What one share is beyond another: none below zero, where an edge rests and they differ by rounding."""
    return np.maximum(larger - smaller, 0.0)


def _shared(one: Array, other: Array) -> Array:
    """Weight of the square of the difference of two parts in what they hold beyond their mean."""
    whole = one + other
    return np.divide(one * other, whole, out=np.zeros_like(whole), where=whole > 0.0)
