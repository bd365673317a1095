"""Node-release closure on an elastic body: energy release, exact integrals, no ripple from node to node."""

from functools import cache

import numpy as np
import pytest

from fem_solver.condensed import Response
from fem_solver.edge import AdhesiveEdge, EdgeMotion
from fem_solver.edge_geometry import EdgeGeometry
from fem_solver.halfspace import HalfSpace
from fem_solver.release import ContactProblem
from fem_solver.surface import SurfaceOperator
from meshes import fit, structured_half_space
from validation.reference.finite_zone import FiniteZone

ZONE = 0.02
PLANE = 2.0 / (1.0 - 0.3)  # E* at unit shear modulus, nu = 0.3


@cache
def surface(divisions, offset=0.0):
    size = ZONE / (divisions + offset)
    mesh = structured_half_space(fit(0.0, 0.26, size, 1, margin=1.5 * divisions, grading=0.15))
    space = HalfSpace(mesh)
    count = int(np.searchsorted(space.radii, 1.2 * mesh.parameters.fine_to)) // 2 * 2 + 1
    compliance, _ = space.factorise(1.5 * 0.4 / 1.3, count).compliance()
    operator, radii = SurfaceOperator(compliance), space.radii[:count]
    return operator, radii, mesh.parameters.fine_to


def problem(divisions, penetration, sphere=True, offset=0.0, zone=ZONE, control="penetration"):
    operator, radii, reach = surface(divisions, offset)
    geometry = EdgeGeometry(radii, operator.effective_radii(PLANE), zone, reach, np.inf)
    response = Response(operator, 1.0, np.zeros(len(radii)))
    height = radii**2 / 2.0 if sphere else np.zeros(len(radii))
    return geometry, ContactProblem(geometry, response, height, control, penetration)


def test_force_of_a_flat_punch_is_linear_in_its_radius():
    geometry, contact = problem(4, 0.1, sphere=False)
    for s in np.linspace(20.0, 90.0, 40):
        assert contact.force(s) == pytest.approx(2.0 * PLANE * geometry.radius(s) * 0.1, rel=1e-12)
        assert contact.forces(s).sum() == pytest.approx(contact.force(s), rel=1e-9)


def test_effective_radius_exceeds_the_last_node_by_a_fraction_of_an_element():
    operator, radii, reach = surface(4)
    inside = radii < reach
    excess = (operator.effective_radii(PLANE) - radii)[inside][2:] / (2.0 * radii[1])
    assert excess.min() > 0.0
    assert excess.max() < 0.25


@pytest.mark.parametrize(("offset", "bound"), [(0.0, 1e-3), (0.37, 2.5e-3)])
def test_closure_matches_the_exact_integral_at_every_edge_position(offset, bound):
    exact = FiniteZone(1.0, PLANE, 1.0, ZONE)
    geometry, contact = problem(5, 0.032, offset=offset)
    first = geometry.position(0.24)
    s = first + np.linspace(0.0, 3.0, 25)
    error = [contact.closure(x) / exact.closure(geometry.radius(x), 0.032) - 1.0 for x in s]
    assert np.abs(error).max() < bound
    assert np.ptp(error) < 1e-3


@pytest.mark.parametrize(("control", "value"), [("penetration", 0.032), ("force", 0.02)])
def test_closure_between_two_nodes_is_the_work_of_the_forces_over_the_gaps(control, value):
    """The first evaluation between two nodes sets up a form that the others use."""
    geometry, contact = problem(5, value, offset=0.37, control=control)
    shift, height = geometry.shift, contact.geometry.radii**2 / 2.0
    first = float(int(geometry.position(0.24)))
    for s in first + np.linspace(0.0, 1.9, 8):
        forces, top = contact.forces(s), int(s) + 1
        gap = height - contact.penetration(s) + contact.operator.displacement(forces)
        start, end = shift.nodes(int(s), top)
        direct = shift.closure(start, forces[start : top + 1], gap[top:end])
        assert contact.closure(s) == pytest.approx(direct, rel=1e-8)


def test_closure_rises_without_ripple_although_nodes_are_released_one_by_one():
    geometry, contact = problem(3, 0.032, offset=0.37)
    s = geometry.position(0.21) + np.linspace(0.0, 6.0, 61)
    assert np.all(np.diff([contact.closure(x) for x in s]) > 0.0)


def test_closure_is_the_energy_released_per_area():
    # elastic, fixed grips: I = -dU/dA; energies from forces and displacements of whole states
    geometry, contact = problem(4, 0.0, sphere=True, zone=2.0 * surface(4)[1][2])
    node = int(geometry.position(0.22))

    def energy(s):
        forces = contact.forces(s)
        return 0.5 * forces @ contact.operator.displacement(forces)

    zone = geometry.zone
    released = energy(node) - energy(node - 4)
    area = np.pi * (geometry.radius(node) ** 2 - geometry.radius(node - 4) ** 2)
    assert geometry.radius(node) - geometry.radius(node - 4) == pytest.approx(zone, rel=5e-3)
    mean = 0.5 * (contact.closure(node) + contact.closure(node - 4))
    assert mean == pytest.approx(released / area, rel=0.25 * zone / 0.22)  # bias of a finite zone


def test_edge_under_pressure_advances():
    _, contact = problem(4, 0.05)
    geometry = contact.geometry
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
    assert strong.seek(contact, s, s - 1.0, s + 1.0) == type(strong.start(contact))(
        EdgeMotion.ADVANCING, s + 1.0
    )
    _, pulled = problem(4, -0.05)
    assert AdhesiveEdge(geometry, 1e-6).start(pulled).motion is EdgeMotion.RECEDING
