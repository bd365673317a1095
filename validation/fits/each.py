"""Many curves, each fitted alone: those of files and force maps; each starts from its neighbour's answer.

The neighbour is the curve before it in the order of the record whose data were explained; the contact point
starts from what each record shows of itself.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass, replace
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from contact_scene import Scene, SceneError
from validation.drawing.axes import format_axes
from validation.drawing.styles import INK, SERIES, VERMILION
from validation.fits.fit import fit_curves, named_apart
from validation.fits.page import with_error
from validation.fits.parameters import FitSettings
from validation.fits.record import MeasuredCurve
from validation.fits.result import FitResult
from validation.report import report
from validation.report.document import (
    ABSENT,
    DataTable,
    Document,
    Figure,
    Figures,
    Paragraph,
    Record,
    Section,
    VerdictCell,
    with_drawing,
)
from validation.runs.store import Store

if TYPE_CHECKING:
    from matplotlib.figure import Figure as Drawing
OF_PARAMETER = ("value", "deviation", "low", "high")


@dataclass(frozen=True)
class EachFit:
    """One curve of many with what its fit found, or why there is none."""

    curve: str
    result: FitResult | None
    failure: str = ""

    @property
    def explained(self) -> bool:
        """Whether there is a model that explains the data."""
        return self.result is not None and self.result.converged and self.result.goodness.explained

    def numbers(self) -> dict[str, dict[str, float]]:
        """Value, deviation and interval of each parameter, by its name without that of the curve."""
        estimates = () if self.result is None else self.result.estimates
        return {
            one.name.partition("@")[0]: {name: getattr(one, name) for name in OF_PARAMETER}
            for one in estimates
        }


def fit_each(
    curves: Sequence[MeasuredCurve],
    scene: Scene,
    settings: FitSettings,
    executor: Executor | None = None,
    store: Store | None = None,
    progress: Callable[[str], None] | None = None,
    on_result: Callable[[list[EachFit]], None] | None = None,
) -> list[EachFit]:
    """Fit every curve, whatever becomes of the others; ``on_result`` gets all that is there after each."""
    alone = replace(settings, vary=(*settings.vary, *settings.per_curve), per_curve=())
    guess, store = scene, store or Store()
    found: list[EachFit] = []
    refusals = []
    for curve in named_apart(curves):

        def tell(text: str, where: str = f"{len(found) + 1} of {len(curves)}, {curve.name}") -> None:
            if progress is not None:
                progress(f"{where}: {text}")

        try:
            one = EachFit(curve.name, fit_curves([curve], guess, alone, executor, store, tell))
        except SceneError as error:
            refusals.append(error)
            one = EachFit(curve.name, None, str(error))
        found.append(one)
        if one.explained and one.result is not None:
            guess = one.result.scene
        if on_result is not None and len(found) > len(refusals):
            on_result(found)
    if len(refusals) == len(found):
        raise refusals[0]
    return found


def dataset(found: Sequence[EachFit]) -> Any:
    """All numbers as an ``xarray.Dataset`` over ``curve`` and ``parameter``; NaN where a fit has none."""
    try:
        xarray = import_module("xarray")
    except ImportError:
        raise SceneError("", "xarray is not installed", "pip install 'crosscontact[fit]'") from None
    numbers = [one.numbers() for one in found]
    parameters = list(dict.fromkeys(name for one in numbers for name in one))
    variables: dict[str, Any] = {}
    for of in OF_PARAMETER:
        values = [[one.get(name, {}).get(of, np.nan) for name in parameters] for one in numbers]
        variables[of] = ("curve", "parameter"), np.array(values)
    good = [None if one.result is None else one.result.goodness for one in found]
    variables["explained"] = "curve", np.array([one.explained for one in found])
    variables["misfit_over_noise"] = "curve", [np.nan if one is None else one.misfit for one in good]
    variables["rms_over_range"] = "curve", [np.nan if one is None else one.share for one in good]
    variables["failure"] = "curve", np.array([one.failure for one in found], str)
    return xarray.Dataset(variables, {"curve": [one.curve for one in found], "parameter": parameters})


def write_each(found: Sequence[EachFit], folder: Path) -> None:
    """Write ``table.csv``, ``map.nc`` and the page with the table and a figure."""
    data = dataset(found)
    names = data.parameter.values.tolist()
    columns = [data[of].sel(parameter=name, drop=True) for name in names for of in OF_PARAMETER]
    titles = [name if of == "value" else f"{name} {of}" for name in names for of in OF_PARAMETER]
    whole = data.drop_vars(OF_PARAMETER).drop_dims("parameter").to_dataframe()
    for place, (title, column) in enumerate(zip(titles, columns, strict=True)):
        whole.insert(place, title, column)
    files: dict[str, str | bytes] = {
        "table.csv": whole.to_csv(na_rep="nan", lineterminator="\n"),
        "map.nc": bytes(data.to_netcdf(engine="scipy")),
    }
    report.write(folder, _document(found, names), files)


def each_table(found: Sequence[EachFit]) -> DataTable:
    """A row for each curve."""
    names = list(dict.fromkeys(name for one in found for name in one.numbers()))
    rows: list[Record] = []
    for one in found:
        estimates = () if one.result is None else one.result.estimates
        shown = {each.name.partition("@")[0]: with_error(each) for each in estimates}
        share = ABSENT if one.result is None else f"{one.result.goodness.share:.2%}"
        verdict = VerdictCell(one.failure or ("yes" if one.explained else "no"), one.explained)
        numbers = {name: shown.get(name, ABSENT) for name in names}
        rows.append({"curve": one.curve, **numbers, "rms / range": share, "explained": verdict})
    return DataTable.of(rows, unbroken=("curve", *names))


def _document(found: Sequence[EachFit], names: Sequence[str]) -> Document:
    explained = sum(one.explained for one in found)
    lead = Paragraph(f"{explained} of {len(found)} curves are explained.", explained == len(found))
    caption = "Every parameter over the curves, with its 95 % interval."
    figure = with_drawing(Figure("fit-each", caption, wide=True), _draw(found, names))
    section = Section("Curves", (Figures((figure,)), each_table(found)))
    return Document("Fit of each curve", (lead,), (section,))


def _draw(found: Sequence[EachFit], names: Sequence[str]) -> Drawing:
    """A panel for each parameter: values with their intervals over the number of the curve."""
    from matplotlib.figure import Figure as Drawing

    figure = Drawing(figsize=(7.2, 1.6 * len(names) + 0.6), layout="constrained")
    panels = figure.subplots(len(names), 1, squeeze=False, sharex=True)[:, 0]
    for axes, name in zip(panels, names, strict=True):
        for explained, colour in ((True, SERIES[0]), (False, VERMILION)):
            rows = [
                (number, *(one.numbers()[name][end] for end in ("value", "low", "high")))
                for number, one in enumerate(found, 1)
                if one.explained is explained and name in one.numbers()
            ]
            place, value, low, high = np.array(rows).reshape(-1, 4).T
            reach = np.nan_to_num(np.abs([low - value, high - value]), posinf=0.0)
            label = "explained" if explained else "not explained"
            axes.errorbar(place, value, reach, fmt="o", markersize=3, color=colour, label=label)
        axes.set_ylabel(name, color=INK, fontsize="small")
        format_axes(axes)
    panels[-1].set_xlabel("number of the curve")
    panels[0].legend(frameon=False, fontsize="small", labelcolor=INK)
    return figure
