"""Size of the house, part by part: ``python benchmarks/house.py [ROOT]``; ROOT: a checkout, else this one.

Lines as ``wc -l`` counts them; names without a leading underscore defined at the top of a module; names of
our own that its modules import for 1000 lines; share of docstrings.
"""

from __future__ import annotations

import ast
import sys
from collections.abc import Iterator
from pathlib import Path

PARTS = (
    "contact_scene", "bem_solver", "fem_solver", "meshes", "validation/reference", "validation",
    "crosscontact", "benchmarks", "docs", "tests",
)  # fmt: skip
OWN = {"contact_scene", "bem_solver", "fem_solver", "meshes", "validation", "crosscontact"}


def part_of(file: Path) -> str:
    """The part a file belongs to: the longest that its path begins with."""
    return max((part for part in PARTS if file.is_relative_to(part)), key=len, default="")


def figures(text: str) -> Iterator[int]:
    """Lines, public definitions, own names imported and lines of docstrings of a module."""
    tree = ast.parse(text)
    definitions = (ast.FunctionDef, ast.AsyncFunctionDef, ast.ClassDef)
    yield text.count("\n")
    yield sum(isinstance(one, definitions) and one.name[0] != "_" for one in tree.body)
    imports = [one for one in ast.walk(tree) if isinstance(one, ast.ImportFrom)]
    yield sum(len(one.names) for one in imports if (one.module or "").split(".")[0] in OWN)
    documented = (one for one in ast.walk(tree) if isinstance(one, (*definitions, ast.Module)))
    yield sum(len((ast.get_docstring(one, clean=False) or "").splitlines()) for one in documented)


def main(root: Path) -> None:
    """Print a row a part."""
    total = {part: [0, 0, 0, 0, 0] for part in PARTS}
    for part in {part.split("/")[0] for part in PARTS}:
        for file in (root / part).rglob("*.py"):
            row = total[part_of(file.relative_to(root))]
            for index, figure in enumerate((1, *figures(file.read_text("utf-8")))):
                row[index] += figure
    print(f"{'part':22}{'lines':>8}{'modules':>9}{'public':>8}{'own/1000':>10}{'docstrings':>12}")
    for part, (modules, lines, public, own, docs) in total.items():
        density = 1000.0 * own / max(lines, 1)
        print(f"{part:22}{lines:8}{modules:9}{public:8}{density:10.0f}{docs / max(lines, 1):12.0%}")
    outside = [row for part, row in total.items() if part not in ("tests", "docs")]
    print(f"{'outside tests, docs':22}{sum(row[1] for row in outside):8}{sum(row[0] for row in outside):9}")


if __name__ == "__main__":
    main(Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).parents[1])
