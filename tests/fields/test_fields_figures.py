"""What figures of fields show, in numbers: geometry, colours, moments, Fig. 3. Nothing is rendered here."""

from __future__ import annotations

import dataclasses
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from matplotlib import colormaps
from support.synthetic_fields import RADIUS, SCENE, ZONE, state, states, surfaces, trace

from contact_scene import FlatPunch, SceneError
from validation.fields.figures import (
    colours,
    fig3,
    geometry,
    moments,
    rendering,
    single_section,
)
from validation.fields.figures.colours import ValueKind
from validation.fields.figures.figure_set import FigureSet
from validation.fields.figures.quantities import QUANTITIES

ROOT = Path(__file__).parents[2]


@given(largest=st.floats(1e-9, 1e9), radius=st.floats(1e-9, 1e9))
def test_magnification_is_the_largest_round_number_within_the_swing(largest, radius):
    scale = geometry.magnification(largest, radius)
    room = geometry.LARGEST_DRAWN * geometry.HALF_WIDTH * radius / largest
    assert scale <= room * (1 + 1e-6) < 2.5 * scale * (1 + 1e-6)
    digit = scale / 10.0 ** np.floor(np.log10(scale * (1 + 1e-9)))
    assert round(digit) in (1, 2, 5)
    assert digit == pytest.approx(round(digit))


@pytest.mark.parametrize(("pulled", "drawn"), [(0.0, 50.0), (0.03, 20.0), (0.3, 2.0), (3.0, 0.2)])
def test_no_triangle_near_the_edge_is_folded_over(pulled, drawn):
    """Points beyond it move towards it: a triangle keeps one less ``pulled`` times the magnification."""
    one = state()
    moves = one.displacement * 0.0
    moves[:, 0] = -pulled * np.maximum(one.points[:, 0] - RADIUS, 0.0)
    one = dataclasses.replace(one, displacement=moves)
    assert geometry.magnification_near_edge(one, ZONE, 50.0) == pytest.approx(drawn)


@pytest.mark.parametrize("scale", [1.0, 5.0])
def test_marks_sit_on_the_deformed_surface_at_the_edge(scale):
    cut = geometry.section(state(), SCENE, scale)
    height = scale * (RADIUS**2 / 2 - 0.03)
    np.testing.assert_allclose(cut.edge, [RADIUS * (1 + 0.01 * scale), height])
    np.testing.assert_allclose(cut.zone[0], cut.edge)
    np.testing.assert_allclose(cut.zone[-1], [(RADIUS + ZONE) * (1 + 0.01 * scale), height])
    np.testing.assert_allclose(cut.moved, cut.state.points + scale * cut.state.displacement)
    np.testing.assert_allclose(cut.surface, cut.moved[cut.top])
    assert (np.diff(cut.surface[:, 0]) > 0).all()


def test_indenter_is_magnified_like_the_surface_it_touches():
    cut = geometry.section(state(), SCENE, 5.0)
    r, y = cut.indenter.T
    np.testing.assert_allclose(y, 5.0 * (r**2 / 2 - 0.03))
    punch = dataclasses.replace(SCENE, indenter=FlatPunch(0.3))
    side = geometry.outline(punch, 0.03, 2.0, 1.0)
    assert side[-1].tolist() == [0.3, 1.0]
    assert side[-2].tolist() == [pytest.approx(0.3), -0.06]


def test_no_process_zone_without_adhesion():
    bare = dataclasses.replace(SCENE, adhesion=None)
    assert geometry.section(state(), bare).zone.size == 0
    assert moments.zone(bare, 0.2) == pytest.approx(0.002)
    assert moments.zone(SCENE, 0.2) == ZONE


def test_areas_add_up_and_mirror_images_are_in_view():
    cut = geometry.section(state(), SCENE)
    assert cut.areas.sum() == pytest.approx(1.0)
    right = cut.within(geometry.View(0.1, 0.3, -0.5, 0.5))
    left = cut.within(geometry.View(-0.3, -0.1, -0.5, 0.5))
    assert right.any()
    np.testing.assert_array_equal(left, right)


def test_signed_colours_are_centred_on_zero():
    value = np.concatenate([np.linspace(-3.0, 1.0, 400), [50.0]])
    found = colours.colours(ValueKind.SIGNED, [value], [np.ones_like(value)])
    assert found.low == -found.high
    assert 2.9 < found.high < 3.0  # 99 % of the area; the spike is beyond
    assert found.extend == "both"
    assert found.shade(0.0) == pytest.approx(0.5)
    np.testing.assert_allclose(found.shade([-99.0, found.low, found.high, 99.0]), [0, 0, 1, 1])


def test_range_follows_area_not_the_number_of_nodes():
    value, area = np.array([1.0] * 5 + [9.0] * 95), np.array([1.0] * 5 + [1e-6] * 95)
    assert colours.colours(ValueKind.POSITIVE, [value], [area]).high == 1.0
    assert colours.colours(ValueKind.POSITIVE, [value], [np.ones(100)]).high == 9.0


def test_colours_serve_several_views_and_decades():
    one, two = np.linspace(0.0, 1.0, 50), np.linspace(0.0, 4.0, 50)
    shared = colours.colours(ValueKind.POSITIVE, [one, two], [np.ones(50)] * 2)
    assert 3.8 < shared.high <= 4.0
    assert shared.low == 0.0
    rates = colours.colours(ValueKind.DECADES, [two], [np.ones(50)])
    assert rates.high / rates.low == pytest.approx(10.0**colours.DECADES)
    assert rates.below
    np.testing.assert_allclose(rates.shade([0.0, rates.low, rates.low * 100, rates.high]), [0, 0, 0.5, 1])


def test_fields_that_are_zero_or_not_finite():
    nothing = colours.colours(ValueKind.SIGNED, [np.zeros(4)], [np.ones(4)])
    assert (nothing.low, nothing.high, nothing.extend) == (-1.0, 1.0, "neither")
    with pytest.raises(ValueError, match="finite"):
        colours.colours(ValueKind.SIGNED, [np.array([np.nan])], [np.ones(1)])


@pytest.mark.parametrize("kind", ValueKind)
def test_maps_are_even_in_lightness(kind):
    light = lightness(colormaps[kind.value](np.linspace(0, 1, 256))[:, :3])
    if kind is ValueKind.SIGNED:  # darkens alike to both sides of a light middle
        assert np.argmax(light) in range(120, 136)
        assert (np.diff(light[:120]) > -0.05).all()
        assert (np.diff(light[136:]) < 0.05).all()
        assert np.abs(light - light[::-1]).max() < 8.0
    else:
        step = np.diff(light)
        assert (step > 0.0).all()
        assert step.max() < 2.5 * step.mean()


def lightness(rgb):
    """CIE L* of sRGB colours."""
    linear = np.where(rgb > 0.04045, ((rgb + 0.055) / 1.055) ** 2.4, rgb / 12.92)
    return 116.0 * np.cbrt(linear @ (0.2126, 0.7152, 0.0722)) - 16.0


def test_quantities_read_the_state_they_name():
    one = state()
    for quantity in QUANTITIES.values():
        assert quantity.values(one).shape == (len(one.points),), quantity.name
        assert "(" in quantity.label
        assert "$" not in quantity.plain
    np.testing.assert_array_equal(QUANTITIES["stress_zz"].values(one), one.stress[1])
    np.testing.assert_array_equal(QUANTITIES["principal_1"].values(one), one.principal[0])
    np.testing.assert_array_equal(QUANTITIES["dissipation_rate"].values(one), one.dissipation_rate[0])
    assert QUANTITIES["stress_tt"].plain == "stress σθθ (force/length²)"
    signed = {name for name, one in QUANTITIES.items() if one.kind is ValueKind.SIGNED}
    assert {"stress_rz", "hydrostatic", "strain_tt", "displacement_z", "principal_3"} <= signed
    assert not {"von_mises", "max_shear", "dissipated_energy"} & signed


def test_key_moments_of_a_cycle():
    assert moments.key_moments(trace(), SCENE) == {
        0: "jump-in",
        3: "end of approach",
        7: "start of detachment",  # the first row a whole process zone inside the largest radius
        8: "pull-off",
    }
    never = trace(force=np.abs(trace().force))
    assert list(moments.key_moments(never, SCENE)) == [0, 3, 7]


def test_frames_are_spread_over_the_contact():
    assert moments.in_contact(trace(), 4) == [0, 3, 6, 9]
    assert moments.in_contact(trace(), 500) == list(range(10))
    assert moments.in_contact(trace(contact_radius=np.zeros(11)), 4) == []


def test_figures_ask_for_the_rows_they_draw():
    assert FigureSet().rows(trace(), SCENE) == {}
    assert not FigureSet(revolve=True).chooses_moments
    assert list(FigureSet(moments=True).rows(trace(), SCENE)) == [0, 3, 7, 8]
    both = FigureSet(moments=True, animate=True, frames=4).rows(trace(), SCENE)
    assert list(both) == [0, 3, 6, 7, 8, 9]
    assert both[8] == "pull-off"
    assert both[9] == ""
    with pytest.raises(SceneError, match="von-misses"):
        FigureSet(("von-misses",))


def test_without_rendering_sections_are_left_out_with_a_word_and_the_rest_is_an_error(monkeypatch, tmp_path):
    monkeypatch.setattr(rendering, "_attempt", lambda name: None)
    rendering.rendering_window.cache_clear()
    shown = states({3: "end of approach"})
    try:
        said = FigureSet().draw(tmp_path, shown, trace(), SCENE, lambda done: None)
        assert len(said) == 1
        assert "PyVista cannot draw" in said[0]
        assert "libegl1" in said[0]
        with pytest.raises(rendering.NoRendering):
            FigureSet(moments=True).draw(tmp_path, shown, trace(), SCENE, lambda done: None)
    finally:
        rendering.rendering_window.cache_clear()
    assert not list(tmp_path.rglob("*.png"))


@pytest.mark.parametrize(
    ("display", "said", "expected"),
    [
        (None, "drawn with vtkEGLRenderWindow", rendering.RenderingWindow("vtkEGLRenderWindow", False)),
        (":0", "drawn with vtkXOpenGLRenderWindow", rendering.RenderingWindow("", True)),
        (
            ":0",
            "drawn with vtkEGLRenderWindow",
            rendering.RenderingWindow("", False),
        ),  # no such screen
    ],
)
def test_screens_are_recognised(monkeypatch, display, said, expected):
    monkeypatch.setattr(rendering, "_attempt", lambda name: said)
    monkeypatch.setattr(sys, "platform", "linux")
    for name in ("PYVISTA_OFF_SCREEN", "DISPLAY", rendering.CHOICE):
        monkeypatch.delenv(name, raising=False)
    if display is not None:
        monkeypatch.setenv("DISPLAY", display)
    rendering.rendering_window.cache_clear()
    try:
        assert rendering.rendering_window() == expected
        rendering.rendering_window.cache_clear()
        monkeypatch.setenv("PYVISTA_OFF_SCREEN", "true")
        assert not rendering.rendering_window().screen
    finally:
        rendering.rendering_window.cache_clear()


@pytest.mark.slow
def test_nothing_that_draws_is_loaded_before_something_is_drawn():
    code = (
        "import sys, validation.fields.figures.figure_set, validation.fields.page as f\n"
        "from validation.report import document, html\n"
        "html.text(document.Document('', (), f.chapter(f.CycleFields(None)).sections))\n"
        "print(*sorted({m.split('.')[0] for m in sys.modules}))"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True, cwd=ROOT)
    assert not {"pyvista", "vtk", "vtkmodules", "matplotlib", "PIL", "skfem"} & set(done.stdout.split())


def test_fig3_lays_both_solvers_over_each_other():
    drawn = fig3.figure(SCENE, surfaces(), surfaces(), 2.0)
    panels = [axes for axes in drawn.axes if axes.get_title()]
    titles = [axes.get_title() for axes in panels]
    assert titles[0] == r"(a) approach, $\Delta/R$ = 0.01"
    assert titles[2] == r"(c) retraction, $\Delta/R$ = 0.03"
    assert [title[:3] for title in titles] == ["(a)", "(b)", "(c)", "(d)", "(e)", "(f)", "(g)"]
    lines = {line.get_label(): line for line in panels[0].lines}
    np.testing.assert_allclose(lines["indenter"].get_ydata(), lines["indenter"].get_xdata() ** 2 / 2 - 0.01)
    shown = lines["bem"].get_xdata() <= 0.199
    flat = lines["bem"].get_xdata()[shown], lines["bem"].get_ydata()[shown]
    np.testing.assert_allclose(flat[1], flat[0] ** 2 / 2 - 0.01, atol=1e-12)
    assert set(lines["fem"].get_xdata()) <= set(lines["bem"].get_xdata())
    inset = panels[0].child_axes[0]
    assert inset.lines[0].get_ydata()[0] == pytest.approx((1 - 0.25) * 5.0 / np.pi)  # (1-nu^2) p/(pi E0)
    assert inset.lines[0].get_xdata().max() <= fig3.NEAREST * 0.2
    crack = panels[-1].lines[0]
    np.testing.assert_allclose(crack.get_ydata(), np.sqrt(crack.get_xdata()) / 10)


def test_fig3_refuses_what_does_not_belong_together():
    with pytest.raises(ValueError, match="different times"):
        fig3.figure(SCENE, surfaces(), surfaces((1.0, 2.0, 3.0, 4.5)), 2.0)
    with pytest.raises(ValueError, match="retraction"):
        fig3.figure(SCENE, surfaces(), surfaces(), 9.0)


def test_alike_sections_share_scale_view_and_colours(monkeypatch):
    monkeypatch.setattr(rendering, "picture", lambda fill, size: np.zeros((size[1], size[0], 3), np.uint8))
    some, quantity = states({0: "", 3: "end of approach"}), QUANTITIES["stress_zz"]

    def shown(common):
        found = []
        for one in some:
            axes = single_section.single_section(one, SCENE, quantity, common).axes
            bars = [each.get_ylim() for each in axes if each.get_label() == "<colorbar>"]
            found.append((axes[0].get_title().split("\n")[1], axes[0].get_xlim(), *bars))
        return found

    one, other = shown(single_section.alike(some, SCENE, quantity))
    assert one == other
    one, other = shown(None)
    assert one[1:3] != other[1:3]


def test_one_section_states_its_scale(monkeypatch):
    monkeypatch.setattr(rendering, "picture", lambda fill, size: np.zeros((size[1], size[0], 3), np.uint8))
    one = state(label="pull-off")
    drawn = single_section.single_section(one, SCENE, QUANTITIES["stress_zz"])
    scale = geometry.magnification(float(np.abs(one.displacement).max()), RADIUS)
    whole, edge = drawn.axes[:2]
    assert f"displacements drawn {scale:g} times as large" in whole.get_title()
    assert edge.get_title() == f"at the contact edge\ndrawn {scale:g} times as large"
    marks = sorted(line.get_xdata()[0] for line in whole.lines if line.get_gid() == "edge")
    np.testing.assert_allclose(marks, np.array([-1, 1]) * RADIUS * (1 + 0.01 * scale))
    assert edge.get_xlim()[0] < marks[1] < edge.get_xlim()[1]
    assert edge.get_xlim()[1] - edge.get_xlim()[0] == pytest.approx(8 * ZONE)
    bars = [axes for axes in drawn.axes if axes.get_label() == "<colorbar>"]
    assert all(axes.get_ylim()[0] == -axes.get_ylim()[1] for axes in bars)
    assert [axes.get_ylabel() for axes in bars] == ["", r"stress $\sigma_{zz}$ (force/length²)"]
