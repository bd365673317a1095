"""Rows of the trace: each step's end, and rows on its way from polynomials of ``u``.

A straight line between two rows that are ``du`` apart misses a quantity f at equal times by

    |f'' - f' t''/t'| du^2/8,

and so rows lie evenly in the integral of the root of that. Before a limit point, where ``t' = 0``, the
integral is finite: there they crowd like the square root that the radius is of the time. An extremum of the
force is found on the dense path, and is a row; so are times that are asked for. None changes the path.

``F dD + w dA = dU + P_d dt`` defines the loss ``P_d`` as that of the interface and the branches together.
The tip releases only the glassy ``q(a)^2/Einf* da``; what the branches dissipate is therefore
``F dD - dU + q(a)^2/Einf* da``.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from functools import partial

import numpy as np
from numpy.typing import ArrayLike, NDArray

from contact_scene import Event
from validation.reference.path.edge_law import EdgeLaw
from validation.reference.path.energies import (
    DEPTH,
    FORCE,
    RADIUS,
    SEPARATION,
    STORED,
    STRESS,
    TIME,
    WORK,
    Course,
    course,
    stored_energy,
    stored_when_free,
)
from validation.reference.path.equilibrium import Scales
from validation.reference.path.memory import COLLOCATION
from validation.reference.path.numerics import bracketed, derivative, horner, inverse, powers
from validation.reference.path.rheology import IndentedBody
from validation.reference.path.state import State
from validation.reference.path.trial import Arrival, Trial

Array = NDArray[np.float64]

EXTRA_COLUMNS = (
    "stress_intensity_factor",
    "energy_release_rate",
    "branch_dissipation",
    "separation_energy",
)
"""Columns beside those of every solver."""
DEEPEST, PRESSED, PULLED = "largest penetration", "largest force", "largest tension"
"""Kinds of located events."""
CELLS = 64
"""Cells in which a step is looked at, and most of its rows; closer at its ends, where it may be a root."""
_EDGES = np.sin(0.5 * math.pi * np.linspace(0.0, 1.0, CELLS + 1)) ** 2
_WIDTHS = _EDGES[1:] - _EDGES[:-1]
_AT_CENTRES = powers(np.sin(0.5 * math.pi * (np.arange(CELLS) + 0.5) / CELLS) ** 2, COLLOCATION)
_ORDERS = np.arange(COLLOCATION + 1)
_SLOPES, _BENDS = np.zeros_like(_AT_CENTRES), np.zeros_like(_AT_CENTRES)
_SLOPES[:, 1:] = _AT_CENTRES[:, :-1] * _ORDERS[1:]
_BENDS[:, 2:] = _AT_CENTRES[:, :-2] * _ORDERS[2:] * _ORDERS[1:-1]
CURVED = 12.0
"""Deviation of rows from straight lines under a load that is curved itself, in that under a linear one."""
VERTEX = 0.05
"""Most distance in its step of the three places that tell an extremum: it is off by the cube."""
NARROW = 3e-3
"""Part of a step within which the dense path knows an extremum; the force is off by the square."""
LEAST_AREA_CHANGE = 1e-6
"""Change of the contact area, relative to the largest, below which no energy release rate is formed."""


def _value(coefficients: Array, u: float) -> float:
    return float(horner(coefficients, np.array(u)))


@dataclass
class Recorder:
    """Rows, events and the states that are asked for of one run.

    ``allowed``: deviation of straight lines between rows, relative to the largest force and radius.
    ``stops``: times that get a row; of the ``wanted`` among them the state is handed to ``seen``.
    """

    body: IndentedBody
    law: EdgeLaw
    scales: Scales
    allowed: float
    stops: Array
    wanted: frozenset[float]
    seen: Callable[[State], None]
    linear: bool = True
    rows: list[Array] = field(default_factory=list)
    events: list[Event] = field(default_factory=list)
    located: list[Event] = field(default_factory=list)
    _ends: list[Array] = field(default_factory=list)

    def begin(self, state: State) -> None:
        """The state from which a run starts."""
        stored, stress = stored_energy(self.body, state), 0.0
        if state.radius > 0.0:
            at_edge = state.in_contact(self.body, np.zeros(1))
            stress = float(self.body.rheology.stress(*at_edge)[0])
        self._add([[state.time, state.depth, state.radius, state.force, stored, 0.0, 0.0, 0.0, stress]])
        if state.time in self.wanted:
            self.seen(state)

    def put(self, state: State) -> None:
        """A state that takes neither time nor work to reach: a plane tip touches, an indenter is set down."""
        row = self._ends[-1].copy()
        if (row[DEPTH], row[RADIUS]) != (state.depth, state.radius):
            row[[DEPTH, RADIUS, FORCE]] = state.depth, state.radius, state.force
            self._add(row[None, :])

    def step(self, arrival: Arrival, state: State, back: float | None) -> None:
        """A step to a state; ``back``: ``u < 0`` of the row before it, if the path is smooth there."""
        before = None if back is None else (back, self._ends[-2])
        trial, way = arrival.trial, course(arrival, state, self._ends[-1], before)
        marked, stops = {}, {}
        if arrival.rise > 0.0:
            marked = self._extrema(arrival, way)
        elif trial.direction:
            self._jumped(trial)
        u = np.array([*sorted(marked), 1.0])
        if arrival.duration > 0.0:
            stops = self._stops(trial, way, state)
            u = self._places(trial, way, state, np.array([*marked, *stops]))
        rows = way.at(u)
        rows[-1, [TIME, DEPTH, RADIUS, FORCE]] = state.time, state.depth, state.radius, state.force
        if self.law.adhesion is None:  # no polynomial pulls where nothing can
            rows[:, FORCE] = np.maximum(rows[:, FORCE], 0.0)
        for at, stop in stops.items():
            rows[u.searchsorted(at), TIME] = stop
            if stop in self.wanted:
                self.seen(replace(arrival.part(at).after(), time=stop) if at < 1.0 else state)
        for at, (kind, apart, height) in marked.items():
            row = rows[u.searchsorted(at)]
            if kind in (PRESSED, PULLED):  # no polynomial goes beyond it
                limit = np.minimum if kind == PRESSED else np.maximum
                rows[:-1, FORCE] = limit(rows[:-1, FORCE], height)
                row[FORCE] = height
            self._mark(kind, row, self._spread(way, at, apart))
        self._add(rows)

    def level(self, kind: str) -> None:
        """The last row is where the path meets a level, to the rounding of its load."""
        self._mark(kind, self._ends[-1], np.spacing(np.abs(self._ends[-1][: FORCE + 1])))

    def lost(self, in_a_point: bool, apart: float) -> None:
        """Contact is lost at the last row; a limit point, where the time is stationary, is that far off."""
        time, depth, radius, force = self._ends[-1][: FORCE + 1].tolist()
        change = self._ends[-1] - self._ends[0]
        uncertainty: tuple[float, ...] = ()
        if change[RADIUS] != 0.0:
            uncertainty = (0.0, 0.0, abs(float(change[FORCE] / change[RADIUS])) * apart, apart)
        force, radius = (0.0, 0.0) if in_a_point else (force, radius)
        self.events.append(Event("pull-off", time, depth, force, radius, uncertainty))

    def free(self, state: State, depth: float) -> None:
        """The surface right after contact is lost, the indenter at a penetration."""
        row = self._ends[-1].copy()
        work, released = 0.5 * row[FORCE] * (depth - row[DEPTH]), math.pi * row[RADIUS] ** 2
        stored = stored_when_free(self.body, state)
        taken = self.law.adhesion.opening(math.inf) if self.law.adhesion else 0.0
        if math.isfinite(taken):
            row[SEPARATION] += taken * released
        else:  # a law without a bound takes what there is
            row[SEPARATION] += row[STORED] + work - stored
        row[WORK] += work
        row[[DEPTH, RADIUS, FORCE, STORED, STRESS]] = depth, 0.0, 0.0, stored, 0.0
        self._add(row[None, :])

    def _add(self, rows: ArrayLike) -> None:
        self.rows.append(np.asarray(rows))
        self._ends = [*self._ends[-1:], self.rows[-1][-1]]
        largest = float(np.abs(self.rows[-1][:, FORCE]).max())
        if largest > self.scales.force:
            self.scales = replace(self.scales, force=largest)

    # rows within a step ---

    def _places(self, trial: Trial, way: Course, state: State, also: Array) -> Array:
        """``u`` of the rows of a step, the last at its end."""
        columns, largest = [TIME, RADIUS, FORCE], [1.0, self.scales.radius, self.scales.force]
        if trial.leg.free:
            columns, largest = [*columns, DEPTH], [*largest, self.scales.depth]
        changes = way.coefficients[: COLLOCATION + 1, columns]
        first, second = _SLOPES @ changes, _BENDS @ changes
        clock = np.where(first[:, 0] > 0.0, first[:, 0], math.inf)
        bend = np.abs(second - first * (second[:, 0] / clock)[:, None]) / largest
        bend = bend[:, 1:].max(axis=1)
        allowed = 8.0 * self.allowed * (1.0 if self.linear else CURVED)
        parts = np.zeros(CELLS + 1)
        (np.sqrt(bend / allowed) * _WIDTHS).cumsum(out=parts[1:])
        count = min(max(math.ceil(parts[-1]), 1), CELLS)
        even = np.interp(parts[-1] * np.arange(1, count) / count, parts, _EDGES)
        u = np.concatenate((even, also, [1.0]))
        if len(also):
            u = np.unique(u)
        time = np.empty(len(u) + 1)
        time[0], time[-1] = trial.state.time, state.time
        time[1:-1] = powers(u[:-1], COLLOCATION) @ way.coefficients[: COLLOCATION + 1, TIME]
        later = (time[1:] > np.maximum.accumulate(time)[:-1]) & (time[1:] < state.time)
        later[-1] = True
        return u[later]

    def _stops(self, trial: Trial, way: Course, state: State) -> dict[float, float]:
        """Where in a step the times lie that are asked for."""
        clock = way.coefficients[:, TIME].copy()
        clock[0] = 0.0
        inside = self.stops[(self.stops > trial.state.time) & (self.stops < state.time)]
        found = dict(zip(inverse(clock, inside - trial.state.time).tolist(), inside.tolist(), strict=True))
        return found | ({1.0: state.time} if state.time in self.wanted else {})

    def _extrema(self, arrival: Arrival, way: Course) -> dict[float, tuple[str, float, float]]:
        """Extrema of penetration and force within a step: kind, how far off it is in ``u``, and the force.

        One that changes less than the tolerance over the step is of the errors: a hold has many.
        """
        found: dict[float, tuple[str, float, float]] = {}
        trial, coefficients = arrival.trial, way.coefficients
        ends = np.array([coefficients[1], np.arange(len(coefficients)) @ coefficients])
        if ends[:, TIME].min() < 0.0:  # rounding of a shortest step, or past a limit point
            return found
        force = max(abs(trial.state.force), abs(arrival.force))
        for column, largest in ((DEPTH, self.scales.depth), (FORCE, force)):
            first, last = ends[:, column]
            errors = self.allowed * largest if trial.leg.free or column == FORCE else 0.0
            if first * last >= 0.0 or max(abs(first), abs(last)) < errors:
                continue
            slope = derivative(coefficients[:, column])
            at = bracketed(partial(_value, slope), 0.0, 1.0)
            if column == DEPTH:
                found[at] = DEEPEST if first > 0.0 else "", 0.0, math.nan
            elif trial.leg.control != "force":
                extremum = self._extremum(arrival, at)
                if extremum is not None:
                    exact, height = extremum
                    height = max(height, 0.0) if self.law.adhesion is None else height  # nothing pulls
                    kind = PRESSED if first > 0.0 else PULLED
                    off = max(abs(exact - at), NARROW)
                    found[exact] = kind if height * first > 0.0 else "", off, height
        return found

    def _extremum(self, arrival: Arrival, at: float) -> tuple[float, float] | None:
        """Place and height of an extremum of the force; ``None`` where the dense path alone has one."""
        # one secant tells no speed
        if arrival.trial.direction and self.law.adhesion is not None and not self.law.rated:
            middle = min(max(at, NARROW), 1.0 - NARROW)
            apart = min(VERTEX, middle, 1.0 - middle)
            way, height = self._vertex(arrival, middle, apart)
            place = middle + apart * way
            if not -apart <= place <= 1.0 + apart and math.isfinite(height):
                return None
            if abs(way) < 2.0:
                return min(max(place, NARROW**2), 1.0 - NARROW**2), height
        return at, arrival.part(at).force

    def _vertex(self, arrival: Arrival, middle: float, apart: float) -> tuple[float, float]:
        """Vertex, seen from the middle, and height there of the parabola through three forces on the path."""
        before, here, after = (arrival.corrected_force(middle + shift) for shift in (-apart, 0.0, apart))
        bend, slope = before - 2.0 * here + after, 0.5 * (after - before)
        way = -slope / bend if bend else math.nan
        return way, here + 0.5 * slope * way

    @staticmethod
    def _spread(way: Course, at: float, apart: float) -> Array:
        """How far time, penetration, radius and force go within a distance of an extremum."""
        first, second = (way.slopes(np.array([at]), order)[0, : FORCE + 1] for order in (1, 2))
        return np.asarray(np.abs(first) * apart + 0.5 * np.abs(second) * apart**2)

    def _mark(self, kind: str, row: Array, off: Array) -> None:
        if kind:
            time, depth, radius, force = row[: FORCE + 1].tolist()
            off = off[[TIME, DEPTH, FORCE, RADIUS]]
            self.located.append(Event(kind, time, depth, force, radius, tuple(off.tolist())))

    def _jumped(self, trial: Trial) -> None:
        """The edge has gone to another stable place at a fixed load."""
        if self.law.adhesion is not None:
            state, kind = trial.state, "snap-in" if trial.direction > 0.0 else "pull-off"
            self.events.append(Event(kind, state.time, state.depth, state.force, state.radius))

    # columns ---

    def columns(self) -> dict[str, Array]:
        """All columns by name: the contract's seven, then those of ``EXTRA_COLUMNS``.

        The stress intensity factor is ``-q(a)/sqrt(pi a)``, 0 without contact. The energy release rate is
        that between a row and the one before; repeated where the area hardly changed.
        """
        rows = np.concatenate(self.rows)
        time, depth, radius, force, energy, tip, spent, external, stress = rows.T
        stored, area = energy - energy[0], math.pi * radius**2
        branch = np.where(np.diff(time) > 0.0, np.diff(external - stored + tip), 0.0)  # dashpots take time
        roots = np.sqrt(math.pi * np.where(radius > 0.0, radius, 1.0))
        return {
            "time": time,
            "penetration": depth,
            "force": force,
            "contact_radius": radius,
            "stored_energy": energy,
            "external_work": external,
            "dissipated_energy": external - spent - stored,
            "stress_intensity_factor": np.where(radius > 0.0, -stress / roots, 0.0),
            "energy_release_rate": self._release_rate(area, stored - external),
            "branch_dissipation": np.concatenate(([0.0], branch.cumsum())),
            "separation_energy": spent,
        }

    def _release_rate(self, area: Array, potential: Array) -> Array:
        """``(dU - F dD)/dA``; the work of adhesion, its value in equilibrium, before anything has moved."""
        work = self.law.adhesion.work if self.law.adhesion else 0.0
        step = np.diff(area)
        moves = np.abs(step) > LEAST_AREA_CHANGE * area.max()
        last = np.maximum.accumulate(np.where(moves, np.arange(len(step)), -1))
        each = np.divide(np.diff(potential), step, out=np.zeros_like(step), where=moves)
        return np.concatenate(([work], np.where(last >= 0, each[last], work) if len(step) else []))
