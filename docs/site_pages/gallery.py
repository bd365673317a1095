"""The verification gallery: a page for every built-in scene and each kind of evidence, from a saved report.

Nothing is run: numbers, curves and verdicts are those of the report. A scene that it does not hold is shown
with its statement and the values it is checked against.
"""

from __future__ import annotations

import json
import re
import tempfile
from collections.abc import Iterator
from pathlib import Path
from shutil import copyfile

from benchmarks import saved_report as saved
from site_pages import gallery_index
from site_pages.report_parts import note, raw
from validation.cases import Case, load
from validation.claims.all import CLAIMS
from validation.claims.claim import Finding
from validation.compare.suite import SceneComparison
from validation.report.document import DataTable, Fold, Part, Section, number, plain
from validation.report.figures.paper_figures import FIGURES
from validation.report.report import Report
from validation.report.sections import checks
from validation.report.sections import claims as claims_section
from validation.report.sections import scene as scene_section
from validation.report.sections import stability as stability_section
from validation.scenes import names, suite
from validation.solvers import SOLVERS
from validation.stability.runner import StabilityMatrix

RECORDED = """\
The saved report holds no evaluation (suites `paper` and `full` do): the verdicts are those recorded with the
statements."""
NO_STABILITY = """\
# Stiff and extreme cases

The saved report holds none: `crosscontact stability --out DIR` computes them and draws the maps, and
`report --suite full` includes them.
"""
NO_STUDY = """\
# Refinement studies

The saved report holds none: `crosscontact study SCENE --out DIR` refines every solver level by level.
"""


def write(folder: Path, source: Path) -> None:
    """Write all pages.

    Parameters
    ----------
    folder : Path
        Made anew by the caller's caller.
    source : Path
        The folder of a report, or its archive.
    """
    folder.mkdir(parents=True)
    with tempfile.TemporaryDirectory() as unpacked:
        if not source.is_dir():
            saved.unpack(source, Path(unpacked))
            source = Path(unpacked)
        report = saved.read(source)
        data = json.loads((source / "report.json").read_text("utf-8"))
        cases = {name: load(name) for name in names()}
        compared = {scene.case.name: scene for scene in report.scenes}
        for name, case in cases.items():
            (folder / f"{name}.md").write_text(_scene_page(case, compared.get(name), report), "utf-8")
        figures = sorted((source / "figures").glob("*.png"))
        for figure in figures:
            (folder / "figures").mkdir(exist_ok=True)
            copyfile(figure, folder / "figures" / figure.name)
        kept = [figure.name for figure in figures]
        judged = saved.findings(data["claims"]) if "claims" in data else None
        (folder / "statements.md").write_text(_statements(judged, kept), "utf-8")
        matrix = report.stability or _matrix(source)
        (folder / "stability.md").write_text(_stability(matrix), "utf-8")
        (folder / "studies.md").write_text(_studies(source / "study.md"), "utf-8")
        (folder / "index.md").write_text(gallery_index.page(cases, compared, report), "utf-8")


def _scene_page(case: Case, scene: SceneComparison | None, report: Report) -> str:
    """Statement, parameters, figures, checks with their estimates, and the sources of the check values."""
    lines = [f"# {case.name}", "", f"**{case.scene.title}**", "", case.statement, ""]
    lines += [f"Figure of the paper: {case.figure or 'none'}. Suites: {', '.join(case.suites)}.", ""]
    shown = SceneComparison(case, {}, []) if scene is None else scene
    parts: list[Part] = [Section("Parameters", (scene_section.parameters(shown),))]
    if scene is None:
        first = next(one for one in ("quick", "paper", "full") if case.name in suite(one))
        command = f"`crosscontact report --suite {first}`"
        lines += [f"The saved report (suite `{report.suite}`) does not hold this scene: {command} does.", ""]
    else:
        parts += [scene_section.figures(scene), Section("Runs", (scene_section.runs(scene),))]
        failed = [check for check in scene.checks if not check.passed]
        parts += [Section("Not passed", (checks.table(failed),))] if failed else []
        parts += [Section("Checks", tuple(_checks(scene)))]
    if case.expected:
        parts += [Section("Where the check values come from", (_sources(case),))]
    lines += [raw(parts, 2), "" if scene is None else note(report)]
    return "\n".join(lines) + "\n"


def _checks(scene: SceneComparison) -> Iterator[Part]:
    for solver in dict.fromkeys(check.solver for check in scene.checks):
        own = [check for check in scene.checks if check.solver == solver]
        passed = sum(check.passed for check in own)
        title = SOLVERS[solver].title if solver in SOLVERS else solver
        yield Fold(f"{solver}, {title}: {passed} of {len(own)} passed", (checks.table(own),))


def _sources(case: Case) -> DataTable:
    return DataTable.of(
        {
            "quantity": plain(one.observable) + ("" if one.at_time is None else f" at t = {one.at_time:g}"),
            "value": number(one.value) if one.value is not None else _limit(one.at_most, one.at_least),
            "unit": one.unit or "scene units",
            "source": one.source,
        }
        for one in case.expected
    )


def _limit(at_most: float | None, at_least: float | None) -> str:
    return f"≤ {number(at_most)}" if at_most is not None else f"≥ {number(at_least)}"


def _statements(judged: tuple[Finding, ...] | None, figures: list[str]) -> str:
    lines = ["# What the paper says", "", claims_section.EXPLAINED, ""]
    if judged is None:
        lines += [RECORDED]
        rows = [
            {"verdict": str(one.recorded), "place": one.place, "what it says": one.wording} for one in CLAIMS
        ]
    else:
        lines += [claims_section.in_words(judged)]
        rows = [
            {
                "verdict": str(one.verdict),
                "place": one.place,
                "what it says": one.wording,
                "what was found": one.shown,
            }
            for one in judged
        ]
    captions = {f"{one.name}.png": one.caption for one in FIGURES}
    lines += ["", *(f"![{captions[name]}](figures/{name})\n" for name in figures if name in captions), ""]
    return "\n".join([*lines, raw([DataTable.of(rows)], 2)])


def _matrix(source: Path) -> StabilityMatrix | None:
    file = source / "stability.json"
    return saved.matrix(json.loads(file.read_text("utf-8"))) if file.exists() else None


def _stability(matrix: StabilityMatrix | None) -> str:
    if matrix is None:
        return NO_STABILITY
    return "# Stiff and extreme cases\n\n" + raw(stability_section.section(matrix).parts, 2)


def _studies(file: Path) -> str:
    if file.exists():
        return re.sub(r"\A# .*", "# Refinement studies", file.read_text("utf-8"))
    return NO_STUDY
