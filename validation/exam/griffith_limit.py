"""Codes whose attraction has a finite range: length of their zone, and convergence to the Griffith limit.

A cohesive law (Dugdale, Lennard-Jones) has no Griffith zone, so at a given range its answer is that of
another model. What can be asked of it is that its answers tend to those of the scene with a vanishing zone
as the range goes to zero. An answer states Maugis' transition parameter (D. Maugis, J. Colloid Interface
Sci. 150, 243, 1992),

    lambda = 2 s0/(pi dg K^2/R)^(1/3),   K = 4 E*/3;

at a crack tip of energy release rate ``K_I^2/(2 E*) = dg`` a constant stress ``s0`` acts over the length
(D.S. Dugdale, J. Mech. Phys. Solids 8, 100, 1960; small-scale limit of its equations)

    d = (pi/8) (K_I/s0)^2 = pi E* dg/(4 s0^2) = pi (16 pi/9)^(-2/3) lambda^-2 (dg R^2/E*)^(1/3).

That is the length which stands for the process zone. The track is held on elastic spheres: under relaxation
the zone sets the speed scale, and there is no limit.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from contact_scene import Adhesion, Sphere
from validation.cases import Case
from validation.exam.answer import Answer
from validation.exam.grading import COARSEST, grade
from validation.runs.run import run
from validation.solvers import REFERENCE
from validation.solvers.contact_range import largest_contact_radius

VANISHING = 1e-5
"""Zone over contact radius of the limit: its error, of first order in it, is below any decade graded."""
FEWEST = 3
"""Answers from which an order can be seen."""
LEAST_ORDER = 0.5
"""Least fitted exponent of the error over the zone: theory gives 1, and terms of higher order add to it."""
SEEN_IN = "pull_off_force"
"""Quantity whose error is followed."""


@dataclass(frozen=True)
class RangeError:
    """Signed relative error of ``SEEN_IN`` at a transition parameter, which stands for a zone."""

    transition: float
    zone: float
    error: float


@dataclass(frozen=True)
class GriffithTrack:
    """Answers of one code over the range of its attraction, the longest first.

    ``order`` is the fitted exponent of the error over the zone, ``remaining`` the error that is left where
    the zone is extrapolated to zero. A code without a zone has no points, and the ``decade`` of its whole
    answer at the Griffith limit.
    """

    points: tuple[RangeError, ...]
    order: float
    remaining: float
    decade: int = 0

    @property
    def converges(self) -> bool:
        """Whether the errors fall with the range, to nothing as far as can be seen."""
        if not self.points:
            return self.decade >= COARSEST
        falling = all(abs(after.error) < abs(before.error) for before, after in pairwise(self.points))
        return falling and self.order >= LEAST_ORDER and abs(self.remaining) <= 10.0**-COARSEST

    @property
    def in_words(self) -> str:
        """One line."""
        if not self.points:
            return f"an edge without a zone: at the Griffith limit good to 1e-{self.decade}"
        first, last = self.points[0], self.points[-1]
        return (
            f"against the Griffith limit {SEEN_IN.replace('_', ' ')} is off by {abs(first.error):.2g} at "
            f"transition {first.transition:g}, {abs(last.error):.2g} at {last.transition:g}: as zone^"
            f"{self.order:.2f}, {abs(self.remaining):.1e} left at zero"
        )


def zone_of(transition: float, radius: float, plane_modulus: float, work: float) -> float:
    """Length of the zone that Maugis' transition parameter stands for (see the head of this module)."""
    unit = np.cbrt(work * radius**2 / plane_modulus)
    return float(np.pi * (16.0 * np.pi / 9.0) ** (-2.0 / 3.0) / transition**2 * unit)


def tracks(answers: Iterable[Answer], case: Case) -> GriffithTrack | None:
    """The track of a code on a scene; ``None`` where it states too few transition parameters for one."""
    scene, sphere, adhesion = case.scene, case.scene.indenter, case.scene.adhesion
    by_transition = {
        one.header.transition: one for one in answers if one.header.transition is not None and not one.problem
    }
    few = len(by_transition) < FEWEST and math.inf not in by_transition
    if few or not isinstance(sphere, Sphere) or not scene.material.is_elastic or not scene.is_adhesive:
        return None
    if adhesion is None or adhesion.rate is not None or adhesion.work_closing is not None:
        return None
    zone = VANISHING * largest_contact_radius(scene)
    at_limit = replace(scene, adhesion=Adhesion(adhesion.work, zone))
    limit = run(replace(case, scene=at_limit), REFERENCE, estimate=True)
    if limit.curves is None:
        return None
    if math.inf in by_transition:
        return GriffithTrack((), 0.0, 0.0, grade(by_transition[math.inf], at_limit, limit).decade)
    stated = sphere.radius, scene.material.relaxed_plane_modulus, adhesion.work
    points = []
    for transition in sorted(by_transition):
        found = grade(by_transition[transition], at_limit, limit).differences
        error = next((one.error for one in found if one.quantity == SEEN_IN), math.inf)
        if math.isfinite(error):
            points.append(RangeError(transition, zone_of(transition, *stated), error))
    return None if len(points) < FEWEST else track_of(points)


def track_of(points: list[RangeError]) -> GriffithTrack:
    """Order by least squares of logarithms; what is left by extrapolation of the last two with it."""
    sizes = [max(abs(point.error), np.finfo(float).tiny) for point in points]
    order = float(np.polyfit(np.log([point.zone for point in points]), np.log(sizes), 1)[0])
    before, last = points[-2:]
    ratio = (before.zone / last.zone) ** order - 1.0
    remaining = last.error - (before.error - last.error) / ratio if ratio > 0.0 else last.error
    return GriffithTrack(tuple(points), order, float(remaining))
