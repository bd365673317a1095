"""What a layer costs: ``python -m benchmarks.layer_cost [SOLVER ...] [--scenes NAME ...] [--turns N]``.

Built-in scenes on a layer and on the half-space in its place, at the default resolution and in turn: the
processor time of the layer, the least of all turns, and ratios to the half-space: of times, steps, and of
the ways that the edge goes.

With ``--orders N ...`` mean errors of force and radius at these resolutions instead, against the reference at
its finest, and their orders over two halvings.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from contact_scene import Scene
from contact_scene.trace import Array
from validation import cases, scenes
from validation.measure.curves import CURVES, distance
from validation.measure.windows import windows
from validation.solvers import SOLVERS, solver

FINEST = 64
"""Resolution of the reference that errors are taken against."""


def run(name: str, scene: Scene) -> tuple[float, int, float]:
    """Processor time, steps, and way of the edge of one run."""
    began = time.process_time()
    trace = solver(name).solve(scene)
    taken = time.process_time() - began
    if not trace.outcome.finished:
        raise SystemExit(f"{name}: {trace.outcome.reason}")
    way = np.abs(np.diff(trace.contact_radius[trace.contact_radius > 0.0])).sum()
    return taken, trace.counters.steps, float(way)


def errors(name: str, scene: Scene, resolutions: Sequence[int]) -> Array:
    """Mean errors of force and radius, shape (2, n)."""
    exact = solver("reference").solve(scene, FINEST)
    spans = windows(scene.loading, exact)
    runs = [solver(name).solve(scene, resolution) for resolution in resolutions]
    apart = [[distance(run, exact, column, spans) for run in runs] for column in CURVES]
    return np.array([[one.mean if one else np.nan for one in row] for row in apart])


def main(arguments: Sequence[str] | None = None) -> int:
    """Command line."""
    parser = argparse.ArgumentParser(description="processor time on a layer over that on the half-space")
    parser.add_argument("solvers", nargs="*", metavar="SOLVER", help=f"of {', '.join(SOLVERS)}; else all")
    parser.add_argument("--scenes", nargs="+", help="names of scenes with a layer; else all built-in ones")
    parser.add_argument("--turns", type=int, default=3, help="runs of each, of which the shortest counts")
    parser.add_argument("--orders", type=int, nargs="+", metavar="N", help="resolutions, each twice the last")
    chosen = parser.parse_args(arguments)
    for name in chosen.scenes or [one for one in scenes.names() if one.startswith("layer-")]:
        layer = cases.load(name).scene
        bodies = layer, replace(layer, body=None)
        for one in chosen.solvers or SOLVERS:
            for body, scene in zip(("layer", "half-space"), bodies if chosen.orders else (), strict=False):
                for column, found in zip(CURVES, errors(one, scene, chosen.orders), strict=True):
                    orders = 0.5 * np.log2(found[:-2] / found[2:])
                    print(f"{name:24} {one:10} {body:10} {column:14}", found, orders.round(1), flush=True)
            if chosen.orders:
                continue
            turns = [[run(one, scene) for scene in bodies] for _ in range(chosen.turns)]
            (taken, *on_layer), (least, *on_half_space) = map(min, zip(*turns, strict=True))
            ratios = [taken / least, *(a / b for a, b in zip(on_layer, on_half_space, strict=True))]
            print(f"{name:24} {one:10} {taken:6.2f} s", *(f"{ratio:6.2f}" for ratio in ratios), flush=True)
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
