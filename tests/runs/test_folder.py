"""A folder belongs to one question and is written by one command; its files appear whole."""

from __future__ import annotations

import errno
import json
import os
import signal
from pathlib import Path

import pytest
from support.commands import refusal, stand_in
from support.recorded import elastic_scene, hertz_curve
from support.report_commands import WORK
from support.spring_solver import small_scene, spring

import crosscontact as cc
from contact_scene import SceneError, read_columns
from crosscontact.cli import main
from validation import cases
from validation.runs import folder
from validation.runs.folder import CLAIM, LOCK_FILE, claim, locked_folder
from validation.runs.progress import Progress
from validation.runs.run import Run, write_run

CASE = cases.load("cycle-v0.1")


class WorkBegan(Exception):
    """The folder was accepted."""


@pytest.fixture(params=WORK)
def command(request, tmp_path, monkeypatch):
    """Arguments of a command into ``tmp_path / "out"``, which ends where its work begins."""

    def work(*given, **more):
        for progress in (one for one in given if isinstance(one, Progress)):
            progress.close()
        raise WorkBegan

    monkeypatch.setattr(f"crosscontact.commands.{WORK[request.param]}", work)
    (tmp_path / "out").mkdir()
    given = [small_scene(tmp_path) if word == "SCENE" else word for word in request.param.split()]
    return [*given, "--jobs", "1", "--out", str(tmp_path / "out")]


def begun(given: list[str]) -> bool:
    """Whether the work began."""
    try:
        main(given)
    except WorkBegan:
        return True
    return False


def refused(capsys, given: list[str]) -> str:
    """The line with which a command is refused."""
    line = refusal(capsys, *given)
    assert line.startswith("crosscontact: error: --out: ")
    assert line.endswith("; allowed: another folder, or --fresh to replace what it holds")
    return line


def test_what_another_program_or_command_wrote_is_kept(capsys, tmp_path, command):
    foreign = tmp_path / "out/trace.csv"
    foreign.write_text("mine")
    (tmp_path / "out/my.toml").write_text("a file that no command writes")
    assert "is not empty: it holds trace.csv;" in refused(capsys, command)
    assert foreign.read_text() == "mine"
    (tmp_path / "out" / CLAIM).write_text('{"kind": "a meal", "question": {}}')
    assert "it holds a meal" in refused(capsys, command)
    assert begun([*command, "--fresh"])
    assert begun(command)  # its own from here on


def test_results_on_another_scene_are_kept(capsys, tmp_path, command):
    assert begun(command)
    (tmp_path / "out/index.html").write_text("")
    assert begun(command)
    file = tmp_path / "out" / CLAIM
    stated = json.loads(file.read_text())
    for name in stated["question"]:
        file.write_text(json.dumps({**stated, "question": stated["question"] | {name: "0"}}))
        assert f"(other {name})" in refused(capsys, command)
    file.write_text(json.dumps({**stated, "question": stated["question"] | {"scene larger": "0"}}))
    assert "(other scene larger)" in refused(capsys, command)


def test_from_python_there_is_no_fresh(tmp_path, monkeypatch):
    out = tmp_path / "out"
    out.mkdir()
    (out / "report.json").write_text("{}")
    with pytest.raises(SceneError, match=r"^out: .* it holds report\.json; allowed: another folder$"):
        cc.fit(hertz_curve(), elastic_scene(), ["material.modulus"], out=out)
    with pytest.raises(SceneError, match=r"^out: .* it holds report\.json; allowed: another folder$"):
        cc.sweep(small_scene(tmp_path), {"material.modulus": [0.7]}, out=out)
    with pytest.raises(SceneError, match=r"^folder: .* it holds report\.json; allowed: another folder$"):
        cc.export_exam(out)
    assert [file.name for file in out.iterdir()] == ["report.json"]


def test_a_sweep_joins_no_other_and_is_joined_by_none(capsys, tmp_path, monkeypatch):
    def work(*given):
        raise WorkBegan

    monkeypatch.setattr("crosscontact.commands.sweep.carry_out", work)
    scene, plan, out = small_scene(tmp_path), tmp_path / "plan.toml", tmp_path / "out"
    coordinate = '[[coordinates]]\nkeys = ["material.modulus"]\nvalues = [0.7, 0.8]\n'
    plan.write_text(f'scene = "{scene}"\n{coordinate}')
    given = ["sweep", str(plan), "--jobs", "1", "--out", str(out)]
    out.mkdir()
    assert begun(given)
    (out / "sweep.nc").write_text("")
    assert begun(given)
    assert "it holds a sweep" in refused(capsys, ["compare", scene, "--out", str(out)])


def test_a_run_and_fields_share_a_folder_by_scene_and_solver(capsys, tmp_path, monkeypatch):
    def work(*given):
        raise WorkBegan

    monkeypatch.setattr("crosscontact.commands.fields.moments.record_fields", work)
    stand_in(monkeypatch)
    file, out = small_scene(tmp_path), str(tmp_path / "out")
    solve, fields = ["solve", file, "--out", out, "--solver"], ["fields", file, "--at", "0.1", "--out", out]
    assert main([*solve, "bem"]) == 0
    before = (tmp_path / "out/summary.json").read_bytes()
    for given in ([*solve, "fem"], fields):
        assert "it holds a run (other solver)" in refused(capsys, given)
    assert (tmp_path / "out/summary.json").read_bytes() == before
    assert main([*solve, "bem", "--resolution", "6"]) == 0  # other options of the same question
    assert main([*solve, "fem", "--fresh"]) == 0
    assert begun(fields)
    Path(file).write_text(Path(file).read_text().replace("A small", "The same"))
    assert begun(fields)
    Path(file).write_text(Path(file).read_text().replace("0.75", "0.76"))
    assert "(other scene)" in refused(capsys, fields)


def test_a_folder_is_held_once(tmp_path):
    out = tmp_path / "out"
    with locked_folder(out) as held:
        assert held == out
        with pytest.raises(SceneError, match=f"in use by another crosscontact \\(process {os.getpid()} on "):
            locked_folder(out).__enter__()
        (out / "result").write_text("")
    assert [file.name for file in out.iterdir()] == ["result"]
    with locked_folder(out):
        pass
    with locked_folder(tmp_path / "nothing comes of it") as held:
        claim(held, "a run", {})
    assert not (tmp_path / "nothing comes of it").exists()


def killed(work) -> None:
    """Do it in a process of its own, which may kill itself."""
    child = os.fork()
    if child == 0:
        try:
            work()
        finally:
            os._exit(0)
    assert os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) in (0, -signal.SIGKILL)


@pytest.mark.parametrize("left", [None, "", "garbage", "4242\nanother-host\n"])
def test_a_lock_goes_with_its_holder_whatever_its_file_says(tmp_path, left):
    def hold():
        with locked_folder(tmp_path):
            os.kill(os.getpid(), signal.SIGKILL)

    if left is None:
        killed(hold)
    else:
        (tmp_path / LOCK_FILE).write_text(left)
    assert (tmp_path / LOCK_FILE).exists()
    with locked_folder(tmp_path), pytest.raises(SceneError, match=f"process {os.getpid()} on "):
        locked_folder(tmp_path).__enter__()
    assert not (tmp_path / LOCK_FILE).exists()


@pytest.mark.parametrize(
    ("left", "named"),
    [
        ("", "another crosscontact; "),
        ("4242\nanother-host\n", "process 4242 on another-host"),
        pytest.param("garbage", None, marks=pytest.mark.slow),
    ],
)
def test_without_locks_of_the_kernel_the_file_is_the_lock(tmp_path, monkeypatch, left, named):
    """A damaged one is taken over; of another host, or of a program that wrote nothing, it stands."""

    def flock(descriptor, operation):
        raise OSError(errno.ENOSYS, os.strerror(errno.ENOSYS))

    monkeypatch.setattr("fcntl.flock", flock)
    with locked_folder(tmp_path):
        pass
    file = tmp_path / LOCK_FILE
    file.write_text(left)
    if named is None:
        locked_folder(tmp_path).__enter__()
        return
    monkeypatch.setattr(folder, "MARKER_WAIT", 0.1)
    with pytest.raises(SceneError, match=f"{named}.*remove {file}"):
        locked_folder(tmp_path).__enter__()
    assert file.read_text() == left


@pytest.mark.parametrize("failing", ["fsync", "write"])
def test_a_full_disk_is_told_with_the_file(tmp_path, monkeypatch, failing):
    """The lock, whose contents are for the reader of a message, is held without them."""

    def full(*given, **more):
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    if failing == "fsync":
        stage = tmp_path / "stage"
        stage.mkdir()
        (stage / "trace.csv").write_text("")
        monkeypatch.setattr(os, "fsync", full)
        with pytest.raises(OSError, match=r"No space left on device.*folder/trace\.csv"):
            folder.move_whole(stage, tmp_path / "folder")
        return
    monkeypatch.setattr(os, "write", full)
    monkeypatch.setattr(Path, "write_text", full)
    with locked_folder(tmp_path):
        pass


def run_of(stiffness: float) -> Run:
    trace = spring(stiffness)(CASE.scene)
    return Run(CASE.name, "bem", trace, measures={"pull_off_force": 0.01})


@pytest.mark.parametrize("survived", range(6))
def test_results_are_whole_whenever_the_program_is_killed(tmp_path, survived):
    """Killed before one move into place after the other: old or new, never half; no summary of a mixture."""
    before, after = run_of(1.0), run_of(2.0)
    write_run(tmp_path, CASE.scene, before)
    moves = iter(range(10))

    def work():
        move = Path.replace

        def last(self, target):
            if next(moves) == survived:
                os.kill(os.getpid(), signal.SIGKILL)
            return move(self, target)

        Path.replace = last
        write_run(tmp_path, CASE.scene, after)

    killed(work)
    force = read_columns(tmp_path / "trace.csv")["force"]
    assert force.tolist() in (before.trace.force.tolist(), after.trace.force.tolist())
    finished = (tmp_path / "summary.json").exists()
    assert finished == (survived == 5)
    write_run(tmp_path, CASE.scene, after)  # and whatever was left lying about goes
    assert sorted(file.name for file in tmp_path.iterdir()) == ["scene.toml", "summary.json", "trace.csv"]
    assert json.loads((tmp_path / "summary.json").read_text())["pull_off_force"] == 0.01
