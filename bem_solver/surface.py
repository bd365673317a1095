"""The surface at one instant: pressure inside a given contact edge, displacement around it.

Lengths in scene units; ``scaled`` pressure is pressure times contact radius at unit plane modulus, which is
what one solve on the unit annuli gives. Signs: see ``kernel``.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from bem_solver.annuli import Annuli
from bem_solver.between_annuli import LoadBetween
from bem_solver.cubic_interpolation import even_cubic
from bem_solver.kinks import EdgeKinks

Array = NDArray[np.float64]


@dataclass(frozen=True)
class ContactSurface:
    """Contact of radius ``edge`` under scaled pressures.

    Attributes
    ----------
    scaled : ndarray (M,)
        Pressure times ``edge`` on each annulus, the punches included.
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
    """

    annuli: Annuli
    edge: float
    scaled: Array
    density: Array
    kappa: float
    field: Array
    force: float
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
    ) -> ContactSurface:
        """The surface under a required displacement.

        Parameters
        ----------
        annuli : Annuli
        edge : float
        load : ndarray (M + 3 k + m,)
            ``v`` at the collocation radii, then at the readings of the kinks and at the nodes between.
        kinks : EdgeKinks, optional
        between : LoadBetween, optional

        Returns
        -------
        ContactSurface
        """
        load, read = load[: annuli.count], load[annuli.count :]
        if kinks is None:
            load = load if between is None else between.added(load, read)
            scaled = rest = annuli.solve(load)
            strengths, carried = None, 0.0
        else:
            read, at_nodes = np.split(read, [3 * len(kinks.radius)])
            strengths = kinks.strengths(read)
            punches = kinks.displacement(edge * annuli.radii) @ strengths
            load = load - punches
            if between is not None:
                load = between.added(load, at_nodes - kinks.displacement(between.radius) @ strengths)
            scaled, rest = annuli.solve(np.array((load + punches, load)).T).T
            carried = 2.0 * float(kinks.radius @ strengths)
        curvature = annuli.curvature(rest)
        density = annuli.density(rest, curvature)
        kappa = annuli.edge_strength(density)
        field = annuli.outside_field(rest, kappa, curvature)
        force = edge * annuli.force(rest, kappa, curvature) + carried
        return cls(annuli, edge, scaled, density, kappa, field, force, kinks, strengths)

    def towards(self, other: ContactSurface, share: float) -> ContactSurface:
        """The surface a share of the way to another with the same edge and kinks; all is linear in ``v``."""
        names = ("scaled", "density", "kappa", "field", "force")
        mixed = {n: getattr(self, n) + share * (getattr(other, n) - getattr(self, n)) for n in names}
        if self.strengths is not None and other.strengths is not None:
            mixed["strengths"] = self.strengths + share * (other.strengths - self.strengths)
        return replace(self, **mixed)

    @classmethod
    def free(cls, annuli: Annuli) -> ContactSurface:
        """No contact."""
        zero = np.zeros(annuli.count)
        return cls(annuli, 0.0, zero, zero, 0.0, np.zeros((4, annuli.count)), 0.0)

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
        return value

    def work_on(self, displacement: Array) -> Array:
        """``int p g`` over the contact.

        Parameters
        ----------
        displacement : ndarray (M + 3 k, n)
            Fields g at the collocation radii, then at the readings of the kinks.

        Returns
        -------
        ndarray (n,)

        Notes
        -----
        No annuli resolve the root of g at a kink, let alone the inverse root of p: their punches are taken
        out of both. What a punch does on the rest of g is, the operator being symmetric, what the pressure
        under that rest does on the punch's displacement, and that on an annulus is known.
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
        if kinks is None or strengths is None:
            return float(self.edge * annuli.work(self.scaled, annuli.matrix @ self.scaled))
        rest = annuli.pressure(self.density)
        return float(self._work_on_parts(kinks, strengths, annuli.matrix @ rest, rest, strengths))

    def _work_on_parts(
        self, kinks: EdgeKinks, strengths: Array, rest: Array, scaled: Array, roots: Array
    ) -> Array:
        """``int p g``: rest of g (M, ...), scaled pressure (M, ...) that makes it, and punches (k, ...)."""
        annuli, smooth = self.annuli, self.annuli.pressure(self.density)
        volumes = kinks.volumes(self.edge * annuli.borders).T / self.edge
        work = self.edge * annuli.work(smooth, rest) + strengths @ (volumes @ scaled)
        return work + (volumes @ smooth + strengths @ kinks.works) @ roots

    @cached_property
    def edge_load(self) -> float:
        """``v`` at the edge."""
        if self.edge == 0.0:
            return 0.0
        load = self.annuli.at_edge(self.field, self.kappa)
        if self.kinks is not None and self.strengths is not None:
            load += float(self.kinks.displacement(np.array([self.edge]))[0] @ self.strengths)
        return load

    def load_ahead(self, distance: float) -> float:
        """``v`` at a distance >= 0 outside the edge."""
        if distance == 0.0:
            return self.edge_load
        return float(self.outside(np.array([self.edge + distance]))[0])

    def root_strength(self, reach: float) -> float:
        """B in ``v = v(a) - B sqrt(x) - C x`` at distance x outside the edge.

        Read at ``reach`` and a quarter of it.

        Where the stress behind the edge relaxes over less than ``reach``, this is the strength seen from
        there, not the one at the very tip.
        """
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
