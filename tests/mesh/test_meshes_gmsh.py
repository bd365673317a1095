"""gmsh as a guest: missing, in another thread, already in use, and how it leaves the process."""

import importlib
import logging
import os
import signal
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

import meshes
from meshes import gmsh_session

ASKED = meshes.MeshParameters(0.004, 0.1, 0.27, 98.0)


@pytest.fixture
def gmsh():
    try:
        return importlib.import_module("gmsh")
    except (ImportError, OSError) as error:
        pytest.skip(f"gmsh cannot be loaded here: {error}")


@pytest.fixture
def fresh_warning():
    gmsh_session._warn_once.cache_clear()
    yield
    gmsh_session._warn_once.cache_clear()


@pytest.mark.parametrize(
    ("error", "words"),
    [
        (OSError("libGLU.so.1: cannot open shared object file"), ("libGLU.so.1", "apt install libglu1-mesa")),
        (OSError("libXft.so.2: cannot open shared object file"), ("libXft.so.2", "apt install libxft2")),
        (OSError("libodd++-2.so.7: cannot open shared object file"), ("libodd++-2.so.7", "is missing")),
        (ModuleNotFoundError("No module named 'gmsh'", name="gmsh"), ("gmsh", "pip install gmsh")),
        (OSError("image not found"), ("gmsh cannot be loaded", "image not found")),
    ],
)
@pytest.mark.usefixtures("fresh_warning")
def test_without_gmsh_one_line_says_what_is_missing(monkeypatch, caplog, error, words):
    def refuse(name):
        raise error

    monkeypatch.setattr(importlib, "import_module", refuse)
    with caplog.at_level(logging.WARNING):
        first, second = meshes.half_space(ASKED), meshes.half_space(ASKED)
    assert len(caplog.records) == 1
    message = caplog.records[0].getMessage()
    assert "\n" not in message
    assert all(word in message for word in (*words, "structured"))
    assert first.parameters.family == second.parameters.family == "structured"
    np.testing.assert_array_equal(first.points, meshes.structured_half_space(ASKED).points)


def test_a_process_without_the_library_prints_one_line(tmp_path):
    """As a user sees it: a gmsh package whose shared library does not load."""
    (tmp_path / "gmsh.py").write_text("raise OSError('libGLU.so.1: cannot open shared object file')\n")
    code = "import meshes as m; print(m.cached(m.MeshParameters(.01, .1, .2, 80)).parameters.family)"
    path = os.pathsep.join([str(tmp_path), os.getcwd()])
    environment = {**os.environ, "PYTHONPATH": path}
    run = subprocess.run([sys.executable, "-c", code], env=environment, capture_output=True, text=True)
    assert (run.returncode, run.stdout.strip()) == (0, "structured")
    assert len(run.stderr.strip().splitlines()) == 1
    assert "libglu1-mesa" in run.stderr


def test_gmsh_is_silent_and_leaves_the_process_as_it_was(gmsh, capfd):
    before = signal.getsignal(signal.SIGINT)
    meshes.half_space(ASKED)
    assert not gmsh.isInitialized()
    assert signal.getsignal(signal.SIGINT) is before
    assert capfd.readouterr() == ("", "")


def test_gmsh_is_left_clean_after_a_failure(gmsh, monkeypatch):
    def fail(*_):
        raise RuntimeError("in the middle of meshing")

    monkeypatch.setattr("meshes.halfspace._size_field", fail)
    with pytest.raises(RuntimeError, match="in the middle"):
        meshes.half_space(ASKED)
    monkeypatch.undo()
    assert not gmsh.isInitialized()
    assert meshes.half_space(ASKED).parameters.family == "gmsh"


def test_threads_share_gmsh_without_harm(gmsh):
    expected = meshes.half_space(ASKED)
    with ThreadPoolExecutor(4) as pool:
        results = list(pool.map(meshes.half_space, [ASKED] * 4))
    for mesh in results:
        np.testing.assert_array_equal(mesh.points, expected.points)
    assert not gmsh.isInitialized()


def test_a_running_session_of_the_caller_survives(gmsh):
    expected = meshes.half_space(ASKED)
    with gmsh_session._sigpipe_restored():
        gmsh.initialize(readConfigFiles=False, interruptible=False)
    try:
        gmsh.option.setNumber("General.Terminal", 0)
        gmsh.option.setNumber("Mesh.MeshSizeFactor", 7.0)
        gmsh.model.add("theirs")
        gmsh.model.geo.addPoint(0, 0, 0)
        gmsh.model.geo.synchronize()
        models = gmsh.model.list()
        mesh = meshes.half_space(ASKED)
        assert gmsh.isInitialized()
        assert gmsh.model.list() == models
        assert gmsh.model.getCurrent() == "theirs"
        assert gmsh.model.getEntities(0) == [(0, 1)]
        assert gmsh.option.getNumber("Mesh.MeshSizeFactor") == 7.0
    finally:
        gmsh.finalize()
    np.testing.assert_array_equal(mesh.points, expected.points)


@pytest.mark.skipif(not hasattr(signal, "SIGPIPE"), reason="no such signal on this system")
def test_a_broken_pipe_is_still_an_exception_afterwards(gmsh):
    """gmsh makes it end the process: a worker that dies would take the whole command along."""
    program = """
import os, threading, meshes
other = threading.Thread(target=meshes.half_space, args=(meshes.MeshParameters(0.004, 0.1, 0.27, 98.0),))
other.start()
other.join()
read, write = os.pipe()
os.close(read)
try:
    os.write(write, b"nobody reads this")
except BrokenPipeError:
    print("noticed")
"""
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=False)
    assert (done.returncode, done.stdout) == (0, "noticed\n"), done.stderr
