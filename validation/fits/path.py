"""The measured motion as few straight lines, which is what a solver is to follow.

Recorded positions have noise, and every row would be a kink of the loading. The lines begin with the rows
that Ramer (Comput. Graph. Image Process. 1, 244, 1972) keeps within a tolerance; a corner between two
straight stretches moves to where they meet, and all heights are then those of least squares.
"""

from __future__ import annotations

from itertools import pairwise

import numpy as np
from scipy.linalg import solveh_banded

from contact_scene.errors import SceneError
from validation.fits.contact import Array, white_noise

NOISE_WITHIN = 4.0
"""Deviations of the noise by which a row may miss its line: one in 16 000 by chance."""
SMALLEST = 1e-6
"""Tolerance over the range of the motion, at least: round-off of recorded numbers."""
CORNER_ROWS = 3
"""Rows between two straight stretches, at most, that belong to one corner; and rows inside a stretch, at
least, from which its direction is known well enough to find its corners."""
CORNER = 0.02
"""Change of the rate over the larger rate from which two stretches have a corner to be found."""
PRIOR = 1e-9
"""Weight of the recorded height at a corner beside that of a row: decides where no row lies between two."""
MOST_KNOTS = 400
"""Lines of a path; a motion that needs more is not resolved by its rows, or is all noise."""


def straight_lines(time: Array, position: Array, tolerance: float) -> tuple[Array, Array]:
    """Times and heights of the corners of a path that no row misses by more than tolerance and noise."""
    noise = white_noise(position)
    within = max(tolerance, NOISE_WITHIN * noise, SMALLEST * float(np.ptp(position)))
    rows = _kept_rows(time, position, within)
    if rows.size > MOST_KNOTS:
        problem = f"the motion needs {rows.size} straight lines"
        raise SceneError("penetration", problem, f"at most {MOST_KNOTS}: smoother or finer rows")
    knots = _moved_corners(time, position, rows)
    return knots, _heights(time, position, knots)


def count_lines(time: Array, values: Array, share: float) -> int:
    """How many straight lines a column needs, within a share of its range and its noise."""
    within = max(share * float(np.ptp(values)), NOISE_WITHIN * white_noise(values))
    return _kept_rows(time, values, within).size - 1


def _kept_rows(time: Array, position: Array, within: float) -> np.ndarray:
    keep, stack = {0, time.size - 1}, [(0, time.size - 1)]
    while stack:
        begin, end = stack.pop()
        line = np.interp(time[begin:end], time[[begin, end]], position[[begin, end]])
        miss = np.abs(position[begin:end] - line)
        worst = begin + int(np.argmax(miss))
        if miss[worst - begin] > within:
            keep.add(worst)
            stack += [(begin, worst), (worst, end)]
    return np.array(sorted(keep))


def _moved_corners(time: Array, position: Array, rows: np.ndarray) -> Array:
    """Times of the corners: where two straight stretches meet, if that is among the rows between them."""
    stretches: list[tuple[int, int, float, float]] = []
    for begin, end in pairwise(rows.tolist()):
        inner = slice(begin + 1, end)
        if end - begin - 1 >= CORNER_ROWS:
            middle = float(time[inner].mean())
            rate, level = np.polyfit(time[inner] - middle, position[inner], 1)
            stretches.append((begin, end, float(rate), float(level) - float(rate) * middle))
    knots = dict.fromkeys(rows.tolist())
    moved = []
    for (_, left, rate, level), (right, _, next_rate, next_level) in pairwise(stretches):
        turn = rate - next_rate
        if right - left > CORNER_ROWS or abs(turn) < CORNER * max(abs(rate), abs(next_rate)):
            continue
        meeting = (next_level - level) / turn
        if time[left - 1] <= meeting <= time[right + 1]:
            for row in range(left, right + 1):
                knots.pop(row, None)
            moved.append(meeting)
    return np.sort(np.concatenate([time[list(knots)], moved]))


def _heights(time: Array, position: Array, knots: Array) -> Array:
    """Heights at the knots with which the lines miss the rows least."""
    place = np.clip(np.searchsorted(knots, time, side="right") - 1, 0, knots.size - 2)
    share = (time - knots[place]) / np.diff(knots)[place]
    level = float(position.mean())
    diagonal, beside = np.full(knots.size, PRIOR), np.zeros(knots.size)
    target = PRIOR * (np.interp(knots, time, position) - level)
    for end, weight in ((place, 1.0 - share), (place + 1, share)):
        np.add.at(diagonal, end, weight**2)
        np.add.at(target, end, weight * (position - level))
    np.add.at(beside, place, share * (1.0 - share))
    return solveh_banded(np.vstack([diagonal, beside]), target, lower=True) + level
