"""States that a run accepts, one row each, and the ends that a state may bring.

Penetration is positive downwards, force positive in compression.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field
from functools import partial
from typing import Any, NoReturn, cast

import numpy as np
from numpy.typing import NDArray

from contact_scene import Counters, LoadingCursor, Outcome, OutcomeKind, RunMonitor
from contact_scene.loading import Control
from contact_scene.run_control import below_zone_outcome, budget_outcome
from fem_solver.contact_solver import ContactCandidate, ContactSolver
from fem_solver.edge import AdhesiveEdge, EdgeMotion
from fem_solver.edge_geometry import EdgeOrigin
from fem_solver.events import zone_reached
from fem_solver.following.contact_solver import FollowingContactSolver
from fem_solver.following.setup import FollowingSetup
from fem_solver.irreversible_edge import IrreversibleEdge, energy_spent
from fem_solver.limit_point import LimitPoint, limit_point
from fem_solver.recorder import SurfaceRecorder, SurfaceState
from fem_solver.run_state import StepBefore
from fem_solver.setup import Setup
from fem_solver.step_control import DyadicInterval, SlopeErrorEstimator
from fem_solver.tip_release import LARGEST_STEP, release_of_tip

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
    setup : Setup or FollowingSetup
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

    setup: Setup | FollowingSetup
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
        self.solver: ContactSolver
        if isinstance(self.setup, FollowingSetup):
            following = FollowingContactSolver(self.setup, self.counters)
            self.solver = following  # type: ignore[assignment] # another class with the same methods
        else:
            # not a method of its own: a run that holds itself stays until the garbage collection
            origin = partial(_edge_origin, self.recorder, self.estimator)
            self.solver = ContactSolver(self.setup, self.counters, origin)

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
        if outcome is not None:
            raise RunEnded(outcome)

    def _commit(self, candidate: ContactCandidate, contact: bool = True, bent: float = 0.0) -> None:
        """Accept a state, in contact or free: history, row, counters; ``bent`` as of a surface state."""
        forces = candidate.problem.forces(candidate.edge.s)
        penetration, force, radius = candidate.penetration, candidate.force, self.solver.radius(candidate)
        if not (np.isfinite(forces).all() and all(map(math.isfinite, (penetration, force, radius)))):
            self._end(OutcomeKind.NOT_FINITE, "a force or a radius is not finite")
        least = self.setup.resolved_from
        if contact and radius < least:
            reason = f"the contact shrinks below the radius {least:.6g} the mesh is made for"
            self._end(OutcomeKind.OUT_OF_RANGE, reason)
        history = self.setup.history
        received = self.solver.accept(candidate, forces)
        self.on_commit(candidate.dt, forces)
        displacement = history.displacement
        gap = self.setup.height - penetration + displacement
        self.counters.steps += self.recorder.content.last is not None
        self.recorder.add(
            SurfaceState(
                time=self.time,
                penetration=penetration,
                force=force,
                radius=radius,
                edge=candidate.edge.s,
                forces=forces,
                displacement=displacement,
                stored=history.stored_energy,
                interface=history.interface_energy(forces, gap),
                branch_dissipation=history.state.dissipated,
                zone=candidate.problem.zone(candidate.edge.s),
                received=received,
                smooth="force" in self.estimator.slopes,
                bent=bent,
                singular_force=candidate.singular_force,
                **self._at_tip(candidate.edge.s, radius, forces),
                **self._interface(candidate, radius),
            )
        )
        if contact and self.setup.geometry.stress is not None and self.state.zone >= radius:
            forces_so_far = [row[2] for row in self.recorder.content.rows]
            raise RunEnded(below_zone_outcome(forces_so_far, self.time))

    def _at_tip(self, edge: float, radius: float, forces: Array) -> dict[str, Any]:
        """Glassy energy release rate of the tip, not known in a jump, on a mesh that does not follow it."""
        setup, last = self.setup, self.recorder.content.last
        if isinstance(setup, FollowingSetup) or not setup.has_history:
            return {}
        partly = setup.history.state.partly
        if partly is None:
            return {}
        node = min(max(math.floor(edge), 0), setup.geometry.last - 1)
        element = 2.0 * float(np.diff(setup.geometry.radii[node : node + 2])[0])
        if last is not None and abs(radius - last.radius) > LARGEST_STEP * element:
            return {}
        operator, modulus = setup.history.instantaneous, setup.history.glassy_modulus
        return {"release": release_of_tip(partly, operator, setup.geometry, modulus, forces)}

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
        control = cast("Control", candidate.problem.control)
        if geometry.zone is None:
            self._last_touch(candidate.dt, control, candidate.problem.value)
        self._pulled_off(control, self._limit_point(control))

    def _last_touch(self, dt: float, control: Control, value: float) -> None:
        """The row of the last touch without adhesion: a point, or a plane tip that a force lets go.

        A blunt profile keeps a radius within the shortest step of that.
        """
        value = 0.0 if control == "force" else value
        plane = self.solver.plane_contact(dt, control, value)
        if plane is None or control == "force":
            self.time += dt
            self._commit(plane or self.solver.held(dt, control, value, 0.0))

    def _limit_point(self, control: Control) -> LimitPoint | None:
        """Where contact is lost, as the rows since the last instability tell it."""
        content, geometry = self.recorder.content, self.setup.geometry
        if geometry.zone is None or not content.rows:
            return None
        node = min(max(math.floor(self.state.edge), 0), len(geometry.radii) - 3)
        element = float(geometry.radii[node + 2] - geometry.radii[node])
        rows = np.array(content.rows)[:, 1:4]
        return limit_point(rows, element, control, self.setup.compliance)

    def _pulled_off(self, control: Control, at: LimitPoint | None = None) -> NoReturn:
        self.recorder.event("pull-off", at)
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


def _edge_origin(recorder: SurfaceRecorder, estimator: SlopeErrorEstimator) -> EdgeOrigin | None:
    """Edge of the last accepted state; the step to it counts unless rates jump there."""
    last = recorder.content.last
    if last is None:
        return None
    smooth = "radius" in estimator.slopes
    return EdgeOrigin(last.edge, last.radius, last.rate, last.duration if smooth else 0.0)
