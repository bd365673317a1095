"""Options of the front tracking."""

from __future__ import annotations

from dataclasses import dataclass

from contact_scene.errors import SceneError, number

RESOLUTION = {True: 16.0, False: 4.0}  # with and without adhesion
TOLERANCE = 1e-5


@dataclass(frozen=True)
class Options:
    """How finely to step, what to report.

    Parameters
    ----------
    resolution : int, optional
        Steps, at least, in which the edge crosses one process zone (without adhesion: one hundredth of the
        largest contact radius); 4 or more. Default 16 (without adhesion 4) at the default tolerance, and
        otherwise falling with its root.
    tolerance : float, optional
        How far the radius may be from where the rows before pointed, and about how far force and radius may
        leave the straight line between rows, relative to the largest value so far. Default 1e-5 at the
        default resolution, and otherwise falling with its square.
    stop_times : tuple of float
        Times stepped onto exactly.
    profile_times : tuple of float
        Times at which surface profiles are returned; stepped onto exactly, ignored outside the run.
    max_steps : int
        Budget of accepted and rejected steps.
    estimate_errors : bool
        Run a second time at half the resolution and four times the tolerance, and put estimates of the
        relative errors into ``Trace.errors``.
    """

    resolution: int | None = None
    tolerance: float | None = None
    stop_times: tuple[float, ...] = ()
    profile_times: tuple[float, ...] = ()
    max_steps: int = 200_000
    estimate_errors: bool = False

    def __post_init__(self) -> None:
        if self.resolution is not None:
            number(self.resolution, "resolution", "a whole number >= 4", low=4)
            if self.resolution != int(self.resolution):
                raise SceneError("resolution", f"got {self.resolution}", "a whole number >= 4")
        if self.tolerance is not None:
            number(self.tolerance, "tolerance", "0 < tolerance < 1", low=0.0, high=1.0, open_low=True)
        number(self.max_steps, "max_steps", "a whole number >= 1", low=1)
        for name in ("stop_times", "profile_times"):
            object.__setattr__(self, name, tuple(float(t) for t in getattr(self, name)))

    def fineness(self, adhesive: bool) -> Fineness:
        """The two numbers the stepping works with."""
        usual = RESOLUTION[adhesive]
        if self.resolution is not None:
            divisions = float(self.resolution)
        else:
            divisions = usual * (TOLERANCE / self.tolerance) ** 0.5 if self.tolerance is not None else usual
        if self.tolerance is not None:
            return Fineness(divisions, self.tolerance)
        return Fineness(divisions, TOLERANCE * (usual / divisions) ** 2)


@dataclass(frozen=True)
class Fineness:
    """Steps per zone, and largest relative deviation from a straight line within a step."""

    divisions: float
    deviation: float

    def coarser(self) -> Fineness:
        """Twice the step."""
        return Fineness(0.5 * self.divisions, 4.0 * self.deviation)
