"""Columns of runs for figures, in the paper's dimensionless form where the scene allows it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from contact_scene import Cone, PowerLaw, Scene, Sphere, Trace
from contact_scene.trace import Array
from validation.measure.events import largest_tension
from validation.measure.scaling import drawn_sizes, unit_name
from validation.reference.jkr import JKR

Labels = Mapping[str, str]


@dataclass(frozen=True)
class RunCurves:
    """Columns of one run, or of a closed form (no ``style``), ready to be drawn."""

    label: str
    style: str
    columns: dict[str, Array]
    pull_off: int | None = None


def labels(scene: Scene) -> Labels:
    """Axis labels that go with the columns of :func:`of_trace`."""
    units = {name: f" ({unit_name(scene, name)})" for name in ("time", "penetration", "force")}
    length, force = units["penetration"], units["force"]
    scaled = "length" in drawn_sizes(scene)
    return {
        "time": f"time t{units['time']}",
        "shared_time": f"time t{units['time']}",
        "penetration": "penetration Δ" + ("/R" if scaled else length),
        "force": "force " + ("(1−ν²)F/(πE₀R²)" if scaled else f"F{force}"),
        "contact_radius": "contact radius a" + ("/R" if scaled else length),
        "stage": "stage X" + ("/R" if scaled else length),
        "difference": "(F − F_ref)/max |F_ref|",
    }


def of_trace(trace: Trace, scene: Scene) -> RunCurves:
    """The columns a figure needs, without the jump to the free surface after contact is lost."""
    lost = len(trace) > 1 and trace.contact_radius[-1] == 0.0 and trace.time[-1] == trace.time[-2]
    rows = slice(None, -1 if lost else None)
    size = drawn_sizes(scene)
    length, force = size.get("length", 1.0), size.get("force", 1.0)
    columns = {
        "time": trace.time[rows],
        "penetration": trace.penetration[rows] / length,
        "force": trace.force[rows] / force,
        "contact_radius": trace.contact_radius[rows] / length,
    }
    if "stage" in trace.extra:
        columns["stage"] = trace.extra["stage"][rows] / length
    return RunCurves(trace.solver, trace.solver, columns, largest_tension(trace) if len(trace) else None)


def with_differences(curves: list[RunCurves], base: str) -> list[RunCurves]:
    """The same curves; those that are not ``base`` also carry ``F(t) - F_base(t)`` over its largest force.

    Both are straight between rows and are compared piecewise between jumps of the load; rows within a jump
    have no counterpart.
    """
    found = [curve for curve in curves if curve.style == base and curve.columns["time"].size > 1]
    if not found:
        return curves
    time, force = found[0].columns["time"], found[0].columns["force"]
    scale = float(np.abs(force).max()) or 1.0
    carried = []
    for curve in curves:
        if not curve.style or curve.style == base or curve.columns["time"].size < 2:
            carried.append(curve)
            continue
        at = curve.columns["time"]
        begins, ends = np.diff(at, prepend=-np.inf) > 0.0, np.diff(at, append=np.inf) > 0.0
        before, after = np.interp(-at, -time[::-1], force[::-1]), np.interp(at, time, force)
        shared = (begins | ends) & (at <= time[-1])
        apart = (curve.columns["force"] - np.where(ends, after, before)) / scale
        columns = curve.columns | {"shared_time": at[shared], "difference": apart[shared]}
        carried.append(replace(curve, columns=columns))
    return carried


def elastic_limits(scene: Scene, largest_radius: float) -> list[RunCurves]:
    """The exact JKR curves of the relaxed and the glassy modulus, up to a contact radius.

    They belong to a vanishing process zone and therefore run slightly beside the elastic limits of a solver.
    """
    if scene.adhesion is None or not scene.is_adhesive:
        return []
    if not isinstance(scene.indenter, (Sphere, Cone, PowerLaw)):
        return []
    size = drawn_sizes(scene)
    length, force = size.get("length", 1.0), size.get("force", 1.0)
    material = scene.material
    moduli = {"JKR, E₀": material.relaxed_plane_modulus}
    if not material.is_elastic:
        moduli["JKR, E∞"] = material.glassy_plane_modulus
    found = []
    for label, modulus in moduli.items():
        law = JKR(scene.indenter, modulus, scene.adhesion.work)
        least = law.pull_off_penetration_control().contact_radius
        if not 0.0 < least < largest_radius:
            continue
        a = np.geomspace(least, largest_radius, 200)
        columns = {
            "penetration": law.penetration(a) / length,
            "force": law.force(a) / force,
            "contact_radius": a / length,
        }
        found.append(RunCurves(label, "", columns))
    return found
