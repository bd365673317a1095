"""A recorded curve: force over time and over the motion of the indenter or of the stage that carries it.

Signs and units are the scene's: penetration and stage positive towards the body, force positive in
compression. The zero of penetration and force need not be known: both may be parameters of a fit.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from contact_scene.errors import SceneError
from contact_scene.value_checks import LARGEST, SMALLEST, a_string, column, finite, positive

Array = NDArray[np.float64]

FEWEST_ROWS = 20
"""Rows of a curve, at least: fewer hardly outnumber the parameters of a fit and those of its baseline."""
COLUMNS = ("time", "penetration", "stage", "force", "contact_radius")


@dataclass(frozen=True)
class MeasuredCurve:
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

    Raises
    ------
    SceneError
        One line, if the columns are no record of a curve.
    """

    time: Array
    force: Array
    penetration: Array | None = None
    stage: Array | None = None
    contact_radius: Array | None = None
    stiffness: float | None = None
    indenter_radius: float | None = None
    noise: float | None = None
    name: str = "curve"

    def __post_init__(self) -> None:
        a_string(self.name, "name")
        for name in COLUMNS:
            given = getattr(self, name)
            if given is not None or name in ("time", "force"):
                object.__setattr__(self, name, self._checked(given, name))
        if self.time.size < FEWEST_ROWS:
            raise self._error("", f"{self.time.size} rows", f"at least {FEWEST_ROWS}")
        stuck = np.flatnonzero(np.diff(self.time) <= 0.0)
        if stuck.size:
            row = int(stuck[0])
            problem = f"does not advance from row {row + 1} to {row + 2}"
            raise self._error("time", problem, "strictly rising times; are two columns swapped?")
        if (self.penetration is None) == (self.stage is None):
            raise self._error("", "needs penetration or stage, and not both", "one of the two columns")
        if self.stage is not None and self.stiffness is None:
            allowed = "the spring constant between stage and indenter"
            raise self._error("stiffness", "is missing beside stage", allowed)
        for key in ("stiffness", "indenter_radius", "noise"):
            if getattr(self, key) is not None:
                try:
                    object.__setattr__(self, key, positive(getattr(self, key), key))
                except SceneError as error:
                    raise error.in_file(self.name) from None

    def _checked(self, given: ArrayLike, name: str) -> Array:
        try:
            values = column(given, name)
        except SceneError as error:
            raise error.in_file(self.name) from None
        if name != "time" and values.shape != self.time.shape:
            raise self._error(name, f"has shape {values.shape}", "one number for each time")
        broken = np.flatnonzero(~(np.abs(values) <= LARGEST))
        if broken.size:
            row = int(broken[0])
            raise self._error(
                name,
                f"{values[row]} in row {row + 1}",
                "finite numbers" if not np.isfinite(values[row]) else finite.words,
            )
        if values.size and 0.0 < np.ptp(values) < SMALLEST:
            raise self._error(name, f"changes by {np.ptp(values):.3g} in all", f"at least {SMALLEST:g}")
        return values

    def _error(self, key: str, problem: str, allowed: str) -> SceneError:
        return SceneError(key, problem, allowed, self.name)

    @property
    def position(self) -> Array:
        """What the instrument prescribed, shape (N,): the position of the stage, or else of the indenter."""
        driven = self.penetration if self.stage is None else self.stage
        assert driven is not None
        return driven

    @property
    def motion(self) -> Array:
        """Measured position of the indenter, shape (N,): the stage less the extension of the spring."""
        if self.penetration is not None:
            return self.penetration
        assert self.stage is not None
        assert self.stiffness is not None
        return self.stage - self.force / self.stiffness

    @property
    def sampling(self) -> float:
        """Time between two rows, the median."""
        return float(np.median(np.diff(self.time)))
