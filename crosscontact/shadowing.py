"""Finds what hides or replaces one of our packages: a user's file, another distribution.

The Python package index has a distribution ``validation``, whose files pip writes over ours.
"""

from __future__ import annotations

import importlib.util
import sys
from pathlib import Path

PACKAGES = ("contact_scene", "bem_solver", "fem_solver", "meshes", "validation")
_INSTALLED = frozenset(("site-packages", "dist-packages"))
"""Folders that distributions are installed into."""


def check_packages() -> None:
    """Check that the names of our packages lead to our packages, without importing them.

    Raises
    ------
    ImportError
        One line: which file hides or replaces which package, and what to do.
    """
    root = Path(__file__).resolve().parents[1]
    for name in PACKAGES:
        location = _location(name)
        if location is None:
            raise ImportError(f"crosscontact: its package {name} is missing: install crosscontact again")
        in_place = location.resolve().parent == root / name
        if in_place and _is_ours(location):
            continue
        if in_place or location.is_dir() or not _INSTALLED.isdisjoint(location.parts):
            raise ImportError(
                f"crosscontact: the installation is damaged: {location} is not the package {name} of "
                f"crosscontact: `pip uninstall {name}`, if another distribution brought it, then "
                f"`pip install --force-reinstall --no-deps crosscontact`"
            )
        raise ImportError(
            f"crosscontact: {location} hides its package {name}: rename it, or start Python elsewhere"
        )


def started_as_command() -> bool:
    """Whether this process is the command line: the script ``crosscontact`` or ``python -m``."""
    return Path(sys.argv[0] if sys.argv else "").stem in ("crosscontact", "-m")


def _is_ours(file: Path) -> bool:
    """Whether the first file of a package says that it is part of crosscontact, as ours do."""
    return b"crosscontact" in file.read_bytes()


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
