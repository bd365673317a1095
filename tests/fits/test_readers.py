"""Files of instruments: what is read of them, what their user must state, and tables as others write them."""

from __future__ import annotations

import subprocess
import sys
import zipfile
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from support.recorded import elastic_scene, hertz_curve

import crosscontact as cc
from contact_scene import SceneError, write_scene
from validation.fits.readers import write_afm

afmformats = pytest.importorskip("afmformats", reason="the optional extra `fit` is not installed")
h5py = pytest.importorskip("h5py", reason="the optional extra `fit` is not installed")

FILES = Path(__file__).parents[2] / "docs" / "data" / "curves"
CSV = {"spring_constant": 0.1, "speed": 1e-6}
RECORDED = [
    ("spot3.jpk-force", {}, 4000, 0.0435, 5.008, 4.670, 1.9995, "approach retract"),
    ("flipsign.jpk-force", {}, 14000, 0.0187, 50.01, 5.069, 6.9995, "approach retract"),
    ("force-save-example.jpk-force", {}, 8400, 0.0223, 30.03, 6.331, 4.1995, "approach retract"),
    ("polymergel.jpk-force", {}, 9000, 0.061, 30.25, 22.08, 8.999, "approach pause retract"),
    ("brain.jpk-force", {}, 9000, 0.061, 31.59, 17.31, 8.999, "approach pause retract"),
    ("cell.jpk-force", {}, 11935, 1.068, 20.03, 422.9, 32.95, "pause approach pause retract"),
    (
        "uncalibrated.jpk-force",
        {"spring_constant": 0.05, "sensitivity": 6e-8},
        4096,
        0.05,
        50.0,
        0.847,
        19.995,
        "approach retract",
    ),
    ("four.jpk-qi-data", {"enum": 0}, 600, 0.0301, 1.332, 0.3805, 0.0559, "approach retract"),
    ("silicon-nitride.ibw", {}, 2016, 1.184, 0.2139, 22.89, 1.0075, "approach retract"),
    ("u3-3.ibw", {}, 10097, 0.3145, 7.448, 206.8, 5.048, "approach retract"),
    ("workshop-2020.csv", CSV, 2030, 0.1, 3.38, 3860.0, 6.76, "approach retract"),
    ("workshop-2021.csv", CSV, 2434, 0.1, 1.216, 0.0317, 2.432, "approach retract"),
    ("ntmdt-gel.txt", CSV | {"sensitivity": 1e-7}, 1644, 0.1, 6.575, 3.258e-8, 13.15, "approach retract"),
    ("chiaro.zip", {}, 13827, 0.019, 88.65, 66.37, 13.83, "approach retract"),
]


@pytest.mark.parametrize(
    ("file", "stated", "rows", "spring", "travel", "force", "duration", "kinds"), RECORDED
)
def test_what_is_read_of_an_instruments_file(file, stated, rows, spring, travel, force, duration, kinds):
    curve = cc.read_curve(FILES / file, **stated)
    found = curve.stiffness, np.ptp(curve.stage), np.ptp(curve.force), np.ptp(curve.time)
    assert curve.time.size == rows
    assert found == pytest.approx((spring, 1e-6 * travel, 1e-9 * force, duration), rel=4e-3)
    assert " ".join(one.kind for one in curve.segments) == kinds
    pressed = curve.force > np.median(curve.force) + 0.6 * (curve.force.max() - np.median(curve.force))
    assert curve.stage[pressed].mean() > curve.stage.mean()  # positions grow into the sample


def test_a_number_given_goes_before_that_of_the_file():
    stated, halved = (
        cc.read_curve(FILES / "spot3.jpk-force", spring_constant=k) for k in (None, 0.5 * 0.0434943)
    )
    assert halved.force == pytest.approx(0.5 * stated.force, rel=1e-4)
    slow = cc.read_curve(FILES / "silicon-nitride.ibw", sampling_rate=20.0)
    assert slow.time[-1] == pytest.approx(2015 / 20.0)


@pytest.mark.parametrize(
    ("segment", "first", "last"), [("retract", 6000, 9000), ("1:", 3000, 9000), ("0:1", 0, 3000)]
)
def test_a_segment_by_its_kind_or_numbers(segment, first, last):
    whole = cc.read_curve(FILES / "polymergel.jpk-force")
    part = cc.read_curve(FILES / "polymergel.jpk-force", segment=segment)
    assert np.array_equal(part.force, whole.force[first:last])


ROWS = np.column_stack([np.arange(40.0), 10.0 * np.arange(40.0), 2.0 * np.arange(40.0)])
"""Seconds, nanometres of the stage, nanometres of deflection or nanonewtons."""


def table(head, sign="\t", comma=".", end="\n"):
    lines = [sign.join(f"{number:.4f}" for number in row).replace(".", comma) for row in ROWS]
    return end.join([*head.split("\n"), *lines, ""])


@pytest.mark.parametrize(
    ("text", "stated"),
    [
        (table("time [s],stage [nm],force [nN]", ",") + "# spring constant", {"spring_constant": 0.5}),
        (table("# spring constant: 500 pN/nm\ntime [s];stage [nm];force [nN]", ";", ","), {}),
        (table("# stiffness = 0.5\nTime (s)\tZ (nm)\tForce (nN)"), {}),
        (table("k (N/m)\t0.5\n\nTime (s)\tPiezo (nm)\tLoad (nN)", comma=","), {}),
        (table("k [mN/m] = 500\ntime [s]\tz [nm]\tF [nN]", end="\r"), {}),
        (
            table(
                "lab 3\n\nPiezo position[nm]\tdummy\tF [nN]\neoh".replace("Piezo", "t [s]\tPiezo").replace(
                    "dummy\t", ""
                )
            ),
            {"spring_constant": 0.5},
        ),
        (table(""), {"spring_constant": 0.5, "columns": "time=1,stage=2:1e-9,force=3:1e-9"}),
        (
            table("when\twhere\thow much"),
            {
                "spring_constant": 0.5,
                "columns": {"time": "when", "stage": ("where", 1e-9), "force": (3, 1e-9)},
            },
        ),
        (table("time [s],stage [nm],deflection [nm]", ","), {"spring_constant": 1.0, "check": 1.0}),
        (
            table("time [s],stage [nm],deflection [mV]", ","),
            {"spring_constant": 1.0, "sensitivity": 1e-6, "check": 1.0},
        ),
    ],
)
def test_a_table_as_others_write_it(tmp_path, text, stated):
    (tmp_path / "a.txt").write_bytes(text.encode("cp1252"))
    spring = stated.pop("check", 0.5)
    curve = cc.read_curve(tmp_path / "a.txt", **stated)
    assert curve.stiffness == pytest.approx(spring)
    for column, rows in (("time", ROWS[:, 0]), ("stage", 1e-9 * ROWS[:, 1]), ("force", 1e-9 * ROWS[:, 2])):
        assert getattr(curve, column) == pytest.approx(rows)


def test_heights_grow_away_and_units_stay_labels_of_the_scene(tmp_path):
    (tmp_path / "a.csv").write_text(table("# stiffness = 0.5\ntime [s],height [nm],force [nN]", ","))
    assert cc.read_curve(tmp_path / "a.csv").stage == pytest.approx(-1e-9 * ROWS[:, 1])
    (tmp_path / "b.csv").write_text(table("# stiffness = 0.5\ntime [s],stage [nm],force [nN]", ","))
    [curve] = cc.read_curves(tmp_path / "b.csv")
    assert curve.stage == pytest.approx(ROWS[:, 1])


def test_rows_without_numbers_and_times_twice_are_left_out(tmp_path):
    text = (
        table("time [s],stage [nm],force [nN]", ",")
        .replace("\n7.0000,", "\n6.0000,")
        .replace("\n9.0000,", "\nnan,")
    )
    (tmp_path / "a.csv").write_text(text)
    assert cc.read_curve(tmp_path / "a.csv", spring_constant=1.0).time.tolist() == [
        *range(7),
        8,
        *range(10, 40),
    ]


def test_an_archive_holds_files_of_any_format(tmp_path):
    with zipfile.ZipFile(tmp_path / "a.zip", "w") as archive:
        archive.write(FILES / "spot3.jpk-force", "folder/one.jpk-force")
        archive.writestr("two.csv", table("# stiffness = 0.5\ntime [s],stage [nm],force [nN]", ","))
    assert [cc.read_curve(tmp_path / "a.zip", enum=n).name for n in (0, 1)] == ["one", "two"]


def test_asylum_may_write_one_channel_a_file(tmp_path, monkeypatch):
    """The channels lie beside each other, and the deflection is in metres."""
    stage = np.concatenate([np.linspace(0.0, 1e-6, 50), np.linspace(1e-6, 0.0, 50)])
    channels = {"aDefl": 0.1 * stage, "aZSnsr": stage}
    for name in channels:
        (tmp_path / f"{name}.ibw").write_bytes(b"a wave")
    note = b"SpringConstant: 0.5\rNumPtsPerSec: 10\rInvOLS: 1e-7\rIndexes: 0,50,99"
    waves = {f"{name}.ibw": {"note": note, "wData": data} for name, data in channels.items()}
    monkeypatch.setattr("igor2.binarywave.load", lambda path: {"wave": waves[path.name]})
    curve = cc.read_curve(tmp_path / "aDefl.ibw")
    assert curve.stage == pytest.approx(stage)
    assert curve.force == pytest.approx(0.05 * stage)
    assert curve.time[-1] == pytest.approx(9.9)
    assert [one.kind for one in curve.segments] == ["approach", "retract"]
    twice = cc.read_curve(tmp_path / "aDefl.ibw", sensitivity=2e-7)
    assert twice.force == pytest.approx(2.0 * curve.force)


def test_nanoscope_retractions_are_turned():
    pytest.importorskip("pyfmreader")
    curve = cc.read_curve(FILES / "egel.spm")
    assert curve.stiffness == pytest.approx(0.1332)
    apex = curve.segments[1].first
    assert abs(curve.force[apex] - curve.force[apex - 1]) < 0.05 * np.ptp(curve.force)


def refusal(path):
    """The one line with which a file is refused, without its name."""
    with pytest.raises(SceneError) as caught:
        cc.read_curves(path)
    line = str(caught.value)
    assert line.startswith(f"{path}: ")
    assert "\n" not in line
    return line.removeprefix(f"{path}: ")


@pytest.mark.slow
def test_the_log_of_afmformats_stays_off_stderr(tmp_path):
    file, scene = tmp_path / "a.ibw", tmp_path / "scene.toml"
    file.write_bytes(b"no wave")
    write_scene(elastic_scene(), scene)
    command = ["-m", "crosscontact", "fit", str(file), str(scene), "--vary", "material.modulus"]
    # In a process of its own, whose log has no handlers: those of pytest would take what goes to stderr.
    ended = subprocess.run([sys.executable, *command], capture_output=True, text=True)
    assert ended.returncode == 2
    assert len(ended.stderr.splitlines()) == 1
    assert "cannot be read: ValueError invalid binary wave version" in ended.stderr


@pytest.mark.parametrize(
    ("column", "unit", "kind", "told"),
    [
        ("force", "nN", float, "is in nN; allowed: N"),
        ("tip position", b"nm", float, "is in nm; allowed: m"),
        ("time", "ms", float, "is in ms; allowed: s"),
        ("force", "N", np.complex128, "holds complex128"),
        ("force", "N", np.bool_, "holds bool"),
        ("force", b"N", float, ""),
        ("force", "", float, ""),
    ],
)
def test_columns_in_other_units_or_of_no_real_numbers_are_refused(tmp_path, column, unit, kind, told):
    file = tmp_path / "a.h5"
    write_afm(hertz_curve(), file)
    with h5py.File(file, "r+") as opened:
        values = opened["0"][column][:].astype(kind)
        del opened["0"][column]
        opened["0"][column] = values
        opened["0"][column].attrs["unit"] = unit
    if told:
        assert refusal(file).startswith(f"0/{column}: {told}")
    else:
        assert len(cc.read_curves(file)) == 1


@pytest.mark.parametrize("column", ["force", "segment"])
def test_a_column_that_is_shorter_than_the_others_is_refused(tmp_path, column):
    file = tmp_path / "a.h5"
    write_afm(hertz_curve(), file)
    with h5py.File(file, "r+") as opened:
        values, unit = opened["0"][column][:-5], opened["0"][column].attrs["unit"]
        del opened["0"][column]
        opened["0"][column] = values
        opened["0"][column].attrs["unit"] = unit
    assert refusal(file)


@pytest.mark.parametrize("ending", ["csv", "h5", "tab", "H5", "Tab"])
@pytest.mark.parametrize("stiffness", [None, 0.3])
def test_a_curve_that_is_written_comes_back(tmp_path, ending, stiffness):
    """A table bit for bit; the text format of AFM programs has eight digits or so."""
    file, curve, more = tmp_path / f"one.{ending}", hertz_curve(), {"noise": 1e-4, "indenter_radius": 2.0}
    stage = (
        {} if stiffness is None else {"stage": curve.motion + curve.force / stiffness, "penetration": None}
    )
    curve = replace(curve, **stage, stiffness=stiffness, contact_radius=curve.motion, **more)
    cc.write_curve(curve, file)
    [back] = cc.read_curves(file)
    assert (back.name, back.stiffness) == ("one", stiffness)
    for column in ("time", "force", "motion"):
        assert np.allclose(getattr(back, column), getattr(curve, column), rtol=1e-6, atol=1e-8)
    if ending == "csv":
        assert {name: getattr(back, name) for name in more} == more
        assert all(np.array_equal(values, back.columns()[name]) for name, values in curve.columns().items())
    else:
        file.write_bytes(b"nothing that is known")
        assert f"a .{ending.lower()} of a force microscope" in refusal(file)


def test_a_file_that_is_cut_off_is_refused(tmp_path):
    """Cells that are missing would be read as 0."""
    file = tmp_path / "a.tab"
    write_afm(hertz_curve(), file)
    lines = file.read_text().splitlines()
    first = next(k for k, line in enumerate(lines) if line[0] != "#")
    cells = lines[first + 30].split("\t")
    short, cut = "\t".join(cells[:2]), "\t".join([*cells[:3], cells[3][:4]])
    for last in ([short], [cut], [short, *lines[first + 31 :], ""]):  # the second is another number
        file.write_text("\n".join([*lines[: first + 30], *last]))
        assert "whole rows of 120" in refusal(file)
    file.write_text("\n".join(lines))  # whole but for the last end of a line
    assert len(cc.read_curves(file)) == 1


@pytest.mark.parametrize("interruption", [KeyboardInterrupt, SystemExit])
def test_an_interruption_while_a_file_is_read_goes_on(tmp_path, monkeypatch, interruption):
    def interrupted(path, **options):
        raise interruption

    write_afm(hertz_curve(), tmp_path / "a.h5")
    monkeypatch.setattr(afmformats, "load_data", interrupted)
    with pytest.raises(interruption):
        cc.read_curves(tmp_path / "a.h5")
