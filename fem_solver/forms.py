"""Axisymmetric strain and the matrices of the weak form in displacement and pressure.

Coordinates ``(r, z)``, the body in ``z <= 0``; displacement ``(u_r, u_z)``, no twist. Strains in the order
``(rr, zz, tt, rz)`` with the tensor shear strain ``e_rz = (u_r,z + u_z,r)/2`` and the hoop strain
``e_tt = u_r/r``. All integrals carry ``2 pi r``: forces and energies are those of the whole body.

Isotropic elasticity with shear modulus ``G`` and bulk modulus ``K``, split into deviator and volume, with the
pressure ``p = -K div u`` as an unknown of its own, tested weakly:

    ``2 G int dev e(u) : e(v) - int p div v = l(v)``,
    ``-int q div u - (1/K) int p q = 0``

holds for ``1/K = 0``. Quadratic ``u`` with linear continuous ``p`` (Taylor-Hood) is inf-sup stable; quadratic
``u`` alone cannot make ``div u`` vanish pointwise and still bend, and locks as ``K/G -> inf``.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import scipy.sparse as sparse
from numpy.typing import NDArray

Array = NDArray[np.float64]

CONTRACTION = np.array([1.0, 1.0, 1.0, 2.0])
"""Weights of the components (rr, zz, tt, rz) in a double contraction ``a : b``."""


def strain(u: Any, radius: Array) -> Array:
    """Strain components ``(rr, zz, tt, rz)`` of a scikit-fem vector field; shape (4, elements, points)."""
    gradient = u.grad
    return np.stack(
        [
            gradient[0, 0],
            gradient[1, 1],
            np.asarray(u)[0] / radius,
            0.5 * (gradient[0, 1] + gradient[1, 0]),
        ]
    )


def dilatation(u: Any, radius: Array) -> Array:
    """``div u = u_r,r + u_r/r + u_z,z``; shape (elements, points)."""
    return u.grad[0, 0] + u.grad[1, 1] + np.asarray(u)[0] / radius


def deviator(components: Array) -> Array:
    """Deviatoric part of a tensor given by its components ``(rr, zz, tt, rz)``; same shape."""
    result = components.copy()
    result[:3] -= components[:3].sum(axis=0) / 3.0
    return result


def strain_operator(basis: Any) -> sparse.csr_matrix:
    """Matrix from nodal displacements to strains ``(rr, zz, tt, rz)`` at the quadrature points.

    Its rows run over component, element and point; times the volume weights and transposed it gives nodal
    forces.
    """
    radius = basis.global_coordinates()[0]
    cells, points = radius.shape
    rows = np.arange(4 * cells * points).reshape(4, cells, points)
    entries = []
    for local, fields in enumerate(basis.basis):
        columns = np.broadcast_to(basis.element_dofs[local][None, :, None], rows.shape)
        values = strain(fields[0], radius)
        entries.append((values.ravel(), rows.ravel(), columns.ravel()))
    data, i, j = (np.concatenate(parts) for parts in zip(*entries, strict=True))
    operator = sparse.coo_matrix((data, (i, j)), shape=(rows.size, basis.N)).tocsr()
    operator.eliminate_zeros()
    return operator


def volume_weights(basis: Any) -> Array:
    """``2 pi r`` times the quadrature weights; shape (elements, points)."""
    return 2.0 * np.pi * basis.global_coordinates()[0] * basis.dx


def deviatoric_stiffness(basis: Any) -> sparse.csc_matrix:
    """``2 int dev e(u) : e(v)``, the stiffness of unit shear modulus."""
    deviators = deviator(_of_shapes(basis, strain).swapaxes(0, 1)).swapaxes(0, 1)
    roots = np.sqrt(2.0 * CONTRACTION[:, None, None] * volume_weights(basis)) * deviators
    return _assembled(basis, roots, basis, roots)


def divergence(basis: Any, pressure_basis: Any) -> sparse.csc_matrix:
    """``int q div u``, a row per pressure."""
    dilatations = volume_weights(basis) * _of_shapes(basis, dilatation)
    return _assembled(pressure_basis, _of_shapes(pressure_basis, _value), basis, dilatations)


def pressure_mass(pressure_basis: Any) -> sparse.csc_matrix:
    """``int p q``."""
    values = _of_shapes(pressure_basis, _value)
    return _assembled(pressure_basis, volume_weights(pressure_basis) * values, pressure_basis, values)


def _value(field: Any, radius: Array) -> Array:
    return np.broadcast_to(np.asarray(field), radius.shape)


def _of_shapes(basis: Any, quantity: Callable[[Any, Array], Array]) -> Array:
    """A quantity of every local shape function; shape (shapes, ..., elements, points)."""
    radius = basis.global_coordinates()[0]
    return np.stack([quantity(fields[0], radius) for fields in basis.basis])


def _by_element(values: Array) -> Array:
    """The same with shape (elements, shapes, components and points)."""
    return np.moveaxis(values, -2, 0).reshape(values.shape[-2], len(values), -1)


def _assembled(rows: Any, first: Array, columns: Any, second: Array) -> sparse.csc_matrix:
    """Matrix of the products of two quantities of shape functions, summed over components and points."""
    one = _by_element(first)
    other = one if second is first else _by_element(second)
    entries = one @ other.swapaxes(1, 2)
    i = np.broadcast_to(rows.element_dofs.T[:, :, None], entries.shape)
    j = np.broadcast_to(columns.element_dofs.T[:, None, :], entries.shape)
    triplets = entries.ravel(), (i.ravel(), j.ravel())
    return sparse.coo_matrix(triplets, shape=(rows.N, columns.N)).tocsc()
