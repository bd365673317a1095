"""The problem of a run: what its steps need besides the state."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from contact_scene import Scene, Segment
from validation.reference.path.rheology import Body, rheology
from validation.reference.sneddon import transform
from validation.reference.tracking.control import freedom
from validation.reference.tracking.equilibrium import pressed_radius, staged_radius, touching_radius
from validation.reference.tracking.law import EdgeCondition, Griffith, NoTension
from validation.reference.tracking.node_placement import NodePlacement
from validation.reference.tracking.options import Fineness
from validation.reference.tracking.state import FrontState
from validation.reference.tracking.step_error import StepErrorEstimator, free_columns
from validation.reference.tracking.step_history import FORCE, PENETRATION, RADIUS
from validation.reference.tracking.step_outcome import FrontCandidate
from validation.reference.tracking.surface import Surface
from validation.reference.tracking.trial import Trial

LONG_ZONE = 0.05
"""Process zone over contact radius from which on a step is a fraction of a zone; with shorter zones it may
be the same fraction of this part of the radius. The zones of the paper are longer, and their runs resolved
to 1e-7 by it."""

LONG_STEP_SHARE = 0.3
"""Allowed deviation of a step over process zones, in those of shorter ones, which stay far below theirs: an
accelerating edge magnifies errors."""
FREE_STEP_SHARE = 0.035
"""The same under a controlled force, where no penetration holds the edge back: there by up to ten. On
a spring it is between the two (:func:`~validation.reference.tracking.control.freedom`)."""
FREE_SHARE = 0.7
"""Allowed deviation of shorter steps under a controlled force: when contact is lost is a sum of all times."""
ZONES_FROM_TURN = 2
"""Steps end at so many zones from a turn; farther on the radius is smooth enough (see ``zone_from_turn``)."""
ELASTIC_TRAVEL = 0.08
"""Largest travel in an elastic step, in first radii, times the steps per process zone: 0.5 % by default."""


@dataclass(frozen=True)
class FrontProblem:
    """Scene and step sizes; constant during a run.

    Attributes
    ----------
    largest_travel : float
        Distance that resolves a process zone: largest travel of the edge in one step where zones are long.
    radius, force, depth : float
        Scales of the scene: contact radius under the largest load, largest force, largest penetration.
    """

    scene: Scene
    body: Body
    condition: EdgeCondition
    fineness: Fineness
    largest_travel: float
    radius: float
    force: float
    depth: float

    @property
    def edge_radius(self) -> float:
        """Radius of the indenter's edge; infinite without one."""
        return self.scene.indenter.edge

    @property
    def shortest_time(self) -> float:
        """Shortest relaxation time; infinite if nothing relaxes."""
        return self.body.rheology.shortest

    @property
    def elastic(self) -> bool:
        """Whether nothing relaxes: each state is then an equilibrium by itself."""
        return len(self.body.rheology.times) == 0

    @property
    def rated(self) -> bool:
        """Whether an opening edge takes up what its speed tells."""
        return self.condition.rated

    @property
    def irreversible(self) -> Griffith | None:
        """The edge condition if what the edge takes up depends on its direction or speed."""
        condition = self.condition
        return condition if isinstance(condition, Griffith) and not condition.adhesion.reversible else None

    @property
    def work_of_adhesion(self) -> float:
        """Work of adhesion; 0 without adhesion."""
        return self.condition.adhesion.work if isinstance(self.condition, Griffith) else 0.0

    def longest_travel(self, radius: float) -> float:
        """Largest distance that the edge of a contact of a given radius may travel in one step."""
        if isinstance(self.condition, NoTension):
            return self.largest_travel
        return max(self.largest_travel, LONG_ZONE * radius / self.fineness.divisions)

    def over_zones(self, radius: float) -> bool:
        """Whether a step of a contact of a given radius may pass over process zones."""
        return self.longest_travel(radius) > self.largest_travel

    def trial(self, state: FrontState, segment: Segment, travel: float = 0.0) -> Trial:
        """A trial step from the present state.

        Parameters
        ----------
        state : FrontState
        segment : Segment
            Load step.
        travel : float
            Expected travel of the edge, signed.

        Returns
        -------
        Trial
        """
        over_zones = self.over_zones(state.surface.radius)
        return Trial(
            self.body,
            self.condition,
            state.surface,
            segment,
            state.time,
            state.history.expectation(RADIUS),
            state.history.extrapolation(PENETRATION),
            NodePlacement(
                self.shortest_time,
                travel,
                self.condition.zone_length,
                self.fineness.divisions,
                self.fineness.deviation,
                over_zones,
                freedom(segment, self.body, state.surface.radius),
            ),
            state.counters,
            self.edge_radius,
            self.longest_travel(state.surface.radius),
            over_zones,
        )

    def zone_from_turn(self, state: FrontState) -> float | None:
        """Radius one more zone from the last turn, if the edge goes there and was not at rest on its way."""
        condition = self.condition
        if state.turn is None or state.zones_from_turn >= ZONES_FROM_TURN:
            return None
        if not isinstance(condition, Griffith) or self.elastic or self.rated:
            return None
        if condition.adhesion.stress is not None or self.over_zones(state.surface.radius):
            return None
        distance = (state.zones_from_turn + 1) * condition.zone_length
        place = state.turn + math.copysign(distance, state.direction)
        return place if (place - state.surface.radius) * state.direction > 0.0 else None

    def load_rate(self, state: FrontState, segment: Segment) -> float:
        """Rate of the load, relative to its largest value so far or expected."""
        scale = segment.present(state.largest_depth, state.largest_force)
        return segment.rate(state.time) / scale if scale > 0.0 else 0.0

    def candidate(self, time: float, surface: Surface, intervals: int = 0) -> FrontCandidate:
        """A candidate with its force.

        Parameters
        ----------
        time : float
        surface : Surface
        intervals : int
            As of :class:`FrontCandidate`.

        Returns
        -------
        FrontCandidate
        """
        return FrontCandidate(time, surface, surface.force(self.body), intervals)

    def step_error(self, state: FrontState, segment: Segment, to: FrontCandidate) -> StepErrorEstimator:
        """Error estimator of a step.

        Parameters
        ----------
        state : FrontState
            At its start.
        segment : Segment
            Load step.
        to : FrontCandidate
            At its end.

        Returns
        -------
        StepErrorEstimator
        """
        scales = {
            RADIUS: state.largest_radius,
            FORCE: max(state.largest_force, abs(to.force)),
            PENETRATION: max(state.largest_depth, abs(to.surface.penetration)),
        }
        over_zones = self.over_zones(state.surface.radius)
        held, free = (LONG_STEP_SHARE, FREE_STEP_SHARE) if over_zones else (1.0, FREE_SHARE)
        share = held * (free / held) ** freedom(segment, self.body, state.surface.radius)
        return StepErrorEstimator(
            state.history,
            share * self.fineness.deviation,
            free_columns(segment.control),
            scales,
            self.condition.zone_length if over_zones else 0.0,
        )


def with_elastic_travel(problem: FrontProblem, radius: float) -> FrontProblem:
    """The problem with steps that do not depend on the process zone, if nothing relaxes.

    No state depends then on how the edge came there, and steps are as long as what is read between the rows
    allows. ``radius`` is that of the first contact.
    """
    if not problem.elastic or not isinstance(problem.condition, Griffith):
        return problem
    return replace(
        problem,
        largest_travel=max(problem.largest_travel, ELASTIC_TRAVEL * radius / problem.fineness.divisions),
    )


def front_problem(scene: Scene, fineness: Fineness) -> FrontProblem:
    """Material and indenter in Abel space, the edge condition, and the scales of a scene."""
    body = Body(rheology(scene.material), transform(scene.indenter))
    depth, load = _largest_load(scene, body)
    edge = scene.indenter.edge
    radius = max(touching_radius(body, depth, edge), pressed_radius(body, load, edge))
    deepest = max(depth, _depth_under(body, load, edge))
    condition: EdgeCondition
    if scene.adhesion is not None and scene.is_adhesive:
        condition = Griffith(scene.adhesion)
        travel = scene.adhesion.zone / fineness.divisions
    else:
        condition = NoTension()
        travel = 0.01 * radius / fineness.divisions
    weight = 2.0 * body.rheology.relaxed * (depth * radius - body.transform.integral(radius))
    return FrontProblem(scene, body, condition, fineness, travel, radius, max(weight, load), deepest)


def _largest_load(scene: Scene, body: Body) -> tuple[float, float]:
    """Largest penetration and largest force that the loading prescribes.

    A stage presses with the relaxed contact under it; a level that ends a step bounds the step.
    """
    depth = deepest = scene.loading.penetration
    force = hardest = 0.0
    edge = scene.indenter.edge
    for step in scene.loading.steps:
        segment = scene.loading.segment(step, 0.0, depth, force)
        values = [segment.value(t) for t in np.linspace(0.0, segment.end, 257)]
        trigger = segment.trigger
        if segment.control == "force":
            hardest, force = max(hardest, *values), values[-1]
            continue
        if segment.control == "stage":
            relaxed = body.rheology.relaxed
            radius = staged_radius(body, relaxed, max(values), segment.compliance, edge)
            soft = 2.0 * relaxed * segment.compliance
            staged = (max(values) + soft * body.transform.integral(radius)) / (1.0 + soft * radius)
            values = [staged] if radius > 0.0 else [depth]
        if trigger is not None and trigger.quantity == "force":
            hardest, force = max(hardest, trigger.level), trigger.level
            values = [min(max(values), _depth_under(body, trigger.level, edge))]
        elif trigger is not None and trigger.quantity == "radius":
            values = [min(max(values), float(body.transform(np.array([min(trigger.level, edge)]))[0]))]
        deepest, depth = max(deepest, *values), values[-1]
    return deepest, hardest


def _depth_under(body: Body, force: float, edge: float) -> float:
    """Penetration of the adhesionless relaxed contact under a force."""
    radius = pressed_radius(body, force, edge)
    if radius == 0.0:
        return 0.0
    return float((0.5 * force / body.rheology.relaxed + body.transform.integral(radius)) / radius)
