"""Options of the front tracking."""

from __future__ import annotations

from dataclasses import dataclass

from contact_scene.run_control import MAX_STEPS, moments, whole_number
from contact_scene.value_checks import number

DEFAULT_RESOLUTION = {True: 16.0, False: 4.0}
"""Steps per process zone with adhesion (``True``), per hundredth of the largest radius without."""
DEFAULT_TOLERANCE = 1e-5
"""Relative deviation allowed in a step at the default resolution."""


@dataclass(frozen=True)
class Options:
    """How finely to step, and what to report.

    Parameters
    ----------
    resolution : int, optional
        Steps, at least, in which the edge crosses one process zone (without adhesion: one hundredth of the
        largest contact radius); 4 or more. Default 16 (without adhesion 4) at the default tolerance, and
        otherwise falling with its root.
    tolerance : float, optional
        How far the radius may be from the extrapolation of the rows before, and about how far force and
        radius may leave the straight line between rows, relative to the largest value so far. Default 1e-5
        at the default resolution, and otherwise falling with its square.
    stop_times : tuple of float
        Times that are stepped onto exactly; ignored outside the run.
    profile_times : tuple of float
        Times that are stepped onto exactly and at which surface profiles are returned.
    max_steps : int
        Budget of accepted and rejected steps.
    estimate_errors : bool
        Run a second time at half the resolution and four times the tolerance, and put estimates of the
        relative errors into ``Trace.errors``.

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
            object.__setattr__(self, "resolution", whole_number(self.resolution, "resolution", 4))
        if self.tolerance is not None:
            number(self.tolerance, "tolerance", "0 < tolerance < 1", low=0.0, high=1.0, open=True)
        object.__setattr__(self, "max_steps", whole_number(self.max_steps, "max_steps", 1))
        object.__setattr__(self, "stop_times", moments(self.stop_times, "stop_times"))
        object.__setattr__(self, "profile_times", moments(self.profile_times, "profile_times"))

    def fineness(self, adhesive: bool) -> Fineness:
        """Step sizes and tolerance that these options ask for."""
        usual = DEFAULT_RESOLUTION[adhesive]
        if self.resolution is not None:
            divisions = float(self.resolution)
        else:
            divisions = (
                usual * (DEFAULT_TOLERANCE / self.tolerance) ** 0.5 if self.tolerance is not None else usual
            )
        if self.tolerance is not None:
            return Fineness(divisions, self.tolerance)
        return Fineness(divisions, DEFAULT_TOLERANCE * (usual / divisions) ** 2)


@dataclass(frozen=True)
class Fineness:
    """Steps per process zone, and the relative deviation allowed in a step.

    ``first_share``: the first step after a kink, in parts of the time to the next, at most. Between the rows
    of a table nothing else tells a coarser run from a finer one.
    """

    divisions: float
    deviation: float
    first_share: float = 1e-2

    def coarser(self) -> Fineness:
        """Twice the step."""
        return Fineness(0.5 * self.divisions, 4.0 * self.deviation, 2.0 * self.first_share)
