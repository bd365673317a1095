"""Tamaas: pressures on square pixels, generalised Maxwell body, the mean pressure prescribed.

``MaxwellViscoelastic`` takes steps of one length. The cell of Tamaas is periodic by default; here its
non-periodic operator is used. Contact radius: that of the disc whose area all loaded pixels cover. The
model's Young's modulus is the relaxed one (one long step gives Hertz with it); the moduli of the branches are
shear moduli. It returns no penetration.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from contact_scene import Force, ForceRamp, Scene, Sphere, Trace
from validation.solvers.base import RunOptions
from validation.solvers.peers.peer import Peer, not_a_sphere, trace_of

SPARE = 2.8
"""Side of the square over the largest contact radius: beyond 2, so that the contact ends inside it."""
TOLERANCE = 1e-8
"""Complementarity error at which Tamaas ends its iteration, relative as it defines it."""


class ViscoelasticPixels(Peer):
    """``resolution`` pixels a side, and as many time steps over the whole loading."""

    name = "tamaas"
    title = "Tamaas: pixels, fixed steps"
    distribution = module = "tamaas"
    columns = ("time", "force", "contact_radius")
    least_resolution = 16

    def outside(self, scene: Scene) -> str:
        """Adhesion, penetration control, elastic scenes, other shapes, a start in contact."""
        if scene.is_adhesive:
            return "adhesion"
        if scene.material.is_elastic:
            return "a material without branches"
        steps = scene.loading.steps
        if not steps or not all(isinstance(step, (Force, ForceRamp)) for step in steps):
            return "a prescribed penetration"
        if scene.loading.penetration != 0.0:
            return "a start in contact"
        return not_a_sphere(scene)

    def default_resolution(self, scene: Scene) -> int:
        """64."""
        return 64

    def load(self) -> None:
        """Import Tamaas."""
        import tamaas

        tamaas.set_log_level(tamaas.LogLevel.error)

    def _solve(self, scene: Scene, resolution: int | None, options: RunOptions) -> Trace:
        pixels = max(resolution or self.default_resolution(scene), self.least_resolution)
        time, force = _loading(scene, pixels)
        assert isinstance(scene.indenter, Sphere)
        modulus = scene.material.relaxed_plane_modulus
        side = SPARE * float(np.cbrt(0.75 * force.max() * scene.indenter.radius / modulus))
        solver, model = _solver(scene, pixels, side, float(time[1] - time[0]))
        radius = [0.0]
        for step, load in enumerate(force[1:], 1):
            solver.solve(float(load) / side**2)
            loaded = np.count_nonzero(np.asarray(model.traction) > 0.0)
            radius.append(float(np.sqrt(loaded / np.pi)) * side / pixels)
            if options.progress is not None:
                options.progress(step / (len(time) - 1))
        return trace_of(self, time, np.zeros_like(time), force, np.array(radius))


def _loading(scene: Scene, steps: int) -> tuple[Any, Any]:
    """Equal times over the whole loading and the forces there, each of shape (steps + 1,)."""
    segments = [segment for _, segment in scene.loading.segments(lambda step: _state(scene, step))]
    time = np.linspace(0.0, segments[-1].end, steps + 1)
    force = [next(one.value(float(t)) for one in segments if t <= one.end) for t in time]
    return time, np.array(force)


def _state(scene: Scene, step: object) -> tuple[float, float]:
    """Penetration, which is not known, and force at the start of a load step."""
    steps = scene.loading.steps
    index = next(i for i, one in enumerate(steps) if one is step)
    before = steps[index - 1] if index else None
    force = getattr(before, "to", getattr(before, "value", 0.0))
    return 0.0, float(force)


def _solver(scene: Scene, pixels: int, side: float, time_step: float) -> tuple[Any, Any]:
    """Solver and model of Tamaas for a scene."""
    import tamaas

    material = scene.material
    assert isinstance(scene.indenter, Sphere)
    model = tamaas.Model(tamaas.model_type.basic_2d, [side, side], [pixels, pixels])
    model.E, model.nu = material.modulus, material.poisson
    x = (np.arange(pixels) + 0.5) * side / pixels - 0.5 * side
    heights = -(x[:, None] ** 2 + x[None, :] ** 2) / (2.0 * scene.indenter.radius)
    moduli, times = material.spectrum
    shear = (moduli / (2.0 * (1.0 + material.poisson))).tolist()
    solver = tamaas.MaxwellViscoelastic(model, heights, TOLERANCE, time_step, shear, times.tolist())
    tamaas.ModelFactory.registerNonPeriodic(model, "dcfft")
    solver.setIntegralOperator("dcfft")
    solver.dump_freq = 10**6
    return solver, model
