"""Energy of the surface: a sum over ``x``, both sides of the edge counted (``power = 2 int q w_t dx``).

The density is integrated along the interpolated fields. It varies faster than they do, and nodes that are
enough for them are too few to interpolate their squares.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from validation.reference.path.rheology import Body
from validation.reference.tracking import hermite
from validation.reference.tracking.surface import Surface

Array = NDArray[np.float64]
Density = Callable[[Array, Array], Array]


def stored_energy(surface: Surface, body: Body) -> float:
    """``U = 2 int (E0* w^2/2 + sum_k b_k^2/(2 E_k)) dx``, outside in its creep form."""
    rheology = body.rheology

    def in_contact(branches: Array, x: Array) -> Array:
        return rheology.stored_in_contact(branches, surface.penetration - body.transform(x))

    def outside(units: Array, _: Array) -> Array:
        return rheology.stored_outside(units)

    return _over_both_sides(surface, in_contact, outside)


def branch_power(surface: Surface, body: Body) -> float:
    """Rate of dissipation in all branches, ``2 int sum_k b_k^2/(E_k tau_k) dx``, both sides of the edge."""
    rheology = body.rheology
    viscosity = rheology.moduli * rheology.times

    def in_contact(branches: Array, _: Array) -> Array:
        return branches**2 @ (1.0 / viscosity)

    def outside(units: Array, x: Array) -> Array:
        return in_contact(units @ rheology.branches_of_units, x)

    return _over_both_sides(surface, in_contact, outside)


def _over_both_sides(surface: Surface, in_contact: Density, outside: Density) -> float:
    """Twice the integral of a density over the contact, of branch forces, and over the rest, of strains."""
    contact = hermite.integral_of(surface.inside, surface.branches, in_contact, surface.branch_slopes)
    return 2.0 * (contact + hermite.integral_of(surface.outside, surface.units, outside, surface.unit_slopes))
