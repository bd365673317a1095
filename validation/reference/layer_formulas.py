"""Published formulas for elastic layers: to be compared with, never to compute with.

Each is the load over that on a half-space. Spheres, at one penetration, in ``chi = sqrt(R D)/h``:

- E.K. Dimitriadis, F. Horkay, J. Maresca, B. Kachar, R.S. Chadwick, Biophys. J. 82, 2798 (2002), Eq. 12
  (incompressible, bonded) and Eq. 13 (not bonded); the exact second-order term is 7/6 of theirs.
- P.D. Garcia, R. Garcia, Biophys. J. 114, 2923 (2018), Eq. 27: incompressible, bonded.

Flat punches, in ``a/h``, bonded:

- K.R. Shull, D. Ahn, W.-L. Chen, C.M. Flanigan, A.J. Crosby, Macromol. Chem. Phys. 199, 489 (1998):
  incompressible.
- W.C. Hayes, L.M. Keer, G. Herrmann, L.F. Mockros, J. Biomech. 5, 541 (1972): tables, by Poisson's ratio;
  three rows as they are commonly quoted, the original was not at hand.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import partial
from typing import Any

from numpy.polynomial.polynomial import polyval

SPHERES: Mapping[str, tuple[str, Callable[..., Any]]] = {
    "Dimitriadis 2002": ("bonded", partial(polyval, c=(1.0, 1.133, 1.283, 0.769, 0.0975))),
    "Garcia 2018": ("bonded", partial(polyval, c=(1.0, 1.133, 1.497, 1.469, 0.755))),
    "Dimitriadis 2002, not bonded": ("frictionless", partial(polyval, c=(1.0, 0.884, 0.781, 0.386, 0.0048))),
}
"""Base, and force over Hertz's for arrays of ``chi``; incompressible."""
PUNCHES: Mapping[str, Callable[..., Any]] = {"Shull 1998": partial(polyval, c=(1.0, 4 / 3, 0.0, 4 / 3))}
"""Stiffness over ``2 E* a`` for arrays of ``a/h``; bonded, incompressible."""
HAYES: Mapping[float, tuple[float, ...]] = {
    0.2: (1.207, 1.232, 1.252, 1.281),
    1.0: (2.480, 2.789, 3.085, 3.609),
    3.0: (6.218, 7.923, 10.235, 17.862),
}
"""Stiffness over ``2 E* a`` by ``a/h``, for Poisson's ratio 0.3, 0.4, 0.45, 0.5; bonded."""
