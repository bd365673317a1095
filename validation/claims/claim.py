"""A statement of the paper, and the finding on it: parts, each with its numbers, and a verdict.

A part is a number, or a curve over a parameter, in a relation: near a known value, above or below a bound,
rising, largest between both ends.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from enum import StrEnum

import numpy as np
from numpy.typing import ArrayLike

from validation.claims.evidence import SOLVER, Evidence, MissingRun
from validation.measure.difference import Check


class Verdict(StrEnum):
    """Whether a statement holds as worded."""

    HOLDS = "holds"
    IN_PART = "holds in part"
    FAILS = "does not hold"
    NOT_EVALUATED = "not evaluated"


RECOVERED = 0.05
"""Relative difference within which two responses count as the same."""
LARGER = 1.2
"""Least ratio of two values for the first to count as significantly larger."""
STEADY = 1e-3
"""Change, relative to the largest magnitude, below which a quantity counts as constant."""

HOLDS, IN_PART, FAILS = Verdict.HOLDS, Verdict.IN_PART, Verdict.FAILS


@dataclass(frozen=True)
class Part:
    """One part of a statement, with its result: ``shown`` has the numbers; ``values`` the same by name."""

    shown: str
    holds: bool
    values: dict[str, float] = field(default_factory=dict)


def near(what: str, found: float, known: float = 1.0, within: float = RECOVERED) -> Part:
    """That a value is a known one, within a share of it."""
    shown = f"{what} {found:.5g} ({known:.5g} ± {100 * within:.2g} %)"
    return Part(shown, bool(abs(found / known - 1.0) <= within), {what: float(found), "known": float(known)})


def above(what: str, found: float, bound: float) -> Part:
    """That a value is larger than a bound."""
    return Part(f"{what} {found:.4g} (> {bound:.4g})", bool(found > bound), {what: float(found)})


def below(what: str, found: float, bound: float) -> Part:
    """That a value is no larger than a bound."""
    return Part(f"{what} {found:.4g} (≤ {bound:.4g})", bool(found <= bound), {what: float(found)})


def rises(what: str, curve: Mapping[float, float], slack: float = STEADY) -> Part:
    """That a curve never falls."""
    return over(f"{what} rises:", curve, rising(list(curve.values()), slack))


def peaks(what: str, curve: Mapping[float, float], bound: float = -np.inf) -> Part:
    """That a curve is largest at neither end, and there above a bound."""
    at = max(curve, key=lambda x: curve[x])
    holds = at not in (min(curve), max(curve)) and curve[at] > bound
    return Part(f"{what} {curve[at]:.4g}, largest at {at:g}", bool(holds), {what: float(curve[at]), "at": at})


def over(what: str, curve: Mapping[float, float], holds: bool) -> Part:
    """A curve, point by point."""
    shown = ", ".join(f"{y:.4g} at {x:g}" for x, y in curve.items())
    return Part(f"{what} {shown}", bool(holds), {f"{x:g}": float(y) for x, y in curve.items()})


def rising(values: ArrayLike, slack: float = STEADY) -> bool:
    """Whether no value falls below an earlier one by more than ``slack`` of the largest magnitude."""
    y = np.asarray(values, float)
    return bool(np.all(y >= np.maximum.accumulate(y) - slack * np.abs(y).max()))


def bell(values: ArrayLike) -> bool:
    """Whether the values rise to one inner maximum, significantly larger than both ends, and fall again."""
    y = np.asarray(values, float)
    top = int(y.argmax())
    single = rising(y[: top + 1], 0.01) and rising(y[top:][::-1], 0.01)
    return single and bool(y[top] >= LARGER * max(y[0], y[-1]))


@dataclass(frozen=True)
class Finding:
    """The result on one statement; ``failure`` says why it could not be evaluated.

    Another verdict than the ``recorded`` one, of an earlier evaluation, fails a check.
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

    @property
    def check(self) -> Check:
        """The check that the verdict is the recorded one."""
        found = None if self.verdict is Verdict.NOT_EVALUATED else str(self.verdict)
        note = self.shown if self.changed else ""
        return Check(
            "claims", SOLVER, self.name, self.place, str(self.recorded), found, not self.changed, note=note
        )


@dataclass(frozen=True)
class Claim:
    """A statement of the paper, and the function that judges its parts on runs."""

    name: str
    place: str
    wording: str
    recorded: Verdict
    judge: Callable[[Evidence], Iterable[Part]]

    def finding(self, evidence: Evidence) -> Finding:
        """Judge the statement; where a run is missing the verdict is open, with the reason."""
        try:
            parts, failure = tuple(self.judge(evidence)), ""
        except MissingRun as error:
            parts, failure = (), str(error)
        return Finding(self.name, self.place, self.wording, self.recorded, parts, failure)


def claim(place: str, recorded: Verdict) -> Callable[[Callable[[Evidence], Iterator[Part]]], Claim]:
    """Turn a function that yields parts into a claim: it is named like the function, worded as its docstring.

    ``place`` is where it stands in the paper, ``recorded`` the verdict found before.
    """

    def named(judge: Callable[[Evidence], Iterator[Part]]) -> Claim:
        wording = " ".join((judge.__doc__ or "").split())
        return Claim(judge.__name__.replace("_", " "), place, wording, recorded, judge)

    return named
