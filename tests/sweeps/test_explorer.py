"""A page with sliders: what it holds is what was solved, and moving a slider shows another run."""

from __future__ import annotations

import base64
import json
import re
from dataclasses import replace

import numpy as np
import pytest
from support.browser import CHROMIUM, measure_pages, title_of
from support.wrong_values import refusal

import crosscontact as cc
from validation.sweeps.explorer import COLUMNS, DEPTH, POINTS, _columns, _packed

VARIED = ["adhesion.work=2e-4:8e-4", "material.modulus=0.5:2"]
MOVED = """<script>
addEventListener("load", () => setTimeout(async () => {
  const models = [...Bokeh.documents[0]._all_models.values()];
  const slider = models.find(one => one.title === "adhesion.work");
  const text = models.filter(one => one.type === "Div");
  const curve = models.find(one => one.name === "shown");
  const seen = [];
  for (const value of [1, 0]) {
    slider.value = value;
    await new Promise(done => setTimeout(done, 300));
    seen.push([curve.data.force[0], text.map(one => one.text).join(" ")]);
  }
  document.title = JSON.stringify(seen);
}, 1500));
</script></body>"""


@pytest.fixture(scope="module")
def found():
    return cc.explore("elastic-relaxed", VARIED, values=3)


def test_every_run_of_the_grid_is_that_of_its_values(found):
    assert [one.values for one in found.sliders] == [
        pytest.approx((2e-4, 4e-4, 8e-4)),
        pytest.approx((0.5, 1.0, 2.0)),
    ]
    table = cc.builtin("elastic-relaxed")
    scene = cc.Scene(
        cc.Material(2.0, table.material.poisson),
        table.indenter,
        table.loading,
        cc.Adhesion(2e-4, table.adhesion.zone),
    )
    assert found.plan.solver == "batch"
    assert found.runs[2].measures["pull_off_force"] == pytest.approx(cc.solve(scene).pull_off.force, rel=1e-4)
    coarse = cc.explore(scene, ["adhesion.work=2e-4:4e-4"], values=2, solver="reference")
    alone = cc.solve(scene, resolution=4).pull_off.force
    assert coarse.runs[0].measures["pull_off_force"] == pytest.approx(alone, rel=1e-12)
    assert found.unfinished == 0


def test_scenes_that_the_batch_solver_does_not_take_the_reference_solves():
    scene = cc.builtin("elastic-relaxed")
    rated = replace(scene, adhesion=replace(scene.adhesion, rate=cc.PowerRate(1.0, 0.5)))
    assert cc.explore(rated, VARIED[:1], values=2).plan.solver == "reference"


def test_curves_come_back_to_sixteen_bits_and_keep_their_ends(found):
    scene = cc.builtin("elastic-relaxed")
    curves = [_columns(run, scene) for run in found.runs] + [dict.fromkeys(COLUMNS, np.empty(0))]
    packed = {name: base64.b64decode(text) for name, text in _packed(curves).items()}
    limits = np.frombuffer(packed["limits"], "<f4").reshape(-1, len(COLUMNS), 2)
    points = np.frombuffer(packed["points"], "<u2").reshape(-1, len(COLUMNS), POINTS)
    for i, curve in enumerate(curves[:-1]):
        for j, name in enumerate(COLUMNS):
            again = limits[i, j, 0] + limits[i, j, 1] * points[i, j] / DEPTH
            assert np.abs(again - curve[name]).max() <= 2e-5 * np.abs(curve[name]).max()
    assert (points[-1] > DEPTH).all()
    trace = found.runs[0].trace
    assert curves[0]["time"][0] == trace.time[0]


@pytest.mark.parametrize(
    "vary",
    [
        [],
        [*VARIED, "indenter.radius", "adhesion.zone"],
        ["adhesion.worth"],
        ["loading.steps[9].rate"],
        ["indenter.shape"],
        ["material.branches"],
        ["adhesion.work=1"],
        ["adhesion.work=2:1"],
        ["adhesion.work=0:inf"],
        ["adhesion.work=-1:1"],
        "adhesion.work",
        3,
    ],
)
def test_what_cannot_be_varied_is_refused_in_one_line(vary):
    assert str(refusal(cc.explore, "elastic-relaxed", vary))


def test_a_run_without_an_answer_is_told(tmp_path):
    found = cc.explore("relaxed-equilibrium", ["adhesion.zone=1e-3:0.2"], values=2)
    found.save(tmp_path / "page.html")
    assert found.unfinished == sum(not run.finished for run in found.runs)
    ended = [run.failure or str(run.trace.outcome.kind) for run in found.runs]
    page = (tmp_path / "page.html").read_text("utf-8")
    assert all(json.dumps(one)[1:-1] in page for one in ended)


@pytest.mark.slow
@pytest.mark.skipif(CHROMIUM is None, reason="no Chromium")
def test_a_moved_slider_shows_another_curve(found, tmp_path):
    page = found.page()
    assert len(page) < 5_000_000
    assert not re.search(r"<(script|link)[^>]*\b(src|href)=", page.partition("<body>")[0])
    for seen in measure_pages(tmp_path, [(page, 390), (page, 1280)]):
        assert seen["trouble"] == 0
        assert seen["content"] <= seen["width"]
    file = tmp_path / "moved.html"
    file.write_text(MOVED.join(page.rsplit("</body>", 1)), "utf-8")
    (middle, said), (left, other) = json.loads(title_of(file))
    for value, text, row in ((middle, said, 1), (left, other, 0)):
        run = found.runs[row * 3 + found.sliders[1].nearest]
        assert value == pytest.approx(run.trace.force[0], abs=1e-4 * np.abs(run.trace.force).max())
        told = float(re.search(r"pull-off force ([\d.e+-]+)", text)[1])
        assert told == pytest.approx(run.measures["pull_off_force"], rel=1e-3)
