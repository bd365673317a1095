"""Samples of the unit cube: Latin hypercubes and Sobol points, by SciPy."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray
from scipy.stats import qmc

SAMPLES = ("latin-hypercube", "sobol")
DESIGNS = ("grid", "points", *SAMPLES)


def shares(kind: str, dimensions: int, count: int, seed: int) -> NDArray[np.float64]:
    """A sample of the unit cube.

    The first points of a longer Sobol sample with the same seed are those of a shorter one: a plan that asks
    for more points later shares the ones it has.

    Parameters
    ----------
    kind : str
        One of ``SAMPLES``.
    dimensions, count, seed : int

    Returns
    -------
    (count, dimensions) array
        Shares, 0 to 1.
    """
    random = np.random.default_rng(seed)
    if kind == "sobol":
        blocks = max(math.ceil(math.log2(count)), 0)
        points: NDArray[np.float64] = qmc.Sobol(dimensions, seed=random).random_base2(blocks)[:count]
        return points
    cube: NDArray[np.float64] = qmc.LatinHypercube(dimensions, seed=random).random(count)
    return cube
