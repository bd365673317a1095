"""Finished runs on a disk: read back bit for bit, refused or begun anew when damaged, nothing executed."""

from __future__ import annotations

import dataclasses
import io
import json
import os
import random
import sqlite3
import types
from collections.abc import Iterator
from contextlib import closing
from dataclasses import fields, is_dataclass
from enum import Enum
from pathlib import Path
from typing import Any, Union, get_args, get_origin, get_type_hints

import numpy as np
import pytest
from support.spring_solver import spring

import crosscontact as cc
from benchmarks import saved_report as saved
from contact_scene import Event, SceneError, Sphere, SurfaceProfile
from contact_scene.indenter import TabulatedProfile
from validation import cases
from validation.compare import regression
from validation.fits.model import FitRun
from validation.runs import provenance, store
from validation.runs.run import Run, read_run, write_run
from validation.runs.store import UNFINISHED, Store, dumps
from validation.studies.study import FinestReference, TimedRun

EXECUTED = b"cposix\nsystem\n(S'touch executed'\ntR."
"""A pickle: a reader that takes it for one makes the file ``executed``."""
CRASHING = b"\x80\x05\x8c\x05numpy\x8c\x07ndarray\x93(K\x01\x85\x8c\x01OC\x08AAAAAAAAtR."
"""Another: an array of objects at addresses of the file's choice."""
STRANGE = (None, True, -1, 0, 1.5, 1e400, 10**400, "", "nan", "completed", [], {}, [1.0], {"float64": "A"})


def changed(text: str, chance: random.Random) -> str:
    """A JSON text with one of its values replaced, taken away, or put under another name."""
    data = {"": json.loads(text)}
    places = list(_places(data))
    holder, key = chance.choice(places)
    match chance.randrange(4):
        case 0:
            other, place = chance.choice(places)
            holder[key] = json.loads(json.dumps(other[place]))
        case 1 if isinstance(holder, list) or len(holder) > 1:
            del holder[key]
        case 2 if isinstance(holder, dict) and holder is not data:
            holder[f"{key}_"] = holder.pop(key)
        case _:
            holder[key] = chance.choice(STRANGE)
    return json.dumps(data.get(""))


def _places(value: Any) -> Iterator[tuple[Any, Any]]:
    if isinstance(value, (dict, list)):
        for key in value if isinstance(value, dict) else range(len(value)):
            yield value, key
            yield from _places(value[key])


def with_other_bytes(data: bytes, chance: random.Random) -> bytes:
    """The same with a byte changed, a piece cut out, or one doubled."""
    first, last = sorted(chance.randrange(len(data) + 1) for _ in range(2))
    match chance.randrange(3):
        case 0:
            return data[:first] + bytes([chance.randrange(256)]) + data[first + 1 :]
        case 1:
            return data[:first] + data[last:]
    return data[:last] + data[first:]


def is_of(value: Any, kind: Any) -> bool:
    """Whether a value, down to its last part, has the declared kind."""
    origin, inner = get_origin(kind), get_args(kind)
    if origin in (Union, types.UnionType):
        return any(is_of(value, one) for one in inner)
    if kind is type(None):
        return value is None
    if origin is dict:
        return type(value) is dict and all(
            is_of(k, inner[0]) and is_of(v, inner[1]) for k, v in value.items()
        )
    if origin is tuple:
        kinds = inner[:1] * len(value) if inner[1:] == (...,) else inner
        return type(value) is tuple and len(kinds) == len(value) and all(map(is_of, value, kinds))
    if origin is np.ndarray:
        return type(value) is np.ndarray and value.dtype == np.float64
    if is_dataclass(kind):
        hints = get_type_hints(kind)
        return type(value) is kind and all(is_of(getattr(value, e.name), hints[e.name]) for e in fields(kind))
    if issubclass(kind, Enum):
        return isinstance(value, kind)
    return type(value) in ((float, int) if kind is float else (kind,))


CASE = cases.load("cycle-v0.1")
TRACE = dataclasses.replace(
    spring()(CASE.scene),
    extra={"stage": np.arange(80.0)[::2][:39]},
    events=(Event("pull-off", 1.0, -0.0, 5e-324, 1e300),),
    profiles=(SurfaceProfile(0.1, 0.2, 0.3, 0.4, *np.arange(8.0).reshape(4, 2)),),
)
MEASURES = {"loop_energy": 0.1 + 0.2, "pull_off_force": None, "wall_seconds": 0.0}
RUN = Run(CASE.name, "bem", TRACE, measures=MEASURES, errors={"force": 1e-3}, warnings=("a",))
STORED = {
    "run": (RUN, Run),
    "failed run": (Run("s", "bem", failure="no memory", details="line\nline"), Run),
    "level": (TimedRun(RUN, 3), TimedRun),
    "finest reference": ((RUN, 30, "words"), FinestReference),
    "run of a fit": (FitRun(*np.arange(12.0).reshape(4, 3), None, "why"), FitRun),
}
"""What is stored of every command, and its kind."""


def replace_answer(file: Path, text: str | bytes) -> None:
    """Put another answer under the key, with a digest that is right."""
    with closing(sqlite3.connect(file)) as connection, connection:
        digest = store._digest("key", text) if isinstance(text, str) else "0"
        connection.execute("UPDATE answers SET answer = ?, digest = ?", (text, digest))


def fuzzed(name: str, seeds: range, folder: Path) -> int:
    """Damage a stored value again and again; how often it was given back as something of its kind."""
    value, kind = STORED[name]
    with Store(folder) as kept:
        kept.put("key", value)
        for _ in range(30):
            kept.put(f"{_}", [])  # so that many a damage leaves the file one that can be opened
    file, given, said = folder / UNFINISHED, 0, []
    whole, answer = file.read_bytes(), dumps(value)
    for seed in seeds:
        chance = random.Random(seed)
        file.write_bytes(whole if seed % 4 else with_other_bytes(whole, chance))
        for ending in ("-wal", "-shm"):
            file.with_name(file.name + ending).unlink(missing_ok=True)
        if seed % 4:
            replace_answer(file, changed(answer, chance))
        try:
            with Store(folder) as kept:
                found = kept.get("key", kind)
        except SceneError as error:
            said.append(str(error))
            continue
        assert found is None or is_of(found, kind), seed
        assert seed % 4 or found is None or dumps(found) == answer, seed
        given += found is not None
    assert "\n" not in "".join(said)
    return given


@pytest.mark.parametrize("name", STORED)
def test_what_is_stored_comes_back_bit_for_bit_and_what_is_damaged_does_not(tmp_path, name):
    value, kind = STORED[name]
    with Store(tmp_path) as kept:
        kept.put("key", value)
    with Store(tmp_path) as kept:
        back = kept.get("key", kind)
    assert is_of(back, kind)
    assert dumps(back) == dumps(value)
    assert fuzzed(name, range(60), tmp_path) < 50


def fuzzed_run(seeds: range, folder: Path) -> int:
    """The same of the folder of a run."""
    write_run(folder, CASE.scene, RUN)
    files = {name: (folder / name).read_bytes() for name in ("scene.toml", "summary.json", "trace.csv")}
    given, said = 0, []
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
    write_run(tmp_path, CASE.scene, RUN)
    file = tmp_path / "summary.json"
    summary = json.loads(file.read_text())
    for key, value in {"pull_off_force": [], "warnings": "none", "counters": {"steps": 1.5}}.items():
        file.write_text(json.dumps(summary | {key: value}))
        with pytest.raises(SceneError, match=f"summary.json: {key}.*allowed: "):
            cc.load(tmp_path)


@pytest.mark.slow
def test_three_thousand_damages(tmp_path):
    for name in STORED:
        (tmp_path / name).mkdir()
        assert fuzzed(name, range(300), tmp_path / name) < 250
    assert fuzzed_run(range(700), tmp_path / "of a run") < 525


class Executing:
    def __reduce__(self):
        return os.system, ("touch executed",)


def objects() -> bytes:
    """A ``.npz`` with an array of objects, which NumPy unpickles if it may."""
    stream = io.BytesIO()
    np.savez(stream, time=np.array([Executing()], object))
    return stream.getvalue()


@pytest.mark.parametrize("content", [EXECUTED, CRASHING, objects()], ids=["pickle", "crash", "npz"])
def test_nothing_on_a_disk_is_executed(tmp_path, monkeypatch, content):
    """In place of a stored answer, of the files of a run and a report, and of the store."""
    monkeypatch.chdir(tmp_path)
    out = tmp_path / "out"
    out.mkdir()
    with Store(out) as kept:
        kept.put("key", RUN)
    replace_answer(out / UNFINISHED, content)
    with Store(out) as kept:
        assert kept.get("key", Run) is None
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
    (out / UNFINISHED).write_bytes(content)
    with pytest.raises(SceneError, match="cannot be used"):
        Store(out)
    assert not (tmp_path / "executed").exists()


def test_what_another_version_has_stored_is_begun_anew(tmp_path, monkeypatch, capsys):
    key = provenance.fingerprint("question")
    with Store(tmp_path) as kept:
        kept.put(key, 1.5)
    with Store(tmp_path) as kept:
        assert kept.get(provenance.fingerprint("question"), float) == 1.5
    assert capsys.readouterr().err == ""
    monkeypatch.setattr(provenance, "version", lambda: "0123456789")
    with Store(tmp_path) as kept:
        assert kept.get(provenance.fingerprint("question"), float) is None
    said = capsys.readouterr().err
    assert said == f"crosscontact: starting anew: {tmp_path / UNFINISHED} is of another version\n"


def test_questions_are_told_apart():
    """By every number, not by the file of a table nor by what follows from it."""
    scene = CASE.scene
    nudged = dataclasses.replace(scene, indenter=Sphere(np.nextafter(1.0, 2.0)))
    tables = [
        dataclasses.replace(scene, indenter=TabulatedProfile((0.0, 1.0, 2.0), heights, file))
        for heights, file in (((0.0, 0.5, 2.0), "a"), ((0.0, 0.5, 2.1), "a"), ((0.0, 0.5, 2.0), "b"))
    ]
    asked = [("solve", one, 8) for one in (scene, nudged, *tables[:2])] + [("solve", scene, None)]
    assert len({provenance.fingerprint(*parts) for parts in asked}) == len(asked)
    assert provenance.fingerprint(tables[0]) == provenance.fingerprint(tables[2])
    with pytest.raises(TypeError):
        provenance.fingerprint(object())


def test_an_interrupted_command_finds_what_is_done(tmp_path):
    """Also where its store is still open; nothing is kept without a folder."""
    left_open, numbers = Store(tmp_path), dict[str, float]
    assert not list(tmp_path.iterdir())
    left_open.put("a", {"x": 0.1})
    again = Store(tmp_path)
    assert (again.get("a", numbers), again.get("b", numbers), again.taken_over) == ({"x": 0.1}, None, 1)
    assert again.holds_answers
    assert again.seconds > 0.0
    again.put("b", {"x": 0.2})
    assert not Store(tmp_path, fresh=True).holds_answers
    again.clear()
    assert not list(tmp_path.iterdir())
    nowhere = Store()
    nowhere.put("a", 1)
    assert nowhere.get("a", int) is None
