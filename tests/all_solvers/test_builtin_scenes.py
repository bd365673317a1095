"""The built-in scenes: every file reads, every check can be evaluated, none is without a statement."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
from scipy.integrate import quad

from contact_scene import Loading, Oscillate, Ramp, Sweep
from validation.cases import load
from validation.compare.suite import all_pairs
from validation.measure.scaling import unit_sizes
from validation.measure.windows import cycle_times
from validation.reference.finite_zone import FiniteZone
from validation.reference.ting import Ting
from validation.scenes import FOLDER, SUITES, names, suite


def test_every_scene_has_its_checks_and_the_other_way_round():
    scenes = {f.name.removesuffix(".toml") for f in FOLDER.glob("*.toml") if ".checks" not in f.name}
    assert scenes == set(names())
    assert len(scenes) >= 25


@pytest.mark.parametrize("name", names())
def test_scene_reads_and_its_checks_make_sense(name):
    case = load(name)
    assert case.statement
    assert case.scene.title
    assert case.outcome in ("completed", "detached", "out of the model's range")
    assert set(case.suites) <= set(SUITES)
    assert "full" in case.suites
    compared = {"bem", "fem", "reference"} - set(case.too_long_for)
    assert set(case.tolerances) == compared - {"reference"}
    for expected in case.expected:
        assert expected.unit in unit_sizes(case.scene)
        assert expected.source
        assert sum(x is not None for x in (expected.value, expected.at_most, expected.at_least)) == 1
        if expected.value is not None:
            assert set(expected.tolerance) == compared
            assert all(0 < tolerance <= 0.1 for tolerance in expected.tolerance.values())


def test_a_solver_for_which_a_scene_takes_too_long_is_run_only_where_it_is_named():
    case = dataclasses.replace(load("cycle-v0.1"), too_long_for=("bem",))
    assert {solver for _, solver in all_pairs([case])} == {"fem", "reference"}
    assert [solver for _, solver in all_pairs([case], ["bem", "reference"])] == ["bem", "reference"]
    assert not any(load(name).too_long_for for name in names())


def test_suites_grow():
    quick, paper, full = (set(suite(name)) for name in SUITES)
    assert quick < paper < full == set(names())


def test_units_of_the_si_cycle_agree_with_the_dimensionless_one():
    si, plain = unit_sizes(load("cycle-si").scene), unit_sizes(load("cycle-v0.02").scene)
    assert si["length"] == pytest.approx(1e-3)
    assert si["jkr-force"] / si["force"] == pytest.approx(plain["jkr-force"] / plain["force"])
    assert plain["jkr-force"] / plain["force"] == pytest.approx(7.53982e-4, rel=1e-6)


def test_cycle_times():
    sweep = cycle_times(load("sweep").scene.loading)
    assert 0.5 * 0.006 * sweep[10] ** 2 == pytest.approx(20 * np.pi)
    assert len(sweep) == 85
    steady = cycle_times(load("oscillation-w1.4").scene.loading)
    assert steady[3] == pytest.approx(3 * 2 * np.pi / 1.4)
    assert cycle_times(load("cycle-v0.1").scene.loading) == ()
    assert cycle_times(load("force-2").scene.loading) == ()
    swing = Oscillate(1e-3, 2.0 * np.pi, 3.0)
    reached = Ramp(0.02, 0.1, until_force=1e-3)
    assert cycle_times(Loading("relaxed", 0.0, (reached, swing))) == ()  # the run will tell when
    assert cycle_times(Loading("relaxed", 0.0, (swing, reached))) == (0.0, 1.0, 2.0, 3.0)


@pytest.mark.parametrize("step", [Oscillate(1e-3, 2.0 * np.pi, 1.1e6), Sweep(1e-3, 2.2e6 * 2.0 * np.pi, 1.0)])
def test_more_cycles_than_any_solver_takes_are_not_listed(step):
    assert cycle_times(Loading("relaxed", 0.0, (step,))) == ()


@pytest.mark.parametrize("name", ["relaxed-equilibrium", "elastic-relaxed", "elastic-glassy"])
def test_check_values_of_elastic_scenes_are_those_of_the_finite_zone(name):
    case = load(name)
    scene = case.scene
    exact = FiniteZone(
        scene.indenter.radius,
        scene.material.relaxed_plane_modulus,
        scene.adhesion.work,
        scene.adhesion.zone,
    )
    start = exact.at_penetration(scene.loading.penetration)
    lost = exact.pull_off_penetration_control().contact_radius
    least = exact.pull_off_penetration_control().penetration

    def surplus(a):
        return (exact.energy_release_rate(a) - scene.adhesion.work) * 2.0 * np.pi * a

    found = {
        "dissipated_energy": quad(surplus, lost, start.contact_radius, epsrel=1e-9, epsabs=0.0)[0],
        "start_radius": start.contact_radius,
        "start_force": start.force,
        "pull_off_force": -exact.pull_off_force_control().force,
        "detachment_radius": lost,
        "detachment_penetration": least,
    }
    stated = [e for e in case.expected if e.source.startswith("exact elastic field")]
    assert stated
    for expected in stated:
        size = unit_sizes(scene)[expected.unit]
        flat = 1e-5 if expected.observable == "detachment_radius" else 2e-6  # the place of a minimum
        assert expected.value * size == pytest.approx(found[expected.observable], rel=flat, abs=0.0)


def test_check_values_of_the_adhesionless_scene_are_those_of_lee_radok_and_ting():
    case = load("adhesionless-cycle")
    exact = Ting(case.scene.material, case.scene.indenter, rise=0.05, peak=1.0, fall=0.05)
    for expected in case.expected:
        if expected.observable == "detachment_time":
            found = exact.detachment()
        elif expected.observable == "detachment_penetration":
            found = exact.penetration(exact.detachment())
        else:
            column = exact.force if expected.observable.endswith("force") else exact.contact_radius
            found = column(1.0 if expected.at_time is None else expected.at_time)
        assert expected.value == pytest.approx(float(found), rel=3e-6)
