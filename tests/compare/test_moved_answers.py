"""What a change of method has moved, over the estimates of both versions."""

from __future__ import annotations

import json

import pytest

from validation.compare.moved import main, moved


def report(pull_off: float, time: float, estimate: float, solver: str = "bem") -> dict:
    run = {
        "pull_off_force": pull_off,
        "detachment_time": time,
        "loop_energy": None,
        "error_estimates": {"pull_off_force": estimate, "detachment_time": estimate},
    }
    return {"format": 1, "scenes": [{"name": "one", "runs": {solver: run}, "checks": []}]}


def test_the_worst_answer_over_both_estimates():
    (found,) = moved(report(0.01, 2.0, 1e-3), report(0.0101, 2.002, 3e-3))
    assert found.quantity == "pull_off_force"
    assert found.difference == pytest.approx(1.0 / 101.0)
    assert found.share == pytest.approx(1.0 / 101.0 / 4e-3)


def test_rounding_is_no_move_and_other_solvers_are_left_out():
    (found,) = moved(report(0.01, 2.0, 1e-3), report(0.01 * (1.0 + 1e-15), 2.0, 1e-3))
    assert (found.quantity, found.share) == ("", 0.0)
    assert moved(report(0.01, 2.0, 1e-3), report(0.01, 2.0, 1e-3, "fem")) == []


@pytest.mark.parametrize(("now", "code"), [(0.010001, 0), (0.011, 1)])
def test_the_exit_code_tells_whether_an_answer_moved_beyond_its_estimates(tmp_path, capsys, now, code):
    files = [tmp_path / "old.json", tmp_path / "new.json"]
    for file, value in zip(files, (0.01, now), strict=True):
        file.write_text(json.dumps(report(value, 2.0, 1e-3)))
    assert main([str(file) for file in files]) == code
    assert "| one | " in capsys.readouterr().out
    assert main([str(files[0]), str(tmp_path / "none.json")]) == 2
    assert main([]) == 2
