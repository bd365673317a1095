"""Energy of the surface: a sum over ``x``, both sides of the edge counted (``power = 2 int q w_t dx``).

The density is integrated along the interpolated fields. It varies faster than they do, and nodes that are
enough for them are too few to interpolate their squares.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from validation.reference.tracking import hermite
from validation.reference.tracking.surface import Body, Surface

Array = NDArray[np.float64]


def stored_energy(surface: Surface, body: Body) -> float:
    """``U = 2 int (E0* w^2/2 + sum_k b_k^2/(2 E_k)) dx``, outside in its creep form."""
    rheology = body.rheology

    def in_contact(branches: Array, x: Array) -> Array:
        return rheology.stored_in_contact(branches, surface.penetration - body.transform(x))

    contact = hermite.integral_of(surface.inside, surface.branches, in_contact)
    free = hermite.integral_of(
        surface.outside, surface.units, lambda units, _: rheology.stored_outside(units)
    )
    return 2.0 * (contact + free)


def branch_power(surface: Surface, body: Body) -> float:
    """Rate of dissipation in all branches, ``2 int sum_k b_k^2/(E_k tau_k) dx``, both sides of the edge."""
    rheology = body.rheology
    viscosity = rheology.moduli * rheology.times

    def in_contact(branches: Array, _: Array) -> Array:
        return np.asarray((branches**2 / viscosity).sum(axis=1))

    def outside(units: Array, x: Array) -> Array:
        return in_contact(units @ rheology.branches_of_units, x)

    contact = hermite.integral_of(surface.inside, surface.branches, in_contact)
    free = hermite.integral_of(surface.outside, surface.units, outside)
    return 2.0 * (contact + free)
