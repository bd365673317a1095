"""Stress and displacement under axisymmetric contacts in closed form: punch, Hertz, JKR, cone.

I.N. Sneddon, Proc. Camb. Phil. Soc. 44, 492 (1948) (punch); M.T. Huber, Ann. Phys. 14, 153 (1904) (sphere);
K.L. Johnson, *Contact Mechanics* (1985), sections 3.4, 4.2, 5.5 (sphere with adhesion: Hertz minus punch).
All are one formula here. A frictionless load ``p(r) = int P(k) J0(k r) k dk`` on the half-space leaves

    2G u_r = -(1 - 2 nu) C0 + s C1,    2G w = 2 (1 - nu) B0 + s A0    (w downwards, depth s = -z),
    s_zz = -A0 - s A1,    s_rr = -A0 + s A1 + c/r,    s_tt = -2 nu A0 - c/r,    s_rz = s C2,

    c = (1 - 2 nu) C0 - s C1,    B0, A0, A1 = int P (1, k, k^2) exp(-k s) J0(k r) dk,    C likewise with J1.

With the Abel density ``q`` of the load (``E* (D - G(x))`` in ``x < a``; :mod:`validation.reference.sneddon`),
``P(k) = (1/pi) int_0^a q(x) cos(k x) dx``: each x adds a harmonic function of complex depth ``s + i x``, e.g.

    B0 = (1/pi) Re int_0^a q(x)/sqrt(r^2 + Z^2) dx,    Z = s + i x.

With ``R^2 = r^2 + Z^2``, ``Re R > 0``, the Laplace transforms of the Bessel functions form two ladders,

    T_n = int_0^inf k^-n exp(-k Z) J0(k r) dk,    S_n = int_0^inf k^-n exp(-k Z) J1(k r) dk,

    T_-1 = Z/R^3,  T_0 = 1/R,  T_1 = -L,  T_2 = Z L - R,  T_3 = 3 Z R/4 - (Z^2/2 - r^2/4) L,
    S_-1/r = 1/R^3,  S_0/r = 1/(R (R + Z)),  S_1/r = 1/(R + Z),  S_2/r = -[L + Z/(R + Z)]/2,
    S_3/r = [Z L - R + (R^2 + R Z + Z^2)/(3 (R + Z))]/2,    L = log(R + Z).

From ``n = 1`` (``n = 2``) on the integrals diverge at ``k = 0``; the functions given are the ones with
``dT_n/dZ = -T_(n-1)``, ``dS_n/dZ = -S_(n-1)``, and what they leave open drops out between two ends of a load.
For a ``q`` made of parabolas this is done by parts, as only jumps of ``q, q', q''`` (left minus right) count:

    int q T_n dx = sum over jumps of  i [q] T_(n+1) + [q'] T_(n+2) - i [q''] T_(n+3),    likewise for S.

``q`` is one such piece for a flat punch (constant), a cone (linear) and a sphere (quadratic, any ``D``).
Coordinates (r, z), the body in ``z <= 0``, displacement along them; stress positive in tension, components
``(rr, zz, tt, rz)``. Round-off in the stress stays near 1e-15 of the pressure, out to a thousand ``a``.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from contact_scene import Cone, FlatPunch, Indenter, Sphere
from validation.reference import sneddon

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]

_SHALLOWEST = 1e-12
"""Least depth of a point, in contact radii: the stress at the edge of a punch stays finite."""
_PIECES = 256
"""Parabolas that interpolate the density under a profile without closed form."""


@dataclass(frozen=True)
class Field:
    """``stress`` (4, ...): rr, zz, tt, rz, tension positive; ``displacement`` (2, ...): along r and z."""

    stress: Array
    displacement: Array


@dataclass(frozen=True)
class Density:
    """Abel density made of parabolas, zero beyond the last knot.

    Piece j is ``sum_m coefficients[j, m] (x - knots[j])^m`` between ``knots[j]`` and ``knots[j + 1]``.
    ``knots`` (n + 1,) rise from 0, ``coefficients`` (n, 3); force per length.
    """

    knots: Array
    coefficients: Array

    @property
    def jumps(self) -> Array:
        """Left minus right limits of ``q, q', q''`` at the knots, shape (n + 1, 3).

        ``q`` is even in x, so at 0 only the slope jumps; the others drop out as imaginary.
        """
        c0, c1, c2 = self.coefficients.T
        h = np.diff(self.knots)
        left = np.stack([c0 + h * (c1 + h * c2), c1 + 2.0 * h * c2, 2.0 * c2], axis=1)
        right = np.stack([c0, c1, 2.0 * c2], axis=1)
        none = np.zeros((1, 3))
        jumps = np.concatenate([none, left]) - np.concatenate([right, none])
        jumps[0, [0, 2]] = 0.0
        return jumps

    def field(self, r: ArrayLike, z: ArrayLike, plane_modulus: float, poisson: float) -> Field:
        """Stress and displacement at points ``(r, z)``, ``r >= 0``, ``z <= 0``; shapes are broadcast.

        Points within 1e-12 contact radii of the surface are evaluated that deep, which keeps the
        values at the edge of a punch, where the stress is infinite, finite.
        """
        r, z = np.broadcast_arrays(np.asarray(r, float), np.asarray(z, float))
        if np.any(z > 0.0) or np.any(r < 0.0):
            raise ValueError("the body is in r >= 0, z <= 0")
        a = float(self.knots[-1])
        r, s = r / a, np.maximum(-z / a, _SHALLOWEST)
        # the lengths of q' and q'' and of the integral are contact radii too
        b0, a0, a1, c0, c1, c2 = self._potentials(r, s, a)
        twice_shear = plane_modulus * (1.0 - poisson)
        compressible = 1.0 - 2.0 * poisson
        ring = compressible * c0 - s * c1
        stress = np.stack([-a0 + s * a1 + ring, -a0 - s * a1, -2.0 * poisson * a0 - ring, s * r * c2]) / a
        moved = np.stack([-r * ring, -2.0 * (1.0 - poisson) * b0 - s * a0]) / twice_shear
        return Field(stress, moved)

    def _potentials(self, r: Array, s: Array, a: float) -> Array:
        """``B0, A0, A1, C0/r, C1/r, C2/r`` at points in contact radii, shape (6, ...)."""
        total = np.zeros((6, *r.shape))
        for knot, jump in zip(self.knots / a, self.jumps * (1.0, a, a**2), strict=True):
            if not jump.any():
                continue
            weights = jump * (1j, 1.0, -1j) / np.pi
            even, odd = _ladders(r, s, float(knot))
            for order, weight in enumerate(weights):
                if weight != 0.0:  # an absent jump must not meet its singularity
                    for row in range(3):
                        total[row] += (weight * even[2 - row + order]).real
                        total[3 + row] += (weight * odd[2 - row + order]).real
        return total


def density(indenter: Indenter, contact_radius: float, penetration: float, plane_modulus: float) -> Density:
    """``q = E* (D - G(x))`` of any indenter held at contact radius and penetration.

    Exact for flat punch, cone and sphere; other shapes are interpolated by 256 parabolas.
    """
    exact = isinstance(indenter, FlatPunch | Cone | Sphere)

    def q(x: Array) -> Array:
        return plane_modulus * (penetration - sneddon.depth(indenter, x))

    held = through(q, contact_radius, 1 if exact else _PIECES)
    if not isinstance(indenter, Sphere) and exact:
        held.coefficients[:, 2] = 0.0  # instead of its round-off
    return held


def through(q: Callable[[Array], Array], contact_radius: float, count: int = _PIECES) -> Density:
    """Parabolas through ``q`` at the ends and in the middle of pieces that shrink towards both ends."""
    knots = float(contact_radius) * np.sin(0.5 * np.pi * np.arange(count + 1) / count) ** 2
    h = np.diff(knots)
    q0, q1, q2 = (q(knots[:-1] + part * h) for part in (0.0, 0.5, 1.0))
    curvature = 2.0 * (q2 - 2.0 * q1 + q0) / h**2
    return Density(knots, np.stack([q0, (q2 - q0) / h - curvature * h, curvature], axis=1))


def contact(
    r: ArrayLike,
    z: ArrayLike,
    indenter: Indenter,
    contact_radius: float,
    penetration: float,
    plane_modulus: float,
    poisson: float,
) -> Field:
    """Field at points ``(r, z)`` under any indenter held at contact radius and penetration, adhesive or not.

    Of the broadcast shape of radii ``r >= 0`` and heights ``z <= 0``.
    """
    held = density(indenter, contact_radius, penetration, plane_modulus)
    return held.field(r, z, plane_modulus, poisson)


def _ladders(r: Array, depth: Array, x: float) -> tuple[list[Complex], list[Complex]]:
    """``[T_-1 .. T_3]`` and ``[S_-1/r .. S_3/r]`` at ``depth + i x``."""
    z = depth + 1j * x
    # not r^2 + Z^2, which loses the distance from the circle r = x
    root = np.sqrt((r - x) * (r + x) + depth**2 + 2j * depth * x)
    total = root + z
    log = np.log(total)
    even = [
        z / root**3,
        1.0 / root,
        -log,
        z * log - root,
        0.75 * z * root - (0.5 * z**2 - 0.25 * r**2) * log,
    ]
    odd = [
        1.0 / root**3,
        1.0 / (root * total),
        1.0 / total,
        -0.5 * (log + z / total),
        0.5 * (z * log - root + (root**2 + root * z + z**2) / (3.0 * total)),
    ]
    return even, odd
