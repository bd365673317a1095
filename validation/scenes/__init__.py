"""The built-in scenes by name; to list them loads no scene, no solver and no NumPy."""

from __future__ import annotations

import tomllib
from pathlib import Path
from typing import Any

FOLDER = Path(__file__).parent
SUITES = ("quick", "paper", "full")
_CHECKS = ".checks.toml"


def names() -> list[str]:
    """Names of the built-in scenes."""
    return sorted(file.name.removesuffix(_CHECKS) for file in FOLDER.glob("*" + _CHECKS))


def titles() -> dict[str, str]:
    """Title of every built-in scene."""
    return {name: _table(f"{name}.toml")["title"] for name in names()}


def suite(name: str) -> list[str]:
    """Names of the built-in scenes of a report suite."""
    return [scene for scene in names() if name in checks(scene)["suites"]]


def checks(name: str) -> dict[str, Any]:
    """What is known about a built-in scene, ``NAME.checks.toml``; its keys: ``validation.cases``."""
    return _table(name + _CHECKS)


def _table(file: str) -> dict[str, Any]:
    return tomllib.loads((FOLDER / file).read_text("utf-8"))
