"""The surface at one instant: pressure inside a given contact edge, displacement around it.

Lengths in scene units; ``scaled`` pressure is pressure times contact radius at unit plane modulus, which is
what one solve on the unit annuli gives. Signs: see ``annuli``. Two things annuli do not resolve:

Beyond an edge at rest the surface opens as the root of the distance, relaxed. When the contact spreads over
it, the required ``v`` keeps that root inside, and the pressure an inverse root inside the *old* edge. A flat
punch with the old edge has just this pressure, ``1/(pi sqrt(b^2 - r^2))`` within its radius b, under the
displacement 1 within and ``(2/pi) arcsin(b/r)`` beyond, at unit plane modulus. Taken out with the right
strength it leaves to the annuli what is smooth across b; any strength is an exact superposition.

Annuli widen with the distance from the edge, and what an edge has left behind where it set out slowly or
turned may be far narrower: read at single radii it comes and goes as those pass over it, and the closure of
an advancing edge becomes a wave on which the edge stops. So the part of ``v`` beyond the cubics through the
collocation radii counts, too, at the nodes of the history, each in the shares of its cubic.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view
from numpy.typing import NDArray

from bem_solver.annuli import Annuli, even_cubic
from bem_solver.body import HALF_SPACE, Compliance, SmoothPart
from bem_solver.history import NODES_APART

Array = NDArray[np.float64]


@dataclass(frozen=True)
class EdgeKinks:
    """Punches with edges at ``radius`` (k,), their roots read up to ``reach`` (k,) beyond."""

    radius: Array
    reach: Array

    @classmethod
    def within(cls, radii: tuple[float, ...], edge: float, reach: float) -> EdgeKinks:
        """Those of ``radii`` below ``edge``, each read up to the next, ``edge`` or ``reach``."""
        inside = np.array(sorted({r for r in radii if 0.0 < r < edge}))
        return cls(inside, np.minimum(np.diff(np.append(inside, edge)), reach))

    @property
    def readings(self) -> Array:
        """Radii (3 k,) at which the required ``v`` is wanted: at each, a quarter reach and one beyond."""
        return (self.radius + np.array([0.0, 0.25, 1.0])[:, None] * self.reach).ravel()

    def strengths(self, load: Array) -> Array:
        """Displacements (k, ...) of punches; ``v = v(b) - B sqrt(x) - C x`` (3 k, ...) at the readings."""
        at, quarter, full = load.reshape(3, len(self.radius), *load.shape[1:])
        fall = (4.0 * (at - quarter) - (at - full)).T / np.sqrt(self.reach)
        return (0.5 * np.pi * np.sqrt(0.5 * self.radius) * fall).T

    def displacement(self, radius: Array) -> Array:
        """``v`` of unit punches (k,) at radii (m,), shape (m, k)."""
        return (2.0 / np.pi) * np.arcsin(self.radius / np.maximum(radius[:, None], self.radius))

    def volumes(self, borders: Array) -> Array:
        """Integrals (m, k) of ``v`` of unit punches over annuli with these borders (m + 1,)."""
        far = np.maximum(borders[:, None], self.radius)
        beyond = far**2 * np.arcsin(self.radius / far) + self.radius * np.sqrt(far**2 - self.radius**2)
        within = np.minimum(borders[:, None], self.radius) ** 2 - self.radius**2
        return np.diff(np.pi * within + 2.0 * beyond, axis=0)

    @property
    def works(self) -> Array:
        """Work (k, k) of each unit punch on the displacement of each: the wider one's is even there."""
        return 2.0 * np.minimum(self.radius[:, None], self.radius)

    def tension(self, index: int, inside: Array) -> Array:
        """Normal stress (tension positive) of the unit punch ``index`` at distances inside its own edge."""
        return -1.0 / (np.pi * np.sqrt(inside * (2.0 * self.radius[index] - inside)))


NO_KINKS = EdgeKinks(np.empty(0), np.empty(0))


def speed_jump_between(
    kinks: tuple[float, ...], zone: float, edge: float, new_edge: float, accuracy: float
) -> float | None:
    """The radius, nearest to ``edge`` on its way to ``new_edge``, at which its speed may jump.

    The closure pairs gap and tension a zone apart: once the zone has left a kink, what it takes of the root
    there grows from zero, so that its slope with the edge, and the speed of the edge, jump.
    """
    way = 1.0 if new_edge > edge else -1.0
    travels = [way * (kink + side * zone - edge) for kink in kinks for side in (-1.0, 1.0)]
    nearest = min((t for t in travels if -accuracy <= t < abs(new_edge - edge)), default=None)
    return None if nearest is None else edge + way * nearest


_CROWDED, _EVEN = 0.25, 0.5
"""Distances of nodes from each other, in those asked for where the history is smooth, up to which they count
in full and from which on they do not: there the cubics hold ``v`` better than sums over nodes that come and
go. Nodes that are taken out again in pairs come no closer than the second for long."""
_AROUND = 3
"""Annuli on both sides of crowded nodes in which all nodes count: so far the cubics feel what is there."""


@dataclass(frozen=True)
class LoadBetween:
    """What nodes of the history inside a contact, at ``radius`` (m,), add to the load of its annuli.

    Each counts in the four annuli around it, ``annulus`` (4, m), by its ``share`` (4, m) of them, and stands
    for ``width`` (m,) annuli.
    """

    radius: Array
    annulus: NDArray[np.intp]
    share: Array
    width: Array

    @classmethod
    def of(cls, annuli: Annuli, edge: float, nodes: Array) -> LoadBetween:
        """Nodes around places where they are closer than their distance from the edge asks for."""
        count = int(nodes.searchsorted(edge))
        radius = nodes[:count]
        high = np.minimum(np.append(0.5 * (nodes[1:] + nodes[:-1]), edge)[:count], edge)
        low = np.append(radius[:1], high[:-1])
        apart = (high - low) / (NODES_APART * (edge - radius))
        apart[:1] *= 2.0  # nothing on the other side of the axis
        if apart.min(initial=_EVEN) >= _EVEN:
            return NONE_BETWEEN
        crowded = np.minimum((_EVEN - apart) / (_EVEN - _CROWDED), 1.0)
        position = annuli.position_at(edge - radius, edge)
        at = np.minimum(position.astype(int), annuli.count - 1)
        most = np.zeros(annuli.count + 2 * _AROUND)
        np.maximum.at(most, at + _AROUND, crowded)
        weight = sliding_window_view(most, 2 * _AROUND + 1).max(axis=1)[at]
        some = np.flatnonzero(weight)
        wide = annuli.position_at(edge - high[some], edge) - annuli.position_at(edge - low[some], edge)
        return cls(radius[some], *annuli.cubic_shares(position[some]), weight[some] * wide)

    def added(self, load: Array, at_nodes: Array) -> Array:
        """``v`` (M,) for the annuli, from that at their collocation radii (M,) and at the nodes (m,)."""
        rest = self.width * (at_nodes - (self.share * load[self.annulus]).sum(axis=0))
        return load + np.bincount(self.annulus.ravel(), (self.share * rest).ravel(), len(load))


NONE_BETWEEN = LoadBetween(np.empty(0), np.empty((4, 0), int), np.empty((4, 0)), np.empty(0))


@dataclass(frozen=True)
class ContactSurface:
    """Contact of radius ``edge`` under scaled pressures.

    ``scaled`` (M,) is pressure times ``edge`` on each annulus, ``rest`` (M,) that without the punches at
    ``kinks``, former edges, of displacements ``strengths`` (k,). Of the rest are ``density`` (M,), scaled
    pressure times ``sqrt(1 - (r/a)^2)``, smooth up to the edge; ``kappa``, ``pi`` times it at the edge, with
    ``K_I = -kappa/sqrt(pi a)`` (tension opens); ``field`` (4, M), the outer displacement without its punch
    part (``Annuli.outside_field``). ``smooth`` is what the body lacks of the half-space's compliance, and
    ``moments`` (K,) those of the pressure in it.
    """

    annuli: Annuli
    edge: float
    scaled: Array
    rest: Array
    density: Array
    kappa: float
    field: Array
    force: float
    smooth: SmoothPart
    moments: Array
    kinks: EdgeKinks
    strengths: Array

    @classmethod
    def under(
        cls,
        annuli: Annuli,
        edge: float,
        load: Array,
        kinks: EdgeKinks = NO_KINKS,
        body: Compliance = HALF_SPACE,
        between: LoadBetween = NONE_BETWEEN,
    ) -> ContactSurface:
        """The surface under a required displacement: on the half-space that and what the body lacks."""
        smooth = body.within(edge)
        response = smooth.response(annuli, edge)
        load, read, at_nodes = np.split(load, [annuli.count, annuli.count + 3 * len(kinks.radius)])
        strengths = kinks.strengths(read)
        punches = kinks.displacement(edge * annuli.radii) @ strengths
        load = between.added(load - punches, at_nodes - kinks.displacement(between.radius) @ strengths)
        if len(strengths):
            scaled, rest = annuli.solve(np.array((load + punches, load)).T).T
        else:
            scaled = rest = annuli.solve(load)
        volumes = strengths @ kinks.volumes(edge * annuli.borders).T / (2.0 * np.pi * edge)
        moments = rest @ response.weights + volumes @ response.pressures
        moments = response.inverse @ moments
        added = response.pressures @ moments
        curvature = annuli.curvature(rest) + float(response.curvatures @ moments)
        scaled, rest = scaled + added, rest + added
        density = annuli.density(rest, curvature)
        kappa = annuli.edge_strength(density)
        field = annuli.outside_field(rest, kappa, curvature)
        force = edge * annuli.force(rest, kappa, curvature) + 2.0 * float(kinks.radius @ strengths)
        of_annuli = annuli, edge, scaled, rest, density, kappa, field, force
        return cls(*of_annuli, smooth, moments, kinks, strengths)

    def towards(self, other: ContactSurface, share: float) -> ContactSurface:
        """The surface a share of the way to another with the same edge and kinks; all is linear in ``v``."""
        names = ("scaled", "rest", "density", "kappa", "field", "force", "moments", "strengths")
        mixed = {n: getattr(self, n) + share * (getattr(other, n) - getattr(self, n)) for n in names}
        return replace(self, **mixed)

    @classmethod
    def free(cls, annuli: Annuli) -> ContactSurface:
        """No contact."""
        zero = np.zeros(annuli.count)
        none = HALF_SPACE.within(0.0)
        field, moments = np.zeros((4, annuli.count)), np.zeros(none.fields.shape[1])
        return cls(annuli, 0.0, zero, zero, zero, 0.0, field, 0.0, none, moments, NO_KINKS, np.empty(0))

    def tension(self, distance: Array, density: Array | None = None) -> Array:
        """Normal stress (tension positive) at ``distance`` inside the edge, without kinks."""
        density = self.density if density is None else density
        cosine = np.sqrt(distance * (2.0 * self.edge - distance)) / self.edge
        return -even_cubic(density, self.annuli.position_at(distance, self.edge)) / (cosine * self.edge)

    def pressure(self, radius: Array) -> Array:
        """Pressure at radii < edge, kinks as the annuli see them; zero outside."""
        inside = radius < self.edge
        value = np.zeros(len(radius))
        if inside.any():
            density = self.density
            if len(self.strengths):
                density = self.annuli.density(self.scaled, self.annuli.curvature(self.scaled))
            value[inside] = -self.tension(self.edge - radius[inside], density)
        return value

    def outside(self, radius: Array) -> Array:
        """Displacement ``v`` at unit plane modulus, radii >= edge."""
        if self.edge == 0.0:
            return np.zeros(len(radius))
        value = self.annuli.outside(self.field, self.kappa, radius / self.edge)
        if len(self.strengths):
            value = value + self.kinks.displacement(radius) @ self.strengths
        return self.smooth.taken_from(value, radius, self.moments)

    def work_on(self, displacement: Array) -> Array:
        """``int p g`` (n,) over the contact, of fields g (M + 3 k, n) at the radii and readings of kinks.

        The punches are taken out of both: what one does on the rest of g is, the operator being symmetric,
        what the pressure under that rest does on the punch's displacement.
        """
        annuli, kinks = self.annuli, self.kinks
        at, roots = displacement[: annuli.count], kinks.strengths(displacement[annuli.count :])
        rest = at - kinks.displacement(self.edge * annuli.radii) @ roots
        return self._work_on_parts(rest, annuli.solve(rest) if len(self.strengths) else rest, roots)

    @property
    def load_work(self) -> float:
        """``int p v`` over the contact."""
        work = self._work_on_parts(self.annuli.matrix @ self.rest, self.rest, self.strengths)
        return float(work) - 2.0 * np.pi * float(self.moments @ self.moments)

    def _work_on_parts(self, rest: Array, scaled: Array, roots: Array) -> Array:
        """``int p g``: rest of g (M, ...), scaled pressure (M, ...) that makes it, and punches (k, ...)."""
        volumes = self.kinks.volumes(self.edge * self.annuli.borders).T / self.edge
        work = self.edge * self.annuli.work(self.rest, rest) + self.strengths @ (volumes @ scaled)
        return work + (volumes @ self.rest + self.strengths @ self.kinks.works) @ roots

    @cached_property
    def edge_load(self) -> float:
        """``v`` at the edge."""
        if self.edge == 0.0:
            return 0.0
        load = self.annuli.at_edge(self.field, self.kappa)
        load += float(self.kinks.displacement(np.array([self.edge]))[0] @ self.strengths)
        return float(self.smooth.taken_from(np.array([load]), np.array([self.edge]), self.moments)[0])

    def load_ahead(self, distance: float) -> float:
        """``v`` at a distance >= 0 outside the edge."""
        if distance == 0.0:
            return self.edge_load
        return float(self.outside(np.array([self.edge + distance]))[0])

    def root_strength(self, reach: float) -> float:
        """B in ``v = v(a) - B sqrt(x) - C x`` at distance x outside the edge."""
        if self.edge == 0.0 or reach == 0.0:
            return 0.0
        tip, quarter, full = self.outside(self.edge + np.array([0.0, 0.25, 1.0]) * reach)
        return float((4.0 * (tip - quarter) - (tip - full)) / np.sqrt(reach))

    @property
    def stress_intensity(self) -> float:
        """``K_I``, positive in tension; zero without contact."""
        return -self.kappa / float(np.sqrt(np.pi * self.edge)) if self.edge > 0 else 0.0
