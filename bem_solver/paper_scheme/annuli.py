"""The paper's annuli (Appendix A): uniform width, fixed in space, the contact edge on one of their borders.

A disc ``C_0`` of radius ``lambda`` is collocated at its centre, annulus ``C_q`` from ``q lambda`` to
``(q + 1) lambda`` at ``(q + 1/2) lambda``. A contact of n annuli has radius ``n lambda``; the process zone is
a whole number of annuli. Every annulus has a history, in contact or not: its displacement per unit modulus
``v`` and the strains ``e_k`` of its Voigt branches, ``w = v/Einf + sum e_k``, so that the paper's known term
(Eq. knownterm) is ``A = sum e_k``. One step of any scheme then reads ``w = C v + A`` at every radius, the
same C everywhere: inside the contact ``w = D - f`` gives ``v`` and, with the influence matrix, the pressure;
outside v follows from the pressure and w from v. Signs: see ``kernel``; lengths in scene units, ``scaled``
pressure is pressure times ``lambda`` at unit plane modulus.

One factorisation of the influence matrix without row exchanges serves every contact. With ``K = L U``, for
every n ``K[:n, :n] = L[:n, :n] U[:n, :n]`` and ``K[n:, :n] = L[n:, :n] U[:n, :n]``: so ``y = L^-1 b`` holds
the forward solutions of all leading blocks, and ``K[n:, :n] K[:n, :n]^-1 b[:n]`` is ``L[n:, :n] y[:n]``. From
10 to 2000 annuli every multiplier stays below 0.58 and every pivot between 1.7 and 2 annulus widths, so that
partial pivoting would exchange no rows; that none are is checked.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import solve_triangular
from scipy.linalg.blas import dtpsv
from scipy.linalg.lapack import dgetrf

from bem_solver.creep import Chain
from bem_solver.kernel import annulus_influence
from contact_scene import Counters, Indenter

Array = NDArray[np.float64]


def _packed(triangle: Array) -> Array:
    """Rows of a lower triangle one after another: storage of which every leading block is a prefix."""
    return np.concatenate([triangle[j, : j + 1] for j in range(len(triangle))])


class LeadingBlocks:
    """LU factors of a matrix (N, N) for solutions with any leading block.

    In ``factors`` (N, N) L, with unit diagonal, is below the diagonal, U on and above it. ArithmeticError if
    the matrix is singular or needs row exchanges.
    """

    def __init__(self, matrix: Array) -> None:
        factors, rows, info = dgetrf(matrix)
        if info or np.any(rows != np.arange(len(rows))):
            raise ArithmeticError("the matrix cannot be factorised without exchanging rows")
        self.factors = np.ascontiguousarray(factors)
        self._lower = _packed(self.factors)
        self._upper = _packed(self.factors.T)

    def forward(self, values: Array) -> Array:
        """``L^-1 b`` for b (n,), any n <= N."""
        return dtpsv(len(values), self._lower, values, trans=1, diag=1)

    def backward(self, values: Array) -> Array:
        """``U^-1 y`` for y (n,): the solution with the leading block of that size."""
        return dtpsv(len(values), self._upper, values)

    def adjoint(self, values: Array) -> Array:
        """``U^-T c`` for c (n,): ``c[:m] @ K[:m, :m]^-1 b[:m]`` is ``(U^-T c)[:m] @ (L^-1 b)[:m]``."""
        return dtpsv(len(values), self._upper, values, trans=1)

    def last(self, forward: Array, count: int) -> Array:
        """The last ``count`` entries of ``U^-1 y`` for y (n,)."""
        n = len(forward)
        corner = self.factors[n - count : n, n - count : n]
        return solve_triangular(corner, forward[n - count :], check_finite=False)

    def beyond(self, forward: Array, end: int) -> Array:
        """Rows n to ``end`` of ``K[:, :n] K[:n, :n]^-1 b`` from ``y = L^-1 b`` (n,)."""
        n = len(forward)
        return self.factors[n:end, :n] @ forward


class UniformAnnuli:
    """``count`` annuli of equal ``width`` under an indenter, ``zone`` of them (0 without adhesion) the zone.

    ``radii``, ``heights`` and ``areas`` (N,) are the collocation radii, the indenter there, and areas in
    squared widths; ``blocks`` the factors for annuli of width one; ``unit`` is ``L^-1`` of the displacement
    one, all flat punches at once, and ``force_weights`` ``U^-T areas``: the force of n annuli is its product
    with ``y = L^-1 v``.
    """

    def __init__(self, width: float, count: int, zone: int, indenter: Indenter) -> None:
        borders = np.arange(count + 1.0)
        middles = borders[:-1] + 0.5
        middles[0] = 0.0
        self.width, self.count, self.zone = width, count, zone
        self.radii = width * middles
        self.heights = indenter.height(self.radii)
        self.areas = np.pi * np.diff(borders**2)
        self.blocks = LeadingBlocks(annulus_influence(middles, borders))
        self.unit = self.blocks.forward(np.ones(count))
        self.force_weights = self.blocks.adjoint(self.areas)

    def forces(self, scaled: Array) -> Array:
        """Force on each annulus of a contact from its scaled pressures, (n,)."""
        return self.width * self.areas[: len(scaled)] * scaled

    def stress_intensity(self, forward: Array) -> float:
        """``K_I`` (tension opens) from ``y = L^-1 v`` (n,): the edge annulus against the flat punch's.

        The punch of unit displacement has ``K_I = -1/sqrt(pi a)``; the ratio of last pressures is that of the
        last entries of y.
        """
        n = len(forward)
        if n == 0:
            return 0.0
        return -float(forward[-1] / self.unit[n - 1] / np.sqrt(np.pi * n * self.width))


@dataclass(frozen=True)
class AnnuliState:
    """Committed state of the surface.

    ``contact`` annuli touch under the ``scaled`` pressure (n,); ``load`` (N,) is ``v``, and ``strains``
    (N, K) are the displacements of the Voigt branches.
    """

    time: float
    penetration: float
    contact: int
    load: Array
    strains: Array
    scaled: Array
    force: float
    stress_intensity: float

    @classmethod
    def untouched(cls, annuli: UniformAnnuli, branches: int, penetration: float) -> AnnuliState:
        """No contact and no past, at time zero."""
        zero = np.zeros(annuli.count)
        return cls(0.0, penetration, 0, zero, np.zeros((annuli.count, branches)), zero[:0], 0.0, 0.0)

    def displacement(self, chain: Chain) -> Array:
        """Surface displacement (N,)."""
        return self.load / chain.glassy + self.strains.sum(axis=1)


@dataclass(frozen=True)
class StepFactors:
    """``e_k = decay e_k + before v + after v`` (the last v after the step), all (K,)."""

    decay: Array
    before: Array
    after: Array


def step_factors(chain: Chain, duration: float) -> StepFactors:
    """Factors of a step of either scheme."""
    y = duration / chain.retardation
    decay, spread = chain.decay(y), chain.spread(y)
    return StepFactors(decay, chain.compliances * (spread - decay), chain.compliances * (1.0 - spread))


class ContactCandidates:
    """All contacts that are possible at the end of a step, from one triangular solution.

    Penetration enters ``v = (D - f - A)/C`` linearly, so ``y = L^-1 v`` is ``base + D rise``, for contacts of
    any number of annuli, and so is the force. The duration of a sudden change of load is zero; of penetration
    and force the ``control`` has ``value`` at the end.
    """

    def __init__(
        self,
        annuli: UniformAnnuli,
        chain: Chain,
        before: AnnuliState,
        duration: float,
        control: str,
        value: float,
        counters: Counters,
    ) -> None:
        self.annuli, self.before = annuli, before
        self.control, self.value, self.counters = control, value, counters
        factors = step_factors(chain, duration)
        self._new_share = factors.after
        self._decayed = before.strains * factors.decay + np.outer(before.load, factors.before)
        self._known = self._decayed.sum(axis=1)
        self._compliance = 1.0 / chain.glassy + float(self._new_share.sum())
        self._base = annuli.blocks.forward(-(annuli.heights + self._known) / self._compliance)
        self._rise = annuli.unit / self._compliance
        if control == "force":
            self._force_base = annuli.width * np.cumsum(annuli.force_weights * self._base)
            self._force_rise = annuli.width * np.cumsum(annuli.force_weights * self._rise)
        counters.linear_solves += 1
        counters.history_updates += 1

    def penetration(self, contact: int) -> float:
        """Penetration of a contact of that many annuli (at least one)."""
        if self.control == "penetration":
            return self.value
        return float((self.value - self._force_base[contact - 1]) / self._force_rise[contact - 1])

    def forward(self, contact: int) -> Array:
        """``L^-1 v`` (n,)."""
        return self._base[:contact] + self.penetration(contact) * self._rise[:contact]

    def closure(self, contact: int) -> float:
        """Closure integral (Eq. closure), a plain sum over the annuli of the process zone.

        The tension s inside the edge meets the gap ``zone - s`` outside it, which is the gap ``zone`` annuli
        further out. The zone is cut at the centre. A compressive edge counts negative.
        """
        self.counters.closure_evaluations += 1
        annuli, zone = self.annuli, self.annuli.zone
        y, inside = self.forward(contact), min(zone, contact)
        pressure = annuli.blocks.last(y, inside)
        end = contact + zone
        outside = slice(end - inside, end)
        load = annuli.blocks.beyond(y, end)[-inside:]
        lowered = self._compliance * load + self._known[outside] - self.penetration(contact)
        value = -float(pressure @ (annuli.heights[outside] + lowered)) / (2.0 * zone * annuli.width)
        if not math.isfinite(value):
            raise FloatingPointError(
                f"the closure is not finite at contact radius {contact * annuli.width:.6g}"
            )
        return -abs(value) if pressure[-1] > 0.0 else value

    def edge_pressure(self, contact: int) -> float:
        """Pressure of the outermost annulus of a contact, in units of its own (positive: compression)."""
        n = contact - 1
        return float(self._base[n] + self.penetration(contact) * self._rise[n])

    def state(self, contact: int, time: float) -> AnnuliState:
        """The state with that many annuli in contact."""
        annuli = self.annuli
        if contact == 0:
            penetration = self.value if self.control == "penetration" else self.before.penetration
            load, y, scaled = np.zeros(annuli.count), self._base[:0], self._base[:0]
        else:
            penetration, y = self.penetration(contact), self.forward(contact)
            inside = (penetration - annuli.heights[:contact] - self._known[:contact]) / self._compliance
            load = np.concatenate((inside, annuli.blocks.beyond(y, annuli.count)))
            scaled = annuli.blocks.backward(y)
        force = float(annuli.forces(scaled).sum())
        strains = self._decayed + np.outer(load, self._new_share)
        intensity = annuli.stress_intensity(y)
        return AnnuliState(time, penetration, contact, load, strains, scaled, force, intensity)


def equilibrium_contact(
    candidates: ContactCandidates, start: int, most: int, capped: bool, work: float
) -> int | None:
    """Number of annuli in contact at equilibrium, next to ``start``.

    With adhesion, the stable edge lies where the closure rises through the work of adhesion; of the two
    borders around it the one whose closure comes closer is taken. Zero where no stable contact is left.
    Without adhesion, tensile edge annuli are released and overlapping ones covered. ``None`` where contact
    would spread beyond the largest, ``most``, unless the indenter ends there (``capped``).
    """
    n, above = start, None
    if work > 0.0:
        residual = candidates.closure(n) - work if n > 0 else -work
        while residual > 0.0:
            n, above = n - 1, residual
            if n == 0:
                return 0
            residual = candidates.closure(n) - work
        while above is None and n < most:
            beyond = candidates.closure(n + 1) - work
            if beyond > 0.0:
                above = beyond
            else:
                n, residual = n + 1, beyond
        if above is not None:
            return n + 1 if above < -residual else n
    else:
        while n > 0 and candidates.edge_pressure(n) < 0.0:
            n -= 1
        while n < most and candidates.edge_pressure(n + 1) > 0.0:
            n += 1
    return n if n < most or capped else None
