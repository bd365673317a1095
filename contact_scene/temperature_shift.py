"""Time-temperature superposition: the shift factor ``a_T`` of relaxation times.

Relaxation times of a thermorheologically simple material that are ``tau`` at the reference temperature are
``a_T(T) tau`` at temperature ``T`` (Ferry, Viscoelastic Properties of Polymers, ch. 11); moduli stay.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import ClassVar

import numpy as np

from contact_scene.errors import SceneError
from contact_scene.material import Branch, BulkRelaxation, Material
from contact_scene.value_checks import (
    A_COLUMN,
    LARGEST,
    SMALLEST,
    as_tuple,
    finite,
    number,
    of_class,
    positive,
)

GAS_CONSTANT = 8.31446261815324
"""J/(mol K), exact in the SI of 2019."""
LOWEST_KELVIN = 150.0
"""Below every glass transition of an elastomer, above every Celsius temperature at which one is used: a lower
number is a temperature in Celsius."""
MOST_DECADES = 30.0
"""Of a shift: master curves span 20, from the glass to the melt."""


@dataclass(frozen=True)
class WLF:
    """Williams, Landel and Ferry: ``log10 a_T = -c1 (T - T_ref)/(c2 + T - T_ref)``, for ``T > T_ref - c2``.

    Parameters
    ----------
    c1 : float
        > 0.
    c2 : float
        Degrees, > 0.
    reference_temperature : float
        Degrees, on the scale of the scene's ``temperature`` (Celsius or kelvin: only differences enter).
    """

    model: ClassVar[str] = "WLF"
    c1: float
    c2: float
    reference_temperature: float

    def __post_init__(self) -> None:
        object.__setattr__(self, "c1", positive(self.c1, "c1"))
        object.__setattr__(self, "c2", positive(self.c2, "c2"))
        object.__setattr__(
            self, "reference_temperature", finite(self.reference_temperature, "reference_temperature")
        )

    def log_factor(self, temperature: float) -> float:
        """``ln a_T``."""
        above = finite(temperature, "temperature") - self.reference_temperature
        if above <= -self.c2:
            pole = self.reference_temperature - self.c2
            raise SceneError(
                "temperature", f"got {temperature!r}", f"above reference_temperature - c2 = {pole:g}"
            )
        return -math.log(10.0) * self.c1 * (above / (self.c2 + above))


@dataclass(frozen=True)
class Arrhenius:
    """``ln a_T = activation_energy/R (1/T - 1/T_ref)``.

    Parameters
    ----------
    activation_energy : float
        J/mol, > 0.
    reference_temperature : float
        Kelvin, at least ``LOWEST_KELVIN``; the scene's ``temperature`` is in kelvin too.
    """

    model: ClassVar[str] = "Arrhenius"
    activation_energy: float
    reference_temperature: float

    def __post_init__(self) -> None:
        object.__setattr__(self, "activation_energy", positive(self.activation_energy, "activation_energy"))
        kelvins = _kelvins(self.reference_temperature, "reference_temperature")
        object.__setattr__(self, "reference_temperature", kelvins)

    def log_factor(self, temperature: float) -> float:
        """``ln a_T``."""
        inverse = 1.0 / _kelvins(temperature, "temperature") - 1.0 / self.reference_temperature
        return self.activation_energy / GAS_CONSTANT * inverse


def _kelvins(temperature: float, key: str) -> float:
    """A temperature in kelvin, which one in Celsius is told from."""
    return number(temperature, key, f"kelvin, at least {LOWEST_KELVIN:g}", low=LOWEST_KELVIN)


@dataclass(frozen=True)
class ShiftTable:
    """Measured shift factors; ``log10 a_T`` is linear in temperature between them.

    Parameters
    ----------
    temperatures : tuple of float
        Distinct, in any order; on the scale of the scene's ``temperature``. At least two.
    log10_factors : tuple of float
        ``log10 a_T``, as many; 0 at the reference temperature.
    """

    model: ClassVar[str] = "file"
    temperatures: tuple[float, ...]
    log10_factors: tuple[float, ...]

    def __post_init__(self) -> None:
        temperatures = as_tuple(self.temperatures, "temperatures", A_COLUMN)
        factors = as_tuple(self.log10_factors, "log10_factors", A_COLUMN)
        if len(temperatures) != len(factors):
            problem = f"{len(temperatures)} temperatures but {len(factors)} shift factors"
            raise SceneError("log10_factors", problem, "one for each")
        if len(temperatures) < 2:
            raise SceneError("temperatures", f"{len(temperatures)} rows", "two rows or more")
        rows = sorted(
            (finite(t, f"temperature, row {row}"), finite(a, f"shift factor, row {row}"))
            for row, (t, a) in enumerate(zip(temperatures, factors, strict=True), 1)
        )
        for (one, _), (other, _) in pairwise(rows):
            if one == other:
                raise SceneError("temperature", f"{one:g} comes twice", "distinct temperatures")
        object.__setattr__(self, "temperatures", tuple(t for t, _ in rows))
        object.__setattr__(self, "log10_factors", tuple(a for _, a in rows))

    def log_factor(self, temperature: float) -> float:
        """``ln a_T``."""
        low, high = self.temperatures[0], self.temperatures[-1]
        if not low <= finite(temperature, "temperature") <= high:
            raise SceneError(
                "temperature",
                f"got {temperature!r}",
                f"{low:g} to {high:g}, as in the table of shift factors",
            )
        return math.log(10.0) * float(np.interp(temperature, self.temperatures, self.log10_factors))


Shift = WLF | Arrhenius | ShiftTable
SHIFTS: dict[str, type[WLF] | type[Arrhenius]] = {kind.model: kind for kind in (WLF, Arrhenius)}


def at_temperature(material: Material, shift: Shift, temperature: float) -> Material:
    """A material known at the reference temperature of ``shift``, at another temperature.

    Every relaxation time, of separate bulk relaxation too, is multiplied by ``a_T``.

    Parameters
    ----------
    material : Material
    shift : Shift
    temperature : float
        On the scale of the reference temperature of ``shift``.

    Returns
    -------
    Material

    Raises
    ------
    SceneError
        If ``temperature`` is outside what the shift covers, or shifts by more than ``MOST_DECADES``, or a
        time leaves what a scene may hold.
    """
    of_class(material, "material", Material, "a Material")
    of_class(
        shift, "shift", Shift, "WLF, Arrhenius, or a ShiftTable as read_shift_factors reads one from a file"
    )
    log_factor = shift.log_factor(temperature)
    decades = log_factor / math.log(10.0)
    if abs(decades) > MOST_DECADES:
        problem = f"{temperature:g} shifts relaxation times by {decades:.3g} decades"
        raise SceneError("temperature", problem, f"at most {MOST_DECADES:g} decades")
    bulk = material.bulk
    if isinstance(bulk, BulkRelaxation):
        bulk = replace(bulk, branches=_shifted(bulk.branches, log_factor))
    return replace(material, branches=_shifted(material.branches, log_factor), bulk=bulk)


def _shifted(branches: tuple[Branch, ...], log_factor: float) -> tuple[Branch, ...]:
    for branch in branches:
        if not math.log(SMALLEST) <= math.log(branch.time) + log_factor <= math.log(LARGEST):
            problem = (
                f"shifts the relaxation time {branch.time:g} to {branch.time * math.exp(log_factor):.3g}"
            )
            raise SceneError("temperature", problem, f"times from {SMALLEST:g} to {LARGEST:g}")
    return tuple(Branch(branch.modulus, branch.time * math.exp(log_factor)) for branch in branches)
