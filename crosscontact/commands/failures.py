"""Checks that failed and warnings, on stderr, and the exit code that failures make."""

from __future__ import annotations

import sys
from collections.abc import Collection, Iterable

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


def warn(warnings: Iterable[str]) -> None:
    """Say what makes an answer doubtful, one line each."""
    for warning in warnings:
        print(f"crosscontact: warning: {warning}", file=sys.stderr)
