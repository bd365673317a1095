"""The paper's dimensionless quantities, and the units in which check values are stated.

``Delta~ = Delta/R``, ``a~ = a/R``, ``F~ = (1 - nu^2) F/(pi E0 R^2)``, ``L~ = (1 - nu^2) L/(pi E0 R^3)``,
``F_JKR = 3 pi dgamma R/2`` (paper, Sec. III). They need the sphere's radius; other scenes keep their units.
"""

from __future__ import annotations

import math

from contact_scene import Scene, Sphere


def unit_sizes(scene: Scene) -> dict[str, float]:
    """Size of every unit in the units of the scene; always holds ``""`` = 1."""
    known = {"": 1.0}
    if isinstance(scene.indenter, Sphere):
        radius = scene.indenter.radius
        stiffness = math.pi * scene.material.relaxed_plane_modulus
        known |= {"length": radius, "force": stiffness * radius**2, "energy": stiffness * radius**3}
        if scene.adhesion is not None and scene.is_adhesive:
            known["jkr-force"] = 1.5 * math.pi * scene.adhesion.work * radius
    return known


SYMBOLS = {"": "", "length": "R", "force": "πE₀R²/(1−ν²)", "energy": "πE₀R³/(1−ν²)", "jkr-force": "F_JKR"}
