"""Tags of a scene: what a code has to cover to answer it, and may decline by name."""

from __future__ import annotations

from dataclasses import fields

from contact_scene import Cone, FlatPunch, PowerLaw, Scene, Sphere, TabulatedProfile
from contact_scene.load_steps import STEPS

OF_STEP = {"force": "force-control", "force-ramp": "force-control", "oscillate": "oscillation"}
"""Tag of a kind of load step; any other kind is its own tag."""
OF_SHAPE = {"flat-punch": "punch"}
"""Tag of the shape of an indenter; any other shape is its own tag."""
_ALWAYS = {"title", "material", "indenter", "loading", "adhesion"}
_OF_ADHESION = {"work", "zone"}

POSSIBLE = {
    *("adhesive", "adhesionless", "elastic", "viscoelastic", "spectrum", "separate-bulk", "relaxed-start"),
    *("spring", "trigger"),
    *(OF_STEP.get(step.kind, step.kind) for step in STEPS),
    *(OF_SHAPE.get(kind.shape, kind.shape) for kind in (Sphere, Cone, FlatPunch, PowerLaw, TabulatedProfile)),
}
"""Tags a scene can have, those for further parts of a scene aside."""


def tags(scene: Scene) -> tuple[str, ...]:
    """All tags of a scene, in alphabetical order."""
    material, found = scene.material, {OF_SHAPE.get(scene.indenter.shape, scene.indenter.shape)}
    found.add("adhesive" if scene.is_adhesive else "adhesionless")
    found.add("elastic" if material.is_elastic else "viscoelastic")
    if material.spectrum[0].size > 1:
        found.add("spectrum")
    if material.bulk is not None:
        found.add("separate-bulk")
    if scene.loading.start == "relaxed":
        found.add("relaxed-start")
    if scene.loading.compliance > 0.0:
        found.add("spring")
    if scene.loading.has_triggers:
        found.add("trigger")
    found |= {OF_STEP.get(step.kind, step.kind) for step in scene.loading.steps}
    found |= {part for part in _stated(scene) if part not in _ALWAYS}
    if scene.is_adhesive:
        found |= {part for part in _stated(scene.adhesion) if part not in _OF_ADHESION}
    return tuple(sorted(tag.replace("_", "-") for tag in found))


def _stated(part: object) -> list[str]:
    """Names of the fields of a dataclass that hold something."""
    return [one.name for one in fields(part) if getattr(part, one.name) is not None]  # type: ignore[arg-type]
