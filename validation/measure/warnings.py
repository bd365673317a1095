"""What a run says of itself beside its numbers: where it is in doubt, and which work it left out."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from contact_scene import Loading, Scene, Trace
from validation.measure.observables import largest_fall
from validation.measure.scaling import scale
from validation.measure.windows import windows
from validation.solvers import SOLVERS
from validation.solvers.base import SKIPPED_WORK

FEW_NODES = 8.0
"""Nodes below which a movement of the edge is said to be poorly known. Without adhesion the finite elements
hold whole nodes in contact; where the solid relaxes, how far the edge goes is off by up to 0.16 of its way
over four nodes and fewer (once 0.2), 0.06 over eight, 0.02 over sixteen (120 random oscillations)."""
BACK = 0.1
"""Part of its excursion by which a quantity has to come back, to go to and fro."""


def swing_warnings(trace: Trace, loading: Loading, spacing: float) -> tuple[str, ...]:
    """A sentence on the smallest swing of the edge to and fro, if that is over few nodes of a mesh.

    ``spacing`` is that of the nodes, 0 if the edge may rest anywhere.
    """
    if spacing <= 0.0 or len(trace) == 0:
        return ()
    swings = []
    for begin, end in windows(loading, trace):
        rows = slice(*np.searchsorted(trace.time, [begin, end * (1.0 + 1e-12)]))
        if _to_and_fro(trace.penetration[rows]) and _to_and_fro(trace.contact_radius[rows]):
            swings.append((float(np.ptp(trace.contact_radius[rows])) / spacing, begin, end))
    nodes, begin, end = min(swings, default=(np.inf, 0.0, 0.0))
    if nodes >= FEW_NODES:
        return ()
    when = f"from t = {begin:.4g} to {end:.4g}"
    few = f"over {nodes:.2g} nodes of the mesh, fewer than {FEW_NODES:g}"
    doubt = "its swing may be off by a fifth, by less at a finer resolution"
    return (f"{when} the contact edge goes to and fro {few}: {doubt}",)


def _to_and_fro(values: NDArray[np.float64]) -> bool:
    """Whether a quantity moves, and comes back by a part of its way."""
    if values.size < 2:
        return False
    steps = np.diff(values)
    least = BACK * float(np.ptp(values))
    return least > 0.0 and bool(min(steps[steps > 0.0].sum(), -steps[steps < 0.0].sum()) > least)


def fall_warnings(scene: Scene, trace: Trace, error: float) -> tuple[str, ...]:
    """A sentence on a loss that falls by more than its ``error``, relative as in ``scaling``."""
    if len(trace) == 0:
        return ()
    fall, begin, end = largest_fall(trace)
    largest = scale("loss_fall", fall, trace)
    if fall <= error * largest:
        return ()
    when = f"from t = {trace.time[begin]:.4g} to {trace.time[end]:.4g}"
    why = "without adhesion that is an error of the solver"
    if scene.adhesion is not None and scene.is_adhesive:
        zone = f"the adhesive closure over a zone of {scene.adhesion.zone:.3g}"
        why = f'{zone} does not balance energies there ("Where the loss falls" in the documentation)'
    return (f"the loss falls by {fall:.3g}, {fall / largest:.2g} of the largest energy, {when}: {why}",)


def left_out(scheme: str, counters: Mapping[str, float | None]) -> list[str]:
    """The parts of its work that a solver or scheme left out, in words; none if a counter is not known."""
    meanings = SOLVERS[scheme].skipped_work if scheme in SOLVERS else SKIPPED_WORK
    return [text for name, text in meanings.items() if counters.get(name) == 0]


def left_out_by_all(work: Mapping[str, Mapping[str, float | None]]) -> str:
    """A sentence on all solvers of a scene, ``work`` being their counters by name."""
    skipped = [f"{name}: {', '.join(parts)}" for name, c in work.items() if (parts := left_out(name, c))]
    if not skipped:
        return "Nothing was left out: by its counters every solver did all kinds of its work."
    return f"Left out because the scene did not need it, by the counters: {'; '.join(skipped)}."
