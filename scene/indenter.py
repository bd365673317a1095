"""Rigid axisymmetric indenters ``f(r)``, heights above the lowest point; ``f(0) = 0``, never falling with r.

The surface of the indenter at penetration ``D`` sits at ``D - f(r)`` *below* the undeformed half-space
(``D`` positive downwards). Contact beyond ``edge`` is impossible (flat punch); the gap next to such an edge
is measured from the continued profile. Lengths in the scene's unit.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import ClassVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from scene.errors import SceneError, number, positive

Array = NDArray[np.float64]


class Indenter:
    """What every profile offers: ``height``, ``slope`` and ``edge``."""

    shape: ClassVar[str]

    @property
    def edge(self) -> float:
        """Largest possible contact radius; infinite for smooth profiles."""
        return math.inf

    def height(self, radius: ArrayLike) -> Array:
        """``f(r)`` for ``radius >= 0``; same shape as ``radius``."""
        raise AssertionError("defined by every shape")

    def slope(self, radius: ArrayLike) -> Array:
        """``f'(r)``; same shape as ``radius``."""
        raise AssertionError("defined by every shape")


@dataclass(frozen=True)
class Sphere(Indenter):
    """Paraboloid ``f = r^2/(2 R)``, the paper's sphere."""

    radius: float
    shape: ClassVar[str] = "sphere"

    def __post_init__(self) -> None:
        object.__setattr__(self, "radius", positive(self.radius, "radius"))

    def height(self, radius: ArrayLike) -> Array:
        return np.asarray(radius, float) ** 2 / (2.0 * self.radius)

    def slope(self, radius: ArrayLike) -> Array:
        return np.asarray(radius, float) / self.radius


@dataclass(frozen=True)
class Cone(Indenter):
    """Cone ``f = r cot(alpha)`` with semi-apical angle ``alpha`` (``half_angle``, degrees)."""

    half_angle: float
    shape: ClassVar[str] = "cone"

    def __post_init__(self) -> None:
        angle = number(
            self.half_angle,
            "half_angle",
            "degrees, 0 < half_angle < 90",
            low=0.0,
            high=90.0,
            open_low=True,
            open_high=True,
        )
        object.__setattr__(self, "half_angle", angle)

    @property
    def cotangent(self) -> float:
        """``cot(alpha)``, the slope of the flank."""
        return math.tan(math.radians(90.0 - self.half_angle))

    def height(self, radius: ArrayLike) -> Array:
        return np.asarray(radius, float) * self.cotangent

    def slope(self, radius: ArrayLike) -> Array:
        return np.full_like(np.asarray(radius, float), self.cotangent)


@dataclass(frozen=True)
class FlatPunch(Indenter):
    """Flat-ended cylinder of the given radius: ``f = 0``, contact never beyond ``radius``."""

    radius: float
    shape: ClassVar[str] = "flat-punch"

    def __post_init__(self) -> None:
        object.__setattr__(self, "radius", positive(self.radius, "radius"))

    @property
    def edge(self) -> float:
        return self.radius

    def height(self, radius: ArrayLike) -> Array:
        return np.zeros_like(np.asarray(radius, float))

    def slope(self, radius: ArrayLike) -> Array:
        return np.zeros_like(np.asarray(radius, float))


@dataclass(frozen=True)
class PowerLaw(Indenter):
    """``f = coefficient * r^exponent``, exponent >= 1."""

    exponent: float
    coefficient: float
    shape: ClassVar[str] = "power-law"

    def __post_init__(self) -> None:
        exponent = number(self.exponent, "exponent", "1 <= exponent <= 100", low=1.0, high=100.0)
        object.__setattr__(self, "exponent", exponent)
        object.__setattr__(self, "coefficient", positive(self.coefficient, "coefficient"))

    def height(self, radius: ArrayLike) -> Array:
        return self.coefficient * np.asarray(radius, float) ** self.exponent

    def slope(self, radius: ArrayLike) -> Array:
        return self.coefficient * self.exponent * np.asarray(radius, float) ** (self.exponent - 1.0)


@dataclass(frozen=True)
class Profile(Indenter):
    """Tabulated profile: monotone cubic (Fritsch-Carlson) through the points, straight beyond the last.

    Parameters
    ----------
    radii, heights : tuple of float, length >= 3
        Radii rise from 0; heights never fall, and start from 0.
    file : str
        Where the table came from; kept for writing the scene back.
    """

    radii: tuple[float, ...]
    heights: tuple[float, ...]
    file: str = ""
    shape: ClassVar[str] = "profile"
    _curve: object = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        from scipy.interpolate import PchipInterpolator

        radii = tuple(number(r, "radius", "finite radii >= 0", low=0.0) for r in self.radii)
        heights = tuple(number(h, "height", "finite heights") for h in self.heights)
        if len(radii) != len(heights):
            raise SceneError(
                "file", f"{len(radii)} radii but {len(heights)} heights", "one height for each radius"
            )
        if len(radii) < 3:
            raise SceneError("file", f"got {len(radii)} points", "at least 3 points")
        if radii[0] != 0.0:
            raise SceneError("file", f"first radius is {radii[0]:g}", "radii that start at 0")
        if np.any(np.diff(radii) <= 0):
            raise SceneError("file", "radii do not rise", "strictly rising radii")
        heights = tuple(h - heights[0] for h in heights)
        if np.any(np.diff(heights) < 0):
            raise SceneError("file", "heights fall with radius", "heights that never fall (a convex-ish tip)")
        if heights[-1] <= 0.0:
            raise SceneError("file", "the profile is flat", 'shape = "flat-punch" for a flat profile')
        object.__setattr__(self, "radii", radii)
        object.__setattr__(self, "heights", heights)
        object.__setattr__(self, "_curve", PchipInterpolator(radii, heights))

    def height(self, radius: ArrayLike) -> Array:
        r = np.asarray(radius, float)
        last = self.radii[-1]
        inside = self._curve(np.minimum(r, last))  # type: ignore[operator]
        return inside + np.maximum(r - last, 0.0) * float(self.slope(last))

    def slope(self, radius: ArrayLike) -> Array:
        r = np.asarray(radius, float)
        return np.asarray(self._curve(np.minimum(r, self.radii[-1]), 1))  # type: ignore[operator]
