"""Progress: a bar on a terminal, plain lines elsewhere."""

from __future__ import annotations

import io
import threading

import pytest

from validation.execution import progress
from validation.execution.run_tasks import run_tasks
from validation.execution.store import Store
from validation.execution.tasks import Task


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
    """Of two hundred runs the first took two minutes, as forecast: the others take seconds, not hours."""
    show, lines = work
    show.phase("runs")

    def run(seconds):
        clock[0] += seconds
        show.tell()

    seconds = [2.0, 120.0] + [2.0] * 200
    made = [Task(str(n), "run", run, (each,), expected_seconds=each) for n, each in enumerate(seconds)]
    run_tasks(made, progress=show)
    told = lines()
    assert told[0].startswith("work: runs: 1/202 run: ")
    assert "left" not in told[0]
    assert not any(" h left" in line for line in told)
    assert "about 7 min left" in told[2]


def test_work_inside_a_long_task_counts(clock, work):
    """Among two hundred tasks one is half of the work, and tells how far it is."""
    show, lines = work
    show.phase("runs")

    def long(tell_share):
        for second in range(1, 101):
            clock[0] += 1.0
            tell_share(0.01 * second)

    def short():
        clock[0] += 0.5

    made = [Task("long", "long", long, (), expected_seconds=100.0, tells_share=True)]
    made += [Task(str(n), "short", short, (), expected_seconds=0.5) for n in range(200)]
    run_tasks(made, progress=show)
    of_long = [line for line in lines() if "long" not in line and "short" not in line][:5]
    assert of_long == [f"work: runs: {10 * n} %: about {left} left" for n, left in
                       enumerate(("3 min", "3 min", "2 min", "2 min", "2 min"), 1)]  # fmt: skip


def test_tasks_tell_the_time_left_by_their_forecasts(clock, tmp_path):
    def work():
        clock[0] += 3.0

    told = []
    made = [
        Task(str(n), f"task {n}", work, (), str, expected_seconds=seconds)
        for n, seconds in enumerate((3, 1, 2))
    ]
    run_tasks(made, progress=lambda done, text, left: told.append(text))
    assert [text.partition(", ")[2] for text in told] == ["about 3 s left", "about 3 s left", ""]
    kept = Store(tmp_path)
    kept.put("0", "done before")
    told.clear()
    run_tasks(made, store=kept, progress=lambda done, text, left: told.append(text))
    assert [text.partition(", ")[2] for text in told] == ["", "about 6 s left", ""]
