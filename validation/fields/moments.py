"""Moments of a run at which fields are computed, the run that gives them, and what its densities add up to.

Moments are times, each stepped onto exactly, the largest tension, every n-th row of the trace, or rows that
a function of the trace picks. A time at which the load jumps means the state before. One run serves all.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from contact_scene import Loading, RunMonitor, Scene, SceneError, Trace
from meshes import EdgeMeshes
from validation.measure.events import end_of_approach, largest_tension
from validation.measure.scaling import ROUND_OFF
from validation.solvers.base import step_budget
from validation.solvers.finite_elements import FiniteElements

if TYPE_CHECKING:
    from fem_solver import FieldState, Recording


METHOD = FiniteElements()
"""Only finite elements know the body."""
PULL_OFF = "pull-off"
HUNDREDTH = 0.01
"""Length that replaces the process zone where there is no adhesion, over the contact radius."""


@dataclass(frozen=True)
class FieldRequest:
    """Moments at which fields are wanted: ``times``, largest tension, each n-th row (0: none), and rows that
    a function picks from the trace, with their labels."""

    times: tuple[float, ...] = ()
    pull_off: bool = False
    every: int = 0
    picked: Callable[[Trace, Scene], dict[int, str]] | None = None


@dataclass(frozen=True)
class RecordedFields:
    """A run and the requested rows.

    ``moments`` are labels by row, in order of time, ``missing`` times that the run did not reach, ``sampled``
    rows requested only as every n-th, ``frames`` rows without a label that figures need and nothing else
    requests; with ``never_pulls`` a pull-off was requested and there is none.
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
    progress: Callable[[float], None] | None = None,
    max_steps: int | None = None,
    monitor: RunMonitor | None = None,
) -> RecordedFields:
    """Run the finite elements and select the rows; options as of any run.

    Raises ``SceneError`` if a time cannot lie within the loading, or the scene cannot be solved.
    """
    from fem_solver import Options, record

    request = replace(request, times=check_times(request.times, scene.loading))
    options = Options(
        record_times=request.times,
        record=True,
        max_steps=step_budget(scene) if max_steps is None else max_steps,
    )

    def run(mesh: EdgeMeshes) -> Recording:
        return record(scene, mesh, options, progress, monitor)

    recording, picked = METHOD.on_meshes(scene, resolution, run, lambda found: found.trace), {}
    if request.picked is not None and len(recording.trace):
        picked = request.picked(recording.trace, scene)
    return _select(recording, request, picked)


def _select(recording: Recording, request: FieldRequest, picked: dict[int, str]) -> RecordedFields:
    moments = {row: label for row, label in picked.items() if label}
    for time in request.times:
        if time in recording.rows:
            moments.setdefault(recording.rows[time], "")
    pull = pull_off(recording) if request.pull_off else None
    if pull is not None:
        moments[pull] = moments.get(pull) or PULL_OFF
    rows = range(0, len(recording.trace), request.every) if request.every else range(0)
    sampled = frozenset(rows) - set(moments)
    frames = frozenset(picked) - set(moments) - sampled
    missing = tuple(time for time in request.times if time not in recording.rows)
    moments = dict(sorted((moments | dict.fromkeys(sampled | frames, "")).items()))
    return RecordedFields(recording, moments, missing, sampled, frames, request.pull_off and pull is None)


def pull_off(recording: Recording) -> int | None:
    """Row of the largest tension; ``None`` if the run never pulls."""
    return largest_tension(recording.trace) if len(recording.trace) else None


def check_times(times: Iterable[float], loading: Loading) -> tuple[float, ...]:
    """The same times, rising; what exceeds the end of the loading by round-off becomes that end.

    Raises ``SceneError`` if one cannot lie within the run. A ramp after a force ends when the run says.
    """
    *_, end = (0.0, *(segment.end for _, segment in loading.segments()))
    for time in times:
        if not (math.isfinite(time) and time >= 0.0):
            raise SceneError("--at", f"got {time:g}", "times >= 0")
        if math.isfinite(end) and time > end * (1.0 + ROUND_OFF):
            raise SceneError("--at", f"{time:.10g} is after the loading ends", f"times from 0 to {end:.10g}")
    return tuple(sorted({float(min(time, end)) if math.isfinite(end) else float(time) for time in times}))


def zone_length(scene: Scene, contact_radius: float) -> float:
    """Process-zone length; without adhesion a hundredth of the contact radius."""
    if scene.adhesion is not None and scene.is_adhesive:
        return scene.adhesion.zone
    return HUNDREDTH * contact_radius


def key_moments(trace: Trace, scene: Scene) -> dict[int, str]:
    """Rows of a cycle and their names, in order of time; what a run does not have is left out.

    The start, the end of the approach, the first row of the withdrawal at which the edge has receded by a
    process zone, and the largest tension.
    """
    turn, pull = end_of_approach(trace), largest_tension(trace)
    named = {0: "jump-in" if scene.loading.start == "jump-in" else "start"}
    if turn > 0:
        named[turn] = "end of approach"
    radius = trace.contact_radius
    least = radius[turn] - zone_length(scene, float(radius[turn]))
    receded = turn + np.flatnonzero((radius[turn:] <= least) & (radius[turn:] > 0.0))
    if receded.size and (pull is None or receded[0] < pull):
        named[int(receded[0])] = "start of detachment"
    if pull is not None and pull > turn:
        named[pull] = PULL_OFF
    return dict(sorted(named.items()))


def in_contact(trace: Trace, count: int) -> list[int]:
    """Rows spread evenly in time over the part of a run in contact, first and last included."""
    touching = np.flatnonzero(trace.contact_radius > 0.0)
    if touching.size == 0:
        return []
    time = trace.time[touching]
    nearest = np.abs(time[:, None] - np.linspace(time[0], time[-1], count)).argmin(axis=0)
    return sorted({int(row) for row in touching[nearest]})


@dataclass(frozen=True)
class EnergySums:
    """Energy densities summed over the mesh, and their counterparts in the trace, at one row.

    The mesh ends at a finite radius: the trace counts the half-space outside it, the sum over elements does
    not (a part of relative size ``a/R_far``; none of a layer). ``stored_in_trace`` also contains the energy
    of the hold on a partly released node at the edge, which is no density in the body. Energy
    ``dissipated`` since the start is compared with ``branch_dissipation``, the integral in the trace, and
    with ``work_less_stored``, what closes the balance of the body without any such integral; neither holds
    what a sharp tip makes the branches dissipate within an element, which ``branch_dissipation`` does.
    ``loss``, of ``F dD + dg dA = dU + dL``, is smaller by ``zone_excess`` where a sharp edge dissipates
    what a process zone would have held (see ``fem_solver.recorder``).
    """

    stored: float
    stored_in_trace: float
    dissipated_by_branch: dict[str, float]
    dissipated: float
    branch_dissipation: float
    work_less_stored: float
    zone_excess: float
    loss: float

    @property
    def error(self) -> float | None:
        """Relative difference of the sum over the mesh from the trace's loss; ``None`` without one."""
        if self.branch_dissipation == 0.0:
            return None
        return self.dissipated / self.branch_dissipation - 1.0


def balance(state: FieldState, trace: Trace) -> EnergySums:
    """Sum the densities of a state."""
    sums = (state.element_dissipated @ state.element_volumes).tolist()
    lost = dict(zip(state.branches, sums, strict=True))
    at = {name: float(column[state.row]) for name, column in trace.columns().items()}
    return EnergySums(
        stored=float(state.element_stored @ state.element_volumes),
        stored_in_trace=at["stored_energy"],
        dissipated_by_branch=lost,
        dissipated=sum(lost.values()),
        branch_dissipation=at["branch_dissipation"],
        work_less_stored=at["branch_dissipation"] + at["balance_residual"],
        zone_excess=at["branch_dissipation"] - at["dissipated_energy"],
        loss=at["dissipated_energy"],
    )
