"""The runs that claims rest on: sweeps around the built-in scenes, and where their answers are kept.

Every sweep varies the loading (or the zone) of a built-in scene, so that whatever the paper fixes is stated
once, in that scene's file. Runs go through :func:`validation.execution.runs.run_all`, hence through any
``concurrent.futures`` executor: a process pool, Dask's ``Client.get_executor()``, an MPI pool.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from concurrent.futures import Executor
from dataclasses import dataclass, replace

from contact_scene import Adhesion, Hold, Loading, Ramp, Scene, Trace
from validation.cases import Case, load
from validation.execution.runs import Run, run_all
from validation.measure.dimensionless import units
from validation.solvers import REFERENCE

DEPTH = 0.032  # R: point B of Fig. 4; also the largest penetration of Fig. 2, which the paper leaves out
BELOW = -0.5  # R: contact is lost long before

CYCLE_SPEEDS = (1e-6, 2e-5, 1e-4, 5e-4, 2e-3, 6e-3, 2e-2, 5e-2, 0.1, 0.3, 1.0, 10.0, 100.0)
RETRACTION_SPEEDS = (1e-6, 1e-5, 5e-5, 2e-4, 5e-4, 1e-3, 2e-3, 6e-3, 2e-2, 0.1, 0.5, 2.0, 10.0, 100.0)
PRELOADS = (0.004, 0.01, 0.02, 0.032, 0.05, 0.08)
PRELOAD_SPEEDS = (0.02, 0.1, 1.0, 100.0)
DWELLS = (0.0, 0.1, 0.3, 1.0, 3.0, 10.0, 30.0, 100.0, 300.0)
DWELL_SPEEDS = (0.02, 0.1, 1.0)
HALF_ZONE_SPEEDS = (1e-3, 3e-3, 1e-2, 5e-2)  # cycles with half the process zone
FORCES = (2, 4, 8)
FREQUENCIES = ("0.35", "1.4")
MATCHED = {
    2: 2.371e-4,
    4: 1.175e-3,
    8: 6.04e-3,
}  # speed of the retraction whose pull-off force is that many F_JKR


class Missing(LookupError):
    """A run that a claim needs gave no full answer."""


def cycle(speed: float, zone: float = 0.013, dwell: float = 0.0) -> Scene:
    """Approach and retraction at one speed (Fig. 2), with a rest between them (dwell-time figure)."""
    scene = load("cycle-v0.02").scene
    assert scene.adhesion is not None
    rest = (Hold(dwell),) if dwell > 0.0 else ()
    steps = (Ramp(DEPTH, speed), *rest, Ramp(BELOW, speed))
    title = f"Cycle, V = {speed:g}, da = {zone:g}, dwell {dwell:g}"
    adhesion = Adhesion(scene.adhesion.work, zone)
    return replace(scene, title=title, adhesion=adhesion, loading=Loading("jump-in", 0.0, steps))


def retraction(speed: float, depth: float = DEPTH) -> Scene:
    """Retraction from the relaxed contact (Fig. 4)."""
    scene = load("retraction-fast").scene
    title = f"Retraction from {depth:g}, V = {speed:g}"
    return replace(scene, title=title, loading=Loading("relaxed", depth, (Ramp(BELOW, speed),)))


def key(scene: Scene) -> Scene:
    """What makes two scenes the same question."""
    return replace(scene, title="")


def questions() -> list[tuple[Case, str]]:
    """All runs, as scene and solver; a question that comes up twice is asked once."""
    scenes = [cycle(speed) for speed in CYCLE_SPEEDS]
    scenes += [cycle(speed, zone=0.0065) for speed in HALF_ZONE_SPEEDS]
    scenes += [cycle(speed, dwell=dwell) for speed in DWELL_SPEEDS for dwell in DWELLS]
    scenes += [retraction(speed) for speed in RETRACTION_SPEEDS]
    scenes += [retraction(speed) for speed in MATCHED.values()]
    scenes += [retraction(speed, depth) for depth in PRELOADS for speed in PRELOAD_SPEEDS]
    names = ["cycle-v0.002", "sweep", "retraction-steady"]
    names += [f"force-{force}" for force in FORCES] + [f"oscillation-w{w}" for w in FREQUENCIES]
    asked: dict[Scene, Case] = {key(case.scene): case for case in map(load, names)}
    for scene in scenes:
        asked.setdefault(key(scene), Case(scene.title, scene))
    tasks = [(case, "bem") for case in asked.values()]
    checked = [load("cycle-v0.002"), *(Case(s.title, s) for s in map(retraction, (2e-4, 10.0)))]
    return tasks + [(case, REFERENCE) for case in checked]


@dataclass(frozen=True)
class Evidence:
    """Runs by what was asked and who answered."""

    runs: dict[tuple[Scene, str], Run]

    def run(self, scene: Scene | str, solver: str = "bem") -> Run:
        """A finished run of a scene or a built-in name.

        Raises
        ------
        Missing
            If there is none.
        """
        asked = load(scene).scene if isinstance(scene, str) else scene
        found = self.runs.get((key(asked), solver))
        if found is None or not found.finished:
            why = "not run" if found is None else found.ending
            raise Missing(f"{asked.title} by {solver}: {why}")
        return found

    def trace(self, scene: Scene | str, solver: str = "bem") -> Trace:
        """Its time series."""
        trace = self.run(scene, solver).trace
        assert trace is not None
        return trace

    def measure(self, scene: Scene | str, name: str, solver: str = "bem") -> float:
        """One of its scalars, in the scene's units."""
        found = self.run(scene, solver)
        value = found.measures.get(name)
        if value is None:
            raise Missing(f"{found.scene} by {solver}: no {name}")
        return value

    def pull_off(self, scene: Scene | str, solver: str = "bem") -> float:
        """Pull-off force over ``F_JKR``."""
        asked = load(scene).scene if isinstance(scene, str) else scene
        return self.measure(asked, "pull_off_force", solver) / units(asked)["jkr-force"]


def outstanding(planned: Iterable[tuple[Case, str]]) -> list[tuple[Case, str]]:
    """The questions that ``planned`` runs do not answer."""
    answered = {(key(case.scene), solver, case.profile_times) for case, solver in planned}
    return [(case, s) for case, s in questions() if (key(case.scene), s, case.profile_times) not in answered]


def gather(
    tasks: Iterable[tuple[Case, str]],
    executor: Executor | None = None,
    progress: Callable[[float, str], None] | None = None,
) -> Evidence:
    """Run ``tasks``, here or through an executor."""
    todo = list(tasks)
    return collect(todo, run_all(todo, executor, progress=progress))


def collect(tasks: Iterable[tuple[Case, str]], results: Mapping[tuple[str, str], Run]) -> Evidence:
    """Runs keyed by name and solver, turned into evidence."""
    return Evidence({(key(case.scene), solver): results[case.name, solver] for case, solver in tasks})
