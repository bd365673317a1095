"""A statement of the paper, and what a judgement of it consists of."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from enum import StrEnum
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from validation.claims.evidence import Evidence


class Verdict(StrEnum):
    """Whether a statement holds as worded."""

    HOLDS = "holds"
    IN_PART = "holds in part"
    FAILS = "does not hold"
    NOT_JUDGED = "not judged"


HOLDS, IN_PART, FAILS = Verdict.HOLDS, Verdict.IN_PART, Verdict.FAILS


@dataclass(frozen=True)
class Part:
    """One thing a statement says, as found: ``shown`` has the numbers; ``values`` the same by name."""

    shown: str
    holds: bool
    values: dict[str, float] = field(default_factory=dict)


@dataclass(frozen=True)
class Finding:
    """A statement judged.

    Parameters
    ----------
    name : str
        Short name, unique.
    place, wording : str
        Where in the paper, and what it says there, paraphrased.
    recorded : Verdict
        The verdict found before; another one now is a change that somebody has to look at.
    parts : tuple of Part
    failure : str
        Why it could not be judged.
    """

    name: str
    place: str
    wording: str
    recorded: Verdict
    parts: tuple[Part, ...] = ()
    failure: str = ""

    @property
    def verdict(self) -> Verdict:
        """Holds if every part does, does not hold if none does."""
        if self.failure or not self.parts:
            return Verdict.NOT_JUDGED
        true = sum(part.holds for part in self.parts)
        return HOLDS if true == len(self.parts) else IN_PART if true else FAILS

    @property
    def changed(self) -> bool:
        """Whether the verdict is not the recorded one."""
        return self.verdict is not self.recorded

    @property
    def shown(self) -> str:
        """What was found, in one line; what does not hold is marked."""
        return self.failure or "; ".join(("" if p.holds else "NOT: ") + p.shown for p in self.parts)


@dataclass(frozen=True)
class Claim:
    """A statement of the paper and how it is judged from runs."""

    name: str
    place: str
    wording: str
    recorded: Verdict
    judge: Callable[[Evidence], list[Part]]

    def judged(self, found: Evidence) -> Finding:
        """The statement judged; a run that is missing leaves it unjudged, with the reason."""
        from validation.claims.evidence import Missing

        try:
            parts, failure = tuple(self.judge(found)), ""
        except Missing as error:
            parts, failure = (), str(error)
        return Finding(self.name, self.place, self.wording, self.recorded, parts, failure)


def claim(place: str, wording: str, recorded: Verdict) -> Callable[[Callable[[Evidence], list[Part]]], Claim]:
    """Turn a function that judges into a claim named like it."""

    def named(judge: Callable[[Evidence], list[Part]]) -> Claim:
        return Claim(judge.__name__.replace("_", " "), place, wording, recorded, judge)

    return named
