"""Error estimates of the reference on built-in and random scenes, against runs at a 64th of the tolerance.

    python -m benchmarks.reference_path [SCENE ...] [FAMILY:FROM-TO ...]
    python -m benchmarks.reference_path --before FILE [SCENE ...] [FAMILY:FROM-TO ...]

A line a scene: estimate over true difference of each quantity. At the end, by quantity: how many scenes, the
median ratio, and how many estimates are below the difference, where that is more than rounding.

With ``--before`` a checkout is compared with another: outcomes are written to the file where there is none
yet; else a line for each outcome, number or count of steps that has changed, and ratios of steps and time.
"""

from __future__ import annotations

import argparse
import json
import math
import signal
import time
from collections import defaultdict
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.batch import SCATTERED, Family
from benchmarks.random_scenes import random_scene
from contact_scene import OutcomeKind, Scene, Trace
from validation.cases import load
from validation.measure.observables import observe
from validation.reference.path import Options, solve
from validation.reference.path.solver import LEAST_LOOP, distances
from validation.scenes import names

FINER = 64.0
"""Tolerance, in that of the run at the other resolution: eight times the resolution."""
ROUNDING = 1e-11
"""Difference below which nothing is told."""
LONGEST = 120.0
"""Of both runs, in seconds."""


BEFORE = (
    "scattered:0-249",
    "plain:5000-5029",
    "usual:5000-5029",
    "swings:5000-5029",
    "instruments:5000-5029",
)
"""Compared with another checkout, beside the built-in scenes: ten minutes."""
MOST_STEPS = 3000
"""Of a run that is compared."""
CHANGED = 1e-5
"""Relative change of a number that is told."""


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
    """A built-in scene, or a random one, FAMILY:SEED; ``scattered``: branches anywhere in six decades."""
    family, _, seed = name.partition(":")
    if not seed:
        return load(name).scene
    if family == "scattered":
        i, dwell = int(seed), {"cycle": True, "dwell": True}
        kinds: tuple[dict[str, Any], ...] = (
            {},
            {"spring": (-2.0, 2.0)},
            {"cycle": True},
            dwell,
            dwell | {"spring": (-0.3, 2.0)},
        )
        asked = SCATTERED | kinds[i % len(kinds)] | {"branches": 1 + i % 4}
        return Family(**asked).scene(np.random.default_rng(i))
    drawn = random_scene(family, int(seed))
    return drawn.scene if drawn else None


def spread(given: list[str]) -> list[str]:
    """Names, those of FAMILY:FIRST-LAST one by one."""
    names = []
    for name in given:
        family, _, seeds = name.partition(":")
        first, _, last = seeds.partition("-")
        names += [f"{family}:{seed}" for seed in range(int(first), int(last) + 1)] if last else [name]
    return names


def differences(scene: Scene, run: Trace, finer: Trace) -> dict[str, float]:
    """Relative differences of what a run estimates; of curves the largest distance."""
    here, there = (observe(trace, ends_in_a_point=scene.ends_in_a_point) for trace in (run, finer))
    turnover = float(np.abs(np.diff(finer.external_work)).sum())
    sizes = {
        "pull_off_force": there.pull_off_force or 0.0,
        "loop_energy": max(abs(there.loop_energy or 0.0), LEAST_LOOP * turnover),
        "detachment_time": float(run.time.max()),
        "detachment_penetration": float(np.abs(run.penetration).max()),
    }
    found = {}
    for name, size in sizes.items():
        one, other = getattr(here, name), getattr(there, name)
        if one is not None and other is not None and size > 0.0:
            found[name] = abs(one - other) / size
    for name in ("force", "contact_radius"):
        found[name] = float(distances(run.columns(), finer.columns(), name).max())
    return found


def compared(scene: Scene) -> dict[str, tuple[float, float]]:
    """Estimate and true difference by quantity; nothing where a run has no estimate."""
    run = solve(scene, Options(estimate_errors=True))
    if not run.errors:
        return {}
    step = Options().step_tolerance / FINER
    finer = solve(scene, Options(tolerance=step, stop_times=tuple(run.time.tolist())))
    if finer.outcome.kind is not run.outcome.kind or finer.outcome.kind is OutcomeKind.BREAKDOWN:
        raise ArithmeticError(f"{run.outcome.kind}, and {finer.outcome.kind} at the finer tolerance")
    found = differences(scene, run, finer)
    return {name: (run.errors[name], found[name]) for name in run.errors if name in found}


def outcome(name: str) -> dict[str, Any]:
    """What became of a scene, and the work it took."""
    scene, begun = scene_of(name), time.process_time()
    if scene is None:
        return {}
    try:
        run = within(LONGEST, partial(solve, scene, Options(max_steps=MOST_STEPS)))
    except Exception as error:
        return {"kind": type(error).__name__}
    least, largest = float(run.force.min()), float(run.force.max())
    force = max(-least, largest) or 1.0
    numbers = [least / force, force, float(run.contact_radius.max()), float(run.time[-1])]
    steps = run.counters.steps + run.counters.rejected_steps
    return {"kind": run.outcome.kind, "numbers": numbers, "steps": steps, "s": time.process_time() - begun}


def changes(before: dict[str, Any], after: dict[str, Any]) -> Iterator[str]:
    """What differs between two outcomes of a scene."""
    if before.get("kind") != after.get("kind"):
        yield f"{before.get('kind')}, now {after.get('kind')}"
    elif "steps" in before:
        numbers = zip(
            ("pull-off", "force", "radius", "end"), before["numbers"], after["numbers"], strict=True
        )
        for name, one, other in numbers:
            scale = 1.0 if name == "pull-off" else max(abs(one), abs(other), 1e-300)
            if abs(one - other) > CHANGED * scale:
                yield f"{name} {abs(one - other) / scale:.1e}"
        if abs(math.log((after["steps"] + 60) / (before["steps"] + 60))) > math.log(1.5):
            yield f"steps {before['steps']}, now {after['steps']}"


def compare(names: list[str], file: Path) -> None:
    """Outcomes written to a file, or compared with those in it."""
    if not file.exists():
        file.write_text(json.dumps({name: outcome(name) for name in names}))
        return
    before, ratios = json.loads(file.read_text()), []
    for name in names:
        one, other = before.get(name, {}), outcome(name)
        for change in changes(one, other):
            print(f"{name:20s} {change}", flush=True)
        if "steps" in one and "steps" in other:
            ratios.append([(other["steps"] + 1) / (one["steps"] + 1), other["s"] / one["s"]])
    steps, seconds = np.exp(np.log(ratios).mean(axis=0))
    print(f"{len(ratios)} scenes: steps {steps:.3f}, time {seconds:.3f} of those before")


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("scenes", nargs="*")
    parser.add_argument("--before", type=Path, metavar="FILE", help="outcomes of another checkout")
    asked = parser.parse_args()
    if asked.before is not None:
        compare(spread(asked.scenes or [*names(), *BEFORE]), asked.before)
        return
    pairs: defaultdict[str, list[tuple[float, float]]] = defaultdict(list)
    for name in spread(asked.scenes) or names():
        scene = scene_of(name)
        if scene is None:
            continue
        try:
            found = within(LONGEST, partial(compared, scene))
        except Exception as error:
            print(f"{name:20s} FAILED {type(error).__name__}: {error}", flush=True)
            continue
        told = [f"{key} {one:.0e}/{other:.0e}" for key, (one, other) in found.items()]
        below = [key for key, (one, other) in found.items() if one < other > ROUNDING]
        print(f"{name:20s}", *told, *(f"BELOW: {key}" for key in below), flush=True)
        for key, pair in found.items():
            pairs[key].append(pair)
    for key, each in pairs.items():
        one, other = np.array(each).T
        seen = other > ROUNDING
        ratio = one[seen] / other[seen]
        middle = f": median {np.median(ratio):.1f}, {(ratio < 1.0).sum()} below" if seen.any() else ""
        print(f"{key:24s} {seen.sum()} of {len(each)} scenes{middle}")


if __name__ == "__main__":
    main()
