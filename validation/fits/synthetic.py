"""Curves as an instrument would record them, made by a solver: even sampling, noise, unknown zero."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from contact_scene import Loading, Machine, Scene, SceneError
from contact_scene.loading import Segment
from contact_scene.run_control import LoadingCursor, whole_number
from contact_scene.value_checks import a_string, finite, not_negative, of_class, one_of, positive
from validation.fits.fit_run import FitRun, run_of, sampled
from validation.fits.record import FEWEST_ROWS, Array, MeasuredCurve
from validation.solvers import REFERENCE, SOLVERS

ROWS = 300
"""Rows in contact where no sampling is asked for."""
BESIDE = 0.15
"""Time recorded before contact and after its loss, over that of contact."""
MOST_ROWS = 1_000_000
ON_LEVEL = 1e-9
"""Distance of a row from the level that ended its load step, over that of the row before, at most: rounding
of the search for the level. No step that stops short of a level comes so near."""


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
    (``until_force``, ...) ends where the run reached it.

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
    """
    of_class(scene, "scene", Scene, "a Scene, as read_scene reads one from a file")
    noise = not_negative(noise, "noise")
    sampling = None if sampling is None else positive(sampling, "sampling")
    contact_point, baseline = finite(contact_point, "contact_point"), finite(baseline, "baseline")
    drift = finite(drift, "drift")
    seed = whole_number(seed, "seed", 0)
    a_string(name, "name")
    one_of(solver, "solver", tuple(SOLVERS))
    scene = _on_spring(scene, stiffness)
    segments = _driven_segments(scene)
    run = _finished_run(scene, solver, resolution)
    if scene.loading.has_triggers:
        segments = _segments_up_to_levels(scene.loading, run)
    time = _row_times(scene, segments, run, sampling, seed)
    motion = _motion(scene, segments, time)
    force = _exact_force(segments, run, time)
    force += noise * _force_scale(scene, run) * np.random.default_rng(seed).standard_normal(time.size)
    force += baseline + drift * time
    position = motion + contact_point
    spring = scene.loading.compliance > 0.0
    return MeasuredCurve(
        time - time[0],
        force,
        penetration=None if spring else position,
        stage=position if spring else None,
        stiffness=1.0 / scene.loading.compliance if spring else None,
        name=name or scene.title or "curve",
    )


def _on_spring(scene: Scene, stiffness: float | None) -> Scene:
    """The scene with its spring, which nothing bends before contact: contact is made at constant stage."""
    loading = scene.loading
    if stiffness is not None:
        loading = replace(loading, machine=Machine(positive(stiffness, "stiffness")))
    if loading.compliance > 0.0 and loading.start == "jump-in":
        loading = replace(loading, start="snap-in")
    return replace(scene, loading=loading)


def _finished_run(scene: Scene, solver: str, resolution: int | None) -> FitRun:
    """The run whose curve is recorded.

    Raises
    ------
    SceneError
        If the solver does not finish the scene, or there is no contact.
    """
    run = run_of(scene, solver, resolution)
    if run.failure or run.time.size < 2:
        raise SceneError("", f"no curve: {run.failure or 'no contact'}", "a scene that the solver finishes")
    return run


def _force_scale(scene: Scene, run: FitRun) -> float:
    """What noise is relative to: the largest tension of a contact that pulls, else the largest force."""
    tension = -float(run.force.min())
    return tension if scene.is_adhesive and tension > 0.0 else float(np.abs(run.force).max())


def _driven_segments(scene: Scene) -> list[Segment]:
    """The load steps as laws of the position, as far as they are known before the run.

    Raises
    ------
    SceneError
    """
    segments = [segment for _, segment in scene.loading.segments()]
    levels = scene.loading.has_triggers
    driven = all(segment.control != "force" for segment in segments)
    if not segments or not driven or not (levels or all(math.isfinite(one.end) for one in segments)):
        raise SceneError(
            "loading.steps", "do not prescribe the penetration", "ramps, holds, oscillations, tables"
        )
    return segments


def _segments_up_to_levels(loading: Loading, run: FitRun) -> list[Segment]:
    """The load steps of a run, each from the row at which it began to that at which its level was reached.

    Contact lost, they go on without force, up to the first that waits for a level.
    """
    cursor, segments = LoadingCursor(), []
    row, last = 0, run.time.size - 1
    now = float(run.time[0]), float(run.penetration[0]), float(run.force[0])
    while not cursor.done(loading):
        segment = cursor.segment(loading, *now)
        row = _row_at_end(segment, cursor, run, row)
        if row == last and run.lost is not None:
            segments.append(segment)
            if segment.trigger is not None:
                break
            now = segment.end, segment.value(segment.end), 0.0
        else:
            now = float(run.time[row]), float(run.penetration[row]), float(run.force[row])
            segments.append(segment if segment.trigger is None else replace(segment, end=now[0]))
        cursor.step_done()
    return segments


def _row_at_end(segment: Segment, cursor: LoadingCursor, run: FitRun, row: int) -> int:
    """The row at which a load step that began at ``row`` ends; the last one if the run ends before."""
    before = 0.0
    while row < run.time.size - 1 and run.time[row] < segment.end:
        if segment.trigger is not None:
            at = float(run.penetration[row]), float(run.force[row]), float(run.contact_radius[row])
            excess = abs(segment.trigger.excess(*at))
            if cursor.triggered(segment, *at) or excess < ON_LEVEL * before:
                break
            before = excess
        row += 1
    return row


def _row_times(
    scene: Scene, segments: Sequence[Segment], run: FitRun, sampling: float | None, seed: int
) -> Array:
    """Times of the rows, shape (N,): zero where contact begins.

    No instrument has a row at the very moment at which contact begins or is lost: where these fall between
    two rows is drawn.

    Parameters
    ----------
    scene : Scene
    segments : sequence of Segment
    run : FitRun
    sampling : float or None
        Time between two rows.
    seed : int

    Returns
    -------
    ndarray, shape (N,)
    """
    end = float(run.time[-1])
    beside = BESIDE * end
    of_begin, of_end = np.random.default_rng([seed, 1]).random(2).tolist()
    before = scene.loading.start != "relaxed" and segments[0].rate(0.0) > 0.0
    last = end + beside if run.lost is not None else end
    last = min(last, segments[-1].end)
    step = end / (ROWS - of_end) if sampling is None else sampling
    begin = -beside - of_begin * step if before else 0.0
    rows = math.floor((last - begin) / step) + 1
    if not FEWEST_ROWS <= rows <= MOST_ROWS:
        raise SceneError("sampling", f"gives {rows} rows", f"{FEWEST_ROWS} to {MOST_ROWS} rows")
    return np.asarray(begin + step * np.arange(rows), float)


def _motion(scene: Scene, segments: Sequence[Segment], time: Array) -> Array:
    """What the steps prescribe at some times, and before them the first one's straight line."""
    rate = segments[0].rate(0.0)
    motion = np.empty(time.size)
    for index, at in enumerate(time.tolist()):
        if at < 0.0:
            motion[index] = scene.loading.penetration + rate * at
        else:
            segment = next((s for s in segments if at <= s.end), segments[-1])
            motion[index] = segment.value(at)
    return motion


def _exact_force(segments: Sequence[Segment], run: FitRun, time: Array) -> Array:
    """Force without noise, zero without contact."""
    end = float(run.time[-1])
    touching = (time >= 0.0) & (time <= end if run.lost is not None else True)
    corners = np.array([moment for segment in segments for moment in (*segment.kinks, segment.end)])
    return np.where(touching, sampled(run.time, run.force, corners, np.clip(time, 0.0, end)), 0.0)
