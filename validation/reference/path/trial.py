"""A step to a given radius, ending at any load parameter: what is the same for all of them is computed once.

That is where the quadrature points lie and what they hold when the step begins, where on the step the edge
passes those that change sides, and the closure of the side that it does not pass. What is left is to fade:
two to four exponentials, and two products.
"""

from __future__ import annotations

import math
from dataclasses import replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from validation.reference.path import fields
from validation.reference.path.closure import BASE, Closure, closure, zone_length
from validation.reference.path.edge_law import EdgeLaw
from validation.reference.path.fields import Passed, Passing, Points
from validation.reference.path.memory import (
    COLLOCATION,
    Collocated,
    ConstantRate,
    Motion,
    collocated,
    through_nodes,
)
from validation.reference.path.numerics import ORDERS, inverse, powers, total
from validation.reference.path.path import Leg, PathSegment
from validation.reference.path.rheology import IndentedBody
from validation.reference.path.state import GRADING, State

Array = NDArray[np.float64]


SECANT = 1e-4
"""Change of the load parameter that tells a slope of the residual, in a step: the root is as much closer."""


class Trial:
    """The step from a state along a segment; its end radius is where the segment ends.

    What has the radius in it is measured from the edge where the step begins, and so is the load parameter.
    ``closed``: whether the edge condition is asked for.
    """

    def __init__(
        self,
        body: IndentedBody,
        law: EdgeLaw,
        state: State,
        leg: Leg,
        segment: PathSegment,
        closed: bool = True,
    ) -> None:
        self.body, self.law, self.state, self.leg, self.segment = body, law, state, leg, segment
        self.closed, self.travel = closed, segment.travel
        self.radius, self.zone = state.radius + self.travel, law.zone
        if law.cohesive:  # a guess
            self.zone = min(state.zone or law.zone, 0.5 * self.radius)
        if self.radius <= 0.0:
            self.radius, self.travel = 0.0, -state.radius
        self._guess = self.zone
        self.direction = float(np.sign(self.travel))
        self.closure: Closure | None = None
        self._layered: dict[int, Passed] = {}
        self._cuts = state.cuts(self.travel, body.transform.knots)
        none, edge = np.zeros(0), np.array([self.travel])
        if closed and law.adhesion is None:
            self._lay(none if self.direction > 0.0 else edge, none if self.direction < 0.0 else edge)
        elif closed and not law.cohesive:
            self._close(self.zone)
        else:
            self._lay(none, none)

    # what does not depend on the end ---

    def _close(self, zone: float) -> None:
        """Set up the closure over a zone."""
        self.zone = zone
        form = self.closure = closure(self.radius, zone, self.state.breaks(self.travel, zone))
        self._lay(self.travel - zone + form.s, self.travel + form.s)

    def _lay(self, behind: Array, ahead: Array) -> None:
        """Points behind and ahead of the end, and of the sweep; those that change sides are on one side."""
        edge = self.travel  # a point that rounds onto it is in contact, as in the table
        x = np.concatenate((np.minimum(behind, edge), np.maximum(ahead, np.nextafter(edge, np.inf))))
        self.passed: Passed | None = None
        if not self.direction:
            self._phi, self._G, self._begun = self.state.carried(self.body, x)
            return
        low, high = sorted((0.0, edge))
        changing = (x > low) & (x <= high)
        changing[slice(0, len(behind)) if edge < 0.0 else slice(len(behind), None)] = False
        self._changing = changing.nonzero()[0]
        sweep, u_powers = self._swept(self._cuts, x[self._changing])
        carried = self.state.carried(
            self.body, np.concatenate((x, np.maximum(sweep.x, np.nextafter(low, np.inf))))
        )
        at = np.concatenate((self._changing, np.arange(len(x), len(carried[0]))))
        phi, G, begun = carried
        self._phi, self._G, self._begun = phi[: len(x)], G[: len(x)], begun[: len(x)]
        changed = phi.take(at, axis=0), G[at], begun.take(at, axis=0)
        self.passed = Passed(u_powers, *changed, sweep)

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
            self._layered[count] = Passed(u_powers, *carried, sweep)
        return self._layered[count]

    # an end ---

    def arrive(self, rise: float) -> Arrival:
        """The end of the step after a rise of the load parameter."""
        state, leg, rheology = self.state, self.leg, self.body.rheology
        course = self.segment.parameter + rise * self.segment.basis
        clock = course if leg.timed else np.zeros_like(course)
        layer = self.body.image.is_layer
        if leg.rate is not None and not layer:
            steady = ConstantRate(rheology.times, clock, rheology.moduli, state.depth, leg.rate)
            return Arrival(self, rise, steady)
        depths = self.segment.depths.copy()
        if leg.rate is not None:
            depths[:, 0] = leg.rate * clock
        elif not leg.free:
            through = through_nodes(leg.value, state.parameter, course)
            depths = np.vstack((depths, np.zeros((len(through) - len(depths), depths.shape[1]))))
            depths[:, 0] = through
        depths[0] = state.depths
        motion = collocated(rheology.times, clock, rheology.moduli, depths)
        unknown = (leg.free or layer) and self.segment.basis.any()
        if not unknown or not self.within_reach:
            return Arrival(self, rise, motion)
        return self._balanced(rise, motion)

    def _balanced(self, rise: float, motion: Collocated) -> Arrival:
        """The end at which the load is as it has to be, and ``q`` of ``C`` is ``M q``.

        Both are affine in what the penetrations change by.
        """
        leg, value, rheology = self.leg, self.leg.value(self.state.parameter + rise), self.body.rheology
        coupling, basis = self.body.image.coupling, np.zeros((len(motion.depths), 1))
        basis[: len(self.segment.basis), 0] = self.segment.basis
        each = motion.under(basis)
        moments, slopes = self.moments(motion), self._response(each)
        gained, depths = motion.end
        kept = self.state.memory @ (rheology.moduli * motion.fading)
        matrix = -coupling @ slopes
        matrix.flat[:: len(matrix) + 1] += rheology.relaxed + each.gained
        lack = coupling @ moments - rheology.relaxed * depths - total(gained) - kept
        if leg.control == "force":
            matrix[0], lack[0] = 2.0 * slopes[0], value - 2.0 * moments[0]
        else:
            soft = 2.0 * leg.compliance
            matrix[0], lack[0] = soft * slopes[0], value - depths[0] - soft * moments[0]
            matrix[0, 0] += 1.0
        free = np.asarray(np.linalg.solve(matrix, lack), float)
        motion = motion.under(motion.depths + basis * free)
        return Arrival(self, rise, motion, free, 2.0 * float(moments[0] + slopes[0] @ free))

    def integral(self, motion: Motion, passing: Passing | None) -> float:
        """Closure integral; without a zone the strain at the edge: behind it, unless it covers."""
        rheology, form, covers = self.body.rheology, self.closure, self.direction > 0.0
        if form is None:
            if covers:
                return self.overlap(motion)
            return (
                float(self.stress(self._phi[:1], self._G[:1], self._begun[:1], motion)[0]) / rheology.glassy
            )
        count, depths = len(form.s), motion.end[1]
        fresh = np.exp(-motion.duration / rheology.retardation)
        q = self.stress(self._phi[:count], self._G[:count], self._begun[:count], motion)
        d = self._begun[count:] @ fresh - self._phi[count:] @ depths + self._G[count:]
        if passing is not None and len(at := self._changing):
            changed, strain = total(passing.end[: len(at)]), self._phi[at] @ depths - self._G[at]
            if covers:
                q[at] = rheology.relaxed * strain + changed
            else:
                d[at - count] = changed - strain
        return form.between(q, d)

    def overlap(self, motion: Motion) -> float:
        """Strain by which the surface is within the indenter next to an edge that covers or stays."""
        fresh = np.exp(-motion.duration / self.body.rheology.retardation)
        return float(self._phi[-1] @ motion.end[1] - self._G[-1] - self._begun[-1] @ fresh)

    def stress(self, phi: Array, G: Array, begun: Array, motion: Motion) -> Array:
        """``q`` at the end at points that stay in contact."""
        rheology = self.body.rheology
        gained, depths = motion.end
        q: Array = phi @ (rheology.relaxed * depths + gained.sum(axis=1)) - rheology.relaxed * G
        return q + begun @ motion.fading

    def zone_at_stress(self, motion: Motion) -> float:
        """Length of the zone that a cohesive stress makes at this end of the step."""
        rheology, depths = self.body.rheology, motion.end[1]

        def stress(x: Array) -> Array:
            x = np.minimum(self.travel + x, self.travel)
            phi, G, begun = self.state.carried(self.body, x)
            q = self.stress(phi, G, begun, motion)
            if self.direction > 0.0:
                new = (x > 0.0).nonzero()[0]
                u_powers = powers(inverse(self.segment.way, x[new]), COLLOCATION)
                passing = self.passes(Points(u_powers, phi[new], G[new], begun[new]), motion)
                q[new] = rheology.relaxed * (phi[new] @ depths - G[new]) + total(passing.end)
            return q

        within = self.state.edges_between(-self.state.radius, self.travel)
        edges = np.union1d(within - self.travel, self._guess * (BASE - 1.0))
        return zone_length(stress, edges, self.radius, self.law.cohesive, self.law.zone, self.zone)

    def fits(self, motion: Motion) -> bool:
        """Give the zone the length that its stress makes at an end; whether the edge condition is told."""
        if self.closed and self.law.cohesive:
            zone = self.zone_at_stress(motion)
            if not math.isfinite(zone):
                return False
            if self.closure is None or zone != self.zone:
                self._close(zone)
        return self.closed and self.within_reach

    @property
    def within_reach(self) -> bool:
        """Whether the functions of a layer are known up to the end of the zone."""
        return self.radius + self.zone <= self.body.image.reach

    def passes(self, points: Points, motion: Motion) -> Passing:
        """Points that change sides in this step."""
        return fields.passing(self.body.rheology, self.direction > 0.0, points, motion)

    def force(self, motion: Motion, passing: Passing | None = None) -> float:
        """``F = 2 int_0^a q dx``."""
        return 2.0 * float(self.moments(motion, passing)[0])

    def moments(self, motion: Motion, passing: Passing | None = None) -> Array:
        """``int_0^a phi q dx`` (K + 1,).

        What the contact held before has faded, what it gained is integrated.
        """
        rheology, state, a = self.body.rheology, self.state, self.radius
        gained, depths = motion.end
        if a == 0.0:  # not the rounding of what there was
            return 0.0 * depths
        gram, shape = self.body.integrals(a)
        moments: Array = rheology.relaxed * (gram @ depths - shape) + self.rest.held @ motion.fading
        moments += self.body.integrals(min(a, state.radius))[0] @ total(gained)
        if self.passed and self.direction > 0.0:
            moments += total(self.swept_up(self.passed, motion, passing)[0])
        return moments

    def _response(self, free: Collocated) -> Array:
        """``int_0^a phi q`` under a motion of each of the penetrations (K + 1, K + 1)."""
        body = self.body
        staying = body.integrals(min(self.radius, self.state.radius))[0]
        response: Array = body.rheology.relaxed * body.integrals(self.radius)[0] + free.gained * staying
        if self.passed and self.direction > 0.0:
            points = self._over(self.passed, free.duration)
            phi, covered = points.phi[points.swept], total(self.passes(points.bare, free).end)[points.swept]
            response += phi.T @ (phi * (points.sweep.weight * covered)[:, None])
        return response

    def swept_up(self, passed: Passed, motion: Motion, passing: Passing | None) -> tuple[Array, Array]:
        """Integrals over what the step passed of branch forces or unit strains at the end, and of squares."""
        points = self._over(passed, motion.duration)
        if passing is None or points is not passed:
            passing = self.passes(points, motion)
        end, weight = passing.end[points.swept], points.sweep.weight
        return (points.phi[points.swept].T * weight) @ end, weight @ end**2

    @cached_property
    def rest(self) -> State:
        """The state as the step begins, its integrals without the radii that the step passes."""
        state, passed = self.state, self.passed
        if passed is None:
            return state
        swept, weight = passed.swept, passed.sweep.weight
        begun = passed.begun[swept]
        moments, squares = (passed.phi[swept].T * weight) @ begun, weight @ begun**2
        if self.direction < 0.0:
            return replace(state, held=state.held - moments, held_squares=state.held_squares - squares)
        return replace(state, free=state.free - moments, free_squares=state.free_squares - squares)


class Arrival:
    """The end of a step after a rise of the load parameter.

    ``integral`` is that of the closure, or the edge strain. ``free`` (K + 1,): what the penetrations end at
    besides what the segment says.
    """

    def __init__(
        self,
        trial: Trial,
        rise: float,
        motion: Motion,
        free: Array | None = None,
        force: float | None = None,
    ) -> None:
        self.trial, self.rise, self.motion = trial, rise, motion
        self.free = 0.0 * motion.end[1] if free is None else free
        told = trial.fits(motion)
        self.passing = trial.passes(trial.passed, motion) if trial.passed else None
        self.integral = trial.integral(motion, self.passing) if told else math.nan
        if force is not None:
            self.force = force

    @property
    def duration(self) -> float:
        """Length of the step in time."""
        return self.motion.duration

    @property
    def depth(self) -> float:
        """Penetration."""
        return float(self.motion.end[1][0])

    @cached_property
    def force(self) -> float:
        """The force."""
        return self.trial.force(self.motion, self.passing)

    @property
    def parameter(self) -> float:
        """Load parameter; that of the leg where it rounds onto its end."""
        start, end = self.trial.state.parameter, self.trial.leg.end
        return end if self.rise == end - start else start + self.rise

    @property
    def pace(self) -> float:
        """Slope of the load parameter over the step."""
        return float((self.trial.segment.parameter + self.rise * self.trial.segment.basis) @ ORDERS)

    @property
    def speed(self) -> float:
        """``da/dt``."""
        slope, time = float(self.trial.segment.way @ ORDERS), float(self.motion.clock @ ORDERS)
        return slope / time if time else math.copysign(math.inf, slope)

    # the edge condition ---

    @cached_property
    def residual(self) -> float:
        """How far the edge is from its law: rises with the radius through zero where the edge is stable."""
        trial, law, value = self.trial, self.trial.law, self.integral
        if not math.isfinite(value):
            return math.nan
        if trial.direction == 0.0:
            return self.pull()
        if law.adhesion is None:
            return -value / self._strain
        if trial.direction > 0.0:
            return law.closing(value)
        return law.opening(value, -self.speed if trial.leg.timed else math.inf, self.duration)

    @property
    def _strain(self) -> float:
        """Size of the strains of a contact without adhesion."""
        trial = self.trial
        return (abs(self.depth) + trial.body.shape(max(trial.radius, trial.state.radius))) or 1.0

    def pull(self, slack: float = 0.0) -> float:
        """How far a resting edge is beyond its range: positive opens, negative closes, 0 rests.

        Without adhesion it rests where it is pressed behind and open ahead.
        """
        trial, law, value = self.trial, self.trial.law, self.integral
        if law.adhesion is None:
            opens, closes = -value / self._strain, -trial.overlap(self.motion) / self._strain
        else:  # where time stands no speed is finite
            taken = law.adhesion.work if trial.leg.timed else law.adhesion.opening(math.inf)
            opens, closes = value / taken - 1.0, law.closing(value)
        if trial.radius > 0.0 and opens > slack:
            return opens
        return closes if closes < -slack and not law.at_rim(trial.radius) else 0.0

    # what is left ---

    def after(self) -> State:
        """The state at the end: integrals over contact and free surface recur exactly."""
        trial, motion, rest, state = self.trial, self.motion, self.trial.rest, self.trial.state
        rheology, leg, parameter = trial.body.rheology, trial.leg, self.parameter
        gained, depths = motion.end
        fading = motion.fading
        recovering = np.exp(-motion.duration / rheology.retardation)
        added = trial.body.integrals(min(trial.radius, state.radius))[0] @ gained
        squares = fading**2 * rest.held_squares + (gained * (2.0 * fading * rest.held + added)).sum(axis=0)
        held = fading * rest.held + added
        free, free_squares = rest.free * recovering, rest.free_squares * recovering**2
        surface, passed, passing = state.surface, trial.passed, self.passing
        if passed is not None and passing is not None:
            sweep, swept, opens = passed.sweep, passed.swept, trial.direction < 0.0
            elapsed, left = passing.elapsed[swept], passing.left[swept]
            ends = trial.swept_up(passed, motion, passing)
            if opens:
                free, free_squares = free + ends[0], free_squares + ends[1]
            else:
                held, squares = held + ends[0], squares + ends[1]
                remembered = passed.phi[swept] @ (rheology.moduli * state.memory)
                left = left - remembered * np.exp(-elapsed / rheology.times)
            G = passed.G[swept]
            surface = fields.passed(surface, sweep, elapsed, left, not opens, G, rheology.moduli)
        return State(
            parameter=parameter,
            time=leg.origin + parameter if leg.timed else state.time,
            depths=depths if leg.free else np.append(leg.value(parameter), depths[1:]),
            radius=trial.radius,
            force=leg.value(parameter) if leg.control == "force" else self.force,
            memory=fading * state.memory + gained / rheology.moduli,
            surface=surface.seen_from(trial.travel, trial.radius, self.duration),
            held=held,
            held_squares=squares,
            free=free,
            free_squares=free_squares,
            layer=min(state.layer, rheology.shortest * self.speed)
            if trial.direction > 0.0 and self.duration
            else state.layer,
            zone=trial.zone,
        )

    def edge_stress(self) -> tuple[Array, Array]:
        """``u`` and ``q`` just inside the edge, at both ends of the step and where it passes its points."""
        trial, passing, passed = self.trial, self.passing, self.trial.passed
        rheology = trial.body.rheology
        if passing is None or passed is None:
            u_powers = powers(np.concatenate(([0.0], fields.NODES, [1.0])), COLLOCATION)
            carried = trial.state.carried(trial.body, np.zeros(len(u_powers)))
            passing = trial.passes(Points(u_powers, *carried), self.motion)
            return u_powers[:, 1], rheology.stress(passing.branches, passing.strain)
        swept = passed.swept
        return passed.u_powers[swept, 1], rheology.stress(passing.branches[swept], passing.strain[swept])

    def part(self, u: float) -> Arrival:
        """The end of the step cut off at ``u``, without closure: a point of the dense path."""
        trial = self.trial
        segment = trial.segment.cut(u, self.rise, self.free)
        part = Trial(trial.body, trial.law, trial.state, trial.leg, segment, closed=False)
        return part.arrive(float(segment.parameter.sum()))

    def corrected_force(self, u: float) -> float:
        """The force at the radius that the dense path has at ``u``, where the edge condition holds."""
        trial = self.trial
        segment = trial.segment.cut(u, self.rise, self.free, loose=True)
        part = Trial(trial.body, trial.law, trial.state, trial.leg, segment)
        rise = float((trial.segment.parameter + self.rise * trial.segment.basis) @ u**ORDERS)
        apart = SECANT * self.rise
        first, second = (part.arrive(rise + shift).residual for shift in (0.0, apart))
        return part.arrive(rise - first * apart / (second - first)).force
