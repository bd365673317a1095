r"""Contact point of an approach: a scan in which everything else is linear.

Rows up to the largest force, at most ``MOST_ROWS`` means of neighbours. With the stage :math:`z`, the spring
:math:`k` and the tip :math:`x = z - (F - b - c z)/k`

.. math:: F = b + c z + [a \cos q z + a' \sin q z] + [D/(1 + (x_0 - x)_+/h_0)] + K (x - x_0)_+^p ,

level and tilt of the background, a wave on it (interference of the laser), the hydrodynamic drag near the
wall :math:`6 \pi \eta R^2 v/(h + h_0)` (Alcaraz et al. 2002), and a Hertzian contact. Rows are weighted by
:math:`1/(1 + F'(x)/k)`: the noise of the force is in :math:`x` too, and these are the weights of the implicit
model to first order.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

EXPONENT = 1.5
"""p, of a sphere or a paraboloid."""
MOST_ROWS, EVEN, DENSE = 1500, 160, 60
"""Rows of a scan, which resolve a contact of a thousandth of the travel, and contact points tried: evenly
over it, and ever closer towards its end, where contact may be short."""
REWEIGHTED, SETTLED = 4, 1e-6
"""Repetitions with the weights of the last, at most: a spring as soft as the contact needs three. They end
once the sum of squares changes by this share, a hundredth of the variance of a row."""
SHRINKINGS = 24
"""Of five points about the best, each by 0.6: to 5e-6 of the gap between the points tried."""
LEAST_GAIN, LEAST_HEIGHT, LEAST_ROWS = 40.0, 4.0, 5
"""There is a contact if it lowers the sum of squares by 40 residual variances (by chance, with all places
tried, once in 10^6 records), is four deviations high, and has five rows."""
BETTER = 0.85
"""Misfit with a further term over that without, at most: less is not told from the creep of the drive."""
NEAR, HALVED = (0.5, 0.25, 0.125), 0.5
"""Shares of the largest force up to which the power law is tried, as long as the misfit is halved: deep in a
layered or a soft sample it does not hold."""
REFINED = 3
"""Lengths of the drag, those of least misfit at the places tried, whose contact point is refined: in between
two places neighbouring lengths change their order."""
WAVES, ROUGH, SHARE = 400, 1.5, 0.5
"""Lengths tried for the wave, from a 25th of the free travel to all of it; it is looked for where free rows
are rougher than white noise, and taken if it is half their variance."""
_THIRD_DIFFERENCE = np.sqrt(20.0)  # standard deviation of 1, -3, 3, -1 times independent noise
_NORMAL_MEDIAN = 0.6744897501960817  # median of the magnitude of a standard normal number


@dataclass(frozen=True)
class Contact:
    """``place``: of the stage where indenter and surface touch without force; ``stiffness``: K; ``level`` and
    ``tilt``: of the background, about the stage at ``origin``; ``wave``: its length; ``wall``: length h0 and
    force D at the wall; ``snap_in``: force of a jump into contact."""

    place: float
    error: float
    stiffness: float
    depth: float
    misfit: float
    level: float
    tilt: float
    origin: float
    wave: float | None = None
    wall: tuple[float, float] | None = None
    snap_in: float | None = None

    def line(self, stage: Array) -> Array:
        """Level and tilt at some positions of the stage."""
        return self.level + self.tilt * (stage - self.origin)

    def tip(self, stage: Array, force: Array, spring: float) -> Array:
        """Position of the indenter, of the force over its background."""
        return stage - (force - self.line(stage)) / spring


@dataclass(frozen=True)
class Scan:
    """Rows of an approach and the terms that explain them."""

    stage: Array
    force: Array
    spring: float
    wave: float | None = None
    wall: float | None = None
    even: int = EVEN

    @cached_property
    def level(self) -> float:
        """Force of the first rows, which tells the tip to begin with."""
        return float(np.median(self.force[: max(3, self.force.size // 20)]))

    @cached_property
    def nearest(self) -> tuple[float, float, float]:
        """Of the places tried that of the least sum of squares, the wider gap beside it, and the sum."""
        span = float(np.ptp(self.stage))
        last = float((self.stage - (self.force - self.level) / self.spring).max())
        even = np.linspace(self.stage.min() + 0.02 * span, last - 1e-3 * span, self.even)
        places = np.unique(np.concatenate([even, last - span * np.geomspace(2e-4, 0.3, DENSE)]))
        costs = [self.cost(place) for place in places]
        at = int(np.argmin(costs))
        return float(places[at]), float(np.diff(places)[max(at - 1, 0) : at + 1].max()), costs[at]

    def cost(self, place: float) -> float:
        """Sum of squares with a contact point; infinite where sample or wall would attract."""
        cost, found, _ = self.trial(place)
        return cost if (found[2 : 3 if self.wall is None else 4] > 0.0).all() else np.inf

    def contact(self) -> Contact | None:
        """The contact, or ``None`` where there is none."""
        span, (place, step, least) = float(np.ptp(self.stage)), self.nearest
        if not np.isfinite(least):
            return None
        for _ in range(SHRINKINGS):
            tried = place + step * np.array([-1.0, -1.0 / 3.0, 1.0 / 3.0, 1.0])
            costs = [self.cost(one) for one in tried]
            if min(costs) < least:
                place, least = float(tried[np.argmin(costs)]), min(costs)
            step *= 0.6
        cost, found, depths = self.trial(place)
        variance, depth = cost / max(self.stage.size - 5, 1), float(depths.max())
        height = found[2] * depth**EXPONENT
        if (depths > 0.0).sum() < LEAST_ROWS or height <= LEAST_HEIGHT * np.sqrt(variance):
            return None
        along = (self.stage - self.stage[0]) / span
        line = [np.ones_like(along), along, *wave_columns(self.stage, self.wave)]
        left = _of_scan(line, self.force)[1]
        if float(left @ left) - cost < LEAST_GAIN * variance:
            return None
        aside = 3e-3 * max(depth, 1e-4 * span)
        rises = [self.trial(place + way * aside)[0] - cost for way in (-1.0, 1.0)]
        error = aside * np.sqrt(2.0 * variance / sum(rises)) if sum(rises) > 0.0 else span
        level, tilt, stiffness, *rest = found.tolist()
        return Contact(
            place=float(place),
            error=float(error),
            stiffness=stiffness,
            depth=depth,
            misfit=float(np.sqrt(variance)),
            level=level,
            tilt=tilt / span,
            origin=float(self.stage[0]),
            wave=self.wave,
            wall=(self.wall, rest[0]) if self.wall else None,
        )

    def trial(self, place: float) -> tuple[float, Array, Array]:
        """Linear least squares with one contact point: sum of squares, coefficients, depth of each row."""
        span = float(np.ptp(self.stage))
        along = (self.stage - self.stage[0]) / span
        background, stiffness, before = np.full(along.size, self.level), 0.0, np.inf
        for _ in range(1 + REWEIGHTED):
            tip = self.stage - (self.force - background) / self.spring
            depth = np.maximum(tip - place, 0.0) / span
            root = depth ** (EXPONENT - 1.0)
            slope = stiffness / span * EXPONENT * root
            columns = [np.ones_like(along), along, depth * root]
            if self.wall:
                columns.append(1.0 / (1.0 + np.maximum(place - tip, 0.0) / self.wall))
            columns += wave_columns(self.stage, self.wave)
            found, left = _of_scan(columns, self.force, 1.0 / (1.0 + slope / self.spring))
            background, stiffness = found[0] + found[1] * along, max(float(found[2]), 0.0)
            cost = float(left @ left)
            if abs(cost - before) <= SETTLED * cost:
                break
            before = cost
        found[2] /= span**EXPONENT
        return cost, found, span * depth


def find_contact(stage: Array, force: Array, spring: float) -> tuple[Contact, Scan] | None:
    """The contact, with the wave that explains more, from the rows that explain it; with the scan of all."""
    end = int(np.argmax(force)) + 1
    rows = slice(end if end > 0.3 * force.size else None)
    place, seen = means(MOST_ROWS, stage[rows], force[rows])
    scan = Scan(place, seen, spring)
    found = scan.contact()
    if found is None:
        return None
    free = found.tip(scan.stage, scan.force, spring) < found.place
    length = wave_length(scan.stage[free], (scan.force - found.line(scan.stage))[free])
    if length:
        waved = replace(scan, wave=length)
        better = waved.contact()
        if better and better.misfit < BETTER * found.misfit:
            found, scan = better, waved
    for share in NEAR:
        over = scan.force - found.line(scan.stage)
        end = int(np.argmax(over > share * over.max()))
        better = replace(scan, stage=scan.stage[:end], force=scan.force[:end]).contact()
        if better is None or better.misfit > HALVED * found.misfit:
            break
        depth = float((better.tip(scan.stage, scan.force, spring) - better.place).max())
        found = replace(better, depth=depth)
    return found, scan


def with_wall(scan: Scan, found: Contact) -> Contact | None:
    """The contact behind a drag that grows towards the wall, if any; what is white noise alone hides none."""
    if white_noise(scan.force) > BETTER * found.misfit:
        return None
    lengths = np.geomspace(0.002, 0.2, 7) * np.ptp(scan.stage)
    scans = [replace(scan, wall=float(length), even=EVEN // 4) for length in lengths]
    near = sorted(scans, key=lambda one: one.nearest[2])[:REFINED]
    best = min(filter(None, (one.contact() for one in near)), key=lambda one: one.misfit, default=None)
    return best if best and best.misfit < BETTER * found.misfit else None


def wave_length(stage: Array, left: Array) -> float | None:
    """Length of the sine that takes most of what is left on free rows, if they are no white noise."""
    if stage.size < 60 or np.std(left) <= ROUGH * white_noise(left):
        return None
    span, total = float(np.ptp(stage)), float(np.var(left) * left.size)
    shares = {}
    for wave in np.linspace(1.2 / span, 25.0 / span, WAVES).tolist():
        columns = [np.ones_like(stage), stage - stage.mean(), *wave_columns(stage, 1.0 / wave)]
        rest = _of_scan(columns, left)[1]
        shares[1.0 / wave] = 1.0 - float(rest @ rest) / total
    length = max(shares, key=shares.__getitem__)
    return length if shares[length] > SHARE else None


def wave_columns(stage: Array, length: float | None) -> list[Array]:
    """Cosine and sine of a length along the stage."""
    return [] if not length else [np.cos(2.0 * np.pi * stage / length), np.sin(2.0 * np.pi * stage / length)]


def means(most: int, *columns: Array) -> list[Array]:
    """Means of neighbouring rows, at most so many."""
    if columns[0].size <= most:
        return list(columns)
    edges = np.linspace(0, columns[0].size, most + 1).astype(int)
    return [np.add.reduceat(column, edges[:-1]) / np.diff(edges) for column in columns]


def white_noise(values: Array) -> float:
    """Standard deviation of independent noise on a smooth curve, from third differences, outliers aside."""
    third = np.abs(np.diff(values, 3))
    return float(np.median(third) / _NORMAL_MEDIAN / _THIRD_DIFFERENCE)


def least_squares(columns: Array, values: Array) -> Array:
    """Multiples of the columns that come closest to the values, whatever the sizes of the columns."""
    size = np.maximum(np.abs(columns).max(axis=0, initial=0.0), np.finfo(float).tiny)
    found = np.linalg.lstsq(columns / size, values, rcond=None)[0]
    return found / (size if values.ndim == 1 else size[:, None])


def _of_scan(columns: list[Array], values: Array, weights: Array | float = 1.0) -> tuple[Array, Array]:
    """Coefficients of columns of about one, and what is left of each row times its weight: by the normal
    equations in a tenth of the time, as a scan has thousands."""
    matrix, weighted = np.array(columns) * weights, values * weights
    found = np.linalg.lstsq(matrix @ matrix.T, matrix @ weighted, rcond=None)[0]
    return np.asarray(found, float), weighted - found @ matrix
