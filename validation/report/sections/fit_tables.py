"""A fit in tables: estimates with errors, curves, products of powers, second solver, method."""

from __future__ import annotations

import math
from collections.abc import Iterator

from validation.fits.fit_result import FitResult
from validation.fits.goodness import UNLIKELY
from validation.fits.statistics import Combination, Estimate
from validation.report.document import (
    ABSENT,
    DataTable,
    Paragraph,
    Part,
    Record,
    VerdictCell,
    counted,
    formatted,
)
from validation.report.sections.fit_statements import chance


def table(result: FitResult) -> DataTable:
    """Every parameter with its error."""
    profiles = {one.name: one for one in result.profiles}

    def row(one: Estimate) -> Record:
        record: dict[str, str | VerdictCell] = {
            "parameter": one.name,
            "value ± standard deviation": with_error(one),
            "95 % from": _end(one, one.low),
            "to": _end(one, one.high),
            "first guess": formatted(one.start, ".4g"),
            "note": VerdictCell(one.note, False) if one.note else ABSENT,
        }
        if profiles:
            own = profiles.get(one.name)
            record["profile from"] = ABSENT if own is None else _open(own.low, "no lower end")
            record["profile to"] = ABSENT if own is None else _open(own.high, "no upper end")
        return record

    return DataTable.of(map(row, result.estimates), unbroken=("parameter", "value ± standard deviation"))


def _end(one: Estimate, value: float) -> str:
    return format(value, ".5g") if math.isfinite(one.deviation) else ABSENT


def _open(value: float | None, without: str) -> str:
    return without if value is None else format(value, ".5g")


def with_error(estimate: Estimate) -> str:
    """Value and standard deviation with as many digits as the latter has two."""
    size = estimate.value * estimate.deviation if estimate.logarithmic else estimate.deviation
    if not math.isfinite(size):
        return "not determined"
    if size <= 0.0 or estimate.value == 0.0:
        return f"{estimate.value:.6g} ± {size:.2g}"
    digits = max(1, 2 + math.floor(math.log10(abs(estimate.value))) - math.floor(math.log10(size)))
    return f"{estimate.value:.{min(digits, 15)}g} ± {size:.2g}"


def curves(result: FitResult) -> Iterator[Record]:
    """A row for each curve: noise, misfit, runs test."""
    for one, runs in zip(result.curves, result.goodness.runs, strict=True):
        yield {
            "curve": one.curve.name,
            "rows": str(one.curve.time.size),
            "compared": str(int(one.compared.sum())),
            "noise": format(one.noise, ".3g"),
            "noise from": one.noise_source,
            "misfit / noise": format(float((one.residuals[one.compared] ** 2).mean() ** 0.5), ".3f"),
            "stretches of one sign": str(runs.runs),
            "by chance": format(runs.expected, ".0f"),
            "as few by chance": VerdictCell(chance(runs.probability), runs.probability >= UNLIKELY),
        }


def products(found: tuple[Combination, ...]) -> Iterator[Record]:
    """A row for each product of powers."""
    for one in found:
        error = f"{100.0 * one.deviation:.2g} %" if math.isfinite(one.deviation) else "not determined"
        yield {"product": one.text, "standard deviation": error}


def second_opinion(result: FitResult) -> Iterator[Part]:
    """Differences of the fitted curves by another solver, and shifts of the parameters."""
    assert result.check is not None
    yield DataTable.of(
        {
            "curve": one.curve,
            "difference / noise": formatted(None if one.failure else one.root_mean_square, ".2g"),
            "largest / noise": formatted(None if one.failure else one.largest, ".2g"),
            "difference / force": formatted(None if one.failure else one.relative, ".1e"),
            "failure": one.failure or ABSENT,
        }
        for one in result.check.differences
    )
    if result.check.shifts:
        yield Paragraph("Shifts of the parameters that this difference amounts to, to first order:")
        yield DataTable.of(
            {"parameter": name, "shift / standard deviation": format(shift, "+.3f")}
            for name, shift in result.check.shifts.items()
        )


def method(result: FitResult) -> Iterator[str]:
    """Solver, starts, runs, regularisation, ties."""
    settings = result.settings
    fine = "its own steps" if result.resolution is None else f"{result.resolution} divisions"
    if result.tolerance is not None and result.error_share is not None:
        fine = f"tolerance {result.tolerance:.1e}, with an error of {result.error_share:.2g} of the noise"
    yield f"{settings.solver}, {fine}"
    starts = ", ".join(f"{value:.4g}" for value in result.starts)
    yield f"{counted(settings.starts, 'start')}; sums of squares after few iterations: {starts or ABSENT}"
    yield f"{counted(result.runs, 'run')} in {result.seconds:.0f} s; ended: {result.ended}"
    if settings.prony:
        times = ", ".join(f"{value:g}" for value in settings.prony)
        yield (
            f"Prony weights on the fixed times {times}; the squared second differences of their logarithms, "
            f"times {settings.regularisation:g}, were added to the sum of squares"
        )
    for one in settings.tie:
        yield f"tied: {one}"
