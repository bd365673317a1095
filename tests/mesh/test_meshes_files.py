"""Meshes in files and in memory: round trips, damage."""

from dataclasses import replace

import meshio
import numpy as np
import pytest
import pyvista

import meshes

ASKED = meshes.fit(0.126, 0.244, 0.013, 3, family="structured")
PUNCH = meshes.fit(1.0, 1.0, 0.01, 4, family="structured", edge=1.0)


def assert_same(first: meshes.HalfSpaceMesh, second: meshes.HalfSpaceMesh) -> None:
    np.testing.assert_array_equal(first.points, second.points)
    np.testing.assert_array_equal(first.triangles, second.triangles)
    assert set(first.boundaries) == set(second.boundaries)
    for name in first.boundaries:
        np.testing.assert_array_equal(first.boundaries[name], second.boundaries[name])
    assert first.parameters == second.parameters


@pytest.mark.parametrize("suffix", [".vtu", ".msh"])
@pytest.mark.parametrize("asked", [ASKED, PUNCH, replace(ASKED, family="gmsh")])
def test_everything_survives_the_round_trip(tmp_path, suffix, asked):
    mesh = meshes.half_space(asked)
    meshes.write(mesh, tmp_path / f"mesh{suffix}")
    assert_same(meshes.read(tmp_path / f"mesh{suffix}"), mesh)


def test_msh_file_carries_physical_names_for_other_programs(tmp_path):
    mesh = meshes.half_space(ASKED)
    meshes.write(mesh, tmp_path / "mesh.msh")
    plain = meshio.read(tmp_path / "mesh.msh")
    assert {name: int(dimension) for name, (_, dimension) in plain.field_data.items()} == {
        "surface": 1,
        "axis": 1,
        "far": 1,
        "half-space": 2,
    }
    assert len(plain.cells_dict["triangle"]) == mesh.quality.triangles
    assert len(plain.cells_dict["line"]) == sum(edges.shape[1] for edges in mesh.boundaries.values())


def test_vtu_file_is_read_by_vtk(tmp_path):
    mesh = meshes.half_space(ASKED)
    meshes.write(mesh, tmp_path / "mesh.vtu")
    grid = pyvista.read(tmp_path / "mesh.vtu")
    assert grid.n_points == mesh.quality.vertices
    assert "fine_size" in bytes(np.asarray(grid.field_data["crosscontact_parameters"], np.uint8)).decode()
    assert np.count_nonzero(grid.cell_data["part"] == 4) == mesh.quality.triangles


def test_other_suffixes_are_refused(tmp_path):
    with pytest.raises(ValueError, match=r"mesh\.stl: the suffix must be \.vtu or \.msh"):
        meshes.write(meshes.half_space(ASKED), tmp_path / "mesh.stl")
    with pytest.raises(ValueError, match="suffix"):
        meshes.read(tmp_path / "mesh.stl")


@pytest.mark.parametrize("suffix", [".vtu", ".msh"])
def test_damaged_files_are_refused_in_words(tmp_path, suffix):
    path = tmp_path / f"mesh{suffix}"
    meshes.write(meshes.half_space(ASKED), path)
    whole = path.read_bytes()
    for content in (b"", b"nonsense", whole[: len(whole) // 2], whole.replace(b"fine_size", b"fine_sice")):
        path.write_bytes(content.replace(b"102 105 110 101 95 115", b"102 105 110 101 95 116"))
        with pytest.raises(ValueError, match="not a half-space mesh"):
            meshes.read(path)
    with pytest.raises(FileNotFoundError):
        meshes.read(tmp_path / f"none{suffix}")


def test_a_mesh_is_built_once_and_parameters_are_told_apart():
    other = replace(ASKED, domain_radius=2 * ASKED.domain_radius)
    first = meshes.cached(ASKED)
    assert meshes.cached(other).parameters == other
    assert meshes.cached(replace(other, domain_radius=ASKED.domain_radius)) is first
    assert_same(first, meshes.half_space(ASKED))
