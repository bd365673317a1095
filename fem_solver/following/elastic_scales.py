"""What elastic contact on a mesh lacks of three closed forms, in whose scales a following mesh is read.

Elements are wide away from the strip. A strip of 1e-4 of the contact radius does not change that: contact is
some 5e-5 stiffer than that of the nodes' radius, as if every radius were so much larger. Contact radii are
those of the flat punch as stiff (see ``surface``); here heights and the closure integral follow them.

- Heights are taken at radii at which a paraboloid's contact has Hertz's force.
- The closure integral of a flat punch is ``E* D^2/(2 pi a)`` where its zone is short. On the mesh it depends
  on the place of the edge within the strip, by 2e-6 per zone: where the mesh moves on by some zones, what
  drives the edge would jump, always the same way, and an edge that is about to run away would leap.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from fem_solver.process_zone import ZoneShift
from fem_solver.surface import SurfaceOperator

Array = NDArray[np.float64]

_ZONE = 1.5
"""Length of the zone for which the closure is told, in units of the mesh: between the one for which the mesh
is made and twice that, of a mesh scaled down to half. The scale differs by some 1e-6 between the two."""
_LEAST_RADIUS = 2.0
"""Least contact radius over the zone at which the closure is told."""
_ANGLES, _WEIGHTS = np.polynomial.legendre.leggauss(12)


def punch_closure(radius: float, zone: float) -> float:
    """Closure integral at the edge of a flat punch, for unit plane modulus and unit penetration.

    ``int p(x) u(x + zone) dx / (2 zone)`` over the zone, with the pressure ``1/(pi sqrt(a^2 - x^2))`` and the
    gap ``(2/pi) acos(a/x)``; ``1/(2 pi a)`` for a short zone.

    Parameters
    ----------
    radius : float
        ``a``.
    zone : float
        Less than ``a``.

    Returns
    -------
    float
        An inverse length.
    """
    angles, weights = 0.25 * np.pi * (_ANGLES + 1.0), 0.25 * np.pi * _WEIGHTS
    outside = zone * np.sin(angles) ** 2  # takes both roots at the ends
    gap = 2.0 * np.arcsin(np.sqrt(0.5 * outside / (radius + outside)))  # acos(a/x) without a difference
    integrand = gap * np.sqrt(outside) / np.sqrt(2.0 * radius - zone + outside)
    return float(2.0 * (weights @ integrand) / (np.pi**2 * zone))


def closure_scales(
    operator: SurfaceOperator, radii: Array, effective: Array, strip: tuple[float, float], modulus: float
) -> Array:
    """Closure integral of a flat punch on the mesh over that of the punch as stiff, by its last node.

    Parameters
    ----------
    operator : SurfaceOperator
    radii, effective : ndarray, shape (n,)
        Of the nodes, and of the contact that ends with each.
    strip : tuple of float
        Radii between which the surface is fine.
    modulus : float
        ``E*`` at unit shear modulus.

    Returns
    -------
    ndarray, shape (n,)
        Beyond the strip that of its end.
    """
    shift = ZoneShift(radii, _ZONE)
    first = max(strip[0], _LEAST_RADIUS * _ZONE) + _ZONE
    nodes = np.flatnonzero((radii >= first) & (radii <= strip[1] - _ZONE))
    found = [_closure(operator, shift, int(m)) / punch_closure(effective[m], _ZONE) for m in nodes]
    return np.asarray(np.interp(np.arange(len(radii)), nodes, np.array(found) / modulus))


def _closure(operator: SurfaceOperator, shift: ZoneShift, last: int) -> float:
    """Closure integral at unit shear modulus and unit penetration, pulled, of contact up to a node."""
    first, end = shift.nodes(last, last)
    y = operator.unit[: last + 1]
    gap = 1.0 - operator.displacement_beyond(y, end)
    return float(shift.closure(first, -operator.last_forces(y, first), gap))


def height_stretch(radii: Array, effective: Array, positions: Array, strip: tuple[float, float]) -> float:
    """Radius at which heights are taken over that of the node.

    A paraboloid bears ``2 E* sum_i (A_i - A_(i-1)) (D - x_i^2/R)``, with the effective radii ``A`` and the
    position ``x`` of each component, and ``2 E* int (D - x^2/R) dx`` by Hertz. Both are made equal over the
    strip. Vertices and mid-side nodes bear differently: a mean of the components that does not weight them
    is off by a hundredth of an element.

    Parameters
    ----------
    radii, effective, positions : ndarray, shape (n,)
        Of the nodes, of contact of the nodes ``0..m``, and at which a paraboloid has its component ``m``,
        which lies between two of the second.
    strip : tuple of float
        Radii between which the surface is fine; from the axis on nothing is wide inside it.

    Returns
    -------
    float
    """
    if strip[0] <= 0.0:
        return 1.0
    first, last = np.searchsorted(radii, strip)
    inner, outer = effective[first - 1 : last - 1], effective[first:last]
    borne, by_hertz = positions[first:last] ** 2, (outer**2 + outer * inner + inner**2) / 3.0
    return float(np.sqrt(((outer - inner) @ by_hertz) / ((outer - inner) @ borne)))
