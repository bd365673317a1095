"""Meshes in files and in the cache: round trips, damage, concurrency."""

import os
import subprocess
import sys
from dataclasses import replace

import meshio
import numpy as np
import pytest
import pyvista

import meshes
from meshes import cache

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


@pytest.fixture
def store(tmp_path, monkeypatch):
    """Empty cache on disk and in memory; returns its directory."""
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    monkeypatch.setattr(cache, "_memory", type(cache._memory)())
    return tmp_path / "crosscontact"


@pytest.fixture
def built(monkeypatch):
    """Count the meshes that are really built."""
    calls = []

    def build(asked):
        calls.append(asked)
        return meshes.half_space(asked)

    monkeypatch.setattr(cache, "half_space", build)
    return calls


def test_cache_builds_once_and_answers_from_memory_then_from_disk(store, built):
    first = meshes.cached(ASKED)
    assert meshes.cached(ASKED) is first
    cache._memory.clear()
    assert_same(meshes.cached(ASKED), first)
    assert built == [ASKED]
    assert len(list(store.iterdir())) == 1


def test_cache_tells_parameters_apart(store, built):
    other = replace(ASKED, domain_radius=2 * ASKED.domain_radius)
    assert meshes.cached(ASKED).parameters == ASKED
    assert meshes.cached(other).parameters == other
    assert built == [ASKED, other]


@pytest.mark.parametrize("damage", ["empty", "nonsense", "half", "flipped byte", "other mesh", "directory"])
def test_damaged_entries_are_built_again(store, built, damage):
    first = meshes.cached(ASKED)
    (entry,) = store.iterdir()
    whole = bytearray(entry.read_bytes())
    if damage == "other mesh":
        other = replace(ASKED, grading=0.3)
        meshes.cached(other)
        entry.write_bytes((store / cache._name(other)).read_bytes())
    elif damage == "directory":
        entry.unlink()
        entry.mkdir()
    else:
        flipped = whole.copy()
        flipped[len(whole) // 3] ^= 0xFF
        content = {
            "empty": b"",
            "nonsense": b"x" * 99,
            "half": whole[: len(whole) // 2],
            "flipped byte": flipped,
        }
        entry.write_bytes(content[damage])
    cache._memory.clear()
    before = len(built)
    assert_same(meshes.cached(ASKED), first)
    assert len(built) == before + 1
    if damage != "directory":
        cache._memory.clear()
        assert_same(meshes.cached(ASKED), first)
        assert len(built) == before + 1
    assert not list(store.glob("*.tmp"))


def test_cache_does_without_a_disk(tmp_path, monkeypatch, store):
    (tmp_path / "file").write_text("in the way")
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "file"))
    assert meshes.cached(ASKED).parameters == ASKED


def test_cache_directory_follows_the_environment(monkeypatch, tmp_path):
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    assert meshes.cache_directory() == tmp_path / "crosscontact"
    monkeypatch.setenv("HOME", str(tmp_path / "home"))
    for unset in ("", "relative/path"):
        monkeypatch.setenv("XDG_CACHE_HOME", unset)
        assert meshes.cache_directory() == tmp_path / "home/.cache/crosscontact"


def test_memory_is_bounded(store, monkeypatch):
    monkeypatch.setattr(cache, "IN_MEMORY", 2)
    for factor in (1, 2, 3):
        meshes.cached(replace(ASKED, domain_radius=factor * ASKED.domain_radius))
    assert len(cache._memory) == 2


def test_processes_share_the_cache(tmp_path):
    code = (
        "import meshes\n"
        "p = meshes.fit(0.126, 0.244, 0.013, 3, family='structured')\n"
        "from meshes import cache\n"
        "path = cache.cache_directory() / cache._name(p)\n"
        "m = meshes.half_space(p)\n"
        "for _ in range(30):\n"
        "    cache._store(path, m)\n"
        "    n = cache._load(path, p)\n"
        "    assert n is not None and (n.points == m.points).all()\n"
    )
    environment = {**os.environ, "XDG_CACHE_HOME": str(tmp_path)}
    workers = [
        subprocess.Popen([sys.executable, "-c", code], env=environment, stderr=subprocess.PIPE)
        for _ in range(3)
    ]
    for worker in workers:
        _, complaint = worker.communicate(timeout=60)
        assert worker.returncode == 0, complaint.decode()
    assert len(list((tmp_path / "crosscontact").iterdir())) == 1
