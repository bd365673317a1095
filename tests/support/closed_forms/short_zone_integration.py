"""Integration of the equations of a short zone, whose edge may come to rest or run away.

Both integrations are SciPy's LSODA with dense output: what happens a few zones from a reversal, or on the way
to detachment, takes far shorter steps than what is between.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import LSODA, OdeSolution, solve_ivp

Array = NDArray[np.float64]

ACCURACY = 1e-10
"""Relative tolerance of the integration."""


@dataclass(frozen=True)
class Integration:
    """Times ``t`` of the steps of an integration, and its dense output ``sol``, as SciPy names them."""

    t: Array
    sol: OdeSolution


def integrated(
    rates: Callable[[float, Array], Array],
    span: tuple[float, float],
    state: Array,
    events: Sequence[Callable[[float, Array], float]],
) -> Any:
    """The integration over a time, or up to an event before."""
    return solve_ivp(
        rates,
        span,
        state,
        method="LSODA",
        rtol=ACCURACY,
        atol=_tolerances(state),
        events=events or None,
        dense_output=True,
    )


def integrated_until(
    ended: Callable[[float, Array], bool], rates: Callable[[float, Array], Array], begin: float, state: Array
) -> Integration:
    """The integration up to the first step after which it has ``ended``.

    SciPy's events are located in the dense output, which a state that runs away within a step leaves; and a
    step beyond that moment is shorter than the rounding of the time."""
    solver = LSODA(rates, begin, state, math.inf, rtol=ACCURACY, atol=_tolerances(state))
    times, pieces = [begin], []
    while solver.status == "running" and not ended(solver.t, solver.y):
        solver.step()
        if solver.t > times[-1]:
            times.append(solver.t)
            pieces.append(solver.dense_output())
    return Integration(np.array(times), OdeSolution(times, pieces))


def moment_of_loss(jumps: Callable[[float], bool], times: Array) -> float:
    """The first moment at which the edge jumps, to round-off; at the last of ``times`` it does."""
    held, lost = float(times[[not jumps(t) for t in times]][-1]), float(times[-1])
    while lost - held > 1e-13 * lost:
        middle = 0.5 * (held + lost)
        held, lost = (held, middle) if jumps(middle) else (middle, lost)
    return lost


def _tolerances(state: Array) -> Array:
    """Absolute tolerances by the sizes of the state at its start."""
    return ACCURACY * np.maximum(np.abs(state), ACCURACY * np.abs(state).max())
