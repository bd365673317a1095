"""``solve(scene, options) -> Trace``: the paper's boundary-element solver."""

from __future__ import annotations

import time as clock
from collections.abc import Callable
from dataclasses import replace
from itertools import islice

import numpy as np

from bem_solver.annuli import Annuli
from bem_solver.checkpoint import put_back
from bem_solver.closure import ClosureRule
from bem_solver.creep import Chain
from bem_solver.loading_intervals import pieces
from bem_solver.options import Options
from bem_solver.profiles import surface_profile
from bem_solver.recorder import Recorder
from bem_solver.size_estimates import FEWEST, annuli_for_layer, annuli_needed, largest_contact, thinnest_layer
from bem_solver.start import contact_scale, start_front
from bem_solver.stepping import Stepper
from bem_solver.trial import Problem
from contact_scene import Counters, Outcome, OutcomeKind, RunMonitor, Scene, Trace, UnsupportedScene
from contact_scene.run_control import single_threaded
from contact_scene.scene import zone_too_long


@single_threaded()
def solve(
    scene: Scene,
    options: Options | None = None,
    progress: Callable[[float], None] | None = None,
    watch: RunMonitor | None = None,
) -> Trace:
    """Solve a scene with the boundary-element method of the paper.

    Parameters
    ----------
    scene : Scene
    options : Options, optional
    progress : callable, optional
        Called with the share of the run that is done, 0 to 1.
    watch : RunMonitor, optional
        May keep the run between steps, stop it, and let it go on from where it was kept.

    Returns
    -------
    Trace
        ``outcome`` says how the run ended; a run that could not finish keeps what it computed.

    Raises
    ------
    UnsupportedScene
        For a bulk modulus that relaxes apart from shear: the half-space is then no longer a convolution in
        time with one kernel in space (Eq. convolution).
    SceneError
        If the process zone does not fit into the contact at the start.
    """
    options = options or Options()
    if scene.material.bulk is not None:
        raise UnsupportedScene(
            "material.bulk",
            "the boundary elements assume a constant Poisson's ratio",
            "no bulk key, or --solver fem",
        )
    began = clock.perf_counter()
    with np.errstate(all="ignore"):  # non-finite numbers are looked for where state is committed
        if options.annuli == "uniform":
            from bem_solver.paper_scheme.solver import solve_uniform

            trace = solve_uniform(scene, options, progress, watch)
        else:
            trace = _solve_graded(scene, options, progress, watch)
    return replace(trace, wall_seconds=clock.perf_counter() - began)


def _solve_graded(
    scene: Scene, options: Options, progress: Callable[[float], None] | None, watch: RunMonitor | None
) -> Trace:
    chain = Chain(scene.material, options.scheme == "backward-euler")
    zone, work = (scene.adhesion.zone, scene.adhesion.work) if scene.adhesion else (0.0, 0.0)
    zone = zone if work > 0.0 else 0.0
    counters = Counters(factorisations=1)
    rule = ClosureRule.resolving(options.divisions)
    unresolved = Problem(scene, Annuli(FEWEST), chain, zone, work, 1.0, counters, rule)
    largest = largest_contact(scene, unresolved) or contact_scale(scene, scene.loading.penetration)
    share = min(zone / largest, 1.0) if zone > 0.0 and largest > 0.0 else 0.01
    counters = Counters(factorisations=1)
    layer = thinnest_layer(scene, chain, largest, zone)
    divisions = options.divisions
    count = max(annuli_needed(divisions, share), annuli_for_layer(divisions, largest, layer))
    annuli = Annuli(count)
    rule = ClosureRule.resolving(max(divisions, int(count * np.arccos(1.0 - share) * 2.0 / np.pi)))
    problem = Problem(scene, annuli, chain, zone, work, zone or 0.01 * largest, counters, rule)
    recorder = Recorder(chain, work)
    scale = max(largest, contact_scale(scene, scene.loading.penetration))
    kept = None if watch is None else watch.kept
    if kept is not None:
        moving = put_back(kept, recorder, counters)
        front, energies = moving["front"], moving["energies"]
    else:
        started = start_front(problem, scale)
        if started is None:
            reason = f"no stable contact at penetration {scene.loading.penetration:.6g}"
            return recorder.nothing(scene.loading.penetration, reason, counters)
        front, energies = started
        if zone >= front.edge > 0.0:
            raise zone_too_long(zone, front.edge)
        recorder.row(front, energies)
        moving = {"largest_force": abs(front.surface.force), "largest_edge": front.edge}
    stepper = Stepper(
        problem,
        front,
        energies,
        recorder,
        options.step_tolerance,
        options.divisions,
        options.max_steps,
        scale,
        watch=watch,
    )
    for name, value in moving.items():
        setattr(stepper, name, value)
    try:
        outcome = _run(scene, stepper, options.profile_times, progress)
    except FloatingPointError as error:
        outcome = Outcome(OutcomeKind.NOT_FINITE, str(error), stepper.front.time)
    return recorder.trace(outcome, counters)


def _run(
    scene: Scene, stepper: Stepper, stops: tuple[float, ...], progress: Callable[[float], None] | None
) -> Outcome:
    recorder, problem, place = stepper.recorder, stepper.problem, stepper.place
    count = len(scene.loading.steps)
    if 0.0 in stops and place.fresh:
        recorder.profile(surface_profile(problem, stepper.front))
    while place.step < count:
        front = stepper.front
        time, penetration, force = place.enter(front.time, front.penetration, front.surface.force)
        segment = scene.loading.steps[place.step].segment(time, penetration, force)
        if progress is not None:
            span = segment.end - segment.start

            def report(
                time: float, index: int = place.step, start: float = segment.start, span: float = span
            ) -> None:
                progress((index + ((time - start) / span if span > 0 else 1.0)) / count)

            stepper.progress = report
        reached = penetration if segment.control == "penetration" else force
        for piece in islice(pieces(segment, reached, stops), place.piece, None):
            outcome = stepper.follow(piece)
            if stepper.front.time in stops and (outcome is None or outcome.kind is OutcomeKind.DETACHED):
                recorder.profile(surface_profile(problem, stepper.front))
            if outcome is not None:
                return outcome
            place.next_piece()
        place.next_step()
    return Outcome(OutcomeKind.COMPLETED, "all loading steps done", stepper.front.time)
