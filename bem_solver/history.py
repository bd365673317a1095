"""History of the surface: internal variables on nodes that stay where they are.

Each side of the edge keeps the variables that are smooth there: scaled Maxwell stresses inside, where ``v``
has no singularity, and scaled Voigt strains outside, which do not carry the square root that ``v`` has at
the edge. Nodes are laid where the edge goes, graded towards it, and taken out again where a straight line
through their neighbours says the same to the stated tolerance.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from bem_solver.nodal_variables import NodalVariables

Array = NDArray[np.float64]

NODES_APART = 0.05
"""How far apart nodes are, as a part of their distance from the edge, where that is several zones."""
_FARTHEST, _NEAREST_END = 200.0, 20.0
"""How far out nodes are laid, in contact radii, and how near the last may be before there are more."""


@dataclass(frozen=True)
class SurfaceHistory:
    """Scaled Maxwell stresses up to the edge, scaled Voigt strains from the edge on.

    ``direction`` is the sign of the last motion of the edge, ``farthest`` the radius it has reached in it
    (``None``: not yet any); ``turning`` the radius at which that motion began, or of a kink that it comes
    near, until the edge has left it far enough for it to be a kink.
    """

    inner: NodalVariables
    outer: NodalVariables
    direction: int = 0
    turning: float | None = None
    farthest: float | None = None

    @property
    def kinks(self) -> tuple[float, ...]:
        """Where an edge rests or has rested, on either side."""
        return tuple(sorted({*self.inner.kinks, *self.outer.kinks}))

    @property
    def past_kinks(self) -> tuple[float, ...]:
        """Where an edge has rested or turned, without the edge itself."""
        edge = self.outer.radius[:1].tolist()
        turning = () if self.turning is None else (self.turning,)
        return tuple(kink for kink in (*self.kinks, *turning) if kink not in edge)

    def rested_at(self, edge: float) -> float | None:
        """Radius from which an edge sets out if it advances now, or has set out and is still near."""
        if edge <= 0.0:
            return None
        if self.direction > 0:
            return None if self.turning is None else min(self.turning, edge)
        return edge if self.farthest is None else min(self.farthest, edge)

    @cached_property
    def radius(self) -> Array:
        """All nodes, rising, the edge once."""
        return np.concatenate((self.inner.radius[:-1], self.outer.radius))

    def outside(self, radius: Array) -> Array:
        """Strains (m, K) outside the edge: beyond the last node they fall as ``1/r``, far from any load."""
        strains = self.outer.at(radius)
        if len(self.outer.radius):
            strains *= np.minimum(self.outer.radius[-1] / radius, 1.0)[:, None]
        return strains

    @classmethod
    def blank(cls, branches: int) -> SurfaceHistory:
        """An undisturbed surface."""
        empty = NodalVariables(np.empty(0), np.empty((0, branches)))
        return cls(empty, empty)


def distinct(radius: Array, fixed: tuple[float, ...], smallest: float) -> Array:
    """Sorted radii at least ``smallest`` apart, the ``fixed`` among them.

    Slopes between closer nodes would be rounding errors, and feed back into the motion of the edge.
    """
    merged = np.unique(np.concatenate((radius, fixed)))
    stay, free = np.zeros(len(merged), bool), np.ones(len(merged), bool)
    stay[merged.searchsorted(fixed)] = True
    for value in fixed:
        low, high = merged.searchsorted((value - smallest, value + smallest))
        free[low:high] &= np.abs(merged[low:high] - value) >= smallest
    merged, stay = merged[free | stay], stay[free | stay]
    keep = np.ones(len(merged), bool)
    last = 0  # the outermost node kept so far
    # of a close pair the outer goes, unless it is fixed
    for outer in (np.flatnonzero(np.diff(merged) < smallest) + 1).tolist():
        last = outer - 1 if keep[outer - 1] else last
        if merged[outer] - merged[last] < smallest:
            keep[last if stay[outer] else outer] = False
    return merged[keep | stay]


def updated_kinks(
    before: SurfaceHistory, edge: float, new_edge: float, apart: float, rest: float
) -> tuple[tuple[float, ...], int, float | None, float]:
    """Kinks, direction, turning and farthest radius after the edge went from ``edge`` to ``new_edge``.

    Parameters
    ----------
    before : SurfaceHistory
    edge, new_edge : float
    apart : float
        Smallest distance of a kink from the edge and from newer kinks.
    rest : float
        Accuracy of the edge: so far back from its farthest radius it has not turned.

    Returns
    -------
    kinks : tuple of float
    direction : int
    turning : float or None
    farthest : float

    Notes
    -----
    An edge that turned, or started from rest, leaves a kink once it is ``apart`` from there. Kinks closer
    than that to a newer one are dropped: the nodes that stay around them carry their history. One closer to
    an edge that has not just turned takes the place of the turning until the edge has passed it, also one
    that it meets to its accuracy: left to the annuli, its inverse root would hold the edge up there.
    """
    farthest = edge if before.farthest is None else before.farthest
    direction, turning = before.direction, before.turning
    ahead = (new_edge - farthest) * direction
    if ahead > 0.0:
        farthest = new_edge
    elif direction == 0 or ahead < -rest:
        direction = int(np.sign(new_edge - farthest)) or direction
        turning, farthest = farthest, new_edge
    older = [k for k in before.kinks if k != edge and abs(k - new_edge) >= rest]
    kinks = [k for k in older if abs(k - new_edge) >= apart]
    if turning is not None and abs(new_edge - turning) >= apart:
        kinks = [k for k in kinks if abs(k - turning) >= apart] + [turning]
        turning = None
    if turning is None and len(kinks) < len(older):
        turning = min(older, key=lambda kink: abs(kink - new_edge))
    elif turning is None and any(k != edge and abs(k - new_edge) < rest for k in before.kinks):
        turning = new_edge
    return tuple(sorted(kinks)), direction, turning, farthest


def graded_nodes(annuli_radii: Array, edge: float, reach: float) -> Array:
    """Collocation radii within ``reach`` inside the edge, their mirror images outside, and the edge."""
    inside = edge * annuli_radii
    inside = inside[inside >= edge - reach]
    return np.concatenate((inside, [edge], 2.0 * edge - inside))


def nodes_beyond(edge: float, length: float, last: float = 0.0) -> Array:
    """Radii from ``length`` outside the edge to far beyond, at distances from it in equal ratios.

    In ratios of the radius the first interval would be many process zones wide where these are short, and the
    surface in it, a root of the distance near the edge, one cubic.

    Parameters
    ----------
    edge, length : float
    last : float, optional
        Outermost node so far: those beyond it, none while it is far from the edge.

    Returns
    -------
    ndarray
    """
    size = edge + length
    if last >= _NEAREST_END * size:
        return np.empty(0)
    way = _FARTHEST * size - edge
    radii = edge + np.geomspace(length, way, math.ceil(math.log(way / length) / NODES_APART) + 1)
    return radii[radii > last]


def midpoints_of_wide_intervals(radius: Array, spacing: Array) -> Array:
    """Mid-points of the intervals that are longer than ``spacing`` (n - 1,) allows."""
    wide = np.diff(radius) > spacing
    return 0.5 * (radius[1:] + radius[:-1])[wide]
