"""Error against run time: which scheme is cheapest at an error, and how cost grows.

Between the levels of a ladder the cost at a required error is interpolated on logarithms; nothing is
extrapolated beyond the finest level.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from validation.report import tables
from validation.studies.orders import fitted_slope
from validation.studies.study import Convergence, LevelRun

ERRORS = (1e-1, 1e-2, 1e-3, 1e-4)
"""Relative errors at which costs are compared."""
MEASURES = ("force, RMS", "force, mean", "force, largest", "radius, RMS", "pull_off_force", "loop_energy")
SECONDS = ("wall_seconds", "cpu_seconds")
WORK = (*SECONDS, "steps", "linear_solves", "closure_evaluations", "history_updates")
PRICED = "cpu_seconds"
"""Cost that is compared: processor time, on one thread the run time of a quiet machine whatever the load."""
BUSY = 1.2
"""Run time over processor time above which the machine was loaded by other work."""


@dataclass(frozen=True)
class Price:
    """Cost of a scheme at a required error; ``None`` where no level of its ladder reaches it.

    ``at_most`` marks a cost that its coarsest level, already good enough, only bounds from above.
    """

    scheme: str
    seconds: float | None
    at_most: bool = False

    def __str__(self) -> str:
        if self.seconds is None:
            return "does not reach it"
        return f"{'at most ' if self.at_most else ''}{self.seconds:.2g} s"


@dataclass(frozen=True)
class CostGrowth:
    """How a cost grows: exponents of ``cost ~ resolution^a`` and ``cost ~ error^-b``, by least squares."""

    scheme: str
    work: str
    with_resolution: float | None
    with_error: float | None


def cost(run: LevelRun, work: str) -> float | None:
    """Seconds, or a work counter, of a level that has an answer."""
    found = None if run.failed else getattr(run, work) if work in SECONDS else run.counters.get(work)
    return None if found is None else float(found)


def price(study: Convergence, measure: str, required: float) -> Price:
    """Least processor time at which the error stays at or below the required one up to the finest level."""
    points = [
        (abs(run.errors[measure]), spent)
        for run in study.runs
        if measure in run.errors and (spent := cost(run, PRICED)) is not None
    ]
    good = len(points)
    while good > 0 and points[good - 1][0] <= required:
        good -= 1
    name = study.ladder.scheme
    if good == len(points):
        return Price(name, None)
    error, spent = points[good]
    if good == 0:
        return Price(name, spent, at_most=True)
    worse, less = points[good - 1]
    if error <= 0.0 or less <= 0.0 or spent <= 0.0:
        return Price(name, spent)
    part = math.log(worse / required) / math.log(worse / error)
    return Price(name, math.exp(math.log(less) + part * math.log(spent / less)))


def cheapest(
    studies: Sequence[Convergence], measure: str, required: float
) -> tuple[Price | None, list[Price]]:
    """The cheapest scheme by processor time, if any reaches the error, and all prices."""
    prices = [price(study, measure, required) for study in studies]
    able = [entry for entry in prices if entry.seconds is not None]
    return min(able, key=lambda entry: entry.seconds or 0.0, default=None), prices


def growth(study: Convergence, work: str) -> CostGrowth:
    """Fitted exponents of one kind of cost, over resolution and over the RMS error of the force."""
    spent = [cost(run, work) for run in study.runs]
    fineness = [1.0 / run.level.size for run in study.runs]
    inverse = [1.0 / abs(e) if (e := run.errors.get(MEASURES[0])) else None for run in study.runs]
    return CostGrowth(study.ladder.scheme, work, fitted_slope(fineness, spent), fitted_slope(inverse, spent))


def measures(studies: Sequence[Convergence]) -> list[str]:
    """What errors are given in: without adhesion, for instance, there is no pull-off force to be wrong."""
    known = {name for study in studies for run in study.runs for name in run.errors}
    return [name for name in MEASURES if name in known or not known]


def in_words(studies: Sequence[Convergence], measure: str = MEASURES[0]) -> list[str]:
    """One sentence for each of :data:`ERRORS`."""
    if measure not in measures(studies):
        return ["there is none in this scene."]
    sentences = []
    for error in ERRORS:
        best, prices = cheapest(studies, measure, error)
        if best is None:
            sentences.append(f"At {error:.0e} no scheme reaches the error on its ladder.")
            continue
        others = ", ".join(f"{entry.scheme} {entry}" for entry in prices if entry is not best)
        sentences.append(f"At {error:.0e} {best.scheme} is cheapest: {best} ({others or 'alone'}).")
    return sentences


def busy(studies: Sequence[Convergence]) -> float:
    """Largest run time over processor time of the timed runs: 1 on a quiet machine."""
    runs = [run for study in studies for run in study.runs]
    return max((run.wall_seconds / run.cpu_seconds for run in runs if run.wall_seconds and run.cpu_seconds),
               default=1.0)  # fmt: skip


def left_out(studies: Sequence[Convergence]) -> list[str]:
    """Work that the scene did not need, from the counters of the finest level."""
    sentences = []
    for study in studies:
        finished = [run for run in study.runs if not run.failed]
        missing = tables.left_out(study.ladder.scheme, finished[-1].counters) if finished else ()
        if missing:
            sentences.append(f"{study.ladder.scheme}: {'; '.join(missing)}.")
    return sentences
