"""Contact states with a continuous edge, and the node-release closure.

The edge is a real number ``s``: nodes ``0..floor(s)`` are in full contact, the next one carries the fraction
``s - floor(s)`` of the reaction it would have in full contact, with the history of its part in contact (see
``partial_release``). Every state between two neighbouring contact sets of a solid without history is thus
their linear combination, its total force and contact radius (see ``surface``) too.

The closure ``(1/(2 da)) int sigma(r) g(r + da) dr`` over the process zone is read as the work of the nodal
reactions ``f_i`` (which contain ``2 pi r``) through the gap one zone further out,

    ``I(s) = (1/(2 da)) sum_i -f_i/(2 pi r_i) g(r_i + da)``.

On a uniform mesh with a whole number of elements per zone a shifted vertex is a vertex and a shifted mid-side
node a mid-side node; the sum is then the virtual crack closure integral, equal to the discrete energy release
of an elastic body exactly, with no error from the singular stress. Otherwise the gap at ``r_i + da`` is
interpolated between the neighbouring nodes *of the same kind*, which keeps that property up to second order:
interpolation by the quadratic shape functions would mix the two kinds, whose reactions differ by a factor
of two, and ripple from node to node.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fem_solver.condensed import Response
from fem_solver.edge_geometry import EdgeGeometry, EdgeOrigin
from fem_solver.partial_release import PartialContact
from fem_solver.process_zone import ZoneShift, zone_of_stress

Array = NDArray[np.float64]


@dataclass(frozen=True)
class ClosureWithinNode:
    """Closure integral with the edge between two nodes: a quadratic form.

    Forces and gaps are linear in the penetration and in the ``y`` of the node next to the edge.

    Parameters
    ----------
    penetration : float
        From which changes of it are counted.
    constant, by_x, by_y, by_xx, by_xy, by_yy : float
        Coefficients of the products of 1, the change ``x`` of the penetration, and ``y``.
    """

    penetration: float
    constant: float
    by_x: float
    by_y: float
    by_xx: float
    by_xy: float
    by_yy: float

    @classmethod
    def of(cls, penetration: float, products: Array) -> ClosureWithinNode:
        """From what the forces of 1, ``x`` and ``y`` do over their gaps, shape (3, 3)."""
        (constant, ax, ay), (bx, by_xx, axy), (by, bxy, by_yy) = products.tolist()
        return cls(penetration, constant, ax + bx, ay + by, by_xx, axy + bxy, by_yy)

    def at(self, penetration: float, y: float) -> float:
        """An energy per area; ``y`` per modulus."""
        x = penetration - self.penetration
        by_x, by_y = self.by_x + x * self.by_xx, self.by_y + x * self.by_xy + y * self.by_yy
        return self.constant + x * by_x + y * by_y


class ContactProblem:
    """All contact states possible at one instant, as functions of the edge position.

    Parameters
    ----------
    geometry : EdgeGeometry
    response : Response
        Of the half-space at that instant.
    height : ndarray, shape (n,)
        Indenter profile at the nodes.
    control : "penetration", "force" or "stage"
    value : float
        Of the controlled quantity.
    compliance : float
        Of the machine, through which the stage acts.
    dt : float
        Time since the last accepted state; infinite for a relaxed response.
    origin : EdgeOrigin, optional
        Edge of that state.
    """

    def __init__(
        self,
        geometry: EdgeGeometry,
        response: Response,
        height: Array,
        control: str,
        value: float,
        *,
        compliance: float = 0.0,
        dt: float = 0.0,
        origin: EdgeOrigin | None = None,
    ) -> None:
        self.geometry, self.response = geometry, response
        self.operator = response.operator
        self.control, self.value, self.compliance = control, value, compliance
        self.dt, self.origin = dt, origin
        self._partly = response.partly
        self._base = -height - response.free
        self._base_y = self.operator.transform(self._base)
        self._base_force = np.cumsum(self.operator.unit * self._base_y)
        self._closures: dict[int, ClosureWithinNode] = {}
        self.evaluations = 0

    def penetration(self, s: float) -> float:
        """Penetration at edge position ``s``; the unknown beside it when force or stage is prescribed."""
        if self.control == "penetration":
            return self.value
        stiffness, force = self._totals(s)
        if self.control == "stage":  # X = D + F/k, F = modulus (stiffness D + force)
            softness = self.compliance * self.response.modulus
            return (self.value - softness * force) / (1.0 + softness * stiffness)
        if stiffness == 0.0:  # no contact yet: the penetration at which the indenter first touches
            return -float(self._base.max())
        return (self.value / self.response.modulus - force) / stiffness

    def force(self, s: float) -> float:
        """Total force."""
        if self.control == "force":
            return self.value
        stiffness, force = self._totals(s)
        return self.response.modulus * (stiffness * self.penetration(s) + force)

    def _totals(self, s: float) -> tuple[float, float]:
        m = int(np.floor(s))
        part = s - m
        stiffness = self.operator.stiffness[m] if m >= 0 else 0.0
        force = self._base_force[m] if m >= 0 else 0.0
        if part > 0.0:
            stiffness = (1.0 - part) * stiffness + part * self.operator.stiffness[m + 1]
            force += self.operator.unit[m + 1] * self._bearing(m + 1, part)
        return float(stiffness), float(force)

    def _bearing(self, node: int, share: float) -> float:
        """``y`` of the node next to the edge per modulus, at no penetration."""
        whole = float(self._base_y[node])
        return share * whole if self._partly is None else self._partly.bearing(node, share, whole)

    def partial_contact(self, s: float) -> PartialContact | None:
        """The node next to an adhesive edge at ``s``, unless that is the rim of the indenter."""
        m = int(np.floor(s))
        if self.geometry.zone is None or m < 0 or m >= self.geometry.last:
            return None
        share, unit = s - m, self.operator.unit[m + 1]
        missing = float(self._base_y[m + 1]) - self._bearing(m + 1, share)
        return PartialContact(m + 1, share, float(self.penetration(s) * (1.0 - share) + missing / unit))

    def intensity(self, node: int, s: float) -> float:
        """Indentation of the flat punch up to ``node`` with the same edge singularity; tension < 0."""
        return self._intensity(node, self.penetration(s))

    def _intensity(self, node: int, penetration: float) -> float:
        return penetration + float(self._base_y[node] / self.operator.unit[node])

    def singular_force(self, s: float) -> float:
        """Force of the flat punch, as large as the contact, that leaves the same edge singularity."""
        m = int(np.floor(s))
        if m < 0:
            return 0.0
        return self.response.modulus * float(self.operator.stiffness[m]) * self.intensity(m, s)

    def transformed(self, s: float) -> Array:
        """``L^-1`` of the displacement imposed inside, cut at the edge; shape (floor(s) + 2,)."""
        m, penetration = math.floor(s), self.penetration(s)
        y = penetration * self.operator.unit[: m + 2] + self._base_y[: m + 2]
        y[m + 1] = self._at_edge(s, penetration)
        return y

    def _at_edge(self, s: float, penetration: float) -> float:
        """``y`` of the node next to the edge, in contact in part, per modulus."""
        node, share = math.floor(s) + 1, s - math.floor(s)
        return penetration * float(self.operator.unit[node]) * share + self._bearing(node, share)

    def forces(self, s: float) -> Array:
        """All nodal forces, compressive positive; shape (n,)."""
        y = self.transformed(s)
        padded = np.zeros(len(self._base))
        padded[: len(y)] = y
        return self.response.modulus * self.operator.forces(padded)

    def closure(self, s: float) -> float:
        """Closure integral, an energy per area; minus infinity where the edge is under pressure.

        Pressure at the edge would make the surface outside penetrate the indenter.
        """
        self.evaluations += 1
        m, penetration = math.floor(s), self.penetration(s)
        if self._intensity(m + 1, penetration) > 0.0:
            return -math.inf
        at_edge = self._at_edge(s, penetration)
        if self.geometry.stress is not None:
            return self._closure_within(m, penetration, self._shift_of_stress(s)).at(penetration, at_edge)
        if m not in self._closures:
            self._closures[m] = self._closure_within(m, penetration, self._shift)
        return self._closures[m].at(penetration, at_edge)

    def _closure_within(self, m: int, penetration: float, shift: ZoneShift) -> ClosureWithinNode:
        """The closure integral with the edge between the nodes ``m`` and ``m + 1``.

        Parameters
        ----------
        m : int
        penetration : float
            At which it is most accurate.
        shift : ZoneShift

        Returns
        -------
        ClosureWithinNode
        """
        operator, top = self.operator, m + 1
        first, end = shift.nodes(m, top)
        # at this penetration, by a change of it, and by the node next to the edge
        y = np.zeros((top + 1, 3))
        y[:top, 1] = operator.unit[:top]
        y[:top, 0] = penetration * y[:top, 1] + self._base_y[:top]
        y[top, 2] = 1.0
        gaps = operator.displacement_beyond(y, end)
        gaps[:, 0] -= penetration + self._base[top:end]
        gaps[:, 1] -= 1.0
        forces = self.response.modulus * operator.last_forces(y, first)
        return ClosureWithinNode.of(penetration, np.asarray(shift.closure(first, forces.T, gaps.T)))

    def zone(self, s: float) -> float:
        """Length of the process zone; at fixed stress at most the radius, without contact that at rest."""
        geometry = self.geometry
        if geometry.stress is None or geometry.shortest is None or s < 0.0:
            return geometry.zone or 0.0
        return self._zone(s, self.transformed(s), geometry.stress, geometry.shortest)

    @property
    def _shift(self) -> ZoneShift:
        """By the length of the zone, where that is given."""
        if self.geometry.shift is None:
            raise AssertionError("no closure without adhesion")
        return self.geometry.shift

    def _shift_of_stress(self, s: float) -> ZoneShift:
        return ZoneShift(self.geometry.radii, self.zone(s))

    def _zone(self, s: float, y: Array, stress: float, at_rest: float) -> float:
        def forces(first: int) -> Array:
            return self.response.modulus * self.operator.last_forces(y, first)

        return zone_of_stress(self.geometry.radii[: len(y)], forces, self.geometry.radius(s), stress, at_rest)
