"""How large the contact will become: what the number of annuli is chosen from."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from bem_solver.annuli import Annuli
from bem_solver.start import contact_scale, elastic_twin, empty_front, equilibrium
from bem_solver.trial import Problem
from scene import Scene

_COARSE = 24


def largest_contact(scene: Scene, problem: Problem) -> float:
    """Estimate of the largest contact radius: the relaxed equilibrium at the largest load of every step.

    It need not be exact: annuli travel with the edge, whatever its radius.
    """
    twin = elastic_twin(replace(problem, annuli=Annuli(_COARSE)), scene.material.modulus)
    radius, penetration, force = 0.0, scene.loading.penetration, 0.0

    def settle(control: str, value: float) -> tuple[float, float, float]:
        deepest = penetration if control == "force" else value
        scale = max(contact_scale(scene, deepest), radius)
        if control == "force":
            # force over 2 E* a is a length; the profile is that high somewhere
            guess = abs(value) / (2.0 * twin.chain.relaxed)
            scale = max(scale, contact_scale(scene, guess / scale if scale > 0 else guess**0.5))
        if scale == 0.0:
            return 0.0, penetration, 0.0
        found = equilibrium(twin, empty_front(twin, 0.0, 0.0), control, value, scale)
        if found is None:
            return 0.0, value if control == "penetration" else penetration, 0.0
        return found.surface.edge, found.motion.new_penetration, found.surface.force

    radius, penetration, force = settle("penetration", penetration)
    for step in scene.loading.steps:
        segment = step.segment(0.0, penetration, force)
        times = np.unique(np.concatenate((np.linspace(segment.start, segment.end, 129), segment.kinks)))
        values = [segment.value(float(t)) for t in times]
        edge, _, _ = settle(segment.control, max(values))
        radius = max(radius, edge)
        if segment.control == "force":
            _, penetration, force = settle("force", values[-1])
        else:
            penetration = values[-1]
    return min(radius, scene.indenter.edge)
