"""Scenes side by side, and the ramps that drive them."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, fields, is_dataclass, replace
from functools import cached_property
from typing import Any, Self

import numpy as np
from numpy.typing import NDArray

from contact_scene import Hold, Ramp, Scene
from validation.reference.path.rheology import Rheology
from validation.reference.sneddon import PowerTransform, transform

Array = NDArray[np.float64]
Whole = NDArray[np.intp]
State = tuple[Array, Array, Array]
"""Penetration (B,), what times leave of what relaxes, and branch forces ``E_k M_k``, both (n, B)."""


PROGRAMMES = ["ramp"], ["hold", "ramp"], ["ramp", "ramp"], ["ramp", "hold", "ramp"]
"""Kinds of load steps."""


BACK = 0.1
"""Part of the shortest relaxation time for which fields go on smoothly where time turns back, so that its
largest value is found by polynomials. With 1 there is no root where steps are long beside that time."""
COLUMNS = 16
"""Columns of a product of matrices."""


def refusal(scene: Scene) -> str:
    """Why a scene is none of those that are solved here; empty if it is."""
    adhesion, loading = scene.adhesion, scene.loading
    if not scene.is_adhesive or adhesion is None:
        return "no adhesion"
    if adhesion.stress is not None:
        return "a cohesive stress: its zone has no fixed length"
    if adhesion.rate is not None:
        return "a work of adhesion that depends on the speed"
    if scene.body is not None:
        return "a layer"
    shape = transform(scene.indenter)
    if not isinstance(shape, PowerTransform) or shape.coefficient == 0.0:
        return "an indenter that is no power of the radius"
    if loading.start not in ("relaxed", "jump-in"):
        return f"the start {loading.start!r}"
    if [step.kind for step in loading.steps] not in PROGRAMMES:
        return "load steps other than one ramp or two, and a hold before the last"
    ramps = [step for step in loading.steps if isinstance(step, Ramp)]
    levels = [None if step.trigger is None else step.trigger.quantity for step in loading.steps]
    if not {levels[0], levels[-1]} <= {None, "force"} or any(levels[1:-1]):
        return "a level that ends a load step, but for a force at which a ramp ends"
    if ramps[-1].to >= (ramps[0].to if len(ramps) == 2 else loading.penetration):
        return "a last ramp that does not retract"
    if len(ramps) == 2 and ramps[0].to <= loading.penetration:
        return "two ramps the first of which does not approach"
    return ""


def filled(numbers: Whole) -> Whole:
    """Up to a multiple of ``COLUMNS``, by the last: products of matrices round each column alike then."""
    return np.append(numbers, np.repeat(numbers[-1:], -len(numbers) % COLUMNS))


def _numbers(scene: Scene) -> tuple[float, ...]:
    """Shape, adhesion and loading of a scene that is solved here, in the order of the fields of bodies."""
    shape, adhesion, loading = transform(scene.indenter), scene.adhesion, scene.loading
    ramps = [step for step in loading.steps if isinstance(step, Ramp)]
    first, last = ramps[0], ramps[-1]
    assert isinstance(shape, PowerTransform)
    assert adhesion is not None
    depth = loading.penetration
    deepest = first.to if len(ramps) == 2 else depth
    parts = shape.coefficient, shape.exponent, adhesion.zone, adhesion.work, adhesion.closing
    approach, retraction = (deepest - depth) / first.rate, (deepest - last.to) / last.rate
    hold = sum(step.duration for step in loading.steps if isinstance(step, Hold))
    level = math.nan if first is last or first.until_force is None else first.until_force
    least = math.nan if last.until_force is None else last.until_force
    driven = first.rate, approach, level, hold, -last.rate, retraction, least
    return *parts, loading.start == "jump-in", depth, *driven, loading.compliance


def turns(scene: Scene) -> bool:
    """Whether anything goes before the last ramp that the edge may move in."""
    return scene.loading.start == "jump-in" or len(scene.loading.steps) > 1


class SideBySide:
    """A dataclass of what scenes have along the last axis of arrays; of one column if all have the same."""

    def of_some(self, chosen: Whole, known: dict[int, Any] | None = None) -> Self:
        """Of some scenes; ``known``: parts of it that others share, by what they were made of."""
        known = {} if known is None else known

        def taken(part: Any) -> Any:
            if isinstance(part, SideBySide):
                if id(part) not in known:
                    known[id(part)] = part.of_some(chosen, known)
                return known[id(part)]
            several = isinstance(part, np.ndarray) and part.shape[-1] > 1
            return part.take(chosen, axis=-1) if several else part

        assert is_dataclass(self)
        return replace(self, **{part.name: taken(getattr(self, part.name)) for part in fields(self)})


@dataclass(frozen=True, eq=False)
class Bodies(SideBySide):
    """Scenes side by side, along the last axis: plane moduli, times and shape as in the reference."""

    relaxed: Array
    moduli: Array
    times: Array
    compliances: Array
    retardation: Array
    units_of_branches: Array
    coefficient: Array
    exponent: Array
    zone: Array
    work: Array
    closing: Array
    glassy: Array
    depth: Array
    approach: Array
    turn: Array
    level: Array
    hold: Array
    rate: Array
    duration: Array
    least: Array
    compliance: Array

    @classmethod
    def of(cls, scenes: Sequence[Scene], rheologies: Sequence[Rheology]) -> Bodies:
        """Of scenes with as many branches each."""
        names = "moduli", "times", "compliances", "retardation", "units_of_branches"
        found = [np.array([getattr(one, name) for one in rheologies]) for name in names]
        moduli, times, compliances, retardation, mixing = (
            np.ascontiguousarray(np.moveaxis(spectrum, 0, -1)) for spectrum in found
        )
        numbers = np.array([_numbers(scene) for scene in scenes]).T
        relaxed = np.array([one.relaxed for one in rheologies])
        return cls(relaxed, moduli, times, compliances, retardation, mixing, *np.ascontiguousarray(numbers))

    @cached_property
    def earliest(self) -> Array:
        """Time since an event from which on fields change, where time turns back as contact is lost."""
        return -BACK * self.times.min(axis=0, initial=np.inf)

    def shape(self, x: Array) -> Array:
        """``G`` (m, B) at radii."""
        return self.coefficient * (x * x if (self.exponent == 2.0).all() else x**self.exponent)

    def released(self, depth: Array, branches: Array) -> Array:
        """``A_j`` (n, B)."""
        strain = self.compliances * (self.relaxed * depth)
        return np.asarray(strain + (self.units_of_branches * branches[:, None]).sum(axis=0))

    def volume(self, radius: Array) -> Array:
        """``int_0^a G dx``."""
        return np.asarray(self.coefficient * radius ** (self.exponent + 1.0) / (self.exponent + 1.0))

    def force(self, depth: Array, branches: Array, radius: Array, held: Array) -> Array:
        """``2 int_0^a q dx`` where ``held`` (n, B) are integrals of what is left beside the ``branches``."""
        uniform = (self.relaxed * depth + branches.sum(axis=0)) * radius
        return 2.0 * (uniform - self.relaxed * self.volume(radius) + held.sum(axis=0))


@dataclass(frozen=True, eq=False)
class LoadRamp(SideBySide):
    """A ramp: penetration and branch forces ``E_k M_k`` where it begins, its rate, and a hold before it.

    Of the stage, where there is a spring: what holds of the indenter is in :mod:`.machine`.
    """

    bodies: Bodies
    depth: Array
    rate: Array
    branches: Array
    hold: Array | None = None

    def __call__(self, t: Array) -> State:
        """At times (B,) or (m, B) since it began."""
        return self.at(t)[0], *self.faded(t)

    def at(self, t: Array) -> tuple[Array, Array]:
        """Both at times (B,) or (m, B) since it began: (B,) and (n, B), or (m, B) and (n, m, B)."""
        late = t if self.hold is None else np.maximum(t - self.hold, 0.0)
        return self.depth + self.rate * late, self.faded(t)[1]

    def faded(self, t: Array) -> tuple[Array, Array]:
        """What times leave of what relaxes, and the branch forces then."""
        times, begun, steady = self.bodies.times, self.branches, self.steady
        if t.ndim == 2:
            times, begun, steady = times[:, None], begun[:, None], steady[:, None]
        faded = np.exp(-t / times)
        driven = faded if self.hold is None else np.exp(-np.maximum(t - self.hold, 0.0) / times)
        return faded, steady + begun * faded - steady * driven

    @cached_property
    def steady(self) -> Array:
        """Branch forces (n, B) in the end."""
        return np.asarray(self.bodies.moduli * self.rate * self.bodies.times)

    def after(self, t: Array, rate: Array, hold: Array | None = None) -> LoadRamp:
        """One that follows at a time."""
        return LoadRamp(self.bodies, *self.at(t)[:1], rate, self.at(t)[1], hold)
