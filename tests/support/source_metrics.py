"""Figures of the source tree: modules, lines, import cycles, repeated class names, long functions, contracts.

``python tests/support/source_metrics.py [ROOT]`` prints them; ROOT is a checkout, by default this one.
"""

from __future__ import annotations

import ast
import io
import sys
import tokenize
from collections import Counter, defaultdict
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1]))  # where this file is run as a script

from support.import_graph import ImportGraph, read_sources

PACKAGES = ("contact_scene", "bem_solver", "fem_solver", "meshes", "validation", "crosscontact")
FORMER_PACKAGES = ("scene",)
"""Packages of older checkouts."""
LONG = 60
"""Lines from which a function counts as long."""
MANY = 4
"""Parameters from which a public function needs numpydoc Parameters and Returns."""
Function = ast.FunctionDef | ast.AsyncFunctionDef
_LAYOUT = {
    tokenize.COMMENT,
    tokenize.NL,
    tokenize.NEWLINE,
    tokenize.INDENT,
    tokenize.DEDENT,
    tokenize.ENDMARKER,
}


@dataclass(frozen=True)
class SourceMetrics:
    """What is counted in a source tree.

    Parameters
    ----------
    modules : int
    lines : mapping of str to Counter
        By package: ``total``, ``code``, ``docstrings``; the rest are comments and blank lines.
    cycles : list of list of str
        Groups of modules that import each other, in functions and for type checking too.
    repeated_classes : dict of str to list of str
        Modules by the name of a class that more than one of them defines.
    long_functions : dict of str to (int, int)
        Lines of functions of ``LONG`` lines and more, in all and without the docstring.
    documented, undocumented : list of str
        Public functions and methods of ``MANY`` parameters and more, with and without Parameters and, unless
        they return ``None``, Returns.
    """

    modules: int
    lines: dict[str, Counter[str]]
    cycles: list[list[str]]
    repeated_classes: dict[str, list[str]]
    long_functions: dict[str, tuple[int, int]]
    documented: list[str]
    undocumented: list[str]

    def __str__(self) -> str:
        total = sum(self.lines.values(), Counter())
        repeated = (f"{name}: {', '.join(modules)}" for name, modules in self.repeated_classes.items())
        long = (f"{name}: {n}, {m} without docstring" for name, (n, m) in self.long_functions.items())
        share = f"{len(self.documented)} of {len(self.documented) + len(self.undocumented)} public functions"
        sections: list[tuple[str, list[str]]] = [
            (f"{self.modules} modules", []),
            (_in_words(total), [f"{package}: {_in_words(count)}" for package, count in self.lines.items()]),
            (f"{len(self.cycles)} import cycles", [" <-> ".join(group) for group in self.cycles]),
            (f"{len(self.repeated_classes)} repeated class names", list(repeated)),
            (f"{len(self.long_functions)} functions of {LONG} lines and more", list(long)),
            (
                f"{share} of {MANY} parameters and more have Parameters and Returns, these not:",
                self.undocumented,
            ),
        ]
        return "\n".join(
            line for heading, entries in sections for line in (heading, *(f"  {entry}" for entry in entries))
        )


def measure(root: Path) -> SourceMetrics:
    """The figures of a checkout."""
    sources = read_sources(root, (*PACKAGES, *FORMER_PACKAGES))
    lines: defaultdict[str, Counter[str]] = defaultdict(Counter)
    classes: defaultdict[str, list[str]] = defaultdict(list)
    long: dict[str, tuple[int, int]] = {}
    documented, undocumented = [], []
    for name, source in sources.items():
        tree = ast.parse(source.text)
        lines[name.partition(".")[0]] += count_lines(source.text, tree)
        for node in ast.walk(tree):
            if isinstance(node, ast.ClassDef):
                classes[node.name].append(name)
            elif isinstance(node, Function) and (count := line_count(node)) >= LONG:
                docstring = 0 if ast.get_docstring(node) is None else line_count(node.body[0])
                long[f"{name}.{node.name}"] = count, count - docstring
        for owner, function in public_functions(tree):
            if count_parameters(function) >= MANY:
                (documented if has_contract(function) else undocumented).append(
                    f"{name}.{owner}{function.name}"
                )
    repeated = {name: modules for name, modules in sorted(classes.items()) if len(modules) > 1}
    return SourceMetrics(
        len(sources),
        dict(lines),
        ImportGraph(sources).cycles(),
        repeated,
        dict(sorted(long.items())),
        documented,
        undocumented,
    )


def line_count(node: ast.stmt) -> int:
    """Lines from the first to the last of a statement."""
    return (node.end_lineno or node.lineno) - node.lineno + 1


def count_lines(text: str, tree: ast.Module) -> Counter[str]:
    """Lines in all, of code, and of docstrings, those below constants and fields too."""
    docstrings: set[int] = set()
    for node in ast.walk(tree):
        match node:
            case ast.Expr(value=ast.Constant(value=str())):
                docstrings |= set(range(node.lineno, node.lineno + line_count(node)))
    code: set[int] = set()
    for token in tokenize.generate_tokens(io.StringIO(text).readline):
        if token.type not in _LAYOUT:
            code |= set(range(token.start[0], token.end[0] + 1))
    return Counter(total=len(text.splitlines()), code=len(code - docstrings), docstrings=len(docstrings))


def public_functions(tree: ast.Module) -> Iterator[tuple[str, Function]]:
    """Public functions of a module and public methods of its public classes, after ``Class.`` or nothing."""
    for node in tree.body:
        if isinstance(node, Function) and not node.name.startswith("_"):
            yield "", node
        elif isinstance(node, ast.ClassDef) and not node.name.startswith("_"):
            for method in node.body:
                if isinstance(method, Function) and not method.name.startswith("_"):
                    yield f"{node.name}.", method


def count_parameters(function: Function) -> int:
    """Number of named parameters, without ``self`` and ``cls``."""
    arguments = function.args
    names = [one.arg for one in (*arguments.posonlyargs, *arguments.args, *arguments.kwonlyargs)]
    return len(set(names) - {"self", "cls"})


def has_contract(function: Function) -> bool:
    """Whether the docstring has Parameters and, where something is returned, Returns or Yields."""
    text = ast.get_docstring(function) or ""
    returns_nothing = function.returns is not None and ast.unparse(function.returns) == "None"
    return "Parameters\n---" in text and (returns_nothing or "Returns\n---" in text or "Yields\n---" in text)


def _in_words(count: Counter[str]) -> str:
    return f"{count['total']} lines, {count['code']} of code, {count['docstrings']} of docstrings"


if __name__ == "__main__":
    print(measure(Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).parents[2]))
