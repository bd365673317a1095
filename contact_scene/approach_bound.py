"""How far an approach has to go at most until its force is reached, where the scene does not say.

With ``f = c r^p`` an adhesionless elastic contact of radius ``a`` reaches the depth and carries the force
(I.N. Sneddon, Int. J. Engng Sci. 3, 47 (1965))

    ``h(a) = kappa a^p``,  ``kappa = c sqrt(pi) Gamma(p/2 + 1)/Gamma((p + 1)/2)``,
    ``F(a) = 2 E* p/(p + 1) a h(a)``.

Let ``D = h(a)`` be deeper than all before.

1. Up to ``a`` the surface is pressed deeper than ever, so that every branch pushes as well: the force there
   is at least ``F(a)`` with the relaxed modulus ``E0*``.
2. Beyond ``a`` the contact pulls. It reaches ``b`` at most, where ``h(b) - D = u`` and ``u^2 = 2 pi (b + da)
   w/E0*``: no edge closes farther out than on the relaxed half-space, which resists least. ``da`` is the
   length of the process zone. As ``h`` is convex, ``b - a <= u/h'(a)``; ``u <= D`` makes ``b <= 2 a``, and
   ``da <= 2 a`` then ``u^2 <= 8 pi a w/E0*``. The pull is at most that of a glass,
   ``T = 2 Einf* u (b - a) <= 16 pi (Einf/E0) w a^2/(p D)``.

The force ``F*`` is reached where ``F(a) >= 2 F*`` and ``F(a) >= 2 T``, which gives the bound; the machine
adds ``F*/k`` to the way of the stage, or the force of the start if that is larger: no approach withdraws.

The retraction then loses contact for certain. A contact of radius ``a`` is lifted by ``u = h(a) - D``, and
the stress at its edge is at least that of the relaxed material: what the pressing left has relaxed for
longer than what the pulling adds. Its edge runs away where even a glass would not hold the stress, at ``E0*
u = sqrt(2 pi (a + da) w Einf*)`` at the latest. No contact has a larger radius than that of the approach,
``b <= 2 a`` as in 2, where ``h(a)`` is at least the depth, that of 2 with ``E0`` for ``Einf`` included. The
stage of a spring goes farther by the pull that it holds then, at most ``2 b sqrt(2 pi (b + da) w Einf*)``,
over ``k``. A work that grows with the speed of the edge has no such bound, nor has a measured profile:
there the retraction ends at ``-to``, and a run that is still in contact there says so.
"""

from __future__ import annotations

import math
from dataclasses import replace

from contact_scene.adhesion import Adhesion
from contact_scene.errors import SceneError
from contact_scene.indenter import Cone, FlatPunch, Indenter, PowerLaw, Sphere
from contact_scene.load_steps import Approach
from contact_scene.loading import Loading
from contact_scene.material import Material
from contact_scene.segment import Step
from contact_scene.value_checks import LARGEST, SMALLEST

A_BOUND = "a bound `to`: the greatest penetration, or position of the stage, of the approach"


def bounded_approaches(
    loading: Loading, material: Material, indenter: Indenter, adhesion: Adhesion | None
) -> Loading:
    """The loading with a bound in every approach that has none; ``adhesion`` with its zone at rest. A
    SceneError where no bound can be stated."""
    if not any(isinstance(step, Approach) for step in loading.steps):
        return loading
    steps: list[Step] = []
    farthest = loading.penetration
    for index, step in enumerate(loading.steps):
        key = f"loading.steps[{index}]"
        if isinstance(step, Approach) and step.to is None:
            if not math.isfinite(farthest):
                raise SceneError(f"{key}.to", "is missing after a step under a given force", A_BOUND)
            needed = _depth(step.force, key, material, indenter, adhesion)
            pressing = max(step.force, _start_force(loading, material, indenter, key))
            to = max(needed, farthest) + pressing * loading.compliance
            try:
                step = replace(step, to=to)
            except SceneError as error:
                raise error.under(key) from None
        if isinstance(step, Approach) and step.to is not None and step.away is None:
            holds = _holds_to(max(step.to, farthest), loading.compliance, material, indenter, adhesion)
            step = replace(step, away=-max(step.to, holds))
        farthest = _farthest(step, farthest)
        steps.append(step)
    return replace(loading, steps=tuple(steps))


def _farthest(step: Step, before: float) -> float:
    """Greatest penetration, or position of the stage, up to the end of a step; infinite if it is unknown.

    A stage on a spring may stand short of the indenter, where adhesion pulls it: at a depth, then, at which
    the force is below zero, which is less than that of any approach.
    """
    if isinstance(step, Approach) and step.to is not None and step.away is not None:
        return max(before, step.to, step.away)
    segment = step.segment(0.0, before, 0.0)
    if segment.control != "penetration":
        return math.inf
    return max(before, segment.value(segment.end), step.largest(segment))


def _start_force(loading: Loading, material: Material, indenter: Indenter, key: str) -> float:
    """More than the force of the start state, which puts the stage of a spring where it begins; 0 if none."""
    depth = loading.penetration
    if loading.compliance == 0.0 or loading.start_control == "stage" or depth <= 0.0:
        return 0.0
    if isinstance(indenter, FlatPunch):
        return 2.0 * material.glassy_plane_modulus * indenter.radius * depth
    exponent, coefficient = _power(indenter, key)
    radius = (depth / _transformed(exponent, coefficient)) ** (1.0 / exponent)
    return 2.0 * material.glassy_plane_modulus * exponent / (exponent + 1.0) * radius * depth


def _depth(
    force: float, key: str, material: Material, indenter: Indenter, adhesion: Adhesion | None
) -> float:
    """Penetration at which the force is reached for certain, if it is the largest so far."""
    work, zone = (adhesion.work, adhesion.zone) if adhesion is not None else (0.0, 0.0)
    if force <= 0.0 and work == 0.0:
        raise SceneError(f"{key}.force", f"got {force:g} without adhesion", f"a force > 0, or {A_BOUND}")
    if material.bulk is not None:
        raise SceneError(f"{key}.to", "is missing with a bulk that relaxes by itself", A_BOUND)
    stiffness, load = material.relaxed_plane_modulus, 2.0 * max(force, 0.0)
    if isinstance(indenter, FlatPunch):
        pull = math.sqrt(2.0 * math.pi * (indenter.radius + zone) * work / stiffness)
        return max(0.5 * load / (stiffness * indenter.radius), pull)
    exponent, coefficient = _power(indenter, key)
    kappa = _transformed(exponent, coefficient)
    glass = 2.0 * (material.glassy_modulus / material.modulus) * (exponent + 1.0) / exponent**2
    by_load = load * (exponent + 1.0) / (2.0 * stiffness * exponent)
    by_pull = 8.0 * math.pi * work / stiffness * max(1.0, glass)
    try:
        radius = max(
            (by_load / kappa) ** (1.0 / (exponent + 1.0)),
            (by_pull / kappa / kappa) ** (1.0 / (2.0 * exponent - 1.0)),
            0.5 * zone,
        )
        depth = float(kappa * radius**exponent)
    except ArithmeticError:
        depth = math.inf
    if not SMALLEST <= depth <= LARGEST:
        raise SceneError(f"{key}.to", f"is missing, and {depth:.3g} would be out of range", A_BOUND)
    return depth


def _holds_to(
    depth: float, compliance: float, material: Material, indenter: Indenter, adhesion: Adhesion | None
) -> float:
    """Height at which no contact is left that was as deep as ``depth``; 0 where there is no bound.

    Of a spring that of its stage.
    """
    if adhesion is None or adhesion.rate is not None:
        return 0.0
    work, zone, soft = adhesion.work, adhesion.zone, material.relaxed_plane_modulus
    try:
        if isinstance(indenter, FlatPunch):
            radius = indenter.radius
        else:
            exponent, coefficient = _power(indenter, "")
            kappa = _transformed(exponent, coefficient)
            by_depth = (depth / kappa) ** (1.0 / exponent)
            by_pull = (8.0 * math.pi * work / soft / kappa / kappa) ** (1.0 / (2.0 * exponent - 1.0))
            radius = 2.0 * max(by_depth, 2.0 * by_pull, 0.5 * zone)
        strength = math.sqrt(2.0 * math.pi * (radius + zone) * work * material.glassy_plane_modulus)
    except (ArithmeticError, SceneError):
        return 0.0
    height = strength * (1.0 / soft + 2.0 * radius * compliance)
    return height if height <= LARGEST else 0.0


def _transformed(exponent: float, coefficient: float) -> float:
    """``kappa`` of ``h = kappa a^p``."""
    ratio = math.sqrt(math.pi) * math.gamma(0.5 * exponent + 1.0) / math.gamma(0.5 * exponent + 0.5)
    return coefficient * ratio


def _power(indenter: Indenter, key: str) -> tuple[float, float]:
    """Exponent and coefficient of ``f = c r^p``."""
    match indenter:
        case Sphere(radius=radius):
            return 2.0, 0.5 / radius
        case Cone(cotangent=slope):
            return 1.0, slope
        case PowerLaw(exponent=exponent, coefficient=coefficient):
            return exponent, coefficient
    raise SceneError(f"{key}.to", f'is missing with shape = "{indenter.shape}"', A_BOUND)
