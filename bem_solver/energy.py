"""Energies of a run from its rows: integrals along the path of the run, and what the branches store.

With ``Y = int p v`` and ``X_k = int p e_k`` over the contact (v at unit modulus, ``e_k = G s_k`` the
displacement of Voigt branch k, ``s_k`` its apparent stress) and ``W_k = int s_k e_k`` over the surface, Eq. U
is ``U = Y/(2 Einf*) + sum_k W_k/(2 J_k)``. G is symmetric: ``dW_k/dt = 2 (J_k X_k - W_k)/theta_k``, driven by
what the rows know. The work of the load ``int F dD`` is an integral along the path. What the branches turn
into heat (Eq. dissipated energy) is what is left: with a sharp edge, whose tip releases the glassy
``K^2/(2 Einf*)`` per area, ``heat = int F dD - U + int K^2/(2 Einf*) dA``; at once there is none.

Between kinks of the loading and jumps of the edge work and X are cubics, with the slopes of the parabolas
through neighbouring rows: straight lines cut the corners of every loop, of n rows ``(2 pi/n)^2/6`` of it.
"""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from bem_solver.creep import Chain, decaying_moments, phi

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
