"""The words of the README and of the documentation against the program, and their examples run."""

from __future__ import annotations

import re
import shlex
import shutil
import sys
import tomllib
from pathlib import Path

import pytest
from support.unlaid_figures import without_layout

from contact_scene import OutcomeKind, read_scene, scene_from_dict
from crosscontact import arguments
from crosscontact.cli import main
from crosscontact.commands import parser
from validation import solvers

ROOT = Path(__file__).parents[2]
README = ROOT / "README.md"
PAGES = [path for path in sorted((ROOT / "docs").rglob("*.md")) if "generated" not in path.parts]
TEXTS = {path: path.read_text("utf-8") for path in [README, ROOT / "CONTRIBUTING.md", *PAGES]}
BLOCK = re.compile(
    r"^(`{3,})(?:\{code-(?:block|cell)\} )?(\w+)\n(?::caption: (\S+)\n\n?)?(.*?)^\1$",
    re.DOTALL | re.MULTILINE,
)
ELSEWHERE = {
    "README.md": "tests/door/test_readme.py",
    "add-a-solver.md": "tests/all_solvers/test_plugins.py",
    "sweep-on-a-cluster.md": "a cluster",
}
"""Pages whose Python is run by a test of their own, or cannot be run here; notebooks are run by the site."""
EXECUTED = [
    path
    for path, text in TEXTS.items()
    if "```python" in text and "kernelspec" not in text and path.name not in ELSEWHERE
]
CURVES = ROOT / "docs" / "data" / "curves"


def _name(path):
    return str(path.relative_to(ROOT))


def _blocks(text, language=None):
    """Language, caption and contents of the fenced blocks of a page, in their order."""
    found = [(kind, caption, body) for _, kind, caption, body in BLOCK.findall(text)]
    return [block for block in found if language in (None, block[0])]


def _commands(text):
    """Arguments of the program's commands in the blocks of shell lines."""
    lines = "\n".join(body for _, _, body in _blocks(text, "sh")).replace("\\\n", " ").splitlines()
    calls = [part.partition("#")[0].strip() for line in lines for part in line.split("&&")]
    called = re.compile(r"(?:\.venv/bin/)?crosscontact +(.*)")
    return [shlex.split(found.group(1)) for call in calls if (found := called.fullmatch(call))]


def test_scene_in_the_reference_is_a_scene():
    block = _blocks(TEXTS[ROOT / "docs/reference/scene-file.md"], "toml")[0][2]
    scene = scene_from_dict(tomllib.loads(block))
    assert scene.material.glassy_modulus == 7.5
    assert len(scene.loading.steps) == 2


@pytest.mark.parametrize("page", TEXTS, ids=_name)
def test_commands_are_commands(page, monkeypatch):
    if "add-a-solver" in page.name:  # its solver is that of a package that the reader writes
        monkeypatch.setattr(arguments, "selectable", lambda: (*solvers.SOLVERS, "hertz"))
    spans = re.findall(r"`crosscontact (\w+ [^`]+)`", TEXTS[page])
    spans += re.findall(r"^crosscontact (\w+ [^\n\\#]+)$", TEXTS[page], re.MULTILINE)  # of any block
    for command in [*_commands(TEXTS[page]), *map(shlex.split, spans)]:
        if command == ["--version"]:
            continue
        assert parser().parse_args(command).command, command


def test_most_pages_are_about_commands():
    assert len(_commands(TEXTS[README])) == 1
    assert sum(map(len, map(_commands, TEXTS.values()))) > 5


def test_files_named_exist():
    pattern = r"`((?:validation|contact_scene|bem_solver|fem_solver|crosscontact|docs|tests)/[\w/.-]*)`"
    named = [name for text in TEXTS.values() for name in re.findall(pattern, text)]
    made = ("docs/generated", "docs/data/report.zip")
    assert len(named) >= 8
    assert [name for name in named if not name.startswith(made) and not (ROOT / name).exists()] == []


def test_pictures_and_pages_linked_exist():
    pictures, links = [], []
    for path, text in TEXTS.items():
        pictures += [path.parent / name for name in re.findall(r"!\[[^]]*\]\(([^)]+)\)", text)]
        links += [
            path.parent / name for name in re.findall(r"(?<!!)\[[^]]+\]\(([\w./-]+\.(?:md|cff))\)", text)
        ]
    assert len(re.findall(r"!\[", TEXTS[README])) == 1
    assert {"cycles.png", "fields.png", "first-scene.png"} <= {path.name for path in pictures}
    assert [path for path in pictures if not path.exists()] == []
    assert len(links) > 20
    assert [path for path in links if not path.exists() and "generated" not in path.parts] == []


def test_no_page_holds_both_sides_of_a_merge():
    conflict = re.compile("^(<{7}|>{7}|={7}$)", re.MULTILINE)
    assert [str(page) for page in PAGES if conflict.search(page.read_text("utf-8"))] == []


def test_every_outcome_is_explained():
    page = TEXTS[ROOT / "docs/reference/exit-codes.md"]
    assert [kind for kind in OutcomeKind if f"`{kind}`" not in page] == []


def test_readme_fits_a_screen_and_its_table_is_that_of_the_saved_report():
    import site_pages

    text = TEXTS[README]
    assert len(text.splitlines()) < 100
    table = site_pages.accuracy(site_pages.saved_report.read(site_pages.ARCHIVE))
    assert site_pages.with_table(text, table) == text
    assert "| `fem` |" in text


@pytest.mark.slow
@pytest.mark.parametrize("page", EXECUTED, ids=_name)
def test_examples_run(page, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("pyvista.OFF_SCREEN", True)
    monkeypatch.setattr("validation.fields.figures.PIXELS", 90)
    names: dict = {}
    done = 0
    for name in {path.name for path in CURVES.iterdir()} & set(re.findall(r"[\w.-]+", TEXTS[page])):
        shutil.copy(CURVES / name, tmp_path)
    for kind, caption, body in _blocks(TEXTS[page]):
        if caption:
            Path(caption).write_text(body, "utf-8")
            if "[indenter]" in body:
                assert read_scene(caption).loading.steps
        elif kind == "sh":
            for command in _commands(f"```sh\n{body}```"):
                with without_layout():  # pictures are there; how they look is not asked
                    assert main(command) == 0, command
                done += 1
        elif kind == "python":
            exec(body, names)
            done += 1
    assert done >= 1
    assert "Traceback" not in capsys.readouterr().err


sys.path.append(str(ROOT / "docs"))  # of the modules that write pages
