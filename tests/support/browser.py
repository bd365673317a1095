"""Measures a page in a headless Chromium: script errors, missing pictures, width of the content."""

from __future__ import annotations

import json
import shutil
import subprocess
from pathlib import Path

NAMES = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable", "chrome")
CHROMIUM = next((path for name in NAMES if (path := shutil.which(name))), None)
PROBE = """
<script>
addEventListener('error', e => { window.trouble = (window.trouble || 0) + 1; }, true);
addEventListener("load", () => {
  for (const fold of document.querySelectorAll("details")) fold.open = true;
  const root = document.documentElement;
  const drawn = [...document.querySelectorAll('figure svg')].map(e => e.getBoundingClientRect());
  const labels = [...document.querySelectorAll('figure svg text')];
  document.title = JSON.stringify({
    width: innerWidth, content: root.scrollWidth, trouble: window.trouble || 0,
    broken: [...document.images].filter(i => !i.complete || !i.naturalWidth).length,
    figures: drawn.length, flat: drawn.filter(b => b.width < 100 || b.height < 60).length,
    wide: [...document.querySelectorAll('figure svg')]
      .filter(e => !e.closest('.wide'))  // what scrolls by itself
      .filter(e => e.getBoundingClientRect().right > innerWidth + 1).length,
    labels: labels.length, ink: labels.length ? getComputedStyle(labels[0]).fill : '',
    paper: getComputedStyle(document.body).backgroundColor });
});
</script>
"""
FRAME = '<iframe src="page{number}.html" style="border:0" width="{width}" height="800"></iframe>'
COLLECT = """<script>
addEventListener("load", () => setTimeout(() => {
  const titles = [...document.querySelectorAll("iframe")].map(frame => frame.contentDocument.title);
  document.title = "[" + titles.join() + "]";
}, 300));
</script>"""


def title_of(page: Path, *flags: str) -> str:
    """The title that a page has given itself; of a page without one what the browser says."""
    said = subprocess.run(
        [
            str(CHROMIUM), "--headless", "--no-sandbox", "--disable-gpu", "--no-first-run",
            "--disable-background-networking", "--disable-component-update", "--disable-sync",
            "--allow-file-access-from-files", f"--user-data-dir={page.parent / 'profile'}",
            "--virtual-time-budget=5000", "--window-size=1600,1000", *flags, "--dump-dom", page.as_uri(),
        ],
        capture_output=True, text=True, timeout=120,
    )  # fmt: skip
    return said.stdout.partition("<title>")[2].partition("</title>")[0] or said.stderr[-500:]


def measure_page(folder, html: str, width: int, *flags: str) -> dict:
    """What the page says about itself when it is ``width`` pixels wide."""
    (seen,) = measure_pages(folder, [(html, width)], *flags)
    return seen


def measure_pages(folder, pages: list[tuple[str, int]], *flags: str) -> list[dict]:
    """The same of several pages and widths by one browser, each in a frame: windows have a minimum width."""
    frames = []
    for number, (html, width) in enumerate(pages):
        (folder / f"page{number}.html").write_text(html.replace("<head>", "<head>" + PROBE, 1))
        frames.append(FRAME.format(number=number, width=width))
    (folder / "frame.html").write_text("".join(("<!doctype html><title>waiting</title>", *frames, COLLECT)))
    title = title_of(folder / "frame.html", *flags)
    assert title.startswith("[{"), f"the page said nothing: {title}"
    return json.loads(title)
