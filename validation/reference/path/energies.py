"""The force along a step, from what is known at its rows, and what it works.

With ``B_k = int b_k dx`` over the contact, at any instant

    dF/du = 2 [ Einf* a dD/du - (dt/du) sum_k B_k/tau_k + q(a) da/du ],

exactly: a row knows the slope of the force as it knows the force. Between two rows it is the quartic through
both and the value in the row before, or the cubic through both after a kink.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from validation.reference.path.polynomials import gauss, horner, powers
from validation.reference.path.state import Body, State
from validation.reference.path.trial import Arrival, Trial

Array = NDArray[np.float64]
_POINTS, _WEIGHTS = gauss(6)


def edge_stress(body: Body, state: State, ahead: bool) -> float:
    """``q`` at the edge, just inside; ``ahead``: of the next point, as it is covered."""
    rheology, a = body.rheology, np.array([state.radius])
    at = a * (1.0 + 1e-12) if ahead else a
    G = body.transform(a)
    _, carried = state.surface.at(at, G, state.time, rheology.times, rheology.retardation)
    strain = state.depth - G
    if ahead:
        return float(rheology.stress(rheology.cover(carried, strain), strain)[0])
    return float(rheology.stress(carried + rheology.moduli * state.memory, strain)[0])


def force_slopes(body: Body, trial: Trial, arrival: Arrival, after: State) -> tuple[float, float]:
    """``dF/du`` at both ends of a step."""
    way = trial.segment.way
    clock, depth = arrival.motion.clock, arrival.motion.depth_slope()
    slopes = []
    for state, end in ((trial.state, False), (after, True)):
        relaxed = float((state.held / body.rheology.times).sum())
        rates = [float(c @ np.arange(len(c))) if end else float(c[1]) for c in (depth, clock, way)]
        stress = edge_stress(body, state, trial.direction > 0.0 and not end) if trial.direction else 0.0
        slopes.append(
            2.0 * (body.rheology.glassy * state.radius * rates[0] - rates[1] * relaxed + stress * rates[2])
        )
    return slopes[0], slopes[1]


def force_polynomial(
    first: tuple[float, float], last: tuple[float, float], before: tuple[float, float] | None
) -> Array:
    """Coefficients of the force from value and slope at both ends; ``before``: ``u < 0`` and value of a row."""
    degree = 3 if before is None else 4
    ends = powers(np.array([0.0, 1.0]), degree)
    slopes = np.hstack((np.zeros((2, 1)), ends[:, :-1] * np.arange(1, degree + 1)))
    matrix, right = np.vstack((ends, slopes)), [first[0], last[0], first[1], last[1]]
    if before is not None:
        matrix = np.vstack((matrix, powers(np.array([before[0]]), degree)))
        right.append(before[1])
    return np.asarray(np.linalg.solve(matrix, right))


def work(force: Array, depth: Array) -> float:
    """``int F dD`` over a step."""
    slope = depth[1:] * np.arange(1, len(depth))
    return float(_WEIGHTS @ (horner(force, _POINTS) * horner(slope, _POINTS)))
