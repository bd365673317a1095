"""The report's section on fields: what it holds, what it says where something is missing, and how it fits."""

from __future__ import annotations

import base64
import dataclasses
import io
import re

import numpy as np
import pytest
from PIL import Image as Pixels
from support.synthetic_fields import SCENE, states, surfaces, trace
from support.unlaid_figures import without_layout

from crosscontact.cli import main
from validation.cases import load
from validation.drawing import export
from validation.fields import cycle_fields
from validation.fields import page as fields
from validation.fields.cycle_fields import CycleFields, Image
from validation.fields.figures import animation, rendering
from validation.fields.figures.moments import key_moments
from validation.report import html
from validation.report.document import Document, figures_of
from validation.runs.run import Run


def small_png(inches) -> bytes:
    stream = io.BytesIO()
    Pixels.new("RGB", (int(10 * inches[0]), int(10 * inches[1])), "gray").save(stream, format="PNG")
    return stream.getvalue()


CASE = dataclasses.replace(load(cycle_fields.SCENE), scene=SCENE)


def runs(**traces) -> dict[str, Run]:
    return {name: Run(CASE.name, name, run) for name, run in traces.items()}


@pytest.fixture(scope="module")
def section():
    """The section on a made-up run; what VTK would draw is left blank, figures are saved small."""
    run = dataclasses.replace(trace(), profiles=tuple(surfaces((1.0, 2.0, 3.0, 4.0, 5.0, 6.0))))
    rows = key_moments(trace(), SCENE)
    with pytest.MonkeyPatch.context() as patch, without_layout():
        patch.setattr(rendering, "picture", lambda fill, size: np.full((size[1], size[0], 3), 200, np.uint8))
        patch.setattr(cycle_fields, "png", lambda drawn: small_png(drawn.get_size_inches()))
        patch.setattr(animation, "DOTS", 10)
        shown = cycle_fields.draw(states(rows), trace(), SCENE, lambda done: None)
    first = cycle_fields.surface_figure(runs(bem=run, fem=run), CASE)
    line = ("pull-off", *["1.5"] * (len(fields.HEAD) - 1))
    return CycleFields(first, tuple(shown), (line,))


@pytest.mark.slow
def test_section_holds_strips_edge_body_and_film(section, monkeypatch):
    names = [picture.name for picture in section.images]
    assert [name for name in names if "strip" in name] == [
        f"fields-strip-{quantity}.png" for quantity in ("von_mises", "stress_zz", "dissipation_rate")
    ]
    assert {"fields-section-von_mises.png", "fields-revolution.png", "fields-cycle.gif"} <= set(names)
    for picture in section.images:
        assert picture.data.startswith(b"GIF89a" if picture.name.endswith(".gif") else b"\x89PNG")
    assert section.images[1].caption == "Key moments: stress σzz (force/length²)"
    monkeypatch.setattr(export, "png", lambda drawn: b"")
    with without_layout():
        (part,) = fields.chapter(section).sections
    text = html.text(Document("", (), (part,)))
    assert text.count("<img ") == len(names)
    assert text.count("<svg ") == 1  # Fig. 3, drawn in the page itself
    assert ">pull-off</td>" in text
    content = re.findall(r'src="data:image/gif;base64,([^"]+)"', text)
    assert base64.b64decode(content[0]) == section.images[-1].data
    files = {name for figure in figures_of(part.parts) for name in figure.files}
    assert files == {"fields-fig3.png", *names}


def test_fig3_needs_both_solvers():
    run = dataclasses.replace(trace(), profiles=tuple(surfaces((1.0, 2.0, 3.0, 4.0, 5.0, 6.0))))
    assert cycle_fields.surface_figure(runs(bem=run, fem=None), CASE) is None
    short = dataclasses.replace(run, profiles=run.profiles[:4])
    assert cycle_fields.surface_figure(runs(bem=run, fem=short), CASE) is None
    assert cycle_fields.surface_figure({}, CASE) is None
    failed = CycleFields(None, failure="PyVista cannot <draw>")
    text = html.text(Document("", (), fields.chapter(failed).sections))
    assert "No Fig. 3: a run is missing." in text
    assert '<p class="fail">No pictures of fields: PyVista cannot &lt;draw&gt;</p>' in text


def test_report_draws_fields_only_when_asked(monkeypatch, tmp_path):
    monkeypatch.setattr("validation.scenes.suite", lambda name: [])  # a report without scenes
    asked = []

    def compute(runs, progress):
        asked.append(runs)
        return CycleFields(None, (Image("fields-cycle.gif", "A cycle", b"GIF89a"),))

    monkeypatch.setattr(cycle_fields, "compute", compute)
    main(["report", "--out", str(tmp_path / "plain")])
    assert not asked
    assert not (tmp_path / "plain" / "figures").exists()
    main(["report", "--fields", "--out", str(tmp_path / "drawn")])
    assert len(asked) == 1
    assert (tmp_path / "drawn" / "figures" / "fields-cycle.gif").read_bytes() == b"GIF89a"
    assert 'id="fields"' in (tmp_path / "drawn" / "index.html").read_text()
