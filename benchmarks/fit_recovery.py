"""Blind recovery: random materials, recorded with noise, fitted from elsewhere, held against the intervals.

::

    python -m benchmarks.fit_recovery --out out/recovery --count 50 --jobs 2

Each material has one branch, adhesion, and three curves at speeds from slow to fast, with a noise of 1 % of
the pull-off force. The fit starts within a factor of 1.5 of the truth and knows the zone, Poisson's ratio and
the indenter. Written are ``recovery.md``, ``recovery.json`` and ``recovery.png``; the command goes on where
it was stopped. ``--retraction`` fits work of adhesion and zone of one retraction each, with 2 % of noise;
``--posterior`` counts intervals of walkers beside those of the least squares. ``--price`` instead measures
the fit of one material with its check by a second solver, over the bare runs that it consists of.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np
from scipy import stats

from contact_scene import Adhesion, Branch, Loading, Material, Ramp, Scene, Sphere
from contact_scene.scene import value_at, with_values
from validation.drawing.figure import GREY, INK, MARKERS, SERIES, VERMILION, drawing, format_axes, png
from validation.fits.contact import Array
from validation.fits.fit import fit_curves
from validation.fits.parameters import FitSettings
from validation.fits.record import MeasuredCurve
from validation.fits.synthetic import synthetic
from validation.runs.folder import output_folder, to_json, write_whole
from validation.runs.pool import Task, TaskResult, processes, run_tasks
from validation.runs.progress import Progress
from validation.runs.provenance import fingerprint
from validation.runs.store import Store
from validation.solvers import REFERENCE, SOLVERS

if TYPE_CHECKING:
    from matplotlib.figure import Figure

LABELS = {
    "adhesion.work": "work of adhesion",
    "material.modulus": "relaxed modulus",
    "material.branches[0].modulus": "branch modulus",
    "material.branches[0].time": "relaxation time",
    "adhesion.zone": "process zone",
}
*VARIED, _ = LABELS
RETRACTED = ("adhesion.work", "adhesion.zone")
KINDS = {"background": "add what instruments add", "retraction": "fit two numbers of one retraction each"}
NOISE = 0.01
SPEEDS = (0.006, 0.03, 0.15)
ENOUGH = 50
"""Materials from which coverage is known to 3 %."""
WITHIN = (0.90, 0.98)
"""Share of intervals that should hold the truth, of the 95 % that they state."""


@dataclass(frozen=True)
class RecoveredMaterial:
    """One material: what was put in (``truth``) and what came out, with its 95 % interval and the standard
    deviation of the logarithm; ``misfit`` is the sum of squares over degrees of freedom; ``sampled`` are the
    ends of the posterior's intervals, if there is one."""

    number: int
    truth: tuple[float, ...]
    value: tuple[float, ...]
    low: tuple[float, ...]
    high: tuple[float, ...]
    deviation: tuple[float, ...]
    misfit: float
    explained: bool
    converged: bool
    seconds: float
    sampled: tuple[tuple[float, float], ...] = ()

    @property
    def inside(self) -> list[bool]:
        """Which intervals hold the truth."""
        return [low <= at <= high for low, at, high in zip(self.low, self.truth, self.high, strict=True)]

    @property
    def inside_sampled(self) -> list[bool]:
        """Which of those of the posterior do."""
        return [low <= at <= high for (low, high), at in zip(self.sampled, self.truth, strict=True)]

    @property
    def scores(self) -> list[float]:
        """Errors of the logarithms over their standard deviations."""
        return [
            float(np.log(value / at) / size)
            for value, at, size in zip(self.value, self.truth, self.deviation, strict=True)
        ]


def random_scenes(number: int) -> tuple[list[Scene], Scene]:
    """Three scenes of one material, one for each speed, and a first guess that is wrong."""
    draw = np.random.default_rng([18, number])
    ratio = float(np.exp(draw.uniform(np.log(2.0), np.log(30.0))))
    modulus, time = float(np.exp(draw.uniform(-1.0, 1.0))), float(np.exp(draw.uniform(-1.0, 1.0)))
    work = modulus * float(np.exp(draw.uniform(np.log(2e-4), np.log(2e-3))))
    depth = float(draw.uniform(0.02, 0.04))
    zone = float(np.exp(draw.uniform(np.log(0.008), np.log(0.02))))
    material = Material(modulus, 0.5, (Branch(modulus * (ratio - 1.0), time),))
    scenes = []
    for speed in SPEEDS:
        rate = speed / time * float(np.exp(draw.uniform(-0.4, 0.4)))
        loading = Loading("jump-in", 0.0, (Ramp(depth, rate), Ramp(-0.5, rate)))
        scenes.append(Scene(material, Sphere(1.0), loading, Adhesion(work, zone), f"material {number}"))
    wrong = {path: value_at(scenes[0], path) * float(np.exp(draw.uniform(-0.4, 0.4))) for path in VARIED}
    return scenes, with_values(scenes[0], wrong)


def random_retraction(number: int) -> tuple[Scene, Scene]:
    """A relaxed contact that is pulled off, and a first guess that is wrong."""
    draw = np.random.default_rng([57, number])
    rate, work, zone, *wrong = np.exp(draw.uniform(-1.0, 1.0, 5) * (1.0, 0.4, 0.3, 0.4, 0.4))
    loading = Loading("relaxed", 0.02, (Ramp(-0.3, 0.02 * float(rate)),))
    adhesion = Adhesion(5e-4 * float(work), 0.013 * float(zone))
    scene = Scene(Material(0.75, 0.5, (Branch(6.75, 1.0),)), Sphere(1.0), loading, adhesion)
    wrongly = zip(RETRACTED, wrong, strict=True)
    return scene, with_values(scene, {path: value_at(scene, path) * float(by) for path, by in wrongly})


def recorded(number: int, scenes: Sequence[Scene], background: bool = False) -> list[MeasuredCurve]:
    """Curves of the scenes of a material with their noise, named by their speeds."""
    found = []
    for place, scene in enumerate(scenes):
        curve = synthetic(scene, NOISE, seed=10 * number + place, resolution=16)
        force = curve.force + _background(curve) if background else curve.force
        found.append(replace(curve, force=force, name=f"speed {place + 1}"))
    return found


def _background(curve: MeasuredCurve) -> Array:
    """What instruments add, over the range of the force: a level of 5 %, a tilt of 2 % and a drift of 1 %
    over the record, a drag of 0.5 %, and a wave of 0.2 % with two and a half periods over the way."""
    reach, speed = float(np.ptp(curve.force)), curve.speed  # one in each segment: no row is half turned
    tilt = (curve.position - curve.position[0]) / np.ptp(curve.position)
    drift, drag = curve.time / curve.time[-1], speed / np.abs(speed).max()
    wave = np.sin(5.0 * np.pi * tilt)
    return np.asarray(reach * (0.05 + 0.02 * tilt + 0.01 * drift + 0.005 * drag + 0.002 * wave))


def recover(number: int, kind: str = "cycles", posterior: bool = False) -> RecoveredMaterial:
    """Record and fit one material: ``cycles``, on an instrument's ``background`` too, or a ``retraction``."""
    if kind == "retraction":
        scene, guess = random_retraction(number)
        curves = [synthetic(scene, 2.0 * NOISE, seed=number, resolution=16)]
        settings = FitSettings(vary=RETRACTED, check_solver=None, posterior=posterior)
    else:
        [scene, *others], guess = random_scenes(number)
        curves = recorded(number, [scene, *others], kind == "background")
        free = ("background", "drift") if kind == "background" else ("baseline",)
        settings = FitSettings(vary=tuple(VARIED), free=free, check_solver=None, posterior=posterior)
    found = fit_curves(curves, guess, settings)
    own = found.estimates[: len(settings.vary)]
    sampled = found.posterior.intervals if found.posterior else {}
    return RecoveredMaterial(
        number,
        tuple(value_at(scene, path) for path in settings.vary),
        tuple(one.value for one in own),
        tuple(one.low for one in own),
        tuple(one.high for one in own),
        tuple(one.deviation for one in own),
        found.goodness.misfit_over_noise**2,
        found.goodness.explained,
        found.converged,
        found.seconds,
        tuple((one["low"], one["high"]) for one in sampled.values()),
    )


def judged(inside: Sequence[Sequence[bool]]) -> tuple[str, bool]:
    """How many intervals hold the truth, in words, and whether as many as should."""
    share, count = float(np.mean(inside)), int(np.size(inside))
    low, high = stats.beta.interval(0.95, share * count + 1.0, count - share * count + 1.0)
    sound = WITHIN[0] <= share <= WITHIN[1]
    verdict = "pass" if sound else "FAIL"
    if len(inside) < ENOUGH:
        verdict = f"judged from {ENOUGH} materials on"
    told = (
        f"{100 * share:.1f} % of the 95 % intervals hold the truth ({100 * low:.0f} to {100 * high:.0f} %), "
        f"to be 90 to 98 %: {verdict}"
    )
    return told, sound


def _paths(found: Sequence[RecoveredMaterial]) -> Sequence[str]:
    """What was fitted."""
    return next(paths for paths in (VARIED, RETRACTED) if len(paths) == len(found[0].truth))


def report(found: Sequence[RecoveredMaterial], failures: Sequence[str]) -> str:
    """The table, as Markdown."""
    inside = np.array([one.inside for one in found])
    scores = np.array([one.scores for one in found])
    paths = _paths(found)
    lines = [
        f"{len(found)} materials, {inside.size} intervals: {judged(inside.tolist())[0]}",
        "",
        "| parameter | inside | root mean square error / deviation | median deviation |",
        "|---|---|---|---|",
    ]
    sizes = np.array([one.deviation for one in found])
    for place, path in enumerate(paths):
        spread = float(np.sqrt(np.mean(scores[:, place] ** 2)))
        lines.append(
            f"| {LABELS[path]} | {100 * inside[:, place].mean():.0f} % | {spread:.2f} | "
            f"{100 * np.median(sizes[:, place]):.2f} % |"
        )
    if sampled := [one.inside_sampled for one in found if one.sampled]:
        lacking = f"; {len(found) - len(sampled)} materials have none" * (len(sampled) < len(found))
        lines += ["", f"Of the posterior {judged(sampled)[0]}{lacking}"]
    explained = sum(one.explained for one in found)
    seconds = np.median([one.seconds for one in found])
    lines += ["", f"{explained} of {len(found)} fits explain their data; median {seconds:.0f} s a fit."]
    lines += [f"- {failure}" for failure in failures]
    return "\n".join(lines) + "\n"


def draw(found: Sequence[RecoveredMaterial]) -> Figure:
    """Errors over standard deviations against the normal distribution."""
    figure, axes = drawing((4.8, 3.4))
    scores = np.sort(np.array([one.scores for one in found]), axis=0)
    quantiles = stats.norm.ppf((np.arange(len(found)) + 0.5) / len(found))
    for place, path in enumerate(_paths(found)):
        style: dict[str, Any] = {
            "linestyle": "none",
            "marker": MARKERS[place],
            "color": SERIES[place],
            "markersize": 3.5,
        }
        axes.plot(quantiles, scores[:, place], label=LABELS[path], fillstyle="none", **style)
    axes.plot([-3, 3], [-3, 3], color=INK, linewidth=0.8)
    axes.axhspan(-1.96, 1.96, color=GREY, alpha=0.2, linewidth=0, label="inside the 95 % interval")
    axes.axhline(0.0, color=VERMILION, linewidth=0.5)
    axes.set(xlabel="expected of a normal distribution", ylabel="(fitted - true)/stated deviation")
    format_axes(axes)
    axes.legend(frameon=False, fontsize="x-small", labelcolor=INK)
    return figure


def price(number: int, jobs: int) -> str:
    """Time of a fit with its check by a second solver, over that of as many runs of the reference."""
    scenes, guess = random_scenes(number)
    curves = recorded(number, scenes)
    settings = FitSettings(vary=tuple(VARIED), free=("baseline",), check_solver="bem")
    began = time.perf_counter()
    with processes(jobs) as executor:
        found = fit_curves(curves, guess, settings, executor)
    wall, began = time.perf_counter() - began, time.perf_counter()
    for scene in scenes:
        SOLVERS[REFERENCE].solve(scene, settings.resolution)
    bare = (time.perf_counter() - began) / len(scenes) * found.runs
    return f"{found.runs} runs in {wall:.0f} s: {wall / bare:.2f} of as many bare runs"


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line of this module; 1 if coverage is out of bounds or a fit failed."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.fit_recovery")
    parser.add_argument("--out", default="out/recovery")
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--count", type=int, default=50)
    parser.add_argument("--jobs", type=int, default=2)
    kinds = parser.add_mutually_exclusive_group()
    for kind, told in KINDS.items():
        kinds.add_argument(f"--{kind}", action="store_const", dest="kind", const=kind, help=told)
    parser.set_defaults(kind="cycles")
    parser.add_argument("--posterior", action="store_true", help="count its intervals, too")
    parser.add_argument("--price", type=int, metavar="NUMBER", help="of a material: time its fit")
    options = parser.parse_args(arguments)
    if options.price is not None:
        print(price(options.price, options.jobs))
        return 0
    folder = output_folder(options.out)
    store = Store(folder)
    numbers = range(options.first, options.first + options.count)
    tasks = [
        Task(
            fingerprint("recovery", n, options.kind, options.posterior),
            f"material {n}",
            recover,
            (n, options.kind, options.posterior),
            RecoveredMaterial,
        )
        for n in numbers
    ]
    done: dict[int, RecoveredMaterial] = {}
    failures: dict[int, str] = {}

    def write(result: TaskResult) -> None:
        number = int(result.task.arguments[0])
        if result.value is None:
            failures[number] = f"material {number}: {result.failure}"
        else:
            done[number] = result.value
            everything = [done[key] for key in sorted(done)]
            write_whole(folder / "recovery.json", to_json([vars(one) for one in everything]))
            write_whole(folder / "recovery.md", report(everything, list(failures.values())))

    with Progress("recovery", "fits") as progress, processes(options.jobs) as executor:
        run_tasks(tasks, executor, store, progress, write)
    found = [done[key] for key in sorted(done)]
    write_whole(folder / "recovery.png", png(draw(found)))
    print(report(found, list(failures.values())))
    sound = judged([one.inside for one in found])[1]
    if options.posterior:
        sampled = [one.inside_sampled for one in found if one.sampled]
        sound &= bool(sampled) and judged(sampled)[1]
    return 0 if sound and not failures else 1


if __name__ == "__main__":
    raise SystemExit(main())
