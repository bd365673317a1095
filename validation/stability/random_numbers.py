"""Random numbers of a seed, and the sizes that a random scene is made of."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TypeVar

import numpy as np

Value = TypeVar("Value")


@dataclass(frozen=True)
class SceneSizes:
    """What everything is measured in: contact radius, penetration, force, relaxation time."""

    radius: float
    depth: float
    force: float
    time: float


def rounded(value: float) -> float:
    """The nearest of 1, 2, 5 times a power of ten, in the logarithm, of a positive number."""
    power = math.floor(math.log10(value))
    near = [float(f"{digit}e{power}") for digit in (1, 2, 5, 10)]
    return min(near, key=lambda one: abs(math.log(one / value)))


class RandomNumbers:
    """Random numbers of a seed, rounded to a few digits so that a scene can be read."""

    def __init__(self, seed: int | tuple[int, ...]) -> None:
        self._generator = np.random.default_rng(seed)

    def decades(self, low: float, high: float) -> float:
        """Evenly over powers of ten."""
        return float(f"{10.0 ** self._generator.uniform(low, high):.3g}")

    def near(self, size: float, low: float, high: float) -> float:
        """A round number, evenly over powers of ten of ``size`` but for its rounding.

        Parameters
        ----------
        size : float
        low, high : float
            Exponents.

        Returns
        -------
        float
        """
        return rounded(size * self.decades(low, high))

    def between(self, low: float, high: float) -> float:
        """Evenly."""
        return float(f"{self._generator.uniform(low, high):.3g}")

    def one_of(self, values: tuple[Value, ...]) -> Value:
        """One of several, all alike."""
        return values[int(self._generator.integers(len(values)))]

    def count(self, low: int, high: int) -> int:
        """A whole number, both ends included."""
        return int(self._generator.integers(low, high + 1))

    def happens(self, share: float) -> bool:
        """True in that share of the cases."""
        return bool(self._generator.uniform() < share)
