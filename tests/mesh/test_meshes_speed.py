"""Time to mesh at default resolution, in a fresh process and from the cache."""

import os
import subprocess
import sys
import time

import pytest

import meshes

ASKED = meshes.fit(0.126, 0.244, 0.013, 10)


@pytest.mark.benchmark
@pytest.mark.parametrize("family", meshes.FAMILIES)
def test_default_mesh_takes_less_than_two_seconds_with_the_import_of_gmsh(family):
    code = (
        "import meshes, time\n"
        f"p = meshes.fit(0.126, 0.244, 0.013, 10, family={family!r})\n"
        "start = time.perf_counter(); meshes.half_space(p); print(time.perf_counter() - start)\n"
    )
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert float(run.stdout) < 2.0


@pytest.mark.benchmark
def test_cache_answers_at_once(tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_CACHE_HOME", os.fspath(tmp_path))
    first = meshes.cached(ASKED)
    start = time.perf_counter()
    assert meshes.cached(ASKED) is first
    assert time.perf_counter() - start < 0.01
