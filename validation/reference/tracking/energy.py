"""Energies of the surface: sums over ``x``, both sides of the edge counted (``power = 2 int q w_t dx``)."""

from __future__ import annotations

from validation.reference.tracking import hermite
from validation.reference.tracking.surface import Body, Surface


def stored_energy(surface: Surface, body: Body) -> float:
    """``U = 2 int (E0* w^2/2 + sum_k b_k^2/(2 E_k)) dx``, outside in its creep form."""
    rheology = body.rheology
    strain = surface.penetration - body.transform(surface.inside)
    contact = hermite.integral(surface.inside, rheology.stored_in_contact(surface.branches, strain))
    free = hermite.integral(surface.outside, rheology.stored_outside(surface.units))
    return 2.0 * float(contact + free)


def branch_power(surface: Surface, body: Body) -> float:
    """Rate of dissipation in all branches, ``2 int sum_k b_k^2/(E_k tau_k) dx``, both sides of the edge."""
    rheology = body.rheology
    viscosity = rheology.moduli * rheology.times
    free = surface.units @ rheology.branches_of_units
    inner = hermite.integral(surface.inside, (surface.branches**2 / viscosity).sum(axis=1))
    outer = hermite.integral(surface.outside, (free**2 / viscosity).sum(axis=1))
    return 2.0 * float(inner + outer)
