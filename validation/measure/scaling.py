"""What the error of a measured quantity is relative to, the only rule for all tables and checks; and units.

A difference in a quantity is divided by

- a penetration, or a place of the stage: the largest magnitude of that column in the run, since its zero is a
  matter of choice;
- a loss (dissipated energy, its fall, branch dissipation, their difference): its magnitude, but at least the
  largest term of the balance that it is the remainder of (stored energy, external work, surface energy);
- a force, contact radius or time: its magnitude, but at least a twentieth of the largest magnitude of that
  column in the run, so that a value that nearly vanishes is not divided by itself;
- the work done over the run (loop energy): its magnitude, but at least a twentieth of the largest magnitude
  of the external work in the run, for the same reason; that over a cycle: at least a twentieth of the largest
  stored energy;
- any frequency: its magnitude.

Check values are stated in the paper's units (Sec. III), with ``R`` the radius of the sphere and ``K`` the
relaxed plane modulus ``E0/(1 - nu^2)``: lengths over ``R``, forces over ``pi K R^2``, energies over
``pi K R^3``, pull-off forces over ``F_JKR = 3 pi dgamma R/2``. Scenes without a sphere keep their units.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from contact_scene import Scene, Sphere, Trace

LEAST_SHARE = 0.05
"""Least scale of a force, radius or time, relative to the largest magnitude of its column in the run."""
ROUND_OFF = 1e-9
"""Difference, relative to the largest value of a column, below which two of its values count as equal."""
LOSSES = ("dissipated_energy", "loss_fall", "instability_loss", "branch_dissipation", "zone_excess")
"""Quantities that are what an energy balance leaves."""
WORKS = {"loop_energy": "external_work", "peak_cycle_loss": "stored_energy"}
"""Work done over a run or a cycle: the column it is a small part of where it nearly vanishes."""
SYMBOLS = {"": "", "length": "R", "force": "πE₀R²/(1−ν²)", "energy": "πE₀R³/(1−ν²)", "jkr-force": "F_JKR"}
_COLUMNS = {"force": "force", "radius": "contact_radius", "penetration": "penetration", "time": "time"}
_STAGE = "stage"
_KINDS = {
    "force": "force",
    "time": "time",
    **dict.fromkeys(("radius", "penetration", "stage", "stage_at_detachment"), "length"),
    **dict.fromkeys((*LOSSES, *WORKS, "external_work", "energy"), "energy"),
    "peak_cycle_frequency": "frequency",
}
"""What is measured, force, length, time, energy or frequency, by the name of a scalar or column, or by its
last word."""
_POWERS = {"energy": "force length", "frequency": "time-1", "": "1"}
"""Those that are no unit of their own, as products of powers of length, force and time."""


def column_of(name: str) -> str:
    """Column of the trace that a scalar is a value of; empty for energies."""
    return _STAGE if name.startswith(f"{_STAGE}_") else _COLUMNS.get(name.rpartition("_")[2], "")


def kind_of(name: str) -> str:
    """Kind of a scalar or of a column, as ``"length"``; empty for shares, counters and what is not known."""
    return _KINDS.get(name) or _KINDS.get(name.rpartition("_")[2], "")


def unit_of(name: str) -> str:
    """Name of the unit in which an observable is stated; empty in units of the scene."""
    kind = "jkr-force" if name == "pull_off_force" else kind_of(name)
    return kind if kind in SYMBOLS else ""


def dimension_of(name: str) -> str:
    """Unit of a scalar or of a column as a product of powers of length, force and time."""
    kind = kind_of(name)
    return _POWERS.get(kind, kind)


def unit_name(scene: Scene, name: str) -> str:
    """Unit of a scalar or of a column as the scene names it; "scene units" where it does not."""
    units, dimension = scene.units, dimension_of(name)
    return units.named(dimension) if units is not None and units.states(dimension) else "scene units"


def drawn_sizes(scene: Scene) -> dict[str, float]:
    """Size of the units of figures: those of :func:`unit_sizes`, or the scene's own where it names them."""
    return unit_sizes(scene) if scene.units is None else {"": 1.0}


def unit_sizes(scene: Scene) -> dict[str, float]:
    """Size of every unit in the units of the scene; always holds ``""`` = 1."""
    known = {"": 1.0}
    if isinstance(scene.indenter, Sphere):
        radius = scene.indenter.radius
        stiffness = math.pi * scene.material.relaxed_plane_modulus
        known |= {"length": radius, "force": stiffness * radius**2, "energy": stiffness * radius**3}
        if scene.adhesion is not None and scene.is_adhesive:
            known["jkr-force"] = 1.5 * math.pi * scene.adhesion.work * radius
    return known


@dataclass(frozen=True)
class Magnitudes:
    """Largest magnitudes in a run, by column of the trace, and of the terms of its energy balance."""

    columns: Mapping[str, float]
    balance: float

    @classmethod
    def of_trace(cls, trace: Trace) -> Magnitudes:
        """From all rows."""
        columns = trace.columns()
        energy = trace.whole_stored_energy
        surface = trace.dissipated_energy + (energy - energy[0]) - trace.external_work
        terms = (energy, trace.external_work, surface)
        columns.setdefault(_STAGE, trace.penetration)
        names = (*_COLUMNS.values(), *WORKS.values(), _STAGE)
        return cls(
            {name: float(np.abs(columns[name]).max()) for name in names},
            max(float(np.abs(term).max()) for term in terms),
        )

    @classmethod
    def of_measures(cls, measures: Mapping[str, Any]) -> Magnitudes:
        """From scalars by name, where the rows are not available; what is no number is ignored."""
        numbers = {
            name: abs(value)
            for name, value in measures.items()
            if isinstance(value, (int, float)) and not isinstance(value, bool)
        }
        columns = {
            column: max(
                (number for name, number in numbers.items() if name.endswith(f"_{kind}")), default=0.0
            )
            for kind, column in _COLUMNS.items()
        }
        columns["external_work"] = numbers.get("loop_energy", 0.0)
        columns[_STAGE] = columns["penetration"]
        return cls(columns, max(numbers.get(name, 0.0) for name in ("loop_energy", "branch_dissipation")))

    def scale(self, name: str, value: float) -> float:
        """What a difference in the quantity ``name``, of the given value, is relative to (see the module)."""
        column = column_of(name)
        if column in ("penetration", _STAGE):
            return self.columns[column]
        if name in LOSSES:
            return max(abs(value), self.balance)
        column = column or WORKS.get(name, "")
        return max(abs(value), LEAST_SHARE * self.columns.get(column, 0.0))


def scale(name: str, value: float, trace: Trace) -> float:
    """What a difference in a quantity is relative to, from the rows of the run it belongs to."""
    return Magnitudes.of_trace(trace).scale(name, value)
