"""The surface at one instant: pressure for a given edge, displacement and gap around it.

Lengths in scene units; ``scaled`` pressure is pressure times contact radius at unit plane modulus, which is
what one solve on the unit annuli gives. Signs: see ``kernel``.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bem_solver.annuli import Annuli, even_cubic

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Surface:
    """Contact of radius ``edge`` under scaled pressures.

    Attributes
    ----------
    scaled : ndarray (M,)
        Pressure times ``edge`` on each annulus.
    density : ndarray (M,)
        Scaled pressure times ``sqrt(1 - (r/a)^2)``, smooth up to the edge.
    kappa : float
        ``pi`` times the density at the edge; ``K_I = -kappa/sqrt(pi a)`` (tension opens).
    field : ndarray
        Outer displacement without its punch part (``Annuli.outside_field``).
    force : float
        Compressive force.
    """

    annuli: Annuli
    edge: float
    scaled: Array
    density: Array
    kappa: float
    field: Array
    force: float

    @classmethod
    def under(cls, annuli: Annuli, edge: float, scaled: Array) -> Surface:
        """From scaled pressures."""
        density = annuli.density(scaled)
        kappa = annuli.edge_strength(density)
        field = annuli.outside_field(scaled, kappa)
        # the punch part of the force, 2 kappa, is exact
        force = edge * (2.0 * kappa + annuli.areas @ (scaled - kappa * annuli.punch))
        return cls(annuli, edge, scaled, density, kappa, field, float(force))

    @classmethod
    def free(cls, annuli: Annuli) -> Surface:
        """No contact."""
        zero = np.zeros(annuli.count)
        return cls(annuli, 0.0, zero, zero, 0.0, np.zeros(annuli.count + 3), 0.0)

    def tension(self, distance: Array) -> Array:
        """Normal stress (tension positive) at ``distance`` inside the edge, singular at zero."""
        cosine = np.sqrt(distance * (2.0 * self.edge - distance)) / self.edge
        position = self.annuli.count * (1.0 - 2.0 / np.pi * np.arcsin(np.minimum(cosine, 1.0)))
        return -even_cubic(self.density, position) / (cosine * self.edge)

    def pressure(self, radius: Array) -> Array:
        """Pressure at radii < edge; zero outside."""
        inside = radius < self.edge
        value = np.zeros(len(radius))
        if inside.any():
            value[inside] = -self.tension(self.edge - radius[inside])
        return value

    def outside(self, radius: Array) -> Array:
        """Displacement ``v`` at unit plane modulus, radii >= edge."""
        if self.edge == 0.0:
            return np.zeros(len(radius))
        return self.annuli.outside(self.field, self.kappa, radius / self.edge)

    def root_strength(self, reach: float) -> float:
        """B in ``v = v(a) - B sqrt(x) - C x`` at distance x outside the edge.

        Read at ``reach`` and a quarter of it.

        Where the stress behind the edge relaxes over less than ``reach``, this is the strength seen from
        there, not the one at the very tip.
        """
        if self.edge == 0.0 or reach == 0.0:
            return 0.0
        tip, quarter, full = self.outside(self.edge + np.array([0.0, 0.25, 1.0]) * reach)
        return float((4.0 * (tip - quarter) - (tip - full)) / np.sqrt(reach))

    @property
    def stress_intensity(self) -> float:
        """``K_I``, positive in tension; zero without contact."""
        return -self.kappa / float(np.sqrt(np.pi * self.edge)) if self.edge > 0 else 0.0
