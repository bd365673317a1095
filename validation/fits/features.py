"""What a record shows before any viscoelastic model: contact point, stiffness, loss of contact, background.

In this order: the contact point of the approach (:mod:`validation.fits.contact`), with wave and wall drag;
the loss of contact of the retraction; one background of all free rows; then pull-off, drop, work and
hysteresis of the force over it. In SI units, of a record that goes in and out once.

The background is linear in what may make it: level, tilt over the stage, drag with the speed of the stage,
drift over time, a wave. Rows before contact and behind its loss have equal weight, whatever their number;
rows off it, of tethers, have little (Huber).
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, fields, replace
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from validation.fits.contact import (
    EXPONENT,
    MOST_ROWS,
    Array,
    Contact,
    Scan,
    find_contact,
    least_squares,
    means,
    wave_columns,
    white_noise,
    with_wall,
)

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
one; free rows, in all or of one side, from which they tell more than a level."""


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

    @property
    def background(self) -> dict[str, Array]:
        """Columns that the force without contact is linear in."""
        since, way = self.time - self.time[0], self.stage - self.stage[0]
        return {"level": np.ones_like(way), "drift": since, "tilt": way, "drag": self.speed}


def loss_of_contact(stage: Array, force: Array, noise: float) -> tuple[int | None, float | None]:
    """The row from which a retraction is free, if any, and the height of a jump: from the last row backward
    against its own line, then the jump behind the minimum that frees it."""
    count = stage.size
    width, tail = max(3, count // 400), max(min(12, count // 4), count // 20)
    deepest = float(np.median(force[-max(10, count // 20) :]) - force.min())
    change = np.abs(np.diff(force))  # grows towards a loss, and falls where a smooth force comes to nothing
    jumps = np.flatnonzero(change[1:] > np.maximum(change[:-1] + JUMP * noise, JUMP_SHARE * deepest))
    begin = max(count - tail, min(int(jumps.max(initial=-2)) + 2, count - width))  # behind the last jump
    along = np.column_stack([np.ones(count), (stage - stage[-1]) / (float(np.ptp(stage)) or 1.0)])
    for _ in range(EXTENSIONS):
        line = least_squares(along[begin:], force[begin:])  # level where the stage rests
        off = force - along @ line
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
    bent = abs(line[1]) > STEEP * max(deepest, 0.2 * float(np.ptp(force)))
    steep = bent and (row > (1.0 - SHORT) * count or row <= 1)
    return None if still or steep else row, jump


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
    """That of all free rows, with a wave of a length; two sides tell a drag, and a drift where it gains. Few
    rows tell a level, as the first do where none is free."""
    stage, force = cycle.stage, cycle.force[free]
    if free.sum() <= FEWEST:
        level = float(np.median(force if free.any() else cycle.force[: max(3, free.size // 50)]))
        noise = white_noise(cycle.force)
        return Background(np.full(free.size, level), {"level": level}, 0.0, noise)
    ahead = free & (np.arange(free.size) <= cycle.apex)
    behind = free & ~ahead
    known, waves = cycle.background, wave_columns(stage, wave)
    both = min(ahead.sum(), behind.sum()) > FEWEST and np.ptp(stage[behind]) > 0.01 * np.ptp(stage)
    sides = np.where(ahead, 1.0 / np.sqrt(max(ahead.sum(), 1)), 1.0 / np.sqrt(max(behind.sum(), 1)))[free]
    best: tuple[float, Background] | None = None
    for names in [["level", "tilt", "drag"], [*known]] if both else [["level", "tilt"]]:
        matrix, weights = np.column_stack([*(known[name] for name in names), *waves]), sides
        for _ in range(3):
            found = least_squares(matrix[free] * weights[:, None], force * weights)
            left = force - matrix[free] @ found
            deviation = 1.4826 * float(np.median(np.abs(left - np.median(left)))) + 1e-300
            weights = sides / np.maximum(1.0, np.abs(left) / (OUTLYING * deviation))
        rough = float(np.sqrt(np.sum((sides * left) ** 2) / np.sum(sides**2)))
        if best is None or (
            rough < GAIN * best[0] and np.abs(matrix * found).max() < 3.0 * np.ptp(cycle.force)
        ):
            parts = dict(zip(names, found.tolist(), strict=False))
            size = float(np.hypot(*found[-2:])) if wave else 0.0
            best = rough, Background(matrix @ found, parts, size, float(np.sqrt(np.mean(left**2))))
    assert best is not None
    return best[1]


WATER = 1e-3
"""Viscosity in Pa s, against which the drag near the wall is measured."""
LIKE_WATER, BEADS = 6.0, (1e-6, 60e-6)
"""Factor by which the drag near the wall may miss that of the indenter in water, or, where its radius is not
stated, radii of beads that it may belong to. Without such a bound real contacts are taken for drag."""
SNAP, SNAP_SHARE, ONSET = 8.0, 0.02, 0.15
"""A snap-in is eight deviations and 2 % of the range of the force deep; it begins at 15 % of its depth."""
BESIDE = 0.03, 5
"""Share of the rows before contact, and rows behind its loss, next to it, that are not taken for free: there
a surface attracts, and a spring rings. Free rows of
`silicon-nitride` are nine times rougher with them."""
BEFORE, BEHIND, FEW = 0.10, 0.05, 0.03
"""Shares of the rows: free before contact and behind its loss, below which the background is poorly known,
and in contact, below which they tell little."""
BENDS, FAINT = 1.2, 1e-12
"""Bending of the spring over the travel of the stage, and newtons of the range of the force, from and below
which one of them is in another unit."""
AVERAGED, CERTAIN, PULLED = 200, 3.0, 3.0
"""Means of the free approach with which the retraction is compared, quieter than its rows; deviations of the
contact point before it from which a row is free for certain: contact is no background; deviations of three
rows' mean from which the least force is a pull-off."""
PARTS = (
    ("level", "N", "background: level"),
    ("tilt", "N/m", "background: tilt"),
    ("drag", "N s/m", "background: drag"),
    ("drift", "N/s", "background: drift"),
    ("wave", "m", "background: length of a wave"),
    ("wave", "N", "background: its amplitude"),
    ("wall", "m", "background: length of the drag near the wall"),
    ("wall", "N", "background: its force at the wall"),
    ("wall/water", "", "background: over 6 pi eta R^2 v of water"),
)
"""Of the background: name, unit and words; two of a name are its length and its size."""


def _shown(words: str, unit: str) -> Any:
    """A number that a curve may show, in words, and its unit."""
    return field(default=None, metadata={"words": words, "unit": unit})


@dataclass(frozen=True)
class Features:
    """What a curve shows of itself, in SI units; ``None`` where it does not.

    ``stiffness`` is K of the force ``K depth**1.5``, ``modulus`` that of Hertz' or DMT's contact, of an
    indenter whose radius is stated; ``misfit`` is what the contact leaves of the approach, over the noise;
    ``work`` is ``-F`` over the path of the tip, where it pulls, ``hysteresis`` that of the stage from first
    contact to its loss. ``background`` holds ``level``, ``tilt``, ``drag``, ``drift`` in N over N, m, m/s, s;
    ``wave``: length and amplitude; ``wall``: length and force of the drag near the wall; ``wall/water``: its
    size over that in water. ``force``, shape (N,), is that over its background, wall drag included; rows
    that are ``free`` are without contact.
    """

    contact: float | None = _shown("contact point of the stage", "m")
    contact_error: float | None = _shown("its standard deviation", "m")
    depth: float | None = _shown("largest indentation", "m")
    modulus: float | None = _shown("Young's modulus, elastic guess", "Pa")
    stiffness: float | None = _shown("K of the force K depth^1.5", "N/m^1.5")
    snap_in: float | None = _shown("snap-in force", "N")
    pull_off: float | None = _shown("pull-off force", "N")
    lost: float | None = _shown("contact lost at", "m")
    drop: float | None = _shown("force lost at once", "N")
    work: float | None = _shown("work of separation", "J")
    hysteresis: float | None = _shown("hysteresis", "J")
    noise: float = _shown("noise, white", "N")
    rough: float = _shown("free rows over their background", "N")
    contact_time: float | None = None
    lost_time: float | None = None
    misfit: float | None = None
    background: dict[str, Any] = field(default_factory=dict)
    force: Array = field(default_factory=lambda: np.zeros(0))
    free: NDArray[np.bool_] = field(default_factory=lambda: np.zeros(0, bool))
    warnings: tuple[str, ...] = ()

    def numbers(self) -> Iterator[tuple[str, str, str, float | None]]:
        """Name, unit, words and value of every number, in the order of their table."""
        for one in fields(self):
            if one.metadata:
                yield one.name, one.metadata["unit"], one.metadata["words"], getattr(self, one.name)
        for name, unit, words in PARTS:
            value = self.background.get(name)
            yield name, unit, words, value[unit == "N"] if isinstance(value, tuple) else value


def common_wall(seen: Sequence[Features]) -> Any:
    """Length and force of the drag near the wall of a map, one for all, as indenter and speed are: the median
    of the curves that show one, if any does."""
    shown = [one.background["wall"] for one in seen if "wall" in one.background]
    return tuple(np.median(shown, axis=0).tolist()) if shown else None


def features(
    recorded: Cycle,
    radius: float | None = None,
    poisson: float = 0.5,
    wall: tuple[float, float] | None = None,
) -> Features:
    """Read them off a record; ``wall``: the drag near the wall, where it is known."""
    cycle, contact, warned = recorded, None, list[str]()
    if recorded.approach.size > FEWEST:
        cycle, contact, warned = _contact_behind_drag(recorded, radius, wall)
    stage, force, rows, back = cycle.stage, cycle.force, cycle.approach, cycle.retraction
    noise, before = max(white_noise(force), 1e-9 * float(np.ptp(force))), np.zeros(back.size)
    found: dict[str, Any] = {"noise": noise}
    free, (share, ringing) = np.zeros(stage.size, bool), BESIDE
    if contact is None:  # all of an approach without contact is free
        free[rows] = free[back] = rows.size > 0
    else:
        tip = contact.tip(stage, force, cycle.spring)[rows]
        head, touching = rows[tip < contact.place], rows[tip >= contact.place]
        free[head[: int((1.0 - share) * head.size)]] = True
        # What the retraction shows where the approach was free is background.
        certain = rows[tip < contact.place - CERTAIN * contact.error]
        place, level = means(AVERAGED, stage[certain], force[certain])
        order = np.argsort(place)
        over_line = np.interp(stage[back], place[order], (level - contact.line(place))[order])
        before = contact.line(stage[back]) + over_line
        elastic = contact.stiffness * 0.75 * (1.0 - poisson**2)
        found |= {"contact": contact.place, "contact_error": contact.error, "depth": contact.depth}
        found |= {"stiffness": contact.stiffness, "snap_in": contact.snap_in}
        found["contact_time"] = float(cycle.time[touching[0]]) if touching.size else None
        found["modulus"] = elastic / float(np.sqrt(radius)) if radius else None
        found["misfit"] = contact.misfit / noise * float(np.sqrt(max(1.0, rows.size / MOST_ROWS)))
    lost, drop, returns = None, None, back.size > FEWEST and (contact is not None or not rows.size)
    if returns:
        row, drop = loss_of_contact(stage[back], force[back] - before, noise)
        if row is not None:
            lost, tail = int(back[row]), back[row:]
            free[tail[min(ringing, tail.size // 10) :]] = True
    base = background(cycle, free, contact.wave if contact else None)
    parts: dict[str, Any] = {**base.parts}
    if contact is not None and contact.wave:
        parts["wave"] = contact.wave, base.wave
    if contact is not None and contact.wall:
        length, near = parts["wall"] = contact.wall
        parts["wall/water"] = length * near / _drag_in_water(cycle, radius) if radius else None
    found |= {"rough": base.rough, "force": force - base.force}
    if returns:
        found |= _of_retraction(cycle, found["force"], max(base.rough, noise), lost, drop, contact)
    told = Features(**found, free=free, background=parts)
    return replace(told, warnings=(*_warnings(recorded, contact, told), *warned))


def _contact_behind_drag(
    cycle: Cycle, radius: float | None, known: tuple[float, float] | None
) -> tuple[Cycle, Contact | None, list[str]]:
    """The record without drag near the wall, the contact of its approach, and a warning in doubt."""
    contact, scan = _contact(cycle) or (None, None)
    water, walled = _drag_in_water(cycle, 1.0), None
    if contact is not None and scan is not None and np.isfinite(cycle.spring) and water:
        walled = replace(scan, wall=known[0]).contact() if known else with_wall(scan, contact)
    if walled is None or walled.wall is None:
        return cycle, contact, []
    length, near = known or walled.wall
    bead = float(np.sqrt(length * near / water))
    if known or (radius and LIKE_WATER**-0.5 < bead / radius < LIKE_WATER**0.5):
        gap = np.clip(walled.place - walled.tip(cycle.stage, cycle.force, cycle.spring), 0.0, None)
        along = cycle.speed / cycle.speed[cycle.approach].mean()
        cycle = cycle._replace(force=cycle.force - near * along / (1.0 + gap / length))
        again = _contact(cycle)
        return cycle, replace(again[0], wall=(length, near)) if again else None, []
    doubt = f"a force like the drag near a wall, of a bead of {1e6 * bead:.2g} um: --radius"
    return cycle, contact, [doubt] if radius is None and BEADS[0] < bead < BEADS[1] else []


def _drag_in_water(cycle: Cycle, radius: float) -> float:
    """``6 pi eta R^2 v`` of the approach: drag near the wall times the distance from it."""
    return 6.0 * np.pi * WATER * radius**2 * float(np.abs(cycle.speed[cycle.approach]).mean())


def _contact(cycle: Cycle) -> tuple[Contact, Scan] | None:
    """The contact of the approach; with a snap-in, where that begins, and DMT's stiffness behind it."""
    rows = cycle.approach
    found = find_contact(cycle.stage[rows], cycle.force[rows], cycle.spring)
    if found is None:
        return None
    contact, scan = found
    over = scan.force - contact.line(scan.stage)
    low = int(np.argmin(over))
    early = float(np.std(over[: max(10, int(0.6 * low))]))
    least = max(SNAP * max(early, white_noise(cycle.force)), SNAP_SHARE * float(np.ptp(over)))
    if low <= 20 or over[low] > -least:
        return found
    head = slice(int(0.7 * low))
    tilt, level = np.polyfit(scan.stage[head] - contact.origin, scan.force[head], 1)
    contact = replace(contact, tilt=float(tilt), level=float(level), snap_in=float(over[low]))
    over = scan.force - contact.line(scan.stage)
    outside = np.flatnonzero(over[: low + 1] > -max(4.0 * float(np.std(over[head])), ONSET * abs(over[low])))
    tip = scan.stage - over / cycle.spring
    root = np.clip(over[low:] - over[low], 0.0, None) ** (1.0 / EXPONENT)
    slope = float(np.polyfit(tip[low:] - tip[low], root, 1)[0]) if over.size - low > 10 else 0.0
    place = float(scan.stage[outside[-1] if outside.size else 0])
    return replace(
        contact,
        place=place,
        error=float(abs(scan.stage[1] - scan.stage[0])),
        depth=float(tip.max() - place),
        stiffness=slope**EXPONENT if slope > 0.0 else contact.stiffness,
    ), scan


def _of_retraction(
    cycle: Cycle, over: Array, noise: float, lost: int | None, drop: float | None, contact: Contact | None
) -> dict[str, Any]:
    """Pull-off, and where contact is lost, with the work until then; ``over``: force over its background."""
    back, stage, found = cycle.retraction, cycle.stage, {}
    lowest = int(np.argmin(_smooth(over[back], 3)[1:-1])) + 1
    if over[back][lowest] < -PULLED * noise:
        found["pull_off"] = float(over[back][lowest])
    if lost is None:
        return found
    if drop is None:
        near = max(3, back.size // 200)
        drop = float(np.median(over[lost : lost + near]) - over[max(lost - near, back[0]) : lost + 1].min())
    path, tip = slice(back[0], lost), stage - over / cycle.spring
    found |= {"lost": float(stage[lost]), "lost_time": float(cycle.time[lost]), "drop": drop}
    found["work"] = float(np.trapezoid(np.clip(over[path], None, 0.0), tip[path]))
    if contact is not None and cycle.approach.size:
        loop = slice(cycle.approach[0], lost)
        found["hysteresis"] = float(np.trapezoid(over[loop], stage[loop]))
    return found


def _warnings(recorded: Cycle, contact: Contact | None, told: Features) -> Iterator[str]:
    """What is doubtful, in order of worth."""
    force, stage = recorded.force, recorded.stage
    bend, travel = float(np.ptp(force)) / recorded.spring, float(np.ptp(stage))
    if bend > BENDS * travel:
        asked = "spring constant or unit of the force?"
        yield f"the spring bends {1e6 * bend:.3g} um over a stage of {1e6 * travel:.3g} um: {asked}"
    if np.ptp(force) < FAINT:
        yield f"the force changes by {np.ptp(force):.2g} N in all: sensitivity, spring constant or unit?"
    if stage[np.argmax(np.abs(force - np.median(force)))] < stage.min() + 0.1 * travel:
        yield "the force is largest where the stage is smallest: both signs turned?"
    if contact is None:
        yield "no contact on the approach" if recorded.approach.size else "no approach in the record"
        return
    ahead, behind = (part.sum() / stage.size for part in np.split(told.free, [recorded.apex]))
    if ahead < BEFORE:
        yield f"{100 * ahead:.2g} % of the rows are free before contact: the background is poorly known"
    if told.lost is not None and behind < BEHIND:
        yield f"{100 * behind:.2g} % of the rows are free behind the loss of contact"
    if contact.wall and told.pull_off and abs(told.pull_off) < 0.5 * contact.wall[1]:
        yield "the pull-off force is less than half the drag at the wall: adhesion is not determined"
    touching = 1.0 - told.free.mean()
    if touching < FEW:
        yield f"{100 * touching:.2g} % of the rows are in contact"
    if recorded.retraction.size and told.lost is None:
        yield "contact is not lost in the record"
