"""Energy spent in the interface by an edge that takes up on opening what its speed tells.

On opening the edge takes up ``w`` per area, on closing it gives ``work_closing`` back. The closure integral
at an opening edge is ``w``. As an edge departs, ``w`` rises with the root of its speed or the like, steeply
over the area, but both are smooth in time: the integral over the area is taken along cubics in time. At
fixed time an edge takes up the most its law allows, or, where that has no bound, what is released.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from contact_scene import Adhesion
from validation.reference.tracking.row_integrals import integrals

Array = NDArray[np.float64]


def interface_work(adhesion: Adhesion, time: Array, area: Array, closure: Array, ends: list[int]) -> Array:
    """Energy spent between rows.

    Parameters
    ----------
    adhesion : Adhesion
    time, area, closure : ndarray, shape (l,)
        Time, contact area, and closure integral at the rows, 0 without contact.
    ends : list of int
        Rows at which smooth stretches end and begin.

    Returns
    -------
    ndarray, shape (l - 1,)
    """
    taken = taken_at(adhesion, closure)
    grown = np.diff(area)
    opened = integrals(time, taken, area, ends)
    at_once = adhesion.opening(math.inf)
    jump = at_once if math.isfinite(at_once) else 0.5 * (taken[1:] + taken[:-1])
    opened = np.where(np.diff(time) > 0.0, opened, jump * grown)
    return -np.where(grown > 0.0, adhesion.closing * grown, opened)


def taken_at(adhesion: Adhesion, closure: Array) -> Array:
    """What an opening edge takes up where the closure integral is ``closure``; ``work`` at rest."""
    return np.clip(closure, adhesion.work, adhesion.opening(math.inf))
