"""Finds a user's file or folder that hides one of the packages of this distribution."""

from __future__ import annotations

import importlib.util
import sys
from pathlib import Path

PACKAGES = ("contact_scene", "bem_solver", "fem_solver", "meshes", "validation")


def check_packages() -> None:
    """Check that the names of our packages lead to our packages, without importing them.

    Raises
    ------
    ImportError
        One line: which file hides which package, and what to do.
    """
    root = Path(__file__).resolve().parents[1]
    for name in PACKAGES:
        location = _location(name)
        if location is None:
            raise ImportError(f"crosscontact: its package {name} is missing: install crosscontact again")
        if location.resolve().parent != root / name:
            raise ImportError(
                f"crosscontact: {location} hides its package {name}: rename it, or start Python elsewhere"
            )


def _location(name: str) -> Path | None:
    """The file that ``import NAME`` takes or has taken; of a folder without ``__init__.py`` the folder."""
    loaded = sys.modules.get(name)
    spec = importlib.util.find_spec(name) if loaded is None else loaded.__spec__
    if spec is None:
        file = getattr(loaded, "__file__", None)
        return None if file is None else Path(file)
    if spec.origin is not None:
        return Path(spec.origin)
    return next((Path(folder) for folder in spec.submodule_search_locations or ()), None)
