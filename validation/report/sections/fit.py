"""A fit in words and tables: verdict, estimates with errors, what the data cannot tell, second solver."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING

from validation.fits.fit import FitResult
from validation.fits.statistics import UNLIKELY, VAGUE, Combination, Estimate
from validation.report.document import (
    ABSENT,
    Bullets,
    DataTable,
    Document,
    Figure,
    Figures,
    Paragraph,
    Part,
    Record,
    Section,
    VerdictCell,
    counted,
    formatted,
)
from validation.report.figures import fit_chart
from validation.report.pictures import with_drawing

if TYPE_CHECKING:
    from matplotlib.figure import Figure as Drawing

CURVES = """\
Measured and fitted force over penetration; below, what is left, over the noise. Grey rows around jumps of the
force are not compared, the moments of the jumps are."""
COMBINATIONS = """\
Products of powers of the parameters whose errors are independent of each other, the least known first, with
their relative standard deviation. Powers below 0.2 are left out."""
PROFILES = """\
Increase of the least sum of squares as one parameter is held at a value and all others are fitted anew, over
the variance of a residual; at 3.84 the 95 % interval ends."""
VISIBLE_SHIFT = 0.5
"""Shift of a parameter by the second solver, over its standard deviation, that is worth a warning."""


def lead(result: FitResult) -> Paragraph:
    """Whether the model explains the data, in a sentence."""
    good, head = result.goodness, "The fit was interrupted: the best so far. " if not result.converged else ""
    numbers = (
        f"Misfit {math.sqrt(good.reduced):.3g} times the noise (sum of squares {good.chi_squared:.1f} for "
        f"{good.degrees} degrees of freedom; as large by chance: {_chance(good.probability)})."
    )
    if good.explained:
        return Paragraph(f"{head}The model explains the data within their noise. {numbers}", result.converged)
    return Paragraph(f"{head}The model does not explain the data. {numbers}", False)


def statements(result: FitResult) -> list[str]:
    """What a reader has to know before using a number."""
    found = list(result.warnings)
    for one in result.goodness.runs:
        if one.probability < UNLIKELY:
            found.append(
                f"{one.curve}: the signs of the residuals change {one.runs - 1} times, where chance gives "
                f"{one.expected - 1:.0f} ({_chance(one.probability)}): the model misses the shape of this "
                "curve. A branch or the adhesion may be missing, the zero of the record, or the spring."
            )
    if result.goodness.probability < UNLIKELY:
        found.append(
            "The misfit is larger than the noise: the errors below are scaled up to it, but say nothing "
            "about how wrong a wrong model's parameters are."
        )
    for estimate in result.estimates:
        if estimate.note:
            found.append(f"{estimate.name}: {estimate.note}{_largest(estimate)}.")
    for first, second, value in result.confused:
        found.append(f"{first} and {second} are hardly told apart: correlation {value:+.3f}.")
    vague = [one for one in result.combinations if len(one.powers) > 1 and not one.deviation < VAGUE]
    for combination in vague:
        found.append(f"The data do not determine {combination.text}; others below are known.")
    if result.check is not None:
        found += [
            f"{one.curve}: no second opinion, {result.check.solver} failed: {one.failure}"
            for one in result.check.differences
            if one.failure
        ]
        found += [
            f"{name} would move by {shift:+.2f} of its standard deviations with {result.check.solver}."
            for name, shift in result.check.shifts.items()
            if abs(shift) > VISIBLE_SHIFT
        ]
    return found


def _largest(estimate: Estimate) -> str:
    """For a modulus that may be zero: how large it may be, to first order."""
    if not estimate.note or not estimate.name.partition("@")[0].endswith("].modulus"):
        return ""
    if not math.isfinite(estimate.deviation):
        return ""
    largest = estimate.value * (1.0 + 1.96 * estimate.deviation)
    return f"; it may be zero, and at most {largest:.2g} (97.5 %)"


def _chance(probability: float) -> str:
    return f"{probability:.2g}" if probability >= 1e-4 else "below 1e-4"


def with_error(estimate: Estimate) -> str:
    """Value and standard deviation with as many digits as the latter has two."""
    size = estimate.value * estimate.deviation if estimate.logarithmic else estimate.deviation
    if not math.isfinite(size):
        return "not determined"
    if size <= 0.0 or estimate.value == 0.0:
        return f"{estimate.value:.6g} ± {size:.2g}"
    digits = max(1, 2 + math.floor(math.log10(abs(estimate.value))) - math.floor(math.log10(size)))
    return f"{estimate.value:.{min(digits, 15)}g} ± {size:.2g}"


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


def document(result: FitResult, drawings: Mapping[str, Drawing]) -> Document:
    """The whole page, with the figures of :func:`drawings`."""
    said = statements(result)
    parts: list[Part] = [Section("Parameters", (table(result),))]
    if said:
        parts.insert(0, Section("Before you use a number", (Bullets(tuple(said)),)))

    def figures(name: str, caption: str) -> Figures:
        wide = name == "curves"
        return Figures((with_drawing(Figure(f"fit-{name}", caption, wide=wide), drawings[name]),))

    parts.append(Section("Curves", (figures("curves", CURVES), DataTable.of(_curves(result)))))
    known = (
        Paragraph(COMBINATIONS),
        DataTable.of(_combinations(result.combinations)),
        figures("correlations", "Correlations of the parameters."),
    )
    parts.append(Section("What the data tell apart", known))
    if result.profiles:
        parts.append(Section("Profile likelihood", (figures("profiles", PROFILES),)))
    if result.check is not None:
        parts.append(Section(f"The same by {result.check.solver}", tuple(_second(result))))
    parts.append(Section("How it was done", (Bullets(tuple(_method(result))),)))
    return Document(f"Fit: {result.scene.title or 'a scene'}", (lead(result),), tuple(parts))


def drawings(result: FitResult) -> dict[str, Drawing]:
    """The figures by name: ``curves``, ``correlations`` and, where there are some, ``profiles``."""
    made = {
        "curves": fit_chart.draw_curves(result.curves),
        "correlations": fit_chart.draw_correlations(result),
    }
    return made | ({"profiles": fit_chart.draw_profiles(result.profiles)} if result.profiles else {})


def _curves(result: FitResult) -> Iterator[Record]:
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
            "as few by chance": VerdictCell(_chance(runs.probability), runs.probability >= UNLIKELY),
        }


def _combinations(found: tuple[Combination, ...]) -> Iterator[Record]:
    for one in found:
        error = f"{100.0 * one.deviation:.2g} %" if math.isfinite(one.deviation) else "not determined"
        yield {"product": one.text, "standard deviation": error}


def _second(result: FitResult) -> Iterator[Part]:
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


def _method(result: FitResult) -> Iterator[str]:
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
