"""Declared numbers: what is accepted, what is refused and how; fitting to a contact."""

import math

import numpy as np
import pytest

import meshes

GOOD = {"fine_size": 0.01, "fine_from": 0.1, "fine_to": 0.3, "domain_radius": 10.0}


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"fine_size": 0.0}, r"fine_size = 0\.0: must be a length > 0"),
        ({"fine_size": math.nan}, "fine_size = nan: must be a finite number"),
        ({"fine_size": 1e-9}, "fine_size = 1e-09: .* intervals; at most 20000"),
        ({"fine_from": -0.1}, "fine_from = -0.1: must be a radius >= 0"),
        ({"fine_to": 0.1}, "fine_to = 0.1: must be a radius > 0.1"),
        ({"fine_to": "wide"}, "fine_to = 'wide': must be a finite number"),
        ({"domain_radius": 0.5}, "domain_radius = 0.5: must be a radius >= 1.24"),
        ({"domain_radius": math.inf}, "domain_radius = inf: must be a finite number"),
        ({"grading": 0.0}, r"grading = 0\.0: must be a number in \(0, 0\.5\]"),
        ({"grading": 0.6}, r"grading = 0\.6: must be"),
        ({"family": "hexagons"}, "family = 'hexagons': must be 'gmsh' or 'structured'"),
        ({"extra_fine_radius": 0.5}, "extra_fine_radius = 0.5: must be a radius on the fine strip"),
        ({"extra_fine_size": 0.001}, "extra_fine_size: needs extra_fine_radius"),
        ({"extra_fine_radius": 0.2, "extra_fine_size": 0.02}, "extra_fine_size = 0.02: must be a length in"),
    ],
)
def test_refuses_in_words(change, message):
    with pytest.raises(ValueError, match=message):
        meshes.MeshParameters(**{**GOOD, **change})


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"contact_from": -1.0}, "contact_from = -1.0: must be a radius >= 0"),
        ({"contact_to": 0.1}, "contact_to = 0.1: must be a radius >= contact_from"),
        ({"contact_from": 0.0, "contact_to": 0.0}, "contact_to = 0.0: must be"),
        ({"zone": 0.0}, "zone = 0.0: must be a length > 0"),
        ({"divisions": 0}, "divisions = 0: must be a whole number >= 1"),
        ({"divisions": 2.5}, "divisions = 2.5: must be a whole number"),
        ({"margin": -1.0}, "margin = -1.0: must be a number >= 0"),
    ],
)
def test_fit_refuses_in_words(change, message):
    with pytest.raises(ValueError, match=message):
        meshes.fit(**{"contact_from": 0.126, "contact_to": 0.244, "zone": 0.013, "divisions": 10, **change})


def test_fit_covers_the_path_of_the_edge_with_its_margins():
    asked = meshes.fit(0.126, 0.244, 0.013, 10)
    assert asked.fine_size == pytest.approx(0.0013)
    assert 0.1 - 0.0013 <= asked.fine_from <= 0.1 + 1e-12
    assert 0.27 - 1e-12 <= asked.fine_to <= 0.27 + 0.0013
    assert asked.domain_radius == pytest.approx(400 * 0.244)
    for radius in (asked.fine_from, asked.fine_to):
        assert radius / asked.fine_size == pytest.approx(round(radius / asked.fine_size), abs=1e-9)


def test_fit_stops_at_the_axis_and_covers_a_zone_wider_than_the_contact():
    asked = meshes.fit(0.0, 0.01, 0.05, 4)
    assert asked.fine_from == 0.0
    assert asked.fine_to >= 0.11
    assert asked.domain_radius >= 4 * asked.fine_to


def test_fit_aligns_the_strip_with_a_sharp_edge():
    asked = meshes.fit(0.3, 1 / 3, 0.01, 7, edge=1 / 3)
    radii = meshes.surface_radii(asked)
    assert asked.extra_fine_radius == 1 / 3
    assert np.abs(radii - 1 / 3).min() < 1e-15
    assert radii[(radii > 0.28) & (radii < 0.35)].size >= 49


TRIANGLE = {
    "points": np.array([[0.0, 1.0, 0.0], [0.0, 0.0, -1.0]]),
    "triangles": np.array([[0], [2], [1]]),
    "boundaries": {
        "surface": np.array([[1], [0]]),
        "axis": np.array([[0], [2]]),
        "far": np.array([[2], [1]]),
    },
}


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"triangles": np.array([[0], [1], [2]])}, "counter-clockwise"),
        ({"triangles": np.array([[0], [2], [3]])}, "triangles: empty, or vertex index out of range"),
        ({"points": np.zeros((3, 3))}, r"points: has shape \(3, 3\), must be \(2, n\)"),
        ({"points": -TRIANGLE["points"]}, "r >= 0 and z <= 0"),
        ({"boundaries": {"surface": np.array([[0], [1]])}}, "must be named surface, axis, far"),
        ({"boundaries": {**TRIANGLE["boundaries"], "far": np.zeros((2, 0))}}, "far: empty"),
    ],
)
def test_mesh_refuses_what_is_no_half_space(change, message):
    asked = meshes.MeshParameters(**GOOD)
    assert meshes.HalfSpaceMesh(**TRIANGLE, parameters=asked).quality.min_angle == pytest.approx(45.0)
    with pytest.raises(ValueError, match=message):
        meshes.HalfSpaceMesh(**{**TRIANGLE, **change}, parameters=asked)


def test_mesh_cannot_be_changed_in_place():
    mesh = meshes.structured_half_space(meshes.MeshParameters(**GOOD))
    with pytest.raises(ValueError, match="read-only"):
        mesh.points[0, 0] = 1.0
