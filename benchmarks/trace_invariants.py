"""What must hold for the answer of any solver to any scene, told from its rows alone."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from contact_scene import Force, ForceRamp, OutcomeKind, Ramp, Scene, Table, Trace
from contact_scene.machine import COLUMNS_OF_MACHINE

ROUND_OFF = 1e-12
"""Of an energy, relative to the largest effort of the run: what is negative by less is zero. Of a
penetration, relative to the largest: the end of a long way is met to a rounding error of the way."""
REACHED = 1e-6
"""Largest distance of the last force from the prescribed one, relative to the largest force."""
CLEAR = (
    OutcomeKind.NO_EQUILIBRIUM,
    OutcomeKind.OUT_OF_RANGE,
    OutcomeKind.BELOW_ZONE,
    OutcomeKind.TRIGGER_NOT_REACHED,
)
"""Endings that are no full answer, and no failure either: there is none, or none within the model."""


def broken(scene: Scene, trace: Trace) -> list[str]:
    """Every statement about the form of an answer that does not hold: what is finite, ordered, reached."""
    columns = trace.columns()
    found = [f"{name} is not finite" for name, column in columns.items() if not np.isfinite(column).all()]
    found += [
        f"{name} has {column.size} rows for {trace.time.size} times"
        for name, column in columns.items()
        if column.shape != trace.time.shape
    ]
    if not trace.outcome.reason:
        found.append("the outcome has no reason")
    if not math.isfinite(trace.outcome.time):
        found.append("the time of the outcome is not finite")
    if any(
        not np.isfinite([event.time, event.penetration, event.force, event.contact_radius]).all()
        for event in trace.events
    ):
        found.append("an event is not finite")
    if not all(math.isfinite(error) for error in trace.errors.values()):
        found.append("an error estimate is not finite")
    if np.any(np.diff(trace.time) < 0.0):
        found.append("time runs back")
    if np.any(trace.contact_radius < 0.0):
        found.append("a contact radius is negative")
    return found + _not_reached(scene, trace) + _off_the_spring(scene, trace)


def _off_the_spring(scene: Scene, trace: Trace) -> list[str]:
    """On a spring: stage and energy of the machine in every row, no work of a stage that stands still."""
    compliance = scene.loading.compliance
    if compliance == 0.0 or len(trace) == 0:
        return []
    missing = [f"there is no column {name}" for name in COLUMNS_OF_MACHINE if name not in trace.extra]
    if missing:
        return missing
    found = []
    stage, energy = (trace.extra[name] for name in ("stage", "machine_energy"))
    if not np.allclose(stage, trace.penetration + compliance * trace.force, rtol=ROUND_OFF, atol=0.0):
        found.append("the stage is not D + F/k")
    if not np.allclose(energy, 0.5 * compliance * trace.force**2, rtol=ROUND_OFF, atol=0.0):
        found.append("the energy of the machine is not F^2/(2 k)")
    most = np.abs(stage).max()
    at_once = (np.diff(trace.time) == 0.0) & (np.abs(np.diff(stage)) <= ROUND_OFF * most)
    work = np.abs(np.diff(trace.external_work)[at_once]).max(initial=0.0)
    if work > REACHED * (effort(scene, trace) + energy.max()):
        found.append("a stage that stands still does work")
    return found


def _not_reached(scene: Scene, trace: Trace) -> list[str]:
    if trace.outcome.kind is not OutcomeKind.COMPLETED or len(trace) == 0 or not scene.loading.steps:
        return []
    depth, force = float(trace.penetration[-1]), float(trace.force[-1])
    last = scene.loading.steps[-1]
    if last.trigger is not None:
        excess = last.trigger.excess(depth, force, float(trace.contact_radius[-1]))
        at_level = abs(excess) <= REACHED * abs(last.trigger.level) or bool(trace.events)
        return [] if at_level else ["the level that ends the last step is missed"]
    match last:
        case Ramp(to=to) | Table(values=(*_, to), quantity="penetration"):
            if scene.loading.compliance > 0.0:
                stage = trace.extra["stage"]
                near = abs(float(stage[-1]) - to) <= REACHED * np.abs(stage).max(initial=abs(to))
                return [] if near else ["the last stage is not the prescribed one"]
            near = abs(depth - to) <= ROUND_OFF * float(np.abs(trace.penetration).max())
            return [] if near else ["the last penetration is not the prescribed one"]
        case Force(value=to) | ForceRamp(to=to) | Table(values=(*_, to), quantity="force"):
            near = abs(force - to) <= REACHED * np.abs(trace.force).max(initial=abs(to))
            return [] if near else ["the last force is not the prescribed one"]
    return []


def energy_gained(scene: Scene, trace: Trace, accuracy: float) -> list[str]:
    """Branches only dissipate; no stored energy is negative; without adhesion nothing is gained."""
    if len(trace) == 0:
        return []
    energy = effort(scene, trace)
    found = []
    if np.diff(trace.extra.get("branch_dissipation", np.zeros(1))).min(initial=0.0) < -accuracy * energy:
        found.append("the branches gain energy")
    if trace.stored_energy.min() < -ROUND_OFF * energy:
        found.append("the stored energy is negative")
    if not scene.is_adhesive and trace.dissipated_energy[in_contact(trace)].min() < -accuracy * energy:
        found.append("energy is gained without adhesion")
    return found


def effort(scene: Scene, trace: Trace) -> float:
    """The largest force all along the path of the penetration, and adhesion all along that of the area.

    A force that is off by its tolerance of the largest does that much work; energies are no better.
    """
    work = scene.adhesion.work if scene.adhesion is not None else 0.0
    path = float(np.abs(np.diff(trace.penetration)).sum())
    swept = np.pi * float(np.abs(np.diff(trace.contact_radius**2)).sum())
    stored = float(trace.stored_energy.max(initial=0.0))
    return max(stored, float(np.abs(trace.force).max(initial=0.0)) * path + work * swept)


def in_contact(trace: Trace) -> slice:
    """All rows but those after contact was lost, where the energy set free by the snap is booked."""
    touching: NDArray[np.intp] = np.flatnonzero(trace.contact_radius > 0.0)
    lost = trace.outcome.kind is OutcomeKind.DETACHED and touching.size > 0
    return slice(0, int(touching[-1]) + 1 if lost else len(trace))
