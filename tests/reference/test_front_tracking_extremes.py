"""Scenes at the ends of the allowed range end with an answer, an error of the scene or a reason."""

import numpy as np
import pytest
from support.paper_scenes import ELASTIC, ONE, STICKY, WORK

from contact_scene import (
    Adhesion,
    Branch,
    FlatPunch,
    Force,
    Hold,
    Loading,
    Material,
    OutcomeKind,
    PowerLaw,
    PowerRate,
    Ramp,
    RateTable,
    Scene,
    Sphere,
    Step,
    Table,
)
from contact_scene.errors import SceneError
from validation.reference import Options, solve
from validation.reference.finite_zone import FiniteZone

COARSE = Options(resolution=4)


def _scene(*steps: Step, start: str = "relaxed", material: Material = ONE, zone: float = 0.0) -> Scene:
    adhesion = Adhesion(WORK, zone) if zone > 0.0 else None
    return Scene(material, Sphere(1.0), Loading(start, 0.032, steps), adhesion)


def test_a_hold_of_any_length_ends_in_the_relaxed_equilibrium() -> None:
    trace = solve(_scene(Hold(1e60), start="jump-in", zone=STICKY.zone), COARSE)
    assert trace.outcome.kind is OutcomeKind.COMPLETED
    exact = FiniteZone(1.0, 1.0, WORK, STICKY.zone).at_penetration(0.032)
    assert trace.contact_radius[-1] == pytest.approx(exact.contact_radius, rel=1e-5)
    assert trace.force[-1] == pytest.approx(exact.force, rel=1e-5)


def test_a_branch_that_relaxes_in_no_time_is_none() -> None:
    fast = Material(0.75, 0.5, (Branch(6.75, 1e-60),))
    trace = solve(_scene(Ramp(0.02, 0.01), start="jump-in", material=fast, zone=0.05), COARSE)
    assert trace.outcome.kind is OutcomeKind.COMPLETED
    exact = FiniteZone(1.0, 1.0, WORK, 0.05).at_penetration(0.02)
    assert trace.force[-1] == pytest.approx(exact.force, rel=1e-4)


def test_a_step_shorter_than_the_rounding_of_time_is_out_of_range() -> None:
    """What the run has done before is kept."""
    trace = solve(_scene(Hold(1e17), Ramp(-0.5, 0.02)), COARSE)
    assert trace.outcome.kind is OutcomeKind.OUT_OF_RANGE
    assert "rounding of the time" in trace.outcome.reason
    assert trace.time[-1] == 1e17


@pytest.mark.parametrize(("zone", "problem"), [(1e9, "longer than the contact"), (1e-12, "rounding")])
def test_a_zone_out_of_proportion_is_an_error_of_the_scene(zone: float, problem: str) -> None:
    with pytest.raises(SceneError, match=problem) as error:
        solve(_scene(Ramp(-0.5, 0.02), zone=zone), COARSE)
    assert error.value.key == "adhesion.zone"


def test_what_overflows_is_out_of_range() -> None:
    flat = Scene(ELASTIC, PowerLaw(2.0, 1e-300), Loading("relaxed", 0.032, (Ramp(0.0, 0.02),)))
    trace = solve(flat)
    assert trace.outcome.kind is OutcomeKind.OUT_OF_RANGE
    assert len(trace) == 0
    stiff = Material(1e60, 0.5)
    pressed = Scene(stiff, PowerLaw(2.0, 1e55), Loading("relaxed", 0.0, (Force(1e60, 1.0),)))
    trace = solve(pressed, COARSE)
    assert all(np.isfinite(column).all() for column in trace.columns().values())


@pytest.mark.slow
def test_collapse_of_a_rated_edge_within_the_rounding_of_time() -> None:
    """An unlimited law of a small power: the speed is the ninth power of the drive, too fast for any step."""
    loading = Loading("relaxed", 5.584e-7, (Ramp(3.068e-6, 0.2583), Hold(1.091e-5), Ramp(-1.227e-5, 0.234)))
    adhesion = Adhesion(0.004124, 4.449e-9, 7.299e-4, PowerRate(1.3404e-4, 0.114))
    question = Scene(Material(105000.0, 0.49), FlatPunch(1.60631e-05), loading, adhesion)
    trace = solve(question)
    assert trace.outcome.kind is OutcomeKind.BELOW_ZONE, trace.outcome
    at_once = np.flatnonzero(np.diff(trace.time) == 0.0)
    assert at_once[-1] == trace.time.size - 2
    assert trace.contact_radius[at_once[0]] > 0.05 * trace.contact_radius.max()
    assert trace.counters.rejected_steps < 50  # it rejected a thousand and went on


@pytest.mark.slow
def test_a_limited_law_has_limit_points() -> None:
    """Beyond its bound no speed balances the edge: contact is lost at fixed time, as by the others."""
    moduli = ((1.41, 0.00772), (13.2, 1.31), (3.36, 546.0), (13.5, 0.00503), (3.74, 0.184), (1.25, 0.0529))
    depths = (0.0232544, 0.0648284, 0.009802, 0.0643552, 0.0616512)
    loading = Loading("relaxed", depths[0], (Table((0.0, 0.692, 0.7403, 1.1613, 1.1918), depths),))
    rate = RateTable((16.149, 1614.9), (7.4326e-5, 1.87793e-4))
    adhesion = Adhesion(3.95353e-5, 0.004186, rate=rate)
    material = Material(1.0, 0.5, tuple(Branch(*one) for one in moduli))
    question = Scene(material, Sphere(1.0), loading, adhesion)
    assert np.isfinite(adhesion.opening(np.inf))
    trace = solve(question, Options(resolution=8))
    assert trace.outcome.kind is OutcomeKind.DETACHED, trace.outcome
    assert trace.events[-1].kind == "pull-off"
    assert trace.events[-1].contact_radius == pytest.approx(0.05622, rel=5e-3)  # 13 zones: bem has the same
    assert trace.events[-1].contact_radius > 10.0 * adhesion.zone
