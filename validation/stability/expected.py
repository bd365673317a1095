"""What the answer to a case is held against, and by how much an answer is off it.

Numbers of a closed form, the front tracking at two resolutions, the same solver on an equivalent scene, or
that there is no solution, which a solver has to report. Errors are relative and by name; one that has to be
there and is not is infinite.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass, replace

import numpy as np
from scipy.integrate import quad
from scipy.optimize import brentq

from contact_scene import COLUMNS, Adhesion, Material, OutcomeKind, Ramp, Scene, Sphere
from validation.measure.curves import distance
from validation.measure.difference import of_curves, of_numbers, relative
from validation.reference import prony_integrals, punch_oscillation
from validation.reference.elastic_layer import ElasticLayer
from validation.reference.finite_zone import FiniteZone
from validation.reference.jkr import ElasticContact
from validation.reference.spring import SpringContact
from validation.reference.ting import Ting
from validation.runs.run import Run

CURVE = "force, RMS"
"""Name of the error of the curve ``F(t)``: root mean square over the largest force."""
RICHARDSON = 1.0 / 3.0
"""Error of the finer of two runs of second order over their difference, the coarser at twice the step."""


@dataclass(frozen=True)
class Value:
    """An observable of a closed form; errors are relative to ``scale``, by default to its own magnitude."""

    name: str
    value: float
    scale: float | None = None


@dataclass(frozen=True)
class ClosedForm:
    """Values of a closed form, where they come from, and how the run may end."""

    values: tuple[Value, ...]
    source: str
    endings: tuple[OutcomeKind, ...] = (OutcomeKind.COMPLETED,)

    def errors(self, run: Run) -> dict[str, float]:
        """Error of every value."""
        errors = {}
        for one in self.values:
            measured = run.measures[one.name]
            size = abs(one.value) if one.scale is None else one.scale
            errors[one.name] = math.inf if measured is None else relative(abs(measured - one.value), size)
        return errors


@dataclass(frozen=True)
class ReferenceRuns:
    """Observables of the front tracking; a third of its own step halving is its error estimate.

    Numbers ``of_largest`` are relative to the largest magnitude of their column: they may vanish.
    """

    names: tuple[str, ...]
    fine: int = 20
    coarse: int = 10
    of_largest: tuple[str, ...] = ()

    @property
    def source(self) -> str:
        """What it is, in words."""
        return f"front tracking, {self.fine} steps a zone"

    def errors(self, run: Run, base: Run) -> dict[str, float]:
        """Difference of every observable of two runs; infinite where only one has it."""
        found = [*of_numbers(run, base, self.names, self.of_largest), *of_curves(run, base)]
        named = {CURVE if one.quantity == "force" else one.quantity: abs(one.error) for one in found}
        return {name: named.get(name, 0.0) for name in self.names}

    def own_error(self, fine: Run, coarse: Run) -> float:
        """Error estimate of what the finer run gives."""
        return RICHARDSON * max(self.errors(coarse, fine).values())


@dataclass(frozen=True)
class EquivalentScene:
    """The same solver on a scene that differs in units, or in something without any effect.

    The columns of the case are those of ``scene`` times the units that they have.
    """

    scene: Scene
    length: float = 1.0
    stress: float = 1.0
    time: float = 1.0
    source = "the same solver on the equivalent scene"

    def errors(self, run: Run, other: Run) -> dict[str, float]:
        """Largest difference of any row by column; of the curve alone where rows are not as many."""
        trace, base = run.trace, other.trace
        assert trace is not None
        assert base is not None
        if len(trace) != len(base):
            apart = distance(trace, base) if self.length == self.stress == self.time == 1.0 else None
            return {CURVE: math.inf if apart is None else apart.rms}
        force, energy = self.stress * self.length**2, self.stress * self.length**3
        factors = (self.time, self.length, force, self.length, energy, energy, energy)
        expected = {name: by * getattr(base, name) for name, by in zip(COLUMNS, factors, strict=True)}
        sizes = {name: float(np.abs(column).max()) for name, column in expected.items()}
        # What a balance leaves is as exact as its largest term.
        sizes["dissipated_energy"] = max(
            sizes[name] for name in ("dissipated_energy", "stored_energy", "external_work")
        )
        return {
            name: relative(float(np.abs(getattr(trace, name) - column).max()), sizes[name])
            for name, column in expected.items()
        }


@dataclass(frozen=True)
class NoSolution:
    """There is no solution, and why: a solver must refuse, or end with ``no equilibrium``."""

    source: str


Expected = ClosedForm | ReferenceRuns | EquivalentScene | NoSolution


# Closed forms: elastic limits, adhesionless cycles, a punch, dead loads, springs

PULLED = ("approach_force", "approach_radius", "pull_off_force", "final_penetration", "dissipated_energy")
"""Observables of a cycle whose final instability leaves no time to creep."""
CREEPING = PULLED[:-1]
"""Of one that creeps during it, where energy is lost that no elastic law contains."""
SOURCE = "elastic closure of finite zone"
DETACHED = (OutcomeKind.DETACHED,)
EITHER = (OutcomeKind.DETACHED, OutcomeKind.BELOW_ZONE)
"""Endings of a cycle that creeps: its edge, slower than that of the elastic instability, may be followed down
to the process zone."""


def zone_law(scene: Scene, which: str = "E0", closing: bool = False) -> FiniteZone:
    """The elastic closure of finite zone with the relaxed modulus ``E0`` or the glassy one ``Einf``."""
    assert isinstance(scene.indenter, Sphere)
    assert isinstance(scene.adhesion, Adhesion)
    modulus = {"E0": scene.material.relaxed_plane_modulus, "Einf": scene.material.glassy_plane_modulus}[which]
    work = scene.adhesion.closing if closing else scene.adhesion.work
    return FiniteZone(scene.indenter.radius, modulus, work, scene.adhesion.zone)


def elastic_cycle(
    scene: Scene,
    top: float,
    which: str = "E0",
    names: Iterable[str] = PULLED,
    endings: tuple[OutcomeKind, ...] = DETACHED,
    source: str = "",
) -> ClosedForm:
    """Press to ``top``, or start there, and pull off, elastic with one modulus.

    The loss is that of the model's own process zone, ``int (G - dg) dA`` from the start to where contact is
    lost, relative to the work of adhesion on the largest contact. A law that is stable down to its zone ends
    there alone.
    """
    law = zone_law(scene, which)
    pressed = zone_law(scene, which, closing=True).at_penetration(top)
    pulled, last = law.pull_off_force_control(), law.pull_off_penetration_control()
    if pressed.contact_radius < pulled.contact_radius:  # the tension is largest where a pinned edge lets go
        pulled = law.state(pressed.contact_radius)
    larger = max(abs(pressed.force), -pulled.force)
    known = (
        *_state("start", pressed, larger),
        *_state("approach", pressed, larger),
        Value("pull_off_force", -pulled.force),
        Value("final_penetration", last.penetration, top - last.penetration),
        Value("detachment_penetration", last.penetration, top - last.penetration),
    )
    values = {one.name: one for one in known}
    if "dissipated_energy" in names:
        loss = _zone_loss(law, last, law.at_penetration(scene.loading.penetration))
        adhering = law.work * math.pi * pressed.contact_radius**2
        values["dissipated_energy"] = Value("dissipated_energy", loss, adhering)
    ends = (OutcomeKind.BELOW_ZONE,) if law.shrinks_to_its_zone() else endings
    return ClosedForm(tuple(values[name] for name in names), source or f"{SOURCE}, {which}", ends)


def _state(when: str, state: ElasticContact, scale: float | None = None) -> tuple[Value, Value]:
    return Value(f"{when}_force", state.force, scale), Value(f"{when}_radius", state.contact_radius)


def _zone_loss(law: FiniteZone, low: ElasticContact, high: ElasticContact) -> float:
    """``int (G - dg) dA`` over the contact radii between two equilibria."""

    def excess(radius: float) -> float:
        return 2.0 * math.pi * radius * (law.energy_release_rate(radius) - law.work)

    return float(quad(excess, low.contact_radius, high.contact_radius, epsrel=1e-8)[0])


def faint(scene: Scene, top: float) -> ClosedForm:
    """Nearly Hertz: lost where the penetration is back at zero."""
    values = (
        *_state("start", zone_law(scene).at_penetration(top)),
        Value("detachment_penetration", 0.0, top),
    )
    return ClosedForm(values, f"{SOURCE}, nearly Hertz", DETACHED)


def started(scene: Scene, which: str) -> ClosedForm:
    """The run starts in an elastic equilibrium."""
    state = zone_law(scene, which).at_penetration(scene.loading.penetration)
    return ClosedForm(_state("start", state), SOURCE)


def rest(scene: Scene, penetration: float, which: str) -> ClosedForm:
    """The run ends in an elastic equilibrium at this penetration."""
    law = zone_law(scene, which)
    state, pulled = law.at_penetration(penetration), law.pull_off_force_control()
    larger = max(abs(state.force), -pulled.force)
    return ClosedForm(_state("final", state, larger), f"{SOURCE}, {which}")


def held(scene: Scene, tension: float) -> ClosedForm:
    """The run ends in the relaxed equilibrium under a dead load below the slow pull-off force."""
    law = zone_law(scene)
    least = law.pull_off_force_control().contact_radius
    state = law.state(float(brentq(lambda a: law.state(a).force + tension, least, 2.0 * least)))
    depth = Value("final_penetration", state.penetration)
    return ClosedForm((*_state("final", state), depth), f"{SOURCE}, E0")


def limit_point(spring: SpringContact, lost: ElasticContact, stage: float, way: float) -> ClosedForm:
    """A spring's contact is ``lost`` at the least ``stage``, so ``way`` from the start."""
    values = (
        Value("pull_off_force", -spring.largest_tension().force),
        Value("stage_at_detachment", stage, way),
        Value("instability_loss", spring.lost_in_snap(), spring.energy(lost)),
    )
    return ClosedForm(values, f"{SOURCE}, least stage", DETACHED)


def adhesionless_cycle(scene: Scene) -> ClosedForm:
    """Press and pull at the same speed, without adhesion, any spectrum and profile (:class:`Ting`)."""
    up = scene.loading.steps[0]
    assert isinstance(up, Ramp)
    cycle = Ting(scene.material, scene.indenter, rise=up.rate, peak=up.to / up.rate, fall=up.rate)
    values = (
        Value("approach_force", float(cycle.force(cycle.peak))),
        Value("approach_radius", float(cycle.contact_radius(cycle.peak))),
        Value("detachment_time", cycle.detachment()),
    )
    return ClosedForm(values, "Lee and Radok, Ting: hereditary integrals", DETACHED)


def pressed_layer(scene: Scene) -> ClosedForm:
    """The run ends in the elastic equilibrium of a layer, without adhesion."""
    up = scene.loading.steps[-1]
    assert isinstance(up, Ramp)
    assert scene.body is not None
    layer = ElasticLayer(scene.body, scene.material.poisson, scene.indenter)
    state = layer.state(layer.radius_at(up.to))
    force = scene.material.relaxed_plane_modulus * state.force
    return ClosedForm(_state("final", replace(state, force=force)), "integral equation of the elastic layer")


def punch_ramp(material: Material, radius: float, speed: float, top: float) -> ClosedForm:
    """A flat punch pressed to ``top``: ``F = 2 a V int_0^(top/V) E*(t) dt``."""
    carried = float(prony_integrals.relaxation_integral(material, top / speed))
    values = (Value("final_force", 2.0 * radius * speed * carried), Value("final_radius", radius))
    return ClosedForm(values, "Boussinesq's punch under the relaxation integral")


def punch_cycles(
    material: Material, radius: float, top: float, size: float, duration: float, cycles: int
) -> ClosedForm:
    """A flat punch swung at frequency one about the relaxed ``top``, all but the last quarter in cycles."""
    swing = float(punch_oscillation.force(material, radius, 1.0, size, duration))
    force = 2.0 * radius * material.relaxed_plane_modulus * top + swing
    loss = cycles * punch_oscillation.loss_per_cycle(material, radius, 1.0, size)
    return ClosedForm(
        (Value("final_force", force), Value("dissipated_energy", loss)), "punch under the complex modulus"
    )
