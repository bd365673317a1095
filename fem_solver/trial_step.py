"""A trial step within the travel of the edge: its error, and whether it is too long whatever its error.

It returns a candidate and changes nothing.
"""

from __future__ import annotations

import math

from contact_scene import Segment
from fem_solver.accepted_states import AcceptedStates
from fem_solver.contact_solver import ContactCandidate
from fem_solver.curved_loads import deviation_from_tangent
from fem_solver.irreversible_edge import IrreversibleEdge
from fem_solver.recorder import SurfaceState
from fem_solver.run_state import StepCandidate
from fem_solver.step_control import DyadicInterval

_ZONE_END_SHARE = 1e-4
"""Longest step, in intervals, within which a zone of fixed stress may come to fill its contact: the end."""
_FIRST_TRAVEL = 0.0625
"""Travel of a rated edge in the step in which it sets off, relative to that allowed per step."""
_FIRST_ZONES = 0.0625
"""Travel of an edge in the step in which it sets off, relative to its process zone: over a zone its speed is
felt."""
_DEVIATION_PER_TOLERANCE = 10.0
"""Deviation of the prescribed value from its tangent over a step, per tolerance, relative to its swing."""
_RADIUS_SCALE = 10.0
"""Allowed error of the radius per that of the force, relative to their sizes: the travel bounds it closer."""
_MISSED_RADIUS = 0.1
"""Distance by which the edge may miss the extrapolation of its path, per allowed error of the force, relative
to the sizes of radius and force. It is less than one: an edge that is too far inside recedes faster from
then on, so that what it misses grows towards the pull-off."""
_ELASTIC_TRAVEL = 4.0
"""Factor on the edge travel per step of an elastic solid, which has no history to resolve."""
_ELASTIC_SHARE = 0.1
"""Edge travel per step of an elastic solid, relative to the contact radius, where that is more."""


class TriedSteps(AcceptedStates):
    """A run that can try a step of any length from the last accepted state."""

    def trial_step(self, segment: Segment, dt: float, end: float) -> StepCandidate:
        """A step with its edge within one step's travel.

        Parameters
        ----------
        segment : Segment
        dt, end : float
            Length of the step and the time at its end.

        Returns
        -------
        StepCandidate
        """
        now = self.state
        contact = self.solver.trial(dt, segment.control, segment.value(end), now.edge, self._reach(now))
        if not contact.in_equilibrium:
            return StepCandidate(contact, {}, math.inf)
        radius = self.solver.radius(contact)
        force = contact.force
        quantities = {
            "force": (force, now.force, self.force_scale(force, contact.singular_force, radius)),
            "radius": (radius, now.radius, _RADIUS_SCALE * radius),
        }
        if segment.control != "penetration":
            scale = self.recorder.depth_scale()
            quantities["penetration"] = contact.penetration, now.penetration, scale
        slopes = {name: (new - old) / dt for name, (new, old, _) in quantities.items()}
        scales = {name: scale for name, (_, _, scale) in quantities.items()}
        error = max(self.estimator.error(slopes, scales, dt), self._path_error(contact, radius))
        return StepCandidate(contact, slopes, error)

    def _path_error(self, contact: ContactCandidate, radius: float) -> float:
        """Error of the edge's path over a step, relative to the allowed one.

        The force does not show it where it follows the loading whatever the edge does, as on a soft spring.
        The missed distance is of the third order in the step; errors are of the second.
        """
        if radius <= 0.0:
            return 0.0
        allowed = _MISSED_RADIUS * self.estimator.tolerance * radius
        return (self.solver.missed_by_extrapolation(contact) / allowed) ** (2.0 / 3.0)

    def _travel(self) -> float:
        """Edge travel allowed in the present step.

        Without a history each state is an equilibrium by itself, and the edge may pass many zones in a step;
        the shortest step alone keeps to the travel of the others: what lies farther is reached in a jump.
        """
        travel, interval = self.setup.travel, self.interval
        if self.setup.has_history or interval is None or interval.shortest:
            return travel
        return max(_ELASTIC_TRAVEL * travel, _ELASTIC_SHARE * self.state.radius)

    def _reach(self, now: SurfaceState) -> tuple[float, float]:
        """Edge positions within one step's travel, at least one node either way."""
        geometry, travel = self.setup.geometry, self._travel()
        low, high = geometry.position(now.radius - travel), geometry.position(now.radius + travel)
        return min(low, now.edge - 1.0), max(high, now.edge + 1.0)

    def _deviation(self, segment: Segment, interval: DyadicInterval, span: float) -> float:
        """Deviation of the prescribed value from its tangent over a step, relative to the allowed one."""
        if segment.linear or span == 0.0:
            return 0.0
        largest = deviation_from_tangent(segment, interval.time, interval.next_time)
        return largest / (_DEVIATION_PER_TOLERANCE * self.estimator.tolerance * span)

    def _sets_off_too_far(self, contact: ContactCandidate, interval: DyadicInterval) -> bool:
        """Whether an edge at rest sets off in a step and goes far in it.

        Its speed would be averaged over the rest that is part of the step, and with it what a relaxing solid,
        or a law of the edge, takes up.
        """
        if not self._rests or interval.shortest or not contact.in_equilibrium:
            return False
        allowed = _FIRST_ZONES * contact.problem.zone(contact.edge.s)
        if self._has_rate:
            allowed = min(allowed, _FIRST_TRAVEL * self.setup.travel)
        return abs(self.state.radius - self.solver.radius(contact)) > allowed

    @property
    def _rests(self) -> bool:
        """Whether an edge whose speed matters is at rest: pinned, or held by the rim of a punch."""
        if not (self.setup.has_history or self._has_rate):
            return False
        if isinstance(self.setup.law, IrreversibleEdge):
            return self.state.rate == 0.0
        rows = self.recorder.content.rows
        return len(rows) > 1 and rows[-2][3] == rows[-1][3] > 0.0

    def _zone_fills_contact(self, contact: ContactCandidate, interval: DyadicInterval) -> bool:
        """Whether a zone of fixed stress comes to fill its contact within a step that is not yet short."""
        if self.setup.geometry.stress is None or not contact.in_equilibrium or interval.shortest:
            return False
        fills = contact.problem.zone(contact.edge.s) >= self.solver.radius(contact)
        return fills and interval.dt > _ZONE_END_SHARE * (interval.end - interval.start)
