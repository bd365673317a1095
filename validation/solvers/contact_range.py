"""Range of the contact edge, which a finite-element mesh is fitted to before anything is solved.

A bound, not a solution: the largest contact is that of the fully relaxed elastic contact (soft modulus,
hence the largest area) at the largest penetration, or under the largest force, of the loading.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import lru_cache, partial

import numpy as np
from numpy.typing import ArrayLike, NDArray

from contact_scene import ForceRamp, Scene, SceneError, Step, TabulatedProfile
from validation.reference import sneddon
from validation.reference.elastic_layer import ElasticLayer

SPARE = 1.02
"""Factor on the largest contact radius of a sharp edge, which a finite process zone exceeds by less."""
DECADES = np.geomspace(1e-62, 1e62, 4961)
"""Radii between which the largest contact radius is searched, in any unit of length."""
SEARCHED = 33
"""Radii that an interval is divided by, as often as it takes: eight times from ``DECADES`` on."""
RADIUS_TOLERANCE = 1e-13
"""Error of a contact radius, relative: of the order of the rounding of the loads it is told by."""
LARGEST_FLOAT = float(np.finfo(float).max)
LAYER_RANGE = 1e-3, 32.0
"""Radii over the thickness of a layer from which on it is no half-space, and up to which one is searched."""
NODES = 36
"""Radii in that range at which the elastic layer is solved: neighbours are a factor of 1.35 apart."""
INTERPOLATED = 1e-4
"""Error of a radius between them, at most."""
TABLE_RANGE = 1e-9, 1e6
"""The radii searched for a tabulated profile, whose transform takes long, relative to its last one."""


def _finite(spare: NDArray[np.float64]) -> NDArray[np.float64]:
    """A load that is spare, where the resistance of a large contact leaves the range of floats."""
    return np.nan_to_num(spare, nan=-LARGEST_FLOAT, posinf=LARGEST_FLOAT, neginf=-LARGEST_FLOAT)


def _searched(scene: Scene) -> NDArray[np.float64]:
    """Radii between which a contact radius is searched."""
    least, most = 0.0, math.inf
    if isinstance(scene.indenter, TabulatedProfile):
        least, most = TABLE_RANGE[0] * scene.indenter.radii[-1], TABLE_RANGE[1] * scene.indenter.radii[-1]
    if scene.body is not None:
        most = min(most, LAYER_RANGE[1] * scene.body.thickness)
    return DECADES[(least < DECADES) & (most > DECADES)]


def _outermost(spare: Callable[[ArrayLike], NDArray[np.float64]], inner: float, outer: float) -> float:
    """The outermost radius between two, of which the inner has some to spare and the outer none."""
    while outer - inner > RADIUS_TOLERANCE * outer:
        radii = np.geomspace(inner, outer, SEARCHED)
        held = np.flatnonzero(spare(radii[1:-1]) > 0.0)
        last = int(held[-1]) + 1 if held.size else 0
        inner, outer = radii[last : last + 2]
    return float(outer)


@lru_cache(maxsize=64)
@np.errstate(all="ignore")
def _stiffening(layer: ElasticLayer) -> Callable[[ArrayLike], NDArray[np.float64]]:
    """Additions of a layer to the half-space over ``a/h``, of the logarithm of a radius.

    To stiffness and edge value of unit penetration, to force and edge value of the profile over its force:
    smooth, so that interpolation between ``NODES`` radii errs by less than ``INTERPOLATED``.
    """
    from scipy.interpolate import make_interp_spline  # a run on a half-space loads none of it

    radii, found = layer.layer.thickness * np.geomspace(*LAYER_RANGE, NODES), []
    for a in radii:
        at, depth = layer.response(float(a)), sneddon.depth(layer.indenter, a)
        bare = depth - sneddon.force(layer.indenter, a, 1.0) / (2.0 * a)
        profile = (at.profile_force / (2.0 * a) - bare) / bare, (at.profile_edge - depth) / bare
        found.append((at.stiffness / (2.0 * a) - 1.0, at.edge - 1.0, *profile))
    shares = np.nan_to_num(found, posinf=0.0, neginf=0.0) * (layer.layer.thickness / radii)[:, None]
    return make_interp_spline(np.log(radii), shares, k=5)


def _sharp(
    scene: Scene, stiffness: float, work: float, a: NDArray[np.float64], reach: float = 0.0
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Penetration and force of an elastic contact of radius ``a`` with a sharp edge, or a longer reach."""
    pull, punch = np.sqrt(2.0 * np.pi * (a + reach) * work / stiffness), 2.0 * stiffness * a
    profile, borne = sneddon.depth(scene.indenter, a), sneddon.force(scene.indenter, a, stiffness)
    depth, force = profile - pull, borne - punch * pull
    if scene.body is not None:
        ratio = a / scene.body.thickness
        on = (ratio > LAYER_RANGE[0]) & (ratio < LAYER_RANGE[1])
        layer = ElasticLayer(scene.body, scene.material.poisson, scene.indenter)
        if on.all() and a.size == 1:  # one radius is solved, many are interpolated
            found = layer.response(float(a[0]))
            depth[0] = found.penetration(float(pull[0]))
            force[0] = stiffness * found.force(float(depth[0]))
            return depth, force
        stiffer, edge, mean, end = _stiffening(layer)(np.log(a[on])).T * ratio[on]
        bare = (profile - borne / punch)[on]
        depth[on] = (depth[on] + end * bare) / (1.0 + edge)
        force[on] = punch[on] * ((1.0 + stiffer) * depth[on] - (1.0 + mean) * bare)
    return depth, force


def _solved(scene: Scene, spare: Callable[[ArrayLike], NDArray[np.float64]], radius: float) -> float:
    """The root next to one that was found between interpolated values."""
    if scene.body is None or radius < LAYER_RANGE[0] * scene.body.thickness:
        return radius
    from scipy.optimize import newton  # a run on a half-space loads none of it

    ends = radius, radius * (1.0 + INTERPOLATED)
    return float(newton(lambda a: float(spare([a])[0]), ends[0], x1=ends[1], tol=RADIUS_TOLERANCE * radius))


@lru_cache(maxsize=64)
@np.errstate(over="ignore", invalid="ignore", under="ignore")
def largest_contact_radius(scene: Scene) -> float:
    """Upper estimate of the contact radius over the whole loading; at most the largest that is searched."""
    if math.isfinite(scene.indenter.edge):
        return scene.indenter.edge
    deepest, strongest, farthest = _largest_load(scene)
    compliance, stiffness = scene.loading.compliance, scene.material.relaxed_plane_modulus
    work, zone = (scene.adhesion.work, scene.adhesion.zone) if scene.adhesion is not None else (0.0, 0.0)

    def spare_load(radius: ArrayLike, reach: float = 0.0) -> NDArray[np.float64]:
        """Positive where the load would hold a larger contact."""
        a = np.asarray(radius, float)
        depth, force = _sharp(scene, stiffness, work, a, reach)
        loads = np.fmax(deepest - depth, (strongest - force) / (2.0 * stiffness * a))
        if farthest > -math.inf:
            spare = farthest - (depth + compliance * force)
            loads = np.fmax(loads, spare / (1.0 + 2.0 * compliance * stiffness * a))
        return _finite(loads)

    radii = _searched(scene)
    for reach in (0.0, zone):  # a process zone may hold a contact that a sharp edge does not
        held = np.flatnonzero(spare_load(radii, reach) > 0.0)
        if held.size and held[-1] + 1 == radii.size:
            return SPARE * float(radii[-1])
        if held.size:
            spare = partial(spare_load, reach=reach)
            return SPARE * _solved(scene, spare, _outermost(spare, *radii[held[-1] : held[-1] + 2]))
    raise SceneError("loading", "never brings a contact about", "a penetration or force that touches")


@np.errstate(over="ignore", invalid="ignore", under="ignore", divide="ignore")
def contact_bounds(scene: Scene) -> tuple[float, float] | None:
    """Radii between which the largest one lies, where no search is needed: of a power that is pressed in.

    ``c a^n - sqrt(2 pi (a + zone) w/E)`` is convex: where it is more than the penetration it stays so.
    """
    shape, (deepest, strongest, farthest) = sneddon.transform(scene.indenter), _largest_load(scene)
    driven = max(strongest, farthest) == -math.inf and deepest > 0.0
    if not driven or scene.body is not None or not isinstance(shape, sneddon.PowerTransform):
        return None
    least = most = (np.float64(deepest) / shape.coefficient) ** (1.0 / shape.exponent)
    if not 0.0 < least < math.inf:
        return None
    work, zone = (scene.adhesion.work, scene.adhesion.zone) if scene.adhesion is not None else (0.0, 0.0)
    pull = 2.0 * np.pi * work / np.float64(scene.material.relaxed_plane_modulus)
    while shape.coefficient * most**shape.exponent - np.sqrt(pull * (most + zone)) <= deepest:
        most *= 2.0
    return float(least), SPARE * float(most)


@lru_cache(maxsize=64)
@np.errstate(over="ignore", invalid="ignore", under="ignore")
def start_radius(scene: Scene) -> float:
    """Contact radius of the start state, by the modulus with which it starts; 0 without contact.

    That of a sharp edge: the outermost radius at which the penetration is that of the start and rises; at
    most the largest that is searched.
    """
    if math.isfinite(scene.indenter.edge):
        return scene.indenter.edge
    loading, material = scene.loading, scene.material
    work = scene.adhesion.closing if scene.adhesion is not None else 0.0
    relaxed = loading.start == "relaxed"
    stiffness = material.relaxed_plane_modulus if relaxed else material.glassy_plane_modulus
    compliance = loading.compliance if loading.start_control == "stage" else 0.0

    def missing(radius: ArrayLike) -> NDArray[np.float64]:
        """How much less than that of the start the penetration is."""
        depth, force = _sharp(scene, stiffness, work, np.asarray(radius, float))
        return _finite(loading.penetration - (depth + compliance * force if compliance > 0.0 else depth))

    radii = _searched(scene)
    below = np.flatnonzero(missing(radii) >= 0.0)
    if below.size == 0:
        return 0.0
    if below[-1] + 1 == radii.size:
        return float(radii[-1])
    return _solved(scene, missing, _outermost(missing, *radii[below[-1] : below[-1] + 2]))


@np.errstate(over="ignore", invalid="ignore", under="ignore")
def largest_penetration(scene: Scene) -> float:
    """Upper estimate of the penetration over the whole loading."""
    deepest, strongest, farthest = _largest_load(scene)
    return max(deepest, farthest, _deepest_under(scene, strongest) if strongest > -math.inf else deepest)


def _largest_load(scene: Scene) -> tuple[float, float, float]:
    """Largest penetration, force and position of the stage of the loading; minus infinity without.

    A force ramp takes over the force it finds: at most the glassy one at the penetration reached, the relaxed
    one at a relaxed start. After a force the indenter is no deeper than where the relaxed contact bears it. A
    stage starts no farther than where that contact puts it. A smooth table has its extrema in its rows. A
    ramp that waits for a force below that from which it presses goes to its end.
    """
    depth, force, before = scene.loading.penetration, 0.0, "start"
    deepest, strongest, farthest = depth, -math.inf, -math.inf
    if scene.loading.start_control == "stage":
        deepest, farthest = -math.inf, depth
    compliance = scene.loading.compliance
    told = _pressing(scene, depth, scene.loading.start == "relaxed")  # the force, where it is known; or more
    if compliance > 0.0 and scene.loading.start_control != "stage":
        force = told

    def state(step: Step) -> tuple[float, float]:
        if isinstance(step, ForceRamp) and before != "force":
            return depth, _pressing(scene, depth, before == "start" and scene.loading.start == "relaxed")
        return depth, force

    for step, segment in scene.loading.segments(state, own_time=True):  # when a level is reached is not known
        values = [segment.value(at) for at in (segment.start, *segment.kinks, segment.end)]
        largest = max(*values, step.largest(segment))
        before, trigger = segment.control, segment.trigger
        if segment.control == "force":
            force, depth = values[-1], _deepest_under(scene, largest)
            strongest, told = max(strongest, largest), force
            continue
        awaited = trigger.level if trigger is not None and trigger.quantity == "force" else math.nan
        if awaited >= told and values[0] < largest:
            force = told = awaited  # which is reached before the end of the ramp
            strongest, depth = max(strongest, force), max(depth, _deepest_under(scene, force))
            continue
        told = -math.inf
        if segment.control == "stage":
            farthest = max(farthest, largest)
            force = (values[-1] - depth) / compliance
        else:
            depth = values[-1]
            deepest = max(deepest, largest)
    return deepest, strongest, farthest


def _deepest_under(scene: Scene, force: float) -> float:
    """More than the penetration of the relaxed contact with a sharp edge under a force."""
    radii, stiffness = _searched(scene), scene.material.relaxed_plane_modulus
    work = scene.adhesion.work if scene.adhesion is not None else 0.0
    held = np.flatnonzero(_sharp(scene, stiffness, work, radii)[1] <= force)
    if not held.size:
        return 0.0
    beyond = radii[min(held[-1] + 1, radii.size - 1)]
    return float(_sharp(scene, stiffness, 0.0, np.array([beyond]))[0][0])


def _pressing(scene: Scene, depth: float, relaxed: bool) -> float:
    """Adhesionless force at a penetration."""
    if depth <= 0.0:
        return 0.0
    material = scene.material
    modulus = material.relaxed_plane_modulus if relaxed else material.glassy_plane_modulus
    if scene.body is None:
        return float(sneddon.force(scene.indenter, sneddon.contact_radius(scene.indenter, depth), modulus))
    radii = _searched(scene)
    depths, forces = _sharp(scene, modulus, 0.0, radii)
    return float(forces[min(int(np.searchsorted(depths, depth)), radii.size - 1)])
