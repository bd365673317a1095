"""Records accepted states, events and profiles (paper, Fig. 3), and makes the trace of them."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from bem_solver.edge_energy import energy_spent
from bem_solver.energy import RowPath, rest_ends, stored_energy, tip_energy
from bem_solver.problem import Problem
from bem_solver.surface_points import HalfSpaceState, points_at
from contact_scene import COLUMNS, Counters, Event, Outcome, OutcomeKind, SurfaceProfile, Trace

Array = NDArray[np.float64]

_OUTER_RADIUS = 4.0
"""Largest radius of a profile, in contact radii."""


@dataclass
class RunRecord:
    """Rows, events and profiles of a run so far; a row begins with time, penetration, force, contact radius.

    After the rows ``kinks`` slopes may jump.
    """

    rows: list[tuple[float, ...]] = field(default_factory=list)
    events: list[Event] = field(default_factory=list)
    profiles: list[SurfaceProfile] = field(default_factory=list)
    kinks: list[int] = field(default_factory=list)

    @property
    def forces(self) -> list[float]:
        """Force of every row, positive in compression."""
        return [row[2] for row in self.rows]

    def kink(self) -> None:
        """Slopes may jump at the last row."""
        self.kinks.append(max(len(self.rows) - 1, 0))

    def event(self, kind: str) -> None:
        """An instability of the last row."""
        time, penetration, force, radius, *_ = self.rows[-1]
        self.events.append(Event(kind, time, penetration, force, radius))

    def profile(self, profile: SurfaceProfile) -> None:
        """The surface at a requested time; of two at one time (a jump) the later stays."""
        self.profiles = [p for p in self.profiles if p.time != profile.time] + [profile]

    def path(self, of_edge: bool = True) -> RowPath:
        """The path of the rows, in the plane of time and contact radius or in time alone."""
        time, _, _, radius, *_ = np.array(self.rows).T
        return RowPath(time, [*self.kinks, *rest_ends(radius)], radius if of_edge else None)

    def finished(
        self, outcome: Outcome, counters: Counters, work: float, energies: tuple[Array, ...], intensity: Array
    ) -> Trace:
        """The trace; the loss is what the energy balance (Eq. energybalance) leaves.

        ``energies`` are what is stored, what the interface and what the branches have taken up, and
        ``intensity`` is that of the stress, all (n,); ``work`` is that of adhesion. ``zone_excess`` is what
        the branches dissipate beyond the loss: at a sharp edge the whole field moves as if the process zone
        had no length, and the tip takes only the glassy ``K^2/(2 Einf*)``.
        """
        time, penetration, force, radius, *_ = np.array(self.rows).T
        stored, spent, branch = energies
        external = summed(self.path().integral(force, penetration))
        dissipated = external - spent - (stored - stored[0])
        return Trace(
            solver="bem",
            time=time,
            penetration=penetration,
            force=force,
            contact_radius=radius,
            stored_energy=stored,
            external_work=external,
            dissipated_energy=dissipated,
            outcome=outcome,
            counters=counters,
            extra={
                "branch_dissipation": branch,
                "zone_excess": branch - dissipated,
                "stress_intensity_factor": intensity,
                "energy_release_rate": release_rate(stored, force, penetration, np.pi * radius**2, work),
                "separation_energy": spent,
            },
            events=tuple(self.events),
            profiles=tuple(self.profiles),
        )


@dataclass
class GradedRecord(RunRecord):
    """Record of a run on graded annuli, with what its energies follow from."""

    states: list[tuple[float, ...]] = field(default_factory=list)
    branch_works: list[Array | float] = field(default_factory=list)

    def row(self, state: HalfSpaceState) -> None:
        """Add the row of an accepted state."""
        surface = state.surface
        self.rows.append((state.time, state.penetration, surface.force, state.edge))
        self.states.append((surface.stress_intensity, surface.load_work, state.closure, state.tip_release))
        self.branch_works.append(state.branch_work)

    def trace(self, problem: Problem, outcome: Outcome) -> Trace:
        """The finished trace."""
        time, penetration, force, radius = np.array(self.rows).T
        intensity, load_work, closure, release = np.array(self.states).T
        chain, path = problem.chain, self.path()
        branch_work = np.array([np.broadcast_to(work, len(chain)) for work in self.branch_works])
        stored = stored_energy(chain, self.path(of_edge=False), time, load_work, branch_work)
        left = path.integral(force, penetration) - np.diff(stored) + tip_energy(radius, release)
        heat = summed(np.where(np.diff(time) > 0.0, left, 0.0)) if len(chain) else np.zeros_like(time)
        spent = -problem.work * np.pi * (radius**2 - radius[0] ** 2)
        if problem.irreversible is not None:
            spent = summed(energy_spent(problem.irreversible, radius, closure))
        return self.finished(outcome, problem.counters, problem.work, (stored, spent, heat), intensity)


def summed(steps: Array) -> Array:
    """Sums (n,) of what the steps (n - 1,) before each row add."""
    return np.concatenate(([0.0], np.cumsum(steps)))


def trace_without_start(reason: str, counters: Counters) -> Trace:
    """The trace of a scene without a start state: all columns, no row."""
    outcome = Outcome(OutcomeKind.NO_EQUILIBRIUM, reason, 0.0)
    record, none = RunRecord([(0.0,) * 4]), np.zeros(1)
    trace = record.finished(outcome, counters, 0.0, (none, none, none), none)
    empty = {name: getattr(trace, name)[:0] for name in COLUMNS}
    return replace(trace, **empty, extra={name: column[:0] for name, column in trace.extra.items()})


def release_rate(stored: Array, force: Array, penetration: Array, area: Array, work: float) -> Array:
    """``G = (dU - F dD)/dA`` (Eq. enrelrate) between neighbouring rows.

    Where the area hardly moves (less than 1e-5 of its largest value over two steps) the quotient is
    replaced by the work of adhesion, its value without dissipation.
    """
    result = np.full(len(area), work)
    if len(area) < 3:
        return result
    mean = 0.5 * (force[1:] + force[:-1]) * np.diff(penetration)
    energy = np.diff(stored) - mean
    change = area[2:] - area[:-2]
    moving = np.abs(change) > 1e-5 * area.max()
    inner = result[1:-1]
    inner[moving] = (energy[1:] + energy[:-1])[moving] / change[moving]
    return result


def surface_profile(problem: Problem, state: HalfSpaceState) -> SurfaceProfile:
    """Profile of the committed state, on the annuli inside the contact and graded radii beyond."""
    edge = state.edge
    if edge > 0.0:
        inside = edge * problem.annuli.radii
        near = 2.0 * edge - inside[::-1]
        radius = np.concatenate(
            ([0.0], inside, near[near < 2.0 * edge], edge * np.linspace(2.0, _OUTER_RADIUS, 101))
        )
    else:
        # there is no contact radius to scale with
        radius = np.unique(problem.length * np.linspace(0.0, 100.0 * _OUTER_RADIUS, 401))
    points = points_at(problem, state, radius)
    pressure = state.surface.pressure(radius)
    gap = points.height - state.penetration + points.displacement
    if edge > 0.0:
        gap[radius <= edge] = 0.0
    return SurfaceProfile(
        state.time,
        state.penetration,
        state.surface.force,
        edge,
        radius,
        pressure,
        points.displacement,
        gap,
    )
