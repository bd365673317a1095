"""How runs end, what is recognised on the way, and what is refused."""

import numpy as np
import pytest
from numpy.testing import assert_allclose
from support.bem_runs import bem, front
from support.paper_scenes import ELASTIC, ONE, PULL, WORK, ZONE, cycle, scene

from bem_solver import Options, solve
from bem_solver.creep import surface_material
from contact_scene import (
    Adhesion,
    Branch,
    BulkRelaxation,
    Cone,
    FlatPunch,
    Force,
    ForceRamp,
    Hold,
    Loading,
    Material,
    Oscillate,
    OutcomeKind,
    PowerLaw,
    PowerRate,
    Ramp,
    Scene,
    Sphere,
    Sweep,
    Table,
    TabulatedProfile,
)
from validation.reference.finite_zone import FiniteZone

COARSE = Options(resolution=6)


def finite(trace):
    columns = trace.columns().values()
    profiles = [c for p in trace.profiles for c in (p.pressure, p.displacement, p.gap)]
    return all(np.isfinite(column).all() for column in (*columns, *profiles))


def ledge():
    """A paraboloid with a broad, almost level ledge: contact spreads over it all at once."""
    r = np.linspace(0.0, 0.8, 81)
    level = 0.5 * 0.25**2 + 0.002 * (r - 0.25)
    height = np.where(r < 0.25, 0.5 * r**2, np.where(r < 0.45, level, level + 2.0 * (r - 0.45) ** 2))
    return TabulatedProfile(tuple(r), tuple(height))


@pytest.mark.parametrize(
    "material", [ELASTIC, pytest.param(ONE, marks=pytest.mark.slow)], ids=["elastic", "viscoelastic"]
)
def test_snap_in_is_an_event_and_a_jump(material):
    question = scene(
        Ramp(0.06, 0.01),
        Ramp(-0.5, 0.01),
        start="relaxed",
        at=-0.004,
        material=material,
        indenter=ledge(),
    )
    mine, other = bem(question, resolution=4), front(question, 4)
    assert [event.kind for event in mine.events] == [event.kind for event in other.events]
    assert mine.events[0].kind == "snap-in"
    assert mine.events[-1].kind == "pull-off"
    for one, two in zip(mine.events, other.events, strict=True):
        assert_allclose(one.penetration, two.penetration, atol=1e-4)
        assert_allclose(one.contact_radius, two.contact_radius, rtol=5e-3)
    (jump,) = np.flatnonzero(mine.contact_radius == mine.events[0].contact_radius)[:1]
    assert mine.time[jump + 1] == mine.time[jump]
    assert mine.contact_radius[jump + 1] > 1.1 * mine.contact_radius[jump]
    assert_allclose(mine.external_work[-1], other.external_work[-1], rtol=5e-3)


def test_adhesionless_first_contact_and_lift_off():
    steps = Ramp(0.01, 0.05), Ramp(-0.02, 0.05)
    trace = solve(scene(*steps, at=-0.01, adhesion=None), Options(resolution=4))
    assert trace.outcome.kind is OutcomeKind.DETACHED
    waiting = trace.time < 0.2
    assert_allclose(trace.force[waiting], 0.0)
    assert np.all(trace.force >= -1e-9)
    assert trace.contact_radius[-1] == trace.force[-1] == 0.0
    assert 0.0 < trace.stored_energy[-1] < 0.05 * trace.stored_energy.max()  # the free surface still creeps
    never = solve(scene(Ramp(-0.1, 0.05), at=-0.01, adhesion=None), COARSE)
    assert never.outcome.finished
    assert_allclose(never.contact_radius, 0.0)
    pulled = solve(scene(Force(-1.0, 1.0), at=-0.01, adhesion=None), COARSE)
    assert pulled.outcome.kind is OutcomeKind.DETACHED


@pytest.mark.parametrize("shear", [(), (Branch(6.0, 1.0),), (Branch(6.0, 0.5), Branch(0.3, 7.0))])
def test_shear_and_bulk_are_in_series(shear):
    """``1/E* = 1/(4 G) + 1/(4 K + 4 G/3)`` of the transforms, at real times of them."""
    material = Material(0.75, 0.3, shear, BulkRelaxation(2.0, (Branch(1.5, 0.5), Branch(1.0, 3.0))))
    found = surface_material(material)
    for p in (1e-3, 0.3, 2.0, 50.0):

        def transform(modulus, branches, p=p):
            return modulus + sum(one.modulus * p * one.time / (1.0 + p * one.time) for one in branches)

        g = transform(material.modulus, shear) / 2.6
        k = transform(2.0, material.bulk.branches)
        expected = 1.0 / (0.25 / g + 1.0 / (4.0 * k + 4.0 * g / 3.0))
        assert transform(found.modulus, found.branches) == pytest.approx(expected, rel=1e-13)


@pytest.mark.parametrize("annuli", ["graded", "uniform"])
def test_relaxing_bulk_is_that_of_the_surface_alone(annuli):
    separate = Material(0.75, 0.3, ONE.branches, BulkRelaxation(2.0, (Branch(1.0, 2.0),)))
    one, other = (
        solve(scene(Ramp(0.01, 0.1), start="relaxed", at=0.008, material=material), Options(6, annuli=annuli))
        for material in (separate, surface_material(separate))
    )
    assert np.array_equal(one.force, other.force)
    constant = solve(scene(Ramp(0.01, 0.1), start="relaxed", at=0.008), Options(6))
    assert one.force[-1] != pytest.approx(constant.force[-1], rel=0.1)


EXTREMES = {
    "stiff": scene(
        Ramp(0.021, 0.01), start="relaxed", at=0.02, material=Material(0.75, 0.5, (Branch(7.5e4, 1.0),))
    ),
    "very slow": cycle(1e-7),
    "very fast": cycle(1e7),
    "fifteen decades": scene(
        Ramp(0.01, 0.1), material=Material(1.0, 0.5, tuple(Branch(1.0, 10.0**k) for k in range(-9, 7)))
    ),
    "tiny unit": scene(
        Ramp(0.03e-9, 0.1e-9),
        indenter=Sphere(1e-9),
        adhesion=Adhesion(WORK * 1e-9, 0.013e-9),
    ),
    "long hold": scene(Ramp(0.02, 0.1), Hold(1e9)),
    "sharp cone": scene(Ramp(0.05, 0.1), indenter=Cone(20.0), adhesion=None),
    "almost flat": scene(Ramp(0.02, 0.1), indenter=PowerLaw(40.0, 1e20), adhesion=None),
    "punch": scene(Ramp(-0.5, 0.01), start="relaxed", at=0.01, indenter=FlatPunch(0.2)),
    "frequent": scene(Oscillate(1e-4, 1e3, 0.05), start="relaxed", at=0.02),
    "sweep": scene(Sweep(1e-3, 50.0, 1.0), start="relaxed", at=0.02),
    "steps": scene(Table((0.0, 0.5, 1.0), (0.0, 0.02, 0.01)), Force(0.0, 0.5), ForceRamp(PULL, PULL)),
    "weak adhesion": cycle(0.02, adhesion=Adhesion(1e-9, 3e-4), depth=1e-5),
    "no work of adhesion": scene(Ramp(0.01, 0.1), adhesion=Adhesion(0.0, 1.0)),
}
SLOW = dict.fromkeys(("fifteen decades", "frequent", "long hold", "no work of adhesion"), pytest.mark.slow)
SLOW |= dict.fromkeys(("sharp cone", "stiff", "sweep", "very slow"), pytest.mark.slow)


@pytest.mark.parametrize(
    "question",
    [pytest.param(case, id=name, marks=SLOW.get(name, ())) for name, case in EXTREMES.items()],
)
def test_never_anything_but_finite_numbers(question):
    trace = solve(question, Options(resolution=4, profile_times=(0.0, 0.05), max_steps=4000))
    assert finite(trace)
    assert trace.outcome.finished, trace.outcome
    assert np.all(np.diff(trace.time) >= 0.0)
    assert np.all(trace.contact_radius >= 0.0)
    assert trace.wall_seconds > 0.0


def test_whole_periods_are_not_stepped_over():
    """The end of the step has the phase of its start: no trial would notice where nothing relaxes.

    After the hold the first step is a twentieth of what follows, as a period is.
    """
    question = scene(Hold(100.0), Oscillate(1e-3, 1.0, 40.0 * np.pi), start="relaxed", material=ELASTIC)
    trace = solve(question, Options(resolution=4))
    assert_allclose(trace.penetration.max(), 1e-3, rtol=0.02)
    assert len(trace) > 100


@pytest.mark.parametrize(
    "contrast", [*(pytest.param(c, marks=pytest.mark.exhaustive) for c in (1e3, 1e6)), 1e9], ids="{:g}".format
)
def test_pull_of_a_relaxed_contact_depends_on_the_contrast_only_through_time(contrast):
    """At ``V tau_c = da`` the largest tension has a limit for a glass that is stiffer and stiffer."""
    rubber = Material(0.75, 0.5, (Branch(0.75 * (contrast - 1.0), 1.0),))
    question = scene(Ramp(-20.0, ZONE / contrast), start="relaxed", at=0.01, material=rubber)
    trace = solve(question, Options(resolution=4))
    assert_allclose(-trace.force.min(), 0.01013, rtol=5e-3)


@pytest.mark.parametrize(
    ("stop", "contrast"),
    [
        (0.3, 1e9),
        *(pytest.param(*row, marks=pytest.mark.exhaustive) for row in ((0.3, 1e6), (0.66, 1e6), (0.66, 1e9))),
    ],
)
def test_two_stops_close_together_do_not_turn_the_edge_of_a_stiff_glass(contrast, stop):
    """In steps so short the closure is met already where the edge stands, but for what it is known."""
    rubber = Material(0.75, 0.5, (Branch(0.75 * (contrast - 1.0), 1.0),))
    question = scene(Ramp(-20.0, ZONE / contrast), start="relaxed", at=0.01, material=rubber)
    stops = contrast * stop, contrast * (stop + 1e-10)
    trace = solve(question, Options(resolution=4, stop_times=stops))
    assert_allclose(-trace.force.min(), 0.01013, rtol=5e-3)


@pytest.mark.parametrize("annuli", ["graded", pytest.param("uniform", marks=pytest.mark.slow)])
@pytest.mark.parametrize(
    ("zone", "material"),
    [
        pytest.param(0.05, ONE, id="rubber", marks=pytest.mark.slow),
        pytest.param(0.08, ELASTIC, id="elastic"),
    ],
)
def test_contact_that_shrinks_to_its_zone_leaves_the_range_of_the_model(annuli, zone, material):
    """The last row is the state at the zone's length; nothing is called pull-off but the largest tension."""
    question = scene(
        Ramp(-0.5, 0.002), start="relaxed", at=0.01, material=material, adhesion=Adhesion(WORK, zone)
    )
    trace = bem(question, resolution=8, annuli=annuli)
    assert trace.outcome.kind is OutcomeKind.BELOW_ZONE
    assert trace.outcome.past_extremum
    assert trace.outcome.time == trace.time[-1]
    assert_allclose(trace.contact_radius[-1], zone, rtol=1e-12)
    assert np.all(trace.contact_radius >= zone * (1.0 - 1e-12))
    assert not trace.events
    finer = bem(question, resolution=12)
    assert_allclose(trace.force[-1], finer.force[-1], rtol=1e-3 if annuli == "graded" else 0.05)
    assert_allclose(trace.time[-1], finer.time[-1], rtol=1e-3 if annuli == "graded" else 0.02)


def test_elastic_cycle_costs_the_same_whatever_the_zone():
    """Every state is an equilibrium by itself: rows as needed for force and energy, annuli likewise."""
    rows = []
    for zone in (1e-3, 3e-5):
        trace = bem(cycle(0.02, material=ELASTIC, adhesion=Adhesion(WORK, zone)), resolution=6)
        exact = FiniteZone(1.0, 1.0, WORK, zone)
        assert_allclose(trace.force.min(), exact.pull_off_force_control().force, rtol=5e-4)
        assert_allclose(trace.penetration[-1], exact.pull_off_penetration_control().penetration, rtol=1e-4)
        rows.append(len(trace))
    assert max(rows) < 100
    assert rows[1] < 1.2 * rows[0]


@pytest.mark.parametrize(
    "step", [Force(-1e20, 1.0), Oscillate(1e-7, 10.0, 1.0, 1e45)], ids=["force", "drift"]
)
def test_a_pull_beyond_all_measure_detaches(step):
    trace = solve(of_small_sphere(step), Options(resolution=6))
    assert trace.outcome.kind is OutcomeKind.DETACHED
    assert all(np.isfinite(column).all() for column in trace.columns().values())


@pytest.mark.parametrize(
    ("where", "error", "kind"),
    [
        ("equilibrium", ZeroDivisionError, OutcomeKind.NO_EQUILIBRIUM),
        ("step", OverflowError, OutcomeKind.OUT_OF_RANGE),
    ],
)
def test_numbers_beyond_floating_point_end_a_run_with_a_reason(monkeypatch, where, error, kind):
    def beyond(*given):
        raise error("as told")

    monkeypatch.setattr(f"bem_solver.{where}.evaluate", beyond)
    trace = solve(of_small_sphere(Ramp(0.0, 1e-7)), Options(resolution=6))
    assert trace.outcome.kind is kind
    assert trace.outcome.reason == "a number is beyond the range of floating point (as told)"
    assert all(np.isfinite(column).all() for column in trace.columns().values())


def of_small_sphere(step):
    """Relaxed on a soft gel, then one load step."""
    material, loading = Material(2.2e4, 0.42, (Branch(6e4, 0.03),)), Loading("relaxed", 8e-7, (step,))
    return Scene(material, Sphere(3.7e-5), loading, Adhesion(0.03, 4e-7))


@pytest.mark.parametrize(
    ("branch_time", "rate"),
    [
        pytest.param(1e-18, 4e-6, marks=pytest.mark.slow),
        pytest.param(0.03, 1e-20, marks=pytest.mark.exhaustive),
    ],
)
def test_a_collapse_faster_than_the_rounding_of_time_is_a_detachment(branch_time, rate):
    """The contact is relaxed but for the collapse, whatever the units of time."""
    material = Material(2.2e4, 0.42, (Branch(6e4, branch_time),))
    pulled = Loading("relaxed", 8e-7, (Ramp(-6e-6, rate),))
    question = Scene(material, Sphere(3.7e-5), pulled, Adhesion(0.03, 4e-7))
    elastic = Scene(Material(2.2e4, 0.42), Sphere(3.7e-5), pulled, Adhesion(0.03, 4e-7))
    trace, limit = (solve(one, Options(resolution=4)) for one in (question, elastic))
    assert trace.outcome.kind is limit.outcome.kind is OutcomeKind.DETACHED
    assert_allclose(trace.force.min(), limit.force.min(), rtol=1e-4)
    assert_allclose(trace.time[-1], limit.time[-1], rtol=1e-4)


def test_within_the_rounding_of_time_the_time_of_a_step_is_not_sought():
    """A dead load under a law of rate: the collapse takes half of the steps, and none of the time."""
    adhesion = Adhesion(1e-4, 1e-4, rate=PowerRate(1e-3, 0.3))
    pulled = Loading("relaxed", 0.01, (Force(-2e-3, 1.0),))
    trace = solve(Scene(Material(1.0, 0.4), Sphere(1.0), pulled, adhesion), COARSE)
    assert trace.outcome.kind is OutcomeKind.BELOW_ZONE
    assert np.count_nonzero(trace.time > trace.time[-1] * (1.0 - 1e-12)) > 0.3 * len(trace)
    assert trace.counters.closure_evaluations < 8 * trace.counters.steps
