"""The paper's sphere on rubber, with its glue, and scenes made of them: the same for every solver's tests."""

from __future__ import annotations

import numpy as np

from contact_scene import Adhesion, Branch, Loading, Material, Ramp, Scene, Sphere, Step

WORK = 1.6e-4 * np.pi
ZONE = 0.013
PULL = 1.5 * np.pi * WORK  # JKR pull-off force
ELASTIC = Material(0.75, 0.5)
ONE = Material(0.75, 0.5, (Branch(6.75, 1.0),))
THREE = Material(0.75, 0.5, (Branch(3.0, 0.1), Branch(2.75, 1.0), Branch(1.0, 8.0)))
STICKY = Adhesion(WORK, ZONE)
SPHERE = Sphere(1.0)


def scene(*steps: Step, start="jump-in", at=0.0, material=ONE, indenter=SPHERE, adhesion=STICKY) -> Scene:
    """A scene, the paper's sphere unless told otherwise."""
    return Scene(material, indenter, Loading(start, at, steps), adhesion)


def cycle(rate: float, depth: float = 0.032, **others) -> Scene:
    """Approach from the jump into contact, and retraction until the contact is lost."""
    return scene(Ramp(depth, rate), Ramp(-0.5, rate), **others)
