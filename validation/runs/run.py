"""One run of one solver on one scene: carried out, and as the files of a folder.

A run never raises for what a scene or a solver did: it carries the failure, so that a report shows it.
"""

from __future__ import annotations

import csv
import os
import shutil
import tempfile
import time
import traceback
from collections.abc import Collection
from dataclasses import asdict, dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

import contact_scene as cs
from contact_scene.errors import one_line
from contact_scene.files import read_text
from contact_scene.run_control import outcome_of_loss
from validation import solvers
from validation.cases import Case
from validation.measure import error_estimate
from validation.measure.observables import Observables, largest_fall, measure
from validation.measure.scaling import scale
from validation.measure.windows import cycle_times
from validation.runs.folder import from_json, move_whole, to_json, write_whole
from validation.runs.process import peak_memory
from validation.runs.store import checked


@dataclass(frozen=True)
class Run:
    """The outcome of one solver on one scene.

    ``trace`` is ``None`` if there is no answer at all; then ``failure`` says why in one line, ``refused``
    whether the solver does not take this scene (as opposed to a breakdown), ``details`` has the traceback.
    Run and processor time are those around the call, without imports and without an error estimate that is
    a run of its own, whose processor time is ``estimate_seconds``. ``measures`` are all scalars by name,
    ``errors`` relative error estimates by observable and column, ``warnings`` say where model or resolution
    come to their limits, one line each. ``peak_memory`` is the most bytes that the process held by then,
    program included.
    """

    scene: str
    solver: str
    trace: cs.Trace | None = None
    failure: str = ""
    refused: bool = False
    details: str = ""
    wall_seconds: float = 0.0
    cpu_seconds: float = 0.0
    estimate_seconds: float = 0.0
    measures: dict[str, float | None] = field(default_factory=dict)
    errors: dict[str, float] = field(default_factory=dict)
    warnings: tuple[str, ...] = ()
    peak_memory: int | None = None

    @property
    def curves(self) -> cs.Trace | None:
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
    def reason(self) -> str:
        """Why it ended so, in a line."""
        return self.failure if self.trace is None else self.trace.outcome.reason

    @property
    def ending(self) -> str:
        """How it ended, in words."""
        return f"{self.outcome}: {self.reason}"


class NotFiniteError(ArithmeticError):
    """A trace has columns with infinities or NaN."""


def run(case: Case, solver: str | solvers.Solver, *asked: Any, **how: Any) -> Run:
    """Run one solver, as :func:`run_or_raise`; a refusal or a breakdown is part of the answer."""
    begin, spent = time.perf_counter(), time.process_time()
    name = solver if isinstance(solver, str) else solver.name
    try:
        found = run_or_raise(case, solver, *asked, **how)
    except cs.SceneError as error:
        found = Run(case.name, name, failure=str(error), refused=True)
    except Exception as error:
        found = Run(
            case.name,
            name,
            failure=str(error) if isinstance(error, NotFiniteError) else one_line(error),
            details=traceback.format_exc(),
            wall_seconds=time.perf_counter() - begin,
            cpu_seconds=time.process_time() - spent,
        )
    return replace(found, peak_memory=peak_memory())


def run_or_raise(
    case: Case,
    solver: str | solvers.Solver,
    resolution: int | None = None,
    progress: solvers.Progress | None = None,
    estimate: bool = False,
    *,
    monitor: cs.RunMonitor | None = None,
    stop_times: Collection[float] = (),
    **options: Any,
) -> Run:
    """Run one solver; the ends of cycles are stepped onto, so that losses per cycle are exact to the step.

    A ``solver`` is named, or given as it is, with settings of its own.
    ``resolution`` is in divisions per process zone (``None``: the solver's choice). ``progress`` is called
    with the share of the loading that is done, 0 to 1. With ``estimate`` errors are estimated (see
    ``error_estimate``), by a coarser run, half as long again, where the solver does not do it. ``monitor``
    is asked between two steps whether the run is to continue; an error estimate that it stops is left out.
    ``stop_times`` are stepped onto as well; further ``options`` are those of the solver (``RunOptions``).
    Raises ``SceneError`` if the solver does not take the scene or an option, :class:`NotFiniteError` if the
    answer is not finite.
    """
    scene, method = case.scene, solvers.solver(solver) if isinstance(solver, str) else solver
    method.load()
    begin, spent = time.perf_counter(), time.process_time()  # imports are not part of a run
    trace = method.solve(
        scene,
        resolution,
        stop_times=(*cycle_times(scene.loading), *stop_times),
        profile_times=case.profile_times,
        progress=progress,
        monitor=monitor,
        estimate_errors=estimate,
        **options,
    )
    wall, cpu = time.perf_counter() - begin, time.process_time() - spent
    broken = [name for name, column in trace.columns().items() if not np.isfinite(column).all()]
    if broken:
        raise NotFiniteError(f"not finite: {', '.join(broken)}")
    outcome = outcome_of_loss(trace.outcome, scene.is_adhesive, trace.penetration, trace.contact_radius)
    trace = replace(trace, outcome=outcome)
    measures = measure(trace, scene, wall)
    warnings = solvers.trace_warnings(scene, trace) or solvers.scene_warnings(scene)
    result = Run(case.name, method.name, trace, wall_seconds=wall, cpu_seconds=cpu, measures=measures)
    if estimate and result.finished:
        spent = time.process_time()
        errors = _errors(case, trace, measures, method, resolution, monitor)
        result = replace(result, errors=errors, estimate_seconds=time.process_time() - spent)
    return replace(result, warnings=warnings + fall_warnings(scene, trace, fall_error(case, result)))


def fall_warnings(scene: cs.Scene, trace: cs.Trace, error: float) -> tuple[str, ...]:
    """A sentence on a loss that falls by more than its ``error``, relative as in ``scaling``."""
    if len(trace) == 0:
        return ()
    fall, begin, end = largest_fall(trace)
    largest = scale("loss_fall", fall, trace)
    if fall <= error * largest:
        return ()
    when = f"from t = {trace.time[begin]:.4g} to {trace.time[end]:.4g}"
    why = "without adhesion that is an error of the solver"
    if scene.adhesion is not None and scene.is_adhesive:
        zone = f"the adhesive closure over a zone of {scene.adhesion.zone:.3g}"
        why = f'{zone} does not balance energies there ("Where the loss falls" in the documentation)'
    return (f"the loss falls by {fall:.3g}, {fall / largest:.2g} of the largest energy, {when}: {why}",)


def fall_error(case: Case, result: Run) -> float:
    """Relative error of a fall of the loss: as estimated, else the scene's tolerance for the solver."""
    return result.errors.get("loss_fall", case.tolerance(result.solver, "loss_fall") or 0.0)


def _errors(
    case: Case,
    trace: cs.Trace,
    measures: dict[str, float | None],
    method: solvers.Solver,
    resolution: int | None,
    monitor: cs.RunMonitor | None,
) -> dict[str, float]:
    """Error estimates of a finished run; none if the second run ends otherwise."""
    loading = case.scene.loading
    if method.estimates_errors:
        return error_estimate.from_own(trace, measures, loading)
    second = method.comparison_run(case.scene, resolution)
    try:
        other = second.solve(
            stop_times=cycle_times(loading), profile_times=case.profile_times, monitor=monitor
        )
    except Exception:  # a scene too coarse to be solved has no estimate; the run itself stands
        return {}
    if other.outcome.kind is not trace.outcome.kind:
        return {}
    otherwise = measure(other, case.scene, 0.0)
    return error_estimate.from_two_runs(trace, other, measures, otherwise, second.ratio, loading)


_NO_MEASURES: dict[str, Any] = {
    "solver": str,
    "scene": str,
    "outcome": cs.OutcomeKind,
    "reason": str,
    "finished": bool,
    "past_extremum": bool,
    "warnings": tuple[str, ...],
    "wall_seconds": float,
    "cpu_seconds": float,
    "estimate_seconds": float,
    "counters": cs.Counters,
    "error_estimates": dict[str, float | None],
    "events": tuple[cs.Event, ...],
    "located": tuple[cs.Event, ...],
}
"""Keys of the ``summary.json`` of a run with a trace that are no measures, and what each holds."""
_TIMES = ("wall_seconds", "cpu_seconds", "estimate_seconds")


def write_run(folder: Path, scene: cs.Scene, result: Run) -> None:
    """Write the three files, ``summary.json`` last: where it exists, the set is complete."""
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "summary.json").unlink(missing_ok=True)
    for left in folder.glob(".run.*"):  # by a program that was killed
        shutil.rmtree(left, ignore_errors=True)
    with tempfile.TemporaryDirectory(dir=folder, prefix=".run.") as stage:
        cs.write_scene(scene, Path(stage) / "scene.toml")  # with tables of its own, where it has any
        if result.trace is not None:
            cs.write_trace(result.trace, Path(stage) / "trace.csv")
        else:
            (folder / "trace.csv").unlink(missing_ok=True)
        move_whole(Path(stage), folder)
    write_whole(folder / "summary.json", to_json(summary(result)))


def summary(result: Run) -> dict[str, Any]:
    """Contents of ``summary.json``; ``None`` where something does not apply."""
    trace = result.trace
    return {
        "solver": result.solver,
        "scene": result.scene,
        "outcome": result.outcome,
        "reason": result.reason,
        "finished": result.finished,
        "past_extremum": None if trace is None else trace.outcome.past_extremum,
        "warnings": list(result.warnings),
        **Observables().as_dict(),
        **{name: value for name, value in result.measures.items() if not name.startswith("counters.")},
        **{name: getattr(result, name) for name in _TIMES},
        "counters": None if trace is None else asdict(trace.counters),
        "error_estimates": None if trace is None else result.errors or dict(trace.errors),
        "events": [asdict(event) for event in trace.events] if trace is not None else [],
        "located": [asdict(event) for event in trace.located] if trace is not None else [],
    }


def read_run(source: Path) -> tuple[cs.Scene, Run]:
    """Read a folder back, bit for bit; profiles were not written.

    Raises ``SceneError``, one line, if a file is missing or damaged, or the run gave no answer.
    """
    for name in ("scene.toml", "summary.json"):
        if not os.path.isfile(source / name):
            allowed = "a folder written by `crosscontact solve --out`"
            raise cs.SceneError("", f"has no {name}", allowed, str(source))
    scene = cs.read_scene(source / "scene.toml")
    file = str(source / "summary.json")
    try:
        stated = from_json(read_text(Path(file)))
        if not isinstance(stated, dict):
            raise ValueError("no object of JSON")
        if stated.get("outcome") in ("failed", "refused"):
            problem = f"{stated.get('solver')} gave no answer: {stated.get('reason')}"
            raise cs.SceneError("outcome", problem, "a run with a trace")
        return scene, _run(stated, cs.read_columns(source / "trace.csv"))
    except cs.SceneError as error:
        raise error.in_file(file) from None
    except OSError as error:
        problem = f"cannot be read: {error.strerror or error}"
        raise cs.SceneError("trace.csv", problem, "the trace of the run", str(source)) from None
    except (ValueError, csv.Error) as error:
        raise cs.SceneError("", f"damaged: {error}", "summary.json and trace.csv as written", file) from None


def _run(stated: dict[str, Any], columns: dict[str, NDArray[np.float64]]) -> Run:
    """The run that a folder holds; its outcome is dated by the last row of the trace."""
    stated = {"located": []} | stated  # earlier versions wrote none
    of = {name: checked(stated.get(name), kind, name) for name, kind in _NO_MEASURES.items()}
    measures: dict[str, float | None] = {
        name: checked(value, float | None, name)
        for name, value in stated.items()
        if name == "wall_seconds" or name not in _NO_MEASURES
    }
    if not all(np.isfinite(column).all() for column in columns.values()):
        raise ValueError("a number is not finite")
    rows: dict[str, Any] = {name: columns[name] for name in cs.COLUMNS}
    end = float(columns["time"][-1]) if columns["time"].size else 0.0
    trace = cs.Trace(
        of["solver"],
        **rows,
        outcome=cs.Outcome(of["outcome"], of["reason"], end, of["past_extremum"]),
        counters=of["counters"],
        extra={name: column for name, column in columns.items() if name not in cs.COLUMNS},
        events=of["events"],
        located=of["located"],
        wall_seconds=of["wall_seconds"],
    )
    measures |= {f"counters.{name}": float(count) for name, count in vars(of["counters"]).items()}
    return Run(
        of["scene"],
        of["solver"],
        trace,
        **{name: of[name] for name in _TIMES},
        measures=measures,
        errors={name: error for name, error in of["error_estimates"].items() if error is not None},
        warnings=of["warnings"],
    )
