"""Progress: a bar on a terminal, plain lines elsewhere."""

from __future__ import annotations

import io

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
    show = progress.Progress("work", stream=stream)
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
    show = progress.Progress("work", stream=stream)
    show(0.5, "half")
    show.close()
    assert stream.getvalue() == "work: half\n"


def test_plain_lines_elsewhere(clock):
    stream = io.StringIO()
    show = progress.Progress("work", stream=stream)
    for second in range(101):
        clock[0] = float(second)
        show(second / 100)
    show(1.0, "done")
    show.close()
    lines = stream.getvalue().splitlines()
    assert lines == [f"work: {tenth}0 %" for tenth in range(1, 11)] + ["work: done"]


@pytest.fixture
def work(clock, monkeypatch):
    """Progress without its thread, and its lines."""
    monkeypatch.setattr(progress.Progress, "_keep_telling", lambda self: None)
    stream = io.StringIO()
    return progress.Progress("work", stream=stream), lambda: stream.getvalue().splitlines()


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
