"""What runs say about their own errors, and that agreement is judged by it."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
from support.spring_solver import FunctionSolver
from support.spring_solver import spring as spring_solve

from contact_scene import Counters, Event, Force, ForceRamp, Hold, Loading, Outcome, OutcomeKind, Ramp, Trace
from crosscontact import arguments
from validation import solvers
from validation.cases import load
from validation.compare.checks import against_reference, check_case
from validation.measure.curves import distance, interpolation_error
from validation.measure.error_estimate import SAFETY, from_own, from_two_runs
from validation.measure.observables import measure
from validation.measure.scaling import scale
from validation.runs.run import Run, run

CASE = load("cycle-v0.1")


def spring(stiffness: float, rows: int = 41, solver: str = "fem") -> Trace:
    """A spring pressed in and pulled out again, kinked at half time."""
    t = np.linspace(0.0, 1.0, rows)
    d = 0.03 - 0.08 * np.abs(t - 0.5)
    energy = 0.5 * stiffness * d**2
    outcome = Outcome(OutcomeKind.COMPLETED, "as told", 1.0)
    return Trace(
        solver, t, d, stiffness * d, np.full_like(t, 0.2), energy, energy, energy, outcome, Counters()
    )


def estimates(
    run: Trace, other: Trace, ratio: float = 2.0, loading: Loading | None = None
) -> dict[str, float]:
    measured, otherwise = (measure(trace, CASE.scene, 0.0) for trace in (run, other))
    return from_two_runs(run, other, measured, otherwise, ratio, loading)


@pytest.mark.parametrize(("solver", "order"), [("fem", 2), ("bem", 1)])
def test_estimate_covers_the_error_at_the_known_order(solver, order):
    fine, coarse = spring(1.0 + 1e-3, solver=solver), spring(1.0 + 1e-3 * 2**order, solver=solver)
    found = estimates(fine, coarse)
    assert found["approach_force"] == pytest.approx(SAFETY * 1e-3, rel=2e-3)
    assert found["force"] == pytest.approx(SAFETY * 1e-3 * 0.4, rel=0.5)
    assert found["approach_force"] >= 1e-3


def test_a_scalar_is_no_better_than_its_curves():
    fine = spring(1.0)
    bent = dataclasses.replace(fine, force=fine.force * (1.0 + 0.1 * np.sin(2 * np.pi * fine.time)))
    found, apart = estimates(fine, bent), distance(bent, fine, "force")
    assert found["force"] == pytest.approx(apart.rms, abs=2e-5)  # second order: factor 3 of 3
    assert found["approach_force"] == pytest.approx(apart.mean, abs=2e-5)
    assert found["force"] > found["approach_force"] > 1e-3


def test_a_penetration_under_a_given_force_is_no_better_than_its_curve():
    """The force says nothing of it, and the two runs agree in the places that are compared."""
    fine = spring(1.0)
    other = dataclasses.replace(fine, penetration=fine.penetration + 1e-3 * np.sin(4 * np.pi * fine.time))
    alike = {"detachment_penetration": -0.01, "detachment_time": 1.0, "detachment_radius": 0.2}
    found, apart = from_two_runs(fine, other, alike, alike), distance(other, fine, "penetration")
    assert found["force"] == found["detachment_time"] == 0.0
    assert found["detachment_penetration"] == pytest.approx(apart.mean, rel=1e-6)
    assert apart.mean > 1e-2


def pulled(time, tension) -> Trace:
    """A run that detaches, with the given tension; penetration falls by one in unit time."""
    t = np.asarray(time, float)
    outcome = Outcome(OutcomeKind.DETACHED, "as told", float(t[-1]))
    run = spring(1.0, rows=t.size)
    return dataclasses.replace(
        run, time=t, force=-np.asarray(tension, float), penetration=-t, outcome=outcome
    )


def missed(time, tension) -> float:
    """Estimated relative error of the largest tension of two equal runs: what the rows leave open."""
    run = pulled(time, tension)
    return from_two_runs(run, run, {"pull_off_force": max(tension)}, {"pull_off_force": max(tension)})[
        "pull_off_force"
    ]


def test_an_extremum_that_is_located_is_certain():
    t = np.arange(16.0)
    corner = np.concatenate((0.1 * t[:11], 1.0 - 0.2 * t[1:6]))
    assert missed(t, corner) == pytest.approx(0.0, abs=1e-9)
    assert missed(t, 0.1 * t) == pytest.approx(0.0, abs=1e-9)  # at the end of the contact
    run = pulled(t, corner)
    found = from_own(run, {"pull_off_force": 1.0, "pull_off_time": 10.0})
    assert found["pull_off_time"] == pytest.approx(0.0, abs=1e-9)


def test_a_corner_between_rows_is_uncertain_by_what_it_may_exceed_them():
    """Tension rises by 1 and falls by 3 in unit time; the corner, at 3.75, lies between two rows."""
    t = np.delete(np.arange(0.0, 8.0, 0.5), 8)
    tension = np.minimum(t, 3.75 - 3.0 * (t - 3.75))
    assert max(tension) == 3.5
    assert missed(t, tension) - interpolation_error(pulled(t, tension), "force") == pytest.approx(0.25 / 3.5)


def test_a_smooth_extremum_is_uncertain_by_no_more_than_its_curvature_allows():
    t = np.arange(9.0)
    for middle in (4.0, 4.25, 4.5):
        tension = 100.0 - (t - middle) ** 2
        true = (100.0 - tension.max()) / tension.max()
        assert true <= missed(t, tension) <= 2.0 / 100.0


@pytest.mark.parametrize("bend", [0.0, 0.3, -0.3])
@pytest.mark.parametrize("left", [0.0, 1e-4, 1e-3, 1e-2])
def test_what_is_left_until_the_edge_runs_away_is_told_by_the_last_rows(left, bend):
    """A row on the limit point has lost nothing, however long its step; one before it no more than told."""
    away = 0.01 * np.array([1.0, 0.6, 0.4, 0.2, left])
    edge = 0.5 + np.sqrt(away) + bend * away
    run, alike = (
        dataclasses.replace(pulled(1.0 - away, away), contact_radius=edge, errors={"contact_radius": 0.0}),
        {"detachment_radius": edge[-1]},
    )
    between = interpolation_error(run, "contact_radius") * edge.max()
    missed = edge[-1] - 0.5
    for errors, known in ((from_two_runs(run, run, alike, alike), between), (from_own(run, alike), 0.0)):
        found = errors["detachment_radius"] * edge[-1] - known
        assert missed <= found + known + 1e-12
        assert found <= 3.0 * missed + 7.0 * abs(bend) * away[1] + between + 1e-12


def test_an_edge_that_ends_in_a_point_or_at_rest_has_lost_nothing_before():
    t = np.linspace(0.0, 0.9, 10)
    run = dataclasses.replace(pulled(t, 2.0 - t), contact_radius=0.5 + np.sqrt(1.0 - t))
    for radius, column in ((0.0, run.contact_radius), (1.0, np.ones(10))):
        ended = dataclasses.replace(run, contact_radius=column, errors={"contact_radius": 0.0})
        found = from_own(ended, {"detachment_radius": radius, "detachment_force": -1.0})
        assert (found["detachment_radius"], found["detachment_force"]) == (0.0, 0.0)


def test_a_solver_says_how_far_off_what_it_has_located_is():
    """A smooth peak between rows, and a limit point beyond them: as far as it says, not as rows do."""
    t = np.arange(9.0)
    run = pulled(t, 100.0 - (t - 4.25) ** 2)
    run = dataclasses.replace(run, contact_radius=np.sqrt(9.0 - t), errors={"contact_radius": 0.0})
    seen = {
        "pull_off_force": 99.9375,
        "pull_off_time": 4.0,
        "detachment_radius": 1.0,
        "detachment_force": -85.0,
    }
    state = (4.0, -4.0, -99.9375, np.sqrt(5.0))
    located = dataclasses.replace(
        run,
        located=(Event("largest tension", *state, (0.25, 0.25, 0.0625, 0.1)),),
        events=(Event("pull-off", 8.0, -8.0, -85.9375, 1.0, (0.0, 0.0, 8.0, 1.0)),),
    )
    rows, told = from_own(run, seen), from_own(located, seen)
    assert told["pull_off_force"] == pytest.approx(0.0625 / 99.9375)
    assert told["pull_off_time"] == pytest.approx(0.25 / 4.0)
    assert told["detachment_radius"] == pytest.approx(1.0)
    assert told["detachment_force"] == pytest.approx(8.0 / 85.9375)
    assert rows["pull_off_time"] > 2.0 * told["pull_off_time"]


def test_the_place_of_the_largest_tension_is_as_uncertain_as_the_way_its_error_reaches():
    """Tension rises to 1 in ten steps and falls in five; known to 0.25 it may stand 2.5 steps before."""
    t = np.arange(16.0)
    run = pulled(t, np.concatenate((0.1 * t[:11], 1.0 - 0.2 * t[1:6])))
    run = dataclasses.replace(run, errors={"pull_off_force": 0.25})
    found = from_own(run, {"pull_off_force": 1.0, "pull_off_time": 10.0})
    assert found["pull_off_force"] == pytest.approx(0.25)
    assert found["pull_off_time"] == pytest.approx(0.25 + 2.5 / 10.0)


def peaked(level: float, tilt: float) -> Trace:
    """A tension that rises to 1 at t = 10 and falls again, with an error that changes with time."""
    t = np.arange(21.0)
    return pulled(t, 1.0 - 0.01 * (t - 10.0) ** 2 + level + tilt * (t - 10.0))


def place_error(level: float, tilt: float) -> float:
    run, other = (dataclasses.replace(peaked(*of), solver="bem") for of in ((0.0, 0.0), (level, tilt)))
    scalars = [
        {"pull_off_force": float((-r.force).max()), "pull_off_time": float(r.time[np.argmax(-r.force)])}
        for r in (run, other)
    ]
    return 10.0 * from_two_runs(run, other, *scalars)["pull_off_time"]


def test_an_error_that_is_the_same_everywhere_hardly_moves_the_largest_tension():
    """By its root it might, 0.03 by 1.7 at 0.01 (t - 10)^2; half of that is kept for what two runs hide."""
    known = SAFETY * 0.01
    rows = 1.0  # between rows the tension is straight
    assert np.sqrt(0.5 * known / 0.01) - 0.2 <= place_error(0.01, 0.0) <= np.sqrt(0.5 * known / 0.01) + rows
    assert place_error(0.01, 0.0) < np.sqrt(known / 0.01)


@pytest.mark.parametrize("tilt", [4e-3, -4e-3, 1.5e-2])
def test_an_error_that_changes_with_time_moves_the_largest_tension(tilt):
    """The peak of ``1 - 0.01 s^2 + tilt s`` is at ``s = 50 tilt``; its error is thrice that."""
    assert SAFETY * 50.0 * abs(tilt) <= place_error(0.0, tilt) <= 4.5 * SAFETY * 50.0 * abs(tilt)


def test_a_corner_at_the_end_of_a_load_step_is_located():
    """Rows far apart before a corner: the line through the rows before overshoots it, which says nothing."""
    t = np.array([0.0, 1.0, 2.0, 2.1, 2.2, 2.3])
    depth = np.array([0.0, 0.6, 1.0, 0.98, 0.96, 0.94])
    outcome = Outcome(OutcomeKind.COMPLETED, "as told", 2.3)
    run = Trace(
        "bem", t, depth, depth, np.ones(6), *([np.ones(6)] * 3), outcome, Counters(), errors={"force": 0.0}
    )
    named = {"approach_penetration": 1.0, "approach_force": 1.0, "approach_time": 2.0}
    unknown = from_own(run, named)
    known = from_own(run, named, Loading("relaxed", 0.0, (Ramp(1.0, 0.5), Ramp(0.0, 0.2))))
    assert unknown["approach_force"] > 0.01
    assert known["approach_force"] == 0.0
    assert known["approach_time"] == 0.0


@pytest.mark.parametrize("shift", [0.0, 0.3, 0.5])
def test_a_smooth_crest_of_the_force_is_as_uncertain_as_rows_leave_it(shift):
    """``1 - (t - 5)^2/25`` in rows a unit apart; a corner in a row is known."""
    t = np.arange(11.0) + shift
    force = 1.0 - ((t - 5.0) / 5.0) ** 2
    run = dataclasses.replace(pulled(t, -force), errors={"peak_force": 0.0, "force": 0.0})
    row = int(np.argmax(force))
    found = from_own(run, {"peak_force": float(force[row]), "peak_time": float(t[row])})
    assert found["peak_force"] >= 1.0 / force[row] - 1.0
    assert found["peak_time"] >= abs(t[row] / 5.0 - 1.0)
    assert found["peak_force"] < 0.15
    corner = dataclasses.replace(run, force=1.0 - np.abs(t - t[row]) / 5.0)
    known = from_own(corner, {"peak_force": 1.0, "peak_time": float(t[row])})
    assert known["peak_force"] == pytest.approx(0.0, abs=1e-9)


def test_the_end_of_a_plateau_of_the_force_is_an_event():
    t = np.arange(6.0)
    run = dataclasses.replace(pulled(t, [-1.0, 2.0, 2.0, 2.0, 2.0, 2.0]), errors={"pull_off_force": 1e-3})
    found = from_own(run, {"pull_off_force": 2.0, "pull_off_time": 5.0})
    assert found == {"pull_off_force": 1e-3, "pull_off_time": 1e-3}


def test_a_difference_is_as_uncertain_as_both_its_terms():
    fine, coarse = spring(1.0), spring(1.0)
    losses = {"branch_dissipation": 3.0, "dissipated_energy": 2.0, "zone_excess": 1.0}
    moved = {"branch_dissipation": 3.1, "dissipated_energy": 2.1, "zone_excess": 1.0}
    found = from_two_runs(fine, coarse, losses, moved)
    assert found["branch_dissipation"] == pytest.approx(SAFETY * 0.1 / 3.0)
    assert found["dissipated_energy"] == pytest.approx(SAFETY * 0.1 / 2.0)
    assert found["zone_excess"] == pytest.approx(
        3.0 * found["branch_dissipation"] + 2.0 * found["dissipated_energy"]
    )


def test_a_square_is_twice_as_uncertain_as_what_is_squared():
    """Where the two runs agree in it by accident, and their curves do not."""
    fine, coarse = spring(1.0), spring(1.01)
    alike = {"branch_dissipation": 3.0, "detachment_radius": 0.2}
    found = from_two_runs(fine, coarse, alike, alike)
    assert found["detachment_radius"] > 0.0
    assert found["branch_dissipation"] == pytest.approx(2.0 * found["detachment_radius"])


@pytest.mark.parametrize("relaxes", [True, False])
def test_losses_that_agree_at_the_end_by_accident_were_apart_on_the_way(relaxes):
    """By a sine of amplitude 0.1; where nothing relaxes they are those of jumps, each at its time."""
    rough = spring(1.0, rows=401)
    t = rough.time
    heat = t if relaxes else 0.0 * t
    run = dataclasses.replace(rough, dissipated_energy=t, extra={"branch_dissipation": heat})
    apart = 0.1 * np.sin(2.0 * np.pi * t)
    other = dataclasses.replace(run, dissipated_energy=t + apart, extra={"branch_dissipation": heat + apart})
    alike = {"dissipated_energy": 1.0, "branch_dissipation": 1.0, "loop_energy": 1.0, "pull_off_force": 1.0}
    found = from_two_runs(run, other, alike, alike)
    expected = SAFETY * 0.1 / np.sqrt(2.0) if relaxes else 0.0
    assert found["dissipated_energy"] == pytest.approx(expected, rel=1e-3)
    assert found["loop_energy"] == pytest.approx(expected, rel=1e-3)
    assert found["branch_dissipation"] == pytest.approx(2.0 * expected, rel=1e-3)
    assert found["pull_off_force"] == 0.0


def test_a_hold_at_the_largest_penetration_is_where_the_approach_ends():
    """Reached at a level of the force, it is as deep as that is known; time and force are of its begin."""
    t = np.linspace(0.0, 4.0, 81)
    depth = np.minimum(np.minimum(t, 1.0), 4.0 - t)
    rough = dataclasses.replace(spring(1.0, rows=81), time=t, contact_radius=np.full_like(t, 0.2))
    run = dataclasses.replace(rough, penetration=depth, force=np.where(t < 1.0, t, np.exp(1.0 - t)))
    other = dataclasses.replace(run, penetration=1.001 * depth)
    loading = Loading("jump-in", 0.0, (Ramp(2.0, 1.0, until_force=1.0), Hold(2.0), Ramp(0.0, 1.0)))
    found = estimates(run, other, loading=loading)
    assert found["approach_penetration"] > 0.0
    assert max(found["approach_time"], found["approach_force"]) <= 1e-2


def test_own_estimates_serve_for_what_they_do_not_name():
    trace = dataclasses.replace(spring(1.0), errors={"force": 1e-4, "contact_radius": 3e-4})
    found = from_own(trace, measure(trace, CASE.scene, 0.0))
    assert found["force"] == 1e-4
    assert found["approach_force"] == found["loop_energy"] == 3e-4
    assert "counters.steps" not in found
    assert "wall_seconds" not in found


def test_scales():
    trace = spring(1.0)
    assert scale("detachment_penetration", 1e-9, trace) == pytest.approx(0.03)
    assert scale("start_force", 1e-9, trace) == pytest.approx(0.05 * 0.03)
    assert scale("dissipated_energy", 1e-9, trace) == pytest.approx(trace.stored_energy.max())
    worked = dataclasses.replace(trace, external_work=7.0 * trace.external_work)
    assert scale("dissipated_energy", 1e-9, worked) == pytest.approx(7.0 * trace.stored_energy.max())
    assert scale("loop_energy", -2.0, trace) == 2.0


def test_the_run_that_errors_are_estimated_from_is_never_the_same():
    def other(name, scene, resolution):
        """Resolution, step tolerance and solver of the second run, and how much coarser it is."""
        second = solvers.solver(name).comparison_run(scene, resolution)
        assert second.solve.args[0] is scene
        return (*second.solve.args[1:], second.solve.keywords.get("step_tolerance"), second.ratio)

    assert other("bem", CASE.scene, None) == (6, None, 2.0)
    assert other("bem", CASE.scene, 40) == (20, None, 2.0)
    assert other("bem", CASE.scene, 9) == (4, None, 2.25)
    for least in (4, 5, 6, 7):
        assert other("bem", CASE.scene, least) == (2 * least, None, 0.5)
    assert other("fem", CASE.scene, None) == (5, 4e-3, 2.0)
    assert other("fem", CASE.scene, 1) == (2, 0.25e-3, 0.5)
    assert solvers.solver("fem").comparison_run(CASE.scene).solve.func.__self__.grading == 0.4
    assert solvers.solver("fem").comparison_run(CASE.scene, 1).solve.func.__self__.grading == 0.1
    assert other("fem", load("adhesionless-cycle").scene, None)[0] == 2


@pytest.mark.parametrize("ratio", [2.0, 2.25, 1.75, 0.5])
@pytest.mark.parametrize(("solver", "order"), [("fem", 2), ("bem", 1)])
def test_the_estimate_is_that_of_the_first_run_at_any_ratio(solver, order, ratio):
    run, other = spring(1.0 + 1e-3, solver=solver), spring(1.0 + 1e-3 * ratio**order, solver=solver)
    found = estimates(run, other, ratio)
    assert found["approach_force"] == pytest.approx(SAFETY * 1e-3, rel=4e-3)


def runs(difference: float, mine: float | None, theirs: float | None) -> list:
    base = Run(CASE.name, "reference", spring(1.0), measures=measure(spring(1.0), CASE.scene, 0.0))
    trace = spring(1.0 + difference)
    result = Run(CASE.name, "fem", trace, measures=measure(trace, CASE.scene, 0.0))
    if mine is not None:
        result = dataclasses.replace(result, errors=dict.fromkeys([*result.measures, "force"], mine))
    if theirs is not None:
        base = dataclasses.replace(base, errors=dict.fromkeys([*base.measures, "force"], theirs))
    return against_reference(CASE, result, base)


@pytest.mark.parametrize(
    ("difference", "mine", "theirs", "agrees"),
    [
        (5e-3, None, None, True),  # by the tolerance of 1e-2
        (5e-3, 1e-3, None, True),  # an estimate on one side only says nothing
        (5e-3, 3e-3, 3e-3, True),
        (5e-3, 3e-3, 1e-3, False),
        (2e-2, 3e-2, 3e-2, False),  # the tolerance caps what estimates excuse
    ],
)
def test_agreement_is_within_the_estimates_capped_by_the_tolerance(difference, mine, theirs, agrees):
    verdict = {check.quantity: check for check in runs(difference, mine, theirs)}["approach_force"]
    assert verdict.passed is agrees
    assert (verdict.estimate, verdict.base_estimate) == (mine, theirs)
    assert ("parts at t =" in verdict.note) is not agrees


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


def test_a_run_without_its_coarser_run_has_no_estimate(monkeypatch):
    def refuse_twice(scene, resolution, **options):
        if resolution is not None:
            raise ValueError("too coarse")
        return spring_solve()(scene, resolution, **options)

    monkeypatch.setitem(solvers.SOLVERS, "bem", FunctionSolver(refuse_twice))
    result = run(CASE, "bem", estimate=True)
    assert result.finished
    assert result.errors == {}


@pytest.mark.parametrize("name", ["pull_off_force", "pull_off_radius", "branch_dissipation"])
def test_corners_and_layers_are_of_first_order(name):
    """Three times the difference, of finite elements too: 3/(2^1 - 1); other scalars 3/(2^2 - 1)."""
    run = pulled(np.arange(11.0), np.arange(11.0))
    found = from_two_runs(run, run, {name: 10.0, "start_radius": 10.0}, {name: 10.1, "start_radius": 10.1})
    assert found[name] / found["start_radius"] == pytest.approx(3.0)


@pytest.mark.parametrize("shift", [0.0, 0.3, 0.5])
def test_where_the_penetration_has_a_smooth_maximum_the_end_of_approach_is_uncertain(shift):
    """Force falls steadily while the penetration turns at t = 0.5: its value there depends on the rows."""
    rough = spring(1.0, rows=21)
    t = np.concatenate(([0.0], (np.arange(20) + shift) / 20.0 + 0.02, [1.1]))
    turning = dataclasses.replace(
        rough,
        time=t,
        penetration=0.03 - 0.1 * (t - 0.5) ** 2,
        force=2.0 - t,
        contact_radius=np.full_like(t, 0.2),
        stored_energy=0.0 * t,
        external_work=0.0 * t,
        dissipated_energy=0.0 * t,
    )
    found = estimates(turning, turning)
    measured = measure(turning, CASE.scene, 0.0)
    assert abs(measured["approach_force"] / 1.5 - 1.0) <= found["approach_force"] < 0.1
    assert (
        abs(measured["approach_time"] - 0.5) / scale("approach_time", 0.5, turning) <= found["approach_time"]
    )
    corner = spring(1.0)
    assert estimates(corner, corner)["approach_force"] == 0.0


@pytest.mark.parametrize(("drift", "least", "most"), [(0.0, 0.0, 1e-12), (2e-2, 0.2, 2.0)])
def test_where_a_creeping_penetration_turns_is_as_uncertain_as_its_error_changes(drift, least, most):
    """An error that is the same all along does not move the turn at t = 0.5; one that grows does."""
    rough = spring(1.0)
    t, loading = rough.time, Loading("jump-in", 0.0, (Force(1.0, 0.5), ForceRamp(0.0, 2.0)))
    depth = np.where(t < 0.5, 1.0 + 1e-2 * (t - 0.5), 1.5 - t)
    run = dataclasses.replace(rough, penetration=depth, force=2.0 - t)
    other = dataclasses.replace(run, penetration=depth + 1e-3 - drift * t)
    found = estimates(run, other, loading=loading)
    assert least <= found["approach_time"] <= most


def test_energies_that_do_not_add_up_are_an_error_of_the_dissipated_energy():
    fine, coarse = spring(1.0 + 1e-3), spring(1.0 + 4e-3)
    usual = estimates(fine, coarse)["dissipated_energy"]
    left = np.full_like(fine.time, 5e-5)
    unbalanced = dataclasses.replace(fine, extra={"balance_residual": left})
    relative_to = scale("dissipated_energy", float(fine.dissipated_energy[-1]), fine)
    assert estimates(unbalanced, coarse)["dissipated_energy"] == pytest.approx(max(usual, 5e-5 / relative_to))
    assert 5e-5 / relative_to > 1.1 * usual
