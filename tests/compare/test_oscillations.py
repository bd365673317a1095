"""Cycles that rise and pull alike: solvers with other rows agree about what does not depend on the rows."""

from __future__ import annotations

import numpy as np
import pytest

import crosscontact as cc
from contact_scene import Counters
from crosscontact.cli import main
from validation.cases import Case
from validation.compare.checks import against_reference
from validation.measure.observables import measure
from validation.runs.run import Run

SLOW = pytest.mark.slow
CYCLES = (cc.Oscillate(0.002, 1.0, 14.0),)
ELASTIC = cc.Material(0.75, 0.5)
RUBBER = cc.Material(0.75, 0.5, (cc.Branch(6.75, 1.0),))


def punch(material, *steps, adhesion=None, stiffness=None):
    machine = None if stiffness is None else cc.Machine(stiffness)
    loading = cc.Loading("relaxed", 0.002, steps, machine)
    return cc.Scene(material, cc.FlatPunch(0.2), loading, adhesion, "a punch")


SCENES = {
    "contact kept": punch(RUBBER, cc.Ramp(0.02, 0.1), *CYCLES),
    "contact lost": punch(RUBBER, cc.Ramp(0.004, 0.1), cc.Oscillate(0.004, 1.0, 14.0)),
    "after a force": punch(RUBBER, cc.Force(0.01, 5.0), *CYCLES),
    "on a spring": punch(RUBBER, cc.Ramp(0.02, 0.1), *CYCLES, stiffness=2.0),
    "cycles that pull alike": punch(
        ELASTIC, cc.Oscillate(0.004, 1.0, 14.0), adhesion=cc.Adhesion(5e-4, 0.013)
    ),
}


@pytest.mark.parametrize(
    "name",
    [pytest.param(name, marks=() if name == "contact lost" else SLOW) for name in SCENES],
)
def test_three_solvers_agree_on_an_oscillating_punch(name, tmp_path, capsys):
    cc.write_scene(SCENES[name], tmp_path / "punch.toml")
    code = main(["compare", str(tmp_path / "punch.toml"), "--jobs", "1"])
    said = capsys.readouterr()
    assert code == 0, said.out + said.err
    assert {"bem", "fem", "reference"} <= set(said.out.split())


def test_all_take_the_same_crest():
    """The reference and finite elements step onto crests, boundary elements pass over them."""
    results = cc.compare(SCENES["after a force"], estimate_errors=False).results
    times = {solver: result.approach.time for solver, result in results.items()}
    first = 5.0 + 0.5 * np.pi
    assert times == pytest.approx(dict.fromkeys(results, first), abs=0.1)


def checked(turns, pulled, other_pulled):
    """Quantities compared of two runs: tension at the bottom of each cycle, and what the other run has."""
    time = np.linspace(0.0, 2.0 * np.pi * len(pulled), 40 * len(pulled) + 1)[:-1]
    scene = punch(ELASTIC, *turns)
    runs = []
    for solver, sizes in (("bem", other_pulled), ("reference", pulled)):
        force, zero = 0.1 + np.repeat(sizes, 40) * np.sin(time), np.zeros_like(time)
        columns = (time, 0.002 * np.sin(time), force, zero + 0.2, zero, zero, zero)
        outcome = cc.Outcome(cc.OutcomeKind.COMPLETED, "by hand", float(time[-1]))
        trace = cc.Trace(solver, *columns, outcome, Counters())
        runs.append(Run("by hand", solver, trace, measures=measure(trace, scene, 0.0)))
    return {check.quantity: check for check in against_reference(Case("by hand", scene), *runs)}


def test_of_cycles_that_pull_alike_the_time_is_not_compared():
    cycles, ramps = CYCLES, (cc.Ramp(0.01, 0.01), cc.Ramp(-0.5, 0.01))
    alike = checked(cycles, [1.0, 1.001, 1.0], [1.001, 1.0, 1.0])
    assert "pull_off_time" not in alike
    assert "approach_force" not in alike
    assert alike["pull_off_force"].passed
    apart = checked(cycles, [1.0, 1.2, 1.0], [1.2, 1.0, 1.0])
    assert not apart["pull_off_time"].passed
    straight = checked(ramps, [1.0, 1.001, 1.0], [1.001, 1.0, 1.0])
    assert not straight["pull_off_time"].passed
    assert straight["approach_force"].passed
