"""Forecast of what a run costs, told before it: steps, processor time, memory.

No solution: the path of the contact edge is that of the fully relaxed elastic contact, whose edge goes
farthest, and a step is counted

- for every division of a process zone (without adhesion, of a hundredth of the largest contact radius) that
  the edge passes,
- for the times between the shortest relaxation and the duration of a load step, by decades,
- for every cycle of an oscillation, the steps that follow a sine and a share of the divisions that the edge
  passes in it.

How many of each a solver takes, and what a step costs, is its :class:`CostModel`, measured by
``python -m validation.solvers.cost_benchmark``. A forecast is meant within a factor of three.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from contact_scene import Oscillate, Scene, SceneError, Step, Sweep
from validation.reference import sneddon
from validation.solvers.contact_range import largest_contact_radius

RADII = np.geomspace(1e-5, 1.0, 241)
"""Contact radii at which the elastic contact is tabulated, relative to the largest."""
MOST_UNKNOWNS = 1e30
"""Bounds the powers of a number of unknowns that no run could have."""
LAST_DECADES = 6.0
"""Decades of time below the duration of a load step in which steps are counted: what relaxes faster is taken
to have relaxed."""


@dataclass(frozen=True)
class Cost:
    """Forecast of a run, to a factor of three or so.

    Parameters
    ----------
    steps : float
        Accepted steps.
    seconds : float
        Processor time (s) on the machine on which the constants were measured.
    bytes : float
        Largest memory that the run holds beside the program.
    """

    steps: float
    seconds: float
    bytes: float


@dataclass(frozen=True)
class CostModel:
    """What a solver takes for the work that a scene asks; measured constants.

    Parameters
    ----------
    steps_per_division, steps_per_decade, steps_per_cycle, steps_per_interval : float
        Steps for a division of the process zone that the edge passes, for a decade of time after the begin of
        a load step of a viscoelastic contact, for a cycle of an oscillation and for an interval between two
        kinks of the load.
    adhesionless_steps_per_division : float
        The first without adhesion.
    steps_per_division_of_cycle : float
        What a division that the edge passes in a cycle adds to its steps.
    steps_of_elastic_interval : float or None
        Steps of such an interval where nothing relaxes and there is adhesion, whatever the process zone;
        ``None`` if the solver steps through the zones there too.
    seconds_of_setup, seconds_of_step, bytes_of_run : tuple of float
        Processor time (s) and largest memory, as coefficients of the powers 0, 1, 2, ... of the number of
        unknowns.
    share_of_branch : float
        What a branch of the material adds to the time of a step, relative.
    share_of_elastic_step : float
        Time of a step without branches, relative to one with a branch.
    share_of_adhesionless_step : float
        Time of a step without adhesion, relative to one with it.
    share_of_turn : float
        What a turn of the load adds to the time of a step with branches, relative: the history grows.
    bytes_of_row : float
        Memory of a row.
    most_zones_of_radius : float
        Process zones in the largest contact radius up to which a step is a share of a zone; with shorter
        zones it is a share of the radius.
    """

    steps_per_division: float = 1.0
    steps_per_decade: float = 4.0
    steps_per_cycle: float = 40.0
    steps_per_interval: float = 4.0
    adhesionless_steps_per_division: float = 1.0
    steps_per_division_of_cycle: float = 0.5
    steps_of_elastic_interval: float | None = None
    seconds_of_setup: tuple[float, ...] = (0.1,)
    seconds_of_step: tuple[float, ...] = (5e-3,)
    share_of_branch: float = 0.1
    share_of_elastic_step: float = 1.0
    share_of_adhesionless_step: float = 1.0
    share_of_turn: float = 0.0
    bytes_of_run: tuple[float, ...] = (1e7,)
    bytes_of_row: float = 500.0
    most_zones_of_radius: float = math.inf


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
    path = _edge_path(scene, largest)
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


def forecast(model: CostModel, work: SceneWork, resolution: int, unknowns: float) -> Cost:
    """The cost of a run.

    Parameters
    ----------
    model : CostModel
        Of the solver.
    work : SceneWork
        Of the scene.
    resolution : int
        Divisions per process zone.
    unknowns : float
        Of one step: surface points, rows of the history, whatever the time of a step grows with.

    Returns
    -------
    Cost
    """
    zones, zones_of_cycles = work.zones, work.zones_of_cycles
    if work.adhesive and work.radius_in_zones > model.most_zones_of_radius:
        zones *= model.most_zones_of_radius / work.radius_in_zones
        zones_of_cycles *= model.most_zones_of_radius / work.radius_in_zones
    least = model.steps_per_interval * work.intervals + model.steps_per_cycle * work.cycles
    least += model.steps_per_division_of_cycle * resolution * zones_of_cycles
    if work.branches == 0 and work.adhesive and model.steps_of_elastic_interval is not None:
        steps = least + model.steps_of_elastic_interval * work.intervals
    else:
        per_division = model.steps_per_division if work.adhesive else model.adhesionless_steps_per_division
        steps = least + per_division * resolution * zones + model.steps_per_decade * work.decades
    unknowns = min(unknowns, MOST_UNKNOWNS)
    setup, step, memory = (
        sum(factor * unknowns**power for power, factor in enumerate(factors))
        for factors in (model.seconds_of_setup, model.seconds_of_step, model.bytes_of_run)
    )
    share = (
        1.0 + model.share_of_branch * (work.branches - 1) if work.branches else model.share_of_elastic_step
    )
    if work.branches:
        share *= 1.0 + model.share_of_turn * (work.intervals + 2.0 * work.cycles)
    if not work.adhesive:
        share *= model.share_of_adhesionless_step
    seconds = setup + steps * step * share
    return Cost(steps, seconds, memory + steps * model.bytes_of_row)


@dataclass(frozen=True)
class EdgePath:
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


@np.errstate(over="ignore", invalid="ignore", under="ignore")
def _edge_path(scene: Scene, largest: float) -> EdgePath:
    stiffness = scene.material.relaxed_plane_modulus
    work = scene.adhesion.work if scene.adhesion is not None else 0.0
    radii = largest * RADII
    pull = np.sqrt(2.0 * np.pi * radii * work / stiffness)
    depths = sneddon.depth(scene.indenter, radii) - pull
    forces = sneddon.force(scene.indenter, radii, stiffness) - 2.0 * stiffness * radii * pull
    loads = {
        "penetration": depths,
        "force": forces,
        "stage": depths + scene.loading.compliance * forces,
        "radius": radii,
    }
    edge = scene.indenter.edge

    def radius(control: str, value: float) -> float:
        if math.isfinite(edge):
            return edge if value > loads[control].min() else 0.0
        held = np.flatnonzero(loads[control] <= value)
        return float(radii[held[-1]]) if held.size else 0.0

    present = radius(scene.loading.start_control, scene.loading.penetration)
    rests = work > 0.0 or math.isfinite(edge)  # on the rim of a punch, too
    travel, intervals, force = 0.0 if rests else present, 0.0, 0.0
    travel_of_cycles, cycles = 0.0, 0.0
    depth = scene.loading.penetration

    def state(step: Step) -> tuple[float, float]:
        return depth, force

    for step, segment in scene.loading.segments(state):
        amplitude = abs(getattr(step, "amplitude", 0.0))
        if amplitude > 0.0:
            control, middle = segment.control, segment.value(segment.start)
            between = abs(radius(control, middle + amplitude) - radius(control, middle - amplitude))
            share = _share_in_contact(step, middle - float(loads[control].min()))
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
        path = [present, *(radius(segment.control, value) for value in values)]
        if segment.trigger is not None:
            path[-1] = min(path[-1], radius(segment.trigger.quantity, segment.trigger.level))
        travel += sum(abs(after - before) for before, after in pairwise(path))
        intervals += len(times) - 1
        present = path[-1]
        if segment.control == "force":
            force = values[-1]
            depth = float(np.interp(present, radii, depths)) if present > 0.0 else depth
        elif segment.control == "stage" or segment.trigger is not None:
            depth, force = (float(np.interp(present, radii, known)) for known in (depths, forces))
        else:
            depth = values[-1]
        if present == 0.0 and work > 0.0:
            break  # contact is lost, which ends the run
    return EdgePath(travel, travel_of_cycles, cycles, intervals)


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
