"""Share of a run that is done, by the steps it has taken over their forecast.

The share of the prescribed loading says little about the work ahead: a cycle may lose contact half-way.
"""

from __future__ import annotations

SATURATION = 3.0
"""Exponent with which the share of a run falls behind its steps over their forecast: 79 % where that is
reached, 99 % at three times as many, which is what a forecast may be wrong by."""
UNFINISHED = 0.99
"""Largest share of a run whose loading is not done."""


class StepShare:
    """Call it after every step with the share of the loading that is done; it gives the share of the run.

    The steps ahead are those of the forecast that are not taken yet, and at most the forecast's over the part
    of the loading that is left. A forecast may be a few times too small: the share follows the steps taken
    over it, and ever more slowly as it is reached.

    Parameters
    ----------
    forecast : float
        Steps of the whole run.

    Attributes
    ----------
    steps : int
        Taken so far.
    ahead : float
        Steps of the forecast that are left; not positive beyond it.
    """

    def __init__(self, forecast: float) -> None:
        self._forecast = self.ahead = max(forecast, 1.0)
        self.steps, self._share = 0, 0.0

    def __call__(self, loading: float) -> float:
        self.steps += 1
        if loading >= 1.0:
            return 1.0
        over_loading = self._forecast * (1.0 - loading)
        self.ahead = min(self._forecast - self.steps, over_loading)
        taken = self.steps / self._forecast
        saturating = taken / (1.0 + taken**SATURATION) ** (1.0 / SATURATION)
        bounded = self.steps / (self.steps + over_loading)
        self._share = min(max(self._share, saturating, bounded), UNFINISHED)
        return self._share
