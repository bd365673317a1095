"""Numerical options of the finite-element solver, beside the scene and the mesh."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from contact_scene.run_control import MAX_STEPS, moments, whole_number
from contact_scene.value_checks import number, one_of

DEFAULT_TOLERANCE = 1e-3
"""Relative accuracy of the force in time where the options ask for none."""


@dataclass(frozen=True)
class Options:
    """Numerical choices; the mesh carries the spatial ones.

    Parameters
    ----------
    tolerance : float, optional
        Relative accuracy of the force in time, between 0 and 1; default ``DEFAULT_TOLERANCE``.
    stop_times : tuple of float
        Times stepped onto exactly.
    profile_times : tuple of float
        Times, stepped onto exactly, at which surface profiles are returned.
    max_steps : int
        Trial steps, accepted and rejected together, after which the run ends.
    form : "mixed" or "displacement"
        Displacement and pressure, or displacement alone (which locks towards ``nu = 0.5``).
    far_field : bool
        Prescribe the displacement of the total force on the far boundary; otherwise hold it.
    record_times : tuple of float
        Times, stepped onto exactly, whose rows fields in the body will be asked for.
    record : bool
        Record the surface at all rows, which those times alone do as well.

    Raises
    ------
    SceneError
        If an option is out of its range.
    """

    tolerance: float | None = None
    stop_times: tuple[float, ...] = ()
    profile_times: tuple[float, ...] = ()
    max_steps: int = MAX_STEPS
    form: Literal["mixed", "displacement"] = "mixed"
    far_field: bool = True
    record_times: tuple[float, ...] = ()
    record: bool = False

    def __post_init__(self) -> None:
        checked = {
            "stop_times": moments(self.stop_times, "stop_times"),
            "profile_times": moments(self.profile_times, "profile_times"),
            "record_times": moments(self.record_times, "record_times"),
            "max_steps": whole_number(self.max_steps, "max_steps", 1),
        }
        if self.tolerance is not None:
            allowed = "a number between 0 and 1"
            number(self.tolerance, "tolerance", allowed, low=0.0, high=1.0, open=True)
        one_of(self.form, "form", ("mixed", "displacement"))
        for name, value in checked.items():
            object.__setattr__(self, name, value)

    @property
    def records(self) -> bool:
        """Whether the surface is recorded."""
        return self.record or bool(self.record_times)

    @property
    def requested_times(self) -> frozenset[float]:
        """All times that are stepped onto."""
        return frozenset((*self.stop_times, *self.profile_times, *self.record_times))
