"""Rigid axisymmetric indenters ``f(r)``, heights above the lowest point; ``f(0) = 0``, never falling with r.

The surface of the indenter at penetration ``D`` sits at ``D - f(r)`` *below* the undeformed half-space
(``D`` positive downwards). Contact beyond ``edge`` is impossible (flat punch); the gap next to such an edge
is measured from the continued profile. Lengths in the scene's unit.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from itertools import pairwise
from typing import Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from contact_scene.errors import SceneError
from contact_scene.value_checks import (
    A_COLUMN,
    NOT_NEGATIVE,
    SMALLEST,
    a_string,
    as_tuple,
    finite,
    number,
    positive,
)

PROFILE_COLUMNS = ("radius", "height")
"""Columns of a file of a tabulated profile."""

Array = NDArray[np.float64]


class Indenter:
    """A shape; each defines ``height`` and ``slope``, ``edge`` where it ends, ``plane_tip`` if it has one."""

    shape: ClassVar[str]

    @property
    def edge(self) -> float:
        """Largest possible contact radius; infinite for smooth profiles."""
        return math.inf

    @property
    def plane_tip(self) -> float:
        """Radius of a plane tip, which without adhesion touches, and is let go, as a whole; 0 without one."""
        return 0.0

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
            "degrees, 1e-6 <= half_angle < 90",
            low=1e-6,
            high=90.0,
            open_high=True,
        )
        object.__setattr__(self, "half_angle", angle)

    @property
    def cotangent(self) -> float:
        """``cot(alpha)``, the slope of the flank."""
        if self.half_angle > 45.0:  # the complement is exact here, and rounded for sharp cones
            return math.tan(math.radians(90.0 - self.half_angle))
        return 1.0 / math.tan(math.radians(self.half_angle))

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

    @property
    def plane_tip(self) -> float:
        return self.radius

    def height(self, radius: ArrayLike) -> Array:
        return np.zeros_like(np.asarray(radius, float))

    def slope(self, radius: ArrayLike) -> Array:
        return np.zeros_like(np.asarray(radius, float))


@dataclass(frozen=True)
class PowerLaw(Indenter):
    """``f = coefficient * r^exponent``, exponent >= 1 (infinite where the power overflows)."""

    exponent: float
    coefficient: float
    shape: ClassVar[str] = "power-law"

    def __post_init__(self) -> None:
        exponent = number(self.exponent, "exponent", "1 <= exponent <= 100", low=1.0, high=100.0)
        object.__setattr__(self, "exponent", exponent)
        # The unit of the coefficient is length^(1 - exponent), so its range is wider than that of a length.
        coefficient = number(
            self.coefficient,
            "coefficient",
            "a finite number > 0, from 1e-300 to 1e300",
            low=1e-300,
            high=1e300,
        )
        object.__setattr__(self, "coefficient", coefficient)

    def height(self, radius: ArrayLike) -> Array:
        with np.errstate(over="ignore"):
            return self.coefficient * np.asarray(radius, float) ** self.exponent

    def slope(self, radius: ArrayLike) -> Array:
        with np.errstate(over="ignore"):
            return self.coefficient * self.exponent * np.asarray(radius, float) ** (self.exponent - 1.0)


@dataclass(frozen=True)
class TabulatedProfile(Indenter):
    """Tabulated profile: monotone cubic through the points, straight beyond the last.

    Parameters
    ----------
    radii, heights : tuple of float, length >= 3
        Radii rise from 0; heights never fall. The height at the axis is subtracted from all.
    file : str
        Where the table came from; no part of the comparison of two profiles.

    Notes
    -----
    The curve has a continuous slope, passes through every point and never falls between two.
    Scatter in a measured table counts as the real shape as long as the heights do not fall. Where they do,
    however little, the table is refused with the row: such an indenter may touch in a ring, which a contact
    area that is a full disc cannot represent, and smoothing would change the shape.
    """

    radii: tuple[float, ...]
    heights: tuple[float, ...]
    file: str = field(default="", compare=False)
    shape: ClassVar[str] = "profile"
    _curve: Any = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        a_string(self.file, "file")
        radii, heights = _checked_profile(self.radii, self.heights)
        object.__setattr__(self, "radii", radii)
        object.__setattr__(self, "heights", heights)
        object.__setattr__(self, "_curve", _monotone_curve(radii, heights))

    @property
    def plane_tip(self) -> float:
        return self.radii[self.heights.count(0.0) - 1]

    def height(self, radius: ArrayLike) -> Array:
        r = np.asarray(radius, float)
        last = self.radii[-1]
        return self._curve(np.minimum(r, last)) + np.maximum(r - last, 0.0) * float(self.slope(last))

    def slope(self, radius: ArrayLike) -> Array:
        return np.asarray(self._curve(np.minimum(np.asarray(radius, float), self.radii[-1]), 1))


def _checked_profile(
    radii: Sequence[float], heights: Sequence[float]
) -> tuple[tuple[float, ...], tuple[float, ...]]:
    """The table as floats, its first height subtracted, or the first thing that is wrong with it."""
    given = as_tuple(radii, "radius", A_COLUMN), as_tuple(heights, "height", A_COLUMN)
    r = tuple(number(x, f"radius, row {row}", NOT_NEGATIVE, low=0.0) for row, x in enumerate(given[0], 1))
    h = tuple(finite(x, f"height, row {row}") for row, x in enumerate(given[1], 1))
    if len(r) != len(h):
        raise SceneError("height", f"{len(r)} radii but {len(h)} heights", "one height for each radius")
    if len(r) < 3:
        raise SceneError("radius", f"got {len(r)} points", "at least 3 points of radius, height")
    if r[0] != 0.0 or r[1] < SMALLEST:
        raise SceneError("radius", f"starts with {r[0]:g}, {r[1]:g}", f"0, then at least {SMALLEST:g}")
    for row, (before, after) in enumerate(pairwise(r), 2):
        if after <= before:
            raise SceneError(
                f"radius, row {row}", f"does not rise ({before:g} -> {after:g})", "strictly rising radii"
            )
    for row, (before, after) in enumerate(pairwise(h), 2):
        if after < before:
            raise SceneError(
                f"height, row {row}",
                f"falls by {before - after:.3g} ({before:g} -> {after:g})",
                "heights that never fall with radius; smooth a noisy table first",
            )
    if h[-1] <= h[0]:
        raise SceneError("height", "the profile is flat", 'shape = "flat-punch" for a flat profile')
    return r, tuple(x - h[0] for x in h)


def _monotone_curve(radii: tuple[float, ...], heights: tuple[float, ...]) -> Any:
    """Cubic Hermite curve with three-point slopes, limited to three times the smaller neighbouring secant.

    The limit keeps the curve monotone (Fritsch and Carlson, SIAM J. Numer. Anal. 17, 1980); where it does not
    act, paraboloids and cones are reproduced exactly, the axis included.
    """
    from scipy.interpolate import CubicHermiteSpline

    secants = np.diff(heights) / np.diff(radii)
    limit = 3.0 * np.minimum(np.append(secants[0], secants), np.append(secants, secants[-1]))
    slopes = np.clip(np.gradient(heights, radii, edge_order=2), 0.0, limit)
    curve = CubicHermiteSpline(radii, heights, slopes)
    if not np.isfinite(curve.c).all():
        raise SceneError("height", "slopes leave the range of floats", "points that are further apart")
    return curve
