"""Rows of the trace, gathered step by step, and the columns computed from them.

``F dD + dg dA = dU + P_d dt`` defines the loss. A field with a sharp edge releases only the glassy
``K^2/(2 Einf*)`` at the tip, ``2 pi a da K^2/(2 Einf*) = q(a)^2/Einf* da``; what the branches dissipate is
therefore ``F dD - dU + q(a)^2/Einf* da``, larger than the loss by ``(dg - K^2/(2 Einf*)) |dA|`` on opening.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from validation.reference.tracking import hermite
from validation.reference.tracking.energy import stored_energy
from validation.reference.tracking.surface import Body, Surface

Array = NDArray[np.float64]

_GAUSS, _WEIGHT = np.polynomial.legendre.leggauss(3)
_GAUSS, _WEIGHT = 0.5 * (_GAUSS + 1.0), 0.5 * _WEIGHT
HARDLY = 1e-6  # of the largest area: a change below it says nothing about the energy release rate


@dataclass
class Record:
    """Time series of a run; ``work`` is the work of adhesion (0 without)."""

    body: Body
    work: float
    rows: list[tuple[float, ...]] = field(default_factory=list)
    kinks: list[int] = field(default_factory=list)

    def add(self, time: float, surface: Surface, force: float) -> None:
        """One row for a surface in contact, or free where its radius is 0."""
        radius = surface.radius
        stress = surface.edge_stress(self.body) if radius > 0.0 else 0.0
        energy = stored_energy(surface, self.body)
        self.rows.append((time, surface.penetration, force, radius, energy, stress))

    def kink(self) -> None:
        """Rates jump at the last row."""
        self.kinks.append(len(self.rows) - 1)

    def columns(self) -> dict[str, Array]:
        """All columns by name: the contract's seven, then ``stress_intensity_factor`` (``-q(a)/sqrt(pi a)``,
        0 without contact), ``energy_release_rate`` (between a row and the one before; repeated where the
        area hardly moved) and ``branch_dissipation``."""
        time, depth, force, radius, energy, stress = np.array(self.rows).reshape(-1, 6).T
        area = math.pi * radius**2
        external = _accumulated(self._work(time, force, depth))
        glassy = self.body.rheology.glassy
        tip = _accumulated(0.5 * (stress[1:] ** 2 + stress[:-1] ** 2) * np.diff(radius)) / glassy
        stored = energy - energy[:1]
        intensity = np.where(
            radius > 0.0, -stress / np.sqrt(math.pi * np.where(radius > 0.0, radius, 1.0)), 0.0
        )
        return {
            "time": time,
            "penetration": depth,
            "force": force,
            "contact_radius": radius,
            "stored_energy": energy,
            "external_work": external,
            "dissipated_energy": external + self.work * (area - area[:1]) - stored,
            "stress_intensity_factor": intensity,
            "energy_release_rate": self._release_rate(area, stored - external),
            "branch_dissipation": external - stored + tip,
        }

    def _work(self, time: Array, force: Array, depth: Array) -> Array:
        """``int F dD`` between rows, both of them cubics in time between kinks; exact across jumps."""
        parts = 0.5 * (force[1:] + force[:-1]) * np.diff(depth)
        jumps = np.flatnonzero(np.diff(time) <= 0.0)
        ends = np.unique([0, *self.kinks, *jumps, *(jumps + 1), len(time) - 1])
        for first, last in pairwise(ends.tolist()):
            if last - first < 3 or time[first] == time[last]:
                continue
            rows = slice(first, last + 1)
            t, f, d = time[rows], force[rows], depth[rows]
            h = np.diff(t)
            f_slope, d_slope = hermite.slopes(t, f), hermite.slopes(t, d)
            at = t[:-1, None] + h[:, None] * _GAUSS
            speed = hermite.rate(t, d, d_slope, at)
            parts[first:last] = h * ((hermite.evaluate(t, f, f_slope, at) * speed) @ _WEIGHT)
        return parts

    def _release_rate(self, area: Array, potential: Array) -> Array:
        """``(dU - F dD)/dA``; the work of adhesion, its value in equilibrium, before anything has moved."""
        rate = np.full_like(area, self.work)
        if len(area) < 2:
            return rate
        step = np.diff(area)
        moves = np.abs(step) > HARDLY * area.max()
        last = np.maximum.accumulate(np.where(moves, np.arange(len(step)), -1))
        each = np.divide(np.diff(potential), step, out=np.zeros_like(step), where=moves)
        rate[1:] = np.where(last >= 0, each[last], self.work)
        return rate


def _accumulated(parts: Array) -> Array:
    return np.concatenate(([0.0], np.cumsum(parts)))
