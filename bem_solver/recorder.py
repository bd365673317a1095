"""Records accepted states, events and profiles (paper, Fig. 3); the energies of a run follow from its rows.

With ``Y = int p v`` and ``X_k = int p e_k`` over the contact and ``W_k = int s_k e_k`` over the surface,
``U = Y/(2 Einf*) + sum_k W_k/(2 J_k)`` (Eq. U), ``dW_k/dt = 2 (J_k X_k - W_k)/theta_k``. The work of the load
is an integral along the path; ``heat = int F dD - U + int K^2/(2 Einf*) dA``, and at once there is none.
Between kinks of the loading and jumps of the edge work and X are cubics, with the slopes of the parabolas
through neighbouring rows: straight lines cut the corners of every loop, of n rows ``(2 pi/n)^2/6`` of it.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from bem_solver.creep import Chain, decaying_moments, phi
from bem_solver.problem import Problem
from bem_solver.surface_points import HalfSpaceState, points_at
from contact_scene import COLUMNS, Adhesion, Counters, Event, Outcome, OutcomeKind, SurfaceProfile, Trace

Array = NDArray[np.float64]


_LEAST_SHARE = 0.01
"""Distance of a neighbour, in the larger of the two steps, below which it tells no slope: steps that follow
from each other differ by less, those between two prescribed times may be of any length."""


class RowPath:
    """Rows of a run at times (n,), and with the contact radii there the length of its path between them.

    ``kinks`` are rows at which slopes may jump; so they may between rows of the same time. An edge that runs
    away, as before a limit point, is a root of time: there its own path is the longer one. One that goes to
    and fro has a long way, and time counts: where it turns, a length of its own way would not be smooth.
    """

    def __init__(self, time: Array, kinks: list[int], edge: Array | None = None) -> None:
        at_once = np.flatnonzero(np.diff(time) <= 0.0)
        borders = sorted({0, *kinks, *at_once.tolist(), *(at_once + 1).tolist(), len(time) - 1})
        self._pieces = [slice(first, last + 1) for first, last in pairwise(borders) if last - first > 2]
        self._steps = [
            np.diff(time[rows]) if edge is None else _lengths(time[rows], edge[rows]) for rows in self._pieces
        ]

    def bends(self, values: Array) -> tuple[Array, Array]:
        """Slopes at both ends of every step, times the step, beyond the chord, each (n - 1,)."""
        chord = np.diff(values)
        early, late = np.zeros_like(chord), np.zeros_like(chord)
        for rows, step in zip(self._pieces, self._steps, strict=True):
            slope, steps = _slopes(step, values[rows]), slice(rows.start, rows.stop - 1)
            early[steps], late[steps] = slope[:-1] * step - chord[steps], slope[1:] * step - chord[steps]
        return early, late

    def integral(self, force: Array, place: Array) -> Array:
        """``int F dD`` over every step, (n - 1,), of values (n,) at the rows.

        With the bends a and b, ``F = chord + a s (1 - s)^2 - b s^2 (1 - s)`` over a share s of the step.
        """
        d, (d0, d1) = np.diff(place), self.bends(place)
        f, (f0, f1) = np.diff(force), self.bends(force)
        straight = 0.5 * (force[1:] + force[:-1]) * d
        return straight + (d * (f0 - f1) - f * (d0 - d1)) / 12.0 + (f1 * d0 - f0 * d1) / 60.0


def stored_energy(chain: Chain, path: RowPath, time: Array, load_work: Array, branch_work: Array) -> Array:
    """Stored energy U (n,) from Y (n,) and X (n, K) at rows of a path in time.

    ``W_k/J_k`` starts as ``X_k``, of a contact that has relaxed or of branches without strain, and follows X
    exactly, a cubic in time.
    """
    stored = 0.5 * load_work / chain.glassy
    for theta, work in zip(chain.retardation, branch_work.T, strict=True):
        y = 2.0 * np.diff(time) / theta
        decay, spread, (early, late) = np.exp(-y), phi(y), path.bends(work)
        once, twice = decaying_moments(y)
        gained = work[1:] * (1.0 - spread) + work[:-1] * (spread - decay)
        gained += y * (early * twice - late * (once - twice))
        energy = work[0]
        stored[0] += 0.5 * energy
        for row, (left, more) in enumerate(zip(decay.tolist(), gained.tolist(), strict=True), 1):
            energy = left * energy + more
            stored[row] += 0.5 * energy
    return stored


def tip_energy(radius: Array, release: Array) -> Array:
    """What the tip releases over every step, ``int K^2/(2 Einf*) dA`` (n - 1,), by its rates at rows (n,).

    The release jumps where the edge turns or sets off, and in a step that passes a place where it did.
    """
    taken, rests, came = np.zeros(len(radius) - 1), [], 0.0
    for step, (edge, new_edge) in enumerate(pairwise(radius.tolist())):
        way = np.sign(new_edge - edge)
        if way == 0.0:
            continue
        if way != came:
            rests.append(edge)
        before, after = release[step : step + 2].tolist()
        area = math.pi * (new_edge - edge) * (new_edge + edge)
        met = [rest for rest in rests if min(edge, new_edge) <= rest <= max(edge, new_edge)]
        if not met or (came == way and met == [edge]):
            taken[step] = 0.5 * (before + after) * area
        else:
            rest = min(met, key=lambda radius: abs(radius - edge))
            passed = math.pi * (rest - edge) * (rest + edge)
            taken[step] = before * passed + after * (area - passed)
        came = way
    return taken


def rest_ends(radius: Array) -> list[int]:
    """Rows at which an edge that has rested sets off, or comes to rest."""
    rests = np.diff(radius) == 0.0
    return (np.flatnonzero(rests[1:] != rests[:-1]) + 1).tolist()


def _lengths(time: Array, edge: Array) -> Array:
    """Lengths (n - 1,) of the path of the edge over time between rows, both in parts of their totals."""
    moved = np.abs(np.diff(edge))
    return np.hypot(np.diff(time) / np.ptp(time), moved / (moved.sum() or 1.0))


def _slopes(step: Array, values: Array) -> Array:
    """Derivatives at the rows, of the parabola through each and its neighbours.

    A neighbour far closer than the other is passed over: what the two rows miss would be all of the secant.
    Where there is no other, the slope is the other secant.
    """
    place = np.concatenate(([0.0], np.cumsum(step)))
    at, inner, inside = place[1:-1], values[1:-1], np.arange(1, len(step))
    away = _LEAST_SHARE * np.maximum(step[:-1], step[1:])
    left = np.clip(place.searchsorted(at - away, "right") - 1, 0, inside - 1)
    right = np.clip(place.searchsorted(at + away, "left"), inside + 1, len(step))
    before, after = at - place[left], place[right] - at
    early, late = (inner - values[left]) / before, (values[right] - inner) / after
    middle = (early * after + late * before) / (before + after)
    middle = np.where(before < away, late, np.where(after < away, early, middle))
    first = 2.0 * (values[1] - values[0]) / step[0] - middle[0]
    last = 2.0 * (values[-1] - values[-2]) / step[-1] - middle[-1]
    return np.concatenate(([first], middle, [last]))


def energy_spent(adhesion: Adhesion, radius: Array, closure: Array) -> Array:
    """Energy that the interface takes up over every step (n - 1,); negative where the edge closes.

    Of contact radii and closure integrals (n,) at the rows: what an opening edge takes up there.
    """
    area = -np.pi * np.diff(radius**2)
    opening = np.full_like(closure, adhesion.work)
    if adhesion.rate is not None:
        opening = np.clip(closure, adhesion.work, adhesion.opening(math.inf))
    return area * np.where(area > 0.0, 0.5 * (opening[1:] + opening[:-1]), adhesion.closing)


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

        ``energies`` are what is stored, and what the interface and the branches have taken up, all (n,).
        ``zone_excess`` is what the branches dissipate beyond the loss: a sharp tip takes only the glassy
        ``K^2/(2 Einf*)``.
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
    at = state.time, state.penetration, state.surface.force, edge
    return SurfaceProfile(*at, radius, pressure, points.displacement, gap)
