"""The body under the surface: a half-space, or a layer on a rigid base, which is less compliant.

What a layer lacks of the half-space's displacement under a pressure is smooth: ``N p = sum_k f_k int p f_k
dA/(2 pi)``, with few fields f_k for pressures within a ``reach`` (equations: the page on boundary elements in
the explanation). Lengths in scene units.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field
from functools import lru_cache

import numpy as np
from numpy.polynomial.legendre import leggauss
from numpy.typing import NDArray
from scipy.special import j0

from bem_solver.annuli import Annuli, cubic_weights, divided_differences, interpolated
from contact_scene import Layer, Scene

Array = NDArray[np.float64]

_LAST = 18.0
"""Transform variable t at which the integrals end: ``1 - K`` is below 1e-12 of its largest value there."""
_NODES, _NODES_PER_LENGTH = 40, 5.0
"""Gauss's nodes for 1 - K itself, and per thickness of the distance over which J0 oscillates: half as many as
the radians of ``t r/h`` over half the range, and a tenth more."""
_NEGLIGIBLE = 1e-14
"""Part of the half-space's compliance that is rounding."""
_PER_THICKNESS = 64
"""Entries of the table of fields per thickness: the cubics between them miss 1e-8 of N."""
_BEYOND = 20.0
"""Distance from the contact, in thicknesses, from which on a layer does not move. Its displacement falls as
``exp(-2.1 r/h)``, that of an incompressible one as a hundredth of ``exp(-0.74 r/h)``."""
_SHORTEST_REACH = 0.25
"""Shortest reach, in thicknesses: for smaller contacts there is hardly less to keep."""
_EDGES_KEPT = 8
"""Edges whose response is kept: more than are tried at a time."""


@dataclass(frozen=True)
class ContactUnderFields:
    """A contact under each of the fields (M, K), on unit annuli: scaled pressures (M, K).

    ``weights`` (M, K) make moments of scaled pressures; ``inverse`` (K, K) those under the body of those
    under the half-space. ``curvatures`` (K,) are their ``Annuli.curvature``, as their edge
    singularities have it. A flat punch of that radius is stiffer by the factor ``stiffness``.
    """

    pressures: Array
    weights: Array
    inverse: Array
    curvatures: Array
    stiffness: float


@dataclass(frozen=True)
class SmoothPart:
    """``N p = sum_k f_k c_k`` with the moments ``c_k = int p f_k dA/(2 pi)`` of pressures within a reach.

    ``fields`` (n, K) are the ``f_k`` at multiples of the ``spacing``, from minus one on, and ``transforms``
    (n', K) Abel's transforms of them within the reach: displacements of the punches of the same edge.
    """

    spacing: float
    fields: Array
    transforms: Array
    _responses: dict[tuple[Annuli, float], ContactUnderFields] = field(
        default_factory=dict, compare=False, repr=False
    )

    def _at(self, table: Array, radius: Array) -> Array:
        """Entries (m, K) of a table at radii (m,) within the reach."""
        position = radius / self.spacing
        first = position.astype(np.intp)
        weights = cubic_weights(position - first + 1.0)
        return sum(weights[n][:, None] * table[first + n] for n in range(4))

    def taken_from(self, load: Array, radius: Array, moments: Array) -> Array:
        """The half-space's displacement outside a contact (m,) less this part: all of it, far away."""
        if not self.fields.shape[1]:  # the half-space
            return load
        position = radius / self.spacing + 1.0
        taken = interpolated(divided_differences(self.fields @ moments), position)
        return np.where(position < len(self.fields) - 2.0, load - taken, 0.0)

    def response(self, annuli: Annuli, edge: float) -> ContactUnderFields:
        """Of a contact of some radius > 0 within the reach."""
        key = annuli, edge if self.fields.shape[1] else 0.0
        if key not in self._responses:
            if len(self._responses) >= _EDGES_KEPT:
                self._responses.clear()
            fields = self._at(self.fields, edge * annuli.radii)
            pressures, weights = annuli.solve(fields), edge / (2.0 * np.pi) * annuli.work_weights(fields)
            inverse = np.asarray(np.linalg.inv(np.eye(self.fields.shape[1]) - weights.T @ pressures), float)
            forces = annuli.areas @ pressures  # by reciprocity 2 pi times the moments of the punch
            stiffness = 1.0 + 0.25 * edge / np.pi * float(forces @ inverse @ forces)
            (kappas,) = self._at(self.transforms, np.array([edge]))
            curvatures = annuli.curvatures_at_edge(pressures, kappas)
            self._responses[key] = ContactUnderFields(pressures, weights, inverse, curvatures, stiffness)
        return self._responses[key]


@dataclass(frozen=True)
class Compliance:
    """That of a layer, or of a half-space; ``lacking`` is ``1 - K(t)``."""

    layer: Layer | None
    lacking: Callable[[Array], Array]
    _parts: dict[float, SmoothPart] = field(default_factory=dict, compare=False, repr=False)

    @classmethod
    def of(cls, scene: Scene) -> Compliance:
        """The body of a scene."""
        if scene.body is None:
            return HALF_SPACE
        return _layer(scene.body, scene.material.poisson)

    @property
    def thickness(self) -> float:
        """Its thickness."""
        return self.layer.thickness if self.layer is not None else math.inf

    @property
    def largest(self) -> float:
        """Radius of the largest contact that is taken."""
        return self.layer.largest_contact if self.layer is not None else math.inf

    def within(self, edge: float) -> SmoothPart:
        """For contacts of a radius: of the next reach in powers of two of the thickness."""
        ratio = max(edge / self.thickness, _SHORTEST_REACH)
        mantissa, exponent = math.frexp(ratio)
        reach = math.ldexp(1.0, exponent - (mantissa == 0.5))
        if reach not in self._parts:
            self._parts[reach] = self._reaching(reach)
        return self._parts[reach]

    def _reaching(self, reach: float) -> SmoothPart:
        """Of a reach in thicknesses."""
        far = reach + _BEYOND
        node, weight = leggauss(math.ceil(_NODES + _NODES_PER_LENGTH * (far + reach)))
        t = 0.5 * _LAST * (node + 1.0)
        strength = np.sqrt(_LAST * weight * self.lacking(t))
        place, share = leggauss(math.ceil(_NODES + 2.0 * _NODES_PER_LENGTH * reach))
        waves = np.cos(np.outer(0.5 * reach * (place + 1.0), t)) * strength
        _, size, axes = np.linalg.svd(
            waves * np.sqrt(reach * share / (2.0 * np.pi))[:, None], full_matrices=False
        )
        kept = axes[size**2 > _NEGLIGIBLE].T
        radius = np.arange(-1.0, math.ceil(far * _PER_THICKNESS) + 2.0) / _PER_THICKNESS
        strength /= math.sqrt(self.thickness)
        fields = (j0(np.outer(radius, t)) * strength) @ kept
        inside = radius[: math.ceil(reach * _PER_THICKNESS) + 4]
        transforms = (np.cos(np.outer(inside, t)) * strength) @ kept
        return SmoothPart(self.thickness / _PER_THICKNESS, fields, transforms)


HALF_SPACE = Compliance(None, np.zeros_like)


@lru_cache(maxsize=4)
def _layer(layer: Layer, poisson: float) -> Compliance:
    """A layer on a rigid base; kept, for the next run or problem with it."""
    return Compliance(layer, lambda t: _lacking(t, poisson, layer.base == "bonded"))


def _lacking(t: Array, poisson: float, bonded: bool) -> Array:
    """``1 - K(t)`` of a layer on a rigid base."""
    e = np.exp(-2.0 * t)
    if not bonded:
        return 2.0 * e * (1.0 + 2.0 * t - e) / (1.0 - e * e + 4.0 * t * e)
    k = 3.0 - 4.0 * poisson
    rest = e * (2.0 * t * t + 5.0 - 12.0 * poisson + 8.0 * poisson**2)
    return 2.0 * (k * e * e + 2.0 * t * e + rest) / (k * (1.0 + e * e) + 2.0 * rest)
