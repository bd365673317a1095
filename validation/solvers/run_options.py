"""What may be asked of a run of any solver, beside the scene and the resolution."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from contact_scene import RunMonitor
from contact_scene.run_control import whole_number
from contact_scene.value_checks import as_tuple, finite, function_or_none, positive, true_or_false

Progress = Callable[[float], None]
"""Called with the share of the loading that is done, 0 to 1."""


@dataclass(frozen=True)
class RunOptions:
    """What may be requested of any solver beside the resolution.

    Parameters
    ----------
    step_tolerance : float, optional
        Tolerance of the time steps, relative; what it bounds, and its default, are the solver's own.
    stop_times : tuple of float
        Times that are stepped onto exactly.
    profile_times : tuple of float
        Times that are stepped onto exactly and give a surface profile each.
    max_steps : int, optional
        Largest number of steps, accepted and rejected together; by default
        :func:`~validation.solvers.base.step_budget`.
    progress : callable, optional
        Called with the share of the loading that is done, 0 to 1.
    monitor : RunMonitor, optional
        Stops the run between two steps, or has it continued.
    estimate_errors : bool
        Put error estimates into ``Trace.errors``, if the solver makes its own.
    """

    step_tolerance: float | None = None
    stop_times: tuple[float, ...] = ()
    profile_times: tuple[float, ...] = ()
    max_steps: int | None = None
    progress: Progress | None = None
    monitor: RunMonitor | None = None
    estimate_errors: bool = False

    def __post_init__(self) -> None:
        if self.step_tolerance is not None:
            object.__setattr__(self, "step_tolerance", positive(self.step_tolerance, "step_tolerance"))
        for key in ("stop_times", "profile_times"):
            times = as_tuple(getattr(self, key), key, "several times")
            checked = tuple(finite(time, f"{key}[{index}]") for index, time in enumerate(times))
            object.__setattr__(self, key, checked)
        if self.max_steps is not None:
            object.__setattr__(self, "max_steps", whole_number(self.max_steps, "max_steps", 1))
        function_or_none(self.progress, "progress", "the share that is done")
        function_or_none(self.monitor, "monitor", "nothing, and says whether the run is to continue")
        true_or_false(self.estimate_errors, "estimate_errors")

    @property
    def of_solver(self) -> dict[str, Any]:
        """Keywords that the options of every solver have in common."""
        return {
            "tolerance": self.step_tolerance,
            "stop_times": self.stop_times,
            "profile_times": self.profile_times,
            **specified(max_steps=self.max_steps),
        }


def specified(**options: Any) -> dict[str, Any]:
    """The options that are not ``None``; the others keep the solver's default."""
    return {name: value for name, value in options.items() if value is not None}
