"""Whether records can be what they are said to be: errors for what cannot be fitted, and warnings."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from contact_scene import FlatPunch, Machine, Scene, SceneError
from validation.fits.model import CurveModel, kept_rows, moments
from validation.fits.parameters import CONTACT_POINT, SPRING, Unknown
from validation.fits.record import MeasuredCurve
from validation.reference import sneddon
from validation.reference.elastic_layer import ElasticLayer, moment

CONTACT = 6.0
"""Deviations of the noise from the background that no row of a record without contact reaches by chance."""
OPPOSED = -0.5
"""Correlation of force and motion in contact below which one of them has the wrong sign."""
ABSURD, PLAUSIBLE = 1e4, 1e2
"""Factors by which the largest force may miss that of the scene's elastic contact: above the first it is not
this contact, below the second it may be, and between them a warning says so."""
OUTWEIGHS = 3.0
"""Factor by which a record comes closer to that force than with its columns swapped, from which its size
tells more than its shape: first guesses are about as good."""
STRAIGHT = 0.02
"""Share of its range by which a column may miss its straight lines: less than a contact bends."""
SAME_SPRING = 1e-3
"""Relative difference of two spring constants that is not mentioned: springs are hardly calibrated to it."""
TENTH = 0.09
"""``y`` at which ``y + (7/6) y^2`` is a tenth."""
FEW_ROWS = 50
"""Rows in contact below which the shape of the curve, not its noise, limits what a fit can tell."""
LOUD, COARSE = 10.0, 20.0
"""Noise, and change between neighbouring rows, jumps aside, in per cent of the range of the force, from which
a fit is of little use."""


def check(models: Sequence[CurveModel], scene: Scene, unknowns: Sequence[Unknown]) -> list[str]:
    """Warnings about curves, which the scene, as its user states it, is fitted to."""
    varied = {path for one in unknowns for path in one.sets}
    spring, found = scene.machine if varied.isdisjoint(SPRING) else None, []
    for model in models:
        try:
            if np.ptp(model.curve.force) > 0.0:
                _check_columns(model)
            _check_signs(model)
            if CONTACT_POINT not in varied:
                model.scene_of({})
        except SceneError as error:
            raise error.in_file(model.curve.name) from None
        found += [f"{model.curve.name}: {text}" for text in _doubts(model, spring)]
    return found if scene.body is not None else [*found, thickness_needed(models, scene)]


def _check_columns(model: CurveModel) -> None:
    """Whether force and motion are of the order of the scene's contact, or of each other's: a drive moves
    in straight lines, which what a contact makes of them does not."""
    curve = model.curve
    exchanged: dict[str, Any] = {curve.driven: curve.force, "force": curve.position, "noise": None}
    stated, swapped = (_over_expected(model.scene, one) for one in (curve, replace(curve, **exchanged)))
    off, off_swapped = (max(factor, 1.0 / factor) for factor in (stated, swapped))
    compared = f"{stated:.2g} times the force of the scene's contact, {swapped:.2g} times if they are"
    lines, of_force = (
        kept_rows(curve.time, one, STRAIGHT * float(np.ptp(one))).size - 1
        for one in (curve.position, curve.force)
    )
    problem = ""
    if off >= ABSURD:
        problem = f"looks like the force, and the force like it: swapped? ({compared})"
    elif off_swapped < OUTWEIGHS * off and 2 * of_force <= lines:
        problem = f"moves in {lines} straight lines, the force in {of_force}: swapped? ({compared})"
    if problem and off_swapped < PLAUSIBLE:
        raise SceneError(curve.driven, problem, "each in its column")
    if off >= ABSURD:
        problem = f"is {stated:.0e} times that of the scene's contact: other units?"
        raise SceneError("force", problem, "force, lengths and times in the units of the scene")


def _check_signs(model: CurveModel) -> None:
    """Whether there is contact, the force grows with the position in it, and rows without contact lie further
    out: a record that shows such rows only once both its signs are turned has both of them wrong."""
    curve, seen = model.curve, model.moments
    over, inside = curve.force - seen.background, slice(seen.first, seen.last)
    if not (np.abs(over) > CONTACT * seen.noise).any():
        problem = f"never leaves its noise of {seen.noise:.3g}: no contact"
        raise SceneError("force", problem, "a record with contact")
    if np.ptp(curve.position[inside]) > 0.0:
        together = float(np.corrcoef(curve.position[inside], over[inside])[0, 1])
        if together < OPPOSED:
            problem = f"falls where {curve.driven} rises (correlation {together:.2f}): one has the wrong sign"
            raise SceneError("force", problem, "both positive towards the body")
    turned: dict[str, Any] = {curve.driven: -curve.position, "force": -curve.force, "segments": ()}
    size, other = curve.time.size, moments(replace(curve, **turned))
    if seen.last - seen.first == size > other.last - other.first:
        problem = "contact is where it is smallest: the wrong sign"
        raise SceneError(curve.driven, problem, "positions positive towards the body")


def _over_expected(scene: Scene, curve: MeasuredCurve) -> float:
    """Range of the force over the force of the scene's contact at the range of the motion."""
    expected = _elastic_force(scene, float(np.ptp(curve.motion)))
    return float(np.ptp(curve.force)) / expected if expected > 0.0 else np.inf


def _elastic_force(scene: Scene, depth: float) -> float:
    """Force of the glassy contact without adhesion, the order of magnitude."""
    radius = sneddon.contact_radius(scene.indenter, depth)
    modulus = scene.material.glassy_plane_modulus
    if scene.body is not None:  # as much stiffer as a flat punch of that radius
        flat = min(radius, scene.body.largest_contact)
        layer = ElasticLayer(scene.body, scene.material.poisson, FlatPunch(flat))
        modulus *= layer.response(flat).stiffness / (2.0 * flat)
    force = float(sneddon.force(scene.indenter, radius, modulus))
    return force if force > 0.0 else modulus * radius * depth


def thickness_needed(models: Sequence[CurveModel], scene: Scene) -> str:
    """At which thickness a layer would be taken for a half-space of a modulus 10 % too high, in words.

    Bonded to its base it is stiffer by ``y + (7/6) y^2``, ``y = (2 m0/pi) a/h``.
    """
    depth = max(float(np.ptp(one.curve.motion[one.moments.first : one.moments.last])) for one in models)
    radius = sneddon.contact_radius(scene.indenter, depth)
    thickness = 2.0 / np.pi * moment(0, scene.material.poisson, "bonded") * radius / TENTH
    return (
        f"the scene has no body, so it is a half-space: on a layer of thickness {thickness:.2g} bonded to a "
        "stiff base the modulus would come out 10 % too high, on a thinner one more"
    )


def _doubts(model: CurveModel, spring: Machine | None) -> Iterator[str]:
    """What makes a record of little use, and that the spring of the scene, where it is not varied, plays no
    part or is another one than the record's."""
    curve, seen = model.curve, model.moments
    inside, reach, rows = slice(seen.first, seen.last), float(np.ptp(curve.force)), seen.last - seen.first
    changes = np.abs(np.diff(curve.force))[seen.compared[1:] & seen.compared[:-1]]
    step, noise = 100.0 * changes.max(initial=0.0) / reach, 100.0 * seen.noise / reach
    expected = _elastic_force(model.scene, float(np.ptp(curve.motion[inside])))
    factor = float(np.abs(curve.force - seen.background)[inside].max()) / expected
    if rows < FEW_ROWS:
        yield f"{rows} rows in contact: too coarse for more than one or two parameters"
    if step > COARSE:
        yield f"the force changes by {step:.0f} % of its range between two rows: too coarse"
    if not 1.0 / PLAUSIBLE < factor < PLAUSIBLE:
        yield f"the force is {factor:.0e} times that of the scene's elastic contact: other units?"
    if noise > LOUD:
        yield f"the noise is {noise:.0f} % of the range of the force"
    if spring is None:
        return
    if curve.stage is None or curve.stiffness is None:
        yield "positions are those of the indenter: the spring of the scene plays no part"
    elif model.scene.loading.start == "relaxed":
        yield "a relaxed start drives the indenter by stage and measured force, which is noisy"
    elif abs(curve.stiffness / spring.stiffness - 1.0) > SAME_SPRING:
        own, stated = curve.stiffness, spring.stiffness
        yield f"the spring constant of the record holds, {own:.6g}, not the scene's {stated:.6g}"
