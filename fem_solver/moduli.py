"""Relaxing moduli: Prony series whose variables are updated exactly, and the one modulus of a surface.

A modulus ``m(t) = m_0 + sum_k m_k exp(-t/tau_k)`` acts on a strain-like quantity ``x`` (a number, a surface
vector, a field at quadrature points: all alike) as

    ``s = m_0 x + sum_k b_k``,   ``b_k' = -b_k/tau_k + m_k x'``.

Over a step ``dt`` in which ``x`` is linear in time, exactly,

    ``b_k <- exp(-y_k) b_k + m_k phi(y_k) dx``,   ``y_k = dt/tau_k``,   ``phi(y) = (1 - exp(-y))/y``,

so ``s = m_hat x + memory`` with the algorithmic modulus ``m_hat = m_0 + sum_k m_k phi(y_k)``. The formulas
hold from ``dt = 0`` (the glassy jump) to ``dt = inf`` (fully relaxed). A parabola, ``bend theta (theta - 1)``
beyond the line over the share ``theta`` of the step, adds ``m_k (2 (1 - phi(y_k))/y_k - phi(y_k)) bend``.

Shear and bulk of a material are such series. A frictionless surface answers with two moduli in series,
``1/E* = 1/(4 G) + 3/(4 (3 K + G))``, whatever relaxes; as one, ``G``, where all relax alike. The energies are
those of the body: what ``1/(2 G)`` answers to the pressures of the surface changes no volume, what
``3/(2 (3 K + G))`` answers does, and holds a third of its shear energy beside it; neither works on the other,
and each energy is a multiple of the same form of the pressures (by Clapeyron's theorem, from the derivatives
of ``1/E*`` with respect to G and K).
"""

from __future__ import annotations

import math
import sys
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from contact_scene import BulkRelaxation, Material

Array = NDArray[np.float64]

_SHORT = 1e-3
"""Time, relative to a relaxation or retardation time, below which a series replaces a difference of nearly
equal numbers."""


def phi(y: Array) -> Array:
    """``(1 - exp(-y))/y`` with ``phi(0) = 1`` and ``phi(inf) = 0``."""
    y = np.maximum(y, sys.float_info.min)
    return np.asarray(-np.expm1(-y) / y)


def mean_phi(y: Array) -> Array:
    """``(1 - phi(y))/y``, the mean over a time of the mean so far of what decays; 1/2 at 0."""
    short, long = np.minimum(y, _SHORT), np.maximum(y, _SHORT)
    series = 0.5 - short / 6.0 + short**2 / 24.0 - short**3 / 120.0
    return np.where(y > _SHORT, (1.0 - phi(long)) / long, series)


def bend_through(first: float, middle: float, last: float) -> float:
    """``bend`` of the parabola through the begin, the middle and the end of a step."""
    return 2.0 * (first + last) - 4.0 * middle


@dataclass(frozen=True)
class Increment:
    """Coefficients of one step; ``decay``, ``gain`` and ``bent`` have shape (branches,)."""

    modulus: float
    decay: Array
    gain: Array
    bent: Array

    def memory(self, branches: Array, x: Array | float) -> Array:
        """Part of the new stress that the old state determines: ``sum_k decay_k b_k - gain_k x``.

        ``branches`` has shape (branches,) or (branches, m), ``x`` the shape of one of them.
        """
        return self.decay @ branches - self.gain.sum() * np.asarray(x)

    def advance(self, branches: Array, dx: Array | float, bend: Array | float = 0.0) -> Array:
        """Branch variables at the end of the step, in which ``x`` may go on a parabola."""
        shape = (-1, *(1,) * (branches.ndim - 1))
        new = self.decay.reshape(shape) * branches + self.gain.reshape(shape) * np.asarray(dx)
        return new + self.bent.reshape(shape) * np.asarray(bend)


@dataclass(frozen=True)
class Prony:
    """Relaxing modulus; ``moduli`` and ``times`` have shape (branches,)."""

    relaxed: float
    moduli: Array
    times: Array

    @property
    def glassy(self) -> float:
        """``m(0)``."""
        return self.relaxed + float(self.moduli.sum())

    def scaled(self, factor: float) -> Prony:
        """The modulus times a number."""
        return Prony(self.relaxed * factor, self.moduli * factor, self.times)

    def plus(self, other: Prony) -> Prony:
        """Sum of two moduli, branches side by side."""
        moduli, times = np.append(self.moduli, other.moduli), np.append(self.times, other.times)
        return Prony(self.relaxed + other.relaxed, moduli, times)

    def increment(self, dt: float) -> Increment:
        """Coefficients of a step ``0 <= dt <= inf``."""
        y = dt / self.times
        gain = self.moduli * phi(y)
        bent = self.moduli * (2.0 * mean_phi(y) - phi(y))
        return Increment(self.relaxed + float(gain.sum()), np.exp(-y), gain, bent)

    def loss_weights(self, dt: float) -> Array:
        """Weights of the energy dissipated in each branch over a step, shape (3, branches).

        A Maxwell branch of stored energy ``Q(b, b)/2`` dissipates ``Q(b, b)/tau``. With
        ``b(t) = exp(-t/tau) b_0 + m tau/dt (1 - exp(-t/tau)) dx`` the loss over the step is
        ``w_0 Q(b_0, b_0) + w_1 Q(b_0, m dx) + w_2 Q(m dx, m dx)``; these are the weights.
        """
        y = dt / self.times
        one, two = phi(y), phi(2.0 * y)
        with np.errstate(invalid="ignore", divide="ignore"):
            curved = np.where(y < _SHORT, y / 3.0 - y**2 / 4.0, (1.0 - 2.0 * one + two) / y)
        return np.stack([y * two, 2.0 * (one - two), curved])

    def bent_loss(self, dt: float, b: Array, dx: Array, bend: Array) -> Array:
        """What the bend of a parabola adds to the energy dissipated in all branches, shape of ``dx``.

        A branch takes up ``int b x' dt``, less what it stores; with ``theta`` the share of the step,
        ``int b dtheta`` and ``int b theta dtheta`` follow from its equation.
        """
        y, m = (dt / self.times)[:, None], self.moduli[:, None]
        straight = np.exp(-y) * b + m * phi(y) * dx
        bent = m * (2.0 * mean_phi(y) - phi(y)) * bend
        mean, moment = (m * dx - straight + b) / y, (m * dx / 2.0 - straight) / y
        moment, of_mean = moment + mean / y, -bent / y
        of_moment = (m * bend / 6.0 - bent + of_mean) / y
        lost = dx * of_mean - bend * (mean + of_mean) + 2.0 * bend * (moment + of_moment)
        lost -= bent * (straight + 0.5 * bent) / m
        short = -y * bend * (b / 3.0 + m * (dx / 6.0 - bend / 30.0))
        return np.asarray(np.where(y > _SHORT, lost, short).sum(axis=0))

    def mean_loss_weights(self, dt: float) -> Array:
        """Means of :meth:`loss_weights` over durations from 0 to ``dt``, with ``dx`` in proportion to them.

        They belong to parts of a whole that take the strain for evenly distributed durations; shape
        (3, branches), for the ``dx`` of the longest.
        """
        y = dt / self.times
        one, two = mean_phi(y), mean_phi(2.0 * y)
        with np.errstate(invalid="ignore", divide="ignore"):
            curved = np.where(y < _SHORT, y / 12.0 - y**2 / 20.0, (0.5 - 2.0 * one + two) / y)
        return np.stack([y * two, 2.0 * (one - two), curved])


_LEAST_SHARE = 1e-14
"""Modulus of a branch, relative to the glassy one, that is a rounding error."""


class OneModulus:
    """Two moduli that bear the same stress, as one of the sum of their strains.

    The energy of springs and dashpots over the strain ``x`` and those ``q`` of the dashpots of both,
    ``m(0) x^2/2 - x g.q + q.H q/2`` once the strain of the first modulus is eliminated, with the loss
    ``sum_k m_k tau_k q_k'^2``: in the eigenvectors of ``H`` with respect to that loss each internal variable
    goes its own way, as in a Maxwell branch, with the same energies. What no strain reaches is left out.
    """

    def __init__(self, one: Prony, other: Prony) -> None:
        whole = one.glassy + other.glassy
        self._share = other.glassy / whole  # of the strain, taken by the first modulus in a jump
        self._count = len(one.moduli)
        coupling = np.append(self._share * one.moduli, (1.0 - self._share) * other.moduli)
        self._signed = np.append(one.moduli, -other.moduli) / whole
        stiffness = np.diag(np.append(one.moduli, other.moduli))
        stiffness -= whole * np.outer(self._signed, self._signed)
        root = np.sqrt(np.append(one.moduli * one.times, other.moduli * other.times))
        rates, modes = np.linalg.eigh(stiffness / np.outer(root, root))
        amplitudes = modes.T @ (coupling / root)
        moduli = amplitudes**2 / rates
        reached = moduli > _LEAST_SHARE * one.glassy * self._share
        relaxed = one.relaxed * other.relaxed / (one.relaxed + other.relaxed)
        self.modulus = Prony(relaxed, moduli[reached], 1.0 / rates[reached])
        self._dashpots = (modes[:, reached] * (amplitudes / rates)[reached]) / root[:, None]

    def parts(self, x: Array, branches: Array) -> tuple[StrainedModulus, StrainedModulus]:
        """What both moduli have gone through."""
        dashpots = self._dashpots @ (x - branches / self.modulus.moduli[:, None])
        first = self._share * x + self._signed @ dashpots
        own, others = dashpots[: self._count], dashpots[self._count :]
        return StrainedModulus(first, first - own), StrainedModulus(x - first, x - first - others)


@dataclass(frozen=True)
class StrainedModulus:
    """Strain of a modulus, shape (n,), and of the springs of its branches, (branches, n)."""

    whole: Array
    springs: Array


@dataclass(frozen=True)
class Moduli:
    """Shear and bulk relaxation; ``bulk`` is ``None`` if incompressible."""

    shear: Prony
    bulk: Prony | None
    alike: bool

    @property
    def ratio(self) -> float:
        """Relaxed ``G/K``."""
        return 0.0 if self.bulk is None else self.shear.relaxed / self.bulk.relaxed

    @property
    def instantaneous_ratio(self) -> float:
        """Glassy ``G/K``."""
        if self.alike or self.bulk is None:
            return self.ratio
        return self.shear.glassy / self.bulk.glassy

    @property
    def unit_plane_modulus(self) -> float:
        """``E*`` of the glassy solid at unit shear modulus, ``2/(1 - nu)``."""
        ratio = self.instantaneous_ratio
        poisson = (3.0 - 2.0 * ratio) / (2.0 * (3.0 + ratio))
        return 2.0 / (1.0 - poisson)

    @property
    def surface(self) -> Prony:
        """``E*(t)`` over :attr:`unit_plane_modulus`, what the surface answers with (``series``)."""
        return self.shear if self.series is None else self.series.modulus

    @property
    def series(self) -> OneModulus | None:
        """``4 G`` and ``4 (3 K + G)/3`` as one, over :attr:`unit_plane_modulus`; ``None`` if all relax alike.

        The branches of the second are those of the bulk, then those of the shear.
        """
        if self.alike or self.bulk is None:
            return None
        unit = 4.0 / self.unit_plane_modulus
        joined = self.bulk.scaled(unit).plus(self.shear.scaled(unit / 3.0))
        return OneModulus(self.shear.scaled(unit), joined)


def moduli(material: Material) -> Moduli:
    """Shear modulus ``E(t)/(2 (1 + nu))`` and what ``material.bulk`` makes of the bulk modulus."""
    values, times = material.spectrum
    young = Prony(material.modulus, values, times)
    shear = young.scaled(0.5 / (1.0 + material.poisson))
    compressible = material.poisson < 0.5
    factor = 1.0 / (3.0 * (1.0 - 2.0 * material.poisson)) if compressible else math.inf
    if material.bulk is None:
        return Moduli(shear, young.scaled(factor) if compressible else None, True)
    none = np.zeros(0)
    if isinstance(material.bulk, BulkRelaxation):
        relaxed = material.bulk.modulus or material.modulus * factor
        branches = [branch for branch in material.bulk.branches if branch.modulus > 0.0]
        bulk = Prony(
            relaxed,
            np.array([b.modulus for b in branches], float),
            np.array([b.time for b in branches], float),
        )
    else:
        bulk = Prony(material.modulus * factor, none, none)
    return Moduli(shear, bulk, shear.times.size == 0 and bulk.times.size == 0)
