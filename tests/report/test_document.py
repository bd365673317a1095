"""One document in every form: nothing is lost, numbers stand to the right, markup in a text stays text."""

from __future__ import annotations

import re

from validation.report import document as doc
from validation.report import html, texts

TABLE = doc.DataTable.of(
    [
        {"run": doc.LinkCell("first", "runs"), "force": "1.5e-3", "verdict": doc.VerdictCell("pass", True)},
        {"run": "a | b <c>", "force": "–", "verdict": doc.VerdictCell("FAIL", False)},
        {"run": "third", "force": "≤ 12", "verdict": doc.VerdictCell("holds in part", None)},
    ],
    "Forces & radii",
)
IMAGE = doc.Figure("f", "A curve", b"\x89PNG", files={"curve.png": b"\x89PNG"})
PARTS = (
    doc.Section(
        "Runs",
        (TABLE, doc.Fold("More", (doc.Bullets(("one", "two")),))),
        "runs",
        doc.VerdictCell("FAIL", False),
    ),
    doc.Figures((IMAGE, doc.Figure("g", "Another", missing="No run."))),
)
DOCUMENT = doc.Document("Title & more", (doc.Paragraph("1 not passed.", False),), PARTS)


def test_columns_of_numbers_are_recognised():
    assert TABLE.columns == ("text", "number", "text")
    assert doc.DataTable(("t",), (("1.0",),), unbroken=("t",)).columns == ("unbroken",)
    assert doc.DataTable(("t",), (("1.0",),), numeric=False).columns == ("text",)
    for text in ("1", "-2.5", "+3.1e-05", "≥ 4", "2.5 s", "12 %", "inf"):
        assert doc.DataTable(("t",), ((text,),)).columns == ("number",), text
    for text in ("1.2 1.3", "7.1e-04 + 0.0e+00", "e5", "fig2a"):
        assert doc.DataTable(("t",), ((text,),)).columns == ("text",), text


def test_page_escapes_links_and_marks():
    page = html.text(DOCUMENT)
    assert "<h1>Title &amp; more</h1>" in page
    assert "a | b &lt;c&gt;" in page
    assert '<a href="#runs">first</a>' in page
    assert '<td class="number">1.5e-3</td>' in page
    assert page.count('class="fail"') == 3
    assert "<summary>More</summary>" in page
    assert "data:image/png;base64,iVBORw==" in page
    assert "<p>No run.</p>" in page


def test_markdown_holds_the_same():
    text = texts.markdown(DOCUMENT)
    rows = [line for line in text.splitlines() if line.startswith("|")]
    assert {len(re.findall(r"(?<!\\)\|", row)) for row in rows} == {4}
    assert rows[1] == "|---|---:|---|"
    for said in ("# Title & more", "## Runs: **FAIL**", "### More", "- two", "**1 not passed.**", r"a \| b"):
        assert said in text
    assert "![A curve](figures/curve.png)" in text


def test_terminal_aligns_columns():
    lines = texts.lines(PARTS[0])
    table = lines[lines.index("Forces & radii") + 1 :][:4]
    assert table[0] == f"  run{9 * ' '}force  verdict"
    assert table[1].startswith("  first      1.5e-3  pass")
    assert lines[-3:] == ["More", "- one", "- two"]


def test_contents_lead_to_every_section_and_fold():
    parts = (
        doc.Section(
            "Same",
            (doc.Section("Inner", (TABLE,)), doc.Fold("More", (doc.Paragraph("x"),))),
            verdict=doc.VerdictCell("FAIL", False),
        ),
        doc.Section("Same", (doc.Paragraph("y"),), folded=True),
        doc.Section("Named", (), "named"),
    )
    page = html.text(doc.Document("T", (), parts, contents_depth=2))
    contents = page.partition("</nav>")[0]
    anchors = re.findall(r'<li><a href="#([^"]+)">', contents)
    assert anchors == ["part-Same", "part-Inner", "part-More", "part-Same-", "named"]
    assert [page.count(f'id="{anchor}"') for anchor in anchors] == [1] * 5
    assert '<details class="section" id="part-Same-"><summary><h2>Same</h2></summary>' in page
    assert contents.count("✗") == 1


def test_folded_sections_of_a_large_document_have_pages_of_their_own(monkeypatch):
    overview = doc.Section(
        "Overview", (doc.DataTable.of([{"scene": doc.LinkCell("first", "scene-first")}]),), "overview"
    )
    runs = (doc.Section("Runs", (TABLE,)),)
    passed = doc.Section("First <scene>", runs, "scene-first", doc.VerdictCell("pass", True), folded=True)
    failed = doc.Section(
        "Second", (doc.Paragraph("open " * 300),), "scene-second", doc.VerdictCell("FAIL", False)
    )
    document = doc.Document("All", (), (overview, passed, failed))
    assert list(html.pages(document)) == ["index.html"]
    monkeypatch.setattr(html, "MOST_BYTES", len(html.text(document)) - 1)
    pages = html.pages(document)
    first, own = pages.pop("index.html"), pages.pop("pages/scene-first.html")
    assert pages == {}
    assert first.count('<a href="pages/scene-first.html">') == 2  # in the contents and in the overview
    assert (first.count("1.5e-3"), own.count("1.5e-3")) == (0, 1)
    assert 'id="scene-second"' in first
    assert "<h1>First &lt;scene&gt;</h1>" in own
    assert '<a href="../index.html">All</a>' in own
    assert '<p class="pass">pass</p>' in own
    assert html.ON_PAGES in first


def test_pictures_are_found_at_any_depth_and_their_rules_stated_once():
    nested = (doc.Section("a", (doc.Fold("b", (doc.Figures((IMAGE,)),)),)),)
    assert list(doc.figures_of(nested)) == [IMAGE]
    picture = '<svg><defs><style type="text/css">.a{fill: none}.b{fill: red}</style></defs></svg>'
    other = '<svg><defs><style type="text/css">.a{fill: none}</style></defs></svg>'
    page = html.text(
        doc.Document("T", (), (doc.Figures((doc.Figure("f", "", picture), doc.Figure("g", "", other))),))
    )
    assert page.count(".a{fill: none}") == page.count(".b{fill: red}") == 1
    assert page.count('<style type="text/css">') == 1
