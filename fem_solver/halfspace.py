"""The discrete half-space: spaces, assembly, one factorisation per ratio of moduli, surface compliance.

Surface quantities point *downwards*: force positive where the indenter presses, displacement positive where
the surface sinks. Everything here is for unit shear modulus; a solid of shear modulus ``G`` and
``ratio = G/K`` displaces ``1/G`` times as much, so with a constant Poisson's ratio one factorisation serves
all times. In unit shear modulus the mixed system is

    ``[ A   -B^T ] [u]   [f]``
    ``[-B  -ratio M] [p] = [0]``

and the displacement system ``A + V/ratio``.

On the far boundary the Boussinesq displacement of the load is prescribed (see ``farfield``). A nodal force
``f_i`` enters its amplitude with the weight ``v_i = c_i/c_0``, where ``c_i`` is the displacement of node i
per unit amplitude and ``c_0`` that of the node at the axis. By Betti's theorem this is the weight with which
a ring force excites that far field; it differs from one by the order of ``(r_i/R_far)^2``, and it makes the
compliance ``C_ij = C^0_ij + c_i v_j`` symmetric.

With the surface ordered behind the body, the last diagonal block of the factors ``L D L^T`` factorises the
stiffness condensed to the surface (the Schur complement), and ``C^0 = L_ss^-T D_ss^-1 L_ss^-1``: a second
elimination takes the place of a back-substitution for every node of the surface.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np
import scipy.sparse as sparse
from numpy.typing import NDArray
from scipy.linalg.lapack import dlauum, dtrtri
from scipy.sparse.linalg import SuperLU, splu
from skfem import Basis, ElementTriP1, ElementTriP2, ElementVector, MeshTri

from fem_solver import forms
from fem_solver.farfield import boussinesq_shapes

Array = NDArray[np.float64]
_QUADRATURE_ORDER = 5
"""Polynomial order that the quadrature of the elements integrates exactly."""
_BLOCK = 256
"""Rows and columns that are symmetrised at a time; bounds the memory that takes."""
_SYMMETRIC = {"SymmetricMode": True}
"""Options of SuperLU for a symmetric matrix that needs no pivoting."""
_LEAST_RATIO = 1e-7
"""Least ``G/K`` of the factorised mixed system.

It keeps elimination without pivoting stable; smaller ratios, zero among them, are reached from there by one
step of iterative refinement, or by extrapolation from it and its double (error about its square).
"""


class HalfSpace:
    """Finite-element spaces and unit matrices on a mesh.

    Parameters
    ----------
    mesh : object
        With ``points`` (2, n), ``triangles`` (3, m) and ``boundaries`` "surface", "axis", "far" as (2, k)
        vertex pairs.
    mixed : bool
        Displacement and pressure (right for every Poisson's ratio) or displacement alone.
    far_field : bool
        Prescribe the displacement of the total force on the far boundary; otherwise zero.
    """

    def __init__(self, mesh: Any, mixed: bool = True, far_field: bool = True) -> None:
        self.mixed, self.far_field = mixed, far_field
        self.mesh = MeshTri(np.ascontiguousarray(mesh.points), np.ascontiguousarray(mesh.triangles))
        self.basis = Basis(self.mesh, ElementVector(ElementTriP2()), intorder=_QUADRATURE_ORDER)
        self.deviatoric = forms.deviatoric_stiffness.assemble(self.basis).tocsc()
        self.unknowns = self.basis.N
        if mixed:
            self.pressure_basis = Basis(self.mesh, ElementTriP1(), quadrature=self.basis.quadrature)
            self.divergence = forms.divergence.assemble(self.basis, self.pressure_basis).tocsc()
            self.mass = forms.pressure_mass.assemble(self.pressure_basis).tocsc()
            self.unknowns += self.pressure_basis.N
        else:
            self.volumetric = forms.volumetric_stiffness.assemble(self.basis).tocsc()
        facets = {name: self._facets(pairs) for name, pairs in mesh.boundaries.items()}
        self._order_surface(facets["surface"])
        self._constrain(facets["axis"], facets["far"], far_field)

    def _facets(self, pairs: NDArray[np.integer]) -> NDArray[np.integer]:
        """Facet numbers of edges given by their end vertices."""
        count = self.mesh.p.shape[1]
        known = np.sort(self.mesh.facets, axis=0)
        keys = known[0].astype(np.int64) * count + known[1]
        order = np.argsort(keys)
        wanted = np.sort(np.asarray(pairs), axis=0)
        sought = wanted[0].astype(np.int64) * count + wanted[1]
        return order[np.searchsorted(keys, sought, sorter=order)]

    def _order_surface(self, facets: NDArray[np.integer]) -> None:
        vertices = np.unique(self.mesh.facets[:, facets])
        dofs = np.concatenate([self.basis.nodal_dofs[1, vertices], self.basis.facet_dofs[1, facets]])
        radii = self.basis.doflocs[0, dofs]
        order = np.argsort(radii)
        self.surface_dofs = dofs[order]
        self.radii: Array = radii[order]

    def _constrain(self, axis: NDArray[np.integer], far: NDArray[np.integer], far_field: bool) -> None:
        on_axis = np.unique(self.mesh.facets[:, axis])
        on_far = np.unique(self.mesh.facets[:, far])
        rollers = np.concatenate([self.basis.nodal_dofs[0, on_axis], self.basis.facet_dofs[0, axis]])
        nodes = [self.basis.nodal_dofs[:, on_far], self.basis.facet_dofs[:, far]]
        radial, vertical = np.hstack(nodes)
        self.far_shapes = np.zeros((2, self.unknowns))
        if far_field:
            for row, shape in enumerate(boussinesq_shapes(self.basis.doflocs[:, radial])):
                self.far_shapes[row, radial], self.far_shapes[row, vertical] = shape
        held = np.concatenate([rollers, radial, vertical])
        self.far_shapes[:, rollers] = 0.0
        self.free = np.setdiff1d(np.arange(self.unknowns), held)

    def matrix(self, ratio: float) -> sparse.csc_matrix:
        """The whole system for unit shear modulus and ``ratio = G/K`` (zero if incompressible)."""
        if not self.mixed:
            return (self.deviatoric + self.volumetric / ratio).tocsc()
        return sparse.bmat(
            [[self.deviatoric, -self.divergence.T], [-self.divergence, -ratio * self.mass]], format="csc"
        )

    def factorise(self, ratio: float) -> Factorisation:
        """Factorise the constrained system."""
        rows = self.matrix(ratio)[self.free]
        exact = rows[:, self.free].tocsc()
        near = exact
        refined = self.mixed and ratio < 10.0 * _LEAST_RATIO
        if refined:
            near = self.matrix(ratio + _LEAST_RATIO)[self.free][:, self.free].tocsc()
        factor = splu(near, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options=_SYMMETRIC)
        lifted = np.stack([-(rows @ shape) for shape in self.far_shapes])
        return Factorisation(self, ratio, factor, exact if refined else None, lifted)


@dataclass
class Factorisation:
    """Factors of the constrained system for one ratio of moduli."""

    space: HalfSpace
    ratio: float
    factor: SuperLU
    exact: sparse.csc_matrix | None
    lifted: Array
    solves: int = field(default=0)

    @property
    def far_mix(self) -> Array:
        """Weights of the two far shapes for an elastic solid of unit shear modulus, shape (2,)."""
        return np.array([1.0, 3.0 * self.ratio / (3.0 + self.ratio)])

    def _invert(self, right: Array) -> Array:
        first = self.factor.solve(right)
        if self.exact is None:
            return first
        return first + self.factor.solve(right - self.exact @ first)

    def solve(self, load: Array, far: Array) -> Array:
        """Displacement (and pressure) for a right-hand side and far-field amplitudes.

        Parameters
        ----------
        load : ndarray, shape (unknowns,)
            Nodal forces along the coordinates, for unit shear modulus.
        far : ndarray, shape (2,)
            Amplitudes of the two far shapes.
        """
        self.solves += 1
        result = far @ self.space.far_shapes
        result[self.space.free] = self._invert(load[self.space.free] + far @ self.lifted)
        return result

    def surface_response(self, count: int) -> tuple[Array, Array]:
        """Displacements of the first ``count`` surface nodes for unit shear modulus.

        Returns
        -------
        clamped : ndarray, shape (count, count)
            Per nodal force, with the far boundary held.
        far : ndarray, shape (count,)
            Per amplitude of the Boussinesq field of an elastic solid.
        """
        rows = self._rows(count)
        if self.exact is None:
            clamped = self._condensed(self.ratio, rows)
        else:
            clamped = self._condensed(self.ratio + _LEAST_RATIO, rows)
            clamped *= 2.0
            clamped -= self._condensed(self.ratio + 2.0 * _LEAST_RATIO, rows)
        return clamped, self._far_response(rows)

    def far_weights(self, count: int) -> Array:
        """Weights of the nodal forces in the far amplitude with which the compliance is symmetric.

        Parameters
        ----------
        count : int
            Number of surface nodes, from the axis.

        Returns
        -------
        ndarray, shape (count,)
        """
        return self._weights_of(self._far_response(self._rows(count)))

    def _weights_of(self, far: Array) -> Array:
        return far / far[0] if self.space.far_field else np.zeros(len(far))

    def _far_response(self, rows: NDArray[np.integer]) -> Array:
        """Displacement of unknowns per amplitude of the Boussinesq field of an elastic solid."""
        self.solves += 1
        return -self._invert(self.far_mix @ self.lifted)[rows]

    def _rows(self, count: int) -> NDArray[np.integer]:
        """Free unknowns that are displacements of the first surface nodes."""
        space = self.space
        position = np.full(space.unknowns, -1)
        position[space.free] = np.arange(space.free.size)
        return position[space.surface_dofs[:count]]

    def _condensed(self, ratio: float, rows: NDArray[np.integer]) -> Array:
        """Displacements of the given unknowns per force on them, at a ratio of moduli; in Fortran's order."""
        free = self.space.free
        place = self.factor.perm_c.astype(np.int64)
        place[rows] = free.size + np.arange(rows.size)
        order = np.argsort(place)
        matrix = self.space.matrix(ratio)[free[order]][:, free[order]].tocsc()
        factor = splu(matrix, permc_spec="NATURAL", diag_pivot_thresh=0.0, options=_SYMMETRIC)
        last = factor.perm_c[free.size - rows.size :]
        lower = np.asfortranarray(factor.L[last][:, last].toarray())
        pivots = factor.U.diagonal()[last]
        del factor, matrix
        inverse = dtrtri(lower, lower=1, unitdiag=1, overwrite_c=1)[0]
        inverse /= np.sqrt(pivots)[:, None]
        whole = dlauum(inverse, lower=1, overwrite_c=1)[0]
        for begin in range(0, rows.size, _BLOCK):
            part = slice(begin, begin + _BLOCK)
            whole[part, part] += np.tril(whole[part, part], -1).T
            whole[:begin, part] = whole[part, :begin].T
        return whole

    def compliance(self, count: int, weights: Array | None = None) -> tuple[Array, Array]:
        """Surface compliance with the far field of the load, and the weights of that far field.

        Parameters
        ----------
        count : int
            Number of surface nodes, from the axis.
        weights : ndarray, shape (count,), optional
            Weights ``v`` of the nodal forces in the far amplitude; default those that make it symmetric.

        Returns
        -------
        compliance : ndarray, shape (count, count)
        weights : ndarray, shape (count,)
        """
        whole, far = self.surface_response(count)
        if weights is None:
            weights = self._weights_of(far)
        for begin in range(0, count, _BLOCK):
            part = slice(begin, begin + _BLOCK)
            whole[:, part] += 0.5 * (np.outer(far, weights[part]) + np.outer(weights, far[part]))
        return whole, weights
