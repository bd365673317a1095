"""How accurate a solver is with zones of every length under every kind of loading.

``python -m benchmarks.zone_accuracy SOLVER [SCENE ...]`` is ``crosscontact study --zones`` on scenes of
all kinds, with the curves and the time of detachment beside its errors.
"""

from __future__ import annotations

import argparse
import math
from collections.abc import Sequence
from dataclasses import replace

from contact_scene import Oscillate, SceneError
from validation import cases
from validation.solvers import SOLVERS
from validation.studies.knobs import Zones

SCENES = (
    *("cycle-v0.002", "cycle-v0.1", "retraction-v0.02", "retraction-fast", "dwell-1", "force-4"),
    *("pdms-dead-load-1um", "three-branches", "oscillation-w1.4", "cone-cycle", "elastic-relaxed"),
    "spring-relaxed-si",
)
"""Approach, reversal, dwell, dead loads with delayed detachment, oscillation, branches, jump at a spring."""
CYCLES = 10
"""Cycles of an oscillation: those that follow repeat them."""
MEASURES = ("pull_off_force", "loop_energy", "detachment_time")


def shortened(case: cases.Case) -> cases.Case:
    """The case with oscillations no longer than ``CYCLES``."""
    steps = tuple(
        replace(step, duration=min(step.duration, CYCLES * 2.0 * math.pi / step.angular_frequency))
        if isinstance(step, Oscillate)
        else step
        for step in case.scene.loading.steps
    )
    return replace(case, scene=replace(case.scene, loading=replace(case.scene.loading, steps=steps)))


def main(arguments: Sequence[str] | None = None) -> int:
    """Print a line for every scene and zone, the longest first; exit code 2 for what cannot be run."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("solver", choices=[*SOLVERS])
    parser.add_argument("scenes", nargs="*", default=SCENES, help="built-in names or TOML files")
    parser.add_argument("--zones", type=float, nargs="+", default=Zones.values, help="over the radius")
    chosen = parser.parse_args(arguments)
    for case in map(shortened, cases.load_all(chosen.scenes)):
        try:
            runs = Zones((chosen.solver,)).runs(case, chosen.zones)
        except SceneError as error:
            print(f"{case.name}: {error}")
            return 2
        for one in runs:
            apart = one.differences(MEASURES).values()
            errors = ", ".join(f"{each.quantity} {each.error:.1e}" for each in apart)
            ending = one.run.ending if one.run else one.skipped
            costs = ", ".join(f"{name} {value:.3g}" for name, value in one.costs.items())
            print(f"{case.name}, {one.value:.0e}: {costs}; {errors or 'no errors'}; {ending}", flush=True)
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
