"""``solve(scene, options) -> Trace``, with estimates of its errors.

Signs and units are the scene's: penetration and pressure positive downwards and in compression.

**Error estimates** are what a run differs by from a second one at ten times the tolerance. The second run is
the worse of the two, about by the ratio of the tolerances: the difference is its error, and so bounds that of
the first. Scalars of two runs can agree by accident; curves cannot. The pull-off is therefore held to be no
better than the curves are in the mean, nor is the loss of a contact that ends in a point. At a limit point
the time is stationary: there it is no better than the force is at half the rows. A curve ends no better than
when contact is lost.

A curve that falls through a limit point has an infinite slope there, and the difference of two such curves at
equal times is no error. So curves are compared by their distance in a plane where time and value both count
relative to their ranges; the second run has a row at each time of the first.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from contact_scene import COLUMNS, OutcomeKind, RunMonitor, Scene, Trace
from contact_scene.run_control import MAX_STEPS, moments, single_threaded, whole_number
from contact_scene.value_checks import number
from validation.reference.path.numerics import NEGLIGIBLE
from validation.reference.path.run import PathRun

Array = NDArray[np.float64]
Columns = Mapping[str, Array]
NAME = "reference"
DEFAULT_RESOLUTION = 16
"""Resolution of the default tolerance."""
DEFAULT_TOLERANCE = 1e-5
"""Misprediction of a step, in a tenth of the largest radius or in the time since the leg began."""
COARSER = 10.0
"""Tolerance of the second run, in that of the first."""
LEAST_LOOP = 1e-3
"""Work of a loop that almost closes, in the work done to and fro, to which errors are still relative."""
CHUNK = 64
"""Rows that are compared with all sides of the other polygon at once."""


@dataclass(frozen=True)
class Options:
    """How finely to step, and what to report.

    Parameters
    ----------
    resolution : int, optional
        Another word for the tolerance, which falls with its square; 1 or more. Default 16.
    tolerance : float, optional
        How far a step is to be mispredicted along the path of the edge, relative to the scales that the path
        has there, and how far force and radius may leave the straight line between rows, relative to the
        largest. Default 1e-5.
    stop_times, profile_times : tuple of float
        Times that get a row, and those at which surface profiles are returned, too; ignored outside the run.
        No other number depends on them.
    max_steps : int
        Budget of accepted and rejected steps.
    estimate_errors : bool
        Run a second time at ten times the tolerance, and put estimates of the relative errors into
        ``Trace.errors``.

    Raises
    ------
    SceneError
        If an option is not what it has to be.
    """

    resolution: int | None = None
    tolerance: float | None = None
    stop_times: tuple[float, ...] = ()
    profile_times: tuple[float, ...] = ()
    max_steps: int = MAX_STEPS
    estimate_errors: bool = False

    def __post_init__(self) -> None:
        if self.resolution is not None:
            object.__setattr__(self, "resolution", whole_number(self.resolution, "resolution", 1))
        if self.tolerance is not None:
            number(self.tolerance, "tolerance", "0 < tolerance < 1", low=0.0, high=1.0, open=True)
        object.__setattr__(self, "max_steps", whole_number(self.max_steps, "max_steps", 1))
        object.__setattr__(self, "stop_times", moments(self.stop_times, "stop_times"))
        object.__setattr__(self, "profile_times", moments(self.profile_times, "profile_times"))

    @property
    def step_tolerance(self) -> float:
        """The tolerance that is asked for, in one way or the other."""
        if self.tolerance is not None:
            return self.tolerance
        return DEFAULT_TOLERANCE * (DEFAULT_RESOLUTION / (self.resolution or DEFAULT_RESOLUTION)) ** 2


@single_threaded()
def solve(
    scene: Scene,
    options: Options | None = None,
    progress: Callable[[float], None] | None = None,
    monitor: RunMonitor | None = None,
) -> Trace:
    """Run a scene.

    Parameters
    ----------
    scene : Scene
    options : Options, optional
    progress : callable(fraction), optional
        Called after each step with the share of the loading that is done.
    monitor : RunMonitor, optional
        Asked between two steps whether the run is to continue; not in the second run for error estimates.

    Returns
    -------
    Trace
        Extra columns ``stress_intensity_factor``, ``energy_release_rate``, ``branch_dissipation``,
        ``separation_energy``. Straight lines through the rows are accurate to the tolerance (to 12
        tolerances under a load that is curved). If contact is lost the last row is the free surface (force
        and radius 0) at the time of the row before, unless a given force takes the indenter with it: what
        that works no row can tell. If contact shrinks to the process zone the last row is that contact.

    Raises
    ------
    SceneError
        A process zone longer than the contact it starts from.
    """
    options = options or Options()
    began = time.perf_counter()
    asked = options.stop_times, options.profile_times, options.max_steps
    run = PathRun(scene, options.step_tolerance, *asked, progress, monitor)
    columns, outcome = run.run()
    errors: dict[str, float] = {}
    if options.estimate_errors and outcome.finished:
        times = tuple(columns["time"].tolist())
        coarser = PathRun(scene, COARSER * run.tolerance, times, max_steps=options.max_steps)
        others, ending = coarser.run()
        if ending.kind is not OutcomeKind.BREAKDOWN:
            detached = {outcome.kind, ending.kind} == {OutcomeKind.DETACHED}
            errors = estimated_errors(columns, others, detached)
    return Trace(
        solver=NAME,
        **{name: columns[name] for name in COLUMNS},
        outcome=outcome,
        counters=run.counters,
        extra={name: column for name, column in columns.items() if name not in COLUMNS},
        events=tuple(run.recorder.events) if run.begun else (),
        located=tuple(run.recorder.located) if run.begun else (),
        profiles=tuple(run.profiles),
        errors=errors,
        wall_seconds=time.perf_counter() - began,
    )


def estimated_errors(fine: Columns, coarse: Columns, detached: bool = False) -> dict[str, float]:
    """Relative errors of the finer run.

    ``pull_off_force`` and ``loop_energy`` as they are, ``contact_radius`` and ``force`` the largest over the
    run, relative to the largest; of runs that both lose contact (``detached``) also ``detachment_time`` and
    ``detachment_penetration``, relative to the largest. Columns are those of the traces by name; times of
    ``fine`` are rows of ``coarse``, too.
    """
    errors = {}
    apart = {name: distances(fine, coarse, name) for name in ("contact_radius", "force")}
    mean = max(map(_root_mean_square, apart.values()))
    turnover = float(np.abs(np.diff(fine["external_work"])).sum())
    if turnover > 0.0:
        loop = abs(float(fine["external_work"][-1]))
        errors["loop_energy"] = _work_apart(fine, coarse) / max(loop, LEAST_LOOP * turnover)
    tension = [max(float(-run["force"].min()), 0.0) for run in (fine, coarse)]
    if tension[0] > NEGLIGIBLE * float(np.abs(fine["force"]).max()):
        errors["pull_off_force"] = max(abs(tension[0] - tension[1]) / tension[0], mean)
    if detached:
        ends = [_end_of_contact(run) for run in (fine, coarse)]
        stationary = fine["contact_radius"][ends[0]] > 0.0
        least = float(np.median(apart["force"])) if stationary else mean
        for name in ("time", "penetration"):
            values = [float(run[name][end]) for run, end in zip((fine, coarse), ends, strict=True)]
            largest = float(np.abs(fine[name]).max())
            if largest > 0.0:
                errors[f"detachment_{name}"] = max(abs(values[0] - values[1]) / largest, least)
    for name, each in apart.items():
        errors[name] = max(float(each.max()), errors.get("detachment_time", 0.0))
    return errors


def _end_of_contact(run: Columns) -> int:
    """The last row in contact; that after it where contact ends in a point, which takes time."""
    last = int(np.flatnonzero(run["contact_radius"] > 0.0)[-1])
    return last if run["time"][last] == run["time"][-1] else len(run["time"]) - 1


def _work_apart(fine: Columns, coarse: Columns) -> float:
    """What the works of two runs differ by at the end, at least in the mean along the way.

    Not the most: within a load jump, whose rows have one time, the coarser run may have none at its turn.
    """
    works = fine["external_work"], coarse["external_work"]
    along = _root_mean_square(distances(fine, coarse, "external_work")) * float(np.abs(works[0]).max())
    return max(along, abs(float(works[0][-1] - works[1][-1])))


def _root_mean_square(values: Array) -> float:
    return float(np.sqrt(np.mean(values**2)))


def distances(fine: Columns, coarse: Columns, name: str) -> Array:
    """Distances of the rows of the finer run from the polygon through those of the other."""
    scale, span = float(np.abs(fine[name]).max()) or 1.0, float(np.ptp(fine["time"])) or 1.0
    rows = np.column_stack((fine["time"] / span, fine[name] / scale))
    corners = np.column_stack((coarse["time"] / span, coarse[name] / scale))
    begin, side = corners[:-1], np.diff(corners, axis=0)
    length = (side**2).sum(axis=1)
    length[length == 0.0] = 1.0
    least = [np.abs(rows[:0, 0])]
    for chunk in np.array_split(rows, len(rows) // CHUNK + 1):
        off = chunk[:, None] - begin
        share = np.clip((off * side).sum(axis=2) / length, 0.0, 1.0)
        least.append(np.sqrt(((off - share[:, :, None] * side) ** 2).sum(axis=2).min(axis=1, initial=np.inf)))
    apart = np.concatenate(least)
    return apart if len(corners) > 1 else np.hypot(*(rows - corners).T)
