"""Units of what a sweep varies and of what it measures, as products of length, force and time.

They are the scene's own: any consistent system. A plan may name them, ``[units] length = "mm"``.
"""

from __future__ import annotations

from collections.abc import Mapping

from validation.sweeps.coordinates import Coordinate
from validation.sweeps.scene_table import SceneTable, parts

NONE = "1"
"""Unit of a number without dimension."""
_OF_KEYS = {
    "modulus": "force length-2",
    "poisson": NONE,
    "exponent": NONE,
    "time": "time",
    "duration": "time",
    "radius": "length",
    "zone": "length",
    "penetration": "length",
    "amplitude": "length",
    "work": "force length-1",
    "stiffness": "force length-1",
    "half_angle": "degree",
    "angular_frequency": "time-1",
    "chirp": "time-2",
    "drift": "length time-1",
    "to": "length",
    "rate": "length time-1",
}
_OF_FORCE_STEPS = {"to": "force", "value": "force", "rate": "force time-1"}
_OF_MEASURES = {
    "force": "force",
    "radius": "length",
    "penetration": "length",
    "stage": "length",
    "time": "time",
    "energy": "force length",
    "branch_dissipation": "force length",
    "zone_excess": "force length",
    "peak_cycle_loss": "force length",
    "instability_loss": "force length",
    "peak_cycle_frequency": "time-1",
}
"""By the name of a measure or the last word of it."""


def of_coordinate(coordinate: Coordinate, base: SceneTable, names: Mapping[str, str]) -> str:
    """Unit of a coordinate; empty where the key does not tell."""
    if coordinate.unit:
        return coordinate.unit
    path = coordinate.keys[0]
    key = parts(path)[-1]
    force_step = base.kind_of(path).startswith("force")
    return _named(
        _OF_FORCE_STEPS.get(key, "") if force_step and key in _OF_FORCE_STEPS else _OF_KEYS.get(key, ""),
        names,
    )


def of_measure(measure: str, names: Mapping[str, str]) -> str:
    """Unit of a measure."""
    dimension = _OF_MEASURES.get(measure) or _OF_MEASURES.get(measure.rpartition("_")[2], NONE)
    return _named(dimension, names)


def _named(dimension: str, names: Mapping[str, str]) -> str:
    for kind, name in names.items():
        dimension = dimension.replace(kind, name)
    return dimension
