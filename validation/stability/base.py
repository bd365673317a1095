"""The scene that every axis varies: the paper's sphere, pressed in a little and pulled off.

In units of ``R``, ``E0*`` and the relaxation time; ``gamma~ = dg/(pi E0* R) = 1.6e-4``, ``da = 0.013 R``.
"""

from __future__ import annotations

from collections.abc import Sequence

from contact_scene import Adhesion, Branch, Indenter, Loading, Material, Ramp, Scene, Sphere, Step

POISSON = 0.5
MODULUS = 1.0 - POISSON**2
"""Relaxed Young's modulus at which ``E0* = 1``."""
CONTRAST = 10.0
"""``Einf/E0``."""
WORK = 5.026548e-4
"""Work of adhesion, over ``E0* R``."""
ZONE = 0.013
"""Process-zone length, over ``R``."""
RADIUS = 1.0
TOP = 0.01
"""Largest penetration, over ``R``."""
AWAY = -0.2
"""Penetration to which the sphere is pulled, over ``R``: below every detachment but those of the stiffest
contrasts, which have a limit of their own."""

SPHERE = Sphere(RADIUS)
ADHESION = Adhesion(WORK, ZONE)


def material(
    contrast: float = CONTRAST, time: float = 1.0, poisson: float = POISSON, branches: int = 1
) -> Material:
    """A material with ``E0* = 1`` and equal branches.

    Parameters
    ----------
    contrast : float
        ``Einf/E0``; elastic for 1.
    time : float
        Relaxation time of all branches.
    poisson : float
    branches : int
        Their number.

    Returns
    -------
    Material
    """
    modulus = 1.0 - poisson**2
    if contrast == 1.0:
        return Material(modulus, poisson)
    share = modulus * (contrast - 1.0) / branches
    return Material(modulus, poisson, tuple(Branch(share, time) for _ in range(branches)))


def press_and_pull(speed: float, top: float = TOP, away: float = AWAY) -> tuple[Step, ...]:
    """Press to ``top`` and pull to ``away``.

    Parameters
    ----------
    speed : float
        Length over time.
    top, away : float
        Penetrations.

    Returns
    -------
    tuple of Step
    """
    return (Ramp(top, speed), Ramp(away, speed))


def scene(
    of: Material,
    steps: Sequence[Step],
    start: str = "jump-in",
    penetration: float = 0.0,
    adhesion: Adhesion | None = ADHESION,
    indenter: Indenter = SPHERE,
) -> Scene:
    """A scene of the matrix.

    Parameters
    ----------
    of : Material
    steps : sequence of Step
        Loading steps.
    start : "jump-in" or "relaxed"
        Glassy or relaxed equilibrium at the start.
    penetration : float
        At the start.
    adhesion : Adhesion or None
    indenter : Indenter

    Returns
    -------
    Scene
    """
    return Scene(of, indenter, Loading(start, penetration, tuple(steps)), adhesion)
