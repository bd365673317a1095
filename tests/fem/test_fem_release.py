"""Node-release closure on an elastic body: energy release, exact integrals, no ripple from node to node."""

import math
from functools import cache

import numpy as np
import pytest

from contact_scene import Adhesion, Cone, FlatPunch, ForceRamp, Loading, Material, Scene, Sphere
from fem_solver.components import Components
from fem_solver.contact_problem import ContactProblem
from fem_solver.edge import AdhesiveEdge
from fem_solver.edge_path import EdgeMotion, EdgePosition
from fem_solver.moduli import moduli
from fem_solver.placement import Surfaces
from fem_solver.state import nodal_forces, undeformed
from meshes import EdgeMeshes
from validation.reference.finite_zone import FiniteZone
from validation.solvers.finite_elements import FiniteElements

ZONE = 0.02
SOLID = Material(2.6, 0.3)
"""Of unit shear modulus."""
PLANE = 2.0 / (1.0 - 0.3)


@cache
def placement(divisions, sphere=True, zone=ZONE, unit=ZONE):
    """Zones may be longer than the unit in which the mesh has its divisions."""
    indenter = Sphere(1.0) if sphere else FlatPunch(1.0)
    scene = Scene(SOLID, indenter, Loading("relaxed", 0.0, ()), Adhesion(1e-4, zone))
    return Surfaces(scene, EdgeMeshes(unit, divisions, 0.3, 0.15), moduli(SOLID), True).around(0.2)


def problem(divisions, value, control="penetration", **more):
    here, solid = placement(divisions, **more), Components(moduli(SOLID).surface)
    return here.geometry, ContactProblem(here, solid, undeformed(here, 0), 0.0, control, value)


def forces(contact, s):
    return nodal_forces(contact.accepted(s), contact.placement, contact.solid)


def test_force_of_a_flat_punch_is_linear_in_its_radius():
    geometry, contact = problem(4, 0.1, sphere=False)
    for s in np.linspace(20.0, 90.0, 40):
        assert contact.force(s) == pytest.approx(2.0 * PLANE * geometry.radius(s) * 0.1, rel=1e-12)
        assert forces(contact, s).sum() == pytest.approx(contact.force(s), rel=1e-9)


def test_effective_radius_exceeds_the_last_node_by_a_fraction_of_an_element():
    geometry, _ = problem(4, 0.0)
    inside = slice(2, geometry.last)
    excess = (geometry.effective - geometry.radii)[inside] / (2.0 * geometry.radii[1])
    assert excess.min() > 0.0
    assert excess.max() < 0.25


@pytest.mark.parametrize(("zone", "bound"), [(ZONE, 1e-3), (1.074 * ZONE, 2.5e-3)])
def test_closure_matches_the_exact_integral_at_every_edge_position(zone, bound):
    """The second zone is no whole number of elements."""
    exact = FiniteZone(1.0, PLANE, 1.0, zone)
    geometry, contact = problem(5, 0.032, zone=zone)
    first = geometry.position(0.24)
    s = first + np.linspace(0.0, 3.0, 25)
    error = [contact.closure(x) / exact.closure(geometry.radius(x), 0.032) - 1.0 for x in s]
    assert np.abs(error).max() < bound
    assert np.ptp(error) < 1e-3


def test_closure_rises_without_ripple_although_nodes_are_released_one_by_one():
    geometry, contact = problem(3, 0.032, zone=1.123 * ZONE)
    s = geometry.position(0.21) + np.linspace(0.0, 6.0, 61)
    assert np.all(np.diff([contact.closure(x) for x in s]) > 0.0)


def test_closure_is_the_energy_released_per_area():
    # elastic, fixed grips: I = -dU/dA; energies from forces and displacements of whole states
    geometry, contact = problem(4, 0.0, zone=0.5 * ZONE)
    node = int(geometry.position(0.22))

    def energy(s):
        return 0.5 * forces(contact, s) @ contact.placement.displacement(contact.accepted(s).components)

    released = energy(node) - energy(node - 4)
    area = np.pi * (geometry.radius(node) ** 2 - geometry.radius(node - 4) ** 2)
    assert geometry.radius(node) - geometry.radius(node - 4) == pytest.approx(geometry.zone, rel=5e-3)
    mean = 0.5 * (contact.closure(node) + contact.closure(node - 4))
    assert mean == pytest.approx(released / area, rel=0.25 * geometry.zone / 0.22)  # bias of a finite zone


def test_edge_under_pressure_advances():
    geometry, contact = problem(4, 0.05)
    assert contact.closure(geometry.position(0.1)) == -np.inf
    law = AdhesiveEdge(geometry, 1e-4)
    found = law.seek(contact, geometry.position(0.1), 0.0, np.inf)
    assert found.motion is EdgeMotion.RESTING
    assert geometry.radius(found.s) > np.sqrt(0.05)


def test_force_control_finds_the_same_state_as_penetration_control():
    geometry, contact = problem(4, 0.01)
    law = AdhesiveEdge(geometry, 1e-3)
    settled = law.start(contact)
    _, other = problem(4, contact.force(settled.s), control="force")
    again = law.seek(other, settled.s + 2.0, 0.0, np.inf)
    assert again.s == pytest.approx(settled.s, abs=1e-6)
    assert other.penetration(again.s) == pytest.approx(0.01, rel=1e-8)


def test_search_reports_where_the_edge_ran_off():
    geometry, contact = problem(4, 0.03)
    weak, strong = AdhesiveEdge(geometry, 1e-12), AdhesiveEdge(geometry, 1.0)
    s = geometry.position(0.24)
    assert weak.seek(contact, s, s - 1.0, s + 1.0).motion is EdgeMotion.RECEDING
    assert strong.seek(contact, s, s - 1.0, s + 1.0) == EdgePosition(EdgeMotion.ADVANCING, s + 1.0)
    _, pulled = problem(4, -0.05)
    assert AdhesiveEdge(geometry, 1e-6).start(pulled).motion is EdgeMotion.RECEDING


def test_contact_at_a_tip_is_as_deep_as_a_cone_has_it_within_the_first_element():
    """Love's cone: ``D = (pi/2) a cot(angle)``, while the force grows from nothing."""
    cone, loading = Cone(60.0), Loading("jump-in", 0.0, (ForceRamp(1.0, 1.0),))
    scene, early = Scene(Material(0.75, 0.5), cone, loading), (1e-8, 1e-7, 1e-6, 1e-5)
    trace = FiniteElements().solve(scene, 4, stop_times=early)
    rows = np.searchsorted(trace.time, early)
    slope = 0.5 * math.pi / math.tan(math.radians(cone.half_angle))
    np.testing.assert_allclose(trace.penetration[rows], slope * trace.contact_radius[rows], rtol=0.06)
