"""A step to a given radius, ending at any load parameter: what is the same for all of them is computed once.

That is where the quadrature points lie and what they carry when the step begins, where on the step the edge
passes those that change sides, and the matrix of the closure. What is left is to fade: two to four
exponentials an array, and two products.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from validation.reference.path import fields
from validation.reference.path.closure import BASE, Closure, closure
from validation.reference.path.cohesive_zone import zone_length
from validation.reference.path.memory import (
    COLLOCATION,
    PATH_AT_NODES,
    Collocation,
    Motion,
    Ramp,
    collocation,
)
from validation.reference.path.path import Leg, Segment
from validation.reference.path.polynomials import horner, inverse, powers
from validation.reference.path.rheology import Body, total
from validation.reference.path.state import GRADING, State

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Points:
    """Distances from the edge that a step begins with, ``G`` there, and what is carried then.

    ``passed`` change sides where ``u_powers`` say.
    """

    x: Array
    G: Array
    carried: Array
    passed: NDArray[np.intp]
    u_powers: Array


@dataclass(frozen=True)
class Passing:
    """Points in contact as the edge passes them, and when that is, since the step began (m, 1)."""

    branches: Array
    strain: Array
    memory: Array
    elapsed: Array


@dataclass(frozen=True)
class Arrival:
    """The end of a step after a rise of the load parameter.

    ``integral`` is that of the closure, or the edge strain.
    """

    rise: float
    duration: float
    motion: Motion
    integral: float
    free: float = 0.0

    @property
    def depth(self) -> float:
        """Penetration."""
        return self.motion.end[1]


_NONE = np.zeros(0, int), np.zeros((0, COLLOCATION + 1))


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
        segment: Segment,
        zone: float,
        cohesive: float = 0.0,
        at_rest: float = 0.0,
        closed: bool = True,
    ) -> None:
        self.body, self.state, self.leg, self.segment = body, state, leg, segment
        self.zone, self.cohesive, self.zone_at_rest = zone, cohesive, at_rest
        self.travel = segment.travel
        self.radius = state.radius + self.travel
        if self.radius <= 4.0 * math.ulp(state.radius):
            self.radius, self.travel = 0.0, -state.radius
        self.direction = float(np.sign(self.travel))
        self.closure: Closure | None = None
        self._layered: dict[int, tuple[fields.Sweep, Points]] = {}
        self._passings: dict[tuple[Points, Motion], Passing] = {}
        self._forces: dict[Motion, float] = {}
        self.guess = 0.0
        if closed and zone > 0.0 and not cohesive:
            self._close(zone)
        elif zone == 0.0:
            self.behind, self.ahead = self._points(np.array([self.travel]), np.array([self.travel]))
        self.closed = closed

    def _close(self, zone: float, breaks: Array | None = None) -> None:
        """Set up the closure over a zone."""
        self.zone = zone
        self.closure = closure(
            self.radius, zone, self.state.breaks(self.travel, zone) if breaks is None else breaks
        )
        s = self.closure.s
        self.behind, self.ahead = self._points(self.travel - zone + s, self.travel + s)

    def zone_at_stress(self, motion: Motion, duration: float) -> float:
        """Length of the zone that a cohesive stress makes at this end of the step."""

        def stress(x: Array) -> Array:
            return self.stress(self._points(self.travel + x, x[:0])[0], motion, duration)

        within = self.state.thinned(self.state.edges_between(-self.state.radius, self.travel), self.zone)
        edges = np.union1d(within - self.travel, self.zone * (BASE - 1.0))
        return zone_length(stress, edges, self.radius, self.cohesive, self.zone_at_rest, self.zone)

    # what does not depend on the end ---

    def _points(self, behind: Array, ahead: Array) -> tuple[Points, Points]:
        """Points behind and ahead of the end; those that change sides are all on one side."""
        edge = self.travel  # a point that rounds onto it is in contact, as in the table
        x = np.concatenate((np.minimum(behind, edge), np.maximum(ahead, np.nextafter(edge, np.inf))))
        G, carried = self.state.carried(self.body, x)
        sides = []
        for side, moves in (
            (slice(0, len(behind)), self.direction > 0.0),
            (slice(len(behind), None), self.direction < 0.0),
        ):
            passed, u_powers = _NONE
            if moves:
                low, high = sorted((0.0, self.travel))
                passed = ((x[side] > low) & (x[side] <= high)).nonzero()[0]
                u_powers = powers(inverse(self.segment.way, x[side][passed]), COLLOCATION)
            sides.append(Points(x[side], G[side], carried[side], passed, u_powers))
        return sides[0], sides[1]

    @cached_property
    def swept(self) -> tuple[fields.Sweep, Points]:
        """The points that a moving edge passes, and the ends, in the entries they will be kept in."""
        return self._sweep(self.state.cuts(self.travel, self.zone, self.body.transform.knots))

    def _sweep(self, cuts: Array) -> tuple[fields.Sweep, Points]:
        """Points of the sweep between these cuts."""
        swept = fields.sweep(self.segment.way, cuts)
        u_powers = powers(swept.u, COLLOCATION)
        x = np.maximum(swept.x, np.nextafter(min(self.travel, 0.0), np.inf))
        return swept, Points(x, *self.state.carried(self.body, x), np.arange(len(x)), u_powers)

    # an end ---

    def arrive(self, rise: float) -> Arrival:
        """The end of the step after a rise of the load parameter."""
        state, leg, rheology = self.state, self.leg, self.body.rheology
        course = self.segment.parameter + rise * self.segment.basis
        clock = course if leg.timed else np.zeros_like(course)
        free = 0.0
        if leg.rate is not None:
            motion: Motion = Ramp(rheology.times, clock, state.memory, state.depth, leg.rate)
        elif leg.control == "penetration":
            at = state.parameter + PATH_AT_NODES @ course
            given = np.array([leg.value(p) for p in at]) - state.depth
            given[0] = 0.0
            motion = collocation(
                rheology.times, clock, state.memory, state.depth, given, 0.0 * given
            ).motion()
        else:
            family = collocation(
                rheology.times,
                clock,
                state.memory,
                state.depth,
                PATH_AT_NODES @ self.segment.depth,
                PATH_AT_NODES @ self.segment.basis,
            )
            free = self._balance(family, clock, state.parameter + rise)
            motion = family.motion(free)
        duration = float(clock.sum())
        return Arrival(rise, duration, motion, self._integral(motion, duration), free)

    def _balance(self, family: Collocation, clock: Array, parameter: float) -> float:
        """Change of the penetration in the step for the load to be as it has to: it is affine in it."""
        leg, state = self.leg, self.state
        if not self.segment.basis.any():  # a part of a step that is known
            return 0.0
        size = 1e-2 * max(abs(state.depth), abs(float(self.body.transform(np.array([self.radius]))[0])))
        size = size or 1e-3 * self.radius  # of any size, as the force is affine
        duration = float(clock.sum())
        one = self.force(family.motion(self.guess), duration)
        slope = (self.force(family.motion(self.guess + size), duration) - one) / size
        lack = leg.value(parameter) - leg.compliance * one
        if leg.control == "force":
            free = self.guess + (leg.value(parameter) - one) / slope
        else:
            free = self.guess + (lack - state.depth - self.guess) / (1.0 + leg.compliance * slope)
        if math.isfinite(free):
            self.guess = free
        return free

    def _integral(self, motion: Motion, duration: float) -> float:
        """Closure integral; without a zone the strain at the edge."""
        rheology = self.body.rheology
        if self.zone > 0.0:
            if not self.closed:
                return 0.0
            if self.cohesive:
                zone = self.zone_at_stress(motion, duration)
                if not math.isfinite(zone):
                    return math.nan
                if self.closure is None or abs(zone - self.zone) > 1e-13 * zone:
                    self._close(zone)
            assert self.closure is not None
            q, d = self.stress(self.behind, motion, duration), self.opening(self.ahead, motion, duration)
            return self.closure.integral(q, d)
        if self.direction > 0.0:
            return -float(self.opening(self.ahead, motion, duration)[0])
        return float(self.stress(self.behind, motion, duration)[0]) / rheology.glassy

    def stress(self, points: Points, motion: Motion, duration: float) -> Array:
        """``q`` of points in contact at the end."""
        rheology = self.body.rheology
        memory, depth = motion.end
        q = rheology.relaxed * (depth - points.G) + points.carried @ np.exp(-duration / rheology.times)
        q += rheology.moduli @ memory
        if self.direction > 0.0 and len(points.passed):
            at = points.passed
            covered = self._covered(self._passing(points, motion), motion, duration)
            q[at] = rheology.relaxed * (depth - points.G[at]) + total(covered)
        return q

    def opening(self, points: Points, motion: Motion, duration: float) -> Array:
        """``d`` of free points at the end."""
        rheology = self.body.rheology
        d = points.carried @ np.exp(-duration / rheology.retardation)
        if self.direction < 0.0 and len(points.passed):
            d[points.passed] = total(self._released(self._passing(points, motion), duration)[1])
        return d - (motion.end[1] - points.G)

    def _passing(self, points: Points, motion: Motion) -> Passing:
        """Points in contact at the edge."""
        rheology, at = self.body.rheology, points.passed
        elapsed, memory, depth = motion.during(points.u_powers)
        strain, carried = depth - points.G[at], points.carried[at]
        if self.direction > 0.0:
            branches = rheology.cover(carried * np.exp(-elapsed / rheology.retardation), strain)
        else:
            branches = carried * np.exp(-elapsed / rheology.times) + rheology.moduli * memory
        return Passing(branches, strain, memory, elapsed)

    def _swept_passing(self, points: Points, motion: Motion) -> Passing:
        """Points of a sweep, for force, energies and what is left."""
        key = points, motion
        if key not in self._passings:
            self._passings[key] = self._passing(points, motion)
        return self._passings[key]

    def _released(self, passing: Passing, duration: float) -> tuple[Array, Array]:
        """Unit strains of points released on the way, when they were and at the end."""
        rheology = self.body.rheology
        units = rheology.release(passing.branches, passing.strain)
        return units, units * np.exp((passing.elapsed - duration) / rheology.retardation)

    def _covered(self, passing: Passing, motion: Motion, duration: float) -> Array:
        """Branch forces of points covered on the way at the end."""
        rheology = self.body.rheology
        fading = np.exp((passing.elapsed - duration) / rheology.times)
        return passing.branches * fading + rheology.moduli * (motion.end[0] - fading * passing.memory)

    def edge_stress(self, arrival: Arrival) -> tuple[Array, Array]:
        """``u`` and ``q`` just inside the edge, at both ends of the step and where it passes its points."""
        if self.direction == 0.0:
            u = np.concatenate(([0.0], fields.NODES, [1.0]))
            x = np.zeros(len(u))
            points = Points(x, *self.state.carried(self.body, x), np.arange(len(x)), powers(u, COLLOCATION))
        else:
            swept, points = self.swept
            u = swept.u
        passing = self._swept_passing(points, arrival.motion)
        return u, self.body.rheology.stress(passing.branches, passing.strain)

    def _seen(self, duration: float) -> tuple[fields.Sweep, Points]:
        """The sweep with its last panel cut until the layer is seen in which the fastest branch relaxes."""
        swept, points = self.swept
        rheology = self.body.rheology
        shortest = rheology.shortest if self.direction > 0.0 else rheology.retardation.min(initial=math.inf)
        if duration > GRADING * shortest:
            count = int(math.log(duration / shortest) / math.log(GRADING))
            if count not in self._layered:
                cuts = swept.cuts
                near = self.travel - (self.travel - cuts[-2]) / GRADING ** np.arange(1, count + 1)
                near = near[(near - cuts[-2]) * (self.travel - near) > 0.0]
                self._layered[count] = self._sweep(np.concatenate((cuts[:-1], near, cuts[-1:])))
            swept, points = self._layered[count]
        return swept, points

    def _gained(self, motion: Motion, duration: float) -> tuple[Array, Array]:
        """``int b_k dx`` and ``int b_k^2 dx`` over what the step covered."""
        swept, points = self._seen(duration)
        covered = self._covered(self._swept_passing(points, motion), motion, duration)
        return swept.weight @ covered, swept.weight @ covered**2

    def force(self, motion: Motion, duration: float) -> float:
        """``F = 2 int_0^a q dx``."""
        if motion not in self._forces:
            self._forces[motion] = self._force(motion, duration)
        return self._forces[motion]

    def _force(self, motion: Motion, duration: float) -> float:
        """What the contact held before has faded, what it gained is integrated."""
        rheology, state, a = self.body.rheology, self.state, self.radius
        if a == 0.0:  # not the rounding of what there was
            return 0.0
        memory, depth = motion.end
        fading = np.exp(-duration / rheology.times)
        gained = rheology.moduli * (memory - fading * state.memory)
        branches = fading * (state.held - self._lost[0]) + gained * min(a, state.radius)
        if self.direction > 0.0:
            branches = branches + self._gained(motion, duration)[0]
        elastic = rheology.relaxed * (depth * a - self.body.transform.integral(a))
        return 2.0 * (elastic + float(branches.sum()))

    @cached_property
    def _lost(self) -> tuple[Array, Array]:
        """What the swept radii held as the step began: integrals of what they carry, and of its square."""
        state, rheology = self.state, self.body.rheology
        if self.direction == 0.0:
            return 0.0 * state.memory, 0.0 * state.memory
        swept, points = self.swept
        carried = points.carried
        if self.direction < 0.0:
            carried = carried + rheology.moduli * state.memory
        lost = swept.weight @ carried, swept.weight @ carried**2
        return lost if self.direction < 0.0 else (0.0 * lost[0], lost[1])

    # acceptance ---

    def state_after(self, arrival: Arrival) -> State:
        """The state at the end: integrals over contact and free surface recur exactly."""
        state, rheology, motion = self.state, self.body.rheology, arrival.motion
        memory, depth = motion.end
        fading = np.exp(-arrival.duration / rheology.times)
        recovering = np.exp(-arrival.duration / rheology.retardation)
        gained = rheology.moduli * (memory - fading * state.memory)
        low = min(self.radius, state.radius)
        lost, lost_squares = self._lost
        receding = self.direction < 0.0
        held = state.held - lost
        squares = state.held_squares - (lost_squares if receding else 0.0)
        squares = fading**2 * squares + 2.0 * fading * gained * held + gained**2 * low
        held = fading * held + gained * low
        free = (state.free_squares - (lost_squares if self.direction > 0.0 else 0.0)) * recovering**2
        surface = state.surface
        if self.direction != 0.0:
            swept, points = self.swept
            passing = self._swept_passing(points, motion)
            if receding:
                carried, _ = self._released(passing, arrival.duration)
                fine, near = self._seen(arrival.duration)
                _, strains = self._released(self._swept_passing(near, motion), arrival.duration)
                free = free + fine.weight @ strains**2
            else:
                gains = self._gained(motion, arrival.duration)
                held, squares = held + gains[0], squares + gains[1]
                carried = passing.branches - rheology.moduli * passing.memory
            surface = fields.passed(
                surface,
                swept,
                passing.elapsed,
                carried,
                not receding,
                points.G,
                rheology.moduli,
            )
        parameter = self.parameter(arrival)
        return replace(
            state,
            parameter=parameter,
            time=parameter if self.leg.timed else state.time,
            depth=self.leg.value(parameter) if self.leg.control == "penetration" else depth,
            radius=self.radius,
            force=self.leg.value(parameter)
            if self.leg.control == "force"
            else self.force(motion, arrival.duration),
            memory=memory,
            surface=surface.seen_from(self.travel, self.radius, arrival.duration),
            held=held,
            held_squares=squares,
            free_squares=free,
            layer=rheology.shortest * self.speed(arrival)
            if self.direction > 0.0 and arrival.duration
            else state.layer,
            kinks=tuple(kink - self.travel for kink in state.kinks),
            corners=tuple(corner - self.travel for corner in state.corners),
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

    def speed(self, arrival: Arrival) -> float:
        """``da/dt`` at the end."""
        orders = np.arange(len(self.segment.way))
        slope = float(self.segment.way @ orders)
        return slope / float(arrival.motion.clock @ orders)

    def way_at(self, u: float) -> float:
        """Radius at ``u``."""
        return self.state.radius + float(horner(self.segment.way, np.array(u)))
