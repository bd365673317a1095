"""Entries of a plan file, read and checked one by one."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from contact_scene import Counters, Outcome, OutcomeKind, Scene, Trace
from contact_scene.errors import SceneError, shown
from contact_scene.run_control.options import whole_number
from validation.measure.scalars import measure
from validation.sweeps.coordinates import Coordinate, read_coordinate
from validation.sweeps.samples import SAMPLES
from validation.sweeps.scene_table import SceneTable, parts

UNITS = ("length", "force", "time")


def read_coordinates(entries: Any, design: str) -> tuple[Coordinate, ...]:
    """``[[coordinates]]``: each name and each key of the scene once."""
    if not isinstance(entries, (list, tuple)) or not entries:
        raise SceneError("coordinates", f"got {shown(entries)}", "at least one table [[coordinates]]")
    read = []
    for index, entry in enumerate(entries):
        try:
            read.append(read_coordinate(entry, design in SAMPLES))
        except SceneError as error:
            raise error.under(f"coordinates[{index}]") from None
    keys = [".".join(parts(key)) for coordinate in read for key in coordinate.keys]
    for what, names in (("name", [coordinate.name for coordinate in read]), ("key", keys)):
        twice = next((name for name in names if names.count(name) > 1), None)
        if twice is not None:
            raise SceneError("coordinates", f"the {what} {twice} comes twice", f"every {what} once")
    lengths = {coordinate.name: len(coordinate.rows) for coordinate in read}
    if design == "points" and len(set(lengths.values())) > 1:
        shown_lengths = ", ".join(f"{count} of {name}" for name, count in lengths.items())
        raise SceneError(
            "coordinates", f"got {shown_lengths}", "as many values of each, for a list of points"
        )
    return tuple(read)


def refuse_names_of_measures(coordinates: Sequence[Coordinate], base: SceneTable) -> None:
    """A data set has a variable for each measure and each error estimate."""
    taken = measure_names(base.scene({}))
    for coordinate in coordinates:
        if coordinate.name.removesuffix("_error") in taken:
            problem = f"the coordinate {coordinate.name} has the name of a measure"
            raise SceneError("coordinates", problem, "another name")


def read_points(data: Mapping[str, Any], design: str) -> int:
    """``points``, of a sample; else 0."""
    if design not in SAMPLES:
        if "points" in data:
            raise SceneError("points", f'given with design = "{design}"', f"for {', '.join(SAMPLES)} only")
        return 0
    return whole_number(data.get("points", 0), "points", 1)


def read_optional(data: Mapping[str, Any], key: str, least: int) -> int | None:
    """A whole number, if it is given."""
    return None if data.get(key) is None else whole_number(data[key], key, least)


def read_flag(data: Mapping[str, Any], key: str, default: bool) -> bool:
    """``true`` or ``false``."""
    value = data.get(key, default)
    if not isinstance(value, bool):
        raise SceneError(key, f"got {shown(value)}", "true or false")
    return value


def read_measures(
    data: Mapping[str, Any], key: str, default: tuple[str, ...], base: SceneTable
) -> tuple[str, ...]:
    """Names of measures.

    Parameters
    ----------
    data : mapping
        The plan file.
    key : str
        Which list of it.
    default : tuple of str
        Without one.
    base : SceneTable
        The scene, whose runs have these measures.

    Returns
    -------
    tuple of str
    """
    names = data.get(key, default)
    if not isinstance(names, (list, tuple)):
        raise SceneError(key, f"got {shown(names)}", "a list of names of measures")
    known = measure_names(base.scene({})) if names is not default else names
    for name in names:
        if not isinstance(name, str) or name not in known:
            raise SceneError(key, f"no measure {shown(name)}", ", ".join(known))
    return tuple(names)


def measure_names(scene: Scene) -> list[str]:
    """Names of all measures of a run: those of one that gave no row."""
    none = np.empty(0)
    outcome = Outcome(OutcomeKind.COMPLETED, "", 0.0)
    trace = Trace("", none, none, none, none, none, none, none, outcome, Counters())
    return list(measure(trace, scene, 0.0))


def read_units(table: Any) -> dict[str, str]:
    """``[units]``: names by kind of unit."""
    if not isinstance(table, dict) or not all(isinstance(unit, str) and unit for unit in table.values()):
        raise SceneError("units", f"got {shown(table)}", f"names of the units of {', '.join(UNITS)}")
    for key in table:
        if key not in UNITS:
            raise SceneError(f"units.{key}", "unknown key", ", ".join(UNITS))
    return dict(table)
