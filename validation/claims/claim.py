"""A statement of the paper, and the finding on it: parts, each with its numbers, and a verdict."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from enum import StrEnum

from validation.claims.evidence import Evidence, MissingRun


class Verdict(StrEnum):
    """Whether a statement holds as worded."""

    HOLDS = "holds"
    IN_PART = "holds in part"
    FAILS = "does not hold"
    NOT_EVALUATED = "not evaluated"


HOLDS, IN_PART, FAILS = Verdict.HOLDS, Verdict.IN_PART, Verdict.FAILS


@dataclass(frozen=True)
class Part:
    """One part of a statement, with its result: ``shown`` has the numbers; ``values`` the same by name."""

    shown: str
    holds: bool
    values: dict[str, float] = field(default_factory=dict)


@dataclass(frozen=True)
class Finding:
    """The result on one statement.

    Parameters
    ----------
    name : str
        Short name, unique.
    place, wording : str
        Where in the paper, and its words, paraphrased.
    recorded : Verdict
        The verdict of an earlier evaluation; another one now fails a check.
    parts : tuple of Part
    failure : str
        Why it could not be evaluated.
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
            return Verdict.NOT_EVALUATED
        true = sum(part.holds for part in self.parts)
        return HOLDS if true == len(self.parts) else IN_PART if true else FAILS

    @property
    def changed(self) -> bool:
        """Whether the verdict is not the recorded one."""
        return self.verdict is not self.recorded

    @property
    def shown(self) -> str:
        """The results of all parts, in one line; what does not hold is marked."""
        return self.failure or "; ".join(("" if p.holds else "NOT: ") + p.shown for p in self.parts)


@dataclass(frozen=True)
class Claim:
    """A statement of the paper and the function that evaluates it on runs."""

    name: str
    place: str
    wording: str
    recorded: Verdict
    evaluate: Callable[[Evidence], list[Part]]

    def finding(self, evidence: Evidence) -> Finding:
        """Evaluate the statement; where a run is missing the verdict is open, with the reason."""
        try:
            parts, failure = tuple(self.evaluate(evidence)), ""
        except MissingRun as error:
            parts, failure = (), str(error)
        return Finding(self.name, self.place, self.wording, self.recorded, parts, failure)


def claim(place: str, wording: str, recorded: Verdict) -> Callable[[Callable[[Evidence], list[Part]]], Claim]:
    """Turn a function that evaluates a statement into a claim named like it.

    Parameters
    ----------
    place : str
        In the paper.
    wording : str
        Of the statement.
    recorded : Verdict
        From which a change of the verdict is told.

    Returns
    -------
    callable
        Decorator.
    """

    def named(evaluate: Callable[[Evidence], list[Part]]) -> Claim:
        return Claim(evaluate.__name__.replace("_", " "), place, wording, recorded, evaluate)

    return named
