"""The mesh that follows the edge: laws of single components, path, transfer, whole runs with short zones."""

from __future__ import annotations

import math
from dataclasses import replace
from functools import cache
from itertools import pairwise
from types import SimpleNamespace

import numpy as np
import pytest
from numpy.testing import assert_allclose
from support.paper_scenes import ONE, WORK

import fem_solver
from contact_scene import (
    Adhesion,
    Branch,
    Cone,
    Force,
    Loading,
    Material,
    Ramp,
    Scene,
    Sphere,
    Trace,
)
from fem_solver import setup
from fem_solver.closure import ZoneShift
from fem_solver.components import Components
from fem_solver.contact_problem import ContactProblem
from fem_solver.edge_path import EdgePolynomial, extrapolated
from fem_solver.moduli import Prony, moduli, phi
from fem_solver.nodes import NodeBorders, NodeParts, NodePassage, PartlyReleased
from fem_solver.placement import Surfaces
from fem_solver.state import ComponentState, transferred, undeformed
from meshes import EdgeMeshes
from validation.cases import load
from validation.measure.observables import observe
from validation.reference.finite_zone import FiniteZone
from validation.solvers.finite_elements import FiniteElements

SHEAR = Prony(0.3, np.array([1.0, 2.0, 0.5]), np.array([1e-3, 0.7, 40.0]))
STEPS = 4000
TWO = Material(0.75, 0.5, (Branch(4.0, 0.1), Branch(2.75, 3.0)))
RETRACTION = Loading("relaxed", 0.032, (Ramp(-0.5, 0.002),))
SHORT = Scene(ONE, Sphere(1.0), RETRACTION, Adhesion(WORK, 1.3e-3))
PULL_OFF, LOOP, DETACHED = 0.02028430, 8.564744e-4, 30.572995
"""Of ``SHORT``, by front tracking with short steps."""
CREEPING, HELD = 4e-3, 229.853
"""Process zone under a dead load, and the time at which it detaches by front tracking."""
SLOWLY_LOST, SLOW_WORK = 104.2011, -4.356896e-9
"""Of the built-in scene ``pdms-dead-load-100nm``, in seconds and joule, by front tracking."""
COARSE = 5e-3
"""Error at four elements a zone: the bound that is set to the default of ten."""


def followed(borders: NodeBorders, passage: NodePassage, dt: float, edge: tuple[float, float]) -> NodeBorders:
    """Borders after a step, with the one that it leaves and what they lose counted."""
    later, lost, received = borders.after(passage.solid, dt, edge, np.ones_like)
    passage.dissipated, passage.opening = passage.dissipated + lost, passage.opening + received
    return later if passage.beyond is None else later.with_border(edge[0], passage.beyond)


def components(count: int = 3) -> tuple[np.ndarray, np.ndarray]:
    random = np.random.default_rng(3)
    return random.normal(size=count), random.normal(size=(3, count))


def test_a_component_under_a_linear_force_creeps_as_in_many_small_steps():
    solid, (v, b) = Components(SHEAR), components()
    before, after = solid.force(v, b), np.array([0.0, 2.0, -1.0])
    time = np.array([1e-3, 1.0, 100.0])
    reached, branches = solid.crept(v, b, time, after)
    work = solid.work_of_creep(v, b, time, after, reached)
    now, inner, done = v, b, np.zeros(3)
    for step in range(1, STEPS + 1):
        force = before + step / STEPS * (after - before)
        free, dt = solid.relieved(now, inner, time / STEPS), time / STEPS
        y = dt / SHEAR.times[:, None]
        gain = SHEAR.relaxed + (SHEAR.moduli[:, None] * -np.expm1(-y) / y).sum(axis=0)
        target = free + force / gain
        mean = 0.5 * (solid.force(now, inner) + force)
        done += mean * (target - now)
        now, inner = target, solid.linear(now, inner, dt, target)
    assert_allclose(reached, now, rtol=2e-3)
    assert_allclose(branches, inner, rtol=2e-3, atol=1e-6)
    assert_allclose(work, done, rtol=2e-3, atol=1e-6)
    assert_allclose(solid.force(reached, branches), after, atol=1e-12)


def test_without_force_a_component_recovers_in_one_step_as_in_two():
    solid, (v, b) = Components(SHEAR), components()
    b -= (SHEAR.relaxed * v + b.sum(axis=0)) * SHEAR.moduli[:, None] / SHEAR.moduli.sum()
    whole = solid.recovered(b, 3.0)
    first = solid.recovered(b, 1.0)
    second = solid.recovered(first[1], 2.0)
    crept = solid.crept(v, b, np.full(3, 3.0), np.zeros(3))
    for found in (second, crept):
        assert_allclose(found[0], whole[0], rtol=1e-12)
        assert_allclose(found[1], whole[1], rtol=1e-9, atol=1e-13)
    assert_allclose(solid.recovered(b, math.inf)[0], 0.0, atol=1e-13)


@pytest.mark.parametrize("steps", [1, 7])
@pytest.mark.parametrize("time", [1e-4, 1.0, 1e4])
def test_radii_released_one_by_one_lose_what_each_stores_after_its_jump(time, steps):
    """From equilibrium, in one step or in several: each jumps and creeps by itself, nothing else is lost."""
    solid, contact = Components(SHEAR), np.array([-2.0 / SHEAR.relaxed])
    v, b = contact, np.zeros((3, 1))
    jumped = solid.stored(*solid.crept(v, b, np.zeros(1), np.zeros(1)))
    passage = NodePassage(solid, v, b, b[:, 0], True)
    first, last, shares = np.zeros(1), np.ones(1), np.linspace(1.0, 0.0, steps + 1)
    borders = NodeBorders.none(3)
    for before, after in pairwise(shares):
        passage.release(time / steps, after, first, last, lambda _: contact, 0 if before < 1.0 else 1, before)
        passage.held = passage.held[:, 0]
        borders = followed(borders, passage, time / steps, (before, after))
    left = solid.stored(passage.v, passage.b) + borders.stored(solid)
    assert passage.dissipated == pytest.approx(float((jumped - left)[0]), rel=1e-12)
    creeping = solid.free_energies(solid.crept(v, b, np.zeros(1), np.zeros(1))[1])
    assert float(left[0]) == pytest.approx(creeping @ phi(2.0 * solid._rates * time), rel=1e-9)
    gained = float((left - solid.stored(v, b))[0])
    assert passage.opening - passage.dissipated == pytest.approx(gained, rel=1e-9)


@pytest.mark.parametrize("steps", [1, 7])
@pytest.mark.parametrize("time", [1e-4, 1.0, 1e4])
def test_radii_covered_one_by_one_lose_what_each_stores_after_its_jump(time, steps):
    solid, contact = Components(SHEAR), np.array([0.3])
    v, b = np.zeros(1), np.zeros((3, 1))
    jumped = solid.stored(contact, solid.linear(v, b, 0.0, contact))
    passage = NodePassage(solid, v, b, b[:, 0], True)
    first, last, shares = np.zeros(1), np.ones(1), np.linspace(0.0, 1.0, steps + 1)
    borders = NodeBorders.none(3)
    for before, after in pairwise(shares):
        passage.cover(time / steps, np.array([after]), first, last, lambda _: contact, before)
        passage.held = passage.held[:, 0]
        borders = followed(borders, passage, time / steps, (before, after))
    left = solid.stored(passage.v, passage.b) + borders.stored(solid)
    assert passage.dissipated == pytest.approx(float((jumped - left)[0]), rel=1e-12)
    relaxing = SHEAR.relaxed + SHEAR.moduli @ phi(2.0 * time / SHEAR.times)
    assert float(left[0]) == pytest.approx(0.5 * relaxing * contact[0] ** 2, rel=1e-9)


@pytest.mark.parametrize("after", [0.004, 0.5, 1.0])
def test_a_jump_within_a_node_leaves_its_radii_where_each_of_them_jumps_to(after):
    """Those in contact follow the indenter, those just covered come to it, the free ones stay."""
    solid, before, contact, imposed = Components(SHEAR), 0.01, np.array([0.3]), np.array([0.35])
    held = np.full((3, 1), 0.02)
    away, free = solid.recovered(np.array([[0.05], [-0.02], [0.01]]), 0.4)
    v, b = before * contact + (1.0 - before) * away, before * held + (1.0 - before) * free
    passage = NodePassage(solid, v, b, held[:, 0], True)
    passage.at_once(
        0.0, np.array([after]), contact, imposed, away, PartlyReleased(0, before, float(contact[0]))
    )
    in_contact = solid.linear(contact, held, 0.0, imposed)
    if after > before:
        covered = solid.linear(away, free, 0.0, imposed)
        parts = (before, imposed, in_contact), (after - before, imposed, covered), (1.0 - after, away, free)
        in_contact = (before * in_contact + (after - before) * covered) / after
    else:
        left = solid.relieved(imposed, in_contact, 0.0)
        released = solid.linear(imposed, in_contact, 0.0, left)
        parts = (after, imposed, in_contact), (before - after, left, released), (1.0 - before, away, free)
    assert_allclose(passage.v, sum(share * v for share, v, _ in parts), rtol=1e-12)
    assert_allclose(passage.b, sum(share * b for share, _, b in parts), rtol=1e-11)
    # what the radii hold is what their mean holds, the border between them and the partial contact
    known, mean = solid.stored(*passage.beyond), (passage.v, passage.b)
    if after < 1.0:
        assert_allclose(passage.held, in_contact, rtol=1e-12)
        known += NodeParts(solid, after, mean, (imposed, passage.held)).energy_beyond_mean
    whole = sum(share * solid.stored(v, b) for share, v, b in parts)
    assert_allclose(known + solid.stored(*mean), whole, rtol=1e-12)


def test_a_border_left_by_a_jump_holds_what_radii_on_its_sides_hold_beyond_their_mean():
    """In contact, released within a step, covered within another: dissipated, or received by the surface."""
    solid, shares, imposed = Components(SHEAR), np.array([0.3, 0.7]), np.full(2, 0.3)
    v, b = imposed, np.array([[0.2, 0.9], [-0.1, 1.5], [0.4, 0.1]])
    apart = np.sqrt(shares.prod())
    borders = NodeBorders.none(3).with_border(1.0, (np.zeros(1), apart * (b[:, 1:] - b[:, :1])))

    def beyond():
        mean = solid.stored(np.array([shares @ v]), (b @ shares)[:, None])
        return float(shares @ solid.stored(v, b) - mean[0])

    at = 1.2
    for edge, dt, share in [
        (1.1, 0.2, 1.0),
        (0.8, 0.5, 0.4),
        (0.8, 3.0, 1.0),
        (1.3, 0.7, 0.8),
        (1.3, 9.0, 1.0),
    ]:
        before = borders.stored(solid)
        after, lost, received = borders.after(
            solid, dt, (at, edge), lambda x, share=share: np.full(len(x), share)
        )
        decayed = 0.0
        for held, time in ((at > 1.0, share * dt), (edge > 1.0, (1.0 - share) * dt)):
            if held != (v[0] == imposed[0]):
                reached = imposed if held else solid.relieved(v, b, 0.0)
                v, b = reached, solid.linear(v, b, 0.0, reached)
            stored = beyond()
            v, b = (v, solid.linear(v, b, time, v)) if held else solid.recovered(b, time)
            decayed += stored - beyond()
        assert after.stored(solid) == pytest.approx(beyond(), rel=1e-9)
        assert lost == pytest.approx(decayed, rel=1e-9)
        assert received == pytest.approx(after.stored(solid) - before + lost, rel=1e-9, abs=1e-15)
        borders, at = after, edge


def test_energy_and_heat_after_a_jump_by_less_than_a_node():
    """The edge jumps by 0.015 zones and creeps by 0.022, as in random scene 11129; by front tracking."""
    material = Material(1.0, 0.45, (Branch(6.89, 87.7), Branch(9.49, 1.45e-3)))
    loading = Loading("relaxed", 0.036214812, (Force(0.009881057657680253, 0.015),))
    scene = Scene(material, Sphere(1.0), loading, Adhesion(0.009838366300041592, 0.0112407))
    trace = FiniteElements().solve(scene, 4)
    jumped = np.flatnonzero(trace.time == 0.0)[-1]
    assert trace.stored_energy[jumped] - trace.stored_energy[0] == pytest.approx(6.0746e-5, rel=5e-3)
    assert trace.extra["branch_dissipation"][-1] == pytest.approx(1.4563e-4, rel=5e-3)


@pytest.mark.parametrize(
    ("way", "expected"),
    [
        pytest.param(1.0, 2.933496e-6, id="in"),
        pytest.param(-1.0, 6.232658e-7, id="out", marks=pytest.mark.slow),
    ],
)
def test_heat_of_an_edge_that_takes_many_steps_in_each_element(way, expected):
    """Each step is about as long as the branch needs, an element takes ten times that; by front tracking."""
    depth, material = 1e-2, Material(1.0, 0.5, (Branch(5.0, 1.0),))
    loading = Loading("relaxed", depth, (Ramp(depth + 1.2e-3 * way, 3e-5),))
    trace = FiniteElements().solve(Scene(material, Sphere(1.0), loading, Adhesion(7.5e-4, 1.75e-3)), 8)
    assert trace.extra["branch_dissipation"][-1] == pytest.approx(expected, rel=2e-2)


def test_the_path_meets_the_rows_and_tells_when_a_node_is_passed():
    path = EdgePolynomial.through(1.0, 0.7, 0.5, ((0.25, 1.05),))
    shares = np.linspace(0.0, 1.0, 11)
    radii = 1.0 + path.travel * (shares + path.bend * shares * (shares - 1.0))
    assert_allclose(path.passed(radii), shares, atol=1e-12)
    # the parabola through (-0.25, 1.05), (0, 1), (0.5, 0.7)
    parabola = np.polyfit([-0.25, 0.0, 0.5], [1.05, 1.0, 0.7], 2)
    assert_allclose(radii, np.polyval(parabola, 0.5 * shares), atol=1e-12)
    assert path.passed(np.array([1.2, 0.5])).tolist() == [0.0, 1.0]
    rows = [-0.4, -0.25, 0.0, 0.5], [1.07, 1.05, 1.0, 0.7]
    cubic = EdgePolynomial.through(1.0, 0.7, 0.5, ((0.25, 1.05), (0.4, 1.07)))
    assert_allclose(cubic.passed(np.polyval(np.polyfit(*rows, 3), 0.5 * shares)), shares, atol=1e-9)
    # through rows that a monotonic cubic cannot follow: passed once, in order
    bent = EdgePolynomial.through(1.0, 0.7, 0.5, ((0.25, 1.05), (0.4, -1.0)))
    moments = bent.passed(np.linspace(1.0, 0.7, 50))
    assert bent.twist == pytest.approx(-(1.0 + bent.bend) / 1.5)  # at rest at the end
    assert (np.diff(moments) >= 0.0).all()
    assert moments[[0, -1]].tolist() == [0.0, 1.0]
    turning = EdgePolynomial.through(1.0, 1.001, 0.5, ((0.25, 1.5),))
    assert abs(turning.bend) == 1.0
    assert not turning.opens
    at_rest = EdgePolynomial.through(1.0, 1.0, 0.5, ((0.25, 1.5),))
    assert at_rest.passed(np.array([0.9, 1.0, 1.1])).tolist() == [1, 1, 0]


@pytest.mark.parametrize("twist", [0.0, 0.1])
def test_the_end_of_a_path_is_passed_at_the_end_of_the_step_to_the_last_bit(twist):
    """A node that is covered in part would else go on as if it were covered whole."""
    for bend in np.linspace(-0.5, 0.5, 1001):
        path = EdgePolynomial(0.071, 0.0011325, bend, twist)
        assert path.passed(np.array([0.073]))[0] == 1.0


def test_a_parabola_through_three_rows_misses_a_cubic_by_its_third_difference():
    def missed(path):
        return path(1.2) - extrapolated(path(0.7), 0.5, ((0.3, path(0.4)), (0.7, path(0.0))))

    assert missed(lambda t: 1.0 - 0.1 * t + 0.02 * t**2) == pytest.approx(0.0, abs=1e-15)
    cubic = missed(lambda t: 1.0 - 0.02 * t**3)
    assert cubic == pytest.approx(-0.02 * 0.5 * (0.5 + 0.3) * (0.5 + 0.7), rel=1e-12)
    assert extrapolated(1.0, 0.1, ((0.2, 1.5),)) == pytest.approx(0.75)
    assert extrapolated(1.0, 0.1, ()) == 1.0


def test_places_cover_every_radius_with_meshes_whose_number_grows_with_the_logarithm():
    family = EdgeMeshes(1.0, 4, 1e6)
    levels = set()
    for radius in np.geomspace(1.0, 1e6, 400):
        place = family.place(radius)
        levels.add(place.level)
        scale, parameters = family.scale(place), family.parameters(place.level)
        low, high = scale * parameters.fine_from, scale * parameters.fine_to
        assert low == 0.0 or low < radius - 3.0
        assert radius + 3.0 < high
        assert scale * parameters.fine_size <= 0.25 * 1.01
    assert len(levels) < 20


def test_no_mesh_is_made_for_an_edge_that_a_sharp_one_leaves_within_its_zone():
    trace = FiniteElements().solve(load("pdms-retraction-1um").scene, 4)
    assert trace.outcome.kind == "detached"
    assert trace.contact_radius[-2] > 24.0 * 1e-6  # beyond what the mesh at the axis serves
    assert trace.counters.factorisations == 3


@pytest.mark.parametrize("scale", [1.0, 0.7])
def test_the_shift_is_one_zone_however_short_it_is(scale):
    """Elements of a zone of 5e-9 of the radius are 1e-9 of it, the tolerance for nodes that coincide."""
    radii = scale * (1e8 + 0.05 * np.arange(100))
    shift = ZoneShift(radii, 1.0)
    inner = np.arange(60)
    reached = (1.0 - shift.share) * radii[shift.low] + shift.share * radii[shift.high] - radii
    assert_allclose(reached[inner], 1.0, atol=1e-6)


@pytest.mark.parametrize("zones", [1e6, 2e8])
def test_elements_are_as_small_around_the_strip_however_short_the_zone_is(zones):
    """Gmsh, with tolerances of its own, left out seven of eight around a strip at 1e8 zones."""
    meshes = EdgeMeshes(1.0, 4, zones, in_cache=False)
    level = meshes.place(zones).level
    mesh, strip = meshes.mesh(level), meshes.centre(level)
    corners = mesh.points[:, mesh.triangles] - np.array([strip, 0.0])[:, None, None]
    within = (np.abs(corners[0].mean(axis=0)) < 10.0) & (corners[1].mean(axis=0) > -1.0)
    one, other = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    area = 0.5 * (one[0] * other[1] - one[1] * other[0])[within]
    assert np.abs(area).sum() == pytest.approx(20.0, rel=0.15)
    assert np.abs(area).max() < 0.2


@pytest.mark.slow
@pytest.mark.parametrize("zone", [1.8e-7, 9e-10])
def test_the_edge_is_found_where_the_contact_radius_is_a_million_zones(zone):
    """Contact radii follow from stiffnesses; their error of 5e-5 is more than the length of the strip."""
    elastic = Scene(Material(1.0, 0.5), Sphere(1.0), Loading("relaxed", 0.01), Adhesion(WORK, zone))
    trace = FiniteElements().solve(elastic, 4)
    # as a sharp edge rests, JKR: a^2/R - sqrt(2 pi w a/E*) = D
    radius, modulus = trace.contact_radius[0], 4.0 / 3.0
    rest = radius**2 - np.sqrt(2.0 * np.pi * WORK * radius / modulus)
    assert rest == pytest.approx(0.01, rel=0.1 * COARSE)
    assert trace.counters.linear_solves < 50


def test_what_a_cone_has_borne_is_known_by_its_depth_where_the_mesh_moves_on():
    """Wide elements have the depth of a tip a hundredth off; by radius fine ones would keep that."""
    material, zone = Material(1.0, 0.5, (Branch(4.0, 1.0),)), 1e-3
    scene = Scene(material, Cone(70.0), Loading("jump-in", 0.1), Adhesion(WORK, zone))
    surfaces = Surfaces(scene, FiniteElements().mesh(scene, 5), moduli(material), True)
    wide, fine = (surfaces.around(zones * zone) for zones in (100.0, 10.0))
    held = 0.1 * wide.unit - wide.profile
    edge = wide.geometry.position(100.0 * zone)
    borne = replace(undeformed(wide, 1), components=held, branches=4.0 * held[None], penetration=0.1)
    borne = replace(borne, edge=edge, radius=wide.geometry.radius(edge))
    moved = transferred(borne, wide, fine, Components(moduli(material).surface))
    nodes = slice(int(fine.lowest), fine.geometry.last)
    expected = 4.0 * moved.components[nodes] / fine.unit[nodes]
    assert_allclose(moved.branches[0, nodes] / fine.unit[nodes], expected, rtol=1e-9)


@cache
def retraction(zone: float = 1.3e-3) -> Trace:
    return FiniteElements().solve(replace(SHORT, adhesion=Adhesion(WORK, zone)), 4)


def errors(trace: Trace) -> tuple[float, float, float]:
    pull_off = -trace.force.min() / PULL_OFF - 1.0
    return pull_off, trace.external_work[-1] / LOOP - 1.0, trace.outcome.time / DETACHED - 1.0


@pytest.mark.slow
def test_short_zones_are_passed_over_with_little_error():
    """Zone 6e-3 of the contact radius; 75 steps where a quarter of an element a step takes thousands."""
    trace = retraction()
    assert np.abs(errors(trace)).max() < COARSE
    assert trace.counters.steps < 150
    residual = trace.extra["balance_residual"]
    assert np.abs(residual).max() < 1e-4 * trace.external_work[-1]


def straight(true):
    return classmethod(lambda cls, start, end, dt, before: cls(start, end - start))


def late(true):
    return lambda self, radii: np.where(true(self, radii) > 0.0, 1.0, 0.0)


def forgetful(true):
    def transferred(*given):
        moved = true(*given)
        beyond = np.arange(len(moved.components)) > moved.edge + 1.0
        if moved.place == given[0].place:
            return moved
        kept = np.where(beyond, 0.0, moved.components)
        branches = np.where(beyond, 0.0, moved.branches)
        return replace(moved, components=kept, branches=branches, record=None)

    return transferred


@pytest.mark.exhaustive
@pytest.mark.parametrize(
    ("owner", "name", "wrong"),
    [
        pytest.param(EdgePolynomial, "through", straight, id="a path of lower order"),
        pytest.param(EdgePolynomial, "passed", late, id="nodes released at the end of the step"),
    ],
)
def test_faults_in_the_steps_over_many_nodes_show(owner, name, wrong, monkeypatch):
    """Each moves the pull-off force, or the loop energy, by more than the error of the true steps."""
    true = np.abs(errors(retraction())).max()
    monkeypatch.setattr(owner, name, wrong(getattr(owner, name)))
    found = FiniteElements().solve(SHORT, 4)
    assert np.abs(errors(found)).max() > 2.0 * true


@pytest.mark.slow
def test_the_limit_of_short_zones_is_reached():
    """Pull-off force at zones of 1.3e-4, by front tracking, and steps that do not grow."""
    trace = retraction(1.3e-4)
    assert -trace.force.min() == pytest.approx(0.0230577, rel=COARSE)
    assert trace.external_work[-1] == pytest.approx(9.30494e-4, rel=COARSE)
    assert trace.counters.steps < 1.2 * retraction().counters.steps


@pytest.mark.slow
def test_an_edge_that_creeps_under_a_dead_load_detaches_in_time(monkeypatch):
    """Slower than a node in a relaxation time; a wake forgotten where the mesh moves changes that time."""
    loading = Loading("relaxed", 0.032, (Force(-0.006, 1000.0),))
    scene = replace(SHORT, material=TWO, loading=loading, adhesion=Adhesion(WORK, CREEPING))
    trace = FiniteElements().solve(scene, 4)
    assert trace.outcome.time == pytest.approx(HELD, rel=2.0 * COARSE)
    # what the wake does shows early; without it the whole run takes 600 steps
    early = replace(scene, loading=replace(loading, steps=(Force(-0.006, 20.0),)))
    true = pytest.approx(np.interp(20.0, trace.time, trace.penetration), rel=2.0 * COARSE)
    assert FiniteElements().solve(early, 4).penetration[-1] == true
    monkeypatch.setattr(setup, "transferred", forgetful(setup.transferred))
    assert FiniteElements().solve(early, 4).penetration[-1] != true


@pytest.mark.exhaustive
@pytest.mark.parametrize("rows", [2, 1])
def test_a_dead_load_on_a_micrometre_contact_detaches_in_time(rows, monkeypatch):
    """Zone 6e-4 of the contact radius; a path one order lower is seen in the time to detachment."""
    true = ComponentState.rows_and_this
    monkeypatch.setattr(ComponentState, "rows_and_this", lambda *given: true(*given)[:rows])
    found = FiniteElements().solve(load("pdms-dead-load-100nm").scene)
    accurate = rows == 2
    assert (abs(found.outcome.time / SLOWLY_LOST - 1.0) < 0.4 * COARSE) == accurate
    assert found.external_work[-1] == pytest.approx(SLOW_WORK, rel=COARSE)


@pytest.mark.slow
def test_an_edge_jump_without_a_place_to_rest_loses_contact():
    """The sharp edge, which needs no fine mesh, tells that nothing inside holds the contact."""
    meshes = FiniteElements().mesh(SHORT, 4)
    solved = fem_solver.solve(
        replace(SHORT, loading=Loading("relaxed", 0.032, (Force(-1.0, 1.0),))), meshes, fem_solver.Options()
    )
    assert solved.outcome.finished
    assert solved.outcome.kind.value == "detached"


def test_penetration_under_a_force_where_elements_are_tiny(monkeypatch):
    """Their size is below a rounding error of the penetration."""
    problem = object.__new__(ContactProblem)
    problem.control, problem.value = "force", 2.0
    problem.state = SimpleNamespace(penetration=1e-3)
    problem.placement, problem._passage = SimpleNamespace(scale=1e-26), None
    nodes = SimpleNamespace(between=lambda _: None)
    monkeypatch.setattr(ContactProblem, "_passages", lambda self, s: lambda *_: nodes)
    monkeypatch.setattr(ContactProblem, "_forces_of", lambda self, s, depths, _: 1.0 + 500.0 * depths)
    assert problem.penetration(2.0) == pytest.approx(2e-3, rel=1e-9)


@pytest.mark.slow
def test_an_elastic_contact_over_short_zones_is_lost_at_its_limit_point():
    """Sought from a sharp edge alone it was lost 1.5 % of its radius before, at every resolution."""
    work, zone = 2.0, 5e-7
    exact = FiniteZone(1e-3, 1e6 / 0.75, work, zone).pull_off_penetration_control()
    assert exact.contact_radius > 48.0 * zone
    loading = Loading("relaxed", 0.95 * exact.penetration, (Ramp(2.0 * exact.penetration, 5e-4),))
    scene = Scene(Material(1e6, 0.5), Sphere(1e-3), loading, Adhesion(work, zone))
    trace = FiniteElements().solve(scene)
    last = observe(trace, loading=loading)
    assert last.detachment_penetration == pytest.approx(exact.penetration, rel=1e-5)
    assert last.detachment_radius == pytest.approx(exact.contact_radius, rel=5e-3)
