"""The folder of one run, written and read back: ``scene.toml``, ``trace.csv`` and ``summary.json``."""

from __future__ import annotations

import csv
import os
import shutil
import tempfile
from dataclasses import asdict, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from contact_scene import (
    COLUMNS,
    Counters,
    Event,
    Outcome,
    OutcomeKind,
    Scene,
    SceneError,
    Trace,
    read_columns,
    read_scene,
    write_scene,
    write_trace,
)
from contact_scene.files import read_text
from validation.measure.observables import Observables
from validation.runs.files import from_json, move_whole, to_json, write_whole
from validation.runs.run import Run
from validation.runs.store import checked

OUTPUT = ("scene.toml", "trace.csv", "summary.json")
"""Files of a run."""


FIELDS = "moments.json"
"""Numbers of the fields in the body, which say by which solver they are."""
_STATE_SOLVER = ("summary.json", FIELDS)


def check_unused(folder: Path, scene: Scene, key: str = "--out", solver: str | None = None) -> None:
    """Refuse a folder whose files belong to another scene, another solver or another program.

    Parameters
    ----------
    folder : Path
        That a run is to be written to.
    scene : Scene
        Of that run.
    key : str
        What named the folder.
    solver : str or None
        Of that run; ``None`` where what is written is no run of one solver, and replaces none.

    Raises
    ------
    SceneError
    """
    there = [name for name in OUTPUT if (folder / name).exists()]
    if not there:
        return
    try:
        other = read_scene(folder / "scene.toml")
    except (SceneError, OSError):
        problem = f"a {there[-1]} that is not of a run of this program"
    else:
        others = _solvers_of(folder) - {solver}
        if replace(other, title=scene.title) != scene:
            problem = f"the results of another scene{f', {other.title!r}' if other.title else ''}"
        elif solver is not None and others:
            problem = f"the results of another solver, {', '.join(sorted(others))}"
        else:
            return
    raise occupied(folder, problem, key)


def occupied(folder: Path, holds: str, key: str = "--out") -> SceneError:
    """The refusal of a folder for what it holds; ``--fresh`` belongs to the command line, as its keys do."""
    fresh = ", or --fresh to replace what it holds" if key.startswith("--") else ""
    return SceneError(key, f"{folder} holds {holds}", f"another folder{fresh}")


def _solvers_of(folder: Path) -> set[str]:
    """Names of the solvers whose results a folder holds, as far as they are stated."""
    found = set()
    for name in _STATE_SOLVER:
        try:
            stated = from_json(read_text(folder / name))["solver"]
        except (SceneError, OSError, ValueError, TypeError, KeyError):
            continue
        if isinstance(stated, str):
            found.add(stated)
    return found


_NO_MEASURES: dict[str, Any] = {
    "solver": str,
    "scene": str,
    "outcome": OutcomeKind,
    "reason": str,
    "finished": bool,
    "past_extremum": bool,
    "warnings": tuple[str, ...],
    "wall_seconds": float,
    "cpu_seconds": float,
    "estimate_seconds": float,
    "counters": Counters,
    "error_estimates": dict[str, float | None],
    "events": tuple[Event, ...],
}
"""Keys of the ``summary.json`` of a run with a trace that are no measures, and what each holds."""


def write_run(folder: Path, scene: Scene, result: Run) -> None:
    """Write the three files, ``summary.json`` last: where it exists, the set is complete."""
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "summary.json").unlink(missing_ok=True)
    for left in folder.glob(".run.*"):  # by a program that was killed
        shutil.rmtree(left, ignore_errors=True)
    with tempfile.TemporaryDirectory(dir=folder, prefix=".run.") as stage:
        write_scene(scene, Path(stage) / "scene.toml")  # with tables of its own, where it has any
        if result.trace is not None:
            write_trace(result.trace, Path(stage) / "trace.csv")
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
        "reason": trace.outcome.reason if trace is not None else result.failure,
        "finished": result.finished,
        "past_extremum": trace.outcome.past_extremum if trace is not None else None,
        "warnings": list(result.warnings),
        **Observables().as_dict(),
        **{name: value for name, value in result.measures.items() if not name.startswith("counters.")},
        "wall_seconds": result.wall_seconds,
        "cpu_seconds": result.cpu_seconds,
        "estimate_seconds": result.estimate_seconds,
        "counters": asdict(trace.counters) if trace is not None else None,
        "error_estimates": (result.errors or dict(trace.errors)) if trace is not None else None,
        "events": [asdict(event) for event in trace.events] if trace is not None else [],
    }


def read_run(source: Path) -> tuple[Scene, Run]:
    """Read a folder back, bit for bit; profiles were not written.

    Raises
    ------
    SceneError
        One line, if a file is missing or damaged, or the run gave no answer.
    """
    for name in ("scene.toml", "summary.json"):
        if not os.path.isfile(source / name):
            allowed = "a folder written by `crosscontact solve --out`"
            raise SceneError("", f"has no {name}", allowed, str(source))
    scene = read_scene(source / "scene.toml")
    file = str(source / "summary.json")
    try:
        summary = from_json(read_text(Path(file)))
        if not isinstance(summary, dict):
            raise ValueError("no object of JSON")
        if summary.get("outcome") in ("failed", "refused"):
            problem = f"{summary.get('solver')} gave no answer: {summary.get('reason')}"
            raise SceneError("outcome", problem, "a run with a trace")
        run = _run(summary, read_columns(source / "trace.csv"))
    except SceneError as error:
        raise error.in_file(file) from None
    except OSError as error:
        problem = f"cannot be read: {error.strerror or error}"
        raise SceneError("trace.csv", problem, "the trace of the run", str(source)) from None
    except (ValueError, csv.Error) as error:
        raise SceneError("", f"damaged: {error}", "summary.json and trace.csv as written", file) from None
    return scene, run


def _run(summary: dict[str, Any], columns: dict[str, NDArray[np.float64]]) -> Run:
    """The run that a folder holds; its outcome is dated by the last row of the trace."""
    of = {name: checked(summary.get(name), kind, name) for name, kind in _NO_MEASURES.items()}
    measures: dict[str, float | None] = {
        name: checked(value, float | None, name)
        for name, value in summary.items()
        if name == "wall_seconds" or name not in _NO_MEASURES
    }
    if not all(np.isfinite(column).all() for column in columns.values()):
        raise ValueError("a number is not finite")
    end = float(columns["time"][-1]) if columns["time"].size else 0.0
    trace = Trace(
        of["solver"],
        columns["time"],
        columns["penetration"],
        columns["force"],
        columns["contact_radius"],
        columns["stored_energy"],
        columns["external_work"],
        columns["dissipated_energy"],
        outcome=Outcome(of["outcome"], of["reason"], end, of["past_extremum"]),
        counters=of["counters"],
        extra={name: column for name, column in columns.items() if name not in COLUMNS},
        events=of["events"],
        wall_seconds=of["wall_seconds"],
    )
    measures |= {f"counters.{name}": float(count) for name, count in vars(of["counters"]).items()}
    return Run(
        of["scene"],
        of["solver"],
        trace,
        wall_seconds=of["wall_seconds"],
        cpu_seconds=of["cpu_seconds"],
        estimate_seconds=of["estimate_seconds"],
        measures=measures,
        errors={name: error for name, error in of["error_estimates"].items() if error is not None},
        warnings=of["warnings"],
    )
