"""A short zone that opens steadily: how closely every row follows the closed law, by solver and resolution.

``python -m benchmarks.steady_edge`` runs the scenes ``steady-rate-si`` and ``steady-stress-si``. The
energy release rate at a row is that of the relaxed contact without a zone at the row's force and radius; the
speed of the edge is the slope of the radius there. Against it stands the law of
:mod:`validation.reference.rated_edge` at that speed.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product

import numpy as np
from numpy.typing import NDArray

from contact_scene import Scene, Trace
from validation.cases import load
from validation.reference.jkr import JKR
from validation.reference.rated_edge import SteadyEdge
from validation.solvers import SOLVERS

Array = NDArray[np.float64]

SCENES = ("steady-rate-si", "steady-stress-si")
RESOLUTIONS = (6, 12, 24)
_SET_OUT = 0.95
"""Contact radius, in that of the start, from which on the edge moves steadily, a thousand zones on."""


def relaxed_contact(scene: Scene) -> JKR:
    """The relaxed contact without a zone."""
    assert scene.adhesion is not None
    return JKR(scene.indenter, scene.material.relaxed_plane_modulus, scene.adhesion.work)


def steady_edge(scene: Scene) -> SteadyEdge:
    """The closed law of a scene."""
    law = relaxed_contact(scene)
    assert scene.adhesion is not None
    return SteadyEdge(
        scene.adhesion, lambda a, depth: float(law.energy_release_rate(a, depth)), scene.material
    )


@dataclass(frozen=True)
class SteadyRows:
    """Rows of a run that the edge passes steadily: speed, energy release rate and that of the law, (n,) each.

    ``enhancement`` (n,) is the part of the half-space in the law; the rest is the work at the speed.
    """

    speed: Array
    release_rate: Array
    law: Array
    enhancement: Array

    @property
    def errors(self) -> Array:
        """Relative difference of the energy release rate from the law, shape (n,)."""
        return self.release_rate / self.law - 1.0


def steady_rows(scene: Scene, trace: Trace) -> SteadyRows:
    """The rows of a retraction between setting out and the last row, at which a slope is one-sided."""
    radius, edge = trace.contact_radius, steady_edge(scene)
    chosen = radius < _SET_OUT * radius[0]
    chosen[-1] = False
    speed = -np.gradient(radius, trace.time)[chosen]
    release = relaxed_contact(scene).energy_release_rate_from_force(radius, trace.force)[chosen]
    pairs = list(zip(speed.tolist(), release.tolist(), strict=True))
    law = np.array([edge.taken(v, g) for v, g in pairs])
    return SteadyRows(speed, release, law, np.array([edge.enhancement(v, g) for v, g in pairs]))


def main(arguments: Sequence[str] | None = None) -> None:
    """Print a row for each scene, solver and resolution."""
    parser = argparse.ArgumentParser(description="energy release rate at every row against the steady edge")
    parser.add_argument("--scene", nargs="+", choices=SCENES, default=SCENES)
    parser.add_argument("--solver", nargs="+", choices=sorted(SOLVERS), default=("reference", "bem", "fem"))
    parser.add_argument("--resolution", type=int, nargs="+", default=RESOLUTIONS)
    chosen = parser.parse_args(arguments)
    print("| scene | solver | resolution | largest error | RMS | rows | seconds |\n" + "|---" * 7 + "|")
    for name, solver, resolution in product(chosen.scene, chosen.solver, chosen.resolution):
        scene, began = load(name).scene, time.process_time()
        trace = SOLVERS[solver].solve(scene, resolution)
        seconds, errors = time.process_time() - began, steady_rows(scene, trace).errors
        largest, rms = float(np.abs(errors).max()), float(np.sqrt(np.mean(errors**2)))
        print(
            f"| {name} | {solver} | {resolution} | {largest:.1e} | {rms:.1e} | {len(trace)} "
            f"| {seconds:.1f} |",
            flush=True,
        )


if __name__ == "__main__":
    main()
