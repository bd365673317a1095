"""Which solver when: steps, time and memory over the length of the process zone, forecast by the solvers."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from contact_scene import Adhesion, Scene
from validation.cases import load
from validation.solvers import Solver, solvers
from validation.solvers.contact_range import largest_contact_radius
from validation.studies.zones import RATIOS

SCENE = "cycle-v0.02"
IMPRACTICAL = 1e5
"""Processor time (s) beyond which a run is named impractical: more than a day."""


INTRODUCTION = f"""# Cost over the process zone

The scene `{SCENE}` with shorter and shorter zones, at each solver's default resolution. Forecasts by the
constants of `python -m benchmarks.cost_forecast`, to a factor of three: accepted steps, processor
time on one core, memory of the run. `crosscontact study SCENE --zones` measures the same.
"""


def page() -> str:
    """A table of forecasts, and one of what each solver takes."""
    scene = load(SCENE).scene
    names = [solver.name for solver in solvers()]
    lines = [INTRODUCTION, f"| zone / radius | {' | '.join(f'`{name}`' for name in names)} |"]
    lines += ["|---" * (len(names) + 1) + "|"]
    lines += [f"| {ratio:.0e} | {' | '.join(_cells(scene, ratio))} |" for ratio in RATIOS]
    return "\n".join([*lines, "", *_refusals()]) + "\n"


def _cells(scene: Scene, ratio: float) -> Iterator[str]:
    assert scene.adhesion is not None
    asked = replace(scene, adhesion=Adhesion(scene.adhesion.work, ratio * largest_contact_radius(scene)))
    for solver in solvers():
        yield _cell(solver, asked)


def _cell(solver: Solver, scene: Scene) -> str:
    cost = solver.expected_cost(scene)
    if cost.seconds > IMPRACTICAL:
        return "impractical"
    return f"{_short(cost.steps)} steps, {_short(cost.seconds)} s, {_short(1e-6 * cost.bytes)} MB"


def _short(value: float) -> str:
    return f"{float(f'{value:.2g}'):g}"


def _refusals() -> Iterator[str]:
    """Whether each solver takes a bulk that relaxes apart from shear, and estimates its own errors."""
    separate = load("bulk-start").scene
    yield from ("| solver | method | separate bulk relaxation | error estimate |", "|---|---|---|---|")
    for solver in solvers():
        takes = "takes it" if solver.refusal(separate) is None else "refuses it"
        estimate = "its own" if solver.estimates_errors else "from a second, coarser run"
        yield f"| `{solver.name}` | {solver.title} | {takes} | {estimate} |"
