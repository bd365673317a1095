"""Annuli that travel with the contact edge, and the one factorisation they need.

On the unit contact the borders are ``sn(K j/M)`` and the collocation radii ``sn(K (j + 1/2)/M)``, with the
Jacobi sine and its quarter period: even about the centre and about the edge, as the fields are. Steps of the
angle ``arcsin(r)`` shrink from the centre to the edge by the factor ``k'``, the complementary modulus; their
number is ``K(k) ~ log(4/k')`` over the step at the centre. With ``k' = 1``, where the process zone is long,
these are ``sin(pi j/2M)`` and ``sin(pi (j + 1/2)/2M)``. Because the kernel is scale-free one grid serves
every contact radius: the edge is continuous, the matrix is factorised once. The singular part of every
solution is that of the flat punch, whose pressure ``1/(pi sqrt(1 - x^2))`` and displacement ``(2/pi)
arcsin(1/x)`` are exact, and annuli carry the rest. What they miss of a profile ``x^n``, that of the indenter,
is known as well (``PowerContact``), and is added as far as a solution holds it. Unit plane modulus; lengths
in contact radii.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.linalg.lapack import dgetrf, dgetrs
from scipy.special import ellipe, ellipj, ellipkm1, gamma, hyp2f1

Array = NDArray[np.float64]


def disc_displacement(radius: ArrayLike, disc: ArrayLike) -> Array:
    """Surface displacement at ``radius`` under unit pressure on a disc of radius ``disc`` (Eq. Kernel).

    ``K(r, c) = 4 c E(r/c)/pi`` for r <= c and ``4 r [E(c/r) - (1 - (c/r)^2) K(c/r)]/pi`` outside, with the
    complete elliptic integrals of the modulus. Arguments are broadcast; zero for a disc of radius zero.
    """
    r, c = np.broadcast_arrays(np.asarray(radius, float), np.asarray(disc, float))
    outside = r > c
    large = np.where(outside, r, c)
    k = np.divide(np.where(outside, c, r), large, out=np.zeros(r.shape), where=large > 0)
    complement = (1.0 - k) * (1.0 + k)
    # (1 - k^2) K(k) -> 0 at k = 1, where K itself is infinite
    product = complement * ellipkm1(np.where(complement > 0, complement, 1.0))
    value = 4.0 / np.pi * large * (ellipe(1.0 - complement) - np.where(outside, product, 0.0))
    return np.where(c > 0, value, 0.0)


def annulus_influence(radius: Array, borders: Array) -> Array:
    """Displacement at each ``radius`` (m,) under unit pressure on each annulus (Eq. Ghq), shape (m, n).

    ``borders`` (n + 1,) rise from 0; annulus q lies between ``borders[q]`` and ``borders[q + 1]``.
    """
    return np.diff(disc_displacement(radius[:, None], borders[None, :]), axis=1)


def even_cubic(values: Array, position: Array) -> Array:
    """Cubic Lagrange interpolation of samples at half-integers, even about both ends."""
    padded = np.concatenate((values[1::-1], values, values[:-3:-1]))
    return interpolated(divided_differences(padded), position + 1.5)


def cubic_weights(z: Array) -> Array:
    """Lagrange's weights (4, m) at ``z`` (m,) of the cubic through samples at 0, 1, 2 and 3."""
    one, two, three = z - 1.0, z - 2.0, z - 3.0
    return np.array(
        (-one * two * three / 6.0, z * two * three / 2.0, -z * one * three / 2.0, z * one * two / 6.0)
    )


def divided_differences(samples: Array) -> Array:
    """Of the cubics through four neighbouring samples each, in Newton's form."""
    first = samples[1:] - samples[:-1]
    second = 0.5 * (first[1:] - first[:-1])
    third = (second[1:] - second[:-1]) / 3.0
    return np.array((samples[:-3], first[:-2], second[:-1], third))


def interpolated(table: Array, position: Array) -> Array:
    """The cubics of :func:`divided_differences` at positions among the samples, which stand at 0, 1, ..."""
    first = np.minimum(np.maximum(position.astype(np.intp) - 1, 0), table.shape[1] - 1)
    z = position - first
    # clipped: all indices are in range, and to check them takes three times as long
    value, slope, second, third = table.take(first, axis=1, mode="clip")
    return value + z * (slope + (z - 1.0) * (second + (z - 2.0) * third))


_PER_ANNULUS = 64
"""Entries per annulus of the table of their numbers over the angle: straight lines miss the number, whose
steps change by a tenth from annulus to annulus, by a millionth."""

_POINTS_OF_MEAN = 4
"""Gauss points of a mean over an annulus, exact for the seventh power of the angle: cubics times an area."""


@dataclass(frozen=True)
class PowerContact:
    """A contact under the displacement ``x^exponent``, exactly; unit contact, unit plane modulus.

    By Abel's transform it is held by discs of the weights ``G t^n``, with ``G = sqrt(pi) Gamma(n/2 +
    1)/Gamma((n + 1)/2)`` (Sneddon).
    """

    exponent: float

    @property
    def kappa(self) -> float:
        """Displacement of the flat punch with the same edge singularity, ``G``."""
        n = self.exponent
        return float(math.sqrt(math.pi) * gamma(0.5 * n + 1.0) / gamma(0.5 * n + 0.5))

    @property
    def force(self) -> float:
        """Compressive force."""
        return 2.0 * self.kappa / (self.exponent + 1.0)

    def density(self, radius: Array) -> Array:
        """Pressure times ``sqrt(1 - x^2)`` at radii 0 < x < 1."""
        n, root = self.exponent, np.sqrt(1.0 - radius**2)
        inner = radius ** (n - 2.0) * hyp2f1(0.5, 1.0 - 0.5 * n, 1.5, -((root / radius) ** 2))
        return self.kappa / np.pi * (1.0 - n * root**2 * inner)

    def outside(self, radius: Array) -> Array:
        """Displacement at radii >= 1."""
        n = self.exponent
        spread = hyp2f1(0.5, 0.5 * (n + 1.0), 0.5 * (n + 3.0), radius**-2.0)
        return 2.0 / np.pi * self.kappa / (n + 1.0) * spread / radius


class Annuli:
    """``count`` annuli on the unit contact, with the factorised influence ``matrix`` (M, M).

    ``grading``, ``0 < k' <= 1``, is the step of the angle at the edge over that at the centre, ``exponent``
    that of the profile for which the annuli are exact, ``outermost`` the distance of the last collocation
    radius from the edge.
    """

    def __init__(self, count: int, grading: float = 1.0, exponent: float = 2.0) -> None:
        self.count, self.grading, self.exponent = count, grading, exponent
        numbers = np.arange(count + 1.0)
        angle = self._angle(numbers)
        self.borders, self.radii = np.sin(angle), np.sin(self._angle(numbers[:-1] + 0.5))
        self.outermost = 1.0 - float(self.radii[-1])
        self.areas = np.pi * np.diff(self.borders**2)
        self.matrix = annulus_influence(self.radii, self.borders)
        self._factors, self._pivots, info = dgetrf(self.matrix)
        if info:  # cannot happen for distinct annuli
            raise ArithmeticError("the influence matrix is singular")
        self.punch = self.solve(np.ones(count))
        self._per_pressure = 1.0 / (np.pi * self.punch)
        offsets = (np.arange(3) + 0.5) ** 2
        self._edge_fit = np.linalg.inv(np.vander(offsets, 3, increasing=True))[0]
        self._averages = self._area_averages()
        # displacement outside, at the same angles arcsin(1/x); the far end, arcsin = 0, is zero
        self._outside = annulus_influence(1.0 / np.sin(angle[1:]), self.borders)
        self._outside_punch = self._outside @ self.punch
        self._calibrate(PowerContact(exponent), 1.0 / np.sin(angle[1:]))
        self._table_number = np.arange(_PER_ANNULUS * count + 1.0) / _PER_ANNULUS
        self._table_angle = self._angle(self._table_number)

    def _angle(self, number: Array) -> Array:
        """Angle ``arcsin(r)`` after a number of annuli from the centre."""
        return self._jacobi(number)[3]

    def _jacobi(self, number: Array) -> tuple[Array, Array, Array, Array]:
        """Jacobi's functions sn, cn, dn and am after a number of annuli from the centre."""
        return ellipj(ellipkm1(self.grading**2) * number / self.count, 1.0 - self.grading**2)

    def _area_averages(self) -> Array:
        """Means (M, M) over the areas of the annuli of a field at the collocation radii, by even cubics."""
        share, weight = np.polynomial.legendre.leggauss(_POINTS_OF_MEAN)
        number = np.arange(float(self.count))[:, None] + 0.5 * (1.0 + share)
        angle = self._angle(number)
        weight = (
            weight * np.sin(2.0 * angle) * self._jacobi(number)[2]
        )  # d(area) over d(number), but for a factor
        weight /= weight.sum(axis=1, keepdims=True)
        index, parts = self.cubic_shares(number.ravel())
        means = np.zeros((self.count, self.count))
        rows = np.repeat(np.arange(self.count), _POINTS_OF_MEAN)
        np.add.at(means, (rows, index), parts * weight.ravel())
        return means

    def position(self, angle: Array) -> Array:
        """Number of annuli between the centre and the radius ``sin(angle)``, inverse of the angle above."""
        return np.interp(angle, self._table_angle, self._table_number)

    def position_at(self, distance: Array, edge: float) -> Array:
        """Number of annuli between the centre and a ``distance`` inside a contact of radius ``edge``."""
        cosine = np.sqrt(distance * (2.0 * edge - distance)) / edge
        from_edge = np.arcsin(np.minimum(cosine, 1.0))
        return np.minimum(self.position(0.5 * np.pi - from_edge), float(self.count))

    def cubic_shares(self, position: Array) -> tuple[NDArray[np.intp], Array]:
        """Annuli (4, m) that :func:`even_cubic` reads at positions (m,), and the weight of each."""
        first = np.minimum(np.maximum((position + 0.5).astype(int), 0), self.count)
        weight = cubic_weights(position + 1.5 - first)
        index = first + np.arange(-2, 2)[:, None]
        index = np.where(index < 0, -1 - index, index)
        return np.where(index >= self.count, 2 * self.count - 1 - index, index), weight

    def number_within(self, share: float) -> float:
        """Number of annuli within a share of the radius inside the edge."""
        return self.count - float(self.position(np.array(np.arcsin(1.0 - share))))

    def _calibrate(self, shape: PowerContact, outside: Array) -> None:
        """What annuli miss of a displacement ``x^n`` inside and at radii ``outside`` (M,); how it is read.

        How much of it a pressure holds is read in the interior, where fields are smooth; of the punch there
        reads none.
        """
        profile = self.radii**shape.exponent
        pressure = self.solve(profile)
        reading = self.areas * (1.0 - self.radii**2)
        reading *= profile - float(reading @ profile) / float(reading.sum())
        self._reading = reading / float(reading @ (self._per_pressure * pressure))
        self._missed_density = shape.density(self.radii) - self._per_pressure * pressure
        found = 2.0 * shape.kappa + float(self.areas @ (pressure - shape.kappa * self.punch))
        self._missed_force = shape.force - found
        punch = shape.kappa * (2.0 / np.pi * np.arcsin(1.0 / outside) - self._outside_punch)
        self._missed_outside = shape.outside(outside) - punch - self._outside @ pressure

    def curvature(self, pressure: Array) -> float:
        """How much of the displacement ``x^n`` there is in pressures (M,)."""
        return float(self._reading @ (self._per_pressure * pressure))

    def curvatures_at_edge(self, pressure: Array, kappa: Array) -> Array:
        """The same (c,) of pressures (M, c) whose edge singularities ``kappa`` are known: it shows there."""
        found = np.pi * (self._edge_fit @ (self._per_pressure * pressure.T).T[:-4:-1])
        return (kappa - found) / self.edge_strength(self._missed_density)

    def solve(self, displacement: Array) -> Array:
        """Pressures (M,) or (M, c) that produce the given displacements at the collocation radii."""
        return dgetrs(self._factors, self._pivots, displacement)[0]

    def force(self, pressure: Array, kappa: float, curvature: float) -> float:
        """Force of pressures (M,), exact for the punch, whose part in it is ``2 kappa``, and the profile."""
        missed = self._missed_force * curvature
        return float(2.0 * kappa + self.areas @ (pressure - kappa * self.punch)) + missed

    def work(self, pressure: Array, displacement: Array) -> Array:
        """``int p g`` of pressures (M,) and smooth fields g (M, ...) at the collocation radii, shape (...).

        The pressure of an annulus meets the mean of g over it: the error is of third order in the annuli.
        """
        return (self.areas * pressure) @ self._averages @ displacement

    def work_weights(self, displacement: Array) -> Array:
        """What makes that of pressures: ``int p g = pressure @ weights``."""
        return self.areas[:, None] * (self._averages @ displacement)

    def density(self, pressure: Array, curvature: float) -> Array:
        """``q_j = p sqrt(1 - x^2)`` at the collocation angles, (M,), exact for the punch and the profile."""
        return self._per_pressure * pressure + curvature * self._missed_density

    def edge_strength(self, density: Array) -> float:
        """``kappa = pi q(edge)``: displacement of the flat punch with the same edge singularity."""
        return float(np.pi * (self._edge_fit @ density[:-4:-1]))

    def outside_field(self, pressure: Array, kappa: float, curvature: float) -> Array:
        """Cubics (4, M) of the outer displacement without its punch part, over the angle ``arcsin(1/x)``.

        Between borders, from the far end to the edge.
        """
        samples = np.zeros(self.count + 3)
        samples[2:-1] = self._outside @ pressure - kappa * self._outside_punch
        samples[2:-1] += curvature * self._missed_outside
        samples[0] = -samples[2]  # odd about the far end (~1/x); about the edge continued by a cubic
        fourth, third, second, last = samples[-5:-1].tolist()
        samples[-1] = 4.0 * last - 6.0 * second + 4.0 * third - fourth
        return divided_differences(samples)

    def at_edge(self, field: Array, kappa: float) -> float:
        """Surface displacement at the edge: two samples into the last cubic of ``field``."""
        value, slope, second, _ = field[:, -1].tolist()
        return float(kappa + value + 2.0 * (slope + second))

    def outside(self, field: Array, kappa: float, ratio: Array) -> Array:
        """Surface displacement outside the contact at ratios ``r/a >= 1`` (m,), from cubics of the field."""
        angle = np.arcsin(1.0 / ratio)
        return kappa * (2.0 / np.pi) * angle + interpolated(field, self.position(angle) + 1.0)
