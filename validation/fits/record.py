"""A recorded curve: force over time and over the motion of the indenter or of the stage that carries it.

Signs are the scene's: penetration and stage positive towards the body, force positive in compression. Units
are SI in a curve of an instrument's file, and those of the scene in one that is fitted to it. The zero of
penetration and force need not be known. Segments are the stretches of rows in which the drive approaches,
pauses or retracts.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Annotated, Any, NamedTuple, Self

import numpy as np
from numpy.typing import NDArray

from contact_scene.checked import Checked, Positive
from contact_scene.errors import SceneError, shown
from contact_scene.value_checks import SMALLEST, Column, Kind, finite, number, positive
from validation.fits.contact import Array
from validation.fits.features import Cycle, Features, features

FEWEST_ROWS = 20
"""Rows of a curve, at least: fewer hardly outnumber the parameters of a fit and those of its baseline."""
COLUMNS = ("time", "penetration", "stage", "force", "contact_radius")
KINDS = ("approach", "pause", "retract")
"""What the drive does in a segment."""
AT_REST = 0.02
"""Share of the travel below which a segment is a pause: what creep and noise of a closed-loop stage leave."""
PLATEAU = 0.005, 0.1
"""A record whose segments nobody tells has a pause at its apex if more than a tenth of its rows lie within
half a percent of the travel: those of a triangle are one percent, of a sine four and a half."""
SEGMENTS = Kind(
    f"(kind, first row, row after the last), one behind the other; kind: {', '.join(KINDS)}", (tuple, list)
)
Numbers = Annotated[Array, Column("finite numbers, one a row", finite)]


class CurveSegment(NamedTuple):
    """Rows ``first`` to ``last - 1``, in which the drive does ``kind``, one of ``KINDS``."""

    kind: str
    first: int
    last: int

    @property
    def rows(self) -> slice:
        """To take them out of a column."""
        return slice(self.first, self.last)


@dataclass(frozen=True)
class MeasuredCurve(Checked):
    """One record of an instrument.

    Parameters
    ----------
    time : array_like, shape (N,)
        Rising.
    force : array_like, shape (N,)
    penetration, stage : array_like, shape (N,), optional
        Exactly one of them: the position of the indenter, or of the stage that drives it through a spring.
    contact_radius : array_like, shape (N,), optional
    stiffness : float, optional
        Spring constant between stage and indenter; needed with ``stage``.
    indenter_radius : float, optional
        Of this curve's indenter, where it is not the scene's.
    noise : float, optional
        Standard deviation of the force; by default estimated from the baseline.
    name : str
    segments : sequence of (str, int, int), optional
        Kind (``approach``, ``pause``, ``retract``), first row and the row after the last of each stretch, in
        their order; by default told from the apex of the position.

    Raises
    ------
    SceneError
        One line, if the columns are no record of a curve.

    Examples
    --------
    >>> time = np.linspace(0.0, 2.0, 21)
    >>> curve = cc.MeasuredCurve(time, 1e-6 * np.sin(np.pi * time), penetration=1e-7 * np.sin(np.pi * time))
    >>> len(curve.time)
    21
    """

    time: Numbers
    force: Numbers
    penetration: Numbers | None = None
    stage: Numbers | None = None
    contact_radius: Numbers | None = None
    stiffness: Positive | None = None
    indenter_radius: Positive | None = None
    noise: Positive | None = None
    name: str = "curve"
    segments: Annotated[Sequence[CurveSegment], SEGMENTS] = ()

    def __post_init__(self) -> None:
        try:
            super().__post_init__()
        except SceneError as error:
            raise error.in_file(str(self.name)) from None

    def rules(self) -> None:
        if self.time.size < FEWEST_ROWS:
            raise SceneError("", f"{self.time.size} rows", f"at least {FEWEST_ROWS}")
        for name, values in self.columns().items():
            if values.shape != self.time.shape:
                raise SceneError(name, f"has shape {values.shape}", "one number for each time")
            if 0.0 < np.ptp(values) < SMALLEST:
                raise SceneError(name, f"changes by {np.ptp(values):.3g} in all", f"at least {SMALLEST:g}")
        stuck = np.flatnonzero(np.diff(self.time) <= 0.0)
        if stuck.size:
            problem = f"does not advance from row {stuck[0] + 1} to {stuck[0] + 2}"
            raise SceneError("time", problem, "strictly rising times; are two columns swapped?")
        if (self.penetration is None) == (self.stage is None):
            raise SceneError("", "needs penetration or stage, and not both", "one of the two columns")
        if self.stage is not None and self.stiffness is None:
            allowed = "the spring constant between stage and indenter"
            raise SceneError("stiffness", "is missing beside stage", allowed)
        try:
            segments = [CurveSegment(str(kind), int(first), int(last)) for kind, first, last in self.segments]
        except (TypeError, ValueError):
            raise SEGMENTS.refused("segments", f"got {shown(self.segments)}") from None
        end = 0
        for one in segments:
            if one.kind not in KINDS or not end <= one.first < one.last <= self.time.size:
                raise SEGMENTS.refused("segments", f"got {shown(tuple(one))}")
            end = one.last
        object.__setattr__(self, "segments", tuple(segments) or apex_segments(self.position))

    @property
    def driven(self) -> str:
        """Name of the column that the instrument prescribed."""
        return "penetration" if self.stage is None else "stage"

    @property
    def position(self) -> Array:
        """What the instrument prescribed, shape (N,): the position of the stage, or else of the indenter."""
        return np.asarray(getattr(self, self.driven))

    @property
    def motion(self) -> Array:
        """Measured position of the indenter, shape (N,): the stage less the extension of the spring."""
        if self.stage is None or self.stiffness is None:
            return self.position
        return self.stage - self.force / self.stiffness

    @property
    def speed(self) -> Array:
        """Of the drive, shape (N,): one in each segment, as noise of the height is none; 0 in a pause."""
        speed = np.zeros(self.time.size)
        for one in self.segments:
            if one.kind != "pause" and one.last - one.first > 1:
                speed[one.rows] = np.polyfit(self.time[one.rows], self.position[one.rows], 1)[0]
        return speed

    @property
    def cycle(self) -> Cycle:
        """The columns, with the rows of the approach to the apex and of the retraction from it."""
        position, spring = self.position, np.inf if self.stiffness is None else self.stiffness
        place, apex = np.arange(position.size), int(np.argmax(position))
        approach = place[self.rows("approach") & (place <= apex)]
        retraction = place[self.rows("retract") & (place >= apex - 1)]
        return Cycle(self.time, position, self.force, spring, self.speed, apex, approach, retraction)

    def rows(self, *kinds: str) -> NDArray[np.bool_]:
        """Which rows belong to segments of some kinds, shape (N,)."""
        chosen = np.zeros(self.time.size, bool)
        for one in self.segments:
            chosen[one.rows] |= one.kind in kinds
        return chosen

    def between(self, first: int, last: int) -> Self:
        """The rows from ``first`` to ``last - 1`` as a curve of their own."""
        columns = {name: values[first:last] for name, values in self.columns().items()}
        return self._of(columns, lambda row: min(max(row, first), last) - first)

    def features(
        self,
        radius: float | None = None,
        poisson: float = 0.5,
        wall: tuple[float, float] | None = None,
    ) -> Features:
        """What the curve shows without any solver, in SI units: contact, pull-off, background, warnings.

        Parameters
        ----------
        radius : float, optional
            Of a spherical indenter, in m; by default ``indenter_radius``. Without it there is no modulus,
            and a drag near the wall is told, not taken away.
        poisson : float
        wall : (float, float), optional
            Length (m) and force (N) of the drag near the wall, as ``background["wall"]`` of another curve has
            them; by default looked for in this one.

        Returns
        -------
        Features
        """
        radius = self.indenter_radius if radius is None else positive(radius, "radius")
        poisson = number(poisson, "poisson", "from -1 to 0.5", low=-1.0, high=0.5)
        return features(self.cycle, radius, poisson, wall)

    def means(self, most: int) -> tuple[Self, int]:
        """The curve with at most ``most`` rows, and of how many each is the mean; white noise falls with the
        root of their number, and rows at the end that fill no mean are left out."""
        together = -(-self.time.size // most)
        if together == 1:
            return self, 1
        rows = self.time.size // together
        columns = {
            name: values[: rows * together].reshape(rows, together).mean(axis=1)
            for name, values in self.columns().items()
        }
        noise = None if self.noise is None else self.noise / float(np.sqrt(together))
        return self._of(columns, lambda row: min(row // together, rows), noise=noise), together

    def _of(self, columns: dict[str, Any], place: Callable[[int], int], **more: Any) -> Self:
        """The curve with other rows, and where a row has come to."""
        cut = [CurveSegment(kind, place(first), place(last)) for kind, first, last in self.segments]
        return replace(self, **columns, **more, segments=[one for one in cut if one.first < one.last])

    def columns(self) -> dict[str, Array]:
        """The columns that were recorded, by name."""
        return {name: getattr(self, name) for name in COLUMNS if getattr(self, name) is not None}


def apex_segments(position: Array) -> tuple[CurveSegment, ...]:
    """Approach to the apex of a position, a pause there if it stays, and the retraction behind it."""
    share, rows = PLATEAU
    near = position >= position.max() - share * np.ptp(position)
    first, last = int(np.argmax(near)), near.size - int(np.argmax(near[::-1]))
    if last - first <= rows * near.size:
        first = last = int(np.argmax(position)) + 1
    bounds = zip(KINDS, (0, first, last), (first, last, near.size), strict=True)
    return tuple(CurveSegment(*one) for one in bounds if one[1] < one[2])


def moved_segments(
    position: Array, numbers: NDArray[Any], kinds: Sequence[str] = ()
) -> tuple[CurveSegment, ...]:
    """Segments of rows that an instrument numbers, of the kind of their first row, or of their net motion."""
    bounds = [0, *(np.flatnonzero(np.diff(numbers)) + 1).tolist(), numbers.size]
    if len(bounds) == 2:
        return apex_segments(position)
    found = []
    for first, last in pairwise(bounds):
        net = position[last - 1] - position[first]
        still = abs(net) < AT_REST * np.ptp(position)
        moved = "pause" if still else "approach" if net > 0.0 else "retract"
        found.append(CurveSegment(kinds[first] if kinds else moved, first, last))
    return tuple(found)
