"""Scenes that solvers refuse: all of them in one line, some of them beside the answers of the others."""

from __future__ import annotations

import os
from functools import partial

import pytest
from support.commands import refusal, stand_in
from support.spring_solver import SCENE, FunctionSolver, StudiedSolver, small_scene, spring

from contact_scene import SceneError, UnsupportedScene, read_scene
from crosscontact.cli import main
from validation import solvers
from validation.solvers.finite_elements import FiniteElements
from validation.studies import ladders as schemes

BRANCH = "branches = [{ modulus = 6.75, time = 1.0 }]\n"


class Picky(FunctionSolver):
    """A solver that does not take what it is asked."""

    def refusal(self, scene):
        return UnsupportedScene("indenter", "is too round", "another one")


def beginning_with(step):
    """A scene with another load step before its own."""
    head, *ramps = SCENE.split("[[loading.steps]]")
    return "[[loading.steps]]\n".join([head, f"{step}\n", *ramps])


OSCILLATE = 'kind = "oscillate"\namplitude = 1e-3\nangular_frequency = 1e6\nduration = 1e7'
LOST = (beginning_with('kind = "hold"\nduration = 1e17'), "less than the time can resolve")
LARGE = (beginning_with('kind = "force"\nvalue = 1e12\nduration = 1.0'), "grows to")
CYCLES = (beginning_with(OSCILLATE), "cycles")
MESH = (SCENE.replace("[indenter]", BRANCH + "[indenter]"), "no mesh for this scene")
FOLLOWING = (MESH[0].replace("0.013", "0.0013"), MESH[1])
LAYER = (SCENE.replace("[indenter]", '[body]\nthickness = 1.0\nbase = "bonded"\n\n[indenter]'), "half-space")
FINE = "--resolution 1000000"
REFUSED = [
    *((command, LOST) for command in ("compare", "study", "study --poisson 10", "study --zones 0.01")),
    *(
        (command, asked)
        for command in ("solve --solver fem", "fields --at 0 --no-figures")
        for asked in (LOST, LARGE, CYCLES)
    ),
    *((f"{command} {FINE}", MESH) for command in ("solve --solver fem", "fields --pull-off")),
    *((f"{command} {FINE}", FOLLOWING) for command in ("solve --solver fem", "fields --pull-off")),
    ("solve --solver bem --resolution 1000000", (SCENE, "resolution")),
    ("study --poisson 10", LAYER),
]
"""Commands, and the scene and reason that no solver, or not this one, takes."""


@pytest.mark.parametrize(("command", "asked"), REFUSED)
def test_a_scene_that_is_not_taken_is_one_line_before_anything_is_said_or_made(
    capsys, tmp_path, monkeypatch, command, asked
):
    text, reason = asked
    name, *more = command.split()
    (tmp_path / "refused.toml").write_text(text)
    monkeypatch.setattr(solvers, "scene_warnings", lambda scene: ("doubtful",))
    line = refusal(capsys, name, str(tmp_path / "refused.toml"), *more, "--out", str(tmp_path / "out"))
    assert line.startswith(f"crosscontact: error: {tmp_path / 'refused.toml'}: ")
    assert reason in line
    assert "allowed: " in line
    assert not list((tmp_path / "out").glob("*"))


@pytest.fixture
def fakes(monkeypatch):
    """All solvers replaced, by springs where nothing is said."""
    return partial(stand_in, monkeypatch)


def test_different_reasons_are_told_with_their_solvers(capsys, tmp_path, fakes):
    class Pickier(FunctionSolver):
        def refusal(self, scene):
            return UnsupportedScene("material", "is too soft", "another one")

    fakes(bem=Picky(spring()), reference=Pickier(spring()))
    line = refusal(capsys, "compare", small_scene(tmp_path), "--solvers", "bem,reference", "--jobs", "1")
    assert "small.toml: no solver takes it" in line
    assert "bem: indenter: is too round" in line
    assert "reference: material: is too soft" in line


def test_a_solver_that_refuses_costs_the_others_nothing(capsys, tmp_path, fakes):
    fakes(fem=Picky(spring()))
    assert main(["compare", small_scene(tmp_path), "--jobs", "1"]) == 0
    rows = [line.split() for line in capsys.readouterr().out.splitlines()]
    (row,) = [row for row in rows if row[:1] == ["fem"]]
    assert row[1:3] == ["outcome", "refused"]
    assert " ".join(row).endswith("refused: indenter: is too round; allowed: another one")
    assert any(row[:2] == ["bem", "dissipated"] for row in rows)


def test_without_the_reference_nothing_is_compared(capsys, tmp_path, fakes):
    fakes(reference=Picky(spring()))
    assert main(["compare", small_scene(tmp_path), "--jobs", "1"]) == 1
    err = capsys.readouterr().err
    assert "reference: outcome: found refused" in err
    assert "no reference run" in err


def test_a_refusal_that_only_the_run_tells_is_exit_code_2(capsys, tmp_path, fakes):
    def refuse(scene, resolution=None, **options):
        raise SceneError("adhesion.zone", "too long", "a shorter one")

    fakes(FunctionSolver(refuse))
    out = tmp_path / "out"
    assert main(["compare", small_scene(tmp_path), "--jobs", "1", "--out", str(out)]) == 2
    last = capsys.readouterr().err.splitlines()[-1]
    assert last == "crosscontact: error: small: adhesion.zone: too long; allowed: a shorter one"
    assert not (out / "index.html").exists()


def test_a_study_leaves_out_what_does_not_take_the_scene(capsys, tmp_path, monkeypatch):
    for name in schemes.SCHEMES:
        stand_in = StudiedSolver(spring(), schemes.SCHEMES[name].solver.name)
        if name == "bem":
            monkeypatch.setattr(
                stand_in, "refusal", lambda scene: UnsupportedScene("indenter", "is round", "x")
            )
        monkeypatch.setitem(schemes.SCHEMES, name, schemes.replace(schemes.SCHEMES[name], solver=stand_in))
    assert main(["study", small_scene(tmp_path), "--jobs", "1"]) == 0
    out, err = capsys.readouterr()
    assert "bem together" not in err
    assert "failed:" not in err
    assert "0 failed" in out


@pytest.mark.parametrize("command", ["fields --at 0 --no-figures", "solve --solver fem"])
def test_what_the_memory_does_not_hold_is_refused_before_a_mesh_is_made(
    capsys, tmp_path, monkeypatch, command
):
    """With the finest resolution that it holds, which is taken; or it is said that there is none."""
    file = tmp_path / "fine.toml"
    file.write_text(SCENE.replace("0.013", "0.0013"))
    name, *more = command.split()
    given = [name, str(file), *more, "--out", str(tmp_path / "out")]
    method, gigabytes = FiniteElements(), 0.15

    def no_mesh(*arguments):
        raise AssertionError("a mesh is made")

    monkeypatch.setattr(FiniteElements, "mesh", no_mesh)
    page = os.sysconf("SC_PAGE_SIZE")
    monkeypatch.setattr(os, "sysconf", lambda key: int(1e9 * gigabytes) // page if "PHYS" in key else page)
    line = refusal(capsys, *given)
    assert line.startswith(f"crosscontact: error: {file}: at resolution 10 it takes about ")
    assert f"{gigabytes:.3g} GB are installed" in line
    finest = int(line.split("at most ")[1])
    scene = read_scene(file)
    method.check(scene, finest)
    with pytest.raises(SceneError, match=f"at resolution {2 * finest} "):
        method.check(scene, 2 * finest)
    gigabytes *= 0.2
    assert refusal(capsys, *given).endswith(
        "allowed: a longer process zone, a smaller contact, or another solver"
    )
