"""The mesh of a layer: a rectangle of unit depth, wide enough for rings up to a radius."""

import numpy as np
import pytest

from meshes import MeshParameters, layer, structured_layer
from meshes.layer import BEYOND, ROWS
from meshes.mesh import areas, boundary_edges
from meshes.surface import surface_radii


@pytest.mark.parametrize("reach", [1e-7, 0.3, 4.1])
def test_it_fills_the_rectangle_and_has_rings_up_to_the_reach(reach):
    made = layer(reach)
    covered = areas(made.points, made.triangles)
    width = made.points[0].max()
    assert covered.min() > 0.0
    assert covered.sum() == pytest.approx(width, rel=1e-12)
    assert made.points[1].min() == -1.0
    assert made.uniform[-1] >= reach + 0.25
    assert width == pytest.approx(made.uniform[-1] + BEYOND)
    assert np.isin(made.uniform, made.points[0, made.points[1] == 0.0]).all()
    assert boundary_edges(made.triangles).shape[1] == 2 * (ROWS + made.points.shape[1] // (ROWS + 1) - 1)


@pytest.mark.parametrize(
    ("strip", "thickness"),
    [((0.0, 25.0), 15.0), ((0.0, 25.0), 2e4), ((372.0, 396.0), 15.0), ((372.0, 396.0), 900.0)],
)
def test_below_a_surface_it_fills_the_rectangle_and_keeps_the_vertices(strip, thickness):
    parameters = MeshParameters(0.25, *strip, 1e4, 0.14)
    made = structured_layer(parameters, thickness)
    covered = areas(made.points, made.triangles)
    assert covered.sum() == pytest.approx(made.points[0].max() * thickness, rel=1e-12)
    on_top, expected = made.points[0, made.surface_nodes], surface_radii(parameters)
    assert np.array_equal(on_top[: len(expected) - 1], expected[:-1])
    corners = made.points[:, made.triangles]
    sides = np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=0)
    near = np.abs(corners[0] - strip[1]).max(axis=0) < 2.0 * thickness
    assert (4.0 * 3.0**0.5 * covered / (sides**2).sum(axis=0))[near].min() > 0.3  # equilateral ones have 1
