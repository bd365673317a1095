"""Pages of the documentation that are made from the program and from a saved report; nothing is run for them.

``python docs/site_pages.py`` puts the table of accuracy and cost of the saved report into the README.
"""

from __future__ import annotations

import argparse
import inspect
import json
import re
import shutil
import sys
import tempfile
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path
from statistics import median
from typing import Any

HERE = Path(__file__).parent
sys.path.append(str(HERE.parent))  # of the module of saved reports, which is not installed

from docutils.nodes import SkipNode  # noqa: E402
from latex2mathml.converter import convert  # noqa: E402

import crosscontact as cc  # noqa: E402
from benchmarks import saved_report  # noqa: E402
from contact_scene.adhesion import PowerRate, RateTable  # noqa: E402
from contact_scene.checked import REQUIRED, Checked, Tabulated, fields_of  # noqa: E402
from contact_scene.indenter import SHAPES  # noqa: E402
from contact_scene.loading import STEPS  # noqa: E402
from contact_scene.material import MODELS  # noqa: E402
from contact_scene.temperature_shift import SHIFTS  # noqa: E402
from crosscontact.commands import parser  # noqa: E402
from validation.cases import Case, load  # noqa: E402
from validation.claims import page as statements  # noqa: E402
from validation.claims.claim import Finding  # noqa: E402
from validation.claims.paper_figures import FIGURES  # noqa: E402
from validation.compare import page as overview  # noqa: E402
from validation.compare import scene_page as scene_section  # noqa: E402
from validation.compare.suite import SceneComparison, SuiteComparison  # noqa: E402
from validation.report import document as doc  # noqa: E402
from validation.report import html  # noqa: E402
from validation.report.tables import environment, of_checks  # noqa: E402
from validation.report.texts import markdown  # noqa: E402
from validation.scenes import SUITES, names  # noqa: E402
from validation.solvers import REFERENCE, SOLVERS  # noqa: E402

ARCHIVE = HERE / "data" / "report.zip"
GROUPS = {
    "contact_scene": "Scenes and materials",
    "validation.fits": "Fits",
    "": "Solving, comparing, results",
}
"""Headings of the Python interface by the beginning of the name of the module that defines a name."""
QUANTITIES = {"pull_off_force": "pull-off force", "loop_energy": "loop energy"}
UNJUDGED = "The saved report judges none of them: suites `paper` and `full` do."
SHOWN_RULES = re.compile(r"\.(pass|fail|wide|figures|sortable)|figure|figcaption")
"""Rules of a report's style sheet that its parts need on a page of the site."""


def write(report: Path) -> None:
    """Write ``docs/generated`` anew, and the style and script of reports to ``docs/_static``."""
    target = HERE / "generated"
    shutil.rmtree(target, ignore_errors=True)
    (target / "gallery").mkdir(parents=True)
    pages = {"command-line": command_line(), "api": api(), "scene-keys": scene_keys()}
    with tempfile.TemporaryDirectory() as unpacked:
        if not report.is_dir():
            saved_report.unpack(report, Path(unpacked))
            report = Path(unpacked)
        saved = saved_report.read(report)
        pages["accuracy"] = accuracy(saved)
        judged = saved_report.findings(
            json.loads((report / "report.json").read_text("utf-8")).get("claims", [])
        )
        pages |= {f"gallery/{name}": text for name, text in gallery(saved, judged).items()}
        if (report / "figures").is_dir():
            shutil.copytree(report / "figures", target / "gallery" / "figures")
    for name, text in pages.items():
        (target / f"{name}.md").write_text(text, "utf-8")
    (HERE / "_static" / "report-parts.js").write_text(html.source("script.js"), "utf-8")
    (HERE / "_static" / "report-parts.css").write_text(style(), "utf-8")


def api() -> str:
    """Every public name of ``crosscontact`` from its docstring, grouped by what it is about."""
    entries: dict[str, list[str]] = {heading: [] for heading in reversed(GROUPS.values())}
    for name in sorted(cc.__all__, key=lambda name: inspect.isclass(getattr(cc, name))):
        thing = getattr(cc, name)
        module = getattr(thing, "__module__", "")
        kind = "autoclass" if inspect.isclass(thing) else "autofunction" if callable(thing) else "autodata"
        members = "   :members:\n" if kind == "autoclass" and not issubclass(thing, BaseException) else ""
        if inspect.isclass(thing) and issubclass(thing, Checked):  # what its fields are is declared
            declared = ((one, field.key) for one, field in fields_of(thing).items() if field.key.text)
            members += "\n" + "".join(f"   - ``{one}``: {key.text}\n" for one, key in declared)
        if not name.startswith("__"):
            heading = next(GROUPS[start] for start in GROUPS if module.startswith(start))
            entries[heading].append(f".. {kind}:: crosscontact.{name}\n{members}\n")
    parts = (f"## {heading}\n\n```{{eval-rst}}\n{''.join(found)}```\n" for heading, found in entries.items())
    return "\n".join(["# Python interface\n\nAll of it is found in the module `crosscontact`.\n", *parts])


def command_line() -> str:
    """Every command as its ``--help`` says it."""
    (commands,) = (one for one in parser()._actions if isinstance(one, argparse._SubParsersAction))
    lines = ["# Commands", "", "As `crosscontact COMMAND --help` prints them."]
    for choice in commands._choices_actions:
        said = commands.choices[choice.dest].format_help().rstrip()
        lines += ["", f"## {choice.dest}", "", f"{choice.help}.".capitalize(), "", f"```text\n{said}\n```"]
    return "\n".join(lines) + "\n"


SCENE_KEYS: dict[str, Iterable[type[Checked]]] = {
    "`[units]`": (cc.Units,),
    "`[material]`": (cc.Material,),
    "`material.model`": MODELS,
    "`material.bulk`": (cc.BulkRelaxation,),
    "`material.shift.model`": SHIFTS,
    "`[body]`": (cc.Layer,),
    "`indenter.shape`": SHAPES,
    "`[adhesion]`": (cc.Adhesion,),
    "`adhesion.rate`": (PowerRate, RateTable),
    "`[machine]`": (cc.Machine,),
    "`[loading]`": (cc.Loading,),
    "`kind` of a load step": STEPS,
}


def scene_keys() -> str:
    """Tables of all keys of a scene file: what each is, its unit, what is allowed, and its default."""
    sections = []
    for title, kinds in SCENE_KEYS.items():
        parts: list[doc.Part] = []
        for kind in kinds:
            about = doc.Paragraph((inspect.getdoc(kind) or "").split("\n\n")[0].replace("``", "`"))
            told = about, doc.DataTable.of(_keys(kind))
            parts += [doc.Section(f"`{getattr(kind, kind.tag)}`", told)] if kind.tag else told
        sections.append(doc.Section(title, tuple(parts)))
    lead = doc.Paragraph("Written from the declarations of the classes that a scene is made of.")
    return markdown(doc.Document("Keys by kind", (lead,), tuple(sections)))


def _keys(kind: type[Checked]) -> Iterator[doc.Record]:
    columns = 2 if issubclass(kind, Tabulated) else 0
    for index, (name, field) in enumerate(fields_of(kind).items()):
        allowed = field.allowed(name) if index >= columns else "a list, in place of the file"
        default = "" if field.default in (None, "", (), REQUIRED) else f"`{field.default!r}`"
        unit = f"`{field.key.unit}`" if field.key.unit else ""
        told = {"key": f"`{name}`", "": field.key.text, "unit": unit}
        yield told | {"allowed": allowed, "default": default}


def accuracy(report: SuiteComparison) -> str:
    """Differences from the reference and processor time of each solver over the scenes of a report."""
    scenes = [scene for scene in report.scenes if scene.case.scene.is_adhesive and REFERENCE in scene.runs]
    lines = [f"| solver | {' | '.join(QUANTITIES.values())} | processor seconds |", "|---|---|---|---|"]
    for name in sorted(SOLVERS, key=lambda one: one == REFERENCE):
        pairs = [(scene.runs[name], scene.runs[REFERENCE]) for scene in scenes if name in scene.runs]
        cells = []
        for quantity in QUANTITIES:
            found = []
            for run, base in pairs:
                value, expected = run.measures.get(quantity), base.measures.get(quantity)
                if value is not None and expected:
                    own = run.errors.get(quantity) if name == REFERENCE else None
                    found.append(abs(value / expected - 1.0) if own is None else own)
            cells.append(f"{median(found):.0e} ({max(found):.0e})" if found else "–")
        seconds = [run.cpu_seconds for run, _ in pairs if run.trace is not None]
        if seconds:
            typical, longest = (f"{float(f'{one:.2g}'):g}" for one in (median(seconds), max(seconds)))
            lines.append(f"| `{name}` | {' | '.join(cells)} | {typical} ({longest}) |")
    caption = f"""
Relative difference from the reference (for `{REFERENCE}`: its own error estimate), median and in brackets
the largest over the {len(scenes)} adhesive scenes of `report --suite {report.suite}`, default resolution;
processor time of a run on one core ({report.environment["processor"]}).
"""
    return "\n".join([*lines, caption])


def with_table(readme: str, table: str) -> str:
    """The text of the README with this table between its marks."""
    marks = re.compile(r"(<!-- generated: accuracy -->\n).*?(<!-- end -->)", re.DOTALL)
    return marks.sub(lambda found: f"{found.group(1)}{table}{found.group(2)}", readme)


def gallery(report: SuiteComparison, judged: Sequence[Finding]) -> dict[str, str]:
    """A page for every built-in scene, one for the paper's statements, and one that lists them."""
    packages: Any = report.environment["packages"]
    time, version = str(report.environment["time"]).partition("T")[0], packages.get("crosscontact", "")
    note = f"From a saved report of suite `{report.suite}`, computed {time} with crosscontact {version}."
    compared = {scene.case.name: scene for scene in report.scenes}
    cases = {name: load(name) for name in names()}
    pages = {name: scene_page(case, compared.get(name), note) for name, case in cases.items()}
    pages["statements"] = statements_page(judged)
    lines = ["# Verification gallery", "", note, "", overview.lead(report).text, ""]
    lines += ["What the paper says, with verdicts: [statements](statements.md).", ""]
    lines += ["| scene | title | figure | checks passed |", "|---|---|---|---|"]
    for name, case in cases.items():
        passed = [check.passed for check in compared[name].checks] if name in compared else []
        counted = f"{'' if all(passed) else '**FAIL** '}{sum(passed)}/{len(passed)}" if passed else "–"
        lines += [f"| [{name}]({name}.md) | {case.scene.title} | {case.figure or '–'} | {counted} |"]
    lines += ["", "```{toctree}", ":hidden:", "", "statements", *cases, "```", ""]
    stamp = environment(report.environment, report.wall_seconds)
    return pages | {"index": "\n".join([*lines, raw([stamp])])}


def scene_page(case: Case, scene: SceneComparison | None, note: str) -> str:
    """Statement, parameters, figures, checks with their estimates, and the sources of the check values."""
    lines = [f"# {case.name}", "", f"**{case.scene.title}**", "", case.statement, ""]
    lines += [f"Figure of the paper: {case.figure or 'none'}. Suites: {', '.join(case.suites)}.", ""]
    parts: list[doc.Part] = [
        doc.Section("Parameters", (scene_section.parameters(scene or SceneComparison(case, {}, [])),))
    ]
    if scene is None:
        first = next(one for one in SUITES if one in case.suites)
        lines += [
            f"The saved report does not hold this scene: `crosscontact report --suite {first}` does.",
            "",
        ]
    else:
        folds: list[doc.Part] = []
        for solver in dict.fromkeys(check.solver for check in scene.checks):
            own = [check for check in scene.checks if check.solver == solver]
            title = f"{SOLVERS[solver].title}: {sum(check.passed for check in own)} of {len(own)} passed"
            folds.append(doc.Fold(f"{solver}, {title}", (of_checks(own),)))
        failed = [check for check in scene.checks if not check.passed]
        parts += [scene_section.figures(scene), doc.Section("Runs", (scene_section.runs(scene),))]
        parts += [doc.Section("Not passed", (of_checks(failed),))] if failed else []
        parts += [doc.Section("Checks", tuple(folds))]
    rows, limits = list[doc.Record](), {"value": "", "at_most": "≤ ", "at_least": "≥ "}
    for one in case.expected:
        kind = next(name for name in limits if getattr(one, name) is not None)
        when = "" if one.at_time is None else f" at t = {one.at_time:g}"
        stated = {"quantity": doc.plain(one.observable) + when}
        stated["value"] = limits[kind] + doc.number(getattr(one, kind))
        rows.append(stated | {"unit": one.unit or "scene units", "source": one.source})
    parts += [doc.Section("Where the check values come from", (doc.DataTable.of(rows),))] if rows else []
    return "\n".join([*lines, raw(parts), note if scene else ""]) + "\n"


def statements_page(judged: Sequence[Finding]) -> str:
    """The paper's statements with what was found, and its figures redrawn."""
    lines = [f"# {statements.TITLE}", "", statements.EXPLAINED, ""]
    lines += [statements.in_words(judged) if judged else UNJUDGED, ""]
    lines += [f"![{one.caption}](figures/{one.name}.png)\n" for one in FIGURES] if judged else []
    return "\n".join([*lines, raw([doc.DataTable.of(map(statements.cells, judged))])])


def raw(parts: Sequence[doc.Part]) -> str:
    """Parts of a report inside a page of the site."""
    shown = re.sub(r"\n\s*\n+", "\n", html.fragment(parts, 2))
    return f"```````{{raw}} html\n{shown}\n```````\n"


def style() -> str:
    """The rules for tables, figures and verdicts of a report, inside a page of the site."""
    rules = html.source("style.css")
    kept = "\n".join(line for line in rules.splitlines() if SHOWN_RULES.match(line))
    (light,) = re.findall(r":root \{ color-scheme: light dark; (.*?)\}", rules, re.DOTALL)
    (dark,) = re.findall(r"prefers-color-scheme: dark\) \{ :root \{(.*?)\}", rules, re.DOTALL)
    chosen = f'body {{ {light} }}\nbody[data-theme="dark"] {{ {dark} }}\n'
    unchosen = f"@media (prefers-color-scheme: dark) {{ body:not([data-theme=light]) {{ {dark} }} }}\n"
    return f"{chosen}{unchosen}{kept}\n"


def formula(writer: Any, node: Any) -> None:
    """A formula in a line as MathML, which browsers draw: the site loads nothing from elsewhere."""
    writer.body.append(convert(node.astext()))
    raise SkipNode


def displayed(writer: Any, node: Any) -> None:
    """A formula of its own, with its number."""
    count = f'<span class="equation-number">({node["number"]})</span>' if node.get("number") else ""
    label = f' id="equation-{node["label"]}"' if node.get("label") else ""
    shown = convert(node.astext(), display="block")
    writer.body.append(f'<div class="equation"{label}>{shown}{count}</div>')
    raise SkipNode


if __name__ == "__main__":
    readme = HERE.parent / "README.md"
    readme.write_text(with_table(readme.read_text("utf-8"), accuracy(saved_report.read(ARCHIVE))), "utf-8")
