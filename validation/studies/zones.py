"""What a shorter process zone costs: steps, updates, time, memory, error of every solver over decades of it.

The scene is run with zones of given ratios to its contact radius, long ones first. The zone is part of the
model, so every zone has an answer of its own: the reference at twice its default resolution. A run that takes
longer than ``PATIENCE`` is ended, and its solver is not asked for shorter zones.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from contact_scene import SceneError
from validation.cases import Case
from validation.measure.difference import of_numbers
from validation.runs.pool import TaskEnding, run_of, run_task, run_tasks
from validation.runs.process import peak_memory
from validation.runs.provenance import fingerprint
from validation.runs.run import Run, run
from validation.runs.store import Store
from validation.solvers import REFERENCE, SOLVERS

RATIOS = (5e-2, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 5e-9)
"""Process zones over the largest contact radius: seven decades."""
OBSERVED = ("pull_off_force", "loop_energy")
PATIENCE = 300.0
"""Longest processor time (s) of one run; the reference needs seconds at any zone, the finite elements a
minute or two at the shortest."""


@dataclass(frozen=True)
class ZoneRun:
    """One solver at one zone.

    Parameters
    ----------
    ratio, zone : float
        Zone over the largest contact radius of the scene, and the zone itself.
    solver : str
    run : Run or None
        ``None`` if it was not run; then ``skipped`` says why.
    skipped : str
    errors : dict of str to float
        Signed relative errors by observable, against the finer reference.
    peak_memory : int or None
        Most bytes of the process of this run alone, program included; ``None`` if it had none of its own.
    """

    ratio: float
    zone: float
    solver: str
    run: Run | None = None
    skipped: str = ""
    errors: dict[str, float] = field(default_factory=dict)
    peak_memory: int | None = None

    @property
    def steps(self) -> int | None:
        """Accepted steps; ``None`` without an answer."""
        trace = None if self.run is None else self.run.trace
        return None if trace is None else trace.counters.steps

    @property
    def updates(self) -> float | None:
        """Updates of the history in a step, on average, as the solver counts them; or ``None``."""
        trace = None if self.run is None else self.run.trace
        if trace is None or not trace.counters.history_updates or not trace.counters.steps:
            return None
        return trace.counters.history_updates / trace.counters.steps

    @property
    def megabytes(self) -> float | None:
        """Most that the process of this run held, in 1e6 bytes; ``None`` if it had none of its own."""
        return None if self.peak_memory is None else 1e-6 * self.peak_memory

    @property
    def seconds(self) -> float | None:
        """Processor time."""
        return None if self.run is None or self.run.trace is None else self.run.cpu_seconds


@dataclass(frozen=True)
class MeasuredRun:
    """A run, and the most bytes that its process held by then."""

    run: Run
    peak_memory: int | None

    @property
    def breakdown(self) -> str:
        """Why there is no answer, where the next attempt may give one."""
        return self.run.breakdown


def zone_runs(
    case: Case,
    solvers: Sequence[str],
    ratios: Iterable[float] = RATIOS,
    progress: Callable[[float, str], None] | None = None,
    executor: Executor | None = None,
    store: Store | None = None,
    max_steps: int | None = None,
) -> list[ZoneRun]:
    """Run a scene with zones of all ratios.

    Parameters
    ----------
    case : Case
        With adhesion.
    solvers : sequence of str
        Names.
    ratios : iterable of float
        Zones over the largest contact radius that the scene reaches with its own zone.
    progress : callable(fraction, text), optional
    executor : Executor, optional
        With processes of its own, which alone can end a run that takes too long; one task a process, for
        memory is measured as well.
    store : Store, optional
        Runs of an earlier attempt are taken over, run times and memory included.
    max_steps : int or None
        Of every run but those of the reference that radius and errors are read from; ``None``: by its
        forecast.

    Returns
    -------
    list of ZoneRun
        Zone by zone, the longest first; within one in the order of ``solvers``.

    Raises
    ------
    SceneError
        A scene without adhesion has no zone, and one of fixed stress sets it itself.
    """
    adhesion = case.scene.adhesion
    if adhesion is None or not case.scene.is_adhesive:
        raise SceneError("adhesion", "a study of zones needs adhesion")
    if adhesion.stress is not None:
        raise SceneError(
            "adhesion.stress", "a study of zones sets their lengths", "a scene with adhesion.zone"
        )
    own = run(case, REFERENCE)
    if own.curves is None:
        raise SceneError("scene", f"the reference has no answer to it: {own.ending}")
    radius = float(own.curves.contact_radius.max())
    ordered = sorted(ratios, reverse=True)
    made: list[ZoneRun] = []
    given_up: set[str] = set()
    for index, ratio in enumerate(ordered):
        zone = ratio * radius
        there = _with_zone(case, zone)
        finer = run(there, REFERENCE, 2 * SOLVERS[REFERENCE].default_resolution(there.scene))
        for place, solver in enumerate(solvers):
            if progress is not None:
                done = (index + place / len(solvers)) / len(ordered)
                progress(done, f"{solver}, zone {ratio:.0e} of the radius")
            one = ZoneRun(ratio, zone, solver, skipped="not run: too long at a longer zone")
            if solver not in given_up:
                one = _zone_run(one, there, finer, executor, store, max_steps)
            if one.skipped:
                given_up.add(solver)
            made.append(one)
    return made


def _zone_run(
    one: ZoneRun,
    case: Case,
    finer: Run,
    executor: Executor | None,
    store: Store | None,
    max_steps: int | None,
) -> ZoneRun:
    """The run, or that it took too long."""
    plain = run_task(case, one.solver, max_steps=max_steps)
    task = replace(
        plain,
        key=fingerprint("memory", plain.key),
        function=_measured,
        arguments=(plain.function, *plain.arguments),
        answer=MeasuredRun,
        time_limit=PATIENCE,
    )
    (answer,) = run_tasks([task], executor, store)
    if answer.ending is TaskEnding.TIMED_OUT:
        return replace(one, skipped=answer.failure)
    measured: MeasuredRun | None = answer.value
    result = run_of(replace(answer, task=plain, value=None if measured is None else measured.run))
    peak = None if executor is None or measured is None else measured.peak_memory
    return replace(one, run=result, skipped="", errors=relative_errors(result, finer), peak_memory=peak)


def _with_zone(case: Case, zone: float) -> Case:
    adhesion = case.scene.adhesion
    if adhesion is None:
        return case
    return replace(case, scene=replace(case.scene, adhesion=replace(adhesion, zone=zone, stress=None)))


def _measured(function: Callable[..., Run], *arguments: Any) -> MeasuredRun:
    return MeasuredRun(function(*arguments), peak_memory())


def relative_errors(result: Run, finer: Run, names: Iterable[str] = OBSERVED) -> dict[str, float]:
    """Signed relative errors of observables against a finer run; those that one lacks are left out."""
    return {one.quantity: one.error for one in of_numbers(result, finer, names) if math.isfinite(one.error)}


def growth(runs: Iterable[ZoneRun], quantity: str) -> float | None:
    """Fitted exponent ``p`` of a quantity that grows as ``zone**-p``; 0: at most with the logarithm.

    ``quantity`` is ``steps``, ``updates`` or ``seconds``; ``None`` with fewer than three zones.
    """
    pairs = [(one.ratio, getattr(one, quantity)) for one in runs]
    known = [(math.log(ratio), math.log(value)) for ratio, value in pairs if value]
    if len(known) < 3:
        return None
    across, up = zip(*known, strict=True)
    return -float(np.polyfit(across, up, 1)[0])
