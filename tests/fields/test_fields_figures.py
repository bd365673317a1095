"""What figures of fields show: geometry, colours, moments, pixels; what a report and a folder get of them."""

from __future__ import annotations

import dataclasses
import os
import subprocess
import sys
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from matplotlib import colormaps
from matplotlib.tri import LinearTriInterpolator, Triangulation
from PIL import Image
from support.synthetic_traces import DETACHED, by_hand
from support.unlaid_figures import without_layout

from contact_scene import (
    Adhesion,
    Counters,
    FlatPunch,
    Loading,
    Material,
    Ramp,
    Scene,
    Sphere,
    SurfaceProfile,
    Trace,
)
from crosscontact.cli import main
from fem_solver import FieldState
from validation.cases import load
from validation.fields import chapter, fig3, figures, moments, rendering, section
from validation.fields.figures import FigureSet
from validation.fields.quantities import QUANTITIES, SPANNED, ValueKind, colours
from validation.fields.section import AxialSection, Look, look_at
from validation.report import html
from validation.report.document import Document
from validation.runs.run import Run

RADIUS, ZONE = 0.2, 0.02
SCENE = Scene(
    Material(1.0, 0.5),
    Sphere(1.0),
    Loading("jump-in", 0.0, (Ramp(0.03, 0.01), Ramp(-0.02, 0.01))),
    Adhesion(1e-3, ZONE),
)


def state(
    radius: float = RADIUS, penetration: float = 0.03, row: int = 0, time: float = 3.0, label: str = ""
) -> FieldState:
    """``u_r = r/100``; ``u_z`` follows the indenter to the edge, then stays; ``stress_zz = r + z``."""
    along = np.unique(np.concatenate([np.linspace(0.0, 1.0, 41), [radius, radius + ZONE]]))
    down = -(np.linspace(0.0, 1.0, 15) ** 1.5)[::-1]
    r, z = (axis.ravel() for axis in np.meshgrid(along, down))
    columns, n = len(along), r.size
    corner = (np.arange(len(down) - 1)[:, None] * columns + np.arange(columns - 1)).ravel()
    lower = np.column_stack([corner, corner + 1, corner + columns + 1])
    upper = np.column_stack([corner, corner + columns + 1, corner + columns])
    top = np.minimum(r, radius) ** 2 / 2.0 - penetration
    stress = np.zeros((4, n))
    stress[1] = r + z
    none, m = np.zeros((1, n)), len(corner)
    gap = np.maximum(along**2 / 2.0 - penetration - (np.minimum(along, radius) ** 2 / 2.0 - penetration), 0.0)
    surface = SurfaceProfile(
        time,
        penetration,
        1.0,
        radius,
        along,
        0.0 * along,
        penetration - np.minimum(along, radius) ** 2 / 2,
        gap,
    )
    return FieldState(
        row=row,
        time=time,
        penetration=penetration,
        force=penetration,
        contact_radius=radius,
        label=label,
        branches=("tau=1",),
        points=np.column_stack([r, z]),
        triangles=np.vstack([lower, upper]),
        displacement=np.column_stack([0.01 * r, top * np.exp(z)]),
        stress=stress,
        strain=0.1 * stress,
        stored_energy_density=np.exp(z),
        dissipation_rate=none + 10.0 ** (4.0 * z),
        dissipated=none,
        surface=surface,
        element_volumes=np.ones(m),
        element_stored=np.zeros(m),
        element_rate=np.zeros((1, m)),
        element_dissipated=np.zeros((1, m)),
    )


def trace(**changes: Any) -> Trace:
    """A cycle of eleven rows: the edge recedes late, tension is largest in row 8, contact ends in row 10."""
    time = np.arange(11.0)
    depth = np.array([0.0, 0.01, 0.02, 0.03, 0.03, 0.02, 0.01, 0.0, -0.01, -0.02, -0.02])
    force = np.array([-0.1, 0.4, 0.8, 1.0, 0.9, 0.3, -0.2, -0.5, -0.7, -0.4, 0.0])
    radius = np.array([0.05, 0.1, 0.15, 0.2, 0.2, 0.2, 0.19, 0.17, 0.12, 0.06, 0.0])
    rows = {"penetration": depth, "force": force, "contact_radius": radius} | changes
    return by_hand(rows.pop("time", time), DETACHED, "fem", counters=Counters(steps=10), **rows)


def states(rows: dict[int, str]) -> list[FieldState]:
    """The states of that cycle at some rows."""
    run = trace()
    return [
        state(float(run.contact_radius[row]), float(run.penetration[row]), row, float(run.time[row]), label)
        for row, label in rows.items()
    ]


def surfaces(times=(1.0, 2.0, 3.0, 4.0)) -> list[SurfaceProfile]:
    """Surfaces of a sphere with a punch's pressure and a square-root gap, in contact up to 0.2."""
    r = np.concatenate([np.linspace(0.0, 0.199, 60), 0.2 + np.geomspace(1e-5, 0.5, 60)])
    gap = np.sqrt(np.maximum(r - 0.2, 0.0)) / 10
    found = []
    for time in times:
        pressure = np.where(r < 0.2, time / np.sqrt(np.maximum(0.04 - r**2, 1e-6)), 0.0)
        found.append(
            SurfaceProfile(time, 0.01 * time, 1.0, 0.2, r, pressure, 0.01 * time - r**2 / 2 + gap, gap)
        )
    return found


ROOT = Path(__file__).parents[2]
STRESS, MISES = QUANTITIES["stress_zz"], QUANTITIES["von_mises"]
PRESSED = """
material = { modulus = 0.75, poisson = 0.5 }
indenter = { shape = "sphere", radius = 1.0 }
[loading]
start = "relaxed"
penetration = 0.01
steps = [{ kind = "ramp", to = 0.011, rate = 0.01 }]
"""


@pytest.fixture(scope="module")
def can_draw():
    try:
        rendering.check_rendering()
    except rendering.NoRendering as reason:
        pytest.skip(str(reason))


@pytest.fixture
def blank(monkeypatch):
    """Nothing is rendered."""
    monkeypatch.setattr(rendering, "picture", lambda fill, size: np.zeros((size[1], size[0], 3), np.uint8))


@given(largest=st.floats(1e-9, 1e9), radius=st.floats(1e-9, 1e9))
def test_magnification_is_the_largest_round_number_within_the_swing(largest, radius):
    scale = section.magnification(largest, radius)
    room = section.LARGEST_DRAWN * section.HALF_WIDTH * radius / largest
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
    assert section.magnification_near_edge(one, ZONE, 50.0) == pytest.approx(drawn)


@pytest.mark.parametrize("scale", [1.0, 5.0])
def test_marks_and_indenter_sit_on_the_deformed_surface(scale):
    cut = AxialSection(state(), SCENE, scale)
    height = scale * (RADIUS**2 / 2 - 0.03)
    np.testing.assert_allclose(cut.edge, [RADIUS * (1 + 0.01 * scale), height])
    np.testing.assert_allclose(cut.zone[0], cut.edge)
    np.testing.assert_allclose(cut.zone[-1], [(RADIUS + ZONE) * (1 + 0.01 * scale), height])
    assert (np.diff(cut.surface[:, 0]) > 0).all()
    r, y = cut.indenter.T
    np.testing.assert_allclose(y, scale * (r**2 / 2 - 0.03))
    side = section.outline(dataclasses.replace(SCENE, indenter=FlatPunch(0.3)), 0.03, 1.0, scale)
    assert side[-2:, 0] == pytest.approx(0.3)
    assert side[-1, 1] > side[-2, 1] == -0.03 * scale
    assert AxialSection(state(), dataclasses.replace(SCENE, adhesion=None)).zone.size == 0


def test_ranges_of_colours():
    """Signed ones are centred on zero; what is covered is area, not nodes; a logarithm spans decades."""
    value = np.concatenate([np.linspace(-3.0, 1.0, 400), [50.0]])
    found = colours(ValueKind.SIGNED, [value], [np.ones_like(value)])
    assert found.low == -found.high
    assert 2.9 < found.high < 3.0  # 99 % of the area; the spike is beyond
    assert found.extend == "both"
    np.testing.assert_allclose(found.shade([-99.0, found.low, 0.0, found.high, 99.0]), [0, 0, 0.5, 1, 1])
    value, area = np.array([1.0] * 5 + [9.0] * 95), np.array([1.0] * 5 + [1e-6] * 95)
    assert colours(ValueKind.POSITIVE, [value], [area]).high == 1.0
    two = np.linspace(0.0, 4.0, 50)
    assert 3.8 < colours(ValueKind.POSITIVE, [two / 4.0, two], [np.ones(50)] * 2).high <= 4.0
    rates = colours(ValueKind.DECADES, [two], [np.ones(50)])
    assert rates.high / rates.low == pytest.approx(10.0**SPANNED)
    np.testing.assert_allclose(rates.shade([0.0, rates.low, rates.low * 100, rates.high]), [0, 0, 0.5, 1])
    nothing = colours(ValueKind.SIGNED, [np.zeros(4)], [np.ones(4)])
    assert (nothing.low, nothing.high, nothing.extend) == (-1.0, 1.0, "neither")


def test_quantities_read_the_state_they_name():
    one = state()
    for quantity in QUANTITIES.values():
        assert quantity.values(one).shape == (len(one.points),), quantity.name
        assert "$" not in quantity.plain
    for k, part in enumerate(("rr", "zz", "tt", "rz")):
        np.testing.assert_array_equal(QUANTITIES[f"stress_{part}"].values(one), one.stress[k])
        np.testing.assert_array_equal(QUANTITIES[f"strain_{part}"].values(one), one.strain[k])
    np.testing.assert_array_equal(QUANTITIES["principal_1"].values(one), one.principal[0])
    np.testing.assert_array_equal(QUANTITIES["dissipation_rate"].values(one), one.dissipation_rate[0])
    assert QUANTITIES["stress_tt"].plain == "stress σθθ (force/length²)"
    signed = {name for name, one in QUANTITIES.items() if one.kind is ValueKind.SIGNED}
    assert {"stress_rz", "hydrostatic", "strain_tt", "displacement_z", "principal_3"} <= signed
    assert not {"von_mises", "max_shear", "dissipated_energy"} & signed


def test_moments_of_a_cycle():
    assert moments.key_moments(trace(), SCENE) == {
        0: "jump-in",
        3: "end of approach",
        7: "start of detachment",  # the first row a whole process zone inside the largest radius
        8: "pull-off",
    }
    never = trace(force=np.abs(trace().force))
    assert list(moments.key_moments(never, SCENE)) == [0, 3, 7]
    assert moments.in_contact(trace(), 4) == [0, 3, 6, 9]
    assert moments.in_contact(trace(contact_radius=np.zeros(11)), 4) == []
    assert not FigureSet(revolve=True).chooses_moments
    both = FigureSet(moments=True, animate=True, frames=4).rows(trace(), SCENE)
    assert list(both) == [0, 3, 6, 7, 8, 9]
    assert (both[8], both[9]) == ("pull-off", "")


def shown(one, pair):
    """Words of scale, view and ranges of colours of the section of a state."""
    axes = figures.section(one, SCENE, pair).axes
    bars = [each.get_ylim() for each in axes if each.get_label() == "<colorbar>"]
    return axes[0].get_title().split("\n")[1], axes[0].get_xlim(), *bars


def test_sections_state_their_scale_and_may_be_alike(blank):
    some = states({0: "", 3: "end of approach"})
    one, other = (shown(each, section.looks(some, SCENE, STRESS)) for each in some)
    assert one == other
    one, other = (shown(each, section.looks([each], SCENE, STRESS)) for each in some)
    assert one[1:3] != other[1:3]
    look = look_at(some[1:], SCENE, STRESS)
    body = AxialSection(some[1], SCENE, look.scale)
    inside = body.within(look.view(body))
    sizes, areas = np.abs(STRESS.values(body.state)[inside]), body.areas[inside] / body.areas[inside].sum()
    assert areas[sizes < look.colours.high].sum() < 0.99 <= areas[sizes <= look.colours.high].sum()
    assert body.areas.sum() == pytest.approx(1.0)
    cut = state(label="pull-off")
    drawn = figures.section(cut, SCENE, section.looks([cut], SCENE, STRESS))
    scale = section.magnification(float(np.abs(cut.displacement).max()), RADIUS)
    whole, edge = drawn.axes[:2]
    assert f"displacements drawn {scale:g} times as large" in whole.get_title()
    marks = sorted(line.get_xdata()[0] for line in whole.lines if line.get_gid() == "edge")
    np.testing.assert_allclose(marks, np.array([-1, 1]) * RADIUS * (1 + 0.01 * scale))
    assert edge.get_xlim()[0] < marks[1] < edge.get_xlim()[1]
    assert edge.get_xlim()[1] - edge.get_xlim()[0] == pytest.approx(8 * ZONE)
    assert [axes.get_ylabel() for axes in drawn.axes[2:]] == ["", r"stress $\sigma_{zz}$ (force/length²)"]


def test_panels_are_alike_and_frames_mark_where_they_stand(blank, monkeypatch):
    four = states(moments.key_moments(trace(), SCENE))
    drawn = figures.panels(four, SCENE, STRESS)
    titled = [axes for axes in drawn.axes if axes.get_title()]
    names = [axes.get_title().split(":")[0] for axes in titled]
    assert names == ["jump-in", "end of approach", "start of detachment", "pull-off"]
    assert len({(axes.get_xlim(), axes.get_ylim()) for axes in titled}) == 1
    assert f"{look_at(four, SCENE, STRESS).scale:g} times as large" in drawn.get_suptitle()
    spots = []
    for frame in figures.frames(states({3: "", 8: ""}), trace(), SCENE, MISES):
        lines = [line for axes in frame.axes for line in axes.lines if line.get_gid() == "state"]
        spots += [(line.get_xdata()[0], line.get_ydata()[0]) for line in lines]
    assert spots == [(0.03, 0.03), (-0.01, -0.01)]
    shared = []
    monkeypatch.setattr(figures, "draw", lambda axes, cut, look: shared.append(look))
    figures.panels(four, SCENE, STRESS)
    assert shared == shared[:1] * 4


def test_pixels_have_the_colour_of_the_field_there(can_draw):
    """Mirrored about the axis, white above the surface."""
    cut, look = AxialSection(state(), SCENE, 2.0), look_at([state()], SCENE, STRESS)
    view = look.view(cut)
    size = (400, round(400 / view.aspect))
    image = rendering.picture(lambda plotter: rendering.add_section(plotter, cut, look), size)
    field = LinearTriInterpolator(Triangulation(*cut.points.T, cut.state.triangles), cut.state.stress[1])
    height, width = image.shape[:2]
    for x, y in ((0.0, -0.2), (0.1, -0.15), (-0.1, -0.15), (0.3, -0.1), (-0.33, -0.3)):
        column = int((x - view.left) / (view.right - view.left) * width)
        row = int((view.top - y) / (view.top - view.bottom) * height)
        centre = view.left + (column + 0.5) / width * (view.right - view.left)
        at = view.top - (row + 0.5) / height * (view.top - view.bottom)
        wanted = 255 * np.array(colormaps["RdBu_r"](look.colours.shade(field(abs(centre), at)))[:3])
        assert np.abs(image[row, column] - wanted).max() < 6, (x, y)
    highest = round((view.top - cut.surface[:, 1].max()) / (view.top - view.bottom) * height)
    assert (image[: highest - 1] == 255).all()


def test_body_of_revolution(can_draw):
    """The outline of the half in view is turned about the axis; it carries the field."""
    cut = AxialSection(state(), SCENE, 2.0)
    look: Look = look_at([cut.state], SCENE, STRESS)
    ring = rendering.turned(rendering.line([cut.edge]))
    np.testing.assert_allclose(np.hypot(*np.asarray(ring.points)[:, :2].T), cut.edge[0], rtol=1e-6)
    parts = {}

    class Plotter:
        def __getattr__(self, name):
            return self

        def __call__(self, *given, **named):
            if "name" in named:
                parts[named["name"]] = given[0]
            return self

    rendering.add_body(Plotter(), cut, look)
    skin, view = parts["skin"], look.view(cut)
    assert np.hypot(*np.asarray(skin.points)[:, :2].T).max() == pytest.approx(view.right)
    assert skin.bounds[4] == pytest.approx(view.bottom)
    x, y, _ = np.asarray(skin.points).T
    assert np.degrees(np.arctan2(y, x))[np.hypot(x, y) > 1e-6].max() == pytest.approx(rendering.CUT)
    on_top = np.isclose(np.hypot(*np.asarray(skin.points)[:, :2].T), cut.edge[0], atol=1e-6)
    on_top &= skin.points[:, 2] > view.bottom * 0.99
    wanted = look.colours.shade(RADIUS)  # stress r + z of the undeformed edge
    assert skin.point_data["shade"][on_top] == pytest.approx(wanted, abs=1e-5)


@pytest.mark.slow
def test_figures_are_written_as_reported(tmp_path, blank):
    asked = FigureSet(("von_mises",), moments=True, animate=True, revolve=True, frames=2)
    done: list[float] = []
    some = states({0: "", 8: "pull-off", 9: ""})
    said = asked.draw(tmp_path, some, trace(), SCENE, done.append, {0})
    files = {str(path.relative_to(tmp_path)) for path in tmp_path.rglob("*.*")}
    single = {f"{kind}/von_mises_{row:06d}.png" for kind in ("sections", "revolution") for row in (0, 8)}
    assert files == single | {"strip_von_mises.png", "cycle_von_mises.gif"}  # 9: a frame only
    assert len(said) == len(files)
    assert done == sorted(done)
    assert done[-1] == 1.0
    with Image.open(tmp_path / "cycle_von_mises.gif") as gif:
        frames = []
        for number, duration in enumerate((figures.FRAME, figures.LAST)):
            gif.seek(number)
            frames.append(np.asarray(gif.convert("RGB"), int))
            assert gif.info["duration"] == duration
        assert (gif.n_frames, gif.info["loop"]) == (2, 0)
    assert all(np.abs(a - b).mean() > 0.3 for a, b in pairwise(frames))


@pytest.mark.slow
def test_drawing_off_screen_is_silent(can_draw):
    code = (
        "import pyvista\n"
        "from validation.fields import rendering\n"
        "print(rendering.picture(lambda plotter: plotter.add_mesh(pyvista.Plane()), (40, 30)).shape)\n"
        "print(rendering.show(lambda plotter: None, 'title'))\n"
    )
    kept = {name: value for name, value in os.environ.items() if name not in ("DISPLAY", rendering.CHOICE)}
    command = [sys.executable, "-W", "error", "-c", code]
    done = subprocess.run(command, capture_output=True, text=True, check=True, cwd=ROOT, env=kept)
    assert done.stdout.split("\n")[:2] == ["(30, 40, 3)", "False"]
    assert done.stderr == ""


@pytest.mark.slow
def test_a_machine_without_opengl_is_told_so(tmp_path):
    """VTK dies there; the files for ParaView are written all the same."""
    hidden = {name: value for name, value in os.environ.items() if name not in ("DISPLAY", rendering.CHOICE)}
    hidden["__EGL_VENDOR_LIBRARY_DIRS"] = str(tmp_path)
    file = tmp_path / "pressed.toml"
    file.write_text(PRESSED)
    run = [sys.executable, "-m", "crosscontact", "fields", str(file), "--resolution", "4", "--at", "0.1"]
    run += ["--out", str(tmp_path / "out")]
    done = subprocess.run(run, capture_output=True, text=True, cwd=ROOT, env=hidden)
    assert done.returncode == 0
    assert "no figures: PyVista cannot draw" in done.stdout
    assert "libegl1" in done.stdout
    assert (tmp_path / "out" / "body.pvd").is_file()
    assert not list(tmp_path.rglob("*.png"))
    done = subprocess.run([*run, "--revolve"], capture_output=True, text=True, cwd=ROOT, env=hidden)
    assert done.returncode == 1
    assert done.stderr.count("error: PyVista cannot draw") == 1
    assert "Traceback" not in done.stderr


def test_fig3_lays_both_solvers_over_each_other():
    drawn = fig3.figure(SCENE, surfaces(), surfaces(), 2.0)
    titled = [axes for axes in drawn.axes if axes.get_title()]
    titles = [axes.get_title() for axes in titled]
    assert titles[0] == r"(a) approach, $\Delta/R$ = 0.01"
    assert titles[2] == r"(c) retraction, $\Delta/R$ = 0.03"
    assert [title[:3] for title in titles] == ["(a)", "(b)", "(c)", "(d)", "(e)", "(f)", "(g)"]
    lines = {line.get_label(): line for line in titled[0].lines}
    inside = lines["bem"].get_xdata() <= 0.199
    flat = lines["bem"].get_xdata()[inside], lines["bem"].get_ydata()[inside]
    np.testing.assert_allclose(flat[1], flat[0] ** 2 / 2 - 0.01, atol=1e-12)
    assert set(lines["fem"].get_xdata()) <= set(lines["bem"].get_xdata())
    inset = titled[0].child_axes[0]
    assert inset.lines[0].get_ydata()[0] == pytest.approx((1 - 0.25) * 5.0 / np.pi)  # (1-nu^2) p/(pi E0)
    assert inset.lines[0].get_xdata().max() <= fig3.NEAREST * 0.2
    crack = titled[-1].lines[0]
    np.testing.assert_allclose(crack.get_ydata(), np.sqrt(crack.get_xdata()) / 10)
    with pytest.raises(ValueError, match="different times"):
        fig3.figure(SCENE, surfaces(), surfaces((1.0, 2.0, 3.0, 4.5)), 2.0)
    with pytest.raises(ValueError, match="retraction"):
        fig3.figure(SCENE, surfaces(), surfaces(), 9.0)


@pytest.mark.slow
def test_a_report_holds_strips_edge_body_film_and_fig3(tmp_path, monkeypatch, blank):
    """Only when asked; where VTK cannot draw, it says so."""
    monkeypatch.setattr("validation.scenes.suite", lambda name: [])  # a report without scenes
    rows = FigureSet(moments=True, animate=True, frames=2).rows(trace(), SCENE)

    class Recorded:
        recording = type("Recording", (), {"trace": trace()})

        def states(self):
            return states(rows)

    monkeypatch.setattr(chapter, "record_fields", lambda *given: Recorded())
    monkeypatch.setattr(chapter, "balance", lambda *given: moments.EnergySums(1, 1, {}, 1.5, 1, 1, 0, 1))
    main(["report", "--out", str(tmp_path / "plain")])
    assert not (tmp_path / "plain" / "figures").exists()
    with without_layout():
        main(["report", "--fields", "--out", str(tmp_path / "drawn")])
    page = (tmp_path / "drawn" / "index.html").read_text()
    strips = {f"fields-strip-{name}.png" for name in figures.USUAL}
    edges = {f"fields-section-{name}.png" for name in figures.USUAL[:2]}
    written = {path.name for path in (tmp_path / "drawn" / "figures").iterdir()}
    assert written == strips | edges | {"fields-revolution.png", "fields-cycle.gif"}
    assert page.count("<img ") == len(written)
    assert ">pull-off</td>" in page
    assert "No Fig. 3: a run is missing." in page

    def undrawn(*given):
        raise rendering.NoRendering("PyVista cannot <draw>")
        yield

    monkeypatch.setattr(chapter, "pictures", undrawn)
    text = html.text(Document("", (), chapter.chapter({}).sections))
    assert '<p class="fail">No pictures of fields: PyVista cannot &lt;draw&gt;</p>' in text


@pytest.mark.slow
def test_fig3_of_a_report_needs_both_solvers():
    case = dataclasses.replace(load(chapter.SCENE), scene=SCENE)
    run = dataclasses.replace(trace(), profiles=tuple(surfaces((1.0, 2.0, 3.0, 4.0, 5.0, 6.0))))
    short = dataclasses.replace(run, profiles=run.profiles[:4])
    for fem, drawn in ((run, True), (short, False), (None, False)):
        runs = {name: Run(case.name, name, one) for name, one in (("bem", run), ("fem", fem))}
        assert bool(chapter.surfaces(runs, case).picture) == drawn
