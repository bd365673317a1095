"""From a scene and a mesh to a trace."""

from __future__ import annotations

import math
import time as clock
from collections.abc import Callable
from typing import Any

import numpy as np

from fem_solver.condensed import CondensedHistory
from fem_solver.edge import AdhesionlessEdge, AdhesiveEdge, EdgeLaw
from fem_solver.halfspace import HalfSpace
from fem_solver.options import DEFAULT_TOLERANCE, Options
from fem_solver.prony import Prony
from fem_solver.record import Recorder
from fem_solver.release import EdgeGeometry
from fem_solver.stepcontrol import Judge
from fem_solver.stepping import Ended, Run
from fem_solver.surface import SurfaceOperator
from scene import Outcome, OutcomeKind, Scene, Trace
from scene.scene import zone_too_long


def solve(
    scene: Scene,
    mesh: Any,
    options: Options = Options(),
    progress: Callable[[float], None] | None = None,
) -> Trace:
    began = clock.perf_counter()
    material = scene.material
    space = HalfSpace(mesh, options.form == "mixed", options.far_field)
    nu = material.poisson
    ratio = 1.5 * (1.0 - 2.0 * nu) / (1.0 + nu)
    factor = space.factorise(ratio)
    reach = mesh.parameters.fine_to
    count = int(np.searchsorted(space.radii, 1.5 * reach))
    C0, far = factor.compliance(count)
    c = factor.far_mix @ far
    C = C0 + np.outer(c, c) / c[0] if options.far_field else C0
    C = 0.5 * (C + C.T)
    op = SurfaceOperator(C)
    mod, tim = material.spectrum
    shear = Prony(material.modulus, mod, tim).scaled(0.5 / (1 + nu))
    history = CondensedHistory(op, shear)
    radii = space.radii[:count]
    eff = op.effective_radii(2.0 / (1.0 - nu))
    zone = scene.adhesion.zone if scene.is_adhesive else None
    work = scene.adhesion.work if scene.is_adhesive else 0.0
    geo = EdgeGeometry(radii, eff, zone, reach, scene.indenter.edge)
    if zone:
        law: EdgeLaw = AdhesiveEdge(geo, work)
        h = np.diff(radii[: geo.last])
        travel = zone / (2 * options.resolution) if options.resolution else float(np.median(h))
    else:
        law = AdhesionlessEdge(geo, op.transform_radii(radii).tolist())
        travel = 0.01 * reach
    rec = Recorder(work)
    E0 = material.relaxed_plane_modulus

    def scale(a: float) -> float:
        return max(max(abs(row[2]) for row in rec.rows), math.sqrt(8 * math.pi * E0 * a**3 * work))

    run = Run(
        history, geo, law, scene.indenter.height(radii), Judge(options.tolerance or DEFAULT_TOLERANCE, travel),
        rec, float(tim.min()) if tim.size else math.inf, scale, options.max_steps, lambda t: None,
    )
    kind, reason = OutcomeKind.COMPLETED, "all loading steps carried out"
    try:
        run.start(scene.loading.penetration, scene.loading.start == "relaxed")
        if zone and run.state.radius < zone:
            raise zone_too_long(zone, run.state.radius)
        for step in scene.loading.steps:
            seg = step.segment(run.time, run.state.penetration, run.state.force)
            run.carry_out(seg)
            run.time = seg.end
    except Ended as e:
        kind, reason = e.kind, e.reason
    return rec.trace(Outcome(kind, reason, run.time), run.counters, clock.perf_counter() - began)
