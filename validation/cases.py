"""Built-in scenes and what is known about each: statement, suites, check values, tolerances.

A built-in scene is a pair of files in ``validation/scenes``: ``NAME.toml``, an ordinary scene file, and
``NAME.checks.toml`` with

- ``figure``, ``statement``: where in the paper it belongs, what it shows;
- ``suites``: the report suites it belongs to; ``outcome``: how a run should end;
- ``too_long_for``: solvers that would take more than a minute, and are run only where they are named, none if
  left out;
- ``profile_times``: times at which the state of the surface is kept, none if left out;
- ``[tolerances]``: per solver, the largest difference from the reference, relative: ``values`` for scalars,
  a scalar's own name where it differs (the loss of the balance takes that of ``loop_energy``), ``curves``
  for ``F(t)`` and ``a(t)`` (RMS over maximum), ``movement`` for the same relative to their excursion;
- ``[[checks]]``: one number each, with ``observable``, ``value`` and ``tolerance`` per solver (relative to
  ``scale``, by default to the value) or ``at_most``/``at_least``, ``unit`` and ``source``; ``at_time`` takes
  a column of the trace at that time instead of an observable.
"""

from __future__ import annotations

import difflib
import os
from collections.abc import Iterable
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from contact_scene import Scene, SceneError, read_scene
from validation.scenes import FOLDER, checks, names
from validation.solvers import SOLVERS


@dataclass(frozen=True)
class Expected:
    """One number a run should show; see the head of this module."""

    observable: str
    source: str
    value: float | None = None
    at_most: float | None = None
    at_least: float | None = None
    unit: str = ""
    tolerance: dict[str, float] = field(default_factory=dict)
    scale: float | None = None
    at_time: float | None = None


@dataclass(frozen=True)
class Case:
    """A scene and what is known about it; for a user's own file only the defaults."""

    name: str
    scene: Scene
    figure: str = ""
    statement: str = ""
    suites: tuple[str, ...] = ()
    outcome: str = ""
    expected: tuple[Expected, ...] = ()
    tolerances: dict[str, dict[str, float]] = field(default_factory=dict)
    profile_times: tuple[float, ...] = ()
    too_long_for: tuple[str, ...] = ()

    def tolerance(self, solver: str, quantity: str) -> float | None:
        """Largest relative difference of ``solver`` from the reference in a scalar, ``curves``, ``movement``.

        The place of a maximum, and the edge where it loses its hold, are known to the root of what the force
        is known to, and the branch integral squares a stress that is singular at the edge: they have wider
        tolerances, unless the scene says so.
        Where the scene has no tolerances for this solver, its defaults hold; ``None``: no such solver.
        """
        method = SOLVERS.get(solver)
        if method is None:
            return None
        usual_values = {"values": method.tolerance, "curves": method.curve_tolerance}
        table = self.tolerances.get(solver, usual_values)
        if quantity == "curves":
            return table.get("curves")
        if quantity == "movement":
            return table.get("movement", method.movement_tolerance)
        usual = table.get("values")
        if usual is not None:
            usual = max(usual, method.quantity_tolerances.get(quantity, 0.0))
        if quantity in ("dissipated_energy", "loss_fall"):
            usual = table.get("loop_energy", usual)
        return table.get(quantity, usual)


def load(name: str) -> Case:
    """A built-in scene by name, or a user's scene file by path; ``SceneError`` if it is neither."""
    if name in names():
        known = checks(name)
        expected = tuple(Expected(**entry) for entry in known.pop("checks", []))
        stated: Any = {key: tuple(one) if isinstance(one, list) else one for key, one in known.items()}
        return Case(name, read_scene(FOLDER / f"{name}.toml"), expected=expected, **stated)
    path = Path(name)
    if name and (os.path.exists(name) or path.suffix == ".toml" or len(path.parts) > 1):
        return Case(name=path.stem, scene=read_scene(path))
    near = difflib.get_close_matches(name, names(), n=3, cutoff=0.3) or names()[:3]
    raise SceneError(
        "SCENE",
        f'"{name}" is no file and no built-in scene; nearest: {", ".join(near)}',
        "a TOML file, or a name listed by `crosscontact scenes`",
    )


def load_all(scenes: Iterable[str]) -> list[Case]:
    """Several scenes; one named twice counts once, different files of one name are numbered."""
    loaded: dict[str, Case] = {}
    for name in dict.fromkeys(scenes):
        case = load(name)
        unique, number = case.name, 1
        while unique in loaded:
            number += 1
            unique = f"{case.name}-{number}"
        loaded[unique] = replace(case, name=unique)
    return list(loaded.values())
