"""Where the indenter is while a ramp drives the stage: at ``D = X - C F`` on a spring of compliance ``C``.

What a ramp of the stage would do by itself is known in closed form. The deflection ``u = C F`` of the spring
takes ``u`` of the penetration, and of the branch forces ``E_k N_k``, ``N_k = int exp(-(t - s)/tau_k) du(s)``.
Over a step it is the polynomial through the rows. ``N_k`` and the force are affine in its value at the end,
so that one division tells it.

While the edge rests, the branch forces ``B_k`` of the whole contact follow

    B_k' = -B_k/tau_k + 2 a E_k D',    (1 + 2 C a E0) D = X + 2 C E0 int_0^a G dx - C sum_k B_k,

a Prony element in series with a spring, which is another Prony element: its times are the eigenvalues of
``diag(tau) + 2 a c r r^T``, with ``r_k^2 = E_k tau_k`` and ``c = C/(1 + 2 C a E0)``.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from validation.reference.batch.grid import Travel
from validation.reference.batch.scenes import LoadRamp, State

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class AtRest:
    """Above an edge that rests from the beginning of a ramp on; ``held``: integrals (n, B) of what is left in
    contact beside the ``branches`` (n, B), both as it begins."""

    leg: LoadRamp
    radius: Array
    branches: Array
    held: Array

    @cached_property
    def _modes(self) -> tuple[Array, Array, Array, Array]:
        """Times (n, B) of the contact on its spring, their vectors (n, n, B), where each begins and ends."""
        bodies, a = self.leg.bodies, self.radius
        r = np.sqrt(bodies.moduli * bodies.times)
        stiff = 2.0 * a / (1.0 + 2.0 * a * bodies.compliance * bodies.relaxed)
        coupling = (bodies.compliance * stiff * r * r[:, None]).transpose(2, 0, 1)
        times, vectors = np.linalg.eigh(coupling + np.eye(len(r)) * bodies.times.T[:, None])
        vectors = vectors.transpose(1, 2, 0)
        sides = 2.0 * (self.branches * a + self.held) / r, stiff * self.leg.rate * r
        begin, end = ((vectors * part[:, None]).sum(axis=0) for part in sides)
        return np.ascontiguousarray(times.T), np.ascontiguousarray(vectors), begin, end

    def __call__(self, t: Array) -> State:
        """At times (B,) or (m, B) since the ramp began."""
        bodies, (times, vectors, begin, end) = self.leg.bodies, self._modes
        soft = 2.0 * bodies.compliance * bodies.relaxed
        stage, faded, _ = self.leg(np.atleast_2d(t))
        share = end[:, None] + (begin - end)[:, None] * np.exp(-np.atleast_2d(t) / times[:, None])
        whole = np.sqrt(bodies.moduli * bodies.times)[:, None] * np.einsum("kjb,jmb->kmb", vectors, share)
        D = stage + soft * bodies.volume(self.radius) - bodies.compliance * whole.sum(axis=0)
        b = (0.5 * whole - self.held[:, None] * faded) / self.radius
        state = D / (1.0 + soft * self.radius), faded, b
        return state if t.ndim == 2 else (state[0][0], faded[:, 0], b[:, 0])


def fading(since: Array, times: Array) -> Array:
    """What times (Q, B) since points ``LAYERED`` leave of what relaxes (Q, n, B), at last a mean."""
    shares = since[:, None] / times
    shares[-1] = np.where(shares[-1] == 0.0, 1e-300, shares[-1])
    faded = np.exp(-shares)
    faded[-1] = -np.expm1(-shares[-1]) / shares[-1]
    return faded


@dataclass(frozen=True, eq=False)
class OnSpring:
    """At the end of a step to a radius, after rows of ``times`` and ``forces`` (m, B).

    ``held``: integrals (n, B) of what is left in contact beside the branch forces, as the ramp began;
    ``lag``: ``E_k N_k`` (n, B) in the last row.
    """

    leg: LoadRamp
    travel: Travel
    radius: Array
    times: Array
    forces: Array
    lag: Array
    held: Array

    def faded(self, t: Array) -> Array:
        """As of :func:`fading`."""
        bodies, weights = self.leg.bodies, self.travel.gained[0]
        since = t - weights[:, :-1] @ self.times - weights[:, -1:] * t
        return fading(np.maximum(since, bodies.earliest), bodies.times)

    def remembered(self, t: Array, faded: Array, last: Array, values: Array) -> Array:
        """Branch forces (n, B) that values (m, B) in the rows have driven, without the new row."""
        bodies = self.leg.bodies
        old = last * np.exp(-np.maximum(t - self.times[-1], bodies.earliest) / bodies.times)
        gained = self.travel.gained[1][:, :-1] @ values
        return np.asarray(old + bodies.moduli * (faded * gained[:, None]).sum(axis=0))

    def new(self, faded: Array) -> Array:
        """What the new row counts (n, B)."""
        return np.asarray(self.leg.bodies.moduli * (faded * self.travel.gained[1][:, -1:, None]).sum(axis=0))

    def driven(self, t: Array, state: State, faded: Array) -> Array:
        """The force (B,) if the indenter were where the stage is."""
        D, left, b = state
        return self.leg.bodies.force(D, b, self.radius, self.held * left)

    def __call__(self, t: Array) -> State:
        """At a time (B,) at which the step ends."""
        bodies, (D, left, b), faded = self.leg.bodies, self.leg(t), self.faded(t)
        own = self.new(faded)
        b = b - self.remembered(t, faded, self.lag, bodies.compliance * self.forces)
        stiff = 2.0 * self.radius * (bodies.relaxed + own.sum(axis=0))
        u = bodies.compliance * self.driven(t, (D, left, b), faded) / (1.0 + bodies.compliance * stiff)
        return D - u, left, b - own * u


@dataclass(frozen=True, eq=False)
class Covering(OnSpring):
    """The same of an edge that closes over a surface never touched.

    What it covers has no strain, so that branch forces of the whole contact are those that
    ``P = a D - int_0^a G dx`` drives: ``held`` (n, B) in the last row; ``driving``: ``P`` (m, B) in the rows.
    """

    driving: Array

    def whole(self, t: Array, D: Array, faded: Array) -> Array:
        """Integrals (n, B) of the branch forces over the contact at a penetration."""
        P = self.radius * D - self.leg.bodies.volume(self.radius)
        return self.remembered(t, faded, self.held, self.driving) + self.new(faded) * P

    def driven(self, t: Array, state: State, faded: Array) -> Array:
        """As of :class:`OnSpring`."""
        bodies, D = self.leg.bodies, state[0]
        P = self.radius * D - bodies.volume(self.radius)
        return 2.0 * (bodies.relaxed * P + self.whole(t, D, faded).sum(axis=0))
