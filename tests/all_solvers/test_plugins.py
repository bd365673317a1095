"""Solvers of other packages: listed unloaded, loaded when asked for, a broken one told in a line."""

from __future__ import annotations

import subprocess
import sys
import venv
from importlib.metadata import EntryPoint
from pathlib import Path

import pytest
from support.exam_answers import answer_of, case, hertz_run
from support.report_commands import WORK
from support.spring_solver import FunctionSolver, small_scene, spring

import crosscontact as cc
from contact_scene import SceneError
from crosscontact import arguments
from crosscontact.cli import main
from validation.cases import load
from validation.exam.grading import grade
from validation.runs.provenance import of_case
from validation.runs.run import run
from validation.solvers import PEERS, Solver, registry, solvers
from validation.solvers.boundary_elements import BoundaryElements
from validation.solvers.registry import SOLVERS, SolverRegistry
from validation.stability.cases import cases

ROOT = Path(__file__).parents[2]


class PluginSpring(Solver):
    """A spring, as another package may bring it."""

    name = "plug-spring"
    title = "a spring of another package"

    def _solve(self, scene, resolution, options):
        return FunctionSolver(spring(), self.name).solve(scene, resolution, **vars(options))


class Exiting(Solver):
    """A solver that ends the program it is called by."""

    name = "exiting"
    title = "a program of its own"

    def _solve(self, scene, resolution, options):
        sys.exit("no licence")


class NotMade(Exiting):
    """The same before it is asked anything."""

    def __init__(self):
        sys.exit(3)


def entry(name: str, target: str) -> EntryPoint:
    return EntryPoint(name, target, registry.GROUP)


ENTRIES = (
    entry("plug-spring", f"{__name__}:PluginSpring"),
    entry("missing", "no_such_package_anywhere:Solver"),
    entry("other-name", f"{__name__}:PluginSpring"),
    entry("no-solver", f"{__name__}:ROOT"),
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
    monkeypatch.setattr(registry, "_entries", lambda: ENTRIES)
    monkeypatch.setattr(SOLVERS, "_found", None)
    before = dict(SOLVERS._solvers)
    yield
    SOLVERS._solvers.clear()
    SOLVERS._solvers.update(before)


def test_names_are_listed_without_loading(monkeypatch):
    monkeypatch.setattr(registry, "_entries", lambda: ENTRIES)
    monkeypatch.setattr(registry, "load", lambda entry: pytest.fail(f"loaded {entry.name}"))
    made = SolverRegistry({"bem": BoundaryElements})
    assert list(made) == ["bem", "missing", "no-solver", "other-name", "plug-spring"]
    assert "plug-spring" in made
    assert len(made) == 5
    assert made["bem"].title == "boundary elements"


def test_a_broken_one_is_named_and_the_rest_goes_on(found, capsys):
    assert arguments.usable() == ("bem", "fem", "reference", "plug-spring")
    lines = capsys.readouterr().err.splitlines()
    assert len(lines) == len(BROKEN)
    for name, reason in BROKEN.items():
        (line,) = (line for line in lines if f'"{name}" of ' in line)
        assert reason in line
    assert arguments.usable() == ("bem", "fem", "reference", "plug-spring")
    assert capsys.readouterr().err == ""


def test_one_that_ends_the_program_has_a_failed_run(tmp_path, monkeypatch, capsys):
    monkeypatch.setitem(SOLVERS._solvers, "exiting", Exiting())
    scene, why = small_scene(tmp_path), "RuntimeError: the solver called sys.exit('no licence')"
    assert run(load(scene), "exiting").failure == why
    for command in ("compare --jobs 1 --solvers reference,exiting", "solve --solver exiting"):
        assert main([*command.split(), scene]) == 1
        assert why in "".join(capsys.readouterr())
    with pytest.raises(registry.UnusableSolver, match=r"sys\.exit"):
        registry.load(entry("exiting", f"{__name__}:NotMade"))


def test_what_walks_the_registry_leaves_a_broken_one_out(found):
    names = [one.name for one in solvers()]
    assert names == ["bem", "fem", "reference", "plug-spring"]
    assert list(of_case(load("elastic-press"))["tolerances"]) == names
    assert {name for one in cases("adhesion") for name in one.resolutions} <= set(names)


@pytest.mark.parametrize("command", ["compare SCENE", "study SCENE", "stability", "report"])
def test_commands_that_run_all_solvers_go_on_without_a_broken_one(
    found, command, tmp_path, monkeypatch, capsys
):
    name, *more = command.replace("SCENE", str(small_scene(tmp_path))).split()
    ran = []

    def stopped(*given, **more):
        ran.extend(SOLVERS)
        raise SceneError("", "the work has begun")

    monkeypatch.setattr(f"crosscontact.commands.{WORK[command]}", stopped)
    assert main([name, *more, "--jobs", "1", "--out", str(tmp_path / "out")]) == 2
    assert ran == ["bem", "fem", "reference", "plug-spring"]
    *lines, _ = capsys.readouterr().err.splitlines()
    assert len(lines) == len(BROKEN)
    assert all(
        any(f'"{broken}" of ' in line and why in line for line in lines) for broken, why in BROKEN.items()
    )


def test_a_plan_with_a_broken_one_is_bad_input(found, tmp_path, capsys):
    plan = tmp_path / "plan.toml"
    plan.write_text(
        f'scene = "{small_scene(tmp_path)}"\nsolver = "missing"\n'
        '[[coordinates]]\nkey = "indenter.radius"\nvalues = [1.0]\n'
    )
    assert main(["sweep", str(plan), "--dry-run"]) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert BROKEN["missing"] in line


def test_the_command_line_takes_it(found, tmp_path, capsys):
    scene = small_scene(tmp_path)
    assert main(["solve", scene, "--solver", "plug-spring"]) == 0
    assert "small by plug-spring: detached" in capsys.readouterr().out
    assert cc.solve(scene, "plug-spring").outcome.kind == "detached"
    assert main(["solve", scene, "--solver", "missing"]) == 2
    told = capsys.readouterr().err.splitlines()
    assert len(told) == 1
    assert BROKEN["missing"] in told[0]
    with pytest.raises(SceneError, match="no_such_package_anywhere"):
        cc.solve(scene, "missing")


def template() -> str:
    """The solver that the page on plug-ins shows."""
    page = (ROOT / "docs" / "how-to" / "add-a-solver.md").read_text(encoding="utf-8")
    return page.split("```python\n")[1].split("```")[0]


def test_the_template_of_the_page_works(monkeypatch):
    text, module = template(), {}
    assert len(text.splitlines()) <= 60
    exec(compile(text, "template", "exec"), module)
    method = module["HertzSolver"]()
    found = grade(answer_of(method.solve(cc.builtin("elastic-press"))), case().scene, hertz_run())
    assert found.passed
    refused = {"cycle-v0.02": "adhesion", "adhesionless-cycle": "material", "punch-programme": "material"}
    for scene, key in refused.items():
        assert method.refusal(cc.builtin(scene)).key.startswith(key)


@pytest.mark.slow
def test_a_package_in_a_fresh_environment(tmp_path):
    """The package of the page, installed without a network; what it depends on is lent by this environment.

    It brings a broken solver too, which is named in a line of each command while the others run.
    """
    page = (ROOT / "docs" / "how-to" / "add-a-solver.md").read_text(encoding="utf-8")
    package, fresh = tmp_path / "my-solver", tmp_path / "fresh"
    package.mkdir()
    project, group = (
        page.split("```toml\n")[1].split("```")[0],
        '[project.entry-points."crosscontact.solvers"]\n',
    )
    assert group in project
    broken = 'broken = "my_solver:NoSuchSolver"\n'
    (package / "pyproject.toml").write_text(project.replace(group, group + broken))
    (package / "my_solver.py").write_text(template())
    venv.create(fresh, symlinks=True)
    python = fresh / "bin" / "python"
    ask = [str(python), "-c", "import sysconfig; print(sysconfig.get_path('purelib'))"]
    library = Path(subprocess.run(ask, capture_output=True, text=True, check=True).stdout.strip())
    lent = [str(ROOT), *(path for path in sys.path if path.endswith("site-packages"))]
    (library / "lent.pth").write_text("\n".join(lent))
    pip = [
        sys.executable,
        "-m",
        "pip",
        "install",
        "--quiet",
        "--no-index",
        "--no-deps",
        "--no-build-isolation",
    ]
    subprocess.run([*pip, "--target", str(library), str(package)], check=True, cwd=tmp_path, timeout=100)
    command = [str(python), "-m", "crosscontact", "solve", "elastic-press", "--solver", "hertz"]
    run = subprocess.run(
        [*command, "--out", "hertz"], capture_output=True, text=True, cwd=tmp_path, timeout=200
    )
    assert run.returncode == 0, run.stderr
    assert "by hertz: detached" in run.stdout
    assert (tmp_path / "hertz" / "trace.csv").exists()
    listed = "from crosscontact import arguments; print(*arguments.usable())"
    run = subprocess.run(
        [str(python), "-c", listed], capture_output=True, text=True, cwd=tmp_path, timeout=100
    )
    assert run.stdout.split() == ["bem", "fem", "reference", "hertz"]
    (line,) = run.stderr.splitlines()
    assert '"broken" of my-solver 1.0 cannot be used: AttributeError' in line


@pytest.mark.slow
def test_peers_are_found_by_name_and_run_by_nobody_else():
    assert set(PEERS) <= set(arguments.selectable())
    assert not set(PEERS) & {*arguments.names(), *SOLVERS}
    assert SOLVERS["tamaas"] is PEERS["tamaas"]
    code = (
        "import sys; from crosscontact import arguments; print(*arguments.selectable()); print(*sys.modules)"
    )
    run = subprocess.run(
        [sys.executable, "-c", code],
        capture_output=True,
        text=True,
        check=True,
        cwd=ROOT,
    )
    names, modules = run.stdout.splitlines()
    assert "tamaas" in names.split()
    packages = {peer.module for peer in PEERS.values()} | {"SurfaceTopography"}
    assert not packages & set(modules.split())
