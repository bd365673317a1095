"""``crosscontact material``: prints, writes and draws what the file holds; one line for what is wrong."""

from __future__ import annotations

from functools import partial

import numpy as np
import pytest
from support import commands
from support.unlaid_figures import without_layout

import crosscontact as cc
from validation.drawing import material_figure

TIMES = np.geomspace(1e-3, 1e3, 49)
KNOWN = cc.Material(1.0, 0.5, (cc.Branch(5.0, 0.01), cc.Branch(2.0, 0.3), cc.Branch(1.2e-3, 30.0)))
REST = '[indenter]\nshape = "sphere"\nradius = 1.0\n[loading]\nstart = "relaxed"\npenetration = 0.0\n'


def table(header, *columns):
    rows = [" ".join(repr(float(x)) for x in row) for row in zip(*columns, strict=True)]
    return "\n".join([header, *rows]) + "\n"


RELAXATION = table("t E", TIMES, KNOWN.relaxation_modulus(TIMES))
RATES = 1.0 / TIMES
DYNAMIC = table("w G' G''", RATES, KNOWN.storage_modulus(RATES) / 3, KNOWN.loss_modulus(RATES) / 3)
MODES = "# Maxwell modes\n\n#number of modes\n2\n\n#   i tau_i G_i\n1\t0.01\t5\n2\t1\t2\n\n#end"
PYVISCO = "i,tau_i,alpha_i,E_0,E_i\n-,s,-,MPa,MPa\n1,0.01,0.5,20.0,10.0\n2,100.0,0.3,20.0,6.0\n"
SHORT = "t E\n1 2\n2 1\n3 1\n"


code_of = partial(commands.code_of, "material")


@pytest.fixture
def file(tmp_path):
    return tmp_path / "moduli.txt"


@pytest.mark.parametrize(
    ("content", "options", "times", "said"),
    [
        (RELAXATION, {"poisson": 0.4}, (0.01, 0.3), "relaxation Young's modulus over time, 49 rows"),
        (RELAXATION, {"tolerance": 1e-6}, (0.01, 0.3, 30.0), "  branches          3 "),
        (DYNAMIC, {"tolerance": 1e-6}, (0.01, 0.3, 30.0), "storage and loss shear modulus over angular"),
        (MODES, {"modulus": 0.75}, (0.01, 1.0), "Prony series (reptate) of 2 branches"),
        (PYVISCO, {"poisson": 0.3}, (0.01, 100.0), "Prony series (pyvisco) of 2 branches"),
    ],
)
def test_a_file_becomes_the_material_of_a_scene(tmp_path, capsys, file, content, options, times, said):
    file.write_text(content)
    given = [text for name, value in options.items() for text in (f"--{name}", value)]
    assert code_of(file, *given, "--out", tmp_path) == 0
    assert said in capsys.readouterr().out
    snippet = (tmp_path / "material.toml").read_text()
    (tmp_path / "scene.toml").write_text(snippet + REST)
    material = cc.read_scene(tmp_path / "scene.toml").material
    assert [branch.time for branch in material.branches] == pytest.approx(times, rel=0.01)
    if "tolerance" not in options:
        assert material == cc.read_material(file, **options)
    assert f"# {file}" in snippet


def test_branches_of_scattered_data_are_dropped_by_schwarz_criterion(capsys, file):
    scatter = 1.0 + 0.01 * np.random.default_rng(1).standard_normal(TIMES.size)
    file.write_text(table("t E", TIMES, KNOWN.relaxation_modulus(TIMES) * scatter))
    assert code_of(file) == 0
    lines = capsys.readouterr().out.splitlines()
    afters = [float(line.split("->")[1]) for line in lines if "dropped: time" in line]
    assert min(afters) > 0.001  # misfits above the tolerance


def test_a_melt_needs_a_relaxed_modulus(tmp_path, capsys, file):
    file.write_text(table("t E", TIMES, 5.0 * np.exp(-TIMES / 200.0)))
    assert code_of(file) == 0
    assert "the data show no relaxed modulus; a scene needs one: --modulus" in capsys.readouterr().out
    assert code_of(file, "--out", tmp_path) == 2
    assert "--modulus: is missing" in capsys.readouterr().err
    assert not (tmp_path / "material.toml").exists()
    assert code_of(file, "--modulus", "1e-6", "--out", tmp_path) == 0
    assert "modulus = 1e-06" in (tmp_path / "material.toml").read_text()


@pytest.mark.parametrize(
    ("content", "doubt", "tolerance"),
    [
        ("t,E\n" + "".join(f"{t},{t}\n" for t in range(1, 6)), "no Prony series meets the data: misfit", 0.6),
        ("t,E\n1,3\n10,2\n100,1.5\n", "3 measured moduli do not determine 5 numbers of the series", 0.2),
    ],
)
def test_doubts_are_told_written_and_exit_code_1(tmp_path, capsys, file, content, doubt, tolerance):
    file.write_text(content)
    assert code_of(file, "--out", tmp_path) == 1
    (line,) = capsys.readouterr().err.splitlines()
    assert line.startswith(f"crosscontact: {file}: {doubt}")
    assert f"# {doubt}" in (tmp_path / "material.toml").read_text()
    assert code_of(file, "--tolerance", tolerance) == 0  # as much was allowed
    assert capsys.readouterr().err == ""


def test_a_relaxed_modulus_above_the_data_is_doubtful(capsys, file):
    file.write_text(RELAXATION)
    assert code_of(file, "--modulus", "1.01", "--tolerance", "1") == 0
    (line,) = capsys.readouterr().err.splitlines()
    assert line.startswith("crosscontact: warning: --modulus 1.01 is above the smallest Young's")


def test_what_figures_show(tmp_path, monkeypatch, file):
    monkeypatch.chdir(tmp_path)
    file.write_text(RELAXATION)
    with without_layout():
        assert code_of(file, "--plot") == 0
    assert (tmp_path / "material.png").read_bytes().startswith(b"\x89PNG")
    storage, *_ = material_figure.draw_series(KNOWN).axes[0].get_lines()
    np.testing.assert_array_equal(storage.get_ydata(), KNOWN.storage_modulus(storage.get_xdata()))
    fit = cc.fit_prony(cc.read_measured(file))
    top, middle, bottom = material_figure.draw_fit(fit).axes
    measured, series = top.get_lines()
    np.testing.assert_array_equal(measured.get_ydata(), fit.data.moduli)
    fitted = fit.material(0.5).relaxation_modulus(series.get_xdata())
    np.testing.assert_allclose(series.get_ydata(), fitted, rtol=1e-12)
    np.testing.assert_allclose(middle.get_lines()[0].get_ydata(), 100.0 * fit.residuals)
    labels = bottom.get_legend_handles_labels()[1]
    assert labels == ["times tried", "2 branches kept", f"{len(fit.dropped)} dropped", "relaxed modulus"]


@pytest.mark.parametrize(
    ("content", "arguments", "said"),
    [
        (None, (), "No such file"),
        ("", (), "the file is empty"),
        (SHORT, ("--format", "excel"), '"reptate"'),
        (SHORT, ("--poisson", "x"), "--poisson"),
        (SHORT, ("--modulus", "-1"), "--modulus: got -1.0"),
        (SHORT, ("--tolerance", "nan"), "tolerance: got nan"),
        (MODES, (), "modulus: "),
        (MODES, ("--modulus", "1", "--tolerance", "0.1"), "--tolerance: given for a Prony series"),
    ],
)
def test_bad_input_is_one_line(capsys, file, content, arguments, said):
    if content is not None:
        file.write_text(content)
    assert said in commands.refusal(capsys, "material", file, *arguments)
