"""A fit in words: whether the model explains the data, and what to know before using a number."""

from __future__ import annotations

import math

from validation.fits.fit_result import FitResult
from validation.fits.goodness import UNLIKELY
from validation.fits.statistics import VAGUE, Estimate
from validation.report.document import Paragraph

VISIBLE_SHIFT = 0.5
"""Shift of a parameter by the second solver, over its standard deviation, that is worth a warning."""


def lead(result: FitResult) -> Paragraph:
    """Whether the model explains the data, in a sentence."""
    good, head = result.goodness, "The fit was interrupted: the best so far. " if not result.converged else ""
    numbers = (
        f"Misfit {math.sqrt(good.reduced):.3g} times the noise (sum of squares {good.chi_squared:.1f} for "
        f"{good.degrees} degrees of freedom; as large by chance: {chance(good.probability)})."
    )
    if good.explained:
        return Paragraph(f"{head}The model explains the data within their noise. {numbers}", result.converged)
    return Paragraph(f"{head}The model does not explain the data. {numbers}", False)


def statements(result: FitResult) -> list[str]:
    """What a reader has to know before using a number."""
    found = list(result.warnings)
    for one in result.goodness.runs:
        if one.probability < UNLIKELY:
            found.append(
                f"{one.curve}: the signs of the residuals change {one.runs - 1} times, where chance gives "
                f"{one.expected - 1:.0f} ({chance(one.probability)}): the model misses the shape of this "
                "curve. A branch or the adhesion may be missing, the zero of the record, or the spring."
            )
    if result.goodness.probability < UNLIKELY:
        found.append(
            "The misfit is larger than the noise: the errors below are scaled up to it, but say nothing "
            "about how wrong a wrong model's parameters are."
        )
    for estimate in result.estimates:
        if estimate.note:
            found.append(f"{estimate.name}: {estimate.note}{_largest(estimate)}.")
    for first, second, value in result.confused:
        found.append(f"{first} and {second} are hardly told apart: correlation {value:+.3f}.")
    vague = [one for one in result.combinations if len(one.powers) > 1 and not one.deviation < VAGUE]
    for combination in vague:
        found.append(f"The data do not determine {combination.text}; others below are known.")
    if result.check is not None:
        found += [
            f"{one.curve}: no second opinion, {result.check.solver} failed: {one.failure}"
            for one in result.check.differences
            if one.failure
        ]
        found += [
            f"{name} would move by {shift:+.2f} of its standard deviations with {result.check.solver}."
            for name, shift in result.check.shifts.items()
            if abs(shift) > VISIBLE_SHIFT
        ]
    return found


def _largest(estimate: Estimate) -> str:
    """For a modulus that may be zero: how large it may be, to first order."""
    if not estimate.note or not estimate.name.partition("@")[0].endswith("].modulus"):
        return ""
    if not math.isfinite(estimate.deviation):
        return ""
    largest = estimate.value * (1.0 + 1.96 * estimate.deviation)
    return f"; it may be zero, and at most {largest:.2g} (97.5 %)"


def chance(probability: float) -> str:
    """A probability in words."""
    return f"{probability:.2g}" if probability >= 1e-4 else "below 1e-4"
