"""What reaches a solver is not quite the scene, what leaves it not quite its answer: for all solvers alike.

A fault changes the question or the answer in one place, by amounts from a thousandth to a tenth, or in one
regime only, as a small slip in the solver's own code would. The scenes named with it are the cheapest of the
quick suite that show its regime.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
from support.faults.injection import by, changed, table

from contact_scene import Branch, Cone, Force, ForceRamp, Hold, Scene, Step, Table, TabulatedProfile, Trace

ENTRANCES = {"bem": "bem_solver", "fem": "fem_solver", "reference": "validation.reference.path"}
"""Package whose ``solver.solve`` takes the scene."""
AsScene = Callable[[Scene], Scene]
AsTrace = Callable[[Scene, Trace], Trace]
PUNCH, CONE, GLASSY, RELAXED = "punch-programme", "cone-force-ramp", "elastic-glassy", "elastic-relaxed"
PROFILE = "repressed-profile"


def _material(**changes: Callable) -> AsScene:
    return changed(material=changed(**changes))


def _branches(**changes: Callable) -> AsScene:
    return _material(branches=lambda branches: tuple(map(changed(**changes), branches)))


def _adhesion(**changes: Callable) -> AsScene:
    return changed(adhesion=lambda adhesion: adhesion and changed(**changes)(adhesion))


def _steps(kind: type[Step], change: Callable[[Step], Step]) -> AsScene:
    def of(steps: tuple[Step, ...]) -> tuple[Step, ...]:
        return tuple(change(step) if isinstance(step, kind) else step for step in steps)

    return changed(loading=changed(steps=of))


def _joined(branches: tuple[Branch, ...]) -> tuple[Branch, ...]:
    """Branches within a quarter of each other in time become one, of the first of the times."""
    joined: list[Branch] = []
    for branch in sorted(branches, key=lambda b: b.time):
        if joined and branch.time < 1.25 * joined[-1].time:
            joined[-1] = Branch(joined[-1].modulus + branch.modulus, joined[-1].time)
        else:
            joined.append(branch)
    return tuple(joined)


def _straightened(profile):
    """Straight lines between the rows of a table of heights."""
    if not isinstance(profile, TabulatedProfile):
        return profile
    fine = np.linspace(0.0, profile.radii[-1], 12 * len(profile.radii))
    coarse = np.array(profile.radii[::3])
    heights = np.interp(fine, coarse, profile.height(coarse))
    return TabulatedProfile(tuple(fine.tolist()), tuple(heights.tolist()))


def _not_repressed(step: Table) -> Table:
    """A table that turns back goes straight on from its first deepest row to the last one."""
    inner = [i for i, depth in enumerate(step.values) if i == 0 or depth >= max(step.values[:i])]
    kept = sorted({*inner, len(step.times) - 1})
    return Table(tuple(step.times[i] for i in kept), tuple(step.values[i] for i in kept))


SCENES: list[tuple] = [
    ("relaxation times 1 % too long", _branches(time=by(1.01)), PUNCH),
    ("branches 0.5 % too stiff", _branches(modulus=by(1.005)), PUNCH),
    ("relaxed modulus 1 % too stiff", _material(modulus=by(1.01)), PUNCH),
    ("relaxation times close together joined", _material(branches=_joined), PUNCH),
    ("branches shorter than a thousandth left out",
     _material(branches=lambda branches: tuple(b for b in branches if b.time > 1e-3)), PUNCH),
    ("branches faster than the steps taken for slow ones", _branches(time=lambda t: max(t, 0.02)), PUNCH),
    ("holds 3 % too long", _steps(Hold, changed(duration=by(1.03))), PUNCH),
    ("forces 0.5 % too large", _steps(Force, changed(value=by(1.005))), PUNCH),
    ("force ramps 3 % too fast", _steps(ForceRamp, changed(rate=by(1.03))), PUNCH, CONE),
    ("tables 2 % too slow", _steps(Table, changed(times=lambda times: tuple(map(by(1.02), times)))), PUNCH),
    ("cones half a degree too sharp",
     changed(indenter=lambda one: Cone(one.half_angle - 0.5) if isinstance(one, Cone) else one), CONE),
    ("process zone longer by a length of 1e-6", _adhesion(zone=lambda zone: zone + 1e-6), "cycle-si-small"),
    ("process zone 3 % too long", _adhesion(zone=by(1.03)), GLASSY, "cone-pull"),
    ("process zone 1 % too short", _adhesion(zone=by(0.99)), GLASSY, "rated-edge-si"),
    ("work of adhesion 0.3 % too large", _adhesion(work=by(1.003)), RELAXED),
    ("measured profile by straight lines", changed(indenter=_straightened), PROFILE),
    ("an edge that turned goes on as if it had not", _steps(Table, _not_repressed), PROFILE),
]  # fmt: skip
"""Name, change of the scene, and the built-in scenes that have to show it."""


def _column(name: str, change: Callable[[np.ndarray], np.ndarray]) -> AsTrace:
    def of(scene: Scene, trace: Trace) -> Trace:
        column = change(trace.columns()[name].copy())
        if name in trace.extra:
            return replace(trace, extra=trace.extra | {name: column})
        return replace(trace, **{name: column})

    return of


def _given_up_early(scene: Scene, trace: Trace) -> Trace:
    """Contact counts as lost half a zone before the last radius."""
    touching = np.flatnonzero(trace.contact_radius > 0.0)
    if scene.adhesion is None or touching.size == 0:
        return trace
    least = trace.contact_radius[touching[-1]] + 0.5 * scene.adhesion.zone
    kept = slice(0, int(np.flatnonzero(trace.contact_radius >= least)[-1]) + 1)
    columns = {name: column[kept] for name, column in trace.columns().items() if name not in trace.extra}
    extra = {name: column[kept] for name, column in trace.extra.items()}
    end = replace(trace.outcome, time=float(trace.time[kept][-1]))
    return replace(trace, **columns, extra=extra, events=(), profiles=(), outcome=end)


ANSWERS: list[tuple] = [
    ("contact given up half a zone too early", _given_up_early, RELAXED, GLASSY),
    ("forces 0.5 % too large", _column("force", by(1.005)), PUNCH),
    ("tensions 1 % too small", _column("force", lambda f: np.where(f < 0.0, 0.99 * f, f)), GLASSY),
    ("radii 0.5 % too small", _column("contact_radius", by(0.995)), "relaxed-equilibrium"),
    ("penetrations 0.3 % too small", _column("penetration", by(0.997)), PUNCH),
    ("forces one row late", _column("force", lambda f: np.concatenate((f[:1], f[:-1]))), PUNCH),
    ("external work 2 % too small", _column("external_work", by(0.98)), PUNCH),
    ("branches dissipate 3 % too much", _column("branch_dissipation", by(1.03)), PUNCH),
    ("losses 3 % too small", _column("dissipated_energy", by(0.97)), PUNCH),
]
"""Name, change of the trace, and the built-in scenes that have to show it."""


def _asked(change: AsScene) -> Callable[[Callable], Callable]:
    return lambda true: lambda scene, *others, **named: true(change(scene), *others, **named)


def _answered(change: AsTrace) -> Callable[[Callable], Callable]:
    return lambda true: lambda scene, *others, **named: change(scene, true(scene, *others, **named))


ROWS = [(name, "solver:solve", _asked(change), *shown) for name, change, *shown in SCENES]
ROWS += [(f"answer: {name}", "solver:solve", _answered(change), *shown) for name, change, *shown in ANSWERS]
FAULTS = [fault for solver, package in ENTRANCES.items() for fault in table(solver, package, ROWS)]
