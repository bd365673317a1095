"""``solve(scene, options) -> Trace`` by front tracking."""

from __future__ import annotations

import time
from collections.abc import Callable

import numpy as np

from scene import Counters, Outcome, OutcomeKind, Profile, Scene, Trace, UnsupportedScene
from validation.reference.tracking.abel import transform
from validation.reference.tracking.equilibrium import start_surface, touching_radius
from validation.reference.tracking.law import Griffith, Law, NoTension
from validation.reference.tracking.options import Options
from validation.reference.tracking.record import Record
from validation.reference.tracking.rheology import rheology
from validation.reference.tracking.stepping import Run
from validation.reference.tracking.surface import Body, Surface

NAME = "reference"


def solve(
    scene: Scene, options: Options | None = None, progress: Callable[[float], None] | None = None
) -> Trace:
    """Nearly exact run of a scene."""
    options = options or Options()
    began = time.perf_counter()
    if scene.material.bulk is not None:
        raise UnsupportedScene(
            "material.bulk",
            "the Abel transform needs bulk and shear to relax alike",
            "no bulk entry, or the finite-element solver",
        )
    body = Body(rheology(scene.material), transform(scene.indenter))
    depth = _largest_depth(scene)
    scale = touching_radius(body, depth, scene.indenter.edge)
    law: Law
    if scene.adhesion is not None and scene.is_adhesive:
        law = Griffith(scene.adhesion)
        reach, work = scene.adhesion.zone, scene.adhesion.work
        travel = reach / options.divisions
    else:
        law = NoTension(body.rheology.glassy * max(depth, 1e-300))
        reach, work, travel = 0.0, 0.0, 0.01 * scale / 2.0
    surface = start_surface(scene, body, law)
    if surface is None:
        outcome = Outcome(OutcomeKind.NO_EQUILIBRIUM, "no stable contact at the start penetration", 0.0)
        empty = Record(body, work).columns()
        return _trace(empty, outcome, Counters(), began)
    profiles: list[Profile] = []

    def on_profile(at: float, state: Surface, force: float) -> None:
        pass

    run = Run(
        scene, body, law, options, surface, reach, travel, scale, Record(body, work), on_profile, progress
    )
    run.start()
    outcome = run.go()
    return _trace(run.record.columns(), outcome, run.counters, began, tuple(run.events), tuple(profiles))


def _trace(columns, outcome, counters, began, events=(), profiles=()) -> Trace:
    main = {k: columns.pop(k) for k in list(columns)[:7]}
    return Trace(
        solver=NAME,
        **main,
        outcome=outcome,
        counters=counters,
        extra=columns,
        events=events,
        profiles=profiles,
        wall_seconds=time.perf_counter() - began,
    )


def _largest_depth(scene: Scene) -> float:
    """Largest penetration the loading prescribes."""
    depth = largest = scene.loading.penetration
    for step in scene.loading.steps:
        segment = step.segment(0.0, depth, 0.0)
        if segment.control == "penetration":
            values = [segment.value(t) for t in np.linspace(0.0, segment.end, 65)]
            largest, depth = max(largest, *values), values[-1]
    return largest
