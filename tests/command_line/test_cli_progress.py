"""Progress: a bar on a terminal, plain lines elsewhere."""

from __future__ import annotations

import io
import threading

import pytest

from validation.runs import progress
from validation.runs.pool import Task, run_tasks
from validation.runs.store import Store


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
    monkeypatch.setenv("TERM", "xterm")


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
    assert stream.getvalue().endswith(" \r")


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


@pytest.fixture
def work(clock, monkeypatch):
    """Progress without its thread, and its lines."""
    monkeypatch.setattr(progress.Progress, "_keep_telling", lambda self: None)
    stream = io.StringIO()
    return progress.Progress("work", stream), lambda: stream.getvalue().splitlines()


def test_a_silent_phase_is_told_to_go_on(clock, work):
    show, lines = work
    show.phase("set-up")
    for second in range(1, 301):
        clock[0] = float(second)
        show.tell()
    told = lines()
    assert told[0] == "work: set-up: 0 %, after 10 s"
    assert told[-1].startswith("work: set-up: 0 %, after 5 min")
    assert 12 < len(told) < 25  # ever less often
    show.phase("drawing")
    clock[0] += 5.0
    show(0.4)
    assert lines()[-1] == "work: drawing: 40 %: about 8 s left"


def test_the_thread_tells_by_itself(monkeypatch):
    for name in ("SILENCE", "SILENT_SHARE"):
        monkeypatch.setattr(progress, name, 0.0)
    told = threading.Event()
    monkeypatch.setattr(progress.Progress, "tell", lambda self: told.set())
    with progress.Progress("work", io.StringIO()) as show:
        show.phase("set-up")
        assert told.wait(10.0)
    assert show._closed.is_set()


def test_a_run_tells_its_steps_and_the_time_left_by_its_loading(clock, work):
    show, lines = work
    count = progress.StepProgress(show, "measuring")
    for share in (0.0, *(n / 200 for n in range(1, 100)), 1.0):  # contact is lost half-way
        clock[0] += 0.2
        count(share)
    told = lines()
    assert told[-1].startswith("work: solving: 100 %: 101 steps")
    middle = next(line for line in told if " 40 %" in line)
    assert middle == "work: solving: 40 %: 81 steps, about 24 s left"


def test_no_time_is_left_to_be_told_before_a_share_of_the_work_is_done(clock, work):
    """Of two hundred runs the second took two minutes: nothing is told before a twentieth of them is done."""
    show, lines = work
    show.phase("runs")

    def run(seconds):
        clock[0] += seconds
        show.tell()

    seconds = [2.0, 120.0] + [2.0] * 200
    made = [Task(str(n), "run", run, (each,)) for n, each in enumerate(seconds)]
    run_tasks(made, progress=show)
    told = lines()
    assert told[0].startswith("work: runs: 1/202 run: ")
    assert "left" not in told[0]
    first = next(line for line in told if "left" in line)
    assert first.startswith("work: runs: 11/202 run: 0.0 s, about 41 min left")


def test_tasks_tell_the_time_left_by_those_finished_before(clock, tmp_path):
    def work():
        clock[0] += 3.0

    told = []
    made = [Task(str(n), f"task {n}", work, (), str) for n in range(3)]
    run_tasks(made, progress=lambda done, text, left: told.append(text))
    assert [text.partition(", ")[2] for text in told] == ["about 6 s left", "about 3 s left", ""]
    kept = Store(tmp_path)
    kept.put("0", "done before")
    told.clear()
    run_tasks(made, store=kept, progress=lambda done, text, left: told.append(text))
    assert [text.partition(", ")[2] for text in told] == ["", "about 3 s left", ""]
