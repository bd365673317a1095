"""A layer of finite thickness: the half-space and a smooth correction of low rank.

Under pressures with the transform ``q`` the surface of an elastic layer goes down by the transform ``w``,

    E* w = q - M q,    M(x, s) = 2/(pi h) int_0^inf (1 - K(t)) cos(t x/h) cos(t s/h) dt;

``K`` is its transfer function over that of the half-space. With ``w^ = w + L`` and ``L = sum_j C_j P_j(x)``,
``E* C`` being the coefficients of ``M q``, the *image* ``w^`` is what a half-space would show under the same
pressures: ``q = E* w^``. In contact ``w^ = phi . (D, C) - G`` with ``phi = (1, P_1, ... P_K)``. So the
penetration is a vector, and a layer a half-space under an indenter that changes with the load; a half-space
is one without functions.

The ``P_j`` are the principal axes of ``M``, told by Chebyshev's polynomials of ``x^2`` up to a length that
no radius reaches. ``M`` is entire in both squares: to 1e-10 it has 7 of them if that length is the thickness,
12 if it is twice as long.
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
"""Part of ``q`` by which ``M q`` changes where a function or a polynomial is left out."""


@dataclass(frozen=True, eq=False)
class Image:
    """``M = phi . coupling phi`` at radii up to ``reach``; row and column 0 of ``coupling`` are zero.

    ``axes`` (c, K): the functions as series of Chebyshev in the square of the radius.
    """

    reach: float
    coupling: Array
    axes: Array

    @property
    def is_layer(self) -> bool:
        """Whether the image is not the surface itself."""
        return len(self.coupling) > 1

    def functions(self, x: Array) -> Array:
        """``phi`` (m, K + 1) at radii (m,), by ``T_n(2 y^2 - 1) = cos(2 n arccos y)``."""
        phi = np.ones((len(x), len(self.coupling)))
        if self.is_layer:
            angle = 2.0 * np.arccos(np.minimum(x / self.reach, 1.0))
            phi[:, 1:] = np.cos(np.outer(angle, np.arange(len(self.axes)))) @ self.axes
        return phi


HALF_SPACE = Image(math.inf, np.zeros((1, 1)), np.zeros((0, 0)))


def image(layer: contact_scene.Layer, poisson_ratio: float, reach: float) -> Image:
    """That of a layer, for radii up to ``reach``."""
    h = layer.thickness
    order = 12 + math.ceil(8.0 * reach / h)
    knots, series = chebyshev_series(order)
    t, weights = gauss(60 + math.ceil(LONGEST_WAVE * reach / h))
    t, weights = LONGEST_WAVE * t, LONGEST_WAVE * weights
    lacks = 2.0 / (math.pi * h) * weights * (1.0 - transfer(t, poisson_ratio, layer.base))
    waves = series @ np.cos(np.outer(reach / h * np.sqrt(0.5 * (1.0 + knots)), t))
    coefficients = (waves * lacks) @ waves.T
    told = int((np.abs(coefficients).max(axis=1) * reach > NEGLIGIBLE).nonzero()[0].max(initial=0)) + 1
    strengths, axes = np.linalg.eigh(coefficients[:told, :told])
    kept = np.abs(strengths) * reach > NEGLIGIBLE
    return Image(reach, np.diag(np.append(0.0, strengths[kept])), axes[:, kept])
