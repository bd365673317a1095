"""The figures of a source tree, on a small one whose figures are known."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

from support import source_metrics

PROJECT = {
    "scene/__init__.py": '"""An older name of the package."""\n',
    "scene/one.py": '"""Head\nof two lines."""\n\nfrom scene import two  # comment\n\nLIMIT = 1\n'
    '"""A constant."""\n\n\nclass State:\n    pass\n',
    "scene/two.py": "def f():\n    from scene.one import LIMIT\n    return LIMIT\n"
    "\n\nclass State:\n    pass\n",
    "meshes/fit.py": "def long(a):\n    '''Two\n    lines.'''\n"
    + "    a += 1\n" * 57
    + "    return a\n\n\ndef short(a):\n    return a\n",
    "bem_solver/solver.py": '''
def complete(a, b, c, *, d) -> int:
    """Sum.

    Parameters
    ----------
    a, b, c, d : int

    Returns
    -------
    int
    """


def procedure(a, b, c, d) -> None:
    """Nothing to return.

    Parameters
    ----------
    a, b, c, d : int
    """


def without_returns(a, b, c, d) -> int:
    """Sum.

    Parameters
    ----------
    a, b, c, d : int
    """


def few(a, b, c):
    pass


def _private(a, b, c, d):
    pass


class Solver:
    def few(self, a, b, c):
        pass

    def bare(self, a, b, c, d):
        pass
''',
}


def write(root):
    for name, text in PROJECT.items():
        (root / name).parent.mkdir(parents=True, exist_ok=True)
        (root / name).write_text(text)


def test_every_figure_of_a_small_tree(tmp_path):
    write(tmp_path)
    found = source_metrics.measure(tmp_path)
    assert found.modules == 5
    assert dict(found.lines["scene"]) == {"total": 19, "code": 9, "docstrings": 4}
    assert dict(found.lines["meshes"]) == {"total": 65, "code": 61, "docstrings": 2}
    assert found.cycles == [["scene.one", "scene.two"]]
    assert found.repeated_classes == {"State": ["scene.one", "scene.two"]}
    assert found.long_functions == {"meshes.fit.long": (61, 59)}
    assert found.documented == ["bem_solver.solver.complete", "bem_solver.solver.procedure"]
    assert found.undocumented == ["bem_solver.solver.without_returns", "bem_solver.solver.Solver.bare"]


def test_the_script_prints_them(tmp_path):
    write(tmp_path)
    command = [sys.executable, source_metrics.__file__, str(tmp_path)]
    run = subprocess.run(command, capture_output=True, text=True, check=True, cwd=Path(tmp_path))
    lines = run.stdout.splitlines()
    assert lines[0] == "5 modules"
    assert "1 import cycles" in lines
    assert "  scene.one <-> scene.two" in lines
    assert lines[-1] == "  bem_solver.solver.Solver.bare"
