"""Built-in scenes by the reference and by the path of the edge, side by side.

    python -m benchmarks.reference_path --oracle FILE [--tolerance 1e-5] [SCENE ...] [FAMILY:FIRST-LAST ...]

A random scene is compared with the default of the reference. FILE keeps what the reference says at resolution
32 and what its default costs; made where it lacks a scene.
"""

from __future__ import annotations

import argparse
import json
import signal
import time
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.random_scenes import random_scene
from contact_scene import Scene, Trace
from validation.cases import load
from validation.reference import tracking
from validation.reference.path.options import DEFAULT_TOLERANCE, Options
from validation.reference.path.solver import solve
from validation.scenes import names

FINE = 32
LONGEST = 60.0
"""Of a run, in seconds."""
MEASURES = ("pull_off", "time", "radius", "largest", "work")


def measures(trace: Trace) -> dict[str, Any]:
    """Scalars of a trace, at the last row in contact; at the last of all where nothing pulls."""
    pulls = float(trace.force.min()) < -1e-12 * float(trace.force.max())
    touching = np.flatnonzero(trace.contact_radius > (0.0 if pulls else -1.0))
    last = int(touching[-1]) if touching.size else 0
    return {
        "pull_off": max(-float(trace.force.min()), 0.0) if pulls else 0.0,
        "time": float(trace.time[last]),
        "radius": float(trace.contact_radius[last]),
        "largest": float(trace.contact_radius.max()),
        "work": float(trace.external_work[last]),
        "most_work": float(np.abs(trace.external_work).max()),
        "outcome": str(trace.outcome.kind),
        "steps": trace.counters.steps,
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


def oracle_of(name: str, scene: Scene) -> dict[str, dict[str, Any]]:
    """The reference, fine and as it comes."""
    answers = {}
    for fineness, resolution in (("fine", FINE), ("default", None)):
        if (":" in name or name.startswith(("sweep", "oscillation"))) and resolution:
            continue  # minutes
        began = time.process_time()
        answers[fineness] = measures(
            within(LONGEST, partial(tracking.solve, scene, tracking.Options(resolution)))
        )
        answers[fineness]["seconds"] = time.process_time() - began
    answers.setdefault("fine", answers["default"])
    return answers


def compared(
    name: str, scene: Scene, oracle: dict[str, dict[str, Any]], tolerance: float, in_turn: bool = False
) -> str:
    """One line: relative differences from the fine run, the work, and the times of both."""
    fine, default = oracle["fine"], oracle["default"]
    began = time.process_time()
    try:
        trace = within(LONGEST, lambda: solve(scene, Options(tolerance=tolerance)))
    except Exception as error:
        return f"{name:22s} FAILED {type(error).__name__}: {str(error)[:80]} | {fine['outcome']}"
    seconds = time.process_time() - began
    mine, counters = measures(trace), trace.counters
    sizes = {key: abs(fine[key]) for key in MEASURES} | {"work": fine["most_work"]}
    apart = [abs(mine[key] - fine[key]) / (sizes[key] or 1.0) for key in MEASURES]
    if in_turn:
        began = time.process_time()
        tracking.solve(scene)
        default["seconds"] = time.process_time() - began
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
    parser.add_argument("--oracle", type=Path, required=True)
    parser.add_argument("--tolerance", type=float, default=DEFAULT_TOLERANCE)
    parser.add_argument("--in-turn", action="store_true", help="time today's default beside each run")
    parser.add_argument("scenes", nargs="*")
    given = parser.parse_args()
    known = json.loads(given.oracle.read_text()) if given.oracle.exists() else {}
    for name in spread(given.scenes) or names():
        scene = scene_of(name)
        if scene is None:
            continue
        if name not in known:
            try:
                known[name] = oracle_of(name, scene)
            except Exception as error:
                print(name, "has no oracle:", error)
                continue
            given.oracle.write_text(json.dumps(known))
        print(compared(name, scene, known[name], given.tolerance, given.in_turn), flush=True)


if __name__ == "__main__":
    main()
