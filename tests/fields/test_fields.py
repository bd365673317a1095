"""Fields in the body: against closed forms, against the trace, and one way to them against the other."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from support.paper_scenes import STICKY as ADHESION

from benchmarks import fields_accuracy
from contact_scene import (
    Branch,
    BulkRelaxation,
    FlatPunch,
    Force,
    Hold,
    Layer,
    Loading,
    Material,
    Ramp,
    Scene,
    Sphere,
)
from fem_solver import Options, field_states, record
from fem_solver.state import nodal_forces
from fem_solver.volume import volume
from validation.fields.moments import balance
from validation.reference import subsurface
from validation.solvers.finite_elements import FiniteElements

TWO = (Branch(2.0, 0.3), Branch(3.0, 5.0))
STEPS = (Ramp(0.02, 0.05), Hold(0.3), Ramp(0.004, 0.05))
TURN, END = 0.1, 0.72


@cache
def recorded(poisson=0.3):
    scene = Scene(Material(0.75, poisson, TWO), Sphere(1.0), Loading("jump-in", 0.015, STEPS), ADHESION)
    return record(scene, FiniteElements().mesh(scene, 4), Options(tolerance=3e-4, record_times=(TURN, END)))


@cache
def states(poisson=0.3):
    recording = recorded(poisson)
    return list(field_states(recording, {recording.rows[time]: f"t = {time}" for time in (TURN, END)}))


@pytest.mark.parametrize(("name", "poisson"), [("flat punch", 0.3), ("Hertz", 0.3), ("JKR", 0.5)])
def test_stress_under_static_contacts_is_that_of_the_closed_forms(name, poisson):
    state, found = fields_accuracy.static(name, poisson, 10 if name == "JKR" else 4)
    assert found.worst < 1e-2
    assert found.traction < (3e-2 if name == "JKR" else 3e-3), found  # wide elements below the middle
    assert abs(found.force) < 2e-2  # over the edge, where the recovered stress overshoots
    if name == "Hertz":
        depth, shear = fields_accuracy.deepest_shear(state)
        exact_depth, exact_shear = fields_accuracy.exact_shear(poisson)
        largest = 1.5 * state.force / (np.pi * state.contact_radius**2)
        assert shear / largest == pytest.approx(exact_shear, rel=1e-2)
        assert depth == pytest.approx(exact_depth, rel=5e-2)


def test_displacement_and_strain_belong_to_the_stress():
    scene = Scene(Material(1.0, 0.3), Sphere(1.0), Loading("relaxed", 0.01), None)
    (state,) = field_states(record(scene, FiniteElements().mesh(scene, 4), Options(record=True)), {0: ""})
    r, z = state.points.T
    near = np.hypot(r, z) < 0.3
    a = state.contact_radius
    exact = subsurface.contact(r[near], z[near], Sphere(1.0), a, a**2, 1.0 / 0.91, 0.3).displacement
    assert np.abs(state.displacement[near].T - exact).max() < 5e-3 * np.abs(exact).max()
    # Hooke's law between two fields that were projected apart
    law = (1.3 * state.stress - 0.3 * np.outer([1.0, 1.0, 1.0, 0.0], state.stress[:3].sum(axis=0))) / 1.0
    assert np.abs(law - state.strain).max() < 1e-9 * np.abs(state.strain).max()


@pytest.mark.parametrize(
    ("poisson", "bulk"),
    [
        (0.5, None),
        (0.3, BulkRelaxation(2.0, (Branch(5.0, 0.1),))),
        pytest.param(0.3, None, marks=pytest.mark.slow),
    ],
    ids=["incompressible", "apart", "alike"],
)
def test_back_substitution_gives_what_internal_variables_in_the_body_give(poisson, bulk):
    """The edge rests, and forces are straight from row to row; of bulk apart the meshes know two solids."""
    loading = Loading("relaxed", 0.01, (Ramp(0.02, 0.05), Ramp(0.01, 0.05)))
    scene = Scene(Material(0.75, poisson, TWO, bulk=bulk), FlatPunch(0.2), loading)
    recording = record(scene, FiniteElements().mesh(scene, 2), Options(record=True, tolerance=1e-2))
    history, setup = volume(recording), recording.setup
    for step in recording.steps:
        here = setup.surfaces.at(step.end.place)
        history.commit(step.dt, nodal_forces(step.end, here, setup.solid) / here.scale)
    (state,) = field_states(recording, {len(recording.steps) - 1: ""})
    basis = history.space.basis
    displacement = history.state.unknowns[: basis.N][np.hstack([basis.nodal_dofs, basis.facet_dofs])].T
    allowed = 1e-5 if bulk is None else 3e-4
    assert np.abs(state.displacement - displacement).max() < allowed * np.abs(displacement).max()
    sums = balance(state, recording.trace)
    assert sums.stored == pytest.approx(here.scale * history.stored_energy, rel=5e-3)  # of the mesh, of all
    assert sums.dissipated == pytest.approx(here.scale * history.state.dissipated, rel=5e-3)


def test_densities_add_up_to_the_energies_of_the_trace():
    recording = recorded()
    for state in states():
        sums = balance(state, recording.trace)
        assert sums.dissipated == pytest.approx(sums.branch_dissipation, rel=5e-3)
        assert sums.dissipated == pytest.approx(sums.work_less_stored, rel=2e-2)
        held = recording.surfaces[state.row].interface
        assert sums.stored == pytest.approx(sums.stored_in_trace - held, rel=5e-3)
        assert sums.loss == pytest.approx(sums.branch_dissipation - sums.zone_excess, rel=1e-12)
        assert list(sums.dissipated_by_branch) == ["tau=0.3", "tau=5"]
        assert (state.dissipated >= 0.0).all()
        assert (state.dissipation_rate >= 0.0).all()


def test_dissipation_rate_is_the_slope_of_the_loss():
    recording = recorded()
    state, trace = states()[0], recording.trace
    k, lost = state.row, trace.extra["branch_dissipation"]
    slopes = [(lost[k] - lost[k - 1]) / (trace.time[k] - trace.time[k - 1])]
    slopes.append((lost[k + 1] - lost[k]) / (trace.time[k + 1] - trace.time[k]))
    rate = float((state.element_rate @ state.element_volumes).sum())
    assert min(slopes) * 0.97 < rate < max(slopes) * 1.03


def test_principal_stresses_are_eigenvalues():
    state, random = states()[0], np.random.default_rng(7)
    parts = random.normal(size=(4, state.stress.shape[1]))
    state = replace(state, stress=parts)
    rr, zz, tt, rz = parts
    tensors = np.zeros((len(rr), 3, 3))
    tensors[:, 0, 0], tensors[:, 1, 1], tensors[:, 2, 2] = rr, zz, tt
    tensors[:, 0, 1] = tensors[:, 1, 0] = rz
    values = np.linalg.eigvalsh(tensors)[:, ::-1].T
    assert np.allclose(state.principal, values, atol=1e-12)
    assert np.allclose(state.max_shear, 0.5 * (values[0] - values[2]))
    assert np.allclose(state.hydrostatic, values.mean(axis=0))
    between = values - np.roll(values, 1, axis=0)
    assert np.allclose(state.von_mises, np.sqrt(0.5 * (between**2).sum(axis=0)))


def test_surface_is_that_of_the_run():
    recording = recorded()
    for state in states():
        radius, sinking = fields_accuracy.on_surface(state, -state.displacement[:, 1])
        found = np.interp(state.surface.radius, radius, sinking)
        assert np.abs(found - state.surface.displacement).max() < 1e-7
        assert state.force == recording.trace.force[state.row]
        assert state.surface.contact_radius == state.contact_radius


def test_rows_not_recorded_are_named():
    with pytest.raises(KeyError, match="rows not recorded"):
        next(field_states(recorded(), {len(recorded().trace): ""}))


def test_where_the_load_jumps_a_time_means_the_state_before():
    loading = Loading("relaxed", 0.01, (Hold(0.1), Force(0.01, 0.1)))
    scene = Scene(Material(0.75, 0.5, TWO), Sphere(1.0), loading, ADHESION)
    recording = record(scene, FiniteElements().mesh(scene, 4), Options(record_times=(0.1,)))
    rows = np.flatnonzero(recording.trace.time == 0.1)
    assert len(rows) >= 2
    before, after = field_states(recording, {int(rows[0]): "", int(rows[-1]): ""})
    assert recording.rows[0.1] == before.row
    assert before.penetration == pytest.approx(0.01)
    assert after.force == pytest.approx(0.01)
    assert np.array_equal(before.element_dissipated, after.element_dissipated)  # a jump loses nothing


def test_stress_in_a_layer_is_that_of_the_closed_form():
    _, found = fields_accuracy.static("Hertz", 0.5, 2, Layer(0.03, "bonded"))
    assert found.worst < 1e-2
    assert found.traction < 3e-3


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "base", "poisson", "thickness"),
    [
        ("flat punch", "bonded", 0.0, 0.1),
        ("Hertz", "bonded", 0.3, 0.03),
        ("JKR", "bonded", 0.5, 0.1),
        ("Hertz", "frictionless", 0.3, 0.1),
    ],
)
def test_usual_meshes_of_layers_keep_within_it(name, base, poisson, thickness):
    state, found = fields_accuracy.static(name, poisson, None, Layer(thickness, base))
    assert found.worst < 1e-2
    assert state.points[:, 1].min() == pytest.approx(-thickness, rel=1e-12)
    below = state.points[:, 1] < -(1.0 - 1e-9) * thickness
    assert not state.displacement[below, 1].any()
    assert state.displacement[below, 0].any() == (base == "frictionless")


@pytest.mark.slow
@pytest.mark.parametrize(
    ("zone", "to", "places"), [(ADHESION.zone, 0.004, 1), (4e-3, 0.0095, 2)], ids=["stays", "follows"]
)
def test_densities_in_a_layer_add_up_wherever_the_mesh_was(zone, to, places):
    """On the half-space those of this scene miss 5e-2 of the loss on so coarse a mesh."""
    loading = Loading("relaxed", 0.012, (Ramp(0.02, 0.05), Ramp(to, 0.05)))
    law, body = replace(ADHESION, zone=zone), Layer(0.1, "frictionless")
    scene = Scene(Material(0.75, 0.3, TWO), Sphere(1.0), loading, law, body=body)
    recording = record(scene, FiniteElements().mesh(scene, 4), Options(record=True))
    assert len({step.end.place for step in recording.steps}) >= places
    row = len(recording.steps) - 1
    (state,) = field_states(recording, {row: ""})
    sums, held = balance(state, recording.trace), recording.surfaces[row].interface
    assert sums.dissipated == pytest.approx(sums.branch_dissipation, rel=3e-2)
    assert sums.stored == pytest.approx(sums.stored_in_trace - held, rel=1e-2)
    radius, sinking = fields_accuracy.on_surface(state, -state.displacement[:, 1])
    apart = np.interp(state.surface.radius, radius, sinking) - state.surface.displacement
    assert np.sqrt(np.mean(apart**2)) < 1e-3 * 0.02


@pytest.mark.slow
@pytest.mark.parametrize("name", fields_accuracy.CONTACTS)
@pytest.mark.parametrize("poisson", fields_accuracy.RATIOS)
def test_usual_meshes_keep_within_a_hundredth_of_the_closed_forms(name, poisson):
    _, found = fields_accuracy.static(name, poisson)
    assert found.worst < 1e-2
