"""Files of force microscopes: what ``afmformats`` cannot read, or would misread, is refused in one line."""

from __future__ import annotations

import subprocess
import sys

import numpy as np
import pytest
from support.recorded import elastic_scene, hertz_curve

import crosscontact as cc
from contact_scene import SceneError, write_scene
from validation.fits.instruments import write_afm
from validation.fits.tables import write_csv

afmformats = pytest.importorskip("afmformats", reason="the optional extra `fit` is not installed")
h5py = pytest.importorskip("h5py", reason="the optional extra `fit` is not installed")

UNKNOWN = "is damaged, or in no format that afmformats knows; allowed: a .{} of a force microscope; a table"


def refusal(path):
    """The one line with which a file is refused, without its name."""
    with pytest.raises(SceneError) as caught:
        cc.read_curves(path)
    line = str(caught.value)
    assert line.startswith(f"{path}: ")
    assert "\n" not in line
    return line.removeprefix(f"{path}: ")


@pytest.mark.parametrize("ending", ["h5", "tab", "jpk-force", "jpk-force-map", "jpk-qi-data"])
def test_a_file_in_no_known_format_is_refused_in_one_line(tmp_path, ending):
    file = tmp_path / f"a.{ending}"
    file.write_bytes(np.random.default_rng(1).bytes(5000))
    assert UNKNOWN.format(ending) in refusal(file)
    file.write_bytes(b"")
    assert refusal(file).startswith("the file is empty;")


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


def test_what_is_no_file_is_told_as_what_it_is(tmp_path):
    (tmp_path / "a.h5").mkdir()
    assert refusal(tmp_path / "a.h5").startswith("is a folder;")
    assert refusal(tmp_path / "b.h5").startswith("cannot be read: No such file")


@pytest.mark.parametrize(
    ("column", "unit", "allowed"), [("force", "nN", "N"), ("tip position", "nm", "m"), ("time", "ms", "s")]
)
def test_a_unit_that_is_not_the_one_a_column_is_read_in_is_refused(tmp_path, column, unit, allowed):
    file = tmp_path / "a.h5"
    write_afm(hertz_curve(), file)
    with h5py.File(file, "r+") as opened:
        opened["0"][column].attrs["unit"] = unit
    assert refusal(file) == f"0/{column}: is in {unit}; allowed: {allowed}: nothing is converted"
    for fine in (allowed, allowed.encode(), ""):
        with h5py.File(file, "r+") as opened:
            opened["0"][column].attrs["unit"] = fine
        assert len(cc.read_curves(file)) == 1


@pytest.mark.parametrize("kind", [np.complex128, np.bool_])
def test_columns_that_hold_no_real_numbers_are_refused(tmp_path, kind):
    file = tmp_path / "a.h5"
    write_afm(hertz_curve(), file)
    with h5py.File(file, "r+") as opened:
        force = opened["0"]["force"][:].astype(kind)
        del opened["0"]["force"]
        opened["0"]["force"] = force
    assert refusal(file) == f"0/force: holds {np.dtype(kind)}; allowed: real numbers"


@pytest.mark.parametrize("ending", ["H5", "Tab"])
def test_an_ending_in_capitals_is_the_same_ending(tmp_path, ending):
    curve = hertz_curve()
    write_afm(curve, tmp_path / f"a.{ending}")
    [back] = cc.read_curves(tmp_path / f"a.{ending}")
    assert back.name == "a"
    assert np.allclose(back.force, curve.force, rtol=1e-6, atol=1e-8)
    (tmp_path / f"a.{ending}").write_bytes(b"nothing that is known")
    assert UNKNOWN.format(ending.lower()) in refusal(tmp_path / f"a.{ending}")


def test_a_row_that_is_cut_off_is_told_by_its_line(tmp_path):
    """Cells that are missing would be read as 0."""
    file = tmp_path / "a.tab"
    write_afm(hertz_curve(), file)
    lines = file.read_text().splitlines()
    first, rows = next(k for k, line in enumerate(lines) if line[0] != "#"), hertz_curve().time.size
    cells = lines[first + 30].split("\t")
    for last in (cells[:2], [*cells[:3], cells[3][:4]]):  # the latter is a number, but another one
        file.write_text("\n".join([*lines[: first + 30], "\t".join(last)]))
        assert refusal(file).startswith(f"line {first + 31}: ends within row 31 of {rows}; allowed: ")
    file.write_text("\n".join([*lines[: first + 30], "\t".join(cells[:2]), *lines[first + 31 :], ""]))
    allowed = f"{len(cells)}, separated by tabs, as in line {first + 1}"
    assert refusal(file) == f"line {first + 31}: 2 cells; allowed: {allowed}"
    file.write_text("\n".join(lines))  # whole but for the last end of a line
    assert len(cc.read_curves(file)) == 1


def test_such_a_table_needs_no_afmformats(tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "afmformats", None)
    write_csv(hertz_curve(), tmp_path / "a.txt")
    assert len(cc.read_curves(tmp_path / "a.txt")) == 1
    (tmp_path / "a.txt").write_text("Device:\tChiaro\n")
    with pytest.raises(ImportError, match="afmformats is not installed"):
        cc.read_curves(tmp_path / "a.txt")


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("time;penetration;force\n0;0;0\n", "1 rows; allowed: at least 20"),
        ("weight,depth\n1,2\n", "columns: got 'weight,depth'; allowed: a header: time"),
        ("0 1 2\n1 2 3\n", "states no spring constant and no sensitivity; allowed: "),
    ],
)
def test_a_txt_that_is_no_table_is_told_as_one_unless_afmformats_knows_it(tmp_path, text, words):
    (tmp_path / "a.txt").write_text(text)
    assert words in refusal(tmp_path / "a.txt")


@pytest.mark.parametrize("interruption", [KeyboardInterrupt, SystemExit])
def test_an_interruption_while_a_file_is_read_goes_on(tmp_path, monkeypatch, interruption):
    def interrupted(path, **options):
        raise interruption

    write_afm(hertz_curve(), tmp_path / "a.h5")
    monkeypatch.setattr(afmformats, "load_data", interrupted)
    with pytest.raises(interruption):
        cc.read_curves(tmp_path / "a.h5")
