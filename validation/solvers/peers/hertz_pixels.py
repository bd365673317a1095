"""ContactMechanics: elastic half-space on square pixels, the penetration prescribed, no adhesion.

At some penetrations its iteration does not end; these rows are left out and counted as rejected steps.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from contact_scene import Scene, Sphere, Trace
from validation.solvers.base import RunOptions
from validation.solvers.peers.peer import Peer, elastic_ramps, ramp_times, trace_of

SPARE = 2.8
"""Side of the square over the largest contact radius: beyond 2, so that the contact ends inside it."""
ROWS = 12
"""Penetrations along a ramp, at each of which a contact problem is solved."""
OVERLAP = 1e-6
"""Overlap at which the iteration ends, relative to the largest penetration."""
MOST_ITERATIONS = 300
"""Iterations at one penetration: those that end take 15 to 50. A penetration beyond them is left out."""


class HertzOnPixels(Peer):
    """``resolution`` pixels a side."""

    name = "contact-mechanics"
    title = "ContactMechanics: pixels"
    distribution = module = "ContactMechanics"
    least_resolution = 16

    def outside(self, scene: Scene) -> str:
        """Adhesion, relaxation, force control, other shapes."""
        return "adhesion" if scene.is_adhesive else elastic_ramps(scene)

    def default_resolution(self, scene: Scene) -> int:
        return 32

    def load(self) -> None:
        import ContactMechanics.Systems  # noqa: F401
        import SurfaceTopography  # noqa: F401

    def _solve(self, scene: Scene, resolution: int | None, options: RunOptions) -> Trace:
        from ContactMechanics import FreeFFTElasticHalfSpace
        from ContactMechanics.Systems import NonSmoothContactSystem
        from SurfaceTopography import make_sphere

        pixels = max(resolution or self.default_resolution(scene), self.least_resolution)
        assert isinstance(scene.indenter, Sphere)
        time, depth = ramp_times(scene, ROWS)
        side = SPARE * float(np.sqrt(scene.indenter.radius * depth.max()))
        shape, size = (pixels, pixels), (side, side)
        substrate = FreeFFTElasticHalfSpace(shape, scene.material.relaxed_plane_modulus, size)
        surface = make_sphere(scene.indenter.radius, shape, size, kind="paraboloid")
        system = NonSmoothContactSystem(substrate, surface)
        force, radius = np.zeros_like(time), np.zeros_like(time)
        solved = np.ones(time.shape, bool)
        accuracy = {"pentol": OVERLAP * float(depth.max()), "maxiter": MOST_ITERATIONS}
        for row, offset in enumerate(depth):
            if offset > 0.0:
                solved[row] = bool(system.minimize_proxy(offset=float(offset), **accuracy).success)
            if offset > 0.0 and solved[row]:
                force[row] = system.compute_normal_force()
                radius[row] = np.sqrt(system.compute_contact_area() / np.pi)
            if options.progress is not None:
                options.progress((row + 1) / len(time))
        left_out = int(np.count_nonzero(~solved))
        time, depth, force, radius = (column[solved] for column in (time, depth, force, radius))
        end = int(np.flatnonzero(radius > 0.0)[-1]) + 2
        if end <= len(time):  # free from the penetration zero on, which lies between two rows
            part = depth[end - 2] / (depth[end - 2] - depth[end - 1])
            time[end - 1] = time[end - 2] + part * (time[end - 1] - time[end - 2])
            depth[end - 1] = 0.0
        lost = end <= len(time)
        found = trace_of(self, time[:end], depth[:end], force[:end], radius[:end], lost)
        return replace(found, counters=replace(found.counters, rejected_steps=left_out))
