"""Cost and error over the process zone: the study of :mod:`validation.studies.zones`."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from validation.report.document import ABSENT, DataTable, Paragraph, Record, Section, formatted, plain
from validation.studies.zones import OBSERVED, ZoneRun, growth

NOTES = """\
Errors: relative, against the reference at twice its default resolution with the same zone. Updates: of the
history, in a step on average, as each solver counts them (the reference: points of the surface). Megabytes:
the most that the process of a run held, program and libraries included. Growth: exponent p of a fit by
zone^-p over all zones of a solver; 0 where a shorter zone costs no more than its logarithm."""


def section(name: str, runs: Sequence[ZoneRun]) -> Section:
    """A row for every zone and solver, then the growth for every solver."""
    rows = DataTable.of(_row(one) for one in runs)
    fits = DataTable.of(_growth_rows(runs))
    return Section(f"{name}: cost over the process zone", (rows, fits, Paragraph(NOTES)))


def _row(one: ZoneRun) -> Record:
    ending = one.skipped
    if one.run is not None and not one.run.finished:
        ending = one.run.ending
    return {
        "zone / radius": f"{one.ratio:.0e}",
        "solver": one.solver,
        "steps": formatted(one.steps, "d"),
        "updates": formatted(one.updates, ".0f"),
        "seconds": formatted(one.seconds, ".2f"),
        "megabytes": formatted(one.megabytes, ".0f"),
        **{f"{plain(name)}: error": formatted(one.errors.get(name), "+.1e") for name in OBSERVED},
        "not finished": ending or ABSENT,
    }


def _growth_rows(runs: Sequence[ZoneRun]) -> Iterator[Record]:
    for solver in dict.fromkeys(one.solver for one in runs):
        own = [one for one in runs if one.solver == solver]
        yield {
            "solver": solver,
            **{
                f"growth of {name}": formatted(growth(own, name), ".2f")
                for name in ("steps", "updates", "seconds")
            },
        }
