"""The key numbers of a run: in units of the scene, dimensionless, over the JKR force; error estimates."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from contact_scene import Scene
from validation.measure.dimensionless import SYMBOLS, unit_sizes

KEY_MEASURES = {
    "approach_force": "force",
    "approach_radius": "length",
    "peak_force": "force",
    "peak_time": "time",
    "pull_off_force": "force",
    "pull_off_penetration": "length",
    "pull_off_radius": "length",
    "detachment_time": "time",
    "detachment_penetration": "length",
    "loop_energy": "energy",
    "dissipated_energy": "energy",
}
"""Measures shown for every run, and the kind of their unit."""
MACHINE_MEASURES = {"stage_at_detachment": "length", "instability_loss": "energy"}
"""Those shown after them where the machine is a spring: the last is the energy lost at snaps."""

SCALES_IN_WORDS = (
    "penetrations to the largest of the run, losses at least to the largest energy, else to the value"
)
"""What an error estimate is relative to, in short; in full: ``validation.measure.scaling``."""
HEAD = ("", "in scene units", "dimensionless", "F/F_JKR", "error estimate")


@dataclass(frozen=True)
class KeyNumber:
    """One measure of a run.

    Parameters
    ----------
    name : str
        As in ``summary.json``.
    value : float or None
        In units of the scene; ``None`` where it does not apply.
    kind : str
        Kind of its unit: "length", "force", "energy" or "time".
    ratio : float or None
        Over the unit of the paper's dimensionless quantities, ``symbol``; ``None`` without one.
    symbol : str
    jkr_ratio : float or None
        Over the JKR force, where the number is a force and the contact of a sphere adhesive.
    error : float or None
        Relative error estimate (see ``validation.measure.error_estimate``), if there is one.
    """

    name: str
    value: float | None
    kind: str
    ratio: float | None
    symbol: str
    jkr_ratio: float | None
    error: float | None

    def cells(self) -> tuple[str, ...]:
        """In words, in the order of ``HEAD``."""
        return (
            self.name,
            "-" if self.value is None else format(self.value, ".8g"),
            "" if self.ratio is None else f"{self.ratio:.6g} {self.symbol}",
            "" if self.jkr_ratio is None else f"{self.jkr_ratio:.6g}",
            "" if self.error is None else f"{self.error:.1e}",
        )


def key_numbers(
    scene: Scene, measures: Mapping[str, float | None], errors: Mapping[str, float]
) -> list[KeyNumber]:
    """The key numbers of a run on a scene, in the order of ``KEY_MEASURES``; then those of its spring."""
    units = unit_sizes(scene)
    numbers = []
    shown = KEY_MEASURES | (MACHINE_MEASURES if scene.loading.compliance > 0.0 else {})
    for name, kind in shown.items():
        value, jkr = measures.get(name), units.get("jkr-force") if kind == "force" else None
        scaled = value is not None and kind in units
        numbers.append(
            KeyNumber(
                name,
                value,
                kind,
                value / units[kind] if value is not None and scaled else None,
                SYMBOLS[kind] if scaled else "",
                None if value is None or jkr is None else value / jkr,
                None if value is None else errors.get(name),
            )
        )
    return numbers


def table(numbers: list[KeyNumber]) -> list[tuple[str, ...]]:
    """Heading and one row for each number; columns in which there is nothing are left out."""
    rows = [number.cells() for number in numbers]
    filled = [index for index in range(len(HEAD)) if any(row[index] for row in rows)]
    return [tuple(row[index] for index in filled) for row in (HEAD, *rows)]
