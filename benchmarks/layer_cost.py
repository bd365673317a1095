"""What a layer costs: ``python -m benchmarks.layer_cost [SOLVER ...] [--scenes NAME ...] [--turns N]``.

Built-in scenes on a layer and on the half-space in its place, at the default resolution and in turn: the
processor time of the layer, the least of all turns, and its ratio to that of the half-space.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Sequence
from dataclasses import replace

from contact_scene import Scene
from validation import cases, scenes
from validation.solvers import SOLVERS, solver


def seconds(name: str, scene: Scene) -> float:
    """Processor time of one run."""
    began = time.process_time()
    trace = solver(name).solve(scene)
    taken = time.process_time() - began
    if not trace.outcome.finished:
        raise SystemExit(f"{name}: {trace.outcome.reason}")
    return taken


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
            turns = [[seconds(one, scene) for scene in bodies] for _ in range(chosen.turns)]
            on_layer, on_half_space = map(min, zip(*turns, strict=True))
            print(f"{name:24} {one:10} {on_layer:7.2f} s {on_layer / on_half_space:6.2f}", flush=True)
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
