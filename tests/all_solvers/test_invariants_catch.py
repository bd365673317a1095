"""Every invariant fails for a solver that breaks it: front tracking with one thing wrong in its answers."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
import pytest
from support.invariants.coarse_solvers import SOLVERS, CoarseSolver
from support.invariants.table import INVARIANTS

from benchmarks.strategies import in_units
from contact_scene import (
    Adhesion,
    Branch,
    Hold,
    Loading,
    Machine,
    Material,
    Oscillate,
    Outcome,
    OutcomeKind,
    Ramp,
    Scene,
    Sphere,
    Table,
    Trace,
)

pytestmark = pytest.mark.slow

Alteration = Callable[[Scene, Trace], Trace]
RUBBER = Material(0.75, 0.5, (Branch(2.0, 1.0), Branch(1.0, 0.05)))
STICKY = Adhesion(5e-4, 0.02)
PRESSED = Scene(RUBBER, Sphere(1.0), Loading("jump-in", 0.01, (Ramp(0.02, 0.05), Hold(0.1))), STICKY)
RAMPED = replace(PRESSED, loading=Loading("relaxed", 0.01, (Ramp(0.02, 0.05),)))
BARE = replace(PRESSED, adhesion=None)
AROUND = replace(PRESSED, loading=Loading("relaxed", 0.01, (Table((0.0, 1.0, 2.0), (0.01, 0.02, 0.01)),)))
SHAKEN = replace(PRESSED, loading=Loading("relaxed", 0.01, (Oscillate(0.001, 6.0, 1.0),)))
HELD = replace(
    PRESSED,
    loading=Loading("relaxed", 0.02, (Ramp(0.0, 0.05),)),
    adhesion=Adhesion(5e-4, 0.02, work_closing=2e-4),
)
TURNED = Loading("relaxed", 0.01, (Ramp(0.02, 0.05, until_force=2e-3), Ramp(0.01, 0.05)), Machine(0.5))
SPRUNG = replace(PRESSED, loading=TURNED)
PULLED = replace(HELD, loading=replace(HELD.loading, machine=Machine(0.5)))
OTHER_UNITS = (2.0**-30, 2.0**20, 2.0**-10)  # of length, modulus and time
HISTORIES = ((0.0, 1.0, 3.0), [0.01, 0.02, -0.01], [0.0, 0.02, 0.01], (0.5, -0.7))


@dataclass(frozen=True)
class AlteredSolver(CoarseSolver):
    """Answers of a true solver, changed."""

    alter: Alteration = lambda scene, trace: trace

    def solve(self, scene: Scene, **asked) -> Trace:  # type: ignore[override]
        """The true answer, altered."""
        return self.alter(scene, super().solve(scene, **asked))


class UnboundedSolver(AlteredSolver):
    """Ignores its step budget."""

    def solve(self, scene: Scene, budget: int = 0, **asked) -> Trace:  # type: ignore[override]
        """As if there were none."""
        return super().solve(scene, **asked)


def changed(name: str, change: Callable[[np.ndarray], np.ndarray]) -> Alteration:
    """One column of every answer changed."""

    def alter(scene: Scene, trace: Trace) -> Trace:
        column = change(trace.columns()[name].copy())
        if name in trace.extra:
            return replace(trace, extra=trace.extra | {name: column})
        return replace(trace, **{name: column})

    return alter


def profiles(name: str, change: Callable[[np.ndarray], np.ndarray]) -> Alteration:
    """One array of every profile changed."""
    return lambda scene, trace: replace(
        trace, profiles=tuple(replace(p, **{name: change(getattr(p, name).copy())}) for p in trace.profiles)
    )


def when(condition: Callable[[Scene], bool], alter: Alteration) -> Alteration:
    """Only some scenes are answered wrongly."""
    return lambda scene, trace: alter(scene, trace) if condition(scene) else trace


def last_is(value: float) -> Callable[[np.ndarray], np.ndarray]:
    def change(column: np.ndarray) -> np.ndarray:
        column[-1] = value
        return column

    return change


def underflow(scene: Scene, trace: Trace) -> Trace:
    return replace(trace, outcome=Outcome(OutcomeKind.STEP_UNDERFLOW, "arguments up", 0.0))


def louder(column: np.ndarray) -> np.ndarray:
    return 1.05 * column


def bent(column: np.ndarray) -> np.ndarray:
    return column + 1e-6 * column**2 / np.abs(column).max()


def many(scene: Scene) -> bool:
    return len(scene.material.branches) > 2


def small(scene: Scene) -> bool:
    return isinstance(scene.indenter, Sphere) and scene.indenter.radius < 1e-3


BROKEN: dict[str, list[tuple[Alteration, tuple]]] = {
    "clear answer": [
        (changed("energy_release_rate", last_is(np.nan)), (RAMPED,)),
        (changed("time", last_is(-1.0)), (RAMPED,)),
        (changed("penetration", last_is(0.0199)), (RAMPED,)),
        (underflow, (RAMPED,)),
    ],
    "interface": [
        (changed("separation_energy", louder), (HELD,)),
        (changed("dissipated_energy", louder), (HELD,)),
    ],
    "instrument: clear answer": [
        (changed("stage", last_is(np.nan)), (SPRUNG,)),
        (underflow, (SPRUNG,)),
    ],
    "instrument: energy balance": [
        (changed("external_work", louder), (SPRUNG,)),
        (changed("machine_energy", np.zeros_like), (SPRUNG,)),
    ],
    "instrument: interface": [
        (changed("separation_energy", louder), (PULLED,)),
        (changed("dissipated_energy", louder), (PULLED,)),
    ],
    "energy gained": [
        (changed("branch_dissipation", np.negative), (PRESSED,)),
        (changed("stored_energy", lambda u: u - 1.1 * u.max()), (PRESSED,)),
        (changed("dissipated_energy", np.negative), (BARE,)),
    ],
    "energy balance": [
        (changed("branch_dissipation", louder), (AROUND,)),
        (changed("external_work", louder), (PRESSED,)),
        (changed("stress_intensity_factor", louder), (AROUND,)),
    ],
    "touch": [
        (profiles("pressure", lambda p: p - 1e-9 * p.max()), (PRESSED,)),
        (profiles("gap", lambda g: g + 1e-9 * g.max()), (PRESSED,)),
        (profiles("gap", np.negative), (PRESSED,)),
    ],
    "slow limit": [(when(lambda s: bool(s.material.branches), changed("force", louder)), (PRESSED, 0.015))],
    "fast limit": [
        (when(lambda s: bool(s.material.branches), changed("contact_radius", louder)), (PRESSED, 0.015))
    ],
    "closed cycle": [
        (changed("external_work", np.negative), (AROUND,)),
        (changed("branch_dissipation", np.zeros_like), (AROUND,)),
    ],
    "units": [
        (when(small, changed("force", lambda f: f * (1.0 + 1e-8))), (SHAKEN, *OTHER_UNITS)),
        (when(small, changed("stored_energy", lambda u: u * (1.0 + 1e-8))), (SHAKEN, *OTHER_UNITS)),
        (when(small, changed("time", last_is(1.0))), (SHAKEN, *OTHER_UNITS)),
    ],
    "rest": [
        (when(lambda s: isinstance(s.loading.steps[0], Hold), changed("force", louder)), (RAMPED, 3.0)),
    ],
    "superposition": [(changed("force", bent), (RUBBER, HISTORIES, "relaxed"))],
    "no weight": [(when(many, changed("force", lambda f: f * (1.0 + 1e-15))), (PRESSED, 1.0, 1))],
}


def with_units(name: str, arguments: tuple) -> tuple:
    return (arguments[0], *in_units(*arguments)) if name == "units" else arguments


@pytest.mark.parametrize("name", BROKEN)
def test_invariant_holds_for_the_true_answers_and_not_for_spoiled_ones(name: str) -> None:
    true = SOLVERS["reference"]
    invariant = INVARIANTS[name].check
    for alter, arguments in BROKEN[name]:
        invariant(true, *with_units(name, arguments))
        altered = AlteredSolver(true.name, true.resolution, true.order, alter)
        with pytest.raises(AssertionError):
            invariant(altered, *with_units(name, arguments))


def test_a_step_budget_that_is_exceeded_fails() -> None:
    true = SOLVERS["reference"]
    invariant = INVARIANTS["budget"].check
    invariant(true, PRESSED, 5)
    with pytest.raises(AssertionError):
        invariant(UnboundedSolver(true.name, true.resolution, true.order), PRESSED, 5)


def test_every_invariant_is_here() -> None:
    assert {*BROKEN, "budget"} == set(INVARIANTS)
