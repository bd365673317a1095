"""The fixed time step of the paper scheme, per loading interval, in inverse proportion to the resolution."""

from __future__ import annotations

import math

import numpy as np

from bem_solver.loading_intervals import LoadingInterval
from bem_solver.options import Options
from contact_scene import Scene

_STEPS_PER_RESOLUTION = 4.0
"""Steps per unit of the resolution in the shortest of the times to be resolved."""
_SAMPLES = 256
"""Times per interval at which the loading is sampled."""
_LONGEST_RATIO = 1000.0
"""Interval length over relaxation time above which the latter is no longer resolved."""


def step_count(
    scene: Scene,
    interval: LoadingInterval,
    options: Options,
    largest: float,
    length: float,
) -> int:
    """Number of equal steps in which an interval is taken.

    A jump, which takes no time, is applied in ``4 resolution`` equal steps. Elsewhere, unless
    ``options.step`` is given, a step is ``1/(4 resolution)`` of the shortest of

    - the time in which, at the fastest loading, the edge of the largest contact travels ``length``, the
      process zone;
    - the time in which that loading would sweep its range;
    - the shortest relaxation time, though not less than a thousandth of the interval: a fixed step cannot
      follow a spectrum over many decades, and both schemes are stable beyond it.

    Parameters
    ----------
    scene : Scene
    interval : LoadingInterval
    options : Options
    largest : float
        Largest contact radius.
    length : float
        Length of the process zone, or of ``resolution`` annuli without adhesion.

    Returns
    -------
    int
    """
    if interval.jump:
        return math.ceil(_STEPS_PER_RESOLUTION * options.divisions)
    if options.step is not None:
        return max(math.ceil(interval.length / options.step * (1.0 - 1e-12)), 1)
    # at multiples of the golden ratio, behind which no periodic loading can hide
    share = np.modf(0.5 * (math.sqrt(5.0) - 1.0) * np.arange(_SAMPLES))[0]
    times = (interval.start + interval.length * share).tolist()
    values = [interval.value(t) for t in (*times, interval.end)]
    travel = interval.length * max(abs(interval.rate(t)) for t in times)
    swing = max(values) - min(values)
    count = travel / swing if swing > 0.0 else 0.0
    slope = 2.0 * float(scene.indenter.slope(min(largest, scene.indenter.edge)))
    if interval.control == "force":
        slope *= 2.0 * scene.material.relaxed_plane_modulus * largest
    if slope > 0.0:
        count = max(count, travel / (slope * length))
    relaxation = scene.material.spectrum[1]
    if relaxation.size:
        count = max(count, interval.length / max(float(relaxation.min()), interval.length / _LONGEST_RATIO))
    return max(math.ceil(_STEPS_PER_RESOLUTION * options.divisions * count), 1)
