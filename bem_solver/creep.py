"""One surface point as a viscoelastic element: Voigt chain outside the contact, Maxwell chain inside.

With ``v`` the displacement the present pressure would cause at unit plane modulus, the paper's Eq.
convolution reads ``w = int J*(t - t') dv(t')`` at every radius separately. Outside the contact ``v`` is known
and ``w`` creeps; inside ``w`` is prescribed and ``v`` relaxes. Two sets of internal variables say the same:

- Voigt lags ``l_k = J_k v - e_k`` with ``dl_k/dt = J_k dv/dt - l_k/theta_k`` and ``w = v/E0 - sum l_k``;
- Maxwell stresses ``b_j`` with ``db_j/dt = E_j dw/dt - b_j/tau_j`` and ``v = E0 w + sum b_j``.

Both dissipate ``sum b_j^2/(E_j tau_j) = sum l_k^2/(J_k theta_k)``: scaled by those square roots, as stored
here, they are images of each other under the *orthogonal* matrix ``Q``, ``Q_kj = sqrt(E_j tau_j J_k
theta_k)/(theta_k - tau_j)``. The retardation times theta_k are the roots of ``E0 + sum_k E_k tau_k/(tau_k -
x)``, one in each gap of the tau_k, found as *distances from the nearer pole*: no spectrum costs digits.
Compliances follow from ``s E(s) = E0 prod_k (1 + s theta_k)/(1 + s tau_k)``, whose factors are such distances
(the device of Gu and Eisenstat, SIAM J. Matrix Anal. Appl. 16, 1995).
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray
from scipy.special import dawsn, hyp1f1

from contact_scene import Branch, BulkRelaxation, Material

Array = NDArray[np.float64]

_HALVINGS = 72
"""Halvings of a bracket of at most a few hundred in the logarithm of the distance: down to rounding."""


def creep_spectrum(relaxed: float, moduli: Array, times: Array) -> tuple[Array, Array, Array]:
    """Compliances ``J_k``, retardation times ``theta_k`` and their distances from the relaxation times."""
    n = len(times)
    if n == 0:
        return np.empty(0), np.empty(0), np.empty((0, 0))
    pole, distance = _roots(moduli / relaxed * times, times)
    retardation = times[pole] + distance
    to_poles = (times[None, :] - times[pole][:, None]) - distance[:, None]  # tau_j - theta_k
    base = times[pole]
    to_roots = (base - base[:, None]) + (distance - distance[:, None])  # theta_j - theta_k
    np.fill_diagonal(to_roots, 1.0)
    # J_k E0 = (1 - tau_k/theta_k) prod_(j != k) (theta_k - tau_j)/(theta_k - theta_j)
    ratio = to_poles / to_roots
    diagonal = np.diag(-to_poles) / retardation
    np.fill_diagonal(ratio, diagonal)
    return np.prod(ratio, axis=1) / relaxed, retardation, -to_poles


def _roots(strengths: Array, poles: Array) -> tuple[NDArray[np.intp], Array]:
    """Roots of ``1 + sum_j strengths[j]/(poles[j] - x)``, one above each pole."""
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


SMALLEST = 1e-300
"""Stands for zero in quotients whose limit there is 1 to rounding."""
_SHORT = 1e-2
"""Time, in relaxation times, below which what relaxes of a root is summed as a series, to 1e-6 of it."""
_LATEST_SHARE = 1.0 - 1e-8
"""Share of a step at which a penetration is met at the latest: between the end and an even later one rounding
would be more than half the change, and the difference it makes is as small."""
_STEPS_KEPT = 16
"""Steps whose factors are kept: more than are tried at a time."""


def phi(y: Array) -> Array:
    """``(1 - exp(-y))/y``, the average of ``exp(-y x)`` over 0 <= x <= 1; phi(0) = 1."""
    positive = np.maximum(y, SMALLEST)
    return -np.expm1(-positive) / positive


def decaying_moments(y: Array) -> tuple[Array, Array]:
    """Integrals of ``exp(-y u) u (1 - u)`` and ``exp(-y u) u^2 (1 - u)`` over 0 <= u <= 1."""
    return hyp1f1(2.0, 4.0, -y) / 6.0, hyp1f1(3.0, 5.0, -y) / 12.0


def surface_material(material: Material) -> Material:
    """A material of one Poisson's ratio, 0, whose modulus is the plane one that the surface knows.

    Where bulk relaxes apart a frictionless surface meets ``1/E* = 1/A + 1/B`` with ``A = 4 G`` and ``B = 4 K
    + 4 G/3`` (as functions of time, products are convolutions): two bodies in series, with the energies of
    both. The times of ``E* = A - A^2/(A + B)`` are those ``theta`` at which ``A + B``, of compliances ``J``,
    vanishes, with the moduli ``A(theta)^2 J``, and those of the shear, with ``A_k B_k/(A_k + B_k)``.
    """
    bulk = material.bulk
    if bulk is None:
        return material
    twice, (shear, times) = 2.0 * (1.0 + material.poisson), material.spectrum
    own, branches = (bulk.modulus, bulk.branches) if isinstance(bulk, BulkRelaxation) else (None, ())
    stiffness = own or material.modulus / (3.0 * (1.0 - 2.0 * material.poisson))
    volume, slow = Material(stiffness, 0.0, branches).spectrum
    every = np.unique(np.concatenate((times, slow)))
    one, other = np.zeros(len(every)), np.zeros(len(every))
    one[every.searchsorted(times)] = 4.0 * shear / twice
    other[every.searchsorted(slow)] = 4.0 * volume
    other += one / 3.0
    soft = 4.0 * material.modulus / twice
    stiff = 4.0 * stiffness + soft / 3.0
    compliances, retardation, distances = creep_spectrum(soft + stiff, one + other, every)
    at_zeros = soft - (one * every / distances).sum(axis=1)
    moduli = np.concatenate((one * other / (one + other), at_zeros**2 * compliances))
    pairs = zip(moduli.tolist(), np.concatenate((every, retardation)).tolist(), strict=True)
    return Material(soft * stiff / (soft + stiff), 0.0, tuple(Branch(*pair) for pair in pairs))


class Chain:
    """The material as seen by one surface point, of K branches: plane moduli, times ``tau`` and ``theta``.

    ``stress_scale`` and ``lag_scale`` (K,), ``sqrt(E_j tau_j)`` and ``sqrt(J_k theta_k)``, make stresses and
    lags of stored variables; ``stress_rate`` and ``lag_rate``, the same over the times, are stored stress per
    ``w`` and stored lag per ``v``. Stored lags are ``rotation`` (K, K), ``Q``, @ stored stresses.
    """

    def __init__(self, material: Material, backward_euler: bool = False) -> None:
        plane = 1.0 - material.poisson**2
        moduli, times = material.spectrum
        compliances, retardation, distances = creep_spectrum(material.modulus, moduli, times)
        self.backward_euler = backward_euler
        self.relaxed = material.modulus / plane
        self.glassy = material.glassy_modulus / plane
        self.relaxation = times
        self.retardation = retardation
        self.compliances = plane * compliances
        self.stress_scale = np.sqrt(moduli / plane * times)
        self.stress_rate = self.stress_scale / times
        self.lag_scale = np.sqrt(self.compliances * self.retardation)
        self.lag_rate = self.lag_scale / self.retardation
        self.rotation = np.outer(self.lag_scale, self.stress_scale) / distances
        self.in_contact = lru_cache(_STEPS_KEPT)(self._in_contact)

    def __len__(self) -> int:
        return len(self.relaxation)

    def modulus_of_ramp(self, duration: float) -> float:
        """Plane modulus that a steady strain has met after a duration."""
        branches = self.stress_scale**2 / self.relaxation
        return self.relaxed + float(branches @ self.spread(duration / self.relaxation))

    def moduli_of_passage(self, time: Array, gained: tuple[Array, Array]) -> tuple[Array, Array]:
        """Plane moduli (m,) met by strains as ``1/sqrt(s)`` and ``sqrt(s)`` behind an edge, a time after it.

        ``gained`` is the part of each that has come, evenly, since the passage, beyond a steady edge's.
        """
        branches = self.stress_scale**2 / self.relaxation
        y = time[:, None] / self.relaxation
        root = np.sqrt(y)
        share = np.divide(dawsn(root), root, out=np.ones_like(root), where=root > 0.0)
        falling = 1.0 - 2.0 * y * share
        # what relaxes meanwhile of one that grows from nothing: int exp(-(T - s)/tau) (T - s) m(s) ds/(tau T)
        late = share - falling
        short = y < _SHORT
        rest = (1.0 - 0.5 * late - share) / np.where(short, 1.0, y)
        late_root = np.where(short, y * (4.0 - y * 16.0 / 7.0) / 15.0, rest)
        of_inverse_root, of_root = falling + gained[0][:, None] * late, share + gained[1][:, None] * late_root
        return self.relaxed + of_inverse_root @ branches, self.relaxed + of_root @ branches

    def share_to_meet(self, duration: float) -> float:
        """Share ``s'`` of a step at which a parabola through its ends has to meet a prescribed penetration.

        It misses by a multiple of ``s (1 - s) (s - s')``, which then leaves no stress in contact at the end.
        """
        y = duration / self.relaxation
        if not y.size:
            return 0.5
        once, twice = decaying_moments(y)
        weight = self.stress_scale**2 / self.relaxation * y
        return min(1.0 - float(weight @ twice) / float(weight @ once), _LATEST_SHARE)

    def _in_contact(self, duration: float) -> tuple[Array, Array, Array]:
        """Of stored stresses what is left, and what a rise and a bend of ``w`` leave in them, each (K,)."""
        y, rate = duration / self.relaxation, self.stress_rate
        return self.decay(y), rate * self.spread(y), rate * self.spread_bent(y)

    def decay(self, y: Array) -> Array:
        """What is left of an internal variable after ``y`` = step/time."""
        return 1.0 / (1.0 + y) if self.backward_euler else np.exp(-y)

    def spread(self, y: Array) -> Array:
        """Share of an increment spread evenly over a step that is still there at its end."""
        return 1.0 / (1.0 + y) if self.backward_euler else phi(y)

    def spread_bent(self, y: Array) -> Array:
        """As :meth:`spread`, of the increments of ``s (s - 1)`` over a share s of the step (sum 0)."""
        if self.backward_euler:
            return np.zeros_like(y)
        small = y * (1.0 / 6.0 - y * (1.0 / 12.0 - y * (1.0 / 40.0 - y / 180.0)))
        safe = np.maximum(y, 0.01)
        even = phi(safe)
        return np.where(y < 0.02, small, even - 2.0 * (even - np.exp(-safe)) / safe)

    def from_strains(self, strains: Array, load: Array) -> Array:
        """Stored variables (m, K) from Voigt strains ``e_k/sqrt(J_k theta_k)`` (m, K) and ``v`` (m,)."""
        return (load[:, None] * self.lag_rate - strains) @ self.rotation

    def to_strains(self, variables: Array, load: Array) -> Array:
        """Inverse of :meth:`from_strains`."""
        return load[:, None] * self.lag_rate - variables @ self.rotation.T
