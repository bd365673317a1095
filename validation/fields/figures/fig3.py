"""Fig. 3 of the paper from boundary and finite elements together: surface, pressure, annular peak, crack.

Axes as in the paper for a sphere, ``r~ = r/R``, ``u~ = u/R`` upwards, ``p~ = (1 - nu^2) p/(pi E0)``; other
indenters keep the units of the scene. Lines are the boundary elements, open marks the finite elements; in
the first six panels colour distinguishes the solvers, in the last three the penetrations.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from contact_scene import Scene, SurfaceProfile
from validation.drawing.axes import format_axes
from validation.drawing.styles import GRID, INK, MARKERS, SERIES
from validation.measure.dimensionless import unit_sizes

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

Array = NDArray[np.float64]

WIDE = 2.1
"""Largest radius drawn, over the largest contact radius."""
NEAREST = 0.995
"""Largest radius of a pressure curve, over the contact radius: at the edge the pressure is singular."""
MARKS = 16
"""Marks of the finite elements along a curve."""
TWO_SOLVERS = ("bem", "fem")


@dataclass(frozen=True)
class AxisScale:
    """Size of the length and the pressure that axes are divided by, and what the axes then say."""

    length: float
    pressure: float
    radius_label: str
    height_label: str
    pressure_label: str
    depth_label: str
    gap_label: str
    distance_label: str


def scale(scene: Scene) -> AxisScale:
    """The paper's dimensionless axes for a sphere; otherwise the units of the scene."""
    size = unit_sizes(scene)
    if "length" in size:
        length = size["length"]
        names = (r"$r/R$", r"$u/R$", r"$(1-\nu^2)\,p/(\pi E_0)$", r"$\Delta/R$", r"gap $g/R$", r"$(r-a)/R$")
        return AxisScale(length, size["force"] / length**2, *names)
    plain = ("radius $r$", "height $u$", "pressure $p$", r"penetration $\Delta$", "gap $g$", "$r-a$")
    return AxisScale(1.0, 1.0, *(f"{name} (scene units)" for name in plain))


def figure(scene: Scene, bem: Sequence[SurfaceProfile], fem: Sequence[SurfaceProfile], turn: float) -> Figure:
    """Nine panels: six moments, the pressure of either way, and the crack of the retraction.

    Parameters
    ----------
    scene : Scene
    bem, fem : sequence of SurfaceProfile
        The same moments by either solver, in order of time.
    turn : float
        Time of the reversal; moments up to it belong to the approach.

    Returns
    -------
    Figure

    Raises
    ------
    ValueError
        If the two do not hold the same moments, or not one of either way.
    """
    from matplotlib.figure import Figure as New

    pairs = list(zip(bem, fem, strict=True))
    if not np.allclose([b.time for b in bem], [f.time for f in fem], rtol=1e-9, atol=0.0):
        raise ValueError("the two solvers give the surface at different times")
    ways = [[p for p in pairs if p[0].time <= turn], [p for p in pairs if p[0].time > turn]]
    if not all(ways):
        raise ValueError("a surface is needed both on approach and on retraction")
    size = scale(scene)
    widest = WIDE * max(profile.contact_radius for profile in bem)
    deepest = max(max(abs(p.penetration), float(np.abs(p.displacement).max())) for p in bem) / size.length
    columns = max(len(way) for way in ways)
    panel_figure = New(figsize=(9.4, 8.2), layout="constrained")
    halves: Any = panel_figure.subfigures(2, 1, height_ratios=(1.9, 1.0))
    upper, lower = halves
    panels = upper.subplots(2, columns, sharex=True, sharey=True, squeeze=False)
    letters = iter("abcdefghijklmnopqrstuvwxyz")
    for row, way, name in zip(panels, ways, ("approach", "retraction"), strict=True):
        for axes, pair in zip(row, way, strict=False):
            _moment(axes, scene, size, pair, widest)
            axes.set(xlim=(0.0, widest / size.length), ylim=(-1.15 * deepest, 2.7 * deepest))
            depth = pair[0].penetration / size.length
            axes.set_title(f"({next(letters)}) {name}, {size.depth_label} = {depth:.3g}", fontsize=9)
        for axes in row[len(way) :]:
            axes.set_axis_off()
        row[0].set_ylabel(size.height_label)
    for axes in panels[1]:
        axes.set_xlabel(size.radius_label)
    panels[0, 0].legend(loc="lower right", frameon=False, fontsize=8, labelcolor=INK)
    three = lower.subplots(1, 3)
    peak = max(float(profile.pressure.max()) for profile in bem) / size.pressure
    for axes, way, title in zip(three, ways, ("approach: annular peak", "retraction: no peak"), strict=False):
        _pressures(axes, size, way)
        axes.set_title(f"({next(letters)}) {title}", fontsize=9)
        axes.set_ylim(-1.8 * peak, 1.15 * peak)  # the peak; the singular tension at the edge leaves below
    _crack(three[2], size, ways[1])
    three[2].set_title(f"({next(letters)}) retraction: trumpet crack", fontsize=9)
    for axes in (*panels.flat, *three):
        format_axes(axes, (-2, 4), 0.4)
        for inset in axes.child_axes:
            for axis in (inset.xaxis, inset.yaxis):
                axis.get_offset_text().set_fontsize(7)
    return panel_figure


def _moment(
    axes: Axes, scene: Scene, size: AxisScale, pair: tuple[SurfaceProfile, SurfaceProfile], widest: float
) -> None:
    """Indenter and deformed surface, with the pressure in an inset."""
    r = np.linspace(0.0, widest, 200)
    height = scene.indenter.height(r) - pair[0].penetration
    axes.plot(r / size.length, height / size.length, color=INK, linewidth=1.0, label="indenter")
    axes.fill_between(r / size.length, height / size.length, 1e3, color=GRID, alpha=0.35, linewidth=0.0)
    inset = axes.inset_axes((0.12, 0.64, 0.36, 0.26))
    for profile, solver in zip(pair, TWO_SOLVERS, strict=True):
        drawn = profile.radius <= widest
        x, up = profile.radius[drawn] / size.length, -profile.displacement[drawn] / size.length
        r, p = loaded(profile)
        if solver == "bem":
            axes.plot(x, up, label=solver, color=SERIES[0], linewidth=1.5)
            inset.plot(r / size.length, p / size.pressure, color=SERIES[0], linewidth=1.3)
        else:
            axes.plot(*evenly(x, up), label=solver, **_marks(SERIES[1], "o"))
            inset.plot(*evenly(r / size.length, p / size.pressure), **_marks(SERIES[1], "o", 2.5))
    inset.axhline(0.0, color=INK, linewidth=0.5)
    inset.set_xlabel(size.radius_label, fontsize=7, labelpad=0)
    inset.set_title(size.pressure_label, fontsize=7, pad=2)
    inset.tick_params(labelsize=6.5)


def _pressures(axes: Axes, size: AxisScale, pairs: Sequence[tuple[SurfaceProfile, SurfaceProfile]]) -> None:
    """Pressure over ``r/a`` of one way."""
    for pair, colour, shape in zip(pairs, SERIES, MARKERS, strict=False):
        for profile, solver in zip(pair, TWO_SOLVERS, strict=True):
            r, p = loaded(profile)
            x, y = r / profile.contact_radius, p / size.pressure
            if solver == "bem":
                axes.plot(x, y, color=colour, linewidth=1.4)
            else:
                axes.plot(*evenly(x, y), **_marks(colour, shape))
        label = f"{size.depth_label} = {pair[0].penetration / size.length:.3g}"
        axes.plot([], [], color=colour, marker=shape, fillstyle="none", label=label)
    axes.axhline(0.0, color=INK, linewidth=0.6)
    axes.set(xlabel=r"$r/a$", ylabel=size.pressure_label, xlim=(0.0, 1.02))
    axes.legend(loc="lower left", frameon=False, fontsize=8, labelcolor=INK)


def _crack(axes: Axes, size: AxisScale, pairs: Sequence[tuple[SurfaceProfile, SurfaceProfile]]) -> None:
    """Gap over the distance from the edge."""
    curves: list[tuple[Array, Array]] = []
    for pair, colour, shape in zip(pairs, SERIES, MARKERS, strict=False):
        for profile, solver in zip(pair, TWO_SOLVERS, strict=True):
            s, gap = opening(profile)
            x, y = s / size.length, gap / size.length
            if solver == "bem":
                axes.loglog(x, y, color=colour, linewidth=1.4)
                curves.append((x, y))
            else:
                axes.loglog(*evenly(np.log(x), np.log(y), np.exp), **_marks(colour, shape))
        label = f"{size.depth_label} = {pair[0].penetration / size.length:.3g}"
        axes.plot([], [], color=colour, marker=shape, fillstyle="none", label=label)
    x, y = curves[-1]
    middle = x.size // 2
    for at, reach, power, line in ((0, x[-1] / x[0], 0.5, ":"), (middle, 4.0, 1.5, "--")):
        span = np.array([x[at], reach * x[at]])
        rising = 1.15 * y[at] * (span / x[at]) ** power
        label = f"power {2 * power:.0f}/2"
        axes.plot(span, rising, line, color=INK, linewidth=1.0, label=label)
    axes.set(xlabel=size.distance_label, ylabel=size.gap_label)
    axes.legend(loc="upper left", frameon=False, fontsize=8, labelcolor=INK)


def loaded(profile: SurfaceProfile) -> tuple[Array, Array]:
    """Radii and pressures inside the contact, without the singular end."""
    inside = profile.radius <= NEAREST * profile.contact_radius
    return profile.radius[inside], profile.pressure[inside]


def opening(profile: SurfaceProfile, least: float = 2e-3, most: float = 0.6) -> tuple[Array, Array]:
    """Distances from the edge and gaps there, within two parts of the contact radius.

    Parameters
    ----------
    profile : SurfaceProfile
    least, most : float
        Distances from the edge, relative to the contact radius.

    Returns
    -------
    distance, gap : ndarray, shape (n,)
    """
    s = profile.radius - profile.contact_radius
    drawn = (s >= least * profile.contact_radius) & (s <= most * profile.contact_radius) & (profile.gap > 0.0)
    return s[drawn], profile.gap[drawn]


def evenly(x: Array, y: Array, back: Any = None) -> tuple[Array, Array]:
    """Points of a curve at even distances along it, axes scaled to their range; ``back`` undoes a log.

    Parameters
    ----------
    x, y : ndarray, shape (n,)
    back : callable, optional
        Of the points that are left.

    Returns
    -------
    x, y : ndarray
    """
    if x.size > MARKS:
        along = np.hypot(np.diff(x) / (np.ptp(x) or 1.0), np.diff(y) / (np.ptp(y) or 1.0))
        length = np.concatenate(([0.0], np.cumsum(along)))
        rows = np.unique(np.searchsorted(length, np.linspace(0.0, length[-1], MARKS)))
        x, y = x[rows], y[rows]
    return (x, y) if back is None else (back(x), back(y))


def _marks(colour: str, shape: str, size: float = 4.0) -> dict[str, Any]:
    return {"color": colour, "marker": shape, "markersize": size, "fillstyle": "none", "linestyle": "none"}
