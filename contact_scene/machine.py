"""The machine that holds the indenter: a spring between the indenter and the stage that is driven.

An atomic force microscope is a spring of known stiffness, and every test rig has one in series. With the
stage at ``X`` the spring of stiffness ``k`` leaves the indenter at the penetration

    ``D = X - F/k``,

and holds the energy ``F^2/(2 k)``. ``X`` is positive downwards as ``D`` is, and equals it without force. The
work done on contact and machine together is that of the stage, ``int F dX = int F dD + [F^2/(2 k)]``.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Annotated

import numpy as np
from numpy.typing import NDArray

from contact_scene.checked import Checked, Key
from contact_scene.trace import Event, Trace
from contact_scene.value_checks import LARGEST, SMALLEST, Range

Array = NDArray[np.float64]

COLUMNS_OF_MACHINE = ("stage", "machine_energy", "instability_loss")
"""Columns of a trace beside the others where the machine is a spring."""


@dataclass(frozen=True)
class Machine(Checked):
    """A spring of ``stiffness`` > 0 (force per length) in series with the contact; ``inf`` is rigid.

    Examples
    --------
    >>> cc.Machine(stiffness=0.1).compliance
    10.0
    """

    stiffness: Annotated[
        float,
        Range(
            f"a number > 0, from {SMALLEST:g} to {LARGEST:g} (force per length), or inf: rigid",
            SMALLEST,
            also=(math.inf,),
        ),
        Key("stiffness of the spring that holds the indenter", "force length-1"),
    ]

    @property
    def compliance(self) -> float:
        """``1/k``; 0 for a rigid machine."""
        return 1.0 / self.stiffness


def machine_columns(
    columns: Mapping[str, Array], machine: Machine, events: Sequence[Event]
) -> dict[str, Array]:
    """Columns that follow from the machine, and the external work as that of the stage.

    ``columns`` are those of a trace, its external work that of the indenter, ``int F dD``, a straight line in
    force and penetration where the edge moves at once. Each of the ``events`` starts from a row or, at the
    time of a row, next to it. Returned are ``stage`` (D + F/k), ``machine_energy`` (F^2/(2 k)),
    ``instability_loss`` (lost so far in instabilities, at constant stage and within no time; part of the
    dissipated energy) and ``external_work``.
    """
    force, compliance = columns["force"], machine.compliance
    energy = 0.5 * compliance * force**2
    loss = np.zeros_like(force)
    for event in events:
        row = _row_of(columns, event)
        if row is not None and row + 1 < len(force):
            loss[row + 1 :] += columns["dissipated_energy"][row + 1] - columns["dissipated_energy"][row]
    return {
        "stage": columns["penetration"] + compliance * force,
        "machine_energy": energy,
        "instability_loss": loss,
        "external_work": columns["external_work"] + (energy - energy[:1]),
    }


def on_machine(trace: Trace, machine: Machine | None) -> Trace:
    """The trace with the columns of its machine; as it is without one, or with a rigid one."""
    if machine is None or machine.compliance == 0.0:
        return trace
    columns = machine_columns(trace.columns(), machine, trace.events)
    extra = trace.extra | {name: columns[name] for name in COLUMNS_OF_MACHINE}
    return replace(trace, external_work=columns["external_work"], extra=extra)


def _row_of(columns: Mapping[str, Array], event: Event) -> int | None:
    """The row from which an instability starts: of those at its time the one next to its contact radius.

    A solver may know the limit point better than its rows do.
    """
    rows = np.flatnonzero(columns["time"] == event.time)
    if not rows.size:
        return None
    apart = np.abs(columns["contact_radius"][rows] - event.contact_radius)
    return int(rows[np.flatnonzero(apart == apart.min())[-1]])
