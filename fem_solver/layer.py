"""A layer on a rigid base: the surface compliance of the half-space, and a smooth difference.

A ring of pressure on the surface of the layer displaces it by ``u + c``: ``u`` is the field in the half-space
(Boussinesq's, averaged over the ring), and ``c`` bears no load on the surface and makes good what ``u`` does
at the base. That is smooth on the scale of the thickness, whatever happens at the contact edge, so ``c`` is
found by finite elements as coarse as that, once for rings at all radii. At the base and the rim it has,
component by component,

- where displacements are held, ``c = -u``: all of them if bonded, the normal one if frictionless;
- elsewhere the traction ``t(c) + k c = -(t(u) + k u)`` without friction, with springs ``k`` on the rim:
  beyond it a layer that may slide is a membrane with ``u_r ~ 1/r``, so ``sigma_rr = -2 G u_r/r``.

The difference is read as an energy, whose error is the square of that of the field: by Betti's theorem
between ``c`` of one ring and ``u`` of another,

    ``D_ij = -a(c_i, c_j) + l_i(c_j) + l_j(c_i) + int t(u_i).u_j (held) - int (t(u_i) + k u_i).u_j (free)``

with the energy ``a`` of layer and springs and the work ``l_i(c) = -int (t(u_i) + k u_i).c`` where it is
free.
Everything is for unit shear modulus and unit thickness; as of the half-space, one Poisson's ratio serves all
times.
"""

from __future__ import annotations

from typing import Any, Literal

import numpy as np
import scipy.sparse as sparse
from numpy.typing import NDArray
from scipy.interpolate import make_interp_spline
from scipy.sparse.linalg import splu
from skfem import (
    Basis,
    BilinearForm,
    ElementTriP2,
    ElementTriP3,
    ElementVector,
    FacetBasis,
    LinearForm,
    MeshTri,
)

from fem_solver import forms

Array = NDArray[np.float64]

_ORDER = 6
"""Degree of the polynomials that quadrature integrates exactly; twice that on sides."""
_DEGREE = 5
"""Degree of the splines between rings."""


def ring_fields(points: Array, radius: float, ratio: float) -> tuple[Array, Array]:
    """Displacement ``(r, z)`` and stress ``(rr, rz, zz)`` of a unit force on a ring of the half-space.

    ``points`` (2, k) are off the ring; shapes (2, k) and (3, k). Johnson, Contact Mechanics, Eqs. 3.18-19.
    """
    r, depth = points[0][:, None], -points[1][:, None]
    count = 24 + int(8.0 * radius)  # the mean over the angle converges exponentially
    angle = np.pi * (np.arange(count) + 0.5) / count
    along = r - radius * np.cos(angle)
    square = along**2 + (radius * np.sin(angle)) ** 2
    rho = np.sqrt(square + depth**2)
    volume = 3.0 * ratio / (3.0 + ratio)  # 1 - 2 nu
    near = volume / (rho * (rho + depth))
    hoop = volume * depth / rho**3 - near
    radial = near - 3.0 * depth * square / rho**5
    cosine = np.divide(along**2, square, out=np.zeros_like(rho), where=square > 0.0)
    displacement = along * (depth / rho**3 - near), -((depth**2 / rho**2 + 1.0 + volume) / rho)
    stress = hoop + (radial - hoop) * cosine, 3.0 * along * depth**2 / rho**5, -3.0 * depth**3 / rho**5
    return (
        np.stack(displacement).mean(axis=-1) / (4.0 * np.pi),
        np.stack(stress).mean(axis=-1) / (2.0 * np.pi),
    )


class LayerDifference:
    """Surface compliance of a layer of unit thickness and unit shear modulus, minus that of the half-space.

    The mesh is a rectangle of unit depth; ``matrix`` holds the displacement at one of the ``rings`` per unit
    force on another; ``ratio`` is ``G/K``.
    """

    def __init__(self, mesh: Any, base: Literal["bonded", "frictionless"], ratio: float) -> None:
        self.rings: Array = mesh.uniform
        self._mesh = MeshTri(np.ascontiguousarray(mesh.points), np.ascontiguousarray(mesh.triangles))
        self._basis = Basis(self._mesh, ElementVector(ElementTriP3()), intorder=_ORDER)
        self.matrix = self._solved(base, ratio)

    @property
    def reach(self) -> float:
        """Largest radius at which the surface is known."""
        return float(self.rings[-1])

    def compliance(self, radii: Array) -> Array:
        """The difference at any radii up to ``reach``; shape (n, n)."""
        mirrored = np.append(-self.rings[:0:-1], self.rings)
        shapes = make_interp_spline(mirrored, np.eye(len(mirrored)), k=_DEGREE)(radii)
        middle = len(self.rings) - 1
        even = shapes[:, middle:]
        even[:, 1:] += shapes[:, middle - 1 :: -1]
        return np.asarray(even @ self.matrix @ even.T)

    def _solved(self, base: str, ratio: float) -> Array:
        mesh, basis = self._mesh, self._basis
        pressures = Basis(mesh, ElementTriP2(), quadrature=basis.quadrature)
        stiffness, divergence = forms.deviatoric_stiffness(basis), forms.divergence(basis, pressures)
        unknowns, rim = basis.N + pressures.N, float(mesh.p[0].max())
        loads, fields = np.zeros((2, len(self.rings), unknowns))
        difference = np.zeros((len(self.rings), len(self.rings)))
        fixed = [basis.get_dofs(lambda x: x[0] == 0.0).all("u^1")]
        bottom = mesh.facets_satisfying(lambda x: x[1] == -1.0)
        outer = mesh.facets_satisfying(lambda x: x[0] == rim)
        bonded = base == "bonded"
        # a boundary, the sign of its normal, which of the stresses it bears, what is held of it, its springs
        for facets, sign, stresses, held, springs in (
            (bottom, -1.0, (1, 2), (bonded, True), (0.0, 0.0)),
            (outer, 1.0, (0, 1), (bonded, bonded), (2.0 / rim, 0.0)),
        ):
            side = FacetBasis(mesh, basis.elem, facets=facets, intorder=2 * _ORDER)
            points = np.asarray(side.global_coordinates())
            weights = (2.0 * np.pi * points[0] * side.dx).ravel()
            u, sigma = self._of_rings(points.reshape(2, -1), ratio)
            for component, spring in enumerate(springs):
                displacement, traction = u[:, component], sign * sigma[:, stresses[component]]
                if held[component]:
                    nodes = basis.get_dofs(facets).all(f"u^{component + 1}")
                    fields[:, nodes] = -self._of_rings(basis.doflocs[:, nodes], ratio)[0][:, component]
                    fixed.append(nodes)
                    difference += (traction * weights) @ displacement.T
                    continue
                missing = -(traction + spring * displacement)
                difference += (missing * weights) @ displacement.T
                work = LinearForm(lambda v, w, c=component: 2.0 * np.pi * w.x[0] * w["load"] * v[c])
                for load, values in zip(loads, missing, strict=True):
                    load[: basis.N] += work.assemble(side, load=values.reshape(side.dx.shape))
                if spring:
                    form = BilinearForm(lambda u, v, w, c=component: 2.0 * np.pi * w.x[0] * u[c] * v[c])
                    stiffness = stiffness + spring * form.assemble(side)
        matrix = sparse.bmat(
            [[stiffness, -divergence.T], [-divergence, -ratio * forms.pressure_mass(pressures)]], "csc"
        )
        free = np.setdiff1d(np.arange(unknowns), np.concatenate(fixed))
        left = (loads - fields @ matrix)[:, free]
        fields[:, free] = splu(matrix[free][:, free].tocsc()).solve(left.T).T
        work = loads @ fields.T
        difference += work + work.T - fields @ (matrix @ fields.T)
        return np.asarray(0.5 * (difference + difference.T))

    def _of_rings(self, points: Array, ratio: float) -> tuple[Array, Array]:
        """Fields of all rings at points (2, k): displacements (m, 2, k) and stresses (m, 3, k)."""
        displacement, stress = zip(*(ring_fields(points, ring, ratio) for ring in self.rings), strict=True)
        return np.stack(displacement), np.stack(stress)
