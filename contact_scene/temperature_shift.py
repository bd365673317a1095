"""Time-temperature superposition: the shift factor ``a_T`` of relaxation times.

Relaxation times of a thermorheologically simple material that are ``tau`` at the reference temperature are
``a_T(T) tau`` at temperature ``T`` (Ferry, Viscoelastic Properties of Polymers, ch. 11); moduli stay.
"""

from __future__ import annotations

import math
import os
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from itertools import pairwise
from pathlib import Path
from typing import Annotated, Any, ClassVar

import numpy as np

from contact_scene.checked import Checked, Finite, Key, Positive, Tabulated, from_table
from contact_scene.errors import SceneError
from contact_scene.files import as_path, read_text
from contact_scene.material import Branch, BulkRelaxation, Material
from contact_scene.tables import read_table
from contact_scene.value_checks import LARGEST, SMALLEST, Range, finite, of_class, positive

GAS_CONSTANT = 8.31446261815324
"""J/(mol K), exact in the SI of 2019."""
LOWEST_KELVIN = 150.0
"""Below every glass transition of an elastomer, above every Celsius temperature at which one is used: a lower
number is a temperature in Celsius."""
MOST_DECADES = 30.0
"""Of a shift: master curves span 20, from the glass to the melt."""

kelvins = Range(f"kelvin, at least {LOWEST_KELVIN:g}", LOWEST_KELVIN)


class _Law(Checked):
    tag = "model"
    model: ClassVar[str]

    def log_factor(self, temperature: float) -> float:
        """``ln a_T``."""
        raise AssertionError("defined by every law")


@dataclass(frozen=True)
class WLF(_Law):
    """Williams, Landel and Ferry: ``log10 a_T = -c1 (T - T_ref)/(c2 + T - T_ref)``, for ``T > T_ref - c2``.

    Temperatures in degrees, Celsius or kelvin: only differences enter.

    Examples
    --------
    >>> rubber = cc.Material(1e6, 0.5, (cc.Branch(9e6, 0.1),))
    >>> cooled = cc.at_temperature(rubber, cc.WLF(17.44, 51.6, reference_temperature=20.0), 10.0)
    >>> f"{cooled.branches[0].time:.1f}"
    '1557.1'
    """

    model: ClassVar[str] = "WLF"
    c1: Annotated[Positive, Key("first constant", "1")]
    c2: Annotated[Positive, Key("second constant", "degree")]
    reference_temperature: Annotated[Finite, Key("temperature of the stated times", "degree")]

    def log_factor(self, temperature: float) -> float:
        above = finite(temperature, "temperature") - self.reference_temperature
        if above <= -self.c2:
            pole = self.reference_temperature - self.c2
            raise SceneError(
                "temperature", f"got {temperature!r}", f"above reference_temperature - c2 = {pole:g}"
            )
        return -math.log(10.0) * self.c1 * (above / (self.c2 + above))


@dataclass(frozen=True)
class Arrhenius(_Law):
    """``ln a_T = activation_energy/R (1/T - 1/T_ref)``; the scene's ``temperature`` is in kelvin too.

    Examples
    --------
    >>> rubber = cc.Material(1e6, 0.5, (cc.Branch(9e6, 0.1),))
    >>> warmed = cc.at_temperature(rubber, cc.Arrhenius(8e4, reference_temperature=293.0), 313.0)
    >>> f"{warmed.branches[0].time:.4f}"
    '0.0123'
    """

    model: ClassVar[str] = "Arrhenius"
    activation_energy: Annotated[Positive, Key("activation energy", "J/mol")]
    reference_temperature: Annotated[float, kelvins, Key("temperature of the stated times", "kelvin")]

    def log_factor(self, temperature: float) -> float:
        inverse = 1.0 / kelvins(temperature, "temperature") - 1.0 / self.reference_temperature
        return self.activation_energy / GAS_CONSTANT * inverse


@dataclass(frozen=True)
class ShiftTable(_Law, Tabulated):
    """Measured shift factors; ``log10 a_T`` is linear in temperature between them.

    Temperatures are distinct, at least two, in any order, on the scale of the scene's ``temperature``; the
    factor's logarithm is 0 at the reference temperature. In a file it stands as ``a_T`` or ``log_aT``.

    Examples
    --------
    >>> rubber = cc.Material(1e6, 0.5, (cc.Branch(9e6, 0.1),))
    >>> warmed = cc.at_temperature(rubber, cc.ShiftTable((20.0, 40.0), (0.0, -2.0)), 40.0)
    >>> f"{warmed.branches[0].time:.4f}"
    '0.0010'
    """

    model: ClassVar[str] = "file"
    temperatures: Annotated[tuple[Finite, ...], Key("temperatures", "degree")]
    log10_factors: Annotated[tuple[Finite, ...], Key("log10 of the shift factors at these", "1")]
    file: Annotated[str, Key("CSV file of T and a_T or log_aT")] = field(default="", compare=False)
    columns = ("temperature", "a_T or log_aT")

    @classmethod
    def read(cls, file: Path, data: dict[str, Any]) -> tuple[Sequence[float], Sequence[float]]:
        kinds = ("temperature", "log shift factor", "shift factor")
        table = read_table(read_text(file), str(file), kinds, "T, a_T | T, log_aT")
        at = table.places(kinds[:2], kinds[::2])
        temperatures = table.column(at["temperature"])
        if kinds[1] in at:
            return temperatures.tolist(), table.column(at[kinds[1]]).tolist()
        return temperatures.tolist(), np.log10(table.column(at[kinds[2]], positive)).tolist()

    def rules(self) -> None:
        rows = sorted(zip(self.temperatures, self.log10_factors, strict=False))
        for (one, _), (other, _) in pairwise(rows):
            if one == other:
                raise SceneError("temperatures", f"{one:g} comes twice", "distinct temperatures")
        if len(rows) == len(self.temperatures) == len(self.log10_factors):
            for name, column in zip(("temperatures", "log10_factors"), zip(*rows, strict=True), strict=False):
                object.__setattr__(self, name, column)
        super().rules()

    def log_factor(self, temperature: float) -> float:
        low, high = self.temperatures[0], self.temperatures[-1]
        if not low <= finite(temperature, "temperature") <= high:
            allowed = f"{low:g} to {high:g}, as in the table of shift factors"
            raise SceneError("temperature", f"got {temperature!r}", allowed)
        return math.log(10.0) * float(np.interp(temperature, self.temperatures, self.log10_factors))


def read_shift_factors(path: str | os.PathLike[str]) -> ShiftTable:
    """Shift factors from a table with the columns ``T`` and ``a_T`` or ``log_aT`` (decadic).

    Examples
    --------
    >>> _ = Path("shift.csv").write_text("T,a_T\\n20,1\\n40,0.01\\n")
    >>> cc.read_shift_factors("shift.csv").log10_factors
    (0.0, -2.0)
    """
    shift: ShiftTable = from_table([ShiftTable], {"model": "file", "file": str(as_path(path))}, Path())
    return shift


Shift = WLF | Arrhenius | ShiftTable
SHIFTS = (WLF, Arrhenius, ShiftTable)
"""What a file may state under ``shift.model``."""


def at_temperature(material: Material, shift: Shift, temperature: float) -> Material:
    """A material known at the reference temperature of ``shift``, at another temperature.

    Every relaxation time, of separate bulk relaxation too, is multiplied by ``a_T``. ``temperature`` is on
    the scale of the reference temperature of ``shift``.

    Raises
    ------
    SceneError
        If ``temperature`` is outside what the shift covers, or shifts by more than ``MOST_DECADES``, or a
        time leaves what a scene may hold.

    Examples
    --------
    >>> rubber = cc.Material(1e6, 0.5, (cc.Branch(9e6, 0.1),))
    >>> cooled = cc.at_temperature(rubber, cc.WLF(17.44, 51.6, reference_temperature=20.0), 10.0)
    >>> cooled.modulus == rubber.modulus, cooled.branches[0].time > rubber.branches[0].time
    (True, True)
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
