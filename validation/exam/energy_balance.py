"""Whether the energies of an answer close.

    external work = change of stored energy + energy spent at the edge + loss

Spent at the edge is ``work`` for an area that opens; given back is ``work_closing`` for one that closes. On
a spring of stiffness ``k`` the work is that of the stage, and the spring stores ``F^2/(2 k)``. Where the work
of adhesion follows the speed of the edge the balance is not judged: radii do not hold that speed.
"""

from __future__ import annotations

import numpy as np

from contact_scene import Scene, Trace

NEEDED = {"contact_radius", "stored_energy", "external_work", "dissipated_energy"}
"""Columns of an answer without which there is no balance; on a spring the force too."""


def balance_error(columns: set[str], rows: Trace, scene: Scene) -> float | None:
    """What is left of the balance, relative to its largest term.

    Parameters
    ----------
    columns : set of str
        Those that the answer has.
    rows : Trace
        Its rows in contact.
    scene : Scene

    Returns
    -------
    float or None
        ``None`` where it cannot be judged.
    """
    compliance, adhesion = scene.loading.compliance, scene.adhesion
    needed = NEEDED | ({"force"} if compliance > 0.0 else set())
    if not needed <= columns or len(rows) < 2 or (adhesion is not None and adhesion.rate is not None):
        return None
    stored = rows.stored_energy + 0.5 * compliance * rows.force**2
    opened = -np.pi * np.diff(rows.contact_radius**2)
    spent = np.zeros(len(rows))
    if adhesion is not None:
        spent[1:] = np.cumsum(np.where(opened > 0.0, adhesion.work, adhesion.closing) * opened)
    gone = (rows.external_work - rows.external_work[0]) - (stored - stored[0]) - spent
    left = gone - (rows.dissipated_energy - rows.dissipated_energy[0])
    largest = max(float(np.abs(term).max()) for term in (stored, rows.external_work, spent))
    return float(np.abs(left).max()) / largest if largest > 0.0 else None
