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
from numpy.typing import NDArray

from contact_scene import Indenter, Material
from validation.reference import prony_integrals, sneddon

Array = NDArray[np.float64]

_GAUSS, _WEIGHT = np.polynomial.legendre.leggauss(3)
_GAUSS, _WEIGHT = 0.5 * (_GAUSS + 1.0), 0.5 * _WEIGHT


def force_of_history(
    material: Material, indenter: Indenter, start: str, time: Array, penetration: Array, radius: Array
) -> Array:
    """Force at all rows, from their times, penetrations and contact radii alone; straight between rows."""
    relaxed, moduli, times = prony_integrals.plane_spectrum(material)
    total = relaxed * (penetration * radius - sneddon.depth_integral(indenter, radius))
    memory = _memory(time, penetration, times)
    first = np.minimum(radius, radius[0])
    first = penetration[0] * first - sneddon.depth_integral(indenter, first)
    for k, (modulus, tau) in enumerate(zip(moduli, times, strict=True)):
        total += modulus * radius * memory[:, k]
        if start == "jump-in":
            total += modulus * first * np.exp(-(time - time[0]) / tau)
        total += modulus * _covered(indenter, (time, penetration, radius), memory[:, k], float(tau))
    return np.asarray(2.0 * total)


def _memory(time: Array, penetration: Array, times: Array) -> Array:
    """``h_k`` at all rows, shape (n, branches): exact for a penetration that is straight between them."""
    memory = np.zeros((len(time), len(times)))
    for row in range(1, len(time)):
        y = (time[row] - time[row - 1]) / times
        shared = np.where(y > 0.0, -np.expm1(-y) / np.where(y > 0.0, y, 1.0), 1.0)
        memory[row] = np.exp(-y) * memory[row - 1] + shared * (penetration[row] - penetration[row - 1])
    return memory


def _covered(indenter: Indenter, rows: tuple[Array, Array, Array], memory: Array, tau: float) -> Array:
    """``int exp(-(t - t_x)/tau) (w_x - h(t_x)) dx`` over the points covered since the start, at all rows."""
    time, penetration, radius = rows
    reached = np.maximum.accumulate(radius)
    before = np.flatnonzero(np.diff(reached) > 0.0)
    result = np.zeros(len(time))
    for row in range(1, len(time)):
        j = before[(before < row) & (reached[before] < radius[row])]
        left, right = reached[j], np.minimum(reached[j + 1], radius[row])
        x = left + (right - left) * _GAUSS[:, None]
        share = (x - radius[j]) / (radius[j + 1] - radius[j])
        covered, depth, held = (c[j] + share * (c[j + 1] - c[j]) for c in (time, penetration, memory))
        jump = np.exp(-(time[row] - covered) / tau) * (depth - sneddon.depth(indenter, x) - held)
        result[row] = float((_WEIGHT[:, None] * (right - left) * jump).sum())
    return result
