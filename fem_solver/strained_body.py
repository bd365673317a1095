"""Fields at the quadrature points of one mesh for the components of its surface, by back-substitution.

Stress and strain components in the order ``(rr, zz, tt, rz)``, tension positive. A relaxing solid is a set of
springs that bear their stresses side by side: two that do not relax, in shear and in volume, and one in each
branch. Every spring is strained by surface forces on an elastic body, so that its fields need one
back-substitution: by the deviator ``e`` and by ``m``, which is a stress where all moduli relax alike and a
volume strain where bulk relaxes apart,

    ``s = 2 G e + S m 1``,   energy density ``G e : e + c S m^2/2``,   volume strain ``c m``.

- All alike: ``m`` is the mean stress of a solid of unit shear modulus under the forces ``L^-T v``, and
  ``S = G``, ``c = G/K``: it holds for the incompressible solid, too. The spring of a branch has the
  components ``b_k/G_k``.
- Bulk apart: under normal pressures the displacement of a half-space is
  ``A[p/(2 G)] + B[3 p/(2 (3 K + G))]``, where ``A`` changes no volume, so that an elastic solid of unit shear
  modulus gives both: incompressible ``A[w/2]``, and compressible that and ``B[3 w/(2 (3 K/G + 1))]``. Either
  belongs to one of the two moduli that the surface has in series (see ``moduli``). ``S = K``,
  ``c = 1``.

The mesh may stand for one that is ``scale`` times as large: the same forces displace that ``1/scale`` and
stress it ``1/scale^2`` times as much.

**Losses.** Over a step a branch loses ``m (w_0 q(s, s) + w_1 q(s, dx) + w_2 q(dx, dx))``, with its spring at
the begin, ``s``, the change ``dx`` of the whole, and the form ``q`` of which ``m q/2`` is the energy of the
spring (``Prony.loss_weights``). That is not negative, so a sum of two squares,

    ``m q(v_1, v_1) + m q(v_2, v_2)``,   ``v_1 = sqrt(w_0) (s + w_1/(2 w_0) dx)``,
    ``v_2 = sqrt(w_2 - w_1^2/(4 w_0)) dx``.

All of it is linear in the components of the surface, and as long as the mesh stays the densities everywhere
follow from the Gram sum of the components of ``v_1`` and ``v_2``. In components the energy of the whole body
is the sum of squares: that sum is cut where what is left out is a share ``CUT`` of the energy, which bounds
the density left out anywhere, summed over the body. So a run takes few back-substitutions, whatever its rows.

Where the mesh moves on, what was lost is projected onto the mesh at its new place (``Recovery.taken_over``).
Its energy remains; it is known as finely as the meshes have been since it was lost.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fem_solver import forms
from fem_solver.halfspace import HalfSpace
from fem_solver.moduli import Moduli, Prony
from fem_solver.placement import Placement
from fem_solver.state import ComponentState

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Spring:
    """Moduli ``G`` and ``S`` of a spring; ``time`` is that of the dashpot in line with it, if any."""

    shear: float
    volume: float
    time: float = np.inf


@dataclass(frozen=True)
class Strained:
    """Nodal ``unknowns``, ``e`` (4, points) and ``m`` (points,) of a spring."""

    unknowns: Array
    deviator: Array
    mean: Array


@dataclass(frozen=True)
class PointFields:
    """State of the body at the quadrature points.

    ``unknowns`` are nodal; ``stress`` and ``strain`` (4, points), ``stored`` (points,), ``rates`` (branches,
    points).
    """

    unknowns: Array
    stress: Array
    strain: Array
    stored: Array
    rates: Array


class Springs:
    """The springs of a material, and the surface components that strain them.

    ``names`` are those of the branches. Components of a spring have the shape (1, n), or where bulk relaxes
    apart (2, n): what the first and what the second modulus of the surface has gone through.
    """

    def __init__(self, material: Moduli) -> None:
        self.material, self._series, shear, bulk = material, material.series, material.shear, material.bulk
        if self._series is None or bulk is None:
            self.names = _names(shear)
            self.relaxed = Spring(shear.relaxed, shear.relaxed)
            pairs = [(shear, shear.moduli)]
        else:
            self.names = _names(shear, "shear ") + _names(bulk, "bulk ")
            self.relaxed = Spring(shear.relaxed, bulk.relaxed)
            pairs = [(shear, 0.0 * shear.moduli), (bulk, bulk.moduli)]
        self.branches = tuple(
            Spring(modulus if part is shear else 0.0, volume, time)
            for part, volumes in pairs
            for modulus, volume, time in zip(part.moduli, volumes, part.times, strict=True)
        )
        self.times: Array = np.array([branch.time for branch in self.branches])

    def components(self, v: Array, b: Array) -> tuple[Array, Array]:
        """Of the relaxed springs (parts, n), and of those of the branches (branches, parts, n)."""
        if self._series is None:
            return v[None], (b / self.material.shear.moduli[:, None])[:, None]
        one, both = self._series.parts(v, b)
        count = len(both.springs) - len(one.springs)  # branches of the bulk come first
        of_volume = np.concatenate([both.springs[count:], both.springs[:count]])
        of_shear = np.concatenate([one.springs, np.zeros((count, len(v)))])
        return np.stack([one.whole, both.whole]), np.stack([of_shear, of_volume], axis=1)


class StrainedBody:
    """The factorised half-space, or layer, of one mesh, of which ``count`` surface nodes have components."""

    def __init__(self, space: HalfSpace, count: int, springs: Springs) -> None:
        self.space, self.springs = space, springs
        material, self._strain = springs.material, forms.strain_operator(space.basis)
        ratio, self._apart = material.instantaneous_ratio, material.series is not None
        self._factors = [space.factorise(each, 0) for each in ([0.0, ratio] if self._apart else [ratio])]
        self._weights = [factor.far_weights(count) for factor in self._factors]
        self._dilated = 1.0 if self._apart else ratio  # volume strain per m
        self._unit = material.unit_plane_modulus
        self.points: int = self._strain.shape[0] // 4

    @property
    def factorisations(self) -> int:
        """Of this body."""
        return len(self._factors)

    @property
    def solves(self) -> int:
        """Back-substitutions so far."""
        return sum(factor.solves for factor in self._factors)

    def strained(self, components: Array, here: Placement) -> Strained:
        """A spring with these components, shape (parts, n), on the mesh at a place."""
        if not self._apart:
            return self._under(0, here.forces(components[0]), here.scale)
        ratio = self._factors[1].ratio
        beside = 4.0 * (3.0 / ratio + 1.0) / (3.0 * self._unit) * components[1]
        one = self._under(0, here.forces(4.0 / self._unit * components[0] - beside), here.scale)
        other = self._under(1, here.forces(beside), here.scale)
        size = self.space.basis.N
        unknowns = one.unknowns[:size] + other.unknowns[:size]
        return Strained(unknowns, one.deviator + other.deviator, ratio * other.mean)

    def energy(self, spring: Spring, strained: Strained) -> Array:
        """Energy density; shape (points,)."""
        e = strained.deviator
        in_shear = np.einsum("i,ip,ip->p", forms.CONTRACTION, e, e)
        return spring.shear * in_shear + 0.5 * self._dilated * spring.volume * strained.mean**2

    def fields(self, v: Array, b: Array, here: Placement) -> PointFields:
        """The relaxing solid for the components of its surface, as of :meth:`Springs.components`."""
        whole, branches = self.springs.components(v, b)
        at_all = self.strained(whole, here)
        stress, stored = self._stress(self.springs.relaxed, at_all), self.energy(self.springs.relaxed, at_all)
        rates = np.zeros((len(branches), self.points))
        for k, (spring, components) in enumerate(zip(self.springs.branches, branches, strict=True)):
            strained = self.strained(components, here)
            energy = self.energy(spring, strained)
            stress, stored = stress + self._stress(spring, strained), stored + energy
            rates[k] = 2.0 * energy / spring.time
        strain = at_all.deviator.copy()
        strain[:3] += self._dilated * at_all.mean / 3.0
        return PointFields(at_all.unknowns, stress, strain, stored, rates)

    @staticmethod
    def _stress(spring: Spring, strained: Strained) -> Array:
        stress = 2.0 * spring.shear * strained.deviator
        stress[:3] += spring.volume * strained.mean
        return stress

    def _under(self, which: int, forces: Array, scale: float) -> Strained:
        """An elastic solid of unit shear modulus under forces on the surface, compressive positive."""
        space, factor, weights = self.space, self._factors[which], self._weights[which]
        load, size = np.zeros(space.unknowns), space.basis.N
        load[space.surface_dofs[: len(forces)]] = -forces
        unknowns = factor.solve(load, factor.far_mix * float(weights @ forces))
        strain = scale**-2 * (self._strain @ unknowns[:size]).reshape(4, -1)
        # the volume strain of the pressure is better than that of the displacement
        mean = -(scale**-2) * np.asarray(space.pressure_basis.interpolate(unknowns[size:])).ravel()
        return Strained(unknowns / scale, forms.deviator(strain), mean)


def _names(modulus: Prony, kind: str = "") -> tuple[str, ...]:
    """Names of the branches of a modulus."""
    return tuple(f"{kind}tau={time:.6g}" for time in modulus.times)


CUT = 1e-8
"""Energy left out by the truncation, relative to the energy of all vectors."""


class Losses:
    """Losses of the steps on one mesh, a branch each as few components of the surface."""

    def __init__(self, springs: Springs) -> None:
        self._springs = springs
        times = springs.times
        self._law = Prony(0.0, np.ones_like(times), times)
        self._vectors: list[list[Array]] = [[] for _ in times]

    def add(self, dt: float, begin: ComponentState, end: ComponentState) -> None:
        """Add a step, both ends of which are on this mesh."""
        if not 0.0 < dt < np.inf:
            return
        before, springs = self._springs.components(begin.components, begin.branches)
        change = self._springs.components(end.components, end.branches)[0] - before
        weights = self._law.loss_weights(dt).T
        for spring, (first, second, third), vectors in zip(springs, weights, self._vectors, strict=True):
            mixed = second / (2.0 * first)
            vectors.append(np.sqrt(first) * (spring + mixed * change))
            vectors.append(np.sqrt(max(third - 0.5 * second * mixed, 0.0)) * change)
        if any(len(vectors) > vectors[0].size for vectors in self._vectors):  # no more are independent
            self._vectors = [_leading(vectors) for vectors in self._vectors]

    def density(self, body: StrainedBody, here: Placement) -> Array:
        """Densities of all added; shape (branches, points)."""
        lost = np.zeros((len(self._vectors), body.points))
        for k, (spring, vectors) in enumerate(zip(self._springs.branches, self._vectors, strict=True)):
            for vector in _leading(vectors):
                lost[k] += 2.0 * body.energy(spring, body.strained(vector, here))
        return lost


def _leading(vectors: list[Array]) -> list[Array]:
    """Few vectors with the same Gram sum."""
    if not vectors:
        return []
    rows = np.array(vectors)
    flat = rows.reshape(len(rows), -1)
    energies, modes = np.linalg.eigh(flat @ flat.T)
    left_out = np.cumsum(np.maximum(energies, 0.0))
    leading = modes[:, left_out > CUT * left_out[-1]]
    return list((leading.T @ flat).reshape(-1, *rows.shape[1:]))
