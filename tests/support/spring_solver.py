"""A stand-in for the solvers: a spring of the given stiffness follows every ramp, then lets go."""

from __future__ import annotations

import dataclasses

import numpy as np

from contact_scene import Counters, Outcome, OutcomeKind, Scene, Trace

SCENE = """
title = "A small scene"
[material]
modulus = 0.75
poisson = 0.5
[indenter]
shape = "sphere"
radius = 1.0
[adhesion]
work = 5e-4
zone = 0.013
[loading]
start = "jump-in"
penetration = 0.0
[[loading.steps]]
kind = "ramp"
to = 0.03
rate = 0.01
[[loading.steps]]
kind = "ramp"
to = -0.01
rate = 0.01
"""


def fake(stiffness: float = 1.0, kind: OutcomeKind = OutcomeKind.DETACHED, poison: bool = False):
    """A solver factory, to be put into ``validation.solvers.SOLVERS``."""

    def call(scene: Scene, resolution, tolerance, profile_times, progress, watch=None) -> Trace:
        time, depth = [0.0], [scene.loading.penetration]
        for step in scene.loading.steps:
            segment = step.segment(time[-1], depth[-1], 0.0)
            for at in np.linspace(segment.start, segment.end, 20)[1:]:
                time.append(float(at))
                depth.append(segment.value(float(at)))
        if progress is not None:
            progress(0.5)
        t, d = np.array(time), np.array(depth)
        force = stiffness * d
        if poison:
            force[-1] = np.nan
        outcome = Outcome(kind, "as told", float(t[-1]))
        energy = 0.5 * stiffness * d**2
        return Trace(
            "bem", t, d, force, np.full_like(t, 0.2), energy, energy, 0 * t, outcome, Counters(steps=len(t))
        )

    return lambda: call


def named(name: str, factory):
    """The same factory, its traces signed by ``name``."""

    def make():
        call = factory()
        return lambda *arguments: dataclasses.replace(call(*arguments), solver=name)

    return make
