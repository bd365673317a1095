"""Largest radius, penetration and force that a scene asks for."""

from __future__ import annotations

from dataclasses import dataclass

from contact_scene import Scene
from validation.reference.path.equilibrium import pressed_radius, staged_radius, touching_radius
from validation.reference.path.rheology import Body
from validation.reference.path.state import State


@dataclass(frozen=True)
class Scales:
    """Of a whole run."""

    radius: float
    depth: float
    force: float


def scales(scene: Scene, body: Body, start: State) -> Scales:
    """As if the contact were relaxed and without adhesion, or as it begins, whichever is larger.

    Where nothing is ever touched any length is one.
    """
    edge = scene.indenter.edge
    deepest, hardest = _largest_load(scene, body)
    radius = (
        max(start.radius, touching_radius(body, deepest, edge), pressed_radius(body, hardest, edge)) or 1.0
    )
    shape = body.shape(radius)
    depth = max(abs(start.depth), abs(deepest), shape, _depth_under(body, hardest, edge)) or 1.0
    weight = 2.0 * body.rheology.relaxed * (depth * radius - body.transform.integral(radius))
    return Scales(radius, depth, max(abs(start.force), weight, hardest))


def _largest_load(scene: Scene, body: Body) -> tuple[float, float]:
    """Largest penetration and largest force that the loading prescribes.

    A stage presses with the relaxed contact under it; a level that ends a load step bounds it.
    """
    loading, edge = scene.loading, scene.indenter.edge
    depth = deepest = loading.penetration
    force = hardest = 0.0
    for step in loading.steps:
        segment = loading.segment(step, 0.0, depth, force)
        largest, last = step.largest(segment), segment.value(segment.end)
        if segment.control == "force":
            hardest, force = max(hardest, largest), last
            continue
        if segment.control == "stage":
            soft = 2.0 * body.rheology.relaxed * segment.compliance
            radius = staged_radius(body, largest, segment.compliance, edge)
            pressed = (largest + soft * body.transform.integral(radius)) / (1.0 + soft * radius)
            last = largest = pressed if radius > 0.0 else depth
        trigger = segment.trigger
        if trigger is not None and trigger.quantity == "force":
            hardest, force = max(hardest, trigger.level), trigger.level
            last = largest = min(largest, _depth_under(body, trigger.level, edge))
        elif trigger is not None and trigger.quantity == "radius":
            last = largest = min(largest, body.shape(min(trigger.level, edge)))
        deepest, depth = max(deepest, largest), last
    return deepest, hardest


def _depth_under(body: Body, force: float, edge: float) -> float:
    """Penetration of the adhesionless relaxed contact under a force."""
    radius = pressed_radius(body, force, edge)
    if radius == 0.0:
        return 0.0
    return float((0.5 * force / body.rheology.relaxed + body.transform.integral(radius)) / radius)
