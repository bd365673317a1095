"""What a trial step returns: nothing of it is committed yet."""

from __future__ import annotations

from dataclasses import dataclass

from contact_scene import Event
from validation.reference.tracking.step_history import HistoryRow
from validation.reference.tracking.surface import Surface


@dataclass(frozen=True)
class FrontCandidate:
    """A state that a step arrives at.

    ``intervals``: number of intervals into which interpolated rows divide the step, 0 for a step that is not
    interpolated at all.
    ``to_limit_point``: distance that is left to the limit point ahead, if the step is smooth over the radius
    rather than in time.
    """

    time: float
    surface: Surface
    force: float
    intervals: int = 0
    to_limit_point: float | None = None

    @property
    def row(self) -> HistoryRow:
        """What the history keeps of it."""
        return self.time, self.surface.radius, self.force, self.surface.penetration


@dataclass(frozen=True)
class StepOutcome:
    """Result of a trial step.

    Attributes
    ----------
    proposal : float or None
        Duration to be proposed for the next step; ``None``: the first step after a kink.
    candidates : tuple of FrontCandidate
        States to commit, one after the other; none if the step is rejected.
    rejected : bool
        Whether a trial was rejected on the way.
    travel : float or None
        New limit of the travel of the edge; ``None``: as before.
    steepness : float or None
        Slope of the residual over the radius; ``None``: as before.
    steepening : float or None
        Rate of that slope; ``None``: as before.
    equilibria : tuple of Surface
        Rows at the present time before the candidate, recorded without being steps.
    reversible : bool
        Whether the way from row to row, up to the candidate, is one of equilibria at a fixed time.
    unstable_row : int or None
        But for this row, counted from the first of ``equilibria``: an unstable motion has led there.
    event : Event or None
    kink : bool
        Whether rates jump at the last candidate.
    zone_from_turn : bool
        Whether the edge has come to be one more process zone from its turn at the last candidate.
    first_contact : bool
        Whether contact may begin at the candidate with a whole face.
    detachment : str
        Why contact is lost after the last candidate; empty if it is not.
    below_zone : bool
        Whether the contact has shrunk to its process zone at the last candidate, and goes on to shrink.
    unstable : float
        Direction in which the edge runs from the limit point that it has reached; otherwise 0.
    """

    proposal: float | None = None
    candidates: tuple[FrontCandidate, ...] = ()
    rejected: bool = False
    travel: float | None = None
    steepness: float | None = None
    steepening: float | None = None
    equilibria: tuple[Surface, ...] = ()
    reversible: bool = False
    unstable_row: int | None = None
    event: Event | None = None
    kink: bool = False
    zone_from_turn: bool = False
    first_contact: bool = False
    detachment: str = ""
    below_zone: bool = False
    unstable: float = 0.0


NO_STABLE_CONTACT = "no stable contact is left"
