"""One step: what it is to end at, where it is to go, and where it went."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum

import numpy as np
from numpy.typing import NDArray

from validation.reference.path.trial import Arrival, Trial

Array = NDArray[np.float64]

MOVING = 3e-3
"""Share of the radius in the direction of the path from which on a step ends at a radius."""


class Kind(StrEnum):
    """What a step came to."""

    NONE = ""
    REJECTED = "rejected"
    END = "end of the leg"
    LEVEL = "level"
    CORNER = "corner"
    TURN = "turn"
    DEPARTURE = "departure"
    TOWARDS = "towards a fold"
    FOLD = "fold"
    LEAST = "smallest radius"
    RIM = "rim"
    LOST = "lost"


class Fixed(StrEnum):
    """What a step ends at."""

    RADIUS = "radius"
    LOAD = "load"
    REST = "rest"


@dataclass
class Plan:
    """Where a step is to go: ``z = (p/T, a/L, D, F)`` after a way ``h``, and its slopes there.

    ``after``: the first step beyond a corner, in the last one.
    """

    h: float
    z: Array
    tangent: Array
    fixed: Fixed
    event: Kind = Kind.NONE
    after: float = 1.0


@dataclass(frozen=True)
class Correction:
    """A step that satisfies the edge condition, by how much it was mispredicted, and its arclength."""

    trial: Trial
    arrival: Arrival
    error: float
    s: float
