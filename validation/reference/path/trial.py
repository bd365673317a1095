"""A step to a given radius, ending at any load parameter: what is the same for all of them is computed once.

That is where the quadrature points lie and what they hold when the step begins, where on the step the edge
passes those that change sides, and the closure of the side that it does not pass. What is left is to fade:
two to four exponentials, and two products.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from validation.reference.path import fields
from validation.reference.path.closure import BASE, Closure, closure, zone_length
from validation.reference.path.fields import Passed, Passing
from validation.reference.path.memory import (
    COLLOCATION,
    PATH_AT_NODES,
    Collocation,
    ConstantRate,
    Motion,
    collocation,
)
from validation.reference.path.numerics import inverse, powers
from validation.reference.path.path import Leg, PathSegment
from validation.reference.path.rheology import Body, total
from validation.reference.path.state import GRADING, State

Array = NDArray[np.float64]


SECANT = 1e-4
"""Change of the load parameter that tells a slope of the residual, in a step: the root is as much closer."""


@dataclass(eq=False)
class Arrival:
    """The end of a step after a rise of the load parameter.

    ``integral`` is that of the closure, or the edge strain.
    """

    rise: float
    motion: Motion
    passing: Passing | None
    integral: float
    free: float = 0.0
    force: float | None = None

    @property
    def duration(self) -> float:
        """Length of the step in time."""
        return self.motion.duration

    @property
    def depth(self) -> float:
        """Penetration."""
        return self.motion.end[1]


class Trial:
    """The step from a state along a segment; its end radius is where the segment ends.

    What has the radius in it is measured from the edge where the step begins, and so is the load parameter.

    ``zone`` 0: without adhesion. ``cohesive``: stress of a zone whose length follows, ``zone`` is a guess.
    """

    def __init__(
        self,
        body: Body,
        state: State,
        leg: Leg,
        segment: PathSegment,
        zone: float,
        cohesive: float = 0.0,
        at_rest: float = 0.0,
        closed: bool = True,
    ) -> None:
        self.body, self.state, self.leg, self.segment = body, state, leg, segment
        self.zone, self.cohesive, self.zone_at_rest, self.closed = zone, cohesive, at_rest, closed
        self._guess = zone
        self.travel = segment.travel
        self.radius = state.radius + self.travel
        if self.radius <= 4.0 * math.ulp(state.radius):
            self.radius, self.travel = 0.0, -state.radius
        self.direction = float(np.sign(self.travel))
        self.closure: Closure | None = None
        self._remembered = body.rheology.moduli * state.memory
        self._layered: dict[int, Passed] = {}
        self._cuts = state.cuts(self.travel, zone, body.transform.knots)
        none, edge = np.zeros(0), np.array([self.travel])
        if closed and zone > 0.0 and not cohesive:
            self._close(zone)
        elif closed and zone == 0.0:
            self._lay(none if self.direction > 0.0 else edge, none if self.direction < 0.0 else edge)
        else:
            self._lay(none, none)

    # what does not depend on the end ---

    def _close(self, zone: float) -> None:
        """Set up the closure over a zone, and what it makes of the side that the edge does not pass."""
        self.zone = zone
        form = self.closure = closure(self.radius, zone, self.state.breaks(self.travel, zone))
        count = len(form.s)
        self._lay(self.travel - zone + form.s, self.travel + form.s)
        side = slice(count, None) if self.direction > 0.0 else slice(0, count)
        rows = np.vstack((np.ones(count), self._G[side] - self._G[count], self._begun[side].T))
        self._factors = form.of_openings(rows) if self.direction > 0.0 else form.of_stresses(rows)
        self._beside = rows[:, 0 if self.direction > 0.0 else -1]  # the point next to the edge

    def _lay(self, behind: Array, ahead: Array) -> None:
        """Points behind and ahead of the end, and of the sweep; those that change sides are on one side."""
        edge = self.travel  # a point that rounds onto it is in contact, as in the table
        x = np.concatenate((np.minimum(behind, edge), np.maximum(ahead, np.nextafter(edge, np.inf))))
        self.passed: Passed | None = None
        if not self.direction:
            self._G, self._begun = self.state.carried(self.body, x)
            return
        low, high = sorted((0.0, edge))
        changing = (x > low) & (x <= high)
        changing[slice(0, len(behind)) if edge < 0.0 else slice(len(behind), None)] = False
        self._changing = changing.nonzero()[0]
        sweep, u_powers = self._swept(self._cuts, x[self._changing])
        G, begun = self.state.carried(
            self.body, np.concatenate((x, np.maximum(sweep.x, np.nextafter(low, np.inf))))
        )
        at = np.concatenate((self._changing, np.arange(len(x), len(G))))
        self._G, self._begun = G[: len(x)], begun[: len(x)]
        self.passed = Passed(sweep, u_powers, G[at], begun[at])

    def _swept(self, cuts: Array, before: Array) -> tuple[fields.SweptRadii, Array]:
        """A sweep, and powers of ``u`` at radii and at its own, from the beginning to the end of the step."""
        sweep = fields.sweep(self.segment.way, cuts)
        u = inverse(self.segment.way, np.concatenate((before, sweep.x)))
        u[len(before)], u[-1] = 0.0, 1.0
        return sweep, powers(u, COLLOCATION)

    def _over(self, passed: Passed, duration: float) -> Passed:
        """The sweep with its last panel cut until the layer is seen in which the fastest branch relaxes."""
        rheology = self.body.rheology
        shortest = rheology.shortest if self.direction > 0.0 else rheology.retardation.min(initial=math.inf)
        if not duration > GRADING * shortest:
            return passed
        count = int(math.log(duration / shortest) / math.log(GRADING))
        if count not in self._layered:
            cuts = self._cuts
            near = self.travel - (self.travel - cuts[-2]) / GRADING ** np.arange(1, count + 1)
            near = near[(near - cuts[-2]) * (self.travel - near) > 0.0]
            sweep, u_powers = self._swept(np.concatenate((cuts[:-1], near, cuts[-1:])), cuts[:0])
            carried = self.state.carried(
                self.body, np.maximum(sweep.x, np.nextafter(min(self.travel, 0.0), np.inf))
            )
            self._layered[count] = Passed(sweep, u_powers, *carried)
        return self._layered[count]

    # an end ---

    def arrive(self, rise: float) -> Arrival:
        """The end of the step after a rise of the load parameter."""
        state, leg, rheology = self.state, self.leg, self.body.rheology
        course = self.segment.parameter + rise * self.segment.basis
        clock = course if leg.timed else np.zeros_like(course)
        if leg.rate is not None:
            return self._arrived(
                rise, ConstantRate(rheology.times, clock, rheology.moduli, state.depth, leg.rate)
            )
        if leg.control == "penetration":
            at = state.parameter + PATH_AT_NODES @ course
            given = np.array([leg.value(p) for p in at]) - state.depth
            given[0] = 0.0
            basis = 0.0 * given
        else:
            given, basis = PATH_AT_NODES @ self.segment.depth, PATH_AT_NODES @ self.segment.basis
        family = collocation(rheology.times, clock, rheology.moduli, state.depth, given, basis)
        if not basis.any():  # the penetration is known
            return self._arrived(rise, family.motion())
        return self._balanced(rise, family)

    def _balanced(self, rise: float, family: Collocation) -> Arrival:
        """The end at which the load is as it has to be: it is affine in the change of the penetration."""
        leg, value = self.leg, self.leg.value(self.state.parameter + rise)
        one, slope = self.force(family.motion()), self.force(family.free, unit=True)
        if leg.control == "force":
            free = (value - one) / slope
        else:
            free = (value - leg.compliance * one - self.state.depth) / (1.0 + leg.compliance * slope)
        arrival = self._arrived(rise, family.motion(free))
        arrival.free, arrival.force = free, one + free * slope
        return arrival

    def _arrived(self, rise: float, motion: Motion) -> Arrival:
        if self.cohesive and self.closed:
            zone = self.zone_at_stress(motion)
            if math.isfinite(zone) and (self.closure is None or abs(zone - self.zone) > 1e-13 * zone):
                self._close(zone)
        passing = self._passes(self.passed, motion) if self.passed else None
        integral = self._integral(motion, passing) if self.closed else 0.0
        if self.cohesive and self.closed and not math.isfinite(zone):
            integral = math.nan
        return Arrival(rise, motion, passing, integral)

    def _integral(self, motion: Motion, passing: Passing | None) -> float:
        """Closure integral; without a zone the strain at the edge: behind it, unless it covers."""
        rheology, form, covers = self.body.rheology, self.closure, self.direction > 0.0
        gained, depth = motion.end
        fresh = np.exp(-motion.duration / rheology.retardation)
        if form is None:
            if covers:
                return self.overlap(motion)
            return float(self.stress(self._G[:1], self._begun[:1], motion)[0]) / rheology.glassy
        count = len(form.s)
        side, strain = (slice(0, count) if covers else slice(count, None)), depth - self._G
        other = self._begun[side]
        if covers:
            field = self.stress(self._G[side], other, motion)
            still = np.concatenate(([-strain[count], 1.0], fresh))
        else:
            field = other @ fresh - strain[side]
            fading = np.exp(-motion.duration / rheology.times)
            constant = rheology.relaxed * strain[count] + gained.sum()
            still = np.concatenate(([constant, -rheology.relaxed], fading))
        if passing is not None and len(self._changing):
            changed = total(passing.end[: len(self._changing)])
            changed += (rheology.relaxed if covers else -1.0) * strain[self._changing]
            field[self._changing - (0 if covers else count)] = changed
        beside = float(still @ self._beside), float(field[-1 if covers else 0])
        return form.integral(float(still @ (self._factors @ field)), *(beside[::-1] if covers else beside))

    def overlap(self, motion: Motion) -> float:
        """Strain by which the surface is within the indenter next to an edge that covers or stays."""
        fresh = np.exp(-motion.duration / self.body.rheology.retardation)
        return motion.end[1] - float(self._G[-1]) - float(self._begun[-1] @ fresh)

    def stress(self, G: Array, begun: Array, motion: Motion) -> Array:
        """``q`` at the end at points that stay in contact."""
        rheology = self.body.rheology
        gained, depth = motion.end
        q: Array = rheology.relaxed * (depth - G) + begun @ np.exp(-motion.duration / rheology.times)
        return q + gained.sum()

    def zone_at_stress(self, motion: Motion) -> float:
        """Length of the zone that a cohesive stress makes at this end of the step."""
        rheology, depth = self.body.rheology, motion.end[1]

        def stress(x: Array) -> Array:
            x = np.minimum(self.travel + x, self.travel)
            G, begun = self.state.carried(self.body, x)
            q = self.stress(G, begun, motion)
            if self.direction > 0.0:
                new = (x > 0.0).nonzero()[0]
                u_powers = powers(inverse(self.segment.way, x[new]), COLLOCATION)
                passing = self._passing(G[new], begun[new], u_powers, motion)
                q[new] = rheology.relaxed * (depth - G[new]) + total(passing.end)
            return q

        within = self.state.edges_between(-self.state.radius, self.travel)
        edges = np.union1d(within - self.travel, self._guess * (BASE - 1.0))
        return zone_length(stress, edges, self.radius, self.cohesive, self.zone_at_rest, self.zone)

    def _passes(self, points: Passed, motion: Motion) -> Passing:
        return self._passing(points.G, points.begun, points.u_powers, motion)

    def _passing(self, G: Array, begun: Array, u_powers: Array, motion: Motion) -> Passing:
        return fields.passing(self.body.rheology, self.direction > 0.0, G, begun, u_powers, motion)

    def edge_stress(self, arrival: Arrival) -> tuple[Array, Array]:
        """``u`` and ``q`` just inside the edge, at both ends of the step and where it passes its points."""
        passing, passed, rheology = arrival.passing, self.passed, self.body.rheology
        if passing is None or passed is None:
            u_powers = powers(np.concatenate(([0.0], fields.NODES, [1.0])), COLLOCATION)
            carried = self.state.carried(self.body, np.zeros(len(u_powers)))
            passing = self._passing(*carried, u_powers, arrival.motion)
            return u_powers[:, 1], rheology.stress(passing.branches, passing.strain)
        swept = passed.swept
        return passed.u_powers[swept, 1], rheology.stress(passing.branches[swept], passing.strain[swept])

    def force_at(self, arrival: Arrival) -> float:
        """The force at an end."""
        if arrival.force is None:
            arrival.force = self.force(arrival.motion, arrival.passing)
        return arrival.force

    def force(self, motion: Motion, passing: Passing | None = None, unit: bool = False) -> float:
        """``F = 2 int_0^a q dx``; ``unit``: what a motion adds to it that does so to others.

        What the contact held before has faded, what it gained is integrated.
        """
        rheology, state, a = self.body.rheology, self.state, self.radius
        if a == 0.0:  # not the rounding of what there was
            return 0.0
        gained, depth = motion.end
        branches, shape = gained * min(a, state.radius), 0.0
        if not unit:
            shape = self.body.transform.integral(a)
            branches = branches + np.exp(-motion.duration / rheology.times) * (state.held - self._lost[0])
        if self.passed and self.direction > 0.0:
            branches = branches + self._left(self.passed, motion, passing, unit)[0]
        return 2.0 * (rheology.relaxed * (depth * a - shape) + float(branches.sum()))

    def _left(
        self, passed: Passed, motion: Motion, passing: Passing | None, unit: bool = False
    ) -> tuple[Array, Array]:
        """Integrals over what the step passed of branch forces or unit strains at the end, and of squares."""
        points = self._over(passed, motion.duration)
        if unit:
            points = replace(points, G=0.0 * points.G, begun=0.0 * points.begun)
        if passing is None or points is not passed:
            passing = self._passes(points, motion)
        end, weight = passing.end[points.swept], points.sweep.weight
        return weight @ end, weight @ end**2

    @cached_property
    def _lost(self) -> tuple[Array, Array]:
        """What the swept radii held as the step began: integrals of what they carry, and of its square."""
        nothing = 0.0 * self.state.memory
        if self.passed is None:
            return nothing, nothing
        weight, begun = self.passed.sweep.weight, self.passed.begun[self.passed.swept]
        return weight @ begun if self.direction < 0.0 else nothing, weight @ begun**2

    # acceptance ---

    def state_after(self, arrival: Arrival) -> State:
        """The state at the end: integrals over contact and free surface recur exactly."""
        state, rheology, motion = self.state, self.body.rheology, arrival.motion
        gained, depth = motion.end
        fading = np.exp(-motion.duration / rheology.times)
        recovering = np.exp(-motion.duration / rheology.retardation)
        low, opens = min(self.radius, state.radius), self.direction < 0.0
        lost, lost_squares = self._lost
        held = state.held - lost
        squares = state.held_squares - (lost_squares if opens else 0.0)
        squares = fading**2 * squares + 2.0 * fading * gained * held + gained**2 * low
        held = fading * held + gained * low
        free = (state.free_squares - (0.0 if opens else lost_squares)) * recovering**2
        surface, passed, passing = state.surface, self.passed, arrival.passing
        if passed is not None and passing is not None:
            sweep, swept = passed.sweep, passed.swept
            elapsed, left = passing.elapsed[swept], passing.left[swept]
            ends = self._left(passed, motion, passing)
            if opens:
                free = free + ends[1]
            else:
                held, squares = held + ends[0], squares + ends[1]
                left = left - self._remembered * np.exp(-elapsed / rheology.times)
            G = passed.G[swept]
            surface = fields.passed(surface, sweep, elapsed, left, not opens, G, rheology.moduli)
        parameter = self.parameter(arrival)
        return replace(
            state,
            parameter=parameter,
            time=parameter if self.leg.timed else state.time,
            depth=self.leg.value(parameter) if self.leg.control == "penetration" else depth,
            radius=self.radius,
            force=self.leg.value(parameter) if self.leg.control == "force" else self.force_at(arrival),
            memory=fading * state.memory + gained / rheology.moduli,
            surface=surface.seen_from(self.travel, self.radius, arrival.duration),
            held=held,
            held_squares=squares,
            free_squares=free,
            layer=rheology.shortest * self.speed(arrival)
            if self.direction > 0.0 and arrival.duration
            else state.layer,
        )

    def parameter(self, arrival: Arrival) -> float:
        """Load parameter at an end; that of the leg where it rounds onto its end."""
        start, end = self.state.parameter, self.leg.end
        return end if arrival.rise == end - start else start + arrival.rise

    def part(self, u: float, arrival: Arrival) -> tuple[Trial, Arrival]:
        """The step cut off at ``u``, without closure, and its end: a point of the dense path."""
        segment = self.segment.cut(u, arrival.rise, arrival.free)
        zones = self.zone, self.cohesive, self.zone_at_rest
        trial = Trial(self.body, self.state, self.leg, segment, *zones, closed=False)
        return trial, trial.arrive(float(segment.parameter.sum()))

    def corrected_force(
        self, u: float, arrival: Arrival, residual: Callable[[Trial, Arrival], float]
    ) -> float:
        """The force at the radius that the dense path has at ``u``, where the edge condition holds."""
        segment = self.segment.cut(u, arrival.rise, arrival.free, loose=True)
        zones = self.zone, self.cohesive, self.zone_at_rest
        trial = Trial(self.body, self.state, self.leg, segment, *zones)
        orders = np.arange(len(self.segment.basis))
        rise = float((self.segment.parameter + arrival.rise * self.segment.basis) @ u**orders)
        apart = SECANT * arrival.rise
        values = [residual(trial, trial.arrive(rise + shift)) for shift in (0.0, apart)]
        return trial.force_at(trial.arrive(rise - values[0] * apart / (values[1] - values[0])))

    def speed(self, arrival: Arrival) -> float:
        """``da/dt`` at the end."""
        orders = np.arange(len(self.segment.way))
        slope = float(self.segment.way @ orders)
        time = float(arrival.motion.clock @ orders)
        return slope / time if time else math.copysign(math.inf, slope)
