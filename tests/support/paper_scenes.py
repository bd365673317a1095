"""The paper's sphere, rubber and adhesion, and scenes made of them: the same for the tests of every solver.

Units of the sphere's radius and of the relaxed plane modulus: ``E0/(1 - nu^2) = 1``.
"""

from __future__ import annotations

import numpy as np

from contact_scene import Adhesion, Branch, Loading, Material, Ramp, Scene, Sphere, Step

WORK = 1.6e-4 * np.pi  # of adhesion
ZONE = 0.013  # length of the process zone
PULL = 1.5 * np.pi * WORK  # JKR pull-off force
ELASTIC = Material(0.75, 0.5)  # relaxed
ONE = Material(0.75, 0.5, (Branch(6.75, 1.0),))
THREE = Material(0.75, 0.5, (Branch(3.0, 0.1), Branch(2.75, 1.0), Branch(1.0, 8.0)))
STICKY = Adhesion(WORK, ZONE)
SPHERE = Sphere(1.0)


def scene(*steps: Step, start="jump-in", at=0.0, material=ONE, indenter=SPHERE, adhesion=STICKY) -> Scene:
    """A scene of the paper's sphere, rubber and adhesion, where no others are named."""
    return Scene(material, indenter, Loading(start, at, steps), adhesion)


def cycle(rate: float, depth: float = 0.032, **others) -> Scene:
    """Approach from the jump into contact, and retraction until the contact is lost."""
    return scene(Ramp(depth, rate), Ramp(-0.5, rate), **others)
