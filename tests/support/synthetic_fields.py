"""A made-up body under a made-up contact: linear fields on a small mesh, so every drawn value is known."""

from __future__ import annotations

from typing import Any

import numpy as np
from support.synthetic_traces import DETACHED, by_hand

from contact_scene import (
    Adhesion,
    Counters,
    Loading,
    Material,
    Ramp,
    Scene,
    Sphere,
    SurfaceProfile,
    Trace,
)
from fem_solver import FieldState

RADIUS, ZONE = 0.2, 0.02
SCENE = Scene(
    Material(1.0, 0.5),
    Sphere(1.0),
    Loading("jump-in", 0.0, (Ramp(0.03, 0.01), Ramp(-0.02, 0.01))),
    Adhesion(1e-3, ZONE),
)


def state(
    radius: float = RADIUS, penetration: float = 0.03, row: int = 0, time: float = 3.0, label: str = ""
) -> FieldState:
    """``u_r = r/100``; ``u_z`` follows the indenter to the edge, then stays; ``stress_zz = r + z``."""
    along = np.unique(np.concatenate([np.linspace(0.0, 1.0, 41), [radius, radius + ZONE]]))
    down = -(np.linspace(0.0, 1.0, 15) ** 1.5)[::-1]
    r, z = (axis.ravel() for axis in np.meshgrid(along, down))
    columns, n = len(along), r.size
    corner = (np.arange(len(down) - 1)[:, None] * columns + np.arange(columns - 1)).ravel()
    lower = np.column_stack([corner, corner + 1, corner + columns + 1])
    upper = np.column_stack([corner, corner + columns + 1, corner + columns])
    top = np.minimum(r, radius) ** 2 / 2.0 - penetration
    stress = np.zeros((4, n))
    stress[1] = r + z
    none, m = np.zeros((1, n)), len(corner)
    gap = np.maximum(along**2 / 2.0 - penetration - (np.minimum(along, radius) ** 2 / 2.0 - penetration), 0.0)
    surface = SurfaceProfile(
        time,
        penetration,
        1.0,
        radius,
        along,
        0.0 * along,
        penetration - np.minimum(along, radius) ** 2 / 2,
        gap,
    )
    return FieldState(
        row=row,
        time=time,
        penetration=penetration,
        force=penetration,
        contact_radius=radius,
        label=label,
        branches=("tau=1",),
        points=np.column_stack([r, z]),
        triangles=np.vstack([lower, upper]),
        displacement=np.column_stack([0.01 * r, top * np.exp(z)]),
        stress=stress,
        strain=0.1 * stress,
        stored_energy_density=np.exp(z),
        dissipation_rate=none + 10.0 ** (4.0 * z),
        dissipated=none,
        surface=surface,
        element_volumes=np.ones(m),
        element_stored=np.zeros(m),
        element_rate=np.zeros((1, m)),
        element_dissipated=np.zeros((1, m)),
    )


def trace(**changes: Any) -> Trace:
    """A cycle of eleven rows: the edge recedes late, tension is largest in row 8, contact ends in row 10."""
    time = np.arange(11.0)
    depth = np.array([0.0, 0.01, 0.02, 0.03, 0.03, 0.02, 0.01, 0.0, -0.01, -0.02, -0.02])
    force = np.array([-0.1, 0.4, 0.8, 1.0, 0.9, 0.3, -0.2, -0.5, -0.7, -0.4, 0.0])
    radius = np.array([0.05, 0.1, 0.15, 0.2, 0.2, 0.2, 0.19, 0.17, 0.12, 0.06, 0.0])
    rows = {"penetration": depth, "force": force, "contact_radius": radius} | changes
    return by_hand(rows.pop("time", time), DETACHED, "fem", counters=Counters(steps=10), **rows)


def states(rows: dict[int, str]) -> list[FieldState]:
    """The states of that cycle at some rows."""
    run = trace()
    return [
        state(float(run.contact_radius[row]), float(run.penetration[row]), row, float(run.time[row]), label)
        for row, label in rows.items()
    ]


def surfaces(times=(1.0, 2.0, 3.0, 4.0)) -> list[SurfaceProfile]:
    """Surfaces of a sphere with a punch's pressure and a square-root gap, in contact up to 0.2."""
    r = np.concatenate([np.linspace(0.0, 0.199, 60), 0.2 + np.geomspace(1e-5, 0.5, 60)])
    gap = np.sqrt(np.maximum(r - 0.2, 0.0)) / 10
    found = []
    for time in times:
        pressure = np.where(r < 0.2, time / np.sqrt(np.maximum(0.04 - r**2, 1e-6)), 0.0)
        found.append(
            SurfaceProfile(time, 0.01 * time, 1.0, 0.2, r, pressure, 0.01 * time - r**2 / 2 + gap, gap)
        )
    return found
