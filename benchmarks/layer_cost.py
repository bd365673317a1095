"""What a layer costs: ``python -m benchmarks.layer_cost [SOLVER ...] [--scenes NAME ...] [--turns N]``.

Built-in scenes on a layer and on the half-space in its place, at the default resolution and in turn: the
processor time of the layer, the least of all turns, and ratios to the half-space: of times, steps, and of
the ways that the edge goes.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from contact_scene import Scene
from validation import cases, scenes
from validation.solvers import SOLVERS, solver


def run(name: str, scene: Scene) -> tuple[float, int, float]:
    """Processor time, steps, and way of the edge of one run."""
    began = time.process_time()
    trace = solver(name).solve(scene)
    taken = time.process_time() - began
    if not trace.outcome.finished:
        raise SystemExit(f"{name}: {trace.outcome.reason}")
    way = np.abs(np.diff(trace.contact_radius[trace.contact_radius > 0.0])).sum()
    return taken, trace.counters.steps, float(way)


def main(arguments: Sequence[str] | None = None) -> int:
    """Command line."""
    parser = argparse.ArgumentParser(description="processor time on a layer over that on the half-space")
    parser.add_argument("solvers", nargs="*", metavar="SOLVER", help=f"of {', '.join(SOLVERS)}; else all")
    parser.add_argument("--scenes", nargs="+", help="names of scenes with a layer; else all built-in ones")
    parser.add_argument("--turns", type=int, default=3, help="runs of each, of which the shortest counts")
    chosen = parser.parse_args(arguments)
    for name in chosen.scenes or [one for one in scenes.names() if one.startswith("layer-")]:
        layer = cases.load(name).scene
        bodies = layer, replace(layer, body=None)
        for one in chosen.solvers or SOLVERS:
            turns = [[run(one, scene) for scene in bodies] for _ in range(chosen.turns)]
            (taken, *on_layer), (least, *on_half_space) = map(min, zip(*turns, strict=True))
            ratios = [taken / least, *(a / b for a, b in zip(on_layer, on_half_space, strict=True))]
            print(f"{name:24} {one:10} {taken:6.2f} s", *(f"{ratio:6.2f}" for ratio in ratios), flush=True)
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
