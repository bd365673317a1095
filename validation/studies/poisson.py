"""How good is a constant Poisson's ratio? A scene with elastic bulk, against bulk and shear alike.

For every ratio ``K/G`` of the relaxed solid the scene keeps its shear relaxation and is run

- in full, with nu(t) from separate bulk and shear, by the finite elements (over short zones by the modulus of
  the surface as well, from eigenvalues of their own);
- by the reference with the ``E*(t)`` the surface feels (see ``poisson_material``): the same problem, another
  method, so the two must agree within their error estimates, which is checked;
- under three assumptions of a constant ratio, by the reference: ``shear`` and ``tension``, the relaxed ratio
  with the modulus measured in shear or in tension, and ``incompressible``, the paper's 0.5.

What an assumption costs is its difference from the second of these, reported beside the estimates.
"""

from __future__ import annotations

from collections.abc import Iterable
from concurrent.futures import Executor
from dataclasses import dataclass, replace

from validation.cases import Case
from validation.measure.difference import Difference, of_curves, of_numbers
from validation.measure.norms import CURVES
from validation.runs.pool import TellProgress, run_of, run_task, run_tasks
from validation.runs.run import Run
from validation.runs.store import Store
from validation.solvers import REFERENCE
from validation.solvers.finite_elements import FiniteElements
from validation.studies import poisson_material as materials

RATIOS = (10.0, 30.0, 100.0, 300.0, 1000.0)
"""``K/G`` of the relaxed solid."""
OBSERVED = ("pull_off_force", "loop_energy", "approach_radius", "approach_force")
FULL, SURFACE = "full", "surface"
"""Names of the runs with separate bulk relaxation and with the modulus at the surface."""
ASSUMPTIONS = {
    "shear": materials.constant,
    "tension": materials.tension,
    "incompressible": materials.incompressible,
}


@dataclass(frozen=True)
class CompressibilityComparison:
    """One compressibility.

    Parameters
    ----------
    ratio : float
        ``K/G`` of the relaxed solid.
    initial, final : float
        Poisson's ratio at first and in the end.
    runs : dict of str to Run
        ``full``, ``surface`` and the assumptions by name.
    """

    ratio: float
    initial: float
    final: float
    runs: dict[str, Run]

    @property
    def finished(self) -> bool:
        """Whether every run reached its end."""
        return all(result.finished for result in self.runs.values())

    def difference(self, name: str, observable: str) -> Difference | None:
        """Of a run by name, in an observable or (root mean square over time) a column of the trace."""
        result, base = self.runs[name], self.runs[SURFACE]
        found = (*of_curves(result, base), *of_numbers(result, base, OBSERVED))
        return next((one for one in found if one.quantity == observable and not one.missing), None)

    @property
    def disagreements(self) -> list[str]:
        """Observables in which the full path is not where the surface modulus says, beyond the estimates."""
        differences = (self.difference(FULL, name) for name in (*OBSERVED, *CURVES))
        known = [(one, (one.own or 0.0) + (one.known_to or 0.0)) for one in differences if one is not None]
        return [one.quantity for one, estimates in known if abs(one.error) > estimates]


def ratio_runs(case: Case, ratio: float) -> dict[str, tuple[Case, str]]:
    """Runs of one compressibility: case and solver by name."""
    separate = materials.with_bulk(case.scene.material, ratio)
    answers = {
        FULL: (separate, FiniteElements.name),
        SURFACE: (materials.on_the_surface(separate), REFERENCE),
    }
    answers |= {name: (assume(separate), REFERENCE) for name, assume in ASSUMPTIONS.items()}
    return {
        name: (replace(case, scene=replace(case.scene, material=material)), solver)
        for name, (material, solver) in answers.items()
    }


def compare_ratios(
    case: Case,
    ratios: Iterable[float] = RATIOS,
    resolution: int | None = None,
    executor: Executor | None = None,
    progress: TellProgress | None = None,
    store: Store | None = None,
    max_steps: int | None = None,
) -> list[CompressibilityComparison]:
    """Run everything, for every ratio.

    Parameters
    ----------
    case : Case
    ratios : iterable of float
        ``K/G`` of the relaxed solid.
    resolution : int or None
        Divisions per process zone of the finite elements.
    executor, progress, store
        As of :func:`~validation.runs.pool.run_tasks`.
    max_steps : int or None
        Of every run; ``None``: the solver's own bound.

    Returns
    -------
    list of CompressibilityComparison
        In the order of ``ratios``.

    Raises
    ------
    SceneError
        If a ratio ``K/G`` is not above 2/3 (a negative Poisson's ratio).
    """
    named = {ratio: ratio_runs(case, ratio) for ratio in ratios}
    tasks = [
        replace(
            run_task(of, solver, resolution if name == FULL else None, estimate=True, max_steps=max_steps),
            label=f"K/G = {ratio:g}: {name}",
        )
        for ratio, pairs in named.items()
        for name, (of, solver) in pairs.items()
    ]
    runs = map(run_of, run_tasks(tasks, executor, store, progress))
    comparisons = []
    for ratio, pairs in named.items():
        initial, final = materials.poisson_range(pairs[FULL][0].scene.material)
        comparisons.append(
            CompressibilityComparison(ratio, initial, final, {name: next(runs) for name in pairs})
        )
    return comparisons
