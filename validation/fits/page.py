"""The folder of a fit: ``index.html``, ``fit.json``, ``scene.toml``, ``fit.png`` and ``fit.svg``.

The page has the verdict, estimates with errors, what the data cannot tell, and the second solver's answer.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Mapping
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from contact_scene import write_scene
from validation.drawing import export
from validation.fits import charts
from validation.fits.errors import UNLIKELY, VAGUE, Combination, Estimate
from validation.fits.result import FitResult, FittedCurve
from validation.report import report
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
    with_drawing,
)
from validation.runs.folder import to_json
from validation.runs.provenance import stamp, version

if TYPE_CHECKING:
    from matplotlib.figure import Figure as Drawing

FORMAT = 1
VISIBLE_SHIFT = 0.5
"""Shift of a parameter by the second solver, over its standard deviation, that is worth a warning."""
CURVES = """\
Measured and fitted force over the position of indenter or stage; below, what is left, over the noise. Grey
rows around jumps of the force are not compared, the moments of the jumps are."""
COMBINATIONS = """\
Products of powers of the parameters whose errors are independent of each other, the least known first, with
their relative standard deviation. Powers below 0.2 are left out."""
PROFILES = """\
Increase of the least sum of squares as one parameter is held at a value and all others are fitted anew, over
the variance of a residual; at 3.84 the 95 % interval ends."""


def of_fit(result: FitResult) -> dict[str, Any]:
    """``fit.json``: every number of a fit. The keys are a fixed contract with whoever reads it."""
    good = result.goodness
    return {
        "format": FORMAT,
        "converged": result.converged,
        "ended": result.ended,
        "explained": good.explained,
        "parameters": [asdict(one) for one in result.estimates],
        "correlations": result.correlations,
        "combinations": [asdict(one) for one in result.combinations],
        "hardly_told_apart": result.confused,
        "goodness": {
            "sum_of_squares": good.chi_squared,
            "degrees": good.degrees,
            "noise_degrees": good.noise_degrees,
            "probability": good.probability,
            "runs_tests": [asdict(one) for one in good.runs],
            "misfit_over_noise": math.sqrt(good.reduced),
            "rms_over_range": good.share,
            "within": good.within,
        },
        "profiles": [asdict(one) for one in result.profiles],
        "second_solver": None if result.check is None else asdict(result.check),
        "curves": [
            {
                "name": one.curve.name,
                "noise": one.noise,
                "noise_source": one.noise_source,
                "misfit_over_noise": one.misfit,
                "rms_over_range": one.share,
                "rows_correlated": one.correlated,
                "worst_stretch": one.curve.time[one.stretch][[0, -1]] if _missed(one) else None,
                "time": one.curve.time,
                "measured_force": one.curve.force,
                "fitted_force": one.force,
                "compared": one.compared,
            }
            for one in result.curves
        ],
        "statements": statements(result),
        "settings": asdict(result.settings),
        "resolution": result.settings.resolution,
        "step_tolerance": result.tolerance,
        "solver_error_over_noise": result.error_share,
        "starts": result.starts,
        "runs": result.runs,
        "seconds": result.seconds,
        "environment": stamp(),
        "program": version(),
        "question": result.question,
    }


def write_fit(result: FitResult, folder: Path) -> None:
    """Write everything; the page last, so that a folder with a page is complete."""
    (folder / "index.html").unlink(missing_ok=True)
    write_scene(result.scene, folder / "scene.toml")
    drawn = drawings(result)
    curves = {"fit.png": export.png(drawn["curves"]), "fit.svg": export.svg_file(drawn["curves"])}
    report.write(folder, document(result, drawn), {"fit.json": to_json(of_fit(result)), **curves})


def document(result: FitResult, drawings: Mapping[str, Drawing]) -> Document:
    """The whole page, with the figures of :func:`drawings`."""
    said = statements(result)
    parts: list[Part] = [Section("Parameters", (table(result),))]
    if said:
        parts.insert(0, Section("Before you use a number", (Bullets(tuple(said)),)))

    def figures(name: str, caption: str) -> Figures:
        wide = name == "curves"
        return Figures((with_drawing(Figure(f"fit-{name}", caption, wide=wide), drawings[name]),))

    parts.append(Section("Curves", (figures("curves", CURVES), DataTable.of(curves(result)))))
    known = (
        Paragraph(COMBINATIONS),
        DataTable.of(products(result.combinations)),
        figures("correlations", "Correlations of the parameters."),
    )
    parts.append(Section("What the data tell apart", known))
    if result.profiles:
        parts.append(Section("Profile likelihood", (figures("profiles", PROFILES),)))
    if result.check is not None:
        parts.append(Section(f"The same by {result.check.solver}", tuple(second_opinion(result))))
    parts.append(Section("How it was done", (Bullets(tuple(method(result))),)))
    return Document(f"Fit: {result.scene.title or 'a scene'}", (lead(result),), tuple(parts))


def drawings(result: FitResult) -> dict[str, Drawing]:
    """The figures by name: ``curves``, ``correlations`` and, where there are some, ``profiles``."""
    made = {
        "curves": charts.draw_curves(result),
        "correlations": charts.draw_correlations(result),
    }
    return made | ({"profiles": charts.draw_profiles(result.profiles)} if result.profiles else {})


def lead(result: FitResult) -> Paragraph:
    """Whether the model explains the data, in a sentence."""
    good, head = result.goodness, "The fit was interrupted: the best so far. " if not result.converged else ""
    numbers = (
        f"Misfit {math.sqrt(good.reduced):.3g} times the noise (sum of squares {good.chi_squared:.1f} for "
        f"{good.degrees} degrees of freedom; as large by chance: {chance(good.probability)}), "
        f"{100.0 * good.share:.2g} % of the range of the force."
    )
    if good.explained:
        share = "their noise" if good.within is None else f"{100.0 * good.within:g} % of their range"
        return Paragraph(f"{head}The model explains the data within {share}. {numbers}", result.converged)
    return Paragraph(f"{head}The model does not explain the data. {numbers}", False)


def statements(result: FitResult) -> list[str]:
    """What a reader has to know before using a number."""
    good, found = result.goodness, list(result.warnings)
    if not good.explained:
        found += _misfits(result)
    for estimate in result.estimates:
        if estimate.note:
            found.append(f"{estimate.name}: {estimate.note}{_largest(estimate)}.")
    found += _times(result)
    for first, second, value in result.confused:
        text = f"{first} and {second} are hardly told apart: correlation {value:+.3f}"
        kinds = {re.sub(r".*branches.*[.]", "", one.partition("@")[0]) for one in (first, second)}
        remedy = ", at one speed only their ratio: fit a record of a second speed together with this one"
        found.append(text + (remedy if kinds == {"adhesion.zone", "time"} else "") + ".")
    vague = [one for one in result.combinations if len(one.powers) > 1 and not one.deviation < VAGUE]
    found += [f"The data do not determine {one.text}; others below are known." for one in vague]
    if result.check is not None:
        solver = result.check.solver
        found += [
            f"{one.curve}: no second opinion, {solver} failed: {one.failure}"
            for one in result.check.differences
            if one.failure
        ]
        found += [
            f"{name} would move by {shift:+.2f} of its standard deviations with {solver}."
            for name, shift in result.check.shifts.items()
            if abs(shift) > VISIBLE_SHIFT
        ]
    return found


def _misfits(result: FitResult) -> Iterator[str]:
    """Where and how the model misses the data."""
    for one, runs in zip(result.curves, result.goodness.runs, strict=True):
        if runs.probability < UNLIKELY:
            yield (
                f"{runs.curve}: the signs of the residuals change {runs.runs - 1} times, where chance gives "
                f"{runs.expected - 1:.0f} ({chance(runs.probability)}): the model misses the shape of this "
                "curve. A branch or the adhesion may be missing, the zero of the record, or the spring."
            )
        if _missed(one):
            begin, end = one.curve.time[one.stretch][[0, -1]].tolist()
            largest = float(abs(one.residuals[one.stretch]).max()) * one.noise / np.ptp(one.curve.force)
            yield (
                f"{one.curve.name}: missed most from time {begin:.4g} to {end:.4g}, by up to "
                f"{100.0 * largest:.2g} % of the range of the force."
            )
    if result.goodness.within is None and result.goodness.probability < UNLIKELY:
        yield (
            "The misfit is larger than the noise: the errors below are scaled up to it, but say nothing "
            "about how wrong a wrong model's parameters are. --within SHARE asks for a share of the range."
        )


def _missed(one: FittedCurve) -> bool:
    """Whether a stretch of a curve is missed at all."""
    return one.stretch.stop > one.stretch.start


def _times(result: FitResult) -> Iterator[str]:
    """Which relaxation times the records hold, where branches are fitted."""
    branches = [one for one in result.estimates if "branches[" in one.name]
    if not branches:
        return
    shortest = 2.0 * min(one.curve.sampling for one in result.curves)
    longest = max(float(np.ptp(one.curve.time)) for one in result.curves)
    outside = [
        one.name
        for one in branches
        if one.name.partition("@")[0].endswith("].time") and not shortest <= one.value <= longest
    ]
    yield (
        f"The records hold times from {shortest:.3g} to {longest:.3g}: the relaxed modulus is that after "
        f"{longest:.3g}" + (f", and {', '.join(outside)} lies outside." if outside else ".")
    )


def _largest(estimate: Estimate) -> str:
    """For a modulus that may be zero: how large it may be, to first order."""
    if not estimate.note or not estimate.name.partition("@")[0].endswith("].modulus"):
        return ""
    if not math.isfinite(estimate.deviation):
        return ""
    largest = estimate.value * (1.0 + 1.96 * estimate.deviation)
    return f"; it may be zero, and at most {largest:.2g} (97.5 %)"


def chance(probability: float) -> str:
    """A probability in words."""
    return f"{probability:.2g}" if probability >= 1e-4 else "below 1e-4"


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
            "misfit / noise": format(one.misfit, ".3f"),
            "misfit / range": f"{100.0 * one.share:.2g} %",
            "rows correlated": format(one.correlated, ".0f"),
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
    fine = "its own steps" if settings.resolution is None else f"{settings.resolution} divisions"
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
