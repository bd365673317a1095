"""Linear viscoelastic material: Prony relaxation modulus.

Young's relaxation modulus ``E(t) = E0 + sum_k E_k exp(-t/tau_k)`` with relaxed modulus ``E0``, glassy
modulus ``Einf = E0 + sum_k E_k`` and *relaxation* times ``tau_k`` (paper, Eq. relaxation: one branch).
The creep compliance and its retardation times follow from it; every solver derives them by itself.
With constant Poisson's ratio the surface sees ``E* = E/(1 - nu^2)``. Units are the scene's.

Laws of few parameters are expanded into a relaxed modulus and branches. Standard linear solid: one branch,
exact. Power law: ``E(t) = relaxed + modulus (t/time)^-n``, from Euler's integral (DLMF 5.2.1, ``s = e^u``)

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
from functools import cached_property
from typing import Annotated, ClassVar, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from contact_scene.checked import Checked, Key, NotNegative, Positive
from contact_scene.errors import SceneError
from contact_scene.value_checks import LARGEST, SMALLEST, Range

NEGLIGIBLE = 1e-31
"""Branches below this fraction of the relaxed modulus are left out of the spectrum: eps^2, never visible."""


@dataclass(frozen=True)
class Branch(Checked):
    """One Maxwell branch, ``modulus * exp(-t/time)``; modulus >= 0, time > 0.

    Examples
    --------
    >>> cc.Branch(modulus=9e6, time=0.1)
    Branch(modulus=9000000.0, time=0.1)
    """

    modulus: Annotated[NotNegative, Key("modulus of the branch", "force length-2")]
    time: Annotated[Positive, Key("relaxation time", "time")]


@dataclass(frozen=True)
class BulkRelaxation(Checked):
    """Bulk relaxation modulus ``K(t) = modulus + sum_k branches[k]``, separate from shear.

    ``modulus`` may be left out (``None``) to keep the relaxed bulk modulus that Young's modulus and
    Poisson's ratio imply, ``E0 / (3 (1 - 2 nu))``.

    Examples
    --------
    >>> bulk = cc.BulkRelaxation(branches=(cc.Branch(2e6, 0.1),))
    >>> cc.Material(1e6, 0.3, (cc.Branch(9e6, 0.1),), bulk).bulk is bulk
    True
    """

    modulus: Annotated[Positive | None, Key("relaxed bulk modulus", "force length-2")] = None
    branches: Annotated[tuple[Branch, ...], Key("Maxwell branches of the bulk modulus")] = ()


@dataclass(frozen=True)
class Material(Checked):
    """Prony material with a constant Poisson's ratio (or, with ``bulk``, separate bulk relaxation).

    Without ``bulk`` bulk and shear relax alike. Otherwise ``E(t)/(2 (1 + nu))`` is the *shear* relaxation
    modulus, and the bulk modulus is as given, or constant at ``E0/(3 (1 - 2 nu))`` (``"elastic"``).

    Examples
    --------
    >>> rubber = cc.Material(1e6, 0.5, (cc.Branch(9e6, 0.1),))
    >>> rubber.glassy_modulus
    10000000.0
    """

    modulus: Annotated[Positive, Key("relaxed Young's modulus", "force length-2")]
    poisson: Annotated[float, Range("0 <= nu <= 0.5", 0.0, 0.5), Key("Poisson's ratio", "1")]
    branches: Annotated[tuple[Branch, ...], Key("Maxwell branches of Young's modulus")] = ()
    bulk: Annotated[
        Literal["elastic"] | BulkRelaxation | None, Key("bulk modulus that relaxes by itself, or not at all")
    ] = None

    def rules(self) -> None:
        own_bulk = isinstance(self.bulk, BulkRelaxation) and self.bulk.modulus is not None
        if self.bulk is not None and self.poisson == 0.5 and not own_bulk:
            problem = "poisson = 0.5 leaves the bulk modulus infinite"
            raise SceneError("bulk", problem, "poisson < 0.5, or a bulk modulus of its own")
        if self.glassy_modulus > LARGEST:
            problem = f"the glassy modulus is {self.glassy_modulus:g}"
            raise SceneError("branches", problem, f"a sum of at most {LARGEST:g}")

    @property
    def glassy_modulus(self) -> float:
        """``Einf = E(0)``."""
        return self.modulus + sum(branch.modulus for branch in self.branches)

    @property
    def relaxed_plane_modulus(self) -> float:
        """``E0* = E0/(1 - nu^2)``."""
        return self.modulus / (1.0 - self.poisson**2)

    @property
    def glassy_plane_modulus(self) -> float:
        """``Einf* = Einf/(1 - nu^2)`` (the paper's text has a typing slip here)."""
        return self.glassy_modulus / (1.0 - self.poisson**2)

    @cached_property
    def spectrum(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Branch moduli and relaxation times that matter, ascending in time.

        Branches of negligible modulus (``NEGLIGIBLE``, zero included) are left out, equal times are joined;
        both arrays have shape (n,).
        """
        joined: dict[float, float] = {}
        for branch in self.branches:
            if branch.modulus > NEGLIGIBLE * self.modulus:
                joined[branch.time] = joined.get(branch.time, 0.0) + branch.modulus
        times = np.array(sorted(joined), float)
        return np.array([joined[t] for t in times], float), times

    @property
    def is_elastic(self) -> bool:
        """Whether nothing relaxes."""
        separate = isinstance(self.bulk, BulkRelaxation) and any(b.modulus > 0 for b in self.bulk.branches)
        return self.spectrum[0].size == 0 and not separate

    def relaxation_modulus(self, time: ArrayLike) -> NDArray[np.float64]:
        """``E(t)`` for ``time >= 0``, zero before; same shape as ``time``."""
        moduli, times = self.spectrum
        t = np.asarray(time, float)
        value = self.modulus + np.exp(-np.maximum(t, 0.0)[..., None] / times) @ moduli
        return np.where(t >= 0, value, 0.0)

    def complex_modulus(self, angular_frequency: ArrayLike) -> NDArray[np.complex128]:
        """``E(omega) = E0 + sum_k E_k i w tau_k/(1 + i w tau_k)``: storage + i loss modulus."""
        moduli, times = self.spectrum
        p = np.asarray(angular_frequency, float)[..., None] * times
        length = np.hypot(1.0, p)  # p^2 would overflow
        in_phase, out_of_phase = 1.0 / length, p / length
        return self.modulus + (out_of_phase * (out_of_phase + 1j * in_phase)) @ moduli.astype(complex)

    def storage_modulus(self, angular_frequency: ArrayLike) -> NDArray[np.float64]:
        """Real part of :meth:`complex_modulus`."""
        return self.complex_modulus(angular_frequency).real

    def loss_modulus(self, angular_frequency: ArrayLike) -> NDArray[np.float64]:
        """Imaginary part of :meth:`complex_modulus`."""
        return self.complex_modulus(angular_frequency).imag


# Laws of few parameters

WIDEST_SPACING = math.log(10.0)
"""In log time: at least one branch a decade. Wider spacings may still keep ``E(t)`` to the stated error, but
the loss modulus would show a peak for each branch (a Debye peak is 1.14 decades wide at half its height)."""


class RelaxationLaw(Checked):
    """A law of few parameters; each kind expands it into a ``series``."""

    tag = "model"
    model: ClassVar[str]

    def series(self) -> tuple[float, tuple[Branch, ...]]:
        """Relaxed modulus and branches, ascending in time."""
        raise AssertionError("defined by every law")

    def material(self, poisson: float) -> Material:
        """The law as a material."""
        modulus, branches = self.series()
        return Material(modulus, poisson, branches)


@dataclass(frozen=True)
class StandardLinearSolid(RelaxationLaw):
    """``E(t) = relaxed + (glassy - relaxed) exp(-t/time)``.

    Examples
    --------
    >>> cc.StandardLinearSolid(relaxed=1e6, glassy=1e7, time=0.1).material(0.5).branches
    (Branch(modulus=9000000.0, time=0.1),)
    """

    model: ClassVar[str] = "standard-linear"
    relaxed: Annotated[Positive, Key("Young's modulus at rest", "force length-2")]
    glassy: Annotated[Positive, Key("Young's modulus at once, above relaxed", "force length-2")]
    time: Annotated[Positive, Key("relaxation time", "time")]

    def rules(self) -> None:
        if self.glassy <= self.relaxed:
            raise SceneError("glassy", f"got {self.glassy!r}", f"a modulus above relaxed, {self.relaxed!r}")

    def series(self) -> tuple[float, tuple[Branch, ...]]:
        return self.relaxed, (Branch(self.glassy - self.relaxed, self.time),)


@dataclass(frozen=True)
class PowerLawRelaxation(RelaxationLaw):
    """``E(t) = relaxed + modulus (t/time)^-exponent`` for ``t`` in ``range``, to ``error``.

    Examples
    --------
    >>> law = cc.PowerLawRelaxation(0.2, modulus=1e3, time=1.0, range=(1e-3, 1e3))
    >>> len(law.material(0.5).branches)
    23
    """

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


MODELS = (PowerLawRelaxation, StandardLinearSolid)
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
