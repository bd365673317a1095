"""Stress and displacement in an elastic layer under an axisymmetric contact, by Hankel transforms.

With harmonic functions ``f, g`` of radius and depth ``s`` (H. Neuber, ZAMM 14, 203 (1934)), ``'`` along s,

    2G u_r = (f + s g)_,r,    2G w = f' + s g' - (3 - 4 nu) g    (w downwards),
    s_zz = f'' + s g'' - 2 (1 - nu) g',    s_rz = -[f' + s g' - (1 - 2 nu) g]_,r,
    s_rr = (f + s g)_,rr - 2 nu g',        s_tt = (f + s g)_,r/r - 2 nu g'.

For each wave number k they are ``A exp(-k s) + B exp(-k (h - s))`` times ``J0(k r)``. The tractions
``-P(k), 0`` of the surface and the base, ``u_r = w = 0`` or ``s_rz = w = 0``, give the four amplitudes. The
half-space has ``g = -P exp(-k s)/k, f = -(1 - 2 nu) g/k``; only what the layer has beyond that is summed up
here, which falls as ``exp(-k h)``. The rest, and axes and signs, are those of
:mod:`validation.reference.subsurface` under the same pressure.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.special import j0, j1

from validation.reference import subsurface
from validation.reference.elastic_layer import ElasticLayer

Array = NDArray[np.float64]

_LAST = 40.0
"""Wave number times thickness at which the sum ends: amplitudes are rounding there."""


def contact(
    layer: ElasticLayer, r: Array, z: Array, contact_radius: float, penetration: float, plane_modulus: float
) -> subsurface.Field:
    """Field at points ``(r, z)``, shape (n,), ``-h <= z <= 0``; as of :func:`subsurface.contact`."""
    nu, h, d = layer.poisson, layer.layer.thickness, np.array([penetration, -1.0])

    def q(x: Array) -> Array:
        return np.asarray(plane_modulus * layer.solution(contact_radius, x)[2] @ d)

    below = subsurface.through(q, contact_radius).field(r, z, plane_modulus, nu)
    node, weight = np.polynomial.legendre.leggauss(80 + int(8.0 * (float(r.max()) + contact_radius) / h))
    k, weight = 0.5 * _LAST / h * (node + 1.0), 0.5 * _LAST / h * weight
    node, share = np.polynomial.legendre.leggauss(80 + int(8.0 * contact_radius / h))
    x = 0.5 * contact_radius * (node + 1.0)
    load = np.cos(np.outer(k, x)) @ (0.5 * contact_radius / np.pi * share * q(x))
    rows = _rows(k, np.zeros(1), h, nu)[[2, 3], ..., 0], _rows(k, np.full(1, h), h, nu)[..., 0]
    held = rows[1][[1, 0 if layer.layer.base == "bonded" else 3]]
    system = np.moveaxis(np.concatenate([rows[0], held]), -1, 0)  # wave number, condition, amplitude
    known = np.zeros((len(k), 4))
    known[:, 0] = -load
    amplitudes = np.linalg.solve(system, known[..., None])[..., 0]
    amplitudes[:, 2] += load / k
    amplitudes[:, 0] -= (1.0 - 2.0 * nu) * load / k**2
    fields = np.einsum("cakn,ka->ckn", _rows(k, -z, h, nu), (weight * k)[:, None] * amplitudes)
    kr = np.outer(k, r)
    even, odd = j0(kr), j1(kr)
    along = np.where(kr > 1e-9, odd / np.maximum(kr, 1e-300), 0.5) * k[:, None]
    radial, down, zz, rz, volume = fields
    stress = radial * (k[:, None] * even - along) - volume * even, zz * even, radial * along - volume * even
    moved = np.stack([radial * odd, -down * even]) / (plane_modulus * (1.0 - nu))
    return subsurface.Field(
        below.stress + np.stack([*stress, -rz * odd]).sum(axis=1), below.displacement + moved.sum(axis=1)
    )


def _rows(k: Array, s: Array, h: float, nu: float) -> Array:
    """Transforms of ``2G u_r, 2G w, s_zz, -s_rz`` and ``2 nu g'`` per amplitude of ``f`` (2) and ``g`` (2).

    Shape (5, 4, wave numbers, depths).
    """
    k = k[:, None]
    found = np.empty((5, 4, len(k), len(s)))
    for index, (decay, sign) in enumerate(((np.exp(-k * s), -k), (np.exp(-k * (h - s)), k))):
        none = np.zeros_like(decay)
        found[:, index] = decay * np.stack([-k + none, sign + none, k**2 + none, -k * sign + none, none])
        g = -k * s, s * sign - (3.0 - 4.0 * nu), s * k**2 - 2.0 * (1.0 - nu) * sign
        shear = -k * (s * sign - (1.0 - 2.0 * nu))
        found[:, 2 + index] = decay * np.stack([*g, shear, 2.0 * nu * sign + none])
    return found
