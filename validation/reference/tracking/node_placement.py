"""At which moments of a step the moving edge leaves nodes behind, besides the end of the step."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

CROWD = 1.75  # over the divisions: how moments crowd towards the end of a step
LAYER = 1e-14  # of the process zone: thinner boundary layers do not matter at any ratio of moduli
THINNEST = 1e-13  # of a step: nearer moments round onto its end


@dataclass(frozen=True)
class Marks:
    """Moments crowded towards the end: every short time leaves a layer behind the edge.

    ``shortest`` relaxation time, ``travel`` expected of the edge, ``reach`` of the law, steps per zone.
    """

    shortest: float
    travel: float
    reach: float
    divisions: float

    def __call__(self, duration: float) -> Array:
        """Fractions of the step, rising, within (0, 1)."""
        if math.isinf(self.shortest) or duration <= 0.0 or self.travel == 0.0 or self.reach == 0.0:
            return np.empty(0)
        ratio = 1.0 - CROWD / self.divisions
        smallest = max(0.15 * self.shortest / duration, LAYER * self.reach / self.travel, THINNEST)
        count = int(math.log(min(smallest, 1.0)) / math.log(ratio))
        return np.asarray(1.0 - ratio ** np.arange(1, count + 1), float)
