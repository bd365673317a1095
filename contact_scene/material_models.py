"""Relaxation laws of few parameters, expanded into a relaxed modulus and Maxwell branches.

Standard linear solid: one branch, exact. Power law: ``E(t) = relaxed + modulus (t/time)^-n``, from Euler's
integral (DLMF 5.2.1 with ``s = e^u``)

    (t/time)^-n = 1/Gamma(n) int_-inf^inf (time e^u)^n exp(-t e^u) du

by the trapezoidal rule: a branch of time ``e^-u`` at every multiple of the spacing ``h``. Three errors, each
relative to the power law and each bounded from above, make up the stated one:

- spacing: by Poisson's summation formula the rule is off by ``2 sum_m |Gamma(n + 2 pi i m/h)|/Gamma(n)`` at
  most, for every ``t`` alike (half of the stated error);
- branches faster than the range are left out: at its start they hold at most the regularised incomplete
  gamma function ``Q(n, t_min/tau)`` of the fastest one kept (a quarter);
- branches slower than the range are taken as relaxed: an error ``1 - exp(-x) <= x`` at its end (a quarter).

Outside the range the expansion levels off: at the glassy modulus before it, at the relaxed modulus after it.
The complex modulus at ``w`` feels both ends: branches left out take ``(w tau)^(1-n) sin(pi n)/(pi (1-n))`` of
it at most, ``tau`` the fastest time kept, and the relaxed ones ``(w tau)^-(1+n) sin(pi n)/(pi (1+n))``.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Annotated, ClassVar

import numpy as np

from contact_scene.checked import Checked, Key, Kinds, NotNegative, Positive
from contact_scene.errors import SceneError
from contact_scene.material import Branch, Material
from contact_scene.value_checks import LARGEST, SMALLEST, Range

WIDEST_SPACING = math.log(10.0)
"""In log time: at least one branch a decade. Wider spacings may still keep ``E(t)`` to the stated error, but
the loss modulus would show a peak for each branch (a Debye peak is 1.14 decades wide at half its height)."""


@dataclass(frozen=True)
class StandardLinearSolid(Checked):
    """``E(t) = relaxed + (glassy - relaxed) exp(-t/time)``."""

    tag = "model"
    model: ClassVar[str] = "standard-linear"
    relaxed: Annotated[Positive, Key("Young's modulus at rest", "force length-2")]
    glassy: Annotated[Positive, Key("Young's modulus at once, above relaxed", "force length-2")]
    time: Annotated[Positive, Key("relaxation time", "time")]

    def rules(self) -> None:
        if self.glassy <= self.relaxed:
            raise SceneError("glassy", f"got {self.glassy!r}", f"a modulus above relaxed, {self.relaxed!r}")

    def series(self) -> tuple[float, tuple[Branch, ...]]:
        """Relaxed modulus and the one branch."""
        return self.relaxed, (Branch(self.glassy - self.relaxed, self.time),)

    def material(self, poisson: float) -> Material:
        """The solid as a material."""
        modulus, branches = self.series()
        return Material(modulus, poisson, branches)


@dataclass(frozen=True)
class PowerLawRelaxation(Checked):
    """``E(t) = relaxed + modulus (t/time)^-exponent`` for ``t`` in ``range``, to ``error``."""

    tag = "model"
    model: ClassVar[str] = "power-law"
    exponent: Annotated[float, Range("0 < exponent < 1", 0.0, 1.0, open=True), Key("exponent", "1")]
    modulus: Annotated[Positive, Key("Young's modulus of the power law at time", "force length-2")]
    time: Annotated[Positive, Key("time at which the modulus is stated", "time")]
    range: Annotated[tuple[Positive, ...], Key("first and last time at which the law holds", "time")]
    error: Annotated[
        float, Range("1e-12 <= error <= 0.1", 1e-12, 0.1), Key("largest relative error within range", "1")
    ] = 1e-4
    relaxed: Annotated[NotNegative, Key("Young's modulus added to the power law", "force length-2")] = 0.0

    def rules(self) -> None:
        if len(self.range) != 2 or self.range[0] >= self.range[1]:
            raise SceneError("range", f"got {list(self.range)}", "two times, first < last")

    def series(self) -> tuple[float, tuple[Branch, ...]]:
        """Relaxed modulus and branches, ascending in time."""
        n, first, last = self.exponent, *self.range
        spacing = spacing_of(n, 0.5 * self.error)
        log_fastest = math.log(first) - math.log(_fastest_rate(n, 0.25 * self.error))
        log_slowest = math.log(last) - _log_slowest_rate(n, spacing, 0.25 * self.error)
        count = math.ceil((log_slowest - log_fastest) / spacing) + 1
        log_times = log_fastest + spacing * np.arange(count)
        allowed = f"times and moduli from {SMALLEST:g} to {LARGEST:g}"
        if not (math.log(SMALLEST) <= log_times[0] and log_times[-1] <= math.log(LARGEST)):
            reached = f"{_power(float(log_times[0]))} to {_power(float(log_times[-1]))}"
            raise SceneError("range", f"needs relaxation times from {reached}", allowed)
        log_moduli = (
            math.log(self.modulus)
            + math.log(spacing)
            - math.lgamma(n)
            + n * (math.log(self.time) - log_times)
        )
        # all slower branches, which are taken as relaxed: a geometric series
        log_rest = float(log_moduli[-1]) - math.log(math.expm1(n * spacing))
        if max(float(log_moduli[0]), log_rest) > math.log(LARGEST) or log_rest < math.log(SMALLEST):
            raise SceneError(
                "modulus",
                f"the branches would have moduli from {_power(log_rest)} to {_power(float(log_moduli[0]))}",
                allowed,
            )
        branches = tuple(
            Branch(float(modulus), float(time))
            for modulus, time in zip(np.exp(log_moduli), np.exp(log_times), strict=True)
        )
        return self.relaxed + math.exp(log_rest), branches

    def material(self, poisson: float) -> Material:
        """The expansion as a material."""
        modulus, branches = self.series()
        return Material(modulus, poisson, branches)


MODELS = Kinds((PowerLawRelaxation, StandardLinearSolid))
"""What a file may state under ``material.model``, beside a Prony series."""


def spacing_error(exponent: float, spacing: float) -> float:
    """Largest relative error of the trapezoidal rule with ``spacing`` in log time, for any ``t``.

    ``2 sum_m |Gamma(n + 2 pi i m/h)|/Gamma(n)``; the terms fall faster than geometrically with ``m``.
    """
    from scipy.special import loggamma

    m = np.arange(1, 40)
    log_terms = loggamma(exponent + 2j * math.pi * m / spacing).real - math.lgamma(exponent)
    return 2.0 * float(np.exp(np.maximum(log_terms, -700.0)).sum())


def spacing_of(exponent: float, error: float) -> float:
    """Widest spacing in log time, to within 1 %, with a :func:`spacing_error` of at most ``error``."""
    spacing = WIDEST_SPACING
    while spacing_error(exponent, spacing) > error:
        spacing /= 1.01
    return spacing


def _fastest_rate(n: float, error: float) -> float:
    """Smallest ``t_min/tau`` with ``Q(n, t_min/tau) <= error``; at least 1: the bound holds from ``n`` on."""
    from scipy.special import gammainccinv

    return max(float(gammainccinv(n, error)), 1.0)


def _log_slowest_rate(n: float, spacing: float, error: float) -> float:
    """Log of the largest ``t_max/tau``, at most 1, below which all branches may be taken as relaxed."""
    log_sum = math.log(error) + math.lgamma(n) + math.log(math.expm1((n + 1.0) * spacing) / spacing)
    return min(log_sum / (n + 1.0), 0.0)


def _power(log: float) -> str:
    """``e^log`` as a power of ten, which may lie outside the floating-point numbers."""
    return f"1e{log / math.log(10.0):.0f}"
