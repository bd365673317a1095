"""How far the runs of two reports lie apart, over what may lie between them.

    python -m benchmarks.reports_apart OLD NEW --within estimates|rounding|checks

``estimates``: the error estimates of both runs, what a change of the method may move. ``rounding``: a tenth
of the first run's estimate, for reports by other kernels of the linear algebra, threads or machines: the last
bit of a dot product belongs to the processor, and where a decision flips (a step accepted here and rejected
there) the rows differ, but the answer must not show it. ``checks``: the tolerances of the scene's checks,
those of ``crosscontact report --baseline``, which also compares verdicts, endings and work. Exit code 1 if a
run lies further apart, ends otherwise or is missing.
"""

from __future__ import annotations

import argparse
import math
import sys
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path

from contact_scene import SceneError
from validation import cases
from validation.measure.curves import CURVES
from validation.measure.difference import of_curves, of_numbers
from validation.measure.scaling import Magnitudes
from validation.runs.run import Run, read_run

SAME = 1e-9
"""Relative difference that is none: a thousandth of what step control and Newton iterations leave open."""
SHARE = 0.1
"""Of the error estimate, that rounding may move: it must not show in the error."""


def differences(run: Run, other: Run) -> Iterator[tuple[str, float]]:
    """Relative difference of every curve (RMS) and scalar of which the first run estimates the error."""
    one, two = run.trace, other.trace
    assert one is not None
    assert two is not None
    if len(one) == len(two) == 1:  # an equilibrium has no curve
        sizes = Magnitudes.of_trace(one).columns
        pairs = {name: (one.columns()[name][0], two.columns()[name][0]) for name in CURVES}
        curves = {name: abs(b - a) / (sizes[name] or 1.0) for name, (a, b) in pairs.items()}
    else:
        curves = {found.quantity: found.error for found in of_curves(other, run)}
    yield from ((name, curves[name]) for name in CURVES if name in (run.errors or CURVES))
    known = [name for name in run.errors if run.measures.get(name) is not None]
    yield from ((found.quantity, abs(found.error)) for found in of_numbers(other, run, known))


def _of_checks(run: Run, other: Run, name: str) -> float | None:
    return cases.load(run.scene).tolerance(run.solver, name)


TOLERANCES: dict[str, Callable[[Run, Run, str], float | None]] = {
    "estimates": lambda run, other, name: run.errors.get(name, 0.0) + other.errors.get(name, 0.0),
    "rounding": lambda run, other, name: SHARE * run.errors.get(name, 0.0),
    "checks": _of_checks,
}
"""What may lie between two runs in a quantity; ``None``: anything."""


def worst(folder: Path, other: Path, within: str) -> tuple[float, str]:
    """Largest share of the tolerance that lies between two runs, and of which quantity."""
    there = [(one / "trace.csv").exists() for one in (folder, other)]
    if not all(there):
        return (math.inf, "run") if any(there) else (0.0, "refused by both")
    first, second = read_run(folder)[1], read_run(other)[1]
    if first.ending != second.ending:
        return math.inf, f"outcome: {first.ending}, {second.ending}"
    found = [(0.0, "nothing")]
    for name, difference in differences(first, second):
        allowed = TOLERANCES[within](first, second, name)
        if difference > SAME and allowed is not None:
            found.append((difference / allowed if allowed > 0.0 else math.inf, f"{name} {difference:.1e}"))
    return max(found)


def main(arguments: Sequence[str] | None = None) -> int:
    """Print what lies apart, worst first; the exit code."""
    parser = argparse.ArgumentParser(
        prog="python -m benchmarks.reports_apart", description=__doc__.splitlines()[0]
    )
    parser.add_argument("old", type=Path, help="folder of a report")
    parser.add_argument("new", type=Path, help="folder of another one on the same scenes")
    parser.add_argument("--within", choices=TOLERANCES, default="estimates")
    chosen = parser.parse_args(arguments)
    names = sorted({p.relative_to(f / "runs") for f in (chosen.old, chosen.new) for p in f.glob("runs/*/*")})
    if not names:
        print(f"error: {chosen.old} holds no runs; allowed: the folder of a report", file=sys.stderr)
        return 2
    try:
        found = [
            (*worst(chosen.old / "runs" / name, chosen.new / "runs" / name, chosen.within), name)
            for name in names
        ]
    except SceneError as error:
        print(f"error: {error}", file=sys.stderr)
        return 2
    for share, what, name in sorted(found, reverse=True):
        if share > 0.0:
            print(f"{'FAILED' if share > 1.0 else 'apart'}: {name}: {what}: {share:.2g} of what is allowed")
    same, failed = (sum(map(test, found)) for test in (lambda one: one[0] == 0.0, lambda one: one[0] > 1.0))
    print(f"{len(found)} runs, {same} the same to {SAME:g}, {failed} too far apart")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
