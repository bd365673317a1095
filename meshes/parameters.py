"""Parameters of a half-space mesh.

All lengths are in the caller's units. The prescribed element size grows linearly with the distance ``d`` from
the fine strip ``fine_from <= r <= fine_to`` of the surface: ``size = fine_size + grading * d``.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

FAMILIES = ("gmsh", "structured")
WIDEST = 0.5
"""Growth of the element size with the distance from the strip, at most."""
DOMAIN_RATIO = 400.0
"""Radius of the domain over the largest radius that is fine, where none is specified."""

MAX_STRIP_INTERVALS = 20_000
"""Intervals in the strip; more of them are a mistake in the input."""


@dataclass(frozen=True)
class MeshParameters:
    """Sizes, radii and family that determine a mesh.

    Parameters
    ----------
    fine_size : float
        Vertex spacing on the fine strip (quadratic elements put a node half-way as well).
    fine_from, fine_to : float
        Radii between which the surface is uniform; ``0 <= fine_from < fine_to``. The strip is rounded up to
        whole intervals.
    domain_radius : float
        Where the surface meets the far boundary; at least four times ``fine_to``.
    grading : float
        Growth of the element size per distance from the strip, in (0, 0.5].
    family : {"gmsh", "structured"}
        Which mesh generator; both give the same surface vertices.

    Raises
    ------
    ValueError
        When a number is outside its range.
    """

    fine_size: float
    fine_from: float
    fine_to: float
    domain_radius: float
    grading: float = 0.2
    family: str = "gmsh"

    def __post_init__(self) -> None:
        for name in ("fine_size", "fine_from", "fine_to", "domain_radius", "grading"):
            object.__setattr__(self, name, _finite(getattr(self, name), name))
        _require(self.fine_size > 0, "fine_size", self.fine_size, "a length > 0")
        _require(self.fine_from >= 0, "fine_from", self.fine_from, "a radius >= 0")
        _require(self.fine_to > self.fine_from, "fine_to", self.fine_to, f"a radius > {self.fine_from:g}")
        _require(0 < self.grading <= WIDEST, "grading", self.grading, f"a number in (0, {WIDEST:g}]")
        _require(self.family in FAMILIES, "family", self.family, " or ".join(map(repr, FAMILIES)))
        intervals = (self.fine_to - self.fine_from) / self.fine_size
        if intervals > MAX_STRIP_INTERVALS:
            raise ValueError(
                f"fine_size = {self.fine_size:g}: the strip from {self.fine_from:g} to {self.fine_to:g} "
                f"would need {intervals:.0f} intervals; at most {MAX_STRIP_INTERVALS} are allowed"
            )
        least = 4.0 * (self.fine_to + self.fine_size)
        _require(self.domain_radius >= least, "domain_radius", self.domain_radius, f"a radius >= {least:g}")

    def size_at(self, distance: float) -> float:
        """Prescribed element size at a distance from the strip."""
        return self.fine_size + self.grading * distance


def _finite(value: float, name: str) -> float:
    try:
        result = float(value)
    except (TypeError, ValueError):
        result = math.nan
    if not math.isfinite(result):
        raise ValueError(f"{name} = {value!r}: must be a finite number")
    return result


def _require(condition: bool, name: str, value: object, allowed: str) -> None:
    if not condition:
        raise ValueError(f"{name} = {value!r}: must be {allowed}")
