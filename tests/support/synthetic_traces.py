"""Made-up traces and profiles on which the paper's statements can be judged without a solver."""

from __future__ import annotations

import numpy as np

from contact_scene import Counters, Outcome, OutcomeKind, Scene, SurfaceProfile, Trace
from validation.measure.scaling import unit_sizes


def trace(depth=(0.0, 1.0), force=(0.0, 1.0), radius=None, loss=None) -> Trace:
    """A detached run over equally spaced times; contact radius 0.2 where nothing else is said."""
    d, f = np.array(depth, float), np.array(force, float)
    a = np.full_like(d, 0.2) if radius is None else np.asarray(radius, float)
    p = np.zeros_like(d) if loss is None else np.asarray(loss, float)
    t = np.arange(d.size, dtype=float)
    outcome = Outcome(OutcomeKind.DETACHED, "as told", float(t[-1]))
    return Trace("bem", t, d, f, a, 0.0 * d, 0.0 * d, p, outcome, Counters())


def follow(scene: Scene, strength: float) -> Trace:
    """Pressed along a line through one JKR force of tension at -0.005, and back by ``strength`` of them."""
    deepest, size = 0.032, unit_sizes(scene)["jkr-force"]
    inward, outward = np.linspace(0.0, deepest, 50), np.linspace(deepest, -0.005, 50)
    slope = size / 0.005
    drop = size * (strength - 1.0) * np.minimum(1.0, (deepest - outward) / deepest)
    return trace(np.concatenate((inward, outward)), np.concatenate((slope * inward, slope * outward - drop)))


def half_ellipse(r):
    """Pressure of Hertz."""
    return np.sqrt(1.0 - r**2)


def profile(pressure, gap=lambda s: s**0.5) -> SurfaceProfile:
    """A contact of radius 1 with the given pressure inside and gap at a distance outside."""
    inside = np.sin(0.5 * np.pi * np.arange(200) / 200)
    outside = 1.0 + np.geomspace(1e-4, 1.0, 200)
    r = np.concatenate((inside, outside))
    p = np.concatenate((pressure(inside), np.zeros(200)))
    g = np.concatenate((np.zeros(200), gap(outside - 1.0)))
    return SurfaceProfile(0.0, 0.1, 1.0, 1.0, r, p, 0.0 * r, g)
