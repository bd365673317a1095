"""Who may import whom, read from the sources, and what a bare import loads."""

from __future__ import annotations

import ast
import os
import subprocess
import sys
from functools import cache
from pathlib import Path

import pytest
from support.import_graph import COMPUTED, ImportGraph, Source, imports, source_at

ROOT = Path(__file__).parents[1]
TESTS = ROOT / "tests"

# The solvers share the question, never the method: a common helper would be a common error.
PACKAGES = {
    "contact_scene": set(),
    "bem_solver": {"contact_scene"},
    "fem_solver": {"contact_scene"},
    "meshes": set(),
    "validation": {"contact_scene", "bem_solver", "fem_solver", "meshes"},
    # The door imports the file of a command by its name.
    "crosscontact": {"contact_scene", "bem_solver", "fem_solver", "meshes", "validation", COMPUTED},
    # What only the authors run; nothing imports it but its tests, and it is not installed.
    "benchmarks": {"contact_scene", "bem_solver", "fem_solver", "meshes", "validation", "crosscontact"},
}
# Inside ``validation``, upwards only: exact solutions, scenes and solvers; measuring, and carrying out runs,
# which measures each at its end; drawing; six kinds of evidence beside each other, fits of measured curves
# among them, which compare runs with a record instead of another run; sweeps, which ask for runs as the
# evidence does and judge nothing. The report is a model of documents with its renderers, below all evidence:
# each kind hands in its own chapter.
BELOW_RUNS = {"reference", "scenes", "solvers", "cases"}
BELOW_REPORT = BELOW_RUNS | {"measure", "runs", "drawing"}
BELOW_EVIDENCE = BELOW_REPORT | {"report"}
EVIDENCE = {"compare", "studies", "stability", "claims", "fields", "fits"}
ROOMS = {
    "reference": set(),
    "scenes": set(),
    "solvers": {"reference"},
    "cases": {"scenes", "solvers"},  # a scene states tolerances for solvers by their names
    "measure": BELOW_RUNS,
    "runs": BELOW_RUNS | {"measure"},
    "drawing": BELOW_RUNS | {"measure", "runs"},
    **dict.fromkeys(EVIDENCE, BELOW_EVIDENCE),
    "sweeps": BELOW_EVIDENCE,
    # Beside the evidence: it judges answers of other codes, as the evidence does runs of our solvers.
    "exam": BELOW_EVIDENCE,
    "report": BELOW_REPORT,
}
# Packages that a function may import to keep them unloaded: each takes from a tenth of a second to seconds,
# or need not be installed.
HEAVY = {"skfem", "gmsh", "pyvista", "vtk", "vtkmodules", "meshio", "matplotlib", "PIL", "pandas", "xarray"}
HEAVY |= {"dask", "distributed", "h5py", "pyarrow", "afmformats"}
HEAVY |= {"tamaas", "ContactMechanics", "SurfaceTopography", "Adhesion"}
# Packages that a function may import because a run that does not call it would load them for nothing: each
# part of SciPy takes longer than a small scene; a bar is drawn on a terminal only; what is known about
# installed packages is read by the parser of e-mail.
LARGE = {"scipy", "importlib"}
# Modules that load light names too at first use: importing the user's interface may take 0.15 s, and a list
# of scenes, --help and --version come at once; NumPy and SciPy alone take longer.
LOADED_AT_FIRST_USE = {"crosscontact", "crosscontact.cli", "crosscontact.commands"}
# A solver is loaded where it is looked up.
LOADED_AT_FIRST_USE |= {"validation.solvers.registry"}

# Readers that carry out what a file says. Between live processes bytes are pickled, and none of them lie on a
# disk.
EXECUTING = {"pickle", "_pickle", "cPickle", "marshal", "shelve", "dill", "cloudpickle", "joblib"}
BETWEEN_PROCESSES = {("validation.runs.pool", "pickle")}


def project() -> ImportGraph:
    """The imports of all packages."""
    return ImportGraph.of(ROOT, tuple(PACKAGES))


def room(module: str) -> str:
    """The part of ``validation`` a module belongs to."""
    return module.split(".")[1] if module.startswith("validation.") else ""


def against_the_table(graph: ImportGraph) -> list[str]:
    """Imports of a package of ours, of tests, or of a computed name, that ``PACKAGES`` does not allow."""
    ours = set(PACKAGES) | {"tests", "support", COMPUTED}
    found = []
    for one in graph.imports:
        importer, target = one.importer.split(".")[0], one.module.split(".")[0]
        if target in ours - PACKAGES[importer] - {importer}:
            found.append(str(one))
    return found


def against_the_layers(graph: ImportGraph) -> list[str]:
    """Imports inside ``validation`` that run down again or across the evidence, and rooms without a layer."""
    found = [
        f"{module}: no layer for it"
        for module in sorted(graph.modules)
        if room(module) and room(module) not in ROOMS
    ]
    for one in graph.imports:
        if not one.module.startswith("validation") or not one.importer.startswith("validation"):
            continue
        importer, target = room(one.importer), room(one.module)
        if target in {"", importer}:
            continue
        if target not in ROOMS.get(importer, set()):
            found.append(str(one))
    return found


def deferred_without_need(graph: ImportGraph) -> list[str]:
    """Imports in functions or under ``TYPE_CHECKING`` that do not keep a heavy package unloaded."""
    loading = graph.loads(HEAVY)
    return [
        str(one)
        for one in graph.imports
        if one.deferred
        and one.importer not in LOADED_AT_FIRST_USE
        and one.module.split(".")[0] not in HEAVY | LARGE
        and one.module not in loading
    ]


def executing_readers(graph: ImportGraph) -> list[str]:
    """Imports of what executes the files that it reads, and calls that let NumPy or pandas do so."""
    found = [
        str(one)
        for one in graph.imports
        if EXECUTING & {one.module.split(".")[0], one.name}
        and (one.importer, one.module) not in BETWEEN_PROCESSES
    ]
    for name, source in graph.sources.items():
        for node in ast.walk(source.tree) if "pickle" in source.text else ():
            called = getattr(node, "attr", getattr(node, "id", ""))
            never = isinstance(node, ast.keyword) and getattr(node.value, "value", None) is False
            if called == "read_pickle" or (getattr(node, "arg", "") == "allow_pickle" and not never):
                found.append(f"{name} reads pickles")
    return found


def report(found: list[str]) -> str:
    return "\n" + "\n".join(found)


def test_imports_keep_to_the_table():
    assert {module.split(".")[0] for module in project().modules} == set(PACKAGES)
    found = against_the_table(project())
    assert not found, report(found)


def test_imports_inside_validation_run_upwards():
    found = against_the_layers(project())
    assert not found, report(found)


def test_every_layer_and_every_deferred_import_exists():
    assert {room(module) for module in project().modules} - {""} == set(ROOMS)
    assert project().modules >= LOADED_AT_FIRST_USE


def test_no_module_executes_what_it_reads():
    found = executing_readers(project())
    assert not found, report(found)
    assert {(one.importer, one.module) for one in project().imports} >= BETWEEN_PROCESSES


@pytest.mark.parametrize(
    "line",
    [
        "import pickle",
        "def f():\n    from shelve import open",
        "from multiprocessing.reduction import pickle",
        "import numpy as np\nnp.load('a.npz', allow_pickle=True)",
        "import numpy as np\nnp.load('a.npz', allow_pickle=trusted)",
        "import pandas\npandas.read_pickle('a')",
        "from pandas import read_pickle\nread_pickle('a')",
    ],
)
def test_a_reader_that_executes_is_seen(line):
    assert executing_readers(made_up(validation__store=line))
    assert not executing_readers(made_up(validation__store="import numpy\nnumpy.load(f, allow_pickle=False)"))


def test_there_is_no_cycle_of_imports():
    found = [" <-> ".join(group) for group in project().cycles()]
    assert not found, report(found)


def test_functions_import_only_what_is_heavy():
    found = deferred_without_need(project())
    assert not found, report(found)


def made_up(**texts: str) -> ImportGraph:
    """A project of the given modules (``__`` for the dot); names without a dot are packages."""
    return ImportGraph(
        {
            name.replace("__", "."): Source(text, is_package="__" not in name)
            for name, text in {"validation": "", "bem_solver": "", **texts}.items()
        }
    )


LIGHT = ("contact_scene", "bem_solver", "validation.solvers", "crosscontact")
"""Each may import all that those before it may: what it loads is seen though they are loaded already."""


@cache
def loaded_by_light_packages() -> list[set[str]]:
    """What one process has loaded after each of them."""
    code = "".join(
        f"import sys, {package}; print(*sorted({{m.split('.')[0] for m in sys.modules}}))\n"
        for package in LIGHT
    )
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True, cwd=ROOT)
    return [set(line.split()) for line in run.stdout.splitlines()]


@pytest.mark.parametrize("package", LIGHT)
def test_light_packages_load_nothing_heavy(package):
    loaded = loaded_by_light_packages()[LIGHT.index(package)]
    top = package.partition(".")[0]
    before = [name.partition(".")[0] for name in LIGHT[: LIGHT.index(package)]]
    assert PACKAGES[top] >= {one for name in before for one in (name, *PACKAGES[name])}
    assert top in loaded
    assert not loaded & HEAVY
    assert not loaded & (set(PACKAGES) - PACKAGES[top] - {top})


OWN_EVIDENCE = {
    "compare": {"compare"}, "study": {"studies"}, "stability": {"stability"}, "fields": {"fields"},
    "exam": {"exam"}, "judge": {"exam"}, "fit": {"fits"}, "sweep": {"sweeps"}, "material": set(),
    "solve": set(),
}  # fmt: skip
"""Evidence of ``validation`` that each command may load."""


@pytest.mark.skipif(not hasattr(os, "fork"), reason="one process for each command would take seconds")
def test_a_command_loads_its_own_evidence_alone():
    code = (
        "import importlib, os, sys, crosscontact.commands.solve\n"
        f"for command in {list(OWN_EVIDENCE)}:\n"
        "    if os.fork() == 0:\n"
        "        importlib.import_module(f'crosscontact.commands.{command}')\n"
        "        rooms = {name.split('.')[1] for name in sys.modules if name.startswith('validation.')}\n"
        "        print(command, *rooms, flush=True)\n"
        "        os._exit(0)\n"
        "    os.wait()\n"
    )
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True, cwd=ROOT)
    loaded = {command: set(rooms) for command, *rooms in map(str.split, run.stdout.splitlines())}
    found = {command: rooms & {*EVIDENCE, "exam", "sweeps"} for command, rooms in loaded.items()}
    assert found == OWN_EVIDENCE


def test_no_test_imports_another_and_no_folder_of_tests_shadows_a_package():
    files = {path.stem: path for path in TESTS.rglob("test_*.py")}
    found = [
        f"{path.relative_to(ROOT)} imports {one.module}"
        for path in TESTS.rglob("*.py")
        for one in imports(path.stem, source_at(path))
        if one.module.split(".")[0] in files or (one.module.split(".")[0] == "tests")
    ]
    assert not found, report(found)
    folders = {path.name for path in TESTS.rglob("*") if path.is_dir()}
    assert not folders & set(PACKAGES)
