"""Solving and comparing from Python: the bits of solvers and command line, one line for bad input."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
import threadpoolctl

import crosscontact as cc
from contact_scene.run_control import single_threaded
from crosscontact.cli import main
from validation.reference.path import Options, solve
from validation.solvers.boundary_elements import BoundaryElements

SPHERE = cc.Scene(
    cc.Material(0.75, 0.5, (cc.Branch(6.75, 1.0),)),
    cc.Sphere(1.0),
    cc.Loading("jump-in", 0.0, (cc.Ramp(0.01, 0.02), cc.Ramp(-0.5, 0.02))),
    cc.Adhesion(5.026548e-4, 0.013),
    "a short cycle",
)


@pytest.fixture(scope="module")
def short():
    return cc.solve(SPHERE)


def test_the_reference_answers_by_default(short):
    assert (short.solver, short.name) == ("reference", "a short cycle")
    direct = solve(SPHERE, Options())
    for name, column in direct.columns().items():
        assert np.array_equal(short.trace.columns()[name], column), name
    assert short.outcome == direct.outcome
    assert short.errors == {}


def test_measures_have_groups(short):
    measures = short.measures
    assert short.pull_off.force == measures["pull_off_force"] > 0.0
    assert short.pull_off.penetration == measures["pull_off_penetration"]
    assert short.pull_off.radius == measures["pull_off_radius"]
    assert short.detachment.time == measures["detachment_time"] == pytest.approx(short.outcome.time)
    assert short.approach.penetration == 0.01
    assert short.final.time == short.trace.time[-1]
    assert measures["loop_energy"] > 0.0


def test_what_does_not_apply_is_none():
    pressed = dataclasses.replace(SPHERE, loading=cc.Loading("jump-in", 0.0, (cc.Ramp(0.01, 0.02),)))
    result = cc.solve(dataclasses.replace(pressed, adhesion=None))
    assert result.detachment == cc.ContactState(None, None, None, None)
    assert result.pull_off.force is None
    assert ["pull_off_force", "-"] in [line.split() for line in repr(result).splitlines()]


def test_a_path_and_a_name_are_scenes_too(tmp_path):
    coarse = cc.solve(SPHERE, resolution=4)
    file = tmp_path / "short.toml"
    cc.write_scene(SPHERE, file)
    for path in (file, str(file)):
        again = cc.solve(path, resolution=4)
        assert again.name == "short"
        assert np.array_equal(again.trace.force, coarse.trace.force)
    assert cc.solve("relaxed-equilibrium").scene == cc.builtin("relaxed-equilibrium")
    assert cc.scenes()["relaxed-equilibrium"] == cc.builtin("relaxed-equilibrium").title


def test_errors_are_estimated_when_asked():
    for solver in ("reference", "bem"):
        result = cc.solve("relaxed-equilibrium", solver, estimate_errors=True)
        assert 0.0 <= result.errors["start_force"] < 1e-2


def test_stop_times_are_stepped_onto_and_profiles_kept():
    result = cc.solve(SPHERE, resolution=4, stop_times=[0.1234], profile_times=[0.2345])
    assert {0.1234, 0.2345} <= set(result.trace.time.tolist())
    assert 0.2345 in [profile.time for profile in result.trace.profiles]


def test_a_budget_ends_a_run_with_its_reason():
    result = cc.solve(SPHERE, max_steps=5)
    assert result.outcome.kind is cc.OutcomeKind.STEP_BUDGET
    assert not result.outcome.finished


def test_progress_is_reported():
    shares = []
    cc.solve(SPHERE, resolution=4, progress=shares.append)
    assert shares
    assert all(0.0 <= share <= 1.0 for share in shares)


def test_compare_finds_agreement_and_names_what_failed():
    compared = cc.compare("relaxed-equilibrium", solvers=["bem", "reference"])
    assert compared.agree, repr(compared)
    assert list(compared.results) == ["bem", "reference"]
    assert compared["bem"].solver == "bem"
    assert "all agree" in repr(compared)
    assert "<table>" in compared._repr_html_()


def test_a_refused_scene_is_raised_and_compared_without_the_solver(monkeypatch):
    refused = cc.UnsupportedScene("indenter.shape", "not by this method", "another solver")
    monkeypatch.setattr(BoundaryElements, "refusal", lambda self, scene: refused)
    with pytest.raises(cc.UnsupportedScene, match="not by this method"):
        cc.solve(SPHERE, "bem")
    compared = cc.compare(SPHERE, solvers=["bem", "reference"], estimate_errors=False)
    assert set(compared.failures) == {"bem"}
    assert compared["reference"].outcome.finished


def blas_threads() -> set[int]:
    return {entry["num_threads"] for entry in threadpoolctl.threadpool_info() if entry["user_api"] == "blas"}


def test_one_thread_during_a_run_and_what_was_there_after():
    with threadpoolctl.threadpool_limits(2, user_api="blas"):
        before, during = blas_threads(), []
        cc.solve(SPHERE, resolution=4, progress=lambda share: during.append(blas_threads()))
        assert during[0] == {1}
        assert blas_threads() == before
        with single_threaded():
            with single_threaded():
                assert blas_threads() == {1}
            assert blas_threads() == {1}  # the outer run goes on
        assert blas_threads() == before


def test_the_folder_is_that_of_the_command_line(tmp_path, capsys):
    cc.solve("relaxed-equilibrium", "bem", 8).save(tmp_path / "api")
    command = ["solve", "relaxed-equilibrium", "--solver", "bem", "--resolution", "8", "--out"]
    assert main([*command, str(tmp_path / "command")]) == 0
    names = ["scene.toml", "summary.json", "trace.csv"]
    for folder in ("api", "command"):
        assert sorted(file.name for file in (tmp_path / folder).glob("[!.]*")) == names
    for name in ("scene.toml", "trace.csv"):
        assert (tmp_path / "api" / name).read_bytes() == (tmp_path / "command" / name).read_bytes()
    api, command_line = cc.load(tmp_path / "api"), cc.load(tmp_path / "command")
    differing = {k for k, v in api.measures.items() if command_line.measures[k] != v}
    assert differing <= {"wall_seconds"}
