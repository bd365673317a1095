"""The unknowns that settings ask for: numbers of the scene, and of each curve's instrument."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace

import numpy as np

from contact_scene import Branch, Machine, Scene, SceneError
from contact_scene.errors import shown
from validation.fits.curve_model import CurveModel
from validation.fits.fit_settings import FitSettings
from validation.fits.parameters import (
    BASELINE,
    DRIFT,
    SPRING,
    TIME_OFFSET,
    FitParameter,
    scene_parameter,
)
from validation.fits.record import Array, MeasuredCurve

TIME_SHARE = 0.1
"""Time offset over the duration of a record, at most."""


def with_grid(scene: Scene, settings: FitSettings) -> tuple[Scene, FitSettings]:
    """The scene with a Prony series on the fixed grid, and its moduli among the parameters."""
    if not settings.prony:
        return scene, settings
    count = len(settings.prony)
    relaxing = scene.material.glassy_modulus - scene.material.modulus or scene.material.modulus
    branches = tuple(Branch(relaxing / count, time) for time in settings.prony)
    grid = tuple(f"material.branches[{index}].modulus" for index in range(count))
    scene = replace(scene, material=replace(scene.material, branches=branches))
    return scene, replace(settings, vary=(*settings.vary, *grid))


def with_spring(scene: Scene, curves: Sequence[MeasuredCurve]) -> Scene:
    """The scene on the spring of the curves, where it states none and all of them were recorded on one."""
    springs = {None if curve.stage is None else curve.stiffness for curve in curves}
    [spring] = springs if len(springs) == 1 else [None]
    if scene.machine is not None or spring is None:
        return scene
    return replace(scene, loading=replace(scene.loading, machine=Machine(spring)))


def bending(settings: FitSettings) -> Callable[[Mapping[str, float]], Array]:
    """Second differences of the logarithms of the Prony weights, weighted."""
    names = [f"material.branches[{index}].modulus" for index in range(len(settings.prony))]
    weight = np.sqrt(settings.regularisation)
    return lambda values: weight * np.diff(np.log([values[name] for name in names]), 2)


def unknowns(models: Sequence[CurveModel], scene: Scene, settings: FitSettings) -> list[FitParameter]:
    """All parameters of a fit with their first guesses: shared ones, then those of each curve.

    Raises
    ------
    SceneError
        If a path names no number of the scene, or is tied to one that is not varied.
    """
    tied: dict[str, list[str]] = {}
    for entry in settings.tie:
        path, _, other = entry.partition("=")
        if not path or not other:
            raise SceneError("tie", f"got {shown(entry)}", "PATH=OTHER, both numbers of the scene")
        if path == other:
            raise SceneError(
                "tie", f"{shown(path)} is tied to itself", "PATH=OTHER, two numbers of the scene"
            )
        tied.setdefault(other, []).append(path)
    varied = [entry.partition("=")[0] for entry in (*settings.vary, *settings.per_curve)]
    for path in (*varied, *(one for ties in tied.values() for one in ties)):
        _check_part(path, models)
    for other in tied:
        if other not in varied:
            raise SceneError("tie", f"{other} is not varied", "ties to a number that is")
    found = [scene_parameter(scene, entry, tied.get(entry.partition("=")[0], ())) for entry in settings.vary]
    for index, model in enumerate(models):
        for entry in settings.per_curve:
            ties = tied.get(entry.partition("=")[0], ())
            found.append(scene_parameter(model.scene, entry, ties, (index, model.curve.name)))
        found += [_instrument(model, index, name) for name in dict.fromkeys(settings.free)]
    return found


def _check_part(path: str, models: Sequence[CurveModel]) -> None:
    """Refuse a number of the scene that plays no part in the model of a curve."""
    if path.startswith("loading.steps"):
        problem = "plays no part: the measured motion takes the place of the loading steps"
        raise SceneError(path, problem, "numbers of material, adhesion, indenter or machine")
    for model in models:
        if path in SPRING and model.scene.machine is None:
            problem = "plays no part: the motion of the indenter is recorded, not that of a stage"
            raise SceneError(path, problem, "curves with a column stage", model.curve.name)


def _instrument(model: CurveModel, index: int, kind: str) -> FitParameter:
    """A parameter of the instrument, with its first guess from the record."""
    curve, seen = model.curve, model.features
    name = f"{kind}@{curve.name}"
    duration = float(curve.time[-1] - curve.time[0])
    if kind == BASELINE:
        reach = float(np.ptp(curve.force))
        return FitParameter(
            name, seen.baseline, seen.baseline - reach, seen.baseline + reach, False, seen.noise, curve=index
        )
    if kind == DRIFT:
        reach = float(np.ptp(curve.force)) / duration
        return FitParameter(
            name,
            seen.drift,
            seen.drift - reach,
            seen.drift + reach,
            False,
            seen.noise / duration,
            curve=index,
        )
    if kind == TIME_OFFSET:
        return FitParameter(
            name, 0.0, -TIME_SHARE * duration, TIME_SHARE * duration, False, duration, curve=index
        )
    reach = float(np.ptp(curve.position))
    touch = 0.0
    if 0 < seen.first < seen.last and model.scene.loading.start != "relaxed":
        touch = (
            float(curve.position[seen.first - 1 : seen.first + 1].mean()) - model.scene.loading.penetration
        )
    return FitParameter(name, touch, touch - reach, touch + reach, False, reach, curve=index)
