"""Elastic bulk against a constant Poisson's ratio, as a table and ``poisson-SCENE.json``.

The keys of that file are a fixed contract with whoever reads it.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

from validation.cases import Case
from validation.measure.difference import Difference
from validation.measure.norms import CURVES
from validation.report import markdown
from validation.report.document import ABSENT, DataTable, Document, Paragraph, Section, formatted, plain
from validation.report.tables import estimates
from validation.runs.folder import to_json, write_whole
from validation.runs.provenance import of_case
from validation.runs.run import Run
from validation.studies.poisson import (
    ASSUMPTIONS,
    FULL,
    OBSERVED,
    CompressibilityComparison,
)

NOTES = """\
full − E*(t): ν(t) by the finite elements against the reference on E*(t), the one modulus the surface feels;
estimates: what these two say of their own errors. The other columns are what a constant ratio costs, against
E*(t): `shear` and `tension`, the relaxed ratio with a modulus measured so; `incompressible`, ν = 0.5. All
relative; curves: root mean square over time. For K >> G the plane modulus is 4 G (1 - G/K): a constant ratio
takes the fast response too stiff by (G(0) - G(∞))/K, two thirds of it if measured in tension."""


def write(case: Case, compressibilities: Sequence[CompressibilityComparison], folder: Path) -> Path:
    """Write ``poisson-NAME.md`` and ``.json``; returns the first."""
    shown, path = section(case.name, compressibilities), folder / f"poisson-{case.name}.json"
    write_whole(path, to_json(data(case, compressibilities)))
    page = path.with_suffix(".md")
    write_whole(page, markdown.text(Document(shown.title, (), shown.parts)))
    return page


def data(case: Case, compressibilities: Sequence[CompressibilityComparison]) -> dict[str, Any]:
    """``poisson-SCENE.json``."""
    return {
        "scene": case.name,
        "premises": of_case(case),
        "compressibilities": [
            {
                "bulk_to_shear": one.ratio,
                "initial_poisson": one.initial,
                "final_poisson": one.final,
                "runs": {label: _assumption(one, label, run) for label, run in one.runs.items()},
            }
            for one in compressibilities
        ],
    }


def _assumption(one: CompressibilityComparison, label: str, run: Run) -> dict[str, Any]:
    names = (*OBSERVED, *CURVES)
    differences = {name: one.difference(label, name) for name in names}
    return {
        "solver": run.solver,
        "ending": run.ending,
        "cpu_seconds": run.cpu_seconds,
        "observables": {name: run.measures.get(name) for name in OBSERVED},
        "error_estimates": {name: run.errors.get(name) for name in names},
        "differences": {name: None if d is None else d.error for name, d in differences.items()},
    }


def section(name: str, compressibilities: Sequence[CompressibilityComparison]) -> Section:
    """One row for every compressibility and quantity."""
    rows = (row for one in compressibilities for row in _rows(one))
    title = f"{name}: elastic bulk against a constant Poisson's ratio"
    return Section(title, (DataTable.of(rows), Paragraph(NOTES)))


def _rows(one: CompressibilityComparison) -> Iterator[dict[str, str]]:
    for name in (*OBSERVED, *CURVES):
        full = one.difference(FULL, name)
        yield {
            "K/G": f"{one.ratio:g}",
            "ν(0)": f"{one.initial:.4f}",
            "ν(∞)": f"{one.final:.4f}",
            "quantity": plain(name) + (" (curve)" if name in CURVES else ""),
            "full − E*(t)": _relative(full),
            "estimates": ABSENT if full is None else estimates(full.own, full.known_to),
        } | {assumption: _relative(one.difference(assumption, name)) for assumption in ASSUMPTIONS}


def _relative(difference: Difference | None) -> str:
    return formatted(None if difference is None else difference.error, "+.1e")
