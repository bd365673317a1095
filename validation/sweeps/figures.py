"""Figures of a sweep from its data set: curves, maps with contours, small multiples; a sample as points."""

from __future__ import annotations

import itertools
import math
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from validation.drawing.figure import DASHES, INK, MARKERS, SERIES, as_files, drawing, format_axes
from validation.runs.folder import write_whole
from validation.sweeps.dataset import RUN, drawn_measures

if TYPE_CHECKING:
    import xarray
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

PANEL = (4.2, 3.2)
"""Inches of a panel."""
MOST_PANELS, MOST_CURVES = 12, 6
"""Small multiples of one figure, of more evenly chosen ones; curves that are told apart in one panel."""
NO_VALUE = "#c8c8c8"
"""Of runs without the measure; grey is no colour of the map."""
COLOURS = "cividis"
"""Lightness rises evenly, for any kind of colour vision and in print."""


def draw(data: xarray.Dataset, out: Path) -> list[str]:
    """Draw the figures of a data set as PNG and SVG; their names."""
    drawn = figures(data)
    for name, figure in drawn.items():
        for file, content in as_files(figure, name).items():
            write_whole(out / file, content)
    return list(drawn)


def figures(data: xarray.Dataset) -> dict[str, Figure]:
    """One figure for each measure that is drawn, by its name; measures that no run has are left out."""
    for dim in data.dims:
        if dim in data.coords:
            data = data.sortby(str(dim)).drop_duplicates(dim)
    held = [name for name in drawn_measures(data) if bool(np.isfinite(data[name]).any())]
    drawn = {name: _figure(data[name]) for name in held}
    for figure in drawn.values() if data.attrs.get("title") else ():
        figure.suptitle(str(data.attrs["title"]), fontsize="small", color=INK, wrap=True)
    return drawn


def _figure(measure: xarray.DataArray) -> Figure:
    """Across the axes the longest coordinates that are numbers; a panel, or a curve, for each other value."""
    if measure.dims == (RUN,):
        coordinates = [str(name) for name in measure.coords if name != RUN]
        figure, axes = _panels(len(coordinates), measure)
        for one, name in zip(axes, coordinates, strict=True):
            size = float(np.clip(200.0 / math.sqrt(measure.size), 2.0, 25.0))
            one.scatter(measure[name], measure, s=size, color=SERIES[0], linewidths=0, alpha=0.6)
            _finish(one, measure[name], measure)
        return figure
    varied = sorted(
        (dim for dim in measure.dims if measure[dim].size > 1), key=lambda dim: -measure[dim].size
    )
    numbers = [dim for dim in varied if np.issubdtype(measure[dim].dtype, np.number)]
    across = numbers[:2] or varied[:1] or list(measure.dims[:1])
    outer = [
        dim for dim in (*numbers[2:], *(dim for dim in varied if dim not in numbers)) if dim not in across
    ]
    measure = measure.squeeze([dim for dim in measure.dims if dim not in across and dim not in outer])
    parts = [measure.isel(dict(zip(outer, at, strict=True))) for at in _indices(measure, outer)]
    as_curves = len(across) == 1 and math.prod(measure[dim].size for dim in outer) <= MOST_CURVES
    panels = [parts] if as_curves else [[part] for part in parts]
    figure, axes = _panels(len(panels), measure)
    limits = {"vmin": float(measure.min()), "vmax": float(measure.max())}
    for one, shown in zip(axes, panels, strict=True):
        if len(across) == 2:
            picture = _map(one, shown[0].transpose(across[1], across[0]), limits)
            _finish(one, measure[across[0]], measure[across[1]])
        for index, part in enumerate(shown if len(across) == 1 else ()):
            _curve(one, part, index, _values(part, outer))
            _finish(one, measure[across[0]], measure)
        if not as_curves:
            one.set_title(_values(shown[0], outer), fontsize="small")
        elif outer:
            one.legend(frameon=False, fontsize="small")
    if len(across) == 2:
        bar = figure.colorbar(picture, ax=axes, shrink=0.9 if len(panels) == 1 else 0.6)
        bar.set_label(_label(measure))
    return figure


def _indices(measure: xarray.DataArray, outer: list[Any]) -> list[tuple[int, ...]]:
    found = list(itertools.product(*(range(measure[dim].size) for dim in outer)))
    if len(found) <= MOST_PANELS:
        return found
    return [found[int(at)] for at in np.linspace(0, len(found) - 1, MOST_PANELS).round()]


def _values(part: xarray.DataArray, outer: list[Any]) -> str:
    """The values of the other coordinates of a panel or a curve."""
    values = {dim: part[dim].item() for dim in outer}
    return ", ".join(f"{dim} = {v if isinstance(v, str) else format(v, '.3g')}" for dim, v in values.items())


def _curve(axes: Axes, part: xarray.DataArray, index: int, label: str) -> None:
    x, y = part[part.dims[0]].values, part.values
    style: dict[str, Any] = {"color": SERIES[index % len(SERIES)], "marker": MARKERS[index % len(MARKERS)]}
    if not np.issubdtype(x.dtype, np.number):  # between two words there is nothing that a line could show
        axes.plot(x.astype(str), y, label=label, linestyle="none", markersize=5, **style)
        return
    axes.plot(x, y, label=label, linestyle=DASHES[index % len(DASHES)], linewidth=1.3, markersize=3, **style)
    if (unknown := x[~np.isfinite(y)]).size:
        foot = np.full(unknown.size, 0.03)
        axes.plot(unknown, foot, "x", color=INK, markersize=4, transform=axes.get_xaxis_transform())


def _map(axes: Axes, part: xarray.DataArray, limits: dict[str, Any]) -> Any:
    from matplotlib.patheffects import withStroke

    x, y, z = part[part.dims[1]], part[part.dims[0]], np.ma.masked_invalid(part.values)
    picture = axes.pcolormesh(x, y, z, cmap=COLOURS, **limits, shading="nearest", rasterized=True)
    axes.set_facecolor(NO_VALUE)
    _finish(axes, x, y)  # before the labels of contours, whose gaps are measured on the page
    axes.grid(False)
    axes.autoscale_view()
    if z.count() and min(z.shape) > 2 and z.max() > z.min():
        outline: list[Any] = [withStroke(linewidth=2.0, foreground="#0a0a0a99")]
        lines = axes.contour(x, y, z, 8, colors="white", linewidths=0.8)
        lines.set(path_effects=outline)
        for label in axes.clabel(lines, fontsize=7, fmt="%.3g"):
            label.set_path_effects(outline)
    if z.count() < z.size:
        box = {"fc": "white", "ec": "none", "alpha": 0.8, "pad": 1.5}
        note: dict[str, Any] = {"fontsize": 7, "color": INK, "ha": "right", "va": "bottom", "bbox": box}
        axes.text(0.98, 0.02, "grey: no value", transform=axes.transAxes, **note)
    return picture


def _panels(count: int, measure: xarray.DataArray) -> tuple[Figure, list[Axes]]:
    columns = min(count, 3)
    rows = math.ceil(count / columns)
    size = PANEL[0] * columns + 0.9, PANEL[1] * rows + 0.3
    figure, grid = drawing(size, rows, columns, squeeze=False)
    axes = list(grid.flat)
    for empty in axes[count:]:
        empty.remove()
    return figure, axes[:count]


def _finish(axes: Axes, across: xarray.DataArray, up: xarray.DataArray) -> None:
    """Scales and labels of both axes by the attributes of what is drawn along them."""
    axes.set(xlabel=_label(across), ylabel=_label(up))
    axes.set(
        **{
            f"{axis}scale": "log"
            for axis, one in (("x", across), ("y", up))
            if one.attrs.get("scale") == "log"
        }
    )
    format_axes(axes)


def _label(data: xarray.DataArray) -> str:
    """Name and unit, exponents raised."""
    unit = str(data.attrs.get("units", "")).replace("-1", "⁻¹").replace("-2", "⁻²")
    name = str(data.attrs.get("long_name", data.name))
    return f"{name} ({unit})" if unit not in ("", "1") else name
