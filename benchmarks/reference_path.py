"""Scenes by the reference of this checkout and by that of another one, side by side.

    python -m benchmarks.reference_path CHECKOUT --oracle FILE [SCENE ...] [FAMILY:FROM-TO ...]

CHECKOUT has its environment in ``.venv``. FILE keeps what its reference says at resolution 32 (a random
scene: at its default) and what its default costs; made where it lacks a scene.
"""

from __future__ import annotations

import argparse
import json
import signal
import subprocess
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.random_scenes import random_scene
from contact_scene import Scene, Trace
from validation.cases import load
from validation.reference.path.solver import DEFAULT_TOLERANCE, Options, solve
from validation.scenes import names

FINE = 32
LONGEST = 60.0
"""Of a run, in seconds."""
MEASURES = ("pull_off", "time", "radius", "largest", "work")


COLUMNS = ("time", "force", "contact_radius", "external_work")
ELSEWHERE = """
import json, sys, time
from benchmarks.random_scenes import random_scene
from validation.cases import load
from validation.solvers import SOLVERS

name, resolution = sys.argv[1], json.loads(sys.argv[2])
family, _, seed = name.partition(":")
scene = random_scene(family, int(seed)).scene if seed else load(name).scene
began = time.process_time()
trace = SOLVERS["reference"].solve(scene, resolution)
row = {column: getattr(trace, column).tolist() for column in sys.argv[3:]}
row |= {"outcome": str(trace.outcome.kind), "steps": trace.counters.steps}
print(json.dumps(row | {"seconds": time.process_time() - began}))
"""
"""What the other checkout runs: name of the scene, resolution, columns; prints them."""


def of_trace(trace: Trace) -> dict[str, Any]:
    """What is measured of a trace of this checkout."""
    row: dict[str, Any] = {column: getattr(trace, column) for column in COLUMNS}
    return row | {"outcome": str(trace.outcome.kind), "steps": trace.counters.steps}


def measures(row: dict[str, Any]) -> dict[str, Any]:
    """Scalars of a trace, at the last row in contact; at the last of all where nothing pulls."""
    time_, force, radius, work = (np.asarray(row[column]) for column in COLUMNS)
    pulls = float(force.min()) < -1e-12 * float(force.max())
    touching = np.flatnonzero(radius > (0.0 if pulls else -1.0))
    last = int(touching[-1]) if touching.size else 0
    return {
        "pull_off": max(-float(force.min()), 0.0) if pulls else 0.0,
        "time": float(time_[last]),
        "radius": float(radius[last]),
        "largest": float(radius.max()),
        "work": float(work[last]),
        "most_work": float(np.abs(work).max()),
        "outcome": row["outcome"],
        "steps": row["steps"],
    }


class TooLong(Exception):
    """A run that takes longer than it may."""


def within(seconds: float, task: Callable[[], Any]) -> Any:
    """What a task returns; :class:`TooLong` where it takes longer."""

    def late(*_: object) -> None:
        raise TooLong(f"more than {seconds:g} s")

    signal.signal(signal.SIGALRM, late)
    signal.setitimer(signal.ITIMER_REAL, seconds)
    try:
        return task()
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0.0)


def scene_of(name: str) -> Scene | None:
    """A built-in scene, or a random one, FAMILY:SEED."""
    family, _, seed = name.partition(":")
    if not seed:
        return load(name).scene
    drawn = random_scene(family, int(seed))
    return drawn.scene if drawn else None


def elsewhere(checkout: Path, name: str, resolution: float | None) -> dict[str, Any]:
    """What the reference of another checkout says, and its processor time."""
    command = [".venv/bin/python", "-c", ELSEWHERE, name, json.dumps(resolution), *COLUMNS]
    done = subprocess.run(command, cwd=checkout, capture_output=True, text=True, timeout=LONGEST, check=True)
    row = json.loads(done.stdout.splitlines()[-1])
    return measures(row) | {"seconds": row["seconds"]}


def oracle_of(checkout: Path, name: str) -> dict[str, dict[str, Any]]:
    """The other reference, fine and as it comes."""
    default = elsewhere(checkout, name, None)
    slow = ":" in name or name.startswith(("sweep", "oscillation"))  # minutes at the fine resolution
    return {"default": default, "fine": default if slow else elsewhere(checkout, name, FINE)}


def compared(
    name: str, scene: Scene, oracle: dict[str, dict[str, Any]], tolerance: float, checkout: Path | None
) -> str:
    """One line: relative differences from the fine run, the work, and the times of both (in turn: of now)."""
    fine, default = oracle["fine"], oracle["default"]
    began = time.process_time()
    try:
        trace = within(LONGEST, lambda: solve(scene, Options(tolerance=tolerance)))
    except Exception as error:
        return f"{name:22s} FAILED {type(error).__name__}: {str(error)[:80]} | {fine['outcome']}"
    seconds = time.process_time() - began
    mine, counters = measures(of_trace(trace)), trace.counters
    sizes = {key: abs(fine[key]) for key in MEASURES} | {"work": fine["most_work"]}
    apart = [abs(mine[key] - fine[key]) / (sizes[key] or 1.0) for key in MEASURES]
    if checkout is not None:
        default["seconds"] = elsewhere(checkout, name, None)["seconds"]
    return (
        f"{name:22s} "
        + " ".join(f"{key} {value:.0e}" for key, value in zip(MEASURES, apart, strict=True))
        + f" | {counters.steps}+{counters.rejected_steps} geo {counters.history_updates}"
        + f" ev {counters.closure_evaluations} rows {len(trace)}"
        + f" {1e3 * seconds:.0f} ms {mine['outcome'][:22]}"
        + f" | {default['steps']} {1e3 * default['seconds']:.0f} ms {fine['outcome'][:12]}"
        + f" x{default['seconds'] / seconds:.1f}"
    )


def spread(given: list[str]) -> list[str]:
    """Names, those of FAMILY:FIRST-LAST one by one."""
    names = []
    for name in given:
        family, _, seeds = name.partition(":")
        first, _, last = seeds.partition("-")
        names += [f"{family}:{seed}" for seed in range(int(first), int(last) + 1)] if last else [name]
    return names


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("checkout", type=Path)
    parser.add_argument("--oracle", type=Path, required=True)
    parser.add_argument("--tolerance", type=float, default=DEFAULT_TOLERANCE)
    parser.add_argument("--in-turn", action="store_true", help="time the other default beside each run")
    parser.add_argument("scenes", nargs="*")
    given = parser.parse_intermixed_args()
    known = json.loads(given.oracle.read_text()) if given.oracle.exists() else {}
    for name in spread(given.scenes) or names():
        scene = scene_of(name)
        if scene is None:
            continue
        if name not in known:
            try:
                known[name] = oracle_of(given.checkout, name)
            except Exception as error:
                print(name, "has no oracle:", error)
                continue
            given.oracle.write_text(json.dumps(known))
        beside = given.checkout if given.in_turn else None
        print(compared(name, scene, known[name], given.tolerance, beside), flush=True)


if __name__ == "__main__":
    main()
