"""The only definitions of what is measured on a run, the same for every solver.

Signs: penetration ``D`` positive downwards, force ``F`` positive in compression, tension reported positive.
Units are the scene's. Values are those of rows of the trace: no parabola is laid through a maximum, nothing
is extrapolated, so a coarse trace shows as a coarse number. What does not apply is ``None``.

A jump of the load or of the answer is a pair of rows of equal time; it belongs to the curve and counts in
every integral over the penetration.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from contact_scene import Loading, OutcomeKind, Scene, Trace
from contact_scene.trace import Array
from validation.measure.events import approach_ended, end_of_approach, last_in_contact, peak_row, pull_off_row
from validation.measure.scaling import ROUND_OFF
from validation.measure.windows import cycle_times


@dataclass(frozen=True)
class Observables:
    """Scalars of one run, ``None`` where one does not apply; ``docs/reference/output.md`` says what each is.

    ``approach_*`` and ``peak_*`` of a run that did not finish are known once its approach has ended.
    ``detachment_*`` is the last state in contact, and ``None`` where the contact shrank to its process zone:
    there the model ends, not the contact, and the state is ``final_*``. On a spring ``loop_energy`` is the
    work of the stage, and ``instability_loss`` what is lost in instabilities at constant stage.
    """

    start_force: float | None = None
    start_radius: float | None = None
    approach_time: float | None = None
    approach_penetration: float | None = None
    approach_force: float | None = None
    approach_radius: float | None = None
    peak_force: float | None = None
    peak_time: float | None = None
    pull_off_force: float | None = None
    pull_off_time: float | None = None
    pull_off_penetration: float | None = None
    pull_off_radius: float | None = None
    detachment_time: float | None = None
    detachment_penetration: float | None = None
    detachment_radius: float | None = None
    detachment_force: float | None = None
    stage_at_detachment: float | None = None
    loop_energy: float | None = None
    dissipated_energy: float | None = None
    instability_loss: float | None = None
    final_time: float | None = None
    final_penetration: float | None = None
    final_force: float | None = None
    final_radius: float | None = None

    def as_dict(self) -> dict[str, float | None]:
        """All observables by name."""
        return dict(vars(self))


@dataclass(frozen=True)
class CycleLoss:
    """Energy lost over one oscillation: ``loop`` is ``integral F dD``, ``dissipated`` the solver's own loss.

    ``start`` and ``end`` are times of equal phase, one period apart; ``angular_frequency`` is the mean.
    """

    start: float
    end: float
    angular_frequency: float
    loop: float
    dissipated: float


def measure(trace: Trace, scene: Scene, wall_seconds: float) -> dict[str, float | None]:
    """Every scalar of a run by name: observables, losses of cycles, work counters and run time (s)."""
    zone = scene.adhesion.zone if scene.adhesion is not None and scene.is_adhesive else 0.0
    observed = observe(trace, zone, scene.loading, scene.ends_in_a_point)
    values: dict[str, float | None] = dict(observed.as_dict())
    stored = float(trace.stored_energy.max()) if len(trace) else 0.0
    branches = at_last_contact(trace, "branch_dissipation", zone, scene.ends_in_a_point)
    loss = values["dissipated_energy"]
    values["branch_dissipation"] = branches
    values["zone_excess"] = branches - loss if branches is not None and loss is not None else None
    values["loss_fall"] = largest_fall(trace)[0] if len(trace) else None
    values["loss_share"] = loss / stored if loss is not None and stored > 0.0 else None
    cycles = cycle_losses(trace, cycle_times(scene.loading))
    peak = max(cycles, key=lambda cycle: cycle.loop, default=None)
    values["peak_cycle_loss"] = peak.loop if peak else None
    values["peak_cycle_frequency"] = peak.angular_frequency if peak else None
    values |= {f"counters.{name}": float(count) for name, count in vars(trace.counters).items()}
    values["wall_seconds"] = wall_seconds
    return values


def observe(
    trace: Trace, zone: float = 0.0, loading: Loading | None = None, ends_in_a_point: bool = False
) -> Observables:
    """All observables of a run; of a run without a row, none.

    ``zone`` is the length of the process zone. ``loading`` tells whether the approach of a run that did not
    finish had ended. ``ends_in_a_point``: contact shrinks to nothing before it is lost.
    """
    if len(trace) == 0:
        return Observables()
    lost, last = trace.outcome.kind is OutcomeKind.DETACHED, last_in_contact(trace, zone)
    values: dict[str, float] = {
        "start_force": trace.force[0],
        "start_radius": trace.contact_radius[0],
        "loop_energy": loop_energy(trace),
        "dissipated_energy": trace.dissipated_energy[_lost(trace, zone, ends_in_a_point)],
        "final_time": trace.time[-1],
        "final_penetration": trace.penetration[-1],
        "final_force": 0.0 if lost else trace.force[-1],
        "final_radius": 0.0 if lost else trace.contact_radius[-1],
    }
    if trace.outcome.finished or approach_ended(trace, loading):
        values |= dict(_row(trace, end_of_approach(trace), "approach"))
        peak = peak_row(trace)
        if peak is not None:
            values |= {"peak_force": trace.force[peak], "peak_time": trace.time[peak]}
    pulling = pull_off_row(trace)
    if pulling is not None:
        values |= dict(_row(trace, pulling, "pull_off")) | {"pull_off_force": -trace.force[pulling]}
    values |= _detachment(trace, last, zone, ends_in_a_point)
    if "stage" in trace.extra:
        values["instability_loss"] = trace.extra["instability_loss"][-1]
        if "detachment_force" in values:
            values["stage_at_detachment"] = trace.extra["stage"][last]
    return Observables(**{name: float(value) for name, value in values.items()})


def at_last_contact(
    trace: Trace, column: str, zone: float = 0.0, ends_in_a_point: bool = False
) -> float | None:
    """A column at the row of detachment, or the last; ``None`` if the run has no such column or no row."""
    values = trace.columns().get(column)
    return None if values is None or not len(trace) else float(values[_lost(trace, zone, ends_in_a_point)])


def _lost(trace: Trace, zone: float, ends_in_a_point: bool) -> int:
    """The row of detachment, or the last.

    Where contact ends in a point that is the first row without: whether one before is just one rounding
    decides.
    """
    return min(last_in_contact(trace, zone) + ends_in_a_point, len(trace) - 1)


def loop_energy(trace: Trace) -> float:
    """``integral F dD`` over the run: the trace's ``external_work``.

    How a solver integrates between its rows is its own affair; trapezoids through the rows would add an error
    of their own where the load is curved and the rows are few.
    """
    return float(np.diff(trace.external_work).sum())


def largest_fall(trace: Trace) -> tuple[float, int, int]:
    """Largest fall of the loss from any row to a later one, not negative, and the two rows.

    It begins where the lines through the rows before and after meet, if that is beside the row: where an edge
    comes to a place at which it has rested the loss has a corner, on which no row lies.

    No material gives back what it has lost. The adhesive closure over a zone of finite length does not
    balance energies where an edge sets off from rest (``docs/explanation/model.md``), nor in first
    order of zone over radius. All solvers share that: ``compare`` holds their falls against each other.
    Without adhesion a loss that falls is an error.
    """
    loss = trace.dissipated_energy
    end = int(np.argmax(np.maximum.accumulate(loss) - loss))
    begin = int(np.argmax(loss[: end + 1]))
    rows = [slice(i - 1, i + 3) for i in (begin - 1, begin) if i > 0]
    crest = max([float(loss[begin]), *(_corner(trace.time[four], loss[four]) for four in rows)])
    return crest - float(loss[end]), begin, end


def _corner(t: Array, y: Array) -> float:
    """Where lines through the first two and the last two of four rows meet, if between; otherwise nothing."""
    if len(t) < 4 or not (t[1:] > t[:-1]).all():
        return -math.inf
    rise, fall = (y[1] - y[0]) / (t[1] - t[0]), (y[3] - y[2]) / (t[3] - t[2])
    ahead = y[2] - y[1] - fall * (t[2] - t[1])
    inside = 0.0 < ahead < (rise - fall) * (t[2] - t[1])
    return float(y[1] + rise * ahead / (rise - fall)) if fall < 0.0 < rise and inside else -math.inf


def cycle_losses(trace: Trace, times: ArrayLike) -> tuple[CycleLoss, ...]:
    """Losses of the cycles between consecutive ``times``, as far as the run went.

    A time that is no row of the trace is interpolated linearly, which costs second order in the row
    spacing; pass them to the solver as stop times to have them stepped onto.
    """
    if len(trace) < 2:
        return ()
    ends = np.asarray(times, float)
    slack = ROUND_OFF * (trace.time[-1] - trace.time[0])
    ends = ends[(ends >= trace.time[0] - slack) & (ends <= trace.time[-1] + slack)]
    work = np.concatenate(([0.0], np.cumsum(np.diff(trace.external_work))))
    at = [_until(trace, work, float(time)) for time in ends]
    return tuple(
        CycleLoss(float(a), float(b), float(2 * np.pi / (b - a)), right[0] - left[0], right[1] - left[1])
        for a, b, left, right in zip(ends[:-1], ends[1:], at[:-1], at[1:], strict=True)
    )


def _until(trace: Trace, work: Array, time: float) -> tuple[float, float]:
    """``integral F dD`` and dissipated energy up to ``time``; ``F`` and ``D`` almost linear between rows."""
    i = int(np.clip(np.searchsorted(trace.time, time, side="right") - 1, 0, len(trace) - 2))
    step = trace.time[i + 1] - trace.time[i]
    part = float(np.clip((time - trace.time[i]) / step, 0.0, 1.0)) if step > 0 else 1.0
    first, last = trace.force[i], trace.force[i + 1]
    depth = trace.penetration[i + 1] - trace.penetration[i]
    straight = (first + 0.5 * part * (last - first)) * part * depth
    done = straight + part * (work[i + 1] - work[i] - 0.5 * (first + last) * depth)
    loss = trace.dissipated_energy[i] + part * (trace.dissipated_energy[i + 1] - trace.dissipated_energy[i])
    return float(work[i] + done), float(loss)


def _row(trace: Trace, index: int, name: str) -> Iterator[tuple[str, float]]:
    for quantity in ("time", "penetration", "force"):
        yield f"{name}_{quantity}", getattr(trace, quantity)[index]
    yield f"{name}_radius", trace.contact_radius[index]


def _detachment(trace: Trace, last: int, zone: float, ends_in_a_point: bool) -> dict[str, float]:
    """The solver's own "pull-off" event where it gives one, else the last row still in contact.

    An event without a contact radius is the loss seen from the free surface: that of a punch is lost at once,
    and the row before it, at the same time, is the last state in contact.
    """
    if trace.outcome.kind is not OutcomeKind.DETACHED:
        return {}
    until = trace.time[last] + ROUND_OFF * float(np.ptp(trace.time))
    for event in reversed(trace.events):
        free = event.contact_radius == 0.0 and event.time <= until and not ends_in_a_point
        if event.kind == "pull-off" and event.contact_radius >= zone and not free:
            return {
                "detachment_time": event.time,
                "detachment_penetration": event.penetration,
                "detachment_radius": event.contact_radius,
                "detachment_force": event.force,
            }
    goes_on = np.any(trace.contact_radius[last + 1 :] > 0.0)  # below the zone
    row = dict(_row(trace, last, "detachment"))
    return row if goes_on else row | {"detachment_time": trace.outcome.time}
