"""Files of instruments: what is read of them, what their user must state, and tables as others write them."""

from __future__ import annotations

import zipfile
from pathlib import Path

import numpy as np
import pytest

import crosscontact as cc

pytest.importorskip("afmformats", reason="the optional extra `fit` is not installed")

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


@pytest.mark.parametrize(
    ("file", "stated", "words"),
    [
        (
            "uncalibrated.jpk-force",
            {},
            "states no spring constant and no sensitivity; allowed: --spring-constant, --s",
        ),
        ("ntmdt-gel.txt", {}, "states no spring constant and no sensitivity"),
        (
            "workshop-2021.csv",
            {"spring_constant": 0.1},
            "states no times; allowed: --sampling-rate or --speed",
        ),
        ("workshop-2021.csv", {"speed": 1e-6}, "states no spring constant; allowed: --spring-constant"),
        ("four.jpk-qi-data", {}, "enum: 4 curves; allowed: one from 0 to 3"),
        ("four.jpk-qi-data", {"enum": 4}, "a number from 0 to 3"),
        ("spot3.jpk-force", {"segment": "pause"}, "has no pause; allowed: of 0 approach, 1 retract"),
        ("spot3.jpk-force", {"segment": "up"}, "allowed: approach, pause, retract, or I:J"),
    ],
)
def test_what_a_file_does_not_state_is_one_line_that_names_the_option(file, stated, words):
    with pytest.raises(cc.SceneError) as caught:
        cc.read_curve(FILES / file, **stated)
    assert words in str(caught.value)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("file", ["spot3.jpk-force", "u3-3.ibw", "four.jpk-qi-data"])
def test_half_a_file_is_one_line(file, tmp_path):
    whole = (FILES / file).read_bytes()
    half = tmp_path / file
    half.write_bytes(whole[: len(whole) // 3])
    with pytest.raises(cc.SceneError) as caught:
        cc.read_curve(half)
    assert "\n" not in str(caught.value)
    assert len(str(caught.value)) < 400


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


@pytest.mark.parametrize(
    ("text", "stated", "words"),
    [
        (
            table("time [s],stage [nm],deflection [V]", ","),
            {"spring_constant": 1.0},
            "no sensitivity; allowed: --sens",
        ),
        (table("time [s],stage [nm],force [nN]", ","), {}, "stiffness: is missing beside stage"),
        (
            table("time [s],stage [furlong],force [nN]", ",") + "",
            {"spring_constant": 1.0},
            "stage in furlong",
        ),
        (
            table(""),
            {"columns": "time=1,stage=9,force=3"},
            "stage is to be column 9; allowed: one of 1, 2, 3",
        ),
        (table(""), {"columns": "when=1"}, "HOLDS=COLUMN[:FACTOR]"),
        (table("").replace("7.0000", "1.0000"), {"columns": "time=1,penetration=2,force=3"}, "4 of 40 rows"),
    ],
)
def test_a_table_that_cannot_be_read_is_told_by_one_line(tmp_path, text, stated, words):
    (tmp_path / "a.csv").write_text(text)
    with pytest.raises(cc.SceneError) as caught:
        cc.read_curve(tmp_path / "a.csv", **stated)
    assert words in str(caught.value)
    assert "\n" not in str(caught.value)


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


def test_nanoscope_retractions_are_turned():
    pytest.importorskip("pyfmreader")
    curve = cc.read_curve(FILES / "egel.spm")
    assert curve.stiffness == pytest.approx(0.1332)
    apex = curve.segments[1].first
    assert abs(curve.force[apex] - curve.force[apex - 1]) < 0.05 * np.ptp(curve.force)
