"""Puts the maps of the built-in sweeps into the documentation, and prints what its text reads off them.

Run ``python docs/make_sweeps.py OUT`` after ``crosscontact sweep NAME --out OUT/NAME`` of ``speed-preload``,
``speed-zone`` and ``speed-stiffness``; writes ``docs/sweep-NAME.png``.
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
import xarray
from numpy.typing import NDArray

from contact_scene import Scene
from validation.cases import load
from validation.drawing.export import png
from validation.sweeps.dataset import read_dataset
from validation.sweeps.figures import figures

DOCS = Path(__file__).parent
PLANS = ("speed-preload", "speed-zone", "speed-stiffness")
MEASURE = "pull_off_force"


def over_jkr(data: xarray.Dataset, scene: Scene) -> NDArray[np.float64]:
    """Pull-off force over that of an elastic sphere, ``3/2 pi R work``; one row a speed."""
    assert scene.adhesion is not None
    force = data[MEASURE].transpose("speed", ...).values
    return force / (1.5 * np.pi * scene.adhesion.work * scene.indenter.radius)


def speed_at(speeds: NDArray[np.float64], column: NDArray[np.float64], level: float) -> float:
    """The slowest speed at which a column passes a level; NaN if it never does."""
    above = np.flatnonzero(column >= level)
    if above.size == 0 or above[0] == 0:
        return float("nan")
    at = above[0]
    share = (level - column[at - 1]) / (column[at] - column[at - 1])
    return float(np.exp(np.interp(share, (0.0, 1.0), np.log(speeds[at - 1 : at + 1]))))


def preload(data: xarray.Dataset, ratio: NDArray[np.float64]) -> None:
    """Fig. 4: less at lower speed, elastic at the slowest, a plateau of E_inf/E0 at the fastest."""
    falls = -np.nanmin(np.diff(ratio, axis=0) / ratio[1:])
    print(f"  largest fall with speed, of the force: {max(falls, 0.0):.1e}")
    print(f"  slowest: {np.nanmin(ratio[0]):.3f} to {np.nanmax(ratio[0]):.3f} F_JKR over all preloads")
    plateau = ratio[-1, -1]
    from_here = data.preload.values[np.flatnonzero(ratio[-1] > 0.95 * plateau)[0]]
    print(f"  fastest: {plateau:.2f} F_JKR at the largest preload, 95 % of it from {from_here:.3g} on")


def zone(data: xarray.Dataset, ratio: NDArray[np.float64]) -> None:
    """Fig. 2: the same force at both ends, a maximum between them that a shorter zone shifts."""
    for index, length in enumerate(data.zone.values):
        column = ratio[:, index]
        top, half = int(np.nanargmax(column)), (np.nanmax(column) + 1.0) / 2.0
        highest = f"{column[top]:.2f} at {data.speed.values[top]:.2g}"
        print(
            f"  zone {length:.4g}: {column[0]:.3f} F_JKR slowest, {highest}, {column[-1]:.3f} fastest; "
            f"half of the rise at {speed_at(data.speed.values, column, half):.2g}"
        )


def stiffness(data: xarray.Dataset, ratio: NDArray[np.float64]) -> None:
    """A soft spring shifts the rise to faster stages, and more is lost as the contact goes."""
    half = (np.nanmax(ratio) + 1.0) / 2.0
    for index, spring in enumerate(data.stiffness.values):
        lost = data.instability_loss.transpose("speed", ...).values[-1, index]
        at = speed_at(data.speed.values, ratio[:, index], half)
        print(
            f"  k = {spring:.4g}: {ratio[0, index]:.2f} to {ratio[-1, index]:.2f} F_JKR, half of the rise at "
            f"{at:.2g}; {lost:.2e} lost in the jump at the fastest"
        )


def main() -> None:
    """Draw and print."""
    out = Path(sys.argv[1])
    for name, read_off in zip(PLANS, (preload, zone, stiffness), strict=True):
        data = read_dataset(out / name)
        file = DOCS / f"sweep-{name}.png"
        file.write_bytes(png(figures(data)[MEASURE]))
        print(f"{file.name}: largest error estimate {float(data[MEASURE + '_error'].max()):.1e}")
        read_off(data, over_jkr(data, load(data.attrs["scene"]).scene))


if __name__ == "__main__":
    main()
