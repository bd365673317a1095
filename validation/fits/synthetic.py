"""Curves as an instrument would record them, made by a solver: even sampling, noise, unknown zero."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from contact_scene import Machine, Scene, SceneError
from contact_scene.run_control import whole_number
from contact_scene.value_checks import a_string, finite, not_negative, of_class, one_of, positive
from validation.fits.model import run_of
from validation.fits.record import FEWEST_ROWS, MeasuredCurve
from validation.measure.curves import RowCurve
from validation.solvers import REFERENCE, SOLVERS

ROWS = 300
"""Rows in contact where no sampling is asked for."""
BESIDE = 0.15
"""Time recorded before contact and after its loss, over that of contact."""
ON_TIME = 1e-9
"""Distance of two rows, over the duration, at most, that share their time: round-off of times."""
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
    """A curve of a scene whose steps prescribe the penetration, or the stage of a spring.

    With a spring contact is made at constant stage, where the scene begins it. A step that a level ends
    (``until_force``, ...) ends where the run reached it. Once contact is lost the motion goes on as it was.

    Parameters
    ----------
    scene : Scene
        On a spring, if its machine is one.
    noise : float
        Standard deviation of the force over the largest tension (without adhesion: the largest force).
    sampling : float, optional
        Time between two rows; by default 300 rows are in contact.
    seed : int
        Of the noise, and of where between two rows contact begins.
    contact_point : float
        Recorded position of zero penetration.
    baseline, drift : float
        Recorded force without contact at time zero, and its change over time.
    stiffness : float, optional
        Of a spring in the scene's machine: its steps then drive the stage, which is recorded instead of the
        penetration.
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

    Examples
    --------
    >>> curve = cc.synthetic(cc.builtin("cycle-v0.02"), noise=0.01)
    >>> curve.force.shape == curve.time.shape
    True
    """
    of_class(scene, "scene", Scene, "a Scene, as read_scene reads one from a file")
    noise = not_negative(noise, "noise")
    sampling = None if sampling is None else positive(sampling, "sampling")
    contact_point, baseline = finite(contact_point, "contact_point"), finite(baseline, "baseline")
    drift, seed = finite(drift, "drift"), whole_number(seed, "seed", 0)
    a_string(name, "name")
    one_of(solver, "solver", tuple(SOLVERS))
    loading = scene.loading
    if stiffness is not None:
        loading = replace(loading, machine=Machine(positive(stiffness, "stiffness")))
    if loading.compliance > 0.0 and loading.start == "jump-in":  # nothing bends the spring before contact
        loading = replace(loading, start="snap-in")
    steps = [step for _, step in loading.segments()]
    ending = loading.has_triggers or all(math.isfinite(step.end) for step in steps)
    if not steps or not ending or any(step.control == "force" for step in steps):
        allowed = "ramps, holds, oscillations, tables"
        raise SceneError("loading.steps", "do not prescribe the penetration", allowed)
    run = run_of(replace(scene, loading=loading), solver, resolution)
    if run.failure:
        raise SceneError("", f"no curve: {run.failure}", "a scene that the solver finishes")
    spring, end = loading.compliance, float(run.time[-1])
    lasting = np.append(True, np.diff(run.time) > ON_TIME * end)  # rows of a jump share their time
    moments, driven = run.time[lasting], (run.penetration + spring * run.force)[lasting]
    # Time is zero where contact begins, which is at none of the rows: its place is drawn.
    of_begin, of_end = np.random.default_rng([seed, 1]).random(2).tolist()
    step = end / (ROWS - of_end) if sampling is None else sampling
    approaches = loading.start != "relaxed" and driven[1] > driven[0]
    begin = -BESIDE * end - of_begin * step if approaches else 0.0
    rows = math.floor(((1.0 + BESIDE if run.lost is not None else 1.0) * end - begin) / step) + 1
    if not FEWEST_ROWS <= rows <= MOST_ROWS:
        raise SceneError("sampling", f"gives {rows} rows", f"{FEWEST_ROWS} to {MOST_ROWS} rows")
    time = begin + step * np.arange(rows)
    inside = np.clip(time, 0.0, end)
    force = np.where(time == inside, run.values(run.force, inside), 0.0)
    tension, largest = -float(run.force.min()), float(np.abs(run.force).max())
    size = tension if scene.is_adhesive and tension > 0.0 else largest
    force += noise * size * np.random.default_rng(seed).standard_normal(time.size)
    position = RowCurve(moments, driven).values(np.clip(inside, 0.0, moments[-1])) + contact_point
    rates = np.diff(driven) / np.diff(moments)
    position += rates[0] * np.minimum(time, 0.0) + rates[-1] * np.maximum(time - end, 0.0)
    return MeasuredCurve(
        time - time[0],
        force + baseline + drift * time,
        stage=position if spring else None,
        penetration=None if spring else position,
        stiffness=1.0 / spring if spring else None,
        name=name or scene.title or "curve",
    )
