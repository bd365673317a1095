"""The surface at one instant: pressure inside a given contact edge, displacement around it.

Lengths in scene units; ``scaled`` pressure is pressure times contact radius at unit plane modulus, which is
what one solve on the unit annuli gives. Signs: see ``kernel``. Two things annuli do not resolve:

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

from bem_solver.annuli import Annuli
from bem_solver.body import HALF_SPACE, Compliance, SmoothPart
from bem_solver.cubic_interpolation import even_cubic
from bem_solver.history import NODES_APART

Array = NDArray[np.float64]


@dataclass(frozen=True)
class EdgeKinks:
    """Punches with edges at ``radius`` (k,), their roots read up to ``reach`` (k,) beyond."""

    radius: Array
    reach: Array

    @classmethod
    def within(cls, radii: tuple[float, ...], edge: float, reach: float) -> EdgeKinks | None:
        """Those of ``radii`` below ``edge``, each read up to the next, ``edge`` or ``reach``."""
        inside = np.array(sorted({r for r in radii if 0.0 < r < edge}))
        if len(inside) == 0:
            return None
        return cls(inside, np.minimum(np.diff(np.append(inside, edge)), reach))

    def and_at(self, radius: float, reach: float) -> EdgeKinks:
        """One more, beyond the others."""
        return EdgeKinks(np.append(self.radius, radius), np.append(self.reach, reach))

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
    """What nodes of the history inside a contact add to the load of its annuli.

    Attributes
    ----------
    radius : ndarray (m,)
        Of the nodes.
    annulus : ndarray of int (4, m)
        Annuli around each.
    share : ndarray (4, m)
        Their shares in it.
    width : ndarray (m,)
        How many annuli each stands for.
    """

    radius: Array
    annulus: NDArray[np.intp]
    share: Array
    width: Array

    @classmethod
    def of(cls, annuli: Annuli, edge: float, nodes: Array) -> LoadBetween | None:
        """Nodes around places where they are closer than their distance from the edge asks for."""
        count = int(nodes.searchsorted(edge))
        radius = nodes[:count]
        high = np.minimum(np.append(0.5 * (nodes[1:] + nodes[:-1]), edge)[:count], edge)
        low = np.append(radius[:1], high[:-1])
        apart = (high - low) / (NODES_APART * (edge - radius))
        apart[:1] *= 2.0  # nothing on the other side of the axis
        if apart.min(initial=_EVEN) >= _EVEN:
            return None
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


@dataclass(frozen=True)
class ContactSurface:
    """Contact of radius ``edge`` under scaled pressures.

    Attributes
    ----------
    scaled : ndarray (M,)
        Pressure times ``edge`` on each annulus, the punches included; ``rest`` (M,) without them.
    kinks : Kinks or None
        Former edges whose punches are subtracted before the annuli carry the rest.
    strengths : ndarray (k,)
        Their displacements.
    density : ndarray (M,)
        Scaled pressure of the rest times ``sqrt(1 - (r/a)^2)``, smooth up to the edge.
    kappa : float
        ``pi`` times the density at the edge; ``K_I = -kappa/sqrt(pi a)`` (tension opens).
    field : ndarray (4, M)
        Outer displacement of the rest without its punch part (``Annuli.outside_field``).
    force : float
        Compressive force.
    smooth : SmoothPart
        What the body lacks of the half-space's compliance, and ``moments`` (K,) of the pressure in it.
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
    kinks: EdgeKinks | None = None
    strengths: Array | None = None

    @classmethod
    def under(
        cls,
        annuli: Annuli,
        edge: float,
        load: Array,
        kinks: EdgeKinks | None = None,
        between: LoadBetween | None = None,
        body: Compliance = HALF_SPACE,
    ) -> ContactSurface:
        """The surface under a required displacement: on the half-space that and what the body lacks."""
        smooth = body.within(edge)
        response = smooth.response(annuli, edge)
        load, read = load[: annuli.count], load[annuli.count :]
        if kinks is None:
            load = load if between is None else between.added(load, read)
            scaled = rest = annuli.solve(load)
            strengths, carried, moments = None, 0.0, rest @ response.weights
        else:
            read, at_nodes = np.split(read, [3 * len(kinks.radius)])
            strengths = kinks.strengths(read)
            punches = kinks.displacement(edge * annuli.radii) @ strengths
            load = load - punches
            if between is not None:
                load = between.added(load, at_nodes - kinks.displacement(between.radius) @ strengths)
            scaled, rest = annuli.solve(np.array((load + punches, load)).T).T
            carried = 2.0 * float(kinks.radius @ strengths)
            volumes = strengths @ kinks.volumes(edge * annuli.borders).T / (2.0 * np.pi * edge)
            moments = rest @ response.weights + volumes @ response.pressures
        moments = response.inverse @ moments
        added = response.pressures @ moments
        curvature = annuli.curvature(rest) + float(response.curvatures @ moments)
        scaled, rest = scaled + added, rest + added
        density = annuli.density(rest, curvature)
        kappa = annuli.edge_strength(density)
        field = annuli.outside_field(rest, kappa, curvature)
        force = edge * annuli.force(rest, kappa, curvature) + carried
        of_annuli = annuli, edge, scaled, rest, density, kappa, field, force
        return cls(*of_annuli, smooth, moments, kinks, strengths)

    def towards(self, other: ContactSurface, share: float) -> ContactSurface:
        """The surface a share of the way to another with the same edge and kinks; all is linear in ``v``."""
        names = ("scaled", "rest", "density", "kappa", "field", "force", "moments")
        mixed = {n: getattr(self, n) + share * (getattr(other, n) - getattr(self, n)) for n in names}
        if self.strengths is not None and other.strengths is not None:
            mixed["strengths"] = self.strengths + share * (other.strengths - self.strengths)
        return replace(self, **mixed)

    @classmethod
    def free(cls, annuli: Annuli) -> ContactSurface:
        """No contact."""
        zero = np.zeros(annuli.count)
        none = HALF_SPACE.within(0.0)
        field, moments = np.zeros((4, annuli.count)), np.zeros(none.rank)
        return cls(annuli, 0.0, zero, zero, zero, 0.0, field, 0.0, none, moments)

    def tension(self, distance: Array) -> Array:
        """Normal stress (tension positive) at ``distance`` inside the edge, singular there; without kinks."""
        return self._tension(self.density, distance)

    def singular_tension(self, distance: Array) -> Array:
        """Its part with the density at the edge."""
        return self._tension(np.full_like(self.density, self.kappa / np.pi), distance)

    def _tension(self, density: Array, distance: Array) -> Array:
        cosine = np.sqrt(distance * (2.0 * self.edge - distance)) / self.edge
        return -even_cubic(density, self.annuli.position_at(distance, self.edge)) / (cosine * self.edge)

    def pressure(self, radius: Array) -> Array:
        """Pressure at radii < edge, kinks as the annuli see them; zero outside."""
        inside = radius < self.edge
        value = np.zeros(len(radius))
        if inside.any():
            density = self.density
            if self.kinks is not None:
                density = self.annuli.density(self.scaled, self.annuli.curvature(self.scaled))
            value[inside] = -self._tension(density, self.edge - radius[inside])
        return value

    def outside(self, radius: Array) -> Array:
        """Displacement ``v`` at unit plane modulus, radii >= edge."""
        if self.edge == 0.0:
            return np.zeros(len(radius))
        value = self.annuli.outside(self.field, self.kappa, radius / self.edge)
        if self.kinks is not None and self.strengths is not None:
            value = value + self.kinks.displacement(radius) @ self.strengths
        return self.smooth.taken_from(value, radius, self.moments)

    def work_on(self, displacement: Array) -> Array:
        """``int p g`` (n,) over the contact, of fields g (M + 3 k, n) at the radii and readings of kinks.

        The punches are taken out of both: what one does on the rest of g is, the operator being symmetric,
        what the pressure under that rest does on the punch's displacement.
        """
        annuli, kinks, strengths = self.annuli, self.kinks, self.strengths
        if kinks is None or strengths is None:
            return self.edge * annuli.work(self.scaled, displacement)
        at, roots = displacement[: annuli.count], kinks.strengths(displacement[annuli.count :])
        rest = at - kinks.displacement(self.edge * annuli.radii) @ roots
        return self._work_on_parts(kinks, strengths, rest, annuli.solve(rest), roots)

    @property
    def load_work(self) -> float:
        """``int p v`` over the contact."""
        annuli, kinks, strengths = self.annuli, self.kinks, self.strengths
        lacking = 2.0 * np.pi * float(self.moments @ self.moments)
        if kinks is None or strengths is None:
            return float(self.edge * annuli.work(self.scaled, annuli.matrix @ self.scaled)) - lacking
        given = annuli.matrix @ self.rest, self.rest
        return float(self._work_on_parts(kinks, strengths, *given, strengths)) - lacking

    def _work_on_parts(
        self, kinks: EdgeKinks, strengths: Array, rest: Array, scaled: Array, roots: Array
    ) -> Array:
        """``int p g``: rest of g (M, ...), scaled pressure (M, ...) that makes it, and punches (k, ...)."""
        volumes = kinks.volumes(self.edge * self.annuli.borders).T / self.edge
        work = self.edge * self.annuli.work(self.rest, rest) + strengths @ (volumes @ scaled)
        return work + (volumes @ self.rest + strengths @ kinks.works) @ roots

    @cached_property
    def edge_load(self) -> float:
        """``v`` at the edge."""
        if self.edge == 0.0:
            return 0.0
        load = self.annuli.at_edge(self.field, self.kappa)
        if self.kinks is not None and self.strengths is not None:
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
    def singular_force(self) -> float:
        """Force of the flat punch, as large as the contact, that leaves the same edge singularity."""
        return 2.0 * self.edge * self.kappa

    @property
    def stress_intensity(self) -> float:
        """``K_I``, positive in tension; zero without contact."""
        return -self.kappa / float(np.sqrt(np.pi * self.edge)) if self.edge > 0 else 0.0
