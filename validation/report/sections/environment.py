"""Versions, machine and threads a report was computed with."""

from __future__ import annotations

from collections.abc import Mapping

from validation.report.document import DataTable, Section


def section(stamp: Mapping[str, object], wall_seconds: float) -> Section:
    """One line for each fact of ``provenance.stamp``, and the wall time of the whole."""
    rows = [(name, in_words(value)) for name, value in stamp.items()]
    rows.append(("whole report", f"{wall_seconds:.1f} s"))
    return Section("Computed on", (DataTable(("", ""), tuple(rows), numeric=False),))


def in_words(value: object) -> str:
    """A fact as text, names and values of a mapping in one line."""
    return ", ".join(f"{k} {v}" for k, v in value.items()) if isinstance(value, dict) else str(value)
