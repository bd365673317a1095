"""Creep compliance of a Prony material, by a symmetric eigenproblem, and its inverse.

``J(t) = 1/Einf + sum_k J_k (1 - exp(-t/theta_k))`` (paper, Eq. creep2). Without stress the strain is
``eps = sum_k E_k eps_k/Einf`` and every dashpot follows ``eps_k' = (eps - eps_k)/tau_k``. By Sherman and
Morrison's formula the inverse of that rate matrix is ``-(I + 1 m^T) diag(tau)`` with ``m_k = E_k/E0``,
similar to the symmetric positive definite

    A = diag(tau) + z z^T,      z_k = sqrt(tau_k E_k/E0).

Its eigenvalues are the retardation times ``theta_k``; with unit eigenvectors ``v_k``, whose components are
proportional to ``z_j/(theta_k - tau_j)``,

    E0 J_k = (v_k . z)^2/theta_k,      1/(v_k . z)^2 = sum_j [z_j/(theta_k - tau_j)]^2.

The entries of ``A`` determine all ``theta_k`` to full relative accuracy. Each is the one root of

    1 = sum_j z_j^2/(theta - tau_j)

between two neighbouring times, or beyond the last, found by halving its distance from the nearer of them.
Differences ``theta_k - tau_j`` of nearly equal times need more than that: Newton's method makes them satisfy
Loewner's identities (Gu and Eisenstat, SIAM J. Matrix Anal. Appl. 16, 1995)

    z_j^2 = (theta_j - tau_j) prod_(k != j) (theta_k - tau_j)/(tau_k - tau_j),

so that the result belongs exactly to branch moduli that are the given ones to round-off.
"""

from __future__ import annotations

from contextlib import suppress
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import ArrayLike, NDArray

from contact_scene import Branch, Material

Array = NDArray[np.float64]

HALVINGS = 60
"""Of the logarithm of a distance between bounds, which spans a few hundred at most."""
LARGE_CORRECTION = 2.0
"""Change of the logarithm of a distance above which a Newton step leaves out ill-determined directions."""
LARGEST_CORRECTION = 20.0
"""Largest change of the logarithm of a distance in one Newton step."""
ILL_DETERMINED = 1e-13
"""Relative singular value of the Newton matrix below which a direction is not moved by a large step."""
MOVED_BY_ROUND_OFF = 1e-7
"""The same once Newton's method stalls: below it round-off moves a direction by more than its root."""
STEPS_TO_STALL = 12
"""Newton steps that do not halve the error after which ill-determined directions are no longer moved."""
MOST_CORRECTIONS = 200
"""Newton steps, of which few are used: one or two where distances are resolved by the eigenvalues."""
ROUND_OFF = 1e-14
"""Relative error of Loewner's identities, per branch, that counts as round-off."""


@dataclass(frozen=True)
class CreepCompliance:
    """``J(t) = glassy + sum_k compliances[k] (1 - exp(-t/times[k]))``.

    ``compliances`` and ``times`` have shape (n,), ascending times; all entries positive. ``distances`` (n, n)
    are ``times[k] - relaxation_times[j]`` at [k, j], accurate where the two nearly coincide.
    """

    glassy: float
    compliances: Array
    times: Array
    distances: Array

    @property
    def relaxed(self) -> float:
        """``J(inf) = 1/E0``."""
        return self.glassy + float(self.compliances.sum())

    def __call__(self, time: ArrayLike) -> Array:
        """``J(t)`` for ``time >= 0``, zero before; same shape as ``time``."""
        t = np.asarray(time, float)
        arrested = -np.expm1(-np.maximum(t, 0.0)[..., None] / self.times)
        return np.where(t >= 0, self.glassy + arrested @ self.compliances, 0.0)

    def complex_compliance(self, angular_frequency: ArrayLike) -> NDArray[np.complex128]:
        """``J(omega) = Jg + sum_k J_k/(1 + i w theta_k) = 1/E(omega)``; same shape as the argument."""
        p = np.asarray(angular_frequency, float)[..., None] * self.times
        length = np.hypot(1.0, p)  # p^2 would overflow
        in_phase, out_of_phase = 1.0 / length, p / length
        return self.glassy + (in_phase * (in_phase - 1j * out_of_phase)) @ self.compliances.astype(complex)

    def relaxation(self) -> tuple[float, tuple[Branch, ...]]:
        """Relaxed modulus and branches of the relaxation modulus ``E(t)`` that this compliance belongs to."""
        relaxed, moduli, times = relaxation_spectrum(self.glassy, self.compliances, self.times)
        return relaxed, tuple(Branch(m, t) for m, t in zip(moduli.tolist(), times.tolist(), strict=True))


@lru_cache(maxsize=64)
def creep_compliance(material: Material) -> CreepCompliance:
    """Creep compliance of Young's modulus."""
    moduli, times = material.spectrum
    return CreepCompliance(1.0 / material.glassy_modulus, *creep_spectrum(material.modulus, moduli, times))


def creep_spectrum(relaxed: float, moduli: Array, times: Array) -> tuple[Array, Array, Array]:
    """``J_k`` and ``theta_k`` (n,) in ascending times, and ``theta_k - tau_j`` at [k, j].

    The last (n, n) to full relative accuracy, however close two times are. Relaxation times ascend.
    """
    weights, retardation, distances = _rank_one_update(times, moduli / relaxed * times)
    return weights / relaxed, retardation, distances


def relaxation_spectrum(glassy: float, compliances: Array, times: Array) -> tuple[float, Array, Array]:
    """The inverse of :func:`creep_spectrum`: the same eigenproblem for ``1/theta_k`` and ``1/tau_k``.

    ``E0 = 1/(Jg + sum J_k)``, branch moduli and relaxation times (n,), ascending as the retardation times.
    """
    relaxed = 1.0 / (glassy + float(np.sum(compliances)))
    rates = 1.0 / times[::-1]
    weights, decay, _ = _rank_one_update(rates, compliances[::-1] / glassy * rates)
    return relaxed, (weights / glassy)[::-1], 1.0 / decay[::-1]


def _rank_one_update(poles: Array, strengths: Array) -> tuple[Array, Array, Array]:
    """``(v_k . z)^2/lambda_k`` and ``lambda_k`` (n,), ``lambda_k - poles[j]`` at [k, j].

    Of the eigenvalues ``lambda`` and vectors ``v`` of ``diag(poles) + z z^T`` with ``z^2 = strengths``; one
    eigenvalue lies above each pole.
    """
    if len(poles) == 0:
        return np.empty(0), np.empty(0), np.empty((0, 0))
    nearest, offset = _corrected(poles, strengths)
    distances = (poles[nearest][:, None] - poles[None, :]) + offset[:, None]
    eigenvalues = poles[nearest] + offset
    weights = 1.0 / (eigenvalues * (strengths / distances / distances).sum(axis=1))
    return weights, eigenvalues, distances


def _located(poles: Array, strengths: Array, gap: Array, least: Array) -> tuple[NDArray[np.bool_], Array]:
    """Whether each eigenvalue lies nearer to the pole above, and its distance from the nearer one."""

    def lies_above(near: Array, offset: Array) -> NDArray[np.bool_]:
        """Whether the eigenvalues lie above places that far from poles."""
        distances = (near[:, None] - poles) + offset[:, None]
        return np.asarray((strengths / distances).sum(axis=1) > 1.0)

    upper = np.isfinite(gap)
    upper[upper] = lies_above(poles, np.where(upper, 0.5 * gap, 1.0))[upper]
    near, low = (np.where(upper, np.append(each[1:], each[-1]), each) for each in (poles, least))
    low, high = np.log(low), np.log(np.where(np.isfinite(gap), 0.5 * gap, strengths.sum()))
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        if (middle == high).all():  # of one branch both bounds are the root
            break
        size = np.exp(middle)
        longer = lies_above(near, np.where(upper, -size, size)) != upper
        low, high = np.where(longer, middle, low), np.where(longer, high, middle)
    return upper, np.exp(0.5 * (low + high))


def _corrected(poles: Array, strengths: Array) -> tuple[NDArray[np.intp], Array]:
    """Nearest pole of each eigenvalue and the signed distance from it, by Newton's method.

    The unknowns are the logarithms of the distances, the equations the logarithms of Loewner's identities.
    """
    index = np.arange(len(poles))
    gap = np.append(np.diff(poles), np.inf)
    between_poles = poles[:, None] - poles[None, :]  # tau_k - tau_j
    np.fill_diagonal(between_poles, 1.0)
    # To a pole j the distance is at least z_j^2/(1 + 2 sum_(i != j) z_i^2/|tau_i - tau_j|).
    others = strengths[:, None] / np.abs(between_poles)
    np.fill_diagonal(others, 0.0)
    least = strengths / (1.0 + 2.0 * others.sum(axis=0))
    upper, size = _located(poles, strengths, gap, least)
    nearest = np.where(upper, index + 1, index)
    size = np.minimum(np.maximum(size, least[nearest]), 0.5 * gap)
    best, best_error, stalled, fixed = (nearest, size), np.inf, 0, False
    for _ in range(MOST_CORRECTIONS):
        upper = nearest > index
        offset = np.where(upper, -size, size)
        distances = (poles[nearest][:, None] - poles[None, :]) + offset[:, None]
        own = np.where(upper, gap - size, size)  # theta_k - tau_k
        np.fill_diagonal(distances, own)
        error = _loewner_error(distances, between_poles, own, strengths)
        largest = float(np.abs(error).max())
        stalled = stalled + 1 if largest > 0.5 * best_error else 0
        if largest < best_error:
            best, best_error = (nearest, offset), largest
        if best_error == 0.0 or (stalled > 2 and (fixed or best_error < ROUND_OFF)):
            break
        if stalled > STEPS_TO_STALL:
            fixed, stalled = True, 0
        size = size * np.exp(_newton_step((offset[:, None] / distances).T, error, fixed))
        beyond = (size > 0.5 * gap) & np.isfinite(gap)
        size = np.where(beyond, np.maximum(gap - size, 0.25 * np.minimum(size, gap)), size)
        nearest = np.where(beyond, np.where(upper, index, index + 1), nearest)
    if best_error > ROUND_OFF * (10 + len(poles)):
        raise ArithmeticError(f"the retardation spectrum is only accurate to {best_error:.1e}")
    return best


def _newton_step(matrix: Array, error: Array, fixed: bool) -> Array:
    """Change of the logarithms of the distances; if ``fixed``, ill-determined directions are not moved."""
    change: Array = np.full_like(error, np.inf)
    if not fixed:
        with suppress(np.linalg.LinAlgError):
            change = np.asarray(np.linalg.solve(matrix, -error), float)
    if not float(np.abs(change).max()) <= LARGE_CORRECTION:
        smallest = MOVED_BY_ROUND_OFF if fixed else ILL_DETERMINED
        change = np.asarray(np.linalg.lstsq(matrix, -error, rcond=smallest)[0], float)
    return np.clip(change, -LARGEST_CORRECTION, LARGEST_CORRECTION)


def _loewner_error(distances: Array, between_poles: Array, own: Array, strengths: Array) -> Array:
    """Logarithm of the right-hand side of Loewner's identities over ``z_j^2``, shape (n,)."""
    relative = own[:, None] / between_poles
    ratio = distances / between_poles
    np.fill_diagonal(relative, 0.0)
    np.fill_diagonal(ratio, 1.0)
    small = np.abs(relative) < 0.5
    near_one, other = np.log1p(np.where(small, relative, 0.0)), np.log(np.where(small, 1.0, ratio))
    return np.asarray((near_one + other).sum(axis=0) + np.log(own / strengths))
