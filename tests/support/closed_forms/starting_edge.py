r"""An edge that sets off from rest at once: what the closure leaves out of the energy balance.

The closure is that of Mandriota, Menga and Carbone, ``I = (1/(2 da)) int_0^da sigma(s) g(da - s) ds = dg``.
An edge at rest over relaxed material, ``da << a``, has ``K^2/(2 E0*) = dg``. Moved so fast that nothing
relaxes on the way, it moves as in a body of modulus ``Einf*`` with the relaxed stress in it. With ``q^2 =
Einf/E0``, after a travel ``x`` and with the amplitude ``k`` of what closing over the gap lays down, an edge
that closes has

    sigma(s) = (k/sqrt(s) - (q^2 - 1) K/sqrt(s - x))/sqrt(2 pi),    g(s) = 4 k sqrt(s/(2 pi))/Einf*,

the second term where ``s > x``, inside of where the edge was at rest. Over ``da - x`` the closure still
meets what relaxed material bears, and ``I = dg`` reads ``k^2 - (1 - x/da) (q^2 - 1) K k = q^2 K^2``. The
field takes up ``k^2/(2 Einf*)`` an area, which is ``dg exp(2 p)`` with

    sinh p = (1 - x/da) (q - 1/q)/2.

Where the edge opens, stress and gap change places, and ``p`` its sign. In an instant no branch dissipates:
what is left of the balance, the loss, changes by ``dg (1 - exp(2 p))`` an area that closes (``p > 0``), and
by ``dg (exp(2 p) - 1)`` an area that opens (``p < 0``). Over the first zone of its travel, per length of
the edge, it falls by ``dg da`` times

    closing: (q - 1) (q^2 + 2 q + 3)/(3 (q + 1)), for large ratios about Einf/(3 E0);
    opening: the same with 1/q for q and its sign changed, at most 1.

From there on ``p = 0``, and the field takes up the work of adhesion. A slower edge loses more on the way.
In a contact of radius ``a`` this holds up to terms of the order of ``da/a``.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]


def closing(ratio: float, travel: ArrayLike = 1.0) -> Array:
    """Fall of the loss where the edge advances, over work of adhesion, zone and length of the edge.

    ``ratio`` is the glassy over the relaxed modulus, ``travel`` that of the edge since it rested, in zones.
    """
    return _fall(ratio, travel, 3.0, -1.0)


def opening(ratio: float, travel: ArrayLike = 1.0) -> Array:
    """The same where the edge recedes."""
    return _fall(ratio, travel, 1.0, -3.0)


def _fall(ratio: float, travel: ArrayLike, rising: float, sinking: float) -> Array:
    """``int 2 sinh|p| exp(p) d(x/da)``, by ``d(sinh p) = cosh p dp`` a sum of two exponentials."""
    most = np.sinh(0.5 * np.log(ratio))
    left = np.arcsinh(most * (1.0 - np.minimum(np.asarray(travel, float), 1.0)))

    def integral(p: ArrayLike) -> Array:
        return np.exp(np.multiply(rising, p)) / rising - np.exp(np.multiply(sinking, p)) / sinking

    return (integral(0.5 * np.log(ratio)) - integral(left)) / (2.0 * most)
