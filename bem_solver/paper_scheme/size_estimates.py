"""Width and number of the uniform annuli, from an estimate of the largest contact."""

from __future__ import annotations

import math

from bem_solver.annuli import Annuli
from bem_solver.closure import ClosureRule
from bem_solver.creep import Chain
from bem_solver.paper_scheme.annuli import UniformAnnuli
from bem_solver.problem import Problem
from bem_solver.size_estimates import FEWEST_ANNULI, MOST_ANNULI, largest_contact
from bem_solver.start import contact_scale
from contact_scene import Counters, Scene, UnsupportedScene

_MARGIN = 1.1
"""Outermost contact allowed for, relative to the estimate of the largest contact radius."""
_PER_RADIUS = 10
"""Annuli in the largest contact without adhesion, in multiples of the resolution."""


def estimated_largest_radius(scene: Scene, chain: Chain) -> float:
    """Estimate of the largest contact radius; any length will do where there is never contact."""
    adhesion = scene.adhesion if scene.is_adhesive else None
    zone, work = (adhesion.zone, adhesion.work) if adhesion else (0.0, 0.0)
    rule = ClosureRule.resolving(FEWEST_ANNULI)
    problem = Problem(scene, Annuli(FEWEST_ANNULI), chain, zone, work, 1.0, Counters(), rule)
    return largest_contact(scene, problem) or contact_scale(scene, scene.loading.penetration) or 1.0


def annuli_for(scene: Scene, divisions: int, largest: float) -> tuple[UniformAnnuli, int]:
    """The annuli, and the number of them in the largest contact that is allowed for.

    Under a flat punch the width is changed by less than one part in the number of annuli, so that its edge
    is a border.

    Parameters
    ----------
    scene : Scene
    divisions : int
        Annuli in the process zone; a tenth of those in the largest contact, without adhesion.
    largest : float
        Estimate of the largest contact radius.

    Returns
    -------
    annuli : UniformAnnuli
    most : int
        Annuli in the largest contact allowed for.

    Raises
    ------
    UnsupportedScene
        If the annuli would be too many for one dense matrix.
    """
    zone = divisions if scene.is_adhesive else 0
    width = largest / (_PER_RADIUS * divisions)
    if scene.adhesion is not None and zone:
        width = scene.adhesion.zone / divisions
    edge = scene.indenter.edge
    most = (math.ceil(_MARGIN * largest / width) if edge == math.inf else round(edge / width)) + 1
    count = most + max(zone, most // 10 + 1)
    if count > MOST_ANNULI:
        raise UnsupportedScene(
            "adhesion.zone",
            f"{count} uniform annuli would be needed",
            f'at most {MOST_ANNULI}: a lower resolution, a longer zone, or annuli "graded"',
        )
    if edge != math.inf:
        most = max(most - 1, 1)
        width = edge / most
    return UniformAnnuli(width, count, zone, scene.indenter), most
