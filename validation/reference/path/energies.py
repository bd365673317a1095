"""Force and energies along a step.

Stored energy is ``U = E0* int w^2 + sum_k int b_k^2/E_k`` over the contact and ``sum_j int e_j^2/J_j`` over
the free surface, both sides of the edge counted. A field with a sharp edge releases the glassy
``q(a)^2/Einf* da`` at its tip. With ``B_k = int b_k``, ``Q_k = int b_k^2`` over the contact, and
``H_j = int e_j^2`` outside, at any instant

    dF = 2 [Einf* a dD - sum_k B_k/tau_k dt + q(a) da],
    dU = F dD - 2 [sum_k Q_k/(E_k tau_k) + sum_j H_j/(J_j theta_j)] dt + q(a)^2/Einf* da,

exactly: a row knows the slopes of its force and energies as it knows these. Between two rows each is the
quartic through both and the value in the row before, or the cubic through both after a kink.

What the edge takes up on opening, or gives back on closing, is the separation energy; it may depend on
direction and speed.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from validation.reference.path.closure import EVEN, points
from validation.reference.path.edge_law import EdgeLaw
from validation.reference.path.fields import NODES, WEIGHTS
from validation.reference.path.memory import COLLOCATION, FAST, through_nodes
from validation.reference.path.numerics import derivative, horner, powers
from validation.reference.path.rheology import IndentedBody
from validation.reference.path.state import State
from validation.reference.path.trial import Arrival, Trial

Array = NDArray[np.float64]

TIME, DEPTH, RADIUS, FORCE, STORED, TIP, SEPARATION, WORK, STRESS = range(9)
"""Columns of a row. Tip energy, separation energy and work are sums since the start, stress is ``q(a)``."""
_SMOOTH = slice(FORCE, WORK)
"""Quantities with known slopes."""
_SIZE = 2 * COLLOCATION + 1


def stored_energy(body: IndentedBody, state: State) -> float:
    """``U``, both sides of the edge."""
    rheology = body.rheology
    elastic = rheology.relaxed * body.strain_squared(state.depths, state.radius)
    held = float((state.held_squares / rheology.moduli).sum())
    image = elastic + held + float((state.free_squares / rheology.compliances).sum())
    strain, branches = _coupled(body, state)
    return image - rheology.relaxed * strain - float((branches / rheology.moduli).sum())


def _coupled(body: IndentedBody, state: State) -> tuple[float, Array]:
    """``int int f M f`` of the image and of each of its branches (n,)."""
    if not body.image.is_layer:
        return 0.0, 0.0 * state.held_squares
    gram, shape = body.integrals(state.radius)
    strain = gram @ state.depths - shape + state.free.sum(axis=1)
    branches = state.held + state.free @ body.rheology.branches_of_units
    coupling = body.image.coupling
    return float(strain @ coupling @ strain), (branches * (coupling @ branches)).sum(axis=0)


def stored_when_free(body: IndentedBody, state: State) -> float:
    """``U`` right after all contact is lost: the whole contact released at once."""
    edges = state.edges_between(-state.radius, 0.0)
    x, weights = points(np.union1d(-state.radius * EVEN, edges))
    units = body.rheology.release(*state.in_contact(body, x))
    moments = (body.image.functions(state.radius + x).T * weights) @ units
    released = replace(
        state,
        radius=0.0,
        held=0.0 * state.held,
        held_squares=0.0 * state.held_squares,
        free=state.free + moments,
        free_squares=state.free_squares + weights @ units**2,
    )
    return stored_energy(body, released)


@dataclass(frozen=True)
class Course:
    """All quantities along a step: coefficients (m, 8) of all but the edge stress, known at ``u``."""

    coefficients: Array
    u: Array
    stress: Array

    def at(self, u: Array) -> Array:
        """Rows (l, 9)."""
        smooth = powers(u, len(self.coefficients) - 1) @ self.coefficients
        return np.column_stack((smooth, np.interp(u, self.u, self.stress)))

    def slopes(self, u: Array, order: int = 1) -> Array:
        """Derivatives (l, 8)."""
        coefficients = self.coefficients
        for _ in range(order):
            coefficients = derivative(coefficients)
        return powers(u, len(coefficients) - 1) @ coefficients


def course(arrival: Arrival, after: State, first: Array, before: tuple[float, Array] | None) -> Course:
    """The course of a step from the row ``first``; ``before``: ``u < 0`` and the row before that."""
    trial, body, law = arrival.trial, arrival.trial.body, arrival.trial.law
    way, clock, depth = trial.segment.way, arrival.motion.clock, arrival.motion.depth_slopes()
    u, stress = arrival.edge_stress()
    end = np.array([after.force, stored_energy(body, after), first[TIP], first[SEPARATION]])
    ends = np.empty((2, 4))
    changes = clock, depth, way
    ends[0] = _slopes(body, law, trial.state, stress[0], [change[1] for change in changes])
    arriving = [np.arange(len(change)) @ change for change in changes]
    ends[1] = _slopes(body, law, after, stress[-1], arriving)
    rated = law.rated and trial.direction < 0.0
    if trial.passed is not None:
        end[2] += trial.direction * float(trial.passed.sweep.weight @ stress**2) / body.rheology.glassy
        end[3] += _separation_at_speed(arrival) if rated else 0.0
    coefficients = np.zeros((_SIZE, STRESS))
    for column, change in ((TIME, clock), (DEPTH, depth[:, 0]), (RADIUS, way)):
        coefficients[: len(change), column] = change
    coefficients[0, :FORCE] = first[:FORCE]
    if arrival.rise == 0.0:  # at a fixed load: no way of equilibria
        ends[:] = end - first[_SMOOTH]
        before = None
    elif trial.direction and arrival.duration > FAST * body.rheology.shortest:
        parabola = _parabola(first[_SMOOTH], end, before and (before[0], before[1][_SMOOTH]))
        layer = np.abs(ends - parabola) > np.abs(parabola).sum(axis=0)  # one that the step does not follow
        layer[:, 2:] = False
        ends = np.where(layer, parabola, ends)
    smooth = _smooth(first[_SMOOTH], end, ends, before and (before[0], before[1][_SMOOTH]))
    coefficients[: len(smooth), _SMOOTH] = smooth
    if not rated:
        spent = _separation(trial)
        coefficients[:, SEPARATION] = 0.0
        coefficients[: len(spent), SEPARATION] = spent
        coefficients[0, SEPARATION] = first[SEPARATION]
    if trial.leg.control == "force" and trial.leg.timed:
        coefficients[: COLLOCATION + 1, FORCE] = through_nodes(trial.leg.value, trial.state.parameter, clock)
    force, depth = coefficients[: COLLOCATION + 1, [FORCE, DEPTH]].T
    power = np.convolve(force, derivative(depth))
    coefficients[0, WORK] = first[WORK]
    coefficients[1 : len(power) + 1, WORK] = power / np.arange(1, len(power) + 1)
    return Course(coefficients, u, stress)


def _parabola(first: Array, end: Array, before: tuple[float, Array] | None) -> Array:
    """Slopes (2, m) at both ends of the parabola through them and a row before; of the chord without one."""
    chord = end - first
    bend = 0.0 * chord if before is None else (chord - (before[1] - first) / before[0]) / (1.0 - before[0])
    return np.array([chord - bend, chord + bend])


def _slopes(
    body: IndentedBody, law: EdgeLaw, state: State, q: float, rates: list[Array]
) -> tuple[float, ...]:
    """Slopes of force, stored, tip and separation energy from those of time, penetrations and radius."""
    t, D, a = float(rates[0]), rates[1], float(rates[2])
    rheology, gram = body.rheology, body.integrals(state.radius)[0]
    relaxing = float((state.held[0] / rheology.times).sum())
    squares = state.held_squares - _coupled(body, state)[1]
    power = float((squares / (rheology.moduli * rheology.times)).sum())
    power += float((state.free_squares / (rheology.compliances * rheology.retardation)).sum())
    tip = q * q / rheology.glassy * a
    force = 2.0 * (rheology.glassy * float(gram[0] @ D) - t * relaxing + q * a)
    taken = law.taken_up(-a / t if t > 0.0 else math.inf, a > 0.0)
    return (
        force,
        state.force * float(D[0]) - 2.0 * power * t + tip,
        tip,
        -taken * 2.0 * math.pi * state.radius * a,
    )


def _separation(trial: Trial) -> Array:
    """Coefficients of ``-int w dA`` along a step, where the energy per area does not depend on the speed."""
    way = trial.segment.way
    area = np.convolve(way, way)
    area[: len(way)] += 2.0 * trial.state.radius * way
    return np.asarray(-trial.law.taken_up(0.0, trial.direction > 0.0) * math.pi * area)


def _separation_at_speed(arrival: Arrival) -> float:
    """``-int w dA`` over a step of an opening edge with a rate law."""
    trial, clock = arrival.trial, arrival.motion.clock
    way = trial.segment.way
    travel, time = horner(derivative(way), NODES), horner(derivative(clock), NODES)
    radius = trial.state.radius + horner(way, NODES)
    speeds = np.divide(-travel, time, out=np.full_like(time, math.inf), where=time > 0.0)
    taken = [trial.law.taken_up(v, False, arrival.integral) for v in speeds.tolist()]
    return -float((WEIGHTS * taken) @ (2.0 * math.pi * radius * travel))


def _smooth(first: Array, last: Array, slopes: Array, before: tuple[float, Array] | None) -> Array:
    """Coefficients from values and slopes at both ends; ``before``: ``u < 0`` and values there."""
    leaving, arriving = slopes - (last - first)
    cubic = np.array([first, slopes[0], -2.0 * leaving - arriving, leaving + arriving])
    if before is None:
        return cubic
    u, value = before
    bump = np.array([[0.0], [0.0], [1.0], [-2.0], [1.0]]) / (u * (1.0 - u)) ** 2
    return np.vstack((cubic, 0.0 * first)) + bump * (value - u ** np.arange(4) @ cubic)
