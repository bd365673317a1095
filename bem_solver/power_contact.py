"""A contact under the displacement ``x^n``, exactly: pressure, force, displacement outside.

Unit contact and unit plane modulus. By Abel's transform the displacement is held by discs of the weights
``G t^n``, with ``G = sqrt(pi) Gamma(n/2 + 1)/Gamma((n + 1)/2)`` (Sneddon).
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.special import gamma, hyp2f1

Array = NDArray[np.float64]


@dataclass(frozen=True)
class PowerContact:
    """Displacement ``x^exponent`` within the unit contact."""

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
