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
from validation.execution.files import write_whole
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
        return _of_points(data, name)
    dimensions = [str(dim) for dim in measure.dims]
    numeric = [dim for dim in dimensions if np.issubdtype(data[dim].dtype, np.number) and data[dim].size > 1]
    words = [dim for dim in dimensions if dim not in numeric]
    numeric.sort(key=lambda dim: -data[dim].size)
    varied = [dim for dim in words if data[dim].size > 1]
    across = numeric[:2] or varied[:1] or dimensions[:1]
    outer = [dim for dim in (*numeric[2:], *varied) if dim not in across]
    measure = measure.squeeze([dim for dim in dimensions if dim not in across and dim not in outer])
    if len(across) == 1 and outer and math.prod(data[dim].size for dim in outer) <= MOST_CURVES:
        return _curves(data, name, measure, across[0], outer)
    panels = _panels(data, outer)
    figure, axes = _grid(len(panels), data)
    limits = (float(measure.min()), float(measure.max()))
    for one, chosen in zip(axes, panels, strict=True):
        part = measure.isel(chosen)
        if len(across) == 2:
            picture = _map(one, data, part, across[0], across[1], limits)
        else:
            _curve(one, data, name, part, across[0], 0, "")
        one.set_title(_title(data, chosen), fontsize="small")
    if len(across) == 2:
        bar = figure.colorbar(picture, ax=axes, shrink=0.9 if len(panels) == 1 else 0.6)
        bar.set_label(_label(data, name))
    return figure


def _curves(
    data: xarray.Dataset, name: str, measure: xarray.DataArray, across: str, outer: list[str]
) -> Figure:
    figure, axes = _grid(1, data)
    for index, chosen in enumerate(_panels(data, outer)):
        _curve(axes[0], data, name, measure.isel(chosen), across, index, _title(data, chosen))
    axes[0].legend(frameon=False, fontsize="small")
    return figure


def _curve(
    axes: Axes, data: xarray.Dataset, name: str, part: xarray.DataArray, across: str, index: int, label: str
) -> None:
    x, y = data[across].values, part.values
    numeric = np.issubdtype(x.dtype, np.number)
    style: dict[str, Any] = {"color": SERIES[index % len(SERIES)], "marker": MARKERS[index % len(MARKERS)]}
    if numeric:
        style |= {"linestyle": DASHES[index % len(DASHES)], "linewidth": 1.3, "markersize": 3}
    else:  # between two words there is nothing that a line could show
        x = np.array([str(value) for value in x])
        style |= {"linestyle": "none", "markersize": 5}
    axes.plot(x, y, label=label, **style)
    known = np.isfinite(y)
    if numeric and not known.all() and known.any():
        axes.plot(x[~known], np.full((~known).sum(), 0.03), "x", color=INK, markersize=4,
                  transform=axes.get_xaxis_transform())  # fmt: skip
    _scales(axes, data, across, None)
    axes.set(xlabel=_label(data, across), ylabel=_label(data, name))
    format_axes(axes)


def _map(
    axes: Axes, data: xarray.Dataset, part: xarray.DataArray, across: str, up: str,
    limits: tuple[float, float],
) -> Any:  # fmt: skip
    x, y, z = data[across].values, data[up].values, part.transpose(up, across).values
    picture = axes.pcolormesh(
        x, y, np.ma.masked_invalid(z), cmap=COLOURS, vmin=limits[0], vmax=limits[1], shading="nearest",
        rasterized=True,
    )  # fmt: skip
    axes.set_facecolor(NO_VALUE)
    _scales(axes, data, across, up)  # before the labels of contours, whose gaps are measured on the page
    axes.autoscale_view()
    known = np.isfinite(z)
    if known.any() and min(z.shape) > 2 and z[known].max() > z[known].min():
        from matplotlib.patheffects import withStroke

        outline: list[Any] = [withStroke(linewidth=2.0, foreground="#0a0a0a99")]
        lines = axes.contour(x, y, np.ma.masked_invalid(z), LEVELS, colors="white", linewidths=0.8)
        lines.set(path_effects=outline)
        for label in axes.clabel(lines, fontsize=7, fmt="%.3g"):
            label.set_path_effects(outline)
    if not known.all():
        box = {"fc": "white", "ec": "none", "alpha": 0.8, "pad": 1.5}
        note: dict[str, Any] = {"fontsize": 7, "color": INK, "ha": "right", "va": "bottom", "bbox": box}
        axes.text(0.98, 0.02, "grey: no value", transform=axes.transAxes, **note)
    axes.set(xlabel=_label(data, across), ylabel=_label(data, up))
    axes.tick_params(which="both", colors=INK, labelcolor=INK)
    return picture


def _of_points(data: xarray.Dataset, name: str) -> Figure:
    """A list of points or a sample: the measure over each coordinate."""
    coordinates = [str(entry) for entry in data.coords if entry != RUN]
    figure, axes = _grid(len(coordinates), data)
    size = float(np.clip(200.0 / math.sqrt(data.sizes[RUN]), 2.0, 25.0))
    for one, coordinate in zip(axes, coordinates, strict=True):
        one.scatter(
            data[coordinate].values, data[name].values, s=size, color=SERIES[0], linewidths=0, alpha=0.6
        )
        _scales(one, data, coordinate, None)
        one.set(xlabel=_label(data, coordinate), ylabel=_label(data, name))
        format_axes(one)
    return figure


def _panels(data: xarray.Dataset, outer: list[str]) -> list[dict[str, int]]:
    """Indices of the outer coordinates for each panel."""
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
    title = str(data.attrs.get("title", ""))
    if title:
        figure.suptitle(title, fontsize="small", color=INK, wrap=True)
    return figure, axes[:count]


def _scales(axes: Axes, data: xarray.Dataset, across: str, up: str | None) -> None:
    for axis, dim in (("x", across), ("y", up)):
        if dim is not None and data[dim].attrs.get("scale") == "log":
            axes.set(**{f"{axis}scale": "log"})


def _title(data: xarray.Dataset, chosen: dict[str, int]) -> str:
    def shown(value: Any) -> str:
        return (
            format(float(value), ".3g") if np.issubdtype(np.asarray(value).dtype, np.number) else str(value)
        )

    return ", ".join(f"{dim} = {shown(data[dim].values[index])}" for dim, index in chosen.items())


def _label(data: xarray.Dataset, name: str) -> str:
    """Name and unit, exponents raised."""
    attributes = data[name].attrs
    unit = str(attributes.get("units", "")).replace("-1", "⁻¹").replace("-2", "⁻²")
    long_name = str(attributes.get("long_name", name))
    return f"{long_name} ({unit})" if unit not in ("", "1") else long_name
