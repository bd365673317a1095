"""Annuli that travel with the contact edge, and the one factorisation they need.

On the unit contact the borders are ``sn(K j/M)`` and the collocation radii ``sn(K (j + 1/2)/M)``, with the
Jacobi sine and its quarter period: even about the centre and about the edge, as the fields are. Steps of the
angle ``arcsin(r)`` shrink from the centre to the edge by the factor ``k'``, the complementary modulus; their
number is ``K(k) ~ log(4/k')`` over the step at the centre. With ``k' = 1``, where the process zone is long,
these are ``sin(pi j/2M)`` and ``sin(pi (j + 1/2)/2M)``. Because the kernel is scale-free one grid serves
every contact radius: the edge is continuous, the matrix is factorised once. The error of piecewise constant
pressure under an edge singularity is the same pattern on every grid, known from the flat punch, whose
pressure ``1/(pi sqrt(1 - x^2))`` and displacement ``(2/pi) arcsin(1/x)`` are exact: the singular part of
every solution is taken out with them, and annuli carry the rest. Unit plane modulus; lengths in contact
radii.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.linalg.lapack import dgetrf, dgetrs
from scipy.special import ellipj, ellipkm1

from bem_solver.kernel import annulus_influence

Array = NDArray[np.float64]

_PER_ANNULUS = 64
"""Entries per annulus of the table of their numbers over the angle: straight lines miss the number, whose
steps change by a tenth from annulus to annulus, by a millionth."""


def even_cubic(values: Array, position: Array) -> Array:
    """Cubic Lagrange interpolation of samples at half-integers, even about both ends.

    ``values`` (n,) stand at 0.5, 1.5, ...; ``position`` in [0, n], any shape.
    """
    padded = np.concatenate((values[1::-1], values, values[:-3:-1]))
    y = position + 1.5
    first = np.minimum(np.maximum(y.astype(int) - 1, 0), len(padded) - 4)
    return _lagrange(padded, first, y - first)


def _lagrange(samples: Array, first: NDArray[np.intp], z: Array) -> Array:
    """Cubic through ``samples[first .. first + 3]`` at offset ``z`` from the first."""
    z1, z2, z3 = z - 1.0, z - 2.0, z - 3.0
    return (
        -z1 * z2 * z3 / 6.0 * samples[first]
        + 0.5 * z * z2 * z3 * samples[first + 1]
        - 0.5 * z * z1 * z3 * samples[first + 2]
        + z * z1 * z2 / 6.0 * samples[first + 3]
    )


class Annuli:
    """Annuli on the unit contact, with the factorised influence matrix.

    Parameters
    ----------
    count : int
        Their number M.
    grading : float
        Step of the angle at the edge over that at the centre, ``0 < k' <= 1``.

    Attributes
    ----------
    borders : ndarray (M + 1,), radii, areas : ndarray (M,)
        Annulus borders, collocation radii and areas.
    matrix : ndarray (M, M)
        Displacement at the collocation radii under unit pressure on each annulus.
    """

    def __init__(self, count: int, grading: float = 1.0) -> None:
        self.count, self.grading = count, grading
        numbers = np.arange(count + 1.0)
        angle = self._angle(numbers)
        middle = 0.5 * (angle[1:] + angle[:-1]) if grading == 1.0 else self._angle(numbers[:-1] + 0.5)
        self.borders = np.sin(angle)
        self.radii = np.sin(middle)
        self.areas = np.pi * np.diff(self.borders**2)
        self.matrix = annulus_influence(self.radii, self.borders)
        self._factors, self._pivots, info = dgetrf(self.matrix)
        if info:  # cannot happen for distinct annuli
            raise ArithmeticError("the influence matrix is singular")
        # average of sqrt(1 - x^2) over an annulus of constant pressure
        self._weight = 0.5 * (np.cos(angle[1:]) + np.cos(angle[:-1]))
        self.punch = self.solve(np.ones(count))
        self._punch_density = np.pi * self._weight * self.punch
        offsets = (np.arange(3) + 0.5) ** 2
        self._edge_fit = np.linalg.inv(np.vander(offsets, 3, increasing=True))[0]
        # displacement outside, at the same angles arcsin(1/x); the far end, arcsin = 0, is zero
        self._outside = annulus_influence(1.0 / np.sin(angle[1:]), self.borders)
        if grading != 1.0:
            self._table_number = np.arange(_PER_ANNULUS * count + 1.0) / _PER_ANNULUS
            self._table_angle = self._angle(self._table_number)

    def _angle(self, number: Array) -> Array:
        """Angle ``arcsin(r)`` after a number of annuli from the centre."""
        if self.grading == 1.0:
            return 0.5 * np.pi * number / self.count
        return ellipj(ellipkm1(self.grading**2) * number / self.count, 1.0 - self.grading**2)[3]

    def position(self, angle: Array) -> Array:
        """Number of annuli between the centre and the radius ``sin(angle)``, inverse of the angle above."""
        if self.grading == 1.0:
            return angle * (2.0 * self.count / np.pi)
        return np.interp(angle, self._table_angle, self._table_number)

    def __reduce__(self) -> tuple[type[Annuli], tuple[int, float]]:
        """Kept as number and grading alone: matrix and factors are made anew, bit for bit."""
        return Annuli, (self.count, self.grading)

    def solve(self, displacement: Array) -> Array:
        """Pressures (M,) or (M, c) that produce the given displacements at the collocation radii."""
        return dgetrs(self._factors, self._pivots, displacement)[0]

    def density(self, pressure: Array) -> Array:
        """``q_j = p sqrt(1 - x^2)`` at the collocation angles, edge pattern taken out by the punch, (M,)."""
        return self._weight * pressure / self._punch_density

    def edge_strength(self, density: Array) -> float:
        """``kappa = pi q(edge)``: displacement of the flat punch with the same edge singularity."""
        return float(np.pi * (self._edge_fit @ density[:-4:-1]))

    def outside_field(self, pressure: Array, kappa: float) -> Array:
        """Samples of the outer displacement without its punch part, at the angles ``arcsin(1/x)`` of borders.

        Returns shape (M + 3,): far end (zero, and its odd continuation) to the edge.
        """
        inner = self._outside @ (pressure - kappa * self.punch)
        # odd about the far end (~1/x); about the edge the samples are continued by a cubic
        beyond = 4.0 * inner[-1] - 6.0 * inner[-2] + 4.0 * inner[-3] - inner[-4]
        return np.concatenate(([-inner[0], 0.0], inner, [beyond]))

    def outside(self, field: Array, kappa: float, ratio: Array) -> Array:
        """Surface displacement outside the contact.

        Parameters
        ----------
        field : ndarray (M + 3,)
            Samples of :meth:`outside_field`.
        kappa : float
            Displacement of the flat punch with the same edge singularity.
        ratio : ndarray (m,)
            ``r/a >= 1``.

        Returns
        -------
        ndarray (m,)
        """
        angle = np.arcsin(1.0 / ratio)
        y = self.position(angle) + 1.0
        first = np.minimum(np.maximum(y.astype(int) - 1, 0), len(field) - 4)
        return kappa * (2.0 / np.pi) * angle + _lagrange(field, first, y - first)
