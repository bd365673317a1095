"""The HTML report in a headless Chromium: no script errors, no missing pictures, no sideways scrolling."""

from __future__ import annotations

import json
import shutil
import subprocess

import pytest
from support.spring_solver import SCENE, fake, named

from crosscontact import registry
from validation import solvers
from validation.cases import load
from validation.execution.progress import Progress
from validation.report.build import build, write

NAMES = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable", "chrome")
CHROMIUM = next((path for name in NAMES if (path := shutil.which(name))), None)
PROBE = """
<script>
addEventListener('error', e => { window.trouble = (window.trouble || 0) + 1; }, true);
addEventListener('load', () => {
  const root = document.documentElement;
  const drawn = [...document.querySelectorAll('figure svg')].map(e => e.getBoundingClientRect());
  const labels = [...document.querySelectorAll('figure svg text')];
  document.title = JSON.stringify({
    width: innerWidth, content: root.scrollWidth, trouble: window.trouble || 0,
    broken: [...document.images].filter(i => !i.complete || !i.naturalWidth).length,
    figures: drawn.length, flat: drawn.filter(b => b.width < 100 || b.height < 60).length,
    wide: drawn.filter(b => b.right > innerWidth + 1).length,
    labels: labels.length, ink: labels.length ? getComputedStyle(labels[0]).fill : '',
    paper: getComputedStyle(document.body).backgroundColor });
});
</script>
"""
FRAME = """<!doctype html><title>waiting</title><iframe src="page.html" style="border:0"
width="{width}" height="800"></iframe><script>
const frame = document.querySelector('iframe');
frame.onload = () => setTimeout(() => { document.title = frame.contentDocument.title; }, 300);
</script>"""

pytestmark = pytest.mark.skipif(
    CHROMIUM is None, reason=f"no Chromium on PATH (looked for {', '.join(NAMES)})"
)


@pytest.fixture(scope="module")
def page(tmp_path_factory):
    folder = tmp_path_factory.mktemp("page")
    own = folder / "small.toml"
    own.write_text(SCENE)
    with pytest.MonkeyPatch.context() as patch:
        for name in registry.names():
            patch.setitem(solvers.SOLVERS, name, named(name, fake(1.0 if name == "reference" else 1.1)))
        write(build("quick", [load(str(own)), load("cycle-v0.1")], 1, Progress("test")), folder)
    return (folder / "index.html").read_text()


def look(folder, html: str, width: int, *flags: str) -> dict:
    """What the page says about itself when it is ``width`` pixels wide (a frame: windows have a minimum)."""
    (folder / "page.html").write_text(html.replace("<head>", "<head>" + PROBE))
    (folder / "frame.html").write_text(FRAME.replace("{width}", str(width)))
    said = subprocess.run(
        [
            str(CHROMIUM), "--headless", "--no-sandbox", "--disable-gpu", "--no-first-run",
            "--disable-background-networking", "--disable-component-update", "--disable-sync",
            "--allow-file-access-from-files", f"--user-data-dir={folder / 'profile'}",
            "--virtual-time-budget=5000", "--window-size=1600,1000", *flags,
            "--dump-dom", (folder / "frame.html").as_uri(),
        ],
        capture_output=True, text=True, timeout=120,
    )  # fmt: skip
    title = said.stdout.partition("<title>")[2].partition("</title>")[0]
    assert title.startswith("{"), f"the page said nothing: {said.stderr[-500:]}"
    return json.loads(title)


@pytest.mark.parametrize("width", [375, 1280])
def test_page_fits_and_shows_everything(page, tmp_path, width):
    seen = look(tmp_path, page, width)
    assert seen["width"] == width
    assert seen["content"] <= width
    assert (seen["trouble"], seen["broken"], seen["flat"], seen["wide"]) == (0, 0, 0, 0)
    assert seen["figures"] == 12
    assert seen["labels"] > 50


@pytest.mark.slow
def test_dark_page_has_light_ink(page, tmp_path):
    light = look(tmp_path, page, 800, "--blink-settings=preferredColorScheme=1")
    dark = look(tmp_path, page, 800, "--blink-settings=preferredColorScheme=0")
    assert sum(_rgb(light["paper"])) > 600 > 200 > sum(_rgb(light["ink"]))
    assert sum(_rgb(dark["paper"])) < 200 < 600 < sum(_rgb(dark["ink"]))


def test_the_probe_sees_a_page_that_is_too_wide_and_a_picture_that_is_missing(page, tmp_path):
    spoilt = page.replace(
        "<main>", '<main><div style="width:900px">x</div><img src="gone.png"><script>nosuch()</script>'
    )
    seen = look(tmp_path, spoilt, 375)
    assert seen["content"] > 375
    assert seen["broken"] == 1
    assert seen["trouble"] >= 1


def _rgb(text: str) -> list[int]:
    return [int(part) for part in text[text.index("(") + 1 : text.index(")")].split(",")[:3]]
