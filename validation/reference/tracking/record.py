"""Rows of the trace, gathered step by step."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from validation.reference.tracking.energy import stored_energy
from validation.reference.tracking.surface import Body, Surface

Array = NDArray[np.float64]


@dataclass
class Record:
    """Time series of a run; ``work`` is the work of adhesion (0 without)."""

    body: Body
    work: float
    rows: list[tuple[float, ...]] = field(default_factory=list)

    def add(self, time: float, surface: Surface, force: float) -> None:
        """One row for a surface in contact."""
        radius = surface.radius
        stress = surface.edge_stress(self.body)
        intensity = -stress / math.sqrt(math.pi * radius) if radius > 0.0 and self.work > 0.0 else 0.0
        energy = stored_energy(surface, self.body)
        self.rows.append((time, surface.penetration, force, radius, energy, intensity))

    def columns(self) -> dict[str, Array]:
        """All columns by name."""
        time, depth, force, radius, energy, intensity = np.array(self.rows).reshape(-1, 6).T
        external = np.concatenate(([0.0], np.cumsum(0.5 * (force[1:] + force[:-1]) * np.diff(depth))))
        area = math.pi * radius**2
        return {
            "time": time,
            "penetration": depth,
            "force": force,
            "contact_radius": radius,
            "stored_energy": energy,
            "external_work": external,
            "dissipated_energy": external + self.work * (area - area[:1]) - (energy - energy[:1]),
            "stress_intensity_factor": intensity,
        }
