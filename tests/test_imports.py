"""Who may import whom, read from the sources, and what a bare import loads."""

from __future__ import annotations

import ast
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]

# The solvers share the question, never the method: a common helper would be a common error.
MAY_IMPORT = {
    "contact_scene": set(),
    "bem_solver": {"contact_scene"},
    "fem_solver": {"contact_scene"},
    "meshes": set(),
    "validation": {"contact_scene", "bem_solver", "fem_solver", "meshes"},
    "crosscontact": {"contact_scene", "bem_solver", "fem_solver", "meshes", "validation"},
}
HEAVY = ("skfem", "gmsh", "pyvista", "matplotlib", "meshio")


def imported(source: str, package: str) -> set[str]:
    """Top-level names imported anywhere in a source, functions and ``importlib`` calls included."""
    names = set()
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.Import):
            names |= {alias.name.split(".")[0] for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            names.add(package if node.level else str(node.module).split(".")[0])
        elif isinstance(node, ast.Call):
            called = node.func.attr if isinstance(node.func, ast.Attribute) else getattr(node.func, "id", "")
            if called in ("import_module", "__import__"):
                first = node.args[0]
                names.add(
                    first.value.split(".")[0] if isinstance(first, ast.Constant) else "a computed module name"
                )
    return names


@pytest.mark.parametrize("package", MAY_IMPORT)
def test_imports_keep_to_the_table(package):
    sources = sorted((ROOT / package).rglob("*.py"))
    assert sources
    ours = set(MAY_IMPORT) | {"tests", "a computed module name"}
    for path in sources:
        found = imported(path.read_text(encoding="utf-8"), package) & ours
        assert found <= MAY_IMPORT[package] | {package}, path.relative_to(ROOT)


def test_the_reader_of_imports_sees_every_form():
    source = (
        "import a.b, c as d\nfrom e.f import g\nfrom . import h\nfrom .i import j\n"
        "def k():\n    import l\n    importlib.import_module('m.n')\n    __import__('o')\n"
        "    import_module(name)\n"
    )
    assert imported(source, "ours") == {"a", "c", "e", "ours", "l", "m", "o", "a computed module name"}


@pytest.mark.parametrize("package", ["contact_scene", "bem_solver"])
def test_light_packages_load_nothing_heavy(package):
    code = f"import sys, {package}; print(*sorted({{m.split('.')[0] for m in sys.modules}}))"
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True, cwd=ROOT)
    loaded = run.stdout.split()
    assert package in loaded
    assert not set(loaded) & set(HEAVY)
    assert not set(loaded) & (set(MAY_IMPORT) - MAY_IMPORT[package] - {package})
