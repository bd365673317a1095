"""Node-release closure and its process zone: nodes one zone further out, and the length at fixed stress.

The closure ``(1/(2 da)) int sigma(r) g(r + da) dr`` over the process zone is read as the work of the nodal
reactions ``f_i`` (which contain ``2 pi r``) through the gap one zone further out,

    ``I(s) = (1/(2 da)) sum_i -f_i/(2 pi r_i) g(r_i + da)``.

On a uniform mesh with a whole number of elements per zone a shifted vertex is a vertex and a shifted mid-side
node a mid-side node; the sum is then the virtual crack closure integral, equal to the discrete energy release
of an elastic body exactly, with no error from the singular stress. Otherwise the gap at ``r_i + da`` is
interpolated between the neighbouring nodes *of the same kind*, which keeps that property up to second order:
interpolation by the quadratic shape functions would mix the two kinds, whose reactions differ by a factor
of two, and ripple from node to node.

On the mesh the integral depends on where the edge lies within an element, by some ``1/N^2`` with N elements
a zone: contact would be lost where that ripple is steepest, and a mesh that moves on would drive the edge the
same way every time. Within a zone the field is that of a paraboloid with the same intensity of stress at the
edge and the same change of it with the square of the radius. There the integral is known
(:func:`exact_closure`); it is read in units of what the mesh has for it (:class:`ClosureRatio`).

A zone of fixed cohesive stress ``s`` is as long as the mean tension over it is ``(4/pi) s`` (definition:
``contact_scene.adhesion``). The tension over a length is a sum of nodal forces, which the mesh knows far
better than the singular stress itself; between vertices its square, nearly linear in the distance from the
edge, is interpolated.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray
from scipy.linalg.lapack import dtrtrs

Array = NDArray[np.float64]

_ZONE = 1.5
"""Length of the zone for which the ratio is told, in units of the mesh: between the one for which the mesh
is made and twice that, of a mesh scaled down to half. It differs by some 1e-6 between the two."""
_LEAST_RADIUS = 2.0
"""Least contact radius over the zone at which the ratio is told: under a smaller one elements of an edge's
zone reach the axis."""
_ANGLES, _WEIGHTS = np.polynomial.legendre.leggauss(12)
LEAST_ZONE = 1e-2
"""Shortest zone of fixed stress that is followed, in zones at rest: a tenth of an element."""


class ZoneShift:
    """Between which nodes the point one zone outside each node lies.

    ``radii`` are those of vertices and mid-side nodes in turn, from the axis. On a uniform mesh with a whole
    number of elements per zone that point is a node; otherwise the gap there is interpolated between the
    neighbouring nodes *of the same kind*.
    """

    def __init__(self, radii: Array, zone: float) -> None:
        count = len(radii)
        self.radii, self.zone = radii, zone
        self.low = np.zeros(count, dtype=int)
        self.high = np.zeros(count, dtype=int)
        self.share = np.zeros(count)
        for kind in (0, 1):
            nodes = np.arange(kind, count, 2)
            own = radii[nodes]
            targets = own + zone
            right = np.clip(np.searchsorted(own, targets), 1, len(nodes) - 1)
            width = own[right] - own[right - 1]
            share = np.clip((targets - own[right - 1]) / width, 0.0, 1.0)
            self.low[nodes], self.high[nodes], self.share[nodes] = nodes[right - 1], nodes[right], share
        # first node whose shifted point can lie outside the contact of the nodes 0..m
        self.first = np.searchsorted(np.maximum.accumulate(self.high), np.arange(count), side="right")

    def nodes(self, last: int, top: int) -> tuple[int, int]:
        """First node whose force the closure asks for, and the end of those whose gap it asks for.

        ``last`` is the last node in full contact, ``top`` the last with a force.
        """
        first = max(int(self.first[last]), 1)
        return first, int(self.high[first : top + 1].max()) + 1

    def seen(self, s: float) -> float:
        """Position, in nodes, of the end of the zone in front of an edge at ``s``."""
        m = int(np.floor(s))
        ends = self.low[m : m + 2] + (self.high[m : m + 2] - self.low[m : m + 2]) * self.share[m : m + 2]
        return float(ends[0] + (s - m) * (ends[1] - ends[0]))

    def closure(self, first: int, forces: Array, gap: Array) -> Array | float:
        """Closure integral: half of what the nodal forces do over the gaps one zone further out, per area.

        Forces of the nodes from ``first`` to the last with one, gaps from that last one on.
        """
        top = first + forces.shape[-1] - 1
        inside = slice(first, top + 1)
        known = np.concatenate([np.zeros((*gap.shape[:-1], top - first)), gap], axis=-1)
        low, high, share = self.low[inside] - first, self.high[inside] - first, self.share[inside]
        shifted = (1.0 - share) * known[..., low] + share * known[..., high]
        return (-forces / self.radii[inside]) @ shifted.T / (4.0 * np.pi * self.zone)


def exact_closure(radius: float, zone: float) -> Array:
    """Closure integral of a paraboloid ``k r^2/2`` at the penetration D, for unit plane modulus.

    ``int -p(r) g(r + zone) dr / (2 zone)`` over the zone, with the pressure
    ``(D + k (a^2 - 2 r^2))/(pi sqrt(a^2 - r^2))`` and the gap
    ``(k/pi) a sqrt(x^2 - a^2) - (2/pi) acos(a/x) (D - k x^2/2)``: what goes with ``D^2``, ``D k`` and
    ``k^2``. That of a flat punch is ``D^2/(2 pi a)`` where the zone is short.
    """
    angles, weights = 0.25 * np.pi * (_ANGLES + 1.0), 0.25 * np.pi * _WEIGHTS
    outside = zone * np.sin(angles) ** 2  # takes both roots at the ends
    x = radius + outside
    arc = 2.0 * np.arcsin(np.sqrt(0.5 * outside / x))  # acos(a/x) without a difference
    pressed = radius**2 - 2.0 * (x - zone) ** 2
    closed = -0.5 * x**2 * arc - 0.5 * radius * np.sqrt(outside * (radius + x))
    measure = 2.0 * weights * np.sqrt(outside / (2.0 * radius - zone + outside)) / (np.pi**2 * zone)
    return np.array([arc @ measure, (closed + pressed * arc) @ measure, (pressed * closed) @ measure])


class ClosureRatio:
    """Closure integral of a paraboloid on a mesh over the closed form, at the edge positions asked for.

    ``sites`` are where its components are, ``stretch`` times a node's radius where its height is, ``strip``
    the radii between which the surface is fine. One where the strip has no room for a zone on both sides of
    an edge: the mesh is fine throughout then.
    """

    def __init__(
        self,
        root: Array,
        unit: Array,
        radii: Array,
        effective: Array,
        sites: Array,
        stretch: float,
        strip: tuple[float, float],
        modulus: float,
    ) -> None:
        zone = _ZONE if strip[0] > 0.0 else 1.0
        self._root, self._unit, self._effective, self._modulus = root, unit, effective, modulus
        self._shift, self._sites, self._height = ZoneShift(radii, zone), sites, 0.5 * (stretch * radii) ** 2
        first = max(strip[0], _LEAST_RADIUS * zone) + zone
        self._nodes = np.flatnonzero((radii >= first) & (radii <= strip[1] - zone))
        self._told: dict[int, Array] = {}

    def at(self, s: float, bend: float) -> float:
        """With the edge at ``s``, or at the nearest end of the strip.

        ``bend`` is the change of the intensity with the square of the radius, over the intensity at the edge:
        at most so much that the intensity changes by itself within a zone.
        """
        if not self._nodes.size:
            return 1.0
        s = min(max(s, float(self._nodes[0])), float(self._nodes[-1]))
        m = math.floor(s)
        share = s - m
        inner, middle, outer = (
            (1.0 - share) * (1.0 - 2.0 * share),
            4.0 * share * (1.0 - share),
            share * (2.0 * share - 1.0),
        )
        forms = inner * self._forms(2 * m)  # of the second degree from node to node
        if share > 0.0:
            forms = forms + middle * self._forms(2 * m + 1) + outer * self._forms(2 * m + 2)
        radius = self._effective[m] + share * (self._effective[m + 1] - self._effective[m])
        most = 0.5 / (radius * self._shift.zone)
        bend = min(max(bend, -most), most)
        depth = 1.0 - bend * radius**2
        mesh, exact = forms @ (depth**2, -depth * bend, bend**2)
        return float(mesh / exact)

    def _forms(self, place: int) -> Array:
        """What goes with ``D^2``, ``D k``, ``k^2`` on the mesh, and exactly; at a node or half past it."""
        if place not in self._told:
            last = place // 2
            top = last + place % 2
            held = self._unit[: top + 1].copy()
            held[last + 1 :] *= 0.5
            v = np.stack([held, -held * self._sites[: top + 1] ** 2])
            first, end = self._shift.nodes(last, top)
            inside, outside = slice(first, top + 1), slice(top, end)
            forces = dtrtrs(self._root[inside, inside], v[:, inside].T, lower=1, trans=1)[0].T
            gaps = v @ self._root[outside, : top + 1].T
            gaps += np.stack([np.full(end - top, -1.0), self._height[outside]])
            (a, b), (c, d) = (np.asarray(self._shift.closure(first, force, gaps)) for force in forces)
            radius = 0.5 * (self._effective[last] + self._effective[top])
            exact = self._modulus * exact_closure(float(radius), self._shift.zone)
            self._told[place] = np.array([[a, b + c, d], exact])
        return self._told[place]


def zone_of_stress(
    radii: Array, forces: Callable[[int], Array], edge: float, stress: float, at_rest: float
) -> float:
    """Length of the process zone of fixed stress, from as many nodes from the edge inwards as it takes."""
    reach = 2.0 * at_rest
    while True:
        first = max(int(np.searchsorted(radii, edge - reach)), 1)
        tension = -forces(first) / (2.0 * np.pi * radii[first:])
        length = zone_length(radii[first:], tension, first, edge, stress)
        if length is not None:
            return max(length, LEAST_ZONE * at_rest)
        if first == 1:
            return edge
        reach *= 2.0


def zone_length(radii: Array, tension: Array, first: int, edge: float, stress: float) -> float | None:
    """Length over which the mean tension is ``(4/pi) stress``; ``None`` if it reaches beyond the first node.

    ``tension`` is force per length of the nodes ``first``, ...; vertices have even numbers.
    """
    allowed = 4.0 / math.pi * stress
    beyond = np.cumsum(tension[::-1])[::-1]
    vertices = np.arange(first % 2, len(radii), 2)
    vertices = vertices[radii[vertices] < edge][::-1]  # from the edge inwards
    over = beyond[vertices] - 0.5 * tension[vertices]
    inwards = radii[vertices]
    if (
        first == 1 and len(vertices) > 1
    ):  # to the axis, where no force tells a stress, as between the last two
        growth = (over[-1] - over[-2]) / (inwards[-2] - inwards[-1])
        over = np.append(over, over[-1] + growth * inwards[-1])
        inwards = np.append(inwards, 0.0)
    squares = np.concatenate(([0.0], over * np.abs(over)))
    distance = np.concatenate(([0.0], edge - inwards))
    excess = squares - (allowed * distance) ** 2
    pulling = np.flatnonzero(excess > 0.0)
    if not len(pulling):
        return 0.0
    after = np.flatnonzero(excess[pulling[0] :] <= 0.0)
    if not len(after):
        return None
    end = int(pulling[0] + after[0])
    start, width = distance[end - 1], distance[end] - distance[end - 1]
    # squares linear, (allowed d)^2 quadratic in the share of the interval
    a = (allowed * width) ** 2
    b = 2.0 * allowed**2 * start * width - (squares[end] - squares[end - 1])
    c = -excess[end - 1]
    return float(start + width * (-2.0 * c) / (b + math.sqrt(b * b - 4.0 * a * c)))
