"""Families of meshes for convergence studies; each step changes declared numbers and nothing else."""

from __future__ import annotations

from dataclasses import replace

from meshes.parameters import MeshParameters, scaled


def ladder(parameters: MeshParameters, levels: int = 3, ratio: float = 2.0) -> tuple[MeshParameters, ...]:
    """Refine uniformly: every element size, near and far, is divided by ``ratio`` from level to level.

    Both ``fine_size`` and ``grading`` shrink, so the error of the coarse far region shrinks as well and an
    order of convergence can be read off. The first level is ``parameters``; with a whole ``ratio`` the
    vertices of the strip are vertices of the next level too.
    """
    _check(levels, ratio)
    return tuple(scaled(parameters, ratio**-level) for level in range(levels))


def domain_ladder(
    parameters: MeshParameters, levels: int = 3, ratio: float = 2.0
) -> tuple[MeshParameters, ...]:
    """Enlarge the domain radius by ``ratio`` from level to level; the element sizes stay as they are."""
    _check(levels, ratio)
    return tuple(
        replace(parameters, domain_radius=parameters.domain_radius * ratio**level) for level in range(levels)
    )


def _check(levels: int, ratio: float) -> None:
    if isinstance(levels, bool) or levels != int(levels) or levels < 1:
        raise ValueError(f"levels = {levels!r}: must be a whole number >= 1")
    if not 1.0 < ratio < float("inf"):
        raise ValueError(f"ratio = {ratio!r}: must be a number > 1")
