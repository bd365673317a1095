"""Records made of closed forms, without any solver: elastic contact, from before contact to after."""

from __future__ import annotations

import numpy as np

from contact_scene import Loading, Material, Ramp, Scene, Sphere
from validation.fits.parameters import FitSettings
from validation.fits.record import MeasuredCurve

MODULUS, DEPTH, RATE = 0.8, 0.03, 0.02
GUESS = 1.3 * MODULUS
"""Where fits of the modulus start."""


def settings_of(*vary, **more):
    """Settings of a fit by closed forms, without a second solver."""
    return FitSettings(vary=vary, **{"solver": "closed-form", "check_solver": None} | more)


def elastic_scene(modulus=MODULUS):
    """A sphere on an elastic half-space, pressed in and pulled out."""
    return Scene(
        Material(modulus, 0.5),
        Sphere(1.0),
        Loading("jump-in", 0.0, (Ramp(DEPTH, RATE), Ramp(-0.01, RATE))),
        title="elastic",
    )


def hertz_curve(noise=1e-4, seed=0, rows=120, offset=0.0, baseline=0.0, name="hertz"):
    """Hertz' force over a triangle of penetration that begins and ends without contact."""
    time = np.linspace(0.0, 4.0, rows)
    motion = DEPTH - RATE * np.abs(time - 2.0)
    force = 4.0 / 3.0 * MODULUS / 0.75 * np.maximum(motion, 0.0) ** 1.5 + baseline
    force = force + noise * np.random.default_rng(seed).standard_normal(rows)
    return MeasuredCurve(time, force, motion + offset, name=name)
