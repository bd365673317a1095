"""What cannot be read or fitted is refused in one line that names the file and what would help."""

from __future__ import annotations

import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from support.recorded import GUESS, elastic_scene, hertz_curve, settings_of

import crosscontact as cc
from contact_scene import (
    Adhesion,
    Loading,
    Machine,
    Ramp,
    SceneError,
    write_scene,
)
from crosscontact.cli import main
from validation.fits.fit import fit_curves
from validation.fits.readers import write_csv
from validation.fits.record import MeasuredCurve

FILES = Path(__file__).parents[2] / "docs" / "data" / "curves"
COLUMNS = {count: "\n".join(",".join([str(k)] * count) for k in range(40)) for count in (2, 3)}
"""Rows of numbers that rise."""
FALLING = "\n".join(f"{k},{k},{(k - 9) ** 2}" for k in range(40))
OPENED = {"spring_constant": 1.0}


def one_line(call, *arguments, **options):
    """The one line with which something is refused."""
    with pytest.raises(SceneError) as caught:
        call(*arguments, **options)
    line = str(caught.value)
    assert "\n" not in line
    assert len(line) < 400
    return line


TABLES = [  # text of a table, how it is read in SI units, if it is; what the line names
    (f"time,force\n{COLUMNS[2]}", None, "stage"),
    ("penetration,force\n", None, "rows"),
    (f"time,penetration,force\n0,0,nan\n{COLUMNS[3]}", None, "force, line 2"),
    ("time,penetration,force\n0,0\n", None, "line 1"),
    ("time,penetration,force\n0,0,x\n", None, "'x'"),
    (f"time,stage,force\n{COLUMNS[3]}", None, "stiffness"),
    ("time,penetration,force\n0,0,0\n1,1,1\n", None, "at least 20"),
    (f"force,penetration,time\n{FALLING}", None, "swapped?"),
    ("time,time,force\n1,2,3\n", None, "time"),
    ("# noise = 1\ntime [s];stage [m];force [N]\n0,1;0;0\n", None, "decimal commas"),
    (f"time [s],stage [nm],deflection [V]\n{COLUMNS[3]}", OPENED, "--sensitivity"),
    (f"time [s],stage [nm],force [nN]\n{COLUMNS[3]}", {}, "stiffness"),
    (f"time [s],stage [furlong],force [nN]\n{COLUMNS[3]}", OPENED, "furlong"),
    (COLUMNS[3], {"columns": "time=1,stage=9,force=3"}, "column 9"),
    (COLUMNS[3], {"columns": "when=1"}, "HOLDS=COLUMN"),
    (FALLING, {"columns": "time=3,penetration=2,force=1"}, "18 of 40 rows"),
]


@pytest.mark.parametrize(("text", "stated", "named"), TABLES)
def test_a_table_that_is_no_record(tmp_path, text, stated, named):
    file = tmp_path / "bad.csv"
    file.write_text(text)
    read = cc.read_curves if stated is None else cc.read_curve
    line = one_line(read, file, **stated or {})
    assert named in line
    assert line.startswith(str(file)) or "HOLDS" in line  # what is stated wrongly is in no file


RECORDED = [  # file, what is stated, the option that the line names
    ("uncalibrated.jpk-force", {}, "--spring-constant, --sensitivity"),
    ("ntmdt-gel.txt", {}, "--spring-constant, --sensitivity"),
    ("workshop-2021.csv", {"spring_constant": 0.1}, "--sampling-rate or --speed"),
    ("workshop-2021.csv", {"speed": 1e-6}, "--spring-constant"),
    ("four.jpk-qi-data", {}, "enum: 4 curves; allowed: one from 0 to 3"),
    ("four.jpk-qi-data", {"enum": 4}, "a number from 0 to 3"),
    ("spot3.jpk-force", {"segment": "pause"}, "0 approach, 1 retract"),
    ("spot3.jpk-force", {"segment": "up"}, "approach, pause, retract, or I:J"),
]


@pytest.mark.parametrize(("file", "stated", "named"), RECORDED)
def test_what_a_file_does_not_state_names_the_option(file, stated, named):
    pytest.importorskip("afmformats", reason="the optional extra `fit` is not installed")
    assert named in one_line(cc.read_curve, FILES / file, **stated)


@pytest.mark.parametrize("ending", ["h5", "tab", "ibw", "jpk-force", "jpk-force-map", "jpk-qi-data"])
def test_a_file_that_is_cut_off_or_damaged_or_empty(tmp_path, ending):
    """Two thirds of a recorded file are missing, or it never was one."""
    pytest.importorskip("afmformats", reason="the optional extra `fit` is not installed")
    whole = {"ibw": "u3-3.ibw", "jpk-force": "spot3.jpk-force", "jpk-qi-data": "four.jpk-qi-data"}.get(ending)
    data = (FILES / whole).read_bytes() if whole else b""
    file = tmp_path / f"a.{ending}"
    for content in (data[: len(data) // 3], np.random.default_rng(1).bytes(5000), b""):
        file.write_bytes(content)
        assert one_line(cc.read_curves, file).startswith(f"{file}: ")
    file.unlink()
    assert "No such file" in one_line(cc.read_curves, file)
    file.mkdir()
    assert "is a folder" in one_line(cc.read_curves, file)


def test_without_the_extra_a_file_of_an_instrument_names_it(tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "afmformats", None)
    (tmp_path / "a.txt").write_text("Device:\tChiaro\n")
    with pytest.raises(ImportError, match="afmformats is not installed: pip install"):
        cc.read_curves(tmp_path / "a.txt")
    write_csv(hertz_curve(), tmp_path / "a.txt")  # a table needs none
    assert len(cc.read_curves(tmp_path / "a.txt")) == 1


IMPOSSIBLE = [  # what is changed of a good record, what the line names
    (lambda c: {"force": -c.force}, "wrong sign"),
    (lambda c: {"penetration": -c.motion}, "wrong sign"),
    (lambda c: {"penetration": -c.motion, "force": -c.force}, "wrong sign"),
    (lambda c: {"force": 1e9 * c.force}, "units?"),
    (lambda c: {"force": 1e300 * c.force}, "at most 1e+60"),
    (lambda c: {"force": 1e-300 * c.force}, "at least 1e-60"),
    (lambda c: {"penetration": 0.0 * c.motion}, "does not move"),
    (lambda c: {"force": 1e-4 * np.random.default_rng(0).standard_normal(c.time.size)}, "no contact"),
    (lambda c: {"force": 0.0 * c.force}, "no contact"),
    (lambda c: {"penetration": c.motion - 0.05}, "never comes to 0"),
]


@pytest.mark.parametrize(("change", "named"), IMPOSSIBLE)
def test_a_record_that_cannot_be_this_contact(closed_form, change, named):
    good = hertz_curve()
    columns = {"time": good.time, "force": good.force, "penetration": good.motion} | change(good)

    def fitted():
        return fit_curves([MeasuredCurve(**columns)], elastic_scene(), settings_of("material.modulus"))

    assert named in one_line(fitted)


ASKED = [  # arguments of a fit, what the line names
    (["--vary", "material.modulos"], "modulos"),
    (["--vary", "material.modulus=2:1"], "bounds"),
    (["--vary", "material.modulus=a:b"], "two finite numbers"),
    ([], "vary"),
    (["--vary", "material.modulus", "--free", "tilt"], "background"),
    (["--vary", "material.modulus", "--within", "2"], "share"),
    (["--vary", "material.modulos", "--each"], "modulos"),
    (["--vary", "material.modulus", "--check-solver", "x"], "--check-solver"),
    (["--vary", "material.modulus", "--tie", "indenter.radius=adhesion.work"], "is not varied"),
    (["--vary", "material.modulus", "--tie", "material.modulus=material.modulus"], "itself"),
    (["--vary", "material.modulus", "--profile", "x", "--check-solver", "none"], "x is not varied"),
]


@pytest.mark.parametrize(("arguments", "named"), ASKED)
def test_bad_arguments_are_one_line_and_exit_2(closed_form, arguments, named, tmp_path, capsys):
    write_csv(hertz_curve(), tmp_path / "a.csv")
    write_scene(elastic_scene(), tmp_path / "scene.toml")
    files = str(tmp_path / "a.csv"), str(tmp_path / "scene.toml")
    assert main(["fit", *files, "--jobs", "1", "--solver", "closed-form", *arguments]) == 2
    said = capsys.readouterr().err.strip().split("\n")[-1]
    assert named in said
    assert said.startswith("crosscontact: error:")


def test_first_guesses_from_which_no_search_sets_out(closed_form):
    scene = elastic_scene()
    away = replace(scene, loading=Loading("relaxed", 0.0, (Ramp(1.0, 1.0),)), adhesion=Adhesion(1e-6, 1e-7))
    sprung = replace(scene, loading=replace(scene.loading, machine=Machine(1.0)))
    modulus = settings_of("material.modulus")
    for guess, settings, named in (
        (away, modulus, "no parameter changes the force at the first guess"),
        (sprung, settings_of("material.modulus", "machine.stiffness"), "not that of a stage"),
        (sprung, settings_of("loading.steps[0].rate"), "measured motion takes"),
    ):
        assert named in one_line(fit_curves, [hertz_curve()], guess, settings)


@pytest.mark.parametrize("name", ["tie", "per_curve", "free", "profile"])
def test_one_name_needs_no_sequence_around_it(closed_form, name):
    """Taken apart into letters it was refused by its first."""
    options = {"solver": "closed-form", "check_solver": None, name: "none-such"}
    assert "none-such" in one_line(cc.fit, hertz_curve(), elastic_scene(GUESS), "material.modulus", **options)
