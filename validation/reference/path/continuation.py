"""Continuation of the edge along its path, step by step, whatever drives it.

A step goes a way ``h`` in the plane of ``p/T`` and ``a/L``, predicted by the polynomial through the rows
since the last kink. Then either the radius is what was predicted, and the load parameter is the root of the
edge condition, which needs one geometry; or, where the edge hardly moves, the other way about; or the edge
rests. At a limit point of the load the radius is fixed, and nothing special happens.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from validation.reference.path import events
from validation.reference.path.numerics import DEGREE, bracketed
from validation.reference.path.tracker import RESIDUAL, Correction, Ending, Fixed, Plan, Tracker
from validation.reference.path.trial import Arrival, Trial

Array = NDArray[np.float64]

REJECTED = 2.5
"""Error, in tolerances, above which a step is repeated."""
LEAST_WEIGHT = 0.3
"""Of what a short step is mispredicted by: it stays in the fields over its way, but the force shows it."""
LEAST_SHARE = 0.1
"""Of what all steps over one scale may add up to: shorter steps are those after a kink, and few."""
LARGEST_GROWTH, LEAST_GROWTH = 3.0, 0.3
"""Ratio of successive steps."""
RUNG = 2.0**0.25
"""Ratio of neighbouring changes of the step; the lower one is taken, so that rounding chooses none."""
ALIKE = 0.99
"""Ratio of two steps that are the same: rounding does not choose between the orders that promise them."""
SMALLEST_STEP = 1e-10
"""Below it the edge condition has no root to be found here: see what became of the contact."""
UNSEEN = 0.25
"""Next step, in one that no correction was found for."""
DEPARTURES = 3
"""Times that a departure is looked for, each with the step that ended at the one before."""
TURNED = 0.01
"""Slope back, in the mean slope of a step, from which on the edge has turned: 1e-5 of the step is lost."""
SPEED = 100.0
"""Misprediction, in tolerances, as bad as one of all of the duration of a step, where the law asks for the
speed of the edge: a collapse takes no time to speak of, and is not seen on the scale of time."""
NARROW = 1e-4
"""Change of a root by a secant, relative to it and in tolerances, with which it is found."""
SECANTS = 12
"""Most secants: they converge in four, or do not."""
SEEN = 1e6
"""Difference of two radii, in zones and the rounding of the residual, that tells the slope."""
UNFORESEEN = 1e-2
"""Longest first step after a kink, whichever way the path then goes."""


def on_ladder(ratio: float) -> float:
    """The next lower power of the ratio of rungs."""
    return float(RUNG ** math.floor(math.log(ratio) / math.log(RUNG)))


class Continuation(Tracker):
    """A run that goes on along its path."""

    def step(self) -> Ending:
        """One attempt; what it came to."""
        self.rescale()
        plan = events.plan(self)
        correction = self._correct(plan)
        error = math.inf if correction is None else correction.error / self._allowed(plan)
        first = len(self.rows) == 1
        if first and correction is not None:
            error *= 0.0  # nothing to judge by: the first step is small; no number stays none
            far = correction.s > max(UNFORESEEN, LARGEST_GROWTH * plan.h)
            if far and plan.fixed is Fixed.RADIUS:  # it is not: the path goes elsewhere
                way = np.array([correction.arrival.rise / self.T, correction.trial.travel / self.L])
                error, self.tangent = math.inf, way / np.hypot(*way)
        if correction is not None and error <= REJECTED:
            passed_by = self._falls(plan, correction) or self._turns(correction.trial)
            error = math.inf if passed_by else error
        if correction is None or not error <= REJECTED:
            return self._reject(plan, correction, error)
        self.fails = 0
        correction = events.to_level(self, plan, correction)
        order, growth = self._order(plan, correction, error)
        events.finish(self, plan, correction)
        self.rows.order = min(len(self.rows), order)
        if plan.event is Ending.NONE:
            self.h = (correction.s if first else plan.h) * on_ladder(max(LEAST_GROWTH, growth))
        return plan.event

    def _allowed(self, plan: Plan) -> float:
        """Misprediction by the tolerance over a way of one scale: what a step leaves counts with its way.

        Where the penetration follows from a force its error is one of the whole contact, and counts as it is.
        Under a load that stands still nothing brings the edge back to where it should be at that time: the
        errors of all steps add up, and each may make its share.
        """
        way = min(1.0, plan.h)
        if not self.leg.free:
            return self.tolerance / max(LEAST_WEIGHT, way)
        return self.tolerance * (max(LEAST_SHARE, way) if self.leg.stands else 1.0)

    def _falls(self, plan: Plan, correction: Correction) -> bool:
        """Whether a step ends beyond a limit point that was not foreseen."""
        trial = correction.trial
        if plan.fixed is not Fixed.RADIUS or plan.event in (Ending.FOLD, Ending.END):
            return False
        rise = trial.segment.parameter + correction.arrival.rise * trial.segment.basis
        return float(rise @ np.arange(len(rise))) < 0.0 and (self.law.zone > 0.0 or trial.direction > 0.0)

    def _turns(self, trial: Trial) -> bool:
        """Whether the edge turns within a step: then its path is no function of the radius."""
        if not trial.direction:
            return False
        way, orders = trial.segment.way, np.arange(DEGREE + 1)
        slopes = np.array([way[1], way @ orders]) * trial.direction
        return bool(slopes.min() < -TURNED * abs(trial.travel) - self.still)

    def _order(self, plan: Plan, correction: Correction, error: float) -> tuple[int, float]:
        """How many rows are to predict the next step for it to be longest, and how long it is in this one.

        The more of them where the step may grow as it likes: turns and folds are seen on the predictor.
        Beyond a bend of the path a parabola goes farther than a polynomial that reaches back over it.
        """

        def growth(off: Array, rows: Array) -> Array:
            return np.minimum(np.maximum(off, 1e-5) ** (-1.0 / (rows + 1.0)), LARGEST_GROWTH)

        known, off = len(self.rows), np.array([error])
        if plan.fixed is not Fixed.REST and known > 1:
            off = self._errors(plan, correction)
            each = growth(off, np.arange(1.0, known + 1.0))
            best = known - int((each[:0:-1] > ALIKE * each[1:].max()).argmax())
            if best < known:
                return best, float(each[best - 1])
        rows = min(known + 1, self.rows.kept)
        return rows, float(growth(off[-1:], np.array([rows]))[0])

    def _errors(self, plan: Plan, correction: Correction) -> Array:
        """Errors of a step had the last 1, 2, ... rows predicted it."""
        trial, arrival = correction.trial, correction.arrival
        force = trial.force_at(arrival)
        row = np.array([arrival.rise, trial.travel, arrival.depth, force])
        scales = np.array([self.T, self.L, self.depth, self.largest_force or 1.0])
        p, a, D, F = self.rows.mispredicted(plan.h, row, scales).T
        across, along = (
            p * plan.tangent[1] - a * plan.tangent[0],
            p * plan.tangent[0] + a * plan.tangent[1],
        )
        depth = D - along * plan.tangent[2] if self.leg.free else 0.0
        load = F - along * plan.tangent[3] / scales[3]
        return np.asarray(np.sqrt(across**2 + depth**2 + load**2) / self._allowed(plan))

    def _reject(self, plan: Plan, correction: Correction | None, error: float) -> Ending:
        """Try a shorter step; where none is short enough, look what became of the contact.

        It has come to a bend of the path, beyond which it is mispredicted by the square of the way.
        """
        self.rejected += 1
        self.fails += 1
        share = UNSEEN
        if correction is not None and math.isfinite(error):
            if plan.fixed is not Fixed.REST and len(self.rows) > 2:
                off = self._errors(plan, correction)[1:]
                if off.min() < error:
                    error, self.rows.order = float(off.min()), 2 + int(off.argmin())
            share = on_ladder(min(max(error ** (-1.0 / 3.0), 0.1), 0.8))
        self.h = plan.h * share
        self.slopes = {}
        if self.h < SMALLEST_STEP or self.fails > 40:
            self.fails = 0
            known = self.tolerance * self.state.radius
            return Ending.FOLD if self.moving and events.runs_away(self, known) else Ending.LOST
        return Ending.REJECTED

    def _correct(self, plan: Plan) -> Correction | None:
        if plan.fixed is Fixed.RADIUS:
            return self._at_radius(plan)
        if plan.fixed is Fixed.REST:
            rested = self._at_rest(plan)
            if rested is not None:
                return rested
            plan.fixed = Fixed.LOAD
        elif self.law.rests(self.state.radius):
            stopped = self._stopped(plan)
            if stopped is not None:
                return stopped
        return self._at_load(plan)

    def chord(self, p: float, a: float) -> float:
        """Arclength from the last row of a point that far from it."""
        return math.hypot(p / self.T, a / self.L)

    def mispredicted(self, plan: Plan, trial: Trial, arrival: Arrival) -> float:
        """Distance of a corrected point from the predicted one: across the path, and in depth and force."""
        off_p, off_a = arrival.rise / self.T - plan.z[0], trial.travel / self.L - plan.z[1]
        across = off_p * plan.tangent[1] - off_a * plan.tangent[0]
        depth = arrival.depth / self.depth - plan.z[2] if self.leg.free else 0.0
        force = trial.force_at(arrival)
        self.largest_force = max(self.largest_force, abs(self.state.force))
        load = (force - plan.z[3]) / (self.largest_force or 1.0)
        speed = 0.0
        if self.law.rated and self.leg.timed and trial.direction < 0.0 < arrival.rise:
            speed = SPEED * self.tolerance * abs(off_p) * self.T / arrival.rise
        return max(math.hypot(across, depth, load), speed)

    def _at_radius(self, plan: Plan) -> Correction | None:
        """The load parameter at which the edge is at the predicted radius."""
        p, a = plan.z[0] * self.T, plan.z[1] * self.L
        s = self.chord(p, a)
        trial = self.trial(a, s)
        found = self.solve_parameter(trial, p, 1e-3 * (p if p > 0.0 else self.h * self.T))
        if found is None:
            return None
        arrival, steepness = found
        new = len(self.rows) == 1
        far = abs(arrival.rise - p) > 10.0 * plan.h * self.T
        left = self.leg.end - self.state.parameter
        if new and arrival.rise > left:  # the leg ends before
            plan.event, plan.z[1] = Ending.END, plan.z[1] * left / arrival.rise
            return self._at_load(plan)
        if (far and not new) or arrival.rise > left + 1e-12 * self.leg.end:
            return None
        error = self.mispredicted(plan, trial, arrival)
        rounding = self.noise / abs(steepness or math.inf) / self.T
        s = self.chord(arrival.rise, a) if new else s  # no load was predicted
        return Correction(trial, arrival, max(error - rounding, 0.0), s)

    def solve_parameter(self, trial: Trial, p: float, size: float) -> tuple[Arrival, float] | None:
        """The end of a trial at which the edge condition holds, and the slope of the residual."""
        ends: dict[float, Arrival] = {}

        def function(at: float) -> float:
            value, ends[at] = self.residual(trial, at)
            return value

        root = self._secants(function, max(p, 0.0), size, Fixed.RADIUS, 0.0)
        return None if root is None else (ends[root], self.slopes.get(Fixed.RADIUS, math.inf))

    def _load(self, plan: Plan) -> float:
        """The rise that a step is to end at: exactly that at the end of a leg."""
        return self.leg.end - self.state.parameter if plan.event is Ending.END else plan.z[0] * self.T

    def _at_load(self, plan: Plan) -> Correction | None:
        """The radius at which the edge is at the predicted load."""
        p, guess = self._load(plan), plan.z[1] * self.L
        if p <= 0.0:
            return None
        zone = self.law.zone
        trials: dict[float, tuple[Trial, Arrival]] = {}

        def function(a: float) -> float:
            if not self.least_radius <= self.state.radius + a <= self.law.rim:
                return math.nan
            trial = self.trial(a, self.chord(p, a))
            value, arrival = self.residual(trial, p)
            trials[a] = trial, arrival
            return value

        size = 1e-3 * max(plan.h, 1e-6) * self.L * min(1.0, zone / self.L if zone else 1.0)
        size = max(size, zone * min(0.01, SEEN * self.noise))
        # after a kink no direction is known
        near = self.L * (10.0 * max(plan.h, 1e-9) if len(self.rows) > 1 else UNFORESEEN)
        if self.law.rated and guess >= 0.0 and self.leg.timed:
            function(0.0)
            allowed = self.law.allowed_speed(trials[0.0][1].integral)
            if allowed > 0.0:
                guess = -min(allowed * p, near)
                size = -0.5 * guess
        root = self._secants(function, guess, size, Fixed.LOAD, -math.inf)
        if root is None or abs(root - guess) > near:
            return None
        trial, arrival = trials[root]
        error = self.mispredicted(plan, trial, arrival)
        return Correction(trial, arrival, error, self.chord(p, root))

    def _at_rest(self, plan: Plan) -> Correction | None:
        """The edge stays; if it would set off, the step ends there. ``None``: it moves at once."""
        p = self._load(plan)
        trial = self.trial(0.0, self.chord(p, 0.0))

        def pull(at: float) -> tuple[float, Arrival]:
            self.evaluations += 1
            arrival = trial.arrive(at)
            return self.law.pulls(trial, arrival, not self.leg.timed, self.noise), arrival

        value, arrival = pull(p)
        if value > 0.0 and self.law.rated and self.leg.timed:  # it has a speed, seen or not
            travel = self.law.allowed_speed(arrival.integral) * p
            if travel > 0.1 * self.still:
                return None
            value = 0.0
        elif value != 0.0 and self.law.adhesion is not None and not self._sets_off(p, value):
            value = 0.0
        if value != 0.0:
            end = p
            if pull(0.0)[0] != 0.0:
                return None
            for _ in range(DEPARTURES):
                p = events.departure(lambda at: pull(at)[0], end, 1e-13 * self.T)
                trial = self.trial(0.0, self.chord(p, 0.0))
            arrival = trial.arrive(p)
            plan.event = Ending.DEPARTURE
        error = 0.0 if plan.event is Ending.DEPARTURE else self.mispredicted(plan, trial, arrival)
        return Correction(trial, arrival, error, self.chord(p, 0.0))

    def _sets_off(self, p: float, pull: float) -> bool:
        """Whether an edge that is pulled at the load is so still after a travel that is seen."""
        travel = -math.copysign(self.still, pull)
        trial = self.trial(travel, self.chord(p, travel), 1)
        return self.residual(trial, p)[0] * pull > 0.0

    def _stopped(self, plan: Plan) -> Correction | None:
        """The edge, which moved, is at rest at the load: what it still travels in the step is the error."""
        p = self._load(plan)
        trial = self.trial(0.0, self.chord(p, 0.0), 1)
        arrival = trial.arrive(p)
        pulled = self.law.pulls(trial, arrival, not self.leg.timed, -self.noise)
        if p <= 0.0 or pulled != 0.0:
            return None
        if plan.event is Ending.NONE:
            plan.event = Ending.TURN
        return Correction(trial, arrival, self.mispredicted(plan, trial, arrival), self.chord(p, 0.0))

    def _secants(
        self,
        function: Callable[[float], float],
        x: float,
        size: float,
        of: Fixed,
        least: float,
    ) -> float | None:
        """Root by secants; where rounding stops them, the best point if it is one.

        Where they lose their way, it is looked for between points on either side of it. Without adhesion the
        residual rises with the radius at rest, too, and jumps where the edge has left a jump: there it rests.
        """
        f = function(x)
        enough = RESIDUAL if of is Fixed.RADIUS else self.noise
        timeless = of is Fixed.RADIUS and not self.law.rated  # a speed is known closer than the time
        rounding = 4.0 * math.ulp(self.state.parameter) if timeless else 0.0
        if abs(f) < enough:
            return x
        slope = self.slopes.get(of)
        after = x - f / slope if slope else (x + size if of is Fixed.RADIUS else x - math.copysign(size, f))
        best, sides = (abs(f), x), {f > 0.0: x}
        for count in range(SECANTS):
            if slope and after == x:  # no number lies closer
                return x
            after = max(after, least)
            value = function(after)
            if not math.isfinite(value) or value == f or after == x:
                break
            if count and self.noise > abs(value) > 0.1 * abs(f):  # rounding: no secant leads closer
                return min(best, (abs(value), after))[1]
            slope = (value - f) / (after - x)
            best, sides[value > 0.0] = min(best, (abs(value), after)), after
            x, f = after, value
            after = x - f / slope
            found = max(NARROW * self.tolerance * abs(x), rounding)
            if abs(f) < enough or abs(after - x) < found:
                self.slopes[of] = slope
                return x
        first, last = sides.get(True, 0.0), sides.get(False, 0.0)
        one_way = of is Fixed.LOAD and first * last > 0.0  # at rest the edge changes its law
        jumps = of is Fixed.LOAD and not self.law.zone and len(sides) > 1 and last < first
        if jumps and last < 0.0 < first:
            value = function(0.0)
            if value == 0.0:
                return 0.0
            first, last = (0.0, last) if value > 0.0 else (first, 0.0)
        if best[0] >= 10.0 * self.noise and (one_way or jumps):
            x = bracketed(function, first, last, NARROW * self.tolerance * max(abs(first), abs(last)))
            if jumps:
                return x
            best = abs(function(x)), x
        return best[1] if best[0] < 10.0 * self.noise else None
