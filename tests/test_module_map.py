"""The map from modules to their tests: a line for every module, no other, tests that do reach it."""

from __future__ import annotations

from support.module_map import MAP, Reach, read, written

AGAIN = "python tests/support/module_map.py writes the map anew"


def test_every_module_has_a_line_and_every_line_a_module_and_tests_that_reach_it():
    reach, stated = Reach(), read(MAP.read_text(encoding="utf-8"))
    assert set(stated) == set(read(written(reach))), AGAIN
    untested = reach.modules - set(stated)
    assert not untested, f"reached by no test: {sorted(untested)}"
    dead = [
        f"{module}: {test}"
        for module, tests in stated.items()
        for test in tests
        if module not in reach.distances.get(test, {})
    ]
    assert not dead, "\n".join([AGAIN, *dead])


def test_the_map_is_worked_out_from_imports_helpers_and_passed_on_names(tmp_path):
    files = {
        "solver/__init__.py": "from .creep import Chain\n",
        "solver/creep.py": "from .roots import bisect\nTWO = 2\n",
        "solver/roots.py": "import math\nTWO = 2\n",
        "solver/alone.py": "import math\nTWO = 2\n",
        "tests/support/runs.py": "from solver import roots\n",
        "tests/solver_tests/test_creep.py": "from solver import Chain\n",
        "tests/solver_tests/test_solver.py": "from support.runs import x\nfrom solver import Chain\n",
    }
    for name, text in files.items():
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text(text)
    found = read(written(Reach(tmp_path, ["solver"])))
    assert "solver.alone" not in found  # and the package is but one line
    assert found["solver.creep"][0] == "tests/solver_tests/test_creep.py"
    assert found["solver.roots"] == ["tests/solver_tests/test_solver.py"]
