"""The imports between modules, read from their sources, those in functions and for type checking too."""

from __future__ import annotations

import ast
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from functools import cache, cached_property
from pathlib import Path

COMPUTED = "a computed module name"
IMPORTING = ("import_module", "__import__")
"""Functions that import what they are told."""


@dataclass(frozen=True)
class Source:
    """A module's text; ``is_package`` for the ``__init__`` of a package."""

    text: str
    is_package: bool = False

    @cached_property
    def tree(self) -> ast.Module:
        """The parsed text."""
        return ast.parse(self.text)


@dataclass(frozen=True)
class Import:
    """One imported module, by its full name as far as that is a module.

    ``name`` is what is imported from it ("" for the module itself); ``deferred`` where a bare import of the
    importing module does not carry it out: inside a function, or under ``TYPE_CHECKING``.
    """

    importer: str
    module: str
    name: str
    line: int
    deferred: bool

    def __str__(self) -> str:
        return f"{self.importer}:{self.line} imports {self.module}{':' + self.name if self.name else ''}"


@cache
def source_at(path: Path) -> Source:
    """The module in a file; no file is read and parsed twice."""
    return Source(path.read_text(encoding="utf-8"), path.stem == "__init__")


def read_sources(root: Path, packages: Iterable[str]) -> dict[str, Source]:
    """Every module below the packages, by its full name."""
    sources = {}
    for package in packages:
        for path in sorted((root / package).rglob("*.py")):
            parts = path.relative_to(root).with_suffix("").parts
            source = source_at(path)
            sources[".".join(parts[:-1] if source.is_package else parts)] = source
    return sources


def imports(module: str, source: Source, modules: Iterable[str] = ()) -> list[Import]:
    """All imports of a source; ``modules`` tells ``from package import module`` from an imported name."""
    known = set(modules)
    package = module if source.is_package else module.rpartition(".")[0]
    found: list[Import] = []

    def add(node: ast.AST, target: str, name: str, deferred: bool) -> None:
        if name and f"{target}.{name}" in known:
            target, name = f"{target}.{name}", ""
        found.append(Import(module, target, name, getattr(node, "lineno", 0), deferred))

    computed = any(name in source.text for name in IMPORTING)
    for node, deferred in _walk(source.tree, False, computed):
        match node:
            case ast.Import():
                for alias in node.names:
                    add(node, alias.name, "", deferred)
            case ast.ImportFrom():
                for alias in node.names:
                    add(node, _absolute(node, package), alias.name, deferred)
            case ast.Call() if _called(node) in IMPORTING:
                first = node.args[0] if node.args else None
                literal = isinstance(first, ast.Constant) and isinstance(first.value, str)
                add(node, first.value if literal else COMPUTED, "", deferred)  # type: ignore[union-attr]
    return found


def _walk(node: ast.AST, deferred: bool, expressions: bool) -> Iterator[tuple[ast.AST, bool]]:
    """Every statement below, with whether a bare import of the module leaves it out; expressions if asked."""
    yield node, deferred
    if isinstance(node, ast.If) and "TYPE_CHECKING" in ast.dump(node.test):
        for child in node.body:
            yield from _walk(child, True, expressions)
        for child in node.orelse:
            yield from _walk(child, deferred, expressions)
        return
    inside = deferred or isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef | ast.Lambda)
    for child in ast.iter_child_nodes(node):
        if expressions or not isinstance(child, ast.expr):
            yield from _walk(child, inside, expressions)


def _absolute(node: ast.ImportFrom, package: str) -> str:
    if not node.level:
        return str(node.module)
    parent = package.split(".")[: len(package.split(".")) - node.level + 1]
    return ".".join([*parent, *([node.module] if node.module else [])])


def _called(node: ast.Call) -> str:
    return node.func.attr if isinstance(node.func, ast.Attribute) else getattr(node.func, "id", "")


class ImportGraph:
    """The modules of some packages and every import between them, whatever its form."""

    @staticmethod
    @cache
    def of(root: Path, packages: tuple[str, ...]) -> ImportGraph:
        """Of every module below the packages."""
        return ImportGraph(read_sources(root, packages))

    def __init__(self, sources: Mapping[str, Source]) -> None:
        self.sources = sources
        self.modules = set(sources)
        self.by_importer = {name: imports(name, source, self.modules) for name, source in sources.items()}
        self.imports = [found for one in self.by_importer.values() for found in one]

    def targets(self, module: str, deferred: bool = True) -> set[str]:
        """Modules of ours that ``module`` names in an import; ``deferred``: those of functions too."""
        named = {i.module for i in self.by_importer[module] if deferred or not i.deferred}
        return (named & self.modules) - {module}

    def cycles(self) -> list[list[str]]:
        """The groups of modules that import each other (strongly connected components), sorted."""
        edges = {module: self.targets(module) for module in self.modules}
        reach = {module: _reachable(edges, module) for module in self.modules}
        groups = {
            tuple(sorted({other for other in reach[module] if module in reach[other]}))
            for module in self.modules
            if module in reach[module]
        }
        return sorted(list(group) for group in groups)

    def loads(self, names: Iterable[str]) -> set[str]:
        """Modules of ours whose bare import loads one of the top-level packages ``names``."""
        wanted = set(names)
        edges: dict[str, set[str]] = {module: set() for module in self.modules}
        direct = set()
        for found in self.imports:
            if found.deferred:
                continue
            edges[found.importer] |= _with_parents(found.module) & self.modules
            if found.module.split(".")[0] in wanted:
                direct.add(found.importer)
        for module in self.modules:
            edges[module] |= _with_parents(module) & self.modules
        return {module for module in self.modules if ({module} | _reachable(edges, module)) & direct}


def _with_parents(module: str) -> set[str]:
    parts = module.split(".")
    return {".".join(parts[: n + 1]) for n in range(len(parts))}


def _reachable(edges: Mapping[str, set[str]], start: str) -> set[str]:
    """What is reached from ``start`` by one edge or more."""
    reached: set[str] = set()
    pending = list(edges[start])
    while pending:
        module = pending.pop()
        if module not in reached:
            reached.add(module)
            pending.extend(edges[module])
    return reached
