"""The mesh that follows the edge: steps farther than its fine strip, and the rim of a punch."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from numpy.typing import ArrayLike

from contact_scene import (
    Adhesion,
    Approach,
    Branch,
    Cone,
    FlatPunch,
    Force,
    Loading,
    Material,
    Oscillate,
    OutcomeKind,
    Ramp,
    Scene,
    Sphere,
)
from fem_solver.components import Components
from fem_solver.moduli import Prony
from fem_solver.surface_record import SurfaceRecord, averaged, interpolated
from validation.reference import path as reference
from validation.solvers.finite_elements import FiniteElements

TWO = Material(0.3, 0.49, (Branch(2.0, 0.05), Branch(1.0, 5.0)))
PRESSED = Loading("jump-in", 10.0, (Ramp(20.0, 1.0), Ramp(-200.0, 20.0)))
CONE = Scene(TWO, Cone(75.0), PRESSED, Adhesion(0.1, 0.05))
CONE_PULL_OFF = 387.3240
"""Of ``CONE``, by front tracking."""
ONE = Material(1.0, 0.49, (Branch(4.0, 0.3),))
AWAY, BACK = Ramp(-0.1, 0.02), Ramp(1e-3, 0.02)
PUNCH = Scene(
    ONE, FlatPunch(1.0), Loading("relaxed", 1e-3, (AWAY, BACK, Ramp(-1.0, 0.02))), Adhesion(1e-3, 1e-3)
)
PUNCH_PULL_OFF, PUNCH_LOOP = 0.3933058, 0.04073106
"""Of ``PUNCH``, by front tracking."""

DEPTH, SWING, FREQUENCY = 0.0114, 1e-3, 100.0
DENTED = Scene(
    Material(1.0, 0.0, (Branch(9.0, 1.0),)),
    Cone(83.0),
    Loading("relaxed", DEPTH, (Oscillate(-SWING, FREQUENCY, 1.6 * np.pi / FREQUENCY),)),
    Adhesion(5e-6, 2e-4),
)
"""A cone that has rested is lifted and pressed back in far less than the relaxation time: the surface keeps
the dent, along which the edge goes over two thirds of the radius and back."""


SOLID = Components(Prony(0.75, np.array([6.75]), np.array([1.0])))


def record(positions: ArrayLike, intensity: ArrayLike, edge: int) -> SurfaceRecord:
    """Points of a body with one branch, under a paraboloid."""
    x = np.asarray(positions, float)
    return SurfaceRecord(x, np.asarray(intensity, float)[None], x**2, edge)


def test_a_record_is_renewed_where_the_mesh_is_fine():
    known = record([1.0, 2.0, 3.0, 4.0, 9.0], [5.0, 1.0, 7.0, 2.0, 4.0], edge=3)
    nodes = record([0.0, 2.5, 5.0, 7.0, 7.1, 7.2, 9.5], [50.0] * 7, edge=4)
    found = known.renewed(nodes, slice(2, 6))
    assert found.positions.tolist() == [1.0, 2.0, 3.0, 4.0, 5.0, 7.0, 7.1, 7.2, 9.0]
    assert found.intensity[0].tolist() == [5.0, 1.0, 7.0, 2.0, 50.0, 50.0, 50.0, 50.0, 4.0]
    assert found.positions[: found.edge].max() == 7.0


def test_points_are_covered_in_their_own_time():
    """Virgin ground, passed at constant speed: each point relaxes from the jump of its own moment."""
    known = record([1.0, 1.1, 1.2, 3.0], [0.0] * 4, edge=1)  # the second one is released in part
    nodes = record([0.5, 1.0, 1.5, 1.7, 2.5, 3.5], [0.0] * 6, edge=4)
    found = known.after(SOLID, 2.0, (4.0, 0.0, 0.0), 2.0, lambda x: x - 1.0, nodes)
    assert found.positions.tolist() == [1.0, 1.2, 1.5, 1.7, 3.0]
    assert found.edge == 4
    passed = found.positions[1:4]
    expected = 6.75 * (4.0 - passed**2) * np.exp(-2.0 * (2.0 - passed))
    assert found.intensity[0, 1:4] == pytest.approx(expected, rel=1e-13)
    assert found.intensity[0, [0, 4]].tolist() == [0.0, 0.0]


def test_points_are_released_in_their_own_time():
    """Each loses its force at once and recovers: with one branch at the rate of retardation."""
    known = record([1.0, 1.5, 2.0, 2.1], [0.0] * 4, edge=3)
    nodes = record([0.5, 1.7, 2.5], [0.0] * 3, edge=1)
    found = known.after(SOLID, 2.0, (1.0, 0.0, 0.0), 1.2, lambda x: 2.0 - x, nodes)
    assert found.positions.tolist() == [1.0, 1.5, 1.7, 2.0]
    assert found.edge == 1
    x = found.positions[1:]
    jump = -6.75 / 7.5 * 0.75 * (1.0 - x**2)
    expected = jump * np.exp(-0.1 * 2.0 * (x - 1.0))
    assert found.intensity[0, 1:] == pytest.approx(expected, rel=1e-13)


@pytest.mark.parametrize("free", [True, False])
def test_the_record_is_read_the_same_after_it_has_been_thinned(free):
    """Straight on both sides of where an edge has rested, from where the points are close together."""
    rest = 0.067 - np.geomspace(0.045, 1e-6, 300)
    outer = np.concatenate([rest, 0.067 + np.geomspace(1e-6, 0.08, 40)])
    values = np.interp(outer, [0.0, 0.067, 0.2], [0.1, 0.03, 0.02])
    strip = np.linspace(0.0215, 0.0219, 200)
    at, here = np.linspace(0.0225, 0.14, 2000), np.interp(strip, [0.0, 0.067], [0.1, 0.03])
    sign = 1.0 if free else -1.0  # in contact all is mirrored
    nodes = record(np.sort(sign * strip), here[:: int(sign)], 0 if free else strip.size)
    known = record(np.sort(sign * outer), values[:: int(sign)], 0 if free else outer.size)
    for _ in range(20):
        known = known.renewed(nodes, slice(strip.size))
    read = interpolated(known.positions, known.intensity, sign * at)[0]
    expected = np.interp(at, outer, values)
    assert np.abs(read - expected).max() < 2e-5 * values.max()
    assert known.positions.size < strip.size + 60


def test_means_of_lines_are_those_of_their_integral():
    """Also over intervals between points, beyond them, and of no width."""
    x, values = np.array([1.0, 1.5, 3.0]), np.array([[2.0, -1.0, 5.0]])
    bounds = np.array([0.5, 1.2, 1.3, 1.3, 2.0, 4.0])
    fine = np.linspace(0.0, 5.0, 500001)
    line = np.interp(fine, x, values[0])
    expected = [line[(fine >= a) & (fine <= b)].mean() for a, b in pairwise(bounds)]
    assert averaged(x, values, bounds)[0] == pytest.approx(expected, abs=1e-4)


@pytest.mark.slow
def test_an_edge_returns_over_what_it_has_just_left():
    """The dent keeps its form: at the same penetration the edge is where it was before."""
    trace = FiniteElements().solve(DENTED, 2)
    turn = int(trace.contact_radius.argmin())
    depth = np.linspace(trace.penetration[turn] + 0.01 * SWING, trace.penetration[-1], 12)
    before, after = slice(turn, None, -1), slice(turn, None)
    left, covered = (np.interp(depth, trace.penetration[s], trace.contact_radius[s]) for s in (before, after))
    assert trace.contact_radius[turn] < 0.34 * trace.contact_radius[0]
    assert np.abs(covered - left).max() < 3.0 * DENTED.adhesion.zone
    assert not trace.events


@pytest.mark.slow
def test_a_cone_pressed_in_slowly_and_pulled_off_at_once():
    """Steps of the approach pass over more than the fine strip, and leave a smooth surface all the same."""
    trace = FiniteElements().solve(CONE, 4)
    assert -trace.force.min() == pytest.approx(CONE_PULL_OFF, rel=4e-3)


@pytest.mark.slow
def test_elements_of_a_billionth_of_the_radius():
    """The radii at which components sit are read from stiffnesses, whose rounding may exchange neighbours."""
    loading = Loading("relaxed", 8e-7, (Ramp(-6e-6, 4e-6),))
    material = Material(2.2e4, 0.42, (Branch(6e4, 0.03),))
    scene = Scene(material, Sphere(3.7e-5), loading, Adhesion(0.03, 3.7e-13))
    trace, other = FiniteElements().solve(scene), reference.solve(scene)
    assert trace.outcome.kind is other.outcome.kind is OutcomeKind.COMPLETED
    assert trace.force[-1] == pytest.approx(other.force[-1], rel=1e-3)
    assert trace.contact_radius[-1] == pytest.approx(other.contact_radius[-1], rel=1e-3)
    assert trace.external_work[-1] == pytest.approx(other.external_work[-1], rel=3e-3)


@pytest.mark.parametrize("control", [pytest.param("penetration", marks=pytest.mark.slow), "force"])
def test_contact_with_a_punch_rests_at_the_rim_and_returns_to_it(control):
    steps = (AWAY, BACK) if control == "penetration" else (Force(-0.24, 3.0), Force(0.05, 3.0))
    trace = FiniteElements().solve(replace(PUNCH, loading=Loading("relaxed", 0.0, steps)), 4)
    assert trace.outcome.finished
    assert trace.contact_radius.max() == trace.contact_radius[0] == pytest.approx(1.0, rel=1e-12)
    assert trace.contact_radius.min() < 1.0 - 0.2 * 1e-3
    assert trace.contact_radius[-1] == trace.contact_radius[0]
    assert np.isfinite(trace.force).all()


def test_an_edge_sets_off_from_the_rim_in_a_row_of_its_own():
    """A step in which it rested and moved left it 8e-4 of the radius behind, and the pull-off 1.5e-3 off."""
    gel, steps = Material(2e4, 0.5, (Branch(1.8e5, 0.1),)), (Approach(1e-4, 5e-3, retract=1e-4),)
    scene = Scene(gel, FlatPunch(7e-4), Loading("jump-in", 0.0, steps), Adhesion(1.0, 2e-5))
    assert FiniteElements().solve(scene, 7).force.min() == pytest.approx(-0.025490, rel=5e-4)


@pytest.mark.slow
def test_pull_off_of_a_punch_with_a_short_zone():
    """A zone of a thousandth of the radius, for which a mesh that is fine inside takes 26 GB."""
    trace = FiniteElements().solve(PUNCH)
    assert -trace.force.min() == pytest.approx(PUNCH_PULL_OFF, rel=3e-3)
    assert trace.external_work[-1] == pytest.approx(PUNCH_LOOP, rel=3e-3)
    assert trace.counters.steps < 400
