"""Both families: they fill the domain once, are oriented and named, have the declared sizes and surface."""

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

import meshes
from meshes.mesh import areas
from meshes.surface import surface_radii

CASES = {
    "default": meshes.fit(0.126, 0.244, 0.013, 10),
    "from the axis": meshes.fit(0.0, 0.2, 0.01, 4),
    "punch": meshes.fit(1.0, 1.0, 0.01, 10, edge=1.0),
    "one interval": meshes.MeshParameters(0.1, 0.5, 0.6, 50.0),
    "coarse": meshes.MeshParameters(0.1, 0.35, 1.1, 100.0, grading=0.5),
    "narrow start": meshes.MeshParameters(0.1, 0.03, 1.1, 100.0),
    "metres": meshes.fit(1.26e-7, 2.44e-7, 1.3e-8, 5),
}
FAMILIES = pytest.mark.parametrize("family", meshes.FAMILIES)


@pytest.fixture(params=[(name, family) for name in CASES for family in meshes.FAMILIES], ids="-".join)
def mesh(request):
    return build(*request.param)


def build(name: str, family: str) -> meshes.HalfSpaceMesh:
    return meshes.half_space(replace(CASES[name], family=family))


def check_geometry(mesh: meshes.HalfSpaceMesh, least_angle: float) -> None:
    """The triangles have the area inside the boundary edges (by Green's theorem) and no sharp corner."""
    sizes = areas(mesh.points, mesh.triangles)
    first, last = np.concatenate(list(mesh.boundaries.values()), axis=1)
    (r0, z0), (r1, z1) = mesh.points[:, first], mesh.points[:, last]
    assert (sizes > 0).all()
    assert sizes.sum() == pytest.approx(0.5 * np.sum(r0 * z1 - r1 * z0), rel=1e-10)
    assert set(np.bincount(np.concatenate([first, last]))) <= {0, 2}
    corners = mesh.points[:, mesh.triangles]
    squares = np.sum((np.roll(corners, 1, axis=1) - np.roll(corners, 2, axis=1)) ** 2, axis=0)
    cotangents = (squares.sum(axis=0) - 2.0 * squares) / (4.0 * sizes)
    assert np.degrees(np.arctan2(1.0, cotangents.max())) > least_angle


def test_the_domain_is_filled_once_and_its_boundaries_named(mesh):
    check_geometry(mesh, least_angle=12.0)
    radius, sizes = mesh.parameters.domain_radius, areas(mesh.points, mesh.triangles)
    assert sizes.sum() == pytest.approx(0.25 * np.pi * radius**2, rel=0.07)
    assert (mesh.points[1, mesh.boundaries["surface"]] == 0.0).all()
    assert set(mesh.boundaries["surface"].ravel()) == set(mesh.surface_nodes)
    assert (mesh.points[0, mesh.boundaries["axis"]] == 0.0).all()
    assert mesh.boundaries["axis"].shape[1] == np.count_nonzero(mesh.points[0] == 0.0) - 1
    far = mesh.points[:, np.unique(mesh.boundaries["far"])]
    assert np.hypot(*far).min() > 0.7 * radius
    assert far[0, far[1] == 0.0] == radius


def test_elements_have_the_declared_sizes(mesh):
    """On the surface; below it no triangle is much coarser than wanted, and few are wastefully fine."""
    asked, radii = mesh.parameters, mesh.points[0, mesh.surface_nodes]
    assert (radii[0], radii[-1]) == (0.0, asked.domain_radius)

    def beyond(r):
        return np.maximum(np.maximum(asked.fine_from - r, r - asked.fine_to), 0.0)

    lengths, middle = np.diff(radii), 0.5 * (radii[1:] + radii[:-1])
    assert (lengths > 0).all()
    assert (lengths <= 1.6 * asked.fine_size + 1.01 * asked.grading * beyond(middle)).all()
    r, z = mesh.points[:, mesh.triangles].mean(axis=1)
    wanted = asked.size_at(np.hypot(beyond(r), z))
    ratio = np.sqrt(4.0 / np.sqrt(3.0) * areas(mesh.points, mesh.triangles)) / wanted
    assert ratio.max() < 2.0
    assert 0.6 < np.exp(np.log(ratio[wanted > 2.0 * asked.fine_size]).mean()) < 1.25


@pytest.mark.parametrize("name", CASES)
def test_families_share_their_surface_vertices(name):
    one, other = (build(name, family) for family in meshes.FAMILIES)
    np.testing.assert_array_equal(one.points[0, one.surface_nodes], other.points[0, other.surface_nodes])


@FAMILIES
def test_strip_is_equispaced_to_rounding(family):
    """So that a vertex shifted by one process zone is a vertex."""
    mesh = build("default", family)
    asked, radii = mesh.parameters, mesh.points[0, mesh.surface_nodes]
    strip = radii[(radii >= asked.fine_from * (1 - 1e-12)) & (radii <= asked.fine_to * (1 + 1e-12))]
    assert strip.size == round((asked.fine_to - asked.fine_from) / asked.fine_size) + 1
    np.testing.assert_allclose(strip[10:] - strip[:-10], 0.013, rtol=1e-12)
    assert 1200 < mesh.points.shape[1] < 1800


@FAMILIES
def test_punch_edge_is_a_vertex_approached_by_halves(family):
    mesh = build("punch", family)
    radii = mesh.points[0, mesh.surface_nodes]
    tip = int(np.argmin(np.abs(radii - 1.0)))
    assert radii[tip] == 1.0
    steps = np.diff(radii[tip : tip + 7])
    halves = mesh.parameters.fine_size * 0.5 ** np.array([6, 6, 5, 4, 3, 2])
    np.testing.assert_allclose(steps, halves, rtol=1e-9)
    np.testing.assert_allclose(np.diff(radii[tip - 6 : tip + 1]), steps[::-1], rtol=1e-9)
    strip = np.arange(-19, 20) * mesh.parameters.fine_size + 1.0
    assert np.abs(radii[:, None] - strip).min(axis=0).max() < 1e-12


@pytest.mark.parametrize("unit", [1e-12, 1e-9, 1e9])
def test_the_mesh_is_the_same_in_other_units(unit):
    plain = meshes.half_space(meshes.fit(0.0, 0.2, 0.013, 4))
    other = meshes.half_space(meshes.fit(0.0, 0.2 * unit, 0.013 * unit, 4))
    assert np.array_equal(other.triangles, plain.triangles)
    assert np.abs(other.points / unit - plain.points).max() < 1e-12 * plain.points.max()


@settings(max_examples=60, deadline=None)
@given(
    size=st.floats(1e-8, 1e3),
    start=st.one_of(st.just(0.0), st.floats(0.0, 300.0)),
    length=st.floats(0.3, 100.0),
    ratio=st.floats(4.1, 1e4),
    grading=st.floats(0.1, 0.5),
    edge=st.one_of(st.none(), st.floats(0.0, 1.0)),
)
def test_structured_mesh_is_sound_for_any_parameters(size, start, length, ratio, grading, edge):
    """Lengths of strip and gap in units of the element size."""
    fine_from, fine_to = start * size, (start + length) * size
    radius = None if edge is None else fine_from + edge * length * size
    assume(radius is None or radius >= max(size, fine_from))
    sizes = size, fine_from, fine_to, ratio * (fine_to + size), grading, "structured", radius
    mesh = meshes.structured_half_space(meshes.MeshParameters(*sizes))
    check_geometry(mesh, least_angle=8.0)
    radii = mesh.points[0, mesh.surface_nodes]
    assert radius is None or np.abs(radii - radius).min() < 1e-9 * radius


def test_a_mesh_is_made_once():
    asked = meshes.fit(0.126, 0.244, 0.013, 3, family="structured")
    assert meshes.cached(replace(asked)) is meshes.cached(asked)
    assert meshes.cached(replace(asked, grading=0.3)).parameters.grading == 0.3


GOOD = {"fine_size": 0.01, "fine_from": 0.1, "fine_to": 0.3, "domain_radius": 10.0}
FITTED = {"contact_from": 0.126, "contact_to": 0.244, "zone": 0.013, "divisions": 10}


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"fine_size": 0.0}, r"fine_size = 0\.0: must be a length > 0"),
        ({"fine_size": math.nan}, "fine_size = nan: must be a finite number"),
        ({"fine_size": 1e-9}, "fine_size = 1e-09: .* intervals; at most 20000"),
        ({"fine_to": 0.1}, "fine_to = 0.1: must be a radius > 0.1"),
        ({"domain_radius": 0.5}, "domain_radius = 0.5: must be a radius >= 1.24"),
        ({"grading": 0.6}, r"grading = 0\.6: must be a number in \(0, 0\.5\]"),
        ({"family": "hexagons"}, "family = 'hexagons': must be 'gmsh' or 'structured'"),
        ({"extra_fine_radius": 0.5}, "extra_fine_radius = 0.5: must be a radius on the fine strip"),
        ({"extra_fine_size": 0.001}, "extra_fine_size: needs extra_fine_radius"),
        ({"contact_from": -1.0}, "contact_from = -1.0: must be a radius >= 0"),
        ({"contact_to": 0.1}, "contact_to = 0.1: must be a radius >= contact_from"),
        ({"zone": 0.0}, "zone = 0.0: must be a length > 0"),
        ({"divisions": 2.5}, "divisions = 2.5: must be a whole number"),
    ],
)
def test_refuses_in_words(change, message):
    with pytest.raises(ValueError, match=message):
        meshes.fit(**FITTED | change) if change.keys() <= FITTED.keys() else meshes.MeshParameters(
            **GOOD | change
        )


def test_fit_covers_the_path_of_the_edge_with_its_margins():
    asked = meshes.fit(**FITTED)
    assert asked.fine_size == pytest.approx(0.0013)
    assert 0.1 - 0.0013 <= asked.fine_from <= 0.1 + 1e-12
    assert 0.27 - 1e-12 <= asked.fine_to <= 0.27 + 0.0013
    assert asked.domain_radius == pytest.approx(400 * 0.244)
    for radius in (asked.fine_from, asked.fine_to):
        assert radius / asked.fine_size == pytest.approx(round(radius / asked.fine_size), abs=1e-9)
    wide = meshes.fit(0.0, 0.01, 0.05, 4)
    assert wide.fine_from == 0.0
    assert wide.domain_radius >= 4 * wide.fine_to >= 0.44
    rim = meshes.fit(0.3, 1 / 3, 0.01, 7, edge=1 / 3)
    radii = surface_radii(rim)
    assert rim.extra_fine_radius == 1 / 3
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
    ],
)
def test_mesh_refuses_what_is_no_half_space(change, message):
    asked = meshes.MeshParameters(**GOOD)
    with pytest.raises(ValueError, match="read-only"):
        meshes.HalfSpaceMesh(**TRIANGLE, parameters=asked).points[0, 0] = 1.0
    with pytest.raises(ValueError, match=message):
        meshes.HalfSpaceMesh(**{**TRIANGLE, **change}, parameters=asked)
