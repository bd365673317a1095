"""Internal variables of the surface components ``v = L^-1 u``, each of which has a history of its own.

With the compliance ``C = L L^T`` of a solid whose moduli relax alike, ``u = C w`` and ``f = G * w`` (a
hereditary product) read, in the components ``v = L^-1 u`` and ``y = L^T f``,

    ``y_j = G_0 v_j + sum_k b_kj``,   ``b_kj' = -b_kj/tau_k + G_k v_j'``,

one by one. As ``L`` is triangular, ``y_j = 0`` for every node outside the contact, and inside it ``v_j``
follows from the displacements imposed on the nodes up to j: what a component has been through is known from
the penetration and from the moment at which the edge passed its node. Energies are sums over components.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from fem_solver.prony import Prony, phi

Array = NDArray[np.float64]

_SHORT = 1e-4
"""Share of a retardation time below which a series replaces a difference of nearly equal numbers; the error
of both is about the square."""


def _double_mean(y: Array) -> Array:
    """``(1 - phi(y))/y``, the mean over a time of the mean so far of what decays."""
    return np.where(y > _SHORT, (1.0 - phi(y)) / np.where(y > _SHORT, y, 1.0), 0.5 - y / 6.0)


class Components:
    """Laws of single components; ``v`` has shape (m,), ``b`` (branches, m), durations are (m,) or numbers.

    Parameters
    ----------
    shear : Prony
    """

    def __init__(self, shear: Prony) -> None:
        self.shear = shear
        self._moduli, self._times = shear.moduli[:, None], shear.times[:, None]
        # without force b' = -M b/(G tau) with M = diag(G) - G G^T/G(0): symmetric in b/sqrt(G tau)
        self._root = np.sqrt(self._moduli * self._times)
        matrix = np.diag(shear.moduli) - np.outer(shear.moduli, shear.moduli) / shear.glassy
        self._rates, self._modes = np.linalg.eigh(matrix / (self._root * self._root.T))

    def linear(self, v: Array, b: Array, dt: Array | float, reached: Array) -> Array:
        """Branch variables after a time in which ``v`` goes linearly to ``reached``.

        Parameters
        ----------
        v, reached : ndarray, shape (m,)
        b : ndarray, shape (branches, m)
        dt : ndarray, shape (m,), or float
            Time.

        Returns
        -------
        ndarray, shape (branches, m)
        """
        y = dt / self._times
        return np.exp(-y) * b + self._moduli * phi(y) * (reached - v)

    def relieved(self, v: Array, b: Array, dt: Array | float) -> Array:
        """The value that ``v`` goes to linearly where the force has vanished after a time.

        Parameters
        ----------
        v : ndarray, shape (m,)
        b : ndarray, shape (branches, m)
        dt : ndarray, shape (m,), or float
            Time.

        Returns
        -------
        ndarray, shape (m,)
        """
        y = dt / self._times
        gain = (self._moduli * phi(y)).sum(axis=0)
        memory = (np.exp(-y) * b).sum(axis=0) - gain * v
        return -memory / (self.shear.relaxed + gain)

    def recovered(self, b: Array, dt: Array | float) -> tuple[Array, Array]:
        """``v`` and ``b`` after a time without force, exactly."""
        amplitudes = np.exp(-self._rates[:, None] * dt) * (self._modes.T @ (b / self._root))
        after = self._root * (self._modes @ amplitudes)
        return -after.sum(axis=0) / self.shear.relaxed, after

    def crept(self, v: Array, b: Array, dt: Array, force: Array) -> tuple[Array, Array, Array]:
        """``v`` and ``b`` after a time in which the force goes linearly to ``force``, exactly, and its work.

        Parameters
        ----------
        v : ndarray, shape (m,)
        b : ndarray, shape (branches, m)
        dt, force : ndarray, shape (m,)

        Returns
        -------
        v, b, work : ndarray
        """
        before, relaxed = self.force(v, b), self.shear.relaxed
        y = self._rates[:, None] * dt
        one, change = phi(y), force - before
        start = self._modes.T @ (b / self._root)
        pull = self._modes.T @ (self._moduli / (self.shear.glassy * self._root))
        after = self._root * (self._modes @ (np.exp(-y) * start + one * pull * change))
        reached = (force - after.sum(axis=0)) / relaxed
        # mean of v over the time: the work is what it does not lose while the force changes
        double = _double_mean(y)
        mean = self._root * (self._modes @ (one * start + double * pull * change))
        work = force * reached - before * v - change * (0.5 * (before + force) - mean.sum(axis=0)) / relaxed
        return reached, after, work

    def lost_by_release(self, dt: Array, share: Array, force: Array) -> float:
        """What the radii of a node dissipate beyond their mean, as each is released all at once in its turn.

        The mean of a node follows a force that goes linearly to zero. Every radius of it loses
        ``z^2/(2 lambda)`` in each mode, by the jump ``z`` of its own release; the mean of all loses less.
        What the difference still holds at the end of the time counts as lost; where a node takes several
        steps, what its parts differ from each other does not.

        Parameters
        ----------
        dt : ndarray, shape (m,)
            Time of the release.
        share, force : ndarray, shape (m,)
            Share of each node that is released, and its force in contact.

        Returns
        -------
        float
            Energy.
        """
        y = self._rates[:, None] * dt
        pull = self._modes.T @ (self._moduli / (self.shear.glassy * self._root))
        each = share * (pull * force) ** 2 * (0.5 - _double_mean(y))
        return float(np.sum(each / self._rates[:, None]))

    def lost_by_cover(self, dt: Array, share: Array, jump: Array) -> float:
        """What the radii of a node dissipate beyond their mean, as each is covered all at once in its turn.

        Parameters
        ----------
        dt : ndarray, shape (m,)
            Time of the covering.
        share, jump : ndarray, shape (m,)
            Share of each node that is covered, and the change of ``v`` when it is.

        Returns
        -------
        float
            Energy.
        """
        y = dt / self._times
        return float(np.sum(share * self._moduli * jump**2 * (0.5 - _double_mean(y))))

    def free_energies(self, b: Array) -> Array:
        """Energy that components without force hold in each mode, all of them together; shape (branches,)."""
        amplitudes = self._modes.T @ (b / self._root)
        return np.asarray((amplitudes**2).sum(axis=1) / (2.0 * self._rates))

    def remaining(self, energies: Array, dt: float) -> Array:
        """What is left after a time of the energies of :meth:`free_energies`."""
        return energies * np.exp(-2.0 * self._rates * dt)

    def uneven_energies(self, spread: Array, unit: Array) -> Array:
        """Energy of each branch that components hold beyond that of their means; shape (branches,).

        Parameters
        ----------
        spread : ndarray, shape (branches, m)
            Variance of ``b/unit`` within each component.
        unit : ndarray, shape (m,)
            ``L^-1 1``.
        """
        return np.asarray((spread * unit**2).sum(axis=1) / (2.0 * self.shear.moduli))

    def remaining_in_contact(self, energies: Array, dt: float) -> Array:
        """What is left after a time of the energies of :meth:`uneven_energies`: a strain that is the same."""
        return energies * np.exp(-2.0 * dt / self.shear.times)

    def force(self, v: Array, b: Array) -> Array:
        """``y``."""
        return self.shear.relaxed * v + b.sum(axis=0)

    def stored(self, v: Array, b: Array) -> Array:
        """Energy of the springs of each component."""
        return 0.5 * (self.shear.relaxed * v**2 + (b**2 / self._moduli).sum(axis=0))

    def loss(self, v: Array, b: Array, dt: Array | float, reached: Array) -> Array:
        """Energy dissipated in each component while ``v`` goes linearly to ``reached`` in a finite time.

        Parameters
        ----------
        v, reached : ndarray, shape (m,)
        b : ndarray, shape (branches, m)
        dt : ndarray, shape (m,), or float
            Time.

        Returns
        -------
        ndarray, shape (m,)
            Energies.
        """
        weights = Prony(self.shear.relaxed, self._moduli, self._times).loss_weights(dt)  # type: ignore[arg-type]
        change = reached - v
        parts = weights[0] * b**2 / self._moduli + weights[1] * b * change
        return np.asarray((parts + weights[2] * self._moduli * change**2).sum(axis=0))
