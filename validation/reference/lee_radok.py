"""Lee and Radok (1960): viscoelastic half-space under an indenter whose contact grows, without adhesion.

E.H. Lee, J.R.M. Radok, J. Appl. Mech. 27, 438 (sphere); T.C.T. Ting, J. Appl. Mech. 33, 845 (1966) (any
profile). While ``a`` grows it depends on the present penetration alone, ``D = G(a)``, and

    F(t) = int_0^t E*(t - s) 2 a(s) D'(s) ds,

the elastic force per unit modulus (whose derivative with respect to ``D`` is ``2 a``) under the relaxation
integral. In Sneddon's coordinate, a point ``x`` reached at ``t_x`` carries
``q = int_(t_x)^t E*(t-s) D'(s) ds`` and ``F = 2 int_0^a q dx``; at constant speed ``V``,
``q = V I(t - t_x)`` with ``I`` the integral of ``E*``. The dual holds with the force given: the elastic
force per unit modulus is ``int J*(t - s) dF(s)``. ``F > 0`` presses, ``D > 0`` downwards, ``t = 0`` at
first touch, nothing before.
"""

from __future__ import annotations

from collections.abc import Callable
from itertools import pairwise

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.integrate import quad
from scipy.special import hyp1f1

from contact_scene import FlatPunch, Indenter, Material, TabulatedProfile
from validation.reference import prony_integrals, sneddon

Array = NDArray[np.float64]
_ACCURACY = {"epsabs": 0.0, "epsrel": 1e-11, "limit": 400}
"""Options of the adaptive quadrature."""


def ramp(material: Material, indenter: Indenter, rate: float, time: ArrayLike) -> tuple[Array, Array]:
    """Contact radius and force for ``D = rate * t``; each of the shape of ``time``.

    Parameters
    ----------
    material : Material
    indenter : Indenter
    rate : float
        Speed of the indenter.
    time : array_like
        Time since the start of the load.

    Returns
    -------
    tuple of ndarray
        Contact radius and force, of the shape of ``time``.
    """
    t = np.asarray(time, float)
    radius = np.vectorize(lambda at: sneddon.contact_radius(indenter, rate * at), otypes=[float])(t)
    swept = np.vectorize(lambda at: ramp_integral(material, indenter, rate, at, at), otypes=[float])(t)
    return radius, 2.0 * rate * swept


def ramp_integral(material: Material, indenter: Indenter, rate: float, covered: float, time: float) -> float:
    """``int_0^a I(t - t_x) dx`` over the points a ramp of speed ``rate`` covered until ``covered <= time``.

    By parts it is ``int_0^covered E*(t - s) a(s) ds + a I(t - covered)``. With ``a = alpha s^(1/n)`` and
    ``p = 1 + 1/n`` each branch gives Kummer's function,
    ``int_0^c exp(-(t-s)/tau) s^(p-1) ds = exp(-(t-c)/tau) (c^p/p) 1F1(1; 1+p; -c/tau)``.

    Parameters
    ----------
    material : Material
    indenter : Indenter
    rate : float
        Speed of the indenter.
    covered : float
        Time until which points have been covered.
    time : float

    Returns
    -------
    float
        Stress times length.
    """
    radius = sneddon.contact_radius(indenter, rate * covered)
    if isinstance(indenter, FlatPunch):
        return radius * float(prony_integrals.relaxation_integral(material, time))
    law = sneddon.power_law(indenter)
    if law is not None:
        p = 1.0 + 1.0 / law[0]
        moduli, times = material.spectrum
        memory = np.exp(-(time - covered) / times) * hyp1f1(1.0, 1.0 + p, -covered / times)
        swept = radius * covered / p * prony_integrals.plane_factor(material)
        late = radius * float(prony_integrals.relaxation_integral(material, time - covered))
        return swept * (material.modulus + float(memory @ moduli)) + late

    def carried(x: float) -> float:
        age = max(time - float(sneddon.depth(indenter, x)) / rate, 0.0)
        return float(prony_integrals.relaxation_integral(material, age))

    knots = indenter.radii if isinstance(indenter, TabulatedProfile) else ()
    ends = [0.0, *(r for r in knots if 0.0 < r < radius), radius]
    return float(sum(quad(carried, a, b, **_ACCURACY)[0] for a, b in pairwise(ends)))


def history_force(
    material: Material,
    indenter: Indenter,
    penetration: Callable[[float], float],
    rate: Callable[[float], float],
    time: float,
) -> float:
    """Force at ``time`` for any smooth ``D(t)`` that rises from zero at ``t = 0``.

    The convolution itself, by adaptive quadrature; ``rate`` is the derivative of ``penetration``.

    Parameters
    ----------
    material : Material
    indenter : Indenter
    penetration : callable
        ``D(t)``.
    rate : callable
        ``D'(t)``.
    time : float

    Returns
    -------
    float
        Force.
    """

    def integrand(s: float) -> float:
        radius = sneddon.contact_radius(indenter, penetration(s))
        return float(prony_integrals.relaxation(material, time - s)) * 2.0 * radius * rate(s)

    return float(quad(integrand, 0.0, time, **_ACCURACY)[0])


def radius_under_force_step(
    material: Material, indenter: Indenter, force: float, time: ArrayLike, preload: float = 0.0
) -> Array:
    """Contact radius at ``time >= 0`` under a dead load ``force > 0`` added at ``t = 0``.

    ``preload`` is a force carried since long before, fully relaxed.

    Parameters
    ----------
    material : Material
    indenter : Indenter
    force : float
        Added force.
    time : array_like
        Time since the start of the load.
    preload : float
        Force that has been held long enough to relax.

    Returns
    -------
    ndarray
        Contact radius, of the shape of ``time``.
    """
    crept = prony_integrals.creep(material, time) * force
    return _radius_of_unit_force(indenter, crept + preload / material.relaxed_plane_modulus)


def radius_under_force_ramp(
    material: Material, indenter: Indenter, rate: float, time: ArrayLike, preload: float = 0.0
) -> Array:
    """Contact radius at ``time >= 0`` under ``F = preload + rate * t``, the preload relaxed.

    Parameters
    ----------
    material, indenter, time, preload
        As of :func:`radius_under_force_step`.
    rate : float
        Rate of the force.

    Returns
    -------
    ndarray
        Contact radius, of the shape of ``time``.
    """
    crept = prony_integrals.creep_integral(material, time) * rate
    return _radius_of_unit_force(indenter, crept + preload / material.relaxed_plane_modulus)


def _radius_of_unit_force(indenter: Indenter, unit_force: Array) -> Array:
    """The ``a`` whose adhesionless elastic force per unit modulus is ``2 (a G(a) - H(a))``."""
    law = sneddon.power_law(indenter)
    if law is not None:
        n, c = law
        unit = 2.0 * c * sneddon.shape_factor(n) * n / (n + 1.0)
        return (np.asarray(unit_force, float) / unit) ** (1.0 / (n + 1.0))
    if isinstance(indenter, FlatPunch):
        return np.full_like(np.asarray(unit_force, float), indenter.radius)

    def invert(target: float) -> float:
        return sneddon.radius_at(lambda a: float(sneddon.force(indenter, a, 1.0)), target)

    return np.vectorize(invert, otypes=[float])(unit_force)
