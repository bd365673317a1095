"""Where a run is on the path of its edge: state, rows, scales of load parameter and radius, and the residual.

``T`` is half the time since the leg began: a leg may last 1e8 times as long as what happens first in it.
``L`` is half the way since the edge turned. Both start anew at a turn of the edge.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from enum import StrEnum
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from validation.reference.path import kinks
from validation.reference.path.edge_law import EdgeLaw
from validation.reference.path.equilibrium import pressed_radius, start_state, touching_radius
from validation.reference.path.numerics import DEGREE, bracketed
from validation.reference.path.path import Leg, Rows
from validation.reference.path.rheology import Body
from validation.reference.path.state import State
from validation.reference.path.trial import Arrival, Trial

Array = NDArray[np.float64]
Level = Callable[[float, float, float], float]
"""How far penetration, force and radius are beyond a level."""

FIRST_STEP = 1e-3
"""First step of a leg, in parts of the shortest time and of the zone."""
SEEN_TIME = 1e-9
"""Least first step, in the scale of time, where no branch holds anything that would relax sooner."""
STILL = 1e-6
"""Travel of the edge, in zones, below which it is at rest."""
LOST_FORCE = 1e-12
"""Force without adhesion, in the largest, at which contact is lost."""
LEAST_CHANGE = 1e-9
"""Penetration after the first step of a new contact, in the largest: what it adds is not known better."""
FIRST_RADIUS = 1e-2
"""Least radius of the first step of a new contact, in the scale of the radius."""
SMALL_PART = 0.1
"""Scales of radius and penetration, in the largest of the run."""
RESIDUAL = 1e-12
"""At a root. What rounding leaves of short zones is the same at each end of a step: asked for is more."""


class Ending(StrEnum):
    """What a step came to."""

    NONE = ""
    REJECTED = "rejected"
    END = "end of the leg"
    LEVEL = "level"
    TURN = "turn"
    DEPARTURE = "departure"
    TOWARDS = "towards a fold"
    FOLD = "fold"
    LEAST = "smallest radius"
    RIM = "rim"
    LOST = "lost"


class Fixed(StrEnum):
    """What a step ends at."""

    RADIUS = "radius"
    LOAD = "load"
    REST = "rest"


@dataclass
class Plan:
    """Where a step is to go: ``z = (p/T, a/L, D, F)`` after a way ``h``, and its slopes there.

    ``p`` and ``a`` are those since the step began.
    """

    h: float
    z: Array
    tangent: Array
    fixed: Fixed
    event: Ending = Ending.NONE


@dataclass(frozen=True)
class Correction:
    """A step that satisfies the edge condition, by how much it was mispredicted, and its arclength."""

    trial: Trial
    arrival: Arrival
    error: float
    s: float


@dataclass
class Tracker:
    """A run in progress.

    ``T``, ``L``, ``depth``: scales of load parameter, radius and penetration; ``L_run`` the largest of the
    radius. ``lasted``, ``travelled``: since the leg began and the edge set off. ``slopes``: of the residual
    over the load parameter and the radius, as last seen; they save evaluations.
    """

    body: Body
    law: EdgeLaw
    state: State
    tolerance: float
    L_run: float
    depth: float
    accepted: Callable[[Trial, Arrival, State, float], None] = lambda *_: None
    leg: Leg = None  # type: ignore[assignment]
    rows: Rows = None  # type: ignore[assignment]
    T: float = 1.0
    L: float = 1.0
    lasted: float = 0.0
    travelled: float = 0.0
    zone: float = 0.0
    T_leg: float = 1.0
    T_first: float = 1.0
    h: float = 1.0
    tangent: Array = field(default_factory=lambda: np.array([1.0, 0.0]))
    slopes: dict[Fixed, float] = field(default_factory=dict)
    fails: int = 0
    evaluations: int = 0
    geometries: int = 0
    steps: int = 0
    rejected: int = 0
    moving: bool = False
    direction: float = -1.0
    vertex: float = math.nan
    stuck_at: int = -1
    level: Level | None = None
    largest_force: float = 0.0

    @property
    def noise(self) -> float:
        """Residual below which there is only rounding: where a load is given, that of the largest load."""
        force = abs(self.state.force)
        if self.law.adhesion is None and self.leg.free and force > 0.0:
            return max(10.0 * RESIDUAL, math.ulp(1.0) * self.largest_force / force)
        return 10.0 * RESIDUAL

    @property
    def least_scale(self) -> float:
        """Scale of the radius where the edge sets off."""
        return self.law.zone or 1e-2 * self.L_run

    @property
    def still(self) -> float:
        """Travel that changes nothing an edge can see."""
        return STILL * self.least_scale

    def trial(self, travel: float, s: float, order: int = DEGREE) -> Trial:
        """The step that goes that far."""
        self.geometries += 1
        segment = self.rows.segment(s, travel, order)
        if self.law.cohesive:
            zone = min(self.zone or self.law.zone, 0.5 * (self.state.radius + travel))
            return Trial(self.body, self.state, self.leg, segment, zone, self.law.cohesive, self.law.zone)
        return Trial(self.body, self.state, self.leg, segment, self.law.zone)

    def residual(self, trial: Trial, rise: float) -> tuple[float, Arrival]:
        """Of the edge condition, at the end of a trial after a rise of the load parameter."""
        self.evaluations += 1
        arrival = trial.arrive(rise)
        return self.law.residual(trial, arrival, not self.leg.timed), arrival

    def begin(self, leg: Leg, T_leg: float) -> None:
        """A new leg: a kink of the path."""
        self.leg, self.T_leg, self.T = leg, T_leg, T_leg
        self.L, self.lasted = min(self.L_run, self.least_scale), 0.0
        self.state = replace(self.state, parameter=leg.start)
        state = self.state
        self.rows = Rows.at(state.depth, state.force)
        if state.radius == 0.0 and state.depth >= 0.0 and leg.presses:
            self.touch()
            return
        self.restart(np.array([1.0, 0.0]))
        self.moving = False
        if leg.timed:
            self.T_first = self.T = T_leg * self.h
            self.h = 1.0

    def touch(self) -> None:
        """The first step of a new contact, as if it were elastic: to a small part of the largest penetration.

        Until the shortest relaxation time only the load changes with time. A plane tip is in contact as a
        whole.
        """
        if self.law.tip:
            begun = start_state(self.body, self.state.depth, self.law.tip, True)
            self.state = replace(begun, parameter=self.state.parameter, time=self.state.time)
            self.restart()
            return
        leg, deepest = self.leg, LEAST_CHANGE * self.depth / SMALL_PART
        a = min(max(touching_radius(self.body, deepest, self.law.rim), FIRST_RADIUS * self.L_run), self.L_run)
        load = depth = self.body.shape(a)
        if leg.control == "force":
            load = 2.0 * self.body.rheology.glassy * (a * depth - self.body.transform.integral(a))
        whole, start = leg.end - leg.start, leg.value(leg.start)
        change = leg.value(leg.end) - start
        p = whole * min(load / (abs(change) or load), 1.0)
        if change > load:
            p = bracketed(lambda at: leg.value(leg.start + at) - start - load, 0.0, whole)
        elastic = min(self.T_leg, self.body.rheology.shortest)
        self.T_first, self.L = max(2.0 * p, elastic, 1e-300) if leg.timed else SMALL_PART, a
        self.T, self.lasted = self.T_first, 0.0
        way = np.array([p / self.T, a / self.L])
        self.restart(way / np.hypot(*way), float(np.hypot(*way)))
        self.moving = True

    def restart(self, tangent: Array | None = None, h: float | None = None) -> None:
        """A kink at the last row."""
        self.rows.restart()
        self.slopes = {}
        self.moving, self.vertex = tangent is not None and self.moving, math.nan
        self.tangent = np.array([1.0, 0.0]) if tangent is None else tangent
        zone = self.law.zone
        if h is None:
            quick = min(1.0, self.body.rheology.shortest / self.T) if self.leg.timed else 1.0
            h = FIRST_STEP * min(1.0, quick, zone / self.L if zone else 1.0)
            least = 0.0 if self.state.held.any() else SEEN_TIME
            h = max(h, least if self.leg.timed else 1e-4)
        self.h, self.travelled = h, 0.0
        self.state = kinks.faded(self.state, self.body, zone, self.tolerance)

    def turn_at(self, h: float) -> None:
        """The edge turns at the last row; the next step is ``h``, and the scales grow anew from there."""
        self.restart(h=h)
        if self.leg.timed:
            self.lasted = 0.0
            self.T_first = h * self.T

    def rescale(self) -> None:
        """Scales grow with the time since the leg began and the way since the edge turned.

        Segments keep their polynomials; only chords change.
        """
        T, L = self.T, self.L_run
        if self.leg.timed:
            T = min(self.T_leg, max(0.5 * self.lasted, self.T_first))
        L = min(L, max(0.5 * abs(self.travelled), self.least_scale))
        if (T, L) == (self.T, self.L):
            return
        ratio = np.array([self.T / T, self.L / L])
        table = self.rows.table
        direction = self.tangent
        if len(table) > 1:
            direction = -table[-2, 1:3] / (self.T, self.L)
            direction = direction / np.hypot(*direction)
        self.h *= math.hypot(*(direction * ratio))
        self.tangent = self.tangent * ratio
        self.tangent = self.tangent / np.hypot(*self.tangent)
        self.T, self.L = T, L
        self.rows.measure(T, L)

    @property
    def let_go(self) -> bool:
        """Whether a contact without adhesion has come to a force that is nothing."""
        forces = self.rows.table[-2:, 4]
        falling = len(forces) > 1 and forces[1] < forces[0]
        return falling and self.law.adhesion is None and forces[1] <= LOST_FORCE * self.largest_force

    @property
    def least_radius(self) -> float:
        """Radius below which no contact is followed: one zone, at rest if its stress is fixed.

        Without adhesion a plane tip is let go as a whole; other contacts end in a point. A force only tells a
        penetration where it is not lost in rounding.
        """
        end_in_a_point = self._vanishing if self.leg.control == "force" else 0.0
        return self.law.zone or self.law.tip or end_in_a_point

    @cached_property
    def _vanishing(self) -> float:
        """Radius of an elastic contact whose force is lost in the rounding of the largest."""
        body, radius = self.body, self.L_run / SMALL_PART
        largest = radius * body.shape(radius) - body.transform.integral(radius)
        least = 2.0 * body.rheology.relaxed * LOST_FORCE * largest
        return max(pressed_radius(body, least, self.law.rim), STILL * self.L_run)
