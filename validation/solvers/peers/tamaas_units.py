"""A minimal case of Tamaas' viscoelastic solver whose answer depends on the unit of stress.

A wavy surface is pressed flat and held: the displacement no longer changes, so the amplitude of the pressure
relaxes as the modulus does, by backward Euler as ``E0 + E1 (1 + dt/tau)^-n`` after n steps. In version 2.9.0
the first step is right in any unit; what later steps remember is too large by one over the relaxed shear
modulus, hence right where that is 1. ``python -m validation.solvers.peers.tamaas_units`` prints both.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

RELAXED, BRANCH, POISSON, TIME, STEP = 0.75, 6.75, 0.5, 1.0, 0.5
"""Young's moduli, Poisson's ratio, relaxation time and time step of the case."""
HEIGHT = 1e-3
"""Amplitude of the surface over its wavelength."""


def exact(steps: int) -> NDArray[np.float64]:
    """Modulus after each step, by backward Euler; shape (steps,)."""
    return RELAXED + BRANCH * (1.0 + STEP / TIME) ** -np.arange(1.0, steps + 1.0)


def measured(unit: float, steps: int, pixels: int = 16) -> NDArray[np.float64]:
    """Modulus that the pressure of Tamaas shows after each step, its stresses given in ``unit``.

    Parameters
    ----------
    unit : float
        Stress that counts as 1, in that of ``RELAXED``.
    steps, pixels : int
        Time steps; pixels a wavelength.

    Returns
    -------
    ndarray, shape (steps,)
        In the unit of ``RELAXED``.
    """
    import tamaas

    tamaas.set_log_level(tamaas.LogLevel.error)
    model = tamaas.Model(tamaas.model_type.basic_2d, [1.0, 1.0], [pixels, pixels])
    model.E, model.nu = RELAXED / unit, POISSON
    wave = np.cos(2.0 * np.pi * np.arange(pixels) / pixels)[:, None] * np.ones(pixels)
    shear = [BRANCH / unit / (2.0 * (1.0 + POISSON))]
    solver = tamaas.MaxwellViscoelastic(model, HEIGHT * wave, 1e-12, STEP, shear, [TIME])
    flat = 10.0 * HEIGHT * (RELAXED + BRANCH) / unit  # mean pressure at which no gap is left
    found = []
    for _ in range(steps):
        solver.solve(flat)
        amplitude = 2.0 * float((np.asarray(model.traction) * wave).mean())
        found.append(amplitude / (np.pi * HEIGHT) * (1.0 - POISSON**2) * unit)
    return np.array(found)


if __name__ == "__main__":
    print("exact                      ", exact(5).round(4))
    for name, size in (("as given", 1.0), ("relaxed shear modulus", RELAXED / (2.0 * (1.0 + POISSON)))):
        print(f"unit: {name:<21}", measured(size, 5).round(4))
