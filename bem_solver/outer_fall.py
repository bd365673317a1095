"""Fall of the load ``v`` with the distance outside the edge, as a moving edge carries it along.

``v(a) - v(a + x) = B(x) sqrt(x)``. At the very tip B is that of the stress intensity factor; where the stress
behind an advancing edge relaxes within a layer, B changes over distances of its thickness. Tabulated over
the logarithm of the distance, from far below the process zone to far beyond the contact.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from bem_solver.surface import ContactSurface

Array = NDArray[np.float64]

_NEAREST, _FARTHEST = 1e-3, 1e4
"""Distances, in process zones and contact radii, between which B varies: it is constant nearer, and the load
has ended farther out."""
_PER_DECADE = 32
"""Entries per decade of distance: straight lines miss B by less than a thousandth of its bend."""


@dataclass(frozen=True)
class OuterFall:
    """B at both ends of a step, ``start`` and ``end`` (n,); distances grow by ``ratio`` from ``near``.

    In between it is linear in time; with the fall of the start alone the residual of a long step of an
    advancing edge has a second, false root.
    """

    near: float
    ratio: float
    start: Array
    end: Array

    @classmethod
    def outside(cls, surface: ContactSurface, zone: float) -> OuterFall:
        """The fall outside a contact of some radius > 0, the same at both ends."""
        near, far = _NEAREST * zone, _FARTHEST * surface.edge
        count = int(_PER_DECADE * np.log10(far / near))
        fall = cls(near, (far / near) ** (1.0 / count), np.empty(count), np.empty(count))
        strength = fall._strength(surface)
        return replace(fall, start=strength, end=strength)

    def towards(self, surface: ContactSurface) -> OuterFall:
        """The same start, and the fall outside another contact at the end."""
        return replace(self, end=self._strength(surface))

    def _strength(self, surface: ContactSurface) -> Array:
        distance = self.near * self.ratio ** np.arange(len(self.start))
        load = surface.outside(np.append(surface.edge, surface.edge + distance))
        return (load[0] - load[1:]) / np.sqrt(distance)

    def __call__(self, distance: Array, share: Array) -> Array:
        """``v(a) - v(a + x)`` at distances >= 0, after shares of the step; arguments broadcast."""
        position = np.log(np.maximum(distance, self.near) / self.near) / np.log(self.ratio)
        position = np.minimum(position, len(self.start) - 1.001)
        first = position.astype(int)
        part, last = position - first, first + 1
        start = (1.0 - part) * self.start[first] + part * self.start[last]
        end = (1.0 - part) * self.end[first] + part * self.end[last]
        return (start + share * (end - start)) * np.sqrt(distance)
