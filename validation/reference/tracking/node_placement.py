"""At which moments of a step the moving edge leaves nodes behind, besides the end of the step."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

GRADING = 1.75
"""Grading of nodes towards the end of a step: distances shrink by the factor ``1 - GRADING/divisions``."""
FREE_GRADING = 0.95
"""The same for steps over process zones under a controlled force: no penetration takes back there what the
speed, which follows from these nodes, is off by."""
STEEPEST = 0.1
"""Least of that factor: with few divisions, as a coarse tolerance asks for, it would not be positive."""
LAYER_ERROR = 1.0 / 40.0
"""Error of interpolation in a relaxing layer over the cube of the distance of its nodes from the edge, in
relaxation times: a cubic with a one-sided slope at ``exp(-s)``."""
LAYER_SHARE = 1.0 / 8.0
"""That error in steps of a fraction of a zone, in their allowed deviations: it has the same sign in all."""
ZONE_FRACTION = 0.1
"""Last node of a step over many process zones before its end, in process zones."""
CLOSURE_REACH = 4.0
"""Part of such a step, in process zones before its end, into which the closure may look at its end."""
WAKE_GRADING = 0.6
"""Grading of the nodes before that part: they count in integrals and for an edge that comes back."""
START_GRADING = 0.1
"""Grading of the nodes at the start of such a step: neighbouring distances then differ by a factor of ten at
most, far from what stands for a discontinuity."""
THINNEST_LAYER = 1e-14
"""Thinnest resolved boundary layer, in process zones: thinner ones do not matter at any ratio of moduli."""
CLOSEST_MOMENT = 1e-13
"""Smallest distance of a moment from the end of the step, in durations: nearer ones round onto the end."""


@dataclass(frozen=True)
class NodePlacement:
    """Moments graded towards the end of a step, down to the boundary layer of the shortest relaxation time.

    Parameters
    ----------
    shortest : float
        Shortest relaxation time; infinite if nothing relaxes.
    travel : float
        Expected travel of the edge.
    zone_length : float
        Process zone; 0 without adhesion.
    divisions : float
        Steps per process zone.
    deviation : float
        Relative deviation allowed in a step.
    over_zones : bool
        Whether the step may pass over several process zones; its nodes then reach down to a part of a zone.
    freedom : float
        How free the penetration is, from 0, prescribed, to 1, under a controlled force.
    """

    shortest: float
    travel: float
    zone_length: float
    divisions: float
    deviation: float
    over_zones: bool = False
    freedom: float = 0.0

    def fractions(self, duration: float) -> Array:
        """Fractions of the step, rising, within (0, 1)."""
        if math.isinf(self.shortest) or duration <= 0.0 or self.travel == 0.0 or self.zone_length == 0.0:
            return np.empty(0)
        grading = GRADING
        if self.over_zones:
            grading *= (FREE_GRADING / GRADING) ** self.freedom
        ratio = max(1.0 - grading / self.divisions, STEEPEST)
        share = 1.0 if self.over_zones else LAYER_SHARE
        smallest = max(
            (share * self.deviation / LAYER_ERROR) ** (1.0 / 3.0) * self.shortest / duration,
            THINNEST_LAYER * self.zone_length / self.travel,
            CLOSEST_MOMENT,
        )
        if not self.over_zones:
            return 1.0 - _graded(1.0, smallest, ratio)
        zone = self.zone_length / self.travel
        smallest = max(min(smallest, ZONE_FRACTION * zone), CLOSEST_MOMENT)
        wake = _graded(1.0, CLOSURE_REACH * zone, WAKE_GRADING)
        begin = float(wake[-1]) if len(wake) else 1.0
        start = _graded(
            0.5 * (1.0 - float(wake[0])) if len(wake) else 0.5, ZONE_FRACTION * zone, START_GRADING
        )
        return np.concatenate((start[::-1], 1.0 - wake, 1.0 - _graded(begin, smallest, ratio)))


def _graded(begin: float, smallest: float, ratio: float) -> Array:
    """Numbers that fall from ``begin`` by a ratio as far as they exceed ``smallest``."""
    count = int(math.log(min(smallest / begin, 1.0)) / math.log(ratio))
    return np.asarray(begin * ratio ** np.arange(1, count + 1), float)
