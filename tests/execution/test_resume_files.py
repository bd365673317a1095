"""What is kept on disk: read back bit for bit, refused when damaged or foreign, never half-written."""

from __future__ import annotations

import dataclasses
import errno
import json
import os
import pickle
import signal
import time
from pathlib import Path

import numpy as np
import pytest
from support.spring_solver import spring

from contact_scene import SceneError, Sphere, read_columns
from contact_scene.indenter import TabulatedProfile
from validation import cases
from validation.execution import checked_pickle, checkpoints, files, fingerprints, folder_lock
from validation.execution.run_folder import write_run
from validation.execution.runs import Run
from validation.execution.store import Store

CASE = cases.load("cycle-v0.1")


@pytest.mark.parametrize(
    "array",
    [
        np.arange(24.0).reshape(4, 6)[1:3, ::2],
        np.arange(24.0)[::-3],
        np.asfortranarray(np.arange(6.0).reshape(2, 3)),
        np.broadcast_to(np.arange(3.0), (2, 3)),
        np.empty((0, 4))[:, ::2],
        np.array(2.5),
    ],
)
def test_arrays_keep_their_layout(array):
    back = checked_pickle.loads(checked_pickle.dumps({"of": array}))["of"]
    assert np.array_equal(back, array)
    assert back.dtype == array.dtype
    if array.size > 1:
        assert back.strides == array.strides


class Evil:
    def __reduce__(self):
        return os.system, ("true",)


class Sly:
    """Reaches through one of our modules for something that is not ours."""

    def __reduce__(self):
        return files.json.JSONDecoder, ()


@pytest.mark.parametrize("thing", [Evil(), Sly(), print, files.write_whole, Path("x"), OSError("x")])
def test_nothing_foreign_is_read_back(thing):
    with pytest.raises(checked_pickle.UnusableFile):
        checked_pickle.loads(pickle.dumps(thing))


def test_no_detour_through_our_modules():
    detour = b"\x80\x04\x8c\x1avalidation.execution.files\x8c\x10json.JSONDecoder\x93."
    assert pickle.loads(detour) is json.JSONDecoder
    with pytest.raises(checked_pickle.UnusableFile):
        checked_pickle.loads(detour)


@pytest.mark.parametrize("damage", ["cut", "flipped", "empty", "text", "no digest", "other", "list"])
def test_a_file_that_is_of_no_use_is_told(tmp_path, damage):
    file = tmp_path / "kept"
    checked_pickle.write(file, "what?", [1.0, np.arange(5.0)], 2.5)
    value, seconds = checked_pickle.read(file, "what?")
    assert (value[0], seconds) == (1.0, 2.5)
    whole = file.read_bytes()
    file.write_bytes(
        {
            "cut": whole[:-1],
            "flipped": whole[:-9] + bytes([whole[-9] ^ 1]) + whole[-8:],
            "empty": b"",
            "text": b"hello\n",
            "no digest": b'{"format": 1, "fingerprint": "what?"}\n',
            "other": whole,
            "list": b"[1]\n",
        }[damage]
    )
    with pytest.raises(checked_pickle.UnusableFile):
        checked_pickle.read(file, "who?" if damage == "other" else "what?")


def test_questions_are_told_apart():
    scene = CASE.scene
    nudged = dataclasses.replace(scene, indenter=Sphere(np.nextafter(1.0, 2.0)))
    asked = [("solve", scene, 8), ("solve", scene, None), ("solve", nudged, 8), ("run", scene, 8)]
    assert len({fingerprints.fingerprint(*parts) for parts in asked}) == len(asked)
    assert fingerprints.fingerprint("solve", scene, 8) == fingerprints.fingerprint(
        "solve", dataclasses.replace(scene), 8
    )
    with pytest.raises(TypeError):
        fingerprints.fingerprint(object())


def test_tabulated_indenters_have_a_fingerprint():
    """They carry an interpolating curve, which follows from the table and is no part of the fingerprint."""
    tables = [
        TabulatedProfile((0.0, 1.0, 2.0), heights, file)
        for heights, file in (((0.0, 0.5, 2.0), "a"), ((0.0, 0.5, 2.0), "b"), ((0.0, 0.5, 2.1), "a"))
    ]
    one, same, other = (
        fingerprints.fingerprint(dataclasses.replace(CASE.scene, indenter=table)) for table in tables
    )
    assert one == same != other


def test_another_version_of_the_program_asks_another_question(monkeypatch):
    before = fingerprints.fingerprint(CASE.scene)
    monkeypatch.setattr(fingerprints, "version", lambda: "another")
    assert fingerprints.fingerprint(CASE.scene) != before


def test_a_writer_goes_on_ignores_and_starts_afresh(tmp_path):
    file = tmp_path / checkpoints.CHECKPOINT
    stopping = checkpoints.CheckpointWriter(file, "q", lambda: True)
    assert (stopping.start_state, stopping.message) == (None, "")
    assert not stopping.continue_run(lambda: [1, 2])
    assert stopping.stopped
    going = checkpoints.CheckpointWriter(file, "q", lambda: False)
    assert going.start_state == [1, 2]
    assert "continuing" in going.message
    assert going.continue_run(lambda: pytest.fail("kept too soon"))
    assert checkpoints.CheckpointWriter(file, "q", lambda: False, fresh=True).start_state is None
    other = checkpoints.CheckpointWriter(file, "p", lambda: False)
    assert other.start_state is None
    assert "another scene" in other.message
    going.remove()
    assert not file.exists()


def test_a_writer_keeps_now_and_then(tmp_path, monkeypatch):
    monkeypatch.setattr(checkpoints, "INTERVAL", 0.0)
    monkeypatch.setattr(checkpoints, "INTERVAL_PER_WRITE", 0.0)
    file = tmp_path / checkpoints.CHECKPOINT
    writer = checkpoints.CheckpointWriter(file, "q", lambda: False)
    for state in range(3):
        assert writer.continue_run(lambda state=state: state)
        assert checked_pickle.read(file, "q")[0][0] == state


def test_a_full_disk_stops_no_run(tmp_path, monkeypatch, capsys):
    def full(*arguments):
        raise OSError("no space left")

    monkeypatch.setattr(checked_pickle, "write_whole", full)
    writer = checkpoints.CheckpointWriter(tmp_path / "kept", "q", lambda: True)
    assert not writer.continue_run(lambda: 1)
    assert not writer.continue_run(lambda: 2)
    assert capsys.readouterr().err.count("cannot be saved: no space left") == 1


def test_a_store_takes_over_what_is_whole(tmp_path):
    store = Store(tmp_path)
    assert store.get("a") is None
    store.put("a", {"x": 0.1})
    store.put("b", {"x": 0.2})
    broken = next((tmp_path / ".unfinished").glob("b"))
    broken.write_bytes(broken.read_bytes()[:-2])
    again = Store(tmp_path)
    assert (again.get("a"), again.get("b"), again.taken_over) == ({"x": 0.1}, None, 1)
    assert again.seconds > 0.0
    again.clear()
    assert list(tmp_path.iterdir()) == []
    nowhere = Store()
    nowhere.put("a", 1)
    assert nowhere.get("a") is None


def test_a_folder_is_held_once(tmp_path):
    folder = tmp_path / "out"
    with folder_lock.locked_folder(folder) as held:
        assert held == folder
        with pytest.raises(SceneError, match=f"in use by another crosscontact \\(process {os.getpid()} on "):
            folder_lock.locked_folder(folder).__enter__()
        (folder / "result").write_text("")
    assert [file.name for file in folder.iterdir()] == ["result"]
    with folder_lock.locked_folder(folder):
        pass
    with folder_lock.locked_folder(tmp_path / "nothing comes of it"):
        pass
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


def test_a_lock_goes_with_its_holder(tmp_path):
    def hold():
        with folder_lock.locked_folder(tmp_path):
            os.kill(os.getpid(), signal.SIGKILL)

    killed(hold)
    assert (tmp_path / folder_lock.LOCK_FILE).exists()
    with folder_lock.locked_folder(tmp_path):
        pass
    assert not (tmp_path / folder_lock.LOCK_FILE).exists()


@pytest.mark.parametrize("left", ["", "garbage", "4242\nanother-host\n"])
def test_what_a_lock_file_says_locks_nothing(tmp_path, left):
    (tmp_path / folder_lock.LOCK_FILE).write_text(left)
    with folder_lock.locked_folder(tmp_path), pytest.raises(SceneError, match=f"process {os.getpid()} on "):
        folder_lock.locked_folder(tmp_path).__enter__()


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
    with folder_lock.locked_folder(tmp_path):
        pass
    file = tmp_path / folder_lock.LOCK_FILE
    file.write_text(left)
    if named is None:
        folder_lock.locked_folder(tmp_path).__enter__()
        return
    monkeypatch.setattr(folder_lock, "MARKER_WAIT", 0.1)
    with pytest.raises(SceneError, match=f"{named}.*remove {file}"):
        folder_lock.locked_folder(tmp_path).__enter__()
    assert file.read_text() == left


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


def test_a_writer_knows_the_time_behind_it(tmp_path):
    file = tmp_path / "kept"
    writer = checkpoints.CheckpointWriter(file, "q", lambda: True)
    time.sleep(0.02)
    writer.continue_run(lambda: None)
    again = checkpoints.CheckpointWriter(file, "q", lambda: True)
    assert again.seconds >= 0.02
    again.continue_run(lambda: None)
    assert checkpoints.CheckpointWriter(file, "q", lambda: True).seconds > again.seconds
