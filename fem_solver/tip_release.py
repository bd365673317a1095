"""Glassy energy release rate of the very tip, from the node in contact in part, and the heat that follows.

At a fixed instant the half-space is elastic with its glassy modulus ``G``. In the components ``v = L^-1 u``,
``y = L^T f`` of the surface (see ``surface``) component j belongs to the radii between two positions of the
edge. As these are released, one after the other, they set free ``y_j^2/(2 G)`` of the part in contact; as
they close, they take up as much of what the free part bears at once in contact. What came into contact last
is released first.
"""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from fem_solver.edge_geometry import EdgeGeometry
from fem_solver.partial_release import PartlyHeld
from fem_solver.surface import SurfaceOperator

Array = NDArray[np.float64]

LARGEST_STEP = 1.0
"""Elements that the edge passes in a step, up to which the rates at both ends tell what it sets free: steps
are a quarter of one, and where it leaves in a jump the rate rises in between."""

UNKNOWN_RELEASE = (math.nan, math.nan)
"""Of opening and of closing, where the tip is not known."""


def release_of_tip(
    partly: PartlyHeld, operator: SurfaceOperator, geometry: EdgeGeometry, modulus: float, forces: Array
) -> tuple[float, float]:
    """Energy per area that the tip sets free as it opens, and takes up as it closes.

    Parameters
    ----------
    partly : PartlyHeld
        The node in contact in part.
    operator : SurfaceOperator
        Of the glassy solid.
    geometry : EdgeGeometry
    modulus : float
        Glassy shear modulus.
    forces : ndarray, shape (n,)
        Nodal forces, compressive positive.

    Returns
    -------
    tuple of float
    """
    node, unit = partly.contact.node, operator.unit[partly.contact.node]
    mean = operator.component(forces, node)
    opening, closing = (mean + unit * stress for stress in partly.stresses_of_tip(modulus))
    area = math.pi * (geometry.effective[node] ** 2 - geometry.effective[node - 1] ** 2)
    return float(opening**2 / (2.0 * modulus * area)), float(closing**2 / (2.0 * modulus * area))


def with_sharp_tip(columns: Mapping[str, Array]) -> Array:
    """What the branches dissipate, with what a sharp tip makes them dissipate within the last element.

    Parameters
    ----------
    columns : mapping of str to ndarray (n,)
        Of the rows, with the ``volume_dissipation`` and the release rates of the tip, ``opening`` and
        ``closing``.

    Returns
    -------
    ndarray (n,)

    Notes
    -----
    The volume integral follows the mean of each node, which is let go in the time that the edge takes to pass
    it: of what relaxes closer to a sharp tip than an element it loses a share, of first order in the size of
    the element. While the edge moves, the balance with a sharp edge takes its place: ``int F dD = dU + loss -
    int K^2/(2 Einf*) dA``. While it is pinned, the volume integral lacks what relaxes between the parts of
    the node next to it: what the indenter does and the interface sets free, beyond the work of the means.
    """
    grown = np.pi * np.diff(columns["contact_radius"] ** 2)
    opening, closing = (0.5 * (columns[n][1:] + columns[n][:-1]) for n in ("opening", "closing"))
    sharp = np.diff(columns["external_work"] - columns["stored_energy"])
    sharp = sharp + np.where(grown > 0.0, closing, opening) * grown
    moves = (grown != 0.0) & (np.diff(columns["time"]) > 0.0) & np.isfinite(sharp)
    pinned = np.isfinite(sharp) & (grown == 0.0)
    volume = np.diff(columns["volume_dissipation"])
    held = np.diff(columns["dissipated_energy"] - columns["balance_residual"])
    lost = np.where(moves, sharp, np.where(pinned, held, volume))
    so_far = np.concatenate((columns["volume_dissipation"][:1], lost)).cumsum()
    return np.maximum.accumulate(so_far)  # a step may miss by the error of its work; branches gain nothing
