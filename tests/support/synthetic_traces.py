"""Traces and profiles by hand, on which whatever reads a run can be judged without a solver."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from contact_scene import COLUMNS, Counters, Outcome, OutcomeKind, Scene, SurfaceProfile, Trace
from validation.measure.scaling import unit_sizes

COMPLETED, DETACHED = OutcomeKind.COMPLETED, OutcomeKind.DETACHED


def by_hand(time, kind: OutcomeKind = COMPLETED, solver: str = "bem", past: bool = False, **stated) -> Trace:
    """A run over these times that ends at the last one.

    Columns that are not stated are zero, but for a contact radius of 1; a number is that in every row. Any
    other field of a trace may be stated, too.
    """
    t = np.asarray(time, float)
    given = {"contact_radius": 1.0} | stated
    columns = {name: np.zeros_like(t) + np.asarray(given.pop(name, 0.0), float) for name in COLUMNS[1:]}
    end = Outcome(kind, "by hand", float(t[-1]) if t.size else 0.0, past)
    return Trace(solver, t, **columns, **{"outcome": end, "counters": Counters()} | given)


def work_of(trace: Trace) -> Trace:
    """The same with the work of its rows, by trapezoids."""
    force, depth = trace.force, trace.penetration
    steps = 0.5 * (force[1:] + force[:-1]) * np.diff(depth)
    return replace(trace, external_work=np.concatenate((0.0 * force[:1], np.cumsum(steps))))


def trace(depth=(0.0, 1.0), force=(0.0, 1.0), radius=0.2, loss=0.0) -> Trace:
    """A detached run over equally spaced times."""
    rows = {"penetration": depth, "force": force, "contact_radius": radius, "dissipated_energy": loss}
    return by_hand(np.arange(len(depth)), DETACHED, **rows)


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
