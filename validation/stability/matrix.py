"""All axes by name."""

from __future__ import annotations

from collections.abc import Callable

from validation.stability import (
    interface,
    loadings,
    machines,
    materials,
    rates,
    surfaces,
    unit_invariance,
)
from validation.stability.case import StabilityCase

AXES: dict[str, Callable[[], list[StabilityCase]]] = {
    "contrast": materials.contrast,
    "relaxation-time": materials.times,
    "spectrum": materials.spectra,
    "poisson": materials.poisson,
    "speed": rates.speeds,
    "step": rates.steps,
    "adhesion": surfaces.adhesion,
    "hysteresis": interface.hysteresis,
    "rate": interface.rate,
    "stress": interface.stress,
    "indenter": surfaces.indenters,
    "loading": loadings.loading,
    "dead-load": loadings.pull_off,
    "spring": machines.springs,
    "scale": unit_invariance.unit_systems,
}


def cases(only: str | None = None) -> list[StabilityCase]:
    """Every case of the matrix, or of one axis."""
    return [case for name, build in AXES.items() if only in (None, name) for case in build()]
