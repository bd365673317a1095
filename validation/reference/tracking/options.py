"""Options of the front tracking."""

from __future__ import annotations

from dataclasses import dataclass

from scene.errors import SceneError, number

RESOLUTION = 20
TOLERANCE = 1e-5


@dataclass(frozen=True)
class Options:
    """How finely to step, what to report.

    Parameters
    ----------
    resolution : int, optional
        Steps in which the edge crosses one process zone, at least; 4 or more. Default 20 at the default
        tolerance, and as the root of the tolerance otherwise.
    tolerance : float, optional
        Largest deviation of force and radius from a straight line within a step, relative to the largest
        value so far. Default 1e-5 at the default resolution, and as its square otherwise.
    profile_times : tuple of float
        Times at which surface profiles are returned; stepped onto exactly, ignored outside the run.
    max_steps : int
        Budget of accepted and rejected steps.
    estimate_errors : bool
        Run once more at four times the tolerance and half the resolution, and put relative differences
        into ``Trace.errors``.
    """

    resolution: int | None = None
    tolerance: float | None = None
    profile_times: tuple[float, ...] = ()
    max_steps: int = 200_000
    estimate_errors: bool = False

    def __post_init__(self) -> None:
        if self.resolution is not None and (
            isinstance(self.resolution, bool)
            or self.resolution != int(self.resolution)
            or self.resolution < 4
        ):
            raise SceneError("resolution", f"got {self.resolution!r:.40}", "a whole number >= 4")
        if self.tolerance is not None:
            number(self.tolerance, "tolerance", "0 < tolerance < 1", low=0.0, high=1.0, open_low=True)
        if self.max_steps < 1:
            raise SceneError("max_steps", f"got {self.max_steps}", "a whole number >= 1")
        object.__setattr__(self, "profile_times", tuple(float(t) for t in self.profile_times))

    @property
    def divisions(self) -> float:
        """Steps per process zone."""
        if self.resolution is not None:
            return float(self.resolution)
        return max(4.0, RESOLUTION * (TOLERANCE / self.deviation) ** 0.5)

    @property
    def deviation(self) -> float:
        """Largest deviation from a straight line within a step."""
        if self.tolerance is not None:
            return self.tolerance
        return TOLERANCE * (RESOLUTION / self.divisions) ** 2 if self.resolution is not None else TOLERANCE
