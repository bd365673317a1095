"""Who may import whom, read from the sources, and what a bare import loads."""

from __future__ import annotations

import ast
import os
import subprocess
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from graphlib import CycleError, TopologicalSorter
from pathlib import Path

import pytest

from crosscontact.commands import COMMANDS

ROOT = Path(__file__).parents[1]
TESTS = ROOT / "tests"
COMPUTED = "a computed module name"

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
HEAVY |= {"dask", "distributed", "h5py", "pyarrow", "afmformats", "igor2", "pyfmreader", "bokeh"}
HEAVY |= {"emcee", "corner", "tamaas", "ContactMechanics", "SurfaceTopography", "Adhesion"}
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


@dataclass(frozen=True)
class Import:
    """One imported module, by its full name; ``name`` is what is imported from it, if that is no module.

    ``deferred``: a bare import of the importing module does not carry it out, for it stands in a function or
    under ``TYPE_CHECKING``.
    """

    importer: str
    module: str
    name: str
    line: int
    deferred: bool

    def __str__(self) -> str:
        return f"{self.importer}:{self.line} imports {self.module}{':' + self.name if self.name else ''}"


@cache
def sources() -> dict[str, ast.Module]:
    """Every module of the packages by its full name, parsed."""
    found = {}
    for path in sorted(path for package in PACKAGES for path in (ROOT / package).rglob("*.py")):
        parts = path.relative_to(ROOT).with_suffix("").parts
        name = ".".join(parts[:-1] if path.stem == "__init__" else parts)
        found[name] = ast.parse(path.read_text(encoding="utf-8"))
    return found


def imports(module: str, tree: ast.Module) -> Iterator[Import]:
    """All imports of a module."""

    left: list[tuple[ast.AST, bool]] = [(tree, False)]
    while left:
        node, deferred = left.pop()
        typing = node.body if isinstance(node, ast.If) and "TYPE_CHECKING" in ast.dump(node.test) else ()
        inside = deferred or isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef | ast.Lambda)
        left += [(child, inside or child in typing) for child in ast.iter_child_nodes(node)]
        match node:
            case ast.Import(names):
                yield from (Import(module, one.name, "", node.lineno, deferred) for one in names)
            case ast.ImportFrom(str(target), names, 0):
                for one in names:
                    inner = f"{target}.{one.name}"
                    found = (inner, "") if inner in sources() else (target, one.name)
                    yield Import(module, *found, node.lineno, deferred)
            case ast.ImportFrom():
                raise AssertionError(f"{module}: imports are absolute")
            case ast.Call(ast.Name("import_module" | "__import__") | ast.Attribute(attr="import_module")):
                stated = node.args[0] if node.args else None
                target = str(stated.value) if isinstance(stated, ast.Constant) else COMPUTED
                yield Import(module, target, "", node.lineno, deferred)


@cache
def all_imports() -> list[Import]:
    """Those of all packages."""
    return [one for module, tree in sources().items() for one in imports(module, tree)]


def room(module: str) -> str:
    """The part of ``validation`` a module belongs to."""
    return module.split(".")[1] if module.startswith("validation.") else ""


def top(module: str) -> str:
    return module.split(".")[0]


def packages(module: str) -> set[str]:
    """A module and the packages around it, which are loaded with it."""
    parts = module.split(".")
    return {".".join(parts[: n + 1]) for n in range(len(parts))}


def none(found: list[str]) -> None:
    assert not found, "\n" + "\n".join(found)


def test_imports_keep_to_the_table():
    ours = set(PACKAGES) | {"tests", "support", COMPUTED}
    assert {top(module) for module in sources()} == set(PACKAGES)
    none(
        [
            str(i)
            for i in all_imports()
            if top(i.module) in ours - PACKAGES[top(i.importer)] - {top(i.importer)}
        ]
    )


def test_imports_inside_validation_run_upwards():
    assert {room(module) for module in sources()} - {""} == set(ROOMS)
    inside = [i for i in all_imports() if i.importer.startswith("validation") and room(i.module)]
    none(
        [str(i) for i in inside if room(i.module) not in {room(i.importer), *ROOMS.get(room(i.importer), ())}]
    )


def test_there_is_no_cycle_of_imports():
    edges: dict[str, set[str]] = {module: set() for module in sources()}
    for one in all_imports():
        if one.module in sources() and one.module != one.importer:
            edges[one.importer].add(one.module)
    cycle: list[str] = []
    try:
        TopologicalSorter(edges).prepare()
    except CycleError as error:
        cycle = error.args[1]
    assert cycle == []


def test_functions_import_only_what_is_heavy():
    """Or what loads it."""
    assert sources().keys() >= LOADED_AT_FIRST_USE
    loading = {i.importer for i in all_imports() if not i.deferred and top(i.module) in HEAVY}
    while (
        more := {i.importer for i in all_imports() if not i.deferred and loading & packages(i.module)}
        - loading
    ):
        loading |= more
    none(
        [
            str(i)
            for i in all_imports()
            if i.deferred
            and i.importer not in LOADED_AT_FIRST_USE
            and top(i.module) not in HEAVY | LARGE
            and not loading & packages(i.module)
        ]
    )


def test_no_module_executes_what_it_reads():
    """Nor lets NumPy or pandas do so."""
    executing = [i for i in all_imports() if EXECUTING & {top(i.module), i.name}]
    assert {(i.importer, i.module) for i in executing} == BETWEEN_PROCESSES
    for name, tree in sources().items():
        for node in ast.walk(tree):
            match node:
                case ast.keyword("allow_pickle", ast.Constant(False)):
                    pass
                case (
                    ast.keyword("allow_pickle") | ast.Attribute(attr="read_pickle") | ast.Name("read_pickle")
                ):
                    pytest.fail(f"{name} reads pickles")


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
    before = [name.partition(".")[0] for name in LIGHT[: LIGHT.index(package)]]
    assert PACKAGES[top(package)] >= {one for name in before for one in (name, *PACKAGES[name])}
    assert top(package) in loaded
    assert not loaded & HEAVY
    assert not loaded & (set(PACKAGES) - PACKAGES[top(package)] - {top(package)})


OWN_EVIDENCE = {
    "compare": {"compare"}, "study": {"studies"}, "stability": {"stability"}, "fields": {"fields"},
    "exam": {"exam"}, "judge": {"exam"}, "fit": {"fits"}, "curve": {"fits"}, "sweep": {"sweeps"},
    "explore": {"sweeps"},
}  # fmt: skip
"""Evidence of ``validation`` that a command may load; others none, ``report`` any."""


@pytest.mark.skipif(not hasattr(os, "fork"), reason="one process for each command would take seconds")
def test_a_command_loads_its_own_evidence_alone():
    """Asked of one process a command, split from one that has loaded the parts of SciPy they share."""
    commands = [name for name in COMMANDS if name != "report"]
    code = (
        "import importlib, os, sys, scipy.interpolate, crosscontact.commands.solve\n"
        f"for command in {commands}:\n"
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
    assert found == {name: OWN_EVIDENCE.get(name, set()) for name in commands}


def test_no_test_imports_another_and_no_folder_of_tests_shadows_a_package():
    files = {path.stem: path for path in TESTS.rglob("test_*.py")}
    none(
        [
            f"{path.relative_to(ROOT)} imports {one.module}"
            for path in TESTS.rglob("*.py")
            for one in imports(path.stem, ast.parse(path.read_text(encoding="utf-8")))
            if top(one.module) in {*files, "tests"}
        ]
    )
    folders = {path.name for path in TESTS.rglob("*") if path.is_dir()}
    assert not folders & set(PACKAGES)
