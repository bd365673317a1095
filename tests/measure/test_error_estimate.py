"""What runs say about their own errors: curves and scalars from two runs, events from rows or solver."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
from support.spring_solver import FunctionSolver
from support.spring_solver import spring as spring_solve
from support.synthetic_traces import by_hand

from contact_scene import COLUMNS, Event, Force, ForceRamp, Hold, Loading, Outcome, OutcomeKind, Ramp, Trace
from crosscontact import arguments
from validation import solvers
from validation.cases import load
from validation.compare.checks import check_case
from validation.measure.curves import distance, interpolation_error
from validation.measure.error_estimate import from_own, from_two_runs
from validation.measure.events import SAFETY
from validation.measure.observables import measure
from validation.measure.scaling import scale
from validation.runs.run import run

CASE = load("cycle-v0.1")


def spring(stiffness: float, solver: str = "fem", rows: int = 41, **columns) -> Trace:
    """A spring pressed in and pulled out again, kinked at half time; some columns replaced."""
    t = np.linspace(0.0, 1.0, rows)
    d = 0.03 - 0.08 * np.abs(t - 0.5)
    made = {"penetration": d, "force": stiffness * d, "contact_radius": 0.2}
    energies = dict.fromkeys(COLUMNS[4:], 0.5 * stiffness * d**2)
    return dataclasses.replace(by_hand(t, solver=solver, **made, **energies), **columns)


def estimates(run: Trace, other: Trace, ratio: float = 2.0, loading: Loading | None = None):
    measured, otherwise = (measure(trace, CASE.scene, 0.0) for trace in (run, other))
    return from_two_runs(run, other, measured, otherwise, ratio, loading)


@pytest.mark.parametrize("ratio", [2.0, 2.25, 1.75, 0.5])
def test_an_estimate_is_three_times_the_error_at_first_order(ratio):
    run, other = spring(1.0 + 1e-3), spring(1.0 + 1e-3 * ratio)
    found = estimates(run, other, ratio)
    assert found["approach_force"] == pytest.approx(SAFETY * 1e-3, rel=4e-3)
    assert found["force"] == pytest.approx(SAFETY * 1e-3 * 0.4, rel=0.5)


def test_what_agrees_by_accident_is_no_better_than_the_curves():
    """A scalar, a penetration under a given force, and a square, which is twice as uncertain."""
    fine = spring(1.0)
    wave = np.sin(2 * np.pi * fine.time)
    bent = dataclasses.replace(fine, force=fine.force * (1.0 + 0.1 * wave))
    found, apart = estimates(fine, bent), distance(bent, fine, "force")
    assert found["force"] == pytest.approx(SAFETY * apart.rms, abs=2e-5)
    assert found["force"] > found["approach_force"] == pytest.approx(SAFETY * apart.mean, abs=2e-5)
    deeper = dataclasses.replace(fine, penetration=fine.penetration + 1e-3 * wave)
    alike = {"detachment_penetration": -0.01, "detachment_time": 1.0}
    found, apart = from_two_runs(fine, deeper, alike, alike), distance(deeper, fine, "penetration")
    assert found["force"] == found["detachment_time"] == 0.0
    assert found["detachment_penetration"] == pytest.approx(SAFETY * apart.mean, rel=1e-6)
    alike = {"branch_dissipation": 3.0, "detachment_radius": 0.2}
    found = from_two_runs(fine, spring(1.01), alike, alike)
    assert found["branch_dissipation"] == pytest.approx(2.0 * found["detachment_radius"]) != 0.0


@pytest.mark.parametrize("relaxes", [True, False])
def test_losses_that_agree_at_the_end_by_accident_were_apart_on_the_way(relaxes):
    """By a sine of amplitude 0.1; where nothing relaxes they are those of jumps, each at its time."""
    rough = spring(1.0, rows=401)
    t = rough.time
    heat, apart = (t if relaxes else 0.0 * t), 0.1 * np.sin(2.0 * np.pi * t)
    run = dataclasses.replace(rough, dissipated_energy=t, extra={"branch_dissipation": heat})
    other = dataclasses.replace(run, dissipated_energy=t + apart, extra={"branch_dissipation": heat + apart})
    alike = {"dissipated_energy": 1.0, "branch_dissipation": 1.0, "loop_energy": 1.0, "pull_off_force": 1.0}
    found = from_two_runs(run, other, alike, alike)
    expected = 2.0 * SAFETY * 0.1 / np.sqrt(2.0) if relaxes else 0.0
    for name in ("dissipated_energy", "loop_energy", "branch_dissipation"):
        assert found[name] == pytest.approx(expected, rel=1e-3)
    assert found["pull_off_force"] == 0.0


def test_energies_have_the_errors_of_their_terms_and_of_what_they_leave():
    losses = {"branch_dissipation": 3.0, "dissipated_energy": 2.0, "zone_excess": 1.0}
    moved = {"branch_dissipation": 3.1, "dissipated_energy": 2.1, "zone_excess": 1.0}
    found = from_two_runs(spring(1.0), spring(1.0), losses, moved)
    both = 3.0 * found["branch_dissipation"] + 2.0 * found["dissipated_energy"]
    assert found["zone_excess"] == pytest.approx(both) == pytest.approx(2.0 * SAFETY * 0.1)
    fine = spring(1.0)
    relative_to = scale("dissipated_energy", float(fine.dissipated_energy[-1]), fine)
    unbalanced = dataclasses.replace(fine, extra={"balance_residual": np.full_like(fine.time, 5e-5)})
    found = estimates(unbalanced, spring(1.0 + 1e-4))
    assert found["dissipated_energy"] == pytest.approx(5e-5 / relative_to)


def test_own_estimates_serve_for_what_they_do_not_name():
    trace = spring(1.0, errors={"force": 1e-4, "contact_radius": 3e-4})
    found = from_own(trace, measure(trace, CASE.scene, 0.0))
    assert found["force"] == 1e-4
    assert found["approach_force"] == found["loop_energy"] == 3e-4
    assert not {"counters.steps", "wall_seconds"} & set(found)


def pulled(time, tension, **columns) -> Trace:
    """A run that detaches, with the given tension; penetration falls by one in unit time."""
    t = np.asarray(time, float)
    outcome = Outcome(OutcomeKind.DETACHED, "as told", float(t[-1]))
    run = spring(1.0, rows=t.size, time=t, force=-np.asarray(tension, float), penetration=-t, outcome=outcome)
    return dataclasses.replace(run, **columns)


def missed(time, tension) -> float:
    """Estimated relative error of the largest tension of two equal runs: what the rows leave open."""
    run, seen = pulled(time, tension), {"pull_off_force": max(tension)}
    return from_two_runs(run, run, seen, seen)["pull_off_force"]


UP_AND_DOWN = np.concatenate((0.1 * np.arange(11.0), 1.0 - 0.2 * np.arange(1.0, 6.0)))


def test_rows_leave_open_what_a_concave_curve_may_do_between_them():
    t = np.arange(16.0)
    assert missed(t, UP_AND_DOWN) == pytest.approx(0.0, abs=1e-9)  # a corner in a row
    assert missed(t, 0.1 * t) == pytest.approx(0.0, abs=1e-9)  # at the end of the contact
    t = np.delete(np.arange(0.0, 8.0, 0.5), 8)  # up by 1, down by 3 in unit time: a corner at 3.75
    tension = np.minimum(t, 3.75 - 3.0 * (t - 3.75))
    between = interpolation_error(pulled(t, tension), "force")
    assert missed(t, tension) - between == pytest.approx(0.25 / 3.5)
    t = np.arange(9.0)
    for middle in (4.0, 4.25, 4.5):
        tension = 100.0 - (t - middle) ** 2
        assert (100.0 - tension.max()) / tension.max() <= missed(t, tension) <= 2.0 / 100.0


def test_the_place_of_the_largest_tension_is_as_uncertain_as_the_way_its_error_reaches():
    """Tension rises to 1 in ten steps and falls in five; known to 0.25 it may stand 2.5 steps before."""
    run = pulled(np.arange(16.0), UP_AND_DOWN, errors={"pull_off_force": 0.25})
    found = from_own(run, {"pull_off_force": 1.0, "pull_off_time": 10.0})
    assert found["pull_off_force"] == pytest.approx(0.25)
    assert found["pull_off_time"] == pytest.approx(0.25 + 2.5 / 10.0)


@pytest.mark.parametrize(
    ("level", "tilt", "least", "most"),
    [
        (0.01, 0.0, np.sqrt(1.5) + 0.05, np.sqrt(1.5) + 1.0),  # the same everywhere: half of 3 times 0.01
        (0.0, 4e-3, 3 * 0.2, 4.5 * 3 * 0.2),  # the peak of 1 - 0.01 s^2 + tilt s is at s = 50 tilt
        (0.0, -4e-3, 3 * 0.2, 4.5 * 3 * 0.2),
        (0.0, 1.5e-2, 3 * 0.75, 4.5 * 3 * 0.75),
    ],
)
def test_an_error_that_changes_with_time_moves_the_largest_tension_and_hardly_one_that_does_not(
    level, tilt, least, most
):
    t = np.arange(21.0)
    tension = 1.0 - 0.01 * (t - 10.0) ** 2
    runs = [pulled(t, tension + error, solver="bem") for error in (0.0, level + tilt * (t - 10.0))]
    seen = [
        {"pull_off_force": float(-r.force.min()), "pull_off_time": float(r.time[np.argmin(r.force)])}
        for r in runs
    ]
    assert least <= 10.0 * from_two_runs(*runs, *seen)["pull_off_time"] <= most


@pytest.mark.parametrize("shift", [0.0, 0.3, 0.5])
def test_a_smooth_crest_is_as_uncertain_as_rows_leave_it_and_a_corner_known(shift):
    """``1 - (t - 5)^2/25`` in rows a unit apart, of the force and of a penetration under a falling force."""
    t = np.arange(11.0) + shift
    crest = 1.0 - ((t - 5.0) / 5.0) ** 2
    row = int(np.argmax(crest))
    run = pulled(t, -crest, errors={"peak_force": 0.0, "force": 0.0})
    found = from_own(run, {"peak_force": float(crest[row]), "peak_time": float(t[row])})
    assert 1.0 / crest[row] - 1.0 <= found["peak_force"] < 0.15
    assert found["peak_time"] >= abs(t[row] / 5.0 - 1.0)
    corner = dataclasses.replace(run, force=1.0 - np.abs(t - t[row]) / 5.0)
    known = from_own(corner, {"peak_force": 1.0, "peak_time": float(t[row])})
    assert known["peak_force"] == pytest.approx(0.0, abs=1e-9)
    creeping = dataclasses.replace(run, penetration=crest, force=20.0 - t)
    measured = measure(creeping, CASE.scene, 0.0)
    found = from_two_runs(creeping, creeping, measured, measured)
    assert abs(measured["approach_force"] / 15.0 - 1.0) <= found["approach_force"] < 0.1
    assert abs(measured["approach_time"] / 5.0 - 1.0) <= found["approach_time"]


def test_corners_and_holds_of_the_loading_are_located():
    """Rows far apart before a corner overshoot it, which says nothing; a plateau ends where the load says."""
    t = np.array([0.0, 1.0, 2.0, 2.1, 2.2, 2.3])
    depth = np.array([0.0, 0.6, 1.0, 0.98, 0.96, 0.94])
    turned = spring(1.0, rows=6, time=t, penetration=depth, force=depth, errors={"force": 0.0})
    named = {"approach_penetration": 1.0, "approach_force": 1.0, "approach_time": 2.0}
    assert from_own(turned, named)["approach_force"] > 0.01
    known = from_own(turned, named, Loading("relaxed", 0.0, (Ramp(1.0, 0.5), Ramp(0.0, 0.2))))
    assert known["approach_force"] == known["approach_time"] == 0.0
    plateau = pulled(np.arange(6.0), [-1.0, 2.0, 2.0, 2.0, 2.0, 2.0], errors={"pull_off_force": 1e-3})
    found = from_own(plateau, {"pull_off_force": 2.0, "pull_off_time": 5.0})
    assert found == {"pull_off_force": 1e-3, "pull_off_time": 1e-3}
    t = np.linspace(0.0, 4.0, 81)
    depth, force = np.minimum(np.minimum(t, 1.0), 4.0 - t), np.where(t < 1.0, t, np.exp(1.0 - t))
    held = spring(1.0, rows=81, time=t, penetration=depth, force=force)
    loading = Loading("jump-in", 0.0, (Ramp(2.0, 1.0, until_force=1.0), Hold(2.0), Ramp(0.0, 1.0)))
    found = estimates(held, dataclasses.replace(held, penetration=1.001 * depth), loading=loading)
    assert found["approach_penetration"] > 0.0
    assert max(found["approach_time"], found["approach_force"]) <= 1e-2


@pytest.mark.parametrize(("drift", "least", "most"), [(0.0, 0.0, 1e-12), (2e-2, 0.2, 4.0)])
def test_where_a_creeping_penetration_turns_is_as_uncertain_as_its_error_changes(drift, least, most):
    """An error that is the same all along does not move the turn at t = 0.5; one that grows does."""
    t, loading = spring(1.0).time, Loading("jump-in", 0.0, (Force(1.0, 0.5), ForceRamp(0.0, 2.0)))
    run = spring(1.0, penetration=np.where(t < 0.5, 1.0 + 1e-2 * (t - 0.5), 1.5 - t), force=2.0 - t)
    other = dataclasses.replace(run, penetration=run.penetration + 1e-3 - drift * t)
    assert least <= estimates(run, other, loading=loading)["approach_time"] <= most


@pytest.mark.parametrize("bend", [0.0, 0.3, -0.3])
@pytest.mark.parametrize("left", [0.0, 1e-4, 1e-3, 1e-2])
def test_what_is_left_until_the_edge_runs_away_is_told_by_the_last_rows(left, bend):
    """A row on the limit point has lost nothing, however long its step; one before it no more than told."""
    away = 0.01 * np.array([1.0, 0.6, 0.4, 0.2, left])
    edge = 0.5 + np.sqrt(away) + bend * away
    run = pulled(1.0 - away, away, contact_radius=edge, errors={"contact_radius": 0.0})
    alike, lost = {"detachment_radius": edge[-1]}, edge[-1] - 0.5
    between = interpolation_error(run, "contact_radius") * edge.max()
    for errors, known in ((from_two_runs(run, run, alike, alike), between), (from_own(run, alike), 0.0)):
        found = errors["detachment_radius"] * edge[-1] - known
        assert lost <= found + known + 1e-12
        assert found <= 3.0 * lost + 7.0 * abs(bend) * away[1] + between + 1e-12


def test_an_edge_that_ends_in_a_point_or_at_rest_has_lost_nothing_before():
    t = np.linspace(0.0, 0.9, 10)
    for radius, column in ((0.0, 0.5 + np.sqrt(1.0 - t)), (1.0, np.ones(10))):
        run = pulled(t, 2.0 - t, contact_radius=column, errors={"contact_radius": 0.0})
        found = from_own(run, {"detachment_radius": radius, "detachment_force": -1.0})
        assert (found["detachment_radius"], found["detachment_force"]) == (0.0, 0.0)


def test_a_solver_says_how_far_off_what_it_has_located_is():
    """A smooth peak between rows, and a limit point beyond them: as far as it says, not as rows do."""
    t = np.arange(9.0)
    radius, errors = np.sqrt(9.0 - t), {"contact_radius": 0.0}
    run = pulled(t, 100.0 - (t - 4.25) ** 2, contact_radius=radius, errors=errors)
    seen = {"pull_off_force": 99.9375, "pull_off_time": 4.0, "detachment_radius": 1.0}
    peak = Event("largest tension", 4.0, -4.0, -99.9375, 5.0**0.5, (0.25, 0.25, 0.0625, 0.1))
    lost = Event("pull-off", 8.0, -8.0, -85.9375, 1.0, (0.0, 0.0, 8.0, 0.25))
    told = from_own(dataclasses.replace(run, located=(peak,), events=(lost,)), seen)
    assert told["pull_off_force"] == pytest.approx(0.0625 / 99.9375)
    assert told["pull_off_time"] == pytest.approx(0.25 / 4.0)
    assert from_own(run, seen)["pull_off_time"] > 2.0 * 0.25 / 4.0
    assert told["detachment_radius"] == pytest.approx(0.25)


def test_the_run_that_errors_are_estimated_from_is_never_the_same():
    def other(name, scene, resolution):
        """Resolution, step tolerance and solver of the second run, and how much coarser it is."""
        second = solvers.solver(name).comparison_run(scene, resolution)
        assert second.solve.args[0] is scene
        return (*second.solve.args[1:], second.solve.keywords.get("step_tolerance"), second.ratio)

    assert other("bem", CASE.scene, None) == (6, None, 2.0)
    assert other("bem", CASE.scene, 9) == (4, None, 2.25)
    for least in (4, 5, 6, 7):
        assert other("bem", CASE.scene, least) == (2 * least, None, 0.5)
    assert other("fem", CASE.scene, None) == (5, None, 2.0)
    assert other("fem", CASE.scene, 1) == (2, None, 0.5)
    assert other("fem", load("adhesionless-cycle").scene, None)[0] == 2


@pytest.mark.parametrize("name", ["cycle-v0.02", "adhesionless-cycle", "pdms-cycle-1um"])
@pytest.mark.parametrize("resolution", [1, 2, 3, 4, 10])
def test_the_coarser_run_of_finite_elements_has_a_mesh(name, resolution):
    scene = load(name).scene
    run = solvers.solver("fem").comparison_run(scene, resolution)
    method, divisions = run.solve.func.__self__, run.solve.args[1]
    made = method.parameters(scene, divisions)
    own = solvers.solver("fem").parameters(scene, resolution)
    assert (made.grading > own.grading) == (divisions < resolution)


def test_a_run_without_its_coarser_run_has_no_estimate(monkeypatch):
    def refuse_twice(scene, resolution, **options):
        if resolution is not None:
            raise ValueError("too coarse")
        return spring_solve()(scene, resolution, **options)

    monkeypatch.setitem(solvers.SOLVERS, "bem", FunctionSolver(refuse_twice))
    result = run(CASE, "bem", estimate=True)
    assert result.finished
    assert result.errors == {}


@pytest.mark.slow
def test_real_solvers_estimate_what_they_miss():
    """Static states, against the reference: true differences lie within the estimates."""
    case = load("relaxed-equilibrium")
    found = {solver: run(case, solver, estimate=True) for solver in arguments.names()}
    checks = [check for check in check_case(case, found) if check.quantity == "start_radius"]
    judged = [check for check in checks if check.source == "front tracking"]
    assert {check.solver for check in judged} == {"bem", "fem"}
    for check in judged:
        assert check.passed
        assert 0.0 < abs(check.difference) <= check.estimate + check.base_estimate < 2e-3
