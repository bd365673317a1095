"""Start states: the elastic equilibrium of an untouched half-space, glassy ("jump-in") or fully relaxed."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from contact_scene import Scene, TabulatedProfile
from contact_scene.errors import SceneError
from contact_scene.scene import zone_too_long
from validation.reference.path.rheology import Body
from validation.reference.tracking.law import EdgeCondition, Griffith
from validation.reference.tracking.root import bracketed
from validation.reference.tracking.surface import Surface

Array = NDArray[np.float64]

LEAST_ZONE = 1e-9
"""Least process zone in contact radii: the rounding of a radius is then 1e-7 of a zone."""
MOST_RADII = 800
"""Most evenly spaced radii among which an equilibrium is bracketed."""
SHORTEST = 1e-60
"""Least radius at which a contact shorter than its zone is looked for: the least length a scene may hold."""
NODES = 160
"""Nodes of the start state, half of them within a fifth of the radius from the edge."""


def start_surface(scene: Scene, body: Body, law: EdgeCondition) -> Surface | None:
    """The outermost stable elastic equilibrium of an edge that has closed; ``None`` if there is none.

    A flat face is in contact up to its rim unless that opens.

    Parameters
    ----------
    scene : Scene
        Its loading gives the penetration, or stage, and whether the half-space is glassy or relaxed.
    body : Body
    law : EdgeCondition

    Returns
    -------
    Surface or None

    Raises
    ------
    SceneError
        If contact is possible, but not with a process zone of that length; if the zone is lost in rounding.
    """
    depth, edge = scene.loading.penetration, scene.indenter.edge
    glassy = scene.loading.start != "relaxed"
    modulus = body.rheology.glassy if glassy else body.rheology.relaxed
    staged = scene.loading.start_control == "stage"
    softness = 2.0 * modulus * scene.loading.compliance if staged else 0.0

    def depth_at(radius: float) -> float:
        """Penetration of a contact of that radius: ``D + F/k = X``, ``F = 2 E* (a D - int_0^a G)``."""
        if not staged:
            return depth
        return (depth + softness * body.transform.integral(radius)) / (1.0 + softness * radius)

    def surface_of(radius: float) -> Surface:
        return elastic_surface(body, depth_at(radius), radius, glassy)

    def residual(radius: float) -> float:
        return law.residual(surface_of(radius), body, math.inf)

    if not isinstance(law, Griffith):
        if staged:
            return surface_of(staged_radius(body, modulus, depth, scene.loading.compliance, edge))
        return surface_of(touching_radius(body, depth, edge))
    zone = law.adhesion.zone

    def tip_residual(radius: float) -> float:
        """The same for a vanishing zone: ``q^2/(2 pi a E*) - dg``, negative where the edge is pressed."""
        q = modulus * (depth_at(radius) - float(body.transform(np.array([radius]))[0]))
        return -math.copysign(q * q, q) / (2.0 * math.pi * radius * modulus * law.adhesion.closing) - 1.0

    highest = edge
    if math.isinf(edge):  # beyond the last root the release rate rises with the radius
        highest = max(2.0 * touching_radius(body, depth, edge), 4.0 * zone, _last_ledge(scene))
        while residual(highest) <= max(residual(0.5 * highest), 0.0):
            highest *= 2.0
    elif law.residual(surface_of(edge), body) <= 0.0:
        return surface_of(edge)
    outermost = _outermost(residual, law.smallest_radius, highest)
    if outermost is not None:
        if zone < LEAST_ZONE * outermost:
            raise SceneError(
                "adhesion.zone",
                f"the process zone {zone:.4g} is lost in the rounding of the contact radius {outermost:.4g}",
                f"a zone of at least {LEAST_ZONE:g} of the contact radius",
            )
        surface = surface_of(outermost)
        longest = law.zone_at(surface, body)
        if longest >= outermost and law.adhesion.stress is not None:
            raise zone_too_long(longest, outermost)
        return surface
    short = _shorter_contact(tip_residual, law.smallest_radius)
    if short is not None:
        raise zone_too_long(zone, short)
    return None


def _shorter_contact(tip_residual: Callable[[float], float], longest: float) -> float | None:
    """Radius below ``longest`` of the contact that there would be with a vanishing zone, if any."""
    while longest > SHORTEST:
        short = _outermost(tip_residual, 1e-6 * longest, longest)
        if short is not None:
            return short
        longest *= 1e-6
    return None


def _last_ledge(scene: Scene) -> float:
    """Radius beyond which a profile has no features."""
    return scene.indenter.radii[-1] if isinstance(scene.indenter, TabulatedProfile) else 0.0


def _outermost(residual: Callable[[float], float], lowest: float, highest: float) -> float | None:
    """Largest radius at which the residual falls through zero on the way inwards.

    Near the least penetration of a contact it does so between two radii of any spacing: every dip is followed
    to its lowest point.
    """
    even = np.linspace(highest, lowest, min(int(highest / lowest) + 2, MOST_RADII))
    radii = sorted({*np.geomspace(highest, lowest, 200).tolist(), *even.tolist()}, reverse=True)
    before = above = radii[0]
    at_before = at_above = residual(above)
    for radius in radii[1:]:
        value = residual(radius)
        if 0.0 < at_above < min(value, at_before):
            from scipy.optimize import minimize_scalar

            nearby = (radius, before)
            dip = minimize_scalar(residual, bounds=nearby, method="bounded", options={"xatol": 1e-8 * radius})
            if dip.fun <= 0.0:
                return bracketed(residual, before, at_before, dip.x, dip.fun, 1e-12, 1e-15 * radius)
        if value <= 0.0 < at_above:
            return bracketed(residual, above, at_above, radius, value, 1e-12, 1e-15 * radius)
        before, at_before, above, at_above = above, at_above, radius, value
    return None


def touching_radius(body: Body, depth: float, edge: float) -> float:
    """Radius of the adhesionless elastic contact, ``G(a) = D``.

    Parameters
    ----------
    body : Body
    depth : float
        Penetration ``D``; no contact where it is not positive.
    edge : float
        Largest radius the indenter touches; infinite without one.

    Returns
    -------
    float
        At most ``edge``.
    """
    if depth <= 0.0:
        return 0.0
    low, high = 0.0, 1.0 if math.isinf(edge) else edge
    if math.isfinite(edge) and float(body.transform(np.array([edge]))[0]) <= depth:
        return edge

    def excess(radius: float) -> float:
        return float(body.transform(np.array([radius]))[0]) - depth

    while excess(high) < 0.0:
        low, high = high, 2.0 * high
    while high > 0.0 and excess(0.5 * high) > 0.0:
        high *= 0.5
        low = 0.5 * high
    return bracketed(excess, low, excess(low), high, excess(high), 0.0, 1e-16 * high)


def pressed_radius(body: Body, force: float, edge: float) -> float:
    """Radius of the adhesionless relaxed contact under a force, ``F = 2 E0* (a G(a) - int_0^a G)``.

    Parameters
    ----------
    body, edge
        As of :func:`touching_radius`.
    force : float
        Positive in compression; no contact where it is not positive.

    Returns
    -------
    float
        At most ``edge``.
    """
    if force <= 0.0:
        return 0.0

    def excess(radius: float) -> float:
        depth = float(body.transform(np.array([radius]))[0])
        return 2.0 * body.rheology.relaxed * (depth * radius - body.transform.integral(radius)) - force

    high = 1.0
    while excess(high) < 0.0:
        if high >= edge:
            return edge
        high *= 2.0
    while excess(0.5 * high) > 0.0:
        high *= 0.5
    return min(bracketed(excess, 0.5 * high, excess(0.5 * high), high, excess(high), 0.0, 1e-9 * high), edge)


def staged_radius(body: Body, modulus: float, stage: float, compliance: float, edge: float) -> float:
    """Radius of the adhesionless elastic contact under a stage, ``G(a) + F(a)/k = X``.

    Parameters
    ----------
    body : Body
    modulus : float
        Plane modulus.
    stage : float
        Its position, X.
    compliance : float
        ``1/k``.
    edge : float
        Radius of the indenter's edge.

    Returns
    -------
    float
    """
    if stage <= 0.0:
        return 0.0

    def excess(radius: float) -> float:
        depth = float(body.transform(np.array([radius]))[0])
        force = 2.0 * modulus * (depth * radius - body.transform.integral(radius))
        return depth + compliance * force - stage

    high = touching_radius(body, stage, edge)
    if excess(high) <= 0.0:
        return high
    return bracketed(excess, 0.0, excess(0.0), high, excess(high), 0.0, 1e-9 * high)


def elastic_surface(body: Body, depth: float, radius: float, glassy: bool) -> Surface:
    """Fields of the elastic contact of that radius.

    Parameters
    ----------
    body : Body
    depth : float
        Penetration.
    radius : float
        Contact radius.
    glassy : bool
        Glassy, otherwise fully relaxed.

    Returns
    -------
    Surface
    """
    inside = radius * _grid() if radius > 0.0 else np.zeros(1)
    count = len(body.rheology.times)
    branches = np.zeros((len(inside), count))
    if glassy:
        branches += (depth - body.transform(inside))[:, None] * body.rheology.moduli
    return Surface(depth, inside, branches, np.array([radius]), np.zeros((1, count)))


def _grid() -> Array:
    half = np.linspace(0.0, 1.0, NODES // 2 + 1)
    return np.concatenate((0.8 * half[:-1], 0.8 + 0.2 * half))
