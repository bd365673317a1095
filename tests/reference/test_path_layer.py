"""The reference on a layer of finite thickness: its operator, known histories, the balance of energies."""

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.special import j0
from support.closed_forms.layer import FrozenLayer

from contact_scene import (
    Adhesion,
    Branch,
    Cone,
    Force,
    ForceRamp,
    Hold,
    Layer,
    Loading,
    Machine,
    Material,
    OutcomeKind,
    PowerLaw,
    Ramp,
    Scene,
    Sphere,
    TabulatedProfile,
)
from validation.reference import prony_integrals
from validation.reference.elastic_layer import ElasticLayer, transfer
from validation.reference.path import Options, energies, solve
from validation.reference.path.equilibrium import edge_strain, elastic_depths, half_force, indented
from validation.reference.path.layer import image
from validation.reference.path.numerics import gauss
from validation.reference.path.recorder import Recorder
from validation.reference.path.rheology import IndentedBody, rheology
from validation.reference.path.run import PathRun
from validation.reference.sneddon import transform

BASES = [("bonded", 0.5), ("bonded", 0.3), ("bonded", 0.0), ("frictionless", 0.3)]
TWO = (Branch(3.0, 0.3), Branch(4.0, 3.0))
ADHESION = Adhesion(5.0e-4, 0.013)
RADII = tuple(np.linspace(0.0, 2.0, 5).tolist())
PROFILE = TabulatedProfile(RADII, tuple(0.5 * r * r if r < 1.0 else 0.5 + 2.0 * (r - 1.0) for r in RADII))


@pytest.mark.parametrize(("base", "poisson"), BASES)
@pytest.mark.parametrize("ratio", [1e-6, 0.2, 1.0, 3.0, 10.0, pytest.param(30.0, marks=pytest.mark.slow)])
def test_elastic_contact_is_that_of_the_integral_equation(base, poisson, ratio):
    layer, material = Layer(1.0 / ratio, base), Material(1.0, poisson, ())
    known_to = {Sphere(3.0): 1e-10, Cone(0.3): 1e-10, PowerLaw(1.7, 0.4): 1e-6, PROFILE: 1e-3}
    for indenter, accuracy in known_to.items():
        known = ElasticLayer(layer, poisson, indenter).response(1.0)
        for reach in (1.01, 1.6) if indenter == Sphere(3.0) else (1.1,):
            body = IndentedBody(rheology(material), transform(indenter), image(layer, poisson, reach))
            found = *half_force(body, 1.0), *edge_strain(body, 1.0)
            accuracy = max(accuracy, 1e-11 * known.stiffness)  # what is left out of M, as often as it acts
            wanted = 0.5 * known.stiffness, 0.5 * known.profile_force, known.edge, known.profile_edge
            assert found == pytest.approx(wanted, rel=accuracy)


def press(base, poisson, *steps, **others):
    material = Material(0.75, poisson, TWO)
    return Scene(material, Sphere(1.0), Loading("jump-in", 0.0, steps), body=Layer(0.1, base), **others)


@pytest.mark.parametrize("steps", [(ForceRamp(0.05, 0.05),), (Force(0.05, 2.0),)])
def test_growing_contact_under_a_force(steps):
    scene = press("bonded", 0.5, *steps)
    trace, layer = solve(scene), ElasticLayer(scene.body, 0.5, scene.indenter)
    if isinstance(steps[0], Force):
        unit = 0.05 * float(prony_integrals.creep(scene.material, 2.0))
    else:
        unit = 0.05 * float(prony_integrals.creep_integral(scene.material, 1.0))
    assert layer.state(float(trace.contact_radius[-1])).force == pytest.approx(unit, rel=1e-6)


def test_a_contact_outgrows_what_its_loading_says():
    """It presses with the force of its start, and a level that is below from the start bounds nothing."""
    unloading, pressing = ForceRamp(0.005, 0.005), Ramp(0.03, 0.02, until_force=1e-3)
    for step in (unloading, pressing):
        scene = press("bonded", 0.5, step)
        scene = replace(scene, loading=replace(scene.loading, penetration=0.01))
        trace, layer = solve(scene), ElasticLayer(scene.body, 0.5, scene.indenter)
        widest = int(trace.contact_radius.argmax())
        radius, time = float(trace.contact_radius[widest]), trace.time[widest]
        assert radius > indented(scene).image.reach
        if step is pressing:
            assert radius == pytest.approx(layer.radius_at(0.03), rel=1e-7)
        else:
            unit = trace.force[0] * prony_integrals.creep(scene.material, time)
            unit -= step.rate * prony_integrals.creep_integral(scene.material, time)
            assert layer.state(radius).force == pytest.approx(float(unit), rel=1e-6)


def test_the_profile_is_what_the_pressure_does_to_the_layer():
    """By Hankel's transform, which knows no image."""
    scene = Scene(
        Material(0.75, 0.3, ()),
        Sphere(1.0),
        Loading("relaxed", 0.01, (Hold(1.0),)),
        body=Layer(0.2, "bonded"),
    )
    (profile,) = solve(scene, Options(profile_times=(0.5,))).profiles
    points, weights = gauss(160)
    a, modulus = profile.contact_radius, scene.material.relaxed_plane_modulus
    x, step = a * points, 0.02
    body = indented(scene)
    q = modulus * (body.image.functions(x) @ elastic_depths(body, 0.01, a) - x * x)
    waves = step * (np.arange(80_000) + 0.5)
    pressed = np.cos(np.outer(waves, x)) @ (a * weights * q) / math.pi
    lowered = 2.0 * step / modulus * pressed * transfer(0.2 * waves, 0.3, "bonded")
    for i in (80, 220, 260, 300):
        direct = float(lowered @ j0(waves * profile.radius[i]))
        assert profile.displacement[i] == pytest.approx(direct, abs=1e-4 * 0.01)


@pytest.mark.parametrize("of", ["force", "penetration"])
@pytest.mark.parametrize(("base", "poisson"), BASES[:2])
def test_elastic_pull_off_of_a_vanishing_zone(base, poisson, of):
    layer, material = Layer(0.15, base), Material(0.75, poisson, ())
    steps = (Ramp(-0.5, 0.01),) if of == "penetration" else (ForceRamp(-0.1, 0.01),)
    values = []
    for zone in (2e-5, 1e-5):
        loading = Loading("relaxed", 0.01, steps)
        scene = Scene(material, Sphere(1.0), loading, Adhesion(5e-4, zone), body=layer)
        trace = solve(scene)
        values.append(getattr(trace, of)[np.flatnonzero(trace.contact_radius > 0.0)].min())
    modulus = material.relaxed_plane_modulus
    known = ElasticLayer(layer, poisson, Sphere(1.0)).pull_off(5e-4 / modulus, of)
    wanted = known.penetration if of == "penetration" else modulus * known.force
    assert 2.0 * values[1] - values[0] == pytest.approx(wanted, rel=1e-5)


def test_retraction_faster_than_all_relaxation():
    layer, material = Layer(0.1, "bonded"), Material(0.75, 0.5, (Branch(6.75, 1.0),))
    loading = Loading("relaxed", 0.01, (Ramp(-0.5, 1e6),))
    scene = Scene(material, Sphere(1.0), loading, Adhesion(5e-4, 1e-6), body=layer)
    trace = solve(scene)
    known = FrozenLayer(material, ElasticLayer(layer, 0.5, Sphere(1.0)), 5e-4, 0.01)
    assert trace.contact_radius[0] == pytest.approx(known.relaxed.contact_radius, rel=1e-4)
    assert trace.force.min() == pytest.approx(known.release(known.relaxed.contact_radius).force, rel=1e-4)


def dissipated(run: PathRun, state) -> float:
    """Power of the branches, ``M`` between them included."""
    body = run.recorder.body
    moments = state.held + state.free @ body.rheology.branches_of_units
    squares = state.held_squares - (moments * (body.image.coupling @ moments)).sum(axis=0)
    material = body.rheology
    power = (squares / (material.moduli * material.times)).sum()
    return 2.0 * float(power + (state.free_squares / (material.compliances * material.retardation)).sum())


RAMPS = (Ramp(0.012, 0.05), Hold(0.5), Ramp(0.004, 0.01), Ramp(0.01, 0.05), Ramp(-0.5, 0.01))
PULLED = {
    "ramps": Loading("jump-in", 0.0, RAMPS),
    "force": Loading("relaxed", 0.005, (ForceRamp(0.01, 0.02), Force(-0.004, 100.0))),
    "spring": Loading("relaxed", 0.005, (Ramp(0.03, 0.02), Ramp(-0.5, 0.02)), Machine(1.0)),
}


@pytest.mark.slow
@pytest.mark.parametrize(
    "name",
    ["ramps", "force", "spring"],
)
def test_work_is_stored_dissipated_or_released_at_the_tip(name, monkeypatch):
    scene = Scene(Material(0.75, 0.45, TWO), Sphere(1.0), PULLED[name], ADHESION, body=Layer(0.1, "bonded"))
    run, lost = PathRun(scene, 1e-5), []
    points, weights = gauss(6)
    record = Recorder.step

    def step(self, arrival, state, back):
        record(self, arrival, state, back)
        slopes = arrival.motion.clock[1:] * np.arange(1, len(arrival.motion.clock))
        for u, weight in zip(points.tolist(), weights, strict=True):
            rate = dissipated(run, arrival.part(u).after())
            lost.append(weight * rate * (u ** np.arange(len(slopes)) @ slopes))

    monkeypatch.setattr(Recorder, "step", step)
    columns, _ = run.run()
    rows = np.concatenate(run.recorder.rows)
    last = int(np.flatnonzero(columns["contact_radius"] > 0.0)[-1])
    work, tip, stored = (
        rows[last, of] - rows[0, of] for of in (energies.WORK, energies.TIP, energies.STORED)
    )
    turnover = np.abs(np.diff(rows[: last + 1, energies.WORK])).sum()
    assert abs(work + tip - stored - sum(lost)) < 1e-6 * turnover


def test_integrals_over_no_contact_are_zero():
    """Of a profile with kinks too, as a contact is lost."""
    body = IndentedBody(
        rheology(Material(1.0, 0.5)), transform(PROFILE), image(Layer(0.3, "bonded"), 0.5, 2.0)
    )
    gram, shape = body.integrals(0.0)
    assert not gram.any()
    assert not shape.any()


@pytest.mark.slow
def test_what_a_thin_layer_rounds_moves_no_edge():
    """At 26 thicknesses; four times the steps where residuals that are its rounding are not told apart."""
    scene = Scene(
        Material(0.75, 0.5, (Branch(6.75, 1.0),)),
        Sphere(1.0),
        Loading("jump-in", 0.003, (Hold(3.0), Ramp(-0.5, 0.01))),
        Adhesion(1e-6, 1e-4),
        body=Layer(0.004, "bonded"),
    )
    trace = solve(scene, Options(max_steps=300))
    assert trace.outcome.kind is OutcomeKind.DETACHED
