"""The package ``afmformats`` (extra ``fit``): imported when it is needed, its errors as one line."""

from __future__ import annotations

import logging
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from importlib import import_module
from pathlib import Path
from typing import Any

from contact_scene.errors import SceneError


class UnknownFormat(SceneError):
    """A file that no reader of ``afmformats`` takes for its own."""


def afmformats() -> Any:
    """The package.

    Raises
    ------
    ImportError
        If it is not installed.
    """
    try:
        return import_module("afmformats")
    except ImportError:
        raise ImportError("afmformats is not installed: pip install 'crosscontact[fit]'") from None


@contextmanager
def errors_in_one_line(package: Any, path: Path) -> Iterator[None]:
    """What its readers, and those below them, raise about a file; warnings and its log stay off the terminal.

    Parameters
    ----------
    package : module
        ``afmformats``.
    path : Path

    Raises
    ------
    SceneError
        One line.
    """
    own = package.errors.AFMFileFormatError, package.meta.MetaDataMissingError  # of BaseException
    try:
        with _logged_nowhere_else(), warnings.catch_warnings():
            warnings.simplefilter("ignore")
            yield
    except SceneError:
        raise
    except package.errors.MissingMetaDataError as error:
        problem = f"does not state its {' and '.join(error.meta_keys)}"
        allowed = "a file that holds forces, or states how its signal becomes one; a CSV table with a header"
        raise SceneError("", problem, allowed, str(path)) from None
    except (Exception, *own) as error:  # whatever a reader of foreign files may raise
        if type(error) is package.errors.FileFormatNotSupportedError:
            problem = "is damaged, or in no format that afmformats knows"
            allowed = f"a {path.suffix} of a force microscope; a table is a .csv or a .txt"
            raise UnknownFormat("", problem, allowed, str(path)) from None
        reason = f"{type(error).__name__} {error}"
        raise SceneError("", f"cannot be read: {reason}", "a file of afmformats", str(path)) from None


@contextmanager
def _logged_nowhere_else() -> Iterator[None]:
    """Its log goes only to handlers of its own, as of a file that its user asked for: not to stderr."""
    logger, handler = logging.getLogger("afmformats"), logging.NullHandler()  # with none: stderr
    propagated, logger.propagate = logger.propagate, False
    logger.addHandler(handler)
    try:
        yield
    finally:
        logger.removeHandler(handler)
        logger.propagate = propagated
