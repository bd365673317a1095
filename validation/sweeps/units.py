"""Units of what a sweep varies and of what it measures, as products of length, force and time.

They are the scene's own: any consistent system. A plan may name them, ``[units] length = "mm"``.
"""

from __future__ import annotations

from collections.abc import Mapping

from validation.sweeps.coordinates import Coordinate
from validation.sweeps.scene_table import SceneTable

NONE = "1"
"""Unit of a number without dimension."""
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
    """Unit of a coordinate, as the scene declares it; empty where the key does not tell."""
    if coordinate.unit:
        return coordinate.unit
    path = coordinate.keys[0]
    field = base.field(path)
    return "" if field is None else _named(field.key.unit, names)


def of_measure(measure: str, names: Mapping[str, str]) -> str:
    """Unit of a measure."""
    dimension = _OF_MEASURES.get(measure) or _OF_MEASURES.get(measure.rpartition("_")[2], NONE)
    return _named(dimension, names)


def _named(dimension: str, names: Mapping[str, str]) -> str:
    for kind, name in names.items():
        dimension = dimension.replace(kind, name)
    return dimension
