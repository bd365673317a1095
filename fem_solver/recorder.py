"""Rows of the trace: observables, work, energies and the balance that closes them.

With a sharp edge the half-space receives the work of the surface forces, ``int sum_i f_i du_i``: what the
indenter does, ``int F dD`` by the rows, and what opening the interface takes, ``int sum_i f_i dg_i`` over the
nodes that the edge passes. It stores and dissipates it in its branches; both are sums over components that
know nothing of the rows. ``balance_residual`` is what is left of that identity, and measures steps, rows and
the mesh where it moves on.

The parts of the node next to the edge, in contact and free, hold an energy beyond that of their mean (see
``nodes``). It belongs to ``stored_energy``, which without it would sag between any two nodes by up
to an eighth of what the edge releases there. The balance of the half-space alone does without it.

``dissipated_energy`` is the loss of the balance ``F dD + dg dA = dU + dL``. It differs from the branch
dissipation by ``zone_excess``: a sharp edge gives back only the glassy ``K^2/(2 Einf*)`` of the work of
adhesion, the remainder is dissipated where the process zone would have held it.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from contact_scene import COLUMNS, Adhesion, Counters, Event, Outcome, SurfaceProfile, Trace
from fem_solver.components import Components
from fem_solver.placement import Placement
from fem_solver.setup import Setup
from fem_solver.state import ComponentState, nodal_forces

Array = NDArray[np.float64]

SOLVER = "fem"
"""Name of the solver in its traces."""
EXTRA = ("branch_dissipation", "zone_excess", "balance_residual", "separation_energy")


@dataclass(frozen=True)
class SurfaceState:
    """An accepted state of the surface.

    Parameters
    ----------
    time, penetration, force, radius : float
        ``radius`` is the contact radius.
    edge : float
        Edge position in nodes (see ``contact_problem``).
    stored, interface : float
        Energy of the half-space, and of the parts of the node next to the edge beyond that of their mean.
    branch_dissipation, opening : float
        Energy dissipated in the branches, and work of the surface forces on the gap, so far.
    zone : float
        Length of the process zone; 0 without adhesion.
    singular_force : float
        Force of the flat punch, as large as the contact, that leaves the same edge singularity.
    smooth : int
        Steps before, at most two, from which the rates go on into the one that ends here.
    bent : float
        Work since the last state beyond its trapezoid, where a load jump tells it.
    closure, spent, rate : float
        Closure integral at the edge, energy that the interface has taken up and mean rate of the radius over
        the last step, where adhesion is irreversible.
    """

    time: float
    penetration: float
    force: float
    radius: float
    edge: float
    stored: float
    interface: float
    branch_dissipation: float
    opening: float
    zone: float
    singular_force: float
    smooth: int
    bent: float
    closure: float = 0.0
    spent: float = 0.0
    rate: float = 0.0


@dataclass(frozen=True)
class Totals:
    """Work up to the last row, and the extremes of all rows."""

    last: SurfaceState | None = None
    external_work: float = 0.0
    surface_work: float = 0.0
    largest_force: float = 0.0
    largest_tension: float = 0.0
    depths: tuple[float, float] = math.inf, -math.inf


@dataclass(frozen=True)
class SurfaceStep:
    """Length of a step, and the surface at its begin and end, on the mesh of the step."""

    dt: float
    begin: ComponentState
    end: ComponentState


@dataclass
class SurfaceRecorder:
    """Accumulates rows and the work between them; ``keeps`` every surface, and the step that led to it."""

    adhesion: Adhesion | None
    keeps: bool = False
    rows: list[tuple[float, ...]] = field(default_factory=list)
    events: list[Event] = field(default_factory=list)
    profiles: list[SurfaceProfile] = field(default_factory=list)
    surfaces: list[SurfaceState] = field(default_factory=list)
    steps: list[SurfaceStep] = field(default_factory=list)
    first: SurfaceState | None = None
    totals: Totals = field(default_factory=Totals)

    @property
    def last(self) -> SurfaceState:
        """The last accepted state."""
        assert self.totals.last is not None, "the run has not started"
        return self.totals.last

    def add(self, state: SurfaceState) -> None:
        """Append an accepted state."""
        totals, last = self.totals, self.totals.last
        external, surface = totals.external_work, totals.surface_work
        if last is not None:
            work = self._work(state)
            external += work
            surface += work + state.opening - last.opening
            if self.adhesion is not None:  # in a jump forces at the edge open it on straight lines
                surface -= state.bent
        first = self.first = self.first or state
        stored, interface = state.stored - first.stored, state.interface - first.interface
        if self.adhesion is None:
            adhesion = 0.0
        elif self.adhesion.reversible:
            adhesion = self.adhesion.work * math.pi * (state.radius**2 - first.radius**2)
        else:
            adhesion = -state.spent
        loss = external + adhesion - stored - interface
        self.rows.append(
            (
                state.time,
                state.penetration,
                state.force,
                state.radius,
                state.stored + state.interface,
                external,
                loss,
                state.branch_dissipation,
                state.branch_dissipation - loss,
                surface - stored - state.branch_dissipation,
                -adhesion,
            )
        )
        if self.keeps:
            self.surfaces.append(state)
        self.totals = Totals(
            state,
            external,
            surface,
            max(totals.largest_force, abs(state.force)),
            max(totals.largest_tension, -state.force),
            (min(totals.depths[0], state.penetration), max(totals.depths[1], state.penetration)),
        )

    def _work(self, state: SurfaceState) -> float:
        """``int F dD`` since the last row, along cubics through two rows more where these go on smoothly.

        A dozen rows are a whole swing where the edge rests, and the polygon through them loses 5 % of it; it
        misses a ten-thousandth of a smooth press, which may be all that an almost elastic contact loses.
        """
        now = state.time, state.penetration, state.force
        before = [row[:3] for row in self.rows[-1 - state.smooth :]]
        time, depth, force = np.array([*before, now]).T
        if not state.smooth or time[-1] == time[-2]:
            return float(0.5 * (force[-1] + force[-2]) * (depth[-1] - depth[-2])) + state.bent
        share = (time - time[-2]) / (time[-1] - time[-2])
        depth, force = np.linalg.solve(np.vander(share, increasing=True), np.array([depth, force]).T).T
        powers = np.arange(len(share))
        return float(force @ (powers / np.maximum(powers[:, None] + powers, 1)) @ depth)

    def take_back(self, before: Totals) -> None:
        """Drop the last row, which brought no event, with the totals before it."""
        self.totals = before
        for kept in (self.rows, self.surfaces, self.steps):
            del kept[-1:]

    def event(self, kind: str, way: float = 0.0) -> None:
        """An instability that starts from the last row, or after a further ``way`` of the edge at most.

        Towards a limit point the load is flat: its ripple, 1e-7 of it from node to node, moves the last
        equilibrium by a share of an element.
        """
        rows = self.rows[-2:]
        if not rows:
            return
        time, penetration, force, radius = rows[-1][:4]
        moved = np.abs(np.subtract(rows[-1][:4], rows[0][:4]))
        uncertainty = (way / moved[3] * moved).tolist() if way * moved[3] > 0.0 else ()
        self.events.append(Event(kind, time, penetration, force, radius, tuple(uncertainty)))

    def depth_scale(self) -> float:
        """Range of the penetrations so far, at least a hundredth of the largest."""
        least, most = self.totals.depths
        return max(most - least, 1e-2 * max(abs(least), abs(most)))

    def trace(self, outcome: Outcome, counters: Counters, wall_seconds: float) -> Trace:
        """All that was recorded."""
        names = (*COLUMNS, *EXTRA)
        table = np.array(self.rows, float).reshape(len(self.rows), len(names))
        columns = dict(zip(names, table.T.copy(), strict=True))
        return Trace(
            solver=SOLVER,
            time=columns["time"],
            penetration=columns["penetration"],
            force=columns["force"],
            contact_radius=columns["contact_radius"],
            stored_energy=columns["stored_energy"],
            external_work=columns["external_work"],
            dissipated_energy=columns["dissipated_energy"],
            outcome=outcome,
            counters=counters,
            extra={name: columns[name] for name in EXTRA},
            events=tuple(self.events),
            profiles=tuple(self.profiles),
            wall_seconds=wall_seconds,
        )


@dataclass(frozen=True)
class Recording:
    """Content of a recorded run.

    Parameters
    ----------
    setup : Setup
    trace : Trace
    rows : dict of float to int
        Row of the trace at each requested time; where the load jumps, the one before.
    surfaces : list of SurfaceState
        By row; empty if nothing was to be recorded.
    steps : list of SurfaceStep
        That end at each row; empty if nothing was to be recorded.
    """

    setup: Setup
    trace: Trace
    rows: dict[float, int]
    surfaces: list[SurfaceState]
    steps: list[SurfaceStep]


def tributary_areas(radii: Array) -> Array:
    """``int N_i 2 pi r dr`` of the quadratic trace; zero at the axis. Shape (n,), n odd."""
    left, right = radii[:-2:2], radii[2::2]
    length = right - left
    areas = np.zeros(len(radii))
    areas[:-2:2] += 2.0 * np.pi * length * left / 6.0
    areas[2::2] += 2.0 * np.pi * length * right / 6.0
    areas[1::2] += 2.0 * np.pi * length * (left + right) / 3.0
    return areas


def profile(
    state: SurfaceState, surface: ComponentState, here: Placement, solid: Components
) -> SurfaceProfile:
    """Pressure, displacement and gap at the surface nodes of the place of a state.

    The pressure is the nodal force over the node's area; the axis takes that of its neighbour, and the
    partly released node at the edge is left out.
    """
    radii, displacement = here.radii, here.displacement(surface.components)
    areas, forces = tributary_areas(radii), nodal_forces(surface, here, solid)
    pressure = np.divide(forces, areas, out=np.zeros_like(areas), where=areas > 0.0)
    pressure[0] = pressure[1]
    full = int(np.floor(state.edge))
    gap = here.height - state.penetration + displacement
    gap[: full + 1] = 0.0
    shown = np.ones(len(radii), bool)
    if full + 1 < len(radii) and state.edge > full:
        shown[full + 1] = False
    return SurfaceProfile(
        state.time,
        state.penetration,
        state.force,
        state.radius,
        here.stretch * radii[shown],
        pressure[shown],
        displacement[shown],
        gap[shown],
    )
