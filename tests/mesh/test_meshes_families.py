"""Both families: they fill the domain once, are oriented and named, have the declared sizes and surface."""

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

import meshes
from meshes.mesh import areas

CASES = {
    "default": meshes.fit(0.126, 0.244, 0.013, 10),
    "from the axis": meshes.fit(0.0, 0.2, 0.01, 4),
    "punch": meshes.fit(1.0, 1.0, 0.01, 10, edge=1.0),
    "one interval": meshes.MeshParameters(0.1, 0.5, 0.6, 50.0),
    "coarse": meshes.MeshParameters(0.1, 0.35, 1.1, 100.0, grading=0.5),
    "narrow start": meshes.MeshParameters(0.1, 0.03, 1.1, 100.0),
    "metres": meshes.fit(1.26e-7, 2.44e-7, 1.3e-8, 5),
}


@pytest.fixture(params=[(name, family) for name in CASES for family in meshes.FAMILIES], ids="-".join)
def mesh(request):
    name, family = request.param
    return build(name, family)


def build(name: str, family: str) -> meshes.HalfSpaceMesh:
    numbers = {key: getattr(CASES[name], key) for key in CASES[name].__dataclass_fields__}
    return meshes.half_space(meshes.MeshParameters(**{**numbers, "family": family}))


def enclosed(mesh: meshes.HalfSpaceMesh) -> float:
    """Area inside the boundary edges, by Green's theorem (the body is on their left)."""
    first, last = np.concatenate(list(mesh.boundaries.values()), axis=1)
    (r0, z0), (r1, z1) = mesh.points[:, first], mesh.points[:, last]
    return float(0.5 * np.sum(r0 * z1 - r1 * z0))


def check_geometry(mesh: meshes.HalfSpaceMesh, least_angle: float) -> None:
    total = areas(mesh.points, mesh.triangles)
    assert (total > 0).all()
    assert total.sum() == pytest.approx(enclosed(mesh), rel=1e-10)
    touched = np.bincount(np.concatenate([edges.ravel() for edges in mesh.boundaries.values()]))
    assert set(touched) <= {0, 2}
    assert mesh.quality.min_angle > least_angle


def test_fills_the_domain_once_with_well_shaped_triangles(mesh):
    check_geometry(mesh, least_angle=12.0)


def test_area_is_that_of_a_quarter_disc(mesh):
    disc = 0.25 * np.pi * mesh.parameters.domain_radius**2
    coarsest = mesh.quality.longest_edge / mesh.parameters.domain_radius
    assert areas(mesh.points, mesh.triangles).sum() == pytest.approx(disc, rel=0.25 * coarsest**2 + 0.05)


def test_named_boundaries_lie_where_they_say(mesh):
    radius = mesh.parameters.domain_radius
    assert (mesh.points[1, mesh.boundaries["surface"]] == 0.0).all()
    assert set(mesh.boundaries["surface"].ravel()) == set(mesh.surface_nodes)
    assert (mesh.points[0, mesh.boundaries["axis"]] == 0.0).all()
    assert mesh.boundaries["axis"].shape[1] == np.count_nonzero(mesh.points[0] == 0.0) - 1
    far = mesh.points[:, np.unique(mesh.boundaries["far"])]
    assert np.hypot(*far).min() > 0.7 * radius
    assert far[0, far[1] == 0.0] == radius


def test_surface_runs_from_the_axis_to_the_domain_radius_in_declared_sizes(mesh):
    asked = mesh.parameters
    radii = mesh.points[0, mesh.surface_nodes]
    assert radii[0] == 0.0
    assert radii[-1] == asked.domain_radius
    middle, size = 0.5 * (radii[1:] + radii[:-1]), np.diff(radii)
    distance = np.maximum(np.maximum(asked.fine_from - middle, middle - asked.fine_to), 0.0)
    assert (size > 0).all()
    assert (size <= 1.6 * asked.fine_size + 1.01 * asked.grading * distance).all()


def test_elements_grow_with_the_distance_as_declared(mesh):
    """No triangle much coarser than wanted, and on average not wastefully fine."""
    corners = mesh.points[:, mesh.triangles]
    r, z = corners.mean(axis=1)
    asked = mesh.parameters
    beyond = np.maximum(np.maximum(asked.fine_from - r, r - asked.fine_to), 0.0)
    wanted = asked.fine_size + asked.grading * np.hypot(beyond, z)
    size = np.sqrt(4.0 / np.sqrt(3.0) * areas(mesh.points, mesh.triangles))
    ratio = size / wanted
    assert ratio.max() < 2.0
    assert 0.6 < np.exp(np.log(ratio[wanted > 2.0 * asked.fine_size]).mean()) < 1.25


@pytest.mark.parametrize("name", CASES)
def test_families_share_their_surface_vertices(name):
    surfaces = [mesh.points[0, mesh.surface_nodes] for mesh in (build(name, f) for f in meshes.FAMILIES)]
    np.testing.assert_array_equal(surfaces[0], surfaces[1])


@pytest.mark.parametrize("family", meshes.FAMILIES)
def test_strip_is_equispaced_to_rounding(family):
    mesh = build("default", family)
    asked = mesh.parameters
    radii = mesh.points[0, mesh.surface_nodes]
    strip = radii[(radii >= asked.fine_from * (1 - 1e-12)) & (radii <= asked.fine_to * (1 + 1e-12))]
    assert strip.size == round((asked.fine_to - asked.fine_from) / asked.fine_size) + 1
    np.testing.assert_allclose(np.diff(strip), asked.fine_size, rtol=1e-12)
    # shifted by one process zone, a vertex is a vertex
    np.testing.assert_allclose(strip[10:] - strip[:-10], 0.013, rtol=1e-12)


@pytest.mark.parametrize("family", meshes.FAMILIES)
def test_punch_edge_is_a_vertex_approached_by_halves(family):
    mesh = build("punch", family)
    radii = mesh.points[0, mesh.surface_nodes]
    tip = int(np.argmin(np.abs(radii - 1.0)))
    assert radii[tip] == 1.0
    steps = np.diff(radii[tip : tip + 7])
    np.testing.assert_allclose(
        steps, mesh.parameters.fine_size * 0.5 ** np.array([6, 6, 5, 4, 3, 2]), rtol=1e-9
    )
    np.testing.assert_allclose(np.diff(radii[tip - 6 : tip + 1]), steps[::-1], rtol=1e-9)
    strip = np.arange(-19, 20) * mesh.parameters.fine_size + 1.0
    assert np.abs(radii[:, None] - strip).min(axis=0).max() < 1e-12


@pytest.mark.parametrize("family", meshes.FAMILIES)
def test_same_parameters_give_the_same_mesh(family):
    first, second = build("default", family), build("default", family)
    np.testing.assert_array_equal(first.points, second.points)
    np.testing.assert_array_equal(first.triangles, second.triangles)


@pytest.mark.parametrize("family", meshes.FAMILIES)
def test_mesh_does_not_depend_on_the_unit_of_length(family):
    large = meshes.half_space(meshes.fit(0.126, 0.244, 0.013, 5, family=family))
    small = meshes.half_space(meshes.fit(0.126e-12, 0.244e-12, 0.013e-12, 5, family=family))
    assert small.quality.vertices == pytest.approx(large.quality.vertices, rel=0.02)
    assert small.quality.min_angle == pytest.approx(large.quality.min_angle, rel=0.25)


@pytest.mark.parametrize("family", meshes.FAMILIES)
def test_default_mesh_is_small_and_well_shaped(family):
    mesh = build("default", family)
    quality = mesh.quality
    assert 1200 < quality.vertices < 1800
    assert quality.triangles < 2 * quality.vertices
    assert quality.shortest_edge > 0.0009
    assert quality.min_angle > (30.0 if mesh.parameters.family == "gmsh" else 12.0)


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
    mesh = meshes.structured_half_space(
        meshes.MeshParameters(
            size, fine_from, fine_to, ratio * (fine_to + size), grading, "structured", radius
        )
    )
    check_geometry(mesh, least_angle=8.0)
    radii = mesh.points[0, mesh.surface_nodes]
    assert radius is None or np.abs(radii - radius).min() < 1e-9 * radius


@pytest.mark.parametrize("unit", [1e-9, 1e-3, 1e3, 1e9])
def test_the_mesh_is_the_same_in_other_units(unit):
    plain = meshes.half_space(meshes.fit(0.0, 0.2, 0.013, 4))
    other = meshes.half_space(meshes.fit(0.0, 0.2 * unit, 0.013 * unit, 4))
    assert np.array_equal(other.triangles, plain.triangles)
    assert np.abs(other.points / unit - plain.points).max() < 1e-12 * plain.points.max()
