"""Curves as an instrument would record them, made by a solver: even sampling, noise, unknown zero."""

from __future__ import annotations

import math

import numpy as np

from contact_scene import Scene, SceneError
from contact_scene.errors import NOT_NEGATIVE, not_negative, number, positive
from validation.fits.fit_run import run_of, sampled
from validation.fits.measured_curve import FEWEST_ROWS, MeasuredCurve
from validation.solvers import REFERENCE

ROWS = 300
"""Rows in contact where no sampling is asked for."""
BESIDE = 0.15
"""Time recorded before contact and after its loss, over that of contact."""
MOST_ROWS = 1_000_000


def synthetic(
    scene: Scene,
    noise: float = 0.01,
    sampling: float | None = None,
    *,
    seed: int = 0,
    contact_point: float = 0.0,
    baseline: float = 0.0,
    drift: float = 0.0,
    stiffness: float | None = None,
    solver: str = REFERENCE,
    resolution: int | None = None,
    name: str = "",
) -> MeasuredCurve:
    """A curve of a scene whose steps prescribe the penetration.

    Parameters
    ----------
    scene : Scene
    noise : float
        Standard deviation of the force over the largest tension (without adhesion: the largest force).
    sampling : float, optional
        Time between two rows; by default 300 rows are in contact.
    seed : int
        Of the noise.
    contact_point : float
        Recorded position of zero penetration.
    baseline, drift : float
        Recorded force without contact at time zero, and its change over time.
    stiffness : float, optional
        Of a spring between stage and indenter: the stage is recorded instead of the penetration.
    solver, resolution : str, int or None
    name : str
        Of the curve; by default the scene's title.

    Returns
    -------
    MeasuredCurve

    Raises
    ------
    SceneError
        If a load step controls the force, or the solver does not finish the scene.
    """
    noise = number(noise, "noise", NOT_NEGATIVE, low=0.0)
    segments = [segment for _, segment in scene.loading.segments()]
    if not segments or any(segment.control != "penetration" for segment in segments):
        raise SceneError(
            "loading.steps", "do not prescribe the penetration", "ramps, holds, oscillations, tables"
        )
    run = run_of(scene, solver, resolution)
    if run.failure or run.time.size < 2:
        raise SceneError("", f"no curve: {run.failure or 'no contact'}", "a scene that the solver finishes")
    end = float(run.time[-1])
    beside = BESIDE * end
    rate = segments[0].rate(0.0)
    begin = -beside if scene.loading.start == "jump-in" and rate > 0.0 else 0.0
    last = end + beside if run.lost is not None else end
    last = min(last, segments[-1].end)
    step = end / ROWS if sampling is None else positive(sampling, "sampling")
    rows = math.floor((last - begin) / step) + 1
    if not FEWEST_ROWS <= rows <= MOST_ROWS:
        raise SceneError("sampling", f"gives {rows} rows", f"{FEWEST_ROWS} to {MOST_ROWS} rows")
    time = begin + step * np.arange(rows)
    motion = np.empty(rows)
    for index, at in enumerate(time.tolist()):
        if at < 0.0:
            motion[index] = scene.loading.penetration + rate * at
        else:
            segment = next((s for s in segments if at <= s.end), segments[-1])
            motion[index] = segment.value(at)
    touching = (time >= 0.0) & (time <= end if run.lost is not None else True)
    inside = np.clip(time, 0.0, end)
    corners = np.array([moment for segment in segments for moment in (*segment.kinks, segment.end)])
    exact = np.where(touching, sampled(run.time, run.force, corners, inside), 0.0)
    tension = -float(run.force.min())
    scale = tension if scene.is_adhesive and tension > 0.0 else float(np.abs(run.force).max())
    force = exact + noise * scale * np.random.default_rng(seed).standard_normal(rows)
    force += baseline + drift * time
    columns = {"time": time - begin, "force": force}
    if stiffness is None:
        columns["penetration"] = motion + contact_point
    else:
        # what the record gives back by stage - force/stiffness is the motion, but for the noise of the force
        columns["stage"] = motion + contact_point + exact / positive(stiffness, "stiffness")
    not_negative(abs(contact_point), "contact_point")
    return MeasuredCurve(**columns, stiffness=stiffness, name=name or scene.title or "curve")  # type: ignore[arg-type]
