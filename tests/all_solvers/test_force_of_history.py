"""Times, penetrations and contact radii of a run tell its force: with adhesion, from the rows alone."""

from dataclasses import replace

import numpy as np
import pytest
from support.bem_runs import bem, front
from support.closed_forms.force_of_history import force_of_history
from support.paper_scenes import PULL, STICKY, scene

from contact_scene import Adhesion, Branch, Cone, Force, ForceRamp, Hold, Material, Ramp, Scene, Sphere, Trace

CLOSE = Material(0.75, 0.5, (Branch(3.0, 1.0), Branch(3.75, 1.05)))
SMALL = Material(1e6, 0.49, (Branch(3e6, 0.01), Branch(1e6, 1.0)))
SCENES = {
    "hold": scene(Ramp(0.032, 0.1), Hold(10.0), Ramp(-0.5, 0.1)),
    "close branches": scene(Ramp(0.02, 0.05), Hold(1.0), Ramp(-0.5, 0.05), material=CLOSE),
    "dead load": scene(Force(-4.0 * PULL, 100.0), start="relaxed", at=0.032),
    "force ramp": scene(ForceRamp(-1.0, 0.02), start="relaxed", at=0.032),
    "cone": scene(
        Ramp(0.1, 0.02), Ramp(-0.5, 0.02), at=0.03, indenter=Cone(70.0), adhesion=Adhesion(STICKY.work, 0.02)
    ),
    "small units": scene(
        Ramp(1e-6, 1e-6),
        Ramp(-1e-4, 1e-5),
        material=SMALL,
        indenter=Sphere(1e-4),
        adhesion=Adhesion(0.05, 1e-6),
    ),
}
QUICK = {"cone", "force ramp"}


def deviation(trace: Trace, asked: Scene, material: Material) -> float:
    rows = trace.contact_radius > 0.0
    columns = (trace.time[rows], trace.penetration[rows], trace.contact_radius[rows])
    found = force_of_history(material, asked.indenter, asked.loading.start, *columns)
    return float(np.abs(found - trace.force[rows]).max() / np.abs(trace.force).max())


@pytest.mark.parametrize("solve", [front, bem])
@pytest.mark.parametrize(
    "name", [pytest.param(name, marks=() if name in QUICK else pytest.mark.slow) for name in SCENES]
)
def test_raw_columns_of_a_run_belong_together(name, solve):
    asked = SCENES[name]
    trace, material = solve(asked, 8), asked.material
    assert deviation(trace, asked, material) < 1e-3
    stiffer = tuple(replace(branch, modulus=1.02 * branch.modulus) for branch in material.branches)
    assert deviation(trace, asked, replace(material, branches=stiffer)) > 3e-3
