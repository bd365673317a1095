"""The cases: the paper's sphere pressed in a little and pulled off, one thing of it moved to an extreme.

Every case is a row: where it is on its axis, the changed scene, what the answer is held against, and within
which tolerance. In units of ``R``, ``E0*`` and the relaxation time; ``gamma~ = dg/(pi E0* R) = 1.6e-4``,
``da = 0.013 R``.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from functools import partial
from typing import Any, Literal

import numpy as np

import contact_scene as cs
from validation.reference import sneddon
from validation.reference.elastic_layer import ElasticLayer
from validation.reference.spring import SpringContact
from validation.solvers import REFERENCE, SOLVERS, solvers
from validation.solvers.boundary_elements import BoundaryElements
from validation.solvers.finite_elements import FiniteElements
from validation.stability import expected as known


@dataclass(frozen=True)
class Tolerance:
    """Largest relative error by solver, why, and that of any other: by default its ``coarse_tolerance``."""

    limits: Mapping[str, float]
    why: str
    other: float | None = None

    def limit(self, solver: str) -> float:
        """Largest relative error of one solver."""
        other = SOLVERS[solver].coarse_tolerance if self.other is None else self.other
        return self.limits.get(solver, other)


USUAL = Tolerance(
    {},
    "coarse runs (6, 4 and 8 divisions a zone): about three times their error in the studies of cycles",
)
PULLED = Tolerance(
    {FiniteElements.name: 4e-2},
    "the edge recedes all the way, and elements round it down by part of one: 1.4 % of the force at 4 a zone",
)
SAME = Tolerance({}, "the same question: round-off only, amplified where contact is lost", other=1e-9)
STEPPED = Tolerance(
    {REFERENCE: 2e-4},
    "the same answer, but a further time may change the steps: their error, as F(t) RMS or row by row",
    other=2e-3,
)
SWUNG = Tolerance(
    {BoundaryElements.name: 0.1},
    "energies of a swing of a hundredth of the load, to whose size steps are controlled: ten a cycle",
)
NEAR = Tolerance({}, "next to the limit the radius moves like a square root", other=5e-2)
ELASTIC = Tolerance({REFERENCE: 1e-4}, "elastic limit points at the coarse resolutions", other=5e-3)


@dataclass(frozen=True)
class StabilityCase:
    """A row of the matrix.

    A ``scene`` that is invalid is the error with which it is refused before any solver sees it. Cases of one
    ``series`` differ in ``stiffness`` alone, the ratio of the longest to the shortest time or of the moduli:
    their work is fitted against it. ``resolutions`` are divisions a zone by solver, where they are not its
    ``coarse_resolution``; a run of more than ``seconds`` of processor time counts as hung.
    """

    label: str
    scene: cs.Scene | cs.SceneError
    expected: known.Expected
    tolerance: Tolerance = USUAL
    series: str = ""
    stiffness: float = 1.0
    resolutions: Mapping[str, int] = field(default_factory=dict)
    max_steps: int = 20_000
    seconds: float = 180.0
    axis: str = ""

    def resolution(self, solver: str) -> int:
        """Divisions per process zone for one solver."""
        adhesive = isinstance(self.scene, cs.Scene) and self.scene.is_adhesive
        return self.resolutions.get(solver) or SOLVERS[solver].coarse_resolution(adhesive)

    @property
    def name(self) -> str:
        """Unique within the matrix."""
        return f"{self.axis}: {self.label}"


Rows = Iterator[StabilityCase]

POISSON = 0.5
MODULUS = 1.0 - POISSON**2
"""Relaxed Young's modulus at which ``E0* = 1``."""
CONTRAST = 10.0
"""``Einf/E0``."""
WORK, ZONE = 5.026548e-4, 0.013
"""Work of adhesion over ``E0* R``, length of the process zone over ``R``."""
TOP = 0.01
"""Largest penetration, over ``R``."""
AWAY = -0.2
"""Penetration to which the sphere is pulled: below every detachment but those of the stiffest contrasts."""
PUSH = 0.01
"""Speed of adhesionless cycles, ``R`` per relaxation time."""
SPEED = 0.02
"""Speed of the others."""
SPHERE, ADHESION = cs.Sphere(1.0), cs.Adhesion(WORK, ZONE)
NAMES = ("pull_off_force", "loop_energy", known.CURVE)
CYCLE = known.ReferenceRuns(("approach_force", *NAMES), of_largest=("approach_force",))
PULL = known.ReferenceRuns(("start_force", *NAMES))
PEELED = replace(PULL, fine=8, coarse=4)


def material(contrast: float = CONTRAST, time: float = 1.0, poisson: float = POISSON) -> cs.Material:
    """A material with ``E0* = 1`` and one branch, none for a contrast of 1."""
    modulus = 1.0 - poisson**2
    branch = cs.Branch(modulus * (contrast - 1.0), time)
    return cs.Material(modulus, poisson, () if contrast == 1.0 else (branch,))


def spectrum(*branches: tuple[float, float]) -> cs.Material:
    """A material with branches of these moduli and times."""
    return cs.Material(MODULUS, POISSON, tuple(cs.Branch(modulus, time) for modulus, time in branches))


BASE = material()
SHARE = MODULUS * (CONTRAST - 1.0)
"""Modulus of its branch."""
SOFT = material(1.0)
"""The relaxed material, elastic."""


def press_and_pull(speed: float = SPEED, top: float = TOP, away: float = AWAY) -> tuple[cs.Step, cs.Step]:
    """Press to ``top`` and pull to ``away``."""
    return cs.Ramp(top, speed), cs.Ramp(away, speed)


def scene(
    steps: Iterable[cs.Step],
    of: cs.Material = BASE,
    adhesion: cs.Adhesion | None = ADHESION,
    indenter: cs.Indenter = SPHERE,
    start: str = "jump-in",
    depth: float = 0.0,
    machine: cs.Machine | None = None,
) -> cs.Scene:
    """A scene of the matrix: all that is not said is that of the sphere of the paper."""
    return cs.Scene(of, indenter, cs.Loading(start, depth, tuple(steps), machine), adhesion)


PLAIN = scene(press_and_pull())
SETTLED: dict[str, Any] = {"start": "relaxed", "depth": TOP}


def pulled(speed: float, away: float = AWAY, **changes) -> cs.Scene:
    """Relaxed contact at ``TOP``, pulled off."""
    return scene((cs.Ramp(away, speed),), **(SETTLED | changes))


def elastic_limit(cycle: cs.Scene, pace: float, slow: float, fast: float) -> known.Expected:
    """A cycle is relaxed at a ``pace`` up to ``slow``, glassy from ``fast`` on; else the front is tracked."""
    if pace <= slow:
        return known.elastic_cycle(cycle, TOP, "E0", known.CREEPING, known.EITHER)
    return known.elastic_cycle(cycle, TOP, "Einf") if pace >= fast else CYCLE


def of_series(name: str, stiffness: float) -> dict[str, Any]:
    """A case of a series; at a stiffness of one there is none."""
    return {"series": name if stiffness > 1.0 else "", "stiffness": stiffness}


def adhesionless(label: str, of: cs.Material, **more) -> StabilityCase:
    """The cycle of the sphere on a material, without adhesion."""
    cycle = scene(press_and_pull(PUSH), of, None)
    return StabilityCase(f"{label}, adhesionless", cycle, known.adhesionless_cycle(cycle), **more)


def contrast() -> Rows:
    """``Einf/E0``: an adhesionless cycle, a cycle slow against creep, and a relaxed contact pulled off.

    The slow cycle takes ``1e7`` retardation times. The pull has ``V tau_c = da``: the edge feels the creep.
    """
    for ratio in (1.0, 10.0, 1e3, 1e6, 1e9):  # the retardation time too, in relaxation times
        of, label = material(ratio), f"Einf/E0 = {ratio:g}"
        yield adhesionless(label, of, **of_series("adhesionless cycle", ratio))
        slow = scene(press_and_pull(1e-7 / ratio), of, start="relaxed")
        elastic = elastic_limit(slow, 0.0, 0.0, 1.0) if ratio > 1.0 else known.elastic_cycle(slow, TOP)
        yield StabilityCase(f"{label}, slow", slow, elastic, **of_series("slow cycle", ratio))
        pull = pulled(ZONE / ratio, -20.0, of=of)
        yield StabilityCase(f"{label}, V tau_c = da", pull, PULL, PULLED, **of_series("pull", ratio))


def times() -> Rows:
    """Relaxation time over the duration of the loading, from a relaxed start and from a glassy one."""
    for ratio in (1e-12, 1e-9, 1e-6, 1e-3, 1.0, 1e3, 1e6, 1e9, 1e12):
        of, label = material(time=ratio), f"tau/T = {ratio:g}"
        side, stiffness = "slow" if ratio > 1.0 else "fast", max(ratio, 1.0 / ratio)
        cycle, pull = scene(press_and_pull(TOP), of), pulled(TOP, of=of)  # the approach takes a unit of time
        expected = elastic_limit(cycle, ratio, 1e-6, 1e6)
        more = of_series(f"cycle, {side} response", stiffness)
        yield StabilityCase(f"{label}, glassy start", cycle, expected, **more)
        more = of_series(f"pull, {side} response", stiffness)
        yield StabilityCase(f"{label}, pulled from rest", pull, PULL, PULLED, **more)


def spectra() -> Rows:
    """Many branches, spread, nearly equal, or of no weight."""
    up, down = press_and_pull()
    for count, decades in ((1, 0), (2, 6), (7, 6), (7, 15), (30, 8), (30, 15)):
        spread = np.logspace(-0.5 * decades, 0.5 * decades, count)
        of = spectrum(*((SHARE / count, time) for time in spread))
        label = f"{count} branch{'es' if count > 1 else ''}" + (f", {decades} decades" if decades else "")
        yield adhesionless(label, of)
        yield StabilityCase(f"{label}, with a hold", scene((up, cs.Hold(1.0), down), of), CYCLE)
    near = spectrum((SHARE / 2, 1.0), (SHARE / 2, 1.0 + 1e-9))
    pairs = [("two times within 1e-9", near, STEPPED)]
    for weight, tolerance in ((1e-12, STEPPED), (1e-40, SAME)):
        for time in (1e-9, 1e3):
            extra = spectrum((SHARE, 1.0), (weight, time))
            pairs.append((f"a branch of weight {weight:g} at {time:g} tau", extra, tolerance))
    for label, of, tolerance in pairs:
        yield StabilityCase(label, scene((up, down), of), known.EquivalentScene(PLAIN), tolerance)


def poisson() -> Rows:
    """Poisson's ratio at the same plane modulus: the answer does not depend on it."""
    for ratio in (0.0, 0.3, 0.49, 0.4999, 0.5):
        of, label = material(poisson=ratio), f"nu = {ratio:g}"
        yield StabilityCase(label, scene(press_and_pull(), of), CYCLE)
        yield adhesionless(label, of)


def speeds() -> Rows:
    """``V tau/R``, approach and retraction; elastic to a thousandth at the slowest and fastest."""
    for speed in (1e-9, 1e-8, 1e-7, 1e-6, 1e-4, 1e-2, 1.0, 1e2, 1e4, 1e6):
        cycle = scene(press_and_pull(speed))
        series = "slow cycle" if speed < 1e-5 else "fast cycle" if speed >= 1.0 else ""
        expected, stiffness = elastic_limit(cycle, speed, 1e-8, 1e4), max(speed, 1.0 / speed)
        yield StabilityCase(f"V tau/R = {speed:g}", cycle, expected, series=series, stiffness=stiffness)


def steps() -> Rows:
    """Tables whose rows force the step: ``1e-9`` and ``1e9`` relaxation times, and both by turns."""
    up = np.linspace(0.0, TOP, 21)
    down = np.linspace(TOP, -0.05, 42)

    def table(values: np.ndarray, step: float) -> cs.Table:
        return cs.Table(tuple(step * np.arange(values.size)), tuple(values))

    for label, step in (("dt/tau = 1e-9", 1e-9), ("dt/tau = 1e9", 1e9)):
        cycle = scene((table(np.concatenate((up, down[1:])), step),))
        yield StabilityCase(label, cycle, elastic_limit(cycle, 1.0 / step, 1e-8, 1e8))
    stairs = np.repeat(up, 2)[1:]
    pace = np.tile((1e-9, 1e4), stairs.size)[: stairs.size]
    pace[0] = 0.0
    climb = cs.Table(tuple(np.cumsum(pace)), tuple(stairs))
    for label, way in (("1e-9, then a hold of 1e4", table(up, 1e-9)), ("1e-9 and 1e4 by turns", climb)):
        settled = scene((way, cs.Hold(1e4)))
        yield StabilityCase(f"dt/tau = {label}", settled, known.rest(settled, TOP, "E0"))


def adhesion() -> Rows:
    """``gamma~`` from none to strong."""
    none = scene(press_and_pull(PUSH), adhesion=cs.Adhesion(0.0, ZONE))
    yield StabilityCase("gamma~ = 0", none, known.adhesionless_cycle(none))
    weak = pulled(1.0, of=SOFT, adhesion=cs.Adhesion(math.pi * 1e-12, 2e-3))
    yield StabilityCase("gamma~ = 1e-12, elastic", weak, known.faint(weak, TOP))
    for gamma, zone in ((1e-12, 2e-3), (1.6e-4, 0.013), (1e-2, 0.02)):
        law = cs.Adhesion(math.pi * gamma, zone)
        adhering = scene((cs.Hold(1.0), cs.Ramp(-2.0, SPEED)), adhesion=law, **SETTLED)
        yield StabilityCase(f"gamma~ = {gamma:g}", adhering, PULL, PULLED)
    strong = scene(press_and_pull(1e6), adhesion=cs.Adhesion(math.pi * 1e-2, 0.02))
    yield StabilityCase("gamma~ = 1e-2, fast", strong, known.elastic_cycle(strong, TOP, "Einf"))


def zones() -> Rows:
    """Zones from a millionth of the contact radius to beyond it.

    The longest that fit take more divisions each, and beyond the pull-off the contact shrinks to the zone,
    where the model ends and nothing is compared. At the shortest a pull of ``V tau/da = 0.3`` besides: the
    edge moves a few zones in a relaxation time; at a speed given in radii it opens as a glass does.
    """
    radius = known.zone_law(scene((), SOFT)).at_penetration(TOP).contact_radius
    finer = {one.name: 3 * one.coarse_resolution(adhesive=True) for one in solvers()}
    shortest = 1e-6
    for share in (shortest, 1e-4, 1e-3, 1e-2, 0.1, 1.0 / 3.0, 0.5):
        law, label, wide = cs.Adhesion(WORK, share * radius), f"da/a = {share:.3g}", share > 0.3
        more: dict[str, Any] = {"tolerance": PULLED, "resolutions": finer if wide else {}}
        elastic = pulled(1.0, of=SOFT, adhesion=law)
        names = ("pull_off_force",) if wide else known.PULLED[2:]
        expected = known.elastic_cycle(elastic, TOP, names=names)
        yield StabilityCase(f"{label}, elastic", elastic, expected, **more)
        runs = known.ReferenceRuns(("start_force", "pull_off_force"), 40, 20) if wide else PEELED
        yield StabilityCase(f"{label}, V tau/R = 0.02", pulled(SPEED, adhesion=law), runs, **more)
    law = cs.Adhesion(WORK, shortest * radius)
    slow = pulled(0.3 * law.zone, adhesion=law)
    yield StabilityCase(f"da/a = {shortest:.3g}, V tau/da = 0.3", slow, PEELED, PULLED)
    for share in (1.5, 100.0):
        longer = pulled(SPEED, adhesion=cs.Adhesion(WORK, share * radius))
        nothing = known.NoSolution("a process zone longer than the contact")
        yield StabilityCase(f"da/a = {share:.3g}", longer, nothing)


def hysteresis() -> Rows:
    """An edge that closes at less than it opens, elastic and viscoelastic."""

    def closing(share: float) -> cs.Adhesion:
        return cs.Adhesion(WORK, ZONE, share * WORK)

    same = scene(press_and_pull(), adhesion=closing(1.0))
    yield StabilityCase("closing as opening", same, known.EquivalentScene(PLAIN), SAME)
    names = ("start_force", "start_radius", "pull_off_force", "detachment_penetration")
    for share in (0.5, 1e-1, 1e-3):
        label = f"closing at {share:g} of opening"
        # Below a hundredth a glassy contact is shorter than its zone at no depth.
        begin = {} if share > 0.01 else SETTLED
        yield StabilityCase(label, scene(press_and_pull(), adhesion=closing(share), **begin), CYCLE)
        elastic = scene(press_and_pull(), SOFT, closing(share), **SETTLED)
        source = "branches of opening and closing, finite zone"
        branches = known.elastic_cycle(elastic, TOP, names=names, source=source)
        yield StabilityCase(f"{label}, elastic", elastic, branches)


def opening(laws: Mapping[str, cs.Adhesion]) -> Rows:
    """Cycles of an edge that opens without end: no instant of detachment is compared."""
    names = known.ReferenceRuns(("approach_force", "pull_off_force", "loop_energy"))
    for label, law in laws.items():
        yield StabilityCase(label, scene(press_and_pull(), adhesion=law), names)


RATES = {
    f"v0 tau/R = {speed:g}, n = 0.5": cs.Adhesion(WORK, ZONE, None, cs.PowerRate(speed, 0.5))
    for speed in (1e-6, 1e-3, 1e3)
} | {
    "n = 2": cs.Adhesion(WORK, ZONE, None, cs.PowerRate(1e-2, 2.0)),
    "table of two rows": cs.Adhesion(WORK, ZONE, None, cs.RateTable((1e-4, 1e-1), (1.2 * WORK, 4.0 * WORK))),
}
"""An edge that takes up more the faster it opens."""
STRESSES = {f"s/E0* = {value:g}": cs.Adhesion(WORK, stress=value) for value in (0.15, 0.3)}
"""Process zones of fixed stress; at rest 0.018 and 0.0044 of ``R`` long."""


def table(noise: float) -> cs.TabulatedProfile:
    """The sphere at 41 radii, relative noise of this size on every height."""
    radii = np.linspace(0.0, 0.6, 41)
    scatter = 1.0 + noise * np.random.default_rng(7).standard_normal(radii.size)
    return cs.TabulatedProfile(tuple(radii.tolist()), tuple((0.5 * radii**2 * scatter).tolist()))


def indenters() -> Rows:
    """Punch, cones, a steep power law, tables with noise; without and with adhesion."""
    punch, power, rough = cs.FlatPunch(0.2), cs.PowerLaw(8.0, 1.0), ("table, noise 0.1 %", table(1e-3))
    pressed = scene((cs.Ramp(TOP, PUSH),), adhesion=None, indenter=punch)
    ramp = known.punch_ramp(BASE, 0.2, PUSH, TOP)
    yield StabilityCase("flat punch, adhesionless", pressed, ramp)
    cones = ((f"cone {angle:g}°", cs.Cone(angle)) for angle in (89.9, 85.0, 45.0, 10.0))
    for label, shape in (*cones, ("power law 8", power), rough):
        top = float(sneddon.depth(shape, 0.1))  # the contact radius of the sphere at ``TOP``
        cycle = scene(press_and_pull(top, top, -10.0 * top), adhesion=None, indenter=shape)
        yield StabilityCase(f"{label}, adhesionless", cycle, known.adhesionless_cycle(cycle))
    short = cs.Adhesion(WORK, 1e-4)  # contact is lost at 3e-4
    held: tuple[tuple[str, cs.Indenter, float, cs.Adhesion], ...] = (
        ("flat punch", punch, 0.0, ADHESION),
        ("cone 85°", cs.Cone(85.0), 0.01, ADHESION),
        ("cone 45°", cs.Cone(45.0), 0.001, short),
        ("power law 8", power, 0.0, ADHESION),
        (*rough, TOP, ADHESION),
    )
    for label, shape, top, law in held:
        pull = pulled(SPEED, top - 1.0, depth=top, adhesion=law, indenter=shape)
        yield StabilityCase(label, pull, PULL, PULLED)
    try:
        falling: cs.Scene | cs.SceneError = scene(press_and_pull(), indenter=table(0.3))
    except cs.SceneError as error:
        falling = error
    yield StabilityCase("table that falls, noise 30 %", falling, known.NoSolution("a profile that falls"))


def loading() -> Rows:
    """Holds of no length, reversals within a step, jumps, many cycles, starts without equilibrium."""
    up, down = press_and_pull()
    with_holds = scene((cs.Hold(0.0), up, cs.Hold(0.0), cs.Hold(0.0), down))
    yield StabilityCase("holds of no length", with_holds, known.EquivalentScene(PLAIN), SAME)
    flick = cs.Table((0.0, 0.2, 0.2 + 1e-6, 0.2 + 2e-6, 0.5), (0.0, 0.004, 0.006, 0.004, TOP))
    yield StabilityCase("reversal within 1e-6 tau", scene((flick, down)), replace(CYCLE, of_largest=()))
    ends: tuple[tuple[str, cs.Step, float, str], ...] = (
        (
            "oscillation far faster than tau",
            cs.Oscillate(2e-3, 1e6, 1.25 * (2.0 * math.pi / 1e6)),
            2e-3,
            "Einf",
        ),
        ("jump of the penetration", cs.Table((0.0, 1e-9), (TOP, TOP)), TOP, "Einf"),
        ("jump, then rest", cs.Table((0.0, 1e5), (TOP, TOP)), TOP, "E0"),
    )
    for label, step, depth, which in ends:
        moved = scene((step,))
        yield StabilityCase(label, moved, known.rest(moved, depth, which))
    cycles, size, radius = 1000, 1e-4, 0.2
    duration = 2.0 * math.pi * cycles
    many: dict[str, Any] = {"tolerance": SWUNG, "max_steps": 200_000, "seconds": 600.0}
    whole = duration + 0.5 * math.pi
    shaken = scene((cs.Oscillate(size, 1.0, whole),), adhesion=None, indenter=cs.FlatPunch(radius), **SETTLED)
    swung = known.punch_cycles(BASE, radius, TOP, size, whole, cycles)
    yield StabilityCase(f"{cycles} cycles of a punch", shaken, swung, **many)
    sticking = scene((cs.Oscillate(size, 1.0, duration), cs.Hold(1e4)), start="relaxed")
    final = known.ReferenceRuns(("final_force", "final_radius", "loop_energy"), fine=8, coarse=4)
    many["resolutions"] = dict.fromkeys(SOLVERS, 4)
    yield StabilityCase(f"{cycles} cycles of a sphere, then rest", sticking, final, **many)
    for start, which in (("relaxed", "E0"), ("jump-in", "Einf")):
        limit = known.zone_law(PLAIN, which).pull_off_penetration_control().penetration
        for factor in (0.99, 1.01, 100.0):
            begun = scene((cs.Hold(0.0),), start=start, depth=factor * limit)
            stable = factor < 1.0
            expected = (
                known.started(begun, which) if stable else known.NoSolution("no contact is stable there")
            )
            label = f"{start} start at {factor:g} of the last stable penetration"
            yield StabilityCase(label, begun, expected, NEAR if stable else USUAL)


def dead_loads() -> Rows:
    """Dead loads around the slow pull-off force: held for ever below, lost after a delay above.

    The delay grows without bound towards the limit, like the root of the margin: the error of the limit
    itself, a thousandth at the coarse resolutions, a tenth of that of the front tracking, divided by twice
    the margin, is the error of the delay.
    """
    slow = -known.zone_law(PLAIN).pull_off_force_control().force

    def loaded(tension: float) -> cs.Scene:
        return scene((cs.Force(-tension, 1e6),), **SETTLED)

    for margin in (0.3, 0.1, 0.03, 0.01, 3e-3):
        share = 2.0 * margin
        why = "1 % and the error of the slow pull-off force over twice the margin"
        tolerance = Tolerance({REFERENCE: 1e-2 + 0.1 * 1e-3 / share}, why, 1e-2 + 1e-3 / share)
        above, below = slow * (1.0 + margin), slow * (1.0 - margin)
        delay = known.ReferenceRuns(("detachment_time",))
        yield StabilityCase(f"{1.0 + margin:g} of slow pull-off", loaded(above), delay, tolerance)
        held = known.held(PLAIN, below)
        yield StabilityCase(f"{1.0 - margin:g} of slow pull-off", loaded(below), held, tolerance)
    lost = known.ClosedForm(
        (known.Value("detachment_time", 0.0, 1.0),), "beyond the glassy limit", known.DETACHED
    )
    yield StabilityCase("30 times slow pull-off", loaded(30.0 * slow), lost)


def springs() -> Rows:
    """Limit points of an elastic contact, the viscoelastic cycle, and a rigid machine.

    Stiffness ``k`` is in those of the elastic contact where its tension is largest.
    """
    law = known.zone_law(scene((), SOFT))
    unit = 2.0 * law.plane_modulus * law.pull_off_force_control().contact_radius
    for share in (1e-6, 1e-3, 0.1, 1.0, 10.0, 1e3, 1e6):
        spring = SpringContact(law, share * unit)
        lost, first = spring.pull_off(), spring.stage(law.at_penetration(TOP))
        last = spring.stage(lost)
        beyond = last - 0.5 * (first - last)
        pull = pulled(1.0, beyond, of=SOFT, machine=cs.Machine(share * unit))
        point = known.limit_point(spring, lost, last, first - last)
        yield StabilityCase(f"elastic, k = {share:g}", pull, point, ELASTIC)
    rigid = scene(press_and_pull(), machine=cs.Machine(math.inf))
    yield StabilityCase("rigid", rigid, known.EquivalentScene(PLAIN), SAME)
    runs = known.ReferenceRuns(("pull_off_force", "stage_at_detachment", "loop_energy", known.CURVE))
    level = 4.0 / 3.0 * TOP**1.5  # of the relaxed contact at ``TOP``, without adhesion
    for share in (1e-3, 0.1, 1.0, 10.0, 1e3):
        speed = SPEED * (1.0 + 1.0 / share)  # of the stage, to move the indenter as without a spring
        far = 10.0 * (TOP + level / (share * unit))
        there, back = cs.Ramp(far, speed, until_force=level), cs.Ramp(-far, speed)
        cycle = scene((there, back), machine=cs.Machine(share * unit))
        yield StabilityCase(f"cycle, k = {share:g}", cycle, runs)


_LAYERS: tuple[tuple[float, Literal["bonded", "frictionless"]], ...] = (
    (0.5, "bonded"),
    (0.3, "bonded"),
    (0.3, "frictionless"),
)
"""Poisson's ratio and base."""


def layers() -> Rows:
    """Contact radius over thickness: an elastic contact pressed to it, and a relaxed one pulled off."""
    radius = 0.2
    for poisson, base in _LAYERS:
        for ratio in (0.02, 0.3, 3.0, 10.0, 29.0):
            body, label = cs.Layer(radius / ratio, base), f"a/h = {ratio:g}, {base}, nu = {poisson:g}"
            layer = ElasticLayer(body, poisson, SPHERE)
            press = cs.Ramp(layer.state(radius).penetration, PUSH)
            pressed = replace(scene((press,), material(1.0, poisson=poisson), None), body=body)
            yield StabilityCase(f"{label}, adhesionless", pressed, known.pressed_layer(pressed))
            law = cs.Adhesion(WORK, min(ZONE, 0.1 * body.thickness))
            depth = layer.state(radius, WORK).penetration
            pull = pulled(SPEED, of=material(poisson=poisson), adhesion=law, depth=depth)
            yield StabilityCase(f"{label}, pulled", replace(pull, body=body), PULL, PULLED)


def units() -> Rows:
    """The same cycle in other units: factors of length, stress and time."""
    systems = (
        ("metres to millimetres", 1e3, 1.0, 1.0),
        ("metres to nanometres", 1e9, 1.0, 1.0),
        ("nanometres to metres", 1e-9, 1.0, 1.0),
        ("GPa to Pa", 1.0, 1e9, 1.0),
        ("Pa to GPa", 1.0, 1e-9, 1.0),
        ("hours to nanoseconds", 1.0, 1.0, 3.6e12),
        ("millimetres, GPa, milliseconds", 1e3, 1e-9, 1e3),
    )
    for label, length, stress, time in systems:
        of = cs.Material(stress * MODULUS, POISSON, (cs.Branch(stress * SHARE, time),))
        law = cs.Adhesion(stress * length * WORK, length * ZONE)
        cycle = press_and_pull(length / time * SPEED, length * TOP, length * AWAY)
        scaled = scene(cycle, of, law, cs.Sphere(length))
        yield StabilityCase(label, scaled, known.EquivalentScene(PLAIN, length, stress, time), SAME)


AXES: Mapping[str, Mapping[str, Callable[[], Rows]]] = {
    "contrast": {"contrast": contrast},
    "relaxation-time": {"relaxation time": times},
    "spectrum": {"spectrum": spectra},
    "poisson": {"Poisson's ratio": poisson},
    "speed": {"speed": speeds},
    "step": {"step": steps},
    "adhesion": {"adhesion": adhesion, "process zone": zones},
    "hysteresis": {"hysteresis": hysteresis},
    "rate": {"rate": partial(opening, RATES)},
    "stress": {"stress": partial(opening, STRESSES)},
    "indenter": {"indenter": indenters},
    "loading": {"loading": loading},
    "dead-load": {"dead load": dead_loads},
    "spring": {"spring": springs},
    "layer": {"layer": layers},
    "scale": {"scale": units},
}
"""Axes by the name of the option that asks for them alone."""


def cases(only: str | None = None) -> list[StabilityCase]:
    """Every case of the matrix, or of one axis."""
    asked = [axes for option, axes in AXES.items() if only in (None, option)]
    return [replace(row, axis=axis) for axes in asked for axis, rows in axes.items() for row in rows()]
