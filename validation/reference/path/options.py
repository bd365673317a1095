"""Options of the reference."""

from __future__ import annotations

from dataclasses import dataclass

from contact_scene.run_control import MAX_STEPS, moments, whole_number
from contact_scene.value_checks import number

DEFAULT_RESOLUTION = 16
"""Resolution of the default tolerance."""
DEFAULT_TOLERANCE = 1e-5
"""Misprediction of a step, in a tenth of the largest radius or in the time since the leg began."""


@dataclass(frozen=True)
class Options:
    """How finely to step, and what to report.

    Parameters
    ----------
    resolution : int, optional
        Another word for the tolerance, which falls with its square; 1 or more. Default 16.
    tolerance : float, optional
        How far a step may be mispredicted along the path of the edge, relative to the scales that the path
        has there, and how far force and radius may leave the straight line between rows, relative to the
        largest. Default 1e-5.
    stop_times, profile_times : tuple of float
        Times that get a row, and those at which surface profiles are returned, too; ignored outside the run.
        No other number depends on them.
    max_steps : int
        Budget of accepted and rejected steps.
    estimate_errors : bool
        Run a second time at ten times the tolerance, and put estimates of the relative errors into
        ``Trace.errors``.

    Raises
    ------
    SceneError
        If an option is not what it has to be.
    """

    resolution: int | None = None
    tolerance: float | None = None
    stop_times: tuple[float, ...] = ()
    profile_times: tuple[float, ...] = ()
    max_steps: int = MAX_STEPS
    estimate_errors: bool = False

    def __post_init__(self) -> None:
        if self.resolution is not None:
            object.__setattr__(self, "resolution", whole_number(self.resolution, "resolution", 1))
        if self.tolerance is not None:
            number(self.tolerance, "tolerance", "0 < tolerance < 1", low=0.0, high=1.0, open=True)
        object.__setattr__(self, "max_steps", whole_number(self.max_steps, "max_steps", 1))
        object.__setattr__(self, "stop_times", moments(self.stop_times, "stop_times"))
        object.__setattr__(self, "profile_times", moments(self.profile_times, "profile_times"))

    @property
    def step_tolerance(self) -> float:
        """The tolerance that is asked for, in one way or the other."""
        if self.tolerance is not None:
            return self.tolerance
        return DEFAULT_TOLERANCE * (DEFAULT_RESOLUTION / (self.resolution or DEFAULT_RESOLUTION)) ** 2
