"""What a result can be turned into: tables, figure, notebook representation, files and back."""

from __future__ import annotations

import dataclasses
import json
import subprocess
import sys

import numpy as np
import pytest
from support.wrong_values import refusal

import crosscontact as cc

ENERGIES = ("stored_energy", "external_work", "dissipated_energy")

SCENE = cc.Scene(
    cc.Material(0.75, 0.5, (cc.Branch(6.75, 1.0),)),
    cc.Sphere(1.0),
    cc.Loading("jump-in", 0.0, (cc.Ramp(0.01, 0.02), cc.Ramp(-0.5, 0.02))),
    cc.Adhesion(5.026548e-4, 0.013),
    "a <short> cycle",
)
CONE = dataclasses.replace(
    SCENE,
    indenter=cc.Cone(70.0),
    loading=cc.Loading("jump-in", 0.03, (cc.Ramp(0.05, 0.05), cc.Ramp(-0.5, 0.05))),
)

SPRUNG = dataclasses.replace(
    SCENE,
    material=cc.Material(0.75, 0.5),
    loading=cc.Loading("jump-in", 0.0, (cc.Ramp(0.01, 0.02), cc.Ramp(-0.5, 0.02)), cc.Machine(0.05)),
)


@pytest.fixture(scope="module")
def sprung():
    """A result on a spring, from which contact is lost in an instability."""
    return cc.solve(SPRUNG, resolution=4)


@pytest.fixture(scope="module")
def result():
    return cc.solve(SCENE, estimate_errors=True)


@pytest.fixture
def axes_free():
    """Figures that are drawn here are closed."""
    import matplotlib
    from matplotlib import pyplot

    matplotlib.use("agg")
    yield
    pyplot.close("all")


def test_saved_and_loaded_bit_for_bit(result, tmp_path):
    result.save(tmp_path / "first")
    again = cc.load(tmp_path / "first")
    assert again.scene == result.scene
    for name, column in result.trace.columns().items():
        assert again.trace.columns()[name].tobytes() == column.tobytes(), name
    assert list(again.trace.columns()) == list(result.trace.columns())
    assert again.outcome == result.outcome
    assert again.trace.events == result.trace.events
    assert again.trace.counters == result.trace.counters
    assert again.measures == result.measures
    assert again.errors == result.errors
    assert repr(again) == repr(result)
    again.save(tmp_path / "second")
    for name in ("scene.toml", "trace.csv", "summary.json"):
        assert (tmp_path / "first" / name).read_bytes() == (tmp_path / "second" / name).read_bytes()


@pytest.mark.parametrize("solver", ["bem", "fem"])
def test_every_solver_round_trips(solver, tmp_path):
    result = cc.solve("relaxed-equilibrium", solver, resolution=8)
    result.save(tmp_path)
    again = cc.load(tmp_path)
    assert (again.outcome, again.measures) == (result.outcome, result.measures)


@pytest.mark.parametrize(
    ("name", "content", "text"),
    [
        ("summary.json", None, "has no summary.json"),
        ("trace.csv", None, "trace.csv: cannot be read"),
        ("scene.toml", "x = 1", "scene.toml: x: unknown key"),
        ("summary.json", "{", "summary.json: damaged"),
        ("summary.json", "{}", "summary.json: solver: got None"),
        ("trace.csv", "time\n1\n", "damaged"),
    ],
)
def test_a_damaged_folder_is_one_line(result, tmp_path, name, content, text):
    result.save(tmp_path)
    if content is None:
        (tmp_path / name).unlink()
    else:
        (tmp_path / name).write_text(content)
    line = str(refusal(cc.load, tmp_path))
    assert text in line
    assert str(tmp_path) in line


def test_a_run_without_an_answer_is_one_line(result, tmp_path):
    result.save(tmp_path)
    summary = json.loads((tmp_path / "summary.json").read_text())
    (tmp_path / "summary.json").write_text(json.dumps(summary | {"outcome": "failed", "reason": "overflow"}))
    with pytest.raises(cc.SceneError, match="reference gave no answer: overflow"):
        cc.load(tmp_path)


def test_pandas(result):
    frame = result.to_pandas()
    assert list(frame.columns) == list(result.trace.columns())
    assert np.array_equal(frame["force"].to_numpy(), result.trace.force)
    assert frame.attrs["solver"] == "reference"
    assert frame.attrs["title"] == SCENE.title
    assert frame.attrs["units"]["force"] == "force in scene units"
    assert set(frame.attrs["units"]) == set(frame.columns)


def test_xarray(result):
    data = result.to_xarray()
    assert data.sizes == {"step": len(result.trace)}
    assert "time" in data.coords
    assert data["contact_radius"].attrs == {"units": "length in scene units", "long_name": "contact radius"}
    assert np.array_equal(data["force"].values, result.trace.force)
    assert data.attrs["outcome"] == "detached"


@pytest.mark.parametrize("package", ["pandas", "xarray"])
def test_without_the_extra_one_line_says_what_to_install(result, monkeypatch, package):
    monkeypatch.setitem(sys.modules, package, None)  # as if it were not installed
    with pytest.raises(ImportError) as error:
        getattr(result, f"to_{package}")()
    assert str(error.value) == f"{package} is not installed: pip install 'crosscontact[data]'"


def test_plot_draws_two_panels_and_marks_the_pull_off(result, axes_free):
    left, right = result.plot()
    assert left.get_xlabel() == "penetration Δ/R"
    assert left.get_ylabel() == right.get_xlabel() == "force (1−ν²)F/(πE₀R²)"
    assert right.get_ylabel() == "contact radius a/R"
    curve, mark = left.lines
    assert np.max(curve.get_xdata()) == pytest.approx(0.01)
    size = np.pi * SCENE.material.relaxed_plane_modulus
    assert mark.get_xdata()[0] == pytest.approx(result.pull_off.penetration)
    assert mark.get_ydata()[0] == pytest.approx(-result.pull_off.force / size)
    assert [text.get_text() for text in left.texts] == ["pull-off"]


@pytest.mark.parametrize(
    ("quantity", "across", "up"),
    [("F(t)", "time", "force"), ("a(F)", "force", "contact_radius"), ("D(X)", "stage", "penetration")],
)
def test_one_quantity_in_units_of_the_scene(sprung, axes_free, quantity, across, up):
    (panel,) = sprung.plot(quantity=quantity, units=True)
    known = sprung.trace.columns()
    for drawn, column in ((panel.lines[0].get_xdata(), across), (panel.lines[0].get_ydata(), up)):
        assert np.array_equal(drawn, known[column][: drawn.size])
    for label, column in ((panel.get_xlabel(), across), (panel.get_ylabel(), up)):
        assert label.startswith(column.replace("_", " "))
        assert label.endswith("(scene units)")
    assert sprung.plot(panel, quantity=quantity) == (panel,)


@pytest.mark.parametrize("quantity", ["F(t)", "F(D)", "F(X)"])
def test_a_record_stands_behind_the_run_and_is_not_hidden_by_it(sprung, axes_free, quantity):
    trace, stiffness = sprung.trace, sprung.scene.machine.stiffness
    time, rows = np.unique(trace.time, return_index=True)
    record = cc.MeasuredCurve(time, trace.force[rows], stage=trace.extra["stage"][rows], stiffness=stiffness)
    (panel,) = sprung.plot(quantity=quantity, data=record, linewidth=1.2)
    (dots,) = (line for line in panel.lines if line.get_label() == record.name)
    run = next(line for line in panel.lines if line.get_label() == sprung.solver)
    assert dots.get_zorder() < run.get_zorder()
    (panel,) = sprung.plot(quantity=quantity, data=record, linewidth=4.0)
    hidden, broad = panel.lines[0], panel.lines[1]
    assert (hidden.get_label(), broad.get_label()) == (record.name, sprung.solver)
    assert hidden.get_zorder() > broad.get_zorder()
    assert np.max(dots.get_ydata()) == pytest.approx(np.max(run.get_ydata()))
    assert np.max(dots.get_xdata()) == pytest.approx(np.max(run.get_xdata()), rel=1e-6)
    for wrong, asked in ((record, "a(F)"), ("a.csv", "F(t)")):
        with pytest.raises(cc.SceneError, match=r"^data: "):
            sprung.plot(quantity=asked, data=wrong)


@pytest.mark.parametrize("quantity", ["F", "F(F)", "x(t)", "X(t)", 3])
def test_a_quantity_that_there_is_not_is_told(result, quantity):
    with pytest.raises(cc.SceneError, match=r"^quantity: .*; allowed: two of F, D, a, t, as F\(t\)"):
        result.plot(quantity=quantity)


@pytest.mark.parametrize("run", ["result", "sprung"])
def test_arrows_tell_the_way_and_the_label_of_the_pull_off_stands_free(run, request):
    figure = request.getfixturevalue(run).figure()
    figure.draw_without_rendering()
    for panel in figure.axes:
        arrows = [one for one in panel.patches if hasattr(one, "get_arrowstyle")]
        assert len(arrows) == (0 if panel.get_xlabel().startswith("time") else 2)
        (label,) = (text for text in panel.texts if text.get_text() == "pull-off")
        box, run_line = label.get_window_extent(), panel.lines[0]
        way = panel.transData.transform(run_line.get_xydata())
        assert not (((way > box.min) & (way < box.max)).all(axis=1)).any()


def test_on_a_spring_the_stage_is_drawn_and_instabilities_are_marked(sprung, axes_free):
    figure = sprung.figure()
    over_time, left, middle, right = figure.axes
    assert over_time.get_xlabel().startswith("time")
    assert (left.get_xlabel(), middle.get_xlabel()) == ("penetration Δ/R", "stage X/R")
    assert left.get_ylabel() == middle.get_ylabel() == right.get_xlabel()
    (event,) = sprung.trace.events
    stage = event.penetration + event.force / 0.05
    assert stage == pytest.approx(sprung.trace.extra["stage"][-1])
    curve, _, cross, jump = middle.lines
    assert np.array_equal(curve.get_xdata(), sprung.trace.extra["stage"][:-1])
    assert cross.get_xdata()[0] == pytest.approx(stage)
    assert cross.get_ydata()[0] == curve.get_ydata()[-1]
    assert jump.get_xdata() == pytest.approx([stage, stage])
    assert jump.get_ydata()[-1] == 0.0
    assert left.lines[3].get_xdata() == pytest.approx([event.penetration, stage])
    assert left.get_xlim()[0] > stage  # the free indenter is far away: the contact is what is shown
    assert right.lines[2].get_ydata()[0] == event.contact_radius
    assert [text.get_text() for text in left.get_legend().get_texts()] == ["reference", "instability"]
    assert (
        'alt="force over time, force against penetration, force against stage and contact'
        in sprung._repr_html_()
    )


def test_on_a_spring_two_axes_do_too(sprung, axes_free):
    from matplotlib.figure import Figure

    left, right = sprung.plot(Figure().subplots(1, 2))
    assert (left.get_xlabel(), right.get_ylabel()) == ("penetration Δ/R", "contact radius a/R")
    with pytest.raises(cc.SceneError, match="two or three Axes"):
        sprung.plot(Figure().subplots(1, 4))
    compared = cc.SolverComparison(SPRUNG, {"bem": sprung, "reference": sprung}, {}, ())
    assert len(compared.plot()[0].get_legend().get_texts()) == 3  # the instability once


def test_on_a_spring_the_energy_lost_at_snaps_is_named(sprung, result):
    lines = repr(sprung).splitlines()
    (loss,) = (line.split() for line in lines if "instability_loss" in line)
    trace = sprung.trace
    assert float(loss[1]) == pytest.approx(trace.dissipated_energy[-1] - trace.dissipated_energy[-2])
    assert f"{sprung.measures['stage_at_detachment']:.8g}" in repr(sprung)
    assert "instability loss" in sprung._repr_html_()
    assert sprung.to_pandas().attrs["units"]["stage"] == "length in scene units"
    assert "instability" not in repr(result)


def test_axes_in_axes_out(result, axes_free):
    from matplotlib.figure import Figure

    given = Figure().subplots(1, 2)
    other = cc.solve(SCENE, "bem", resolution=8)
    assert result.plot(given) == tuple(given)
    other.plot(given, linewidth=0.7)
    assert len(given[0].lines) == 4
    assert given[0].lines[2].get_linewidth() == 0.7
    colours = {given[0].lines[0].get_color(), given[0].lines[2].get_color()}
    assert len(colours) == 2
    assert len(given[0].texts) == 1  # said once
    assert [text.get_text() for text in given[0].get_legend().get_texts()] == ["reference", "bem"]


def test_runs_in_one_figure_have_labels_of_their_own(result, axes_free):
    axes = result.plot(label="1 um/s")
    for _ in range(3):
        result.plot(axes)
    named = "a <short> cycle, reference"
    for panel in axes:
        labels = [line.get_label() for line in panel.lines if not line.get_label().startswith("_")]
        assert labels == ["1 um/s", "reference", named, f"{named} (2)"]
        assert len({line.get_color() for line in panel.lines}) == 4


def test_a_small_run_fills_its_panels(axes_free):
    """Arrows of time, drawn in points, leave limits alone."""
    for panel in cc.solve("afm-si", resolution=4).plot(units=True):
        held = panel.dataLim
        assert np.ptp(panel.get_xlim()) < 1.7 * held.width
        assert np.ptp(panel.get_ylim()) < 1.7 * held.height
        assert min(held.width, held.height) < 1e-5  # metres or newtons


@pytest.mark.parametrize("many", [1, 3, (2, 2)])
def test_other_than_two_axes_are_refused_in_one_line(result, axes_free, many):
    from matplotlib.figure import Figure

    shape = many if isinstance(many, tuple) else (1, many)
    for draw in (result.plot, cc.SolverComparison(SCENE, {}, {}, ()).plot):
        with pytest.raises(cc.SceneError, match=r"axes: got .*; allowed: two Axes"):
            draw(Figure().subplots(*shape))


def test_other_shapes_are_drawn_in_units_of_the_scene(axes_free):
    result = cc.solve(CONE)
    left, _ = result.plot()
    assert left.get_ylabel() == "force F (scene units)"
    assert "F_JKR" not in repr(result)
    assert "dimensionless" not in repr(result)


def test_compared_results_are_laid_over_each_other(axes_free):
    compared = cc.compare("relaxed-equilibrium", ["bem", "reference"], estimate_errors=False)
    left, _ = compared.plot()
    assert [text.get_text() for text in left.get_legend().get_texts()] == ["reference", "bem"]


def test_text_names_units_jkr_ratio_and_errors(result):
    line = next(line for line in repr(result).splitlines() if "pull_off_force" in line)
    jkr = 1.5 * np.pi * 5.026548e-4
    assert f"{result.pull_off.force / jkr:.6g}" in line
    assert "πE₀R²/(1−ν²)" in line
    assert f"{result.errors['pull_off_force']:.1e}" in line
    assert "F/F_JKR" in repr(result)


def test_notebook_representation(result):
    html = result._repr_html_()
    assert "a &lt;short&gt; cycle by reference" in html
    assert html.count("<img ") == html.count('src="data:image/png;base64,') == 1
    assert "pull off force" in html
    assert len(html) < 100_000


@pytest.mark.slow
def test_a_notebook_figure_opens_no_window(result):
    code = (
        "import sys, crosscontact as cc\n"
        "cc.solve('relaxed-equilibrium')._repr_html_()\n"
        "print('matplotlib.pyplot' in sys.modules)"
    )
    ended = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert ended.stdout == "False\n"
