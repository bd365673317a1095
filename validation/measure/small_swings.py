"""A contact edge that goes to and fro over fewer nodes of a mesh than tell how far.

Without adhesion the finite elements hold whole nodes in contact. Between nodes the edge is read from stresses
and gaps, which is right for an elastic solid. Where the solid relaxes, what a part of a node has been through
is not known, and how far the edge goes is off by up to 0.16 of its way over four nodes and fewer (once 0.2),
0.06 over eight, 0.02 over sixteen (120 oscillations with random branches, amplitudes and frequencies).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from contact_scene import Loading, Trace
from validation.measure.windows import windows

FEW_NODES = 8.0
"""Nodes below which a movement is said to be poorly known."""
BACK = 0.1
"""Part of its excursion by which a quantity has to come back, to go to and fro."""


def swing_warnings(trace: Trace, loading: Loading, spacing: float) -> tuple[str, ...]:
    """A sentence on the smallest swing of the edge, if that is over few nodes.

    Parameters
    ----------
    trace : Trace
    loading : Loading
    spacing : float
        Of the nodes, a length; 0 if the edge may rest anywhere.

    Returns
    -------
    tuple of str
        None or one.
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
