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
from validation.fits.errors import UNLIKELY, VAGUE, Estimate
from validation.fits.result import FitResult
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
CAPTIONS = {
    "curves": "Measured and fitted force over the position of indenter or stage; below, what is left, over "
    "the noise. Grey rows around jumps of the force are not compared, the moments of the jumps are.",
    "correlations": "Correlations of the parameters.",
    "profiles": "Increase of the least sum of squares as one parameter is held at a value and all others are "
    "fitted anew, over the variance of a residual; at 3.84 the 95 % interval ends.",
}
COMBINATIONS = """\
Products of powers of the parameters whose errors are independent of each other, the least known first, with
their relative standard deviation. Powers below 0.2 are left out."""


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
            "misfit_over_noise": good.misfit,
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
                "worst_stretch": one.missed,
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


def drawings(result: FitResult) -> dict[str, Drawing]:
    """The figures by name: ``curves``, ``correlations`` and, where there are some, ``profiles``."""
    made = {"curves": charts.draw_curves(result), "correlations": charts.draw_correlations(result)}
    return made | ({"profiles": charts.draw_profiles(result.profiles)} if result.profiles else {})


def document(result: FitResult, drawings: Mapping[str, Drawing]) -> Document:
    """The whole page, with the figures of :func:`drawings`."""
    shown = {
        name: Figures((with_drawing(Figure(f"fit-{name}", CAPTIONS[name], wide=name == "curves"), drawn),))
        for name, drawn in drawings.items()
    }
    said = statements(result)
    products = (
        {"product": one.text, "standard deviation": _percent(one.deviation)} for one in result.combinations
    )
    sections: dict[str, tuple[Part, ...]] = {
        "Before you use a number": (Bullets(tuple(said)),) if said else (),
        "Parameters": (table(result),),
        "Curves": (shown["curves"], DataTable.of(_curves(result))),
        "What the data tell apart": (
            Paragraph(COMBINATIONS),
            DataTable.of(products),
            shown["correlations"],
        ),
        "Profile likelihood": (shown["profiles"],) if result.profiles else (),
        f"The same by {result.check.solver}" if result.check else "": tuple(_second_opinion(result)),
        "How it was done": (Bullets(tuple(_method(result))),),
    }
    parts = tuple(Section(title, own) for title, own in sections.items() if own)
    return Document(f"Fit: {result.scene.title or 'a scene'}", (lead(result),), parts)


def lead(result: FitResult) -> Paragraph:
    """Whether the model explains the data, in a sentence."""
    good, head = result.goodness, "The fit was interrupted: the best so far. " if not result.converged else ""
    numbers = (
        f"Misfit {good.misfit:.3g} times the noise (sum of squares {good.chi_squared:.1f} for "
        f"{good.degrees} degrees of freedom; as large by chance: {_chance(good.probability)}), "
        f"{100.0 * good.share:.2g} % of the range of the force."
    )
    if good.explained:
        share = "their noise" if good.within is None else f"{100.0 * good.within:g} % of their range"
        return Paragraph(f"{head}The model explains the data within {share}. {numbers}", result.converged)
    return Paragraph(f"{head}The model does not explain the data. {numbers}", False)


def statements(result: FitResult) -> list[str]:
    """What a reader has to know before using a number."""
    found = [*result.warnings, *([] if result.goodness.explained else _misfits(result))]
    found += [f"{one.name}: {one.note}{_largest(one)}." for one in result.estimates if one.note]
    found += _times(result)
    for first, second, value in result.confused:
        kinds = {re.sub(r".*branches.*[.]", "", one.partition("@")[0]) for one in (first, second)}
        remedy = ", at one speed only their ratio: fit a record of a second speed together with this one"
        remedy = remedy if kinds == {"adhesion.zone", "time"} else ""
        found.append(f"{first} and {second} are hardly told apart: correlation {value:+.3f}{remedy}.")
    vague = [one for one in result.combinations if len(one.powers) > 1 and not one.deviation < VAGUE]
    found += [f"The data do not determine {one.text}; others below are known." for one in vague]
    if result.check is None:
        return found
    solver, failed = result.check.solver, [one for one in result.check.differences if one.failure]
    found += [f"{one.curve}: no second opinion, {solver} failed: {one.failure}" for one in failed]
    shifts = {name: at for name, at in result.check.shifts.items() if abs(at) > VISIBLE_SHIFT}
    moved = "of its standard deviations with"
    return found + [f"{name} would move by {at:+.2f} {moved} {solver}." for name, at in shifts.items()]


def _misfits(result: FitResult) -> Iterator[str]:
    """Where and how the model misses the data."""
    for one, runs in zip(result.curves, result.goodness.runs, strict=True):
        if runs.probability < UNLIKELY:
            yield (
                f"{runs.curve}: the signs of the residuals change {runs.runs - 1} times, where chance gives "
                f"{runs.expected - 1:.0f} ({_chance(runs.probability)}): the model misses the shape of this "
                "curve. A branch or the adhesion may be missing, the zero of the record, or the spring."
            )
        if one.missed:
            begin, end = one.missed
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


def _times(result: FitResult) -> Iterator[str]:
    """Which relaxation times the records hold, where branches are fitted."""
    branches = {one.name: one.value for one in result.estimates if "branches[" in one.name}
    if not branches:
        return
    shortest = 2.0 * min(one.curve.sampling for one in result.curves)
    longest = max(float(np.ptp(one.curve.time)) for one in result.curves)
    times = {name: value for name, value in branches.items() if name.partition("@")[0].endswith("].time")}
    outside = [name for name, value in times.items() if not shortest <= value <= longest]
    yield (
        f"The records hold times from {shortest:.3g} to {longest:.3g}: the relaxed modulus is that after "
        f"{longest:.3g}" + (f", and {', '.join(outside)} lies outside." if outside else ".")
    )


def _largest(one: Estimate) -> str:
    """For a modulus that may be zero: how large it may be, to first order."""
    if not one.name.partition("@")[0].endswith("].modulus") or not math.isfinite(one.deviation):
        return ""
    return f"; it may be zero, and at most {one.value * (1.0 + 1.96 * one.deviation):.2g} (97.5 %)"


def _chance(probability: float) -> str:
    """A probability in words."""
    return f"{probability:.2g}" if probability >= 1e-4 else "below 1e-4"


def _percent(share: float) -> str:
    """A relative deviation in words."""
    return f"{100.0 * share:.2g} %" if math.isfinite(share) else "not determined"


def table(result: FitResult) -> DataTable:
    """Every parameter with its error."""
    profiles = {one.name: one for one in result.profiles}

    def row(one: Estimate) -> Record:
        known = math.isfinite(one.deviation)
        record: dict[str, str | VerdictCell] = {
            "parameter": one.name,
            "value ± standard deviation": with_error(one),
            "95 % from": format(one.low, ".5g") if known else ABSENT,
            "to": format(one.high, ".5g") if known else ABSENT,
            "first guess": format(one.start, ".4g"),
            "note": VerdictCell(one.note, False) if one.note else ABSENT,
        }
        for title, end in (("profile from", "low"), ("profile to", "high")) if profiles else ():
            own = profiles.get(one.name)
            without = "no lower end" if end == "low" else "no upper end"
            value = None if own is None else getattr(own, end)
            record[title] = ABSENT if own is None else without if value is None else format(value, ".5g")
        return record

    return DataTable.of(map(row, result.estimates), unbroken=("parameter", "value ± standard deviation"))


def with_error(estimate: Estimate) -> str:
    """Value and standard deviation with as many digits as the latter has two."""
    size = estimate.value * estimate.deviation if estimate.logarithmic else estimate.deviation
    if not math.isfinite(size):
        return "not determined"
    if size <= 0.0 or estimate.value == 0.0:
        return f"{estimate.value:.6g} ± {size:.2g}"
    digits = max(1, 2 + math.floor(math.log10(abs(estimate.value))) - math.floor(math.log10(size)))
    return f"{estimate.value:.{min(digits, 15)}g} ± {size:.2g}"


def _curves(result: FitResult) -> Iterator[Record]:
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
            "as few by chance": VerdictCell(_chance(runs.probability), runs.probability >= UNLIKELY),
        }


def _second_opinion(result: FitResult) -> Iterator[Part]:
    """Differences of the fitted curves by another solver, and shifts of the parameters."""
    if result.check is None:
        return
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
    yield from (f"tied: {one}" for one in settings.tie)
