"""Expected values in closed form: elastic limits, adhesionless cycles, a punch."""

from __future__ import annotations

import math

from scipy.integrate import quad

from contact_scene import Adhesion, Indenter, Material, OutcomeKind, Scene, Sphere
from validation.reference import prony_integrals
from validation.reference.finite_zone import FiniteZone
from validation.reference.jkr import State
from validation.reference.ting import Ting
from validation.stability.base import TOP
from validation.stability.case import ClosedForm, Value


def zone_law(scene: Scene, plane_modulus: float) -> FiniteZone:
    """The elastic closure of finite zone, of this scene's sphere."""
    assert isinstance(scene.indenter, Sphere)
    assert isinstance(scene.adhesion, Adhesion)
    return FiniteZone(scene.indenter.radius, plane_modulus, scene.adhesion.work, scene.adhesion.zone)


def elastic_cycle(scene: Scene, plane_modulus: float, which: str, at_once: bool = True) -> ClosedForm:
    """Press to ``TOP`` and pull off, elastic with one modulus.

    Force and radius at the top, the largest tension, where contact ends, and, where that happens
    ``at_once``, the loss: that of the model's own process zone, ``int (G - dg) dA`` from the start to where
    contact is lost, relative to the work of adhesion on the largest contact. A half-space that creeps during
    the final instability loses energy there that no elastic law contains, and its edge, slower than the
    instability of an elastic one, may be followed down to the process zone.

    Parameters
    ----------
    scene : Scene
        A sphere with adhesion.
    plane_modulus : float
        ``E* = E/(1 - nu^2)``, relaxed or glassy.
    which : str
        Which modulus it is, for the source.
    at_once : bool
        Whether the final instability leaves no time to creep.

    Returns
    -------
    ClosedForm
        Ending with detachment, or also at the process zone if not ``at_once``; at the zone alone if the law
        is stable until there.
    """
    law = zone_law(scene, plane_modulus)
    pressed = law.at_penetration(TOP)
    pulled, last = law.pull_off_force_control(), law.pull_off_penetration_control()
    adhering = law.work * math.pi * pressed.contact_radius**2
    values = [
        Value("approach_force", pressed.force, max(abs(pressed.force), -pulled.force)),
        Value("approach_radius", pressed.contact_radius),
        Value("pull_off_force", -pulled.force),
        Value("final_penetration", last.penetration, TOP - last.penetration),
    ]
    if at_once:
        first = law.at_penetration(scene.loading.penetration)
        values.append(Value("dissipated_energy", _zone_loss(law, last, first), adhering))
    if law.shrinks_to_its_zone():
        endings: tuple[OutcomeKind, ...] = (OutcomeKind.BELOW_ZONE,)
    else:
        endings = (OutcomeKind.DETACHED,) if at_once else (OutcomeKind.DETACHED, OutcomeKind.BELOW_ZONE)
    return ClosedForm(tuple(values), f"elastic closure of finite zone, {which}", endings)


def _zone_loss(law: FiniteZone, low: State, high: State) -> float:
    """``int (G - dg) dA`` over the contact radii between two equilibria."""

    def excess(radius: float) -> float:
        return 2.0 * math.pi * radius * (law.energy_release_rate(radius) - law.work)

    return float(quad(excess, low.contact_radius, high.contact_radius, epsrel=1e-8)[0])


def rest(scene: Scene, penetration: float, plane_modulus: float, which: str) -> ClosedForm:
    """The run ends in an elastic equilibrium at this penetration.

    Parameters
    ----------
    scene : Scene
        A sphere with adhesion.
    penetration : float
        At the end of the run.
    plane_modulus : float
        ``E* = E/(1 - nu^2)``, relaxed or glassy.
    which : str
        Which modulus it is, for the source.

    Returns
    -------
    ClosedForm
        Final force and radius.
    """
    state = zone_law(scene, plane_modulus).at_penetration(penetration)
    pulled = zone_law(scene, plane_modulus).pull_off_force_control()
    values = (
        Value("final_force", state.force, max(abs(state.force), -pulled.force)),
        Value("final_radius", state.contact_radius),
    )
    return ClosedForm(values, f"elastic closure of finite zone, {which}")


def adhesionless_cycle(material: Material, indenter: Indenter, speed: float, top: float) -> ClosedForm:
    """Press to ``top`` and pull at the same speed, without adhesion (:class:`Ting`).

    Parameters
    ----------
    material : Material
        Of any spectrum.
    indenter : Indenter
        Of any profile.
    speed : float
        Length over time.
    top : float
        Largest penetration.

    Returns
    -------
    ClosedForm
        Largest force and radius, time of detachment.
    """
    cycle = Ting(material, indenter, rise=speed, peak=top / speed, fall=speed)
    peak = cycle.peak
    values = (
        Value("approach_force", float(cycle.force(peak))),
        Value("approach_radius", float(cycle.contact_radius(peak))),
        Value("detachment_time", cycle.detachment()),
    )
    return ClosedForm(values, "Lee and Radok, Ting: hereditary integrals", (OutcomeKind.DETACHED,))


def punch_ramp(material: Material, radius: float, speed: float, top: float) -> ClosedForm:
    """A flat punch pressed to ``top``: ``F = 2 a V int_0^(top/V) E*(t) dt``.

    Parameters
    ----------
    material : Material
    radius : float
        Radius ``a`` of the punch.
    speed : float
        ``V``, length over time.
    top : float
        Final penetration.

    Returns
    -------
    ClosedForm
        Final force and radius.
    """
    carried = float(prony_integrals.relaxation_integral(material, top / speed))
    values = (Value("final_force", 2.0 * radius * speed * carried), Value("final_radius", radius))
    return ClosedForm(values, "Boussinesq's punch under the relaxation integral")
