"""Check values of built-in scenes, computed anew from formulas written out here.

Nothing of a solver, of ``contact_scene`` or of the reference's closed forms is used, and the numbers of the
scenes are stated again: what is wrong in how a scene is read, or in a formula that all solvers share, does
not appear on both sides.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.integrate import quad
from scipy.linalg import expm
from scipy.optimize import brentq, minimize_scalar

from validation.scenes import checks

Function = Callable[[float], float]


def stated(scene: str, observable: str, at_time: float | None = None) -> float:
    """The one check value of a built-in scene for an observable that is no bound."""
    (found,) = {
        entry["value"]
        for entry in checks(scene)["checks"]
        if entry["observable"] == observable and entry.get("at_time") == at_time and "value" in entry
    }
    return found


class PronyElement:
    """``f(t) = E0 s(t) + sum_k q_k``, ``q_k' = E_k s' - q_k/tau_k``, under a given strain or a given force.

    Either is linear in time over a piece; the equations are then linear with constant coefficients, and the
    matrix exponential solves them.
    """

    def __init__(self, relaxed: float, branches: list[tuple[float, float]]) -> None:
        self.relaxed = relaxed
        self.moduli = np.array([modulus for modulus, _ in branches])
        self.times = np.array([time for _, time in branches])
        self.strain, self.loads, self.work = 0.0, np.zeros(len(branches)), 0.0

    @property
    def force(self) -> float:
        return self.relaxed * self.strain + float(self.loads.sum())

    @property
    def stored(self) -> float:
        return 0.5 * self.relaxed * self.strain**2 + 0.5 * float((self.loads**2 / self.moduli).sum())

    def strain_jumps(self, to: float) -> None:
        before, change = self.force, to - self.strain
        self.loads = self.loads + self.moduli * change
        self.strain = to
        self.work += 0.5 * (before + self.force) * change

    def force_jumps(self, to: float) -> None:
        self.strain_jumps(self.strain + (to - self.force) / (self.relaxed + self.moduli.sum()))

    def strained(self, rate: float, duration: float) -> None:
        self._advance(np.zeros_like(self.loads), rate, duration)

    def loaded(self, rate: float, duration: float) -> None:
        glassy = self.relaxed + self.moduli.sum()
        self._advance(1.0 / (self.times * glassy), rate / glassy, duration)

    def _advance(
        self, strain_rate_of_loads: NDArray[np.float64], strain_rate: float, duration: float
    ) -> None:
        count = len(self.loads)
        matrix = np.zeros((count + 2, count + 2))
        matrix[count, :count], matrix[count, count + 1] = strain_rate_of_loads, strain_rate
        matrix[:count] = np.outer(self.moduli, matrix[count])
        matrix[np.arange(count), np.arange(count)] -= 1.0 / self.times
        start = np.array([*self.loads, self.strain, 1.0])
        for begin, end in pairwise(duration * np.concatenate(([0.0], np.geomspace(1e-6, 1.0, 13)))):
            for place, weight in zip(*np.polynomial.legendre.leggauss(6), strict=True):
                state = expm(matrix * (begin + 0.5 * (end - begin) * (1.0 + place))) @ start
                force = self.relaxed * state[count] + state[:count].sum()
                self.work += 0.5 * (end - begin) * weight * force * float(matrix[count] @ state)
        state = expm(matrix * duration) @ start
        self.loads, self.strain = state[:count], float(state[count])


def close(value: float) -> object:
    """Check values have seven digits or more."""
    return pytest.approx(value, rel=2e-7, abs=0.0)


def test_punch_programme():
    radius, plane, swing, frequency, drift = 100.0, 1.0 / (1.0 - 0.3**2), 0.5, 2.5, -0.1
    element = PronyElement(
        0.5 * plane, [(1.0 * plane, 1e-4), (0.6 * plane, 1.0), (0.9 * plane, 1.1), (0.4 * plane, 30.0)]
    )
    stiffness, name = 2.0 * radius, "punch-programme"
    element.strain_jumps(1.0)
    element.work, stored = 0.0, element.stored
    assert stated(name, "start_force") == close(stiffness * element.force)
    for until, duration, rate in (
        (1.0, 1.0, 2.0),
        (3.0, 2.0, 0.0),
        (3.5, 0.5, -1.0),
        (4.5, 1.0, 1.5),
        (5.0, 0.5, 0.4),
    ):
        element.strained(rate, duration)
        assert stated(name, "force", until) == close(stiffness * element.force)

    def force(time: float) -> float:
        """During the oscillation: each branch by its complex modulus and what is left of its first load."""
        total = element.relaxed * (element.strain + swing * math.sin(frequency * time) - drift * time)
        for modulus, tau, load in zip(element.moduli, element.times, element.loads, strict=True):
            x, fading = frequency * tau, math.exp(-time / tau)
            wave = (math.cos(frequency * time) + x * math.sin(frequency * time) - fading) / (1.0 + x * x)
            total += load * fading + modulus * tau * (swing * frequency * wave - drift * (1.0 - fading))
        return stiffness * total

    assert stated(name, "approach_force") == close(force(3.0))

    def power(time: float) -> float:
        return force(time) * (swing * frequency * math.cos(frequency * time) - drift)

    loss = quad(power, 0.0, 2.0 * math.pi / frequency, epsabs=0.0, epsrel=1e-10)[0]
    assert stated(name, "peak_cycle_loss") == close(loss)

    element.work += quad(power, 0.0, 3.0, epsabs=0.0, epsrel=1e-10)[0] / stiffness
    fading = np.exp(-3.0 / element.times)
    x = frequency * element.times
    wave = (math.cos(3.0 * frequency) + x * math.sin(3.0 * frequency) - fading) / (1.0 + x * x)
    driven = element.moduli * element.times * (swing * frequency * wave - drift * (1.0 - fading))
    element.loads = element.loads * fading + driven
    element.strain += swing * math.sin(3.0 * frequency) - 3.0 * drift
    element.force_jumps(400.0 / stiffness)
    element.loaded(0.0, 2.0)
    assert stated(name, "penetration", 10.0) == close(element.strain)
    element.loaded(200.0 / stiffness, 3.0)
    assert stated(name, "final_penetration") == close(element.strain)
    assert stated(name, "loop_energy") == close(stiffness * element.work)
    lost = stiffness * (element.work - element.stored + stored)
    assert stated(name, "dissipated_energy") == stated(name, "branch_dissipation") == close(lost)


def test_cone_under_a_growing_force():
    """``(pi/2) cot(alpha) a^2`` is the strain of a Prony element that carries the force."""
    plane, cotangent = 1.0 / (1.0 - 0.5**2), 1.0 / math.tan(math.radians(60.0))
    element = PronyElement(0.75 * plane, [(2.25 * plane, 1e-5), (4.5 * plane, 1.0)])
    names = ("contact_radius", "penetration")
    for time, rate, duration in ((1.0, 0.2, 1.0), (6.0, 0.02, 5.0), (None, 0.0, 4.0)):
        element.loaded(rate, duration)
        radius = math.sqrt(2.0 * element.strain / (math.pi * cotangent))
        if time is None:
            names = ("final_radius", "final_penetration")
        assert stated("cone-force-ramp", names[0], time) == close(radius)
        assert stated("cone-force-ramp", names[1], time) == close(0.5 * math.pi * radius * cotangent)


@dataclass(frozen=True)
class ElasticContact:
    """An elastic half-space under any profile, with the closure of a finite zone, all by quadrature.

    ``profile`` is ``f(r)``; ``abel`` is ``G(x) = x int_0^x f'(r)/sqrt(x^2 - r^2) dr``, ``slope`` its
    derivative. Then ``q(x) = E* (D - G(x))``, ``F = 2 int_0^a q dx``, and stress and gap are the Abel
    transforms of ``q`` and of ``D - G``.
    """

    profile: Function
    abel: Function
    slope: Function
    modulus: float
    zone: float
    work: float

    def stress(self, a: float, depth: float, r: float) -> float:
        edge = self.modulus * (depth - self.abel(a)) / math.sqrt((a - r) * (a + r))
        inner = quad(lambda u: self.slope(r * math.cosh(u)), 0.0, math.acosh(a / r), epsrel=1e-11)[0]
        return -(edge + self.modulus * inner) / math.pi

    def gap(self, a: float, depth: float, r: float) -> float:
        inner = quad(lambda v: depth - self.abel(r * math.sin(v)), 0.0, math.asin(a / r), epsrel=1e-11)[0]
        return self.profile(r) - depth + 2.0 / math.pi * inner

    def closure(self, a: float, depth: float) -> float:
        """``(1/(2 da)) int sigma(r) g(r + da) dr`` with ``r = a - da sin^2(v)``: no roots are left."""

        def integrand(v: float) -> float:
            r = a - self.zone * math.sin(v) ** 2
            return self.stress(a, depth, r) * self.gap(a, depth, r + self.zone) * math.sin(2.0 * v)

        return 0.5 * quad(integrand, 1e-9, 0.5 * math.pi - 1e-9, epsrel=1e-8)[0]

    def at_radius(self, a: float) -> tuple[float, float]:
        """Penetration and force of the equilibrium."""
        pull = math.sqrt(2.0 * math.pi * a * self.work / self.modulus)
        stretch = brentq(
            lambda x: self.closure(a, self.abel(a) - x) / self.work - 1.0, 0.2 * pull, 3.0 * pull, rtol=1e-10
        )
        depth = self.abel(a) - float(stretch)
        return depth, 2.0 * self.modulus * (a * depth - quad(self.abel, 0.0, a)[0])

    def at_depth(self, depth: float, low: float, high: float) -> tuple[float, float]:
        """Radius, sought in an interval, and force."""
        a = float(brentq(lambda x: self.at_radius(x)[0] - depth, low, high, rtol=1e-9))
        return a, self.at_radius(a)[1]

    def least(self, index: int, low: float, high: float) -> tuple[float, float]:
        """Radius and value of the least penetration (0) or the least force (1)."""
        found = minimize_scalar(
            lambda x: self.at_radius(x)[index], bounds=(low, high), method="bounded", options={"xatol": 1e-7}
        )
        return float(found.x), float(found.fun)


def sphere(modulus: float, zone: float, work: float) -> ElasticContact:
    return ElasticContact(lambda r: 0.5 * r * r, lambda x: x * x, lambda x: 2.0 * x, modulus, zone, work)


def cone(half_angle: float, modulus: float, zone: float, work: float) -> ElasticContact:
    rise = 1.0 / math.tan(math.radians(half_angle))
    slope = 0.5 * math.pi * rise
    return ElasticContact(lambda r: rise * r, lambda x: slope * x, lambda x: slope, modulus, zone, work)


def polynomial(second: float, fourth: float, modulus: float, zone: float, work: float) -> ElasticContact:
    """``f = second r^2 + fourth r^4``."""
    return ElasticContact(
        lambda r: second * r**2 + fourth * r**4,
        lambda x: 2.0 * second * x**2 + 8.0 / 3.0 * fourth * x**4,
        lambda x: 4.0 * second * x + 32.0 / 3.0 * fourth * x**3,
        modulus, zone, work,
    )  # fmt: skip


JKR_WORK = 1.6e-4 * math.pi
FORCE = math.pi  # unit of the dimensionless force for R = E0* = 1
SHEAR, BULK = 10.0 * 0.75 / (2.0 * 1.3), 0.75 / (3.0 * (1.0 - 2.0 * 0.3))
STARTS = {
    "dwell-10": (sphere(10.0, 0.013, JKR_WORK), 0.0, (0.04, 0.2), FORCE),
    "force-4": (sphere(1.0, 0.013, JKR_WORK), 0.032, (0.2, 0.3), FORCE),
    "force-8": (sphere(1.0, 0.013, JKR_WORK), 0.032, (0.2, 0.3), FORCE),
    "three-branches": (sphere(7.5 / 0.91, 0.013, JKR_WORK), 0.0, (0.04, 0.2), FORCE * 0.75 / 0.91),
    "cone-cycle": (cone(70.0, 10.0, 0.006, JKR_WORK), 0.03, (0.03, 0.12), 1.0),
    "cone-pull": (cone(75.0, 2.0 / (1.0 - 0.45**2), 4e-3, 2e-4), 0.01, (0.025, 0.05), 1.0),
    "repressed-profile": (polynomial(0.25, 6.0, 1.0, 0.03, 5e-4), 0.005, (0.12, 0.25), 1.0),
    "bulk-start": (
        sphere(4.0 * SHEAR * (3.0 * BULK + SHEAR) / (3.0 * BULK + 4.0 * SHEAR), 0.06, 2e-3),
        0.1,
        (0.3, 0.5),
        1.0,
    ),
    "bulk-retraction-100nm": (sphere(1.0, 1e-4, 0.05 * 0.91 / 1e3), 0.02, (0.1, 0.25), FORCE),
}  # contact, penetration, interval of the radius, unit of the force


@pytest.mark.parametrize("name", STARTS)
def test_start_of_an_adhesive_scene(name):
    contact, depth, interval, unit = STARTS[name]
    radius, force = contact.at_depth(depth, *interval)
    assert stated(name, "start_radius") == pytest.approx(radius, rel=1e-6)
    assert stated(name, "start_force") == pytest.approx(force / unit, rel=1e-6)


@pytest.mark.parametrize(("name", "modulus"), [("elastic-relaxed", 1.0), ("elastic-glassy", 10.0)])
def test_least_penetration_of_an_elastic_scene(name, modulus):
    radius, depth = sphere(modulus, 0.013, JKR_WORK).least(0, 0.02, 0.1)
    assert stated(name, "detachment_radius") == pytest.approx(radius, rel=1e-4)  # a minimum is flat
    assert stated(name, "detachment_penetration") == pytest.approx(depth, rel=1e-6)


@pytest.mark.parametrize("name", ["cone-cycle", "cone-pull"])
def test_slow_pull_off_of_a_cone_bounds_every_faster_one(name):
    contact = {
        "cone-cycle": cone(70.0, 1.0, 0.006, JKR_WORK),
        "cone-pull": STARTS["cone-pull"][0],
    }[name]
    _, force = contact.least(1, 1.1 * contact.zone, 8.0 * contact.zone)
    (bound,) = [c["at_least"] for c in checks(name)["checks"] if c["observable"] == "pull_off_force"]
    assert 0.9999 * -force < bound < -force


@pytest.mark.parametrize(("multiple", "time"), [(4.0, 1.0), (4.0, 3.0), (8.0, 0.5), (8.0, 1.5)])
def test_creep_at_the_first_radius_bounds_the_penetration_under_a_tension(multiple, time):
    name = f"force-{multiple:g}"
    contact, depth, interval, _ = STARTS[name]
    radius, force = contact.at_depth(depth, *interval)
    tension = multiple * 1.5 * math.pi * JKR_WORK
    creep = 1.0 - 0.9 * math.exp(-time / 10.0)  # relaxation time 1, Einf = 10 E0: retardation time 10
    entries = [c for c in checks(name)["checks"] if c.get("at_time") == time]
    (bound,) = [entry["at_most"] for entry in entries if entry["observable"] == "penetration"]
    assert bound == pytest.approx(depth - (tension + force) * creep / (2.0 * radius), abs=2e-7)


def test_punch_on_a_half_space_whose_bulk_relaxes_apart():
    """``F = 2 a int E*(t - s) dD(s)``; the Laplace transform of ``E*`` is inverted by Talbot's contour."""

    def plane_modulus(p: complex) -> complex:
        shear = (0.75 + 3.0 * p / (p + 1.0) + 3.0 * p / (p + 0.2)) / (2.0 * 1.3)
        bulk = 0.75 / (3.0 * (1.0 - 2.0 * 0.3)) + 1.5 * p / (p + 2.0)
        return 4.0 * shear * (3.0 * bulk + shear) / (3.0 * bulk + 4.0 * shear)

    def inverted(transform: Callable[[complex], complex], time: float, points: int = 40) -> float:
        angle = -math.pi + (np.arange(points) + 0.5) * 2.0 * math.pi / points  # Weideman 2006
        z = points * (0.5017 * angle / np.tan(0.6407 * angle) - 0.6122 + 0.2645j * angle)
        sine = np.sin(0.6407 * angle)
        dz = points * (0.5017 / np.tan(0.6407 * angle) - 0.5017 * 0.6407 * angle / sine**2 + 0.2645j)
        values = np.array([transform(complex(p)) for p in z / time])
        return float((np.exp(z) * values * dz).sum().imag / (points * time))

    def force(time: float) -> float:
        """Jump to 0.01, then at speed 0.02 for half a unit of time."""
        total = 0.01 * inverted(lambda p: plane_modulus(p) / p, time)
        for sign, begun in ((1.0, 0.0), (-1.0, 0.5)):
            if time > begun:
                total += sign * 0.02 * inverted(lambda p: plane_modulus(p) / p**2, time - begun)
        return 2.0 * total

    name = "bulk-punch"
    assert stated(name, "start_force") == close(2.0 * 0.01 * plane_modulus(1e15).real)
    assert stated(name, "approach_force") == close(force(0.5))
    assert stated(name, "final_force") == close(force(3.5))
