"""History on the surface alone, for a constant Poisson's ratio.

All moduli relax alike, so every branch variable in the volume is the image of a surface vector. With ``w``
the forces that would cause the present displacement in a solid of unit shear modulus, ``u = C w``,

    ``f = G_0 w + sum_k b_k``,   ``b_k' = -b_k/tau_k + G_k w'``,

node by node. Outside the contact ``f = 0`` gives ``w`` without a solve; any field in the body follows from
``w`` and ``b_k`` by one back-substitution. Clapeyron's theorem turns volume integrals into surface sums:
stored energy ``1/2 G_0 w^T C w + sum_k b_k^T C b_k/(2 G_k)``, exterior of the mesh included. The forms
``b_k^T C b_k`` follow the branches in the same recursion, ``b_k <- e_k b_k + g_k dw``: whatever the number of
branches, a step costs one product with ``C`` for what the past leaves, and one for the forces.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fem_solver.partial_release import (
    PartialContact,
    PartlyHeld,
    StripsInStep,
    energy_at_edge,
    partly_held,
)
from fem_solver.prony import Increment, Prony
from fem_solver.series_modulus import SeriesModulus, SeriesStep
from fem_solver.surface import SurfaceOperator

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Response:
    """Surface displacement at the end of a step for new surface forces: ``u = free + C f/modulus``.

    ``free`` (n,) is the displacement of the surface without forces; ``operator`` holds ``C``. ``partly`` are
    the strips of nodes where the step begins.
    """

    operator: SurfaceOperator
    modulus: float
    free: Array
    partly: StripsInStep | None = None


@dataclass(frozen=True)
class CondensedState:
    """Internal variables on the surface.

    Parameters
    ----------
    image : ndarray, shape (n,)
        ``w``, the forces that cause the present displacement in a solid of unit shear modulus.
    branches : ndarray, shape (branches, n)
        ``b_k``.
    displacement : ndarray, shape (n,)
        ``C w``.
    forms : ndarray, shape (branches,)
        ``b_k^T C b_k``.
    dissipated : float
        Energy dissipated in the branches so far.
    updates : int
        Accepted steps so far.
    partly : PartlyHeld, optional
        The node next to an adhesive edge.
    """

    image: Array
    branches: Array
    displacement: Array
    forms: Array
    dissipated: float = 0.0
    updates: int = 0
    partly: PartlyHeld | None = None


@dataclass(frozen=True)
class StepCoefficients:
    """What a step of one length does to any state; ``loss_weights`` vanish in no time and in a relaxation."""

    dt: float
    increment: Increment
    loss_weights: Array
    strips: SeriesStep


@dataclass(frozen=True)
class PastAtEnd:
    """What the past leaves at the end of a step: forces at no displacement, displacement at no force."""

    dt: float
    memory: Array
    free: Array


class CondensedHistory:
    """Relaxation form on surface vectors; ``state`` is replaced by every accepted step.

    Parameters
    ----------
    operator : SurfaceOperator
        Compliance ``C`` of n surface nodes for unit shear modulus.
    shear : Prony
    """

    def __init__(self, operator: SurfaceOperator, shear: Prony) -> None:
        nodes, count = len(operator.unit), len(shear.times)
        self.operator, self.shear = operator, shear
        self.glassy_modulus = shear.glassy
        self.state = CondensedState(
            np.zeros(nodes), np.zeros((count, nodes)), np.zeros(nodes), np.zeros(count)
        )
        self.volume_solves = 0
        self.factorisations = 1
        self._strips = SeriesModulus((shear,))
        self._coefficients: StepCoefficients | None = None
        self._past: PastAtEnd | None = None

    @property
    def instantaneous(self) -> SurfaceOperator:
        """Surface compliance of the glassy response, for unit shear modulus."""
        return self.operator

    def respond(self, dt: float) -> Response:
        """Response to forces at the end of a step; changes nothing."""
        step, partly = self._step(dt), self.state.partly
        released = None if partly is None else partly.released(step.strips, self.operator.unit)
        return Response(self.operator, step.increment.modulus, self._left(dt).free, released)

    def _step(self, dt: float) -> StepCoefficients:
        """Most steps are as long as the one before."""
        if self._coefficients is None or self._coefficients.dt != dt:
            shear = self.shear
            loses = 0.0 < dt < np.inf
            weights = shear.loss_weights(dt) if loses else np.zeros((3, len(shear.times)))
            self._coefficients = StepCoefficients(dt, shear.increment(dt), weights, self._strips.step(dt))
        return self._coefficients

    def _left(self, dt: float) -> PastAtEnd:
        """What the past leaves, for the trial and again when it is accepted."""
        if self._past is None or self._past.dt != dt:
            step = self._step(dt).increment
            memory = step.memory(self.state.branches, self.state.image)
            self._past = PastAtEnd(dt, memory, -self.operator.displacement(memory) / step.modulus)
        return self._past

    def commit(self, dt: float, forces: Array, contact: PartialContact | None = None) -> None:
        """Accept the step that ends with these surface forces, and with an adhesive edge there.

        Parameters
        ----------
        dt : float
            Length of the step.
        forces : ndarray, shape (n,)
            Nodal forces at its end, compressive positive.
        contact : PartialContact, optional
            The node next to the edge then.
        """
        step, past, old = self._step(dt).increment, self._left(dt), self.state
        image = (forces - past.memory) / step.modulus
        displacement = past.free + self.operator.displacement(forces) / step.modulus
        change, moved = image - old.image, displacement - old.displacement
        mixed, squared = old.branches @ moved, float(change @ moved)
        forms = step.decay**2 * old.forms + 2.0 * step.decay * step.gain * mixed + step.gain**2 * squared
        self.state = CondensedState(
            image,
            step.advance(old.branches, change),
            displacement,
            np.maximum(forms, 0.0),
            old.dissipated + self._loss(dt, mixed, squared),
            old.updates + 1,
            partly_held(old.partly, self._step(dt).strips, contact),
        )
        self._past = None

    def take_back(self, state: CondensedState) -> None:
        """Return to the state before the last step."""
        self.state, self._past = state, None

    def interface_energy(self, forces: Array, gap: Array) -> float:
        """Energy of the node next to the edge beyond that of its mean; shapes (n,)."""
        return energy_at_edge(self.state.partly, self.operator.unit, forces, gap)

    def _loss(self, dt: float, mixed: Array, squared: float) -> float:
        """Energy dissipated over a step; ``mixed`` is ``b_k^T C dw`` and ``squared`` ``dw^T C dw``."""
        first, second, third = self._step(dt).loss_weights
        moduli = self.shear.moduli
        return float(np.sum(first * self.state.forms / moduli + second * mixed + third * moduli * squared))

    @property
    def displacement(self) -> Array:
        """Surface displacement, downwards; shape (n,)."""
        return self.state.displacement

    @property
    def stored_energy(self) -> float:
        """Energy of the equilibrium spring and of all branch springs."""
        state = self.state
        relaxed = self.shear.relaxed * float(state.image @ state.displacement)
        return 0.5 * (relaxed + float(np.sum(state.forms / self.shear.moduli)))
