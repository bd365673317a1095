"""Random tests of an instrument, as approaches in SI units, through all three solvers.

``python -m benchmarks.approach_programmes [COUNT] [FIRST]`` solves ``COUNT`` (200) programmes from the seed
``FIRST`` (0) on, coarsely, with error estimates, and prints what disagrees: outcomes that are not alike, and
pull-off and peak forces that differ from those of the reference by more than both estimates; at the end the
outcomes by solver.
"""

from __future__ import annotations

import random
import sys
from collections import Counter

from contact_scene import (
    Adhesion,
    Approach,
    Branch,
    Cone,
    FlatPunch,
    Hold,
    Loading,
    Machine,
    Material,
    PowerLaw,
    Ramp,
    Scene,
    SceneError,
    Sphere,
    Step,
)
from contact_scene.indenter import Indenter
from validation.cases import Case
from validation.runs.run import Run, run

SOLVERS = {"reference": 4, "bem": 4, "fem": 4}
"""Coarse resolutions."""
FORCES = ("peak_force", "pull_off_force")
ALIKE = 1e-3
"""Difference of two forces below which no estimate is needed: coarse solvers are held to a percent."""


def programme(seed: int) -> Scene:
    """A test on a gel or a rubber, by an indenter of micrometres to millimetres."""
    drawn = random.Random(seed)

    def decades(low: float, high: float) -> float:
        return float(f"{10.0 ** drawn.uniform(low, high):.3g}")

    modulus, radius = decades(3.0, 7.0), decades(-6.0, -3.0)
    times = sorted(decades(-2.0, 1.0) for _ in range(drawn.choice((0, 1, 1, 2, 4))))
    branches = tuple(Branch(modulus * decades(-0.5, 1.0), time) for time in times)
    material = Material(modulus, drawn.choice((0.5, 0.49, 0.3)), branches)
    shapes: tuple[Indenter, ...] = (
        Sphere(radius),
        Sphere(radius),
        Cone(drawn.choice((70.0, 80.0))),
        FlatPunch(0.1 * radius),
        PowerLaw(3.0, 0.1 / radius**2),
    )
    indenter = drawn.choice(shapes)
    width = 0.1 * radius
    depth = 0.01 * radius
    soft = material.relaxed_plane_modulus
    # A release rate that lifts the contact by a tenth of its depth to all of it.
    work = soft * depth**2 / (6.3 * width) * decades(-2.0, 0.0)
    adhesion = Adhesion(work, width * drawn.choice((0.05, 0.1))) if drawn.random() < 0.7 else None
    force = soft * width * depth * decades(-0.5, 0.5)
    speed = depth / decades(-1.0, 1.0)
    machine = Machine(2.0 * soft * width * decades(-0.5, 1.0)) if drawn.random() < 0.4 else None
    dwell = drawn.choice((0.0, 0.0, decades(-1.0, 1.0)))
    retract = drawn.choice((None, speed * decades(-1.0, 1.0)))
    steps: tuple[Step, ...]
    if drawn.random() < 0.25:
        level = depth * decades(-0.3, 0.3)
        steps = (Ramp(level, speed), Hold(dwell), Ramp(-20.0 * level, retract or speed))
    else:
        away = drawn.choice((None, None, -5.0 * depth))
        steps = (Approach(speed, force, drawn.choice((None, 20.0 * depth)), dwell, retract, away),)
    return Scene(material, indenter, Loading("jump-in", 0.0, steps, machine), adhesion, f"programme {seed}")


def ending(one: Run) -> str:
    """How a run ended; of one without an answer the key at fault."""
    return str(one.trace.outcome.kind) if one.trace else f"no answer: {one.failure.partition(':')[0]}"


def disagreements(runs: dict[str, Run]) -> list[str]:
    """What of the runs of one programme does not agree, one line each."""
    found = []
    kinds = {name: ending(one) for name, one in runs.items()}
    if len(set(kinds.values())) > 1:
        found.append("outcomes: " + ", ".join(f"{name} {kind}" for name, kind in kinds.items()))
    base = runs["reference"]
    for name, one in runs.items():
        for force in FORCES if one is not base else ():
            expected, value = base.measures.get(force), one.measures.get(force)
            if expected is None or value is None:
                if expected is not value and kinds[name] == kinds["reference"]:
                    found.append(f"{force}: reference {expected}, {name} {value}")
                continue
            allowed = ALIKE + base.errors.get(force, 0.0) + one.errors.get(force, 0.0)
            apart = abs(value - expected) / abs(expected)
            if apart > allowed:
                found.append(f"{force}: {name} off by {apart:.1e}, allowed {allowed:.1e}")
    return found


def main(count: int = 200, first: int = 0) -> int:
    """Solve the programmes and print what disagrees; 1 if anything does."""
    ended: dict[str, Counter[str]] = {name: Counter() for name in SOLVERS}
    differing = 0
    for seed in range(first, first + count):
        try:
            case = Case(f"programme-{seed}", programme(seed))
        except SceneError as error:
            print(f"{seed}: refused: {error}")
            continue
        runs = {name: run(case, name, resolution, estimate=True) for name, resolution in SOLVERS.items()}
        for name, one in runs.items():
            ended[name][ending(one)] += 1
        found = disagreements(runs)
        differing += bool(found)
        for line in found:
            print(f"{seed}: {line}", flush=True)
    for name, kinds in ended.items():
        print(f"{name}: " + ", ".join(f"{number} {kind}" for kind, number in kinds.most_common()))
    print(f"{differing} of {count} programmes disagree")
    return int(differing > 0)


if __name__ == "__main__":
    sys.exit(main(*map(int, sys.argv[1:])))
