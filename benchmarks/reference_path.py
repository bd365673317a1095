"""Built-in scenes by the reference and by the path of the edge, side by side.

    python -m benchmarks.reference_path --oracle FILE [--tolerance 1e-4] [SCENE ...]

FILE keeps what the reference says at resolution 32 and what its default costs; made where it lacks a scene.
"""

from __future__ import annotations

import argparse
import json
import time
import traceback
from pathlib import Path

import numpy as np

from contact_scene import Scene, Trace
from validation.cases import load
from validation.reference.path.solver import Run
from validation.scenes import names
from validation.solvers import REFERENCE, SOLVERS

FINE = 32
MEASURES = ("pull_off", "time", "radius", "largest", "work")


def measures(trace: Trace) -> dict[str, float]:
    """Scalars of a trace, at the last row in contact."""
    touching = np.flatnonzero(trace.contact_radius > 0.0)
    last = int(touching[-1]) if touching.size else 0
    return {
        "pull_off": max(-float(trace.force.min()), 0.0),
        "time": float(trace.time[last]),
        "radius": float(trace.contact_radius[last]),
        "largest": float(trace.contact_radius.max()),
        "work": float(trace.external_work[last]),
        "outcome": str(trace.outcome.kind),
        "steps": trace.counters.steps,
    }


def oracle_of(scene: Scene) -> dict[str, dict[str, float]]:
    """The reference, fine and as it comes."""
    answers = {}
    for name, resolution in (("fine", FINE), ("default", None)):
        began = time.process_time()
        answers[name] = measures(SOLVERS[REFERENCE].solve(scene, resolution))
        answers[name]["seconds"] = time.process_time() - began
    return answers


def compared(name: str, oracle: dict[str, dict[str, float]], tolerance: float) -> str:
    """One line: relative differences from the fine run, the work, and the times of both."""
    fine, default = oracle["fine"], oracle["default"]
    began = time.process_time()
    try:
        run = Run(load(name).scene, tolerance).run()
    except Exception as error:
        return f"{name:22s} FAILED {type(error).__name__}: {str(error)[:80]} | {fine['outcome']}"
    seconds = time.process_time() - began
    mine = run.measures()
    apart = [abs(mine[key] - fine[key]) / abs(fine[key] or 1.0) for key in MEASURES]
    tracker = run.tracker
    return (
        f"{name:22s} "
        + " ".join(f"{key} {value:.0e}" for key, value in zip(MEASURES, apart, strict=True))
        + f" | {tracker.steps}+{tracker.rejected} geo {tracker.geometries} ev {tracker.evaluations}"
        + f" {1e3 * seconds:.0f} ms {run.outcome[:22]}"
        + f" | {default['steps']} {1e3 * default['seconds']:.0f} ms {fine['outcome'][:12]}"
        + f" x{default['seconds'] / seconds:.1f}"
    )


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--oracle", type=Path, required=True)
    parser.add_argument("--tolerance", type=float, default=1e-4)
    parser.add_argument("scenes", nargs="*")
    given = parser.parse_args()
    known = json.loads(given.oracle.read_text()) if given.oracle.exists() else {}
    for name in given.scenes or names():
        if name not in known:
            try:
                known[name] = oracle_of(load(name).scene)
            except Exception as error:
                traceback.print_exc()
                print(name, "has no oracle:", error)
                continue
            given.oracle.write_text(json.dumps(known))
        print(compared(name, known[name], given.tolerance), flush=True)


if __name__ == "__main__":
    main()
