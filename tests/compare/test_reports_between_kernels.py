"""Two reports, run by run: what is the same, what is moved by rounding, what by more than it may."""

from __future__ import annotations

import dataclasses
import tomllib

import numpy as np
import pytest
from support.spring_solver import SCENE, fake, named

from benchmarks.reports_apart import main
from contact_scene import OutcomeKind, scene_from_dict
from validation import solvers
from validation.cases import Case
from validation.runs.run import run, write_run

CASE = Case("small", scene_from_dict(tomllib.loads(SCENE)))
ESTIMATE = 1e-3


@pytest.fixture
def compared(tmp_path, monkeypatch, capsys):
    """Writes a run into either of two folders, the second changed; exit code and what is printed."""
    monkeypatch.setitem(solvers.SOLVERS, "bem", named("bem", fake()))
    done = run(CASE, "bem")
    estimated = dict.fromkeys(("force", "contact_radius", "detachment_force"), ESTIMATE)

    def compare(change, within="rounding", errors=estimated):
        other = change(done.trace)
        measures = done.measures | {"detachment_force": other.force[-1]}
        runs = {
            "one": dataclasses.replace(done, errors=errors),
            "two": dataclasses.replace(done, trace=other, measures=measures, errors=errors),
        }
        for name, one in runs.items():
            write_run(tmp_path / name / "runs/small/bem", CASE.scene, one)
        code = main([*(str(tmp_path / name) for name in runs), "--within", within])
        return code, capsys.readouterr().out

    return compare


def scaled(factor):
    return lambda trace: dataclasses.replace(trace, force=trace.force * factor)


def without_a_row(factor=1.0):
    def change(trace):
        columns = {name: np.delete(column, 7) for name, column in trace.columns().items()}
        return dataclasses.replace(trace, **columns | {"force": columns["force"] * factor})

    return change


@pytest.mark.parametrize(
    ("change", "within", "code", "said"),
    [
        (lambda trace: trace, "rounding", 0, "1 the same to 1e-09"),
        (scaled(1.0 + 5e-10), "rounding", 0, "1 the same to 1e-09"),
        (scaled(1.0 - 0.09 * ESTIMATE), "rounding", 0, "apart: small/bem: "),
        (scaled(1.0 + 0.2 * ESTIMATE), "rounding", 1, "detachment_force 2.0e-04: 2 of what is allowed"),
        (scaled(1.0 - 0.2 * ESTIMATE), "rounding", 1, "detachment_force 2.0e-04: 2 of what is allowed"),
        (without_a_row(), "rounding", 0, "0 too far apart"),
        (without_a_row(1.0 + 0.5 * ESTIMATE), "rounding", 1, "FAILED: small/bem: "),
        (scaled(1.0 + 1.9 * ESTIMATE), "estimates", 0, "apart: small/bem: "),
        (scaled(1.0 + 2.2 * ESTIMATE), "estimates", 1, "FAILED: small/bem: "),
    ],
)
def test_what_may_lie_between_two_runs(compared, change, within, code, said):
    found, printed = compared(change, within)
    assert found == code
    assert said in printed


def test_another_ending_is_no_rounding(compared):
    completed = lambda trace: dataclasses.replace(trace.outcome, kind=OutcomeKind.COMPLETED)  # noqa: E731
    code, printed = compared(lambda trace: dataclasses.replace(trace, outcome=completed(trace)))
    assert code == 1
    assert "FAILED: small/bem: outcome" in printed


def test_a_difference_without_an_estimate_cannot_be_allowed(compared):
    assert compared(scaled(1.0 + 1e-6), errors={})[0] == 1
    assert compared(scaled(1.0 + 1e-10), errors={})[0] == 0


def test_a_missing_run_is_a_failure_and_no_run_bad_input(compared, tmp_path, capsys):
    compared(lambda trace: trace)
    assert main([str(tmp_path / "one"), str(tmp_path / "none"), "--within", "rounding"]) == 1
    assert "FAILED: small/bem: run: inf" in capsys.readouterr().out
    assert main([str(tmp_path / "none"), str(tmp_path / "none")]) == 2
    assert capsys.readouterr().err.count("\n") == 1


def test_a_quantity_known_to_rounding_may_differ_by_rounding(compared):
    """The force where it is prescribed: an estimate of 1e-16 is no measure of what the last bit does."""
    exact = {"force": 1e-17, "detachment_force": 1e-17, "contact_radius": ESTIMATE}
    assert compared(scaled(1.0 + 1e-15), errors=exact)[0] == 0
