"""The result of one check, the form in which all evidence states what passed and what failed."""

from __future__ import annotations

from dataclasses import dataclass

from validation.measure.round_off import ROUND_OFF

SEVERAL = 3.5
"""Largest error estimate, relative to the tolerance, of a run that is worth comparing. Estimates hold a
safety factor of three: beyond this the two runs they come from differ by more than the tolerance, and where
they agree with the reference, they do so by accident. What limits it is the force at which finite elements
lose a contact that was pulled fast (``retraction-fast``: 3.1 tolerances), where the edge runs away."""


@dataclass(frozen=True)
class Check:
    """What a run was expected to show, what it showed, and whether that is within tolerance.

    Parameters
    ----------
    scene, solver, quantity : str
        Names: which number of which run.
    source : str
        Where the expectation comes from.
    expected, found : str or float or None
        In ``unit``; ``found`` is ``None`` if the run does not give it.
    difference : float or None
        Relative, signed where a sign makes sense.
    tolerance : float or None
        Largest magnitude of ``difference``; ``None`` for words and one-sided limits.
    estimate, base_estimate : float or None
        Relative error estimates of the solver and of what it is compared with, where there are any. Then
        their sum is the limit, ``tolerance`` its cap.
    relation : str
        ``"="``, ``"<="`` or ``">="``.
    passed : bool
    note : str
        Why, where numbers do not say it.
    """

    scene: str
    solver: str
    quantity: str
    source: str
    expected: float | str | None
    found: float | str | None
    passed: bool
    unit: str = ""
    difference: float | None = None
    tolerance: float | None = None
    relation: str = "="
    note: str = ""
    estimate: float | None = None
    base_estimate: float | None = None

    @property
    def limit(self) -> float | None:
        """Largest magnitude of ``difference`` that passes."""
        return (
            None
            if self.tolerance is None
            else agreement_limit(self.tolerance, self.estimate, self.base_estimate)
        )


def agreement_limit(tolerance: float, estimate: float | None, base_estimate: float | None) -> float:
    """Largest difference that counts as agreement: the sum of both estimates, at most the tolerance.

    The tolerance alone where one of the runs has no estimate.

    Parameters
    ----------
    tolerance : float
        Relative.
    estimate, base_estimate : float or None
        Relative error estimates of the two runs.

    Returns
    -------
    float
    """
    if estimate is None or base_estimate is None:
        return tolerance
    return min(tolerance, estimate + base_estimate + ROUND_OFF)


def disagreement(
    difference: float | None, tolerance: float, estimate: float | None, base_estimate: float | None
) -> str:
    """Why a value does not agree with what was expected, in words; empty if it does.

    Parameters
    ----------
    difference : float or None
        Relative, of either sign; ``None`` if the run does not give the value.
    tolerance : float
        Relative.
    estimate, base_estimate : float or None
        Relative error estimates of the two runs.

    Returns
    -------
    str
    """
    if difference is None:
        return "the run does not give it"
    for whose, error in (("the run", estimate), ("the reference", base_estimate)):
        if error is not None and not 0.0 <= error <= SEVERAL * tolerance:
            return f"{whose} estimates its own error at {error:.2g}: the tolerance is {tolerance:.2g}"
    limit = agreement_limit(tolerance, estimate, base_estimate)
    return "" if abs(difference) <= limit else f"differs by {abs(difference):.2g}, not within {limit:.2g}"
