"""Traces as files: every bit comes back, the file is whole or absent."""

from __future__ import annotations

import dataclasses
import errno
import os

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

import contact_scene as cs
from contact_scene.files import write_whole


def trace(table, **extra):
    return cs.Trace(
        solver="by hand",
        **dict(zip(cs.COLUMNS, table, strict=True)),
        outcome=cs.Outcome(cs.OutcomeKind.COMPLETED, "end of the loading", 1.0),
        counters=cs.Counters(),
        extra=extra,
    )


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """One folder for all examples."""
    return tmp_path_factory.mktemp("traces")


@given(st.integers(0, 5).flatmap(lambda n: arrays(float, (8, n), elements=st.floats(allow_nan=False))))
def test_every_bit_comes_back(folder, table):
    run = trace(table[:7], stress_intensity=table[7])
    cs.write_trace(run, folder / "trace.csv")
    back = cs.read_columns(folder / "trace.csv")
    assert list(back) == [*cs.COLUMNS, "stress_intensity"]
    for name, column in run.columns().items():
        assert back[name].tobytes() == column.tobytes(), name
    assert [path.name for path in folder.iterdir()] == ["trace.csv"]


def test_header_and_first_row(tmp_path):
    cs.write_trace(trace(np.arange(14.0).reshape(7, 2) / 10), tmp_path / "trace.csv")
    assert (tmp_path / "trace.csv").read_text().splitlines()[:2] == [
        "time,penetration,force,contact_radius,stored_energy,external_work,dissipated_energy",
        "0.0,0.2,0.4,0.6,0.8,1.0,1.2",
    ]


def test_columns_of_unequal_length_write_nothing(tmp_path):
    run = trace(np.zeros((7, 3)))
    with pytest.raises(cs.SceneError, match=r"extra\['short'\]: has shape \(2,\); allowed: shape \(3,\)"):
        dataclasses.replace(run, extra={"short": np.zeros(2)})
    run.extra["short"] = np.zeros(2)
    with pytest.raises(ValueError, match="shorter"):
        cs.write_trace(run, tmp_path / "trace.csv")
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    ("text", "match"),
    [
        ("", "no column time"),
        ("time,force\n1,2\n", "no column penetration"),
        (",".join(cs.COLUMNS) + "\n1,2,3\n", "line 2 has 3 cells"),
        (",".join(cs.COLUMNS) + "\n1,2,3,4,5,6,x\n", "could not convert"),
    ],
)
def test_bad_files(tmp_path, text, match):
    (tmp_path / "trace.csv").write_text(text)
    with pytest.raises(ValueError, match=match):
        cs.read_columns(tmp_path / "trace.csv")


def test_a_failed_write_keeps_the_old_file_and_leaves_nothing(tmp_path):
    path = tmp_path / "text"
    write_whole(path, "old")
    with pytest.raises(UnicodeEncodeError):
        write_whole(path, "new \ud800")
    assert path.read_text() == "old"
    assert [entry.name for entry in tmp_path.iterdir()] == ["text"]


def test_a_device_or_a_pipe_is_not_replaced(tmp_path):
    os.mkfifo(tmp_path / "pipe")
    for path in (tmp_path / "pipe", ""):
        with pytest.raises(OSError, match="is not the name of a regular file"):
            write_whole(path, "text")
    assert (tmp_path / "pipe").is_fifo()
    assert [entry.name for entry in tmp_path.iterdir()] == ["pipe"]


def test_a_full_disk_is_told_with_the_name_of_the_file(tmp_path, monkeypatch):
    def full(descriptor):
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr(os, "fsync", full)
    with pytest.raises(OSError, match=f"No space left on device: '{tmp_path / 'text'}'"):
        write_whole(tmp_path / "text", "new")
