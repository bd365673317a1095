"""Check values of the scenes whose adhesion knows direction, speed or stress, worked out again."""

import math

import numpy as np
import pytest
from support.closed_forms.adhesion_hysteresis import AdhesionHysteresis
from support.closed_forms.fixed_stress import FixedStressContact

from validation.cases import load
from validation.measure.scaling import unit_sizes
from validation.reference.finite_zone import FiniteZone
from validation.reference.rated_edge import RatedEdge

RADIUS, MODULUS, WORK, CLOSING, ZONE = 1e-3, 1e6, 0.5, 0.2, 1.3e-5
OPENING = FiniteZone(RADIUS, MODULUS, WORK, ZONE)
CLOSED = FiniteZone(RADIUS, MODULUS, CLOSING, ZONE)


def stated(name, observable):
    """A check value in SI units."""
    case = load(name)
    (found,) = [check for check in case.expected if check.observable == observable]
    return found.value * unit_sizes(case.scene)[found.unit]


def work_along(states):
    """``int F dD`` by trapezoids."""
    force = np.array([state.force for state in states])
    depth = np.array([state.penetration for state in states])
    return float(np.sum(0.5 * (force[1:] + force[:-1]) * np.diff(depth)))


def test_hysteresis():
    name = "hysteresis-si"
    law = AdhesionHysteresis(OPENING, CLOSED, MODULUS)
    start, top, low = law.path([0.0, 2e-5, 8e-6])
    assert stated(name, "start_radius") == pytest.approx(start.contact_radius, rel=1e-7)
    assert stated(name, "approach_radius") == pytest.approx(top.contact_radius, rel=1e-7)
    assert stated(name, "approach_force") == pytest.approx(top.force, rel=1e-6)
    assert stated(name, "pull_off_force") == pytest.approx(-OPENING.pull_off_force_control().force, rel=1e-7)
    last = OPENING.pull_off_penetration_control()
    assert stated(name, "detachment_penetration") == pytest.approx(last.penetration, rel=1e-7)
    up = [CLOSED.state(a) for a in np.linspace(start.contact_radius, top.contact_radius, 400)]
    down = [OPENING.state(a) for a in np.linspace(top.contact_radius, last.contact_radius, 400)]
    assert low.contact_radius < top.contact_radius  # the small cycle on its vertical line costs nothing
    assert stated(name, "loop_energy") == pytest.approx(work_along([*up, *down]), rel=1e-4)


def test_rated_edge():
    name = "rated-edge-si"
    adhesion = load(name).scene.adhesion
    first = OPENING.at_penetration(2e-5)
    times = np.linspace(0.0, 28.0, 28001)
    radius = RatedEdge(adhesion, OPENING.closure).radii(first.contact_radius, 2e-5, 2e-6, times, ZONE)
    depth = 2e-5 - 2e-6 * times
    force = 2.0 * MODULUS * (radius * depth - radius**3 / (3.0 * RADIUS))
    ended = np.isfinite(radius)
    assert stated(name, "start_radius") == pytest.approx(first.contact_radius, rel=1e-7)
    assert stated(name, "pull_off_force") == pytest.approx(-np.nanmin(force), rel=1e-6)
    assert stated(name, "final_penetration") == pytest.approx(depth[ended][-1], rel=1e-4)
    moved = slice(0, 20001, 20)  # until 20, dense enough for the trapezoids
    taken = np.array([OPENING.closure(*state) for state in zip(radius[moved], depth[moved], strict=True)])
    spent = -np.sum(0.5 * (taken[1:] + taken[:-1]) * np.diff(np.pi * radius[moved] ** 2))
    assert stated(name, "separation_energy") == pytest.approx(spent, rel=1e-6)
    work = np.sum(0.5 * (force[1:] + force[:-1])[ended[1:]] * np.diff(depth)[ended[1:]])
    assert stated(name, "loop_energy") == pytest.approx(work, rel=1e-4)


def test_fixed_stress():
    name = "fixed-stress-si"
    law = FixedStressContact(RADIUS, MODULUS, WORK, 1e-9, 2e5)
    first, last = law.at_penetration(2e-5), law.pull_off_penetration_control()
    assert stated(name, "start_radius") == pytest.approx(first.contact_radius, rel=1e-7)
    assert stated(name, "start_force") == pytest.approx(first.force, rel=1e-6)
    assert stated(name, "pull_off_force") == pytest.approx(-law.pull_off_force_control().force, rel=1e-7)
    assert stated(name, "detachment_penetration") == pytest.approx(last.penetration, rel=1e-7)
    way = [law.state(a) for a in np.linspace(first.contact_radius, last.contact_radius, 300)]
    assert stated(name, "loop_energy") == pytest.approx(work_along(way), rel=1e-4)
    assert load(name).scene.adhesion.zone == pytest.approx(math.pi * MODULUS * WORK / (4.0 * 2e5**2))
