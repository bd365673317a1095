"""The edge of a short zone: closed limits, check values, and the front tracking, which tends to it at a rate.

Built-in scenes of a PDMS-like sphere have zones of 1 um, 100 nm and 10 nm on contacts of 160 um.
"""

from __future__ import annotations

import math
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from scipy.optimize import brentq, minimize_scalar
from support.closed_forms.separate_bulk import equivalent_material
from support.closed_forms.short_zone import ShortZone, ShortZoneRun
from support.closed_forms.short_zone_dead_load import DeadLoad, dead_load

from contact_scene import Scene, Trace
from validation.cases import load
from validation.measure.observables import observe
from validation.measure.scaling import unit_sizes
from validation.reference.jkr import JKR
from validation.reference.path import Options, solve
from validation.reference.prony_integrals import relaxation_integral

SLOW = pytest.mark.slow
SOURCE = "equation of motion of the edge of a short zone"
KINDS = ("cycle", "retraction", "dead-load")
SIZES = {1e-6: "1um", 1e-7: "100nm", 1e-8: "10nm"}
SCENES = [*(f"pdms-{kind}-{size}" for kind in KINDS for size in SIZES.values()), "force-4"]
SCENES.append("bulk-retraction-100nm")


def law(scene: Scene) -> ShortZone:
    material = scene.material if scene.material.bulk is None else equivalent_material(scene.material)
    return ShortZone(material, scene.indenter.radius, scene.adhesion.work, scene.adhesion.zone)


@cache
def predicted(scene: Scene) -> ShortZoneRun | DeadLoad:
    first, start = scene.loading.steps[0], scene.loading.penetration
    if first.kind == "force":
        return dead_load(law(scene), start, first.value)
    if scene.loading.start == "relaxed":
        return law(scene).retraction(start, first.rate)
    return law(scene).cycle(start, first.to, first.rate, scene.loading.steps[1].rate)


def values(scene: Scene) -> dict[str, float]:
    """Predictions by the names of observables."""
    found = predicted(scene)
    if isinstance(found, DeadLoad):
        names = ("detachment_time", "detachment_penetration")
        return {name: getattr(found, name) for name in names}
    seen = {
        "pull_off_force": found.pull_off_force,
        "loop_energy": found.loop_energy,
        "detachment_time": float(found.time[-1]),
    }
    if scene.loading.start == "relaxed":
        return seen
    state = approached(scene)
    return seen | {"approach_radius": state.contact_radius, "approach_force": state.force}


def approached(scene: Scene):
    step = scene.loading.steps[0]
    return law(scene).approach(scene.loading.penetration, step.to, step.rate)


QUICK = ("pdms-dead-load-100nm",)


@pytest.mark.parametrize("name", [pytest.param(name, marks=() if name in QUICK else SLOW) for name in SCENES])
def test_check_values_are_those_of_the_equation_of_motion(name):
    case = load(name)
    units, found = unit_sizes(case.scene), values(case.scene)
    stated = [check for check in case.expected if check.source.startswith(SOURCE)]
    assert len(stated) >= (1 if name.startswith("force") else len(found))
    for check in stated:
        assert check.value * units[check.unit] == pytest.approx(found[check.observable], rel=1e-6, abs=0.0)


def test_check_values_of_an_approach():
    case = load("three-branches")
    found, units = approached(case.scene), unit_sizes(case.scene)
    stated = {c.observable: c.value * units[c.unit] for c in case.expected if c.source.startswith(SOURCE)}
    expected = {"approach_radius": found.contact_radius, "approach_force": found.force}
    assert stated == pytest.approx(expected, rel=1e-6, abs=0.0)


@pytest.mark.slow
def test_fast_edge_is_glassy_at_any_speed_of_the_half_space():
    """Zone to zero: ``q(a) = -sqrt(2 pi a Einf* dg)`` with ``q = E0* (D_0 - a^2/R) - V int_0^t E*(s) ds``."""
    scene = load("pdms-retraction-10nm").scene
    material, radius, work = scene.material, scene.indenter.radius, scene.adhesion.work
    depth, rate, relaxed = (
        scene.loading.penetration,
        scene.loading.steps[0].rate,
        material.relaxed_plane_modulus,
    )
    start = JKR(scene.indenter, relaxed, work).at_penetration(depth).contact_radius

    def edge(time: float) -> float:
        pulled = rate * float(relaxation_integral(material, time))

        def lack(a: float) -> float:
            tension = math.sqrt(2.0 * math.pi * a * material.glassy_plane_modulus * work)
            return relaxed * (depth - a * a / radius) - pulled + tension

        return start if lack(start) >= 0.0 else brentq(lack, 0.3 * start, start)

    def force(time: float) -> float:
        a, pulled = edge(time), rate * float(relaxation_integral(material, time))
        return 2.0 * a * (relaxed * depth - pulled) - 2.0 * relaxed * a**3 / (3.0 * radius)

    best = minimize_scalar(force, bounds=(0.2, 0.3), method="bounded")
    limit = replace(law(scene), zone=1e-11).retraction(depth, rate)
    assert limit.pull_off_force == pytest.approx(-best.fun, rel=1e-6)
    assert limit.pull_off_force == pytest.approx(predicted(scene).pull_off_force, rel=2e-3)


def test_time_under_a_dead_load_is_in_proportion_to_one_over_the_zone():
    scene = load("pdms-dead-load-100nm").scene
    thin = replace(scene, adhesion=replace(scene.adhesion, zone=1e-3 * scene.adhesion.zone))
    force = scene.loading.steps[0].value
    long, short = predicted(scene), predicted(thin)
    assert short.detachment_time == pytest.approx(1e3 * long.detachment_time, rel=1e-12)
    assert short.detachment_radius == long.detachment_radius
    # a long time: crept under the last load, but for the end, where the edge runs away
    relaxed = scene.material.relaxed_plane_modulus
    a = short.detachment_radius
    rest = force / (2.0 * relaxed * a) + a * a / (3.0 * scene.indenter.radius)
    assert short.detachment_penetration == pytest.approx(rest, rel=2e-2)


def test_forces_that_detach_at_once_or_never_are_refused():
    scene = load("pdms-dead-load-1um").scene
    unit = 1.5 * math.pi * scene.adhesion.work * scene.indenter.radius
    for multiple in (-0.9, -3.1):
        with pytest.raises(ValueError, match="no delayed loss of contact"):
            dead_load(law(scene), scene.loading.penetration, multiple * unit)


@cache
def tracked(kind: str, zone: float) -> Trace:
    scene = load(f"pdms-{kind}-1um").scene
    return solve(replace(scene, adhesion=replace(scene.adhesion, zone=zone)), Options())


@cache
def distances(kind: str, zone: float) -> dict[str, float]:
    """Of the front tracking from the equation of motion, relative."""
    scene = load(f"pdms-{kind}-1um").scene
    scene = replace(scene, adhesion=replace(scene.adhesion, zone=zone))
    seen = observe(tracked(kind, zone), zone).as_dict()
    return {name: seen[name] / value - 1.0 for name, value in values(scene).items()}


RATES = {
    ("retraction", "pull_off_force"): (0.9, 1.1, 5e-5),
    ("retraction", "loop_energy"): (0.8, 1.2, 1e-5),
    ("retraction", "detachment_time"): (0.8, 1.2, 2e-5),
    ("cycle", "pull_off_force"): (0.85, 1.15, 5e-5),
    ("cycle", "loop_energy"): (0.5, 1.2, 2e-4),
    ("cycle", "detachment_time"): (0.8, 1.2, 1e-5),
    ("cycle", "approach_radius"): (0.8, 1.5, 2e-6),
    ("dead-load", "detachment_time"): (0.95, 1.05, 5e-4),
}
"""Least and largest power of the zone with which the front tracking tends to the limit, mean over two decades
from 1 um on; largest distance at 10 nm."""


@pytest.mark.parametrize(
    ("kind", "quantity"),
    [
        pytest.param(*key, id="-".join(key), marks=SLOW if key[0] == "retraction" else pytest.mark.exhaustive)
        for key in RATES
    ],
)
def test_front_tracking_tends_to_the_limit_with_the_zone(kind, quantity):
    least, most, finest = RATES[kind, quantity]
    long, short = (abs(distances(kind, zone)[quantity]) for zone in (1e-6, 1e-8))
    assert least < 0.5 * math.log10(long / short) < most
    assert short < finest


@pytest.mark.exhaustive
@pytest.mark.parametrize("quantity", ["pull_off_force", "loop_energy"])
def test_retraction_converges_for_a_vanishing_zone(quantity):
    """The front tracking alone: differences of neighbouring decades fall with the first power of the zone."""
    found = [
        getattr(observe(tracked("retraction", zone), zone), quantity) for zone in (1e-7, 1e-8, 1e-9, 1e-10)
    ]
    first, second, third = np.abs(np.diff(found)) / abs(found[-1])
    assert 0.8 < math.log10(first / second) < 1.1
    assert 0.8 < math.log10(second / third) < 1.2
    assert third < 5e-5
