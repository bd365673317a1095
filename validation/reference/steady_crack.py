r"""Steady opening and closing edge in a viscoelastic half-space with a process zone of fixed length.

The closure is that of Mandriota, Menga and Carbone, ``(1/(2 da)) int_0^da sigma(s) g(da - s) ds = dg``: the
stress at distance ``s`` inside the edge meets the gap at distance ``da - s`` outside. Semi-infinite contact
(``da << a``), edge moving at constant speed ``v``, relaxed far away, so that the apparent energy release
rate is ``G = K^2/(2 E0*)`` with the far stress intensity ``K``. Stress and gap are both half-line
convolutions with ``s^(-1/2)`` and ``s^(1/2)``, and ``int_0^y s^(-1/2) (y - s)^(-1/2) ds = pi`` for every
``y``.

**Opening.** A point now at distance ``s`` outside was released ``s/v`` ago; inside, tractions follow the
moving elastic field, ``sigma = K/sqrt(2 pi s)``, and the gap is the creep answer to it,
``g(s) = 2 K sqrt(2/pi) int_0^s J*((s - y)/v) dy/(2 sqrt(y))``. The closure is a convolution of
``s^(-1/2)``, ``s^(-1/2)`` and ``J*`` taken at ``da``:

    dg = (K^2/2) (1/da) int_0^da J*(y/v) dy       =>    G/dg = J*(inf) / mean of J* over [0, da/v],

for one branch ``[1 - (1 - E0/Einf)(1 - exp(-X))/X]^(-1)``, ``X = da/(v theta)``.

**Closing.** A point now at distance ``s`` inside was covered ``s/v`` ago; outside it has always been free,
so now the *gap* follows the moving elastic field, ``g = 2 N sqrt(2 s/pi)``, and the stress is the
relaxation answer, ``sigma(s) = d/ds int_0^s E*((s - y)/v) N/sqrt(2 pi y) dy``: near the edge
``Einf* N/sqrt(2 pi s)``, far from it ``E0* N/sqrt(2 pi s)``, so ``K = E0* N``. Moving the derivative onto
``g``, which vanishes at the edge,

    dg = (N^2/2) (1/da) int_0^da E*(y/v) dy       =>    G/dg = E0* / mean of E* over [0, da/v],

for one branch ``[1 + (Einf/E0 - 1)(1 - exp(-Y))/Y]^(-1)``, ``Y = da/(v tau)``. Opening runs from 1 (slow) to
``Einf/E0`` (fast), closing from 1 to ``E0/Einf``; retardation times rule the first, relaxation times the
second.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from contact_scene import Material
from validation.reference.prony_integrals import mean_creep, mean_relaxation

Array = NDArray[np.float64]


def opening(material: Material, zone: float, speed: ArrayLike) -> Array:
    """``G/dg`` of an edge with a ``zone`` of length ``da`` that recedes at ``speed > 0``; its shape."""
    relaxed = 1.0 / material.relaxed_plane_modulus
    return relaxed / mean_creep(material, zone / np.asarray(speed, float))


def closing(material: Material, zone: float, speed: ArrayLike) -> Array:
    """``G/dg`` of an edge that advances at ``speed > 0``; same shape as ``speed``."""
    return material.relaxed_plane_modulus / mean_relaxation(material, zone / np.asarray(speed, float))
