"""Front tracking against the check values of the model, its own convergence, and energy."""

import math
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from scipy.interpolate import PchipInterpolator
from support.paper_scenes import ONE, STICKY, WORK, ZONE, cycle
from support.paper_scenes import PULL as F_JKR

from contact_scene import (
    Adhesion,
    Branch,
    Force,
    Hold,
    Loading,
    Material,
    Oscillate,
    OutcomeKind,
    Ramp,
    Scene,
    Sphere,
    Step,
    Sweep,
    Table,
    Trace,
)
from validation import scenes
from validation.cases import load
from validation.measure.error_estimate import from_own
from validation.measure.observables import Observables, measure, observe
from validation.measure.scaling import scale
from validation.measure.windows import cycle_times
from validation.reference.finite_zone import FiniteZone
from validation.reference.path import Options, solve, solver
from validation.reference.path.solver import estimated_errors


def _spread(count: int, low: float, high: float) -> Material:
    """Branches of equal modulus, nine times E0 in all, at times evenly spread over decades."""
    times = np.logspace(low, high, count).tolist()
    return Material(0.75, 0.5, tuple(Branch(6.75 / count, time) for time in times))


MATERIALS = {
    "one": ONE,
    "two": Material(0.75, 0.5, (Branch(3.0, 0.1), Branch(3.75, 10.0))),
    "seven": _spread(7, -3, 3),
    "thirty": _spread(30, -10, 5),
}


@cache
def _solved(scene: Scene, resolution: int | None) -> Trace:
    return solve(scene, Options(resolution=resolution))


def _run(speed: float, resolution: int | None = None, material: str = "one") -> Trace:
    return _solved(cycle(speed, material=MATERIALS[material]), resolution)


def _seen(trace: Trace) -> Observables:
    assert trace.outcome.kind is OutcomeKind.DETACHED
    return observe(trace)


def _elastic(modulus: float) -> Scene:
    loading = Loading("relaxed", 0.032, (Ramp(-0.5, 0.01),))
    return Scene(Material(modulus, 0.5), Sphere(1.0), loading, STICKY)


@pytest.mark.parametrize(
    ("resolution", "accuracy"), [(8, 1e-5), pytest.param(16, 1.5e-6, marks=pytest.mark.slow)]
)
def test_the_largest_tension_is_where_its_derivative_vanishes(resolution: int, accuracy: float) -> None:
    """The force is flat there: its largest row says little about where, and the run says how little."""
    trace = _solved(_elastic(0.75), resolution)
    exact, got = FiniteZone(1.0, 1.0, WORK, ZONE).pull_off_force_control(), _seen(trace)
    assert got.pull_off_radius == pytest.approx(exact.contact_radius, rel=accuracy)
    assert got.pull_off_penetration == pytest.approx(exact.penetration, rel=4.0 * accuracy)
    assert got.pull_off_force == pytest.approx(-exact.force, rel=0.1 * accuracy)
    (event,) = trace.located
    assert abs(event.contact_radius - exact.contact_radius) < event.uncertainty[3]
    assert event.uncertainty[3] < 1e-3 * exact.contact_radius


def test_steps_of_an_elastic_contact_do_not_depend_on_the_process_zone() -> None:
    """Each state is an equilibrium by itself; a zone of 5e-6 contact radii costs a few steps more."""
    zone = 1.3e-6
    trace = solve(replace(_elastic(0.75), adhesion=Adhesion(WORK, zone)))
    assert trace.counters.steps < 1.5 * _solved(_elastic(0.75), None).counters.steps
    elastic, got = FiniteZone(1.0, 1.0, WORK, zone), _seen(trace)
    exact, last = elastic.pull_off_force_control(), elastic.pull_off_penetration_control()
    assert got.pull_off_force == pytest.approx(-exact.force, rel=2e-7)
    (largest,) = trace.located  # a row next to it has the same force to rounding
    assert largest.contact_radius == pytest.approx(exact.contact_radius, rel=2e-6)
    assert got.detachment_penetration == pytest.approx(last.penetration, rel=1e-8)
    for row in range(0, len(trace) - 40, 20):
        state = elastic.at_penetration(float(trace.penetration[row]))
        assert trace.contact_radius[row] == pytest.approx(state.contact_radius, rel=1e-5)
        assert trace.force[row] == pytest.approx(state.force, abs=1e-5 * trace.force.max())


def test_the_deepest_row_of_an_oscillation_is_its_first_peak() -> None:
    """All peaks are equally deep; rows that miss them by more or less would pick one at random."""
    oscillating = Loading("relaxed", 0.032, (Oscillate(1e-3, 2.0, 8.0),))
    seen = observe(solve(replace(_elastic(0.75), loading=oscillating), Options(resolution=4)))
    exact = FiniteZone(1.0, 1.0, WORK, ZONE).at_penetration(0.033)
    assert seen.approach_time == pytest.approx(0.25 * math.pi, rel=1e-8)
    assert seen.approach_penetration == pytest.approx(0.033, rel=1e-12)
    assert seen.approach_force == pytest.approx(exact.force, rel=1e-5)


SLOW = pytest.mark.slow


@pytest.mark.parametrize(
    ("speed", "material"),
    [pytest.param(0.02, "one", marks=SLOW)]
    + [pytest.param(0.02, m, marks=pytest.mark.exhaustive) for m in ("two", "seven", "thirty")]
    + [pytest.param(speed, "one", marks=pytest.mark.exhaustive) for speed in (0.1, 0.002)],
)
def test_errors_fall_with_the_square_of_the_resolution(speed: float, material: str) -> None:
    """As the tolerance does, in all that is measured; single errors change their sign on the way.

    Columns are compared at moments that all runs step onto: no interpolation error is in them.
    """
    scene, resolutions = cycle(speed, material=MATERIALS[material]), (4, 16, 32)
    moments = tuple((np.linspace(0.06, 0.96, 11) * _solved(scene, 4).time[-1]).tolist())

    def measured(resolution: int) -> dict[str, np.ndarray]:
        trace = solve(scene, Options(resolution, profile_times=moments))
        rows = [int(np.abs(trace.time - moment).argmin()) for moment in moments]
        found, seen = (
            {name: trace.columns()[name][rows] for name in ("force", "contact_radius")},
            _seen(trace),
        )
        return found | {name: np.array([getattr(seen, name)]) for name in ("pull_off_force", "loop_energy")}

    exact = measured(96)
    size = {name: np.abs(values).max() for name, values in exact.items()}
    found = {n: measured(n) for n in resolutions}
    worst = {n: max(np.abs(found[n][name] - exact[name]).max() / size[name] for name in exact) for n in found}
    for resolution in resolutions:
        assert worst[resolution] < 0.3 * Options(resolution).step_tolerance, worst
    assert worst[32] < (1e-6 if material == "thirty" else 2e-7)  # over fifteen decades of times
    assert worst[4] > 2.0 * worst[32]
    estimates = solve(scene, Options(16, estimate_errors=True)).errors
    assert all(0.0 < error <= 2e-5 for error in estimates.values())


def test_estimates_from_two_runs() -> None:
    """Two runs by hand: tensions 1 and 1.03, works -2 and -2.06, and contact lost at t = 2 and 2.3."""

    def columns(share: float, end: float) -> dict[str, np.ndarray]:
        return {
            "time": np.array([0.0, 1.0, end, end]),
            "penetration": np.array([4.0, 0.0, -end, -end]),
            "force": share * np.array([0.0, -1.0, -0.5, 0.0]),
            "contact_radius": np.array([1.0, 1.0, 0.5, 0.0]),
            "external_work": share * np.array([0.0, -1.0, -2.0, -2.0]),
        }

    fine, coarse = columns(1.0, 2.0), columns(1.03, 2.3)
    found = estimated_errors(fine, coarse, True)
    assert 0.03 <= found["loop_energy"] < 0.1  # along the way the later end counts, too
    assert found["pull_off_force"] >= 0.03
    assert found["detachment_time"] == pytest.approx(0.15)
    assert found["detachment_penetration"] == pytest.approx(0.075)
    assert "detachment_time" not in estimated_errors(fine, coarse)
    alike = columns(1.03, 2.0)
    assert estimated_errors(fine, alike)["loop_energy"] == pytest.approx(0.03)
    alike["external_work"][-2:] = fine["external_work"][-2:]  # they agree at the end, not at the kink
    assert 0.004 < estimated_errors(fine, alike)["loop_energy"] < 0.006  # in the mean of four rows


def _slow_unless(quick: set[str], names: list[str]) -> list[object]:
    return [pytest.param(name, marks=() if name in quick else pytest.mark.slow) for name in names]


_TABLE = np.linspace(0.0, 3.2, 161)
OWN_SCENES = {
    "sphere without adhesion": Scene(
        ONE, Sphere(1.0), Loading("jump-in", 0.0, (Ramp(0.032, 0.02), Ramp(-0.1, 0.02)))
    ),
    "table of 161 rows": Scene(
        ONE,
        Sphere(1.0),
        Loading(
            "jump-in", 0.0, (Table(tuple(_TABLE), tuple(0.032 - 0.02 * abs(_TABLE - 1.6))), Ramp(-0.1, 0.02))
        ),
    ),
    "pull by a table of 161 rows": Scene(
        ONE,
        Sphere(1.0),
        Loading("relaxed", 0.03, (Table(tuple(_TABLE), tuple(0.03 - 0.01 * _TABLE)), Ramp(-0.1, 0.01))),
        Adhesion(5.026548e-4, 0.004),
    ),
}


@pytest.mark.parametrize(
    "name",
    _slow_unless({"cone-pull"}, [*scenes.suite("quick"), *OWN_SCENES]),
)
def test_no_estimate_is_below_the_true_difference(name: str) -> None:
    """From a run with a quarter of the step; loop energies were 13 times, of tables 670 times off."""
    scene = OWN_SCENES[name] if name in OWN_SCENES else load(name).scene
    divisions = 16 if scene.is_adhesive else 4
    stops = tuple(cycle_times(scene.loading))
    options = Options(divisions, stop_times=stops, estimate_errors=True)
    run, run_tolerance = solve(scene, options), options.step_tolerance
    fine = solve(scene, Options(4 * divisions, stop_times=stops))
    measured, true = measure(run, scene, 0.0), measure(fine, scene, 0.0)
    short = {}
    for quantity, error in from_own(run, measured, scene.loading).items():
        value, there = measured.get(quantity), true.get(quantity)
        if value is not None and there is not None:
            missed = abs(value - there) - error * scale(quantity, value, run)
            if missed > 1e-3 * run_tolerance * abs(value):  # what steps differ by at the same tolerance
                short[quantity] = error * scale(quantity, value, run) / abs(value - there)
    assert not short


@pytest.mark.parametrize(
    "speed",
    [pytest.param(0.02, marks=SLOW), *(pytest.param(v, marks=pytest.mark.exhaustive) for v in (0.002, 0.1))],
)
def test_own_error_estimates(speed: float) -> None:
    trace, coarse = (solve(cycle(speed), Options(n, estimate_errors=True)) for n in (None, 4))
    detachment = {"detachment_time", "detachment_penetration"}
    assert set(trace.errors) == {"pull_off_force", "loop_energy", "contact_radius", "force"} | detachment
    assert all(0.0 < error <= 2e-5 for error in trace.errors.values())
    for name in ("loop_energy", "contact_radius", "force"):
        assert coarse.errors[name] > trace.errors[name], name
    for name in ("pull_off_force", "loop_energy"):
        real = abs(getattr(_seen(coarse), name) / getattr(_seen(_run(speed, 32)), name) - 1.0)
        assert real < 3.0 * coarse.errors[name] + 5e-6, name


SLOW_CYCLE = {
    "approach_force": 5.987168539e-3,
    "approach_radius": 0.24416427034,
    "pull_off_force": 2.6331464945e-3,
    "final_penetration": -0.0135203664,
}
"""By twice the default resolution."""


@pytest.mark.slow
def test_slow_approach_resolves_the_layer_behind_the_edge() -> None:
    """Steps of several relaxation times; the layer is a hundredth of the process zone."""
    usual = _run(2e-5)
    assert np.diff(usual.time).max() > 3.0
    # creep slows the final instability down, so that the radius reaches the length of the process zone
    assert usual.outcome.kind is OutcomeKind.BELOW_ZONE
    for name, value in SLOW_CYCLE.items():
        assert getattr(observe(usual), name) == pytest.approx(value, rel=2e-5), name


@pytest.mark.parametrize("material", ["one", pytest.param("two", marks=SLOW)])
def test_branches_dissipate_what_the_balance_says(material: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """The branch integral, taken from the fields step by step, against work, energy and tip release."""
    power: list[tuple[float, float]] = []
    accepted = solver.PathRun._accepted

    def add_power(run, arrival, state, s):  # type: ignore[no-untyped-def]
        rheology = run.recorder.body.rheology
        held = state.held_squares / (rheology.moduli * rheology.times)
        free = state.free_squares / (rheology.compliances * rheology.retardation)
        power.append((state.time, 2.0 * float(held.sum() + free.sum())))
        accepted(run, arrival, state, s)

    monkeypatch.setattr(solver.PathRun, "_accepted", add_power)
    trace = solve(cycle(0.02, material=MATERIALS[material]), Options(resolution=128))
    at, rate = np.array(power[:-1]).T
    direct = np.zeros_like(at)
    for part in (at <= 1.6, at >= 1.6):  # the load turns
        later = part & np.append(np.diff(at) > 0.0, True)
        direct[part] += PchipInterpolator(at[later], rate[later]).antiderivative()(at[part])
        direct[at > at[part][-1]] = direct[part][-1]
    column = np.interp(at, trace.time[:-1], trace.extra["branch_dissipation"][:-1])
    assert np.abs(direct - column).max() < 1e-4 * column[-1]


@SLOW
def test_thirty_branches_over_fifteen_decades() -> None:
    """Times from 1e-10 to 1e5: the number of steps depends on what happens, not on the shortest time."""
    trace = _run(0.02, 8, "thirty")
    assert len(trace) < 600
    seen = _seen(trace)
    assert seen.pull_off_force == pytest.approx(1.37955 * F_JKR, rel=1e-4)
    assert seen.approach_force == pytest.approx(9.517953e-3 * math.pi, rel=1e-5)


def test_energy_columns() -> None:
    trace = _run(0.02, 8)
    area = math.pi * trace.contact_radius**2
    loss = trace.external_work + WORK * (area - area[0]) - (trace.stored_energy - trace.stored_energy[0])
    np.testing.assert_allclose(trace.dissipated_energy, loss, atol=1e-8 * loss.max())
    assert trace.external_work[-1] == pytest.approx(_seen(trace).loop_energy, rel=2e-5)
    assert np.diff(trace.dissipated_energy).min() > -1e-4 * trace.dissipated_energy[-1]
    tip = trace.extra["stress_intensity_factor"][:-1] ** 2 / (2.0 * 10.0)
    surplus = np.diff(trace.extra["branch_dissipation"] - trace.dissipated_energy)[:-1]
    expected = (WORK - 0.5 * (tip[1:] + tip[:-1])) * -np.diff(area[:-1])
    assert np.abs(surplus - expected).sum() < 1e-4 * trace.dissipated_energy[-1]


def test_energy_release_rate_of_an_elastic_contact_is_the_work_of_adhesion() -> None:
    """Up to the bias of the finite zone: it vanishes with the zone."""
    bias = []
    for zone in (0.013, 0.0065):
        scene = Scene(
            Material(0.75, 0.5), Sphere(1.0), Loading("relaxed", 0.032, (Ramp(-0.001, 0.01),)),
            Adhesion(WORK, zone),
        )  # fmt: skip
        rate = solve(scene, Options(resolution=4)).extra["energy_release_rate"]
        assert np.isfinite(rate).all()
        bias.append(np.abs(rate[1:] / WORK - 1.0).max())
    assert bias[0] < 0.03
    assert bias[1] == pytest.approx(0.5 * bias[0], rel=0.1)


def _sweep(duration: float) -> Scene:
    return Scene(
        ONE, Sphere(1.0),
        Loading("relaxed", 5.7e-5, (Sweep(-1.7e-5, 0.006, duration),)), Adhesion(math.pi * 5e-8, 8.5e-4),
    )  # fmt: skip


def _cycle_ends(duration: float) -> tuple[float, ...]:
    count = int(0.006 * duration**2 / (4.0 * math.pi))
    return tuple(np.sqrt(4.0 * math.pi * np.arange(1, count + 1) / 0.006))


@SLOW
def test_sweep_goes_over_its_own_tracks() -> None:
    """Re-advance over released surface, with thinning: rows at the ends of cycles against a finer run."""
    ends = _cycle_ends(66.0)
    usual = solve(_sweep(66.0), Options(profile_times=ends))
    fine = solve(_sweep(66.0), Options(profile_times=ends, resolution=32))
    assert usual.contact_radius[0] == pytest.approx(0.01311, abs=5e-6)
    for column in ("force", "contact_radius"):
        one, two = (getattr(t, column)[np.searchsorted(t.time, ends)] for t in (usual, fine))
        assert np.abs(one - two).max() < 2e-5 * np.abs(getattr(fine, column)).max()


@pytest.mark.parametrize(
    ("steps", "force", "penetration", "radius"),
    [
        ((Hold(50.0),), -3.687039228e-4, 0.01, 0.1800381741),
        pytest.param(
            (Force(2.0 * F_JKR, 20.0), Force(-F_JKR, 20.0)), -F_JKR, 0.008339471159, 0.1892616929,
            marks=pytest.mark.slow,
        ),
        ((Oscillate(0.004, 1.0, 6.0, drift=1e-3),), -4.736601996e-4, 0.002882338007, 0.1374725703),
    ],
    ids=["hold", "force", "oscillate"],
)  # fmt: skip
def test_other_controls_agree_with_a_finer_run(
    steps: tuple[Step, ...], force: float, penetration: float, radius: float
) -> None:
    """Last row by twice the default resolution."""
    usual = solve(Scene(ONE, Sphere(1.0), Loading("jump-in", 0.01, steps), STICKY))
    assert usual.outcome.kind is OutcomeKind.COMPLETED
    assert usual.force[-1] == pytest.approx(force, abs=2e-5 * np.abs(usual.force).max())
    assert usual.penetration[-1] == pytest.approx(penetration, rel=2e-5)
    assert usual.contact_radius[-1] == pytest.approx(radius, rel=2e-5)


@SLOW
def test_constant_tension_detaches_with_delay() -> None:
    pulled = Loading("relaxed", 0.032, (Force(-3.0 * F_JKR, 1000.0),))
    trace = solve(Scene(ONE, Sphere(1.0), pulled, STICKY))
    assert trace.outcome.kind is OutcomeKind.DETACHED
    assert trace.time[-1] == pytest.approx(56.52096844, rel=5e-5)  # by twice the resolution
    row = int(np.searchsorted(trace.time, 0.0, side="right")) - 1  # after the jump
    assert trace.force[row] == pytest.approx(-3.0 * F_JKR, rel=1e-9)
