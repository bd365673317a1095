"""Codes whose attraction has a finite range: length of their zone, and convergence to the Griffith limit.

A cohesive law (Dugdale, Lennard-Jones) has no Griffith zone, so at a given range its answer is that of
another model. What can be asked of it is that its answers tend to those of the scene with a vanishing zone
as the range goes to zero. An answer states Maugis' transition parameter (D. Maugis, J. Colloid Interface
Sci. 150, 243, 1992),

    lambda = 2 s0/(pi dg K^2/R)^(1/3),   K = 4 E*/3;

at a crack tip of energy release rate ``K_I^2/(2 E*) = dg`` a constant stress ``s0`` acts over the length
(D.S. Dugdale, J. Mech. Phys. Solids 8, 100, 1960; small-scale limit of its equations)

    d = (pi/8) (K_I/s0)^2 = pi E* dg/(4 s0^2) = pi (16 pi/9)^(-2/3) lambda^-2 (dg R^2/E*)^(1/3).

That is the length which stands for the process zone. Of a Lennard-Jones law ``lambda`` is 1.1570 times
Tabor's parameter. The track is held on elastic spheres: under relaxation the zone sets the speed scale, and
there is no limit.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Protocol

import numpy as np

from contact_scene import Adhesion, Sphere
from validation.cases import Case
from validation.exam.answer import Answer
from validation.exam.grading import COARSEST, grade
from validation.execution.runs import run
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


class _Graded(Protocol):
    @property
    def answer(self) -> Answer: ...


@dataclass(frozen=True)
class RangeError:
    """An answer of a code with a finite range against the Griffith limit.

    Parameters
    ----------
    transition, zone : float
        Maugis' parameter, and the length it stands for.
    error : float
        Signed, relative, of ``SEEN_IN``.
    """

    transition: float
    zone: float
    error: float


@dataclass(frozen=True)
class GriffithTrack:
    """Answers of one code over the range of its attraction, the longest first.

    Parameters
    ----------
    points : tuple of RangeError
        Empty of a code without a zone.
    order : float
        Fitted exponent of the error over the zone.
    remaining : float
        Relative error that is left where the zone is extrapolated to zero.
    decade : int
        Of a code without a zone: that of its whole answer at the Griffith limit.
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
        sizes = [abs(point.error) for point in self.points]
        falling = all(after < before for before, after in pairwise(sizes))
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
    """Length of the zone that Maugis' transition parameter stands for (see the head of this module).

    Parameters
    ----------
    transition : float
    radius, plane_modulus, work : float
        Of the sphere, of the half-space, and of adhesion, in units of the scene.

    Returns
    -------
    float
        Length.
    """
    unit = np.cbrt(work * radius**2 / plane_modulus)
    return float(np.pi * (16.0 * np.pi / 9.0) ** (-2.0 / 3.0) / transition**2 * unit)


def tracks(graded: Sequence[_Graded], case: Case) -> GriffithTrack | None:
    """The track of a code on a scene; ``None`` where it states too few transition parameters for one."""
    scene, by_transition = case.scene, {}
    for one in graded:
        if one.answer.header.transition is not None and not one.answer.problem:
            by_transition[one.answer.header.transition] = one.answer
    sphere, adhesion = scene.indenter, scene.adhesion
    few = len(by_transition) < FEWEST and np.inf not in by_transition
    if few or not isinstance(sphere, Sphere) or not scene.material.is_elastic:
        return None
    if adhesion is None or not scene.is_adhesive or adhesion.rate is not None:
        return None
    if adhesion.work_closing is not None:
        return None
    zone = VANISHING * largest_contact_radius(scene)
    limit_case = replace(case, scene=replace(scene, adhesion=Adhesion(adhesion.work, zone)))
    limit = run(limit_case, REFERENCE, estimate=True)
    if limit.curves is None:
        return None
    if np.inf in by_transition:
        there = grade(by_transition[np.inf], limit_case.scene, limit)
        return GriffithTrack((), 0.0, 0.0, there.decade)
    points = []
    for transition in sorted(by_transition):
        found = grade(by_transition[transition], limit_case.scene, limit)
        error = next((one.error for one in found.differences if one.quantity == SEEN_IN), None)
        if error is not None and np.isfinite(error):
            size = zone_of(transition, sphere.radius, scene.material.relaxed_plane_modulus, adhesion.work)
            points.append(RangeError(transition, size, error))
    return None if len(points) < FEWEST else track_of(points)


def track_of(points: list[RangeError]) -> GriffithTrack:
    """Order by least squares of logarithms; what is left by extrapolation of the last two with it."""
    sizes = [max(abs(point.error), np.finfo(float).tiny) for point in points]
    zones = [point.zone for point in points]
    order = float(np.polyfit(np.log(zones), np.log(sizes), 1)[0])
    ratio = (zones[-2] / zones[-1]) ** order - 1.0
    before, last = points[-2].error, points[-1].error
    remaining = last - (before - last) / ratio if ratio > 0.0 else last
    return GriffithTrack(tuple(points), order, float(remaining))
