"""Error against run time of a study: in words, what an error costs by each scheme, how cost grows."""

from __future__ import annotations

from validation.report.document import ABSENT, DataTable, Paragraph, Section, formatted, plain
from validation.studies import work_precision
from validation.studies.convergence import Convergence


def section(studies: list[Convergence], threads: str) -> Section:
    """Error against run time, in words and as tables."""
    stated = [
        "Each run alone, after a warm-up run of its scheme: the smallest of the repeats stated below (fewer "
        f"where a run takes longer than a second), threads {threads}. Meshing and assembly count, imports "
        "do not. Prices below are processor seconds, on one thread the run time of a quiet machine; between "
        "levels they are interpolated on logarithms, never extrapolated.",
        "By the RMS error of F(t) over the run, relative to the largest force: "
        + " ".join(work_precision.in_words(studies)),
        "By the pull-off force: " + " ".join(work_precision.in_words(studies, "pull_off_force")),
        "By the loop integral: " + " ".join(work_precision.in_words(studies, "loop_energy")),
        "Growth of cost (least squares over the ladder, the error that of F(t), RMS): "
        + " ".join(work_precision.growth_in_words(studies)),
    ]
    share = work_precision.busy(studies)
    if share > work_precision.BUSY:
        stated.insert(1, f"The machine was busy: run times are up to {share:.1f} times the processor times.")
    skipped = work_precision.left_out(studies)
    if skipped:
        stated.append("Left out because the scene did not need it: " + " ".join(skipped))
    tables = _price_table(studies), _growth_table(studies)
    return Section("Error against run time", (*map(Paragraph, stated), *tables))


def _price_table(studies: list[Convergence]) -> DataTable:
    rows = []
    for measure in work_precision.measures(studies):
        for asked in work_precision.ERRORS:
            best, found = work_precision.cheapest(studies, measure, asked)
            bounds = ("≤ " if price.at_most else "" for price in found)
            seconds = (formatted(price.seconds, ".2g") for price in found)
            shown = (s if s == ABSENT else f"{b}{s} s" for b, s in zip(bounds, seconds, strict=True))
            rows.append(
                {"error in": plain(measure), "asked": f"{asked:.0e}"}
                | dict(zip((study.ladder.scheme for study in studies), shown, strict=True))
                | {"cheapest": best.scheme if best else ABSENT}
            )
    return DataTable.of(rows, "Processor seconds to an error")


def _growth_table(studies: list[Convergence]) -> DataTable:
    rows = []
    for study in studies:
        fitted = {plain(work): work_precision.growth(study, work) for work in work_precision.WORK}
        by_resolution = {work: formatted(one.with_resolution, ".2f") for work, one in fitted.items()}
        by_error = {work: formatted(one.with_error, ".2f") for work, one in fitted.items()}
        rows.append({"scheme": study.ladder.scheme} | by_resolution)
        rows.append({"scheme": f"{study.ladder.scheme}, over 1/error"} | by_error)
    return DataTable.of(rows, "Exponents of cost over resolution, and over 1/error of F(t)")
