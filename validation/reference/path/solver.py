"""``Run``: the load steps of a scene, leg by leg."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import minimize_scalar

from contact_scene import Scene
from validation.reference.path import events
from validation.reference.path.abel import transform
from validation.reference.path.continuation import SMALL_PART, Tracker
from validation.reference.path.edge_law import EdgeLaw
from validation.reference.path.energies import force_polynomial, force_slopes, work
from validation.reference.path.equilibrium import elastic_start, pressed_radius, touching_radius
from validation.reference.path.legs import Leg, jump, timed_legs
from validation.reference.path.polynomials import gauss, horner
from validation.reference.path.rheology import rheology
from validation.reference.path.state import Body, State, start_state
from validation.reference.path.step import Kind
from validation.reference.path.trial import Arrival, Trial

Array = NDArray[np.float64]
_POINTS, _WEIGHTS = gauss(8)


@dataclass
class Run:
    """A run of a scene; after :meth:`run` the rows and what it ended with."""

    scene: Scene
    tolerance: float = 1e-4
    verbose: bool = False
    max_steps: int = 20000
    times: list[float] = field(default_factory=list)
    depths: list[float] = field(default_factory=list)
    radii: list[float] = field(default_factory=list)
    forces: list[float] = field(default_factory=list)
    works: list[float] = field(default_factory=list)
    stored: list[float] = field(default_factory=list)
    least_force: float = math.inf
    outcome: str = ""

    def run(self) -> Run:
        """All load steps; what overflows belongs to trials beyond a limit point, and is rejected."""
        with np.errstate(all="ignore"):
            return self._run()

    def _run(self) -> Run:
        scene = self.scene
        loading = scene.loading
        body = Body(rheology(scene.material), transform(scene.indenter))
        adhesion = scene.adhesion if scene.is_adhesive else None
        law = EdgeLaw(adhesion, scene.indenter.edge, scene.bare_plane_tip)
        start = elastic_start(scene, body)
        if start is None:
            self.outcome = "no start"
            return self
        state = start_state(body, start.penetration, start.radius, loading.start != "relaxed")
        self.body = body
        largest, deepest = self._scales(body, state)
        self.tracker = tracker = Tracker(
            body,
            law,
            state,
            self.tolerance,
            SMALL_PART * largest,
            SMALL_PART * deepest,
            accepted=self._record,
            verbose=self.verbose,
        )
        self._row(state, 0.0)
        for step in loading.steps:
            state = tracker.state
            segment = loading.segment(step, state.time, state.depth, state.force)
            self.segment = segment
            tracker.level = events.Level.of(segment.trigger, state)
            first = jump(segment, state.depth, state.force)
            legs = ([first] if first else []) + list(timed_legs(segment))
            for leg in legs:
                ending = self._follow(leg, deepest)
                if ending is not Kind.END:
                    break
            if not self.outcome and segment.trigger is not None and ending is Kind.END:
                self.outcome = "trigger not reached"
            if self.outcome:
                return self
        self.outcome = "completed"
        return self

    def _scales(self, body: Body, state: State) -> tuple[float, float]:
        """Largest radius and penetration that the loading asks for."""
        depths, forces = [state.depth], [state.force]
        for step in self.scene.loading.steps:
            if step.kind == "ramp":
                depths.append(step.to)
            forces += (
                [abs(getattr(step, key, 0.0) or 0.0) for key in ("value", "to")]
                if "force" in step.kind
                else []
            )
            if step.kind == "table":
                (depths if step.quantity == "penetration" else forces).extend(step.values)
        deepest = max(depths)
        largest = max(state.radius, touching_radius(body, deepest, self.scene.indenter.edge))
        if largest == 0.0:
            largest = pressed_radius(body, max(forces), self.scene.indenter.edge)
        shape = float(body.transform(np.array([largest]))[0])
        pressed = max(forces) / (2.0 * body.rheology.relaxed * largest) if largest else 0.0
        return largest, max(abs(state.depth), abs(deepest), shape, pressed)

    def _follow(self, leg: Leg, deepest: float) -> Kind:
        """One leg to its end, or what ends it before."""
        tracker = self.tracker
        if leg.timed:
            rate = abs(self.segment.rate(leg.start))
            large = (
                max(abs(tracker.state.force), abs(leg.value(leg.end))) if leg.control == "force" else deepest
            )
            T = SMALL_PART * min(leg.end - leg.start, large / rate if rate else math.inf)
        else:
            T = SMALL_PART
        tracker.begin(leg, T)
        while True:
            kind = tracker.step()
            if kind in (Kind.END, Kind.LEVEL):
                return kind
            if kind is Kind.LEAST:
                self.outcome = "shorter than its zone" if tracker.law.zone else "detached"
            elif kind in (Kind.LOST, Kind.FOLD):
                if events.lost(tracker, kind is Kind.FOLD):
                    self.outcome = "detached" if kind is Kind.FOLD else "detached?"
            elif tracker.steps + tracker.rejected > self.max_steps:
                self.outcome = "budget"
            if self.outcome:
                return kind

    # rows ---

    def _row(self, state: State, work: float) -> None:
        self.times.append(state.time)
        self.depths.append(state.depth)
        self.radii.append(state.radius)
        self.forces.append(state.force)
        self.works.append((self.works[-1] if self.works else 0.0) + work)
        self.stored.append(self._stored(state))
        self.least_force = min(self.least_force, state.force)

    def _stored(self, state: State) -> float:
        """``U``, both sides of the edge."""
        rheology = self.body.rheology
        x = state.radius * (1.0 - np.array([1.0, 0.75, 0.5, 0.25, 0.0]))
        width = np.diff(x)
        at = (x[:-1, None] + width[:, None] * _POINTS).ravel()
        strain = float((width[:, None] * _WEIGHTS).ravel() @ (state.depth - self.body.transform(at)) ** 2)
        branches = float(state.held_squares @ (1.0 / rheology.moduli)) if len(rheology.moduli) else 0.0
        units = float(state.free_squares @ (1.0 / rheology.compliances)) if len(rheology.moduli) else 0.0
        return rheology.relaxed * strain + branches + units

    def _record(self, trial: Trial, arrival: Arrival, state: State, s: float) -> None:
        table = self.tracker.rows.table
        first, last = force_slopes(self.body, trial, arrival, state)
        before = None
        if len(table) > 1:
            back = (table[-2, 0] - table[-1, 0]) / (s - table[-1, 0])
            before = (float(back), float(table[-2, 5]))
        force = force_polynomial((trial.state.force, first), (state.force, last), before)
        if trial.leg.control != "force" and first < 0.0 < last and min(trial.state.force, state.force) < 0.0:
            self._watch(trial, arrival, force, state.force)
        self._row(state, work(force, arrival.motion.depth_slope()))

    def _watch(self, trial: Trial, arrival: Arrival, force: Array, last: float) -> None:
        """The least force, which lies within this step: from the dense path, if that agrees with the rows."""
        first = trial.state.force
        expected = min(float(horner(force, np.linspace(0.0, 1.0, 33)).min()), first, last)

        def of(u: float) -> float:
            part, p = trial.part(u, arrival)
            end = part.arrive(p)
            return part.force(end.motion, end.duration)

        found = minimize_scalar(of, bounds=(0.0, 1.0), method="bounded", options={"xatol": 3e-3})
        agrees = abs(found.fun - expected) <= max(abs(first - last), min(first, last) - expected)
        self.least_force = min(self.least_force, float(found.fun) if agrees else expected)

    def measures(self) -> dict[str, float]:
        """Scalars to compare; the work is that of the stage."""
        compliance = self.scene.loading.compliance
        return {
            "pull_off": max(-self.least_force, 0.0),
            "time": self.times[-1],
            "radius": self.radii[-1],
            "largest": max(self.radii),
            "work": self.works[-1] + 0.5 * compliance * (self.forces[-1] ** 2 - self.forces[0] ** 2),
            "stored": self.stored[-1],
        }
