"""Records accepted states, events and profiles, and makes the trace of them."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from bem_solver.creep import Chain
from bem_solver.energy import Energies, share_of_balance
from bem_solver.external_work import external_work
from bem_solver.half_space_state import HalfSpaceState
from contact_scene import COLUMNS, Counters, Event, Outcome, OutcomeKind, SurfaceProfile, Trace

Array = NDArray[np.float64]

_SHORT_OF_SMOOTH = 4.0
"""By how much shorter than one that counts as short for a branch a step and its neighbours have to be for the
power that the branch receives to be a cubic."""


@dataclass
class TraceRecorder:
    """Rows, events and profiles of a run so far.

    ``kinks`` are the rows after which slopes may jump, ``shortest`` is the shortest relaxation time,
    ``retardation`` (K,) those of the branches; ``supplies`` holds of each row the power that every branch
    receives, and what it received beyond a trapezoid in the step before, both (K,).
    """

    rows: list[tuple[float, ...]] = field(default_factory=list)
    supplies: list[tuple[Array, Array]] = field(default_factory=list)
    events: list[Event] = field(default_factory=list)
    profiles: list[SurfaceProfile] = field(default_factory=list)
    kinks: list[int] = field(default_factory=list)
    shortest: float = math.inf
    retardation: Array = field(default_factory=lambda: np.zeros(0))

    def row(self, chain: Chain, state: HalfSpaceState, energies: Energies) -> None:
        """Add the row of an accepted state.

        Parameters
        ----------
        chain : Chain
        state : HalfSpaceState
            Its ``spent`` counts where adhesion is irreversible.
        energies : Energies
        """
        surface = state.surface
        self.rows.append(
            (
                state.time,
                state.penetration,
                surface.force,
                state.edge,
                energies.stored(chain),
                energies.dissipated,
                surface.stress_intensity,
                state.spent,
                energies.tip,
            )
        )
        self.supplies.append((energies.supply(chain), energies.bend))

    @property
    def forces(self) -> list[float]:
        """Force of every row, positive in compression."""
        return [row[2] for row in self.rows]

    def kink(self) -> None:
        """Slopes may jump at the last row."""
        self.kinks.append(max(len(self.rows) - 1, 0))

    def event(self, kind: str, state: HalfSpaceState) -> None:
        """An instability of a committed state."""
        self.events.append(Event(kind, state.time, state.penetration, state.surface.force, state.edge))

    def profile(self, profile: SurfaceProfile) -> None:
        """The surface at a requested time; of two at one time (a jump) the later stays."""
        self.profiles = [p for p in self.profiles if p.time != profile.time] + [profile]

    def trace(self, outcome: Outcome, counters: Counters, work: float, reversible: bool = True) -> Trace:
        """The finished trace; the loss is what the energy balance (Eq. energybalance) leaves.

        Parameters
        ----------
        outcome : Outcome
        counters : Counters
        work : float
            Work of adhesion.
        reversible : bool
            Whether what the interface takes up, its ``separation_energy``, follows from the contact area.

        Returns
        -------
        Trace

        Notes
        -----
        ``zone_excess`` is what the branches dissipate beyond the loss: at a sharp edge the whole field moves
        as if the process zone had no length, and the tip takes only the glassy ``K^2/(2 Einf*)``.
        """
        columns = [np.array(column) for column in zip(*self.rows, strict=True)]
        time, penetration, force, radius, stored, _, intensity, spent, *_ = columns
        kinks = [*self.kinks, *rest_ends(radius)]
        external = external_work(time, penetration, force, kinks, radius)
        area = np.pi * radius**2
        if reversible:
            spent = -work * (area - area[0])
        dissipated = external - spent - (stored - stored[0])
        heat = self._branch_heat(columns, external, kinks)
        branch = np.concatenate(([0.0], np.cumsum(heat)))
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
                "energy_release_rate": release_rate(stored, force, penetration, area, work),
                "separation_energy": spent,
            },
            events=tuple(self.events),
            profiles=tuple(self.profiles),
        )

    def _branch_heat(self, columns: list[Array], external: Array, kinks: list[int]) -> Array:
        """What the branches turn into heat in each step, shape (n - 1,).

        From the columns of the rows, the external work (n,) and the rows after which slopes may jump.
        """
        time, _, _, radius, stored, branch, _, _, tip = columns
        duration, grown = np.diff(time), np.pi * np.diff(radius**2)
        share = share_of_balance(duration, self.shortest)
        heat = np.diff(branch) + self._beyond_trapezoids(time, kinks)
        rests = grown == 0.0  # the tip releases nothing, and no load is as straight as the forms take it
        balanced = np.diff(external) - np.diff(stored) + np.where(rests, 0.0, tip[1:])
        known = (duration > 0.0) & np.isfinite(balanced)
        share = np.where(known, np.where(rests, 1.0, share), 0.0)
        return share * np.where(known, balanced, 0.0) + (1.0 - share) * heat

    def _beyond_trapezoids(self, time: Array, kinks: list[int]) -> Array:
        """What the branches receive in each step more than their heat counts, shape (n - 1,)."""
        duration = np.diff(time)
        padded = np.pad(duration, 1)
        around = np.maximum(np.maximum(padded[:-2], padded[2:]), duration)
        found = np.zeros_like(duration)
        if not len(self.retardation):
            return found
        supplies, bends = (np.array(each).T for each in zip(*self.supplies, strict=True))
        for supply, bend, retardation in zip(supplies, bends, self.retardation, strict=True):
            smooth = 1.0 - share_of_balance(_SHORT_OF_SMOOTH * around, retardation)
            if smooth.any():
                received = np.diff(external_work(time, time, supply, kinks))
                found += smooth * (received - 0.5 * (supply[1:] + supply[:-1]) * duration - bend[1:])
        return found


def rest_ends(radius: Array) -> list[int]:
    """Rows at which an edge that has rested sets off, or comes to rest: slopes may jump there.

    Parameters
    ----------
    radius : ndarray (n,)
        Contact radius.

    Returns
    -------
    list of int
    """
    rests = np.diff(radius) == 0.0
    return (np.flatnonzero(rests[1:] != rests[:-1]) + 1).tolist()


def trace_without_start(reason: str, counters: Counters) -> Trace:
    """The trace of a scene without a start state: all columns, no row.

    Parameters
    ----------
    reason : str
        Why there is no start state.
    counters : Counters

    Returns
    -------
    Trace
    """
    outcome = Outcome(OutcomeKind.NO_EQUILIBRIUM, reason, 0.0)
    trace = TraceRecorder([(0.0,) * 9]).trace(outcome, counters, 0.0)
    empty = {name: getattr(trace, name)[:0] for name in COLUMNS}
    return replace(trace, **empty, extra={name: column[:0] for name, column in trace.extra.items()})


def release_rate(
    stored: np.ndarray, force: np.ndarray, penetration: np.ndarray, area: np.ndarray, work: float
) -> np.ndarray:
    """``G = (dU - F dD)/dA`` (Eq. enrelrate) between neighbouring rows.

    Parameters
    ----------
    stored, force, penetration, area : ndarray (n,)
        Stored energy, force, penetration and contact area.
    work : float
        Work of adhesion.

    Returns
    -------
    ndarray (n,)

    Notes
    -----
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
