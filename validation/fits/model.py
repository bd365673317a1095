"""What a record asks of a scene, and what a run of that scene leaves of the record.

The loading of the scene gives way to the measured motion; its start and the penetration it starts from stay:
contact begins where the motion first comes to that penetration (``jump-in``), or with the first row
(``relaxed``, or a record that begins in contact). Before, and after contact is lost, the force is zero. A
record of the stage drives the stage of a machine with the record's spring: contact is lost at the limit point
of the stage, and is made at constant stage (``snap-in``), as no force bends the spring before; the noise of
the force is nowhere in the motion. Only a ``relaxed`` start, which prescribes the indenter, drives the
indenter by stage and measured force.

On the retraction contact is lost; on the approach, read backwards in time, it is lost too. Where the force
jumps there, its moment lies between two rows. All other rows without contact share one background.

A solver follows the motion as straight lines: recorded positions have noise, and every row would be a kink of
the loading. The lines begin with the rows that Ramer (Comput. Graph. Image Process. 1, 244, 1972) keeps
within a tolerance; a corner between two straight stretches moves to where they meet, and all heights are then
those of least squares.

Residuals are the force at the measured times, but for the rows around a jump; the contact radius, where it
was measured; and the moments of the jumps. A run that loses contact early, or breaks down, leaves a force of
zero behind: a large residual, no error. Rows that for certain only one of run and record has in contact are
not compared: there the force is wrong by the whole of it, however right the parameters are but for the moment
of the jump, which leads. The background (level, drift, tilt, drag, a wave) is linear: it costs no run, and
every run has the one that makes its residuals least (Golub and Pereyra, SIAM J. Numer. Anal. 10, 413, 1973).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from contact_scene import Machine, OutcomeKind, Scene, SceneError, Sphere, Table
from contact_scene.errors import one_line
from contact_scene.scene import with_values
from validation import solvers
from validation.fits.contact import Array, least_squares, wave_columns, wave_length, white_noise
from validation.fits.features import FEWEST, JUMP, background, loss_of_contact
from validation.fits.record import MeasuredCurve
from validation.measure.curves import RowCurve, edge_turns

OVER_NEIGHBOURS = 3.0
"""Change between two rows over that beside it on the side in contact, from which it is a jump for certain: a
smooth curve has them about equal."""
OFF = 4.0
"""Deviations of the noise from which a row is off the background, or its line: one in 16 000 by chance."""
EXCLUDED, FEWEST_ROWS = 2, 6
"""Rows on both sides of a jump that are not compared, as the moment of the jump has a residual of its own;
and of an approach or a retraction in which a moment is looked for."""
LEAST_NOISE, LEAST_RADIUS_NOISE, MEDIAN_EFFICIENCY = 1e-6, 1e-4, 0.37
"""Noise over the range of the force and of a measured contact radius, at least, so that weights remain
finite; and variance of the standard deviation over that of the median magnitude, both of as many normal
numbers."""
SMALLEST = 1e-6
"""Tolerance of straight lines over the range of the motion, at least: round-off of recorded numbers."""
CORNER_ROWS, MOST_KNOTS = 3, 400
"""Rows between two straight stretches, at most, that belong to one corner, and rows inside a stretch, at
least, from which its direction is known well enough to find its corners; and lines of a path: a motion that
needs more is not resolved by its rows, or is all noise."""
PARTS = {
    "baseline": ("baseline",),
    "drift": ("drift",),
    "background": ("baseline", "tilt", "drag", "wave_cosine", "wave_sine"),
}
"""Parts of the background by what is said to be free."""
PATH_SHARE = 0.3
"""Force that the straight lines may cost, over its noise: both together are 4 % more than the noise."""
OWN_PART = 1e-3
"""Share of a part of the background that the parts before it do not make up, at least: in a record of an
approach alone the drag is a level, and the tilt a drift."""


class Jump(NamedTuple):
    """A jump of the force between two rows: the middle of its interval, the standard deviation of a moment in
    it, and whether contact begins or ends there for certain, or came to nothing on a steep, smooth curve."""

    time: float
    deviation: float
    timed: bool


@dataclass(frozen=True)
class Moments:
    """What a record shows of itself: the force without contact of every row; degrees of freedom from which
    the noise is known, infinite if stated; ``first`` row in contact, and the row after the ``last``; which
    rows, shape (N,), are ``compared`` with a model, all but those around the jumps, and ``certain`` to be in
    contact or not, by a jump."""

    noise: float
    noise_degrees: float
    noise_source: str
    background: Array
    first: int
    last: int
    snap_in: Jump | None
    pull_off: Jump | None
    compared: NDArray[np.bool_]
    certain: NDArray[np.bool_]

    @property
    def timed(self) -> dict[bool, Jump]:
        """Jumps whose moments are compared, by whether contact begins there."""
        both = ((True, self.snap_in), (False, self.pull_off))
        return {begins: jump for begins, jump in both if jump is not None and jump.timed}


def moments(curve: MeasuredCurve) -> Moments:
    """Read them off a curve, at both ends of contact from outside inward."""
    cycle, force, rows = curve.cycle, curve.force, curve.time.size
    least = LEAST_NOISE * float(np.ptp(force))
    noise, source = max(white_noise(force), least), "differences of neighbouring rows"
    degrees, free, ends = MEDIAN_EFFICIENCY * rows, np.zeros(rows, bool), []
    for part, inward in (
        (cycle.approach[::-1], np.arange(rows)),
        (cycle.retraction, np.arange(rows)[::-1]),
    ):
        enough = part.size >= FEWEST_ROWS
        row = loss_of_contact(curve.position[part], force[part], noise)[0] if enough else None
        outside = 0 if row is None else int(inward[part[row]]) + 1
        jump = _jump(curve.time[inward], force[inward], outside, noise)
        free[inward[: outside if jump else _free_rows(force[inward[:outside]])]] = True
        ends.append((inward, outside, jump))
    base = background(cycle, free)
    if free.sum() > FEWEST:
        degrees = float(free.sum() - len(base.parts))
        noise = max(base.rough * float(np.sqrt(free.sum() / degrees)), least)
        source = f"baseline, {free.sum()} rows"
    if curve.noise is not None:
        noise, source, degrees = curve.noise, "stated", np.inf
    level = base.force if free.any() else np.zeros(rows)
    off, compared, found = np.abs(force - level) > OFF * noise, np.ones(rows, bool), []
    for inward, outside, jump in ends:
        while jump is None and outside and off[inward[outside - 1]]:
            outside -= 1
        if jump is not None:
            compared[inward[max(outside - EXCLUDED, 0) : outside + EXCLUDED]] = False
        found.append((outside, jump, jump is not None and jump.timed))
    (first, snap_in, begins), (behind, pull_off, stops) = found
    certain = np.where(2 * np.arange(rows) <= first + rows - behind, begins, stops)
    seen = noise, degrees, source, level, first, rows - behind
    return Moments(*seen, snap_in, pull_off, compared, certain)


def _free_rows(force: Array) -> int:
    """Rows of a baseline in which the smooth contact that begins behind it cannot hide in the noise: not back
    to the last row on the other side of the level, nor as far again before that."""
    if force.size < FEWEST_ROWS:
        return 0
    over = force - float(np.median(force[: force.size // 2]))
    other = np.flatnonzero(over * over[-1] < 0.0)
    return max(2 * int(other[-1]) + 1 - force.size, 0) if other.size else 0


def _jump(time: Array, force: Array, outside: int, noise: float) -> Jump | None:
    """The jump behind as many rows as are outside contact, if the force jumps there."""
    if not 0 < outside < force.size - 1:
        return None
    change, neighbour = np.abs(np.diff(force[outside - 1 : outside + 2])).tolist()
    if change < JUMP * noise:
        return None
    before, behind = time[outside - 1 : outside + 1].tolist()
    timed = bool(change >= OVER_NEIGHBOURS * (neighbour + noise))
    return Jump(0.5 * (before + behind), abs(behind - before) / float(np.sqrt(12.0)), timed)


def straight_lines(time: Array, position: Array, tolerance: float) -> tuple[Array, Array]:
    """Times and heights of the corners of a path that no row misses by more than tolerance and noise."""
    rows = kept_rows(time, position, max(tolerance, SMALLEST * float(np.ptp(position))))
    if rows.size > MOST_KNOTS:
        problem = f"the motion needs {rows.size} straight lines"
        raise SceneError("penetration", problem, f"at most {MOST_KNOTS}: smoother or finer rows")
    stretches: list[tuple[int, int, float, float]] = []
    for begin, end in pairwise(rows.tolist()):
        inner = slice(begin + 1, end)
        if end - begin - 1 >= CORNER_ROWS:
            middle = float(time[inner].mean())
            rate, level = np.polyfit(time[inner] - middle, position[inner], 1)
            stretches.append((begin, end, float(rate), float(level) - float(rate) * middle))
    knots, moved = set(rows.tolist()), []
    for (_, left, rate, level), (right, _, next_rate, next_level) in pairwise(stretches):
        turn = rate - next_rate
        meeting = (next_level - level) / turn if turn else np.inf
        if right - left <= CORNER_ROWS and time[left - 1] <= meeting <= time[right + 1]:
            knots -= set(range(left, right + 1))
            moved.append(meeting)
    places = np.sort(np.concatenate([time[sorted(knots)], moved]))
    # Heights as recorded where no row tells.
    hats = np.array([np.interp(time, places, hat) for hat in np.eye(places.size)])
    recorded = np.interp(places, time, position)
    misses = np.linalg.lstsq(hats @ hats.T, hats @ (position - recorded @ hats), rcond=None)[0]
    return places, np.asarray(recorded + misses, float)


def kept_rows(time: Array, position: Array, tolerance: float) -> NDArray[np.intp]:
    """Rows between which straight lines miss no row by more than tolerance and noise."""
    within = max(tolerance, OFF * white_noise(position))
    keep, stack = {0, time.size - 1}, [(0, time.size - 1)]
    while stack:
        begin, end = stack.pop()
        line = np.interp(time[begin:end], time[[begin, end]], position[[begin, end]])
        miss = np.abs(position[begin:end] - line)
        worst = begin + int(np.argmax(miss))
        if miss[worst - begin] > within:
            keep.add(worst)
            stack += [(begin, worst), (worst, end)]
    return np.array(sorted(keep))


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
class CurveModel:
    """A curve and the scene that is to explain it; ``within`` is the share of the range of the force, and of
    the time of contact, that the model may miss beside the noise; parts of the background are ``free``."""

    curve: MeasuredCurve
    scene: Scene
    moments: Moments
    motion: Array
    within: float = 0.0
    free: Sequence[str] = ()

    @classmethod
    def of(
        cls, curve: MeasuredCurve, scene: Scene, within: float = 0.0, free: Sequence[str] = ()
    ) -> CurveModel:
        """Prepare a curve: the scene has its sphere, its spring and its start of contact."""
        if curve.indenter_radius is not None:
            if not isinstance(scene.indenter, Sphere):
                allowed = "a scene with a sphere, or a file without a radius"
                problem = f"stated for a {scene.indenter.shape}"
                raise SceneError("indenter_radius", problem, allowed, curve.name)
            scene = replace(scene, indenter=Sphere(curve.indenter_radius))
        if np.ptp(curve.position) == 0.0:
            raise SceneError(curve.driven, "does not move", "an approach or a retraction", curve.name)
        seen, loading, motion = moments(curve), replace(scene.loading, machine=None), curve.position
        if curve.stage is not None and curve.stiffness is not None:
            if loading.start == "relaxed":
                motion = curve.motion + seen.background / curve.stiffness
            else:
                loading = replace(loading, start="snap-in", machine=Machine(curve.stiffness))
        model = cls(curve, replace(scene, loading=loading), seen, motion, within, free)
        try:
            assert model.path
        except SceneError as error:
            raise error.in_file(curve.name) from None
        return model

    @cached_property
    def path(self) -> tuple[Array, Array]:
        """Times and heights of the straight lines that drive the scene."""
        reach = float(np.ptp(self.curve.position))
        slope = float(np.ptp(self.curve.force)) / reach
        tolerance = PATH_SHARE * self.allowed / slope if slope > 0.0 else reach
        return straight_lines(self.curve.time, self.motion, tolerance)

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

    @cached_property
    def parts(self) -> dict[str, Array]:
        """Free parts of the background, as far as each is more than the parts before it make up, over the
        deviation of a residual, shape (R,)."""
        asked = {part for name in self.free for part in PARTS.get(name, ())}
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
        more = (curve.time.size if self.radius_noise else 0) + len(self.moments.timed)
        return {name: np.pad(column / self.allowed, (0, more)) for name, column in found.items()}

    def scene_of(self, values: Mapping[str, float], contact_point: float = 0.0) -> tuple[Scene, float]:
        """The scene to solve with these numbers by path, and the time its clock starts at; ``SceneError`` if
        there is none, or the motion never comes to contact."""
        scene, (knots, heights) = with_values(self.scene, values), self.path
        heights = heights - contact_point
        first, begin = scene.loading.penetration, float(knots[0])
        if scene.loading.start == "relaxed" or heights[0] >= first:
            first = float(heights[0])
        else:
            touch = first_passing(knots, heights, first)
            if touch is None:
                problem = f"never comes to {first:.4g}, where the scene begins contact"
                allowed = "positions counted from first touch, or contact_point free"
                raise SceneError(self.curve.driven, problem, allowed)
            begin = touch
        later = knots > begin
        table = Table((begin, *knots[later].tolist()), (first, *heights[later].tolist()))
        return replace(scene, loading=replace(scene.loading, penetration=first, steps=(table,))), begin

    def beside(self, run: FitRun, begin: float, time_offset: float = 0.0, zero: float = 0.0) -> FittedCurve:
        """The curve beside a run whose clock starts at ``begin``; the force is recorded later than the motion
        by ``time_offset``. Contact that never ends does so where the record ends."""
        curve, seen = self.curve, self.moments
        at, first = curve.time - time_offset - begin, begin + time_offset
        ends = run.lost if run.lost is not None else run.time[-1] if run.failure else np.inf
        touching, inside = (at >= 0.0) & (at < ends), np.clip(at, 0.0, run.time[-1])
        force = np.where(touching, run.values(run.force, inside), 0.0)
        left = [(force - curve.force) / self.allowed]
        if curve.contact_radius is not None and self.radius_noise is not None:
            radius = np.where(touching, run.values(run.contact_radius, inside), 0.0)
            left.append((radius - curve.contact_radius) / self.radius_noise)
        duration = float(curve.time[min(seen.last, curve.time.size - 1)] - curve.time[seen.first])
        lost = float(curve.time[-1]) if run.lost is None else first + run.lost
        of_jumps = [
            ((first if begins else lost) - jump.time) / np.hypot(jump.deviation, self.within * duration)
            for begins, jump in seen.timed.items()
        ]
        place, count = np.arange(at.size), len(of_jumps)
        recorded = (place >= seen.first) & (place < seen.last)
        rows = seen.compared & ((recorded == touching) | ~seen.certain)
        hold = np.pad(np.tile(rows, len(left)), (0, count), constant_values=True)
        raw = np.where(hold, np.concatenate([*left, of_jumps]), 0.0)
        columns = np.reshape([np.where(hold, one, 0.0) for one in self.parts.values()], (-1, raw.size)).T
        in_contact = np.pad(np.tile(touching, len(left)), (0, count))
        return FittedCurve(raw, columns, in_contact, hold, self, force, zero, run.failure)


@dataclass(frozen=True)
class Residuals:
    """Residuals ``raw`` (R,) over their deviations, with a background of some ``columns`` (R, Q); which of
    them ``hold``, and which are of rows in contact: a row that comes into contact or loses it on the way
    to other residuals has a derivative on either side only."""

    raw: Array
    columns: Array
    touching: NDArray[np.bool_]
    hold: NDArray[np.bool_]

    @cached_property
    def background(self) -> Array:
        """How much there is of each column, shape (Q,), for the residuals to be least."""
        return -least_squares(self.columns, self.raw)

    @cached_property
    def values(self) -> Array:
        """Residuals over that background."""
        return np.asarray(self.raw + self.columns @ self.background)

    @property
    def independent(self) -> Array:
        """Weights with which residuals count as many as those of them that are independent."""
        return np.ones(self.raw.size)


@dataclass(frozen=True)
class FittedCurve(Residuals):
    """A curve beside a run: the force of the run at its rows without background, shape (N,), the recorded
    position of zero penetration, and why the run ended early."""

    model: CurveModel
    of_run: Array
    zero: float = 0.0
    failure: str = ""

    @property
    def curve(self) -> MeasuredCurve:
        """The record."""
        return self.model.curve

    @property
    def compared(self) -> NDArray[np.bool_]:
        """Rows that take part."""
        return self.hold[: self.of_run.size]

    @property
    def own(self) -> Array:
        """Residuals of the force, of these rows."""
        return self.values[: self.of_run.size][self.compared]

    @property
    def force(self) -> Array:
        """Fitted force with its background, shape (N,)."""
        parts = np.reshape(
            [one[: self.of_run.size] for one in self.model.parts.values()], (-1, self.of_run.size)
        )
        return np.asarray(self.of_run + self.model.allowed * (self.background @ parts))

    @property
    def missed(self) -> float:
        """Root mean square of the force that the model misses."""
        return rms(self.own) * self.model.allowed

    @property
    def rows_correlated(self) -> float:
        """Over how many rows residuals are correlated."""
        return correlation_length(self.own)

    @property
    def independent(self) -> Array:
        weights = np.ones(self.raw.size)
        weights[: self.of_run.size] /= np.sqrt(self.rows_correlated)
        return weights

    @property
    def stretch(self) -> slice:
        """The rows that the model misses most."""
        return misfitting_stretch(self.values[: self.of_run.size])

    @property
    def numbers(self) -> dict[str, Any]:
        """Noise and misfit, as ``fit.json`` has them; and first and last time of what is missed most."""
        times = self.curve.time[self.stretch]
        return {
            "noise": self.model.moments.noise,
            "noise_source": self.model.moments.noise_source,
            "misfit_over_noise": self.missed / self.model.moments.noise,
            "rms_over_range": self.missed / float(np.ptp(self.curve.force)),
            "rows_correlated": self.rows_correlated,
            "worst_stretch": (float(times[0]), float(times[-1])) if times.size else None,
        }


def correlation_length(residuals: Array) -> float:
    """Rows that tell as much as one: twice the sum of the autocorrelation, up to what white noise has."""
    rows = residuals.size
    product = np.fft.irfft(np.abs(np.fft.rfft(residuals, 2 * rows)) ** 2)[:rows]
    if rows < 2 or product[0] <= 0.0:
        return 1.0
    correlations = product[1:] / product[0]
    below = correlations < 2.0 / np.sqrt(rows)
    last = int(np.argmax(below)) if below.any() else rows - 1
    return float(1.0 + 2.0 * correlations[:last].sum())


def misfitting_stretch(residuals: Array) -> slice:
    """The rows whose squares exceed twice the variance of residuals by most in all (Bentley, Commun. ACM 27,
    865, 1984); none if no row does."""
    total = np.concatenate([[0.0], np.cumsum(residuals**2 - 2.0)])
    end = int(np.argmax(total - np.minimum.accumulate(total)))
    return slice(int(np.argmin(total[: end + 1])), end)


def first_passing(x: Array, y: Array, level: float) -> float | None:
    """Where straight lines first come from below to a level, if they do."""
    above = np.flatnonzero(y >= level)
    ends = slice(int(above[0]) - 1, int(above[0]) + 1) if above.size else None
    return None if ends is None else float(np.interp(level, y[ends], x[ends]))


def rms(values: Array) -> float:
    """Root mean square."""
    return float(np.sqrt(np.mean(values**2)))
