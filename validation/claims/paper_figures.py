"""The paper's figures, redrawn from the runs its claims are judged on.

Axes as in the paper, dimensionless. Where the text of the paper does not say which speeds, penetrations or
forces a figure shows, those of the claims' sweeps are shown.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from contact_scene import Scene
from contact_scene.trace import Array
from validation.cases import load
from validation.claims.cycles import REVERSAL
from validation.claims.evidence import (
    CYCLE_SPEEDS,
    DWELL_SPEEDS,
    DWELLS,
    FORCES,
    FREQUENCIES,
    MATCHED,
    PRELOAD_SPEEDS,
    PRELOADS,
    RETRACTION_SPEEDS,
    Evidence,
    MissingRun,
    cycle,
    retraction,
)
from validation.claims.measures import SOFT, STIFF, jkr, sweep_cycles
from validation.claims.retractions import DEPTHS, MOST, approaching, at_pull_off
from validation.drawing.axes import SIZE, format_axes
from validation.drawing.curves import RunCurves, of_trace
from validation.drawing.styles import BLUE, CLOSED_FORM, DASHES, INK, MARKERS, ORANGE, SERIES
from validation.measure.events import end_of_approach
from validation.measure.scaling import unit_sizes

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

Draw = Callable[["Axes", Evidence], None]
Curves = Mapping[str, Mapping[float, float]]
Family = tuple[str, Callable[[float], Scene], tuple[float, ...]]
"""Symbol of a parameter, scene at a value of it, and the values."""
OPEN: dict[str, Any] = {"markersize": 4, "fillstyle": "none"}
DEPTH, FORCE, RADIUS = r"$\tilde{\Delta}$", r"$\tilde{F}$", r"$\tilde{a}$"
SPEED, PULL_OFF = r"$\tilde{V}$", r"$F_\mathrm{off}/F_\mathrm{JKR}$"
NAMES = {"penetration": DEPTH, "force": FORCE, "contact_radius": RADIUS}
CHIRP = 0.006
"""Rate at which the frequency of the sweep rises."""


@dataclass(frozen=True)
class PaperFigure:
    """One figure or panel: ``name`` is a file name, ``draw`` fills axes; ``wide``: as wide as the page."""

    name: str
    caption: str
    draw: Draw
    wide: bool = False


def draw_figure(figure: PaperFigure, evidence: Evidence) -> Figure | None:
    """The figure; ``None`` if a run it shows is missing."""
    from matplotlib.figure import Figure as New

    drawing = New(figsize=(9.0, 5.2) if figure.wide else SIZE, layout="constrained")
    try:
        figure.draw(drawing.subplots(), evidence)
    except MissingRun:
        return None
    for axes in drawing.axes:
        format_axes(axes, (-2, 4))
        if axes.get_legend_handles_labels()[0]:
            legend = axes.legend(
                frameon=False, labelcolor=INK, fontsize=7, handlelength=2.8, labelspacing=0.3
            )
            if axes.child_axes:
                legend.set_loc("lower right")
    return drawing


def _diagram(across: str, up: str, family: Family) -> Draw:
    """Equilibrium diagram: approach dashed, withdrawal solid, the largest tension marked, and JKR."""

    name, scenes, values = family

    def draw(axes: Axes, evidence: Evidence) -> None:
        for value, colour, marker in zip(values, SERIES, MARKERS, strict=False):
            curve = _curve(evidence, scenes(value))
            turn = end_of_approach(evidence.trace(scenes(value)))
            x, y = curve.columns[across], curve.columns[up]
            if turn > 0:
                axes.plot(x[: turn + 1], y[: turn + 1], color=colour, linestyle="--", linewidth=1.0)
            axes.plot(x[turn:], y[turn:], color=colour, linewidth=1.3)
            if curve.pull_off is not None:
                axes.plot(x[curve.pull_off], y[curve.pull_off], marker, color=colour, **OPEN)
            axes.plot([], [], color=colour, marker=marker, **OPEN, label=f"{name} = {value:g}")
        limits = axes.axis()
        for glassy, label, dash in ((SOFT, "$E_0$", (0, (4, 1, 1, 1))), (STIFF, r"$E_\infty$", ":")):
            law = jkr(glassy)
            a = np.linspace(law.pull_off_penetration_control().contact_radius, 0.26, 200)
            exact = {"penetration": law.penetration(a), "force": law.force(a) / np.pi, "contact_radius": a}
            axes.plot(exact[across], exact[up], label=f"JKR, {label}", **CLOSED_FORM | {"linestyle": dash})
        axes.axis(limits)
        axes.set(xlabel=NAMES[across], ylabel=NAMES[up])

    return draw


def _sweep(curves: Callable[[Evidence], Curves], line: dict[str, Any] | None = None, **settings: Any) -> Draw:
    """Values over a parameter, several curves told apart by colour, line style and marker."""

    def draw(axes: Axes, evidence: Evidence) -> None:
        looks = zip(curves(evidence).items(), SERIES, DASHES, MARKERS, strict=False)
        for (label, curve), colour, dash, marker in looks:
            axes.plot(
                list(curve),
                list(curve.values()),
                color=colour,
                linestyle=dash,
                marker=marker,
                **OPEN,
                label=label,
            )
        if line is not None:
            axes.axhline(**line)
        axes.set(**settings)

    return draw


def _curve(evidence: Evidence, scene: Scene | str) -> RunCurves:
    asked = load(scene).scene if isinstance(scene, str) else scene
    return of_trace(evidence.trace(asked), asked)


def _surfaces(first: Axes, evidence: Evidence) -> None:
    """Deformed surface at six moments of a cycle, the pressure inset."""
    figure = first.figure
    figure.clear()
    panels = figure.subplots(2, 3, sharex=True, sharey=True)
    for axes, profile, letter in zip(panels.flat, evidence.profiles(), "abcdef", strict=False):
        r = profile.radius[profile.radius < 0.5]
        sphere, skin = ("sphere", "surface") if letter == "a" else (None, None)
        axes.plot(r, 0.5 * r**2 - profile.penetration, color=INK, linestyle="--", linewidth=1.0, label=sphere)
        axes.plot(r, -profile.displacement[: r.size], color=SERIES[0], linewidth=1.4, label=skin)
        way = "approach" if profile.time <= REVERSAL else "retraction"
        axes.set_title(f"({letter}) {way}, {DEPTH} = {profile.penetration:.3f}", fontsize=8)
        axes.set(xlim=(0.0, 0.5), ylim=(-0.035, 0.09))
        inside = r < 0.995 * profile.contact_radius
        inset = axes.inset_axes((0.2, 0.6, 0.32, 0.36))
        inset.plot(r[inside], profile.pressure[: r.size][inside] / np.pi, color=SERIES[1], linewidth=1.2)
        inset.set_xlabel(r"$\tilde{r}$", fontsize=7, labelpad=0)
        inset.set_ylabel(r"$\tilde{p}$", fontsize=7, labelpad=0)
        inset.tick_params(labelsize=6)
        inset.axhline(0.0, color=INK, linewidth=0.5)
    for axes in panels[1]:
        axes.set_xlabel(r"$\tilde{r}$")
    for axes in panels[:, 0]:
        axes.set_ylabel(r"$\tilde{u}$")


def _constant_tension(axes: Axes, evidence: Evidence) -> None:
    """Withdrawal under constant tension beside the retraction of the same pull-off force."""
    for force, colour in zip(FORCES, SERIES, strict=False):
        held = _curve(evidence, f"force-{force}").columns
        moved = _curve(evidence, retraction(MATCHED[force])).columns
        label = rf"{FORCE} = {held['force'][-1]:.2e}"
        axes.plot(held["penetration"], held["force"], color=colour, linewidth=1.2, label=label)
        axes.plot(moved["penetration"], moved["force"], color=colour, linestyle="--", linewidth=1.2)
        axes.plot(held["penetration"][-1], held["force"][-1], "o", color=colour, markersize=4)
    axes.plot([], [], color=INK, linestyle="--", label="constant speed, same pull-off")
    axes.set(xlabel=DEPTH, ylabel=FORCE)


def _tension_over_time(axes: Axes, evidence: Evidence) -> None:
    for force, colour, dashes in zip(FORCES, SERIES, DASHES, strict=False):
        columns = _curve(evidence, f"force-{force}").columns
        after, label = columns["time"] > 0.0, rf"{force} $F_\mathrm{{JKR}}$"
        t, depth = columns["time"][after], columns["penetration"][after]
        axes.plot(t, depth, color=colour, linestyle=dashes, label=label)
    axes.set(xlabel=r"$\tilde{t}$", ylabel=DEPTH, xscale="log", xlim=(1e-2, None))


def _frequencies(first: float, last: float) -> Draw:
    """Equilibrium diagram of the sweep while the frequency lies in a range."""

    def draw(axes: Axes, evidence: Evidence) -> None:
        columns = _curve(evidence, "sweep").columns
        rows = (columns["time"] * CHIRP >= first) & (columns["time"] * CHIRP <= last)
        axes.plot(columns["penetration"][rows], columns["force"][rows], color=SERIES[0], linewidth=0.9)
        axes.set(xlabel=DEPTH, ylabel=FORCE)

    return draw


def oscillation(axes: Axes, evidence: Evidence) -> None:
    """Retraction with an oscillation: each cycle, the line through its lowest forces, and none."""
    for frequency, colour in zip(FREQUENCIES[::-1], (BLUE, ORANGE), strict=True):
        columns = _curve(evidence, f"oscillation-w{frequency}").columns
        depth, force = columns["penetration"], columns["force"]
        axes.plot(depth, force, color=colour, linewidth=0.4, alpha=0.4, rasterized=True)
        lowest = _lowest_of_cycles(force, np.floor(columns["time"] * float(frequency) / (2.0 * np.pi)))
        label = rf"$\tilde{{\omega}}$ = {frequency}"
        axes.plot(depth[lowest], force[lowest], color=colour, linestyle="--", linewidth=2.2, label=label)
    columns = _curve(evidence, "retraction-steady").columns
    axes.plot(columns["penetration"], columns["force"], color=INK, linewidth=1.3, label="steady")
    axes.set(xlabel=DEPTH, ylabel=FORCE)


def _lowest_of_cycles(force: Array, cycle: Array) -> list[int]:
    """Row of the lowest local minimum of the force in each cycle: roundings make others beside it."""
    minima = np.flatnonzero((force[1:-1] < force[:-2]) & (force[1:-1] <= force[2:])) + 1
    by_force = minima[np.argsort(force[minima], kind="stable")]
    _, first = np.unique(cycle[by_force], return_index=True)
    return by_force[first].tolist()


def _losses(evidence: Evidence) -> Curves:
    size = unit_sizes(load("sweep").scene)["energy"]
    return {"": {one.angular_frequency: one.loop / size for one in sweep_cycles(evidence)[1:]}}


def _release_rates(evidence: Evidence) -> Curves:
    rates = {v: at_pull_off(evidence, v) for v in RETRACTION_SPEEDS}
    return {r"$G/\Delta\gamma$": rates, PULL_OFF: evidence.pull_offs(retraction, RETRACTION_SPEEDS)}


def _by_speed(speeds: tuple[float, ...], scene_of: Callable[[float, float], Scene], over: tuple[float, ...]):
    """Pull-off force over a parameter, a curve a speed."""
    return lambda evidence: {
        f"{SPEED} = {v:g}": evidence.pull_offs(lambda x, v=v: scene_of(v, x), over) for v in speeds
    }


def _approaching(evidence: Evidence) -> Curves:
    return {
        f"{DEPTH} = {depth:g}": {v: approaching(evidence, v, depth) for v in CYCLE_SPEEDS} for depth in DEPTHS
    }


_BY_DEPTH, _BY_FORCE = ("penetration", "force"), ("force", "contact_radius")
_CYCLES: Family = (SPEED, cycle, (2e-5, 2e-3, 6e-3, 2e-2, 0.1, 10.0))
_RETRACTIONS: Family = (SPEED, retraction, (1e-6, 2e-4, 2e-3, 6e-3, 2e-2, 10.0))
_DWELLS: Family = (r"$\tilde{t}_d$", lambda t: cycle(0.1, dwell=t), (0.0, 0.3, 1.0, 3.0, 10.0, 100.0))
_ZERO, _FROZEN = (
    {"y": 0.0, "color": INK, "linewidth": 0.6},
    {"y": MOST, "label": r"$E_\infty/E_0$", **CLOSED_FORM},
)

FIGURES = (
    PaperFigure("fig2a", "Fig. 2 (a): cycles, force against penetration", _diagram(*_BY_DEPTH, _CYCLES)),
    PaperFigure("fig2b", "Fig. 2 (b): cycles, contact radius against force", _diagram(*_BY_FORCE, _CYCLES)),
    PaperFigure("fig2c", "Fig. 2 (c): pull-off force of cycles against speed",
                _sweep(lambda runs: {"": runs.pull_offs(cycle, CYCLE_SPEEDS)},
                       xlabel=SPEED, ylabel=PULL_OFF, xscale="log", ylim=(0.0, None))),
    PaperFigure("fig3", "Fig. 3: surface, and pressure (insets), along the cycle at speed 0.002",
                _surfaces, wide=True),
    PaperFigure("fig4a", "Fig. 4 (a): relaxed, then withdrawn: force against penetration",
                _diagram(*_BY_DEPTH, _RETRACTIONS)),
    PaperFigure("fig4b", "Fig. 4 (b): the same, contact radius against force",
                _diagram(*_BY_FORCE, _RETRACTIONS)),
    PaperFigure("fig4c", "Fig. 4 (c): pull-off force against initial penetration",
                _sweep(_by_speed(PRELOAD_SPEEDS, retraction, PRELOADS), _FROZEN,
                       xlabel=r"$\tilde{\Delta}_B$", ylabel=PULL_OFF)),
    PaperFigure("dwell-a", "Dwell-time figure (a): force against penetration after a rest, speed 0.1",
                _diagram(*_BY_DEPTH, _DWELLS)),
    PaperFigure("dwell-b", "Dwell-time figure (b): contact radius against force",
                _diagram(*_BY_FORCE, _DWELLS)),
    PaperFigure("dwell-c", "Beside it: pull-off force against the rest, at three speeds",
                _sweep(_by_speed(DWELL_SPEEDS, lambda v, t: cycle(v, dwell=t), DWELLS[1:]),
                       xlabel=r"$\tilde{t}_d$", ylabel=PULL_OFF, xscale="log")),
    PaperFigure("fig5a", "Fig. 5 (a): constant tension, force against penetration", _constant_tension),
    PaperFigure("fig5b", "Fig. 5 (b): constant tension, penetration over time", _tension_over_time),
    PaperFigure("fig6a", "Fig. 6 (a): sweep, frequencies up to 0.6", _frequencies(0.0, 0.6)),
    PaperFigure("fig6b", "Fig. 6 (b): sweep, frequencies from 1.8", _frequencies(1.8, 2.6)),
    PaperFigure("fig6c", "Fig. 6 (c): energy lost per cycle of the sweep",
                _sweep(_losses, xlabel=r"$\tilde{\omega}_a$", ylabel=r"$\tilde{L}$", ylim=(0.0, None))),
    PaperFigure("fig6d", "Fig. 6 (d): oscillation on a slow retraction; dashed: largest tensions",
                oscillation),
    PaperFigure("fig7a", "Fig. 7 (a): energy release rate at pull-off, and pull-off force",
                _sweep(_release_rates, xlabel=SPEED, ylabel=rf"$G/\Delta\gamma$, {PULL_OFF}", xscale="log",
                       ylim=(0.0, None))),
    PaperFigure("fig7b", "Fig. 7 (b): energy release rate while approaching",
                _sweep(_approaching, _ZERO, xlabel=SPEED, ylabel=r"$G/\Delta\gamma$", xscale="log")),
)  # fmt: skip
