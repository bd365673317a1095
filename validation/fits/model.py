"""What a solver says a record should have been, and what is left of the record.

The loading of the scene gives way to the measured motion; its start and the penetration it starts from stay:
contact begins where the motion first comes to that penetration (``jump-in``), or with the first row
(``relaxed``, or a record that begins in contact). Before, and after contact is lost, the force is zero.

A record of the stage drives the stage of a machine with the record's spring: contact is lost at the limit
point of the stage, and is made at constant stage (``snap-in``), as no force bends the spring before. The
noise of the force is nowhere in the motion. Only a ``relaxed`` start, which prescribes the indenter, drives
the indenter by stage and measured force.

Residuals are the force at the measured times, but for the rows around a jump; the contact radius, where it
was measured; and the moments of the jumps. A run that loses contact early, or breaks down, leaves a force of
zero behind: a large residual, no error. Rows that for certain only one of run and record has in contact are
not compared: there the force is wrong by the whole of it, however right the parameters are but for the moment
of the jump, which leads.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from contact_scene import Machine, OutcomeKind, Scene, SceneError, Sphere, Table
from contact_scene.errors import one_line
from contact_scene.scene import with_values
from validation import solvers
from validation.fits.contact import Array, wave_columns, wave_length, white_noise
from validation.fits.moments import Moments, moments, straight_lines
from validation.fits.record import MeasuredCurve
from validation.measure.curves import RowCurve, edge_turns

BACKGROUND = {
    "baseline": ("baseline",),
    "drift": ("drift",),
    "background": ("baseline", "tilt", "drag", "wave_cosine", "wave_sine"),
}
"""Parts of the background by what is said to be free."""
PATH_SHARE = 0.3
"""Force that the straight lines may cost, over its noise: both together are 4 % more than the noise."""
LEAST_RADIUS_NOISE = 1e-4
"""Noise of a measured contact radius over its range, at least."""
OWN_PART = 1e-3
"""Share of a part of the background that the parts before it do not make up, at least: in a record of an
approach alone the drag is a level, and the tilt a drift."""


@dataclass(frozen=True)
class FitRun:
    """The part of a run that a fit compares: its rows, when contact was ``lost``, and why it did not reach
    its end (``failure``; its rows up to there count)."""

    time: Array
    force: Array
    contact_radius: Array
    penetration: Array
    lost: float | None = None
    failure: str = ""

    @cached_property
    def corners(self) -> Array:
        """Times at which the edge sets off or comes to rest."""
        return edge_turns(self.time, self.contact_radius)

    def values(self, column: Array, at: Array) -> Array:
        """A column at some times."""
        return RowCurve(self.time, column, self.corners).values(at)


NO_CONTACT = FitRun(np.array([0.0, 1.0]), *(np.zeros(2),) * 3, lost=0.0)


def run_of(
    scene: Scene,
    solver: str,
    resolution: int | None,
    tolerance: float | None = None,
    max_steps: int | None = None,
) -> FitRun:
    """Solve a scene; what goes wrong is part of the answer."""
    method = solvers.solver(solver)
    method.load()
    try:
        trace = method.solve(scene, resolution, step_tolerance=tolerance, max_steps=max_steps)
    except SceneError as error:
        return replace(NO_CONTACT, failure=str(error))
    except Exception as error:
        if tolerance is not None:  # steps as coarse as a fit can do with may be too coarse for this scene
            return run_of(scene, solver, resolution, None, max_steps)
        return replace(NO_CONTACT, failure=one_line(error))
    columns = trace.time, trace.force, trace.contact_radius, trace.penetration
    if not np.isfinite(columns).all():
        return replace(NO_CONTACT, failure="the run is not finite")
    ended = trace.outcome.finished and trace.outcome.kind is not OutcomeKind.COMPLETED
    failure = "" if trace.outcome.finished else f"{trace.outcome.kind}: {trace.outcome.reason}"
    if trace.time.size < 2:
        return replace(NO_CONTACT, failure=failure or "no contact")
    return FitRun(*columns, float(trace.time[-1]) if ended else None, failure)


@dataclass(frozen=True)
class Prediction:
    """A run beside a curve: the ``force`` at its rows without background, shape (N,); residuals of force,
    radius and moments over their deviations, which of them ``hold``, and which are of rows in contact, shape
    (R,) each; why it ended early. A row that comes into contact or loses it on the way to another prediction
    has a derivative on either side only."""

    force: Array
    residuals: Array
    hold: NDArray[np.bool_]
    touching: NDArray[np.bool_]
    failure: str = ""


@dataclass(frozen=True)
class CurveModel:
    """A curve, the scene that is to explain it, and the measured motion as straight lines; ``within`` is the
    share of the range of the force, and of the time of contact, that the model may miss beside the noise."""

    curve: MeasuredCurve
    scene: Scene
    moments: Moments
    knots: Array
    heights: Array
    within: float = 0.0

    @classmethod
    def of(cls, curve: MeasuredCurve, scene: Scene, within: float = 0.0) -> CurveModel:
        """Prepare a curve."""
        seen, reach = moments(curve), float(np.ptp(curve.position))
        if curve.indenter_radius is not None:
            if not isinstance(scene.indenter, Sphere):
                allowed = "a scene with a sphere, or a file without a radius"
                problem = f"stated for a {scene.indenter.shape}"
                raise SceneError("indenter_radius", problem, allowed, curve.name)
            scene = replace(scene, indenter=Sphere(curve.indenter_radius))
        scene, motion = _driven(curve, scene, seen)
        if reach == 0.0:
            raise SceneError(curve.driven, "does not move", "an approach or a retraction", curve.name)
        whole = cls(curve, scene, seen, curve.time, motion, within)
        slope = float(np.ptp(curve.force)) / reach
        tolerance = PATH_SHARE * whole.allowed / slope if slope > 0.0 else reach
        try:
            knots, heights = straight_lines(curve.time, motion, tolerance)
        except SceneError as error:
            raise error.in_file(curve.name) from None
        return replace(whole, knots=knots, heights=heights)

    @cached_property
    def allowed(self) -> float:
        """Standard deviation of a residual of the force: the noise, and what the model may miss."""
        return float(np.hypot(self.moments.noise, self.within * np.ptp(self.curve.force)))

    @cached_property
    def radius_noise(self) -> float | None:
        """Standard deviation of the contact radius, where it was measured."""
        radius, seen = self.curve.contact_radius, self.moments
        if radius is None:
            return None
        inside = radius[seen.first : seen.last]
        noise = white_noise(inside if inside.size > 4 else radius)
        return max(noise, LEAST_RADIUS_NOISE * float(np.ptp(radius))) or None

    def scene_of(self, values: Mapping[str, float], contact_point: float = 0.0) -> tuple[Scene, float]:
        """The scene to solve with these numbers by path, and the time its clock starts at; ``SceneError`` if
        there is none, or the motion never comes to contact."""
        scene = with_values(self.scene, values)
        heights = self.heights - contact_point
        first, begin = scene.loading.penetration, float(self.knots[0])
        if scene.loading.start == "relaxed" or heights[0] >= first:
            first = float(heights[0])
        else:
            touch = first_passing(self.knots, heights, first)
            if touch is None:
                problem = f"never comes to {first:.4g}, where the scene begins contact"
                allowed = "positions counted from first touch, or contact_point free"
                raise SceneError(self.curve.driven, problem, allowed)
            begin = touch
        later = self.knots > begin
        table = Table((begin, *self.knots[later].tolist()), (first, *heights[later].tolist()))
        return replace(scene, loading=replace(scene.loading, penetration=first, steps=(table,))), begin

    def prediction(self, run: FitRun, begin: float, time_offset: float = 0.0) -> Prediction:
        """A run whose clock starts at ``begin``, at the rows of the curve; the force is recorded later than
        the motion by ``time_offset``. Contact that never ends does so where the record ends."""
        curve, seen = self.curve, self.moments
        at, first = curve.time - time_offset - begin, begin + time_offset
        ends = run.lost if run.lost is not None else run.time[-1] if run.failure else np.inf
        touching, inside = (at >= 0.0) & (at < ends), np.clip(at, 0.0, run.time[-1])
        lost = float(curve.time[-1]) if run.lost is None else first + run.lost
        compared = [(run.force, curve.force, self.allowed)]
        if curve.contact_radius is not None and self.radius_noise is not None:
            compared.append((run.contact_radius, curve.contact_radius, self.radius_noise))
        columns = [np.where(touching, run.values(one, inside), 0.0) for one, *_ in compared]
        left = [(one - of) / apart for one, (_, of, apart) in zip(columns, compared, strict=True)]
        duration = float(curve.time[min(seen.last, curve.time.size - 1)] - curve.time[seen.first])
        of_jumps = [
            ((first if begins else lost) - jump.time) / np.hypot(jump.deviation, self.within * duration)
            for begins, jump in seen.timed
        ]

        def of_residuals(rows: NDArray[np.bool_], of_jump: bool) -> NDArray[np.bool_]:
            return np.pad(np.tile(rows, len(left)), (0, len(of_jumps)), constant_values=of_jump)

        recorded, known = seen.contact
        hold = of_residuals(seen.compared & ((recorded == touching) | ~known), True)
        residuals, in_contact = np.concatenate([*left, of_jumps]), of_residuals(touching, False)
        return Prediction(columns[0], residuals, hold, in_contact, run.failure)

    def background(self, free: Sequence[str]) -> dict[str, Array]:
        """Parts of the background, as far as each is more than the parts before it make up, shape (N,)."""
        asked = {part for name in free for part in BACKGROUND.get(name, ())}
        curve, ahead = self.curve, slice(0, self.moments.first)
        parts = {"baseline" if name == "level" else name: c for name, c in curve.cycle.background.items()}
        if "wave_cosine" in asked:  # that which the rows before contact show over level and tilt
            line = np.array([parts["baseline"], parts["tilt"]]).T[ahead]
            left = curve.force[ahead] - line @ least_squares(line, curve.force[ahead])
            waves = wave_columns(curve.position, wave_length(curve.position[ahead], left))
            parts |= dict(zip(("wave_cosine", "wave_sine"), waves, strict=False))
        found: dict[str, Array] = {}
        for name, column in parts.items():
            before = np.array(list(found.values())).reshape(-1, column.size).T
            left = column - before @ least_squares(before, column)
            if name in asked and np.linalg.norm(left) > OWN_PART * np.linalg.norm(column):
                found[name] = column
        return found


def first_passing(x: Array, y: Array, level: float) -> float | None:
    """Where straight lines first come from below to a level, if they do."""
    above = np.flatnonzero(y >= level)
    ends = slice(int(above[0]) - 1, int(above[0]) + 1) if above.size else None
    return None if ends is None else float(np.interp(level, y[ends], x[ends]))


def least_squares(columns: Array, values: Array) -> Array:
    """Multiples of the columns that come closest to the values, whatever the sizes of the columns."""
    size = np.maximum(np.abs(columns).max(axis=0, initial=0.0), np.finfo(float).tiny)
    found = np.linalg.lstsq(columns / size, values, rcond=None)[0]
    return found / (size if values.ndim == 1 else size[:, None])


def _driven(curve: MeasuredCurve, scene: Scene, seen: Moments) -> tuple[Scene, Array]:
    """The scene with the machine and the start of a record, and the motion that drives it, shape (N,)."""
    loading = replace(scene.loading, machine=None)
    if curve.stage is None or curve.stiffness is None:
        return replace(scene, loading=loading), curve.motion
    if loading.start == "relaxed":
        return replace(scene, loading=loading), curve.motion + seen.background / curve.stiffness
    loading = replace(loading, start="snap-in", machine=Machine(curve.stiffness))
    return replace(scene, loading=loading), curve.stage
