"""The contact a run starts from: the elastic equilibrium of an untouched half-space, glassy or fully relaxed.

Elastic fields are ``q = E* w^`` behind the edge and ``d = -w^`` ahead with ``w^ = phi . (D, C) - G``, and
``E*`` of the glass or of the rubber: penetration and radius say all, as ``C`` follows from them. Where the
stage is given, not the penetration, ``D + F/k = X`` with ``F = 2 int_0^a q``. The edge has closed: among the
radii that satisfy its condition the run starts from the outermost at which the release rate rises outwards.
Without adhesion the radius is that of ``w^(a) = 0``. Of the relaxed contact without adhesion are also the
scales of a run.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from contact_scene import Scene, TabulatedProfile
from contact_scene.errors import SceneError
from contact_scene.scene import zone_too_long
from validation.reference.path.closure import BASE, LONGEST, closure, zone_length
from validation.reference.path.fields import untouched
from validation.reference.path.layer import image
from validation.reference.path.numerics import NEGLIGIBLE, bracketed, dip
from validation.reference.path.rheology import IndentedBody, rheology
from validation.reference.path.state import State
from validation.reference.sneddon import transform

Array = NDArray[np.float64]

SHORTEST = 1e-60
"""Least radius at which a contact shorter than its zone is looked for: the least length a scene may hold."""
RATIO = 1.03
"""Ratio of the radii among which an equilibrium is bracketed."""
REACH, BEYOND = 1.1, 2.0
"""The functions of a layer reach so many largest contact radii, and so many process zones farther."""
FARTHER = 2.0
"""How much farther they are to reach where a contact is followed that is larger."""
WIDER = 1.05
"""Ratio of radii among which the largest is looked for."""
LEAST_DIP = 1e-8
"""Width of a dip of the residual, in the radius, between the two radii of a contact about to be lost."""


def elastic_start(scene: Scene, body: IndentedBody) -> State | None:
    """The contact a scene starts from; ``None`` if the indenter does not hold one.

    Raises
    ------
    SceneError
        If contact is possible, but not with a process zone of that length; if the zone is lost in rounding;
        if the contact is too large for its layer.
    """
    depth, rim, adhesion = scene.loading.penetration, scene.indenter.edge, scene.adhesion
    rheology = body.rheology
    glassy = scene.loading.start != "relaxed"
    modulus = rheology.glassy if glassy else rheology.relaxed
    staged = scene.loading.start_control == "stage"
    softness = 2.0 * modulus * scene.loading.compliance if staged else 0.0

    def depth_at(radius: float) -> float:
        slope, lack = half_force(body, radius)
        return (depth + softness * lack) / (1.0 + softness * slope)

    def start(radius: float) -> State:
        if scene.body is not None and radius > scene.body.largest_contact:
            raise scene.body.outgrown
        return start_state(body, depth_at(radius), radius, glassy)

    def strain(radius: float) -> float:
        slope, lack = edge_strain(body, radius)
        return depth_at(radius) * slope - lack

    if not scene.is_adhesive or adhesion is None:
        return start(_rising(lambda a: -strain(a), min(rim, body.image.reach)))

    def field(radius: float) -> Callable[[Array], Array]:
        """``w^`` at distances from the edge."""
        depths = elastic_depths(body, depth_at(radius), radius)
        return lambda x: body.image.functions(radius + x) @ depths - body.transform(radius + x)

    def zone_at(radius: float) -> float:
        """Length of the zone, that of a fixed stress too."""
        if adhesion.stress is None:
            return adhesion.zone
        strain_at = field(radius)
        guess = min(adhesion.zone, 0.5 * radius)
        return zone_length(
            lambda x: modulus * strain_at(x),
            body.transform.knots - radius,
            radius,
            adhesion.stress,
            adhesion.zone,
            guess,
        )

    def released(radius: float) -> float:
        zone, strain_at = zone_at(radius), field(radius)
        knots = np.concatenate((body.transform.knots - radius + zone, body.transform.knots - radius))
        form = closure(radius, zone, np.union1d(zone * BASE, knots[(knots > 0.0) & (knots < zone)]))
        behind, ahead = (strain_at(form.s - shift) for shift in (zone, 0.0))
        return form.between(modulus * behind, -ahead)

    def residual(radius: float) -> float:
        return released(radius) / adhesion.closing - 1.0

    def sharp(radius: float) -> float:
        """The residual of a vanishing zone: ``q^2/(2 pi a E*) - w``, negative where the edge is pressed."""
        released = -math.copysign(modulus * strain(radius) ** 2, strain(radius)) / (2.0 * math.pi * radius)
        return released / adhesion.closing - 1.0

    highest, zone = rim, adhesion.zone
    if math.isinf(rim):  # beyond the last root the release rate rises with the radius
        ledge = scene.indenter.radii[-1] if isinstance(scene.indenter, TabulatedProfile) else 0.0
        reach = body.image.reach - zone
        highest = min(max(2.0 * touching_radius(body, depth, rim), 4.0 * zone, ledge), reach)
        while highest < reach and residual(highest) <= max(residual(0.5 * highest), 0.0):
            highest = min(2.0 * highest, reach)
        if scene.body is not None and residual(highest) <= 0.0:
            raise scene.body.outgrown
    elif released(rim) <= adhesion.work:  # a flat face is in contact up to its rim unless that opens
        return start(rim)
    radius = _outermost(residual, _between(highest, zone, body.transform.knots))
    if radius is None:
        short = _outermost(sharp, _between(zone, SHORTEST, body.transform.knots))
        if short is None:
            return None
        raise zone_too_long(zone, short)
    if zone < NEGLIGIBLE * radius:
        raise SceneError(
            "adhesion.zone",
            f"the process zone {zone:.4g} is lost in the rounding of the contact radius {radius:.4g}",
            f"a zone of at least {NEGLIGIBLE:g} of the contact radius",
        )
    if zone_at(radius) >= LONGEST * radius and adhesion.stress is not None:
        raise zone_too_long(zone_at(radius), radius)
    return start(radius)


def start_state(body: IndentedBody, depth: float, radius: float, glassy: bool) -> State:
    """The elastic contact of that radius on a surface never touched before, glassy or relaxed."""
    rheology = body.rheology
    moduli = rheology.moduli if glassy else 0.0 * rheology.moduli
    depths = elastic_depths(body, depth, radius)
    gram, shape = body.integrals(radius)
    whole = gram @ depths - shape
    return State(
        parameter=0.0,
        time=0.0,
        depths=depths,
        radius=radius,
        force=2.0 * (rheology.relaxed + float(moduli.sum())) * float(whole[0]),
        memory=np.outer(np.append(0.0, depths[1:]), moduli > 0.0),
        surface=untouched(radius, moduli * depth, -moduli),
        held=np.outer(whole, moduli),
        held_squares=moduli**2 * body.strain_squared(depths, radius),
        free=np.zeros((len(depths), len(moduli))),
        free_squares=np.zeros_like(moduli),
    )


def elastic_depths(body: IndentedBody, depth: float, radius: float) -> Array:
    """``(D, C)``."""
    unit, rest = body.elastic(radius)
    return depth * unit - rest


def edge_strain(body: IndentedBody, radius: float) -> tuple[float, float]:
    """``w^(a)``: the first times ``D``, less the second."""
    unit, rest = body.elastic(radius)
    phi = body.image.functions(np.array([radius]))[0]
    return float(phi @ unit), body.shape(radius) + float(phi @ rest)


def half_force(body: IndentedBody, radius: float) -> tuple[float, float]:
    """``int_0^a w^``: the first times ``D``, less the second."""
    (unit, rest), (gram, shape) = body.elastic(radius), body.integrals(radius)
    return float(gram[0] @ unit), float(shape[0] + gram[0] @ rest)


def pressed_depth(body: IndentedBody, radius: float) -> float:
    """Penetration of the adhesionless elastic contact, ``w^(a) = 0``."""
    slope, lack = edge_strain(body, radius)
    return lack / slope


def pressed_force(body: IndentedBody, radius: float) -> float:
    """Its force, in ``2 E*``."""
    slope, lack = half_force(body, radius)
    return pressed_depth(body, radius) * slope - lack


def touching_radius(body: IndentedBody, depth: float, rim: float, compliance: float = 0.0) -> float:
    """Radius of the adhesionless relaxed contact, that of the rim at most; ``compliance``: of a stage."""
    soft = 2.0 * body.rheology.relaxed * compliance

    def excess(radius: float) -> float:
        return pressed_depth(body, radius) + soft * pressed_force(body, radius) - depth

    return _rising(excess, min(rim, body.image.reach))


def pressed_radius(body: IndentedBody, force: float, rim: float) -> float:
    """Radius of the adhesionless relaxed contact under a force."""
    twice = 2.0 * body.rheology.relaxed
    return _rising(lambda a: twice * pressed_force(body, a) - force, min(rim, body.image.reach))


def _rising(excess: Callable[[float], float], rim: float) -> float:
    """The root of a function that rises with the radius, between the axis and the rim."""
    if excess(0.0) >= 0.0:
        return 0.0
    if math.isfinite(rim) and excess(rim) <= 0.0:
        return rim
    high = rim if math.isfinite(rim) else 1.0
    while excess(high) < 0.0:
        high *= 2.0
    while excess(0.5 * high) > 0.0:
        high *= 0.5
    return bracketed(excess, 0.5 * high, high)


def _between(highest: float, lowest: float, knots: Array) -> list[float]:
    """Radii that fall, with a few between the knots of a profile."""
    count = math.ceil(math.log(highest / lowest) / math.log(RATIO)) + 1
    knots = knots[(knots > lowest) & (knots < highest)]
    inner = knots[:-1, None] + np.diff(knots)[:, None] * np.linspace(0.0, 1.0, 4)
    return np.union1d(np.geomspace(lowest, highest, count), inner.ravel())[::-1].tolist()


def _outermost(residual: Callable[[float], float], radii: list[float]) -> float | None:
    """The first root at which the residual falls through zero on the way inwards.

    Near the least penetration of a contact it does so between two radii of any spacing: every dip is followed
    to its lowest point.
    """
    outer = above = radii[0]
    at_outer = at_above = residual(above)
    for radius in radii[1:]:
        value, low = residual(radius), radius
        if 0.0 < at_above < min(value, at_outer):
            place, lowest = dip(residual, radius, outer, LEAST_DIP * radius)
            if lowest <= 0.0:
                value, low, above = lowest, place, outer
        if value <= 0.0 < at_above:
            return bracketed(residual, low, above)
        outer, at_outer, above, at_above = above, at_above, radius, value
    return None


# what a scene asks for ---


def indented(scene: Scene, least_reach: float = 0.0) -> IndentedBody:
    """Material, layer and indenter of a scene; the functions of a layer reach beyond its largest contact."""
    bare = IndentedBody(rheology(scene.material), transform(scene.indenter))
    layer, zone = scene.body, scene.adhesion.zone if scene.is_adhesive and scene.adhesion else 0.0
    if layer is None:
        return bare
    farthest = farthest_reach(scene)

    def within(radius: float) -> float:
        return min(max(REACH * radius + BEYOND * zone, least_reach), farthest)

    reach = within(largest_radius(scene, bare, math.inf))
    while True:
        body = replace(bare, image=image(layer, scene.material.poisson, reach))
        largest = within(largest_radius(scene, body, reach))
        if largest <= reach:
            return replace(bare, image=image(layer, scene.material.poisson, largest))
        reach = min(FARTHER * reach, farthest)


def farthest_reach(scene: Scene) -> float:
    """How far the functions of a layer reach for a contact that is as large as any that is computed."""
    zone = scene.adhesion.zone if scene.is_adhesive and scene.adhesion else 0.0
    return REACH * scene.body.largest_contact + BEYOND * zone if scene.body is not None else 0.0


def largest_radius(scene: Scene, body: IndentedBody, reach: float) -> float:
    """A bound of the radius: that of the relaxed contact, pulled at its edge, under the largest loads."""
    edge, modulus = scene.indenter.edge, body.rheology.relaxed
    adhesion = scene.adhesion if scene.is_adhesive else None
    work = adhesion.work if adhesion else 0.0
    deepest, hardest = _largest_load(scene, body)

    def beyond(radius: float) -> bool:
        """Whether neither penetration nor force hold a contact of that radius."""
        slope, lack = edge_strain(body, radius)
        depth = (lack - math.sqrt(2.0 * math.pi * radius * work / modulus)) / slope
        slope, lack = half_force(body, radius)
        return depth > deepest and 2.0 * modulus * (depth * slope - lack) > hardest

    bound = min(edge, reach)
    least = adhesion.zone if adhesion else SHORTEST
    radius = max(touching_radius(body, deepest, bound), pressed_radius(body, hardest, bound), least)
    while radius < bound and not beyond(radius):
        radius = min(WIDER * radius, bound)
    return radius


@dataclass(frozen=True)
class Scales:
    """Largest radius, penetration and force that a scene asks for."""

    radius: float
    depth: float
    force: float


def scales(scene: Scene, body: IndentedBody, start: State) -> Scales:
    """As if the contact were relaxed and without adhesion, or as it begins, whichever is larger.

    Where nothing is ever touched any length is one.
    """
    edge = scene.indenter.edge
    deepest, hardest = _largest_load(scene, body)
    radius = (
        max(start.radius, touching_radius(body, deepest, edge), pressed_radius(body, hardest, edge)) or 1.0
    )
    shape, (slope, lack) = pressed_depth(body, radius), half_force(body, radius)
    depth = max(abs(start.depth), abs(deepest), shape, _depth_under(body, hardest, edge)) or 1.0
    weight = 2.0 * body.rheology.relaxed * (depth * slope - lack)
    return Scales(radius, depth, max(abs(start.force), weight, hardest))


def _largest_load(scene: Scene, body: IndentedBody) -> tuple[float, float]:
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
            radius = touching_radius(body, largest, edge, segment.compliance)
            slope, lack = half_force(body, radius)
            pressed = (largest + soft * lack) / (1.0 + soft * slope)
            last = largest = pressed if radius > 0.0 else depth
        trigger = segment.trigger
        if trigger is not None and trigger.quantity == "force":
            hardest, force = max(hardest, trigger.level), trigger.level
            last = largest = min(largest, _depth_under(body, trigger.level, edge))
        elif trigger is not None and trigger.quantity == "radius":
            last = largest = min(largest, pressed_depth(body, min(trigger.level, edge, body.image.reach)))
        deepest, depth = max(deepest, largest), last
    return deepest, hardest


def _depth_under(body: IndentedBody, force: float, edge: float) -> float:
    """Penetration of the adhesionless relaxed contact under a force."""
    radius = pressed_radius(body, force, edge)
    if radius == 0.0:
        return 0.0
    slope, lack = half_force(body, radius)
    return (0.5 * force / body.rheology.relaxed + lack) / slope
