"""Whether a record can be what it is said to be: errors for what cannot be fitted, and warnings."""

from __future__ import annotations

import numpy as np

from contact_scene import Scene, SceneError
from validation.fits.model import CurveModel
from validation.fits.parameters import CONTACT_POINT, SPRING, Unknowns
from validation.fits.record import MeasuredCurve
from validation.fits.swapped_columns import exchanged, force_ignores_rest
from validation.reference import sneddon

OPPOSED = -0.5
"""Correlation of force and motion in contact below which one of them has the wrong sign."""
OUTSIDE_ROWS = 5
"""Rows without contact from which their position is compared with that of the rows in contact."""
ABSURD, PLAUSIBLE = 1e4, 1e2
"""Factors by which the largest force may miss that of the scene's elastic contact: above the first it is not
this contact, below the second it may be, and between them a warning says so."""
OUTWEIGHS = 3.0
"""Factor by which a record comes closer to that force than with its columns swapped, from which its size
tells more than its shape: first guesses are about as good."""
SAME_SPRING = 1e-3
"""Relative difference of two spring constants that is not mentioned: springs are hardly calibrated to it."""
FEW_ROWS = 50
"""Rows in contact below which the shape of the curve, not its noise, limits what a fit can tell."""
LOUD = 0.1
"""Noise over the range of the force from which a fit is of little use."""
COARSE = 0.2
"""Change between neighbouring rows over the range of the force, jumps aside, that is coarse sampling."""


def require_contact(model: CurveModel) -> None:
    """Refuse a curve whose force is noise alone: ranges of its parameters would be empty.

    Raises
    ------
    SceneError
        One line.
    """
    seen = model.features
    if seen.last - seen.first < 2:
        problem = f"never leaves its noise of {seen.noise:.3g}: no contact"
        raise SceneError("force", problem, "a record with contact", model.curve.name)


def check(model: CurveModel, parameters: Unknowns) -> list[str]:
    """Warnings about a curve.

    Raises
    ------
    SceneError
        One line, if the curve cannot be a contact as the scene describes it.
    """
    curve, seen, scene = model.curve, model.features, model.scene

    def error(key: str, problem: str, allowed: str) -> SceneError:
        return SceneError(key, problem, allowed, curve.name)

    inside = slice(seen.first, seen.last)
    force, motion = curve.force, curve.position
    column = "penetration" if curve.penetration is not None else "stage"
    _check_columns(model, column)
    if np.ptp(motion[inside]) > 0.0 and np.ptp(force[inside]) > 0.0:
        together = float(np.corrcoef(motion[inside], force[inside])[0, 1])
        if together < OPPOSED:
            problem = f"falls where {column} rises (correlation {together:.2f}): one has the wrong sign"
            raise error("force", problem, "both positive towards the body")
    outside = np.concatenate([motion[: seen.first], motion[seen.last :]])
    if outside.size >= OUTSIDE_ROWS and float(np.mean(outside)) > float(motion[inside].max()):
        problem = "contact is where it is smallest: the wrong sign"
        raise error(column, problem, "positions positive towards the body")
    free = parameters.sets(CONTACT_POINT)
    if model.scene_of({}) is None and not free:
        start = scene.loading.penetration
        problem = f"never comes to {start:.4g}, where the scene begins contact"
        raise error(column, problem, f"positions counted from first touch, or {CONTACT_POINT} free")
    return [f"{curve.name}: {text}" for text in _warnings(model)]


def of_spring(curve: MeasuredCurve, scene: Scene, parameters: Unknowns) -> list[str]:
    """Warnings about the spring that holds the indenter: the scene's plays no part, or is another one."""
    if scene.machine is None or parameters.sets(*SPRING):
        return []
    stated = scene.machine.stiffness
    if curve.stage is None or curve.stiffness is None:
        text = "positions are those of the indenter: the spring of the scene plays no part"
    elif scene.loading.start == "relaxed":
        text = "a relaxed start drives the indenter by stage and measured force, which is noisy"
    elif abs(curve.stiffness / stated - 1.0) > SAME_SPRING:
        text = f"the spring constant of the record holds, {curve.stiffness:.6g}, not the scene's {stated:.6g}"
    else:
        return []
    return [f"{curve.name}: {text}"]


def _check_columns(model: CurveModel, column: str) -> None:
    """Whether force and motion are of the order of the scene's contact, or of each other's."""
    curve, other = model.curve, exchanged(model.curve)
    as_stated, swapped = _over_expected(model.scene, curve), _over_expected(model.scene, other)
    off, off_swapped = (max(factor, 1.0 / factor) for factor in (as_stated, swapped))
    compared = f"{as_stated:.2g} times the force of the scene's contact, {swapped:.2g} times if they are"
    if off_swapped < PLAUSIBLE:
        problem = ""
        if off >= ABSURD:
            problem = f"looks like the force, and the force like it: swapped? ({compared})"
        elif off_swapped < OUTWEIGHS * off and force_ignores_rest(curve):
            problem = f"rests where the force goes on as before: swapped? ({compared})"
        if problem:
            raise SceneError(column, problem, "each in its column", curve.name)
    if off >= ABSURD:
        problem = f"is {as_stated:.0e} times that of the scene's contact: other units?"
        raise SceneError("force", problem, "force, lengths and times in the units of the scene", curve.name)


def _over_expected(scene: Scene, curve: MeasuredCurve) -> float:
    """Range of the force over the force of the scene's contact at the range of the motion."""
    expected = _elastic_force(scene, float(np.ptp(curve.motion)))
    return float(np.ptp(curve.force)) / expected if expected > 0.0 else np.inf


def _elastic_force(scene: Scene, depth: float) -> float:
    """Force of the glassy contact without adhesion, the order of magnitude."""
    radius = sneddon.contact_radius(scene.indenter, depth)
    force = float(sneddon.force(scene.indenter, radius, scene.material.glassy_plane_modulus))
    return force if force > 0.0 else scene.material.glassy_plane_modulus * radius * depth


def _warnings(model: CurveModel) -> list[str]:
    curve, seen = model.curve, model.features
    found = []
    rows, reach = seen.last - seen.first, float(np.ptp(curve.force))
    if rows < FEW_ROWS:
        found.append(
            f"{rows} rows in contact: the sampling is too coarse for more than one or two parameters"
        )
    kept = seen.compared(curve.time.size)
    steps = np.abs(np.diff(curve.force))[kept[1:] & kept[:-1]]
    if steps.size and float(steps.max()) > COARSE * reach:
        share = 100.0 * float(steps.max()) / reach
        found.append(f"the force changes by {share:.0f} % of its range between two rows: sampling too coarse")
    inside = slice(seen.first, seen.last)
    expected = _elastic_force(model.scene, float(np.ptp(curve.motion[inside])))
    factor = float(np.abs(curve.force[inside] - seen.baseline).max()) / expected
    if not 1.0 / PLAUSIBLE < factor < PLAUSIBLE:
        found.append(f"the force is {factor:.0e} times that of the scene's elastic contact: other units?")
    if seen.noise > LOUD * reach:
        found.append(f"the noise is {100.0 * seen.noise / reach:.0f} % of the range of the force")
    times = [branch.time for branch in model.scene.material.branches]
    if times and min(times) < curve.sampling:
        found.append(
            f"rows every {curve.sampling:.3g}: a relaxation time of {min(times):.3g}, where the fit starts, "
            "is shorter"
        )
    return found
