"""Commands killed at random and given again until they end: are their results those of commands never killed?

::

    python -m benchmarks.kills --kills 30 --out out/kills sweep report study fit

Each command runs on short scenes at a coarse resolution. It is killed (SIGKILL) at a random moment of what it
would take, given again with the same ``--out``, killed again, and so on. Whenever it ends, its numbers, run
times aside, are compared with those of the command that was never killed, to the last bit, and it begins anew
in an empty folder; after ``--kills`` kills it is left to end.
"""

from __future__ import annotations

import argparse
import os
import random
import shutil
import subprocess
import sys
import time
from dataclasses import replace
from pathlib import Path

import crosscontact as cc
from benchmarks.what_differs import differences
from crosscontact.cli import main
from validation import scenes
from validation.studies import study

SCENE = """
[material]
modulus = 0.75
poisson = 0.5
[indenter]
shape = "sphere"
radius = 1.0
[adhesion]
work = 5e-4
zone = 0.02
[loading]
start = "jump-in"
penetration = 0.0
steps = [{ kind = "ramp", to = 0.01, rate = 0.02 }, { kind = "ramp", to = -0.5, rate = 0.1 }]
"""
PLAN = """
scene = "scene.toml"
solver = "bem"
resolution = 4
[[coordinates]]
name = "rate"
key = "loading.steps.1.rate"
geomspace = [0.02, 0.5, 8]
"""
COMMANDS = {
    "sweep": "sweep plan.toml",
    "report": "report --suite quick --no-estimates",
    "study": "study scene.toml",
    "fit": "fit curve.csv scene.toml --vary material.modulus --starts 2 --resolution 4",
}
SUITE = ["elastic-relaxed", "relaxed-equilibrium"]
"""Scenes of the report."""


def carry_out(command: str, out: str) -> int:
    """A command on short work: few scenes of a report, the coarsest levels of some ladders of a study."""
    scenes.suite = lambda name: SUITE
    full = study.ladders
    study.ladders = lambda scene: [replace(one, levels=one.levels[:2]) for one in full(scene)[::4]]
    study.finest = lambda scene: (8,)
    return main([*COMMANDS[command].split(), "--jobs", "2", "--out", out])


def begun(name: str, out: Path) -> subprocess.Popen[bytes]:
    """The command in a process of its own."""
    call = f"import sys; from benchmarks.kills import carry_out; sys.exit(carry_out({name!r}, {str(out)!r}))"
    where, silent = out.parent, subprocess.DEVNULL
    environment = os.environ | {"PYTHONPATH": str(Path(__file__).parents[1])}
    return subprocess.Popen(
        [sys.executable, "-c", call], cwd=where, env=environment, stdout=silent, stderr=silent
    )


def killed(name: str, folder: Path, kills: int, chance: random.Random) -> tuple[int, int, int]:
    """Kills, ends, and ends whose numbers differ from those of the command that is never killed."""
    whole, out = folder / "whole", folder / "killed"
    began = time.monotonic()
    begun(name, whole).wait()
    lasts = time.monotonic() - began
    done = ends = differing = 0
    while True:
        process = begun(name, out)
        try:
            process.wait(chance.uniform(0.0, lasts) if done < kills else None)
        except subprocess.TimeoutExpired:
            process.kill()
            process.wait()
            done += 1
            continue
        ends += 1
        differing += any(differences(whole, out, 0.0))
        if done >= kills:
            return done, ends, differing
        shutil.rmtree(out)


def prepare(folder: Path) -> None:
    """The scene, the plan and the curve, in an empty folder."""
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    (folder / "scene.toml").write_text(SCENE)
    (folder / "plan.toml").write_text(PLAN)
    trace = cc.solve(folder / "scene.toml", "bem", 4).trace
    rows = zip(*(column.tolist() for column in (trace.time, trace.force, trace.penetration)), strict=True)
    text = "\n".join(f"{time!r},{1.1 * force!r},{depth!r}" for time, force, depth in rows)
    (folder / "curve.csv").write_text(f"time,force,penetration\n{text}\n")


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("commands", nargs="*", default=list(COMMANDS))
    parser.add_argument("--kills", type=int, default=30)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--out", type=Path, default=Path("out/kills"))
    options = parser.parse_args()
    failed = 0
    for asked in options.commands:
        there = options.out.absolute() / asked
        prepare(there)
        count, ended, wrong = killed(asked, there, options.kills, random.Random(options.seed))
        print(f"{asked}: {count} kills, {ended} ends, {wrong} of them with other numbers", flush=True)
        failed += wrong
    sys.exit(1 if failed else 0)
