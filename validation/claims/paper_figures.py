"""The paper's figures, redrawn from the runs its claims are judged on.

Axes as in the paper, dimensionless. Where the text of the paper does not say which speeds, penetrations or
forces a figure shows, those of the claims' sweeps are shown.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np

from contact_scene import Scene
from contact_scene.trace import Array
from validation.cases import load
from validation.claims import evidence as sweeps
from validation.claims.cycles import REVERSAL
from validation.claims.evidence import Evidence, MissingRun, cycle, retraction
from validation.claims.measures import SOFT, STIFF, jkr, sweep_cycles
from validation.claims.retractions import DEPTHS, MOST, approaching, at_pull_off
from validation.drawing import figure as fig
from validation.drawing.curves import of_trace
from validation.measure.events import end_of_approach
from validation.measure.scaling import unit_sizes

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

Draw = Callable[["Axes", Evidence], None]
Curves = Callable[[Evidence], Mapping[str, Mapping[float, float]]]
Family = tuple[str, Callable[[float], Scene], tuple[float, ...]]
"""Symbol of a parameter, scene at a value of it, and the values."""
OPEN: dict[str, Any] = {"markersize": 4, "fillstyle": "none"}
DEPTH, FORCE, RADIUS = r"$\tilde{\Delta}$", r"$\tilde{F}$", r"$\tilde{a}$"
SPEED, PULL_OFF, RATE = r"$\tilde{V}$", r"$F_\mathrm{off}/F_\mathrm{JKR}$", r"$G/\Delta\gamma$"
NAMES = {"time": r"$\tilde{t}$", "penetration": DEPTH, "force": FORCE, "contact_radius": RADIUS}
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
    picture, panel = fig.drawing((9.0, 5.2) if figure.wide else fig.SIZE)
    try:
        figure.draw(panel, evidence)
    except MissingRun:
        return None
    for axes in picture.axes:
        fig.format_axes(axes, (-2, 4))
        if axes.get_legend_handles_labels()[0]:
            look: dict[str, Any] = {"fontsize": 7, "handlelength": 2.8, "labelspacing": 0.3}
            legend = axes.legend(frameon=False, labelcolor=fig.INK, **look)
            if axes.child_axes:
                legend.set_loc("lower right")
    return picture


def _columns(evidence: Evidence, scene: Scene | str) -> dict[str, Array]:
    asked = load(scene).scene if isinstance(scene, str) else scene
    return of_trace(evidence.trace(asked), asked).columns


def _diagram(across: str, up: str, family: Family) -> Draw:
    """Equilibrium diagram: approach dashed, withdrawal solid, the largest tension marked, and JKR."""
    name, scenes, values = family

    def draw(axes: Axes, evidence: Evidence) -> None:
        for value, colour, marker in zip(values, fig.SERIES, fig.MARKERS, strict=False):
            trace = evidence.trace(scenes(value))
            curve, turn = of_trace(trace, scenes(value)), end_of_approach(trace)
            x, y = curve.columns[across], curve.columns[up]
            at = [] if curve.pull_off is None else [curve.pull_off - turn]
            mark: dict[str, Any] = {"marker": marker, "markevery": at, "label": f"{name} = {value:g}"} | OPEN
            axes.plot(x[: turn + 1], y[: turn + 1], color=colour, linestyle="--", linewidth=1.0)
            axes.plot(x[turn:], y[turn:], color=colour, linewidth=1.3, **mark)
        limits = axes.axis()
        for glassy, label, dash in ((SOFT, "$E_0$", (0, (4, 1, 1, 1))), (STIFF, r"$E_\infty$", ":")):
            law = jkr(glassy)
            a = np.linspace(law.pull_off_penetration_control().contact_radius, 0.26, 200)
            exact = {"penetration": law.penetration(a), "force": law.force(a) / np.pi, "contact_radius": a}
            axes.plot(
                exact[across], exact[up], label=f"JKR, {label}", **fig.CLOSED_FORM | {"linestyle": dash}
            )
        axes.axis(limits)
        axes.set(xlabel=NAMES[across], ylabel=NAMES[up])

    return draw


def _sweep(curves: Curves, line: Mapping[str, Any] | None = None, **settings: Any) -> Draw:
    """Values over a parameter, several curves told apart by colour, line style and marker."""

    def draw(axes: Axes, evidence: Evidence) -> None:
        looks = zip(curves(evidence).items(), fig.SERIES, fig.DASHES, fig.MARKERS, strict=False)
        for (label, curve), colour, dash, marker in looks:
            style: dict[str, Any] = {
                "color": colour,
                "linestyle": dash,
                "marker": marker,
                "label": label,
            } | OPEN
            axes.plot(list(curve), list(curve.values()), **style)
        if line is not None:
            axes.axhline(**line)
        axes.set(**settings)

    return draw


def _pull_offs(speeds: Sequence[float], of: Callable[[float, float], Scene], over: Sequence[float]) -> Curves:
    """Pull-off force over a parameter, a curve a speed."""
    return lambda runs: {
        f"{SPEED} = {v:g}": runs.pull_offs(partial(of, v), over) for v in speeds
    }  # fmt: skip


def _tensions(across: str, up: str, **settings: Any) -> Draw:
    """Constant tensions to their ends; dashed retractions at constant speed of the same pull-off force."""

    def draw(axes: Axes, evidence: Evidence) -> None:
        for force, colour in zip(sweeps.FORCES, fig.SERIES, strict=False):
            held = _columns(evidence, f"force-{force}")
            moved = _columns(evidence, retraction(sweeps.MATCHED[force]))
            look: dict[str, Any] = {"color": colour, "linewidth": 1.2}
            end: dict[str, Any] = {
                "marker": "o",
                "markevery": [-1],
                "label": rf"{force} $F_\mathrm{{JKR}}$",
            } | OPEN
            axes.plot(held[across], held[up], **look, **end)
            axes.plot(moved[across], moved[up], linestyle="--", **look)
        axes.plot([], [], color=fig.INK, linestyle="--", label="constant speed, same pull-off")
        axes.set(xlabel=NAMES[across], ylabel=NAMES[up], **settings)

    return draw


def _frequencies(first: float, last: float) -> Draw:
    """Equilibrium diagram of the sweep while the frequency lies in a range."""

    def draw(axes: Axes, evidence: Evidence) -> None:
        columns = _columns(evidence, "sweep")
        rows = (columns["time"] * CHIRP >= first) & (columns["time"] * CHIRP <= last)
        axes.plot(columns["penetration"][rows], columns["force"][rows], color=fig.SERIES[0], linewidth=0.9)
        axes.set(xlabel=DEPTH, ylabel=FORCE)

    return draw


def oscillation(axes: Axes, evidence: Evidence) -> None:
    """Retraction with an oscillation: each cycle, the line through its lowest forces, and none."""
    for w, colour in zip(sweeps.FREQUENCIES[::-1], (fig.BLUE, fig.ORANGE), strict=True):
        columns = _columns(evidence, f"oscillation-w{w}")
        depth, force = columns["penetration"], columns["force"]
        axes.plot(depth, force, color=colour, linewidth=0.4, alpha=0.4, rasterized=True)
        lowest = _lowest_of_cycles(force, np.floor(columns["time"] * float(w) / (2.0 * np.pi)))
        look: dict[str, Any] = {
            "color": colour,
            "linestyle": "--",
            "linewidth": 2.2,
            "label": rf"$\tilde{{\omega}}$ = {w}",
        }
        axes.plot(depth[lowest], force[lowest], **look)
    columns = _columns(evidence, "retraction-steady")
    axes.plot(columns["penetration"], columns["force"], color=fig.INK, linewidth=1.3, label="steady")
    axes.set(xlabel=DEPTH, ylabel=FORCE)


def _lowest_of_cycles(force: Array, cycle: Array) -> list[int]:
    """Row of the lowest local minimum of the force in each cycle: roundings make others beside it."""
    minima = np.flatnonzero((force[1:-1] < force[:-2]) & (force[1:-1] <= force[2:])) + 1
    by_force = minima[np.argsort(force[minima], kind="stable")]
    _, first = np.unique(cycle[by_force], return_index=True)
    return by_force[first].tolist()


def _surfaces(whole: Axes, evidence: Evidence) -> None:
    """Deformed surface at six moments of a cycle, the pressure inset."""
    figure = whole.figure
    figure.clear()
    panels = figure.subplots(2, 3, sharex=True, sharey=True)
    for axes, profile, letter in zip(panels.flat, evidence.profiles(), "abcdef", strict=False):
        r = profile.radius[profile.radius < 0.5]
        sphere, skin = ("sphere", "surface") if letter == "a" else (None, None)
        axes.plot(
            r, 0.5 * r**2 - profile.penetration, color=fig.INK, linestyle="--", linewidth=1.0, label=sphere
        )
        axes.plot(r, -profile.displacement[: r.size], color=fig.SERIES[0], linewidth=1.4, label=skin)
        way = "approach" if profile.time <= REVERSAL else "retraction"
        axes.set_title(f"({letter}) {way}, {DEPTH} = {profile.penetration:.3f}", fontsize=8)
        axes.set(xlim=(0.0, 0.5), ylim=(-0.035, 0.09), xlabel=r"$\tilde{r}$", ylabel=r"$\tilde{u}$")
        axes.label_outer()
        inside = r < 0.995 * profile.contact_radius
        inset = axes.inset_axes((0.2, 0.6, 0.32, 0.36))
        inset.plot(r[inside], profile.pressure[: r.size][inside] / np.pi, color=fig.SERIES[1], linewidth=1.2)
        inset.set_xlabel(r"$\tilde{r}$", fontsize=7, labelpad=0)
        inset.set_ylabel(r"$\tilde{p}$", fontsize=7, labelpad=0)
        inset.tick_params(labelsize=6)
        inset.axhline(0.0, color=fig.INK, linewidth=0.5)


def _losses(runs: Evidence) -> Mapping[str, Mapping[float, float]]:
    size = unit_sizes(load("sweep").scene)["energy"]
    return {"": {one.angular_frequency: one.loop / size for one in sweep_cycles(runs)[1:]}}


def _approaching(runs: Evidence) -> Mapping[str, Mapping[float, float]]:
    return {
        f"{DEPTH} = {depth:g}": {v: approaching(runs, v, depth) for v in sweeps.CYCLE_SPEEDS}
        for depth in DEPTHS
    }


def _at_pull_off(runs: Evidence) -> Mapping[str, Mapping[float, float]]:
    speeds = sweeps.RETRACTION_SPEEDS
    return {RATE: {v: at_pull_off(runs, v) for v in speeds}, PULL_OFF: runs.pull_offs(retraction, speeds)}


_BY_DEPTH, _BY_FORCE = ("penetration", "force"), ("force", "contact_radius")
_CYCLES: Family = (SPEED, cycle, (2e-5, 2e-3, 6e-3, 2e-2, 0.1, 10.0))
_RETRACTIONS: Family = (SPEED, retraction, (1e-6, 2e-4, 2e-3, 6e-3, 2e-2, 10.0))
_RESTS: Family = (r"$\tilde{t}_d$", lambda t: cycle(0.1, dwell=t), (0.0, 0.3, 1.0, 3.0, 10.0, 100.0))
_ZERO = {"y": 0.0, "color": fig.INK, "linewidth": 0.6}
_FROZEN = {"y": MOST, "label": r"$E_\infty/E_0$", **fig.CLOSED_FORM}
_FROM_ZERO = (0.0, None)

FIGURES = (
    PaperFigure("fig2a", "Fig. 2 (a): cycles, force against penetration", _diagram(*_BY_DEPTH, _CYCLES)),
    PaperFigure("fig2b", "Fig. 2 (b): cycles, contact radius against force", _diagram(*_BY_FORCE, _CYCLES)),
    PaperFigure("fig2c", "Fig. 2 (c): pull-off force of cycles against speed",
                _sweep(lambda runs: {"": runs.pull_offs(cycle, sweeps.CYCLE_SPEEDS)},
                       xlabel=SPEED, ylabel=PULL_OFF, xscale="log", ylim=_FROM_ZERO)),
    PaperFigure("fig3", "Fig. 3: surface, and pressure (insets), along the cycle at speed 0.002",
                _surfaces, wide=True),
    PaperFigure("fig4a", "Fig. 4 (a): relaxed, then withdrawn: force against penetration",
                _diagram(*_BY_DEPTH, _RETRACTIONS)),
    PaperFigure("fig4b", "Fig. 4 (b): the same, contact radius against force",
                _diagram(*_BY_FORCE, _RETRACTIONS)),
    PaperFigure("fig4c", "Fig. 4 (c): pull-off force against initial penetration",
                _sweep(_pull_offs(sweeps.PRELOAD_SPEEDS, retraction, sweeps.PRELOADS), _FROZEN,
                       xlabel=r"$\tilde{\Delta}_B$", ylabel=PULL_OFF)),
    PaperFigure("dwell-a", "Dwell-time figure (a): force against penetration after a rest, speed 0.1",
                _diagram(*_BY_DEPTH, _RESTS)),
    PaperFigure("dwell-b", "Dwell-time figure (b): contact radius against force",
                _diagram(*_BY_FORCE, _RESTS)),
    PaperFigure("dwell-c", "Beside it: pull-off force against the rest, at three speeds",
                _sweep(_pull_offs(sweeps.DWELL_SPEEDS, lambda v, t: cycle(v, dwell=t), sweeps.DWELLS[1:]),
                       xlabel=r"$\tilde{t}_d$", ylabel=PULL_OFF, xscale="log")),
    PaperFigure("fig5a", "Fig. 5 (a): constant tension, force against penetration", _tensions(*_BY_DEPTH)),
    PaperFigure("fig5b", "Fig. 5 (b): constant tension, penetration over time",
                _tensions("time", "penetration", xscale="log", xlim=(1e-2, None))),
    PaperFigure("fig6a", "Fig. 6 (a): sweep, frequencies up to 0.6", _frequencies(0.0, 0.6)),
    PaperFigure("fig6b", "Fig. 6 (b): sweep, frequencies from 1.8", _frequencies(1.8, 2.6)),
    PaperFigure("fig6c", "Fig. 6 (c): energy lost per cycle of the sweep",
                _sweep(_losses, xlabel=r"$\tilde{\omega}_a$", ylabel=r"$\tilde{L}$", ylim=_FROM_ZERO)),
    PaperFigure("fig6d", "Fig. 6 (d): oscillation on a slow retraction; dashed: largest tensions",
                oscillation),
    PaperFigure("fig7a", "Fig. 7 (a): energy release rate at pull-off, and pull-off force",
                _sweep(_at_pull_off, xlabel=SPEED, ylabel=f"{RATE}, {PULL_OFF}", xscale="log",
                       ylim=_FROM_ZERO)),
    PaperFigure("fig7b", "Fig. 7 (b): energy release rate while approaching",
                _sweep(_approaching, _ZERO, xlabel=SPEED, ylabel=RATE, xscale="log")),
)  # fmt: skip
