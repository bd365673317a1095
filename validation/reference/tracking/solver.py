"""``solve(scene, options) -> Trace`` by front tracking.

Signs and units are the scene's: penetration and pressure positive downwards and in compression.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from contact_scene import (
    COLUMNS,
    Counters,
    Event,
    Outcome,
    OutcomeKind,
    RunMonitor,
    Scene,
    Step,
    SurfaceProfile,
    Trace,
    UnsupportedScene,
)
from validation.reference.tracking.abel import transform
from validation.reference.tracking.checkpoint import put_back, taken
from validation.reference.tracking.equilibrium import pressed_radius, start_surface, touching_radius
from validation.reference.tracking.estimate import estimated_errors
from validation.reference.tracking.law import Griffith, Law, NoTension
from validation.reference.tracking.options import Fineness, Options
from validation.reference.tracking.profiles import surface_profile
from validation.reference.tracking.record import Record
from validation.reference.tracking.rheology import rheology
from validation.reference.tracking.stepping import Run
from validation.reference.tracking.surface import Body, Surface

Array = NDArray[np.float64]

NAME = "reference"
ROWS = (1.0, 12.0)  # deviations from straight between rows, under a linear and a curved load
DENSE = (0.25, 0.25)  # the same for a run that another is compared with


def solve(
    scene: Scene,
    options: Options | None = None,
    progress: Callable[[float], None] | None = None,
    watch: RunMonitor | None = None,
) -> Trace:
    """Run a scene.

    Parameters
    ----------
    scene : Scene
    options : Options, optional
    progress : callable(fraction), optional
        Told now and then how much of the loading is done.
    watch : RunMonitor, optional
        May keep the run between steps, stop it, and let it go on from where it was kept. A second run for
        error estimates is not watched.

    Returns
    -------
    Trace
        Extra columns ``stress_intensity_factor``, ``energy_release_rate``, ``branch_dissipation``. Steps
        that bend have rows in between, by cubics in time, so that straight lines through the rows are true
        to the tolerance (to 12 tolerances under a sinusoidal load). If contact is lost the last row is the
        free surface (force and radius 0) at the time of the row before.

    Raises
    ------
    UnsupportedScene
        Separate bulk relaxation: the Abel transform does not make that local.
    SceneError
        A process zone longer than the contact it starts from.
    """
    options = options or Options()
    began = time.perf_counter()
    if scene.material.bulk is not None:
        raise UnsupportedScene(
            "material.bulk",
            "the Abel transform needs bulk and shear to relax alike",
            "no bulk entry, or the finite-element solver",
        )
    fineness = options.fineness(scene.is_adhesive)
    result = _run(scene, options, fineness, ROWS, progress, watch)
    errors: dict[str, float] = {}
    if options.estimate_errors and result.outcome.finished:
        coarser = _run(scene, options, fineness.coarser(), DENSE)
        errors = estimated_errors(result.columns, coarser.columns)
    return Trace(
        solver=NAME,
        **{name: result.columns[name] for name in COLUMNS},
        outcome=result.outcome,
        counters=result.counters,
        extra={name: column for name, column in result.columns.items() if name not in COLUMNS},
        events=tuple(result.events),
        profiles=tuple(result.profiles),
        errors=errors,
        wall_seconds=time.perf_counter() - began,
    )


@dataclass(frozen=True)
class _Result:
    columns: dict[str, Array]
    outcome: Outcome
    counters: Counters = field(default_factory=Counters)
    events: list[Event] = field(default_factory=list)
    profiles: list[SurfaceProfile] = field(default_factory=list)


def _run(
    scene: Scene,
    options: Options,
    fineness: Fineness,
    straight: tuple[float, float],
    progress: Callable[[float], None] | None = None,
    watch: RunMonitor | None = None,
) -> _Result:
    body = Body(rheology(scene.material), transform(scene.indenter))
    depth, load = _largest_load(scene)
    edge = scene.indenter.edge
    scale = max(touching_radius(body, depth, edge), pressed_radius(body, load, edge))
    law: Law
    if scene.adhesion is not None and scene.is_adhesive:
        law, work = Griffith(scene.adhesion), scene.adhesion.work
        travel = scene.adhesion.zone / fineness.divisions
    else:
        typical = max(depth, float(body.transform(np.array([scale]))[0])) or 1.0
        law, work = NoTension(body.rheology.glassy * typical), 0.0
        travel = 0.01 * scale / fineness.divisions
    record = Record(body, work)
    surface = start_surface(scene, body, law)
    if surface is None:
        reason = f"no stable contact at penetration {scene.loading.penetration:g}"
        return _Result(record.columns(), Outcome(OutcomeKind.NO_EQUILIBRIUM, reason, 0.0))
    profiles: list[SurfaceProfile] = []

    def on_profile(at: float, state: Surface, force: float) -> None:
        profiles.append(surface_profile(at, state, force, body, scene.indenter))

    weight = 2.0 * body.rheology.relaxed * (depth * scale - body.transform.integral(scale))
    run = Run(
        scene=scene,
        body=body,
        law=law,
        options=options,
        fineness=fineness,
        surface=surface,
        largest_travel=travel,
        radius_scale=scale,
        force_scale=max(weight, load),
        depth_scale=max(depth, float(body.transform(np.array([scale]))[0])),
        record=record,
        on_profile=on_profile,
        straight=straight,
        progress=progress,
        goes_on=lambda: watch is None or watch.goes_on(lambda: taken(run, profiles)),
    )
    if watch is not None and watch.kept is not None:
        put_back(watch.kept, run, profiles)
    outcome = run.go()
    stopped = outcome.kind is OutcomeKind.INTERRUPTED
    columns = record.columns(whole=not stopped)
    if stopped:
        outcome = replace(outcome, time=float(columns["time"][-1]))
    return _Result(columns, outcome, run.counters, run.events, profiles)


def _largest_load(scene: Scene) -> tuple[float, float]:
    """Largest penetration and largest force that the loading prescribes."""
    depth = deepest = scene.loading.penetration
    force = hardest = 0.0

    def state(_: Step) -> tuple[float, float]:
        return depth, force

    for _, segment in scene.loading.segments(state, own_time=True):
        values = [segment.value(t) for t in np.linspace(0.0, segment.end, 257)]
        if segment.control == "penetration":
            deepest, depth = max(deepest, *values), values[-1]
        else:
            hardest, force = max(hardest, *values), values[-1]
    return deepest, hardest
