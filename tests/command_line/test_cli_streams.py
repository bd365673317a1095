"""Output that goes nowhere, or not far: closed, full, without a reader, in another encoding."""

from __future__ import annotations

import errno
import io
import os
import subprocess
import sys
from pathlib import Path

import pytest
from support.commands import stand_in
from support.spring_solver import small_scene

from crosscontact.cli import main
from validation.runs import progress


@pytest.fixture
def scene_file(tmp_path, monkeypatch):
    stand_in(monkeypatch)
    return small_scene(tmp_path)


@pytest.mark.parametrize("closed", [">&-", ">&- 2>&-"])
def test_closed_output_is_no_error(closed):
    command = f"{sys.executable} -m crosscontact scenes {closed}"
    said = subprocess.run(["bash", "-c", command], capture_output=True, text=True, check=False)
    assert (said.returncode, said.stderr) == (0, "")


@pytest.mark.parametrize("encoding", ["ascii", "latin-1", "cp1252"])
def test_units_in_greek_letters_pass_through_any_encoding(scene_file, monkeypatch, encoding):
    buffer = io.BytesIO()
    monkeypatch.setattr(sys, "stdout", io.TextIOWrapper(buffer, encoding=encoding))
    assert main(["solve", scene_file, "--solver", "bem"]) == 0
    assert "pull_off_force" in buffer.getvalue().decode(encoding)


class Gone(io.StringIO):
    """What a terminal that was closed, or a pipe that nobody reads, makes of a stream."""

    encoding = "utf-8"

    def __init__(self, terminal):
        super().__init__()
        self._terminal = terminal
        self.tried = 0

    def isatty(self):
        return self._terminal

    def write(self, text):
        self.tried += 1
        number = errno.EIO if self._terminal else errno.EPIPE
        raise OSError(number, os.strerror(number))


@pytest.mark.parametrize("terminal", [True, False])
def test_progress_without_a_reader_ends_no_work(terminal, monkeypatch):
    monkeypatch.setenv("TERM", "xterm")
    stream = Gone(terminal)
    show = progress.Progress("work", stream=stream)
    show.phase("solving")
    show(0.5, "half")
    show.tell()
    show.close()
    assert stream.tried > 0


@pytest.mark.parametrize("terminal", [True, False])
def test_titles_and_names_do_not_steer_a_terminal(tmp_path, monkeypatch, terminal):
    """ESC, CSI as one character, a carriage return, and a mark that turns the direction of writing."""

    class Stream(io.StringIO):
        def isatty(self):
            return terminal

    monkeypatch.setenv("TERM", "xterm")
    written = [Stream(), Stream()]
    monkeypatch.setattr(sys, "stdout", written[0])
    monkeypatch.setattr(sys, "stderr", written[1])
    text = Path(small_scene(tmp_path)).read_text()
    scene = tmp_path / "\x1b[31mred\x9b2J.toml"
    scene.write_text(text.replace("A small scene", "\\u001b]0;owned\\u0007\\u009b2J\\rgone\\u202e"))
    stand_in(monkeypatch)
    main(["compare", str(scene), "--jobs", "1", "--solvers", "reference,bem"])
    out, err = (stream.getvalue() for stream in written)
    assert "]0;owned" in out
    assert not [sign for sign in "\x1b\x9b\r\x07\u202e" if sign in out]
    assert not [sign for sign in ("\x1b[31m", "\x1b]0", "\x9b", "\x07", "\u202e") if sign in err]


def test_a_reader_that_leaves_early_leaves_a_whole_run(scene_file, tmp_path, monkeypatch):
    with monkeypatch.context() as reading:
        reading.setattr(sys, "stdout", Gone(terminal=False))
        reading.setattr(os, "dup2", lambda *descriptors: None)  # main turns what is left to the void
        assert main(["solve", scene_file, "--solver", "bem", "--out", str(tmp_path / "out")]) == 0
    names = sorted(file.name for file in (tmp_path / "out").glob("[!.]*"))
    assert names == ["scene.toml", "summary.json", "trace.csv"]


def test_numbers_that_cannot_be_written_are_printed(scene_file, tmp_path, monkeypatch, capsys):
    def full(descriptor):
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    given = ["solve", scene_file, "--solver", "bem", "--out", str(tmp_path / "out")]
    assert main(given) == 0
    capsys.readouterr()
    monkeypatch.setattr("validation.runs.folder.os.fsync", full)
    monkeypatch.setattr("crosscontact.commands.solve.claim", lambda *given, **more: None)
    assert main(given) == 1
    out, err = capsys.readouterr()
    assert "pull_off_force" in out
    assert err.count("\n") == 1
    assert "No space left on device: " in err
    assert "scene.toml" in err
