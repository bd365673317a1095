"""Every invariant fails where it does not hold: answers of the reference with one thing wrong in them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
import pytest
from support.invariants.coarse_solvers import SOLVERS, CoarseSolver
from support.invariants.table import INVARIANTS
from support.paper_scenes import SPHERE

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
    Table,
    Trace,
)

Alteration = Callable[[Scene, Trace], Trace]
RUBBER = Material(0.75, 0.5, (Branch(2.0, 1.0), Branch(1.0, 0.05)))
STICKY = Adhesion(5e-4, 0.02)


def asked(*steps, start="relaxed", at=0.01, adhesion: Adhesion | None = STICKY, machine=None) -> Scene:
    return Scene(RUBBER, SPHERE, Loading(start, at, steps, machine), adhesion)


PRESSED = asked(Ramp(0.02, 0.05), Hold(0.1), start="jump-in")
BARE = replace(PRESSED, adhesion=None)
RAMPED = asked(Ramp(0.02, 0.05))
AROUND = asked(Table((0.0, 1.0, 2.0), (0.01, 0.02, 0.01)))
SHAKEN = asked(Oscillate(0.001, 6.0, 1.0))
HELD = asked(Ramp(0.0, 0.05), at=0.02, adhesion=Adhesion(5e-4, 0.02, work_closing=2e-4))
SPRUNG = asked(Ramp(0.02, 0.05, until_force=2e-3), Ramp(0.01, 0.05), machine=Machine(0.5))
PULLED = replace(HELD, loading=replace(HELD.loading, machine=Machine(0.5)))
IN_UNITS = SHAKEN, *in_units(SHAKEN, 2.0**-30, 2.0**20, 2.0**-10)
HISTORIES = ((0.0, 1.0, 3.0), [0.01, 0.02, -0.01], [0.0, 0.02, 0.01], (0.5, -0.7))


@dataclass(frozen=True)
class AlteredSolver(CoarseSolver):
    """Answers of a true solver, changed."""

    alter: Alteration

    def solve(self, scene: Scene, **options) -> Trace:  # type: ignore[override]
        return self.alter(scene, super().solve(scene, **options))


def changed(name: str, change: Callable[[np.ndarray], np.ndarray]) -> Alteration:
    """One column of the answer changed."""

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


def last_is(value: float) -> Callable[[np.ndarray], np.ndarray]:
    return lambda column: np.append(column[:-1], value)


def times(factor: float) -> Callable[[np.ndarray], np.ndarray]:
    return lambda column: factor * column


def bent(column: np.ndarray) -> np.ndarray:
    return column + 1e-6 * column**2 / np.abs(column).max()


def underflow(scene: Scene, trace: Trace) -> Trace:
    return replace(trace, outcome=Outcome(OutcomeKind.STEP_UNDERFLOW, "arguments up", 0.0))


def one_step_more(scene: Scene, trace: Trace) -> Trace:
    return replace(trace, counters=replace(trace.counters, steps=trace.counters.steps + 1))


def when(condition: Callable[[Scene], bool], alter: Alteration) -> Alteration:
    """Only some scenes are answered wrongly."""
    return lambda scene, trace: alter(scene, trace) if condition(scene) else trace


def viscous(scene: Scene) -> bool:
    return bool(scene.material.branches)


def small(scene: Scene) -> bool:
    return scene.indenter != SPHERE


def rests(scene: Scene) -> bool:
    return isinstance(scene.loading.steps[0], Hold)


def many(scene: Scene) -> bool:
    return len(scene.material.branches) > 2


louder = times(1.05)
WRONG = [
    ("clear answer", changed("energy_release_rate", last_is(np.nan)), (RAMPED,)),
    ("clear answer", changed("time", last_is(-1.0)), (RAMPED,)),
    ("clear answer", changed("penetration", last_is(0.0199)), (RAMPED,)),
    ("clear answer", underflow, (RAMPED,)),
    ("instrument: clear answer", changed("stage", last_is(np.nan)), (SPRUNG,)),
    ("instrument: clear answer", underflow, (SPRUNG,)),
    ("budget", one_step_more, (PRESSED, 5)),
    ("interface", changed("separation_energy", louder), (HELD,)),
    ("interface", changed("dissipated_energy", louder), (HELD,)),
    ("instrument: interface", changed("separation_energy", louder), (PULLED,)),
    ("instrument: interface", changed("dissipated_energy", louder), (PULLED,)),
    ("energy gained", changed("branch_dissipation", np.negative), (PRESSED,)),
    ("energy gained", changed("stored_energy", lambda u: u - 1.1 * u.max()), (PRESSED,)),
    ("energy gained", changed("dissipated_energy", np.negative), (BARE,)),
    ("energy balance", changed("branch_dissipation", louder), (AROUND,)),
    ("energy balance", changed("external_work", louder), (PRESSED,)),
    ("energy balance", changed("stress_intensity_factor", louder), (AROUND,)),
    ("instrument: energy balance", changed("external_work", louder), (SPRUNG,)),
    ("instrument: energy balance", changed("machine_energy", np.zeros_like), (SPRUNG,)),
    ("touch", profiles("pressure", lambda p: p - 1e-9 * p.max()), (PRESSED,)),
    ("touch", profiles("gap", lambda g: g + 1e-9 * g.max()), (PRESSED,)),
    ("touch", profiles("gap", np.negative), (PRESSED,)),
    ("slow limit", when(viscous, changed("force", louder)), (PRESSED, 0.015)),
    ("fast limit", when(viscous, changed("contact_radius", louder)), (PRESSED, 0.015)),
    ("closed cycle", changed("external_work", np.negative), (AROUND,)),
    ("closed cycle", changed("branch_dissipation", np.zeros_like), (AROUND,)),
    ("units", when(small, changed("force", times(1.0 + 1e-8))), IN_UNITS),
    ("units", when(small, changed("stored_energy", times(1.0 + 1e-8))), IN_UNITS),
    ("units", when(small, changed("time", last_is(1.0))), IN_UNITS),
    ("rest", when(rests, changed("force", louder)), (RAMPED, 3.0)),
    ("superposition", changed("force", bent), (RUBBER, HISTORIES, "relaxed")),
    ("no weight", when(many, changed("force", times(1.0 + 1e-15))), (PRESSED, 1.0, 1)),
]
"""Invariant, what is wrong, and the arguments it is asked with."""


@pytest.mark.slow
@pytest.mark.parametrize(("name", "alter", "arguments"), WRONG)
def test_an_invariant_holds_for_true_answers_and_not_for_altered_ones(name, alter, arguments):
    true, check = SOLVERS["reference"], INVARIANTS[name].check
    check(true, *arguments)
    with pytest.raises(AssertionError):
        check(AlteredSolver(true.name, true.resolution, true.order, alter), *arguments)


def test_every_invariant_is_here():
    assert {name for name, *_ in WRONG} == set(INVARIANTS)
