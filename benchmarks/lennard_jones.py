r"""Sphere pulled off a viscoelastic half-space by Lennard-Jones tractions: no contact edge, no process zone.

Surfaces at the gap ``h`` press each other by

    ``p(h) = (8 w/3 eps) [(eps/h)^9 - (eps/h)^3]``,

zero at ``h = eps``, with the largest tension ``s = 16 w/(9 sqrt(3) eps)`` and the work ``w``. The gap
between the paraboloid at the penetration ``D`` and the half-space is ``h = eps + r^2/(2 R) - D + u``, and
``u`` follows from the history of ``p`` by the creep compliance. Elastic: V.M. Muller, V.S. Yushchenko,
B.V. Derjaguin, J. Colloid Interface Sci. 77, 91 (1980); J.A. Greenwood, Proc. R. Soc. A 453, 1277 (1997).
Tabor's parameter is ``(R w^2/E0*^2)^(1/3)/eps``.

Annuli of constant pressure; the displacement under a disc of pressure is that of K.L. Johnson, Contact
Mechanics (1985), Sec. 3.4. Pressures are linear in time over a step, gaps are found by Newton's method.
Nothing is shared with the three solvers.

``python -m benchmarks.lennard_jones`` withdraws a sphere from rest on a standard linear solid by these
tractions, by the reference with ``stress = s``, and by it with a zone of the fixed length it has at rest: the
pull-off forces over speed. The process zone is a model of the traction: the differences are of the models.
"""

from __future__ import annotations

import argparse
import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import solve
from scipy.optimize import brentq
from scipy.special import ellipe, ellipk

from contact_scene import Adhesion, Branch, Loading, Material, Ramp, Scene, Sphere
from validation.reference.creep_compliance import creep_compliance
from validation.solvers import REFERENCE, SOLVERS

Array = NDArray[np.float64]

ACCURACY = 1e-9
"""Residual of a gap, in ``eps``."""
LARGEST_CHANGE = 0.3
"""Of a gap in one iteration, relative to it."""
FIRST_ITERATIONS, ITERATIONS = 200, 12
"""Newton's iterations for the start state, and for a step before it is halved."""
FORCE_STEP = 0.03
"""Largest change of the force in one step, in largest forces so far: 1e-3 of the pull-off force."""
GROWTH = 1.3
"""Ratio of successive steps where Newton's method needs less than five iterations."""
FIRST_STEP, LONGEST_STEP, LEAST_STEP = 0.015, 0.03, 3e-6
"""Steps of the penetration, in start penetrations; below the last the contact has snapped off."""
LOST = 0.3
"""Tension, in largest tensions, below which the run ends: the pull-off is behind."""


@dataclass(frozen=True)
class PullOff:
    """Largest tension (positive), and the penetration at which it acts."""

    force: float
    penetration: float


@dataclass(frozen=True)
class LennardJonesSphere:
    """Sphere on a viscoelastic half-space; ``distance`` is ``eps``, the gap at rest."""

    material: Material
    radius: float
    work: float
    distance: float

    @property
    def stress(self) -> float:
        """Largest tension of the law."""
        return 16.0 * self.work / (9.0 * math.sqrt(3.0) * self.distance)

    @property
    def zone_at_rest(self) -> float:
        """Width of a Dugdale zone of that stress at rest."""
        return math.pi * self.material.relaxed_plane_modulus * self.work / (4.0 * self.stress**2)

    def pull_off(self, penetration: float, speed: float, divisions: int = 4) -> PullOff:
        """Withdrawn from the relaxed state at a penetration > 0, by some annuli in a zone at rest."""
        radius = self._sharp_radius(penetration)
        annuli = UniformRings(self._borders(radius, divisions))
        run = _Retraction(self, annuli, penetration, speed)
        run.start(radius)
        while run.goes_on():
            run.step()
        least = int(np.argmin(run.forces))
        return PullOff(-run.forces[least], run.depths[least])

    def pressure(self, gap: Array) -> tuple[Array, Array]:
        """``p(h)`` and its derivative, at gaps of shape (n,)."""
        ratio, unit = self.distance / gap, 8.0 * self.work / (3.0 * self.distance)
        return unit * (ratio**9 - ratio**3), unit * (3.0 * ratio**3 - 9.0 * ratio**9) / gap

    def _sharp_radius(self, penetration: float) -> float:
        """Contact radius of Johnson, Kendall and Roberts at a penetration."""
        modulus = self.material.relaxed_plane_modulus

        def excess(a: float) -> float:
            return a * a / self.radius - math.sqrt(2.0 * math.pi * a * self.work / modulus) - penetration

        least = math.sqrt(self.radius * penetration)
        largest = 4.0 * (least + math.cbrt(self.work * self.radius**2 / modulus))
        return float(brentq(excess, least, largest))

    def _borders(self, contact: float, divisions: int) -> Array:
        """Annuli as fine as the zone wherever the edge may be, coarser about the axis and far outside."""
        modulus = self.material.relaxed_plane_modulus
        inner = 0.3 * math.cbrt(4.5 * math.pi * self.work * self.radius**2 / modulus)
        fine = self.zone_at_rest / divisions
        outer = 1.02 * contact + 4.0 * self.zone_at_rest
        about = np.linspace(0.0, inner, max(10, int(inner / (6.0 * fine))), endpoint=False)
        between = np.linspace(inner, outer, int((outer - inner) / fine) + 1)
        count = math.ceil(math.log1p(1.2 * outer / fine * 0.15) / math.log(1.15))
        beyond = outer + np.cumsum(fine * 1.15 ** np.arange(1, count + 1))
        return np.concatenate((about, between, beyond))


class UniformRings:
    """Annuli of constant pressure: middle radii, areas, and displacement there at ``E* = 1``."""

    def __init__(self, borders: Array) -> None:
        self.radii = 0.5 * (borders[1:] + borders[:-1])
        self.areas = np.pi * np.diff(borders**2)
        discs = _under_discs(self.radii, borders[1:])
        self.influence = np.diff(discs, axis=1, prepend=0.0)


def _under_discs(radii: Array, discs: Array) -> Array:
    """Displacement at radii (n,) under unit pressure on discs (m,), at ``E* = 1``: shape (n, m)."""
    r, b = radii[:, None], discs[None, :]
    inside = r < b
    near = np.where(inside, (r / b) ** 2, 0.0)
    far = np.where(inside, 0.0, (b / r) ** 2)
    outer = r * (ellipe(far) - (1.0 - far) * ellipk(far))
    return 4.0 / np.pi * np.where(inside, b * ellipe(near), outer)


class _Retraction:
    """A withdrawal in progress: gaps, pressures, creep strains of the branches, forces and penetrations."""

    def __init__(
        self, law: LennardJonesSphere, annuli: UniformRings, penetration: float, speed: float
    ) -> None:
        self.law, self.annuli, self.speed = law, annuli, speed
        plane = 1.0 - law.material.poisson**2
        creep = creep_compliance(law.material)
        self.glassy = plane * creep.glassy
        self.compliances, self.times = plane * creep.compliances, creep.times
        self.first = penetration
        self.next = FIRST_STEP * penetration
        self.forces: list[float] = []
        self.depths: list[float] = [penetration]

    def start(self, contact: float) -> None:
        """The relaxed state, from the gaps outside a contact of that radius under a rigid punch."""
        r, law = self.annuli.radii, self.law
        outside = np.arcsin(np.minimum(1.0, contact / r))
        sunk = 2.0 / np.pi * self.first * outside - self.first
        gap = law.distance + np.where(r < contact, 0.0, np.maximum(0.5 * r**2 / law.radius + sunk, 0.0))
        relaxed = self.glassy + float(self.compliances.sum())
        found = self._gaps(gap, self._apart(self.first), relaxed, FIRST_ITERATIONS)
        if found is None:
            raise ArithmeticError("Newton's method finds no start state")
        self.gap, self.pressure, _ = found
        self.strains = self.compliances[:, None] * self.pressure
        self.forces.append(float(self.pressure @ self.annuli.areas))

    def goes_on(self) -> bool:
        """Whether the pull-off may still be ahead."""
        tension = -min(self.forces)
        lost = tension > 0.0 and -self.forces[-1] < LOST * tension and self.forces[-1] < 0.0
        past = self.depths[-1] < self.depths[int(np.argmin(self.forces))]
        return self.next > LEAST_STEP * self.first and not (lost and past)

    def step(self) -> None:
        """One step of the penetration; half of it next time if it fails or the force changes too much."""
        y = self.next / self.speed / self.times
        decay, mean = np.exp(-y), -np.expm1(-y) / y
        own = self.compliances * (1.0 - mean)
        known = (self.strains * decay[:, None]).sum(axis=0)
        known = known + float((self.compliances * (mean - decay)).sum()) * self.pressure
        depth = self.depths[-1] - self.next
        apart = self._apart(depth) + self.annuli.influence @ known
        found = self._gaps(self.gap, apart, self.glassy + float(own.sum()), ITERATIONS)
        if found is None:
            self.next *= 0.5
            return
        gap, pressure, iterations = found
        force = float(pressure @ self.annuli.areas)
        coarse = abs(force - self.forces[-1]) > FORCE_STEP * max(map(abs, self.forces))
        if coarse and self.next > 1e2 * LEAST_STEP * self.first:
            self.next *= 0.5
            return
        before = (self.compliances * (mean - decay))[:, None] * self.pressure
        self.strains = self.strains * decay[:, None] + before + own[:, None] * pressure
        self.gap, self.pressure = gap, pressure
        self.forces.append(force)
        self.depths.append(depth)
        if iterations < 5:
            self.next = min(GROWTH * self.next, LONGEST_STEP * self.first)

    def _apart(self, penetration: float) -> Array:
        """Gaps over an undeformed surface."""
        return self.law.distance + 0.5 * self.annuli.radii**2 / self.law.radius - penetration

    def _gaps(
        self, gap: Array, apart: Array, compliance: float, most: int
    ) -> tuple[Array, Array, int] | None:
        """Gaps ``h = apart + compliance K p(h)`` from a first guess, pressures and the count of iterations.

        ``apart`` are the gaps without the present pressure; ``None`` if there are too many iterations.
        """
        unit = np.eye(len(gap))
        for iteration in range(most):
            pressure, slope = self.law.pressure(gap)
            residual = gap - apart - compliance * (self.annuli.influence @ pressure)
            if np.abs(residual).max() < ACCURACY * self.law.distance:
                return gap, pressure, iteration
            change = solve(unit - compliance * self.annuli.influence * slope, -residual, overwrite_a=True)
            largest = float((np.abs(change) / gap).max())
            gap = gap + min(1.0, LARGEST_CHANGE / largest) * change
        return None


# Against process zones

WORK, DEPTH, RATIO = 5.026548e-4, 0.032, 10.0
"""Work of adhesion and start penetration of the paper's cycles; glassy over relaxed modulus."""
TABOR = (3.0, 5.0, 10.0)
SPEEDS = (6e-4, 2e-3, 6e-3, 2e-2, 6e-2, 0.2)
AWAY = -0.5
"""Penetration by which contact is lost at any speed."""


@dataclass(frozen=True)
class PullOffComparison:
    """Pull-off forces of one withdrawal by the three, in ``pi w R``."""

    lennard_jones: float
    fixed_stress: float
    fixed_length: float

    @property
    def differences(self) -> tuple[float, float]:
        """Of fixed stress and of fixed length, relative to Lennard-Jones."""
        return self.fixed_stress / self.lennard_jones - 1.0, self.fixed_length / self.lennard_jones - 1.0


def material(ratio: float = RATIO) -> Material:
    """``E0* = 1``, one branch of time 1; elastic where the ratio is 1."""
    return Material(0.75, 0.5, (Branch(0.75 * (ratio - 1.0), 1.0),) if ratio > 1.0 else ())


def compared(
    tabor: float, speed: float, ratio: float = RATIO, resolution: int | None = None, divisions: int = 4
) -> PullOffComparison:
    """One withdrawal at Tabor's parameter and a speed in radii per relaxation time."""
    law = LennardJonesSphere(material(ratio), 1.0, WORK, math.cbrt(WORK**2) / tabor)
    unit = math.pi * WORK

    def by_zone(adhesion: Adhesion) -> float:
        loading = Loading("relaxed", DEPTH, (Ramp(AWAY, speed),))
        scene = Scene(law.material, Sphere(1.0), loading, adhesion)
        return -float(SOLVERS[REFERENCE].solve(scene, resolution).force.min()) / unit

    return PullOffComparison(
        law.pull_off(DEPTH, speed, divisions).force / unit,
        by_zone(Adhesion(WORK, stress=law.stress)),
        by_zone(Adhesion(WORK, law.zone_at_rest)),
    )


def main(arguments: Sequence[str] | None = None) -> None:
    """Print a row for each withdrawal, and the mean size of the differences with its deviation."""
    parser = argparse.ArgumentParser(description="fixed cohesive stress against Lennard-Jones tractions")
    parser.add_argument("--tabor", type=float, nargs="+", default=TABOR)
    parser.add_argument("--speed", type=float, nargs="+", default=SPEEDS, help="radii per relaxation time")
    parser.add_argument("--ratio", type=float, default=RATIO, help="glassy over relaxed modulus; 1: elastic")
    parser.add_argument("--resolution", type=int, help="of the reference")
    chosen = parser.parse_args(arguments)
    print("| Tabor | speed | Lennard-Jones | fixed stress | | fixed length | |\n" + "|---" * 7 + "|")
    found = []
    for tabor, speed in product(chosen.tabor, chosen.speed):
        row = compared(tabor, speed, chosen.ratio, chosen.resolution)
        stress, length = row.differences
        found.append((abs(stress), abs(length)))
        print(
            f"| {tabor:g} | {speed:g} | {row.lennard_jones:.3f} | {row.fixed_stress:.3f} "
            f"| {100 * stress:+.1f} % | {row.fixed_length:.3f} | {100 * length:+.1f} % |",
            flush=True,
        )
    for kind, sizes in zip(("stress", "length"), 100.0 * np.array(found).T, strict=True):
        print(f"Mean difference, fixed {kind}: {sizes.mean():.0f} % (sd {sizes.std():.0f} %)")


if __name__ == "__main__":
    main()
