"""Rows of the trace: observables, work, energies and the balance that closes them.

With a sharp edge the half-space receives the work of the surface forces, ``int sum_i f_i du_i``: what the
indenter does, ``int F dD``, and what opening the interface takes, ``int sum_i f_i dg_i`` over partly released
nodes. It stores and dissipates it in its branches; both are volume integrals (or their condensed
equivalents) that know nothing of the work. ``balance_residual`` is what is left of that identity, with the
work taken by trapezoids between rows, as a reader of the trace would. It measures the steps: it grows where
an edge creeps so slowly that its layer of relaxing stress, ``|da/dt| tau``, is crossed within one of them.

A partly released node is held by the interface as by a spring, with the force ``f`` at the opening ``g``:
its energy ``-f g/2`` belongs to ``stored_energy``, which without it would sag between any two nodes by up to
an eighth of what the edge releases there. The balance of the half-space alone does without it.

``dissipated_energy`` is the loss of the balance ``F dD + dg dA = dU + dL``. It differs from the branch
dissipation by ``zone_excess``: a sharp edge gives back only the glassy ``K^2/(2 Einf*)`` of the work of
adhesion, the remainder is dissipated where the process zone would have held it.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from contact_scene import COLUMNS, Counters, Event, Outcome, Profile, Trace

Array = NDArray[np.float64]

EXTRA = ("branch_dissipation", "zone_excess", "balance_residual")


@dataclass(frozen=True)
class SurfaceState:
    """An accepted state: edge position, controlled and conjugate quantity, nodal vectors, energies.

    ``stored`` is the energy of the half-space, ``held`` that of the hold on a partly released node.
    """

    time: float
    penetration: float
    force: float
    radius: float
    s: float
    forces: Array
    displacement: Array
    stored: float
    held: float
    branch_dissipation: float


@dataclass
class Recorder:
    """Accumulates rows and the work between them; ``kept``, where it is a list, all states."""

    work_of_adhesion: float
    rows: list[tuple[float, ...]] = field(default_factory=list)
    events: list[Event] = field(default_factory=list)
    profiles: list[Profile] = field(default_factory=list)
    external_work: float = 0.0
    surface_work: float = 0.0
    largest_force: float = 0.0
    last: SurfaceState | None = None
    first: SurfaceState | None = None
    kept: list[SurfaceState] | None = None

    def add(self, state: SurfaceState) -> None:
        """Append an accepted state."""
        if self.last is not None:
            mean = 0.5 * (state.force + self.last.force)
            self.external_work += mean * (state.penetration - self.last.penetration)
            forces = 0.5 * (state.forces + self.last.forces)
            self.surface_work += float(forces @ (state.displacement - self.last.displacement))
        else:
            self.first = state
        first = self.first or state
        stored = state.stored - first.stored
        held = state.held - first.held
        adhesion = self.work_of_adhesion * math.pi * (state.radius**2 - first.radius**2)
        loss = self.external_work + adhesion - stored - held
        residual = self.surface_work - stored - state.branch_dissipation
        self.rows.append(
            (
                state.time,
                state.penetration,
                state.force,
                state.radius,
                state.stored + state.held,
                self.external_work,
                loss,
                state.branch_dissipation,
                state.branch_dissipation - loss,
                residual,
            )
        )
        self.last = state
        if self.kept is not None:
            self.kept.append(state)
        self.largest_force = max(self.largest_force, abs(state.force))

    def event(self, kind: str) -> None:
        """An instability that starts from the last row."""
        state = self.last
        if state is not None:
            self.events.append(Event(kind, state.time, state.penetration, state.force, state.radius))

    def trace(self, outcome: Outcome, counters: Counters, wall_seconds: float) -> Trace:
        """All that was recorded."""
        table = np.array(self.rows, float).reshape(len(self.rows), len(COLUMNS) + len(EXTRA))
        columns = dict(zip((*COLUMNS, *EXTRA), table.T.copy(), strict=True))
        return Trace(
            solver="fem",
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
