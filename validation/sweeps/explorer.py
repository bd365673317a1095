"""A page with a slider for each of up to three keys of a scene: curves and pull-off move with them.

All runs of the grid are in the page, a curve as ``POINTS`` places along its arclength in 16 bits of its own
range; the browser only shows what is there. No server and no network: Bokeh is in the page.
"""

from __future__ import annotations

import base64
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from html import escape
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np

from contact_scene import Scene, SceneError, Units
from contact_scene.errors import shown
from contact_scene.scene import value_at
from contact_scene.value_checks import low_and_high
from validation.drawing.curves import labels, of_trace
from validation.drawing.figure import BLUE, GREY, VERMILION
from validation.measure.scaling import unit_name
from validation.runs.folder import write_whole
from validation.runs.pool import Engine
from validation.runs.run import Run
from validation.solvers import REFERENCE
from validation.sweeps.batch_runs import BATCH, drawn_by
from validation.sweeps.plan import SceneTable, SweepPlan, plan_from_dict
from validation.sweeps.run_plan import carry_out, store_of

MOST_KEYS = 3
VALUES = {1: 31, 2: 11, 3: 7}
"""Values of a key, by the number of keys: some hundred runs."""
SPAN = 10.0
"""Factor by which a positive number is varied either way, unless bounds are stated."""
COARSE = 4
"""Resolution of solvers other than the batch solver: enough for curves to look at."""
POINTS = 80
COLUMNS = ("time", "penetration", "force", "contact_radius")
DEPTH = 65_534
"""Steps of a range; one more number says that there is nothing."""

SIZE: dict[str, Any] = {
    "width": 350,
    "height": 300,
    "tools": "pan,box_zoom,reset,save",
    "toolbar_location": "below",
}
"""Of a panel: settings of Bokeh."""


@dataclass(frozen=True)
class Slider:
    """A key of the scene, what it varies over, and the value that the scene has."""

    path: str
    values: tuple[float, ...]
    given: float
    unit: str
    logarithmic: bool

    @property
    def nearest(self) -> int:
        """The value that is nearest to the scene's."""
        values, given = np.array(self.values), self.given
        apart = np.log(values / given) if self.logarithmic and given > 0.0 else values - given
        return int(np.abs(apart).argmin())

    @property
    def edges(self) -> list[float]:
        """Ends of the cells of a map, one more than values."""
        values = np.log(self.values) if self.logarithmic else np.array(self.values)
        middle = 0.5 * (values[1:] + values[:-1])
        ends = np.concatenate(
            ([1.5 * values[0] - 0.5 * values[1]], middle, [1.5 * values[-1] - 0.5 * values[-2]])
        )
        return [float(one) for one in (np.exp(ends) if self.logarithmic else ends)]


@dataclass(frozen=True)
class Exploration:
    """A scene as given, sliders, and the runs of the grid in the order of their product."""

    scene: Scene
    sliders: tuple[Slider, ...]
    plan: SweepPlan
    own: Run
    runs: tuple[Run, ...]

    def page(self) -> str:
        """The page as HTML."""
        from bokeh.embed import file_html
        from bokeh.resources import INLINE

        return str(file_html(_document(self), INLINE))

    @property
    def unfinished(self) -> int:
        """Runs of the grid that did not come to their end."""
        return sum(not run.finished for run in self.runs)

    def save(self, path: str | Path) -> None:
        """Write the page."""
        write_whole(Path(path), self.page())

    def _repr_html_(self) -> str:
        return f'<iframe srcdoc="{escape(self.page())}" style="border:0" width="100%" height="900"></iframe>'


def check_drawable() -> None:
    """Refuse a page before anything runs, if it could not be made."""
    if find_spec("bokeh") is None:
        raise SceneError("explore", "bokeh is not installed", "pip install 'crosscontact[explore]'")


def sliders_of(table: SceneTable, vary: Sequence[str], count: int | None) -> tuple[Slider, ...]:
    """The sliders of ``PATH`` or ``PATH=LOW:HIGH``, a positive number in equal ratios."""
    if not 1 <= len(vary) <= MOST_KEYS:
        raise SceneError("vary", f"got {len(vary)} keys", f"one to {MOST_KEYS} dotted paths of the scene")
    return tuple(_slider(table, entry, count or VALUES[len(vary)]) for entry in vary)


def _slider(table: SceneTable, entry: str, count: int) -> Slider:
    path, _, bounds = str(entry).partition("=")
    given = value_at(table.with_values({}), path)
    if bounds:
        low, high = low_and_high(bounds, path)
    elif given > 0.0:
        low, high = given / SPAN, given * SPAN
    else:
        raise SceneError("vary", f"{path} is {given:g}", f"bounds for it, {path}=LOW:HIGH")
    if not low < high:
        raise SceneError("vary", f"got bounds {shown(bounds)}", "LOW < HIGH")
    space = np.geomspace if low > 0.0 else np.linspace
    values = tuple(space(low, high, count).tolist())
    units, dimension = table.with_values({}).units, table.unit(path)
    unit = units.named(dimension) if units is not None else ""
    return Slider(path, values, given, unit, low > 0.0)


def explored(
    table: SceneTable,
    sliders: tuple[Slider, ...],
    solver: str | None,
    resolution: int | None,
    engine: Engine | None = None,
    progress: Callable[[float, str], None] | None = None,
) -> Exploration:
    """Solve the scene and the grid; what does not come to its end is shown as that.

    Where neither solver nor resolution are stated, the batch solver does if its rows show all of the curves.
    """
    by = solver or REFERENCE
    asked = {"solver": by, "resolution": resolution or (None if by == BATCH else COARSE), "estimate": False}
    asked |= {"traces": "hdf5"}  # so that runs keep their rows; no file of them is written
    grid = [{"key": one.path, "values": one.values} for one in sliders]
    own = [{"key": one.path, "values": [one.given]} for one in sliders]
    given, plan = (plan_from_dict(asked | {"coordinates": some}, Path(), table) for some in (own, grid))
    scenes = (each.scene_of(rows) for each in (given, plan) for rows in each.rows())
    if solver is None and resolution is None and all(map(drawn_by, scenes)):
        given, plan = (replace(each, solver=BATCH, resolution=None) for each in (given, plan))
    else:
        for each in (given, plan):
            each.check()
    with store_of() as store:
        (first,) = carry_out(given, store)
        runs = tuple(carry_out(plan, store, engine, progress))
    return Exploration(table.with_values({}), sliders, plan, first, runs)


def _columns(run: Run, scene: Scene) -> dict[str, np.ndarray]:
    """The columns of a run, thinned along its arclength."""
    if run.trace is None or len(run.trace) < 2:
        return dict.fromkeys(COLUMNS, np.empty(0))
    columns = of_trace(run.trace, scene).columns
    path = np.array([columns[name] for name in COLUMNS])
    size = np.ptp(path, axis=1)
    steps = np.linalg.norm(np.diff(path) / np.where(size > 0.0, size, 1.0)[:, None], axis=0)
    way = np.concatenate(([0.0], steps.cumsum()))
    at = np.linspace(0.0, way[-1], POINTS)
    return {name: np.interp(at, way, columns[name]) for name in COLUMNS}


def _packed(curves: Sequence[dict[str, np.ndarray]]) -> dict[str, str]:
    """Curves for the browser: lowest value and range of each column in 32 bits, points in 16."""
    limits = np.zeros((len(curves), len(COLUMNS), 2), np.float32)
    points = np.full((len(curves), len(COLUMNS), POINTS), DEPTH + 1, np.uint16)
    for i, curve in enumerate(curves):
        for j, name in enumerate(COLUMNS):
            column = curve[name]
            if column.size:
                low, size = float(column.min()), float(np.ptp(column))
                limits[i, j] = low, size
                points[i, j] = np.round((column - low) / (size or 1.0) * DEPTH)
    return {
        name: base64.b64encode(array.astype(array.dtype.newbyteorder("<")).tobytes()).decode()
        for name, array in (("limits", limits), ("points", points))
    }


SHOW = """
const counts = values.map(one => one.length);
const index = sliders.reduce((before, slider, i) => before * counts[i] + slider.value, 0);
const decoded = (text, kind) => new kind(Uint8Array.from(atob(text), c => c.charCodeAt(0)).buffer);
window.explored ??= {limits: decoded(limits, Float32Array), points: decoded(points, Uint16Array)};
const {limits: range, points: place} = window.explored;
const data = {};
columns.forEach((name, j) => {
  const low = range[(index * columns.length + j) * 2], size = range[(index * columns.length + j) * 2 + 1];
  const first = (index * columns.length + j) * many;
  const at = Array.from(place.subarray(first, first + many));
  data[name] = place[first] > depth ? [] : at.map(one => low + size * one / depth);
});
curve.data = data;
const found = pulled[index];
const up = counts.length > 1 ? values[1][sliders[1].value] : found;
present.data = {x: [values[0][sliders[0].value]], y: [up]};
const slice = counts.length < 3 ? 0 : sliders[2].value, deep = counts.length < 3 ? 1 : counts[2];
if (counts.length > 1) {
  const rows = [];
  for (let row = 0; row < counts[1]; row++)
    for (let column = 0; column < counts[0]; column++)
      rows.push(pulled[(column * counts[1] + row) * deep + slice] ?? NaN);
  cells.data = {...cells.data, force: rows};
}
const digits = one => one >= 1e-3 && one < 1e5 ? one.toPrecision(4) : one.toExponential(3);
const force = found === null ? "none" : digits(found) + " " + unit;
said.text = "pull-off force " + force + "; " + endings[index];
"""
"""Shows the run at the sliders."""


def _document(found: Exploration) -> Any:
    from bokeh.document import Document
    from bokeh.layouts import column, row
    from bokeh.models import ColumnDataSource, CustomJS, CustomJSTickFormatter, Div
    from bokeh.models import Slider as Handle

    scene = found.scene if found.scene.units is not None else replace(found.scene, units=Units())
    curve = ColumnDataSource({name: [] for name in COLUMNS}, name="shown")
    present = ColumnDataSource({"x": [], "y": []})
    own, curves = ColumnDataSource(_columns(found.own, scene)), [_columns(run, scene) for run in found.runs]
    pulled = [run.measures.get("pull_off_force") for run in found.runs]
    picture, cells = _map(found.sliders, pulled, unit_name(scene, "force"), present)
    handles = [
        Handle(
            title=one.path,
            start=0,
            end=len(one.values) - 1,
            step=1,
            value=one.nearest,
            width=320,
            format=CustomJSTickFormatter(
                args={"texts": [f"{value:.4g} {one.unit}".strip() for value in one.values]},
                code="return texts[tick]",
            ),
        )
        for one in found.sliders
    ]
    said = Div(text="")
    shown = {
        "sliders": handles,
        "values": [one.values for one in found.sliders],
        "columns": COLUMNS,
        "many": POINTS,
        "depth": DEPTH,
        "curve": curve,
        "present": present,
        "cells": cells,
        "pulled": pulled,
        "endings": [run.failure if run.trace is None else str(run.trace.outcome.kind) for run in found.runs],
        "said": said,
        "unit": unit_name(scene, "force"),
    }
    show = CustomJS(args=shown | _packed(curves), code=SHOW)
    for handle in handles:
        handle.js_on_change("value", show)
    pairs = ("penetration", "force"), ("force", "contact_radius"), ("time", "force")
    panels = [_panel(labels(scene), across, up, own, curve) for across, up in pairs]
    name = escape(found.scene.title or found.plan.scene.name)
    head = Div(text=f"<b>{name}</b>, by {found.plan.solver}; grey: the scene as given")
    document = Document(title=f"explore {name}")
    document.add_root(column(head, *handles, said, row(*panels, picture, styles={"flex-wrap": "wrap"})))
    document.js_on_event("document_ready", show)
    return document


def _panel(names: Any, across: str, up: str, own: Any, curve: Any) -> Any:
    from bokeh.plotting import figure

    panel = figure(x_axis_label=names[across], y_axis_label=names[up], **SIZE)
    panel.line(across, up, source=own, color=GREY, line_width=4)
    panel.line(across, up, source=curve, color=BLUE, line_width=1.6)
    return panel


def _map(
    sliders: Sequence[Slider], pulled: Sequence[float | None], unit: str, present: Any
) -> tuple[Any, Any]:
    """Pull-off force over the first key, or the first two, with the present point in it."""
    from bokeh.models import ColorBar, ColumnDataSource, LinearColorMapper, LogColorMapper
    from bokeh.plotting import figure

    kinds = ["log" if one.logarithmic else "linear" for one in sliders]
    first, label = sliders[0], f"pull-off force ({unit})"
    titles = [f"{one.path} ({one.unit})" if one.unit else one.path for one in sliders]
    up, kind = (label, "linear") if len(sliders) == 1 else (titles[1], kinds[1])
    axes = {"x_axis_type": kinds[0], "x_axis_label": titles[0], "y_axis_type": kind, "y_axis_label": up}
    picture = figure(**axes, **SIZE)
    if len(sliders) == 1:
        cells = ColumnDataSource(
            {"x": first.values, "force": [math.nan if one is None else one for one in pulled]}
        )
        picture.line("x", "force", source=cells, color=BLUE)
    else:
        second = sliders[1]
        edges = [one.edges for one in (first, second)]
        places = [(j, i) for j in range(len(second.values)) for i in range(len(first.values))]
        sides = {
            "left": [edges[0][i] for _, i in places],
            "right": [edges[0][i + 1] for _, i in places],
            "bottom": [edges[1][j] for j, _ in places],
            "top": [edges[1][j + 1] for j, _ in places],
        }
        cells = ColumnDataSource(sides | {"force": [math.nan] * len(places)})
        known = [one for one in pulled if one is not None] or [0.0]
        mapper = LogColorMapper if min(known) > 0.0 else LinearColorMapper
        colours = mapper(palette="Cividis256", low=min(known), high=max(known), nan_color="#ffffff")
        picture.quad(source=cells, fill_color={"field": "force", "transform": colours}, line_color=None)
        picture.add_layout(ColorBar(color_mapper=colours, title=label, width=12), "right")
    picture.scatter("x", "y", source=present, size=11, color=VERMILION, line_color="black")
    return picture, cells
