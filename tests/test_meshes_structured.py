"""The structured family: geometry, orientation, names, sizes, reproducibility, grading to a punch edge."""

import numpy as np
import pytest

import meshes
from meshes.mesh import areas

DEFAULT = meshes.fit(0.126, 0.244, 0.013, 10)
CASES = {
    "default": DEFAULT,
    "from the axis": meshes.fit(0.0, 0.2, 0.01, 4),
    "punch": meshes.fit(1.0, 1.0, 0.01, 10, edge=1.0),
    "one interval": meshes.MeshParameters(0.1, 0.5, 0.6, 50.0),
    "coarse": meshes.MeshParameters(0.1, 0.35, 1.1, 100.0, grading=1.0),
    "narrow start": meshes.MeshParameters(0.1, 0.12, 1.1, 100.0),
}


@pytest.fixture(params=CASES, scope="module")
def mesh(request):
    return meshes.structured_half_space(CASES[request.param])


def enclosed(mesh) -> float:
    """Area inside the boundary edges, by Green's theorem (the body is on their left)."""
    first, last = np.concatenate(list(mesh.boundaries.values()), axis=1)
    (r0, z0), (r1, z1) = mesh.points[:, first], mesh.points[:, last]
    return float(0.5 * np.sum(r0 * z1 - r1 * z0))


def test_triangles_fill_the_domain_once(mesh):
    total = areas(mesh.points, mesh.triangles).sum()
    assert total == pytest.approx(enclosed(mesh), rel=1e-12)
    assert (areas(mesh.points, mesh.triangles) > 0).all()


def test_far_boundary_is_a_closed_chain_to_both_ends(mesh):
    counts = np.bincount(np.concatenate([b.ravel() for b in mesh.boundaries.values()]))
    assert set(counts) == {0, 2}
    radius = mesh.parameters.domain_radius
    far = mesh.points[:, np.unique(mesh.boundaries["far"])]
    assert np.hypot(*far).min() > 0.7 * radius
    assert far[0, far[1] == 0.0] == radius


def test_named_boundaries_lie_where_they_say(mesh):
    assert (mesh.points[1, mesh.boundaries["surface"]] == 0.0).all()
    assert (mesh.points[0, mesh.boundaries["axis"]] == 0.0).all()
    assert set(mesh.boundaries["surface"].ravel()) == set(mesh.surface_nodes)
