"""Sweeps from Python: one scene over many values of its keys, as an ``xarray.Dataset``."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import Executor
from contextlib import ExitStack
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from contact_scene import Scene, SceneError
from contact_scene.errors import shown
from contact_scene.value_checks import function_or_none, one_of, positive, several, whole_from
from crosscontact import arguments
from crosscontact.arguments import A_SCENE, COUNT, checked_path, given
from validation.runs.folder import claim, locked_folder
from validation.runs.pool import engine_of, own_engine
from validation.sweeps import dataset, explorer, run_plan
from validation.sweeps import plan as plans
from validation.sweeps.batch_runs import BATCH

if TYPE_CHECKING:
    import xarray


def sweep(
    scene: Scene | str | os.PathLike[str],
    values: Mapping[str | tuple[str, ...], Any],
    solver: str = arguments.REFERENCE,
    resolution: int | None = None,
    *,
    design: str = "grid",
    points: int | None = None,
    seed: int = 0,
    estimate_errors: bool = True,
    measures: Sequence[str] = (),
    traces: str | None = None,
    max_steps: int | None = None,
    out: str | os.PathLike[str] | None = None,
    executor: Executor | None = None,
    jobs: int = 1,
    batch_seconds: float | None = None,
    progress: Callable[[float, str], None] | None = None,
) -> xarray.Dataset:
    """Solve a scene for many values of its keys.

    Parameters
    ----------
    scene : Scene, str or path
        A scene, the name of a built-in one, or a scene file.
    values : mapping
        By dotted path, such as ``"loading.steps.1.rate"``, the values in units of the scene; by a tuple of
        paths, values that all of them take, or a tuple of values for each. Of a sample: lowest and highest
        value, and ``"log"`` where it is to be even in the logarithm.
    solver : str
        One of :func:`crosscontact.solvers`, or "batch": the reference's method, hundreds of scenes together.
        What it takes is on the page on sweeps; it gives no energies. What has no answer there the reference
        solves (``solved_by``), and a sample again: ``solved_again``, ``largest_difference`` in attributes.
    resolution : int, optional
        As for :func:`crosscontact.solve`; of the batch solver steps a process zone, 16 by default.
    design : str
        "grid", "points" (the first values of all, the second values, ...), "latin-hypercube" or "sobol".
    points, seed : int
        Of a sample: how many, and which.
    estimate_errors : bool
        Whether errors are estimated.
    measures : sequence of str
        Those that the data set holds; by default all.
    traces : str, optional
        "hdf5" or "parquet": keep the time series too, in files in ``out``.
    max_steps : int, optional
        Bounds the steps of every run, accepted and rejected together.
    out : path, optional
        Folder that keeps every finished run and receives ``sweep.nc`` and ``sweep.csv``, of which
        ``crosscontact sweep --plot`` makes figures; the same call with the same folder continues an
        interrupted one, and one with other values shares runs.
    executor : Executor, optional
        Carries out batches of runs; by default this process or ``jobs`` processes.
    jobs : int
        Processes, where there is no executor; more than one in a script: under
        ``if __name__ == "__main__":``, since each process imports the script.
    batch_seconds : float, optional
        Processor time of a batch; by default what the engine's overhead asks for.
    progress : callable, optional
        Called with the share that is done, 0 to 1, and a line of text.

    Returns
    -------
    xarray.Dataset
        A variable for each measure, ``*_error`` for its relative error estimate, and how each run ended; runs
        that failed or were refused are NaN, with their reason.

    Raises
    ------
    SceneError
        If an argument is wrong, the scene refuses a value, or ``out`` holds what another kind of command has
        written, before anything runs; one line.
    ConnectionError
        If the processes, the executor or its scheduler end before the runs; those done stay in ``out``.

    Examples
    --------
    >>> works = {"adhesion.work": [2e-4, 4e-4]}
    >>> data = cc.sweep("elastic-relaxed", works, measures=["pull_off_force"])
    >>> f"{float(data.pull_off_force[1] / data.pull_off_force[0]):.2f}"
    '1.99'
    """
    dataset.check_writable()
    one_of(design, "design", plans.DESIGNS)
    jobs, batch_seconds = COUNT(jobs, "jobs"), given(positive, batch_seconds, "batch_seconds")
    function_or_none(progress, "progress", "the share that is done and a line of text")
    target = None if out is None else checked_path(out, "out")
    if not isinstance(values, Mapping) or not values:
        raise SceneError("values", f"got {shown(values)}", "values by dotted path of the scene")
    asked = {
        "solver": solver,
        "resolution": resolution,
        "max_steps": max_steps,
        "design": design,
        "points": points,
        "seed": seed,
        "estimate": estimate_errors,
        "measures": measures,
        "traces": traces,
        "coordinates": [_coordinate(key, entry, design in plans.SAMPLES) for key, entry in values.items()],
    }
    plan = plans.plan_from_dict(asked, Path(), _base(scene))
    plan.check()
    if plan.traces is not None and target is None:
        raise SceneError("traces", "given without out", "a folder for the traces, out")
    dataset.check_writable(plan)
    with ExitStack() as opened:
        engine = opened.enter_context(own_engine(jobs)) if executor is None else engine_of(executor)
        if batch_seconds is not None:
            engine = replace(engine, batch_seconds=batch_seconds)
        folder = None if target is None else opened.enter_context(locked_folder(target, "out"))
        if folder is not None:
            claim(folder, "a sweep", {}, "out")
        runs = run_plan.carry_out(plan, opened.enter_context(run_plan.store_of(folder)), engine, progress)
        runs = run_plan.solved_again(plan, runs, engine, progress)
        return dataset.to_dataset(plan, runs) if folder is None else dataset.write_results(plan, runs, folder)


def explore(
    scene: Scene | str | os.PathLike[str],
    vary: Sequence[str],
    *,
    values: int | None = None,
    solver: str | None = None,
    resolution: int | None = None,
    jobs: int = 1,
    progress: Callable[[float, str], None] | None = None,
) -> explorer.Exploration:
    """Make a page with a slider for each of up to three keys of a scene; a notebook shows it.

    Parameters
    ----------
    scene : Scene, str or path
        A scene, the name of a built-in one, or a scene file.
    vary : sequence of str
        Dotted paths of numbers of the scene, ``"PATH"`` or ``"PATH=LOW:HIGH"``; without bounds a factor of
        ten either way.
    values : int, optional
        Of each key; by default 31 of one, 11 of two, 7 of three.
    solver, resolution, jobs, progress
        As for :func:`sweep`; where neither solver nor resolution are stated, the batch solver if it takes all
        scenes and they only retract; else the reference, at resolution 4 enough for curves to look at.

    Returns
    -------
    Exploration
        ``save(path)`` writes the page, one file without a server or a network; ``page()`` is its text.

    Raises
    ------
    SceneError
        If an argument is wrong or Bokeh is not installed; one line.

    Examples
    --------
    >>> found = cc.explore("elastic-relaxed", ["adhesion.work"], values=3)
    >>> found.save("work.html")
    >>> len(found.runs)
    3
    """
    explorer.check_drawable()
    function_or_none(progress, "progress", "the share that is done and a line of text")
    if solver is not None:
        arguments.check_solver(solver, "solver", (*arguments.names(), BATCH))
    jobs, count = COUNT(jobs, "jobs"), given(whole_from(2), values, "values")
    table = _base(scene)
    sliders = explorer.sliders_of(table, several(vary, "vary", "dotted paths of the scene"), count)
    with own_engine(jobs) as engine:
        return explorer.explored(
            table,
            sliders,
            solver,
            given(COUNT, resolution, "resolution"),
            engine,
            progress,
        )


def _base(scene: Scene | str | os.PathLike[str]) -> plans.SceneTable:
    """The scene that is varied."""
    if isinstance(scene, Scene):
        return plans.of_scene(scene)
    if isinstance(scene, (str, os.PathLike)):
        return plans.builtin_or_file(os.fspath(scene), Path())
    raise SceneError("scene", f"got {shown(scene)}", A_SCENE)


def _coordinate(key: Any, entry: Any, sampled: bool) -> dict[str, Any]:
    """A coordinate as a plan file has it; its name is its first key."""
    paths = list(key) if isinstance(key, tuple) else [key]
    if not paths or not all(isinstance(path, str) for path in paths):
        raise SceneError("values", f"got the key {shown(key)}", "a dotted path, or a tuple of them")
    listed = entry.tolist() if hasattr(entry, "tolist") else entry
    if not isinstance(listed, (list, tuple)):
        raise SceneError(f"values[{shown(key)}]", f"got {shown(entry)}", "several values")
    table: dict[str, Any] = {"keys": paths}
    if sampled:
        ends, scale = (listed[:2], listed[2]) if len(listed) == 3 else (listed, "linear")
        return table | {"range": list(ends), "scale": scale}
    return table | {"values": list(listed)}
