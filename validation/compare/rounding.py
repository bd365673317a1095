"""What rounding does to whole runs: two reports on the same scenes, from other kernels, threads or machines.

    python -m validation.compare.rounding out/report out/report-haswell

The last bit of a dot product belongs to the processor. Two runs that take the same decisions have the same
rows and agree to ``SAME`` in every column. Where a decision flips (a step accepted here and rejected there)
the rows differ, and the runs are compared as curves and by their scalars: within ``SHARE`` of the error
estimate of the first, or rounding is magnified to what a reader would take for an answer. Exit code 1 if a
run lies further apart, ends otherwise or is missing.
"""

from __future__ import annotations

import sys
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from contact_scene import SceneError, Trace
from validation.execution.run_folder import read_run
from validation.execution.runs import Run
from validation.measure.norms import distance
from validation.measure.scaling import Magnitudes

SAME = 1e-9
"""Largest difference of columns of the same rows, relative to the largest magnitude of the column (of all
energies for an energy): a thousandth of what step control and Newton iterations leave unresolved."""
SHARE = 0.1
"""Largest difference of runs that took other decisions, relative to the error estimate: what moves by
rounding must not show in the error."""
ENERGIES = (
    "stored_energy",
    "external_work",
    "dissipated_energy",
    "branch_dissipation",
    "zone_excess",
    "balance_residual",
)
"""Columns that are terms of one balance: a small one is a difference of large ones."""


@dataclass(frozen=True)
class RoundingEffect:
    """How far two runs of one solver on one scene lie apart.

    Parameters
    ----------
    scene, solver : str
    same_rows : bool
        Whether both took the same decisions.
    quantity : str
        The column or scalar that is worst.
    share : float
        Its difference over the one allowed; infinite where there is nothing to compare.
    """

    scene: str
    solver: str
    same_rows: bool
    quantity: str
    share: float

    @property
    def passed(self) -> bool:
        """Whether rounding is not magnified."""
        return self.share <= 1.0


def effects(first: Path, second: Path) -> list[RoundingEffect]:
    """Every run of the first report against the same of the second.

    Raises
    ------
    SceneError
        If a run cannot be read.
    """
    found = []
    for folder in sorted((first / "runs").glob("*/*")):
        scene, solver = folder.parent.name, folder.name
        other = second / "runs" / scene / solver
        if not (folder / "trace.csv").exists() and not (other / "trace.csv").exists():
            continue  # refused by both
        if not (folder / "trace.csv").exists() or not (other / "trace.csv").exists():
            found.append(RoundingEffect(scene, solver, False, "run", np.inf))
            continue
        found.append(effect(scene, read_run(folder)[1], read_run(other)[1]))
    return found


def effect(scene: str, run: Run, other: Run) -> RoundingEffect:
    """Two runs that differ by rounding."""
    one, two = run.trace, other.trace
    if one is None or two is None or one.outcome.kind is not two.outcome.kind:
        return RoundingEffect(scene, run.solver, False, "outcome", np.inf)
    if len(one) == len(two):
        apart = {name: value / SAME for name, value in _columns(one, two)}
        worst = max(apart, key=lambda name: apart[name])
        if apart[worst] <= 1.0:
            return RoundingEffect(scene, run.solver, True, worst, apart[worst])
    apart = {name: value / SHARE for name, value in _over_estimates(run, other)}
    worst = max(apart, key=lambda name: apart[name], default="no error estimate")
    return RoundingEffect(scene, run.solver, False, worst, apart.get(worst, np.inf))


def _columns(one: Trace, two: Trace) -> Iterator[tuple[str, float]]:
    """Largest relative difference of each column of the same rows."""
    first, second = one.columns(), two.columns()
    energy = max(float(np.abs(first[name]).max()) for name in ENERGIES if name in first)
    for name, column in first.items():
        scale = energy if name in ENERGIES else float(np.abs(column).max())
        apart = float(np.abs(second[name] - column).max()) if name in second else np.inf
        yield name, apart / scale if scale > 0.0 else apart


def _over_estimates(run: Run, other: Run) -> Iterator[tuple[str, float]]:
    """Differences of curves and scalars that have an error estimate, relative to it."""
    one, two = run.trace, other.trace
    if one is None or two is None:
        return
    largest = Magnitudes.of_trace(one)
    for name, error in run.errors.items():
        if name in one.columns():
            apart = distance(two, one, name)
            difference = np.inf if apart is None else apart.rms
        elif name in run.measures:
            value, there = run.measures[name], other.measures.get(name)
            scale = 0.0 if value is None else largest.scale(name, value)
            difference = np.inf if value is None or there is None else abs(there - value) / (scale or 1.0)
        else:
            continue
        if difference <= SAME:  # a prescribed quantity has an error of rounding alone
            yield name, 0.0
        else:
            yield name, difference / error if error > 0.0 else np.inf


def main(folders: list[str]) -> int:
    """Compare two reports and print what rounding does; the exit code."""
    if len(folders) != 2:
        print("usage: python -m validation.compare.rounding REPORT REPORT", file=sys.stderr)
        return 2
    try:
        found = effects(*map(Path, folders))
    except SceneError as error:
        print(f"error: {error}", file=sys.stderr)
        return 2
    if not found:
        print(f"error: {folders[0]} holds no runs; allowed: the folder of a report", file=sys.stderr)
        return 2
    flipped = [one for one in found if not one.same_rows]
    for one in sorted(flipped, key=lambda one: -one.share):
        verdict = "other decisions" if one.passed else "FAILED"
        print(f"{verdict}: {one.scene}: {one.solver}: {one.quantity}: {one.share:.2g} of what is allowed")
    same = max((one.share * SAME for one in found if one.same_rows), default=0.0)
    failed = [one for one in found if not one.passed]
    print(f"{len(found)} runs, {len(found) - len(flipped)} with the same rows, apart by at most {same:.1e}")
    print(f"{len(flipped)} with other decisions, {len(failed)} further apart than rounding may bring them")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
