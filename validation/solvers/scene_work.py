"""What a scene asks of any solver, counted before it is solved.

No solution: the path of the contact edge is that of the fully relaxed elastic contact, whose edge goes
farthest. Counted are

- the process zones (without adhesion, hundredths of the largest contact radius) that the edge passes,
- the decades of time between the shortest relaxation and the duration of a load step,
- the cycles of oscillations, and the zones that the edge passes in them.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from contact_scene import Oscillate, Scene, SceneError, Step, Sweep
from validation.reference import sneddon
from validation.solvers.contact_range import largest_contact_radius

Array = NDArray[np.float64]

RADII = np.geomspace(1e-5, 1.0, 241)
"""Contact radii at which the elastic contact is tabulated, relative to the largest."""
LAST_DECADES = 6.0
"""Decades of time below the duration of a load step in which steps are counted: what relaxes faster is taken
to have relaxed."""


@dataclass(frozen=True)
class SceneWork:
    """What a scene asks of any solver, in counts.

    Parameters
    ----------
    zones : float
        Process zones (without adhesion hundredths of the largest contact radius) that the edge passes outside
        of cycles.
    zones_of_cycles : float
        The same in cycles.
    radius_in_zones : float
        Largest contact radius in process zones.
    decades : float
        Decades of time from the shortest relaxation to the duration, summed over the load steps.
    cycles : float
        Of all oscillations and sweeps until contact is lost.
    intervals : float
        Intervals of the load between its kinks until then.
    branches : int
        Of the material that have a modulus, those of the bulk included.
    adhesive : bool
        Whether there is a process zone.
    """

    zones: float
    zones_of_cycles: float
    radius_in_zones: float
    decades: float
    cycles: float
    intervals: float
    branches: int
    adhesive: bool


@lru_cache(maxsize=64)
def scene_work(scene: Scene) -> SceneWork:
    """Count what a scene asks; a scene that never touches asks nothing."""
    branches = len(scene.material.spectrum[0]) + len(getattr(scene.material.bulk, "branches", ()))
    adhesive = scene.adhesion is not None and scene.is_adhesive
    try:
        largest = largest_contact_radius(scene)
    except SceneError:
        steps = float(len(scene.loading.steps))
        return SceneWork(0.0, 0.0, 0.0, 0.0, cycle_count(scene), steps, branches, adhesive)
    zone = scene.adhesion.zone if scene.adhesion is not None and scene.is_adhesive else 0.01 * largest
    path = _relaxed_path(scene, largest)
    return SceneWork(
        path.length / zone,
        path.length_of_cycles / zone,
        largest / zone,
        _decades(scene),
        path.cycles,
        path.intervals,
        branches,
        adhesive,
    )


def cycle_count(scene: Scene) -> float:
    """Cycles of all oscillations and sweeps of a loading."""
    cycles = 0.0
    for step in scene.loading.steps:
        cycles += _cycles(step)
    return cycles


@dataclass(frozen=True)
class RelaxedPath:
    """What the edge of the relaxed contact does until contact is lost; upper bounds.

    Parameters
    ----------
    length, length_of_cycles : float
        Of its path outside of cycles, and in them.
    cycles, intervals : float
        Cycles, and intervals of the load between its kinks.
    """

    length: float
    length_of_cycles: float
    cycles: float
    intervals: float


@dataclass(frozen=True)
class _RelaxedContact:
    """The fully relaxed elastic contact, tabulated.

    Parameters
    ----------
    loads : dict of str to ndarray, shape (n,)
        "penetration", "force", "stage" and "radius" at rising contact radii.
    rim : float
        Radius of a punch, on whose rim the edge rests; infinite for other shapes.
    """

    loads: dict[str, Array]
    rim: float

    def radius(self, control: str, value: float) -> float:
        """Largest contact radius under a load; 0 without contact."""
        if math.isfinite(self.rim):
            return self.rim if value > self.loads[control].min() else 0.0
        held = np.flatnonzero(self.loads[control] <= value)
        return float(self.loads["radius"][held[-1]]) if held.size else 0.0

    def load(self, name: str, radius: float) -> float:
        """One of the loads at a contact radius."""
        return float(np.interp(radius, self.loads["radius"], self.loads[name]))


def _relaxed_contact(scene: Scene, largest: float) -> _RelaxedContact:
    stiffness = scene.material.relaxed_plane_modulus
    work = scene.adhesion.work if scene.adhesion is not None else 0.0
    radii = largest * RADII
    pull = np.sqrt(2.0 * np.pi * radii * work / stiffness)
    depths = sneddon.depth(scene.indenter, radii) - pull
    forces = sneddon.force(scene.indenter, radii, stiffness) - 2.0 * stiffness * radii * pull
    stages = depths + scene.loading.compliance * forces
    loads = {"penetration": depths, "force": forces, "stage": stages, "radius": radii}
    return _RelaxedContact(loads, scene.indenter.edge)


@np.errstate(over="ignore", invalid="ignore", under="ignore")
def _relaxed_path(scene: Scene, largest: float) -> RelaxedPath:
    contact = _relaxed_contact(scene, largest)
    work = scene.adhesion.work if scene.adhesion is not None else 0.0
    present = contact.radius(scene.loading.start_control, scene.loading.penetration)
    rests = work > 0.0 or math.isfinite(contact.rim)  # on the rim of a punch, too
    travel, intervals, force = 0.0 if rests else present, 0.0, 0.0
    travel_of_cycles, cycles = 0.0, 0.0
    depth = scene.loading.penetration

    def state(step: Step) -> tuple[float, float]:
        return depth, force

    for step, segment in scene.loading.segments(state):
        control = segment.control
        amplitude = abs(getattr(step, "amplitude", 0.0))
        if amplitude > 0.0:
            middle = segment.value(segment.start)
            between = abs(
                contact.radius(control, middle + amplitude) - contact.radius(control, middle - amplitude)
            )
            share = _share_in_contact(step, middle - float(contact.loads[control].min()))
            if work == 0.0 and _shakes_off(scene, step, middle):
                share = 0.0
            lost, carried_out = share < 1.0, _cycles(step)
            if lost:
                carried_out = min(carried_out, max(share * carried_out, 1.0))
            travel_of_cycles += 2.0 * between * carried_out
            cycles += carried_out
            if lost:
                break
        times = (segment.start, *segment.kinks, segment.end)
        values = [segment.value(at) for at in times]
        path = [present, *(contact.radius(control, value) for value in values)]
        if segment.trigger is not None:
            path[-1] = min(path[-1], contact.radius(segment.trigger.quantity, segment.trigger.level))
        travel += sum(abs(after - before) for before, after in pairwise(path))
        intervals += len(times) - 1
        present = path[-1]
        if control == "force":
            force = values[-1]
            depth = contact.load("penetration", present) if present > 0.0 else depth
        elif control == "stage" or segment.trigger is not None:
            depth, force = contact.load("penetration", present), contact.load("force", present)
        else:
            depth = values[-1]
        if present == 0.0 and work > 0.0:
            break  # contact is lost, which ends the run
    return RelaxedPath(travel, travel_of_cycles, cycles, intervals)


def _share_in_contact(step: Step, above: float) -> float:
    """Share of an oscillation by whose end its drift has taken it out of contact, ``above`` at its start."""
    drifted = getattr(step, "drift", 0.0) * getattr(step, "duration", 0.0)
    if drifted <= 0.0:
        return 1.0
    return min(max(above - abs(getattr(step, "amplitude", 0.0)), 0.0) / drifted, 1.0)


def _shakes_off(scene: Scene, step: Step, middle: float) -> bool:
    """Whether an oscillation ends the contact of a punch without adhesion, and about that of other shapes.

    Its force has the amplitude ``|E*(i w)| A`` about ``E0 D``, relative to one stiffness.
    """
    if not isinstance(step, Oscillate):
        return False
    moduli, times = scene.material.spectrum
    turns = 1j * step.angular_frequency * times
    dynamic = scene.material.modulus + np.sum(moduli * turns / (1.0 + turns))
    return bool(abs(dynamic) * abs(step.amplitude) > scene.material.modulus * middle)


def _cycles(step: Step) -> float:
    if isinstance(step, Oscillate):
        return step.angular_frequency * step.duration / (2.0 * math.pi)
    return step.chirp * step.duration**2 / (4.0 * math.pi) if isinstance(step, Sweep) else 0.0


def _decades(scene: Scene) -> float:
    """Decades of time between the shortest relaxation and the end of a load step, over all load steps."""
    times = scene.material.spectrum[1]
    if times.size == 0:
        return 0.0
    total = 0.0
    for _, segment in scene.loading.segments(lambda step: (scene.loading.penetration, 0.0), own_time=True):
        if segment.end > 0.0:
            total += min(max(math.log10(segment.end) - math.log10(times[0]), 0.0) + 1.0, LAST_DECADES)
    return total
