"""Tamaas: pressures on square pixels, generalised Maxwell body, the mean pressure prescribed.

``MaxwellViscoelastic`` takes backward-Euler steps of one length; the moduli of its branches are shear moduli.
Stresses are given to it in units of the relaxed shear modulus ``G0 = E0/(2 (1 + nu))``: in any other unit its
memory of earlier steps is too large by ``1/G0`` (version 2.9.0; a test shows it), while its first step and
its elastic limits are right.

The cell of Tamaas is periodic by default; here its non-periodic operator is used. Contact radius: that of the
disc of the contact area, which Tamaas corrects for the steps of the outline. It returns no penetration.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from contact_scene import Force, ForceRamp, Scene, Sphere, Trace
from validation.solvers.base import RunOptions
from validation.solvers.peers.peer import Peer, beyond_a_sphere, trace_of

SPARE = 2.2
"""Side of the square over a bound of the contact radius: beyond 2, so that the contact ends inside it."""
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
        return beyond_a_sphere(scene)

    def default_resolution(self, scene: Scene) -> int:
        return 64

    def load(self) -> None:
        import tamaas

        tamaas.set_log_level(tamaas.LogLevel.error)

    def _solve(self, scene: Scene, resolution: int | None, options: RunOptions) -> Trace:
        import tamaas

        pixels = max(resolution or self.default_resolution(scene), self.least_resolution)
        time, force = _loading(scene, pixels)
        side = SPARE * _radius_bound(scene, float(time[-1]), float(force.max()))
        solver, model = _solver(scene, pixels, side, float(time[1] - time[0]))
        shear_modulus = scene.material.modulus / (2.0 * (1.0 + scene.material.poisson))
        radius = [0.0]
        for step, load in enumerate(force[1:], 1):
            if not solver.solve(float(load) / side**2 / shear_modulus) <= TOLERANCE:
                raise RuntimeError(f"Tamaas did not converge at time {time[step]:g}")
            pressure = np.asarray(model.traction)
            outline = sum(one.perimeter for one in tamaas.FloodFill.getClusters(pressure > 0.0, False))
            share = tamaas.Statistics2D.contact(pressure, outline)
            radius.append(side * float(np.sqrt(max(share, 0.0) / np.pi)))
            if options.progress is not None:
                options.progress(step / (len(time) - 1))
        return trace_of(self, time, np.zeros_like(time), force, np.array(radius))


def _radius_bound(scene: Scene, end: float, largest_force: float) -> float:
    """No contact radius is larger: ``a^3 <= 3/4 F R J(end)``, and creep compliance times modulus <= 1."""
    assert isinstance(scene.indenter, Sphere)
    modulus = float(scene.material.relaxation_modulus(end)) / (1.0 - scene.material.poisson**2)
    return float(np.cbrt(0.75 * largest_force * scene.indenter.radius / modulus))


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
    """Solver and model of Tamaas for a scene; stresses in units of the relaxed shear modulus."""
    import tamaas

    material = scene.material
    assert isinstance(scene.indenter, Sphere)
    model = tamaas.Model(tamaas.model_type.basic_2d, [side, side], [pixels, pixels])
    model.nu = material.poisson
    model.E = 2.0 * (1.0 + material.poisson)
    x = (np.arange(pixels) + 0.5) * side / pixels - 0.5 * side
    heights = -(x[:, None] ** 2 + x[None, :] ** 2) / (2.0 * scene.indenter.radius)
    moduli, times = material.spectrum
    shear = (moduli / material.modulus).tolist()
    solver = tamaas.MaxwellViscoelastic(model, heights, TOLERANCE, time_step, shear, times.tolist())
    tamaas.ModelFactory.registerNonPeriodic(model, "dcfft")
    solver.setIntegralOperator("dcfft")
    solver.dump_freq = 10**6
    return solver, model
