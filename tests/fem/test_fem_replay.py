"""Surface components against internal variables in the whole volume, fed with the forces of a run."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import pytest

from contact_scene import Branch, BulkRelaxation, SceneError
from fem_solver import Options, record
from fem_solver.components import Components
from fem_solver.volume import replayed
from validation.cases import load
from validation.solvers.finite_elements import FiniteElements


def answer(name, resolution, tolerance, bulk=None):
    scene = load(name).scene
    if bulk is not None:
        scene = replace(scene, material=replace(scene.material, poisson=0.3, bulk=bulk))
    made = FiniteElements().mesh(scene, resolution)
    return replayed(record(scene, made, Options(tolerance=tolerance, record=True)))


@cache
def cycle():
    return answer("cycle-v0.02", 5, 1e-3)


def test_surface_and_volume_go_through_the_same():
    errors = cycle().errors
    assert errors["displacement"] < 3e-4
    assert errors["stored"] < 2e-6
    assert errors["dissipated"] < 3e-3


@pytest.mark.slow
def test_without_adhesion_to_the_steps():
    errors = answer("adhesionless-cycle", 4, 2.5e-4).errors
    assert errors["displacement"] < 3e-5
    assert errors["stored"] < 1e-6
    assert errors["dissipated"] < 2e-6


@pytest.mark.slow
@pytest.mark.parametrize("name", ["layer-cycle", "layer-frictionless"])
def test_on_a_layer_whose_volume_has_a_mesh_of_its_own(name):
    errors = answer(name, 5, 1e-3).errors
    assert errors["displacement"] < 3e-3  # next to the edge
    assert errors["stored"] < 1e-4
    assert errors["dissipated"] < 4e-3


@pytest.mark.slow
def test_where_bulk_relaxes_apart():
    errors = answer("cycle-v0.02", 5, 1e-3, BulkRelaxation(None, (Branch(1.5, 0.5),))).errors
    assert errors["displacement"] < 4e-4
    assert errors["stored"] < 1e-5
    assert errors["dissipated"] < 5e-3


@pytest.mark.slow
@pytest.mark.parametrize(
    ("method", "seen_by"), [("loss", "dissipated"), ("stored", "stored"), ("recovered", "displacement")]
)
def test_a_fault_of_the_components_is_seen(monkeypatch, method, seen_by):
    """Half a percent of a loss, of an energy; twice the time of a recovery."""
    right, true = getattr(Components, method), cycle().errors

    def wrong(self, *given):
        if method == "recovered":
            return right(self, given[0], 2.0 * given[1])
        return 1.005 * right(self, *given)

    monkeypatch.setattr(Components, method, wrong)
    errors = answer("cycle-v0.02", 5, 1e-3).errors
    assert errors[seen_by] > 1.5 * true[seen_by]


@pytest.mark.slow
def test_a_mesh_that_moves_has_no_one_volume():
    with pytest.raises(SceneError, match="the mesh follows the edge"):
        answer("pdms-retraction-1um", 4, 4e-3)
