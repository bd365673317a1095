"""Retardation spectrum of a relaxation spectrum, by bracketed roots.

``s^2 E(s) J(s) = 1`` in Laplace space. With ``s = -1/x``,

    s E(s) = E0 + sum_k E_k tau_k/(tau_k - x)

vanishes at the retardation times theta_k, one in each gap: ``tau_1 < theta_1 < tau_2 < theta_2 < ...``. A
root is represented by its *distance from the nearer pole*, found by bisection of the logarithm of that
distance: neither spectra over many decades nor nearly equal times cost digits, as a polynomial in s would.

The compliances follow from the product form, ``s E(s) = E0 prod_k (1 + s theta_k)/(1 + s tau_k)``, whose
factors are differences of times. They belong exactly to the computed roots, whose rounding is then a relative
change of the input of the same size; residues taken from the sums would not have that property where a
negligible branch sits on a retardation time of the others (the device of Gu and Eisenstat, SIAM J. Matrix
Anal. Appl. 16, 1995, for the same secular equation).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

_HALVINGS = 72
"""Halvings of a bracket of at most a few hundred in the logarithm of the distance: down to rounding."""


def creep_spectrum(relaxed: float, moduli: Array, times: Array) -> tuple[Array, Array, Array]:
    """Compliances ``J_k``, retardation times ``theta_k`` and their distances from the relaxation times.

    Parameters
    ----------
    relaxed : float
        Relaxed modulus ``E0`` > 0.
    moduli, times : ndarray, shape (n,)
        Branch moduli > 0 and distinct, ascending relaxation times.

    Returns
    -------
    compliances, retardation : ndarray, shape (n,)
        Ascending in time, ``tau_k <= theta_k <= tau_(k+1)`` (equality only by rounding).
    distances : ndarray, shape (n, n)
        ``theta_k - tau_j`` at [k, j], to full relative accuracy however close the two are.
    """
    n = len(times)
    if n == 0:
        return np.empty(0), np.empty(0), np.empty((0, 0))
    pole, distance = _roots(moduli / relaxed * times, times)
    retardation = times[pole] + distance
    to_poles = (times[None, :] - times[pole][:, None]) - distance[:, None]  # tau_j - theta_k
    to_roots = _between_roots(times, pole, distance)  # theta_j - theta_k, 1 on the diagonal
    # J_k E0 = (1 - tau_k/theta_k) prod_(j != k) (theta_k - tau_j)/(theta_k - theta_j)
    ratio = to_poles / to_roots
    diagonal = np.diag(-to_poles) / retardation
    np.fill_diagonal(ratio, diagonal)
    return np.prod(ratio, axis=1) / relaxed, retardation, -to_poles


def _roots(strengths: Array, poles: Array) -> tuple[NDArray[np.intp], Array]:
    """Roots of ``1 + sum_j strengths[j]/(poles[j] - x)``, one above each pole.

    Returns
    -------
    pole : ndarray of int, shape (n,)
        The nearer of the two poles a root lies between.
    distance : ndarray, shape (n,)
        Signed distance of the root from that pole.
    """
    n = len(poles)
    index = np.arange(n)
    separation = poles[None, :] - poles[:, None]  # [i, j] = pole_j - pole_i

    def value(pole: NDArray[np.intp], distance: Array) -> Array:
        return 1.0 + np.sum(strengths / (separation[pole] - distance[:, None]), axis=1)

    far = np.empty(n)
    far[:-1] = 0.5 * np.diff(poles)
    # 1 = sum_j c_j/(x - p_j) <= sum_j c_j/(x - p_n)
    far[-1] = strengths.sum() * (1.0 + 1e-12)
    below = np.ones(n, bool)  # the root lies in the lower half of its gap
    below[:-1] = value(index[:-1], far[:-1]) > 0.0
    pole = np.where(below, index, np.minimum(index + 1, n - 1))
    sign = np.where(below, 1.0, -1.0)

    # The nearer pole's term balances the rest; distances to the other poles are at least half as long inside
    # the bracket, so the rest is at most this:
    others = np.abs(separation[pole])
    others[index, pole] = np.inf
    rest = 1.0 + 2.0 * np.sum(strengths / others, axis=1)
    low = np.log(np.minimum(strengths[pole] / rest, far))
    high = np.log(far)
    for _ in range(_HALVINGS):
        middle = 0.5 * (low + high)
        # With the pole below, the function climbs from -inf to its zero; with the pole above, it is mirrored.
        outside = sign * value(pole, sign * np.exp(middle)) > 0.0
        high = np.where(outside, middle, high)
        low = np.where(outside, low, middle)
    return pole, sign * np.exp(0.5 * (low + high))


def _between_roots(poles: Array, pole: NDArray[np.intp], distance: Array) -> Array:
    """``x_j - x_k`` at [k, j] for roots given as pole and distance; ones on the diagonal."""
    base = poles[pole]
    apart = (base[None, :] - base[:, None]) + (distance[None, :] - distance[:, None])
    np.fill_diagonal(apart, 1.0)
    return apart
