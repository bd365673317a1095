"""The comparison of :mod:`validation.studies.poisson` in words and numbers, and the command that makes it."""

from __future__ import annotations

import sys
from collections.abc import Iterable
from pathlib import Path
from typing import Any

from validation import cases
from validation.execution.files import output_folder, to_json, write_whole
from validation.execution.processes import processes
from validation.execution.progress import Progress
from validation.studies.poisson import (
    ASSUMPTIONS,
    CURVES,
    FULL,
    OBSERVED,
    RATIOS,
    CompressibilityComparison,
    Difference,
    compare,
)

HEAD = ("K/G", "ν(0)", "ν(∞)", "quantity", "full − E*(t)", "estimates", *ASSUMPTIONS)
NOTES = """\
full − E*(t): ν(t) by the finite elements against the reference on E*(t), the one modulus the surface feels;
estimates: what these two say of their own errors. The other columns are what a constant ratio costs, against
E*(t): `shear` and `tension`, the relaxed ratio with a modulus measured so; `incompressible`, ν = 0.5. All
relative; curves: root mean square over time. For K >> G the plane modulus is 4 G (1 - G/K): a constant ratio
takes the fast response too stiff by (G(0) - G(∞))/K, two thirds of it if measured in tension."""


def rows(found: Iterable[CompressibilityComparison]) -> list[tuple[str, ...]]:
    """One row for every compressibility and quantity, in the order of ``HEAD``."""
    table = []
    for one in found:
        for name in (*OBSERVED, *CURVES):
            label = f"{name.replace('_', ' ')}{' (curve)' if name in CURVES else ''}"
            full = one.difference(FULL, name)
            costs = [_shown(one.difference(assumption, name)) for assumption in ASSUMPTIONS]
            where = (f"{one.ratio:g}", f"{one.initial:.4f}", f"{one.final:.4f}")
            table.append((*where, label, _shown(full), _estimates(full), *costs))
    return table


def _shown(difference: Difference | None) -> str:
    return "–" if difference is None else f"{difference.value:+.1e}"


def _estimates(difference: Difference | None) -> str:
    if difference is None or difference.estimate is None or difference.base_estimate is None:
        return "–"
    return f"{difference.estimate:.1e} + {difference.base_estimate:.1e}"


def text(found: list[CompressibilityComparison]) -> str:
    """A table for a terminal."""
    table = [HEAD, *rows(found)]
    widths = [max(len(row[column]) for row in table) for column in range(len(HEAD))]
    lines = ["  ".join(f"{cell:<{w}}" for cell, w in zip(row, widths, strict=True)).rstrip() for row in table]
    return "\n".join([*lines, "", NOTES])


def markdown(name: str, found: list[CompressibilityComparison]) -> str:
    """The same as Markdown."""
    table = [HEAD, ("---",) * len(HEAD), *rows(found)]
    lines = [f"| {' | '.join(row)} |" for row in table]
    return "\n".join(
        [f"# {name}: elastic bulk against a constant Poisson's ratio", "", *lines, "", NOTES, ""]
    )


def data(name: str, found: list[CompressibilityComparison]) -> dict[str, Any]:
    """Every number."""
    return {
        "scene": name,
        "compressibilities": [
            {
                "bulk_to_shear": one.ratio,
                "initial_poisson": one.initial,
                "final_poisson": one.final,
                "runs": {
                    label: {
                        "solver": run.solver,
                        "ending": run.ending,
                        "cpu_seconds": run.cpu_seconds,
                        "observables": {key: run.measures.get(key) for key in OBSERVED},
                        "error_estimates": {key: run.errors.get(key) for key in (*OBSERVED, *CURVES)},
                        "differences": {
                            key: None if (d := one.difference(label, key)) is None else d.value
                            for key in (*OBSERVED, *CURVES)
                        },
                    }
                    for label, run in one.runs.items()
                },
            }
            for one in found
        ],
    }


def command(
    given: list[str], ratios: list[float], out: str | None, jobs: int, resolution: int | None = None
) -> int:
    """Exit code 1 if a run does not finish, or the full path and the surface modulus disagree."""
    loaded = cases.load_all(given)
    folder: Path | None = None if out is None else output_folder(out)
    code = 0
    with processes(jobs) as executor:
        for case in loaded:
            progress = Progress(f"{case.name} poisson")
            try:
                found = compare(case, ratios or RATIOS, resolution, executor, progress)
            finally:
                progress.close()
            print(f"{case.name}: elastic bulk against a constant Poisson's ratio\n{text(found)}")
            if folder is not None:
                write_whole(folder / f"poisson-{case.name}.md", markdown(case.name, found))
                write_whole(folder / f"poisson-{case.name}.json", to_json(data(case.name, found)))
                print(f"written to {folder / f'poisson-{case.name}.md'}")
            code = max(code, _verdict(case.name, found))
    return code


def _verdict(name: str, found: list[CompressibilityComparison]) -> int:
    failed = False
    for one in found:
        where = f"{name}: K/G = {one.ratio:g}"
        for label, run in one.runs.items():
            if not run.finished:
                failed = True
                print(f"not finished: {where}: {label}: {run.ending}", file=sys.stderr)
        for quantity in one.disagreements:
            failed = True
            print(f"failed: {where}: {quantity}: beyond the error estimates", file=sys.stderr)
    return 1 if failed else 0
