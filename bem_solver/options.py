"""What may be chosen about a boundary-element run."""

from __future__ import annotations

from dataclasses import dataclass

from contact_scene import SceneError
from contact_scene.errors import number, one_of, positive

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
    annuli : "graded" or "uniform"
        Annuli that travel with a continuous edge, or the paper's fixed ones with the edge on their borders.
    scheme : "exponential" or "backward-euler"
        Exact exponential recursion, or the paper's scheme.
    stop_times : tuple of float
        Times stepped onto exactly, ignored outside the run.
    profile_times : tuple of float
        Times at which the state of the surface is kept; stepped onto exactly, ignored outside the run.
    step : float, optional
        Fixed time step of the uniform annuli. Default, for each piece of loading: 1/(4 resolution) of the
        shortest of the time to travel a process zone at the fastest loading, the time to sweep the range of
        the loading, and the shortest relaxation time (not less than a thousandth of the piece).
    max_steps : int
        Step budget; a run that exceeds it ends with that outcome.
    """

    resolution: int | None = None
    tolerance: float | None = None
    annuli: str = "graded"
    scheme: str = "exponential"
    stop_times: tuple[float, ...] = ()
    profile_times: tuple[float, ...] = ()
    step: float | None = None
    max_steps: int = 200_000

    def __post_init__(self) -> None:
        if self.resolution is not None:
            if isinstance(self.resolution, bool) or not isinstance(self.resolution, int):
                raise SceneError("resolution", f"got {self.resolution!r:.40}", "a whole number >= 4")
            number(self.resolution, "resolution", "a whole number from 4 to 1000", low=4, high=1000)
        if self.tolerance is not None:
            number(self.tolerance, "tolerance", "0 < tolerance <= 1", low=0.0, high=1.0, open_low=True)
        if self.step is not None:
            positive(self.step, "step")
        one_of(self.annuli, "annuli", ANNULI)
        one_of(self.scheme, "scheme", SCHEMES)
        for time in (*self.stop_times, *self.profile_times):
            number(time, "profile_times", "finite times")
        if self.max_steps < 1:
            raise SceneError("max_steps", f"got {self.max_steps}", "a whole number >= 1")

    @property
    def divisions(self) -> int:
        """The resolution to use."""
        return self.resolution or DEFAULT_RESOLUTION

    @property
    def step_tolerance(self) -> float:
        """The tolerance to use."""
        return self.tolerance if self.tolerance is not None else 0.64 / self.divisions**2
