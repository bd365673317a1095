"""Axes of what the edge takes up: hysteresis, rate, and a process zone of fixed stress."""

from __future__ import annotations

from collections.abc import Iterator

from contact_scene import Adhesion, Material, OutcomeKind, PowerRate, RateTable, Scene
from validation.reference.finite_zone import FiniteZone
from validation.stability import base
from validation.stability.case import ClosedForm, EquivalentScene, ReferenceRuns, StabilityCase, Value
from validation.stability.materials import CYCLE, SAME

CLOSING_SHARES = (0.5, 1e-1, 1e-3)
"""Energy at which the edge closes over that at which it opens."""
WEAKEST = 0.01
"""Share below which a glassy contact at no penetration is shorter than the process zone."""
SPEEDS = (1e-6, 1e-3, 1e3)
"""Speed at which the work of adhesion is doubled, ``v0 tau/R``."""
STRESSES = (0.15, 0.3)
"""Cohesive stress over ``E0*``; the zone at rest is 0.018 and 0.0044 of ``R``."""
HELD_BACK = ReferenceRuns(("approach_force", "pull_off_force", "loop_energy"))
"""For an edge that opens without end: no instant of detachment is compared."""


def hysteresis() -> list[StabilityCase]:
    """The cycle with an edge that closes at less than it opens, elastic and viscoelastic."""
    material = base.material()
    plain = _cycle(material, base.ADHESION)
    same = _cycle(material, Adhesion(base.WORK, base.ZONE, base.WORK))
    cases = [StabilityCase("hysteresis", "closing as opening", same, EquivalentScene(plain), SAME)]
    elastic = base.material(1.0)
    for share in CLOSING_SHARES:
        adhesion = Adhesion(base.WORK, base.ZONE, share * base.WORK)
        label = f"closing at {share:g} of opening"
        started = ("jump-in", 0.0) if share > WEAKEST else ("relaxed", base.TOP)
        cases.append(StabilityCase("hysteresis", label, _cycle(material, adhesion, *started), CYCLE))
        cases.append(
            StabilityCase(
                "hysteresis",
                f"{label}, elastic",
                _cycle(elastic, adhesion, "relaxed", base.TOP),
                _pulled_off(elastic, adhesion),
            )
        )
    return cases


def rate() -> list[StabilityCase]:
    """The cycle with an edge that takes up more the faster it opens."""
    material = base.material()
    return [
        StabilityCase("rate", label, _cycle(material, Adhesion(base.WORK, base.ZONE, None, law)), HELD_BACK)
        for label, law in _laws()
    ]


def stress() -> list[StabilityCase]:
    """The cycle with process zones of fixed stress."""
    material = base.material()
    return [
        StabilityCase(
            "stress", f"s/E0* = {value:g}", _cycle(material, Adhesion(base.WORK, stress=value)), HELD_BACK
        )
        for value in STRESSES
    ]


def _laws() -> Iterator[tuple[str, PowerRate | RateTable]]:
    for speed in SPEEDS:
        yield f"v0 tau/R = {speed:g}, n = 0.5", PowerRate(speed, 0.5)
    yield "n = 2", PowerRate(1e-2, 2.0)
    yield "table of two rows", RateTable((1e-4, 1e-1), (1.2 * base.WORK, 4.0 * base.WORK))


def _cycle(material: Material, adhesion: Adhesion, start: str = "jump-in", penetration: float = 0.0) -> Scene:
    return base.scene(material, base.press_and_pull(0.02), start, penetration, adhesion)


def _pulled_off(material: Material, adhesion: Adhesion) -> ClosedForm:
    """An elastic contact that has closed at the largest penetration, and opens until it is lost."""
    modulus = material.relaxed_plane_modulus
    closed = FiniteZone(base.RADIUS, modulus, adhesion.closing, base.ZONE).at_penetration(base.TOP)
    opening = FiniteZone(base.RADIUS, modulus, adhesion.work, base.ZONE)
    pulled, last = opening.pull_off_force_control(), opening.pull_off_penetration_control()
    if closed.contact_radius < pulled.contact_radius:  # the tension is largest where the pinned edge lets go
        pulled = opening.state(closed.contact_radius)
    values = (
        Value("start_force", closed.force, max(abs(closed.force), -pulled.force)),
        Value("start_radius", closed.contact_radius),
        Value("pull_off_force", -pulled.force),
        Value("detachment_penetration", last.penetration, base.TOP - last.penetration),
    )
    return ClosedForm(values, "branches of opening and closing, finite zone", (OutcomeKind.DETACHED,))
