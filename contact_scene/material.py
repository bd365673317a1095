"""Linear viscoelastic half-space: Prony relaxation modulus.

Young's relaxation modulus ``E(t) = E0 + sum_k E_k exp(-t/tau_k)`` with relaxed modulus ``E0``, glassy
modulus ``Einf = E0 + sum_k E_k`` and *relaxation* times ``tau_k`` (paper, Eq. relaxation: one branch).
The creep compliance and its retardation times follow from it; every solver derives them by itself.
With constant Poisson's ratio the half-space sees ``E* = E/(1 - nu^2)``. Units are the scene's.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Annotated, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from contact_scene.checked import Checked, Key, NotNegative, Positive
from contact_scene.errors import SceneError
from contact_scene.value_checks import LARGEST, Range

NEGLIGIBLE = 1e-31
"""Branches below this fraction of the relaxed modulus are left out of the spectrum: eps^2, never visible."""


@dataclass(frozen=True)
class Branch(Checked):
    """One Maxwell branch, ``modulus * exp(-t/time)``; modulus >= 0, time > 0."""

    modulus: Annotated[NotNegative, Key("modulus of the branch", "force length-2")]
    time: Annotated[Positive, Key("relaxation time", "time")]


@dataclass(frozen=True)
class BulkRelaxation(Checked):
    """Bulk relaxation modulus ``K(t) = modulus + sum_k branches[k]``, separate from shear.

    ``modulus`` may be left out (``None``) to keep the relaxed bulk modulus that Young's modulus and
    Poisson's ratio imply, ``E0 / (3 (1 - 2 nu))``.
    """

    modulus: Annotated[Positive | None, Key("relaxed bulk modulus", "force length-2")] = None
    branches: Annotated[tuple[Branch, ...], Key("Maxwell branches of the bulk modulus")] = ()


@dataclass(frozen=True)
class Material(Checked):
    """Prony material with a constant Poisson's ratio (or, with ``bulk``, separate bulk relaxation).

    Parameters
    ----------
    modulus : float
        Relaxed Young's modulus ``E0`` > 0.
    poisson : float
        Poisson's ratio, 0 <= nu <= 0.5.
    branches : tuple of Branch
        Maxwell branches of Young's modulus; none for an elastic half-space.
    bulk : None, "elastic" or BulkRelaxation
        ``None``: Poisson's ratio is constant, bulk and shear relax alike. Otherwise
        ``E(t)/(2 (1 + nu))`` is the *shear* relaxation modulus, and the bulk modulus is constant
        at ``E0/(3 (1 - 2 nu))`` (``"elastic"``) or as given.
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
