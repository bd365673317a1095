"""A solver registered from outside takes part in every report without a change anywhere else."""

from __future__ import annotations

import dataclasses
import json

import pytest
from support.spring_solver import SCENE, FunctionSolver, named, spring
from support.unlaid_figures import without_layout

from contact_scene import Branch, BulkRelaxation, Loading, Material, Scene, Sphere, UnsupportedScene
from validation import solvers
from validation.cases import load
from validation.compare.page import write
from validation.compare.suite import compare_scenes
from validation.runs.progress import Progress
from validation.solvers import Solver, register, unregister
from validation.stability.cases import cases
from validation.studies.ladders import ladders, scheme

NAME = "spring"


class SpringSolver(Solver):
    """Only what a solver has to state: its name, its title and how it solves."""

    name = NAME
    title = "a spring"

    def _solve(self, scene, resolution, options):
        return FunctionSolver(spring(1.1), NAME).solve(scene, resolution, **vars(options))


@pytest.fixture
def registered(monkeypatch):
    """The new solver beside the built-in ones, which do nothing but follow a spring of their own."""
    for name in solvers.SOLVERS:
        monkeypatch.setitem(solvers.SOLVERS, name, named(name, FunctionSolver(spring())))
    register(SpringSolver())
    yield solvers.solver(NAME)
    unregister(NAME)


@pytest.mark.slow
def test_a_whole_report(registered, tmp_path):
    scene = tmp_path / "small.toml"
    scene.write_text(SCENE)
    report = compare_scenes("quick", [load(str(scene))], None, Progress("test"))
    with without_layout():
        write(report, tmp_path / "out")
    (entry,) = json.loads((tmp_path / "out" / "report.json").read_text())["scenes"]
    assert list(entry["runs"]) == [*(one.name for one in solvers.solvers())]
    assert entry["runs"][NAME]["outcome"] == "detached"
    checks = {check["quantity"]: check for check in entry["checks"] if check["solver"] == NAME}
    assert checks["outcome"]["passed"]
    assert not checks["pull_off_force"]["passed"]
    assert checks["pull_off_force"]["difference"] == pytest.approx(0.1)
    assert checks["pull_off_force"]["tolerance"] == registered.tolerance
    assert checks["pull_off_force"]["estimate"] is not None
    for form in ("index.html", "summary.md", "junit.xml"):
        assert NAME in (tmp_path / "out" / form).read_text()
    assert (tmp_path / "out" / "runs" / "small" / NAME / "trace.csv").exists()


def test_the_matrix_and_a_study_take_it_too(registered):
    case = load("cycle-v0.1")
    asked = ladders(case.scene)
    assert {entry.scheme for entry in asked} >= {NAME}
    assert scheme(NAME).run(case, asked[-1].levels[0].settings).solver == NAME
    first = cases("dead-load")[0]
    assert first.resolution(NAME) == registered.coarse_resolution(adhesive=True)
    assert first.tolerance.limit(NAME) > 1e-2


def test_an_unknown_option_is_an_error(registered):
    with pytest.raises(TypeError, match="tolerances"):
        registered.solve(load("cycle-v0.1").scene, 4, tolerances=1e-3)


def test_names_are_unique(registered):
    with pytest.raises(ValueError, match="already"):
        register(SpringSolver())
    assert NAME in solvers.SOLVERS


def test_it_is_gone_afterwards():
    assert NAME not in solvers.SOLVERS
    with pytest.raises(KeyError):
        solvers.solver(NAME)


class RefusingSolver(SpringSolver):
    """Takes no bulk that relaxes apart."""

    def refusal(self, scene):
        return (
            UnsupportedScene("material.bulk", "not by a spring", "--solver bem")
            if scene.material.bulk
            else None
        )


def test_a_refusal_is_told_without_solving():
    material = Material(0.75, 0.4, (Branch(6.75, 1.0),), BulkRelaxation())
    scene = Scene(material, Sphere(1.0), Loading("relaxed", 0.02))
    assert all(method.refusal(scene) is None for method in solvers.solvers())
    refusing = RefusingSolver()
    assert refusing.refusal(dataclasses.replace(scene, material=Material(0.75, 0.4))) is None
    with pytest.raises(UnsupportedScene) as raised:
        refusing.solve(scene)
    assert str(raised.value) == str(refusing.refusal(scene))
