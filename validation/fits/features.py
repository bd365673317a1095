"""What a record shows before any viscoelastic model: background, contact point, stiffness, loss of contact.

In this order: the contact point of the approach (:mod:`validation.fits.contact`), with wave and wall drag;
the loss of contact of the retraction; one background of all free rows; then pull-off, drop, work and
hysteresis of the force over it. In SI units, of a record that goes in and out once.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from validation.fits.background import Background, background, loss_of_contact
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
BEFORE, BEHIND = 0.10, 0.05
"""Shares of the rows free before contact and behind its loss, below which the background is poorly known."""
FEW = 0.03
"""Share of the rows in contact below which they tell little."""
BENDS = 1.2
"""Bending of the spring over the travel of the stage from which one of the two is in another unit."""
FAINT = 1e-12
"""Newtons, of which no instrument has a range."""
AVERAGED = 200
"""Means of the approach with which the retraction is compared: quieter than its rows."""
PULLED = 3.0
"""Deviations of three rows' mean from which the least force is a pull-off."""


class Recorded(Protocol):
    """What is asked of a record: :class:`validation.fits.record.MeasuredCurve`."""

    @property
    def time(self) -> Array: ...
    @property
    def position(self) -> Array: ...
    @property
    def force(self) -> Array: ...
    @property
    def stiffness(self) -> float | None: ...
    @property
    def speed(self) -> Array: ...
    def rows(self, *kinds: str) -> NDArray[np.bool_]: ...


@dataclass(frozen=True)
class Features:
    """What a curve shows of itself, in SI units; ``None`` where it does not.

    Parameters
    ----------
    noise, rough : float
        White noise of the force, and what is left on the free rows over their background.
    contact, contact_error, contact_time : float or None
        Position of the stage at which indenter and sample touch without force, its standard deviation, and
        when.
    depth, stiffness : float or None
        Largest indentation, and K of the force ``K depth**1.5``.
    modulus : float or None
        Young's modulus of Hertz' or DMT's contact, of an indenter whose radius is stated.
    misfit : float or None
        Root mean square of what the contact leaves of the approach, over the noise.
    snap_in, pull_off : float or None
        Least force of a jump into contact, and of the retraction; negative.
    lost, lost_time : float or None
        Position of the stage at which contact is lost, and when.
    drop : float or None
        Force that is lost at once.
    work : float or None
        Of separation: ``-F`` over the path of the tip, where it pulls.
    hysteresis : float or None
        Work of the stage from first contact to its loss.
    background : dict
        ``level``, ``tilt``, ``drag``, ``drift`` in N over N, m, m/s, s; ``wave``: length and amplitude;
        ``wall``: length and force of the drag near the wall; ``wall/water``: its size over that in water.
    force : ndarray, shape (N,)
        Over its background, wall drag included.
    free : ndarray of bool, shape (N,)
        Rows without contact.
    warnings : tuple of str
    """

    noise: float
    rough: float
    force: Array
    free: NDArray[np.bool_]
    contact: float | None = None
    contact_error: float | None = None
    contact_time: float | None = None
    depth: float | None = None
    stiffness: float | None = None
    modulus: float | None = None
    misfit: float | None = None
    snap_in: float | None = None
    pull_off: float | None = None
    lost: float | None = None
    lost_time: float | None = None
    drop: float | None = None
    work: float | None = None
    hysteresis: float | None = None
    background: dict[str, float | tuple[float, float]] = field(default_factory=dict)
    warnings: tuple[str, ...] = ()


@dataclass(frozen=True)
class Drive:
    """The rows of a record by what the drive does: approach up to the apex, retraction from it, and
    speeds."""

    approach: NDArray[np.intp]
    retraction: NDArray[np.intp]
    speed: Array
    apex: int

    @classmethod
    def of(cls, curve: Recorded) -> Drive:
        """That of a record."""
        place, apex = np.arange(curve.position.size), int(np.argmax(curve.position))
        return cls(
            place[curve.rows("approach") & (place <= apex)],
            place[curve.rows("retract") & (place >= apex - 1)],
            curve.speed,
            apex,
        )


def features(curve: Recorded, radius: float | None = None, poisson: float = 0.5) -> Features:
    """Read them off a curve."""
    motion, spring = Drive.of(curve), np.inf if curve.stiffness is None else curve.stiffness
    stage, force = curve.position, curve.force
    told, warned = None, []
    if motion.approach.size >= 20:
        found = _approach(stage, force, spring, motion)
        if found is not None:
            told, scan = found
            walled = with_wall(scan, told) if np.isfinite(spring) else None
            speed = float(np.abs(motion.speed[motion.approach]).mean())
            if walled is not None and walled.wall is not None and speed > 0.0:
                length, near = walled.wall
                bead = float(np.sqrt(length * near / (6.0 * np.pi * WATER * speed)))
                if radius and LIKE_WATER**-0.5 < bead / radius < LIKE_WATER**0.5:
                    force = force - _drag(stage, force, spring, motion, walled)
                    again = _approach(stage, force, spring, motion)
                    told = replace(again[0], wall=walled.wall) if again else None
                elif radius is None and BEADS[0] < bead < BEADS[1]:
                    warned.append(
                        f"a force like the drag near a wall, of a bead of {1e6 * bead:.2g} um: --radius"
                    )
    return _Told(curve, motion, spring, force, told, radius, poisson).features(warned)


def _approach(stage: Array, force: Array, spring: float, motion: Drive) -> tuple[Contact, Scan] | None:
    """The contact of the approach; with a snap-in, where that begins, and DMT's stiffness behind it."""
    rows = motion.approach
    found = find_contact(stage[rows], force[rows], spring)
    if found is None:
        return None
    contact, scan = found
    over = scan.force - contact.line(scan.stage)
    low = int(np.argmin(over))
    early = over[: max(10, int(0.6 * low))]
    if low <= 20 or over[low] > -max(
        SNAP * max(float(np.std(early)), white_noise(force)), SNAP_SHARE * np.ptp(over)
    ):
        return found
    head = slice(int(0.7 * low))
    tilt, level = np.polyfit(scan.stage[head] - contact.origin, scan.force[head], 1)
    contact = replace(contact, tilt=float(tilt), level=float(level), snap_in=float(over[low]))
    over = scan.force - contact.line(scan.stage)
    outside = over > -max(4.0 * float(np.std(over[head])), ONSET * abs(over[low]))
    row = int(np.flatnonzero(outside[: low + 1])[-1]) if outside[: low + 1].any() else 0
    tip = scan.stage - over / spring
    root = np.clip(over[low:] - over[low], 0.0, None) ** (1.0 / EXPONENT)
    slope = float(np.polyfit(tip[low:] - tip[low], root, 1)[0]) if over.size - low > 10 else 0.0
    place = float(scan.stage[row])
    return replace(
        contact,
        place=place,
        error=float(abs(scan.stage[1] - scan.stage[0])),
        depth=float(tip.max() - place),
        stiffness=slope**EXPONENT if slope > 0.0 else contact.stiffness,
    ), scan


def _drag(stage: Array, force: Array, spring: float, motion: Drive, walled: Contact) -> Array:
    """The drag near the wall on all rows, with the sign of the speed."""
    assert walled.wall is not None
    length, near = walled.wall
    gap = np.clip(walled.place - walled.tip(stage, force, spring), 0.0, None)
    return np.asarray(near * motion.speed / motion.speed[motion.approach].mean() / (1.0 + gap / length))


@dataclass(frozen=True)
class _Told:
    """A record, with the force less wall drag and the contact of its approach; the rest follows from them."""

    curve: Recorded
    motion: Drive
    spring: float
    force: Array
    contact: Contact | None
    radius: float | None
    poisson: float

    def features(self, warned: list[str]) -> Features:
        stage, time, force, motion = self.curve.position, self.curve.time, self.force, self.motion
        noise = max(white_noise(force), 1e-9 * float(np.ptp(force)))
        back, lost, drop = motion.retraction, None, None
        seen = self.contact is not None or not motion.approach.size
        if back.size >= 20 and seen:
            over = force[back] - self._approached(stage[back])
            loss = loss_of_contact(stage[back], over, noise)
            drop, lost = loss.jump, None if loss.row is None else int(back[loss.row])
        free = self._free(lost)
        length = self.contact.wave[0] if self.contact and self.contact.wave else None
        if free.sum() > 20:
            base = background(time, stage, motion.speed, force, free, motion.apex, length)
        else:
            level = float(np.median(force[: max(3, force.size // 50)]))
            base = Background(np.full(force.size, level), {"level": level}, 0.0, noise)
        over = force - base.force
        told = Features(noise, base.rough, over, free, background=self._parts(base))
        if self.contact is not None:
            told = self._of_contact(told)
        if seen and back.size >= 20:
            told = self._of_loss(told, lost, drop)
        return replace(told, warnings=(*self._warnings(told), *warned))

    def _approached(self, stage: Array) -> Array:
        """Force of the approach at some positions, where it is free: what comes back there is background."""
        if self.contact is None:
            return np.zeros_like(stage)
        rows = self.motion.approach
        tip = self.contact.tip(self.curve.position, self.force, self.spring)
        free = rows[tip[rows] < self.contact.place - 3.0 * self.contact.error]
        place, seen = means(AVERAGED, self.curve.position[free], self.force[free])
        order = np.argsort(place)
        return self.contact.line(stage) + np.interp(
            stage, place[order], (seen - self.contact.line(place))[order]
        )

    def _free(self, lost: int | None) -> NDArray[np.bool_]:
        """Rows well before contact and behind its loss; all of a record without contact."""
        stage, motion = self.curve.position, self.motion
        free = np.zeros(stage.size, bool)
        if self.contact is None:
            free[motion.approach] = free[motion.retraction] = motion.approach.size > 0
        else:
            tip = self.contact.tip(stage, self.force, self.spring)
            margin = 3.0 * min(self.contact.error, 0.05 * float(np.ptp(stage)))
            head = motion.approach[tip[motion.approach] < self.contact.place - margin]
            free[head[: int(0.97 * head.size)]] = True
        if lost is not None:
            tail = motion.retraction[motion.retraction >= lost]
            free[tail[min(5, tail.size // 10) :]] = True
        return free

    def _parts(self, base: Background) -> dict[str, float | tuple[float, float]]:
        parts: dict[str, float | tuple[float, float]] = {**base.parts}
        if self.contact and self.contact.wave:
            parts["wave"] = self.contact.wave[0], base.wave
        if self.contact and self.contact.wall and self.radius:
            length, near = self.contact.wall
            speed = float(np.abs(self.motion.speed[self.motion.approach]).mean())
            parts |= {
                "wall": (length, near),
                "wall/water": length * near / (6 * np.pi * WATER * self.radius**2 * speed),
            }
        return parts

    def _of_contact(self, told: Features) -> Features:
        one = self.contact
        assert one is not None
        rows = self.motion.approach
        tip = one.tip(self.curve.position, self.force, self.spring)
        touching = rows[tip[rows] >= one.place]
        modulus = None
        if self.radius:
            modulus = one.stiffness * 0.75 * (1.0 - self.poisson**2) / float(np.sqrt(self.radius))
        return replace(
            told,
            contact=one.place,
            contact_error=one.error,
            contact_time=float(self.curve.time[touching[0]]) if touching.size else None,
            depth=one.depth,
            stiffness=one.stiffness,
            modulus=modulus,
            misfit=one.misfit / told.noise * float(np.sqrt(max(1.0, rows.size / MOST_ROWS))),
            snap_in=one.snap_in,
        )

    def _of_loss(self, told: Features, lost: int | None, drop: float | None) -> Features:
        back, over, stage = self.motion.retraction, told.force, self.curve.position
        smooth = np.convolve(over[back], np.full(3, 1.0 / 3.0), mode="same")
        lowest = int(np.argmin(smooth[1:-1])) + 1
        if over[back][lowest] < -PULLED * max(told.rough, told.noise):
            told = replace(told, pull_off=float(over[back][lowest]))
        if lost is None:
            return told
        near = max(3, back.size // 200)
        if drop is None:
            behind, ahead = over[lost : lost + near], over[max(lost - near, back[0]) : lost + 1]
            drop = float(np.median(behind) - ahead.min())
        path = np.arange(back[0], lost)
        tip = stage - over / self.spring
        work = float(np.trapezoid(np.clip(over[path], None, 0.0), tip[path]))
        loop = None
        if self.contact is not None and self.motion.approach.size:
            loop = float(
                np.trapezoid(over[self.motion.approach[0] : lost], stage[self.motion.approach[0] : lost])
            )
        place, when = float(stage[lost]), float(self.curve.time[lost])
        return replace(told, lost=place, lost_time=when, drop=drop, work=work, hysteresis=loop)

    def _warnings(self, told: Features) -> Iterator[str]:
        """In order of worth."""
        force, stage = self.curve.force, self.curve.position
        bend, travel, rows = float(np.ptp(force)) / self.spring, float(np.ptp(stage)), stage.size
        if bend > BENDS * travel:
            asked = "spring constant or unit of the force?"
            yield f"the spring bends {1e6 * bend:.3g} um over a stage of {1e6 * travel:.3g} um: {asked}"
        if np.ptp(force) < FAINT:
            yield f"the force changes by {np.ptp(force):.2g} N in all: sensitivity, spring constant or unit?"
        if stage[np.argmax(np.abs(force - np.median(force)))] < stage.min() + 0.1 * travel:
            yield "the force is largest where the stage is smallest: both signs turned?"
        if self.contact is None:
            yield "no contact on the approach" if self.motion.approach.size else "no approach in the record"
            return
        ahead = told.free[: self.motion.apex].sum() / rows
        behind = told.free[self.motion.apex :].sum() / rows
        if ahead < BEFORE:
            yield f"{100 * ahead:.2g} % of the rows are free before contact: the background is poorly known"
        if told.lost is not None and behind < BEHIND:
            yield f"{100 * behind:.2g} % of the rows are free behind the loss of contact"
        if self.contact.wall and told.pull_off and abs(told.pull_off) < 0.5 * self.contact.wall[1]:
            yield "the pull-off force is less than half the drag at the wall: adhesion is not determined"
        touching = 1.0 - told.free.mean()
        if touching < FEW:
            yield f"{100 * touching:.2g} % of the rows are in contact"
        if self.motion.retraction.size and told.lost is None:
            yield "contact is not lost in the record"
