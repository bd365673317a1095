"""The command line: exit codes, one-line errors, files written, and that a quick question is quick."""

from __future__ import annotations

import csv
import json
import os
import re
import subprocess
import sys
from functools import partial
from pathlib import Path

import numpy as np
import pytest
from support.commands import code_of, refusal, stand_in
from support.spring_solver import SCENE, FunctionSolver, fake, small_scene
from support.unlaid_figures import without_layout

import crosscontact
from contact_scene import COLUMNS, OutcomeKind, UnsupportedScene, read_scene
from crosscontact.commands import parser
from crosscontact.result import SCALES_IN_WORDS
from validation.runs import folder as files
from validation.scenes import names

CONTRACT = {
    *("solver", "outcome", "wall_seconds", "counters", "loop_energy", "dissipated_energy"),
    *("pull_off_force", "pull_off_penetration", "pull_off_radius"),
    *("detachment_time", "detachment_penetration"),
}
COUNTERS = ("steps", "rejected_steps", "closure_evaluations", "linear_solves", "factorisations")


@pytest.fixture
def scene_file(tmp_path):
    return small_scene(tmp_path)


@pytest.fixture
def fakes(monkeypatch):
    """All solvers replaced; ``fakes(bem=..., reference=...)`` replaces them again."""
    stand_in(monkeypatch)
    return partial(stand_in, monkeypatch)


def test_scenes(capsys):
    assert code_of("scenes") == 0
    out = capsys.readouterr().out.splitlines()
    assert [line.split()[0] for line in out] == names()


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (("dance",), "invalid choice: 'dance'"),
        (("solve",), "SCENE"),
        (("solve", "cycle-v0.1", "--solver"), "expected one argument"),
        (("compare", "cycle-v0.1", "--solvers", "bem"), "reference"),
        (("compare", "cycle-v0.1", "--solvers", "reference,magic"), "magic"),
        (("compare", "cycle-v0.1", "--solvers", ""), "--solvers"),
        (("stability", "--solver", "magic"), "choose from"),
        (("solve", "cycle-v0.1", "--solver", "magic"), "choose from"),
        (("solve", "cycle-v0.1", "--solver", "bem", "--resolution", "3"), "a whole number >= 4"),
        (("solve", "cycle-v0.1", "--solver", "bem", "--resolution", "8.5"), "a whole number >= 1"),
        (("solve", "cycle-v0.1", "--solver", "bem", "--colour", "red"), "--colour"),
        (("solve", "cicle", "--solver", "bem"), "nearest: cycle"),
        (("solve", "\0", "--solver", "bem"), "built-in scene"),
        (("solve", "nowhere.toml", "--solver", "bem"), "nowhere.toml"),
        (("solve", ".", "--solver", "bem"), "error: .: "),
        (("solve", "cycle-v0.1", "--out", ""), "--out: is empty"),
        (("fit", "curve.csv", "cycle-v0.1", "--solver", "tamaas"), "--solver: got 'tamaas'"),
        (("study", "cycle-v0.1", "--poisson", "--zones"), "--zones: given beside --poisson"),
        (("sweep", "--dry-run", "--jobs", "1"), "PLAN: is missing beside --jobs, --dry-run"),
        (("sweep", "--plot", ""), "--plot: is empty"),
        (("sweep", "--plot", "x", "--fresh"), "--plot: given beside --fresh"),
        (("report", "--suite", "tiny"), "choose from"),
        (("report", "--jobs", "0"), "a whole number >= 1"),
        (("compare", "cycle-v0.1", "nowhere.toml"), "nowhere.toml"),
    ],
)
def test_bad_input_is_one_line(capsys, arguments, said):
    assert said in refusal(capsys, *arguments)


@pytest.mark.parametrize("content", ["", "not toml [", "x = 1", SCENE.replace("0.75", "-1"), "\x00\x01"])
def test_bad_scene_is_one_line(capsys, tmp_path, content):
    file = tmp_path / "bad.toml"
    file.write_text(content)
    assert "bad.toml" in refusal(capsys, "solve", str(file), "--solver", "bem")


def test_out_must_be_a_folder(capsys, tmp_path, scene_file, fakes):
    file = tmp_path / "taken"
    file.write_text("")
    for out in (str(file), str(file / "below"), "/proc/nothing/here", "a\0b"):
        assert "--out" in refusal(capsys, "solve", scene_file, "--solver", "bem", "--out", out)
        assert "--out" in refusal(capsys, "report", "--out", out)
        assert "--out" in refusal(capsys, "compare", scene_file, "--out", out)


def test_solve_writes_the_contract(capsys, tmp_path, scene_file, fakes):
    out = tmp_path / "deep" / "down"
    assert code_of("solve", scene_file, "--solver", "bem", "--resolution", "4", "--out", str(out)) == 0
    assert sorted(file.name for file in out.glob("[!.]*")) == ["scene.toml", "summary.json", "trace.csv"]
    summary = json.loads((out / "summary.json").read_text())
    assert set(summary) >= CONTRACT
    assert set(COUNTERS) <= set(summary["counters"])
    assert (summary["solver"], summary["outcome"]) == ("bem", "detached")
    assert summary["pull_off_force"] == pytest.approx(0.01)
    assert summary["loop_energy"] == pytest.approx(0.5 * 0.01**2)
    header, *rows = list(csv.reader((out / "trace.csv").open()))
    assert header == list(COLUMNS)
    assert len(rows) == 39
    assert read_scene(out / "scene.toml") == read_scene(scene_file)
    shown = capsys.readouterr().out
    assert "detached" in shown
    assert "pull_off_force" in shown


@pytest.mark.parametrize(
    "kind", [k for k in OutcomeKind if k not in ("completed", "detached", "interrupted")]
)
def test_unfinished_run_leaves_its_partial_trace(capsys, tmp_path, scene_file, fakes, kind):
    fakes(bem=fake(kind=kind))
    out = tmp_path / "out"
    assert code_of("solve", scene_file, "--solver", "bem", "--out", str(out)) == 1
    err = capsys.readouterr().err
    assert str(kind) in err
    assert "as told" in err
    summary = json.loads((out / "summary.json").read_text())
    assert (summary["finished"], summary["peak_cycle_loss"]) == (False, None)
    assert len((out / "trace.csv").read_text().splitlines()) == 40


def test_refused_scene_is_bad_input(capsys, tmp_path, scene_file, fakes):
    def refuse(*arguments, **options):
        raise UnsupportedScene("material.bulk", "not with this solver", "--solver fem")

    fakes(bem=FunctionSolver(refuse))
    assert "not with this solver" in refusal(
        capsys, "solve", scene_file, "--solver", "bem", "--out", str(tmp_path)
    )
    assert not (tmp_path / "summary.json").exists()


def test_breakdown_is_one_line_and_replaces_old_results(capsys, tmp_path, scene_file, fakes):
    assert code_of("solve", scene_file, "--solver", "bem", "--out", str(tmp_path)) == 0

    def fall(*arguments, **options):
        raise FloatingPointError("overflow\nsomewhere")

    fakes(bem=FunctionSolver(fall))
    assert code_of("solve", scene_file, "--solver", "bem", "--out", str(tmp_path)) == 1
    err = capsys.readouterr().err
    assert "FloatingPointError: overflow somewhere" in err
    assert "Traceback" not in err
    assert not (tmp_path / "trace.csv").exists()
    summary = json.loads((tmp_path / "summary.json").read_text())
    assert summary["outcome"] == "failed"
    assert set(summary) >= CONTRACT


def test_numbers_that_are_not_finite_are_a_failure(capsys, tmp_path, scene_file, fakes):
    fakes(bem=fake(poison=True))
    assert code_of("solve", scene_file, "--solver", "bem", "--out", str(tmp_path)) == 1
    assert "not finite: force" in capsys.readouterr().err
    assert json.loads((tmp_path / "summary.json").read_text())["outcome"] == "failed"


def test_json_is_strict():
    given = {"a": [np.float64(1.5), np.nan, float("inf")], "b": np.arange(2), "c": (None, True, "x", 3)}
    said = json.loads(files.to_json(given), parse_constant=lambda name: pytest.fail(name))
    assert said == {"a": [1.5, None, None], "b": [0, 1], "c": [None, True, "x", 3]}


def test_interrupt_is_said_in_one_line(capsys, scene_file, fakes):
    def interrupt(*arguments, **options):
        raise KeyboardInterrupt

    fakes(bem=FunctionSolver(interrupt))
    assert code_of("solve", scene_file, "--solver", "bem") == 1
    assert capsys.readouterr().err.splitlines() == [
        "crosscontact: nothing is kept of the run",
        "crosscontact: interrupted",
    ]


def test_compare_agrees_and_disagrees(capsys, tmp_path, scene_file, fakes):
    assert code_of("compare", scene_file, "--jobs", "1", "--out", str(tmp_path / "same")) == 0
    assert (tmp_path / "same" / "index.html").exists()
    capsys.readouterr()
    fakes(bem=fake(stiffness=1.02))
    assert code_of("compare", scene_file, "--jobs", "1") == 1
    out, err = capsys.readouterr()
    assert "FAIL" in out
    assert "small: bem: pull_off_force: found" in err
    assert "parts at t =" in err


def test_two_files_of_one_name_are_kept_apart(capsys, tmp_path, scene_file, fakes):
    other = tmp_path / "other" / "small.toml"
    other.parent.mkdir()
    other.write_text(SCENE.replace("0.03", "0.04"))
    assert code_of("compare", scene_file, str(other), scene_file, "--jobs", "1") == 0
    out = capsys.readouterr().out
    assert out.count("A small scene") == 2
    assert "small-2:" in out


def test_quick_questions_load_nothing_heavy():
    probe = (
        "import sys; from crosscontact.commands import parser; from crosscontact.cli import main;"
        "parser().format_help(); main(['scenes']);"
        "print(sorted({'numpy', 'scipy', 'matplotlib', 'skfem', 'gmsh', 'pyvista'} & set(sys.modules)))"
    )
    said = subprocess.run([sys.executable, "-c", probe], capture_output=True, text=True, check=True)
    assert said.stdout.splitlines()[-1] == "[]"


def test_figures_are_files_whatever_backend_a_notebook_has_set():
    probe = (
        "from crosscontact.cli import main; main(['scenes']); import matplotlib as m; print(m.get_backend())"
    )
    environment = os.environ | {"MPLBACKEND": "of-a-notebook"}  # unknown here, as one that is not installed
    said = subprocess.run([sys.executable, "-c", probe], capture_output=True, text=True, env=environment)
    assert said.stdout.splitlines()[-1] == "agg", said.stderr


def test_reader_that_leaves_early_is_no_error():
    command = f"{sys.executable} -m crosscontact scenes | head -1 && echo ${{PIPESTATUS[0]}}"
    said = subprocess.run(["bash", "-c", command], capture_output=True, text=True, check=True)
    assert said.stderr == ""
    assert said.stdout.splitlines()[-1] == "0"


def test_help_alone_and_the_version(capsys):
    assert code_of() == 0
    assert capsys.readouterr().out == parser().format_help()
    assert code_of("--version") == 0
    assert capsys.readouterr().out == f"crosscontact {crosscontact.__version__}\n"


def test_solve_prints_what_numbers_are_relative_to(capsys, scene_file, fakes):
    assert code_of("solve", scene_file) == 0
    out = capsys.readouterr().out.splitlines()
    head, line = out[1], next(line for line in out if "pull_off_force" in line)
    assert re.split(r" {2,}", head.strip()) == ["in scene units", "dimensionless", "F/F_JKR"]
    scene = read_scene(scene_file)
    shown = re.split(r" {2,}", line.strip())
    assert shown[0] == "pull_off_force"
    assert float(shown[1]) == pytest.approx(0.01)
    assert shown[2].endswith(" πE₀R²/(1−ν²)")
    assert float(shown[2].split()[0]) == pytest.approx(0.01 / (np.pi * scene.material.relaxed_plane_modulus))
    assert float(shown[3]) == pytest.approx(0.01 / (1.5 * np.pi * 5e-4), rel=1e-5)


def test_solve_tells_which_load_step_was_the_last(capsys, tmp_path):
    """Contact is over where the indenter is back, though the loading would press it on again."""
    scene = tmp_path / "again.toml"
    steps = [f'{{ kind = "ramp", to = {to}, rate = 1e-6 }}' for to in ("1e-6", "0.0", "2e-6", "-1e-6")]
    scene.write_text(
        "[material]\nmodulus = 1e5\npoisson = 0.5\n[indenter]\nshape = 'flat-punch'\nradius = 1e-6\n"
        f"[loading]\nstart = 'relaxed'\npenetration = 0.0\nsteps = [{', '.join(steps)}]\n"
    )
    assert code_of("solve", str(scene), "--resolution", "4") == 0
    last = "contact is lost in load step 2 of 4: what follows is not carried out"
    assert capsys.readouterr().out.splitlines()[-1].strip() == last
    scene.write_text(scene.read_text().replace(f", {steps[2]}, {steps[3]}", ""))
    assert code_of("solve", str(scene), "--resolution", "4") == 0
    assert "is not carried out" not in capsys.readouterr().out


def test_solve_estimates_errors_where_asked(capsys, tmp_path, scene_file, fakes):
    assert code_of("solve", scene_file, "--solver", "bem") == 0
    assert "no error estimate (add --estimate)" in capsys.readouterr().out
    for more in ((), ("--out", str(tmp_path))):
        assert code_of("solve", scene_file, "--solver", "bem", "--estimate", *more) == 0
        out = capsys.readouterr().out
        assert "error estimate" in out.splitlines()[1]
        assert f"errors are relative: {SCALES_IN_WORDS}" in out
    summary = json.loads((tmp_path / "summary.json").read_text())
    assert summary["error_estimates"]["approach_force"] == 0.0  # a fake is the same at any resolution


def test_solve_draws_into_out_or_the_current_folder(capsys, tmp_path, scene_file, fakes, monkeypatch):
    (tmp_path / "here").mkdir()
    monkeypatch.chdir(tmp_path / "here")
    for folder, more in ((Path(), ()), (tmp_path / "there", ("--out", str(tmp_path / "there")))):
        with without_layout():
            assert code_of("solve", scene_file, "--solver", "bem", "--plot", *more) == 0
        assert f"drawn in {folder / 'force.png'} and {folder / 'force.svg'}" in capsys.readouterr().out
        assert (folder / "force.png").read_bytes().startswith(b"\x89PNG")
        assert "<svg" in (folder / "force.svg").read_text("utf-8")
    assert sorted(file.name for file in Path().iterdir()) == ["force.png", "force.svg"]


def test_compare_of_some_solvers(capsys, scene_file, fakes):
    fakes(fem=fake(stiffness=1.02))
    assert code_of("compare", scene_file, "--jobs", "1", "--solvers", "reference, bem") == 0
    out = capsys.readouterr().out
    assert {line.split()[0] for line in out.splitlines()[2:] if line.strip()} == {"bem", "reference"}
