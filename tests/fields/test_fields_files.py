"""Fields as files, read back by PyVista and meshio; the command says in one line what is wrong."""

from __future__ import annotations

import errno
import json
import math
import os
from dataclasses import replace

import meshio
import numpy as np
import pytest
import pyvista
from support.paper_scenes import STICKY as ADHESION
from support.paper_scenes import WORK
from support.scene_text import DOWN_AND_UP as TEXT

from contact_scene import (
    Adhesion,
    Branch,
    Force,
    ForceRamp,
    Hold,
    Loading,
    Material,
    Ramp,
    Scene,
    SceneError,
    Sphere,
)
from crosscontact.cli import main
from fem_solver import Options, field_states, record
from validation.fields import figures, files
from validation.fields.files import cell_data, data_sets, point_data
from validation.fields.moments import FieldRequest, balance, check_times, record_fields
from validation.fields.section import surface_nodes
from validation.solvers.finite_elements import FiniteElements

MATERIAL = Material(0.75, 0.4, (Branch(2.0, 0.3),))


@pytest.fixture(scope="module")
def looked_into():
    loading = Loading("jump-in", 0.015, (Ramp(0.02, 0.05), Ramp(0.01, 0.05)))
    scene = Scene(MATERIAL, Sphere(1.0), loading, ADHESION, "Down and up")
    recording = record(scene, FiniteElements().mesh(scene, 4), Options(record_times=(0.1,)))
    rows = {0: "jump-in", recording.rows[0.1]: "", len(recording.trace) - 1: "last"}
    return scene, recording.trace, list(field_states(recording, rows))


@pytest.fixture
def scene_file(tmp_path):
    path = tmp_path / "down-and-up.toml"
    path.write_text(TEXT, encoding="utf-8")
    return str(path)


def test_data_sets_hold_every_field_with_its_unit(looked_into):
    scene, _, states = looked_into
    state = states[1]
    body, top, outline = data_sets(state, scene).values()
    stresses = ("von_mises", "max_shear", "hydrostatic", "principal_1", "principal_2", "principal_3")
    names = [f"stress_{part} [force/length^2]" for part in ("rr", "zz", "tt", "rz")]
    names += [f"strain_{part} [1]" for part in ("rr", "zz", "tt", "rz")]
    names += [f"{name} [force/length^2]" for name in stresses]
    names += ["displacement_applied [length]", "stored_energy [energy/length^3]"]
    names += [f"dissipation_rate{part} [energy/(length^3 time)]" for part in ("", " tau=0.3")]
    names += [f"dissipated_energy{part} [energy/length^3]" for part in ("", " tau=0.3")]
    assert set(body.point_data.keys()) == set(names)
    assert not set(body.point_data.keys()) & set(body.cell_data.keys())
    assert np.array_equal(body.point_data["stress_zz [force/length^2]"], state.stress[1])
    total = body.point_data["dissipation_rate [energy/(length^3 time)]"]
    assert np.array_equal(total, state.dissipation_rate.sum(axis=0))
    assert body.field_data["TimeValue"] == [state.time]
    assert np.array_equal(top.point_data["pressure [force/length^2]"], state.surface.pressure)
    assert np.allclose(top.points[:, 2], -state.surface.displacement)
    assert outline.points[0, 2] == -state.penetration
    # where they touch, the surface lies on the indenter
    inside = state.surface.radius < 0.9 * state.contact_radius
    height = scene.indenter.height(state.surface.radius[inside]) - state.penetration
    assert np.allclose(top.points[inside, 2], height, atol=1e-9)


def test_all_parts_are_deformed_in_the_plane_of_r_and_z(looked_into):
    scene, _, states = looked_into
    state = states[1]
    body, top, outline = data_sets(state, scene).values()
    for part in (body, top, outline):
        assert np.all(part.points[:, 1] == 0.0)
        assert part.point_data["displacement_applied [length]"].shape == part.points.shape
    undeformed = body.points - body.point_data["displacement_applied [length]"]
    assert np.allclose(undeformed[:, [0, 2]], state.points, atol=1e-12)
    assert np.allclose((top.points - top.point_data["displacement_applied [length]"])[:, 2], 0.0, atol=1e-12)
    above = outline.points - outline.point_data["displacement_applied [length]"]
    assert np.allclose(above[:, 2], scene.indenter.height(above[:, 0]), atol=1e-12)
    # the body's own surface is the surface
    nodes = surface_nodes(state)
    along = body.points[nodes]
    assert np.allclose(np.interp(top.points[:, 0], along[:, 0], along[:, 2]), top.points[:, 2], atol=1e-9)


def test_cells_sum_to_integrals(looked_into):
    _, trace, states = looked_into
    state = states[1]
    cells, sums = cell_data(state), balance(state, trace)
    volumes = cells["undeformed_volume [length^3]"]
    assert volumes.sum() == pytest.approx(state.element_volumes.sum(), rel=1e-12)
    quarters = volumes.reshape(4, -1).sum(axis=0)
    assert np.allclose(quarters, state.element_volumes, rtol=1e-9)
    assert volumes @ cells["mean_stored_energy [energy/length^3]"] == pytest.approx(sums.stored, rel=1e-9)
    assert volumes @ cells["mean_dissipated_energy tau=0.3 [energy/length^3]"] == pytest.approx(
        sums.dissipated, rel=1e-9
    )
    assert (volumes > 0.0).all()


def test_series_is_read_back(looked_into, tmp_path):
    scene, trace, states = looked_into
    for left_over in ("body/body_0007.vtu", "body/mine.vtu"):
        (tmp_path / left_over).parent.mkdir(exist_ok=True)
        (tmp_path / left_over).write_text("old", encoding="utf-8")
    jump = replace(states[-1], label="after a jump")  # at the time of the one before
    written = files.ParaViewSeries(tmp_path, scene)
    for state in (*states, jump):
        written.add(state, balance(state, trace))
    lists = written.close({"outcome": "completed"})
    assert [path.name for path in lists] == ["body.pvd", "surface.pvd", "indenter.pvd"]
    assert not (tmp_path / "body/body_0007.vtu").exists()
    assert (tmp_path / "body/mine.vtu").exists()
    for path in lists:
        reader = pyvista.get_reader(path)
        times = reader.time_values
        assert times[:3] == [state.time for state in states]
        assert times[2] < times[3] <= times[2] * (1.0 + 1e-15)
        for index, state in enumerate((*states, jump)):
            reader.set_active_time_point(index)
            block = reader.read()[0]
            assert block.field_data["penetration [length]"] == [state.penetration]
    found = meshio.read(tmp_path / "body/body_0001.vtu")
    assert np.array_equal(found.cells_dict["triangle"], states[1].triangles)
    for name, values in point_data(states[1]).items():
        assert np.array_equal(found.point_data[name], values)
    numbers = json.loads((tmp_path / "moments.json").read_text(encoding="utf-8"))
    assert [moment["label"] for moment in numbers["moments"]] == ["jump-in", "", "last", "after a jump"]
    assert numbers["moments"][1]["force"] == states[1].force
    assert not [path for path in tmp_path.rglob("*") if path.name.startswith(".")]


def test_nothing_half_written_stays(looked_into, tmp_path, monkeypatch):
    scene, _, states = looked_into
    target = tmp_path / "a.vtu"
    target.write_text("the one before", encoding="utf-8")
    body = data_sets(states[0], scene)["body"]

    def full(descriptor):
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr(os, "fsync", full)
    with pytest.raises(OSError, match="No space left") as caught:
        files.save(body, target)
    assert caught.value.filename == str(target)
    assert target.read_text(encoding="utf-8") == "the one before"
    assert list(tmp_path.iterdir()) == [target]


RAMPS = (Ramp(0.02, 0.01), Hold(3.0))
ENDS = [
    ((), 0.0),
    (RAMPS, 5.0),
    ((*RAMPS, Force(1.0, 2.0)), 7.0),
    ((Force(1.0, 2.0), ForceRamp(3.0, 1.0)), 4.0),
]


@pytest.mark.parametrize(("steps", "end"), ENDS)
def test_times_are_checked_before_anything_is_solved(steps, end):
    loading = Loading("relaxed", 0.0, steps)
    assert check_times([end * (1 + 1e-12), end / 2, end / 2], loading) == tuple(sorted({end / 2, end}))
    for wrong, said in (
        (-1.0, "times >= 0"),
        (math.nan, "times >= 0"),
        (end + 0.1, "after the loading ends"),
    ):
        with pytest.raises(SceneError, match=said):
            check_times([wrong], loading)


@pytest.mark.parametrize("steps", [(Force(1.0, 2.0), Ramp(0.02, 0.01)), (ForceRamp(1.0, 2.0),)])
def test_a_ramp_after_a_force_ends_when_the_run_says(steps):
    assert check_times([1e9], Loading("relaxed", 0.0, steps)) == (1e9,)


@pytest.mark.slow
def test_one_run_serves_all_moments(monkeypatch):
    runs = []
    monkeypatch.setattr("fem_solver.record", lambda *given: runs.append(given) or record(*given))
    asked = FieldRequest((0.02,), picked=lambda trace, scene: {3: "third"})
    loading = Loading("jump-in", 0.012, (Ramp(0.0135, 0.05),))
    for bulk in (None, "elastic"):
        runs.clear()
        scene = Scene(replace(MATERIAL, bulk=bulk), Sphere(1.0), loading, Adhesion(WORK, 0.03))
        found = record_fields(scene, asked, 4)
        assert len(runs) == 1
        assert found.moments[3] == "third"
        assert [state.label for state in found.states()] == ["third", ""]


def test_command_writes_what_it_says(scene_file, tmp_path, capsys):
    out = tmp_path / "out"
    asked = ["--at", "0", "0.06", "--pull-off", "--every", "10", "--resolution", "4"]
    assert main(["fields", scene_file, *asked, "--out", str(out), "--no-figures"]) == 0
    said = capsys.readouterr().out
    numbers = json.loads((out / "moments.json").read_text(encoding="utf-8"))
    assert numbers["solver"] == "fem"
    labels = [moment["label"] for moment in numbers["moments"]]
    assert labels.count("pull-off") == 1
    assert len(labels) > 4
    assert "pull-off" in said
    assert numbers["fields"]["volume_solves"] > len(labels)
    made = numbers["fields"]["factorisations"]  # of body and projection, a pair for every mesh
    assert made in (2, 4)
    assert f"{made} factorisations, {numbers['fields']['volume_solves']} volume solves" in said
    reader = pyvista.get_reader(out / "body.pvd")
    assert len(reader.time_values) == len(labels)
    assert 0.06 in reader.time_values


@pytest.mark.parametrize(
    ("asked", "said"),
    [
        ([], "no moment asked for"),
        (["--at", "x"], "got 'x'; allowed: times >= 0"),
        (["--every", "0"], "allowed: a whole number >= 1"),
        (["--at", "9"], "9 is after the loading ends; allowed: times from 0 to 1.09"),
        (["--at", "0", "1", "--resolution", "4", "--no-figures"], "1: outside the run, which ended at 0."),
    ],
)
def test_what_cannot_be_is_said_in_one_line(scene_file, tmp_path, capsys, asked, said):
    with pytest.raises(SystemExit) as exit_code:
        raise SystemExit(main(["fields", scene_file, *asked, "--out", str(tmp_path / "out")]))
    assert exit_code.value.code == 2
    lines = capsys.readouterr().err.splitlines()
    assert said in lines[-1]
    assert len([line for line in lines if "error" in line]) == 1
    assert (tmp_path / "out/body.pvd").exists() == ("outside the run" in said)


@pytest.mark.slow
def test_an_animation_alone_writes_no_files_for_paraview(scene_file, tmp_path, monkeypatch, capsys):
    monkeypatch.setattr(figures, "film", lambda *given: b"GIF" * 700)
    out = tmp_path / "out"
    assert main(["fields", scene_file, "--animate", "--resolution", "4", "--out", str(out)]) == 0
    written = {path.name for path in out.rglob("[!.]*") if path.is_file()}
    assert written == {"scene.toml", "cycle_von_mises.gif"}
    said = capsys.readouterr().out
    assert "cycle_von_mises.gif (2.1 kB)" in said
    assert "ParaView" not in said


def test_a_run_that_never_pulls(tmp_path, capsys):
    path = tmp_path / "pressed.toml"
    kept = TEXT.split("[loading]")[0] + '[loading]\nstart = "relaxed"\npenetration = 0.03\n'
    path.write_text(kept, encoding="utf-8")
    asked = ["--at", "0", "--pull-off", "--resolution", "4", "--no-figures"]
    assert main(["fields", str(path), *asked, "--out", str(tmp_path / "out")]) == 2
    assert "never pulls" in capsys.readouterr().err
    assert (tmp_path / "out/body.pvd").exists()
