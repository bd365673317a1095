"""Checkpoints of a long run: its state is written every few seconds, and a stopped run continues there.

A checkpoint belongs to a fingerprint (see ``fingerprints``); with any other the run starts at the beginning.
Without a folder nothing is kept, but an interrupted run ends with its present step all the same.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from contact_scene.files import remove_partial
from validation import solvers
from validation.cases import Case
from validation.execution import checked_pickle
from validation.execution.fingerprints import fingerprint
from validation.execution.runs import Run, run
from validation.execution.signals import GracefulStop

CHECKPOINT = "checkpoint"
INTERVAL = 3.0
"""Seconds between two checkpoints, at least: what a killed run loses."""
INTERVAL_PER_WRITE = 20.0
"""Time between two checkpoints over the time to write one, at least: writing takes 5 % of a run at most."""


class CheckpointWriter:
    """Monitors one run (see ``contact_scene.run_control.monitor``) and writes its state to a file.

    Parameters
    ----------
    path : Path or None
        ``None``: nothing is written.
    fingerprint : str
        Of the run.
    stop : callable
        Whether the run is to end at its next step.
    fresh : bool
        Whether to start at the beginning even if there is a checkpoint.

    Attributes
    ----------
    start_state : object
        State read from the file, or ``None``.
    seconds, cpu_seconds : float
        Wall and processor time that led to this state.
    message : str
        Whether an earlier checkpoint is used, or why not; empty if there was none.
    stepping : bool
        Whether the run has come so far as to be stopped between two steps.
    stopped : bool
        Whether it was.
    """

    def __init__(
        self, path: Path | None, fingerprint: str, stop: Callable[[], bool], fresh: bool = False
    ) -> None:
        self.path, self._fingerprint, self._stop = path, fingerprint, stop
        self.start_state: Any = None
        self.seconds = self.cpu_seconds = 0.0
        self.message = ""
        self.stepping = self.stopped = False
        self._failed = False
        if path is not None and path.exists() and not fresh:
            try:
                (self.start_state, self.cpu_seconds), self.seconds = checked_pickle.read(path, fingerprint)
                self.message = f"continuing the run saved in {path}, after {self.seconds:.1f} s of it"
            except checked_pickle.UnusableFile as why:
                self.message = f"starting anew, {path} cannot be used: {why}"
        self._began, self._cpu_began = time.perf_counter(), time.process_time()
        self._due = self._began + INTERVAL

    def continue_run(self, state: Callable[[], Any]) -> bool:
        """Write a checkpoint if one is due; whether the run is to continue."""
        self.stepping = True
        self.stopped, now = self._stop(), time.perf_counter()
        if self.path is not None and (self.stopped or now >= self._due):
            self._write(self.path, state(), now)
            after = time.perf_counter()
            self._due = after + max(INTERVAL, INTERVAL_PER_WRITE * (after - now))
        return not self.stopped

    def _write(self, path: Path, state: Any, now: float) -> None:
        try:
            cpu_seconds = self.cpu_seconds + time.process_time() - self._cpu_began
            seconds = self.seconds + now - self._began
            checked_pickle.write(path, self._fingerprint, (state, cpu_seconds), seconds)
        except OSError as error:  # a run without checkpoints is better than none
            if not self._failed:
                print(f"crosscontact: the run cannot be saved: {error}", file=sys.stderr)
            self._failed = True

    def continue_set_up(self) -> bool:
        """Whether the run is to continue; there is nothing to write yet."""
        self.stepping, self.stopped = True, self._stop()
        return not self.stopped

    def remove(self) -> None:
        """The run is over and its results are written: the checkpoint has served."""
        if self.path is not None:
            self.path.unlink(missing_ok=True)
            remove_partial(self.path)


class RecordedRunWriter(CheckpointWriter):
    """The same for a run that is recorded: its set-up, of which nothing is kept, is interrupted at once."""

    def continue_set_up(self) -> bool:
        """Whether the run is to continue."""
        return True


@dataclass(frozen=True)
class StopMonitor:
    """Stops a run whose state is not kept.

    Parameters
    ----------
    stop : callable
        Whether the run is to end at its next step.
    """

    stop: Callable[[], bool]
    start_state: None = None

    def continue_set_up(self) -> bool:
        """Whether the run is to continue."""
        return not self.stop()

    def continue_run(self, state: Callable[[], Any]) -> bool:
        """Whether the run is to continue."""
        return not self.stop()


def run_with_checkpoints(
    case: Case,
    solver: str,
    resolution: int | None,
    progress: solvers.Progress,
    folder: Path | None,
    *,
    fresh: bool = False,
    estimate: bool = False,
    max_steps: int | None = None,
) -> tuple[Run, CheckpointWriter]:
    """Run one solver; continue from a checkpoint, and end with the present step when interrupted.

    Parameters
    ----------
    case, solver, resolution, progress, estimate, max_steps
        As of :func:`~validation.execution.runs.run_or_raise`. A run that has used up its steps is continued
        by one that may take more.
    folder : Path or None
        Where the checkpoint is; ``None``: there is none.
    fresh : bool
        Whether to start at the beginning even if there is one.

    Returns
    -------
    result : Run
        Its times include those before the checkpoint. An interruption of the error estimate costs the
        estimate only.
    writer : CheckpointWriter
        ``stopped`` where the run, or its estimate, was interrupted.

    Raises
    ------
    KeyboardInterrupt
        If the run is interrupted before its first step, or a second time.
    """
    stop = GracefulStop()
    key = fingerprint("solve", case.scene, solver, resolution, case.profile_times, estimate)
    path = None if folder is None else folder / CHECKPOINT
    writer = CheckpointWriter(path, key, lambda: stop.requested, fresh)
    stop.possible = lambda: writer.stepping
    if writer.message:
        print(f"crosscontact: {writer.message}", file=sys.stderr)
    with stop.handling_signals():
        estimation = StopMonitor(lambda: stop.requested)
        result = run(
            case,
            solver,
            resolution,
            progress,
            estimate,
            monitor=writer,
            max_steps=max_steps,
            estimate_monitor=estimation,
        )
    writer.stopped = stop.requested
    wall, cpu = result.wall_seconds + writer.seconds, result.cpu_seconds + writer.cpu_seconds
    measures = result.measures | ({"wall_seconds": wall} if "wall_seconds" in result.measures else {})
    return replace(result, wall_seconds=wall, cpu_seconds=cpu, measures=measures), writer
