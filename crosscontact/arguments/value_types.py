"""Types of values of arguments: what is allowed of a text, and what an error says."""

from __future__ import annotations

import argparse
import math
from collections.abc import Callable, Iterable, Iterator

from crosscontact.limits import SMALLEST_RESOLUTION


class Names:
    """Names for an option, looked up where they are needed: in its ``--help``, and where it is used.

    Parameters
    ----------
    load : callable
        Gives the names; may import heavy packages.
    """

    def __init__(self, load: Callable[[], Iterable[str]]) -> None:
        self._load = load

    def __iter__(self) -> Iterator[str]:
        return iter(self._load())

    def __contains__(self, name: object) -> bool:
        return name in tuple(self)


def comma_separated(text: str) -> list[str]:
    """The names in ``A,B``."""
    return [name.strip() for name in text.split(",")]


def count(text: str) -> int:
    """A whole number from 1."""
    if not text.isdecimal() or int(text) < 1:
        raise argparse.ArgumentTypeError(f"got {text!r:.40}; allowed: a whole number >= 1")
    return int(text)


def resolution(text: str) -> int:
    """A number of divisions from the smallest that resolves the stress."""
    try:
        value = int(text)
    except ValueError:
        value = 0
    if value < SMALLEST_RESOLUTION:
        raise argparse.ArgumentTypeError(
            f"got {text!r:.40}; allowed: a whole number >= {SMALLEST_RESOLUTION}"
        )
    return value


def number(is_allowed: Callable[[float], bool], allowed: str) -> Callable[[str], float]:
    """The type of an option that is a number; ``allowed`` says in words which numbers are."""

    def parse(text: str) -> float:
        try:
            value = float(text)
        except ValueError:
            value = math.nan
        if not is_allowed(value):
            raise argparse.ArgumentTypeError(f"got {text!r:.40}; allowed: {allowed}")
        return value

    return parse
