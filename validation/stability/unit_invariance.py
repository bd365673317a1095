"""Axis of units: one scene in other units of length, stress and time."""

from __future__ import annotations

from dataclasses import replace

from contact_scene import (
    Adhesion,
    Branch,
    Loading,
    Material,
    PowerRate,
    Ramp,
    RateTable,
    Scene,
    Sphere,
)
from validation.stability import base
from validation.stability.case import EquivalentScene, StabilityCase
from validation.stability.materials import SAME

UNITS = (  # name, factors of length, stress and time
    ("metres to millimetres", 1e3, 1.0, 1.0),
    ("metres to nanometres", 1e9, 1.0, 1.0),
    ("nanometres to metres", 1e-9, 1.0, 1.0),
    ("GPa to Pa", 1.0, 1e9, 1.0),
    ("Pa to GPa", 1.0, 1e-9, 1.0),
    ("hours to nanoseconds", 1.0, 1.0, 3.6e12),
    ("millimetres, GPa, milliseconds", 1e3, 1e-9, 1e3),
)


def unit_systems() -> list[StabilityCase]:
    """The cycle at ``V tau/R = 0.02``; every row is the same after scaling."""
    plain = base.scene(base.material(), base.press_and_pull(0.02))
    return [
        StabilityCase("scale", label, scaled(plain, *by), EquivalentScene(plain, *by), SAME)
        for label, *by in UNITS
    ]


def scaled(scene: Scene, length: float, stress: float, time: float) -> Scene:
    """A sphere's scene in other units.

    Parameters
    ----------
    scene : Scene
        Of ramps, with adhesion.
    length, stress, time : float
        Factors from its units to the new ones.

    Returns
    -------
    Scene
    """
    assert isinstance(scene.indenter, Sphere)
    assert scene.adhesion is not None
    branches = tuple(Branch(stress * b.modulus, time * b.time) for b in scene.material.branches)
    steps = []
    for step in scene.loading.steps:
        assert isinstance(step, Ramp)
        steps.append(Ramp(length * step.to, length / time * step.rate))
    return replace(
        scene,
        material=Material(stress * scene.material.modulus, scene.material.poisson, branches),
        indenter=Sphere(length * scene.indenter.radius),
        adhesion=_scaled_adhesion(scene.adhesion, length, stress, time),
        loading=Loading(scene.loading.start, length * scene.loading.penetration, tuple(steps)),
    )


def _scaled_adhesion(adhesion: Adhesion, length: float, stress: float, time: float) -> Adhesion:
    energy, speed = stress * length, length / time
    rate = adhesion.rate
    if isinstance(rate, PowerRate):
        rate = PowerRate(speed * rate.speed, rate.exponent)
    elif rate is not None:
        rate = RateTable(tuple(speed * v for v in rate.speeds), tuple(energy * w for w in rate.works))
    return Adhesion(
        energy * adhesion.work,
        0.0 if adhesion.stress is not None else length * adhesion.zone,
        None if adhesion.work_closing is None else energy * adhesion.work_closing,
        rate,
        None if adhesion.stress is None else stress * adhesion.stress,
    )
