"""Which tests a module of the packages has, worked out from imports; ``tests/MAP.md`` holds a line a module.

``python tests/support/module_map.py`` writes the map anew where a module or a test has been added or renamed.
"""

from __future__ import annotations

import sys
from collections.abc import Iterable, Mapping
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1]))  # where this file is run as a script

from support.import_graph import Import, ImportGraph, imports, source_at

ROOT = Path(__file__).parents[2]
MAP = ROOT / "tests" / "MAP.md"
PACKAGES = ("contact_scene", "bem_solver", "fem_solver", "meshes", "validation", "crosscontact", "benchmarks")
GROUPS = {"contact_scene": "scene", "bem_solver": "bem", "fem_solver": "fem", "meshes": "mesh"}
MOST = 3  # tests named in a line
HEAD = """# Where each module is tested

Written by `python tests/support/module_map.py`: the tests that import a module, those named after it first,
then those that import little else; where none does, those nearest to it through other modules.

"""


class Reach:
    """How far each test is from each module, in imports."""

    def __init__(self, root: Path = ROOT, packages: Iterable[str] = PACKAGES) -> None:
        self.graph = ImportGraph.of(root, tuple(packages))
        # a package that says nothing but what it is, what only starts the command line, and what only the
        # authors run, have no tests
        self.modules = {
            name
            for name, source in self.graph.sources.items()
            if not name.endswith("__main__")
            and not name.startswith("benchmarks")
            and len(source.tree.body) > 1
        }
        self.tests = {path.relative_to(root).as_posix(): path for path in (root / "tests").rglob("test_*.py")}
        support = {
            ".".join(path.relative_to(root / "tests").with_suffix("").parts): path
            for path in (root / "tests" / "support").rglob("*.py")
        }
        known = self.graph.modules | set(support)
        self._edges = {module: self._named(found) for module, found in self.graph.by_importer.items()}
        for name, path in (*support.items(), *self.tests.items()):
            self._edges[name] = self._named(imports(name, source_at(path), known)) & known
        self._known = set(self._edges)
        self.distances = {name: self._distances(name) for name in self.tests}
        self._sizes = {test: sum(d == 1 for d in found.values()) for test, found in self.distances.items()}
        self._words = {name: set(path.stem.split("_")) for name, path in self.tests.items()}
        self._groups = {name: path.parent.name for name, path in self.tests.items()}

    def _named(self, found: Iterable[Import]) -> set[str]:
        """The imported modules; a name that a package passes on counts for the module it is from."""
        origins = {
            i.module
            for one in found
            for i in self.graph.by_importer.get(one.module, ())
            if i.name == one.name != ""
        }
        return {one.module for one in found} | origins

    def _distances(self, start: str) -> dict[str, int]:
        """Number of imports from a test to every module it reaches; helpers of the tests are no step."""
        distances, level, steps = {start: 0}, [start], 0
        while level:
            steps += 1
            following = []
            while level:
                for module in (self._edges[level.pop()] & self._known).difference(distances):
                    distances[module] = steps
                    (level if module.startswith("support") else following).append(module)
            level = following
        return distances

    def nearest(self, module: str) -> list[str]:
        """The tests of a module: named after it, or nearest to it; of its group and of few modules first."""
        words = set(module.split(".")[-1].split("_"))
        group = GROUPS.get(module.split(".")[0], module.split(".")[min(1, module.count("."))])

        def rank(test: str) -> tuple:
            distance = self.distances[test][module]
            named = len(words & self._words[test]) / len(words)
            size = self._sizes[test]
            stranger = self._groups[test] != group
            if distance == 1 or (distance == 2 and not stranger and named > 0.5):
                return -named if named > 0.5 else 0.0, 1, stranger, size, test
            return 0.0, distance + stranger, stranger, size, test

        reaching = [t for t in self.tests if module in self.distances[t] and "benchmark" not in t]
        ranked = sorted(rank(test) for test in reaching)
        return [test for *order, test in ranked if tuple(order[:2]) <= (0.0, ranked[0][1])][:MOST]


def written(reach: Reach) -> str:
    """The text of the map."""
    lines = []
    for module in sorted(reach.modules):
        if tests := reach.nearest(module):
            names = ", ".join(test.removeprefix("tests/") for test in tests)
            lines.append(f"- `{module}`: {names}")
    return HEAD + "\n".join(lines) + "\n"


def read(text: str) -> Mapping[str, list[str]]:
    """Tests by module, as the map says."""
    entries = [line[3:].split("`: ") for line in text.splitlines() if line.startswith("- `")]
    return {module: [f"tests/{name}" for name in names.split(", ")] for module, names in entries}


if __name__ == "__main__":
    MAP.write_text(written(Reach()), encoding="utf-8")
    sys.stdout.write(f"{MAP.relative_to(ROOT)} written\n")
