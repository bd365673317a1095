"""``crosscontact material``: prints, writes and draws what the file holds; one line for what is wrong."""

from __future__ import annotations

import numpy as np
import pytest
from support.unlaid_figures import without_layout

import crosscontact as cc
from crosscontact.cli import main
from validation.drawing import material_figure

TIMES = np.geomspace(1e-3, 1e3, 49)
KNOWN = cc.Material(1.0, 0.5, (cc.Branch(5.0, 0.01), cc.Branch(2.0, 0.3), cc.Branch(1.2e-3, 30.0)))
REST = '[indenter]\nshape = "sphere"\nradius = 1.0\n[loading]\nstart = "relaxed"\npenetration = 0.0\n'
MODES = "# Maxwell modes\n\n#number of modes\n2\n\n#   i tau_i G_i\n1\t0.01\t5\n2\t1\t2\n\n#end"


def code_of(*arguments):
    try:
        return main(["material", *map(str, arguments)])
    except SystemExit as leave:
        return int(leave.code or 0)


def table(header, *columns):
    rows = [" ".join(repr(float(x)) for x in row) for row in zip(*columns, strict=True)]
    return "\n".join([header, *rows]) + "\n"


@pytest.fixture
def relaxation(tmp_path):
    file = tmp_path / "relaxation.txt"
    file.write_text(table("t E", TIMES, KNOWN.relaxation_modulus(TIMES)))
    return file


@pytest.fixture
def dynamic(tmp_path):
    file = tmp_path / "dynamic.csv"
    w = 1.0 / TIMES
    file.write_text(table("w G' G''", w, KNOWN.storage_modulus(w) / 3, KNOWN.loss_modulus(w) / 3))
    return file


def test_measured_relaxation_becomes_the_material_of_a_scene(tmp_path, capsys, relaxation):
    out = tmp_path / "out"
    assert code_of(relaxation, "--poisson", "0.4", "--out", out) == 0
    printed = capsys.readouterr().out
    assert f"{relaxation}: relaxation Young's modulus over time, 49 rows" in printed
    assert "dropped: time 30, Young's modulus 0.0012: misfit " in printed
    assert "root mean square of fit/measured - 1" in printed
    snippet = (out / "material.toml").read_text()
    (tmp_path / "scene.toml").write_text(snippet + REST)
    material = cc.read_scene(tmp_path / "scene.toml").material
    assert material == cc.fit_prony(cc.read_measured(relaxation)).material(0.4)
    assert [branch.time for branch in material.branches] == [
        pytest.approx(0.01, rel=0.01),
        pytest.approx(0.3, rel=0.01),
    ]
    assert "# " + str(relaxation) in snippet
    assert "#   misfit" in snippet


def test_every_branch_at_a_finer_tolerance(capsys, relaxation):
    assert code_of(relaxation, "--tolerance", "1e-6") == 0
    assert "  branches          3 " in capsys.readouterr().out


def test_branches_of_scattered_data_are_dropped_as_the_help_says(tmp_path, capsys):
    """By Schwarz' criterion, at misfits above the tolerance."""
    assert code_of("--help") == 0
    told = " ".join(capsys.readouterr().out.split())
    assert "scatter by more, as long as Schwarz' criterion prefers the shorter series; default: 0.001" in told
    file = tmp_path / "noisy.txt"
    scatter = 1.0 + 0.01 * np.random.default_rng(1).standard_normal(TIMES.size)
    file.write_text(table("t E", TIMES, KNOWN.relaxation_modulus(TIMES) * scatter))
    assert code_of(file) == 0
    lines = capsys.readouterr().out.splitlines()
    afters = [float(line.split("->")[1]) for line in lines if "dropped: time" in line]
    assert afters
    assert min(afters) > 0.001


def test_storage_and_loss_of_shear(tmp_path, capsys, dynamic):
    assert code_of(dynamic, "--tolerance", "1e-6", "--out", tmp_path / "out") == 0
    assert "storage and loss shear modulus over angular frequency, 49 rows" in capsys.readouterr().out
    (tmp_path / "scene.toml").write_text((tmp_path / "out" / "material.toml").read_text() + REST)
    material = cc.read_scene(tmp_path / "scene.toml").material
    np.testing.assert_allclose([b.modulus for b in material.branches], [5.0, 2.0, 1.2e-3], rtol=1e-4)


def test_modes_of_reptate(tmp_path, capsys):
    file = tmp_path / "modes.txt"
    file.write_text(MODES)
    assert code_of(file, "--modulus", "0.75", "--out", tmp_path) == 0
    assert "Prony series (reptate) of 2 branches" in capsys.readouterr().out
    (tmp_path / "scene.toml").write_text((tmp_path / "material.toml").read_text() + REST)
    material = cc.read_scene(tmp_path / "scene.toml").material
    assert material == cc.Material(0.75, 0.5, (cc.Branch(15.0, 0.01), cc.Branch(6.0, 1.0)))
    assert material == cc.read_material(file, modulus=0.75)


def test_a_table_of_pyvisco(tmp_path, capsys):
    file = tmp_path / "df_prony.csv"
    file.write_text("i,tau_i,alpha_i,E_0,E_i\n-,s,-,MPa,MPa\n1,0.01,0.5,20.0,10.0\n2,100.0,0.3,20.0,6.0\n")
    assert code_of(file, "--poisson", "0.3", "--out", tmp_path) == 0
    assert "Prony series (pyvisco) of 2 branches" in capsys.readouterr().out
    (tmp_path / "scene.toml").write_text((tmp_path / "material.toml").read_text() + REST)
    assert cc.read_scene(tmp_path / "scene.toml").material == cc.read_material(file, poisson=0.3)


def test_a_melt_needs_a_relaxed_modulus(tmp_path, capsys):
    file = tmp_path / "melt.txt"
    file.write_text(table("t E", TIMES, 5.0 * np.exp(-TIMES / 200.0)))
    assert code_of(file) == 0
    assert "the data show no relaxed modulus; a scene needs one: --modulus" in capsys.readouterr().out
    assert code_of(file, "--out", tmp_path) == 2
    assert "--modulus: is missing" in capsys.readouterr().err
    assert not (tmp_path / "material.toml").exists()
    assert code_of(file, "--modulus", "1e-6", "--out", tmp_path) == 0
    assert "modulus = 1e-06" in (tmp_path / "material.toml").read_text()


def test_data_that_no_series_meets_are_told_and_exit_1(tmp_path, capsys):
    file, out = tmp_path / "rising.csv", tmp_path / "out"
    file.write_text("t,E\n" + "".join(f"{t},{t}\n" for t in range(1, 6)))
    assert code_of(file, "--out", out) == 1
    (line,) = capsys.readouterr().err.splitlines()
    doubt = "no Prony series meets the data: misfit 0.54, at most 0.69; allowed: a misfit of at most 0.05"
    assert line == f"crosscontact: {file}: {doubt}"
    assert f"# {doubt}\n" in (out / "material.toml").read_text()
    with pytest.raises(cc.SceneError, match="no Prony series meets the data: misfit 0"):
        cc.read_material(file)
    assert code_of(file, "--tolerance", "0.6") == 0  # as much was allowed


def test_moduli_too_few_for_their_series_are_told_and_exit_1(tmp_path, capsys):
    file, out = tmp_path / "three.csv", tmp_path / "out"
    file.write_text("t,E\n1,3\n10,2\n100,1.5\n")
    assert code_of(file, "--out", out) == 1
    (line,) = capsys.readouterr().err.splitlines()
    assert line.startswith(f"crosscontact: {file}: 3 measured moduli do not determine 5 numbers of the")
    assert "# 3 measured moduli do not determine" in (out / "material.toml").read_text()
    assert code_of(file, "--tolerance", "0.2") == 0
    assert capsys.readouterr().err == ""


@pytest.mark.slow
def test_a_relaxed_modulus_above_the_data_is_doubtful(capsys, dynamic):
    least = KNOWN.storage_modulus(1.0 / TIMES).min()  # of Young: the file holds a third
    assert code_of(dynamic, "--modulus", str(0.99 * least), "--tolerance", "1") == 0
    assert capsys.readouterr().err == ""
    assert code_of(dynamic, "--modulus", str(1.01 * least), "--tolerance", "1") == 0
    (line,) = capsys.readouterr().err.splitlines()
    assert line.startswith(f"crosscontact: warning: --modulus {1.01 * least:g} is above the smallest Young's")


def test_the_figure_is_drawn(tmp_path, monkeypatch, relaxation):
    monkeypatch.chdir(tmp_path)
    with without_layout():
        assert code_of(relaxation, "--plot") == 0
    assert (tmp_path / "material.png").read_bytes().startswith(b"\x89PNG")
    assert "<svg" in (tmp_path / "material.svg").read_text()


def test_what_the_figure_of_a_series_shows():
    storage, loss, relaxation = (
        line for axes in material_figure.draw_series(KNOWN).axes[:2] for line in axes.get_lines()
    )
    np.testing.assert_array_equal(storage.get_ydata(), KNOWN.storage_modulus(storage.get_xdata()))
    np.testing.assert_array_equal(loss.get_ydata(), KNOWN.loss_modulus(loss.get_xdata()))
    np.testing.assert_array_equal(relaxation.get_ydata(), KNOWN.relaxation_modulus(relaxation.get_xdata()))
    assert material_figure.draw_series(cc.Material(1.0, 0.5)).axes[1].get_lines()[0].get_ydata()[0] == 1.0


def test_what_the_figure_of_a_fit_shows(relaxation, dynamic):
    fit = cc.fit_prony(cc.read_measured(relaxation))
    top, middle, bottom = material_figure.draw_fit(fit).axes
    measured, series = top.get_lines()
    np.testing.assert_array_equal(measured.get_xdata(), fit.data.times)
    np.testing.assert_array_equal(measured.get_ydata(), fit.data.moduli)
    np.testing.assert_allclose(
        series.get_ydata(), fit.material(0.5).relaxation_modulus(series.get_xdata()), rtol=1e-12
    )
    np.testing.assert_allclose(middle.get_lines()[0].get_ydata(), 100.0 * fit.residuals)
    labels = bottom.get_legend_handles_labels()[1]
    assert labels == ["times tried", "2 branches kept", f"{len(fit.dropped)} dropped", "relaxed modulus"]
    assert (top.get_xscale(), top.get_yscale(), bottom.get_xscale()) == ("log", "log", "log")
    assert top.get_xlabel() == "time (unit of the file)"

    fit = cc.fit_prony(cc.read_measured(dynamic))
    top, middle, _ = material_figure.draw_fit(fit).axes
    storage, storage_fit, loss, loss_fit = top.get_lines()
    np.testing.assert_array_equal(storage.get_ydata(), fit.data.storage)
    np.testing.assert_array_equal(loss.get_ydata(), fit.data.loss)
    series = cc.Material(fit.modulus, 0.5, fit.branches)
    np.testing.assert_allclose(storage_fit.get_ydata(), series.storage_modulus(storage_fit.get_xdata()))
    np.testing.assert_allclose(loss_fit.get_ydata(), series.loss_modulus(loss_fit.get_xdata()))
    drawn = np.concatenate([line.get_ydata() for line in middle.get_lines()[:2]])
    np.testing.assert_array_equal(drawn, 100.0 * fit.residuals)
    assert len({line.get_color() for line in (storage, loss)}) == 2
    assert len({line.get_marker() for line in (storage, loss)}) == 2
    assert top.get_ylabel() == "$G'$, $G''$ (unit of the file)"


def test_the_figure_of_a_melt():
    """Nothing is added to the series in place of the relaxed modulus, whatever the unit."""
    fit = cc.fit_prony(cc.RelaxationData(TIMES, 5e-30 * np.exp(-TIMES / 200.0)))
    top, _, bottom = material_figure.draw_fit(fit).axes
    series = top.get_lines()[1]
    np.testing.assert_allclose(series.get_ydata(), 5e-30 * np.exp(-series.get_xdata() / 200.0), rtol=1e-9)
    assert "relaxed modulus" not in bottom.get_legend_handles_labels()[1]


def test_units_of_the_file_are_on_the_axes(tmp_path):
    file = tmp_path / "x.csv"
    moduli = KNOWN.relaxation_modulus(TIMES)
    file.write_text("t,E_relax\ns,MPa\n" + "".join(f"{t},{m}\n" for t, m in zip(TIMES, moduli, strict=True)))
    top = material_figure.draw_fit(cc.fit_prony(cc.read_measured(file))).axes[0]
    assert (top.get_xlabel(), top.get_ylabel()) == ("time (s)", "$E(t)$ (MPa)")


@pytest.mark.parametrize(
    ("content", "arguments", "said"),
    [
        (None, (), "No such file"),
        ("", (), "the file is empty"),
        ("a b\n1 2\n", (), "columns: got 'a,b'; allowed: tau, E"),
        ("1 2\n2 1\n", (), "2 rows of data; allowed: 3 to 20000"),
        ("t E\n1 2\n2 1\n3 1\n", ("--format", "excel"), '"reptate"'),
        ("t E\n1 2\n2 1\n3 1\n", ("--poisson", "0.7"), "poisson: got 0.7"),
        ("t E\n1 2\n2 1\n3 1\n", ("--poisson", "x"), "--poisson"),
        ("t E\n1 2\n2 1\n3 1\n", ("--modulus", "-1"), "--modulus: got -1.0"),
        ("t E\n1 2\n2 1\n3 1\n", ("--tolerance", "nan"), "tolerance: must be finite"),
        ("t E\n1 2\n2 1\n3 1\n", ("--out", "/proc/nothing/here"), "--out"),
        (MODES, (), "modulus: "),
        (MODES, ("--modulus", "1", "--tolerance", "0.1"), "--tolerance: given for a Prony series"),
    ],
)
def test_bad_input_is_one_line(tmp_path, capsys, content, arguments, said):
    file = tmp_path / "x.txt"
    if content is not None:
        file.write_text(content)
    assert code_of(file, *arguments) == 2
    out, err = capsys.readouterr()
    assert out == ""
    assert said in err
    assert err.count("\n") == 1
    assert "allowed: " in err or "argument" in err


def test_the_parts_are_at_the_door():
    material = cc.PowerLawRelaxation(0.3, 2.0, 1.0, (1e-3, 1e3)).material(0.5)
    hot = cc.at_temperature(material, cc.WLF(17.44, 51.6, 373.15), 424.75)
    assert hot.branches[0].time == pytest.approx(material.branches[0].time * 10**-8.72, rel=1e-12)
    assert cc.StandardLinearSolid(1.0, 3.0, 2.0).material(0.3) == cc.Material(
        1.0, 0.3, (cc.Branch(2.0, 2.0),)
    )
