"""Loads that jump, and contacts that outgrow the mesh they were given."""

import numpy as np
import pytest
from support.paper_scenes import ELASTIC as SOFT
from support.paper_scenes import PULL as JKR
from support.paper_scenes import WORK, ZONE

from contact_scene import (
    Adhesion,
    Branch,
    Force,
    ForceRamp,
    Loading,
    Material,
    OutcomeKind,
    Scene,
    Sphere,
    Table,
)
from fem_solver import solve
from meshes import EdgeMeshes


def test_work_of_a_jump_is_that_of_the_path_of_the_edge():
    """Elastic: all of it is stored."""
    ball = EdgeMeshes(0.01, 4, 0.2)
    loading = Loading("jump-in", -0.01, (Table((0.0, 1.0), (0.03, 0.001)),))
    trace = solve(Scene(SOFT, Sphere(1.0), loading), ball)
    assert trace.outcome.kind is OutcomeKind.COMPLETED
    assert trace.external_work.max() == pytest.approx(trace.stored_energy.max(), rel=5e-3)
    assert np.abs(trace.dissipated_energy).max() < 5e-3 * trace.stored_energy.max()


@pytest.mark.slow
def test_last_tension_does_not_depend_on_the_jump_that_ends_the_contact():
    ball = EdgeMeshes(ZONE, 2, 0.26)
    for value in (-2.0 * JKR, -50.0 * JKR):
        loading = Loading("relaxed", 0.02, (Force(value, 1.0),))
        trace = solve(Scene(SOFT, Sphere(1.0), loading, Adhesion(WORK, ZONE)), ball)
        assert trace.outcome.kind is OutcomeKind.DETACHED
        assert -trace.force.min() == pytest.approx(1.02693 * JKR, rel=3e-3)


def test_contact_that_outgrows_its_mesh_is_said_to():
    """Also where the force stays, so that the edge has reached the end of the mesh before."""
    small = EdgeMeshes(0.005, 2, 0.1)
    loading = Loading("jump-in", 0.009, (ForceRamp(0.0, 0.01),))
    trace = solve(Scene(Material(0.75, 0.5, (Branch(6.75, 0.01),)), Sphere(1.0), loading), small)
    assert trace.outcome.kind is OutcomeKind.OUT_OF_RANGE
    assert "the mesh is made for" in trace.outcome.reason
