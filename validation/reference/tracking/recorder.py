"""Rows of the trace, gathered step by step, and the columns computed from them.

``F dD + dg dA = dU + P_d dt`` defines the loss. A field with a sharp edge releases only the glassy
``K^2/(2 Einf*)`` at the tip, ``2 pi a da K^2/(2 Einf*) = q(a)^2/Einf* da``; what the branches dissipate is
therefore ``F dD - dU + q(a)^2/Einf* da``, larger than the loss by ``(dg - K^2/(2 Einf*)) |dA|`` on opening.
What the interface takes up, ``-int dg dA``, is the separation energy; ``dg`` may depend on direction and
speed.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from validation.reference.path.rheology import Body
from validation.reference.tracking.dense_output import cubics
from validation.reference.tracking.energy import stored_energy
from validation.reference.tracking.interface_work import interface_work
from validation.reference.tracking.law import Griffith
from validation.reference.tracking.row_integrals import integrals, released_at_once
from validation.reference.tracking.surface import Surface

Array = NDArray[np.float64]

LEAST_AREA_CHANGE = 1e-6
"""Change of the contact area, relative to the largest area, below which no energy release rate is formed."""
LEAST_DISTANCE = 1e-9
"""Distance in time from another row, in step lengths, below which an interpolated row is left out."""
EXTRA_COLUMNS = (
    "stress_intensity_factor",
    "energy_release_rate",
    "branch_dissipation",
    "separation_energy",
)
"""Columns beside those of every solver."""
DEPTH = 1
"""Column of the penetration in interpolated values, which lack the time."""
ROW = ("time", "penetration", "force", "radius", "stored", "edge stress", "closure", "tip")
"""What a recorded row holds."""
FORCE_OF_ROW, RADIUS_OF_ROW = 2, 3
"""Places of force and radius in a recorded row."""
SEPARATION = 6
"""Place of the separation energy in the rows of the trace, of the closure integral in recorded ones."""


@dataclass
class RecordedRows:
    """Rows of a run.

    Time, penetration, force, radius, stored energy, edge stress, closure integral (where the edge takes up
    what its speed tells, otherwise 0), tip energy. The last is a sum over steps, found within each: there the
    edge may come into another field.

    ``kinks``: rows at which rates jump. ``over_radius``: rows at the end of steps that are smooth over the
    radius. ``interpolated``: rows to be added by interpolation, as the step they lie in, their time, the
    penetration if it is prescribed, and the radius in a step that is smooth over it. ``reversible``: rows to
    which equilibria at a fixed time lead from the row before.
    """

    rows: list[tuple[float, ...]] = field(default_factory=list)
    kinks: list[int] = field(default_factory=list)
    over_radius: list[int] = field(default_factory=list)
    interpolated: list[tuple[int, float, float | None, float | None]] = field(default_factory=list)
    reversible: list[int] = field(default_factory=list)
    tip_energy: float = 0.0


@dataclass(frozen=True)
class DenseRows:
    """Recorded and interpolated rows in order.

    ``ends``: rows at which smooth stretches end. ``over_radius``: first and last rows of steps that are
    smooth over the radius. ``reversible``: first and last rows of ways of equilibria at a fixed time.
    """

    rows: Array
    ends: list[int]
    over_radius: list[tuple[int, int]]
    reversible: list[tuple[int, int]]


@dataclass
class Recorder:
    """Records the rows of a run; ``irreversible`` is the edge condition if its energy depends on the way."""

    body: Body
    work: float
    irreversible: Griffith | None
    recorded: RecordedRows = field(default_factory=RecordedRows)

    def add(self, time: float, surface: Surface, force: float) -> None:
        """One row.

        Parameters
        ----------
        time : float
        surface : Surface
            In contact, or free where its radius is 0.
        force : float
        """
        radius = surface.radius
        stress = surface.edge_stress(self.body) if radius > 0.0 else 0.0
        energy = stored_energy(surface, self.body)
        law, closure = self.irreversible, 0.0
        if law is not None and law.rated and radius > 0.0:
            closure = law.closure(surface, self.body)
        self.recorded.tip_energy += surface.tip_energy
        self.recorded.rows.append(
            (
                time,
                surface.penetration,
                force,
                radius,
                energy,
                stress,
                closure,
                self.recorded.tip_energy,
            )
        )

    def interpolate(self, time: float, depth: float | None, back: int, radius: float | None = None) -> None:
        """Add a row by interpolation.

        Parameters
        ----------
        time : float
        depth : float or None
            Penetration there, if it is prescribed.
        back : int
            In which step, counted back from the last, which is 1.
        radius : float, optional
            Contact radius there, in a step that is smooth over it.
        """
        self.recorded.interpolated.append((len(self.recorded.rows) - 1 - back, time, depth, radius))

    def reversible(self, first: int, unstable: int | None) -> None:
        """Equilibria at one time lead to each row from ``first`` on, but to one, counted from there."""
        rows = range(first, len(self.recorded.rows))
        self.recorded.reversible += [row for row in rows if row - first != unstable]

    def over_radius(self) -> None:
        """The step to the last row is smooth over the radius, not in time."""
        self.recorded.over_radius.append(len(self.recorded.rows) - 1)

    def kink(self) -> None:
        """Rates jump at the last row."""
        self.recorded.kinks.append(len(self.recorded.rows) - 1)

    def columns(self, whole: bool = True) -> dict[str, Array]:
        """All columns by name: the contract's seven, then ``stress_intensity_factor`` (``-q(a)/sqrt(pi a)``,
        0 without contact), ``energy_release_rate`` (between a row and the one before; repeated where the
        area hardly changed), ``branch_dissipation`` and ``separation_energy``. If not ``whole``, without the
        last two steps: their interpolated rows depend on later steps."""
        dense = self._dense()
        rows, ends, over_radius = dense.rows, dense.ends, dense.over_radius
        if not whole:
            last = float(self.recorded.rows[max(len(self.recorded.rows) - 3, 0)][0])
            rows = rows[: int(np.searchsorted(rows[:, 0], last, side="right"))]
            ends = [*(end for end in ends if end < len(rows) - 1), len(rows) - 1]
        time, depth, force, radius, energy, stress, spent, tip = rows.T
        area = math.pi * radius**2
        work = integrals(time, force, depth, ends)
        for first, last in over_radius:
            if last < len(time):
                begin = stretch_over_radius(radius, first, max(end for end in ends if end <= first))
                each = slice(begin, last + 1)
                over = integrals(
                    np.abs(radius[each] - radius[begin]), force[each], depth[each], [0, last - begin]
                )
                work[first:last] = over[first - begin :]
        for first, last in dense.reversible:
            if last < len(time):  # no dashpot moves: what is done is stored, or released at the tip
                each = slice(first, last + 1)
                released = released_at_once(radius[each], stress[each] ** 2) / self.body.rheology.glassy
                work[first:last] = np.diff(energy[each]) - released
        external = _accumulated(work)[: len(time)]
        stored = energy - energy[:1]
        if self.irreversible is None:
            spent = -self.work * (area - area[:1])
        elif self.irreversible.adhesion.rate is None:
            grown = np.diff(area)
            per_area = np.where(grown > 0.0, self.irreversible.adhesion.closing, self.work)
            spent = _accumulated(-per_area * grown)[: len(time)]
        branch = np.where(np.diff(time) > 0.0, np.diff(external - stored + tip), 0.0)  # dashpots take time
        intensity = np.where(
            radius > 0.0, -stress / np.sqrt(math.pi * np.where(radius > 0.0, radius, 1.0)), 0.0
        )
        return {
            "time": time,
            "penetration": depth,
            "force": force,
            "contact_radius": radius,
            "stored_energy": energy,
            "external_work": external,
            "dissipated_energy": external - spent - stored,
            "stress_intensity_factor": intensity,
            "energy_release_rate": self._release_rate(area, stored - external),
            "branch_dissipation": _accumulated(branch)[: len(time)],
            "separation_energy": spent,
        }

    def _dense(self) -> DenseRows:
        """All rows with the interpolated ones."""
        rows = np.array(self.recorded.rows).reshape(-1, len(ROW))
        stands = np.diff(rows[:, 0]) <= 0.0
        turns = np.flatnonzero(stands[1:] != stands[:-1]) + 1
        given = np.array([0, *self.recorded.kinks, max(len(rows) - 1, 0)], dtype=int)
        ends = np.array(sorted({*given.tolist(), *turns.tolist()}))
        if self.irreversible is not None and self.irreversible.rated:
            area, closure = math.pi * rows[:, RADIUS_OF_ROW] ** 2, rows[:, SEPARATION]
            parts = interface_work(self.irreversible.adhesion, rows[:, 0], area, closure, ends.tolist())
            rows[:, SEPARATION] = _accumulated(parts)[: len(rows)]
        last_rows = np.array(self.recorded.over_radius, dtype=int)
        reached = np.array(self.recorded.reversible, dtype=int)
        begins = reached[~np.isin(reached - 1, reached)] - 1
        lasts = reached[~np.isin(reached + 1, reached)]
        if not self.recorded.interpolated:
            return DenseRows(rows, ends.tolist(), _pairs(last_rows - 1, last_rows), _pairs(begins, lasts))
        inner = sorted(self.recorded.interpolated, key=lambda entry: entry[:2])
        index = np.array([entry[0] for entry in inner])
        times = np.array([entry[1] for entry in inner])
        apart = LEAST_DISTANCE * (rows[index + 1, 0] - rows[index, 0])
        before = np.maximum(rows[index, 0], np.concatenate(([-math.inf], times[:-1])))
        distinct = (times - before > apart) & (rows[index + 1, 0] - times > apart)
        inner = [entry for entry, is_one in zip(inner, distinct, strict=True) if is_one]
        index, times = index[distinct], times[distinct]
        extra = np.column_stack((times, cubics(rows[:, 0], rows[:, 1:], ends, index, times)))
        for each, (step, _, _, radius) in enumerate(inner):
            if radius is not None:
                begin = stretch_over_radius(rows[:, RADIUS_OF_ROW], step, ends[ends <= step][-1])
                near = rows[begin : step + 2]
                x = np.abs(near[:, RADIUS_OF_ROW] - near[0, RADIUS_OF_ROW])
                at = np.array([abs(radius - near[0, RADIUS_OF_ROW])])
                whole = np.array([0, len(near) - 1])
                extra[each, 1:] = cubics(x, near[:, 1:], whole, np.array([len(near) - 2]), at)[0]
        if self.work == 0.0:  # no polynomial pulls where nothing can
            extra[:, FORCE_OF_ROW] = np.maximum(extra[:, FORCE_OF_ROW], 0.0)
        known = np.array([entry[2] is not None for entry in inner], dtype=bool)
        extra[known, DEPTH] = [entry[2] for entry in inner if entry[2] is not None]
        first_rows, last_rows, ends, begins, lasts = (
            at + index.searchsorted(at) for at in (last_rows - 1, last_rows, ends, begins, lasts)
        )
        all_rows = np.insert(rows, index + 1, extra, axis=0)
        return DenseRows(all_rows, ends.tolist(), _pairs(first_rows, last_rows), _pairs(begins, lasts))

    def _release_rate(self, area: Array, potential: Array) -> Array:
        """``(dU - F dD)/dA``; the work of adhesion, its value in equilibrium, before anything has moved."""
        rate = np.full_like(area, self.work)
        if len(area) < 2:
            return rate
        step = np.diff(area)
        moves = np.abs(step) > LEAST_AREA_CHANGE * area.max()
        last = np.maximum.accumulate(np.where(moves, np.arange(len(step)), -1))
        each = np.divide(np.diff(potential), step, out=np.zeros_like(step), where=moves)
        rate[1:] = np.where(last >= 0, each[last], self.work)
        return rate


def _pairs(first: NDArray[np.int64], last: NDArray[np.int64]) -> list[tuple[int, int]]:
    return list(zip(first.tolist(), last.tolist(), strict=True))


def stretch_over_radius(radius: Array, row: int, first: int) -> int:
    """The row from which the radius moves on in one direction to the row after ``row``, three before at most.

    Parameters
    ----------
    radius : ndarray, shape (l,)
        Of the rows.
    row : int
        Row before which earlier ones are looked for.
    first : int
        Row before which there is none: rates jump there.

    Returns
    -------
    int
    """
    direction = radius[row + 1] - radius[row]
    begin = row
    while begin > max(first, row - 3) and (radius[begin] - radius[begin - 1]) * direction > 0.0:
        begin -= 1
    return begin


def _accumulated(parts: Array) -> Array:
    return np.concatenate(([0.0], np.cumsum(parts)))
