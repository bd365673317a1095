"""The runs that claims rest on: sweeps around the built-in scenes, and how their results are looked up.

Every sweep varies the loading (or the zone) of a built-in scene, so that whatever the paper fixes is stated
once, in that scene's file.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, replace

from contact_scene import Adhesion, Hold, Loading, Ramp, Scene, SurfaceProfile, Trace
from validation.cases import Case, load
from validation.measure.scaling import unit_sizes
from validation.runs.run import Run
from validation.solvers import REFERENCE
from validation.solvers.boundary_elements import BoundaryElements

SOLVER = BoundaryElements.name
"""The solver whose runs the statements are evaluated on: the paper's own method."""
BOTH = (SOLVER, REFERENCE)

DEPTH = 0.032
"""Penetration of point B of Fig. 4, over R; also the largest of Fig. 2, which the paper does not state."""
BELOW = -0.5
"""Penetration to which retractions are prescribed, over R; contact is lost long before."""

CYCLE_SPEEDS = (1e-6, 2e-5, 1e-4, 5e-4, 2e-3, 6e-3, 2e-2, 5e-2, 0.1, 0.3, 1.0, 10.0, 100.0)
RETRACTION_SPEEDS = (1e-6, 1e-5, 5e-5, 2e-4, 5e-4, 1e-3, 2e-3, 6e-3, 2e-2, 0.1, 0.5, 2.0, 10.0, 100.0)
"""``V tau/R`` of the sweeps over cycles (Fig. 2) and over retractions from the relaxed contact (Fig. 4)."""
PRELOADS = (0.004, 0.01, 0.02, 0.032, 0.05, 0.08)
PRELOAD_SPEEDS = (0.02, 0.1, 1.0, 100.0)
"""Penetrations, over R, from which the relaxed contact is pulled off, and speeds (Fig. 4(c))."""
DWELLS = (0.0, 0.1, 0.3, 1.0, 3.0, 10.0, 30.0, 100.0, 300.0)
DWELL_SPEEDS = (0.02, 0.1, 1.0)
"""Rests at the largest penetration, over the relaxation time, and speeds."""
HALF_ZONE, HALF_ZONE_SPEEDS = 0.0065, (1e-3, 3e-3, 1e-2, 5e-2)
"""Half the process zone, and the speeds of cycles with it."""
FORCES = (2, 4, 8)
"""Constant tensions, over ``F_JKR`` (Fig. 5)."""
FREQUENCIES = ("0.35", "1.4")
"""Angular frequencies of the built-in oscillations, times the relaxation time (Fig. 6)."""
MATCHED = {2: 2.371e-4, 4: 1.175e-3, 8: 6.04e-3}
"""Speed of the retraction whose pull-off force is that many ``F_JKR``."""
SURFACES = "cycle-v0.002"
"""Built-in scene whose surface is kept at several times (Fig. 3)."""
CHECKED_SPEEDS = (2e-4, 10.0)
"""Speeds of the retractions that the reference does, too."""


class MissingRun(LookupError):
    """A run that a claim needs is missing or did not finish."""


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


def without_title(scene: Scene) -> Scene:
    """The scene without its title: equal for two scenes that ask for the same run."""
    return replace(scene, title="")


def required_runs() -> list[tuple[Case, str]]:
    """All runs that claims rest on, as scene and solver, each once."""
    names = [SURFACES, "sweep", "retraction-steady"]
    names += [f"force-{force}" for force in FORCES] + [f"oscillation-w{w}" for w in FREQUENCIES]
    scenes = [cycle(speed) for speed in CYCLE_SPEEDS]
    scenes += [cycle(speed, HALF_ZONE) for speed in HALF_ZONE_SPEEDS]
    scenes += [cycle(speed, dwell=dwell) for speed in DWELL_SPEEDS for dwell in DWELLS]
    scenes += [retraction(speed) for speed in (*RETRACTION_SPEEDS, *MATCHED.values())]
    scenes += [retraction(speed, depth) for depth in PRELOADS for speed in PRELOAD_SPEEDS]
    cases: dict[Scene, Case] = {without_title(case.scene): case for case in map(load, names)}
    for scene in scenes:
        cases.setdefault(without_title(scene), Case(scene.title, scene))
    checked = [load(SURFACES), *(Case(one.title, one) for one in map(retraction, CHECKED_SPEEDS))]
    return [(case, SOLVER) for case in cases.values()] + [(case, REFERENCE) for case in checked]


def missing_runs(planned: Iterable[tuple[Case, str]]) -> list[tuple[Case, str]]:
    """The runs that claims need and that are not among the ``planned``."""

    def question(case: Case, solver: str) -> tuple[Scene, str, tuple[float, ...]]:
        return without_title(case.scene), solver, case.profile_times

    covered = {question(*task) for task in planned}
    return [task for task in required_runs() if question(*task) not in covered]


@dataclass(frozen=True)
class Evidence:
    """Runs by scene (without its title) and solver; a scene is asked for as such or by a built-in name."""

    runs: Mapping[tuple[Scene, str], Run]

    def run(self, scene: Scene | str, solver: str = SOLVER) -> Run:
        """A finished run, or ``MissingRun``."""
        scene = _scene(scene)
        result = self.runs.get((without_title(scene), solver))
        if result is None or not result.finished:
            why = "not run" if result is None else result.ending
            raise MissingRun(f"{scene.title} by {solver}: {why}")
        return result

    def trace(self, scene: Scene | str, solver: str = SOLVER) -> Trace:
        """The rows of a run."""
        trace = self.run(scene, solver).trace
        assert trace is not None
        return trace

    def measure(self, scene: Scene | str, name: str, solver: str = SOLVER) -> float:
        """A scalar of a run, as of ``Run.measures``, in the scene's units."""
        result = self.run(scene, solver)
        value = result.measures.get(name)
        if value is None:
            raise MissingRun(f"{result.scene} by {solver}: no {name}")
        return value

    def pull_off(self, scene: Scene | str, solver: str = SOLVER) -> float:
        """Pull-off force over ``F_JKR``."""
        return self.measure(scene, "pull_off_force", solver) / unit_sizes(_scene(scene))["jkr-force"]

    def pull_offs(self, scene_of: Callable[[float], Scene], over: Iterable[float]) -> dict[float, float]:
        """Pull-off force over ``F_JKR`` along a sweep."""
        return {x: self.pull_off(scene_of(x)) for x in over}

    def profiles(self, solver: str = SOLVER) -> list[SurfaceProfile]:
        """Surface along the cycle of Fig. 3, at the times the scene names, in order."""
        recorded = self.trace(SURFACES, solver).profiles
        if len(recorded) < len(load(SURFACES).profile_times):
            raise MissingRun(f"{SURFACES} by {solver}: no surface at some of the times it names")
        return sorted(recorded, key=lambda profile: profile.time)


def _scene(scene: Scene | str) -> Scene:
    return load(scene).scene if isinstance(scene, str) else scene


def collect(tasks: Iterable[tuple[Case, str]], results: Mapping[tuple[str, str], Run]) -> Evidence:
    """Runs keyed by name and solver, turned into evidence."""
    return Evidence(
        {(without_title(case.scene), solver): results[case.name, solver] for case, solver in tasks}
    )
