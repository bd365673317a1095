"""Solution of a scene on meshes that follow the edge: a trace, or a recording of the surface too."""

from __future__ import annotations

import math
import time as clock
from collections.abc import Callable
from dataclasses import replace
from typing import Any

from numpy.typing import NDArray

from contact_scene import (
    Outcome,
    OutcomeKind,
    RunMonitor,
    Scene,
    Trace,
)
from contact_scene.machine import on_machine
from contact_scene.run_control import outcome_of_loss, single_threaded
from contact_scene.scene import zone_too_long
from fem_solver.fields.recording import Recording, SurfaceStep
from fem_solver.options import Options
from fem_solver.recorder import SurfaceRecorder, profile
from fem_solver.setup import Setup, set_up
from fem_solver.step_control import SlopeErrorEstimator
from fem_solver.stepping import ELASTIC_TOLERANCE, NodeReleaseRun

Progress = Callable[[float], None]


def solve(
    scene: Scene,
    meshes: Any,
    options: Options | None = None,
    progress: Progress | None = None,
    monitor: RunMonitor | None = None,
) -> Trace:
    """Solve a scene on meshes of the half-space.

    Parameters
    ----------
    scene : Scene
    meshes : object
        With ``place(radius)``, ``scale(place)``, ``mesh(level)``, ``largest`` and ``divisions`` (see
        ``placement``); meshes with ``points`` (2, n), ``triangles`` (3, m), ``boundaries`` "surface", "axis",
        "far" of vertex pairs (2, k), and ``parameters.fine_from``, ``parameters.fine_to``.
    options : Options, optional
    progress : callable(float), optional
        Called with the share of the loading that is done, 0 to 1.
    monitor : RunMonitor, optional
        Asked between two steps whether the run is to continue.

    Returns
    -------
    Trace
        Extra columns ``branch_dissipation``, ``zone_excess`` and ``balance_residual``
        (see ``recorder``).

    Raises
    ------
    SceneError
        If the process zone is longer than the contact it starts from.
    UnsupportedScene
        If the options exclude what the scene needs.
    """
    return record(scene, meshes, options, progress, monitor).trace


@single_threaded()
def record(
    scene: Scene,
    meshes: Any,
    options: Options | None = None,
    progress: Progress | None = None,
    monitor: RunMonitor | None = None,
) -> Recording:
    """As :func:`solve`, with the history where the options record it.

    Parameters
    ----------
    scene, meshes, options, progress, monitor
        As for :func:`solve`.

    Returns
    -------
    Recording
    """
    began = clock.perf_counter()
    options = options or Options()
    setup = set_up(scene, meshes, options)
    recorder = SurfaceRecorder(
        scene.adhesion.work if scene.adhesion else 0.0,
        scene.adhesion is None or scene.adhesion.reversible,
        [] if options.records else None,
    )
    observer = _Observer(options, setup, recorder)
    run = NodeReleaseRun(
        setup=setup,
        recorder=recorder,
        estimator=SlopeErrorEstimator(
            (options.tolerance or setup.tolerance) * (1.0 if setup.has_history else ELASTIC_TOLERANCE)
        ),
        force_scale=_force_scale(scene, setup, recorder),
        max_steps=options.max_steps,
        requested=options.requested_times,
        on_stop=observer.on_stop,
        on_commit=observer.on_commit,
        on_take_back=observer.on_take_back,
        monitor=monitor,
        progress=progress,
    )
    outcome = _start(scene, run) or run.carry_out(scene.loading)
    if progress is not None and outcome.kind is not OutcomeKind.INTERRUPTED:
        progress(1.0)
    run.counters.history_updates = setup.history.state.updates
    run.counters.factorisations = setup.history.factorisations
    run.counters.volume_solves = setup.history.volume_solves
    trace = on_machine(recorder.trace(outcome, run.counters, clock.perf_counter() - began), scene.machine)
    outcome = outcome_of_loss(outcome, scene.is_adhesive, trace.penetration, trace.contact_radius)
    return Recording(
        setup,
        replace(trace, outcome=outcome),
        observer.rows,
        recorder.surfaces or [],
        observer.steps,
    )


def _start(scene: Scene, run: NodeReleaseRun) -> Outcome | None:
    """Accept the start state; an outcome if there is no equilibrium."""
    outcome = run.start(scene.loading)
    state = run.recorder.content.last
    if state is not None and (state.radius < state.zone or (outcome is not None and state.zone > 0.0)):
        raise zone_too_long(state.zone, state.radius)
    return outcome


def _force_scale(
    scene: Scene, setup: Setup, recorder: SurfaceRecorder
) -> Callable[[float, float, float], float]:
    """Force to which errors of the force are relative, at a force, its singular part and a contact radius.

    What a relaxing contact bears when it is pulled follows from the steps before, and after a hard press it
    is far less than the largest force of the run. There errors are relative to the larger of the present
    force and its part due to adhesion, that of the flat punch with the same edge singularity. Without
    adhesion, or without a history, the largest force serves. The scale is at least the pull-off force of a
    relaxed punch of the contact radius that adheres, ``F = sqrt(8 pi E* a^3 w)`` (Kendall, J. Phys. D 4
    (1971)).
    """
    modulus, work = scene.material.relaxed_plane_modulus, recorder.work_of_adhesion

    def force_scale(force: float, singular: float, radius: float) -> float:
        scale = recorder.content.largest_force
        if work > 0.0 and setup.has_history:
            scale = min(max(abs(force), abs(singular)), scale)
        return max(scale, math.sqrt(8.0 * math.pi * modulus * radius**3 * work))

    return force_scale


class _Observer:
    """Takes profiles at their times and records the history as the options ask."""

    def __init__(self, options: Options, setup: Setup, recorder: SurfaceRecorder) -> None:
        self._options, self._setup, self._recorder = options, setup, recorder
        self.rows: dict[float, int] = {}
        self.steps: list[SurfaceStep] = []

    def on_commit(self, dt: float, forces: NDArray[Any]) -> None:
        if self._options.records:
            self.steps.append(SurfaceStep.last_of(self._setup.history, dt))

    def on_take_back(self) -> None:
        del self.steps[-1:]

    def on_stop(self, time: float) -> None:
        setup, content = self._setup, self._recorder.content
        if time in self._options.profile_times:
            content.profiles.append(profile(self._recorder.last, setup.radii, setup.height, setup.stretch))
        if time in self._options.record_times:
            self.rows[time] = len(content.rows) - 1
