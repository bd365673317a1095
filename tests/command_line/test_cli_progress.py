"""Progress: a bar on a terminal, plain lines elsewhere; and the README's words against the program."""

from __future__ import annotations

import io
import re
import shlex
import tomllib
from pathlib import Path

import pytest

from contact_scene import scene_from_dict
from crosscontact.arguments import parser
from validation.execution import progress

README = Path("README.md").read_text("utf-8")


class Terminal(io.StringIO):
    encoding = "utf-8"

    def isatty(self):
        return True


@pytest.fixture
def clock(monkeypatch):
    """A clock that is set by hand."""
    now = [0.0]
    monkeypatch.setattr(progress.time, "monotonic", lambda: now[0])
    return now


@pytest.fixture
def _terminal(monkeypatch):
    """One that moves the cursor and has no colours, in which an unfilled bar would be drawn."""
    monkeypatch.setenv("TERM", "xterm")
    monkeypatch.setenv("NO_COLOR", "1")


@pytest.mark.usefixtures("_terminal")
def test_bar_on_a_terminal(clock):
    stream = Terminal()
    show = progress.Progress("work", stream)
    clock[0] = 1.0
    show(0.5)
    assert stream.getvalue().count("━") == 15
    drawn = stream.getvalue().count("\r")
    assert drawn == 1
    show(0.55)
    assert stream.getvalue().count("\r") == drawn  # too soon to be redrawn
    show.close()
    assert stream.getvalue().endswith("\r\x1b[1A\x1b[2K")


def test_plain_lines_on_a_terminal_that_cannot_redraw(monkeypatch):
    monkeypatch.setenv("TERM", "dumb")
    stream = Terminal()
    show = progress.Progress("work", stream)
    show(0.5, "half")
    show.close()
    assert stream.getvalue() == "work: half\n"


def test_plain_lines_elsewhere(clock):
    stream = io.StringIO()
    show = progress.Progress("work", stream)
    for second in range(101):
        clock[0] = float(second)
        show(second / 100)
    show(1.0, "done")
    show.close()
    lines = stream.getvalue().splitlines()
    assert lines == [f"work: {tenth}0 %" for tenth in range(1, 11)] + ["work: done"]


def test_quick_work_is_silent(clock):
    stream = io.StringIO()
    show = progress.Progress("work", stream)
    for percent in range(100):
        show(percent / 100)
    assert stream.getvalue() == ""


@pytest.mark.usefixtures("_terminal")
def test_bar_without_unicode(clock):
    stream = Terminal()
    stream.encoding = "ascii"
    show = progress.Progress("work", stream)
    show(1.0, "end")
    assert "-" * progress.WIDTH in stream.getvalue()
    assert stream.getvalue().isascii()


def test_scene_in_the_readme_is_a_scene():
    (block,) = re.findall(r"```toml\n(.*?)```", README, flags=re.DOTALL)
    scene = scene_from_dict(tomllib.loads(block))
    assert scene.material.glassy_modulus == 7.5
    assert len(scene.loading.steps) == 2


def test_commands_in_the_readme_are_commands():
    commands = re.findall(r"\.venv/bin/crosscontact (\w[^\n`&]*)", README)
    assert len(commands) >= 2
    for command in commands:
        assert parser().parse_args(shlex.split(command)).command


def test_files_named_in_the_readme_exist():
    named = re.findall(r"`((?:validation|contact_scene|bem_solver|crosscontact)/[\w/]*(?:\.py)?)`", README)
    assert len(named) >= 8
    assert [name for name in named if not Path(name).exists()] == []
    for script in ("docs/make_figure.py", "docs/make_fields.py", "docs/make_first_scene.py"):
        assert Path(script).exists()
    pictures = re.findall(r"!\[[^]]*\]\(([^)]+)\)", README)
    assert len(pictures) == 3
    assert [picture for picture in pictures if not Path(picture).exists()] == []
