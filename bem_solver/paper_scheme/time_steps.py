"""The fixed time step of the baseline: one a piece of loading, finer in proportion to the resolution."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from bem_solver.loading_intervals import Piece
from bem_solver.options import Options
from contact_scene import Scene

_FINENESS = 4.0
_SAMPLES = 256  # of the loading
_BROADEST = 1000.0  # relaxation times below this share of a piece are stepped over


def step_count(
    scene: Scene,
    piece: Piece,
    rate: Callable[[float], float],
    options: Options,
    largest: float,
    length: float,
) -> int:
    """Number of equal steps in which a piece is taken.

    A jump, which takes no time, is applied bit by bit, ``4 resolution`` of them. Elsewhere, unless
    ``options.step`` is given, a step is ``1/(4 resolution)`` of the shortest of

    - the time in which, at the fastest loading, the edge of the largest contact travels ``length``, the
      process zone;
    - the time in which that loading would sweep its range;
    - the shortest relaxation time, though not less than a thousandth of the piece: a fixed step cannot
      follow a spectrum over many decades, and both schemes are stable beyond it.

    Parameters
    ----------
    rate : callable
        Rate of the loading at a time.
    largest : float
        Largest contact radius.
    """
    if piece.jump:
        return math.ceil(_FINENESS * options.divisions)
    if options.step is not None:
        return max(math.ceil(piece.length / options.step * (1.0 - 1e-12)), 1)
    # at multiples of the golden ratio, behind which no periodic loading can hide
    share = np.modf(0.5 * (math.sqrt(5.0) - 1.0) * np.arange(_SAMPLES))[0]
    times = (piece.start + piece.length * share).tolist()
    values = [piece.value(t) for t in (*times, piece.end)]
    travel = piece.length * max(abs(rate(t)) for t in times)
    swing = max(values) - min(values)
    count = travel / swing if swing > 0.0 else 0.0
    slope = 2.0 * float(scene.indenter.slope(min(largest, scene.indenter.edge)))
    if piece.control == "force":
        slope *= 2.0 * scene.material.relaxed_plane_modulus * largest
    if slope > 0.0:
        count = max(count, travel / (slope * length))
    relaxation = scene.material.spectrum[1]
    if relaxation.size:
        count = max(count, piece.length / max(float(relaxation.min()), piece.length / _BROADEST))
    return max(math.ceil(_FINENESS * options.divisions * count), 1)
