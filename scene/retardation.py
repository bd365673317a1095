"""Retardation spectrum of a Prony relaxation modulus.

``J(s) E(s) s^2 = 1``. With ``s = -1/theta``, ``s E(s) = E0 + sum_k E_k tau_k/(tau_k - theta)``, which rises
from -inf to +inf between neighbouring relaxation times: one root in each gap, the last beyond the longest
time. Roots are sought as the *distance from the nearer pole*, on a logarithmic scale, so that neither
spectra over many decades nor nearly equal times cost digits (never as a polynomial in s).
The compliance of a root is ``J = theta / sum_k E_k tau_k / (1 - tau_k/theta)^2``: a sum of positive terms.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq


def creep_spectrum(
    relaxed: float, moduli: NDArray[np.float64], times: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Compliances ``J_k`` and retardation times ``theta_k``.

    Parameters
    ----------
    relaxed : float
        Relaxed modulus ``E0`` > 0.
    moduli, times : ndarray, shape (n,)
        Branch moduli > 0 and distinct, ascending relaxation times.

    Returns
    -------
    compliances, retardation : ndarray, shape (n,)
        Ascending in time, ``tau_k < theta_k < tau_(k+1)``.
    """
    n = len(times)
    compliances, retardation = np.empty(n), np.empty(n)
    for k in range(n):
        pole, distance = _root(relaxed, moduli, times, k)
        theta = times[pole] + distance
        offsets = ((times - times[pole]) - distance) / theta  # tau_j/theta - 1, exact near the pole
        compliances[k] = theta / np.sum(moduli * times / offsets**2)
        retardation[k] = theta
    return compliances, retardation


def _root(
    relaxed: float, moduli: NDArray[np.float64], times: NDArray[np.float64], k: int
) -> tuple[int, float]:
    """The root beyond ``times[k]`` as (index of the nearer pole, signed distance from it)."""
    scale = moduli * times

    def from_pole(pole: int, distance: float) -> float:
        return float(relaxed + np.sum(scale / ((times - times[pole]) - distance)))

    if k + 1 < len(times):
        gap = times[k + 1] - times[k]
        below = from_pole(k, 0.5 * gap) > 0.0  # the root lies in the lower half of the gap
        pole, sign, far = (k, 1.0, 0.5 * gap) if below else (k + 1, -1.0, 0.5 * gap)
    else:
        # E0 = sum_j E_j tau_j/(theta - tau_j) <= sum_j E_j tau_j/(theta - tau_n)
        pole, sign, far = k, 1.0, float(scale.sum() / relaxed) * (1.0 + 1e-9)
    near = far
    target = np.sign(from_pole(pole, sign * far))
    if target == 0.0:
        return pole, sign * far
    while np.sign(from_pole(pole, sign * near)) == target:
        near *= 1e-3
    log_distance = brentq(
        lambda x: from_pole(pole, sign * np.exp(x)), np.log(near), np.log(far), xtol=1e-15, rtol=1e-15
    )
    return pole, sign * float(np.exp(log_distance))
