"""Columns of force and position that stand the other way round, told by the rows without contact.

There the position moves and the force is at rest. With the two swapped the force moves while the position is
at rest, and goes on at the same pace when the position begins to move, or before it comes to rest. No contact
does that: what its force does at rest is relaxation, which a motion interrupts.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from validation.fits.baseline import CONTACT, features
from validation.fits.contact import white_noise
from validation.fits.record import Array, MeasuredCurve

FEWEST = 5
"""Rows at rest, and as many in motion beside them, from which a pace is read, at least."""
CONTACT_SHARE = 2
"""Rows of contact over those from which a pace is read, at least: beyond is the turning point."""
SAME_PACE = 2.0
"""Factor within which two paces are one: a drive goes on, what a soft spring makes of it included."""
AT_REST = 0.25
"""Pace at rest over that in motion, at most. A motion that is seen at all is known to a sixth of its pace: by
noise alone it never seems at rest."""


def exchanged(curve: MeasuredCurve) -> MeasuredCurve:
    """The record with its columns of force and position the other way round."""
    if curve.stage is None:
        return replace(curve, penetration=curve.force, force=curve.position, noise=None)
    return replace(curve, stage=curve.force, force=curve.position, noise=None)


def force_ignores_rest(curve: MeasuredCurve) -> bool:
    """Whether the force moves where the position is at rest, and at the same pace beside.

    Parameters
    ----------
    curve : MeasuredCurve

    Returns
    -------
    bool
        Of the beginning or of the end of the record, if the position is at rest there.
    """
    seen = features(exchanged(curve))
    most = (seen.last - seen.first) // CONTACT_SHARE
    return any(
        _goes_on(curve.time[::order], curve.force[::order], curve.position[::order], rest, most)
        for order, rest in ((1, seen.first), (-1, curve.time.size - seen.last))
    )


def _goes_on(time: Array, force: Array, position: Array, rest: int, most: int) -> bool:
    """Whether force has one pace before and after the position leaves its rest.

    Parameters
    ----------
    time, force, position : ndarray, shape (N,)
    rest : int
        Rows in which the position is at rest.
    most : int
        Rows from which a pace is read, at most; fewer are tried too, as a ramp may be short.

    Returns
    -------
    bool
    """
    mean = float(np.ptp(force) / np.ptp(time))
    noise = white_noise(force)
    position_noise = max(white_noise(position), _resolution(position))
    rows = min(rest, most)
    while rows >= FEWEST:
        parts = slice(rest - rows, rest), slice(rest, rest + rows)
        at_rest, beside = (_pace(time[part], force[part]) for part in parts)
        still, moving = (abs(_pace(time[part], position[part])) for part in parts)
        seen = CONTACT / float(np.linalg.norm(time[parts[1]] - time[parts[1]].mean()))
        moves_on = min(abs(at_rest), abs(beside)) > max(mean / SAME_PACE, seen * noise)
        if (
            moves_on
            and 1.0 / SAME_PACE < at_rest / beside < SAME_PACE
            and moving > max(still / AT_REST, seen * position_noise)
        ):
            return True
        rows //= 2
    return False


def _pace(time: Array, values: Array) -> float:
    """Slope of the straight line through some rows."""
    centred = time - time.mean()
    return float(centred @ values / (centred @ centred))


def _resolution(values: Array) -> float:
    """Smallest change between neighbouring rows: of a sensor with few digits, one of these."""
    changes = np.abs(np.diff(values))
    return float(changes[changes > 0.0].min(initial=np.inf))
