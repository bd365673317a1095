"""The node next to the edge, in contact in part, keeps the history of its part in contact."""

import math

import numpy as np
import pytest
from support.paper_scenes import ONE, WORK

from contact_scene import (
    Adhesion,
    Branch,
    BulkRelaxation,
    Counters,
    Hold,
    Loading,
    Material,
    Ramp,
    Scene,
    Sphere,
)
from fem_solver import Options, solve
from fem_solver.contact_solver import ContactSolver
from fem_solver.edge_geometry import EdgeGeometry
from fem_solver.following.contact_solver import FollowingContactSolver
from fem_solver.following.setup import set_up_following
from fem_solver.setup import set_up
from meshes import EdgeMeshes, fit, structured_half_space

ZONE, DEPTH = 0.02, 0.01
TWO = Material(0.75, 0.3, (Branch(6.0, 1.0), Branch(0.75, 0.05)))
APART = Material(0.75, 0.3, (Branch(6.0, 1.0),), bulk=BulkRelaxation(1.0, (Branch(2.0, 0.3),)))
LOADING = Loading("relaxed", DEPTH, (Hold(1.0),))


def contact(material: Material, path: str = "auto") -> ContactSolver:
    scene = Scene(material, Sphere(1.0), LOADING, Adhesion(WORK, ZONE))
    setup = set_up(scene, structured_half_space(fit(0.0, 0.16, ZONE, 1)), Options(path=path))
    return ContactSolver(setup, Counters(), lambda: None)


def accepted(solver: ContactSolver, dt: float, penetration: float, radius: float) -> np.ndarray:
    """Nodal forces after a step that ends with the edge at a radius."""
    candidate = solver.held(dt, "penetration", penetration, radius)
    forces = candidate.problem.forces(candidate.edge.s)
    solver.accept(candidate, forces)
    return forces


def radii_within_a_node(geometry: EdgeGeometry) -> list[float]:
    return [geometry.radius(16.0 + share) for share in (0.8, 0.3, 0.6, 0.1)]


@pytest.mark.parametrize(
    ("material", "path", "bound"),
    [(TWO, "condensed", 1e-12), (TWO, "quadrature", 1e-9), (APART, "quadrature", 5e-2)],
    ids=["condensed", "quadrature", "apart"],
)
def test_nothing_changes_in_no_time_where_nothing_moves(material, path, bound):
    """Ten times stiffer at once, the half-space bears what the relaxed one bore, whatever came before.

    Where shear and bulk relax apart, a node alone answers at different ratios of them a little differently.
    """
    solver = contact(material, path)
    first, *others = radii_within_a_node(solver.setup.geometry)
    accepted(solver, math.inf, DEPTH, first)
    for radius, dt in zip(others, (0.3, 2.0, 10.0), strict=True):
        before = accepted(solver, dt, DEPTH, radius)
        after = solver.held(0.0, "penetration", DEPTH, radius)
        error = after.problem.forces(after.edge.s) - before
        assert np.abs(error).max() < bound * np.abs(before).max()


def test_nor_where_the_mesh_follows_the_edge():
    meshes = EdgeMeshes(ZONE, 4, 0.16)
    setup = set_up_following(Scene(ONE, Sphere(1.0), LOADING, Adhesion(WORK, ZONE)), meshes, Options())
    solver = FollowingContactSolver(setup, Counters())
    start = solver.start("penetration", DEPTH, relaxed=True)
    forces = start.problem.forces(start.edge.s)
    solver.accept(start, forces)
    after = solver.held(0.0, "penetration", DEPTH, solver.radius(start))
    assert 0.1 < start.edge.s % 1.0 < 0.9
    assert np.abs(after.problem.forces(after.edge.s) - forces).max() < 1e-9 * np.abs(forces).max()


def test_the_part_in_contact_relaxes_as_a_whole_node_would():
    """At a fixed penetration all forces fall by the same share, from glass on."""
    solver = contact(TWO)
    radius = solver.setup.geometry.radius(16.4)
    glassy = accepted(solver, 0.0, DEPTH, radius)
    later = solver.held(0.4, "penetration", DEPTH, radius)
    falls = (0.75 + 6.0 * math.exp(-0.4) + 0.75 * math.exp(-8.0)) / 7.5
    in_contact = slice(0, 18)
    ratio = later.problem.forces(later.edge.s)[in_contact] / glassy[in_contact]
    assert ratio == pytest.approx(falls, rel=1e-9)


def test_energy_at_rest_goes_into_the_branches_and_nowhere_else():
    """The edge is pinned while all relaxes: what is no longer stored is heat, the node in part included."""
    loading = Loading("relaxed", DEPTH, (Ramp(0.9 * DEPTH, 0.1), Hold(3.0)))
    scene = Scene(ONE, Sphere(1.0), loading, Adhesion(WORK, ZONE, work_closing=0.05 * WORK))
    trace = solve(scene, structured_half_space(fit(0.0, 0.16, ZONE, 2)))
    held = trace.time >= 0.01
    assert np.ptp(trace.contact_radius) == 0.0
    stored, branches = trace.stored_energy[held], trace.extra["branch_dissipation"][held]
    assert np.ptp(stored) > 0.01 * stored[0]
    assert np.ptp(stored + branches) < 1e-9 * np.ptp(stored)
    assert np.ptp(branches - trace.dissipated_energy[held]) < 1e-9 * np.ptp(stored)


def test_heat_of_the_tip_at_a_speed_at_which_elements_relax_while_they_are_passed():
    """By front tracking; a volume integral over the nodes' means lacks 1.7 % on this mesh."""
    scene = Scene(ONE, Sphere(1.0), Loading("relaxed", DEPTH, (Ramp(-0.3, 0.002),)), Adhesion(WORK, ZONE))
    trace = solve(scene, structured_half_space(fit(0.0, 0.26, ZONE, 4)))
    assert trace.extra["branch_dissipation"][-1] == pytest.approx(1.6416527e-4, rel=6e-3)
