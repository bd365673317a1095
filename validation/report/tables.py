"""What several kinds of evidence show: tables of checks and costs, work left out, and where it was done."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

from validation.measure.difference import Check
from validation.measure.scaling import SYMBOLS
from validation.report import document as doc
from validation.runs.run import Run
from validation.solvers import SOLVERS
from validation.solvers.base import SKIPPED_WORK

_RELATIONS = {"<=": "≤ ", ">=": "≥ "}
COUNTERS = {
    "steps": "steps",
    "rejected": "rejected_steps",
    "closure": "closure_evaluations",
    "solves": "linear_solves",
    "factorisations": "factorisations",
}
"""Counters of the work of a run, by the titles of their columns."""
LONGEST = 10
"""Runs whose costs are listed one by one, those that took longest."""


def of_checks(checks: Iterable[Check], anchors: Mapping[str, str] | None = None) -> doc.DataTable:
    """A row for each check; given ``anchors`` of scenes, with a column for its scene that leads there."""
    rows = ({**_scene(check.scene, anchors), **cells(check)} for check in checks)
    return doc.DataTable.of(rows, unbroken=("estimates",))


def _scene(name: str, anchors: Mapping[str, str] | None) -> doc.Record:
    if anchors is None:
        return {}
    return {"scene": doc.LinkCell(name, anchors[name]) if name in anchors else name}


def cells(check: Check) -> doc.Record:
    """One check in words and numbers, by the title of the column."""
    unit = SYMBOLS[check.unit]
    verdict = "pass" if check.passed else ("missing" if check.found is None else "FAIL")
    return {
        "solver": check.solver,
        "quantity": doc.plain(check.quantity) + (f" / {unit}" if unit else ""),
        "found": doc.number(check.found),
        "expected": _RELATIONS.get(check.relation, "") + doc.number(check.expected),
        "difference": doc.formatted(check.difference, "+.1e"),
        "estimates": estimates(check.estimate, check.base_estimate),
        "tolerance": doc.formatted(check.tolerance, ".0e"),
        "verdict": doc.VerdictCell(verdict, check.passed),
        "source": f"{check.source}; {check.note}" if check.note else check.source,
    }


def estimates(own: float | None, base: float | None) -> str:
    """Relative error estimates of a run and of what it is compared with."""
    return doc.ABSENT if own is None or base is None else f"{own:.1e} + {base:.1e}"


def costs(runs: Sequence[Run]) -> doc.Section:
    """Where the processor time went: a line for each solver, one for all, and one for each of the longest."""
    solvers = dict.fromkeys(run.solver for run in runs)
    rows = [_costs(solver, [run for run in runs if run.solver == solver]) for solver in solvers]
    rows.append(_costs("all", runs))
    longest = sorted(runs, key=spent, reverse=True)[:LONGEST]
    rows += [_costs(f"{run.scene} by {run.solver}", [run]) for run in longest]
    return doc.Section("Where the time went", (doc.DataTable.of(rows),))


def _costs(name: str, runs: Sequence[Run]) -> doc.Record:
    return {
        "": name,
        "runs": str(len(runs)),
        "processor seconds": doc.number(float(sum(map(spent, runs))), 3),
        "of these for error estimates": doc.number(float(sum(run.estimate_seconds for run in runs)), 3),
    }


def spent(run: Run) -> float:
    """Processor seconds of a run and of the coarser one that estimates its error."""
    return run.cpu_seconds + run.estimate_seconds


def environment(stamp: Mapping[str, object], wall_seconds: float) -> doc.Section:
    """Versions, machine and threads, one line each, and the wall time of the whole."""
    rows = [(name, in_words(value)) for name, value in stamp.items()]
    rows.append(("whole report", f"{wall_seconds:.1f} s"))
    return doc.Section("Computed on", (doc.DataTable(("", ""), tuple(rows), numeric=False),))


def in_words(value: object) -> str:
    """A fact as text, names and values of a mapping in one line."""
    return ", ".join(f"{k} {v}" for k, v in value.items()) if isinstance(value, dict) else str(value)


def left_out(scheme: str, counters: Mapping[str, float | None]) -> list[str]:
    """The parts of its work that a solver or scheme left out, in words; none if a counter is not known."""
    meanings = SOLVERS[scheme].skipped_work if scheme in SOLVERS else SKIPPED_WORK
    return [text for name, text in meanings.items() if counters.get(name) == 0]


def left_out_by_all(work: Mapping[str, Mapping[str, float | None]]) -> str:
    """A sentence on all solvers of a scene, ``work`` being their counters by name."""
    skipped = [f"{name}: {', '.join(parts)}" for name, c in work.items() if (parts := left_out(name, c))]
    if not skipped:
        return "Nothing was left out: by its counters every solver did all kinds of its work."
    return f"Left out because the scene did not need it, by the counters: {'; '.join(skipped)}."
