"""What a record shows before any viscoelastic model: background, contact point, stiffness, loss of contact.

In this order: the contact point of the approach (:mod:`validation.fits.contact`), with wave and wall drag;
the loss of contact of the retraction; one background of all free rows; then pull-off, drop, work and
hysteresis of the force over it. In SI units, of a record that goes in and out once.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from validation.fits.background import Background, Cycle, background, loss_of_contact
from validation.fits.contact import (
    EXPONENT,
    MOST_ROWS,
    Array,
    Contact,
    Scan,
    find_contact,
    means,
    white_noise,
    with_wall,
)

WATER = 1e-3
"""Viscosity in Pa s, against which the drag near the wall is measured."""
LIKE_WATER, BEADS = 6.0, (1e-6, 60e-6)
"""Factor by which the drag near the wall may miss that of the indenter in water, or, where its radius is not
stated, radii of beads that it may belong to. Without such a bound real contacts are taken for drag."""
SNAP, SNAP_SHARE, ONSET = 8.0, 0.02, 0.15
"""A snap-in is eight deviations and 2 % of the range of the force deep; it begins at 15 % of its depth."""
BEFORE, BEHIND, FEW = 0.10, 0.05, 0.03
"""Shares of the rows: free before contact and behind its loss, below which the background is poorly known,
and in contact, below which they tell little."""
BENDS, FAINT = 1.2, 1e-12
"""Bending of the spring over the travel of the stage, and newtons of the range of the force, from and below
which one of them is in another unit."""
ENOUGH, AVERAGED, PULLED = 20, 200, 3.0
"""Rows of an approach or a retraction that is looked at; means of the approach with which the retraction is
compared, quieter than its rows; deviations of three rows' mean from which the least force is a pull-off."""


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


def features(recorded: Cycle, radius: float | None = None, poisson: float = 0.5) -> Features:
    """Read them off a record."""
    cycle, contact = recorded, None
    warned: list[str] = []
    if recorded.approach.size >= ENOUGH:
        cycle, contact, warned = _contact_behind_drag(recorded, radius)
    stage, force, back = cycle.stage, cycle.force, cycle.retraction
    noise = max(white_noise(force), 1e-9 * float(np.ptp(force)))
    returns = back.size >= ENOUGH and (contact is not None or not cycle.approach.size)
    lost, drop = None, None
    if returns:
        row, drop = loss_of_contact(stage[back], force[back] - _force_before(cycle, contact), noise)
        lost = None if row is None else int(back[row])
    free = _free(cycle, contact, lost)
    if free.sum() > ENOUGH:
        base = background(cycle, free, contact.wave[0] if contact and contact.wave else None)
    else:
        level = float(np.median(force[: max(3, force.size // 50)]))
        base = Background(np.full(force.size, level), {"level": level}, 0.0, noise)
    found: dict[str, Any] = {"noise": noise, "rough": base.rough, "force": force - base.force, "free": free}
    found["background"] = {**base.parts}
    if contact is not None:
        found |= _of_contact(cycle, contact, noise, radius, poisson)
        found["background"] |= _wave_and_wall(cycle, contact, base, radius)
    if returns:
        found |= _of_retraction(cycle, found["force"], max(base.rough, noise), lost, drop, contact)
    told = Features(**found)
    return replace(told, warnings=(*_warnings(recorded, contact, told), *warned))


def _contact_behind_drag(cycle: Cycle, radius: float | None) -> tuple[Cycle, Contact | None, list[str]]:
    """The record without drag near the wall, the contact of its approach, and a warning in doubt."""
    found = _contact(cycle)
    if found is None:
        return cycle, None, []
    contact, scan = found
    walled = with_wall(scan, contact) if np.isfinite(cycle.spring) else None
    speed = _speed(cycle)
    if walled is None or walled.wall is None or speed == 0.0:
        return cycle, contact, []
    length, near = walled.wall
    bead = float(np.sqrt(length * near / (6.0 * np.pi * WATER * speed)))
    if radius and LIKE_WATER**-0.5 < bead / radius < LIKE_WATER**0.5:
        gap = np.clip(walled.place - walled.tip(cycle.stage, cycle.force, cycle.spring), 0.0, None)
        along = cycle.speed / cycle.speed[cycle.approach].mean()
        cycle = cycle._replace(force=cycle.force - near * along / (1.0 + gap / length))
        again = _contact(cycle)
        return cycle, replace(again[0], wall=walled.wall) if again else None, []
    if radius is None and BEADS[0] < bead < BEADS[1]:
        doubt = f"a force like the drag near a wall, of a bead of {1e6 * bead:.2g} um: --radius"
        return cycle, contact, [doubt]
    return cycle, contact, []


def _speed(cycle: Cycle) -> float:
    """That of the approach."""
    return float(np.abs(cycle.speed[cycle.approach]).mean())


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


def _force_before(cycle: Cycle, contact: Contact | None) -> Array | float:
    """Force of the free approach where the retraction comes by: what comes back is background."""
    if contact is None:
        return 0.0
    tip = contact.tip(cycle.stage, cycle.force, cycle.spring)
    free = cycle.approach[tip[cycle.approach] < contact.place - 3.0 * contact.error]
    place, force = means(AVERAGED, cycle.stage[free], cycle.force[free])
    order, stage = np.argsort(place), cycle.stage[cycle.retraction]
    return contact.line(stage) + np.interp(stage, place[order], (force - contact.line(place))[order])


def _free(cycle: Cycle, contact: Contact | None, lost: int | None) -> NDArray[np.bool_]:
    """Rows well before contact and behind its loss; all of an approach without contact."""
    free = np.zeros(cycle.stage.size, bool)
    if contact is None:
        free[cycle.approach] = free[cycle.retraction] = cycle.approach.size > 0
    else:
        tip = contact.tip(cycle.stage, cycle.force, cycle.spring)[cycle.approach]
        margin = 3.0 * min(contact.error, 0.05 * float(np.ptp(cycle.stage)))
        head = cycle.approach[tip < contact.place - margin]
        free[head[: int(0.97 * head.size)]] = True
    if lost is not None:
        tail = cycle.retraction[cycle.retraction >= lost]
        free[tail[min(5, tail.size // 10) :]] = True
    return free


def _wave_and_wall(cycle: Cycle, contact: Contact, base: Background, radius: float | None) -> dict[str, Any]:
    """Parts of the background that are known by a length."""
    parts: dict[str, Any] = {"wave": (contact.wave[0], base.wave)} if contact.wave else {}
    if contact.wall and radius:
        length, near = contact.wall
        parts["wall"] = length, near
        parts["wall/water"] = length * near / (6 * np.pi * WATER * radius**2 * _speed(cycle))
    return parts


def _of_contact(
    cycle: Cycle, one: Contact, noise: float, radius: float | None, poisson: float
) -> dict[str, Any]:
    """Numbers of the contact of the approach."""
    rows = cycle.approach
    touching = rows[one.tip(cycle.stage, cycle.force, cycle.spring)[rows] >= one.place]
    elastic = one.stiffness * 0.75 * (1.0 - poisson**2)
    return {
        "contact": one.place,
        "contact_error": one.error,
        "contact_time": float(cycle.time[touching[0]]) if touching.size else None,
        "depth": one.depth,
        "stiffness": one.stiffness,
        "modulus": elastic / float(np.sqrt(radius)) if radius else None,
        "misfit": one.misfit / noise * float(np.sqrt(max(1.0, rows.size / MOST_ROWS))),
        "snap_in": one.snap_in,
    }


def _of_retraction(
    cycle: Cycle, over: Array, noise: float, lost: int | None, drop: float | None, contact: Contact | None
) -> dict[str, Any]:
    """Pull-off, and where contact is lost, with the work until then; ``over``: force over its background."""
    back, stage, found = cycle.retraction, cycle.stage, {}
    lowest = int(np.argmin(np.convolve(over[back], np.full(3, 1.0 / 3.0), mode="same")[1:-1])) + 1
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
