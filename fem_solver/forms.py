"""Axisymmetric strain and weak forms in scikit-fem, displacement and mixed.

Coordinates ``(r, z)``, the body in ``z <= 0``; displacement ``(u_r, u_z)``, no twist. Strains in the order
``(rr, zz, tt, rz)`` with the tensor shear strain ``e_rz = (u_r,z + u_z,r)/2`` and the hoop strain
``e_tt = u_r/r``. All integrals carry ``2 pi r``: forces and energies are those of the whole body.

Isotropic elasticity with shear modulus ``G`` and bulk modulus ``K`` is split into deviator and volume,

    ``a(u, v) = 2 G int dev e(u) : e(v) + K int div u div v``          (displacement form)

The second term locks as ``K/G -> inf``: quadratic triangles cannot make ``div u`` vanish pointwise and still
bend. The mixed form takes the pressure as an unknown of its own, ``p = -K div u``, tested weakly:

    ``2 G int dev e(u) : e(v) - int p div v = l(v)``,
    ``-int q div u - (1/K) int p q = 0``                               (mixed form)

and holds for ``1/K = 0``. Quadratic ``u`` with linear continuous ``p`` (Taylor-Hood) is inf-sup stable.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import scipy.sparse as sparse
from numpy.typing import NDArray
from skfem import BilinearForm

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


def _contract(first: Array, second: Array) -> Array:
    return np.einsum("i,i...,i...->...", CONTRACTION, first, second)


@BilinearForm
def deviatoric_stiffness(u: Any, v: Any, w: Any) -> Array:
    """``2 int dev e(u) : e(v)``, the stiffness of unit shear modulus."""
    r = w.x[0]
    return 4.0 * np.pi * r * _contract(deviator(strain(u, r)), strain(v, r))


@BilinearForm
def volumetric_stiffness(u: Any, v: Any, w: Any) -> Array:
    """``int div u div v``, the stiffness of unit bulk modulus."""
    r = w.x[0]
    return 2.0 * np.pi * r * dilatation(u, r) * dilatation(v, r)


@BilinearForm
def divergence(u: Any, q: Any, w: Any) -> Array:
    """``int q div u``."""
    r = w.x[0]
    return 2.0 * np.pi * r * q * dilatation(u, r)


@BilinearForm
def pressure_mass(p: Any, q: Any, w: Any) -> Array:
    """``int p q``."""
    return 2.0 * np.pi * w.x[0] * p * q
