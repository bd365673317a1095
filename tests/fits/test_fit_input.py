"""What is asked of a fit and cannot be: one line; what is done to a record is said."""

from __future__ import annotations

from dataclasses import replace

import pytest
from support.recorded import GUESS, elastic_scene, hertz_curve, settings_of

import crosscontact as cc
from contact_scene import (
    Adhesion,
    Branch,
    BulkRelaxation,
    Loading,
    Machine,
    Material,
    Ramp,
    SceneError,
    write_scene,
)
from crosscontact.cli import main
from validation.fits.fit import fit_curves
from validation.fits.page import statements
from validation.fits.parameters import question
from validation.fits.tables import write_csv
from validation.runs.folder import claim

pytestmark = pytest.mark.usefixtures("closed_form")


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--vary", "material.modulos"], "material has no modulos"),
        (["--vary", "material.modulus=2:1"], "bounds"),
        (["--vary", "material.modulus=a:b"], "two finite numbers"),
        ([], "vary: is empty"),
        (["--vary", "material.modulus", "--free", "tilt"], "background"),
        (["--vary", "material.modulus", "--within", "2"], "a share of the range"),
        (["--vary", "material.modulos", "--each"], "material has no modulos"),
        (["--vary", "material.modulus", "--check-solver", "x"], "--check-solver"),
        (["--vary", "material.modulus", "--tie", "indenter.radius=adhesion.work"], "is not varied"),
        (["--vary", "material.modulus", "--tie", "material.modulus=material.modulus"], "is tied to itself"),
        (["--vary", "material.modulus", "--profile", "x", "--check-solver", "none"], "x is not varied"),
    ],
)
def test_bad_arguments_are_one_line_and_exit_2(arguments, words, tmp_path, capsys):
    write_csv(hertz_curve(), tmp_path / "a.csv")
    write_scene(elastic_scene(), tmp_path / "scene.toml")
    files = str(tmp_path / "a.csv"), str(tmp_path / "scene.toml")
    assert main(["fit", *files, "--jobs", "1", "--solver", "closed-form", *arguments]) == 2
    said = capsys.readouterr().err.strip().split("\n")[-1]
    assert words in said
    assert said.startswith("crosscontact: error:")


def test_a_file_is_read_with_the_options_of_the_reader(tmp_path, capsys):
    """Columns that nothing names, of millimetres and millinewtons."""
    curve = hertz_curve(noise=2e-4)
    rows = zip(1e3 * curve.force, 1e3 * curve.motion, curve.time, strict=True)
    (tmp_path / "a.txt").write_text("\n".join(",".join(map(repr, map(float, row))) for row in rows))
    write_scene(elastic_scene(GUESS), tmp_path / "scene.toml")
    asked = ["fit", str(tmp_path / "a.txt"), str(tmp_path / "scene.toml"), "--solver", "closed-form"]
    asked += ["--vary", "material.modulus", "--check-solver", "none", "--jobs", "1"]
    columns = "time=3,penetration=2:1e-3,force=1:1e-3"
    assert main([*asked, "--columns", columns]) == 0
    assert "material.modulus" in capsys.readouterr().out
    assert main([*asked, "--columns", columns, "--segment", "pause"]) == 2
    assert "has no pause" in capsys.readouterr().err


def test_a_folder_of_another_fit_is_refused_and_that_of_the_same_is_not(tmp_path, capsys):
    write_csv(hertz_curve(), tmp_path / "a.csv")
    write_scene(elastic_scene(), tmp_path / "scene.toml")
    [curve], out = cc.read_curves(tmp_path / "a.csv"), tmp_path / "out"
    out.mkdir()
    claim(out, "a fit", question([curve], elastic_scene(), settings_of("material.modulus")))
    (out / "fit.json").write_text("{}")
    renamed = question([replace(curve, name="b")], elastic_scene(), settings_of("material.modulus"))
    claim(out, "a fit", renamed)
    arguments = ["fit", str(tmp_path / "a.csv"), str(tmp_path / "scene.toml"), "--out", str(out)]
    assert main([*arguments, "--vary", "indenter.radius"]) == 2
    assert "holds a fit (other parameters)" in capsys.readouterr().err
    with pytest.raises(
        SceneError, match=r"out: .* holds a fit \(other parameters\); allowed: another folder$"
    ):
        cc.fit(curve, elastic_scene(), ["indenter.radius"], solver="closed-form", check_solver=None, out=out)
    assert main([*arguments, "--vary", "material.modulos", "--fresh"]) == 2
    assert "material has no modulos" in capsys.readouterr().err


@pytest.mark.parametrize("name", ["tie", "per_curve", "free", "profile"])
def test_one_name_needs_no_sequence_around_it(name):
    """Taken apart into letters it was refused by its first."""
    options = {"solver": "closed-form", "check_solver": None, name: "none-such"}
    with pytest.raises(SceneError, match="none-such"):
        cc.fit(hertz_curve(), elastic_scene(GUESS), "material.modulus", **options)


def test_a_first_guess_from_which_no_parameter_matters_is_refused():
    away = Loading("relaxed", 0.0, (Ramp(1.0, 1.0),))  # the first row of the record is out of contact
    scene = replace(elastic_scene(), loading=away, adhesion=Adhesion(1e-6, 1e-7))
    with pytest.raises(SceneError, match=r"no parameter changes the force at the first guess: \w+"):
        fit_curves([hertz_curve()], scene, settings_of("material.modulus"))


def test_a_first_guess_that_the_solver_does_not_take_is_refused_by_its_reason():
    apart = Material(0.75, 0.4, (Branch(6.75, 1.0),), BulkRelaxation())
    scene = replace(elastic_scene(), material=apart, adhesion=Adhesion(5e-4, 1e-5))
    told = "solver: bem does not take the first guess: .*; allowed: .* --solver reference or fem$"
    with pytest.raises(SceneError, match=told):
        fit_curves([hertz_curve()], scene, replace(settings_of("adhesion.work"), solver="bem"))


def test_means_of_rows_stand_in_the_report(monkeypatch):
    monkeypatch.setattr("validation.fits.fit.MOST_ROWS", 60)
    found = fit_curves([hertz_curve(noise=2e-4)], elastic_scene(GUESS), settings_of("material.modulus"))
    assert "hertz: fitted are means of 2 rows" in statements(found)
    assert found.curves[0].curve.time.size == 60


@pytest.mark.parametrize(
    ("path", "words"),
    [("machine.stiffness", "not that of a stage"), ("loading.steps[0].rate", "measured motion takes")],
)
def test_numbers_that_play_no_part_are_refused(path, words):
    scene = elastic_scene()
    scene = replace(scene, loading=replace(scene.loading, machine=Machine(1.0)))
    with pytest.raises(SceneError, match=words):
        fit_curves([hertz_curve()], scene, settings_of("material.modulus", path))
