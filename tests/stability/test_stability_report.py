"""What the matrix writes: page, Markdown, JSON, heat maps; the command's exit code."""

from __future__ import annotations

import json

import pytest
from support import scripted_solver as fakes
from support.unlaid_figures import without_layout

import crosscontact.commands.stability as command
from contact_scene import OutcomeKind
from crosscontact.cli import main
from validation.claims.evidence import Evidence
from validation.compare.suite import SuiteComparison
from validation.report import report
from validation.report.report import Chapter
from validation.runs.folder import to_json
from validation.stability import page
from validation.stability.matrix import FAULTS, Cell, CellVerdict, StabilityMatrix


def cell(label: str, solver: str = "bem", verdict: CellVerdict = CellVerdict.WITHIN, **facts) -> Cell:
    given = {"outcome": "completed", "reason": "a | b <c>", "errors": {"final_force": 1e-3}, **facts}
    return Cell("contrast", label, solver, verdict, tolerance=0.01, why="coarse", **given)


CELLS = (
    cell("1"),
    cell("1", "fem", CellVerdict.DECLINED, errors={}, outcome="refused"),
    cell("10", "bem", CellVerdict.WRONG, errors={"final_force": 0.5}),
    cell("10", "fem", CellVerdict.WRONG, errors={"final_force": float("inf")}),
    cell("100", "bem", CellVerdict.UNKNOWN, errors={}),
    cell("100", "fem", residual=0.2, errors={"final_force": 0.0}),
    cell("1000", "reference", CellVerdict.CRASH, errors={}, outcome="died"),
)
MATRIX = StabilityMatrix(CELLS, 3.0)


def test_json_is_strict_and_checks_and_junit_fail_where_a_cell_is_at_fault():
    told = json.loads(to_json(page.data(MATRIX)))
    assert [entry["number"] for entry in told["cells"]] == [1, 1, 2, 2, 3, 3, 4]
    assert told["cells"][3]["error"] is None  # without bound
    found = page.checks(CELLS)
    assert [(one.solver, one.found, one.passed) for one in found] == [
        (solver, 1, False) for solver in ("bem", "fem", "reference")
    ]
    assert "10: SILENTLY WRONG" in found[0].note
    assert page.checks(CELLS[:2])[0].passed
    assert report.element(Chapter("stability", found)).attrib["failures"] == "3"


@pytest.mark.parametrize("verdict", FAULTS)
def test_a_fault_is_seen_without_colour(verdict):
    plain, fault = (
        page.draw([cell("1", verdict=one)], page.numbers(CELLS[:1])).axes[0]
        for one in (CellVerdict.WITHIN, verdict)
    )
    assert (len(fault.lines), len(fault.patches)) == (len(plain.lines) + 1, len(plain.patches) + 1)


def test_colours_stay_in_range_and_every_outcome_has_its_letter():
    levels = [page.level(one) for one in CELLS]
    assert levels == [-3.0, None, pytest.approx(-0.30103), 0.0, None, page.LEAST, None]
    kinds = [*map(str, OutcomeKind), "hung", "failed", "died", "refused"]
    assert "?" not in {page.letter(cell("1", outcome=kind)) for kind in kinds}
    assert page.letter(CELLS[4]) == "?"


def test_the_command_writes_everything_and_its_code_tells_a_fault(tmp_path, monkeypatch, capsys):
    asked = [fakes.case("right"), fakes.case("wrong")]
    monkeypatch.setattr(command, "cases", lambda only: asked if only is None else asked[:1])
    real = command.matrix.run

    def faked(cases, jobs, solvers, progress, store):
        return real(cases, jobs, solvers, progress, fakes.acted, store)

    monkeypatch.setattr(command.matrix, "run", faked)
    bem, out = ["stability", "--jobs", "1", "--solver", "bem"], tmp_path / "out"
    with without_layout():
        assert main([*bem, "--out", str(out)]) == 1
    told = capsys.readouterr()
    assert "failed: made up: wrong: bem: SILENTLY WRONG" in told.err
    assert "2/2 made up: wrong: " in told.err
    names = {path.name for path in out.rglob("[!.]*") if path.is_file()}
    assert names == {"index.html", "stability.md", "stability.json", "stability-bem.png"}
    assert (out / "figures" / "stability-bem.png").read_bytes().startswith(b"\x89PNG")
    assert main([*bem, "--only", "speed"]) == 0


def test_the_full_report_has_the_matrix_and_fails_with_it(tmp_path, monkeypatch, capsys):
    empty = SuiteComparison("full", [], {"processor": "made up"}, 1.0)
    asked = []
    monkeypatch.setattr("crosscontact.commands.report.compare_scenes", lambda *given, **more: empty)
    monkeypatch.setattr("validation.claims.evidence.collect", lambda *given: Evidence({}))
    monkeypatch.setattr(command, "compute", lambda jobs, store: asked.append(jobs) or MATRIX)
    with without_layout():
        assert main(["report", "--suite", "full", "--jobs", "2", "--out", str(tmp_path / "full")]) == 1
    assert asked == [2]
    assert "failed: stability: bem: faults: contrast: found 1" in capsys.readouterr().err
    for name in ("index.html", "summary.md", "report.json", "junit.xml"):
        assert "SILENTLY WRONG" in (tmp_path / "full" / name).read_text("utf-8")
    assert (tmp_path / "full" / "figures" / "stability-fem.png").exists()
    assert main(["report", "--suite", "quick", "--out", str(tmp_path / "quick")]) == 0
    assert asked == [2]
