"""The folder of one run: ``scene.toml``, ``trace.csv`` and ``summary.json``."""

from __future__ import annotations

import shutil
import tempfile
from pathlib import Path

from contact_scene import Scene, write_scene, write_trace
from validation.execution.files import move_whole, to_json, write_whole
from validation.execution.runs import Run, summary


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
