"""The elastic limits of the paper's sphere, from closed forms: JKR, and the same with the process zone."""

from __future__ import annotations

from functools import cache

from contact_scene import Sphere
from validation.cases import load
from validation.measure.scaling import unit_sizes
from validation.reference.finite_zone import FiniteZone
from validation.reference.jkr import JKR

BASE = "cycle-v0.02"
"""Built-in scene with the material, sphere and adhesion of all claims but the sweep."""


def modulus(glassy: bool, scene: str = BASE) -> float:
    """``E*`` of the limit."""
    material = load(scene).scene.material
    return material.glassy_plane_modulus if glassy else material.relaxed_plane_modulus


@cache
def vanishing(glassy: bool, scene: str = BASE) -> JKR:
    """JKR: a vanishing process zone."""
    adhesive = load(scene).scene
    assert adhesive.adhesion is not None
    return JKR(adhesive.indenter, modulus(glassy, scene), adhesive.adhesion.work)


@cache
def finite(glassy: bool, scene: str = BASE) -> FiniteZone:
    """The elastic limit of the model: the paper's closure over its process zone."""
    adhesive = load(scene).scene
    assert adhesive.adhesion is not None
    assert isinstance(adhesive.indenter, Sphere)
    return FiniteZone(
        adhesive.indenter.radius, modulus(glassy, scene), adhesive.adhesion.work, adhesive.adhesion.zone
    )


def pull_off(glassy: bool, scene: str = BASE) -> float:
    """Pull-off force of the finite zone over ``F_JKR``."""
    return -finite(glassy, scene).pull_off_force_control().force / unit_sizes(load(scene).scene)["jkr-force"]
