"""The figures of the page on thin layers, drawn as it is built."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.pyplot import subplots

from contact_scene import FlatPunch, Layer, Sphere
from validation.drawing.figure import BLUE, DASHES, GREEN, INK, ORANGE, PURPLE, VERMILION
from validation.reference.elastic_layer import ElasticLayer, force_ratio
from validation.reference.jkr import JKR
from validation.reference.layer_formulas import HAYES, PUNCHES, SPHERES

BASES = {"bonded": "bonded to its base", "frictionless": "on a frictionless base"}
COLOURS = (VERMILION, BLUE, PURPLE, ORANGE, GREEN, INK)


def _sphere(ratio: float, poisson: float, base: str) -> tuple[float, float]:
    """``chi`` of a pressed sphere and its force over Hertz's, at a contact radius over the thickness."""
    pressed = ElasticLayer(Layer(1.0 / ratio, base), poisson, Sphere(1.0)).state(1.0)
    return ratio * pressed.penetration**0.5, pressed.force / (4.0 / 3.0 * pressed.penetration**1.5)


def _punch(ratio: float, poisson: float, base: str) -> float:
    """Stiffness of a flat punch over that on a half-space."""
    return 0.5 * ElasticLayer(Layer(1.0 / ratio, base), poisson, FlatPunch(1.0)).response(1.0).stiffness


def _panels(**labels: Any) -> list[Axes]:
    panels = list(subplots(1, 2, figsize=(9.0, 3.8), layout="constrained")[1])
    for axes in panels:
        axes.set(**labels)
        axes.xaxis.set_major_formatter("{x:g}")
        axes.grid(True, color="#e2e2e2", linewidth=0.5)
    return panels


def spheres() -> None:
    """Error of the force that formulas give at one penetration, incompressible."""
    ratios = np.geomspace(0.02, 4.0, 60)
    panels = _panels(xlabel="contact radius over thickness, a/h", xscale="log", ylim=(-60, 60))
    for axes, (base, words) in zip(panels, BASES.items(), strict=True):
        chi, exact = np.array([_sphere(float(ratio), 0.5, base) for ratio in ratios]).T
        formulas: dict[str, Callable] = {"Hertz": np.ones_like}
        formulas["exact to fourth order"] = lambda x, base=base: force_ratio(x, 0.5, base)
        formulas |= {name: formula for name, (where, formula) in SPHERES.items() if where == base}
        for (name, formula), color, dashes in zip(formulas.items(), COLOURS, DASHES, strict=False):
            axes.plot(ratios, 100 * (formula(chi) / exact - 1), color=color, linestyle=dashes, label=name)
        axes.set_title(f"sphere, ν = 1/2, {words}", fontsize="small")
        axes.legend(frameon=False, fontsize="small")
    panels[0].set_ylabel("error of the force at one penetration, %")


def stiffness() -> None:
    """The modulus read by Hertz over the true one, by Poisson's ratio and base."""
    ratios = np.geomspace(0.01, 10.0, 60)
    panels = _panels(xscale="log", yscale="log")
    cases = [(nu, "bonded") for nu in (0.5, 0.49, 0.45, 0.3, 0.0)] + [(0.5, "frictionless")]
    for (nu, base), color, dashes in zip(cases, COLOURS, (*DASHES, "-"), strict=False):
        name = f"ν = {nu:g}, bonded" if base == "bonded" else "frictionless base, any ν"
        chi, exact = np.array([_sphere(float(ratio), nu, base) for ratio in ratios]).T
        panels[0].plot(ratios, exact, color=color, linestyle=dashes, label=name)
        panels[1].plot(chi, 100.0 * (exact - 1.0), color=color, linestyle=dashes)
    panels[0].set(
        xlabel="contact radius over thickness, a/h", ylabel="modulus read by Hertz over the true one"
    )
    panels[0].yaxis.set_major_formatter("{x:g}")
    panels[1].set(
        xlabel="√(R D)/h", ylabel="modulus read by Hertz, % too high", xlim=(0.005, 0.5), ylim=(0.5, 100)
    )
    panels[0].legend(frameon=False, fontsize="small")


def punches() -> None:
    """Stiffness of a bonded flat punch: exact, and two published ones."""
    ratios = np.geomspace(0.1, 5.0, 60)
    panels = _panels(xlabel="punch radius over thickness, a/h")
    exact = np.array([_punch(float(ratio), 0.5, "bonded") for ratio in ratios])
    for name, formula in PUNCHES.items():
        panels[0].plot(
            ratios, 100 * (formula(ratios) / exact - 1), color=BLUE, linestyle="--", label=f"{name}, ν = 0.5"
        )
    for place, nu in enumerate((0.3, 0.4, 0.45, 0.5)):
        errors = [100 * (row[place] / _punch(at, nu, "bonded") - 1) for at, row in HAYES.items()]
        panels[1].plot(
            list(HAYES), errors, "os^D"[place], color=COLOURS[place], label=f"Hayes 1972, ν = {nu:g}"
        )
    panels[0].set(ylabel="error of the stiffness, %", ylim=(-20, 100))
    for axes in panels:
        axes.legend(frameon=False, fontsize="small")


def pull_off() -> None:
    """Pull-off of an elastic sphere over JKR's, by the thickness over the pull-off radius on a half-space."""
    work, sizes = 1e-3, np.geomspace(0.05, 8.0, 13)
    panels = _panels(xlabel="pull-off radius on a half-space over thickness", xscale="log")
    free = JKR(Sphere(1.0), 1.0, work)
    dead, rigid = free.pull_off_force_control(), free.pull_off_penetration_control()
    for (nu, base), color, dashes in zip(
        ((0.5, "bonded"), (0.3, "bonded"), (0.5, "frictionless")), COLOURS, DASHES, strict=False
    ):
        layers = [ElasticLayer(Layer(dead.contact_radius / size, base), nu, Sphere(1.0)) for size in sizes]
        name = f"ν = {nu:g}, bonded" if base == "bonded" else "frictionless base"
        force = [one.pull_off(work, "force").force / dead.force for one in layers]
        depth = [one.pull_off(work, "penetration").penetration / rigid.penetration for one in layers]
        panels[0].plot(sizes, force, color=color, linestyle=dashes, label=name)
        panels[1].plot(sizes, depth, color=color, linestyle=dashes)
    panels[0].set_ylabel("pull-off force over JKR's")
    panels[1].set_ylabel("stretch at loss of contact over JKR's")
    panels[0].legend(frameon=False, fontsize="small")
