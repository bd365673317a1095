"""The folders of a fit and of fits of each curve: a page, numbers and figures.

The page of a fit has the verdict, what to know before using a number, estimates with errors, what the data
cannot tell, and the second solver's answer; numbers bear the names of ``fit.json``.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from contact_scene import write_scene
from validation.drawing import figure as fig
from validation.fits.fit import OF_PARAMETER, EachFit, dataset
from validation.fits.result import CHI_SQUARED, UNLIKELY, VAGUE, Estimate, FitResult, Posterior
from validation.measure.scaling import unit_name
from validation.report import document as doc
from validation.report import report
from validation.report.document import ABSENT, DataTable, Paragraph, Record, Section, VerdictCell, number
from validation.runs.folder import to_json
from validation.runs.provenance import stamp, version

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure as Drawing

FORMAT = 1
VISIBLE_SHIFT = 0.5
"""Shift of a parameter by the second solver, over its standard deviation, that is worth a warning."""
CAPTIONS = {
    "curves": "Measured and fitted force over the position of indenter or stage; below, what is left, over "
    "the noise. Grey rows around jumps of the force are not compared, the moments of the jumps are.",
    "profiles": "Increase of the least sum of squares as one parameter is held at a value and all others are "
    "fitted anew, over the variance of a residual; at 3.84 the 95 % interval ends.",
    "posterior": "Each pair of parameters as the walkers found them, and how often each value.",
    "each": "Every parameter over the curves, with its 95 % interval.",
}
COMBINATIONS = """\
Products of powers of the parameters whose errors are independent of each other, the least known first, with
their relative standard deviation (powers below 0.2 are left out); and the correlations of all parameters."""
METHOD = ("step_tolerance", "solver_error_over_noise", "starts", "runs", "seconds")
"""How a fit was carried out."""
STATED = ("converged", "ended", "explained", "correlations", "hardly_told_apart", "profiles", "second_solver")
"""What stands in ``fit.json`` as it stands in the result, besides."""
PROFILED = ("profile from", "low", "no lower end"), ("profile to", "high", "no upper end")
SAMPLED = {"posterior from": "low", "posterior median": "median", "posterior to": "high"}
MOST_COLUMNS = 4  # curves or profiles side by side
ROWS: dict[str, Any] = {"linestyle": "none", "marker": "o", "markersize": 2.2, "rasterized": True}
LEGEND: dict[str, Any] = {"frameon": False, "fontsize": "small", "labelcolor": fig.INK}


def of_fit(result: FitResult) -> dict[str, Any]:
    """``fit.json``: every number of a fit. The keys are a fixed contract with whoever reads it."""
    curves = [
        {"name": one.curve.name, **one.numbers, "time": one.curve.time, "measured_force": one.curve.force}
        | {"fitted_force": one.force, "compared": one.compared}
        for one in result.curves
    ]
    sampled = result.posterior and {key: at for key, at in vars(result.posterior).items() if key != "samples"}
    return {
        "format": FORMAT,
        **{name: getattr(result, name) for name in (*STATED, *METHOD, "question")},
        "parameters": [vars(one) for one in result.estimates],
        "combinations": [vars(one) for one in result.combinations],
        "goodness": vars(result.goodness),
        "posterior": sampled,
        "curves": curves,
        "statements": statements(result),
        "settings": vars(result.settings),
        "resolution": result.settings.resolution,
        "environment": stamp(),
        "program": version(),
    }


def write_fit(result: FitResult, folder: Path) -> None:
    """Write everything; the page last, so that a folder with a page is complete."""
    (folder / "index.html").unlink(missing_ok=True)
    write_scene(result.scene, folder / "scene.toml")
    drawn = draw_curves(result)
    files: dict[str, str | bytes] = {**fig.as_files(drawn, "fit"), "fit.json": to_json(of_fit(result))}
    report.write(folder, document(result, drawn), files)


def document(result: FitResult, curves: Drawing) -> doc.Document:
    """The whole page, with the figure of the curves; a section without parts has nothing to say."""
    said, other = statements(result), result.second_solver
    numbers: list[Record] = []
    for one, runs in zip(result.curves, result.goodness.runs_tests, strict=True):
        chance = VerdictCell(_chance(runs["probability"]), runs["probability"] >= UNLIKELY)
        own = {"curve": one.curve.name, "rows": one.curve.time.size, "compared": one.compared.sum()}
        own |= {name: at for name, at in one.numbers.items() if name != "worst_stretch"}
        own |= {"stretches of one sign": runs["runs"], "by chance": round(runs["expected"])}
        numbers.append({**_plainly(own, 3), "as few by chance": chance})
    products: list[Record] = []
    for product in result.combinations:
        known = math.isfinite(product.deviation)
        size = f"{100.0 * product.deviation:.2g} %" if known else "not determined"
        products.append({"product": product.text, "standard deviation": size})
    correlations = [
        {"correlation": f"{place} {one.name}"} | {f"{n}": f"{value:+.2f}" for n, value in enumerate(row, 1)}
        for place, (one, row) in enumerate(zip(result.estimates, result.correlations, strict=True), 1)
    ]
    correlated = DataTable.of(correlations, unbroken=("correlation",))
    method = vars(result.settings) | {name: getattr(result, name) for name in METHOD}
    stated = {name: at for name, at in method.items() if at is not False and at not in (None, (), "")}
    sections: dict[str, list[doc.Part]] = {
        "Before you use a number": [doc.Bullets(tuple(said))] if said else [],
        "Parameters": [table(result)],
        "Curves": [_figure("curves", curves), DataTable.of(numbers)],
        "What the data tell apart": [Paragraph(COMBINATIONS), DataTable.of(products), correlated],
    }
    if result.profiles:
        sections["Profile likelihood"] = [_figure("profiles", draw_profiles(result.profiles))]
    if result.posterior:
        sections["Posterior"] = _sampled(result.posterior)
    if other:
        shift = "shift, to first order, over its deviation"
        shifts = ({"parameter": name, shift: f"{at:+.3f}"} for name, at in other["shifts"].items())
        differences = DataTable.of(map(_plainly, other["differences"]))
        sections[f"The same by {other['solver']}"] = [differences, DataTable.of(shifts)]
    done = tuple(_plainly({"ended": result.ended} | stated, 4).items())
    sections["How it was done"] = [DataTable(("", ""), done, numeric=False)]
    if result.settings.prony:
        weight = f"{result.settings.regularisation:g}"
        told = f"The squared second differences of their logarithms, times {weight}, were added to the sum of"
        sections["How it was done"].append(Paragraph(f"{told} squares."))
    shown = tuple(Section(title, tuple(parts)) for title, parts in sections.items() if parts)
    return doc.Document(f"Fit: {result.scene.title or 'a scene'}", (lead(result),), shown)


def _plainly(values: Mapping[str, Any], digits: int = 2) -> dict[str, str]:
    """Numbers, or several of them, by their names in words."""
    several = {name: value if isinstance(value, tuple) else (value,) for name, value in values.items()}
    return {doc.plain(name): ", ".join(number(one, digits) for one in all_) for name, all_ in several.items()}


def _figure(name: str, drawn: Drawing) -> doc.Figures:
    shown = doc.Figure(f"fit-{name}", CAPTIONS[name], wide=name != "profiles")
    return doc.Figures((doc.with_drawing(shown, drawn),))


def lead(result: FitResult) -> Paragraph:
    """Whether the model explains the data, in a sentence."""
    good, head = result.goodness, "The fit was interrupted: the best so far. " if not result.converged else ""
    share = "their noise" if good.within is None else f"{100.0 * good.within:g} % of their range"
    verdict = f"explains the data within {share}" if good.explained else "does not explain the data"
    numbers = (
        f"Misfit {good.misfit_over_noise:.3g} times the noise (sum of squares {good.sum_of_squares:.1f} for "
        f"{good.degrees} degrees of freedom; as large by chance: {_chance(good.probability)}), "
        f"{100.0 * good.rms_over_range:.2g} % of the range of the force."
    )
    return Paragraph(f"{head}The model {verdict}. {numbers}", good.explained and result.converged)


def statements(result: FitResult) -> list[str]:
    """What a reader has to know before using a number."""
    other = result.second_solver or {"solver": "", "differences": (), "shifts": {}}
    failed = (
        f"{one['curve']}: no second opinion, {other['solver']} failed: {one['failure']}"
        for one in other["differences"]
        if one["failure"]
    )
    shifted = (
        f"{name} would move by {at:+.2f} of its standard deviations with {other['solver']}."
        for name, at in other["shifts"].items()
        if abs(at) > VISIBLE_SHIFT
    )
    return [*result.warnings, *_misfits(result), *_of_parameters(result), *failed, *shifted]


def _misfits(result: FitResult) -> Iterator[str]:
    """Where and how the model misses data that it does not explain."""
    good = result.goodness
    if good.explained:
        return
    for one, runs in zip(result.curves, good.runs_tests, strict=True):
        if runs["probability"] < UNLIKELY:
            yield (
                f"{one.curve.name}: the signs of the residuals change {runs['runs'] - 1} times, where chance "
                f"gives {runs['expected'] - 1:.0f} ({_chance(runs['probability'])}): the model misses the "
                "shape of this curve. A branch or the adhesion may be missing, the zero of the record, or "
                "the spring."
            )
        if stretch := one.numbers["worst_stretch"]:
            missed = (one.curve.force - one.force)[one.stretch]
            largest = 100.0 * float(abs(missed).max() / np.ptp(one.curve.force))
            yield (
                f"{one.curve.name}: missed most from time {stretch[0]:.4g} to {stretch[1]:.4g}, by up to "
                f"{largest:.2g} % of the range of the force."
            )
    if good.within is None and good.probability < UNLIKELY:
        yield (
            "The misfit is larger than the noise: the errors below are scaled up to it, but say nothing "
            "about how wrong a wrong model's parameters are. --within SHARE asks for a share of the range."
        )


def _of_parameters(result: FitResult) -> Iterator[str]:
    """What is wrong with parameters, which relaxation times the records hold, what is hardly told apart."""
    kinds = {one.name: re.sub(r".*branches.*[.]", "", one.name.partition("@")[0]) for one in result.estimates}
    for one in result.estimates:
        if one.note and kinds[one.name] == "modulus" and math.isfinite(one.deviation):
            largest = one.value * (1.0 + 1.96 * one.deviation)  # to first order
            yield f"{one.name}: {one.note}; it may be zero, and at most {largest:.2g} (97.5 %)."
        elif one.note:
            yield f"{one.name}: {one.note}."
    branches = [one for one in result.estimates if "branches[" in one.name]
    shortest = 2.0 * min(float(np.median(np.diff(one.curve.time))) for one in result.curves)
    longest = max(float(np.ptp(one.curve.time)) for one in result.curves)
    times = (one for one in branches if kinds[one.name] == "time")
    outside = ", ".join(one.name for one in times if not shortest <= one.value <= longest)
    if branches:
        held = (
            f"The records hold times from {shortest:.3g} to {longest:.3g}: the relaxed modulus is that after "
        )
        yield f"{held}{longest:.3g}" + (f", and {outside} lies outside." if outside else ".")
    for first, second, value in result.hardly_told_apart:
        told = f"{first} and {second} are hardly told apart: correlation {value:+.3f}"
        if {kinds[first], kinds[second]} == {"adhesion.zone", "time"}:
            told += ", at one speed only their ratio: fit a record of a second speed together with this one"
        yield f"{told}."
    for product in result.combinations:
        if len(product.powers) > 1 and not product.deviation < VAGUE:
            yield f"The data do not determine {product.text}; others below are known."


def _chance(probability: float) -> str:
    """A probability in words."""
    return f"{probability:.2g}" if probability >= 1e-4 else "below 1e-4"


def table(result: FitResult) -> DataTable:
    """Every parameter with its error."""
    profiles = {one["name"]: one for one in result.profiles}
    sampled = result.posterior.intervals if result.posterior else {}

    def row(one: Estimate) -> Record:
        ends = (one.low, one.high) if math.isfinite(one.deviation) else (None, None)
        record = {
            "parameter": one.name,
            "value ± standard deviation": with_error(one),
            **{title: number(end, 5) for title, end in zip(("95 % from", "to"), ends, strict=True)},
            "first guess": number(one.start, 4),
            "note": VerdictCell(one.note, False) if one.note else ABSENT,
        }
        if sampled:
            own = sampled.get(one.name, {})
            record |= {title: number(own.get(end), 5) for title, end in SAMPLED.items()}
        for title, end, without in PROFILED if profiles else ():
            at = profiles[one.name][end] if one.name in profiles else ABSENT
            record[title] = without if at is None else number(at, 5)
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


def draw_curves(result: FitResult) -> Drawing:
    """A column for each curve: force over position, residuals over time; what is not explained is marked."""
    panels, figure = _panels(len(result.curves), (3.6, 4.6), 1.4, (2.2, 1.0))
    length, force, time = (f" ({unit_name(result.scene, name)})" for name in ("penetration", "force", "time"))
    for place, (one, (upper, lower)) in enumerate(zip(result.curves, panels, strict=False)):
        curve, position = one.curve, one.curve.position - one.zero
        missed = not result.explained and one.numbers["worst_stretch"]
        parts: list[tuple[Any, str, str]] = [
            (one.compared, fig.SERIES[0], "measured"),
            (~one.compared, fig.GREY, "not compared"),
        ]
        if missed:
            parts.append((one.stretch, fig.SERIES[1], "not explained"))
            lower.axvspan(*missed, color=fig.SERIES[1], alpha=0.2, linewidth=0)
        for rows, colour, label in parts:
            if curve.time[rows].size:
                upper.plot(position[rows], curve.force[rows], color=colour, label=label, **ROWS)
        upper.plot(position, one.force, color=fig.VERMILION, linewidth=1.1, label="fit")
        upper.set_title(curve.name, fontsize="medium")
        over_noise = (curve.force - one.force) / one.model.moments.noise
        lower.plot(curve.time[one.compared], over_noise[one.compared], color=fig.SERIES[0], **ROWS)
        lower.axhline(0.0, color=fig.INK, linewidth=0.8)
        first = place % MOST_COLUMNS == 0
        for axes in (upper, lower):
            fig.format_axes(axes)
            axes.locator_params(axis="x", nbins=5)
        driven = "penetration" if curve.stage is None else "position of the stage"
        fig.label_axes(upper, driven + length, f"force{force}" if first else "")
        fig.label_axes(lower, f"time{time}", "(measured - fit)/noise" if first else "")
    panels[0][0].legend(**LEGEND)
    return figure


def _panels(
    count: int, size: tuple[float, float], least: float, heights: tuple[float, ...] = (1.0,)
) -> tuple[list[list[Axes]], Drawing]:
    """Axes for each of some things, as many one below the other as heights, and their figure."""
    columns, rows, high = min(count, MOST_COLUMNS), -(-count // MOST_COLUMNS), len(heights)
    inches, ratios = (size[0] * max(columns, least), size[1] * rows), [*heights] * rows
    figure, all_axes = fig.drawing(inches, high * rows, columns, squeeze=False, height_ratios=ratios)
    groups = [list(group) for row in range(rows) for group in all_axes[high * row : high * (row + 1)].T]
    for axes in (axes for group in groups[count:] for axes in group):
        axes.set_axis_off()
    return groups, figure


def draw_profiles(profiles: Sequence[Any]) -> Drawing:
    """Increase of the sum of squares over each parameter, the 95 % limit drawn in."""
    panels, figure = _panels(len(profiles), (2.6, 2.4), 1.5)
    look: dict[str, Any] = {
        "color": fig.SERIES[0],
        "marker": fig.MARKERS[0],
        "markersize": 3,
        "linewidth": 1.0,
    }
    for place, ([axes], one) in enumerate(zip(panels, profiles, strict=False)):
        axes.plot(one["values"], one["increases"], **look)
        axes.axhline(CHI_SQUARED, color=fig.VERMILION, linestyle="--", linewidth=1.0, label="95 %")
        axes.set(xlabel=one["name"], ylim=(0.0, 12.0))
        fig.format_axes(axes)
        axes.locator_params(axis="x", nbins=4)
        if place % MOST_COLUMNS == 0:
            axes.set_ylabel("increase of the sum of squares", color=fig.INK)
    panels[0][0].legend(**LEGEND)
    return figure


def _sampled(one: Posterior) -> list[doc.Part]:
    """How the posterior was sampled; all pairs of parameters, and each by itself."""
    import corner

    told = (
        f"{one.walkers} walkers by {one.solver}, {one.steps} steps each, the first {one.discarded} left out; "
        f"autocorrelation over {one.autocorrelation:.0f} steps, {one.acceptance:.0%} accepted. Flat in the "
        "logarithms of positive numbers, within their bounds."
    )
    count = len(one.intervals)
    figure, _ = fig.drawing((1.8 * count, 1.8 * count), count, count, layout=None)
    look: dict[str, Any] = {"color": fig.SERIES[0], "label_kwargs": {"fontsize": "small", "color": fig.INK}}
    look |= {"plot_datapoints": False, "max_n_ticks": 4, "labelpad": 0.2, "quantiles": [0.025, 0.5, 0.975]}
    corner.corner(one.samples, labels=[*one.intervals], fig=figure, **look)
    return [Paragraph(told), _figure("posterior", figure)]


def write_each(found: Sequence[EachFit], folder: Path) -> None:
    """Write ``table.csv``, ``map.nc`` and the page with the table and a figure."""
    data = dataset(found)
    whole = data.drop_vars(OF_PARAMETER).drop_dims("parameter").to_dataframe()
    parameters = [(name, of) for name in data.parameter.values.tolist() for of in OF_PARAMETER]
    for place, (name, of) in enumerate(parameters):
        title = name if of == "value" else f"{name} {of}"
        whole.insert(place, title, data[of].sel(parameter=name, drop=True))
    files: dict[str, str | bytes] = {
        "table.csv": whole.to_csv(na_rep="nan", lineterminator="\n"),
        "map.nc": bytes(data.to_netcdf(engine="scipy")),
    }
    explained = sum(one.explained for one in found)
    lead = Paragraph(f"{explained} of {len(found)} curves are explained.", explained == len(found))
    section = Section("Curves", (_figure("each", draw_each(data)), each_table(found)))
    report.write(folder, doc.Document("Fit of each curve", (lead,), (section,)), files)


def each_table(found: Sequence[EachFit]) -> DataTable:
    """A row for each curve."""
    names = list(dict.fromkeys(name for one in found for name in one.estimates))
    rows: list[Record] = []
    for one in found:
        share = ABSENT if one.result is None else f"{one.result.goodness.rms_over_range:.2%}"
        verdict = VerdictCell(one.failure or ("yes" if one.explained else "no"), one.explained)
        shown = {name: with_error(one.estimates[name]) if name in one.estimates else ABSENT for name in names}
        rows.append({"curve": one.curve, **shown, "rms / range": share, "explained": verdict})
    return DataTable.of(rows, unbroken=("curve", *names))


def draw_each(data: Any) -> Drawing:
    """A panel for each parameter: values with their intervals over the number of the curve."""
    explained, places, count = data.explained.values, np.arange(1, data.curve.size + 1), data.parameter.size
    size = (7.2, 1.6 * max(count, 1) + 0.6)
    figure, [*panels] = fig.drawing(size, max(count, 1), 1, sharex=True, squeeze=False)
    for [axes], name in zip(panels, data.parameter.values, strict=False):
        value, _, low, high = (data[of].sel(parameter=name).values for of in OF_PARAMETER)
        reach = np.nan_to_num(np.abs([low - value, high - value]), posinf=0.0)
        looks = (explained, fig.SERIES[0], "explained"), (~explained, fig.VERMILION, "not explained")
        for kept, colour, label in looks:
            look: dict[str, Any] = {"fmt": "o", "markersize": 3, "color": colour, "label": label}
            axes.errorbar(places[kept], value[kept], reach[:, kept], **look)
        axes.set_ylabel(name, color=fig.INK, fontsize="small")
        fig.format_axes(axes)
        axes.locator_params(axis="x", integer=True)
    panels[-1][0].set_xlabel("number of the curve")
    panels[0][0].legend(**LEGEND)
    return figure
