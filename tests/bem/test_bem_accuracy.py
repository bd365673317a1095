"""What the solver must reach at its default resolution, one test a line of the list.

Values of the cycles: converged front tracking, written down; ``F~ = F/(pi E0* R^2)``.
"""

import numpy as np
import pytest
from scipy.interpolate import PchipInterpolator
from support.bem_runs import bem, front, observed_order
from support.paper_scenes import ELASTIC, cycle, scene

from bem_solver import Options, solve
from contact_scene import Ramp
from validation.measure.observables import observe

# rate: F~ and a at the end of approach, pull-off over JKR, D where contact is lost, loop of F~ dD~


def force_missed(trace, exact):
    """Root mean square of the force missed at the rows of a retraction, in parts of the largest one.

    Up to shortly before the limit point, where the force is no smooth function of time.
    """
    times, first = np.unique(exact.time, return_index=True)
    curve = PchipInterpolator(times, exact.force[first])
    back = slice(int(np.argmax(trace.penetration)), int(np.searchsorted(trace.time, 0.995 * times[-1])))
    missed = trace.force[back] - curve(trace.time[back])
    return float(np.sqrt(np.mean(missed**2))) / np.abs(exact.force).max()


@pytest.mark.parametrize(
    ("rate", "levels", "most"),
    [
        pytest.param(0.006, (6, 12, 24), 6e-5, marks=pytest.mark.slow),
        pytest.param(0.02, (4, 6, 12), 2e-5, marks=pytest.mark.exhaustive),
    ],
)
def test_observed_order_when_annuli_and_steps_are_refined_together(rate, levels, most):
    """Two-sided: an order far above the scheme's would be chance, one a little below it is not.

    Of the force at all rows, because that of a single one, the largest tension, scatters from level to level.
    The loop integral and the force at the top scatter too where they are right to 1e-6, as from V = 0.02 on.
    """
    exact = front(cycle(rate), 40)
    whole = observe(exact)
    forces, loops, tops = [], [], []
    for resolution in levels:
        trace = bem(cycle(rate), resolution=resolution)
        found = observe(trace)
        forces.append(force_missed(trace, exact))
        loops.append(abs(found.loop_energy / whole.loop_energy - 1.0))
        tops.append(abs(found.approach_force / whole.approach_force - 1.0))
    assert max(*forces, *loops, *tops) < most
    assert max(forces[-1], loops[-1]) < 0.15 * most
    for errors in (forces, tops)[: 2 if rate < 0.02 else 1]:
        slope = np.polyfit(np.log(levels), np.log(errors), 1)[0]
        assert 1.6 <= -slope < 2.5, errors


@pytest.mark.slow
def test_backward_euler_costs_the_order():
    exact = observe(bem(cycle(0.02))).loop_energy
    errors = []
    for resolution in (6, 12):
        question = Options(resolution=resolution, scheme="backward-euler")
        errors.append(observe(solve(cycle(0.02), question)).loop_energy / exact - 1.0)
    assert 0.5 < observed_order(errors) < 1.5, errors
    assert abs(errors[-1]) > 10.0 * 2e-4


def test_work_is_triangular_solves_after_one_factorisation():
    trace = bem(cycle(0.02))
    counters = trace.counters
    assert counters.factorisations == 1
    assert counters.steps == len(trace) - 1
    advancing = counters.linear_solves - counters.closure_evaluations  # there the load is solved for thrice
    assert 0 <= advancing < counters.closure_evaluations
    assert counters.linear_solves < 8 * (counters.steps + counters.rejected_steps)
    assert counters.rejected_steps < 0.2 * counters.steps
    assert counters.steps < 500
    assert counters.volume_solves == 0


def test_work_that_a_scene_does_not_need_is_not_done():
    adhesionless = bem(scene(Ramp(0.02, 0.05), adhesion=None), resolution=4).counters
    assert adhesionless.closure_evaluations == 0
    assert adhesionless.linear_solves > 0
    elastic = bem(cycle(0.02, material=ELASTIC), resolution=4).counters
    assert elastic.history_updates == 0
    assert elastic.factorisations == adhesionless.factorisations == 1
