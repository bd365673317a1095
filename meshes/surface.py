"""Radii of the surface vertices, shared by both mesh families so that they differ only below the surface."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from meshes.parameters import MeshParameters

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Layers:
    """The strip and the distances from it at which the mesh has its layers.

    ``strip`` are the equispaced radii; ``offsets`` start with 0 and end where the far boundary is;
    ``offsets[axis]`` equals the distance from the strip to the axis.
    """

    strip: Array
    offsets: Array
    axis: int


def graded(start: float, stop: float, size: float, grading: float) -> Array:
    """Divide [start, stop] into intervals of size about ``size + grading * (x - start)``.

    The number of intervals is ``int dx / size(x) = ln(1 + grading L / size) / grading``, rounded up; the
    vertices take equal shares of the integral, so that intervals grow by a constant ratio.
    """
    growth = 1.0 + grading * (stop - start) / size
    count = max(1, math.ceil(math.log(growth) / grading - 1e-9))
    points = start + size / grading * np.expm1(math.log(growth) * np.arange(count + 1) / count)
    points[-1] = stop
    return points


def layers(parameters: MeshParameters) -> Layers:
    """Lay out strip and offsets, with no interval shorter than half of ``fine_size`` before the strip."""
    size = parameters.fine_size
    start = parameters.fine_from if parameters.fine_from >= 0.5 * size else 0.0
    count = max(math.ceil((parameters.fine_to - start) / size - 1e-9), 1)
    strip: Array = start + size * np.arange(count + 1, dtype=np.float64)
    reach = parameters.domain_radius - strip[-1]
    if strip[0] == 0.0:
        return Layers(strip, graded(0.0, reach, size, parameters.grading), 0)
    inner = graded(0.0, strip[0], size, parameters.grading)
    outer = graded(strip[0], reach, parameters.size_at(strip[0]), parameters.grading)
    return Layers(strip, np.concatenate([inner, outer[1:]]), inner.size - 1)


def surface_radii(parameters: MeshParameters) -> Array:
    """All surface vertices from the axis to the far boundary."""
    plan = layers(parameters)
    inside = plan.strip[0] - plan.offsets[plan.axis : 0 : -1]
    if inside.size:
        inside[0] = 0.0
    outside = plan.strip[-1] + plan.offsets[1:]
    outside[-1] = parameters.domain_radius
    return np.concatenate([inside, plan.strip, outside])
