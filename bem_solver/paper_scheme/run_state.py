"""Committed state of a run on uniform annuli: surface, energies, and what is recorded of them."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from bem_solver.creep import Chain
from bem_solver.energy import Energies
from bem_solver.paper_scheme.annuli import AnnuliState, UniformAnnuli
from bem_solver.recorder import TraceRecorder
from contact_scene import Event, SurfaceProfile


@dataclass
class UniformState:
    """State of a run on uniform annuli.

    Attributes
    ----------
    surface, energies
        Committed state of the surface and its energies.
    record
        Rows, events and profiles so far.
    """

    surface: AnnuliState
    energies: Energies
    record: TraceRecorder

    def commit(self, chain: Chain, annuli: UniformAnnuli, surface: AnnuliState, energies: Energies) -> None:
        """Take a state as the new committed one, and record its row.

        Parameters
        ----------
        chain : Chain
        annuli : UniformAnnuli
        surface : AnnuliState
        energies : Energies

        Raises
        ------
        FloatingPointError
            If force or penetration is not finite.
        """
        if not (math.isfinite(surface.force) and math.isfinite(surface.penetration)):
            raise FloatingPointError("force or penetration is not finite")
        self.surface, self.energies = surface, energies
        radius = surface.contact * annuli.width
        stored, intensity = energies.stored(chain), surface.stress_intensity
        row = (surface.time, surface.penetration, surface.force, radius)
        self.record.rows.append((*row, stored, energies.dissipated, intensity, 0.0, math.nan))

    def event(self, kind: str, width: float) -> None:
        """An instability of the committed state on annuli of a ``width``."""
        surface = self.surface
        radius = surface.contact * width
        self.record.events.append(Event(kind, surface.time, surface.penetration, surface.force, radius))


def annuli_profile(chain: Chain, annuli: UniformAnnuli, surface: AnnuliState) -> SurfaceProfile:
    """A state at the collocation radii, as far as the annuli reach."""
    contact = surface.contact
    pressure = np.zeros(annuli.count)
    pressure[:contact] = surface.scaled / annuli.width
    displacement = surface.displacement(chain)
    gap = annuli.heights - surface.penetration + displacement
    gap[:contact] = 0.0
    return SurfaceProfile(
        surface.time,
        surface.penetration,
        surface.force,
        contact * annuli.width,
        annuli.radii,
        pressure,
        displacement,
        gap,
    )
