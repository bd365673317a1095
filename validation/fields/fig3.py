"""Fig. 3 of the paper from boundary and finite elements together: surface, pressure, annular peak, crack.

Axes as in the paper for a sphere, ``r~ = r/R``, ``u~ = u/R`` upwards, ``p~ = (1 - nu^2) p/(pi E0)``; other
indenters keep the units of the scene. Lines are the boundary elements, open marks the finite elements; in
the first six panels colour distinguishes the solvers, in the last three the penetrations.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from contact_scene import Scene, SurfaceProfile
from validation.drawing.figure import GRID, INK, MARKERS, SERIES, format_axes
from validation.measure.scaling import unit_sizes

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

Array = NDArray[np.float64]
Pair = tuple[SurfaceProfile, SurfaceProfile]
"""One moment by boundary and by finite elements."""
Curve = Callable[[SurfaceProfile], tuple[Array, Array]]

WIDE = 2.1
"""Largest radius drawn, over the largest contact radius."""
NEAREST = 0.995
"""Largest radius of a pressure curve, over the contact radius: at the edge the pressure is singular."""
CRACK = 2e-3, 0.6
"""Distances from the edge at which the gap is drawn, over the contact radius."""
MARKS = 16
"""Marks of the finite elements along a curve."""
TWO_SOLVERS = ("bem", "fem")
LABELS = {
    "radius": ("radius $r$ (scene units)", r"$r/R$"),
    "height": ("height $u$ (scene units)", r"$u/R$"),
    "pressure": ("pressure $p$ (scene units)", r"$(1-\nu^2)\,p/(\pi E_0)$"),
    "depth": (r"penetration $\Delta$ (scene units)", r"$\Delta/R$"),
    "gap": ("gap $g$ (scene units)", "gap $g/R$"),
    "distance": ("$r-a$ (scene units)", r"$(r-a)/R$"),
}
"""What axes say in units of the scene, and in the paper's for a sphere."""


def figure(scene: Scene, bem: Sequence[SurfaceProfile], fem: Sequence[SurfaceProfile], turn: float) -> Figure:
    """Nine panels: six moments, the pressure of either way, and the crack of the retraction.

    Moments are in order of time; those up to ``turn`` belong to the approach.
    """
    from matplotlib.figure import Figure as New

    pairs = list(zip(bem, fem, strict=True))
    if not np.allclose([b.time for b in bem], [f.time for f in fem], rtol=1e-9, atol=0.0):
        raise ValueError("the two solvers give the surface at different times")
    ways = [[p for p in pairs if p[0].time <= turn], [p for p in pairs if p[0].time > turn]]
    if not all(ways):
        raise ValueError("a surface is needed both on approach and on retraction")
    sizes = unit_sizes(scene)
    label = {name: words["length" in sizes] for name, words in LABELS.items()}
    length = sizes.get("length", 1.0)
    pressure = sizes.get("force", 1.0) / length**2
    widest = WIDE * max(profile.contact_radius for profile in bem)
    deepest = max(max(abs(p.penetration), float(np.abs(p.displacement).max())) for p in bem) / length
    peak = max(float(profile.pressure.max()) for profile in bem) / pressure

    def shape(profile: SurfaceProfile) -> tuple[Array, Array]:
        drawn = profile.radius <= widest
        return profile.radius[drawn] / length, -profile.displacement[drawn] / length

    def loaded(profile: SurfaceProfile) -> tuple[Array, Array]:
        inside = profile.radius <= NEAREST * profile.contact_radius
        return profile.radius[inside] / length, profile.pressure[inside] / pressure

    def loaded_by_edge(profile: SurfaceProfile) -> tuple[Array, Array]:
        r, p = loaded(profile)
        return r * length / profile.contact_radius, p

    def opening(profile: SurfaceProfile) -> tuple[Array, Array]:
        s, a = profile.radius - profile.contact_radius, profile.contact_radius
        drawn = (s >= CRACK[0] * a) & (s <= CRACK[1] * a) & (profile.gap > 0.0)
        return s[drawn] / length, profile.gap[drawn] / length

    def depth(pair: Pair) -> str:
        return f"{label['depth']} = {pair[0].penetration / length:.3g}"

    drawing = New(figsize=(9.4, 8.2), layout="constrained")
    halves: Any = drawing.subfigures(2, 1, height_ratios=(1.9, 1.0))
    above = halves[0].subplots(2, max(map(len, ways)), sharex=True, sharey=True, squeeze=False)
    below = halves[1].subplots(1, 3)
    letters = iter("abcdefghijklmnopqrstuvwxyz")
    for row, way, name in zip(above, ways, ("approach", "retraction"), strict=True):
        for axes, pair in zip(row, way, strict=False):
            _indenter(axes, scene, pair[0].penetration, widest, length)
            _lay_over(axes, pair, shape, SERIES, labelled=True)
            inset = axes.inset_axes((0.12, 0.64, 0.36, 0.26))
            _lay_over(inset, pair, loaded, SERIES, size=2.5)
            inset.axhline(0.0, color=INK, linewidth=0.5)
            inset.set_xlabel(label["radius"], fontsize=7, labelpad=0)
            inset.set_title(label["pressure"], fontsize=7, pad=2)
            inset.tick_params(labelsize=6.5)
            axes.set(xlim=(0.0, widest / length), ylim=(-1.15 * deepest, 2.7 * deepest))
            axes.set_title(f"({next(letters)}) {name}, {depth(pair)}", fontsize=9)
        for axes in row[len(way) :]:
            axes.set_axis_off()
        row[0].set_ylabel(label["height"])
    for axes in above[1]:
        axes.set_xlabel(label["radius"])
    above[0, 0].legend(loc="lower right", frameon=False, fontsize=8, labelcolor=INK)
    titles = ("approach: annular peak", "retraction: no peak", "retraction: trumpet crack")
    for axes, way, title in zip(below, (*ways, ways[1]), titles, strict=True):
        crack = axes is below[2]
        if crack:
            axes.set(xscale="log", yscale="log", xlabel=label["distance"], ylabel=label["gap"])
        else:  # the peak; the singular tension at the edge leaves below
            axes.set(xlabel=r"$r/a$", ylabel=label["pressure"], xlim=(0.0, 1.02))
            axes.set_ylim(-1.8 * peak, 1.15 * peak)
            axes.axhline(0.0, color=INK, linewidth=0.6)
        for pair, colour, mark in zip(way, SERIES, MARKERS, strict=False):
            _lay_over(axes, pair, opening if crack else loaded_by_edge, (colour, colour), mark)
            axes.plot([], [], color=colour, marker=mark, fillstyle="none", label=depth(pair))
        if crack:
            _powers(axes, *opening(way[-1][0]))
        axes.set_title(f"({next(letters)}) {title}", fontsize=9)
        place = "upper left" if crack else "lower left"
        axes.legend(loc=place, frameon=False, fontsize=8, labelcolor=INK)
    for axes in (*above.flat, *below):
        format_axes(axes, (-2, 4), 0.4)
        for axis in (axis for inset in axes.child_axes for axis in (inset.xaxis, inset.yaxis)):
            axis.get_offset_text().set_fontsize(7)
    return drawing


def _indenter(axes: Axes, scene: Scene, penetration: float, widest: float, length: float) -> None:
    r = np.linspace(0.0, widest, 200)
    height = (scene.indenter.height(r) - penetration) / length
    axes.plot(r / length, height, color=INK, linewidth=1.0, label="indenter")
    axes.fill_between(r / length, height, 1e3, color=GRID, alpha=0.35, linewidth=0.0)


def _lay_over(
    axes: Axes,
    pair: Pair,
    curve: Curve,
    colours: Sequence[str],
    mark: str = "o",
    size: float = 4.0,
    labelled: bool = False,
) -> None:
    """One curve by either solver: a line for boundary elements, open marks for finite elements."""
    names = TWO_SOLVERS if labelled else ("_", "_")
    axes.plot(*curve(pair[0]), label=names[0], color=colours[0], linewidth=1.4)
    x, y = _evenly(*curve(pair[1]), log=axes.get_xscale() == "log")
    style: dict[str, Any] = {"marker": mark, "markersize": size, "fillstyle": "none", "linestyle": "none"}
    axes.plot(x, y, label=names[1], color=colours[1], **style)


def _powers(axes: Axes, x: Array, y: Array) -> None:
    """Lines of the powers 1/2, next to a singular edge, and 3/2, across a process zone."""
    for at, reach, power, line in ((0, x[-1] / x[0], 0.5, ":"), (x.size // 2, 4.0, 1.5, "--")):
        span = np.array([x[at], reach * x[at]])
        rising = 1.15 * y[at] * (span / x[at]) ** power
        axes.plot(span, rising, line, color=INK, linewidth=1.0, label=f"power {2 * power:.0f}/2")


def _evenly(x: Array, y: Array, log: bool) -> tuple[Array, Array]:
    """Points of a curve at even distances along it as it is seen, axes scaled to their range."""
    if x.size <= MARKS:
        return x, y
    across, up = (np.log(x), np.log(y)) if log else (x, y)
    along = np.hypot(np.diff(across) / (np.ptp(across) or 1.0), np.diff(up) / (np.ptp(up) or 1.0))
    length = np.concatenate(([0.0], np.cumsum(along)))
    rows = np.unique(np.searchsorted(length, np.linspace(0.0, length[-1], MARKS)))
    return x[rows], y[rows]
