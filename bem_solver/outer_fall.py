"""Fall of the load ``v`` with the distance outside the edge, as a moving edge carries it along.

``v(a) - v(a + x) = B(x) sqrt(x)``. At the very tip B is that of the stress intensity factor; where the stress
behind an advancing edge relaxes within a layer, B changes over distances of its thickness. Tabulated over
the logarithm of the distance, from far below the process zone to far beyond the contact.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from bem_solver.cubic_interpolation import cubic_weights
from bem_solver.surface import ContactSurface

Array = NDArray[np.float64]

_FARTHEST = 1e4
"""Distance, in contact radii, at which the load has ended."""
_PER_DECADE = 32
"""Readings per decade of distance: cubics miss B by less than a millionth of its fourth derivative over the
logarithm of the distance."""
_ENTRIES = 4
"""Entries of the table per reading, from the cubics: straight lines between them miss B by 4e-5 of its bend
(by sixteen times that between readings alone). The closure of a fast edge hardly depends on its speed; what
the table misses, unevenly from step to step, is then an uneven speed, and short steps are no more even."""
_CUBIC = cubic_weights(1.0 + np.arange(_ENTRIES) / _ENTRIES)
"""Weights (4, entries) of the readings around an interval of them."""


def distances_outside(edge: float, nearest: float) -> Array:
    """Distances (n,) outside a contact of some radius > 0 at which B is tabulated."""
    far = _FARTHEST * edge
    count = int(_PER_DECADE * np.log10(far / nearest))
    return nearest * (far / nearest) ** (np.arange(count) / count)


@dataclass(frozen=True)
class OuterFall:
    """B at both ends of a step, ``start`` and ``end`` (n,), at ``distance`` (n,) in equal ratios.

    In between it is linear in time; with the fall of the start alone the residual of a long step of an
    advancing edge has a second, false root. ``entries`` are those of the table at the start.
    """

    distance: Array
    start: Array
    end: Array
    entries: Array

    @classmethod
    def between(cls, distance: Array, start: Array, end: Array) -> OuterFall:
        """The fall of given readings.

        Parameters
        ----------
        distance : ndarray (n,)
            In equal ratios.
        start, end : ndarray (n,)
            B there, at both ends of the step.

        Returns
        -------
        OuterFall
        """
        return cls(distance, start, end, _entries(start))

    @classmethod
    def outside(cls, surface: ContactSurface, nearest: float) -> OuterFall:
        """The fall outside a contact of some radius > 0, the same at both ends."""
        distance = distances_outside(surface.edge, nearest)
        strength = _strength(surface, distance)
        return cls.between(distance, strength, strength)

    def towards(self, surface: ContactSurface) -> OuterFall:
        """The same start, and the fall outside another contact at the end."""
        return replace(self, end=_strength(surface, self.distance))

    @cached_property
    def _per_ratio(self) -> float:
        """Entries per unit of the logarithm of the distance."""
        return _ENTRIES * (len(self.distance) - 1) / math.log(self.distance[-1] / self.distance[0])

    @cached_property
    def _table(self) -> Array:
        """B at the start and to the next entry (2, entries); if it changes within the step, by how much."""
        rows = [self.entries] if self.end is self.start else [self.entries, _entries(self.end - self.start)]
        return np.array([part for row in rows for part in (row[:-1], row[1:] - row[:-1])])

    def __call__(self, distance: Array, share: Array) -> Array:
        """``v(a) - v(a + x)`` at distances >= 0, after shares of the step; arguments broadcast."""
        table = self._table
        position = np.maximum(distance, self.distance[0])
        position /= self.distance[0]
        np.log(position, out=position)
        position *= self._per_ratio
        first = position.astype(np.intp)
        np.minimum(first, table.shape[1] - 1, out=first)
        position -= first
        part = np.minimum(position, 1.0, out=position)
        # clipped: all indices are in range, and to check them takes three times as long
        strength, slope, *change = table.take(first, axis=1, mode="clip")
        slope *= part
        strength += slope
        if change:
            gained, its_slope = change
            its_slope *= part
            gained += its_slope
            gained *= share
            strength += gained
        strength *= np.sqrt(distance)
        return strength


def _entries(readings: Array) -> Array:
    """Values at the entries of the table, the last reading among them; B is constant beyond both ends."""
    padded = np.empty(len(readings) + 2)
    padded[0], padded[1:-1], padded[-1] = readings[0], readings, readings[-1]
    between = np.array((padded[:-3], padded[1:-2], padded[2:-1], padded[3:])).T @ _CUBIC
    entries = np.empty(between.size + 1)
    entries[:-1], entries[-1] = between.ravel(), readings[-1]
    return entries


def _strength(surface: ContactSurface, distance: Array) -> Array:
    radius = np.empty(len(distance) + 1)
    radius[0] = surface.edge
    np.add(distance, surface.edge, out=radius[1:])
    load = surface.outside(radius)
    return (load[0] - load[1:]) / np.sqrt(distance)
