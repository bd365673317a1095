"""Figures of fields, rendered: pixels against the field, files, and what a machine without OpenGL says."""

from __future__ import annotations

import io
import os
import subprocess
import sys
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from matplotlib import colormaps
from matplotlib.tri import LinearTriInterpolator, Triangulation
from PIL import Image
from support.synthetic_fields import RADIUS, SCENE, state, states, trace
from support.unlaid_figures import without_layout

from validation.fields.figures import animation, geometry, moment_panels, rendering, revolution, sections
from validation.fields.figures.figure_set import FigureSet
from validation.fields.figures.moments import key_moments
from validation.fields.figures.quantities import QUANTITIES

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


@pytest.fixture(scope="module", autouse=True)
def _can_draw():
    try:
        rendering.rendering_window()
    except rendering.NoRendering as reason:
        pytest.skip(str(reason))


@pytest.fixture(scope="module")
def cut():
    return geometry.section(state(label="pull-off"), SCENE, 2.0)


@pytest.fixture(scope="module")
def view():
    return geometry.whole(RADIUS)


@pytest.fixture(scope="module")
def shown(cut, view):
    return sections.shared_colours(STRESS, [cut], [view])


@pytest.fixture(scope="module")
def image(cut, view, shown):
    size = (400, round(400 / view.aspect))
    return rendering.picture(lambda plotter: sections.add_field(plotter, cut, view, STRESS, shown), size)


@pytest.mark.slow
def test_pixels_have_the_colour_of_the_field_there(image, cut, view, shown):
    field = LinearTriInterpolator(Triangulation(*cut.moved.T, cut.state.triangles), cut.state.stress[1])
    height, width = image.shape[:2]
    for x, y in ((0.0, -0.2), (0.1, -0.15), (-0.1, -0.15), (0.3, -0.1), (-0.33, -0.3)):
        column = int((x - view.left) / (view.right - view.left) * width)
        row = int((view.top - y) / (view.top - view.bottom) * height)
        centre = view.left + (column + 0.5) / width * (view.right - view.left)
        at = view.top - (row + 0.5) / height * (view.top - view.bottom)
        wanted = 255 * np.array(colormaps[shown.map](shown.shade(field(abs(centre), at)))[:3])
        assert np.abs(image[row, column] - wanted).max() < 6, (x, y)


def test_picture_is_mirrored_and_empty_above_the_surface(image, cut, view):
    assert np.abs(image.astype(int) - image[:, ::-1]).mean() < 1.0
    height, width = image.shape[:2]
    highest, middle = (
        round((view.top - y) / (view.top - view.bottom) * height)
        for y in (cut.surface[:, 1].max(), cut.surface[0, 1])
    )
    assert highest < middle
    assert (image[: highest - 1] == 255).all()
    assert (image[: middle - 1, width // 2] == 255).all()
    assert (image[middle + 2 :, width // 2] != 255).any(axis=1).all()


def test_windows_are_closed(image):
    import pyvista

    before = len(pyvista.plotting.plotter._ALL_PLOTTERS)
    rendering.picture(lambda plotter: plotter.add_mesh(pyvista.Plane()), (20, 20))
    with pytest.raises(ZeroDivisionError):
        rendering.picture(lambda plotter: 1 / 0, (20, 20))
    assert len(pyvista.plotting.plotter._ALL_PLOTTERS) == before


def test_moment_panels_are_alike():
    four = states(key_moments(trace(), SCENE))
    drawn = moment_panels.figure(four, SCENE, STRESS)
    panels = [axes for axes in drawn.axes if axes.get_title()]
    names = [axes.get_title().split(":")[0] for axes in panels]
    assert names == ["jump-in", "end of approach", "start of detachment", "pull-off"]
    assert len({(axes.get_xlim(), axes.get_ylim()) for axes in panels}) == 1
    cut, _, _ = moment_panels.sections_alike(four, SCENE, STRESS)
    assert drawn.get_suptitle() == f"displacements drawn {cut[0].scale:g} times as large"
    for axes, one in zip(panels, cut, strict=True):
        marks = sorted(line.get_xdata()[0] for line in axes.lines if line.get_gid() == "edge")
        np.testing.assert_allclose(marks, [-one.edge[0], one.edge[0]])
    low, high = drawn.axes[-1].get_ylim()
    assert low == -high


@pytest.mark.slow
def test_animation_has_a_frame_a_state_and_one_table_of_colours():
    rows = [0, 8]
    done: list[float] = []
    with without_layout():
        film = animation.film(states(dict.fromkeys(rows, "")), trace(), SCENE, MISES, done.append)
    with Image.open(io.BytesIO(film)) as gif:
        assert gif.format == "GIF"
        assert gif.n_frames == 2
        assert gif.size == (864, 333)
        assert gif.info["loop"] == 0
        frames = []
        for number in range(2):
            gif.seek(number)
            frames.append(np.asarray(gif.convert("RGB"), int))
            assert gif.info["duration"] == (animation.LAST if number == 1 else animation.FRAME)
    assert all(np.abs(a - b).mean() > 0.5 for a, b in pairwise(frames))
    assert done == [0.5, 1.0]


def test_frames_mark_where_they_stand():
    spots = []
    for drawn in animation.frames(states({3: "", 8: ""}), trace(), SCENE, MISES):
        lines = [line for axes in drawn.axes for line in axes.lines if line.get_gid() == "state"]
        spots += [(line.get_xdata()[0], line.get_ydata()[0]) for line in lines]
    assert spots == [(0.03, 0.03), (-0.01, -0.01)]


def test_body_of_revolution(cut, view, shown):
    ring = revolution.ring(cut.edge)
    np.testing.assert_allclose(np.hypot(*ring.points[:, :2].T), cut.edge[0], rtol=1e-6)
    shade = shown.shade(STRESS.values(cut.state))
    half = revolution.half_section(cut, view, shade)
    assert half.bounds[1] == pytest.approx(view.right)
    assert half.bounds[2] == pytest.approx(view.bottom)
    line, values = revolution.top(cut, view, shade)
    np.testing.assert_allclose(np.interp(line[:, 0], cut.surface[:, 0], shade[cut.top]), values)
    edge, along = revolution.side(cut, view, shade)
    assert edge[-1].tolist() == pytest.approx(line[-1].tolist())
    assert along[-1] == pytest.approx(values[-1], abs=0.02)
    swept = revolution.turned(line)
    assert swept.n_points == revolution.PLANES * len(line)
    np.testing.assert_allclose(np.asarray(swept.points)[: len(line), 2], line[:, 1], rtol=1e-6, atol=1e-9)
    drawn = revolution.figure(cut.state, SCENE, STRESS)
    picture = np.asarray(drawn.axes[0].images[0].get_array())
    assert picture.shape == (revolution.SIZE[1], revolution.SIZE[0], 3)
    assert 0.2 < (picture.min(axis=2) < 255).mean() < 0.95
    assert "times as large" in drawn.axes[0].get_title()


@pytest.mark.slow
def test_figures_are_written_as_reported(tmp_path, monkeypatch):
    blank = np.zeros((60, 100, 3), np.uint8)
    monkeypatch.setattr(rendering, "picture", lambda fill, size: blank)
    figures = FigureSet(("von_mises",), moments=True, animate=True, revolve=True, frames=2)
    assert list(figures.rows(trace(), SCENE)) == [0, 3, 7, 8, 9]
    done: list[float] = []
    some = states({0: "", 8: "pull-off", 9: ""})
    said = figures.draw(tmp_path, some, trace(), SCENE, done.append, {0})
    files = {str(path.relative_to(tmp_path)) for path in tmp_path.rglob("*.*")}
    kinds = "sections", "revolution"
    single = {f"{kind}/von_mises_{row:06d}.png" for kind in kinds for row in (0, 8)}  # 9: a frame only
    assert files == single | {"strip_von_mises.png", "cycle_von_mises.gif"}
    assert len(said) == len(files)
    assert done == sorted(done)
    assert done[-1] == 1.0
    sizes = {name: Image.open(tmp_path / name).size for name in files}
    assert all(width > 800 and height > 300 for width, height in sizes.values()), sizes


@pytest.mark.slow
def test_drawing_off_screen_is_silent():
    code = (
        "import pyvista\n"
        "from validation.fields.figures import rendering\n"
        "print(rendering.picture(lambda plotter: plotter.add_mesh(pyvista.Plane()), (40, 30)).shape)\n"
        "print(rendering.show(lambda plotter: None, 'title'))\n"
    )
    environment = {
        name: value for name, value in os.environ.items() if name not in ("DISPLAY", rendering.CHOICE)
    }
    done = subprocess.run(
        [sys.executable, "-W", "error", "-c", code],
        capture_output=True, text=True, check=True, cwd=ROOT, env=environment,
    )  # fmt: skip
    assert done.stdout.split("\n")[:2] == ["(30, 40, 3)", "False"]
    assert done.stderr == ""


@pytest.mark.slow
def test_a_machine_without_opengl_is_told_so(tmp_path):
    """VTK dies there; the files for ParaView are written all the same."""
    hidden = os.environ | {"__EGL_VENDOR_LIBRARY_DIRS": str(tmp_path), rendering.CHOICE: "vtkEGLRenderWindow"}
    code = (
        "from validation.fields.figures import rendering\n"
        "try:\n    rendering.rendering_window()\n"
        "except OSError as error:\n    print(type(error).__name__, error)"
    )
    done = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=True, cwd=ROOT, env=hidden
    )
    assert done.stdout.startswith("NoRendering PyVista cannot draw on this machine")
    file = tmp_path / "pressed.toml"
    file.write_text(PRESSED)
    run = [sys.executable, "-m", "crosscontact", "fields", str(file), "--resolution", "4", "--at", "0.1"]
    done = subprocess.run(
        [*run, "--out", str(tmp_path / "out")], capture_output=True, text=True, cwd=ROOT, env=hidden
    )
    assert done.returncode == 0
    assert "no figures: PyVista cannot draw" in done.stdout
    assert (tmp_path / "out" / "body.pvd").is_file()
    assert not list(tmp_path.rglob("*.png"))
    done = subprocess.run(
        [*run, "--revolve", "--out", str(tmp_path / "out")],
        capture_output=True,
        text=True,
        cwd=ROOT,
        env=hidden,
    )
    assert done.returncode == 1
    assert done.stderr.count("error: PyVista cannot draw") == 1
    assert "Traceback" not in done.stderr


@pytest.mark.slow
def test_key_moments_of_the_papers_cycle_from_the_command_line(tmp_path, capsys):
    from crosscontact.cli import main

    arguments = ["fields", "cycle-v0.002", "--resolution", "4", "--strip", "--quantity", "stress_zz"]
    assert main([*arguments, "--out", str(tmp_path)]) == 0
    said = capsys.readouterr().out
    for name in ("jump-in", "end of approach", "start of detachment", "pull-off"):
        assert name in said
    assert len(list((tmp_path / "sections").glob("stress_zz_*.png"))) == 4
    with Image.open(tmp_path / "strip_stress_zz.png") as picture:
        assert picture.width > 1000
        red = np.asarray(picture.convert("RGB"), int)
    tension = (red[..., 0] > 90) & (red[..., 1] < 40) & (red[..., 2] < 60)  # deep red: tension, at the edges
    pressure = (red[..., 0] < 40) & (red[..., 1] < 70) & (red[..., 2] > 80)  # deep blue
    middle = red.shape[0] // 2, red.shape[1] // 2
    assert pressure[: middle[0], middle[1] :].sum() > 20 * pressure[middle[0] :, middle[1] : -160].sum()
    assert tension[middle[0] :, middle[1] : -160].sum() > 3 * tension[: middle[0], middle[1] : -160].sum()
