"""The batch solver against the reference: ``python -m benchmarks.batch [--random N | --sweep N]``.

Each row is a family of random scenes. Both solvers take turns on one core; the reference solves a sample. A
line tells processor time a scene of both, how many have an answer, and of the sample the differences of the
pull-off force, in the median, of 99 in 100, the largest, and how many are larger than the error estimate.
``--random N``: N scenes drawn from all families instead, each solved by both; how many differences are larger
than the estimate, and than it and the reference's own together, and the worst ratios.
``--sweep N``: the command ``crosscontact sweep`` with N retractions on two processes; what it takes.
"""

from __future__ import annotations

import argparse
import resource
import subprocess
import sys
import tempfile
import time
import tracemalloc
from collections import Counter
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
import tomli_w

import contact_scene as cs
from validation.reference import batch
from validation.reference.path import Options, solve

WIDTH = 0.2
"""About the radius of contact of the scenes, whose sphere has the radius one, and the relaxed ``E*``."""
RATIO = 10.0
"""Glassy over relaxed modulus."""


@dataclass(frozen=True)
class Family:
    """Random scenes: powers of ten of zone over radius, speed in radii a relaxation time, work, and
    stiffness of a spring over that of the contact. ``scattered``: times of branches anywhere in ``decades``,
    their moduli in two; speeds and holds in as many more."""

    branches: int = 1
    zones: tuple[float, float] = (-1.19, -1.19)
    speeds: tuple[float, float] = (-1.5, 2.5)
    decades: float = 0.0
    works: tuple[float, float] = (-3.3, -3.3)
    any_indenter: bool = False
    cycle: bool = False
    closing: float | None = None
    dwell: bool = False
    spring: tuple[float, float] | None = None
    scattered: bool = False

    def scene(self, rng: np.random.Generator) -> cs.Scene:
        """One of them: a retraction from a relaxed start, or a cycle from jump-in."""
        times = 10.0 ** (self.decades * np.linspace(-0.5, 0.5, self.branches))
        shares = rng.uniform(0.2, 1.0, self.branches) if self.any_indenter else np.ones(self.branches)
        moduli = (RATIO - 1.0) * shares / max(self.branches, 1)
        spread = 0.0
        if self.scattered:
            spread = 0.5 * self.decades
            times = 10.0 ** rng.uniform(-spread, spread, self.branches)
            moduli = 10.0 ** rng.uniform(-1.0, 1.0, self.branches)
        branches = tuple(cs.Branch(float(E), float(t)) for E, t in zip(0.75 * moduli, times, strict=True))
        indenter: cs.Indenter = cs.Sphere(1.0)
        depth = float(rng.uniform(0.01, 0.05))
        if self.any_indenter:
            exponent = float(rng.uniform(1.0, 6.0))
            indenter = cs.PowerLaw(exponent, 0.5 * depth / WIDTH**exponent)
        work, zone, speed = (
            10.0 ** float(rng.uniform(*span))
            for span in (self.works, self.zones, (self.speeds[0] - spread, self.speeds[1] + spread))
        )
        rate = speed * WIDTH * 0.05
        away = cs.Ramp(-20.0, rate * (float(rng.uniform(0.2, 5.0)) if self.any_indenter else 1.0))
        loading = cs.Loading("relaxed", depth, (away,))
        if self.cycle:
            loading = cs.Loading("jump-in", 0.0, (cs.Ramp(depth, rate), away))
        if self.dwell:
            level = 10.0 ** float(rng.uniform(-4.5, -3.0)) if rng.random() < 0.5 else None
            hold = cs.Hold(10.0 ** float(rng.uniform(-2.0 - spread, 1.5 + spread)))
            loading = cs.Loading("jump-in", 0.0, (cs.Ramp(depth, rate, until_force=level), hold, away))
        adhesion = cs.Adhesion(work, zone * WIDTH, self.closing and self.closing * work)
        if self.spring is not None:
            stiffness = 2.0 * WIDTH * 10.0 ** float(rng.uniform(*self.spring))
            loading = replace(loading, machine=cs.Machine(stiffness))
        return cs.Scene(cs.Material(0.75, 0.5, branches), indenter, loading, adhesion)


SCATTERED: dict[str, Any] = {
    "branches": 3,
    "decades": 6.0,
    "scattered": True,
    "any_indenter": True,
    "closing": 0.5,
    "zones": (-4.0, -1.0),
    "speeds": (-1.0, 1.0),
}
FAMILIES = {
    "retractions, one branch": Family(),
    "retractions, any indenter, zones 1e-1 to 1e-6": Family(
        zones=(-6.0, -1.0), works=(-4.3, -2.8), any_indenter=True
    ),
    "retractions, three branches": Family(branches=3, decades=4.0),
    "retractions, ten branches over six decades": Family(branches=10, decades=6.0),
    "retractions, zone 1e-5 of the radius": Family(zones=(-5.0, -5.0)),
    "retractions on a spring": Family(spring=(-2.0, 2.0)),
    "retractions on a spring, hysteresis, three branches": Family(
        spring=(-2.0, 2.0), closing=0.5, branches=3, decades=4.0, any_indenter=True, zones=(-2.0, -2.0)
    ),
    "cycles, speeds over four decades": Family(cycle=True, speeds=(-1.0, 3.0)),
    "cycles with hysteresis, any indenter": Family(
        cycle=True, speeds=(-1.0, 3.0), closing=0.5, any_indenter=True, zones=(-2.0, -2.0)
    ),
    "cycles, three branches": Family(cycle=True, branches=3, decades=4.0, zones=(-2.0, -2.0)),
    "cycles, ten branches over six decades": Family(cycle=True, branches=10, decades=6.0, zones=(-2.0, -2.0)),
    "cycles, slow turns": Family(cycle=True, zones=(-4.0, -1.7), speeds=(-4.0, -1.0), works=(-5.0, -3.0)),
    "cycles with a dwell, half ended by a force": Family(
        cycle=True, speeds=(-1.0, 3.0), dwell=True, closing=0.5, any_indenter=True, zones=(-2.0, -2.0)
    ),
    "cycles on a spring, speeds over four decades": Family(
        cycle=True, speeds=(-1.0, 3.0), spring=(-0.5, 2.0)
    ),
    "cycles on a spring with a dwell, half ended by a force": Family(
        cycle=True,
        speeds=(-1.0, 3.0),
        dwell=True,
        closing=0.5,
        any_indenter=True,
        zones=(-2.0, -2.0),
        spring=(-0.5, 2.0),
    ),
    "cycles, zone 1e-5 of the radius": Family(cycle=True, zones=(-5.0, -5.0), speeds=(-1.0, 3.0)),
    "retractions on a spring, branches anywhere in six decades": Family(spring=(-2.0, 2.0), **SCATTERED),
}


def difference(scene: cs.Scene, answer: batch.Solution, resolution: int | None = None) -> float:
    """Relative difference of the pull-off force from that of the reference."""
    tension = -float(solve(scene, Options(resolution=resolution)).force.min())
    return abs(answer.pull_off_force - tension) / max(tension, 1e-300)


def line(name: str, family: Family, asked: argparse.Namespace) -> str:
    """A row of the table."""
    rng, count = np.random.default_rng(asked.seed), asked.scenes
    scenes = [family.scene(rng) for _ in range(count)]
    batch.solve(scenes[: count // 8])
    spent, slow, found = [], [], []
    for turn in np.array_split(np.arange(asked.sample), 3):
        began = time.process_time()
        answers = batch.solve(scenes)
        spent.append((time.process_time() - began) / count)
        began = time.process_time()
        for i in turn:
            if answers[i].answered:
                found.append(
                    (difference(scenes[i], answers[i], asked.resolution), answers[i].errors["pull_off_force"])
                )
        slow.append((time.process_time() - began) / max(len(turn), 1))
    tracemalloc.start()
    batch.solve(scenes)
    memory = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    apart, told = np.array(found).T
    reasons = Counter(answer.reason for answer in answers if not answer.answered)
    print(f"# {name}: without an answer {dict(reasons)}, memory {memory / 1e6:.0f} MB", flush=True)
    return (
        f"{name:48s} {1e3 * min(spent):8.3f} {1e3 * np.median(spent):8.3f} {1e3 * np.median(slow):8.1f} "
        f"{count - sum(reasons.values()):6d} {np.median(apart):9.1e} {np.quantile(apart, 0.99):9.1e} "
        f"{apart.max():9.1e} {int((apart > told).sum()):4d} of {len(apart)}"
    )


def calibrate(asked: argparse.Namespace) -> None:
    """Print how many true differences are larger than their estimates, and the largest ratios of the two."""
    rng, families = np.random.default_rng(asked.seed), list(FAMILIES.items())
    drawn = [families[rng.integers(len(families))] for _ in range(asked.random)]
    scenes = [family.scene(rng) for _, family in drawn]
    ratios, own, none = [], [], 0
    for (name, _), scene, answer in zip(drawn, scenes, batch.solve(scenes), strict=True):
        if not answer.answered:
            none += 1
            continue
        trace = solve(scene, Options(resolution=asked.resolution, estimate_errors=True))
        tension, told = -float(trace.force.min()), answer.errors["pull_off_force"]
        apart = abs(answer.pull_off_force - tension) / max(tension, 1e-300)
        ratios.append((apart / told, apart, name))
        own.append(apart / (told + trace.errors.get("pull_off_force", 0.0)))
        if len(ratios) % 100 == 0:
            print(f"# {len(ratios)}: larger than the estimate {sum(r > 1.0 for r, *_ in ratios)}", flush=True)
    print(f"{len(ratios)} answered, {none} not; larger than the estimate: {sum(r > 1.0 for r, *_ in ratios)}")
    print(f"larger than both estimates together: {sum(ratio > 1.0 for ratio in own)}")
    for ratio, apart, name in sorted(ratios, reverse=True)[:10]:
        print(f"{ratio:8.2f} times, {apart:.1e}: {name}")


def sweep(count: int) -> None:
    """Print time and memory of a sweep, its sample by the reference and its data set included."""
    keys = {
        "loading.steps.0.rate": (1e-3, 10.0),
        "adhesion.work": (1e-4, 1e-3),
        "adhesion.zone": (3e-3, 0.013),
    }
    ranges = [{"key": key, "range": list(span), "scale": "log"} for key, span in keys.items()]
    plan = {"scene": "retraction-fast", "solver": "batch", "design": "sobol", "points": count, "drawn": []}
    with tempfile.TemporaryDirectory() as folder:
        file, began = Path(folder) / "plan.toml", time.perf_counter()
        file.write_text(tomli_w.dumps(plan | {"coordinates": ranges}))
        asked = [
            sys.executable,
            "-m",
            "crosscontact",
            "sweep",
            str(file),
            "--out",
            f"{folder}/out",
            "--jobs",
            "2",
        ]
        subprocess.run(asked, check=True)
        wall, spent = time.perf_counter() - began, resource.getrusage(resource.RUSAGE_CHILDREN)
        size = sum(one.stat().st_size for one in Path(folder).rglob("*") if one.is_file())
    processor = spent.ru_utime + spent.ru_stime
    print(
        f"{count} runs in {wall:.0f} s; processor {processor:.0f} s, {1e3 * processor / count:.2f} ms a run"
    )
    print(f"largest process {spent.ru_maxrss / 1e3:.0f} MB; files {size / 1e6:.0f} MB")


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--scenes", type=int, default=256)
    parser.add_argument("--sample", type=int, default=48)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--only", default="")
    parser.add_argument("--resolution", type=int, help="of the reference; by default its own")
    parser.add_argument("--random", type=int, default=0, help="scenes for the calibration of estimates")
    parser.add_argument("--sweep", type=int, default=0, help="runs of a sweep")
    asked = parser.parse_args()
    if asked.sweep:
        sweep(asked.sweep)
        return
    if asked.random:
        calibrate(asked)
        return
    columns = "   least   median     ref. answer    median       99%     worst  over"
    print(f"{'ms a scene':48s} {columns}")
    for name, family in FAMILIES.items():
        if asked.only in name:
            print(line(name, family, asked), flush=True)


if __name__ == "__main__":
    main()
