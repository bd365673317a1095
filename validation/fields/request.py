"""Moments of a run at which fields are computed, and the run that gives them.

Moments are times, each stepped onto exactly, the largest tension, every n-th row of the trace, or rows that
a function of the trace picks. A time at which the load jumps means the state before. With a constant
Poisson's ratio one run serves all; with separate bulk relaxation whole states have to be stored on the way,
so rows picked from the trace take a second run, which is the same to the bit. Where process zones are short
the mesh follows the edge: such a run does not know where energy has been dissipated.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from contact_scene import Loading, OutcomeKind, RunMonitor, Scene, SceneError, Trace
from validation.measure.observables import largest_tension
from validation.measure.round_off import ROUND_OFF
from validation.solvers.base import step_budget
from validation.solvers.finite_elements import FiniteElements

if TYPE_CHECKING:
    from fem_solver import FieldState, Recording

Progress = Callable[[float], None]
_FOLLOWED_BEYOND = 240.0
"""Contact radius, in process zones, beyond which the mesh of a run with fields follows the edge, later than
that of others: one that is fine along the whole path knows where energy has been dissipated, though it comes
to gigabytes and a quarter of an hour."""
_GRADING = 0.14
"""Growth of the element size with the distance from the edge there: under the middle of a contact, where no
strip is fine, the stress is off by 0.9 % of the largest, twice that on the mesh of a run without fields."""
METHOD = FiniteElements(followed_beyond=_FOLLOWED_BEYOND, followed_grading=_GRADING)
"""Only finite elements know the body."""
PULL_OFF = "pull-off"


@dataclass(frozen=True)
class FieldRequest:
    """Moments at which fields are wanted.

    Parameters
    ----------
    times : tuple of float
    pull_off : bool
        Largest tension.
    every : int
        Each n-th row of the trace, the first included; 0: none.
    picked : callable(Trace, Scene) -> dict of int to str, optional
        Rows and their labels.
    """

    times: tuple[float, ...] = ()
    pull_off: bool = False
    every: int = 0
    picked: Callable[[Trace, Scene], dict[int, str]] | None = None


@dataclass(frozen=True)
class RecordedFields:
    """A run and the requested rows.

    Parameters
    ----------
    recording : Recording
    moments : dict of int to str
        Labels by row, in order of time.
    missing : tuple of float
        Times that the run did not reach.
    sampled : frozenset of int
        Rows requested only as every n-th.
    frames : frozenset of int
        Rows without a label that figures need and nothing else requests.
    never_pulls : bool
        A pull-off was requested and there is none.
    """

    recording: Recording
    moments: dict[int, str]
    missing: tuple[float, ...] = ()
    sampled: frozenset[int] = frozenset()
    frames: frozenset[int] = frozenset()
    never_pulls: bool = False

    def states(self) -> Iterator[FieldState]:
        """The fields, computed one after the other in the order of time."""
        from fem_solver import field_states

        return field_states(self.recording, self.moments)


def record_fields(
    scene: Scene,
    request: FieldRequest,
    resolution: int | None = None,
    progress: Progress | None = None,
    max_steps: int | None = None,
    monitor: RunMonitor | None = None,
) -> RecordedFields:
    """Run the finite elements and select the rows.

    Parameters
    ----------
    scene : Scene
    request : FieldRequest
    resolution : int, optional
        Divisions per process zone; default: the solver's choice.
    progress : callable(float), optional
    max_steps : int, optional
        Largest number of steps, accepted and rejected together; default: the solver's own bound.
    monitor : RunMonitor, optional
        Asked between two steps whether the run is to continue.

    Returns
    -------
    RecordedFields

    Raises
    ------
    SceneError
        If a time cannot lie within the loading, or the scene cannot be solved.
    """
    from fem_solver import Options, record
    from fem_solver.fields.history import VolumeLog

    request = replace(request, times=check_times(request.times, scene.loading))
    mesh = METHOD.mesh(scene, resolution)
    # the pull-off in any case: rows picked from the trace are not known yet, and need a run with a history
    options = Options(
        METHOD.step_divisions(scene, resolution),
        record_times=request.times,
        record_every=request.every,
        record_pull_off=True,
        max_steps=step_budget(scene) if max_steps is None else max_steps,
    )
    recording, picked = record(scene, mesh, options, progress, monitor), {}
    if request.picked is not None and len(recording.trace):
        picked = request.picked(recording.trace, scene)
    stopped = recording.trace.outcome.kind is OutcomeKind.INTERRUPTED
    if picked and not stopped and isinstance(recording.log, VolumeLog):
        recording = record(scene, mesh, replace(options, record_rows=tuple(picked)), progress, monitor)
    return _select(recording, request, picked)


def _select(recording: Recording, request: FieldRequest, picked: dict[int, str]) -> RecordedFields:
    trace, moments = recording.trace, {row: label for row, label in picked.items() if label}
    for time in request.times:
        if time in recording.rows:
            moments.setdefault(recording.rows[time], "")
    pull = pull_off(recording) if request.pull_off else None
    if pull is not None:
        moments[pull] = moments.get(pull) or PULL_OFF
    rows = range(0, len(trace), request.every) if request.every else range(0)
    sampled = frozenset(rows) - set(moments)
    frames = frozenset(picked) - set(moments) - sampled
    missing = tuple(time for time in request.times if time not in recording.rows)
    moments = dict(sorted((moments | dict.fromkeys(sampled | frames, "")).items()))
    return RecordedFields(recording, moments, missing, sampled, frames, request.pull_off and pull is None)


def pull_off(recording: Recording) -> int | None:
    """Row of the largest tension; ``None`` if the run never pulls."""
    from fem_solver.fields.history import VolumeLog

    if len(recording.trace) == 0:
        return None
    row, log = largest_tension(recording.trace), recording.log
    if row is not None and isinstance(log, VolumeLog) and log.largest_tension is not None:
        return log.largest_tension[0]  # on a plateau of the force a neighbour of the row, equal to round-off
    return row


def check_times(times: Iterable[float], loading: Loading) -> tuple[float, ...]:
    """The same times, rising; what exceeds the end of the loading by round-off becomes that end.

    Raises
    ------
    SceneError
        If one cannot lie within the run.
    """
    end, checked = ending(loading), set()
    for time in times:
        if not (math.isfinite(time) and time >= 0.0):
            raise SceneError("--at", f"got {time:g}", "times >= 0")
        if end is not None and time > end * (1.0 + ROUND_OFF):
            raise SceneError("--at", f"{time:.10g} is after the loading ends", f"times from 0 to {end:.10g}")
        checked.add(float(time) if end is None else min(float(time), end))
    return tuple(sorted(checked))


def ending(loading: Loading) -> float | None:
    """Time at which the loading ends; ``None`` if that depends on the run (a ramp after a force)."""
    *_, end = (0.0, *(segment.end for _, segment in loading.segments()))
    return end if math.isfinite(end) else None
