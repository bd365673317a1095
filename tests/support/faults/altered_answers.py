"""What leaves a solver is not quite what it found: one table of faults for all solvers, 0.3 to 10 %."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from support.faults.altered_scenes import ENTRANCES
from support.faults.injection import Fault, registry

from contact_scene import Scene, Trace

Alteration = Callable[[Scene, Trace], Trace]


@dataclass(frozen=True)
class AlteredAnswer:
    """A change of the trace, and the built-in scenes that have to show it."""

    name: str
    change: Alteration
    scenes: tuple[str, ...]


def _column(name: str, change: Callable[[np.ndarray], np.ndarray]) -> Alteration:
    def changed(scene: Scene, trace: Trace) -> Trace:
        column = change(trace.columns()[name].copy())
        if name in trace.extra:
            return replace(trace, extra=trace.extra | {name: column})
        return replace(trace, **{name: column})

    return changed


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


def _delayed(scene: Scene, trace: Trace) -> Trace:
    """Forces one row late."""
    return replace(trace, force=np.concatenate((trace.force[:1], trace.force[:-1])))


PUNCH, GLASSY = ("punch-programme",), ("elastic-glassy",)
ANSWERS = (
    AlteredAnswer("contact given up half a zone too early", _given_up_early, ("elastic-relaxed", *GLASSY)),
    AlteredAnswer("forces 0.5 % too large", _column("force", lambda f: 1.005 * f), PUNCH),
    AlteredAnswer(
        "tensions 1 % too small", _column("force", lambda f: np.where(f < 0.0, 0.99 * f, f)), GLASSY
    ),
    AlteredAnswer(
        "radii 0.5 % too small", _column("contact_radius", lambda a: 0.995 * a), ("relaxed-equilibrium",)
    ),
    AlteredAnswer("penetrations 0.3 % too small", _column("penetration", lambda d: 0.997 * d), PUNCH),
    AlteredAnswer("forces one row late", _delayed, PUNCH),
    AlteredAnswer("external work 2 % too small", _column("external_work", lambda w: 0.98 * w), PUNCH),
    AlteredAnswer(
        "branches dissipate 3 % too much", _column("branch_dissipation", lambda e: 1.03 * e), PUNCH
    ),
    AlteredAnswer("losses 3 % too small", _column("dissipated_energy", lambda e: 0.97 * e), PUNCH),
)


def _registered() -> list[Fault]:
    faults: list[Fault] = []
    for solver, (package, entrance) in ENTRANCES.items():
        _, fault = registry(solver, package, faults)
        for altered in ANSWERS:
            fault(f"answer: {altered.name}", entrance, altered.scenes)(_altered(altered.change))
    return faults


def _altered(change: Alteration) -> Callable[[Callable], Callable]:
    return lambda true: lambda scene, *others, **named: change(scene, true(scene, *others, **named))


FAULTS = _registered()
