"""``solve(scene, options) -> Trace``: the paper's boundary-element solver."""

from __future__ import annotations

import time as clock
from collections.abc import Callable

import numpy as np

from bem_solver.annuli import Annuli
from bem_solver.creep import Chain
from bem_solver.options import Options
from bem_solver.pieces import pieces
from bem_solver.recorder import Recorder
from bem_solver.start import contact_scale, start_front
from bem_solver.stepping import Stepper
from bem_solver.trial import Problem
from scene import Counters, Outcome, OutcomeKind, Scene, Trace


def solve(scene, options=None, progress=None) -> Trace:
    options = options or Options()
    began = clock.perf_counter()
    counters = Counters(factorisations=1)
    chain = Chain(scene.material, options.scheme == "backward-euler")
    D = max(abs(scene.loading.penetration), max([abs(getattr(s, "to", 0.0)) for s in scene.loading.steps if s.kind=="ramp" and s.to>0] or [0.0]))
    scale = contact_scale(scene, D)
    zone = scene.adhesion.zone if scene.is_adhesive else 0.0
    work = scene.adhesion.work if scene.is_adhesive else 0.0
    share = min(zone / scale, 0.5) if zone else 0.01
    count = int(np.ceil(options.divisions * 0.5 * np.pi / np.arccos(1 - share)))
    problem = Problem(scene, Annuli(count), chain, zone, work, zone or 0.01 * scale, counters)
    recorder = Recorder(chain, work)
    started = start_front(problem, scale)
    front, energies = started
    recorder.row(front, energies)
    stepper = Stepper(problem, front, energies, recorder, options.step_tolerance, options.divisions, options.max_steps, scale, None)
    outcome = None
    for step in scene.loading.steps:
        seg = step.segment(stepper.front.time, stepper.front.penetration, stepper.front.surface.force)
        reached = stepper.front.penetration if seg.control == "penetration" else stepper.front.surface.force
        for piece in pieces(seg, reached, ()):
            outcome = stepper.follow(piece)
            if outcome: break
        if outcome: break
    outcome = outcome or Outcome(OutcomeKind.COMPLETED, "all steps done", stepper.front.time)
    return recorder.trace(outcome, counters, clock.perf_counter() - began)
