"""One run of one solver on one scene.

A run never raises for what a scene or a solver did: it carries the failure, so that a report shows it.
"""

from __future__ import annotations

import time
import traceback
from collections.abc import Collection
from dataclasses import dataclass, field, replace

import numpy as np

from contact_scene import RunMonitor, SceneError, Trace
from contact_scene.errors import one_line
from contact_scene.run_control import outcome_of_loss
from validation import solvers
from validation.cases import Case
from validation.measure import error_estimate
from validation.measure.falling_loss import fall_warnings
from validation.measure.scalars import measure
from validation.measure.small_swings import swing_warnings
from validation.measure.windows import cycle_times


@dataclass(frozen=True)
class Run:
    """The outcome of one solver on one scene.

    ``trace`` is ``None`` if there is no answer at all; then ``failure`` says why in one line, ``refused``
    whether the solver does not take this scene (as opposed to a breakdown), ``details`` has the traceback.
    Run and processor time are those around the call, without imports and without an error estimate that is
    a run of its own, whose processor time is ``estimate_seconds``. ``measures`` are all scalars by name,
    ``errors`` relative error estimates by observable and column, ``warnings`` say where model or resolution
    come to their limits, one line each.
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
    warnings: tuple[str, ...] = ()

    @property
    def curves(self) -> Trace | None:
        """The trace, if it has a row: a run without a state to start from has an outcome, but no curve."""
        return self.trace if self.trace is not None and len(self.trace) else None

    @property
    def outcome(self) -> str:
        """How it ended, in a word; a trace without rows has an outcome too."""
        if self.trace is None:
            return "refused" if self.refused else "failed"
        return str(self.trace.outcome.kind)

    @property
    def finished(self) -> bool:
        """Whether the run reached its end."""
        return self.trace is not None and self.trace.outcome.finished

    @property
    def breakdown(self) -> str:
        """Why there is no answer, where the next attempt may give one; a refusal stands."""
        return "" if self.trace is not None or self.refused else self.failure

    @property
    def ending(self) -> str:
        """How it ended, in words."""
        if self.trace is None:
            return f"{self.outcome}: {self.failure}"
        return f"{self.outcome}: {self.trace.outcome.reason}"


class NotFiniteError(ArithmeticError):
    """A trace has columns with infinities or NaN."""


def run(
    case: Case,
    solver: str,
    resolution: int | None = None,
    progress: solvers.Progress | None = None,
    estimate: bool = False,
    *,
    monitor: RunMonitor | None = None,
    max_steps: int | None = None,
) -> Run:
    """Run one solver, as :func:`run_or_raise`; a refusal or a breakdown is part of the answer."""
    begin, spent = time.perf_counter(), time.process_time()
    try:
        return run_or_raise(
            case, solver, resolution, progress, estimate, monitor=monitor, max_steps=max_steps
        )
    except SceneError as error:
        return Run(case.name, solver, failure=str(error), refused=True)
    except Exception as error:
        return Run(
            case.name,
            solver,
            failure=str(error) if isinstance(error, NotFiniteError) else one_line(error),
            details=traceback.format_exc(),
            wall_seconds=time.perf_counter() - begin,
            cpu_seconds=time.process_time() - spent,
        )


def run_or_raise(
    case: Case,
    solver: str,
    resolution: int | None = None,
    progress: solvers.Progress | None = None,
    estimate: bool = False,
    *,
    monitor: RunMonitor | None = None,
    stop_times: Collection[float] = (),
    max_steps: int | None = None,
) -> Run:
    """Run one solver; the ends of cycles are stepped onto, so that losses per cycle are exact to the step.

    ``resolution`` is in divisions per process zone (``None``: the solver's choice). ``progress`` is called
    with the share of the loading that is done, 0 to 1. With ``estimate`` errors are estimated (see
    ``error_estimate``), by a coarser run, half as long again, where the solver does not do it. ``monitor``
    is asked between two steps whether the run is to continue; an error estimate that it stops is left out.
    ``stop_times`` are stepped onto as well. ``max_steps`` bounds accepted and rejected steps together.
    Raises ``SceneError`` if the solver does not take the scene or an option, :class:`NotFiniteError` if the
    answer is not finite.
    """
    method = solvers.solver(solver)
    method.load()
    stops = (*cycle_times(case.scene.loading), *stop_times)
    begin, spent = time.perf_counter(), time.process_time()  # imports are not part of a run
    trace = method.solve(
        case.scene,
        resolution,
        stop_times=stops,
        profile_times=case.profile_times,
        max_steps=max_steps,
        progress=progress,
        monitor=monitor,
        estimate_errors=estimate,
    )
    wall, cpu = time.perf_counter() - begin, time.process_time() - spent
    _refuse_not_finite(trace)
    outcome = outcome_of_loss(trace.outcome, case.scene.is_adhesive, trace.penetration, trace.contact_radius)
    trace = replace(trace, outcome=outcome)
    measures = measure(trace, case.scene, wall)
    warnings = solvers.trace_warnings(case.scene, trace) or solvers.scene_warnings(case.scene)
    warnings += swing_warnings(trace, case.scene.loading, method.edge_spacing(case.scene, resolution))
    result = Run(case.name, solver, trace, wall_seconds=wall, cpu_seconds=cpu, measures=measures)
    if estimate and result.finished:
        spent = time.process_time()
        errors = _errors(case, result, method, resolution, monitor)
        result = replace(result, errors=errors, estimate_seconds=time.process_time() - spent)
    return replace(result, warnings=warnings + fall_warnings(case.scene, trace, fall_error(case, result)))


def fall_error(case: Case, result: Run) -> float:
    """Relative error of a fall of the loss: as estimated, else the scene's tolerance for the solver."""
    return result.errors.get("loss_fall", case.tolerance(result.solver, "loss_fall") or 0.0)


def _refuse_not_finite(trace: Trace) -> None:
    broken = [name for name, column in trace.columns().items() if not np.isfinite(column).all()]
    if broken:
        raise NotFiniteError(f"not finite: {', '.join(broken)}")


def _errors(
    case: Case,
    result: Run,
    method: solvers.Solver,
    resolution: int | None,
    monitor: RunMonitor | None,
) -> dict[str, float]:
    """Error estimates of a finished run; none if the second run ends otherwise."""
    trace = result.trace
    if trace is None:
        return {}
    if method.estimates_errors:
        return error_estimate.from_own(trace, result.measures, case.scene.loading)
    second, stops = method.comparison_run(case.scene, resolution), cycle_times(case.scene.loading)
    try:
        other = second.solve(stop_times=stops, profile_times=case.profile_times, monitor=monitor)
    except Exception:  # a scene too coarse to be solved has no estimate; the run itself stands
        return {}
    if other.outcome.kind is not trace.outcome.kind:
        return {}
    otherwise = measure(other, case.scene, 0.0)
    return error_estimate.from_two_runs(
        trace, other, result.measures, otherwise, second.ratio, case.scene.loading
    )
