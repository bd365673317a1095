"""One run of one solver on one scene, and many of them through an executor.

A run never raises for what a scene or a solver did: it carries the failure, so that a report shows it.
"""

from __future__ import annotations

import time
import traceback
from collections.abc import Callable, Collection, Iterable
from concurrent.futures import Executor, Future, as_completed
from dataclasses import asdict, dataclass, field, replace
from typing import Any

import numpy as np

from contact_scene import RunMonitor, Scene, SceneError, Trace
from validation import solvers
from validation.cases import Case
from validation.measure import error_estimate
from validation.measure.cycles import cycle_times
from validation.measure.observables import Observables, at_last_contact, cycle_losses, observe

SECONDS = {"bem": (1.5, 0.3), "fem": (2.5, 0.1), solvers.REFERENCE: (1.2, 0.3)}  # a run; one cycle of it


@dataclass(frozen=True)
class Run:
    """What came out of one solver on one scene.

    Parameters
    ----------
    scene, solver : str
        Names.
    trace : Trace or None
        ``None`` if the solver gave no answer at all; then ``failure`` says why.
    failure : str
        One line.
    refused : bool
        Whether the solver does not take this scene (as opposed to a breakdown).
    details : str
        Traceback of a breakdown.
    wall_seconds, cpu_seconds : float
        Run and processor time around the call; imports, and error estimates that are a run of their own, left
        out.
    estimate_seconds : float
        Processor time of that other run.
    measures : dict
        Every scalar by name (see :func:`measure`).
    errors : dict
        Relative error estimates by observable and column (see ``error_estimate``); empty if not asked for.
    """

    scene: str
    solver: str
    trace: Trace | None = None
    failure: str = ""
    refused: bool = False
    details: str = ""
    wall_seconds: float = 0.0
    cpu_seconds: float = 0.0
    estimate_seconds: float = 0.0
    measures: dict[str, float | None] = field(default_factory=dict)
    errors: dict[str, float] = field(default_factory=dict)

    @property
    def finished(self) -> bool:
        """Whether all that was asked has been computed."""
        return self.trace is not None and self.trace.outcome.finished

    @property
    def ending(self) -> str:
        """How it ended, in words."""
        if self.trace is None:
            return f"{'refused' if self.refused else 'failed'}: {self.failure}"
        return f"{self.trace.outcome.kind}: {self.trace.outcome.reason}"


def run(
    case: Case,
    solver: str,
    resolution: int | None = None,
    progress: solvers.Progress | None = None,
    estimate: bool = False,
    watch: RunMonitor | None = None,
    stop_times: Collection[float] = (),
    max_steps: int | None = None,
    raise_failures: bool = False,
) -> Run:
    """Run one solver; the ends of cycles are stepped onto, so that losses per cycle are exact to the step.

    With ``estimate`` the run is judged by a coarser one (see ``error_estimate``), which takes half as long
    again. A ``watch`` may keep the run, stop it, and let it go on. ``stop_times`` are stepped onto too;
    ``max_steps`` bounds the steps; with ``raise_failures`` a failure is raised instead of carried.
    """
    begin, spent = time.perf_counter(), time.process_time()
    try:
        function = solvers.SOLVERS[solver]()
        if estimate:
            function = getattr(function, "estimating", function)
        begin, spent = time.perf_counter(), time.process_time()  # imports are not part of a run
        times = tuple(sorted({*output_times(case), *stop_times}))
        watched = () if watch is None else (watch,)
        budget = {} if max_steps is None else {"max_steps": max_steps}
        trace = function(case.scene, resolution, None, times, progress, *watched, **budget)
    except SceneError as error:
        if raise_failures:
            raise
        return Run(case.name, solver, failure=str(error), refused=True)
    except Exception as error:
        if raise_failures:
            raise
        said = " ".join(str(error).split())
        return Run(
            case.name,
            solver,
            failure=f"{type(error).__name__}: {said}" if said else type(error).__name__,
            details=traceback.format_exc(),
            wall_seconds=time.perf_counter() - begin,
            cpu_seconds=time.process_time() - spent,
        )
    wall, cpu = time.perf_counter() - begin, time.process_time() - spent
    result = Run(case.name, solver, trace, wall_seconds=wall, cpu_seconds=cpu)
    broken = [name for name, column in trace.columns().items() if not np.isfinite(column).all()]
    if broken and raise_failures:
        raise FloatingPointError(f"{solver}: not finite: {', '.join(broken)}")
    if broken:
        return replace(result, trace=None, failure=f"not finite: {', '.join(broken)}")
    result = replace(result, measures=measure(trace, case.scene, wall))
    if estimate and result.finished:
        spent = time.process_time()
        errors = _errors(case, result, function, times, resolution)
        return replace(result, errors=errors, estimate_seconds=time.process_time() - spent)
    return result


def output_times(case: Case) -> tuple[float, ...]:
    """Times that a run steps onto."""
    return tuple(sorted({*cycle_times(case.scene.loading), *case.profile_times}))


def _errors(
    case: Case, result: Run, function: solvers.Solver, times: tuple[float, ...], resolution: int | None
) -> dict[str, float]:
    """Error estimates of a finished run; none if the coarser run ends otherwise."""
    trace = result.trace
    if trace is None:
        return {}
    if result.solver == solvers.REFERENCE:
        return error_estimate.from_own(trace, result.measures)
    twice = getattr(function, "coarser", function)
    try:
        coarse = twice(
            case.scene, *error_estimate.coarser(result.solver, case.scene, resolution), times, None
        )
    except Exception:  # a scene too coarse to be solved has no estimate; the run itself stands
        return {}
    if coarse.outcome.kind is not trace.outcome.kind:
        return {}
    return error_estimate.from_two_runs(trace, coarse, result.measures, measure(coarse, case.scene, 0.0))


def measure(trace: Trace, scene: Scene, wall_seconds: float) -> dict[str, float | None]:
    """Every scalar of a run by name: observables, cycle losses, work counters, run time."""
    zone = scene.adhesion.zone if scene.adhesion is not None and scene.is_adhesive else 0.0
    found: dict[str, float | None] = dict(observe(trace, zone).as_dict())
    stored = float(trace.stored_energy.max()) if len(trace) else 0.0
    branches, loss = at_last_contact(trace, "branch_dissipation", zone), found["dissipated_energy"]
    found["branch_dissipation"] = branches
    found["zone_excess"] = branches - loss if branches is not None and loss is not None else None
    found["loss_share"] = float(trace.dissipated_energy[-1]) / stored if stored > 0.0 else None
    cycles = cycle_losses(trace, cycle_times(scene.loading))
    peak = max(cycles, key=lambda cycle: cycle.loop, default=None)
    found["peak_cycle_loss"] = peak.loop if peak else None
    found["peak_cycle_frequency"] = peak.angular_frequency if peak else None
    found |= {f"counters.{name}": float(count) for name, count in asdict(trace.counters).items()}
    found["wall_seconds"] = wall_seconds
    return found


def summary(result: Run) -> dict[str, Any]:
    """Contents of ``summary.json``; ``None`` where something does not apply."""
    trace = result.trace
    return {
        "solver": result.solver,
        "scene": result.scene,
        "outcome": str(trace.outcome.kind) if trace else ("refused" if result.refused else "failed"),
        "reason": trace.outcome.reason if trace else result.failure,
        "finished": result.finished,
        **Observables().as_dict(),
        **{name: value for name, value in result.measures.items() if not name.startswith("counters.")},
        "wall_seconds": result.wall_seconds,
        "cpu_seconds": result.cpu_seconds,
        "estimate_seconds": result.estimate_seconds,
        "counters": asdict(trace.counters) if trace else None,
        "error_estimates": (result.errors or dict(trace.errors)) if trace else None,
        "events": [asdict(event) for event in trace.events] if trace else [],
    }


def expected_seconds(case: Case, solver: str) -> float:
    """A guess at the run time that is good enough to sort by: a start, and so much for every cycle."""
    start, cycle = SECONDS.get(solver, (1.0, 0.1))
    return start + cycle * len(cycle_times(case.scene.loading))


def run_all(
    tasks: Iterable[tuple[Case, str]],
    executor: Executor | None = None,
    done: Callable[[Run], None] = lambda result: None,
    estimated: Collection[str] = (),
) -> dict[tuple[str, str], Run]:
    """Run ``(case, solver)`` pairs, here or through any ``concurrent.futures`` executor.

    ``done`` is called as each run ends; ``estimated`` names the scenes whose errors are to be estimated. What
    takes longest is begun first, so that no process is left alone with it at the end. The answer is keyed by
    scene and solver, in the order of ``tasks``.
    """
    todo = list(tasks)
    ordered = sorted(todo, key=lambda task: -expected_seconds(*task))
    results: dict[tuple[str, str], Run] = {}
    if executor is None:
        for case, solver in todo:
            results[case.name, solver] = run(case, solver, estimate=case.name in estimated)
            done(results[case.name, solver])
        return results
    futures: dict[Future[Run], tuple[str, str]] = {
        executor.submit(run, case, solver, estimate=case.name in estimated): (case.name, solver)
        for case, solver in ordered
    }
    for future in as_completed(futures):
        name, solver = futures[future]
        try:
            results[name, solver] = future.result()
        except Exception as error:  # a worker that died takes its run along, not the report
            results[name, solver] = Run(name, solver, failure=f"{type(error).__name__}: {error}")
        done(results[name, solver])
    return {(case.name, solver): results[case.name, solver] for case, solver in todo}
