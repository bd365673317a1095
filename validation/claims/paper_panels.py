"""Panels of the paper's figures: each a function that fills a figure from runs. See ``paper_figures``."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from contact_scene import Scene
from contact_scene.trace import Array
from validation.cases import load
from validation.claims import elastic, oscillations, release, surface
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
    cycle,
    retraction,
)
from validation.drawing.curves import of_trace
from validation.drawing.styles import BLUE, CLOSED_FORM, DASHES, INK, MARKERS, ORANGE, SERIES
from validation.measure.events import end_of_approach
from validation.measure.scaling import unit_sizes

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

OPEN: dict[str, Any] = {"markersize": 4, "fillstyle": "none"}
DEPTH, FORCE, RADIUS = r"$\tilde{\Delta}$", r"$\tilde{F}$", r"$\tilde{a}$"
SPEED, PULL_OFF = r"$\tilde{V}$", r"$F_\mathrm{off}/F_\mathrm{JKR}$"

SHOWN_CYCLES = (2e-5, 2e-3, 6e-3, 2e-2, 0.1, 10.0)
SHOWN_RETRACTIONS = (1e-6, 2e-4, 2e-3, 6e-3, 2e-2, 10.0)
SHOWN_DWELLS = (0.0, 0.3, 1.0, 3.0, 10.0, 100.0)
LabelledScenes = Sequence[tuple[str, Scene]]


def diagram(runs: LabelledScenes, across: str, up: str) -> Callable[[Figure, Evidence], None]:
    """Equilibrium diagram: approach dashed, withdrawal solid, the largest tension marked."""
    names = {"penetration": DEPTH, "force": FORCE, "contact_radius": RADIUS}

    def draw(figure: Figure, evidence: Evidence) -> None:
        axes = figure.subplots()
        for (label, scene), colour, marker in zip(runs, SERIES, MARKERS, strict=False):
            trace = evidence.trace(scene)
            curve, turn = of_trace(trace, scene), end_of_approach(trace)
            x, y = curve.columns[across], curve.columns[up]
            if turn > 0:
                axes.plot(x[: turn + 1], y[: turn + 1], color=colour, linestyle="--", linewidth=1.0)
            axes.plot(x[turn:], y[turn:], color=colour, linewidth=1.3)
            if curve.pull_off is not None:
                axes.plot(x[curve.pull_off], y[curve.pull_off], marker, color=colour, **OPEN)
            axes.plot([], [], color=colour, marker=marker, **OPEN, label=label)
        limits = axes.axis()
        _jkr(axes, across, up)
        axes.axis(limits)
        axes.set(xlabel=names[across], ylabel=names[up])

    return draw


def _jkr(axes: Axes, across: str, up: str) -> None:
    for glassy, label in ((False, "JKR, $E_0$"), (True, r"JKR, $E_\infty$")):
        law = elastic.vanishing(glassy)
        a = np.linspace(law.pull_off_penetration_control().contact_radius, 0.26, 200)
        columns = {"penetration": law.penetration(a), "force": law.force(a) / np.pi, "contact_radius": a}
        style = CLOSED_FORM | {"linestyle": ":" if glassy else (0, (4, 1, 1, 1))}
        axes.plot(columns[across], columns[up], label=label, **style)


def cycles() -> LabelledScenes:
    """Approach and retraction at the speeds of Fig. 2."""
    return [(rf"{SPEED} = {v:g}", cycle(v)) for v in SHOWN_CYCLES]


def retractions() -> LabelledScenes:
    """Retraction of a relaxed contact at the speeds of Fig. 4."""
    return [(rf"{SPEED} = {v:g}", retraction(v)) for v in SHOWN_RETRACTIONS]


def dwells() -> LabelledScenes:
    """Fast cycles with rests of several lengths at the deepest point."""
    return [(rf"$\tilde{{t}}_d$ = {t:g}", cycle(0.1, dwell=t)) for t in SHOWN_DWELLS]


def pull_off_of_cycles(figure: Figure, evidence: Evidence) -> None:
    """Largest tension of cycles against their speed, in units of ``F_JKR``."""
    axes = figure.subplots()
    values = [evidence.pull_off(cycle(v)) for v in CYCLE_SPEEDS]
    axes.semilogx(CYCLE_SPEEDS, values, "o-", color=SERIES[0], markersize=4)
    axes.set(xlabel=SPEED, ylabel=PULL_OFF, ylim=(0.0, None))


def surfaces(figure: Figure, evidence: Evidence) -> None:
    """Deformed surface at six moments of a cycle, the pressure inset."""
    figure.set_size_inches(9.0, 5.2)
    panels = figure.subplots(2, 3, sharex=True, sharey=True)
    for axes, profile, letter in zip(panels.flat, surface.profiles(evidence), "abcdef", strict=False):
        r = profile.radius[profile.radius < 0.5]
        n = r.size
        sphere, skin = ("sphere", "surface") if letter == "a" else (None, None)
        height = 0.5 * r**2 - profile.penetration
        axes.plot(r, height, color=INK, linestyle="--", linewidth=1.0, label=sphere)
        axes.plot(r, -profile.displacement[:n], color=SERIES[0], linewidth=1.4, label=skin)
        way = "approach" if profile.time <= surface.REVERSAL else "retraction"
        axes.set_title(f"({letter}) {way}, {DEPTH} = {profile.penetration:.3f}", fontsize=8)
        axes.set(xlim=(0.0, 0.5), ylim=(-0.035, 0.09))
        inside = r < 0.995 * profile.contact_radius
        inset = axes.inset_axes((0.2, 0.6, 0.32, 0.36))
        inset.plot(r[inside], profile.pressure[:n][inside] / np.pi, color=SERIES[1], linewidth=1.2)
        inset.set_xlabel(r"$\tilde{r}$", fontsize=7, labelpad=0)
        inset.set_ylabel(r"$\tilde{p}$", fontsize=7, labelpad=0)
        inset.tick_params(labelsize=6, colors=INK, labelcolor=INK)
        inset.axhline(0.0, color=INK, linewidth=0.5)
    for axes in panels[1]:
        axes.set_xlabel(r"$\tilde{r}$")
    for axes in panels[:, 0]:
        axes.set_ylabel(r"$\tilde{u}$")


def preload(figure: Figure, evidence: Evidence) -> None:
    """Largest tension against the penetration at which the retraction begins, at several speeds."""
    axes = figure.subplots()
    by_speed = {v: [evidence.pull_off(retraction(v, depth)) for depth in PRELOADS] for v in PRELOAD_SPEEDS}
    _series(axes, PRELOADS, {f"{SPEED} = {speed:g}": values for speed, values in by_speed.items()})
    axes.axhline(10.0, label=r"$E_\infty/E_0$", **CLOSED_FORM)
    axes.set(xlabel=r"$\tilde{\Delta}_B$", ylabel=PULL_OFF)


def _series(axes: Axes, across: Sequence[float], curves: Mapping[str, Sequence[float]]) -> None:
    """Several curves over the same values, told apart by colour, line style and marker."""
    for (label, values), colour, dash, marker in zip(curves.items(), SERIES, DASHES, MARKERS, strict=False):
        axes.plot(across, values, color=colour, linestyle=dash, marker=marker, **OPEN, label=label)


def forces(figure: Figure, evidence: Evidence) -> None:
    """Withdrawal under constant tension beside the retraction of the same pull-off force."""
    axes = figure.subplots()
    for force, colour in zip(FORCES, SERIES, strict=False):
        scene, same = load(f"force-{force}").scene, retraction(MATCHED[force])
        held, moved = of_trace(evidence.trace(scene), scene), of_trace(evidence.trace(same), same)
        label = rf"{FORCE} = {held.columns['force'][-1]:.2e}"
        for curve, line, shown in ((held, "-", label), (moved, "--", None)):
            x, y = curve.columns["penetration"], curve.columns["force"]
            axes.plot(x, y, color=colour, linestyle=line, linewidth=1.2, label=shown)
        axes.plot(held.columns["penetration"][-1], held.columns["force"][-1], "o", color=colour, markersize=4)
    axes.plot([], [], color=INK, linestyle="--", label="constant speed, same pull-off")
    axes.set(xlabel=DEPTH, ylabel=FORCE)


def forces_over_time(figure: Figure, evidence: Evidence) -> None:
    """Penetration over time under constant tension."""
    axes = figure.subplots()
    for force, colour, dashes in zip(FORCES, SERIES, DASHES, strict=False):
        scene = load(f"force-{force}").scene
        columns = of_trace(evidence.trace(scene), scene).columns
        after = columns["time"] > 0.0
        t, depth = columns["time"][after], columns["penetration"][after]
        axes.plot(t, depth, color=colour, linestyle=dashes, label=rf"{force} $F_\mathrm{{JKR}}$")
    axes.set(xlabel=r"$\tilde{t}$", ylabel=DEPTH, xscale="log", xlim=(1e-2, None))


def sweep(first: float, last: float) -> Callable[[Figure, Evidence], None]:
    """Equilibrium diagram of the sweep while the frequency lies in a range."""

    def draw(figure: Figure, evidence: Evidence) -> None:
        axes = figure.subplots()
        chirp = 0.006
        columns = of_trace(evidence.trace("sweep"), load("sweep").scene).columns
        rows = (columns["time"] * chirp >= first) & (columns["time"] * chirp <= last)
        axes.plot(columns["penetration"][rows], columns["force"][rows], color=SERIES[0], linewidth=0.9)
        axes.set(xlabel=DEPTH, ylabel=FORCE)

    return draw


def cycle_losses(figure: Figure, evidence: Evidence) -> None:
    """Energy lost in each cycle of the sweep against its frequency."""
    axes = figure.subplots()
    cycles = oscillations.losses(evidence)[1:]
    size = unit_sizes(load("sweep").scene)["energy"]
    frequencies, loops = [one.angular_frequency for one in cycles], [one.loop / size for one in cycles]
    axes.plot(frequencies, loops, "o-", color=SERIES[0], markersize=3, linewidth=1.0)
    axes.set(xlabel=r"$\tilde{\omega}_a$", ylabel=r"$\tilde{L}$", ylim=(0.0, None))


def oscillation(figure: Figure, evidence: Evidence) -> None:
    """Retraction with an oscillation: each cycle, the line through its lowest forces, and none."""
    axes = figure.subplots()
    for frequency, colour in zip(FREQUENCIES[::-1], (BLUE, ORANGE), strict=True):
        scene = load(f"oscillation-w{frequency}").scene
        columns = of_trace(evidence.trace(scene), scene).columns
        label = rf"$\tilde{{\omega}}$ = {frequency}"
        depth, force = columns["penetration"], columns["force"]
        axes.plot(depth, force, color=colour, linewidth=0.4, alpha=0.4, rasterized=True)
        lowest = _lowest_of_cycles(force, np.floor(columns["time"] * float(frequency) / (2.0 * np.pi)))
        axes.plot(depth[lowest], force[lowest], color=colour, linestyle="--", linewidth=2.2, label=label)
    columns = of_trace(evidence.trace("retraction-steady"), load("retraction-steady").scene).columns
    axes.plot(columns["penetration"], columns["force"], color=INK, linewidth=1.3, label="steady")
    axes.set(xlabel=DEPTH, ylabel=FORCE)


def _lowest_of_cycles(force: Array, cycle: Array) -> list[int]:
    """Row of the lowest local minimum of the force in each cycle: roundings make others beside it."""
    minima = np.flatnonzero((force[1:-1] < force[:-2]) & (force[1:-1] <= force[2:])) + 1
    by_force = minima[np.argsort(force[minima], kind="stable")]
    _, first = np.unique(cycle[by_force], return_index=True)
    return by_force[first].tolist()


def release_rates(figure: Figure, evidence: Evidence) -> None:
    """Energy release rate at pull-off and pull-off force against speed."""
    axes = figure.subplots()
    rates = [release.at_pull_off(evidence, v) for v in RETRACTION_SPEEDS]
    pulls = [evidence.pull_off(retraction(v)) for v in RETRACTION_SPEEDS]
    axes.semilogx(RETRACTION_SPEEDS, rates, "o-", color=SERIES[0], markersize=4, label=r"$G/\Delta\gamma$")
    axes.semilogx(RETRACTION_SPEEDS, pulls, "s--", color=SERIES[1], **OPEN, label=PULL_OFF)
    axes.set(xlabel=SPEED, ylabel=rf"$G/\Delta\gamma$, {PULL_OFF}", ylim=(0.0, None))


def approaching(figure: Figure, evidence: Evidence) -> None:
    """Energy release rate at given penetrations while approaching, against speed."""
    axes = figure.subplots()
    by_depth = {d: [release.approaching(evidence, v, d) for v in CYCLE_SPEEDS] for d in release.DEPTHS}
    _series(axes, CYCLE_SPEEDS, {f"{DEPTH} = {depth:g}": values for depth, values in by_depth.items()})
    axes.axhline(0.0, color=INK, linewidth=0.6)
    axes.set(xlabel=SPEED, ylabel=r"$G/\Delta\gamma$", xscale="log")


def rests(figure: Figure, evidence: Evidence) -> None:
    """Largest tension against the length of the rest, at several speeds."""
    axes = figure.subplots()
    by_speed = {v: [evidence.pull_off(cycle(v, dwell=t)) for t in DWELLS[1:]] for v in DWELL_SPEEDS}
    _series(axes, DWELLS[1:], {f"{SPEED} = {speed:g}": values for speed, values in by_speed.items()})
    axes.set(xlabel=r"$\tilde{t}_d$", ylabel=PULL_OFF, xscale="log")
