"""A record that goes in and out once: where its rows are free, and what the force is there.

The background of all free rows is linear in what may make it: level, tilt over the stage, drag with the
speed of the stage, drift over time, a wave. Rows before contact and behind its loss have equal weight,
whatever their number; rows off it, of tethers, have little (Huber).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from validation.fits.contact import Array, wave_columns

FAR, ROUGH, SHALLOW = 5.0, 2.5, 0.02
"""Deviations of a mean of rows, and of a row, from which the retraction is off its own line; share of the
deepest force below which it is no contact: the ring-down behind a jump."""
EXTENSIONS = 8
"""Of the line, each by no more than its own length, as a line through a few rows says little far away."""
JUMP, JUMP_SHARE, LEFT = 8.0, 0.25, 0.15
"""A jump rises by eight deviations of the noise and a quarter of the pull-off force; it is the loss of
contact if less than the last share still pulls behind it."""
STEEP, SHORT = 0.5, 0.1
"""Change of the line over the travel, over the pull-off force, from which a tail of less than a tenth of
the rows is no free one, for the force still falls; nor is the whole, which is contact throughout."""
OUTLYING, GAIN, FEWEST = 3.0, 0.9, 20
"""Deviations from which a free row counts less; roughness with a drift over that without, from which there is
one; free rows of one side from which it tells more than a level."""


class Cycle(NamedTuple):
    """Columns of such a record, in SI units or those of a scene, and its rows of approach and retraction.

    ``spring``: infinite where the indenter itself is driven; ``speed``: of the drive, one in each segment.
    """

    time: Array
    stage: Array
    force: Array
    spring: float
    speed: Array
    apex: int
    approach: NDArray[np.intp]
    retraction: NDArray[np.intp]


class Loss(NamedTuple):
    """Of a retraction: the ``row`` from which it is free, if any, and the height of a ``jump``."""

    row: int | None
    jump: float | None


def loss_of_contact(stage: Array, force: Array, noise: float) -> Loss:
    """From the last row backward against its own line, then the jump behind the minimum that frees it."""
    count = stage.size
    width, tail = max(3, count // 400), max(min(12, count // 4), count // 20)
    deepest = float(np.median(force[-max(10, count // 20) :]) - force.min())
    begin = count - tail
    for _ in range(EXTENSIONS):
        slope, level = np.polyfit(stage[begin:] - stage[-1], force[begin:], 1)
        off = force - level - slope * (stage - stage[-1])
        deviation = max(float(np.std(off[begin:])), noise)
        limit = max(FAR * deviation / np.sqrt(width), ROUGH * deviation, SHALLOW * deepest)
        touching = np.flatnonzero(np.abs(_smooth(off, width)[: count - width]) > limit)
        last = int(touching[-1]) + 1 if touching.size else 0
        further = max(last, begin - (count - begin))
        if further >= begin:
            break
        begin = further
    row = min(begin, count - 3)
    while last - width < row and row > 0 and abs(off[row]) < 4.0 * deviation:  # to the single row
        row -= 1
    row, jump = min(row + 1, count - 1), None
    lowest = int(np.argmin(_smooth(off, 3)[2:-2])) + 2
    rises = off[5:] - off[:-5]
    high = np.flatnonzero(rises[lowest - 4 :] > max(JUMP * noise, JUMP_SHARE * abs(off[lowest]))) + lowest - 4
    if lowest >= 4 and high.size and off[lowest] < -JUMP * deviation:
        runs = np.split(high, np.flatnonzero(np.diff(high) > 5) + 1)
        tops = [int(run[np.argmax(rises[run])]) for run in runs]
        near = 5 + max(5, count // 200)
        free = [at for at in tops if np.median(off[at + 5 : at + near]) > LEFT * off[lowest]]
        row = free[0] + 1 + int(np.argmax(np.diff(off[free[0] : free[0] + 6]))) if free else row
        jump = float(rises[free[0]] if free else rises[high].max())
    still = row > count - max(min(12, count // 4), count // 50) and jump is None
    bent = abs(slope) * np.ptp(stage) > STEEP * max(deepest, 0.2 * float(np.ptp(force)))
    steep = bent and (row > (1.0 - SHORT) * count or row <= 1)
    return Loss(None if still or steep else row, jump)


def _smooth(values: Array, width: int) -> Array:
    """Running means."""
    return np.convolve(values, np.full(width, 1.0 / width), mode="same")


class Background(NamedTuple):
    """The ``force`` without contact of every row, and what makes it: ``parts``, level (N), tilt (N/m), drag
    (N s/m), drift (N/s); the amplitude of a ``wave``; and how ``rough`` the free rows are over it."""

    force: Array
    parts: dict[str, float]
    wave: float
    rough: float


def background(cycle: Cycle, free: NDArray[np.bool_], wave: float | None = None) -> Background:
    """That of all free rows, with a wave of a length; two sides tell a drag, and a drift where it gains."""
    time, stage, force, speed = cycle.time, cycle.stage, cycle.force[free], cycle.speed
    ahead = free & (np.arange(free.size) <= cycle.apex)
    behind = free & ~ahead
    known = {
        "level": (np.ones_like(stage), 1.0),
        "tilt": (stage - stage[0], float(np.ptp(stage))),
        "drag": (speed, max(float(np.abs(speed).max()), 1e-300)),
        "drift": (time - time[0], float(np.ptp(time))),
    }
    both = min(ahead.sum(), behind.sum()) > FEWEST and np.ptp(stage[behind]) > 0.01 * np.ptp(stage)
    sides = np.where(ahead, 1.0 / np.sqrt(max(ahead.sum(), 1)), 1.0 / np.sqrt(max(behind.sum(), 1)))[free]
    best: tuple[float, Background] | None = None
    for names in [["level", "tilt", "drag"], [*known]] if both else [["level", "tilt"]]:
        columns = [known[name][0] / known[name][1] for name in names] + wave_columns(stage, wave)
        matrix, weights = np.column_stack(columns), sides
        for _ in range(3):
            found = np.linalg.lstsq(matrix[free] * weights[:, None], force * weights, rcond=None)[0]
            left = force - matrix[free] @ found
            deviation = 1.4826 * float(np.median(np.abs(left - np.median(left)))) + 1e-300
            weights = sides / np.maximum(1.0, np.abs(left) / (OUTLYING * deviation))
        rough = float(np.sqrt(np.sum((sides * left) ** 2) / np.sum(sides**2)))
        if best is None or (rough < GAIN * best[0] and np.abs(found).max() < 3.0 * np.ptp(cycle.force)):
            parts = {name: float(value / known[name][1]) for name, value in zip(names, found, strict=False)}
            size = float(np.hypot(*found[-2:])) if wave else 0.0
            best = rough, Background(matrix @ found, parts, size, float(np.sqrt(np.mean(left**2))))
    assert best is not None
    return best[1]
