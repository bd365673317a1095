"""The discrete half-space: spaces, assembly, one factorisation per ratio of moduli, surface compliance.

Surface quantities point *downwards*: force positive where the indenter presses, displacement positive where
the surface sinks. Everything here is for unit shear modulus; a solid of shear modulus ``G`` and
``ratio = G/K`` displaces ``1/G`` times as much, so with a constant Poisson's ratio one factorisation serves
all times. In unit shear modulus the system of displacement and pressure is

    ``[ A   -B^T ] [u]   [f]``
    ``[-B  -ratio M] [p] = [0]``

On the far boundary the Boussinesq displacement of the load is prescribed (below). A nodal force
``f_i`` enters its amplitude with the weight ``v_i = c_i/c_0``, where ``c_i`` is the displacement of node i
per unit amplitude and ``c_0`` that of the node at the axis. By Betti's theorem this is the weight with which
a ring force excites that far field; it differs from one by the order of ``(r_i/R_far)^2``, and it makes the
compliance ``C_ij = C^0_ij + c_i v_j`` symmetric.

With the surface ordered behind the body, the last diagonal block of the factors ``L D L^T`` factorises the
stiffness condensed to the surface (the Schur complement), and ``C^0 = L_ss^-T D_ss^-1 L_ss^-1``: no
back-substitution is needed for any node of the surface.

Elimination needs no pivoting, not even for ``ratio = 0``, where pressures have no diagonal of their own: each
is eliminated behind the displacements around it, which then give it one. Nodes further out on the surface
than those condensed to are among the body. Were all of them held until the last, the volume could not leave
it, and one pressure would find none.

**The far boundary.** A half-space loaded by a normal pressure of total force ``F`` within a radius ``a``
displaces a point at distance ``rho`` like the point force ``F`` up to terms of relative size ``(a/rho)^2``:
for an axisymmetric load the dipole vanishes. Prescribing that displacement leaves an error of the field near
the contact of the order ``(a/rho)^3`` where clamping the boundary leaves ``a/rho``.

With depth ``s = -z``, ``rho^2 = r^2 + s^2`` and a force ``F`` pressing downwards (Johnson, Contact
Mechanics, Eq. 3.18, with ``z`` turned upwards),

    ``u_r = F/(4 pi G) [ r s/rho^3 - (1 - 2 nu) r/(rho (rho + s)) ]``
    ``u_z = -F/(4 pi G) [ s^2/rho^3 + 1/rho + (1 - 2 nu)/rho ]``

and ``(1 - 2 nu)/G = 3/(3 K + G)``: the field is ``F/G`` times a shape independent of the material, plus
``3 F/(3 K + G)`` times another. So, by the correspondence principle, it holds for every isotropic linear
viscoelastic solid, whether or not its Poisson's ratio is constant: only two scalars of time are needed,
``e_1`` with ``G * e_1 = F`` and ``e_2`` with ``(3 K + G) * e_2 = 3 F`` (hereditary integrals).
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
import scipy.sparse as sparse
from numpy.typing import NDArray
from scipy.linalg.blas import dsyr2
from scipy.linalg.lapack import dlauum, dtrtri
from scipy.sparse.linalg import SuperLU, spilu, splu
from skfem import Basis, ElementTriP1, ElementTriP2, ElementVector, MeshTri

from fem_solver import forms

Array = NDArray[np.float64]


def boussinesq_shapes(points: Array) -> tuple[Array, Array]:
    """The two shapes of the field, to be scaled by ``F/G`` and ``3 F/(3 K + G)``."""
    r, depth = points[0], -points[1]
    rho = np.hypot(r, depth)
    shear = np.stack([r * depth / rho**3, -(depth**2 / rho**3 + 1.0 / rho)])
    volume = np.stack([-r / (rho * (rho + depth)), -1.0 / rho])
    return shear / (4.0 * np.pi), volume / (4.0 * np.pi)


_QUADRATURE_ORDER = 5
"""Polynomial order that the quadrature of the elements integrates exactly."""
_UNPIVOTED = {"diag_pivot_thresh": 0.0, "options": {"SymmetricMode": True}}
"""Options of SuperLU for a symmetric matrix that needs no pivoting."""
SYMMETRIC = {"permc_spec": "MMD_AT_PLUS_A"} | _UNPIVOTED
"""The same, by minimum degree."""


class HalfSpace:
    """Finite-element spaces and unit matrices on a mesh.

    It has ``points`` (2, n), ``triangles`` (3, m) and ``boundaries`` "surface", "axis", "far" as (2, k)
    vertex pairs. ``far_field`` prescribes the displacement of the total force on the far boundary, otherwise
    zero; ``sliding`` holds the lowest nodes of the far boundary, those of a base, vertically alone.
    """

    def __init__(self, mesh: Any, far_field: bool = True, sliding: bool = False) -> None:
        self.far_field = far_field
        self.mesh = MeshTri(np.ascontiguousarray(mesh.points), np.ascontiguousarray(mesh.triangles))
        self.basis = Basis(self.mesh, ElementVector(ElementTriP2()), intorder=_QUADRATURE_ORDER)
        self.deviatoric = forms.deviatoric_stiffness(self.basis)
        self.pressure_basis = Basis(self.mesh, ElementTriP1(), quadrature=self.basis.quadrature)
        self.divergence = forms.divergence(self.basis, self.pressure_basis)
        self.mass = forms.pressure_mass(self.pressure_basis)
        self.unknowns = self.basis.N + self.pressure_basis.N
        facets = {name: self._facets(pairs) for name, pairs in mesh.boundaries.items()}
        self._order_surface(facets["surface"])
        self._constrain(facets["axis"], facets["far"], far_field, sliding)

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

    def _constrain(
        self, axis: NDArray[np.integer], far: NDArray[np.integer], far_field: bool, sliding: bool
    ) -> None:
        on_axis = np.unique(self.mesh.facets[:, axis])
        on_far = np.unique(self.mesh.facets[:, far])
        rollers = np.concatenate([self.basis.nodal_dofs[0, on_axis], self.basis.facet_dofs[0, axis]])
        nodes = [self.basis.nodal_dofs[:, on_far], self.basis.facet_dofs[:, far]]
        radial, vertical = np.hstack(nodes)
        self.far_shapes = np.zeros((2, self.unknowns))
        if far_field:
            for row, shape in enumerate(boussinesq_shapes(self.basis.doflocs[:, radial])):
                self.far_shapes[row, radial], self.far_shapes[row, vertical] = shape
        if sliding:
            depth = -self.basis.doflocs[1, radial]
            radial = radial[~np.isclose(depth, depth.max())]
        held = np.concatenate([rollers, radial, vertical])
        self.far_shapes[:, rollers] = 0.0
        self.free = np.setdiff1d(np.arange(self.unknowns), held)

    def matrix(self, ratio: float) -> sparse.csc_matrix:
        """The whole system for unit shear modulus and ``ratio = G/K`` (zero if incompressible)."""
        return sparse.bmat(
            [[self.deviatoric, -self.divergence.T], [-self.divergence, -ratio * self.mass]], format="csc"
        )

    def factorise(self, ratio: float, count: int) -> Factorisation:
        """Factorise the constrained system, the first ``count`` nodes of the surface behind the body."""
        ranks = self._ranks.copy()
        ranks[self.surface_dofs[:count]] = self.unknowns + np.arange(count)
        order = self.free[np.argsort(ranks[self.free], kind="stable")]
        rows = self.matrix(ratio)[order]
        factor = splu(rows[:, order].tocsc(), permc_spec="NATURAL", **_UNPIVOTED)
        lifted = np.stack([-(rows @ shape) for shape in self.far_shapes])
        return Factorisation(self, ratio, count, order, factor, lifted)

    @cached_property
    def _ranks(self) -> NDArray[np.int64]:
        """Place of every unknown in the elimination, by minimum degree: nodes, each pressure behind those of
        the edges that meet in its vertex; shape (unknowns,).
        """
        vertical = np.concatenate([self.basis.nodal_dofs[1], self.basis.facet_dofs[1]])
        nodes, vertices = np.isin(vertical, self.free), self.mesh.p.shape[1]
        graph = self.deviatoric[vertical[nodes]][:, vertical[nodes]]  # one unknown a node
        rank = np.zeros(len(vertical), dtype=np.int64)
        rank[nodes] = spilu(graph, drop_tol=1.0, fill_factor=1.0, **SYMMETRIC).perm_c
        ranks = np.zeros(self.unknowns, dtype=np.int64)
        ranks[self.basis.nodal_dofs], ranks[self.basis.facet_dofs] = rank[:vertices], rank[vertices:]
        latest = rank[:vertices].copy()
        for ends in self.mesh.facets:
            np.maximum.at(latest, ends, rank[vertices:])
        ranks[self.basis.N + self.pressure_basis.nodal_dofs[0]] = latest
        return ranks


@dataclass
class Factorisation:
    """Factors of the constrained system for one ratio ``G/K``; ``count`` surface nodes are eliminated last.

    ``order`` are the unknowns in the order of their elimination, ``lifted`` the forces on them per amplitude
    of each far shape.
    """

    space: HalfSpace
    ratio: float
    count: int
    order: NDArray[np.int64]
    factor: SuperLU
    lifted: Array
    solves: int = 0

    @property
    def far_mix(self) -> Array:
        """Weights of the two far shapes for an elastic solid of unit shear modulus, shape (2,)."""
        return np.array([1.0, 3.0 * self.ratio / (3.0 + self.ratio)])

    def solve(self, load: Array, far: Array) -> Array:
        """Displacement (and pressure) for a right-hand side and far-field amplitudes."""
        self.solves += 1
        result = far @ self.space.far_shapes
        result[self.order] = self.factor.solve(load[self.order] + far @ self.lifted)
        return result

    def far_weights(self, count: int) -> Array:
        """Weights of nodal forces in the far amplitude with which the compliance is symmetric."""
        far = self.solve(np.zeros(self.space.unknowns), self.far_mix)
        return self._weights_of(far[self.space.surface_dofs[:count]])

    def _weights_of(self, far: Array) -> Array:
        return far / far[0] if self.space.far_field else np.zeros(len(far))

    def condensed(self) -> Array:
        """Lower triangle of the displacements of surface nodes per force on them, the far boundary held."""
        last = self.factor.perm_c[-self.count :]
        lower = np.asfortranarray(self.factor.L[:, last][last].toarray())
        inverse = dtrtri(lower, lower=1, unitdiag=1, overwrite_c=1)[0]
        inverse /= np.sqrt(self.factor.U.diagonal()[last])[:, None]
        return dlauum(inverse, lower=1, overwrite_c=1)[0]

    def compliance(self) -> tuple[Array, Array]:
        """Surface compliance with the far field of the load, its lower triangle, and the weights of that."""
        held, self.solves = self.condensed(), self.solves + 1
        # displacement of the surface per amplitude of the Boussinesq field of an elastic solid
        far = -self.factor.solve(self.far_mix @ self.lifted)[-self.count :]
        weights = self._weights_of(far)
        return dsyr2(0.5, far, weights, a=held, lower=1, overwrite_a=1), weights
