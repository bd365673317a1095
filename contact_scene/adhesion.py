"""Short-ranged adhesion: work of adhesion and length of the process zone (paper, Eq. closure)."""

from __future__ import annotations

from dataclasses import dataclass

from contact_scene.errors import not_negative, positive


@dataclass(frozen=True)
class Adhesion:
    """Work of adhesion ``work`` >= 0 (energy per area) and process-zone length ``zone`` > 0.

    The process zone is part of the model, not a numerical parameter: results converge with mesh and step
    at *fixed* zone, and its length sets the speed scale of the viscoelastic enhancement.
    """

    work: float
    zone: float

    def __post_init__(self) -> None:
        object.__setattr__(self, "work", not_negative(self.work, "work"))
        object.__setattr__(self, "zone", positive(self.zone, "zone"))
