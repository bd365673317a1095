"""What may be asked of the finite-element solver beyond the scene and the mesh."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

DEFAULT_TOLERANCE = 1e-3


@dataclass(frozen=True)
class Options:
    """Numerical choices; the mesh carries the spatial ones.

    Parameters
    ----------
    resolution : int, optional
        Divisions per process zone that the time steps resolve: in one step the edge moves by at most half a
        division. Default: the elements of the mesh.
    tolerance : float, optional
        Asked relative accuracy of the force in time; default 1e-3.
    stop_times : tuple of float
        Times stepped onto exactly.
    profile_times : tuple of float
        Times, stepped onto exactly, at which surface profiles are returned.
    max_steps : int
        Budget of accepted steps.
    form : "mixed" or "displacement"
        Displacement and pressure, or displacement alone (which locks towards ``nu = 0.5``).
    path : "auto", "condensed" or "quadrature"
        Where the history lives: on the surface (constant Poisson's ratio only) or at quadrature points.
    far_field : bool
        Prescribe the displacement of the total force on the far boundary; otherwise hold it.
    record_times : tuple of float
        Times, stepped onto exactly, at which the whole history is kept for fields in the body.
    record_every : int
        Keep it at every n-th row as well; 0: no.
    record_rows : tuple of int
        Keep it at these rows as well: a run of the same scene, mesh and options has the same rows.
    record_pull_off : bool
        Keep it where the tension is largest as well.
    """

    resolution: int | None = None
    tolerance: float | None = None
    stop_times: tuple[float, ...] = ()
    profile_times: tuple[float, ...] = ()
    max_steps: int = 50_000
    form: Literal["mixed", "displacement"] = "mixed"
    path: Literal["auto", "condensed", "quadrature"] = "auto"
    far_field: bool = True
    record_times: tuple[float, ...] = ()
    record_every: int = 0
    record_rows: tuple[int, ...] = ()
    record_pull_off: bool = False

    @property
    def records(self) -> bool:
        """Whether any history is to be kept."""
        asked = self.record_times or self.record_rows or self.record_every
        return bool(asked) or self.record_pull_off

    def __post_init__(self) -> None:
        if self.resolution is not None and self.resolution < 1:
            raise ValueError(f"resolution = {self.resolution}: must be a whole number >= 1")
        if self.tolerance is not None and not 0.0 < self.tolerance < 1.0:
            raise ValueError(f"tolerance = {self.tolerance}: must be between 0 and 1")
        if self.max_steps < 1:
            raise ValueError(f"max_steps = {self.max_steps}: must be >= 1")
        if self.record_every < 0:
            raise ValueError(f"record_every = {self.record_every}: must be a whole number >= 0")
        for name, allowed in (
            ("form", ("mixed", "displacement")),
            ("path", ("auto", "condensed", "quadrature")),
        ):
            if getattr(self, name) not in allowed:
                raise ValueError(f"{name} = {getattr(self, name)!r}: must be one of {', '.join(allowed)}")
