"""Rows of the trace: observables, work, energies and the balance that closes them.

With a sharp edge the half-space receives the work of the surface forces, ``int sum_i f_i du_i``: what the
indenter does, ``int F dD``, and what opening the interface takes, ``int sum_i f_i dg_i`` over partly released
nodes. It stores and dissipates it in its branches; both are sums over components that
know nothing of the work. ``balance_residual`` is what is left of that identity, and measures steps and nodes.

The parts of the node next to the edge, in contact and free, hold an energy beyond that of their mean (see
``node_parts``). It belongs to ``stored_energy``, which without it would sag between any two nodes by up
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

from contact_scene import COLUMNS, Counters, Event, Outcome, SurfaceProfile, Trace

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
    forces, displacement : ndarray, shape (n,)
        Nodal forces, compressive positive, and nodal displacements, positive downwards.
    stored, interface : float
        Energy of the half-space, and of the parts of the node next to the edge beyond that of their mean.
    branch_dissipation : float
        Energy dissipated in the branches so far.
    zone : float
        Length of the process zone; 0 without adhesion.
    closure, spent, rate, duration : float
        Closure integral at the edge, energy that the interface has taken up, mean rate of the radius over the
        last step and its length: where adhesion is irreversible.
    received : float
        Work done on the surface so far.
    smooth : bool
        Whether the rates of the step before go on into the one that ends here.
    bent : float
        Work since the last state beyond its trapezoid, where a load jump tells it.
    singular_force : float
        Force of the flat punch, as large as the contact, that leaves the same edge singularity.
    """

    time: float
    penetration: float
    force: float
    radius: float
    edge: float
    forces: Array
    displacement: Array
    stored: float
    interface: float
    branch_dissipation: float
    zone: float = 0.0
    closure: float = 0.0
    spent: float = 0.0
    rate: float = 0.0
    duration: float = 0.0
    received: float = 0.0
    smooth: bool = False
    bent: float = 0.0
    singular_force: float = 0.0


def work_of_bends(rises: tuple[float, float], bends: tuple[float, float]) -> float:
    """``int F dD`` beyond the trapezoid along parabolas."""
    return (bends[0] * rises[1] - bends[1] * rises[0]) / 6.0


@dataclass
class RecorderContent:
    """Content of a recorder: rows, events, profiles and the work between the rows."""

    rows: list[tuple[float, ...]] = field(default_factory=list)
    events: list[Event] = field(default_factory=list)
    profiles: list[SurfaceProfile] = field(default_factory=list)
    external_work: float = 0.0
    surface_work: float = 0.0
    largest_force: float = 0.0
    largest_tension: float = 0.0
    last: SurfaceState | None = None
    first: SurfaceState | None = None


@dataclass(frozen=True)
class RowBefore:
    """The content of a recorder before its last row: the state then, the work and the largest forces."""

    state: SurfaceState
    external_work: float
    surface_work: float
    largest_force: float
    largest_tension: float


@dataclass
class SurfaceRecorder:
    """Accumulates rows and the work between them.

    Parameters
    ----------
    work_of_adhesion : float
    reversible : bool
        Whether what the interface takes up follows from the contact area.
    surfaces : list of SurfaceState, optional
        If a list, every accepted state is appended to it.
    content : RecorderContent
    """

    work_of_adhesion: float
    reversible: bool = True
    surfaces: list[SurfaceState] | None = None
    content: RecorderContent = field(default_factory=RecorderContent)

    @property
    def last(self) -> SurfaceState:
        """The last accepted state."""
        if self.content.last is None:
            raise AssertionError("the run has not started")
        return self.content.last

    def add(self, state: SurfaceState) -> None:
        """Append an accepted state."""
        content = self.content
        if content.last is not None:
            mean = 0.5 * (state.force + content.last.force)
            bent = self._work_of_bend(state)
            content.external_work += mean * (state.penetration - content.last.penetration) + bent
            content.surface_work += state.received - content.last.received
            if self.work_of_adhesion == 0.0:  # otherwise forces at the edge open it, on straight lines
                content.surface_work += state.bent
        else:
            content.first = state
        first = content.first or state
        stored = state.stored - first.stored
        interface = state.interface - first.interface
        adhesion = self.work_of_adhesion * math.pi * (state.radius**2 - first.radius**2)
        if not self.reversible:
            adhesion = -state.spent
        loss = content.external_work + adhesion - stored - interface
        residual = content.surface_work - stored - state.branch_dissipation
        content.rows.append(
            (
                state.time,
                state.penetration,
                state.force,
                state.radius,
                state.stored + state.interface,
                content.external_work,
                loss,
                state.branch_dissipation,
                state.branch_dissipation - loss,
                residual,
                -adhesion,
            )
        )
        content.last = state
        if self.surfaces is not None:
            self.surfaces.append(state)
        content.largest_force = max(content.largest_force, abs(state.force))
        content.largest_tension = max(content.largest_tension, -state.force)

    def _work_of_bend(self, state: SurfaceState) -> float:
        """Work since the last row beyond its trapezoid, ``int F dD`` along parabolas through one row more.

        A dozen rows are a whole swing where the edge rests, and the polygon through them loses 5 % of it; it
        misses a ten-thousandth of a smooth press, which may be all that an almost elastic contact loses.
        """
        if not state.smooth or len(self.content.rows) < 2:
            return state.bent
        (t0, depth0, force0), (t1, depth1, force1) = (row[:3] for row in self.content.rows[-2:])
        before, now = t1 - t0, state.time - t1
        if min(before, now) <= 0.0:
            return 0.0

        def path(first: float, middle: float, last: float) -> tuple[float, float]:
            """Rise over the step, and ``c`` of ``c s (s - 1)`` over its share s."""
            bend = ((last - middle) / now - (middle - first) / before) / (before + now) * now**2
            return last - middle, bend

        depth, depth_bend = path(depth0, depth1, state.penetration)
        force, force_bend = path(force0, force1, state.force)
        return work_of_bends((depth, force), (depth_bend, force_bend))

    def mark(self) -> RowBefore:
        """What is needed to take the next row back."""
        content = self.content
        return RowBefore(
            self.last,
            content.external_work,
            content.surface_work,
            content.largest_force,
            content.largest_tension,
        )

    def take_back(self, before: RowBefore) -> None:
        """Drop the last row, which brought no event."""
        content = self.content
        content.rows.pop()
        if self.surfaces is not None:
            self.surfaces.pop()
        content.last = before.state
        content.external_work, content.surface_work = before.external_work, before.surface_work
        content.largest_force, content.largest_tension = before.largest_force, before.largest_tension

    def event(self, kind: str, way: float = 0.0) -> None:
        """An instability that starts from the last row, or after a further ``way`` of the edge at most.

        Towards a limit point the load is flat: its ripple, 1e-7 of it from node to node, moves the last
        equilibrium by a share of an element.
        """
        rows = self.content.rows[-2:]
        if not rows:
            return
        time, penetration, force, radius = rows[-1][:4]
        moved = np.abs(np.subtract(rows[-1][:4], rows[0][:4]))
        uncertainty = (way / moved[3] * moved).tolist() if way * moved[3] > 0.0 else ()
        self.content.events.append(Event(kind, time, penetration, force, radius, tuple(uncertainty)))

    def depth_scale(self) -> float:
        """Range of the penetrations so far, at least a hundredth of the largest (of about 64 rows)."""
        rows = self.content.rows
        depths = [row[1] for row in rows[:: max(1, len(rows) // 64)]]
        return max(max(depths) - min(depths), 1e-2 * max(abs(d) for d in depths))

    def trace(self, outcome: Outcome, counters: Counters, wall_seconds: float) -> Trace:
        """All that was recorded."""
        rows = self.content.rows
        names = (*COLUMNS, *EXTRA)
        table = np.array(rows, float).reshape(len(rows), len(names))
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
            events=tuple(self.content.events),
            profiles=tuple(self.content.profiles),
            wall_seconds=wall_seconds,
        )


def tributary_areas(radii: Array) -> Array:
    """``int N_i 2 pi r dr`` of the quadratic trace; zero at the axis. Shape (n,), n odd."""
    left, right = radii[:-2:2], radii[2::2]
    length = right - left
    areas = np.zeros(len(radii))
    areas[:-2:2] += 2.0 * np.pi * length * left / 6.0
    areas[2::2] += 2.0 * np.pi * length * right / 6.0
    areas[1::2] += 2.0 * np.pi * length * (left + right) / 3.0
    return areas


def profile(state: SurfaceState, radii: Array, height: Array, stretch: float = 1.0) -> SurfaceProfile:
    """Pressure, displacement and gap at the surface nodes.

    The pressure is the nodal force over the node's area; the axis takes that of its neighbour, and the
    partly released node at the edge is left out.
    """
    areas = tributary_areas(radii)
    pressure = np.divide(state.forces, areas, out=np.zeros_like(areas), where=areas > 0.0)
    pressure[0] = pressure[1]
    full = int(np.floor(state.edge))
    gap = height - state.penetration + state.displacement
    gap[: full + 1] = 0.0
    shown = np.ones(len(radii), bool)
    if full + 1 < len(radii) and state.edge > full:
        shown[full + 1] = False
    return SurfaceProfile(
        state.time,
        state.penetration,
        state.force,
        state.radius,
        stretch * radii[shown],
        pressure[shown],
        state.displacement[shown],
        gap[shown],
    )
