"""Figures of a sweep from its data set: curves, maps with contours, small multiples; a sample as points."""

from __future__ import annotations

import itertools
import math
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from validation.drawing.axes import format_axes
from validation.drawing.export import png, svg_file
from validation.drawing.styles import DASHES, INK, MARKERS, SERIES
from validation.runs.folder import write_whole
from validation.sweeps.dataset import RUN, drawn_measures

if TYPE_CHECKING:
    import xarray
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

PANEL = (4.2, 3.2)
"""Inches of a panel."""
MOST_PANELS = 12
"""Small multiples of one figure; of more values of a coordinate, so many are drawn, evenly chosen."""
MOST_CURVES = 6
"""Values of a coordinate that are told apart as curves in one panel."""
LEVELS = 8
"""Contours of a map, about."""
NO_VALUE = "#c8c8c8"
"""Of runs without the measure; grey is no colour of the map."""
COLOURS = "cividis"
"""Lightness rises evenly, for any kind of colour vision and in print."""


def draw(data: xarray.Dataset, out: Path) -> list[str]:
    """Draw the figures of a data set as PNG and SVG; their names."""
    drawn = figures(data)
    for name, figure in drawn.items():
        write_whole(out / f"{name}.png", png(figure))
        write_whole(out / f"{name}.svg", svg_file(figure))
    return list(drawn)


def figures(data: xarray.Dataset) -> dict[str, Figure]:
    """One figure for each measure that is drawn, by its name; measures that no run has are left out."""
    for dim in data.dims:
        if dim in data.coords:
            data = data.sortby(str(dim)).drop_duplicates(dim)
    held = [name for name in drawn_measures(data) if bool(np.isfinite(data[name]).any())]
    return {name: _figure(data, name) for name in held}


def _figure(data: xarray.Dataset, name: str) -> Figure:
    measure = data[name]
    if measure.dims == (RUN,):
        return _points(data, name)
    dimensions = [str(dim) for dim in measure.dims]
    varied = sorted((dim for dim in dimensions if data[dim].size > 1), key=lambda dim: -data[dim].size)
    numeric = [dim for dim in varied if _is_numeric(data[dim].values)]
    words = [dim for dim in dimensions if dim in varied and dim not in numeric]
    across = numeric[:2] or words[:1] or dimensions[:1]
    outer = [dim for dim in (*numeric[2:], *words) if dim not in across]
    measure = measure.squeeze([dim for dim in dimensions if dim not in across and dim not in outer])
    chosen = _chosen(data, outer)
    in_one = len(across) == 1 and math.prod(data[dim].size for dim in outer) <= MOST_CURVES
    panels = [chosen] if in_one else [[at] for at in chosen]
    figure, axes = _grid(len(panels), data)
    limits: dict[str, Any] = {"vmin": float(measure.min()), "vmax": float(measure.max())}
    for one, parts in zip(axes, panels, strict=True):
        for index, at in enumerate(parts):
            if len(across) == 2:
                picture = _map(one, data, measure.isel(at), across[0], across[1], limits)
            else:
                label = _title(data, at) if in_one else ""
                _curve(one, data, name, measure.isel(at), across[0], index, label)
        if not in_one:
            one.set_title(_title(data, parts[0]), fontsize="small")
        elif outer:
            one.legend(frameon=False, fontsize="small")
    if len(across) == 2:
        bar = figure.colorbar(picture, ax=axes, shrink=0.9 if len(panels) == 1 else 0.6)
        bar.set_label(_label(data, name))
    return figure


def _is_numeric(values: Any) -> bool:
    return bool(np.issubdtype(np.asarray(values).dtype, np.number))


def _curve(
    axes: Axes, data: xarray.Dataset, name: str, part: xarray.DataArray, across: str, index: int, label: str
) -> None:
    x, y = data[across].values, part.values
    style: dict[str, Any] = {"color": SERIES[index % len(SERIES)], "marker": MARKERS[index % len(MARKERS)]}
    numeric = _is_numeric(x)
    if numeric:
        style |= {"linestyle": DASHES[index % len(DASHES)], "linewidth": 1.3, "markersize": 3}
    else:  # between two words there is nothing that a line could show
        x = np.array([str(value) for value in x])
        style |= {"linestyle": "none", "markersize": 5}
    axes.plot(x, y, label=label, **style)
    known = np.isfinite(y)
    if numeric and not known.all() and known.any():
        foot = axes.get_xaxis_transform()
        axes.plot(x[~known], np.full((~known).sum(), 0.03), "x", color=INK, markersize=4, transform=foot)
    _label_axes(axes, data, across, name)
    format_axes(axes)


def _map(
    axes: Axes,
    data: xarray.Dataset,
    part: xarray.DataArray,
    across: str,
    up: str,
    limits: dict[str, Any],
) -> Any:
    x, y, z = data[across].values, data[up].values, np.ma.masked_invalid(part.transpose(up, across).values)
    picture = axes.pcolormesh(x, y, z, cmap=COLOURS, **limits, shading="nearest", rasterized=True)
    axes.set_facecolor(NO_VALUE)
    _label_axes(axes, data, across, up)  # before the labels of contours, whose gaps are measured on the page
    axes.autoscale_view()
    if z.count() and min(z.shape) > 2 and z.max() > z.min():
        from matplotlib.patheffects import withStroke

        outline: list[Any] = [withStroke(linewidth=2.0, foreground="#0a0a0a99")]
        lines = axes.contour(x, y, z, LEVELS, colors="white", linewidths=0.8)
        lines.set(path_effects=outline)
        for label in axes.clabel(lines, fontsize=7, fmt="%.3g"):
            label.set_path_effects(outline)
    if z.count() < z.size:
        box = {"fc": "white", "ec": "none", "alpha": 0.8, "pad": 1.5}
        note: dict[str, Any] = {"fontsize": 7, "color": INK, "ha": "right", "va": "bottom", "bbox": box}
        axes.text(0.98, 0.02, "grey: no value", transform=axes.transAxes, **note)
    axes.tick_params(which="both", colors=INK, labelcolor=INK)
    return picture


def _points(data: xarray.Dataset, name: str) -> Figure:
    """A list of points or a sample: the measure over each coordinate."""
    coordinates = [str(entry) for entry in data.coords if entry != RUN]
    figure, axes = _grid(len(coordinates), data)
    size = float(np.clip(200.0 / math.sqrt(data.sizes[RUN]), 2.0, 25.0))
    style: dict[str, Any] = {"s": size, "color": SERIES[0], "linewidths": 0, "alpha": 0.6}
    for one, coordinate in zip(axes, coordinates, strict=True):
        one.scatter(data[coordinate].values, data[name].values, **style)
        _label_axes(one, data, coordinate, name)
        format_axes(one)
    return figure


def _chosen(data: xarray.Dataset, outer: list[str]) -> list[dict[str, int]]:
    """Indices of the outer coordinates for each panel or curve."""
    chosen = list(itertools.product(*(range(data[dim].size) for dim in outer)))
    if len(chosen) > MOST_PANELS:
        chosen = [chosen[int(at)] for at in np.linspace(0, len(chosen) - 1, MOST_PANELS).round()]
    return [dict(zip(outer, index, strict=True)) for index in chosen]


def _grid(count: int, data: xarray.Dataset) -> tuple[Figure, list[Axes]]:
    from matplotlib.figure import Figure

    columns = min(count, 3)
    rows = -(-count // columns)
    size = (PANEL[0] * columns + 0.9, PANEL[1] * rows + 0.3)
    figure = Figure(figsize=size, layout="constrained")
    axes = list(figure.subplots(rows, columns, squeeze=False).flat)
    for empty in axes[count:]:
        empty.remove()
    if data.attrs.get("title"):
        figure.suptitle(str(data.attrs["title"]), fontsize="small", color=INK, wrap=True)
    return figure, axes[:count]


def _label_axes(axes: Axes, data: xarray.Dataset, across: str, up: str) -> None:
    """Scales and labels of both axes by the attributes of what is drawn along them."""
    for axis, name in (("x", across), ("y", up)):
        axes.set(**{f"{axis}label": _label(data, name)})
        if data[name].attrs.get("scale") == "log":
            axes.set(**{f"{axis}scale": "log"})


def _title(data: xarray.Dataset, at: dict[str, int]) -> str:
    values = {dim: data[dim].values[index] for dim, index in at.items()}
    return ", ".join(f"{dim} = {v:.3g}" if _is_numeric(v) else f"{dim} = {v}" for dim, v in values.items())


def _label(data: xarray.Dataset, name: str) -> str:
    """Name and unit, exponents raised."""
    attributes = data[name].attrs
    unit = str(attributes.get("units", "")).replace("-1", "⁻¹").replace("-2", "⁻²")
    long_name = str(attributes.get("long_name", name))
    return f"{long_name} ({unit})" if unit not in ("", "1") else long_name
