"""Parameters of a half-space mesh, and their choice for a contact problem.

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
    extra_fine_radius : float, optional
        A radius on the strip, such as the edge of a flat punch, towards which elements shrink by halves.
        The strip's vertices are aligned with it.
    extra_fine_size : float, optional
        Size reached there (rounded down to ``fine_size / 2**n``); default ``fine_size / 64``.

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
    extra_fine_radius: float | None = None
    extra_fine_size: float | None = None

    def __post_init__(self) -> None:
        for name in ("fine_size", "fine_from", "fine_to", "domain_radius", "grading"):
            object.__setattr__(self, name, _finite(getattr(self, name), name))
        for name in ("extra_fine_radius", "extra_fine_size"):
            if getattr(self, name) is not None:
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
        if self.extra_fine_radius is None:
            if self.extra_fine_size is not None:
                raise ValueError("extra_fine_size: needs extra_fine_radius beside it")
            return
        inside = max(self.fine_from, self.fine_size) <= self.extra_fine_radius <= self.fine_to
        allowed = f"a radius on the fine strip, {self.fine_from:g} to {self.fine_to:g}, off the axis"
        _require(inside, "extra_fine_radius", self.extra_fine_radius, allowed)
        low = 1e-6 * self.fine_size
        size = self.fine_size / 64 if self.extra_fine_size is None else self.extra_fine_size
        object.__setattr__(self, "extra_fine_size", size)
        _require(
            low <= size <= self.fine_size,
            "extra_fine_size",
            size,
            f"a length in [{low:g}, {self.fine_size:g}]",
        )

    def size_at(self, distance: float) -> float:
        """Prescribed element size at a distance from the strip."""
        return self.fine_size + self.grading * distance


def fit(
    contact_from: float,
    contact_to: float,
    zone: float,
    divisions: int,
    *,
    margin: float = 2.0,
    domain_ratio: float = DOMAIN_RATIO,
    grading: float = 0.2,
    family: str = "gmsh",
    edge: float | None = None,
) -> MeshParameters:
    """Choose a mesh for a contact edge that travels between two radii.

    Parameters
    ----------
    contact_from, contact_to : float
        Smallest and largest contact radius of the run.
    zone : float
        Length to be resolved at the edge: the process zone or, without adhesion, a small part of the
        contact radius.
    divisions : int
        Elements per ``zone``; the strip lies on whole multiples of ``zone / divisions``, so that a vertex
        shifted by ``zone`` is a vertex again.
    margin : float
        Zones added to the strip beyond each end of the path; the closure looks one zone to either side.
    domain_ratio : float
        Radius of the domain over the largest contact radius.
    grading : float
        Growth of the element size per distance from the strip.
    family : {"gmsh", "structured"}
    edge : float, optional
        Radius of a sharp indenter edge; the mesh is graded towards it, and the strip reaches to it.

    Returns
    -------
    MeshParameters
    """
    start, stop = _finite(contact_from, "contact_from"), _finite(contact_to, "contact_to")
    length, ratio = _finite(zone, "zone"), _finite(domain_ratio, "domain_ratio")
    _require(start >= 0, "contact_from", start, "a radius >= 0")
    _require(stop >= start and stop > 0, "contact_to", stop, "a radius >= contact_from and > 0")
    _require(length > 0, "zone", length, "a length > 0")
    if isinstance(divisions, bool) or int(divisions) != divisions or divisions < 1:
        raise ValueError(f"divisions = {divisions!r}: must be a whole number >= 1")
    _require(_finite(margin, "margin") >= 0, "margin", margin, "a number >= 0")
    if edge is not None:
        start, stop = min(start, _finite(edge, "edge")), max(stop, edge)
    size = length / divisions
    anchor = 0.0 if edge is None else edge % size
    fine_from = anchor + size * math.floor((start - margin * length - anchor) / size + 1e-9)
    fine_to = anchor + size * math.ceil((stop + margin * length - anchor) / size - 1e-9)
    return MeshParameters(
        fine_size=size,
        fine_from=max(fine_from, 0.0),
        fine_to=max(fine_to, fine_from + size),
        domain_radius=max(ratio * stop, 8.0 * fine_to),
        grading=grading,
        family=family,
        extra_fine_radius=edge,
    )


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
