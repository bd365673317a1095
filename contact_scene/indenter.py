"""Rigid axisymmetric indenters ``f(r)``, heights above the lowest point; ``f(0) = 0``, never falling with r.

The surface of the indenter at penetration ``D`` sits at ``D - f(r)`` *below* the undeformed half-space
(``D`` positive downwards). Contact beyond ``edge`` is impossible (flat punch); the gap next to such an edge
is measured from the continued profile. Paraboloids, cones and flat faces are powers ``f = c r^p``. Lengths in
the scene's unit.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Annotated, Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from contact_scene.checked import Checked, Finite, Key, NotNegative, Positive, Tabulated
from contact_scene.errors import SceneError
from contact_scene.value_checks import SMALLEST, Range

Array = NDArray[np.float64]


class Indenter:
    """A shape: ``height`` and ``slope``, ``edge`` where it ends, ``plane_tip`` if it has one."""

    shape: ClassVar[str]
    tag = "shape"

    @property
    def edge(self) -> float:
        """Largest possible contact radius; infinite for smooth profiles."""
        return math.inf

    @property
    def plane_tip(self) -> float:
        """Radius of a plane tip, which without adhesion touches, and is let go, as a whole; 0 without one."""
        return 0.0

    @property
    def power(self) -> tuple[float, float] | None:
        """``p`` and ``c`` of a profile ``f = c r^p``; ``None`` of any other."""
        return None

    def height(self, radius: ArrayLike) -> Array:
        """``f(r)`` for ``radius >= 0``; same shape as ``radius``."""
        exponent, coefficient = self.power or (1.0, 0.0)
        with np.errstate(over="ignore"):
            return coefficient * np.asarray(radius, float) ** exponent

    def slope(self, radius: ArrayLike) -> Array:
        """``f'(r)``; same shape as ``radius``."""
        exponent, coefficient = self.power or (1.0, 0.0)
        with np.errstate(over="ignore"):
            return coefficient * exponent * np.asarray(radius, float) ** (exponent - 1.0)


@dataclass(frozen=True)
class Sphere(Indenter, Checked):
    """Paraboloid ``f = r^2/(2 R)``, the paper's sphere.

    Examples
    --------
    >>> float(cc.Sphere(radius=1e-3).height(1e-4))
    5e-06
    """

    radius: Annotated[Positive, Key("radius R of the sphere", "length")]
    shape: ClassVar[str] = "sphere"

    @property
    def power(self) -> tuple[float, float]:
        return 2.0, 0.5 / self.radius


@dataclass(frozen=True)
class Cone(Indenter, Checked):
    """Cone ``f = r cot(alpha)`` with semi-apical angle ``alpha`` (``half_angle``, degrees).

    Examples
    --------
    >>> f"{float(cc.Cone(half_angle=45.0).height(1e-4)):.3e}"
    '1.000e-04'
    """

    half_angle: Annotated[
        float,
        Range("degrees, 1e-6 <= half_angle < 90", 1e-6, math.nextafter(90.0, 0.0)),
        Key("angle between axis and flank", "degree"),
    ]
    shape: ClassVar[str] = "cone"

    @property
    def cotangent(self) -> float:
        """``cot(alpha)``, the slope of the flank."""
        if self.half_angle > 45.0:  # the complement is exact here, and rounded for sharp cones
            return math.tan(math.radians(90.0 - self.half_angle))
        return 1.0 / math.tan(math.radians(self.half_angle))

    @property
    def power(self) -> tuple[float, float]:
        return 1.0, self.cotangent


@dataclass(frozen=True)
class FlatPunch(Indenter, Checked):
    """Flat-ended cylinder of the given radius: ``f = 0``, contact never beyond ``radius``.

    Examples
    --------
    >>> cc.FlatPunch(radius=1e-3).edge
    0.001
    """

    radius: Annotated[Positive, Key("radius of the flat end", "length")]
    shape: ClassVar[str] = "flat-punch"

    @property
    def edge(self) -> float:
        return self.radius

    @property
    def plane_tip(self) -> float:
        return self.radius


@dataclass(frozen=True)
class PowerLaw(Indenter, Checked):
    """``f = coefficient * r^exponent``, exponent >= 1 (infinite where the power overflows).

    Examples
    --------
    >>> float(cc.PowerLaw(exponent=4.0, coefficient=0.5).height(2.0))
    8.0
    """

    exponent: Annotated[float, Range("1 <= exponent <= 100", 1.0, 100.0), Key("exponent of the radius", "1")]
    # The unit of the coefficient is length^(1 - exponent), so its range is wider than that of a length.
    coefficient: Annotated[
        float,
        Range("a finite number > 0, from 1e-300 to 1e300", 1e-300, 1e300),
        Key("height at unit radius", "length^(1 - exponent)"),
    ]
    shape: ClassVar[str] = "power-law"

    @property
    def power(self) -> tuple[float, float]:
        return self.exponent, self.coefficient


@dataclass(frozen=True)
class TabulatedProfile(Indenter, Tabulated):
    """Tabulated profile: monotone cubic through the points, straight beyond the last.

    The height at the axis is subtracted from all. The curve has a continuous slope, passes through every
    point and never falls between two. Scatter in a measured table counts as the real shape as long as the
    heights do not fall. Where they do, however little, the table is refused with the row: such an indenter
    may touch in a ring, which a contact area that is a full disc cannot represent, and smoothing would
    change the shape.

    Examples
    --------
    >>> tip = cc.TabulatedProfile((0.0, 1e-6, 2e-6), (0.0, 5e-8, 2e-7))
    >>> float(tip.height(1e-6))
    5e-08
    """

    radii: Annotated[tuple[NotNegative, ...], Key("radii, rising from 0", "length")]
    heights: Annotated[tuple[Finite, ...], Key("heights at these radii, never falling", "length")]
    file: Annotated[str, Key("CSV file of radius, height")] = field(default="", compare=False)
    shape: ClassVar[str] = "profile"
    columns = ("radius", "height")
    least_rows = 3
    never_falls = "heights that never fall with radius; smooth a noisy table first"
    _curve: Any = field(init=False, repr=False, compare=False)

    def rules(self) -> None:
        super().rules()
        r, h = self.radii, self.heights
        if r[0] != 0.0 or r[1] < SMALLEST:
            raise SceneError("radius", f"starts with {r[0]:g}, {r[1]:g}", f"0, then at least {SMALLEST:g}")
        if h[-1] <= h[0]:
            raise SceneError("height", "the profile is flat", 'shape = "flat-punch" for a flat profile')
        heights = tuple(x - h[0] for x in h)
        object.__setattr__(self, "heights", heights)
        object.__setattr__(self, "_curve", _monotone_curve(r, heights))

    @property
    def plane_tip(self) -> float:
        return self.radii[self.heights.count(0.0) - 1]

    def height(self, radius: ArrayLike) -> Array:
        r = np.asarray(radius, float)
        last = self.radii[-1]
        return self._curve(np.minimum(r, last)) + np.maximum(r - last, 0.0) * float(self.slope(last))

    def slope(self, radius: ArrayLike) -> Array:
        return np.asarray(self._curve(np.minimum(np.asarray(radius, float), self.radii[-1]), 1))


SHAPES = (Sphere, Cone, FlatPunch, PowerLaw, TabulatedProfile)
"""What a file may state as ``[indenter]``."""


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
