"""Two reports that differ by rounding: what is the same, what took other decisions, what is magnified."""

from __future__ import annotations

import dataclasses
import tomllib

import numpy as np
import pytest
from support.spring_solver import SCENE, fake, named

from contact_scene import OutcomeKind, scene_from_dict
from validation import solvers
from validation.cases import Case
from validation.compare import rounding
from validation.execution.run_folder import write_run
from validation.execution.runs import run

CASE = Case("small", scene_from_dict(tomllib.loads(SCENE)))
ESTIMATE = 1e-3


@pytest.fixture
def folders(tmp_path, monkeypatch):
    """Writes a run into either folder; ``change(trace)`` makes the second differ."""
    monkeypatch.setitem(solvers.SOLVERS, "bem", named("bem", fake()))
    done = run(CASE, "bem")
    estimated = dict.fromkeys(("force", "contact_radius", "detachment_force"), ESTIMATE)

    def write(change, errors=estimated):
        other = change(done.trace)
        force = other.force[-1] if len(other) else None
        measures = done.measures | {"detachment_force": force}
        runs = {
            "one": dataclasses.replace(done, errors=errors),
            "two": dataclasses.replace(done, trace=other, measures=measures),
        }
        for name, one in runs.items():
            write_run(tmp_path / name / "runs/small/bem", CASE.scene, one)
        return [str(tmp_path / name) for name in runs]

    return write


def scaled(factor):
    return lambda trace: dataclasses.replace(trace, force=trace.force * factor)


def without_a_row(factor=1.0):
    def change(trace):
        columns = {name: np.delete(column, 7) for name, column in trace.columns().items()}
        return dataclasses.replace(trace, **columns | {"force": columns["force"] * factor})

    return change


@pytest.mark.parametrize(
    ("change", "code", "said"),
    [
        (lambda trace: trace, 0, "1 with the same rows, apart by at most 0.0e+00"),
        (scaled(1.0 + 5e-10), 0, "1 with the same rows, apart by at most 5.0e-10"),
        (scaled(1.0 - 0.09 * ESTIMATE), 0, "0 with the same rows"),
        (scaled(1.0 + 0.2 * ESTIMATE), 1, "FAILED: small: bem: detachment_force: 2 of what is allowed"),
        (scaled(1.0 - 0.2 * ESTIMATE), 1, "FAILED: small: bem: detachment_force: 2 of what is allowed"),
        (without_a_row(), 0, "other decisions: small: bem"),
        (without_a_row(1.0 + 0.5 * ESTIMATE), 1, "FAILED: small: bem"),
    ],
)
def test_what_rounding_may_do(folders, capsys, change, code, said):
    assert rounding.main(folders(change)) == code
    assert said in capsys.readouterr().out


def test_another_ending_is_no_rounding(folders, capsys):
    def change(trace):
        return dataclasses.replace(
            trace, outcome=dataclasses.replace(trace.outcome, kind=OutcomeKind.COMPLETED)
        )

    assert rounding.main(folders(change)) == 1
    assert "FAILED: small: bem: outcome" in capsys.readouterr().out


def test_other_rows_without_an_estimate_cannot_be_judged(folders, capsys):
    assert rounding.main(folders(without_a_row(), {})) == 1
    assert "FAILED: small: bem: no error estimate" in capsys.readouterr().out


def test_a_missing_run_is_a_failure(folders, capsys, tmp_path):
    one, _ = folders(lambda trace: trace)
    assert rounding.main([one, str(tmp_path / "none")]) == 1
    assert "FAILED: small: bem: run: inf" in capsys.readouterr().out


def test_a_small_term_of_the_balance_is_compared_with_the_balance(folders, capsys):
    def change(trace):
        return dataclasses.replace(trace, dissipated_energy=trace.dissipated_energy + 1e-16)

    assert rounding.main(folders(change)) == 0
    assert "1 with the same rows" in capsys.readouterr().out


@pytest.mark.parametrize("given", [[], ["one"], ["nowhere", "nowhere"]])
def test_bad_input_is_one_line(capsys, given):
    assert rounding.main(given) == 2
    assert capsys.readouterr().err.count("\n") == 1


def test_a_quantity_known_to_rounding_may_differ_by_rounding(folders, capsys):
    """The force where it is prescribed: an estimate of 1e-16 is no measure of what the last bit does."""

    def change(trace):
        other = scaled(1.0 + 1e-15)(trace)
        return dataclasses.replace(other, contact_radius=other.contact_radius * (1.0 + 1e-8))

    exact = {"force": 1e-17, "detachment_force": 1e-17, "contact_radius": ESTIMATE}
    assert rounding.main(folders(change, errors=exact)) == 0
    assert "other decisions: small: bem" in capsys.readouterr().out
