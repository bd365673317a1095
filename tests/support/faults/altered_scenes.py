"""What reaches a solver is not quite the scene: one table of faults for all solvers.

Each changes the question in one place, by amounts from a thousandth to a tenth, or in one regime only: what
the solver then answers is what a small slip in its own code would give. The scenes named with a fault are
the cheapest of the quick suite that show its regime.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from support.faults.injection import Fault, registry

from contact_scene import (
    Branch,
    Cone,
    Force,
    ForceRamp,
    Hold,
    Loading,
    Material,
    Scene,
    Step,
    Table,
    TabulatedProfile,
)

ENTRANCES = {
    "bem": ("bem_solver", "solver:solve"),
    "fem": ("fem_solver", "solver:solve"),
    "reference": ("validation.reference.path", "solver:solve"),
}
"""Package and function by which a scene enters each solver."""


@dataclass(frozen=True)
class Alteration:
    """A change of the scene, and the built-in scenes that have to show it."""

    name: str
    change: Callable[[Scene], Scene]
    scenes: tuple[str, ...]


def _material(change: Callable[[Material], Material]) -> Callable[[Scene], Scene]:
    return lambda scene: replace(scene, material=change(scene.material))


def _branches(change: Callable[[Branch], Branch]) -> Callable[[Scene], Scene]:
    return _material(lambda m: replace(m, branches=tuple(change(branch) for branch in m.branches)))


def _steps(kind: type[Step], change: Callable[[Step], Step]) -> Callable[[Scene], Scene]:
    def changed(loading: Loading) -> Loading:
        steps = tuple(change(step) if isinstance(step, kind) else step for step in loading.steps)
        return replace(loading, steps=steps)

    return lambda scene: replace(scene, loading=changed(scene.loading))


def _zone(change: Callable[[float], float]) -> Callable[[Scene], Scene]:
    def changed(scene: Scene) -> Scene:
        adhesion = scene.adhesion
        return replace(scene, adhesion=adhesion and replace(adhesion, zone=change(adhesion.zone)))

    return changed


def _joined(scene: Scene) -> Scene:
    """Branches within a quarter of each other in time become one, of the first of the times."""
    joined: list[Branch] = []
    for branch in sorted(scene.material.branches, key=lambda b: b.time):
        if joined and branch.time < 1.25 * joined[-1].time:
            joined[-1] = Branch(joined[-1].modulus + branch.modulus, joined[-1].time)
        else:
            joined.append(branch)
    return replace(scene, material=replace(scene.material, branches=tuple(joined)))


def _straightened(scene: Scene) -> Scene:
    """Straight lines between the rows of a table of heights."""
    profile = scene.indenter
    if not isinstance(profile, TabulatedProfile):
        return scene
    fine = np.linspace(0.0, profile.radii[-1], 12 * len(profile.radii))
    coarse = np.array(profile.radii[::3])
    heights = np.interp(fine, coarse, profile.height(coarse))
    return replace(scene, indenter=TabulatedProfile(tuple(fine.tolist()), tuple(heights.tolist())))


def _sharper(scene: Scene) -> Scene:
    cone = scene.indenter
    return replace(scene, indenter=Cone(cone.half_angle - 0.5)) if isinstance(cone, Cone) else scene


def _not_repressed(scene: Scene) -> Scene:
    """A table that turns back goes straight on from its first deepest row to the last one."""

    def smoothed(step: Table) -> Table:
        inner = [i for i, depth in enumerate(step.values) if i == 0 or depth >= max(step.values[:i])]
        kept = sorted({*inner, len(step.times) - 1})
        return Table(tuple(step.times[i] for i in kept), tuple(step.values[i] for i in kept))

    return _steps(Table, smoothed)(scene)  # type: ignore[arg-type]


PUNCH, CONE, PULLED = ("punch-programme",), ("cone-force-ramp",), ("cone-pull",)
ALTERATIONS = (
    Alteration("relaxation times 1 % too long", _branches(lambda b: Branch(b.modulus, 1.01 * b.time)), PUNCH),
    Alteration("branches 0.5 % too stiff", _branches(lambda b: Branch(1.005 * b.modulus, b.time)), PUNCH),
    Alteration(
        "relaxed modulus 1 % too stiff", _material(lambda m: replace(m, modulus=1.01 * m.modulus)), PUNCH
    ),
    Alteration("relaxation times close together joined", _joined, PUNCH),
    Alteration(
        "branches shorter than a thousandth left out",
        _material(lambda m: replace(m, branches=tuple(b for b in m.branches if b.time > 1e-3))),
        PUNCH,
    ),
    Alteration(
        "branches faster than the steps taken for slow ones",
        _branches(lambda b: Branch(b.modulus, max(b.time, 0.02))),
        PUNCH,
    ),
    Alteration("holds 3 % too long", _steps(Hold, lambda s: Hold(1.03 * s.duration)), PUNCH),
    Alteration("forces 0.5 % too large", _steps(Force, lambda s: Force(1.005 * s.value, s.duration)), PUNCH),
    Alteration(
        "force ramps 3 % too fast",
        _steps(ForceRamp, lambda s: ForceRamp(s.to, 1.03 * s.rate)),
        (*PUNCH, *CONE),
    ),
    Alteration(
        "tables 2 % too slow",
        _steps(Table, lambda s: Table(tuple(1.02 * t for t in s.times), s.values)),
        PUNCH,
    ),
    Alteration("cones half a degree too sharp", _sharper, CONE),
    Alteration(
        "process zone longer by a length of 1e-6", _zone(lambda zone: zone + 1e-6), ("cycle-si-small",)
    ),
    Alteration("process zone 3 % too long", _zone(lambda zone: 1.03 * zone), ("elastic-glassy", *PULLED)),
    Alteration(
        "process zone 1 % too short", _zone(lambda zone: 0.99 * zone), ("elastic-glassy", "rated-edge-si")
    ),
    Alteration(
        "work of adhesion 0.3 % too large",
        lambda s: replace(s, adhesion=s.adhesion and replace(s.adhesion, work=1.003 * s.adhesion.work)),
        ("elastic-relaxed",),
    ),
    Alteration("measured profile by straight lines", _straightened, ("repressed-profile",)),
    Alteration("an edge that turned goes on as if it had not", _not_repressed, ("repressed-profile",)),
)


def _registered() -> list[Fault]:
    faults: list[Fault] = []
    for solver, (package, entrance) in ENTRANCES.items():
        _, fault = registry(solver, package, faults)
        for alteration in ALTERATIONS:
            fault(alteration.name, entrance, alteration.scenes)(_asked_of_another_scene(alteration.change))
    return faults


def _asked_of_another_scene(change: Callable[[Scene], Scene]) -> Callable[[Callable], Callable]:
    return lambda true: lambda scene, *others, **named: true(change(scene), *others, **named)


FAULTS = _registered()
