"""Energies of a run: balance, branches, stored energy, release rate."""

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.integrate import cumulative_trapezoid
from support.bem_runs import STIFFNESS, bem, front, observed_order
from support.closed_forms import hertz
from support.paper_scenes import ELASTIC, ONE, WORK, ZONE, cycle, scene

from bem_solver.creep import Chain
from bem_solver.recorder import RowPath, rest_ends, stored_energy
from contact_scene import Adhesion, Branch, FlatPunch, Hold, Material, Oscillate, Ramp, Table
from validation.reference.finite_zone import FiniteZone


def area(trace):
    return np.pi * trace.contact_radius**2


@pytest.mark.parametrize(
    "question",
    [
        pytest.param(cycle(0.02), id="cycle"),
        pytest.param(scene(Ramp(0.03, 0.1), Hold(2.0)), id="hold", marks=pytest.mark.slow),
        pytest.param(scene(Oscillate(0.005, 1.0, 8.0), at=0.02), id="oscillation"),
        pytest.param(scene(Ramp(0.02, 0.05), Ramp(-0.1, 0.05), adhesion=None), id="adhesionless"),
    ],
)
def test_balance(question):
    """``F dD + dg dA = dU + P_d dt``, row by row."""
    trace = bem(question, resolution=6)
    work = question.adhesion.work if question.adhesion else 0.0
    external = trace.external_work
    straight = cumulative_trapezoid(trace.force, trace.penetration, initial=0.0)
    assert_allclose(external, straight, atol=5e-3 * np.abs(straight).max())
    left = external + work * (area(trace) - area(trace)[0])
    right = trace.stored_energy - trace.stored_energy[0] + trace.dissipated_energy
    assert_allclose(left, right, atol=1e-12 * np.abs(left).max())
    assert trace.external_work[0] == trace.dissipated_energy[0] == 0.0


def test_energies_are_those_of_front_tracking():
    mine, other = bem(cycle(0.02)), front(cycle(0.02))
    times = np.linspace(0.0, 0.99 * min(mine.time[-1], other.time[-1]), 60)
    for name in ("stored_energy", "external_work", "dissipated_energy"):
        expected = np.interp(times, other.time, other.columns()[name])
        found = np.interp(times, mine.time, mine.columns()[name])
        assert_allclose(found, expected, atol=4e-3 * np.abs(expected).max(), err_msg=name)


APART = Material(0.75, 0.5, (Branch(2.25, 1.0), Branch(1.0, 0.1)))


@pytest.mark.slow
def test_branches_dissipate_the_loss_modulus_while_the_edge_rests():
    """A swinging punch: ``2 a pi d^2 E''`` a cycle. With a load straight in every step 2e-3 are missing."""
    depth, frequency, cycles = 0.002, 3.0, 4
    period = 2.0 * np.pi / frequency
    swings = scene(
        Oscillate(depth, frequency, cycles * period),
        start="relaxed",
        at=0.01,
        material=APART,
        indenter=FlatPunch(0.3),
    )
    trace = bem(swings, stop_times=((cycles - 1) * period,))
    last = np.searchsorted(trace.time, (cycles - 1) * period)
    y = [frequency * branch.time for branch in APART.branches]
    loss = sum(b.modulus * y / (1.0 + y**2) for b, y in zip(APART.branches, y, strict=True)) / 0.75
    heat = trace.extra["branch_dissipation"]
    assert_allclose(heat[-1] - heat[last], 2.0 * 0.3 * np.pi * depth**2 * loss, rtol=4e-4)


def test_branches_dissipate_the_loss_of_a_swing_without_adhesion():
    """Steps are as long as the fastest branch's time: of the power it receives, the trapezoid lost 3 %."""
    rubber = Material(0.2, 0.49, (Branch(0.15, 0.01), Branch(0.1, 0.3)))
    swing = scene(Oscillate(0.005, 6.28, 1.0), start="relaxed", at=0.02, material=rubber, adhesion=None)
    trace = bem(swing, resolution=8)
    assert_allclose(trace.extra["branch_dissipation"][-1], trace.dissipated_energy[-1], rtol=6e-3)


@pytest.mark.slow
def test_branches_dissipate_the_loss_of_a_hold():
    """Of steps short for the slow branch, not for the fast one: 1.7e-3 too much with straight supplies."""
    trace = bem(scene(Ramp(0.01, 0.02), Hold(3.0), start="jump-in", at=0.0, adhesion=None, material=APART))
    assert_allclose(trace.extra["branch_dissipation"][-1], trace.dissipated_energy[-1], rtol=4e-4)


def test_elastic_contact_stores_its_work_and_loses_nothing():
    """``dU = F dD + dg dA``; Hertz's ``8 E* a^5/15``."""
    hertzian = bem(scene(Ramp(0.04, 0.05), start="relaxed", at=0.01, adhesion=None, material=ELASTIC))
    exact = hertz.stored_energy(hertzian.contact_radius, 1.0, 1.0)
    assert_allclose(hertzian.stored_energy, exact, rtol=1e-4)
    assert_allclose(hertzian.dissipated_energy, 0.0, atol=5e-4 * exact.max())  # trapezoids of 25 rows
    sticky = bem(cycle(0.02, material=ELASTIC))
    contact = sticky.contact_radius > 0.0
    bias = FiniteZone(1.0, 1.0, WORK, ZONE).energy_release_rate(0.2) / WORK - 1.0
    turned = WORK * np.ptp(area(sticky))
    assert np.abs(sticky.dissipated_energy[contact]).max() < (abs(bias) + 0.02) * turned
    assert_allclose(sticky.extra["branch_dissipation"], 0.0)


def test_jump_at_fixed_radius_is_reversible():
    """A punch pushed at once: glassy work, all of it stored."""
    jump = scene(
        Table((0.0, 1e-9), (0.02, 0.02)), start="relaxed", at=0.01, indenter=FlatPunch(0.2), adhesion=None
    )
    trace = bem(jump)
    work = 2.0 * 0.2 * (0.01 * 0.01 + 0.5 * 10.0 * 0.01**2)
    assert_allclose(trace.external_work[-1], work, rtol=1e-6)
    assert_allclose(trace.stored_energy[-1] - trace.stored_energy[0], work, rtol=1e-5)


def test_release_rate_of_a_quasi_static_edge_is_the_work_of_adhesion():
    """``G = (dU - F dD)/dA`` of an elastic contact, up to the bias of a finite zone."""
    trace = bem(scene(Ramp(-0.5, 0.01), start="relaxed", at=0.03, material=ELASTIC), resolution=24)
    rate = trace.extra["energy_release_rate"]
    assert np.isfinite(rate).all()
    inner = slice(5, -10)
    law = FiniteZone(1.0, 1.0, WORK, ZONE)
    exact = [law.energy_release_rate(a) for a in trace.contact_radius[inner]]
    assert_allclose(rate[inner], exact, rtol=0.02)


def test_stress_intensity_is_that_of_the_closure_when_the_zone_is_short():
    trace = bem(scene(start="relaxed", at=0.032, adhesion=Adhesion(WORK, 1e-3)))
    intensity = trace.extra["stress_intensity_factor"][0]
    assert_allclose(intensity**2 / (2.0 * STIFFNESS), WORK, rtol=0.01)


def test_branches_warm_behind_an_edge_that_advances_slower_than_any_of_them_relaxes():
    """Layers behind the edge, far thinner than an annulus, have no part in the states: the balance holds."""
    trace = bem(scene(Ramp(0.01, 1e-6), start="relaxed", at=0.0), resolution=4)
    branch = trace.extra["branch_dissipation"]
    assert_allclose(branch[-1], 1.8223e-4, rtol=0.03)  # front tracking
    assert np.all(np.diff(branch) >= -1e-4 * branch[-1])


@pytest.mark.parametrize(
    ("time", "resolution"),
    [
        (1e-4, 4),
        (1e-2, 12),
        *(pytest.param(*row, marks=pytest.mark.slow) for row in ((1e-2, 4), (1e-4, 12))),
    ],
)
def test_branches_faster_than_the_steps(time, resolution):
    """Without adhesion the branch integral is the loss, also where steps are many times the branch's time."""
    rubber = Material(0.75, 0.5, (Branch(6.75, time),))
    question = scene(Hold(1.0), Ramp(0.02, 0.01), at=0.01, adhesion=None, material=rubber)
    trace = bem(question, resolution=resolution)
    branch, lost = trace.extra["branch_dissipation"], trace.dissipated_energy[-1]
    assert np.diff(trace.time).max() > 3.0 * time
    assert_allclose(branch[-1], lost, rtol=0.03 if resolution == 4 else 0.005)
    assert np.all(np.diff(branch) >= -2e-3 * lost)


@pytest.mark.parametrize("slow", [1e-3, 1.0, 1e3])
def test_stored_energy_of_a_load_that_swings(slow):
    """One surface point: ``Y = v^2``, ``X = v e``, ``W = e^2`` with ``e' = (J v - e)/theta``."""
    chain = Chain(ONE)
    (compliance,), (theta,) = chain.compliances, chain.retardation

    def error(rows):
        phase = np.linspace(0.0, 3.0, rows + 1)
        time, wave, load = phase * slow * theta, 1.0 / slow, np.sin(phase)
        strain = (load - wave * np.cos(phase) + wave * np.exp(-time / theta)) / (1.0 + wave**2)
        found = stored_energy(chain, RowPath(time, []), time, load**2, (compliance * load * strain)[:, None])
        exact = 0.5 * (load**2 / chain.glassy + compliance * strain**2)
        return np.abs(found - exact).max() / exact.max()

    coarse, fine = error(40), error(80)
    assert fine < 1e-6
    assert slow > 1.0 or observed_order([coarse, fine]) > 2.8


def external_work(time, penetration, force, kinks, edge=None):
    return np.concatenate(([0.0], np.cumsum(RowPath(time, kinks, edge).integral(force, penetration))))


def sampled(rows):
    """A lagging force under an oscillating penetration: ``pi sin(0.7)`` of work a cycle."""
    time = np.linspace(0.0, 2.0 * np.pi, rows + 1) + 0.1 * np.sin(np.linspace(0.0, 2.0 * np.pi, rows + 1))
    return time, np.sin(time), np.sin(time + 0.7)


def test_work_of_a_loop_is_of_third_order_or_better():
    errors = [abs(external_work(*sampled(n), [])[-1] / (np.pi * np.sin(0.7)) - 1.0) for n in (16, 32, 64)]
    assert observed_order(errors[:2]) > 2.8
    assert observed_order(errors[1:]) > 2.8
    assert errors[0] < 4e-3
    straight = np.trapezoid(sampled(16)[2], sampled(16)[1])
    assert errors[0] < 0.2 * abs(straight / (np.pi * np.sin(0.7)) - 1.0)


@pytest.mark.parametrize("apart", [1e-12, 1e-9, 1e-5])
@pytest.mark.parametrize("at", [0, 3, 11, 16])
def test_rows_at_nearly_the_same_time_tell_no_slope_of_the_work(at, apart):
    """A stop just after another: what the force misses there would be all of its slope."""
    time, depth, force = sampled(16)
    plain = external_work(time, depth, force, [])[-1]
    before, after = (time[at], time[at] + apart) if at < 16 else (time[at] - apart, time[at])
    lost = 1e-7 * np.pi
    columns = (np.insert(values, at, values[at]) for values in (time, depth, force))
    time, depth, force = columns
    time[at : at + 2], force[at + 1] = (before, after), force[at] + lost
    assert_allclose(external_work(time, depth, force, [])[-1], plain, rtol=2e-3)


def test_work_where_an_edge_rests_at_every_turn():
    """Over its own way alone force and penetration are not smooth there, over time they are."""
    time = np.linspace(0.0, 6.0 * np.pi, 91)
    edge = np.tanh(4.0 * np.sin(time))
    found = external_work(time, np.sin(time), np.cos(time + 0.3), [], edge)[-1]
    assert_allclose(found, 3.0 * np.pi * np.cos(0.3), rtol=2e-3)


def test_work_up_to_a_limit_point_is_as_exact():
    """There force and penetration are roots of the time that is left, and smooth in the place of the edge."""

    def error(rows, with_edge):
        edge = 1.0 - np.linspace(0.0, 1.0, rows + 1)
        time, force = 1.0 - edge**2, 1.0 + np.sin(edge)
        work = external_work(time, -2.0 * time, force, [], edge if with_edge else None)[-1]
        return abs(work / (-2.0 - 4.0 * (np.sin(1.0) - np.cos(1.0))) - 1.0)

    assert observed_order([error(16, True), error(32, True)]) > 2.8
    assert error(16, True) < 3e-6
    assert error(16, True) < 0.1 * error(16, False)


@pytest.mark.parametrize("resolution", [6, pytest.param(12, marks=pytest.mark.slow)])
def test_heat_of_the_branches_in_a_cycle(resolution):
    """By front tracking; the trapezoids of what the branches receive alone are 3e-3 and 1e-3 off."""
    found = bem(cycle(0.02), resolution=resolution).extra["branch_dissipation"][-1]
    exact = front(cycle(0.02)).extra["branch_dissipation"][-1]
    assert abs(found / exact - 1.0) < 5e-3 / resolution**2


def test_no_slope_is_taken_across_a_kink_or_a_jump():
    """Triangles: straight lines are exact, and cubics across the corner are not."""
    time = np.array([0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0])
    depth = np.array([0.0, 1.0, 2.0, 3.0, 2.0, 1.0, 0.0])
    force = depth**1.0
    assert_allclose(external_work(time, depth, force, [3])[3], 4.5, rtol=1e-15)
    assert abs(external_work(time, depth, 2.0 * depth + (time > 3.0), [])[-1]) > 0.0
    jump = np.array([0.0, 1.0, 2.0, 2.0, 3.0, 4.0, 5.0])
    force = np.where(np.arange(7) > 2, 1.0, 0.0)
    found = external_work(jump, np.array([0.0, 1.0, 2.0, 4.0, 5.0, 6.0, 7.0]), force, [])
    assert_allclose(found[-1], 1.0 + 3.0, rtol=1e-14)


def test_no_slope_is_taken_where_an_edge_that_rested_sets_off():
    """Long steps of a punch, then a fall of the tension in steps fifty times as short."""
    time = np.concatenate((np.arange(5.0), 4.0 + 0.02 * np.arange(1.0, 6.0)))
    radius = np.concatenate((np.full(5, 1.0), 1.0 - 1e-3 * np.arange(1.0, 6.0)))
    depth, force = -time, np.where(time <= 4.0, 2.0 - time, 100.0 * (time - 4.0) - 2.0)
    assert rest_ends(radius) == [4]
    work = external_work(time, depth, force, rest_ends(radius))
    assert_allclose(work[:5], -(2.0 * time - time**2 / 2.0)[:5], atol=1e-12)
    assert abs(external_work(time, depth, force, [])[4]) > 1.0  # the slopes of the fall within the long step
