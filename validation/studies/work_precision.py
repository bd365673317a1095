"""Error against run time: which scheme is cheapest at an error, and how cost grows.

Between the levels of a ladder the cost at a required error is interpolated on logarithms; nothing is
extrapolated beyond the finest level.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from validation.measure import skipped_work
from validation.studies.convergence import Convergence, LevelRun
from validation.studies.extrapolation import fitted_slope

ERRORS = (1e-1, 1e-2, 1e-3, 1e-4)
"""Relative errors at which costs are compared."""
MEASURES = ("force, RMS", "force, mean", "force, largest", "radius, RMS", "pull_off_force", "loop_energy")
WORK = ("wall_seconds", "cpu_seconds", "steps", "linear_solves", "closure_evaluations", "history_updates")
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


@dataclass(frozen=True)
class CostGrowth:
    """How a cost grows: exponents of ``cost ~ resolution^a`` and ``cost ~ error^-b``, by least squares."""

    scheme: str
    work: str
    with_resolution: float | None
    with_error: float | None


def cost(run: LevelRun, work: str) -> float | None:
    """Seconds, or a work counter, of a level that has an answer."""
    if run.failed:
        return None
    if work in ("wall_seconds", "cpu_seconds"):
        return float(getattr(run, work)) if getattr(run, work) is not None else None
    count = run.counters.get(work)
    return float(count) if count is not None else None


def price(study: Convergence, measure: str, required: float, work: str = PRICED) -> Price:
    """Least cost at which the error stays at or below the required one up to the finest level.

    Parameters
    ----------
    study : Convergence
    measure : str
        Name of the error.
    required : float
        Largest error, relative.
    work : str
        Kind of cost: ``"wall_seconds"``, ``"cpu_seconds"``, or a work counter.

    Returns
    -------
    Price
        In seconds, or counts of work.
    """
    points = [
        (abs(run.errors[measure]), spent)
        for run in study.runs
        if measure in run.errors and (spent := cost(run, work)) is not None
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


def cheapest(studies: list[Convergence], measure: str, required: float) -> tuple[Price | None, list[Price]]:
    """The cheapest scheme by processor time, and all prices.

    Parameters
    ----------
    studies : list of Convergence
    measure : str
        Of ``MEASURES``, in which errors are given.
    required : float
        Relative error that is to be reached.

    Returns
    -------
    best : Price or None
        ``None`` if no scheme reaches the error.
    prices : list of Price
        In the order of ``studies``.
    """
    prices = [price(study, measure, required) for study in studies]
    able = [entry for entry in prices if entry.seconds is not None]
    return min(able, key=lambda entry: entry.seconds or 0.0, default=None), prices


def growth(study: Convergence, work: str, measure: str = MEASURES[0]) -> CostGrowth:
    """Fitted exponents of one kind of cost.

    Parameters
    ----------
    study : Convergence
    work : str
        "wall_seconds", "cpu_seconds" or the name of a work counter.
    measure : str
        Of ``MEASURES``, in which errors are given.

    Returns
    -------
    CostGrowth
    """
    spent = [cost(run, work) for run in study.runs]
    fineness = [1.0 / run.level.size for run in study.runs]
    inverse = [1.0 / abs(e) if (e := run.errors.get(measure)) else None for run in study.runs]
    return CostGrowth(study.ladder.scheme, work, fitted_slope(fineness, spent), fitted_slope(inverse, spent))


def measures(studies: list[Convergence]) -> list[str]:
    """What errors are given in: without adhesion, for instance, there is no pull-off force to be wrong."""
    known = {name for study in studies for run in study.runs for name in run.errors}
    return [name for name in MEASURES if name in known or not known]


def in_words(studies: list[Convergence], measure: str = MEASURES[0]) -> list[str]:
    """One sentence for each of :data:`ERRORS`."""
    if measure not in measures(studies):
        return ["there is none in this scene."]
    sentences = []
    for error in ERRORS:
        best, prices = cheapest(studies, measure, error)
        if best is None:
            sentences.append(f"At {error:.0e} no scheme reaches the error on its ladder.")
            continue
        rest = [entry for entry in prices if entry is not best]
        others = ", ".join(f"{entry.scheme} {_seconds(entry)}" for entry in rest)
        sentences.append(f"At {error:.0e} {best.scheme} is cheapest: {_seconds(best)} ({others or 'alone'}).")
    return sentences


def busy(studies: list[Convergence]) -> float:
    """Largest run time over processor time of the timed runs: 1 on a quiet machine."""
    ratios = [
        run.wall_seconds / run.cpu_seconds
        for study in studies
        for run in study.runs
        if run.wall_seconds and run.cpu_seconds
    ]
    return max(ratios, default=1.0)


def growth_in_words(studies: list[Convergence]) -> list[str]:
    """How processor time grows, one sentence for each scheme."""
    sentences = []
    for study in studies:
        fitted = growth(study, PRICED)
        if fitted.with_resolution is None:
            sentences.append(f"{fitted.scheme}: fewer than three levels to fit a cost to.")
            continue
        line = f"{fitted.scheme}: processor time grows as resolution^{fitted.with_resolution:.2f}"
        if fitted.with_error is not None:
            line += f" and as (1/error)^{fitted.with_error:.2f}"
        sentences.append(line + ".")
    return sentences


def left_out(studies: list[Convergence]) -> list[str]:
    """Work that the scene did not need, from the counters of the finest level."""
    sentences = []
    for study in studies:
        finished = [run for run in study.runs if not run.failed]
        if not finished:
            continue
        scheme = study.ladder.scheme
        missing = skipped_work.left_out(scheme, finished[-1].counters)
        if missing:
            sentences.append(f"{scheme}: {'; '.join(missing)}.")
    return sentences


def _seconds(entry: Price) -> str:
    if entry.seconds is None:
        return "does not reach it"
    return f"{'at most ' if entry.at_most else ''}{entry.seconds:.2g} s"
