"""Solution of a scene on meshes that follow the edge: a trace, or a recording of the surface too."""

from __future__ import annotations

import time as clock
from collections.abc import Callable
from dataclasses import replace
from typing import Any

from contact_scene import OutcomeKind, RunMonitor, Scene, Trace
from contact_scene.machine import on_machine
from contact_scene.run_control import outcome_of_loss, single_threaded
from contact_scene.scene import zone_too_long
from fem_solver.recorder import Recording
from fem_solver.run import NodeReleaseRun
from fem_solver.setup import Options, Setup

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
    """As :func:`solve`, with the history where the options record it."""
    began = clock.perf_counter()
    options = options or Options()
    setup = Setup(scene, meshes, options)
    run = NodeReleaseRun(setup, monitor, progress)
    outcome, recorder = run.start(scene.loading), run.recorder
    state = recorder.totals.last
    if state is not None and (state.radius < state.zone or (outcome is not None and state.zone > 0.0)):
        raise zone_too_long(state.zone, state.radius)
    outcome = outcome or run.carry_out(scene.loading)
    if progress is not None and outcome.kind is not OutcomeKind.INTERRUPTED:
        progress(1.0)
    run.counters.history_updates = setup.state.updates
    run.counters.factorisations = setup.surfaces.factorisations
    trace = on_machine(recorder.trace(outcome, run.counters, clock.perf_counter() - began), scene.machine)
    outcome = outcome_of_loss(outcome, scene.is_adhesive, trace.penetration, trace.contact_radius)
    return Recording(setup, replace(trace, outcome=outcome), run.rows_at, recorder.surfaces, recorder.steps)
