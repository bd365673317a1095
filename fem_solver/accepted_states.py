"""States that a run accepts, one row each, the ends that a state may bring, and what takes a step back.

Penetration is positive downwards, force positive in compression.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any, NoReturn

import numpy as np
from numpy.typing import NDArray

from contact_scene import Counters, LoadingCursor, Outcome, OutcomeKind, RunMonitor
from contact_scene.loading import Control
from contact_scene.run_control import below_zone_outcome, budget_outcome, outgrown_outcome
from fem_solver.contact_problem import ContactCandidate
from fem_solver.edge import AdhesiveEdge, IrreversibleEdge, energy_spent
from fem_solver.edge_geometry import EdgeMotion
from fem_solver.edge_search import ContactSolver
from fem_solver.events import zone_reached
from fem_solver.recorder import RowBefore, SurfaceRecorder, SurfaceState
from fem_solver.setup import Setup
from fem_solver.state import ComponentState
from fem_solver.step_control import DyadicInterval, SlopeErrorEstimator


@dataclass(frozen=True)
class StepBefore:
    """What it needs to take the last step back, which lies in the present interval and brought no event.

    Parameters
    ----------
    time : float
        At its begin.
    position : int
        There, within the interval.
    slopes : dict of str to float
        Of the step before it.
    row : RowBefore
    history : ComponentState
    """

    time: float
    position: int
    slopes: dict[str, float]
    row: RowBefore
    history: ComponentState


@dataclass(frozen=True)
class StepCandidate:
    """Result of a trial step; ``error`` is relative to the allowed one, infinite without equilibrium."""

    contact: ContactCandidate
    slopes: dict[str, float]
    error: float


@dataclass(frozen=True)
class TensionPeak:
    """Rates at which the tension rises to the last row and falls behind it, and what rows may miss of it."""

    rise: float
    fall: float
    allowed: float


Array = NDArray[np.float64]


class RunEnded(Exception):
    """The run ends before its loading does."""

    def __init__(self, outcome: Outcome) -> None:
        super().__init__(outcome.reason)
        self.outcome = outcome


@dataclass
class AcceptedStates:
    """What a run holds, and how a state becomes part of it.

    Parameters
    ----------
    setup : Setup
    recorder : SurfaceRecorder
    estimator : SlopeErrorEstimator
    force_scale : callable(float, float, float) -> float
        Force to which errors of the force are relative, at a force, its singular part and a contact radius.
    max_steps : int
        Budget of trial steps.
    requested : frozenset of float
        Times stepped onto beside kinks and ends of load steps.
    on_stop : callable(float)
        Called at the start and at every stop.
    on_commit : callable(float, ndarray)
        Called after every accepted step with its length and nodal forces.
    on_take_back : callable()
        Called after the last step has been taken back.
    monitor : RunMonitor or None
    progress : callable(float) or None
    """

    setup: Setup
    recorder: SurfaceRecorder
    estimator: SlopeErrorEstimator
    force_scale: Callable[[float, float, float], float]
    max_steps: int
    requested: frozenset[float]
    on_stop: Callable[[float], None]
    on_commit: Callable[[float, Array], None]
    on_take_back: Callable[[], None]
    monitor: RunMonitor | None = None
    progress: Callable[[float], None] | None = None
    cursor: LoadingCursor = field(default_factory=LoadingCursor)
    counters: Counters = field(default_factory=Counters)
    time: float = 0.0
    interval: DyadicInterval | None = None
    step: float | None = None
    before: StepBefore | None = None

    def __post_init__(self) -> None:
        self.solver = ContactSolver(self.setup, self.counters)

    @property
    def state(self) -> SurfaceState:
        """The last accepted state."""
        return self.recorder.last

    @property
    def _has_rate(self) -> bool:
        """Whether the energy that an opening edge takes up follows its speed."""
        law = self.setup.law
        return isinstance(law, IrreversibleEdge) and law.adhesion.rate is not None

    def _check_budget(self) -> None:
        outcome = budget_outcome(self.counters, self.max_steps, self.time)
        outcome = outcome or outgrown_outcome(self.setup.body, self.state.radius, self.time)
        if outcome is not None:
            raise RunEnded(outcome)

    def _commit(self, candidate: ContactCandidate, contact: bool = True, bent: float = 0.0) -> None:
        """Accept a state, in contact or free: history, row, counters; ``bent`` as of a surface state."""
        forces = candidate.problem.forces(candidate.edge.s)
        penetration, force, radius = candidate.penetration, candidate.force, self.solver.radius(candidate)
        if not (np.isfinite(forces).all() and all(map(math.isfinite, (penetration, force, radius)))):
            self._end(OutcomeKind.NOT_FINITE, "a force or a radius is not finite")
        history = self.setup.history
        received = self.solver.accept(candidate)
        self.on_commit(candidate.dt, forces)
        self.counters.steps += self.recorder.content.last is not None
        self.recorder.add(
            SurfaceState(
                time=self.time,
                penetration=penetration,
                force=force,
                radius=radius,
                edge=candidate.edge.s,
                forces=forces,
                displacement=history.displacement,
                stored=history.stored_energy,
                interface=history.interface_energy,
                branch_dissipation=history.state.dissipated,
                zone=candidate.problem.zone(candidate.edge.s),
                received=received,
                smooth="force" in self.estimator.slopes,
                bent=bent,
                singular_force=candidate.singular_force,
                **self._interface(candidate, radius),
            )
        )
        if contact and self.setup.geometry.stress is not None and self.state.zone >= radius:
            forces_so_far = [row[2] for row in self.recorder.content.rows]
            raise RunEnded(below_zone_outcome(forces_so_far, self.time))

    def _interface(self, candidate: ContactCandidate, radius: float) -> dict[str, Any]:
        """Closure, energy spent and rate of the edge, where they do not follow from the contact radius."""
        law, last = self.setup.law, self.recorder.content.last
        if not isinstance(law, IrreversibleEdge):
            return {}
        closure = candidate.problem.closure(candidate.edge.s) if radius > 0.0 else 0.0
        if last is None:
            return {"closure": closure}
        dt = candidate.dt
        spent = energy_spent(law.adhesion, (last.radius, radius), (last.closure, closure))
        rate = (radius - last.radius) / dt if dt > 0.0 else 0.0
        return {"closure": closure, "spent": last.spent + spent, "rate": rate, "duration": dt}

    def _contact_lost(self, candidate: ContactCandidate) -> NoReturn:
        """No equilibrium: the contact outgrows the mesh, or is lost."""
        geometry = self.setup.geometry
        if candidate.edge.motion is EdgeMotion.ADVANCING:
            reached = geometry.radius(candidate.edge.s)
            reason = f"the contact grows beyond the radius {reached:.6g} the mesh is made for"
            self._end(OutcomeKind.OUT_OF_RANGE, reason)
        control = candidate.problem.control
        if geometry.zone is None:
            self._last_touch(candidate.dt, control, candidate.problem.value)
        self._pulled_off(control)

    def _last_touch(self, dt: float, control: Control, value: float) -> None:
        """The row of the last touch without adhesion: a point, or a plane tip.

        A blunt profile keeps a radius within the shortest step of that.
        """
        value = 0.0 if control == "force" else value
        self.time += dt
        plane = self.solver.plane_contact(dt, "force", 0.0)  # bears nothing as it is let go
        self._commit(plane or self.solver.held(dt, control, value, 0.0))

    def _pulled_off(self, control: Control) -> NoReturn:
        geometry = self.setup.geometry
        self.recorder.event("pull-off", 0.5 * geometry.spacing if geometry.zone is not None else 0.0)
        reason = f"contact lost at penetration {self.state.penetration:.6g}"
        # the spring takes the indenter to where the stage is; a given force takes the stage along
        if self.setup.compliance > 0.0 and control != "force":
            stage = self.state.penetration + self.setup.compliance * self.state.force
            self._commit(self.solver.held(0.0, "stage", stage, 0.0), contact=False)
        self._end(OutcomeKind.DETACHED, reason)

    def _below_zone(self, candidate: ContactCandidate) -> bool:
        zone = self.setup.geometry.zone
        return zone is not None and self.solver.radius(candidate) < zone

    def _end_at_zone(self, load: Callable[[float], tuple[float, Control, float]]) -> NoReturn:
        """End with the row at which the contact is as short as its process zone (see ``zone_reached``)."""
        law = self.setup.law
        assert isinstance(law, AdhesiveEdge)
        reached = zone_reached(self.solver, law.taken, load)
        if reached is None:
            self._pulled_off(load(0.0)[1])
        self.time += reached.dt
        self._commit(reached)
        forces = [row[2] for row in self.recorder.content.rows]
        raise RunEnded(below_zone_outcome(forces, self.time))

    def _end(self, kind: OutcomeKind, reason: str) -> NoReturn:
        raise RunEnded(Outcome(kind, reason, self.time))
