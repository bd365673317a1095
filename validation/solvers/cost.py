"""Forecast of what a run costs, told before it: steps, processor time, memory.

Steps are counted

- for every division of a process zone (without adhesion, of a hundredth of the largest contact radius) that
  the edge passes,
- for the times between the shortest relaxation and the duration of a load step, by decades,
- for every cycle of an oscillation, the steps that follow a sine and a share of the divisions that the edge
  passes in it.

How many of these a scene asks for is its :class:`~validation.solvers.scene_work.SceneWork`; how many steps a
solver takes for each, and what a step costs, is its :class:`CostModel`, measured by
``python -m benchmarks.cost_forecast``. A forecast is meant within a factor of three.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

from contact_scene.run_control.options import MAX_STEPS
from validation.solvers.scene_work import SceneWork

MOST_UNKNOWNS = 1e30
"""Bounds the powers of a number of unknowns that no run could have."""
ESTIMATE_SHARE = 0.5
"""Time of the coarser run from which errors are estimated, relative to the run."""
BUDGET_PER_FORECAST = 5.0
"""Step budget over the forecast, which is within a factor of three and leaves rejected steps out."""


def relative_time(estimate: bool) -> float:
    """Time of a run, with that from which its errors are estimated if they are, relative to the run alone."""
    return 1.0 + ESTIMATE_SHARE * estimate


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
    setup_seconds, setup_bytes : float
        What of the two is spent before the first step.
    """

    steps: float
    seconds: float
    bytes: float
    setup_seconds: float = 0.0
    setup_bytes: float = 0.0

    @property
    def step_budget(self) -> int:
        """Most steps of such a run, accepted and rejected together, where the user states no number."""
        return max(MAX_STEPS, math.ceil(BUDGET_PER_FORECAST * self.steps))

    def within(self, max_steps: int | None) -> Cost:
        """What of it so many steps take; ``None``: all."""
        if max_steps is None or max_steps >= self.steps:
            return self
        share = max_steps / self.steps
        seconds = self.setup_seconds + share * (self.seconds - self.setup_seconds)
        memory = self.setup_bytes + share * (self.bytes - self.setup_bytes)
        return replace(self, steps=float(max_steps), seconds=seconds, bytes=memory)


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
    return Cost(steps, seconds, memory + steps * model.bytes_of_row, setup, memory)
