"""``import crosscontact``: quick, loads nothing heavy, names the file that hides one of its packages."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

import crosscontact as cc
from contact_scene.indenter import SHAPES
from contact_scene.loading import STEPS
from contact_scene.material import MODELS
from contact_scene.temperature_shift import SHIFTS
from crosscontact.shadowing import PACKAGES

ROOT = Path(__file__).parents[2]
EVIDENCE = ("claims", "compare", "exam", "fields", "fits", "stability", "studies", "sweeps")
HEAVY = ("numpy", "scipy", "skfem", "gmsh", "pyvista", "matplotlib", "pandas", "xarray", "meshio")


def python(code: str, folder: Path) -> subprocess.CompletedProcess[str]:
    """Run a script that lies in ``folder``, as a notebook or a user's script does."""
    script = folder / "script.py"
    script.write_text(code)
    return subprocess.run([sys.executable, str(script)], capture_output=True, text=True, cwd=folder)


def loaded_by(statement: str, folder: Path) -> set[str]:
    code = f"import sys\n{statement}\nprint(*{{name.split('.')[0] for name in sys.modules}})"
    ended = python(code, folder)
    assert ended.returncode == 0, ended.stderr
    return set(ended.stdout.split())


def test_the_import_loads_nothing_heavy(tmp_path):
    loaded = loaded_by("import crosscontact", tmp_path)
    assert "crosscontact" in loaded
    assert not loaded & {*HEAVY, *PACKAGES}


@pytest.mark.slow
def test_solving_draws_and_tabulates_only_when_asked_and_other_files_of_a_user_hide_nothing(tmp_path):
    for name in ("scene", "solver", "result", "material", "loading", "options"):
        (tmp_path / f"{name}.py").write_text("raise SystemExit('imported')")
    statement = "import crosscontact as cc; cc.Scene; cc.solve('relaxed-equilibrium').measures"
    assert not loaded_by(statement, tmp_path) & {"skfem", "gmsh", "pyvista", "matplotlib", "pandas", "xarray"}


def test_a_run_loads_its_solver_and_nothing_that_it_does_not_call(tmp_path):
    statement = "from crosscontact.cli import main; assert main(['solve', 'elastic-relaxed']) == 0"
    code = f"import sys\n{statement}\nprint('loaded', *sys.modules)"
    ended = python(code, tmp_path)
    assert ended.returncode == 0, ended.stderr
    loaded = set(ended.stdout.partition("loaded ")[2].split())
    unused = {"scipy", "rich", "pebble", "multiprocessing", "asyncio", "email", "bem_solver", "fem_solver"}
    unused |= {"meshes", *(f"validation.{one}" for one in EVIDENCE), *HEAVY} - {"numpy"}
    assert "validation.reference.path.solver" in loaded
    assert sorted(loaded & unused) == []


def test_every_name_is_there():
    for name in cc.__all__:
        assert getattr(cc, name) is not None
    assert set(cc.__all__) <= set(dir(cc))
    assert {kind.__name__ for kind in (*STEPS, *SHAPES, *MODELS, *SHIFTS)} <= set(cc.__all__)
    with pytest.raises(AttributeError, match="no attribute 'Indentor'"):
        cc.Indentor  # noqa: B018


@pytest.mark.parametrize("before", ["", "import {}, "])
@pytest.mark.parametrize("file", [*(f"{package}.py" for package in PACKAGES), "validation/__init__.py"])
def test_a_file_that_hides_a_package_is_named(tmp_path, file, before):
    package = file.partition("/")[0].removesuffix(".py")
    hiding = tmp_path / file
    hiding.parent.mkdir(exist_ok=True)
    hiding.write_text("")
    ended = python(f"{before.format(package) or 'import '}crosscontact", tmp_path)
    assert (ended.returncode, ended.stdout) == (1, "")
    last = ended.stderr.splitlines()[-1]
    assert last.startswith(f"ImportError: crosscontact: {hiding} hides its package {package}: ")


@pytest.mark.parametrize("in_place", [True, False])
@pytest.mark.parametrize("command", [["-m", "crosscontact", "scenes"], ["-c", "import crosscontact"]])
def test_a_distribution_that_replaces_a_package_is_told_as_damage(tmp_path, in_place, command):
    """As ``pip install validation`` does: over our files, or beside an editable installation."""
    ours, other = tmp_path / "ours", tmp_path / "site-packages"
    for package in ("crosscontact", *PACKAGES):
        shutil.copytree(ROOT / package, ours / package, ignore=shutil.ignore_patterns("[!_]*", "__pycache__"))
    shutil.copy(ROOT / "crosscontact" / "shadowing.py", ours / "crosscontact")
    replaced = (ours if in_place else other) / "validation" / "__init__.py"
    replaced.parent.mkdir(parents=True, exist_ok=True)
    replaced.write_text("raise SystemExit('imported')")
    path = os.pathsep.join(map(str, (other, ours)))
    ended = subprocess.run(
        [sys.executable, *command],
        capture_output=True,
        text=True,
        cwd=tmp_path,
        env=os.environ | {"PYTHONPATH": path},
    )
    *before, last = ended.stderr.splitlines()
    assert ended.returncode == 1
    assert f"crosscontact: the installation is damaged: {replaced} " in last
    assert "pip uninstall validation" in last
    assert bool(before) == (command[0] == "-c")  # Python's own traceback; none on the command line
