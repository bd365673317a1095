"""Square roots inside the contact, where an edge has rested before it advanced.

Beyond an edge at rest the surface opens as the root of the distance, relaxed. When the contact spreads over
it, the required ``v`` keeps that root inside the contact, driven by the glassy modulus, and the pressure an
inverse root inside the *old* edge. No annuli resolve the band between the two edges when it is narrow; but a
flat punch with the old edge has just this pressure, ``1/(pi sqrt(b^2 - r^2))`` within its radius b, under the
displacement 1 within and ``(2/pi) arcsin(b/r)`` beyond, at unit plane modulus. Taken out with the right
strength it leaves to the annuli what is smooth across b. Any strength is an exact superposition: a poor one
only leaves them a less smooth rest.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True)
class EdgeKinks:
    """Punches with edges at ``radius`` (k,), their roots read up to ``reach`` (k,) beyond."""

    radius: Array
    reach: Array

    @classmethod
    def within(cls, radii: tuple[float, ...], edge: float, reach: float) -> EdgeKinks | None:
        """Those of ``radii`` below ``edge``, each read up to the next, ``edge`` or ``reach``.

        Parameters
        ----------
        radii : tuple of float
            In any order, repeated or not.
        edge : float
            Contact radius.
        reach : float
            Largest distance beyond a kink up to which its root is read.

        Returns
        -------
        EdgeKinks or None
            ``None`` if there are none.
        """
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
        """Displacement of each punch (k, ...) from ``v`` (3 k, ...) at the readings.

        ``v = v(b) - B sqrt(x) - C x`` beyond each, and ``B = (2/pi) sqrt(2/b)`` for a punch of unit
        displacement.
        """
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

    Where an edge has rested, gap and tension outside and inside it begin with a root. The closure pairs the
    gap at one end of the process zone with the singular tension at the other, so what it takes of the root
    grows linearly from zero once the zone has left that place behind: the slope of the closure with the edge
    jumps there, and with it the speed of the edge.

    Parameters
    ----------
    kinks : tuple of float
        Radii at which an edge has rested.
    zone : float
        Length of the process zone.
    edge, new_edge : float
        Contact radius at the start and at the end of a step.
    accuracy : float
        Of the edge: so far behind it a radius is where it is.

    Returns
    -------
    float or None
        ``None`` if there is none between the two.
    """
    way = 1.0 if new_edge > edge else -1.0
    travels = [way * (kink + side * zone - edge) for kink in kinks for side in (-1.0, 1.0)]
    nearest = min((t for t in travels if -accuracy <= t < abs(new_edge - edge)), default=None)
    return None if nearest is None else edge + way * nearest
