"""What is asked of a fit: the numbers to vary, the method, the second solver."""

from __future__ import annotations

from dataclasses import dataclass

from contact_scene import SceneError
from contact_scene.errors import shown
from contact_scene.run_control import whole_number
from contact_scene.value_checks import not_negative, positive
from validation.fits.parameters import INSTRUMENT
from validation.solvers import REFERENCE

REGULARISATION = 0.1
"""Weight of the squared second differences of the logarithms of Prony weights, beside squares of residuals:
neighbours on the grid may bend by a factor of exp(3) at the cost of one standard deviation."""


@dataclass(frozen=True)
class FitSettings:
    """What to fit and how.

    Parameters
    ----------
    vary : tuple of str
        ``PATH`` or ``PATH=LOW:HIGH[:linear]``, each a number of the scene.
    tie : tuple of str
        ``PATH=OTHER``: the first keeps its ratio to the second, which is varied.
    per_curve : tuple of str
        Like ``vary``, with a value of its own for each curve.
    free : tuple of str
        Of ``contact_point``, ``baseline``, ``drift``, ``time_offset``, one for each curve.
    prony : tuple of float
        Relaxation times of a fixed grid: their moduli are varied, in place of the scene's branches.
    regularisation : float
        Weight of the bending of the Prony weights.
    starts, seed : int
        Starts of the search, and the seed of those that are drawn.
    profile : tuple of str
        Parameters whose profile likelihood is worked out, or ``all``.
    solver : str
    resolution : int or None
        ``None``: of the reference the coarsest steps whose error is a twentieth of the noise; of others their
        own choice.
    check_solver : str or None
        The second solver; ``None``: none.
    max_steps : int or None
        Of every run, accepted and rejected together; ``None``: the solver's own bound.
    """

    vary: tuple[str, ...] = ()
    tie: tuple[str, ...] = ()
    per_curve: tuple[str, ...] = ()
    free: tuple[str, ...] = ()
    prony: tuple[float, ...] = ()
    regularisation: float = REGULARISATION
    starts: int = 3
    seed: int = 0
    profile: tuple[str, ...] = ()
    solver: str = REFERENCE
    resolution: int | None = None
    check_solver: str | None = "bem"
    max_steps: int | None = None

    def __post_init__(self) -> None:
        for name in ("vary", "tie", "per_curve", "free", "profile"):
            given = getattr(self, name)
            if isinstance(given, str) or not all(isinstance(one, str) for one in given):
                raise SceneError(name, f"got {shown(given)}", "several names")
            object.__setattr__(self, name, tuple(given))
        for name in self.free:
            if name not in INSTRUMENT:
                raise SceneError("free", f"got {shown(name)}", ", ".join(INSTRUMENT))
        times = tuple(positive(value, "prony") for value in self.prony)
        object.__setattr__(self, "prony", times)
        if list(times) != sorted(set(times)):
            raise SceneError("prony", f"got {shown(times)}", "rising relaxation times")
        not_negative(self.regularisation, "regularisation")
        whole_number(self.starts, "starts", 1)
        whole_number(self.seed, "seed", 0)
        if self.max_steps is not None:
            object.__setattr__(self, "max_steps", whole_number(self.max_steps, "max_steps", 1))
