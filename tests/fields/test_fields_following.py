"""Fields where the mesh follows the edge: closed forms, one mesh along the whole path, files."""

from __future__ import annotations

import json
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
import pyvista
from numpy.testing import assert_allclose
from scipy.interpolate import LinearNDInterpolator
from support.paper_scenes import WORK

from benchmarks import fields_accuracy
from contact_scene import (
    Adhesion,
    Branch,
    BulkRelaxation,
    Loading,
    Material,
    Ramp,
    Scene,
    Sphere,
    write_scene,
)
from crosscontact.cli import main
from crosscontact.commands import fields
from fem_solver import Options, field_states, record
from fem_solver.halfspace import HalfSpace
from fem_solver.recovery import Recovery
from meshes.around_edge import EdgeMeshes, Place
from validation.fields.moments import FieldRequest, balance, record_fields
from validation.solvers.finite_elements import FiniteElements

TWO = Material(0.75, 0.4, (Branch(2.0, 0.3), Branch(4.0, 0.05)))
PULLED = Loading("relaxed", 0.02, (Ramp(0.019, 0.02),))
MIDDLE = Scene(TWO, Sphere(1.0), PULLED, Adhesion(WORK, 4e-3))
"""Its contact is 50 zones wide: both meshes serve."""
SHORT = replace(MIDDLE, adhesion=Adhesion(WORK, 2e-6))
RESOLUTION = 4
TURN = 0.05


@cache
def recorded(scene, follows, resolution=RESOLUTION):
    made = FiniteElements().mesh(scene, resolution)
    if not follows:  # one mesh, as fine from the axis on
        unit = 0.05 * made.largest
        made = EdgeMeshes(unit, round(unit / made.zone * resolution), made.largest)
    return record(scene, made, Options(record_times=(TURN,)))


@cache
def body(scene, follows=True, resolution=RESOLUTION):
    recording = recorded(scene, follows, resolution)
    (state,) = field_states(recording, {recording.rows[TURN]: ""})
    return state


@cache
def requested():
    """Of ``SHORT``, as the command line has it."""
    return record_fields(SHORT, FieldRequest((TURN,)), RESOLUTION)


@cache
def requested_body():
    (state,) = requested().states()
    return state


def within(state, radius):
    """Fields of a state on a grid below the contact, off its edge."""
    r, z = np.meshgrid(radius * np.linspace(0.02, 2.0, 30), -radius * np.linspace(0.1, 2.0, 25))
    rows = [state.stress, state.strain, state.displacement.T, state.stored_energy_density[None]]
    rows += [state.dissipation_rate, state.dissipated]
    return LinearNDInterpolator(state.points, np.vstack(rows).T)(r.ravel(), z.ravel()).T


def assert_both_meshes_give_the_same_body(scene, mean, rates, lost, resolution=RESOLUTION):
    """Fields to 6 % of their largest and to a mean share of it, sums of energies and of their rates."""
    one, other = (body(scene, follows, resolution) for follows in (True, False))
    assert one.time == other.time == TURN
    assert one.contact_radius == pytest.approx(other.contact_radius, rel=1e-3)
    assert one.branches == other.branches
    found, expected = (within(state, other.contact_radius) for state in (one, other))
    apart, largest = np.abs(found - expected), np.abs(expected).max(axis=1)
    assert np.all(apart.max(axis=1) <= 0.06 * largest)
    assert np.all(np.sqrt(np.mean(apart**2, axis=1)) <= mean * largest)
    for name, allowed in (("element_stored", 2e-3), ("element_rate", rates), ("element_dissipated", lost)):
        sums = [getattr(state, name) @ state.element_volumes for state in (one, other)]
        assert_allclose(*sums, rtol=allowed, atol=0.0)


@pytest.mark.slow
def test_both_meshes_give_the_same_body():
    assert_both_meshes_give_the_same_body(MIDDLE, 6e-3, 2e-2, 2e-2)


@pytest.mark.slow
@pytest.mark.parametrize("poisson", [0.3, 0.5])
def test_a_zone_of_a_hundred_thousandth_of_the_contact_is_as_good_as_the_closed_form(poisson):
    """Of JKR, also next to the edge: all the mesh that stays can reach is a tenth of the radius."""
    loading = Loading("relaxed", 0.01)
    scene = Scene(Material(1.0, poisson), Sphere(1.0), loading, Adhesion(1e-4, 1e-6))
    (state,) = record_fields(scene, FieldRequest((0.0,)), RESOLUTION).states()
    assert state.dissipated.shape == (0, len(state.points))  # nothing is lost
    found = fields_accuracy.deviation(state, scene)
    assert found.worst < 1.1e-2
    assert abs(found.force) < 2e-3
    a, (r, z) = state.contact_radius, state.points.T
    beside = np.hypot(r - a, z)
    close = (beside > 1e-4 * a) & (beside < 1e-3 * a) & (z < 0.0)
    assert close.sum() > 100
    exact = fields_accuracy.subsurface.contact(
        r[close], z[close], scene.indenter, a, state.penetration, 1.0 / (1.0 - poisson**2), poisson
    ).stress
    assert np.abs(state.stress[:, close] - exact).max() < 6e-3 * np.abs(exact).max()


@pytest.mark.slow
@pytest.mark.parametrize(
    "bulk", ["elastic", BulkRelaxation(2.0, (Branch(5.0, 0.1),))], ids=["elastic", "two"]
)
def test_bulk_that_relaxes_apart_gives_the_body_that_its_own_history_gives(bulk):
    scene = replace(MIDDLE, material=replace(TWO, poisson=0.3, bulk=bulk), adhesion=Adhesion(WORK, 0.01))
    assert_both_meshes_give_the_same_body(scene, 8e-3, 3e-2, 5e-2, 2 * RESOLUTION)


def test_the_edge_is_where_the_trace_has_it():
    """Radii of nodes and contact radii, which follow from stiffnesses, differ by many short zones."""
    state = requested_body()
    surface, zone = state.surface, SHORT.adhesion.zone
    open_from = surface.radius[surface.gap > 0.0].min()
    assert abs(open_from - state.contact_radius) < zone
    on_top = np.sort(state.points[state.points[:, 1] == 0.0, 0])
    assert np.abs(on_top - state.contact_radius).min() < zone


@pytest.mark.slow
@pytest.mark.parametrize(
    ("material", "places"),
    [(TWO, 2), (replace(TWO, poisson=0.3, bulk="elastic"), 10)],
    ids=["alike", "bulk apart"],
)
def test_densities_add_up_to_the_loss_of_the_trace_wherever_the_mesh_was(material, places):
    loading = Loading("relaxed", 0.02, (Ramp(0.0, 0.02),))
    scene = Scene(material, Sphere(1.0), loading, Adhesion(WORK, 1e-5))
    recording = record(scene, FiniteElements().mesh(scene, RESOLUTION), Options(record=True))
    row = int(np.flatnonzero(recording.trace.contact_radius)[-1])
    assert len({step.end.place for step in recording.steps}) >= places
    (state,) = field_states(recording, {row: ""})
    sums = balance(state, recording.trace)
    assert sums.dissipated == pytest.approx(sums.branch_dissipation, rel=4e-3)
    assert (state.dissipated >= 0.0).all()
    assert state.element_dissipated.min() > -1e-2 * state.element_dissipated.max()


@pytest.mark.parametrize("places", [((2, 3), (2, 8)), ((1, 4), (0, 0)), ((0, 0), (1, 4))], ids=str)
def test_what_was_lost_is_handed_on_between_meshes(places):
    """What is smooth for both, as it is; what is not, as a whole: here a layer of one zone."""
    meshes = FiniteElements().mesh(SHORT, RESOLUTION)
    old, new = (Place(*one) for one in places)
    units = [meshes.scale(one) / meshes.zone for one in (old, new)]
    left, here = (Recovery(HalfSpace(meshes.mesh(one.level)).basis) for one in (old, new))
    (r, z), (x, y) = (one.places * unit for one, unit in zip((left, here), units, strict=True))
    smooth = 1.0 / (1.0 + (r / 60.0) ** 2 + (z / 60.0) ** 2) ** 2
    thin = np.exp(z) * np.exp(-((r / 70.0) ** 8))
    found = here.taken_over(np.stack([smooth, thin]), left, units[0] / units[1])
    inner = np.hypot(x, y) < 300.0
    expected = 1.0 / (1.0 + (x / 60.0) ** 2 + (y / 60.0) ** 2) ** 2
    assert np.abs(found[0] - expected)[inner].mean() < 2e-3 * expected[inner].mean()
    before, after = (
        float(one.means(values[None])[0] @ one.volumes) * unit**3
        for one, values, unit in ((left, thin, units[0]), (here, found[1], units[1]))
    )
    assert after == pytest.approx(before, rel=4e-3)


@pytest.mark.slow
def test_files_hold_what_is_lost(tmp_path, monkeypatch, capsys):
    monkeypatch.setattr(fields.moments, "record_fields", lambda *given: requested())
    file, folder = tmp_path / "short.toml", tmp_path / "out"
    write_scene(SHORT, file)
    given = ["fields", str(file), "--at", f"{TURN}", "--resolution", f"{RESOLUTION}", "--out", str(folder)]
    assert main([*given, "--no-figures"]) == 0
    assert capsys.readouterr().out.splitlines()[1].split()[-1] == "%"
    moment = json.loads((folder / "moments.json").read_text(encoding="utf-8"))["moments"][0]
    assert moment["dissipated"] == pytest.approx(moment["branch_dissipation"], rel=3e-2)
    section = pyvista.read(next((folder / "body").glob("*.vtu")))
    assert "dissipation_rate tau=0.3 [energy/(length^3 time)]" in section.point_data
    assert "mean_dissipated_energy tau=0.3 [energy/length^3]" in section.cell_data
    assert all(np.isfinite(section.point_data[name]).all() for name in section.point_data)
