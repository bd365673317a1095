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

A layer takes the same bounds. Its Green's function has no time in it, so all is as above with a depth
``H(a)`` for ``h(a)`` and what it is stiffer by: a flat punch of radius ``a`` adds ``e(a) >= 1`` at its edge
where a half-space has 1. Contact of radius ``c`` at the depth ``D`` has ``e (D - H)`` at its edge, and its
force changes with ``c`` by ``2 E* e^2 (D - H) dc``. The relaxed edge closes at ``e (D - H) = -u``, so the
pull of a glass is at most ``2 Einf* u^2/H'(a)`` (of a cone ``H`` is concave, but then ``H - D`` is half as
large in the mean). At one depth a layer so pulls ``R_T`` times as much as the half-space, ``R_T`` being the
ratio of ``a/h'``, and presses ``R_F`` times as much: the bounds hold where ``2 R_F >= 1 + R_T``, and contact
is lost in time where ``e^2`` is at least the ratio of the radii. Up to 30 thicknesses that is so for every
exponent, base and Poisson's ratio: a test goes through them. Only the stage of a soft spring may go farther,
by the last term times the stiffness of the punch over ``2 E* a e``.
"""

from __future__ import annotations

import math
from dataclasses import replace

from contact_scene.adhesion import Adhesion
from contact_scene.errors import SceneError
from contact_scene.indenter import FlatPunch, Indenter
from contact_scene.loading import Approach, Loading, Step
from contact_scene.material import Material
from contact_scene.value_checks import LARGEST, SMALLEST

A_BOUND = "a bound `to`: the greatest penetration, or position of the stage, of the approach"


def bounded_approaches(
    loading: Loading, material: Material, indenter: Indenter, adhesion: Adhesion | None
) -> Loading:
    """The loading with a bound in every approach that has none; ``adhesion`` with its zone at rest. A
    SceneError where no bound can be stated."""
    if not any(isinstance(step, Approach) for step in loading.steps):
        return loading
    contact = _Contact(material, indenter, adhesion, loading.compliance)
    steps: list[Step] = []
    farthest = loading.penetration
    for index, step in enumerate(loading.steps):
        key = f"loading.steps[{index}]"
        if isinstance(step, Approach) and step.to is None:
            if not math.isfinite(farthest):
                raise SceneError(f"{key}.to", "is missing after a step under a given force", A_BOUND)
            needed = contact.depth(step.force, key)
            pressing = max(step.force, contact.start_force(loading))
            try:
                step = replace(step, to=max(needed, farthest) + pressing * loading.compliance)
            except SceneError as error:
                raise error.under(key) from None
        if isinstance(step, Approach) and (to := step.to) is not None:
            away = step.away
            if away is None:
                away = -max(to, contact.holds_to(max(to, farthest)))
                step = replace(step, away=away)
            farthest = max(farthest, to, away)
        else:
            farthest = _farthest(step, farthest)
        steps.append(step)
    return replace(loading, steps=tuple(steps))


def _farthest(step: Step, before: float) -> float:
    """Greatest penetration, or position of the stage, up to the end of a step; infinite if it is unknown.

    A stage on a spring may stand short of the indenter, where adhesion pulls it: at a depth, then, at which
    the force is below zero, which is less than that of any approach.
    """
    segment = step.segment(0.0, before, 0.0)
    if segment.control != "penetration":
        return math.inf
    return max(before, segment.value(segment.end), step.largest(segment))


class _Contact:
    """Sizes of contacts between an indenter ``f = c r^p``, or a flat one, and the half-space."""

    def __init__(
        self, material: Material, indenter: Indenter, adhesion: Adhesion | None, compliance: float
    ) -> None:
        self.material, self.indenter, self.adhesion = material, indenter, adhesion
        self.compliance = compliance
        self.soft, self.stiff = material.relaxed_plane_modulus, material.glassy_plane_modulus
        self.work, self.zone = (adhesion.work, adhesion.zone) if adhesion is not None else (0.0, 0.0)
        self.flat = indenter.radius if isinstance(indenter, FlatPunch) else None
        self.exponent, coefficient = indenter.power or (math.nan, math.nan)
        ratio = math.nan
        if indenter.power is not None:
            ratio = math.gamma(0.5 * self.exponent + 1.0) / math.gamma(0.5 * self.exponent + 0.5)
        self.kappa = coefficient * math.sqrt(math.pi) * ratio

    def radius_at(self, depth: float) -> float:
        """Radius of an adhesionless elastic contact, ``h(a) = depth``."""
        return self.flat or (depth / self.kappa) ** (1.0 / self.exponent)

    def radius_of_pull(self, square: float) -> float:
        """Radius at which ``kappa^2 a^(2 p - 1)`` is ``square``."""
        return (square / self.kappa / self.kappa) ** (1.0 / (2.0 * self.exponent - 1.0))

    def start_force(self, loading: Loading) -> float:
        """More than the force of the start state, which puts the stage of a spring where it begins, or 0."""
        depth = loading.penetration
        if self.compliance == 0.0 or loading.start_control == "stage" or depth <= 0.0:
            return 0.0
        shape = 1.0 if self.flat else self.exponent / (self.exponent + 1.0)
        return 2.0 * self.stiff * shape * self.radius_at(depth) * depth

    def depth(self, force: float, key: str) -> float:
        """Penetration at which the force is reached for certain, if it is the largest so far."""
        if force <= 0.0 and self.work == 0.0:
            raise SceneError(f"{key}.force", f"got {force:g} without adhesion", f"a force > 0, or {A_BOUND}")
        if self.material.bulk is not None:
            raise SceneError(f"{key}.to", "is missing with a bulk that relaxes by itself", A_BOUND)
        if self.flat is None and self.indenter.power is None:
            raise SceneError(f"{key}.to", f'is missing with shape = "{self.indenter.shape}"', A_BOUND)
        load, p = 2.0 * max(force, 0.0), self.exponent
        if self.flat is not None:
            pull = math.sqrt(2.0 * math.pi * (self.flat + self.zone) * self.work / self.soft)
            return max(0.5 * load / (self.soft * self.flat), pull)
        glass = 2.0 * (self.material.glassy_modulus / self.material.modulus) * (p + 1.0) / p**2
        try:
            by_load = load * (p + 1.0) / (2.0 * self.soft * p) / self.kappa
            by_pull = 8.0 * math.pi * self.work / self.soft * max(1.0, glass)
            radius = max(by_load ** (1.0 / (p + 1.0)), self.radius_of_pull(by_pull), 0.5 * self.zone)
            depth = float(self.kappa * radius**p)
        except ArithmeticError:
            depth = math.inf
        if not SMALLEST <= depth <= LARGEST:
            raise SceneError(f"{key}.to", f"is missing, and {depth:.3g} would be out of range", A_BOUND)
        return depth

    def holds_to(self, depth: float) -> float:
        """Height (of a spring: of its stage) at which no contact is left that was as deep as ``depth``; 0
        where there is no bound."""
        known = self.flat is not None or self.indenter.power is not None
        if not known or self.adhesion is None or self.adhesion.rate is not None:
            return 0.0
        try:
            radius = self.flat
            if radius is None:
                by_pull = self.radius_of_pull(8.0 * math.pi * self.work / self.soft)
                radius = 2.0 * max(self.radius_at(depth), 2.0 * by_pull, 0.5 * self.zone)
            strength = math.sqrt(2.0 * math.pi * (radius + self.zone) * self.work * self.stiff)
        except ArithmeticError:
            return 0.0
        height = strength * (1.0 / self.soft + 2.0 * radius * self.compliance)
        return height if height <= LARGEST else 0.0
