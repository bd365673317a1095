"""Force of a contact whose radius and penetration are known at all times: a check on the rows of any solver.

Under the Abel transform each point ``x`` of the surface is driven by its own strain alone. A point covered at
``t_x`` was untouched before, so its strain jumps to ``w_x = D(t_x) - G(x)`` (zero without adhesion) and then
follows the penetration,

    q(x, t) = E*(t - t_x) w_x + int_(t_x)^t E*(t - s) dD(s),    F(t) = 2 int_0^a(t) q(x, t) dx,

for any indenter, holds, jumps and force control alike, as long as the edge does not advance over points that
it has released. With ``h_k(t) = int_0^t exp(-(t - s)/tau_k) dD(s)`` a branch carries
``E_k [h_k(t) + exp(-(t - t_x)/tau_k) (w_x - h_k(t_x))]``.

Sneddon (1965) for the transform; Lee and Radok (1960) and Ting (1966) are the case ``w_x = 0``.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray
from support.closed_forms.separate_bulk import equivalent_material

from contact_scene import Indenter, Material
from validation.reference import prony_integrals, sneddon

Array = NDArray[np.float64]

_GAUSS, _WEIGHT = np.polynomial.legendre.leggauss(3)
_GAUSS, _WEIGHT = 0.5 * (_GAUSS + 1.0), 0.5 * _WEIGHT
RELEASED = 1e-3
"""Advance over released points, in largest radii, that is taken for scatter of the rows."""


def force_of_history(
    material: Material,
    indenter: Indenter,
    start: str,
    time: ArrayLike,
    penetration: ArrayLike,
    contact_radius: ArrayLike,
) -> Array:
    """Force at all rows, from their times, penetrations and contact radii alone; straight between rows."""
    t, depth, radius = (np.asarray(column, float) for column in (time, penetration, contact_radius))
    if _covered_again(radius) > RELEASED * radius.max():
        raise ValueError("the edge advances over points that it has released")
    if material.bulk is not None:
        material = equivalent_material(material)
    relaxed, moduli, times = prony_integrals.plane_spectrum(material)
    elastic = relaxed * (depth * radius - sneddon.depth_integral(indenter, radius))
    memory = _memory(t, depth, times)
    first = depth[0] * np.minimum(radius, radius[0])
    first = first - sneddon.depth_integral(indenter, np.minimum(radius, radius[0]))
    total = elastic.copy()
    for k, (modulus, tau) in enumerate(zip(moduli, times, strict=True)):
        total += modulus * radius * memory[:, k]
        if start == "jump-in":
            total += modulus * first * np.exp(-(t - t[0]) / tau)
        total += modulus * _covered(indenter, (t, depth, radius), memory[:, k], float(tau))
    return np.asarray(2.0 * total)


def _covered_again(radius: Array) -> float:
    """Largest advance over points that had been released before."""
    largest, peak, low = 0.0, float(radius[0]), float(radius[0])
    for now in radius.tolist():
        low = min(low, now)
        largest = max(largest, min(now, peak) - low)
        if now >= peak:
            peak = low = now
    return largest


def _memory(t: Array, depth: Array, times: Array) -> Array:
    """``h_k`` at all rows, shape (n, branches): exact for a penetration that is straight between them."""
    memory = np.zeros((len(t), len(times)))
    for row in range(1, len(t)):
        y = (t[row] - t[row - 1]) / times
        shared = np.where(y > 0.0, -np.expm1(-y) / np.where(y > 0.0, y, 1.0), 1.0)
        memory[row] = np.exp(-y) * memory[row - 1] + shared * (depth[row] - depth[row - 1])
    return memory


def _covered(indenter: Indenter, rows: tuple[Array, Array, Array], memory: Array, tau: float) -> Array:
    """``int exp(-(t - t_x)/tau) (w_x - h(t_x)) dx`` over the points covered since the start, at all rows."""
    t, depth, radius = rows
    reached = np.maximum.accumulate(radius)
    before = np.flatnonzero(np.diff(reached) > 0.0)
    result = np.zeros(len(t))
    for row in range(1, len(t)):
        j = before[(before < row) & (reached[before] < radius[row])]
        left, right = reached[j], np.minimum(reached[j + 1], radius[row])
        x = left + (right - left) * _GAUSS[:, None]
        share = (x - radius[j]) / (radius[j + 1] - radius[j])

        def between(column: Array, j: Array = j, share: Array = share) -> Array:
            return column[j] + share * (column[j + 1] - column[j])

        jump = between(depth) - sneddon.depth(indenter, x) - between(memory)
        faded = np.exp(-(t[row] - between(t)) / tau)
        result[row] = float((_WEIGHT[:, None] * (right - left) * faded * jump).sum())
    return result
