"""What a record shows of itself, as a table, a row of a file, and a picture."""

from __future__ import annotations

import csv
import io
import math
from collections.abc import Iterable
from typing import TYPE_CHECKING, Any

import numpy as np

from contact_scene.tables import PREFIXES
from validation.drawing.figure import GREY, INK, SERIES, VERMILION, drawing, format_axes, label_axes
from validation.fits.contact import Array
from validation.fits.features import Features
from validation.fits.record import KINDS, MeasuredCurve

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

COLOURS = dict(zip(KINDS, (SERIES[0], SERIES[2], SERIES[1]), strict=True))
"""Of the segments of a curve, by what the drive does."""
_BY_POWER = {power: sign for sign, power in PREFIXES.items()}


def prefixed(value: float, unit: str, digits: int = 4) -> str:
    """A number in SI units with the prefix that leaves one to three digits before the point."""
    power = 3 * math.floor(math.log10(abs(value)) / 3.0 + 1e-9) if value and math.isfinite(value) else 0
    power = min(max(power, -15), 9) if 0 < len(unit) <= 2 else 0
    return f"{value / float(f'1e{power}'):.{digits}g} {_BY_POWER[power]}{unit}".rstrip()


def rows(curve: MeasuredCurve, told: Features) -> list[tuple[str, str]]:
    """The table of a curve: what was found, in words, and how much it is."""
    segments = ", ".join(f"{one.kind} {one.last - one.first}" for one in curve.segments)
    spring = "indenter prescribed" if curve.stiffness is None else prefixed(curve.stiffness, "N/m")
    found = [("rows", segments), ("spring constant", spring)]
    if told.contact is None:
        found.append(("contact", "no contact"))
    for key, unit, words, value in told.numbers():
        if value is not None:
            text = prefixed(value, unit)
            if key in ("contact", "lost"):
                text += f"  ({prefixed(value - curve.position[0], unit)} from the first row)"
            found.append((words, text))
    return found


def written(curves: Iterable[tuple[MeasuredCurve, Features]]) -> str:
    """All curves as CSV, a row each, with all digits in SI units; empty where a curve shows nothing."""
    stream = io.StringIO()
    out = csv.writer(stream, lineterminator="\n")
    titles = (f"{name} [{unit}]" if unit else name for name, unit, *_ in Features().numbers())
    out.writerow(["curve", *titles, "warnings"])
    for curve, told in curves:
        cells = ("" if value is None else repr(float(value)) for *_, value in told.numbers())
        out.writerow([curve.name, *cells, "; ".join(told.warnings)])
    return stream.getvalue()


def draw_curve(curve: MeasuredCurve, told: Features) -> Figure:
    """Force over its background: over the stage, over the indentation, and over time; free rows grey."""
    figure, (over, around, along) = drawing((11.0, 3.4), 1, 3)
    draw_over_stage(over, curve, told)
    stage = curve.position
    tip = stage if curve.stiffness is None else stage - told.force / curve.stiffness
    if told.contact is not None:
        _lines(around, curve, tip - told.contact, told, "indentation (m)")
        near = max(told.depth or 0.0, 1e-3 * float(np.ptp(stage)))
        around.set_xlim(-2.0 * near, 1.15 * near)
    else:
        _lines(around, curve, tip - tip[0], told, "tip (m)")
    _lines(along, curve, curve.time - curve.time[0], told, "time (s)")
    over.set_title(curve.name, fontsize="medium")
    over.legend(frameon=False, fontsize="small", labelcolor=INK)
    return figure


def draw_over_stage(axes: Axes, curve: MeasuredCurve, told: Features) -> None:
    """Force over its background, over the stage, with the places of contact and its loss."""
    first = curve.position[0]
    _lines(axes, curve, curve.position - first, told, "stage (m)")
    if told.contact is not None:
        axes.axvline(told.contact - first, color=INK, linewidth=0.8, label="contact")
    if told.lost is not None:
        axes.axvline(told.lost - first, color=VERMILION, linewidth=0.8, linestyle="--", label="lost")


def _lines(axes: Axes, curve: MeasuredCurve, place: Array, told: Features, name: str) -> None:
    """Segments in their colours, above the free rows in grey."""
    bare: dict[str, Any] = {"linestyle": "none", "marker": ".", "markersize": 1.5, "rasterized": True}
    axes.plot(place[told.free], told.force[told.free], color=GREY, **bare)
    labels = {one.kind: one for one in reversed(curve.segments)}
    for one in curve.segments:
        label = one.kind if labels[one.kind] is one else None
        look: dict[str, Any] = {"color": COLOURS[one.kind], "linewidth": 0.8, "rasterized": True}
        axes.plot(place[one.rows], told.force[one.rows], label=label, **look)
    format_axes(axes)
    label_axes(axes, name, "force (N)")
    axes.locator_params(axis="x", nbins=4)
