"""What is kept on disk: read back bit for bit, refused when damaged or foreign, never half-written."""

from __future__ import annotations

import dataclasses
import errno
import hashlib
import io
import json
import os
import random
import signal
import sqlite3
from contextlib import closing
from pathlib import Path

import numpy as np
import pytest
from support.damage import CRASHING, EXECUTED, changed, is_of, with_other_bytes
from support.spring_solver import spring

import crosscontact as cc
from benchmarks import saved_report as saved
from contact_scene import Event, SceneError, Sphere, SurfaceProfile, read_columns
from contact_scene.indenter import TabulatedProfile
from validation import cases
from validation.compare import regression
from validation.fits.fit_run import FitRun
from validation.runs import files, folder_lock, provenance
from validation.runs.run import Run
from validation.runs.run_folder import read_run, write_run
from validation.runs.run_table import Columns, RunRecord, RunTable, StoredRun
from validation.runs.store import Store, dumps
from validation.stability.case_runs import CaseAnswer
from validation.studies.convergence import LevelRun
from validation.studies.ladders import Level
from validation.studies.schemes import Settings
from validation.studies.study import FinestReference
from validation.studies.zones import MeasuredRun

CASE = cases.load("cycle-v0.1")


TRACE = dataclasses.replace(
    spring()(CASE.scene),
    extra={"stage": np.arange(80.0)[::2][:39]},
    events=(Event("pull-off", 1.0, -0.0, 5e-324, 1e300),),
    profiles=(SurfaceProfile(0.1, 0.2, 0.3, 0.4, *np.arange(8.0).reshape(4, 2)),),
)
MEASURES = {"loop_energy": 0.1 + 0.2, "pull_off_force": None, "wall_seconds": 0.0}
RUN = Run(CASE.name, "bem", TRACE, measures=MEASURES, errors={"force": 1e-3}, warnings=("a",))
LEVEL = LevelRun(Level(0.5, "8", Settings(8)), {"a": None}, {"b": np.float64(0.1)}, {"steps": 3})
STORED = {
    "run": (RUN, Run),
    "failed run": (Run("s", "bem", failure="no memory", details="line\nline"), Run),
    "measured run": (MeasuredRun(RUN, 10**9), MeasuredRun),
    "level": (LEVEL, LevelRun),
    "finest reference": ((TRACE, 30, "words"), FinestReference),
    "answer of a case": (CaseAnswer(TRACE, seconds=0.5), CaseAnswer),
    "run of a fit": (FitRun(*np.arange(12.0).reshape(4, 3), None, "why"), FitRun),
}
"""What is stored of every command, and its kind."""


@pytest.mark.parametrize("name", STORED)
def test_what_is_stored_comes_back_bit_for_bit(tmp_path, name):
    value, kind = STORED[name]
    Store(tmp_path).put("key", value)
    back = Store(tmp_path).get("key", kind)
    assert is_of(back, kind)
    assert dumps(back) == dumps(value)


def fuzzed(name: str, seeds: range, folder: Path) -> int:
    """Damage a stored value again and again; how often it was given back as something of its kind."""
    value, kind = STORED[name]
    store = Store(folder)
    store.put("key", value)
    file = folder / ".unfinished/key"
    whole = file.read_bytes()
    header, answer = whole.decode().splitlines()[1:]
    given = 0
    for seed in seeds:
        chance = random.Random(seed)
        if seed % 4 == 0:
            file.write_bytes(with_other_bytes(whole, chance))
        else:  # with a digest that is right
            body = f"{header}\n{changed(answer, chance)}"
            file.write_text(f"{hashlib.sha256(body.encode()).hexdigest()}\n{body}")
        found = store.get("key", kind)
        assert found is None or is_of(found, kind), seed
        given += found is not None
    return given


@pytest.mark.parametrize("name", STORED)
def test_what_is_damaged_is_begun_anew(tmp_path, name):
    assert fuzzed(name, range(100), tmp_path) < 70


def fuzzed_run(seeds: range, folder: Path) -> int:
    """The same of the folder of a run."""
    write_run(folder, CASE.scene, RUN)
    files = {name: (folder / name).read_bytes() for name in ("scene.toml", "summary.json", "trace.csv")}
    said, given = [], 0
    for seed in seeds:
        chance = random.Random(seed)
        for name, content in files.items():
            (folder / name).write_bytes(content)
        if seed % 2:
            name = chance.choice(list(files))
            (folder / name).write_bytes(with_other_bytes(files[name], chance))
        else:
            (folder / "summary.json").write_text(changed(files["summary.json"].decode(), chance))
        try:
            _, found = read_run(folder)
        except SceneError as error:
            said.append(str(error))
            continue
        assert is_of(found, Run), seed
        given += 1
    assert "\n" not in "".join(said)
    return given


def test_a_damaged_folder_of_a_run_is_refused(tmp_path):
    assert fuzzed_run(range(200), tmp_path) < 150


def fuzzed_table(seeds: range, folder: Path) -> int:
    """The same of the runs of a sweep: their records, traces, and the bytes of the file."""
    record = RunRecord("completed", "", True, {"a": 0.1, "b": 5e-324}, {"a": 0.2}, ("c",), 3)
    with RunTable(folder) as table:
        table.put([StoredRun(str(n), record, 0.5, {"time": np.arange(3.0)}) for n in range(30)])
    file, said, given = folder / "runs.sqlite", [], 0
    whole, cells = file.read_bytes(), (dumps(record), dumps({"time": np.arange(3.0)}))
    for seed in seeds:
        chance = random.Random(seed)
        file.write_bytes(whole if seed % 2 else with_other_bytes(whole, chance))
        for ending in ("-wal", "-shm"):
            file.with_name(file.name + ending).unlink(missing_ok=True)
        if seed % 2:
            with closing(sqlite3.connect(file)) as connection, connection:
                connection.execute("UPDATE runs SET record = ?", (changed(cells[0], chance),))
                connection.execute("UPDATE traces SET columns = ?", (changed(cells[1], chance),))
        try:
            with RunTable(folder) as table:
                for key in map(str, range(30)):
                    found, columns = table.record(key), table.columns(key)
                    assert found is None or is_of(found, RunRecord), seed
                    assert columns is None or is_of(columns, Columns), seed
                    assert table.holds(key, trace=True) == (
                        found is not None and (found.rows == 0 or columns is not None)
                    )
                    given += found is not None
        except SceneError as error:
            said.append(str(error))
    assert "\n" not in "".join(said)
    return given


def test_a_damaged_table_of_runs_is_refused_or_begun_anew(tmp_path):
    assert 0 < fuzzed_table(range(60), tmp_path) < 1200


@pytest.mark.slow
def test_ten_thousand_damages(tmp_path):
    for name in STORED:
        (tmp_path / name).mkdir()
        fuzzed(name, range(1000), tmp_path / name)
    fuzzed_run(range(2000), tmp_path / "of a run")
    (tmp_path / "of a sweep").mkdir()
    fuzzed_table(range(1000), tmp_path / "of a sweep")


def objects() -> bytes:
    """A ``.npz`` with an array of objects, which NumPy unpickles if it may."""
    stream = io.BytesIO()
    np.savez(stream, time=np.array([Executing()], object))
    return stream.getvalue()


class Executing:
    def __reduce__(self):
        return os.system, ("touch executed",)


@pytest.mark.parametrize("content", [EXECUTED, CRASHING, objects()], ids=["pickle", "crash", "npz"])
def test_nothing_on_a_disk_is_executed(tmp_path, monkeypatch, content):
    """In place of a stored answer, of the files of a run and a report, and of a trace of a sweep."""
    monkeypatch.chdir(tmp_path)
    out = tmp_path / "out"
    out.mkdir()
    Store(out).put("key", RUN)
    for name in ("key", ".version"):
        (out / ".unfinished" / name).write_bytes(content)
        assert Store(out).get("key", Run) is None
    for name in ("scene.toml", "summary.json", "trace.csv"):
        write_run(out, CASE.scene, RUN)
        (out / name).write_bytes(content)
        with pytest.raises(SceneError):
            cc.load(out)
    (out / "report.json").write_bytes(content)
    for source in (out, out / "report.json"):
        with pytest.raises(SceneError):
            saved.read(source)
    with pytest.raises(SceneError):
        regression.read(str(out / "report.json"))
    with RunTable(out) as table:
        table.put([StoredRun("key", RunRecord("completed", "", rows=1), 0.5, {"time": np.arange(1.0)})])
        table._connection.execute("UPDATE runs SET record = ?", (content,))
        table._connection.execute("UPDATE traces SET columns = ?", (content,))
        assert (table.record("key"), table.columns("key")) == (None, None)
    (out / "runs.sqlite").write_bytes(content)
    with pytest.raises(SceneError):
        RunTable(out)
    assert not (tmp_path / "executed").exists()


def test_a_value_of_a_wrong_type_is_told_by_its_key(tmp_path):
    write_run(tmp_path, CASE.scene, RUN)
    file = tmp_path / "summary.json"
    summary = json.loads(file.read_text())
    for key, value in {"pull_off_force": [], "warnings": "none", "counters": {"steps": 1.5}}.items():
        file.write_text(json.dumps(summary | {key: value}))
        with pytest.raises(SceneError, match=f"summary.json: {key}.*allowed: "):
            cc.load(tmp_path)


def test_what_another_version_has_stored_is_begun_anew(tmp_path, monkeypatch, capsys):
    Store(tmp_path).put("key", 1.5)
    with RunTable(tmp_path) as table:
        table.put([StoredRun("key", RunRecord("completed", ""), 0.5)])
    assert Store(tmp_path).get("key", float) == 1.5
    RunTable(tmp_path).close()
    assert capsys.readouterr().err == ""
    monkeypatch.setattr(provenance, "version", lambda: "0123456789")
    assert Store(tmp_path).get("key", float) is None
    RunTable(tmp_path).close()
    assert capsys.readouterr().err.splitlines() == [
        f"crosscontact: starting anew: {tmp_path / name} is of another version"
        for name in (".unfinished", "runs.sqlite")
    ]


def test_questions_are_told_apart():
    scene = CASE.scene
    nudged = dataclasses.replace(scene, indenter=Sphere(np.nextafter(1.0, 2.0)))
    asked = [("solve", scene, 8), ("solve", scene, None), ("solve", nudged, 8), ("run", scene, 8)]
    assert len({provenance.fingerprint(*parts) for parts in asked}) == len(asked)
    assert provenance.fingerprint("solve", scene, 8) == provenance.fingerprint(
        "solve", dataclasses.replace(scene), 8
    )
    with pytest.raises(TypeError):
        provenance.fingerprint(object())


def test_tabulated_indenters_have_a_fingerprint():
    """They carry an interpolating curve, which follows from the table and is no part of the fingerprint."""
    tables = [
        TabulatedProfile((0.0, 1.0, 2.0), heights, file)
        for heights, file in (((0.0, 0.5, 2.0), "a"), ((0.0, 0.5, 2.0), "b"), ((0.0, 0.5, 2.1), "a"))
    ]
    one, same, other = (
        provenance.fingerprint(dataclasses.replace(CASE.scene, indenter=table)) for table in tables
    )
    assert one == same != other


def test_another_version_of_the_program_asks_another_question(monkeypatch):
    before = provenance.fingerprint(CASE.scene)
    monkeypatch.setattr(provenance, "version", lambda: "another")
    assert provenance.fingerprint(CASE.scene) != before


def test_a_store_takes_over_what_is_whole(tmp_path):
    store = Store(tmp_path)
    numbers = dict[str, float]
    assert store.get("a", numbers) is None
    store.put("a", {"x": 0.1})
    store.put("b", {"x": 0.2})
    broken = next((tmp_path / ".unfinished").glob("b"))
    broken.write_bytes(broken.read_bytes()[:-2])
    again = Store(tmp_path)
    assert (again.get("a", numbers), again.get("b", numbers), again.taken_over) == ({"x": 0.1}, None, 1)
    assert again.seconds > 0.0
    again.clear()
    assert list(tmp_path.iterdir()) == []
    nowhere = Store()
    nowhere.put("a", 1)
    assert nowhere.get("a", int) is None


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
            files.move_whole(stage, tmp_path / "folder")
        return
    monkeypatch.setattr(os, "write", full)
    monkeypatch.setattr(Path, "write_text", full)
    with folder_lock.locked_folder(tmp_path):
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
