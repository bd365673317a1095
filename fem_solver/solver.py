"""From a scene and a mesh to a trace."""

from __future__ import annotations

import math
import time as clock
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from contact_scene import Outcome, OutcomeKind, RunMonitor, Scene, Trace
from contact_scene.run_control import single_threaded
from contact_scene.scene import zone_too_long
from fem_solver.checkpoint import put_back, taken
from fem_solver.fields.history import Log, watch
from fem_solver.history import Ended, History
from fem_solver.options import DEFAULT_TOLERANCE, Options
from fem_solver.profiles import profile
from fem_solver.recorder import Recorder, SurfaceState
from fem_solver.setup import Setup, set_up
from fem_solver.step_control import Judge
from fem_solver.stepping import Run

Progress = Callable[[float], None]


@dataclass(frozen=True)
class Recording:
    """A trace with what is needed to look into the body afterwards (see ``fields``).

    Parameters
    ----------
    trace : Trace
    setup : Setup
    states : dict of float to object
        State of the history at each recorded time (see ``condensed`` and ``quadrature``).
    rows : dict of float to int
        Row of the trace at each recorded time; where the load jumps, the one before.
    surfaces : list of SurfaceState
        By row.
    height : ndarray, shape (n,)
        Of the indenter over the surface nodes.
    log : SurfaceLog, VolumeLog or None
        The history as far as it was kept; ``None`` if nothing was to be recorded.
    """

    trace: Trace
    setup: Setup
    states: dict[float, object]
    rows: dict[float, int]
    surfaces: list[SurfaceState]
    height: NDArray[np.float64]
    log: Log | None


def solve(
    scene: Scene,
    mesh: Any,
    options: Options | None = None,
    progress: Progress | None = None,
    watch: RunMonitor | None = None,
) -> Trace:
    """Solve a scene on a mesh of the half-space.

    Parameters
    ----------
    scene : Scene
    mesh : object
        With ``points`` (2, n), ``triangles`` (3, m), ``boundaries`` "surface", "axis", "far" of vertex pairs
        (2, k) and ``parameters.fine_to``, the radius up to which it is made for a contact edge.
    options : Options, optional
    progress : callable(float), optional
        Told the fraction done, from 0 to 1.
    watch : RunMonitor, optional
        May keep the run between steps, stop it, and let it go on from where it was kept.

    Returns
    -------
    Trace
        Extra columns ``branch_dissipation``, ``zone_excess`` and ``balance_residual`` (see ``record``).

    Raises
    ------
    SceneError
        If the process zone is longer than the contact it starts from.
    UnsupportedScene
        If the options exclude what the scene needs.
    """
    return record(scene, mesh, options, progress, watch).trace


@single_threaded()
def record(
    scene: Scene,
    mesh: Any,
    options: Options | None = None,
    progress: Progress | None = None,
    outside: RunMonitor | None = None,
) -> Recording:
    """As :func:`solve`, and keep the history where the options ask for it.

    A run that goes on from where ``outside`` kept it has the history from there on.
    """
    began = clock.perf_counter()
    options = options or Options()
    setup = set_up(scene, mesh, options)
    zone = scene.adhesion.zone if scene.is_adhesive and scene.adhesion else 0.0
    work = scene.adhesion.work if scene.adhesion else 0.0
    recorder = Recorder(work)
    states: dict[float, object] = {}
    rows: dict[float, int] = {}
    history: History = setup.history
    log: Log | None = None
    if options.records:
        history, log = watch(setup.history, options)
        recorder.kept = []
    height = scene.indenter.height(setup.radii)

    def visit(time: float) -> None:
        if time in options.profile_times and recorder.last is not None:
            recorder.profiles.append(profile(recorder.last, setup.radii, height))
        if time in options.record_times:
            states[time] = setup.history.state
            rows[time] = len(recorder.rows) - 1
            if log is not None:
                log.keep(rows[time])

    def force_scale(radius: float) -> float:
        """Largest force so far, at least that of a relaxed adhering punch of this radius."""
        adhesion = math.sqrt(8.0 * math.pi * scene.material.relaxed_plane_modulus * radius**3 * work)
        return max(recorder.largest_force, adhesion)

    run = Run(
        history=history,
        geometry=setup.geometry,
        law=setup.law,
        height=height,
        judge=Judge(options.tolerance or DEFAULT_TOLERANCE, setup.travel),
        recorder=recorder,
        shortest_time=setup.shortest_time,
        force_scale=force_scale,
        max_steps=options.max_steps,
        visit=visit,
        goes_on=lambda: outside is None or outside.goes_on(lambda: taken(run, setup.history)),
        wanted=(*options.profile_times, *options.record_times),
    )
    kind, reason = OutcomeKind.COMPLETED, "all loading steps carried out"
    steps = scene.loading.steps
    try:
        if outside is not None and outside.kept is not None:
            put_back(outside.kept, run, setup.history)
        else:
            run.start(scene.loading.penetration, scene.loading.start == "relaxed")
            if run.state.radius < zone:
                raise zone_too_long(zone, run.state.radius)
        while run.place.step < len(steps):
            origin = run.place.enter(run.time, run.state.penetration, run.state.force)
            segment = steps[run.place.step].segment(*origin)

            def tell(part: float, done: int = run.place.step) -> None:
                if progress is not None:
                    progress((done + part) / len(steps))

            run.carry_out(segment, tell)
            run.place.leave()
    except Ended as end:
        kind, reason = end.kind, end.reason
    if progress is not None:
        progress(1.0)
    run.counters.history_updates = setup.history.updates
    run.counters.factorisations = setup.history.factorisations
    run.counters.volume_solves = setup.history.volume_solves
    trace = recorder.trace(Outcome(kind, reason, run.time), run.counters, clock.perf_counter() - began)
    return Recording(trace, setup, states, rows, recorder.kept or [], height, log)
