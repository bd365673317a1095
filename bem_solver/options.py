"""Options of a boundary-element run."""

from __future__ import annotations

from dataclasses import dataclass

from contact_scene.run_control import MAX_STEPS, moments, whole_number
from contact_scene.value_checks import SMALLEST, number, one_of, positive

ANNULI = ("graded", "uniform")
SCHEMES = ("exponential", "backward-euler")
DEFAULT_RESOLUTION = 12


@dataclass(frozen=True)
class Options:
    """Options of :func:`bem_solver.solve`.

    Parameters
    ----------
    resolution : int, optional
        Annuli within the process zone (within the outer hundredth of the largest contact radius, without
        adhesion) at the largest contact radius, >= 4. Default 12. Uniform annuli without adhesion have a
        tenth of that: their width is the largest contact radius/(10 resolution).
    tolerance : float, optional
        Step tolerance: error of extrapolating the edge over a step, in process zones (in twentieths of the
        contact radius, without adhesion), and of the force relative to its scale. Default
        ``0.64/resolution**2``, so that refining one refines the other.
    stop_times : tuple of float
        Times stepped onto exactly; ignored outside the run.
    profile_times : tuple of float
        The same, and the trace has a profile of the surface there.
    max_steps : int
        Budget of trial steps, accepted and rejected; a run that exhausts it ends with that outcome.
    annuli : "graded" or "uniform"
        Annuli that move with a continuous edge, or the paper's fixed ones with the edge on their borders.
    scheme : "exponential" or "backward-euler"
        Exact exponential recursion, or the paper's scheme.
    step : float, optional
        Fixed time step of the uniform annuli. Default, for each loading interval: 1/(4 resolution) of the
        shortest of the time to travel a process zone at the fastest loading, the time to sweep the range of
        the loading, and the shortest relaxation time (not less than a thousandth of the interval).
    """

    resolution: int | None = None
    tolerance: float | None = None
    stop_times: tuple[float, ...] = ()
    profile_times: tuple[float, ...] = ()
    max_steps: int = MAX_STEPS
    annuli: str = "graded"
    scheme: str = "exponential"
    step: float | None = None

    def __post_init__(self) -> None:
        if self.resolution is not None:
            number(self.resolution, "resolution", "a whole number from 4 to 1000", high=1000)
            object.__setattr__(self, "resolution", whole_number(self.resolution, "resolution", 4))
        if self.tolerance is not None:
            number(self.tolerance, "tolerance", "0 < tolerance <= 1", low=SMALLEST, high=1.0)
        if self.step is not None:
            positive(self.step, "step")
        one_of(self.annuli, "annuli", ANNULI)
        one_of(self.scheme, "scheme", SCHEMES)
        object.__setattr__(self, "stop_times", moments(self.stop_times, "stop_times"))
        object.__setattr__(self, "profile_times", moments(self.profile_times, "profile_times"))
        object.__setattr__(self, "max_steps", whole_number(self.max_steps, "max_steps", 1))

    @property
    def divisions(self) -> int:
        """The resolution to use."""
        return self.resolution or DEFAULT_RESOLUTION

    @property
    def step_tolerance(self) -> float:
        """The tolerance to use."""
        return self.tolerance if self.tolerance is not None else 0.64 / self.divisions**2
