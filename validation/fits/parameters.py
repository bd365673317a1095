"""What a fit varies: numbers of the scene by dotted path, and what belongs to the instrument.

A search sees plain numbers of order one: the logarithm of a positive parameter, any other one over its scale.
"""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from contact_scene import Scene, SceneError
from contact_scene.errors import shown
from contact_scene.scene import value_at
from contact_scene.value_checks import finite
from validation.fits.record import Array

CONTACT_POINT, BASELINE, DRIFT, TIME_OFFSET = "contact_point", "baseline", "drift", "time_offset"
INSTRUMENT = (CONTACT_POINT, BASELINE, DRIFT, TIME_OFFSET)
"""Parameters of a curve's own that are no numbers of the scene."""
SPRING = ("machine.stiffness", "loading.machine.stiffness")
"""Paths of the spring between stage and indenter."""
RANGE = 1e3
"""Factor about the scene's value within which a positive parameter is searched, if no bounds are given."""
LIMITED = {"material.poisson": (0.0, 0.5)}
"""Numbers that may not leave an interval, by path."""


@dataclass(frozen=True)
class FitParameter:
    """One unknown.

    Parameters
    ----------
    name : str
        Path in the scene, or one of ``INSTRUMENT``; of a curve's own, with the curve behind an ``@``.
    start : float
        First guess.
    low, high : float
        Bounds.
    logarithmic : bool
        Whether its logarithm is searched.
    scale : float
        Size of a change that matters, where it is not.
    ratios : mapping of str to float
        Paths of the scene that it sets, each with the value over its own; empty for the instrument's.
    curve : int or None
        The only curve it belongs to.
    """

    name: str
    start: float
    low: float
    high: float
    logarithmic: bool
    scale: float = 1.0
    ratios: dict[str, float] = field(default_factory=dict)
    curve: int | None = None

    def __post_init__(self) -> None:
        if not self.low <= self.start <= self.high or self.low >= self.high:
            problem = f"starts at {self.start:.6g}, with bounds {self.low:.6g} to {self.high:.6g}"
            raise SceneError(self.name, problem, "bounds with the value of the scene between them")

    @property
    def kind(self) -> str:
        """The path in the scene or the name among ``INSTRUMENT``, without the curve."""
        return self.name.partition("@")[0]

    def plain(self, value: float) -> float:
        """The number that the search sees."""
        return math.log(value) if self.logarithmic else value / self.scale

    def value(self, plain: float) -> float:
        """The parameter of a number of the search."""
        return math.exp(plain) if self.logarithmic else plain * self.scale


@dataclass(frozen=True)
class ParameterSet:
    """All unknowns of a fit."""

    parameters: tuple[FitParameter, ...]

    def __post_init__(self) -> None:
        if not self.parameters:
            raise SceneError("vary", "is empty", "at least one number of the scene")
        seen: set[tuple[str, int | None]] = set()
        for one in self.parameters:
            for path in one.ratios or {one.kind: 1.0}:
                if {(path, None), (path, one.curve)} & seen or (
                    one.curve is None and any(path == other for other, _ in seen)
                ):
                    raise SceneError(path, "is varied twice", "each number once")
                seen.add((path, one.curve))

    def __len__(self) -> int:
        return len(self.parameters)

    @property
    def start(self) -> Array:
        """First guess as the search sees it, shape (P,)."""
        return np.array([one.plain(one.start) for one in self.parameters])

    @property
    def bounds(self) -> tuple[Array, Array]:
        """Bounds as the search sees them, shape (P,) each."""
        low = np.array([one.plain(one.low) for one in self.parameters])
        return low, np.array([one.plain(one.high) for one in self.parameters])

    def values(self, plain: Array) -> dict[str, float]:
        """Values by name."""
        return {one.name: one.value(float(x)) for one, x in zip(self.parameters, plain, strict=True)}

    def of_curve(self, plain: Array, curve: int) -> tuple[dict[str, float], dict[str, float]]:
        """What holds for one curve: numbers of the scene by path, and those of the instrument."""
        scene: dict[str, float] = {}
        instrument = dict.fromkeys(INSTRUMENT, 0.0)
        for one, x in zip(self.parameters, plain, strict=True):
            if one.curve not in (None, curve):
                continue
            value = one.value(float(x))
            if one.ratios:
                scene |= {path: ratio * value for path, ratio in one.ratios.items()}
            else:
                instrument[one.kind] = value
        return scene, instrument


def scene_parameter(
    scene: Scene, entry: str, tied: Sequence[str] = (), curve: tuple[int, str] | None = None
) -> FitParameter:
    """A number of the scene as an unknown.

    Parameters
    ----------
    scene : Scene
    entry : str
        ``PATH``, ``PATH=LOW:HIGH`` or, to search the number itself, ``PATH=LOW:HIGH:linear``.
    tied : sequence of str
        Paths that keep their ratio to it.
    curve : (int, str), optional
        Place and name of the curve it belongs to alone.

    Returns
    -------
    FitParameter

    Raises
    ------
    SceneError
        If there is no such number, or the bounds are none.
    """
    path, _, limits = entry.partition("=")
    start = value_at(scene, path)
    low, high, form = _limits(path, limits)
    least, most = LIMITED.get(path, (-math.inf, math.inf))
    logarithmic = form != "linear" and start > 0.0 and path not in LIMITED and (low is None or low > 0.0)
    if form == "log" and not logarithmic:
        raise SceneError(path, "has no logarithm", "a value and bounds > 0")
    if logarithmic:
        low, high = start / RANGE if low is None else low, start * RANGE if high is None else high
    else:
        reach = RANGE * max(abs(start), 1e-3)
        low, high = (
            max(start - reach if low is None else low, least),
            min(start + reach if high is None else high, most),
        )
    ratios = {path: 1.0}
    for other in tied:
        if start == 0.0:
            raise SceneError(path, "is zero, and others are tied to it", "a value that ratios refer to")
        ratios[other] = value_at(scene, other) / start
    name = path if curve is None else f"{path}@{curve[1]}"
    scale = abs(start) or high - low
    place = None if curve is None else curve[0]
    return FitParameter(name, start, low, high, logarithmic, scale, ratios, place)


def _limits(path: str, text: str) -> tuple[float | None, float | None, str]:
    if not text:
        return None, None, ""
    match = re.fullmatch(r"([^:]+):([^:]+)(?::(log|linear))?", text)
    if match is None:
        raise SceneError(path, f"got bounds {shown(text)}", "LOW:HIGH, LOW:HIGH:linear or LOW:HIGH:log")
    ends = []
    for part in match.groups()[:2]:
        try:
            ends.append(finite(float(part), path))
        except ValueError:
            raise SceneError(path, f"got bounds {shown(text)}", "two finite numbers, LOW:HIGH") from None
    return ends[0], ends[1], match[3] or ""
