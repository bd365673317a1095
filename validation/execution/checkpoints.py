"""Long runs survive: a run is kept every few seconds, stops when asked, and goes on from where it was kept.

What is kept belongs to a question: scene, solver, options, and the program's own sources with the packages it
computes with. Any other question starts anew.
"""

from __future__ import annotations

import hashlib
import json
import platform
import sys
import time
from collections.abc import Callable
from dataclasses import fields, is_dataclass, replace
from functools import cache
from importlib import metadata
from pathlib import Path
from typing import Any

from contact_scene.files import remove_partial
from validation import solvers
from validation.cases import Case
from validation.execution import checked_pickle
from validation.execution.runs import Run, output_times, run
from validation.execution.signals import Patience

CHECKPOINT = "checkpoint"
EVERY = 3.0  # seconds between two times that a run is kept,
SHARE = 20.0  # and at least this many times as long as keeping it takes
COMPUTING = ("numpy", "scipy", "scikit-fem", "gmsh")
_TOLD_ONLY = ("report", "claims")  # folders that say something about runs but do not make them


def question(*parts: Any) -> str:
    """Fingerprint of what is asked, by this version of the program."""
    text = json.dumps([version(), plain(parts)], sort_keys=True)
    return hashlib.sha256(text.encode()).hexdigest()


def plain(value: Any) -> Any:
    """Dataclasses, sequences and numbers as JSON that tells any two of them apart."""
    if is_dataclass(value) and not isinstance(value, type):
        content = {entry.name: plain(getattr(value, entry.name)) for entry in fields(value)}
        return [type(value).__name__, content]
    if isinstance(value, (tuple, list)):
        return [plain(entry) for entry in value]
    if isinstance(value, float):
        return float(value).hex()
    if value is None or isinstance(value, (str, int)):
        return value
    if hasattr(value, "tobytes"):
        return [str(value.dtype), list(value.shape), value.tobytes().hex()]
    raise TypeError(f"{type(value).__name__} cannot be part of a question")


@cache
def version() -> str:
    """Fingerprint of the sources that make the numbers, and of the packages they compute with."""
    digest = hashlib.sha256()
    root = Path(__file__).parents[2]
    for package in checked_pickle.OURS:
        for source in sorted((root / package).rglob("*.py")):
            name = source.relative_to(root)
            if len(name.parts) > 2 and name.parts[1] in _TOLD_ONLY:
                continue
            digest.update(name.as_posix().encode() + b"\0" + source.read_bytes() + b"\0")
    for package in COMPUTING:
        try:
            digest.update(f"{package} {metadata.version(package)}\n".encode())
        except metadata.PackageNotFoundError:
            digest.update(f"{package} missing\n".encode())
    digest.update(f"{sys.version} {platform.machine()}".encode())
    return digest.hexdigest()


class Keeper:
    """Watches one run (see ``contact_scene.run_control``) and keeps it in a file.

    Parameters
    ----------
    path : Path
    asked : str
        The question.
    stop : callable
        Whether the run is to end at its next step.
    fresh : bool
        Whether to start anew whatever has been kept.

    Attributes
    ----------
    kept : object
        What the file held, or ``None``.
    seconds, cpu_seconds : float
        Run and processor time behind it.
    said : str
        What became of an earlier file, in words; empty if there was none.
    watching : bool
        Whether the run has come so far as to be stopped between two steps,
    stopped : bool
        and whether it was.
    """

    def __init__(self, path: Path, asked: str, stop: Callable[[], bool], fresh: bool = False) -> None:
        self.path, self._asked, self._stop = path, asked, stop
        self.kept: Any = None
        self.seconds = self.cpu_seconds = 0.0
        self.said = ""
        self.watching = self.stopped = False
        self._failed = False
        if path.exists() and not fresh:
            try:
                (self.kept, self.cpu_seconds), self.seconds = checked_pickle.read(path, asked)
                self.said = f"going on with the run kept in {path}, after {self.seconds:.1f} s of it"
            except checked_pickle.Unusable as why:
                self.said = f"starting anew, {path} is of no use: {why}"
        self._began, self._spent = time.perf_counter(), time.process_time()
        self._due = self._began + EVERY

    def goes_on(self, state: Callable[[], Any]) -> bool:
        """Keep the run if it is time to; whether it is to go on."""
        self.watching = True
        self.stopped, now = self._stop(), time.perf_counter()
        if self.stopped or now >= self._due:
            self._keep(state(), now)
            after = time.perf_counter()
            self._due = after + max(EVERY, SHARE * (after - now))
        return not self.stopped

    def _keep(self, state: Any, now: float) -> None:
        try:
            spent = self.cpu_seconds + time.process_time() - self._spent
            checked_pickle.write(self.path, self._asked, (state, spent), self.seconds + now - self._began)
        except OSError as error:  # the run is worth more than what it may lose
            if not self._failed:
                print(f"crosscontact: the run cannot be kept: {error}", file=sys.stderr)
            self._failed = True

    def done(self) -> None:
        """The run is over, its results are written: nothing is left to go on with."""
        self.path.unlink(missing_ok=True)
        remove_partial(self.path)


def run_kept(
    case: Case,
    solver: str,
    resolution: int | None,
    progress: solvers.Progress,
    folder: Path,
    fresh: bool = False,
) -> tuple[Run, Keeper]:
    """A run that is kept in a folder, goes on from there, and ends with its step when it is interrupted."""
    patience = Patience()
    asked = question("solve", case.scene, solver, resolution, output_times(case))
    keeper = Keeper(folder / CHECKPOINT, asked, lambda: patience.asked, fresh)
    patience.patient = lambda: keeper.watching
    if keeper.said:
        print(f"crosscontact: {keeper.said}", file=sys.stderr)
    with patience.waiting():
        result = run(case, solver, resolution, progress, watch=keeper)
    wall, cpu = result.wall_seconds + keeper.seconds, result.cpu_seconds + keeper.cpu_seconds
    measures = result.measures | ({"wall_seconds": wall} if "wall_seconds" in result.measures else {})
    return replace(result, wall_seconds=wall, cpu_seconds=cpu, measures=measures), keeper
