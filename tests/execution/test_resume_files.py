"""What is kept on disk: read back bit for bit, refused when damaged or foreign, never half-written."""

from __future__ import annotations

import dataclasses
import json
import os
import pickle
import signal
import time
from pathlib import Path

import numpy as np
import pytest
from support.spring_solver import fake

from contact_scene import SceneError, Sphere, read_columns
from validation import cases
from validation.execution import checked_pickle, checkpoints, files, lock
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
    back = checked_pickle.thawed(checked_pickle.frozen({"of": array}))["of"]
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
    with pytest.raises(checked_pickle.Unusable):
        checked_pickle.thawed(pickle.dumps(thing))


def test_no_detour_through_our_modules():
    detour = b"\x80\x04\x8c\x10validation.files\x8c\x10json.JSONDecoder\x93."
    assert pickle.loads(detour) is json.JSONDecoder
    with pytest.raises(checked_pickle.Unusable):
        checked_pickle.thawed(detour)


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
            "no digest": b'{"format": 1, "question": "what?"}\n',
            "other": whole,
            "list": b"[1]\n",
        }[damage]
    )
    with pytest.raises(checked_pickle.Unusable):
        checked_pickle.read(file, "who?" if damage == "other" else "what?")


def test_questions_are_told_apart():
    scene = CASE.scene
    nudged = dataclasses.replace(scene, indenter=Sphere(np.nextafter(1.0, 2.0)))
    asked = [("solve", scene, 8), ("solve", scene, None), ("solve", nudged, 8), ("run", scene, 8)]
    assert len({checkpoints.question(*parts) for parts in asked}) == len(asked)
    assert checkpoints.question("solve", scene, 8) == checkpoints.question(
        "solve", dataclasses.replace(scene), 8
    )
    with pytest.raises(TypeError):
        checkpoints.question(object())


def test_another_version_of_the_program_asks_another_question(monkeypatch):
    before = checkpoints.question(CASE.scene)
    monkeypatch.setattr(checkpoints, "version", lambda: "another")
    assert checkpoints.question(CASE.scene) != before


def test_a_keeper_goes_on_ignores_and_starts_afresh(tmp_path):
    file = tmp_path / checkpoints.CHECKPOINT
    stopping = checkpoints.Keeper(file, "q", lambda: True)
    assert (stopping.kept, stopping.said) == (None, "")
    assert not stopping.goes_on(lambda: [1, 2])
    assert stopping.stopped
    going = checkpoints.Keeper(file, "q", lambda: False)
    assert going.kept == [1, 2]
    assert "going on" in going.said
    assert going.goes_on(lambda: pytest.fail("kept too soon"))
    assert checkpoints.Keeper(file, "q", lambda: False, fresh=True).kept is None
    other = checkpoints.Keeper(file, "p", lambda: False)
    assert other.kept is None
    assert "another scene" in other.said
    going.done()
    assert not file.exists()


def test_a_keeper_keeps_now_and_then(tmp_path, monkeypatch):
    monkeypatch.setattr(checkpoints, "EVERY", 0.0)
    monkeypatch.setattr(checkpoints, "SHARE", 0.0)
    file = tmp_path / checkpoints.CHECKPOINT
    keeper = checkpoints.Keeper(file, "q", lambda: False)
    for state in range(3):
        assert keeper.goes_on(lambda state=state: state)
        assert checked_pickle.read(file, "q")[0][0] == state


def test_a_full_disk_stops_no_run(tmp_path, monkeypatch, capsys):
    def full(*arguments):
        raise OSError("no space left")

    monkeypatch.setattr(checked_pickle, "write_whole", full)
    keeper = checkpoints.Keeper(tmp_path / "kept", "q", lambda: True)
    assert not keeper.goes_on(lambda: 1)
    assert not keeper.goes_on(lambda: 2)
    assert capsys.readouterr().err.count("cannot be kept: no space left") == 1


def test_a_store_takes_over_what_is_whole(tmp_path):
    store = Store(tmp_path)
    assert store.get("a") is None
    store.put("a", {"x": 0.1})
    store.put("b", {"x": 0.2})
    broken = next((tmp_path / ".unfinished").glob("b"))
    broken.write_bytes(broken.read_bytes()[:-2])
    again = Store(tmp_path)
    assert (again.get("a"), again.get("b"), again.found) == ({"x": 0.1}, None, 1)
    assert again.seconds > 0.0
    again.clear()
    assert list(tmp_path.iterdir()) == []
    nowhere = Store()
    nowhere.put("a", 1)
    assert nowhere.get("a") is None


def test_a_folder_is_held_once(tmp_path):
    folder = tmp_path / "out"
    with lock.held(folder) as held:
        assert held == folder
        with pytest.raises(SceneError, match=f"in use by another crosscontact \\(process {os.getpid()}\\)"):
            lock.held(folder).__enter__()
        (folder / "result").write_text("")
    assert [file.name for file in folder.iterdir()] == ["result"]
    with lock.held(folder):
        pass
    with lock.held(tmp_path / "nothing comes of it"):
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
        with lock.held(tmp_path):
            os.kill(os.getpid(), signal.SIGKILL)

    killed(hold)
    assert (tmp_path / lock.FILE).exists()
    with lock.held(tmp_path):
        pass
    assert not (tmp_path / lock.FILE).exists()


def run_of(stiffness: float) -> Run:
    trace = fake(stiffness)()(CASE.scene, None, None, (), None)
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


def test_a_keeper_knows_the_time_behind_it(tmp_path):
    file = tmp_path / "kept"
    keeper = checkpoints.Keeper(file, "q", lambda: True)
    time.sleep(0.02)
    keeper.goes_on(lambda: None)
    again = checkpoints.Keeper(file, "q", lambda: True)
    assert again.seconds >= 0.02
    again.goes_on(lambda: None)
    assert checkpoints.Keeper(file, "q", lambda: True).seconds > again.seconds
