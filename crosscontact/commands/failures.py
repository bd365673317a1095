"""Checks that failed, on stderr, and the exit code they make."""

from __future__ import annotations

import sys
from collections.abc import Collection

from validation.measure.check import Check


def exit_code(failures: Collection[Check]) -> int:
    """1 if a check failed, each printed in one line; else 0."""
    for check in failures:
        print(
            f"failed: {check.scene}: {check.solver}: {check.quantity}: found {short(check.found)}, "
            f"expected {check.relation} {short(check.expected)}{' ' + check.note if check.note else ''}",
            file=sys.stderr,
        )
    return 1 if failures else 0


def short(value: object) -> str:
    """A number in six digits; words as they are."""
    return "-" if value is None else format(value, ".6g") if isinstance(value, float) else str(value)
