"""Tests with the lowest stated versions of dependencies: ``python tests/support/lowest_versions.py [TESTS]``.

Needs the extra ``release`` and a package index. The environment is made anew in ``out/lowest``.
"""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).parents[2]
ENVIRONMENT = ROOT / "out" / "lowest"
TESTS = (
    "tests/door",
    "tests/scene",
    "tests/measure",
    "tests/mesh",
    "tests/report",
    "tests/fields",
    "tests/sweeps",
)
"""Tests that reach every dependency."""


def main(tests: list[str]) -> int:
    """Install and test; returns the exit code of the tests."""
    uv = [sys.executable, "-m", "uv"]
    python = str(ENVIRONMENT / "bin" / "python")
    subprocess.run([*uv, "venv", "--quiet", "--clear", "--python", sys.executable, ENVIRONMENT], check=True)
    install = [*uv, "pip", "install", "--quiet", "--python", python]
    lowest = ["--resolution", "lowest-direct", "--editable", f"{ROOT}[data,sweep]"]
    subprocess.run([*install, *lowest], check=True)
    subprocess.run([*install, "pytest", "pytest-xdist", "hypothesis"], check=True)
    subprocess.run([*uv, "pip", "list", "--python", python], check=True)
    return subprocess.run([python, "-m", "pytest", *(tests or TESTS)], cwd=ROOT).returncode


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
