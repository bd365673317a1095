"""Checks that failed, on stderr, and the exit code they make."""

from __future__ import annotations

import sys
from collections.abc import Collection

from crosscontact.tables import cell
from validation.measure.check import Check


def exit_code(failures: Collection[Check]) -> int:
    """1 if a check failed, each printed in one line; else 0."""
    for check in failures:
        print(
            f"failed: {check.scene}: {check.solver}: {check.quantity}: found {cell(check.found)}, "
            f"expected {check.relation} {cell(check.expected)}{' ' + check.note if check.note else ''}",
            file=sys.stderr,
        )
    return 1 if failures else 0
