"""Elastic bulk against a constant Poisson's ratio: the comparison of :mod:`validation.studies.poisson`."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from validation.measure.difference import Difference
from validation.measure.norms import CURVES
from validation.report.document import ABSENT, DataTable, Paragraph, Section, formatted, plain
from validation.report.sections.checks import estimates
from validation.studies.poisson import ASSUMPTIONS, FULL, OBSERVED, CompressibilityComparison

NOTES = """\
full − E*(t): ν(t) by the finite elements against the reference on E*(t), the one modulus the surface feels;
estimates: what these two say of their own errors. The other columns are what a constant ratio costs, against
E*(t): `shear` and `tension`, the relaxed ratio with a modulus measured so; `incompressible`, ν = 0.5. All
relative; curves: root mean square over time. For K >> G the plane modulus is 4 G (1 - G/K): a constant ratio
takes the fast response too stiff by (G(0) - G(∞))/K, two thirds of it if measured in tension."""


def section(name: str, compressibilities: Iterable[CompressibilityComparison]) -> Section:
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
