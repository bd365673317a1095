"""What the answer to a case is held against, and by how much an answer is off it.

Numbers of a closed form, the front tracking at two resolutions, the same solver on an equivalent scene, or
that there is no solution, which a solver has to report. Errors are relative and by name; one that has to be
there and is not is infinite.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from contact_scene import COLUMNS, OutcomeKind, Scene, Trace
from validation.measure.curves import distance
from validation.measure.difference import of_curves, of_numbers, relative
from validation.measure.observables import observe
from validation.runs.run import Run

CURVE = "force, RMS"
"""Name of the error of the curve ``F(t)``: root mean square over the largest force."""
RICHARDSON = 1.0 / 3.0
"""Error of the finer of two runs of second order over their difference, the coarser at twice the step."""


@dataclass(frozen=True)
class Value:
    """An observable of a closed form; errors are relative to ``scale``, by default to its own magnitude."""

    name: str
    value: float
    scale: float | None = None


@dataclass(frozen=True)
class ClosedForm:
    """Values of a closed form, where they come from, and how the run may end."""

    values: tuple[Value, ...]
    source: str
    endings: tuple[OutcomeKind, ...] = (OutcomeKind.COMPLETED,)

    def errors(self, trace: Trace) -> dict[str, float]:
        """Error of every value."""
        found, errors = observe(trace).as_dict(), {}
        for one in self.values:
            measured = found[one.name]
            size = abs(one.value) if one.scale is None else one.scale
            errors[one.name] = math.inf if measured is None else relative(abs(measured - one.value), size)
        return errors


@dataclass(frozen=True)
class ReferenceRuns:
    """Observables of the front tracking; a third of its own step halving is its error estimate.

    Numbers ``of_largest`` are relative to the largest magnitude of their column: they may vanish.
    """

    names: tuple[str, ...]
    fine: int = 20
    coarse: int = 10
    of_largest: tuple[str, ...] = ()

    @property
    def source(self) -> str:
        """What it is, in words."""
        return f"front tracking, {self.fine} steps a zone"

    def errors(self, trace: Trace, reference: Trace) -> dict[str, float]:
        """Difference of every observable of two runs; infinite where only one has it."""
        run, base = (
            Run("", it.solver, it, measures=dict(observe(it).as_dict())) for it in (trace, reference)
        )
        found = [*of_numbers(run, base, self.names, self.of_largest), *of_curves(run, base)]
        named = {CURVE if one.quantity == "force" else one.quantity: abs(one.error) for one in found}
        return {name: named.get(name, 0.0) for name in self.names}

    def own_error(self, fine: Trace, coarse: Trace) -> float:
        """Error estimate of what the finer run gives."""
        return RICHARDSON * max(self.errors(coarse, fine).values())


@dataclass(frozen=True)
class EquivalentScene:
    """The same solver on a scene that differs in units, or in something without any effect.

    The columns of the case are those of ``scene`` times the units that they have.
    """

    scene: Scene
    length: float = 1.0
    stress: float = 1.0
    time: float = 1.0
    source = "the same solver on the equivalent scene"

    def errors(self, trace: Trace, base: Trace) -> dict[str, float]:
        """Largest difference of any row by column; of the curve alone where rows are not as many."""
        if len(trace) != len(base):
            apart = distance(trace, base) if self.length == self.stress == self.time == 1.0 else None
            return {CURVE: math.inf if apart is None else apart.rms}
        force, energy = self.stress * self.length**2, self.stress * self.length**3
        factors = (self.time, self.length, force, self.length, energy, energy, energy)
        expected = {name: by * getattr(base, name) for name, by in zip(COLUMNS, factors, strict=True)}
        sizes = {name: float(np.abs(column).max()) for name, column in expected.items()}
        # What a balance leaves is as exact as its largest term.
        sizes["dissipated_energy"] = max(
            sizes[name] for name in ("dissipated_energy", "stored_energy", "external_work")
        )
        return {
            name: relative(float(np.abs(getattr(trace, name) - column).max()), sizes[name])
            for name, column in expected.items()
        }


@dataclass(frozen=True)
class NoSolution:
    """There is no solution, and why: a solver must refuse, or end with ``no equilibrium``."""

    source: str


Expected = ClosedForm | ReferenceRuns | EquivalentScene | NoSolution
