"""Scenes as a first user writes them, and cycles that rise and pull alike: `compare` agrees on right runs."""

from __future__ import annotations

import numpy as np
import pytest
from support.synthetic_traces import by_hand

import crosscontact as cc
from crosscontact.cli import main
from validation.cases import Case
from validation.compare.checks import against_reference
from validation.measure.observables import measure
from validation.runs.run import Run

GEL = """[material]
modulus = 2e4
poisson = 0.45
branches = [{ modulus = 1e4, time = 0.3 }]
"""
STIFF = """[material]
modulus = 1.8e6
poisson = 0.5
branches = [{ modulus = 2e6, time = 0.1 }, { modulus = 1e6, time = 2.0 }]
"""
SOFT = """[material]
modulus = 1e3
poisson = 0.49
branches = [{ modulus = 2e4, time = 1.0 }]
"""
REST, PULLED = '{ kind = "hold", duration = 2.0 }', '{ kind = "ramp", to = -5e-4, rate = 1e-4 }'
HELD = '{ kind = "ramp", to = 1e-4, rate = 1e-3 }, { kind = "hold", duration = 3.0 }'
BACK = '{ kind = "ramp", to = -1e-5, rate = 1e-3 }'
PLAIN = {
    "a ball pressed in and held": (GEL, 'shape = "sphere"\nradius = 5e-3', 1e-5, HELD),
    "a cone comes from above": (GEL, 'shape = "cone"\nhalf_angle = 75', -2e-5, f"{HELD}, {BACK}"),
    "a punch comes from above": (GEL, 'shape = "flat-punch"\nradius = 1e-3', -2e-5, f"{HELD}, {BACK}"),
    "a blunt tip": (GEL, 'shape = "power-law"\nexponent = 4\ncoefficient = 5e7', 0.0, f"{HELD}, {BACK}"),
    "two dead loads": (
        STIFF,
        'shape = "sphere"\nradius = 2e-3',
        1e-6,
        '{ kind = "force", value = 1e-2, duration = 5 }, { kind = "force", value = 1e-3, duration = 5 }',
    ),
    "a dead load that lowers a punch": (
        GEL,
        'shape = "flat-punch"\nradius = 1e-3',
        -1e-5,
        '{ kind = "force", value = 1e-3, duration = 3 }, { kind = "force-ramp", to = 0, rate = 1e-3 }',
    ),
    "a ball on a spring": (
        GEL,
        'shape = "sphere"\nradius = 5e-3',
        0.0,
        f"{HELD}, {BACK}",
        "[machine]\nstiffness = 100\n",
    ),
    "the usual test: until a force, hold, back": (
        GEL,
        'shape = "sphere"\nradius = 5e-3',
        0.0,
        f'{{ kind = "ramp", to = 1e-3, rate = 1e-4, until_force = 1e-3 }}, {REST}, {PULLED}',
        "[adhesion]\nwork = 0.02\nzone = 2e-5\n",
    ),
    "a soft rubber until a force": (
        SOFT,
        'shape = "power-law"\nexponent = 3\ncoefficient = 3e4',
        -1e-5,
        f'{{ kind = "ramp", to = 1e-3, rate = 1e-4, until_force = 3e-5 }}, {REST}, {BACK}',
    ),
}
EXHAUSTIVE = {"a cone comes from above", "a ball on a spring", "a blunt tip", "a soft rubber until a force"}
EXHAUSTIVE |= {"the usual test: until a force, hold, back", "two dead loads"}


@pytest.mark.slow
@pytest.mark.parametrize(
    "name",
    [pytest.param(name, marks=[pytest.mark.exhaustive] * (name in EXHAUSTIVE)) for name in PLAIN],
)
def test_compare_agrees_with_right_runs(name, tmp_path, capsys):
    material, indenter, start, steps, *machine = PLAIN[name]
    path = tmp_path / "plain.toml"
    loading = f'[loading]\nstart = "relaxed"\npenetration = {start}\nsteps = [{steps}]\n'
    path.write_text("\n".join((material, "[indenter]", indenter, loading, *machine)))
    code = main(["compare", str(path)])
    told = capsys.readouterr().out
    assert "FAIL" not in told
    assert code == 0


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
    [pytest.param(name, marks=() if name == "contact lost" else pytest.mark.slow) for name in SCENES],
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
        rows = {"penetration": 0.002 * np.sin(time), "contact_radius": 0.2}
        force = 0.1 + np.repeat(sizes, 40) * np.sin(time)
        trace = by_hand(time, solver=solver, force=force, **rows)
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
