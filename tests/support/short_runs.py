"""Short runs of every solver that pass through each kind of loading step, with profiles on the way."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache

from support.fitted_meshes import mesh_for

import bem_solver
import fem_solver
from contact_scene import (
    Adhesion,
    Branch,
    BulkRelaxation,
    Force,
    Hold,
    Loading,
    Material,
    Oscillate,
    Ramp,
    RunMonitor,
    Scene,
    Sphere,
    Trace,
)
from validation.reference import tracking as reference

TIMES = (0.0, 0.05, 0.35)  # of profiles: the start, within the approach, within the oscillation
TWO = Material(0.75, 0.5, (Branch(3.0, 0.1), Branch(3.75, 1.0)))
APART = Material(0.75, 0.4, (Branch(6.75, 1.0),), BulkRelaxation())
LOADING = Loading(
    "jump-in",
    0.0,
    (
        Ramp(0.01, 0.1),
        Hold(0.1),
        Oscillate(1e-3, 30.0, 0.2),
        Force(-5e-4, 0.05),  # jumps
        Ramp(-0.5, 0.3),
    ),
)
RICH = Scene(TWO, Sphere(1.0), LOADING, Adhesion(5e-4, 0.02))
SHORT = Scene(APART, Sphere(1.0), Loading("relaxed", 0.02, (Ramp(0.018, 0.05),)), Adhesion(5e-4, 0.02))


def bem(scene: Scene, monitor: RunMonitor | None = None, **options) -> Trace:
    return bem_solver.solve(scene, bem_solver.Options(4, profile_times=TIMES, **options), None, monitor)


def fem(scene: Scene, monitor: RunMonitor | None = None, **options) -> Trace:
    fineness = 4 if scene.is_adhesive else 1
    asked = fem_solver.Options(fineness, 5e-3, profile_times=TIMES, **options)
    return fem_solver.solve(scene, mesh_for(scene, fineness), asked, None, monitor)


def front(scene: Scene, monitor: RunMonitor | None = None) -> Trace:
    return reference.solve(scene, reference.Options(5, profile_times=TIMES), None, monitor)


@cache
def uninterrupted(solve: Callable[..., Trace]) -> Trace:
    """The whole run of ``RICH`` by ``bem``, ``fem`` or ``front``, computed once in a process."""
    return solve(RICH)


def assert_same_columns(found: Trace, wanted: Trace) -> None:
    """All columns, to the last bit."""
    columns = wanted.columns()
    assert list(found.columns()) == list(columns)
    for name, column in found.columns().items():
        assert column.tobytes() == columns[name].tobytes(), name
