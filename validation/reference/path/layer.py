"""A layer of finite thickness: the half-space and a smooth correction of low rank.

Under pressures with the transform ``q`` the surface of an elastic layer goes down by the transform ``w``,

    E* w = q - M q,    M(x, s) = 2/(pi h) int_0^inf (1 - K(t)) cos(t x/h) cos(t s/h) dt;

``K`` is its transfer function over that of the half-space. With ``w^ = w + L`` and ``L = sum_j C_j P_j(x)``,
``E* C`` being the coefficients of ``M q``, the *image* ``w^`` is what a half-space would show under the same
pressures: ``q = E* w^``. In contact ``w^ = phi . (D, C) - G`` with ``phi = (1, P_1, ... P_K)``. So the
penetration is a vector, and a layer a half-space under an indenter that changes with the load; a half-space
is one without functions.

The ``P_j`` are Chebyshev's polynomials of ``x^2`` up to a length that no radius reaches. ``M`` is entire in
both squares: 10 of them tell it to 1e-10 if that length is the thickness, 16 if it is twice as long.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

import contact_scene
from validation.reference.elastic_layer import transfer
from validation.reference.path.numerics import chebyshev_series, gauss

Array = NDArray[np.float64]

LONGEST_WAVE = 20.0
"""Argument beyond which ``1 - K`` is left out: it falls as ``t^2 exp(-2 t)``."""
NEGLIGIBLE = 1e-10
"""Part of ``q`` by which ``M q`` changes where a function is left out."""


@dataclass(frozen=True, eq=False)
class Image:
    """``M = phi . coupling phi`` at radii up to ``reach``; row and column 0 of ``coupling`` are zero."""

    reach: float
    coupling: Array

    @property
    def is_layer(self) -> bool:
        """Whether the image is not the surface itself."""
        return len(self.coupling) > 1

    def functions(self, x: Array) -> Array:
        """``phi`` (m, K + 1) at radii (m,)."""
        phi = np.ones((len(self.coupling), len(x)))
        if len(phi) > 2:
            phi[2] = 2.0 * (x / self.reach) ** 2 - 1.0
            twice = 2.0 * phi[2]
        for j in range(3, len(phi)):
            np.multiply(twice, phi[j - 1], out=phi[j])
            phi[j] -= phi[j - 2]
        return phi.T


HALF_SPACE = Image(math.inf, np.zeros((1, 1)))


def image(layer: contact_scene.Layer, poisson_ratio: float, reach: float) -> Image:
    """That of a layer, for radii up to ``reach``."""
    h = layer.thickness
    order = 12 + math.ceil(8.0 * reach / h)
    knots, series = chebyshev_series(order)
    t, weights = gauss(60 + math.ceil(20.0 * reach / h))
    t, weights = LONGEST_WAVE * t, LONGEST_WAVE * weights
    lacks = 2.0 / (math.pi * h) * weights * (1.0 - transfer(t, poisson_ratio, layer.base))
    waves = series @ np.cos(np.outer(reach / h * np.sqrt(0.5 * (1.0 + knots)), t))
    coefficients = (waves * lacks) @ waves.T
    count = int((np.abs(coefficients).max(axis=1) * reach > NEGLIGIBLE).nonzero()[0].max(initial=0)) + 1
    coupling = np.zeros((count + 1, count + 1))
    coupling[1:, 1:] = coefficients[:count, :count]
    return Image(reach, coupling)
