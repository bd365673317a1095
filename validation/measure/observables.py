"""The only definitions of what is measured on a run, the same for every solver.

Signs: penetration ``D`` positive downwards, force ``F`` positive in compression, tension reported positive.
Units are the scene's. Values are those of rows of the trace: no parabola is laid through a maximum, nothing
is extrapolated, so a coarse trace shows as a coarse number. What does not apply is ``None``.

A jump of the load or of the answer is a pair of rows of equal time; it belongs to the curve and counts in
every integral over the penetration.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from contact_scene import Loading, OutcomeKind, Trace
from validation.measure.approach import approach_ended, end_of_approach
from validation.measure.round_off import ROUND_OFF

Array = NDArray[np.float64]

PULLED_BACK = 1e-6
"""Part of the range of the penetration by which an indenter is pulled back: on a spring the penetration is
found with the edge, and rows at nearly the same time may go back by what neither is known."""


@dataclass(frozen=True)
class Observables:
    """Scalars of one run.

    Parameters
    ----------
    start_force, start_radius : float or None
        First row.
    approach_time, approach_penetration, approach_force, approach_radius : float or None
        End of the approach, the first crest of the penetration that may be its largest value (see
        :mod:`validation.measure.approach`). ``None`` for a run that did not finish, unless the approach had
        ended.
    peak_force, peak_time : float or None
        Largest compressive force of the run, and when it is reached first (see :func:`peak_row`); ``None`` of
        a run that did not finish as for the approach, and without compression.
    pull_off_force : float or None
        Largest tension ``max(-F)`` of the run, if it is an extremum that the run has passed (see
        :func:`pull_off_row`): not the tension with which a run begins or which still rises at its end.
    pull_off_time, pull_off_penetration, pull_off_radius : float or None
        There; on a plateau of the force (force control) its last row.
    detachment_time, detachment_penetration, detachment_radius, detachment_force : float or None
        Last state in contact of a run that lost contact. ``None`` where the contact shrank to its process
        zone: there the model ends, not the contact, and the state is ``final_*``.
    stage_at_detachment : float or None
        Position of the stage there; only of a machine with a spring.
    loop_energy : float or None
        ``integral F dD`` over the run; on a spring the work of the stage, ``integral F dX``.
    dissipated_energy : float or None
        The solver's own loss at the end of the run, or at detachment: what the snap to the free surface sets
        free then is no viscous loss.
    instability_loss : float or None
        Lost in instabilities of the whole run, at constant stage; only of a machine with a spring.
    final_time, final_penetration, final_force, final_radius : float or None
        Last row. Of a run that lost contact force and radius are zero, whether or not the solver ends with
        a row of the free surface; the last state in contact is ``detachment_*``.
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


def observe(
    trace: Trace, zone: float = 0.0, loading: Loading | None = None, ends_in_a_point: bool = False
) -> Observables:
    """All observables of a run; of a run without a row, none.

    Parameters
    ----------
    trace : Trace
    zone : float
        Length of the process zone.
    loading : Loading, optional
        What was asked for: whether the approach of a run that did not finish had ended.
    ends_in_a_point : bool
        Whether contact shrinks to nothing before it is lost (``Scene.ends_in_a_point``).

    Returns
    -------
    Observables
    """
    if len(trace) == 0:
        return Observables()
    lost = trace.outcome.kind is OutcomeKind.DETACHED
    values: dict[str, float] = {
        "start_force": trace.force[0],
        "start_radius": trace.contact_radius[0],
        "loop_energy": loop_energy(trace),
        "dissipated_energy": trace.dissipated_energy[_last_in_contact(trace, zone)],
        "final_time": trace.time[-1],
        "final_penetration": trace.penetration[-1],
        "final_force": 0.0 if lost else trace.force[-1],
        "final_radius": 0.0 if lost else trace.contact_radius[-1],
    }
    if trace.outcome.finished or approach_ended(trace, loading):
        values |= _row(trace, end_of_approach(trace), "approach")
        peak = peak_row(trace)
        if peak is not None:
            values |= {"peak_force": trace.force[peak], "peak_time": trace.time[peak]}
    pulling = pull_off_row(trace)
    if pulling is not None:
        at = _row(trace, pulling, "pull_off")
        values |= at | {"pull_off_force": -at["pull_off_force"]}
    values |= _detachment(trace, zone, ends_in_a_point)
    if "stage" in trace.extra:
        values["instability_loss"] = trace.extra["instability_loss"][-1]
        if "detachment_force" in values:
            values["stage_at_detachment"] = trace.extra["stage"][_last_in_contact(trace, zone)]
    return Observables(**{name: float(value) for name, value in values.items()})


def largest_tension(trace: Trace) -> int | None:
    """Index of the last row at the largest tension; ``None`` without tension beyond round-off."""
    tension = -trace.force
    slack = ROUND_OFF * float(np.abs(trace.force).max())
    if tension.max() <= slack:
        return None
    return int(np.flatnonzero(tension >= tension.max() - slack)[-1])


def peak_row(trace: Trace) -> int | None:
    """Index of the first row at the largest compressive force; ``None`` without one beyond round-off."""
    slack = ROUND_OFF * float(np.abs(trace.force).max())
    largest = float(trace.force.max())
    return int(np.flatnonzero(trace.force >= largest - slack)[0]) if largest > slack else None


def pull_off_row(trace: Trace) -> int | None:
    """Index of the last row at the largest tension, if that is the pull-off force.

    It is if the indenter pulls there (some earlier row is deeper), and if the run has passed the extremum:
    the tension falls afterwards, or contact is lost. Of a run that loses contact without ever being pulled
    back, such as during a hold, it is the largest tension after the first row. A contact that has shrunk to
    its process zone has passed the extremum only if its outcome says so.
    """
    tension = -trace.force
    slack = ROUND_OFF * float(np.abs(trace.force).max())
    depth = trace.penetration
    pulled_back = depth < np.maximum.accumulate(depth) - PULLED_BACK * float(np.ptp(depth))
    kind = trace.outcome.kind
    if kind is OutcomeKind.BELOW_ZONE and not trace.outcome.past_extremum:
        return None
    if kind is OutcomeKind.DETACHED and not np.any(pulled_back & (tension > slack)):
        pulled_back = np.arange(len(trace)) > 0
    pulling = np.flatnonzero(pulled_back & (tension > slack))
    if pulling.size == 0:
        return None
    largest = float(tension[pulling].max())
    row = int(pulling[tension[pulling] >= largest - slack][-1])
    falls = bool(np.any(tension[row + 1 :] < largest - slack))
    return row if falls or kind is OutcomeKind.DETACHED else None


def at_last_contact(trace: Trace, column: str, zone: float = 0.0) -> float | None:
    """A column at the row of detachment, or the last; ``None`` if the run has no such column or no row.

    Parameters
    ----------
    trace : Trace
    column : str
        Name.
    zone : float
        Length of the process zone; 0 without adhesion.

    Returns
    -------
    float or None
    """
    values = trace.columns().get(column)
    return None if values is None or len(trace) == 0 else float(values[_last_in_contact(trace, zone)])


def loop_energy(trace: Trace) -> float:
    """``integral F dD`` over the run: the trace's ``external_work``.

    How a solver integrates between its rows is its own affair; trapezoids through the rows would add an error
    of their own where the load is curved and the rows are few.
    """
    return float(np.diff(trace.external_work).sum())


def _row(trace: Trace, index: int, name: str) -> dict[str, float]:
    return {
        f"{name}_time": trace.time[index],
        f"{name}_penetration": trace.penetration[index],
        f"{name}_force": trace.force[index],
        f"{name}_radius": trace.contact_radius[index],
    }


def _detachment(trace: Trace, zone: float, ends_in_a_point: bool) -> dict[str, float]:
    """The solver's own "pull-off" event where it gives one, else the last row still in contact.

    An event without a contact radius is the loss seen from the free surface: that of a punch is lost at once,
    and the row before it, at the same time, is the last state in contact.
    """
    if trace.outcome.kind is not OutcomeKind.DETACHED:
        return {}
    last = _last_in_contact(trace, zone)
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
    if np.any(trace.contact_radius[last + 1 :] > 0.0):  # contact continues below the zone
        return _row(trace, last, "detachment")
    return _row(trace, last, "detachment") | {"detachment_time": trace.outcome.time}


def _last_in_contact(trace: Trace, zone: float) -> int:
    """Of a run that lost contact the last row in contact and no shorter than the zone, else the last row."""
    radius = trace.contact_radius
    if trace.outcome.kind is OutcomeKind.DETACHED:
        for touching in (np.flatnonzero((radius > 0.0) & (radius >= zone)), np.flatnonzero(radius > 0.0)):
            if touching.size:
                return int(touching[-1])
    return len(trace) - 1
