"""The limit point at which contact is lost, from the rows before it.

Towards a limit point the controlled quantity ``X(a)`` is flat, so a ripple of ``1e-7`` of its size, as the
edge passes the nodes, moves the last radius at which there is an equilibrium by a good part of an element.
The ripple repeats with every element, and has two nodes in each: a polynomial and the first two harmonics of
an element are fitted to the rows of the last few elements, and the polynomial has the extremum that the mesh
hides.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.polynomial import Polynomial
from numpy.typing import NDArray

from contact_scene.loading import Control

Array = NDArray[np.float64]

_ELEMENTS = 3
"""Elements behind the last row that are fitted, whole ones: two do not tell a cubic from a ripple, and the
curve over more is no longer that of its extremum."""
_SAMPLES = 20
"""Samples per element: each part of it counts alike, however dense its rows are."""
_WIDEST_ROWS = 0.5
"""Farthest that rows may lie apart, in elements: beyond it they do not resolve a ripple."""


@dataclass(frozen=True)
class LimitPoint:
    """Penetration, force and contact radius at the extremum of the controlled quantity."""

    penetration: float
    force: float
    radius: float


def limit_point(rows: Array, element: float, control: Control, compliance: float = 0.0) -> LimitPoint | None:
    """Extremum of the controlled quantity along the rows of an edge that recedes to it.

    Parameters
    ----------
    rows : ndarray, shape (n, 3)
        Penetration, force and contact radius, the last row nearest to the limit point.
    element : float
        Length of an element at the edge.
    control : "penetration", "force" or "stage"
    compliance : float
        Of the machine; the stage is at ``D + C F``.

    Returns
    -------
    LimitPoint or None
        ``None`` if the rows do not tell: they do not recede steadily through the elements needed, or the
        extremum lies farther than an element from the last row, or those of a cubic and a quadratic are
        farther apart than the cubic's from the last row.
    """
    last = float(rows[-1, 2])
    behind = (rows[::-1, 2] - last) / element
    beyond = np.flatnonzero(behind >= _ELEMENTS)
    if not beyond.size:
        return None
    count = int(beyond[0]) + 1
    at = behind[:count]
    steps = np.diff(at)
    if steps.min() <= 0.0 or steps.max() > _WIDEST_ROWS:
        return None
    samples = (np.arange(_ELEMENTS * _SAMPLES) + 0.5) / _SAMPLES
    penetration, force = (np.interp(samples, at, rows[::-1, column][:count]) for column in (0, 1))
    controlled = {"penetration": penetration, "force": force}.get(control, penetration + compliance * force)
    cubic, quadratic = (_extremum(samples, controlled, degree) for degree in (3, 2))
    if cubic is None or quadratic is None or abs(cubic) > 1.0 or abs(cubic - quadratic) >= abs(cubic):
        return None
    depth, load = (float(_fit(samples, values, 3)(cubic)) for values in (penetration, force))
    return LimitPoint(depth, load, last + cubic * element)


def _fit(x: Array, y: Array, degree: int) -> Polynomial:
    """Polynomial part of the least-squares fit; ``x`` in elements."""
    phase = 2.0 * np.pi * x
    ripple = [np.cos(phase), np.sin(phase), np.cos(2.0 * phase), np.sin(2.0 * phase)]
    basis = np.column_stack([*(x**power for power in range(degree + 1)), *ripple])
    return Polynomial(np.linalg.lstsq(basis, y, rcond=None)[0][: degree + 1])


def _extremum(x: Array, y: Array, degree: int) -> float | None:
    """The real extremum of the fit that lies nearest to 0."""
    roots = _fit(x, y, degree).deriv().roots()
    real = np.real(roots[np.abs(np.imag(roots)) <= 1e-12 * np.maximum(np.abs(roots), 1.0)])
    return float(real[np.argmin(np.abs(real))]) if real.size else None
