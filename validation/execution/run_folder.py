"""The folder of one run: ``scene.toml``, ``trace.csv`` and ``summary.json``."""

from __future__ import annotations

import shutil
import tempfile
from dataclasses import replace
from pathlib import Path

from contact_scene import Scene, SceneError, read_scene, write_scene, write_trace
from validation.execution.files import move_whole, to_json, write_whole
from validation.execution.runs import Run, summary

OUTPUT = ("scene.toml", "trace.csv", "summary.json")
"""Files of a run."""


def check_unused(folder: Path, scene: Scene, key: str = "--out") -> None:
    """Refuse a folder whose files belong to another scene, or to another program.

    Parameters
    ----------
    folder : Path
        That a run is to be written to.
    scene : Scene
        Of that run.
    key : str
        What named the folder.

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
        problem = f"{folder} holds a {there[-1]} that is not of a run of this program"
    else:
        if replace(other, title=scene.title) == scene:
            return
        problem = f"{folder} holds the results of another scene{f', {other.title!r}' if other.title else ''}"
    raise SceneError(key, problem, "another folder, or --fresh to replace what it holds")


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
