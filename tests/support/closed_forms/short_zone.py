r"""Sphere whose process zone is short against the contact: ordinary differential equations for a run.

In Sneddon's coordinate every point of the contact carries its own history,
``q(x, t) = int E*(t - s) dw(x, s)`` with ``w = D - G(x)`` in contact, ``q = 0`` outside, and
``K = -q(a)/sqrt(pi a)`` (:mod:`..jkr`). A point that the edge covers first at ``t_c`` starts there
with the glassy jump ``E*(0) (D(t_c) - G(x))``. The speed of the edge follows from its load
(:mod:`..short_zone_edge`).

The force is the sum of ``f_k = 2 int_0^a q_k dx`` over the branches of the material, and

    f_k' = 2 E_k* D' a + 2 q_k(a) a' - f_k/tau_k,

where ``q_k(a) = E_k* (D - G(a))`` at a closing edge. After a reversal the edge closes on until its speed is
zero; the stress that opens it again is that one zone inside, since the last points have only been covered.

**Where it holds.** What is left out is of the order of ``da/a``; after a reversal, where the edge goes a few
zones while its speed falls to nothing, of some lower order. ``F > 0`` presses; units are those of the input.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import LSODA, OdeSolution, solve_ivp
from scipy.interpolate import CubicHermiteSpline
from scipy.optimize import minimize_scalar
from support.closed_forms.short_zone_edge import ShortZoneEdge

from contact_scene import Sphere
from validation.reference.jkr import JKR, ElasticContact
from validation.reference.prony_integrals import plane_spectrum

Array = NDArray[np.float64]

ACCURACY = 1e-10
"""Relative tolerance of the integration."""


@dataclass(frozen=True)
class Integration:
    """Times ``t`` of the steps of an integration, and its dense output ``sol``, as SciPy names them."""

    t: Array
    sol: OdeSolution


def integrated(
    rates: Callable[[float, Array], Array],
    span: tuple[float, float],
    state: Array,
    events: Sequence[Callable[[float, Array], float]],
) -> Any:
    """The integration over a time, or up to an event before.

    By LSODA: a few zones from a reversal, or on the way to detachment, its steps are far shorter.
    """
    return solve_ivp(
        rates,
        span,
        state,
        method="LSODA",
        rtol=ACCURACY,
        atol=_tolerances(state),
        events=events or None,
        dense_output=True,
    )


def integrated_until(
    ended: Callable[[float, Array], bool], rates: Callable[[float, Array], Array], begin: float, state: Array
) -> Integration:
    """The integration up to the first step after which it has ``ended``.

    SciPy's events are located in the dense output, which a state that runs away within a step leaves; and a
    step beyond that moment is shorter than the rounding of the time."""
    solver = LSODA(rates, begin, state, math.inf, rtol=ACCURACY, atol=_tolerances(state))
    times, pieces = [begin], []
    while solver.status == "running" and not ended(solver.t, solver.y):
        solver.step()
        if solver.t > times[-1]:
            times.append(solver.t)
            pieces.append(solver.dense_output())
    return Integration(np.array(times), OdeSolution(times, pieces))


def moment_of_loss(jumps: Callable[[float], bool], times: Array) -> float:
    """The first moment at which the edge jumps, to round-off; at the last of ``times`` it does."""
    held, lost = float(times[[not jumps(t) for t in times]][-1]), float(times[-1])
    while lost - held > 1e-13 * lost:
        middle = 0.5 * (held + lost)
        held, lost = (held, middle) if jumps(middle) else (middle, lost)
    return lost


def _tolerances(state: Array) -> Array:
    """Absolute tolerances by the sizes of the state at its start."""
    return ACCURACY * np.maximum(np.abs(state), ACCURACY * np.abs(state).max())


LOST = 1e-2
"""Radius of a contact that jumps, relative to that at the start, at which the integration ends."""
AT_REST = 1e-6
"""Speed, in zones per longest relaxation time, below which a closing edge is at rest."""
TINY = 1e-300
"""Least speed of an edge about to come to rest, in place of zero."""


@dataclass(frozen=True)
class ShortZoneRun:
    """A retraction, or the retraction of a cycle, until contact is lost."""

    time: Array
    radius: Array
    penetration: Array
    force: Array
    pull_off_force: float
    pull_off_penetration: float
    loop_energy: float


@dataclass(frozen=True)
class _Ramp:
    """Penetration ``level`` at ``begin``, changing at ``rate``."""

    begin: float
    level: float
    rate: float

    def depth(self, time: Any) -> Any:
        return self.level + self.rate * (time - self.begin)


@dataclass(frozen=True)
class _Branches:
    """Spring (index 0, without a time) and branches of the half-space, as plane moduli."""

    moduli: Array
    rates: Array

    def strained(self, loads: Array, rate: float, duration: float) -> Array:
        """Loads ``q_k`` after a time at a rate of strain."""
        y = self.rates * duration
        mean = np.where(y > 0.0, -np.expm1(-y) / np.where(y > 0.0, y, 1.0), 1.0)
        return loads * np.exp(-y) + self.moduli * rate * duration * mean


@dataclass(frozen=True)
class ShortZone(ShortZoneEdge):
    """A sphere on a half-space that it touches with a short process zone, driven at constant speeds."""

    def retraction(self, start: float, rate: float) -> ShortZoneRun:
        """From the relaxed equilibrium at the penetration ``start``, at a speed, until contact is lost."""
        first = JKR(Sphere(self.radius), self._relaxed, self.work).at_penetration(start)
        state = np.zeros(len(self._branches.moduli) + 2)
        state[:2] = first.contact_radius, first.force

        def edge_loads(a: float, time: float) -> Array:
            loads = np.zeros_like(self._branches.moduli)
            loads[0] = self._relaxed * (start - a * a / self.radius)
            return self._branches.strained(loads, -rate, time)

        return self._opened(_Ramp(0.0, start, -rate), state, edge_loads)

    def approach(self, start: float, deepest: float, rate: float) -> ElasticContact:
        """Where the glassy equilibrium at ``start`` has come to when it reaches ``deepest`` at a speed."""
        pressed = _Ramp(0.0, start, rate)
        radius, *loads, _ = self._closed(pressed, (deepest - start) / rate, self._glassy_state(start)).y[
            :, -1
        ]
        return ElasticContact(float(radius), deepest, float(sum(loads)))

    def cycle(self, start: float, deepest: float, approach: float, retraction: float) -> ShortZoneRun:
        """From the glassy equilibrium at ``start`` to ``deepest``, and back until contact is lost."""
        branches = self._branches
        reversal = (deepest - start) / approach
        pressed, pulled = _Ramp(0.0, start, approach), _Ramp(reversal, deepest, -retraction)
        way = self._closed(pressed, reversal, self._glassy_state(start))
        on = self._closed(pulled, math.inf, way.y[:, -1])
        times, radii = np.append(way.t, on.t), np.append(way.y[0], on.y[0])

        def depth(time: float) -> float:
            return pressed.depth(time) if time <= reversal else pulled.depth(time)

        radii = np.maximum.accumulate(radii)
        rising = np.concatenate(([True], np.diff(radii) > 0.0))
        times, radii = times[rising], radii[rising]
        slopes = [1.0 / max(self.closing_speed(a, depth(t)), TINY) for a, t in zip(radii, times, strict=True)]
        covered = CubicHermiteSpline(radii, times, np.array(slopes))

        def edge_loads(a: float, time: float) -> Array:
            at = min(max(float(covered(a)), 0.0), float(times[-1])) if a > radii[0] else 0.0
            loads = branches.moduli * (depth(at) - a * a / self.radius)
            if at < reversal:
                loads = branches.strained(loads, approach, reversal - at)
            return branches.strained(loads, -retraction, time - max(at, reversal))

        inside = float(radii[-1]) - self.zone
        return self._opened(pulled, on.y[:, -1], edge_loads, float(on.t[-1]), inside)

    @cached_property
    def _branches(self) -> _Branches:
        relaxed, moduli, times = plane_spectrum(self.material)
        return _Branches(np.append(relaxed, moduli), np.append(0.0, 1.0 / times))

    def _rates(self, state: Array, rate: float, speed: float, edge_loads: Array) -> Array:
        """Rates of radius, loads ``f_k`` and work, where the edge moves outwards at ``speed``."""
        radius, loads = float(state[0]), state[1:-1]
        branches = self._branches
        changes = 2.0 * (branches.moduli * rate * radius + edge_loads * speed) - branches.rates * loads
        return np.array([speed, *changes, rate * float(loads.sum())])

    def _glassy_state(self, start: float) -> Array:
        """Radius, loads ``f_k`` and work of the glassy equilibrium at a penetration."""
        first = JKR(Sphere(self.radius), self._glassy, self.work).at_penetration(start)
        return np.array([first.contact_radius, *(self._branches.moduli / self._glassy * first.force), 0.0])

    def _closed(self, leg: _Ramp, end: float, state: Array) -> Any:
        """The edge from a state on until it comes to rest or, at the latest, ``end``."""

        def speed(time: float, state: Array) -> float:
            return self.closing_speed(float(state[0]), leg.depth(time))

        def moved(time: float, state: Array) -> Array:
            at_edge = self._branches.moduli * (leg.depth(time) - state[0] ** 2 / self.radius)
            return self._rates(state, leg.rate, speed(time, state), at_edge)

        def at_rest(time: float, state: Array) -> float:
            return speed(time, state) - AT_REST * self.zone / self.material.spectrum[1].max()

        at_rest.terminal = True  # type: ignore[attr-defined]
        return integrated(moved, (leg.begin, end), state, (at_rest,) if math.isinf(end) else ())

    def _opened(
        self,
        pulled: _Ramp,
        state: Array,
        edge_loads: Callable[[float, float], Array],
        begin: float = 0.0,
        within: float = math.inf,
    ) -> ShortZoneRun:
        """A retraction from a state on until contact is lost."""
        smallest = LOST * float(state[0])

        def driving(a: float, time: float) -> float:
            return float(edge_loads(min(a, within), time).sum())

        def moved(time: float, state: Array) -> Array:
            a = float(state[0])
            speed = self.opening_speed(a, driving(a, time))
            return self._rates(state, pulled.rate, -speed, edge_loads(a, time))

        def runs_away(time: float, state: Array) -> bool:
            radius = float(state[0])
            needed = self.compliance_needed(radius, driving(radius, time))
            return needed * self._glassy <= 1.0

        def jumps(time: float) -> bool:
            return runs_away(time, run.sol(time))

        run = integrated_until(
            lambda time, state: runs_away(time, state) or bool(state[0] <= smallest), moved, begin, state
        )
        lost = moment_of_loss(jumps, run.t)
        time = np.concatenate((run.t[run.t < lost], [lost]))
        states = run.sol(time)
        force = states[1:-1].sum(axis=0)
        at = _pull_off_time(run, time, force)
        return ShortZoneRun(
            time,
            states[0],
            pulled.depth(time),
            force,
            -float(run.sol(at)[1:-1].sum()),
            pulled.depth(at),
            float(states[-1, -1]),
        )


def _pull_off_time(run: Integration, time: Array, force: Array) -> float:
    """When the force is least, in the dense output around the least of its values."""
    least = int(np.argmin(force))
    near = time[max(least - 1, 0)], time[min(least + 1, len(time) - 1)]
    found = minimize_scalar(
        lambda t: run.sol(t)[1:-1].sum(),
        bounds=near,
        method="bounded",
        options={"xatol": 1e-9 * time[-1]},
    )
    return float(found.x)
