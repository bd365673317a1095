"""Solvers of other packages: listed unloaded, loaded when asked for, a broken one told in a line."""

from __future__ import annotations

import subprocess
import sys
from importlib.metadata import EntryPoint
from pathlib import Path

import pytest
from support.spring_solver import SCENE, FunctionSolver, spring

import crosscontact as cc
from contact_scene import SceneError
from crosscontact import registry
from crosscontact.cli import main
from validation.solvers import PEERS, Solver, plugins
from validation.solvers.boundary_elements import BoundaryElements
from validation.solvers.registry import SOLVERS, SolverRegistry


class PluginSpring(Solver):
    """A spring, as another package may bring it."""

    name = "plug-spring"
    title = "a spring of another package"

    def _solve(self, scene, resolution, options):
        return FunctionSolver(spring(), self.name).solve(scene, resolution, **vars(options))


def entry(name: str, target: str) -> EntryPoint:
    return EntryPoint(name, target, plugins.GROUP)


ENTRIES = (
    entry("plug-spring", f"{__name__}:PluginSpring"),
    entry("missing", "no_such_package_anywhere:Solver"),
    entry("other-name", f"{__name__}:PluginSpring"),
    entry("no-solver", f"{__name__}:SCENE"),
    entry("bem", f"{__name__}:PluginSpring"),
    entry("tamaas", f"{__name__}:PluginSpring"),
)
BROKEN = {
    "missing": "ModuleNotFoundError: No module named 'no_such_package_anywhere'",
    "other-name": "the solver's own name is 'plug-spring'",
    "no-solver": "is no Solver",
}


@pytest.fixture
def found(monkeypatch):
    """The entry points above, in a registry that has not looked yet."""
    monkeypatch.setattr(plugins, "entry_points", lambda group: ENTRIES if group == plugins.GROUP else ())
    monkeypatch.setattr(SOLVERS, "_found", None)
    before = dict(SOLVERS._solvers)
    yield
    SOLVERS._solvers.clear()
    SOLVERS._solvers.update(before)


def test_names_are_listed_without_loading(monkeypatch):
    monkeypatch.setattr(plugins, "entry_points", lambda group: ENTRIES)
    monkeypatch.setattr(plugins, "load", lambda entry: pytest.fail(f"loaded {entry.name}"))
    made = SolverRegistry(BoundaryElements())
    assert list(made) == ["bem", "missing", "no-solver", "other-name", "plug-spring"]
    assert "plug-spring" in made
    assert len(made) == 5
    assert made["bem"].title == "boundary elements"


def test_a_broken_one_is_named_and_the_rest_goes_on(found, capsys):
    assert registry.usable() == ("bem", "fem", "reference", "plug-spring")
    lines = capsys.readouterr().err.splitlines()
    assert len(lines) == len(BROKEN)
    for name, reason in BROKEN.items():
        (line,) = (line for line in lines if f'"{name}" of ' in line)
        assert reason in line
    assert registry.usable() == ("bem", "fem", "reference", "plug-spring")
    assert capsys.readouterr().err == ""


def test_the_command_line_takes_it(found, tmp_path, capsys):
    scene = tmp_path / "small.toml"
    scene.write_text(SCENE)
    assert main(["solve", str(scene), "--solver", "plug-spring"]) == 0
    assert "small by plug-spring: detached" in capsys.readouterr().out
    assert cc.solve(str(scene), "plug-spring").outcome.kind == "detached"
    assert main(["solve", str(scene), "--solver", "missing"]) == 2
    told = capsys.readouterr().err.splitlines()
    assert len(told) == 1
    assert BROKEN["missing"] in told[0]
    with pytest.raises(SceneError, match="no_such_package_anywhere"):
        cc.solve(str(scene), "missing")


def test_peers_are_found_by_name_and_run_by_nobody_else():
    assert set(PEERS) <= set(registry.selectable())
    assert not set(PEERS) & {*registry.names(), *SOLVERS}
    assert SOLVERS["tamaas"] is PEERS["tamaas"]
    code = "import sys; from crosscontact import registry; print(*registry.selectable()); print(*sys.modules)"
    run = subprocess.run(
        [sys.executable, "-c", code],
        capture_output=True,
        text=True,
        check=True,
        cwd=Path(__file__).parents[2],
    )
    names, modules = run.stdout.splitlines()
    assert "tamaas" in names.split()
    packages = {peer.module for peer in PEERS.values()} | {"SurfaceTopography"}
    assert not packages & set(modules.split())


def test_a_package_that_is_missing_is_told(monkeypatch):
    peer = PEERS["tamaas"]
    monkeypatch.setattr(type(peer), "module", "no_such_package_anywhere")
    reason = peer.refusal(cc.builtin("adhesionless-force"))
    assert str(reason) == (
        "solver: \"tamaas\" needs the package tamaas; allowed: pip install 'crosscontact[peers]'"
    )
