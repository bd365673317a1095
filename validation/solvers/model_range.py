"""Whether a scene lies within the range of the model and of the solvers, told without solving it.

What no solver can compute is refused: counts beyond any budget of steps, sizes whose ratio is lost in
round-off, products that leave the range of floats. What can be computed, but means little, is a warning: a
process zone that is no small part of the contact, a contact that outgrows the half-space, a test that ends
before contact is lost.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from contextlib import suppress
from dataclasses import replace

import numpy as np

import contact_scene as cs
from contact_scene.scene import THINNEST, zone_too_long
from validation.reference.elastic_layer import ElasticLayer
from validation.reference.jkr import JKR
from validation.solvers.contact_range import (
    contact_bounds,
    largest_contact_radius,
    largest_penetration,
    start_radius,
)

MOST_CYCLES = 1e6
"""Cycles of a loading. A cycle has ten rows or more: ten million of them are what a trace can hold."""
MOST_STEPS = 100_000
"""Load steps and rows of loading tables; each takes a time step at least."""
MOST_BRANCHES = 10_000
"""Branches of a material; each is carried by every point of the surface."""
LARGEST_CONTRAST = 1e12
"""Glassy over relaxed modulus: beyond, the relaxed response is lost in the round-off of the glassy one."""
LARGEST_IN_ZONES = 1e9
"""Largest contact radius over the process zone: beyond, the position of the edge within its zone has less
than seven digits left."""
LARGEST_GROWTH = 1e3
"""Largest contact radius over the length of the indenter (radius of a sphere, extent of a table): beyond,
there is nothing of the indenter left in the answer."""
SHORTEST_STEP = 1e-12
"""Duration of a load step over the time at which it begins: below, it is lost in the round-off of time."""
SMALLEST_PRODUCT, LARGEST_PRODUCT = 1e-90, 1e90
"""Forces and energies of the contact: their squares and products with a further quantity fit into a float."""
LARGEST_ZONE = 0.2
"""Process zone over contact radius beyond which the zone is no small region at the edge: its length enters
the force at first order, a few percent there."""
THIN = 10.0
"""Contact radius over the thickness of a layer from which on few answers are compared."""
LARGEST_STRAIN = 1.0 / 3.0
"""Penetration over the thickness of a layer above which its strains are no longer small."""
NEARLY_INCOMPRESSIBLE, UNTOLD = (0.45, 0.5), 2.0
"""Poisson's ratios between which, and contact radius over thickness from which on, the third digit of the
ratio decides the stiffness of a bonded layer: 0.49 makes 0.91 of what 0.5 makes at 2 thicknesses."""
LARGEST_SLOPE = 0.5
"""Slope of the indenter at the contact edge beyond which the half-space, a theory of small slopes, is poor:
for a sphere at half its radius, where the paraboloid is 7 % lower than the sphere."""


def cycle_count(scene: cs.Scene) -> float:
    """Cycles of all oscillations and sweeps of a loading."""
    return sum(step.cycles_by(math.inf) for step in scene.loading.steps)


def interval_count(scene: cs.Scene) -> int:
    """Intervals of a loading between its kinks."""
    return sum(len(segment.kinks) + 1 for _, segment in scene.loading.segments(own_time=True))


def out_of_range(scene: cs.Scene) -> cs.SceneError | None:
    """Why no solver can compute a scene, with its key and what is allowed; ``None`` if they can."""
    return next(_reasons(scene), None)


def _reasons(scene: cs.Scene) -> Iterator[cs.SceneError]:
    material = scene.material
    branches = len(material.branches) + len(getattr(material.bulk, "branches", ()))
    if branches > MOST_BRANCHES:
        yield cs.SceneError("material.branches", f"got {branches} branches", f"at most {MOST_BRANCHES}")
    contrast = material.glassy_modulus / material.modulus
    if contrast > LARGEST_CONTRAST:
        problem = f"the glassy modulus is {contrast:.3g} times the relaxed one"
        yield cs.SceneError("material.branches", problem, f"at most {LARGEST_CONTRAST:g} times")
    kinks = [len(segment.kinks) for _, segment in scene.loading.segments(own_time=True)]
    rows = sum(count + 2 if count else 1 for count in kinks)
    if rows > MOST_STEPS:
        yield cs.SceneError("loading.steps", f"got {rows} steps and rows of tables", f"at most {MOST_STEPS}")
    cycles = cycle_count(scene)
    if cycles > MOST_CYCLES:
        problem = f"the oscillations have {cycles:.3g} cycles"
        yield cs.SceneError("loading.steps", problem, f"at most {MOST_CYCLES:g}")
    yield from _lost_steps(scene)
    bounds = contact_bounds(scene)  # what holds at both of them holds between
    if bounds is None or any(any(_sizes(scene, bound)) for bound in bounds):
        with suppress(cs.SceneError):  # a loading that never touches
            yield from _sizes(scene, largest_contact_radius(scene))


def _lost_steps(scene: cs.Scene) -> Iterator[cs.SceneError]:
    """Load steps that are too short to advance the time at which they begin."""
    begin = 0.0
    for index, (_, segment) in enumerate(scene.loading.segments(own_time=True)):
        duration = segment.end
        if 0.0 < duration < SHORTEST_STEP * begin:
            problem = f"lasts {duration:.3g} from t = {begin:.3g} on, less than the time can resolve"
            allowed = f"at least {SHORTEST_STEP:g} of the time before it, or no duration"
            yield cs.SceneError(f"loading.steps[{index}]", problem, allowed)
        begin += duration


def _sizes(scene: cs.Scene, largest: float) -> Iterator[cs.SceneError]:
    """Ratios and products of lengths and moduli, given the largest contact radius."""
    length = _length(scene)
    if scene.body is not None and start_radius(scene) > scene.body.largest_contact:
        yield scene.body.outgrown
    if largest > LARGEST_GROWTH * length:
        times = f"{largest:.3g}, {largest / length:.3g} times the indenter's {length:.3g}"
        allowed = f"a contact of at most {LARGEST_GROWTH:g} times the indenter"
        yield cs.SceneError(_growing_by(scene, length), f"the contact radius grows to {times}", allowed)
    if scene.adhesion is not None and scene.is_adhesive:
        zone, least = scene.adhesion.zone, largest / LARGEST_IN_ZONES
        if zone >= min(length, largest):
            yield zone_too_long(zone, min(length, largest))
        if zone < least:
            problem = f"the contact radius grows to {largest / zone:.3g} process zones"
            yield cs.SceneError(
                "adhesion.zone", problem, f"at most {LARGEST_IN_ZONES:g}: a zone >= {least:.3g}"
            )
    for modulus in (scene.material.relaxed_plane_modulus, scene.material.glassy_plane_modulus):
        exponents = [math.log10(modulus) + power * math.log10(largest) for power in (2, 3)]
        if min(exponents) < math.log10(SMALLEST_PRODUCT) or max(exponents) > math.log10(LARGEST_PRODUCT):
            problem = f"with a contact radius of {largest:.3g}, {modulus:.3g} leaves the range of energies"
            allowed = f"products from {SMALLEST_PRODUCT:g} to {LARGEST_PRODUCT:g}; choose other units"
            yield cs.SceneError("material.modulus", problem, allowed)


def _growing_by(scene: cs.Scene, length: float) -> str:
    """Key of what makes the contact outgrow the indenter: the adhesion, if it does not without."""
    try:
        pressed = largest_contact_radius(replace(scene, adhesion=None))
    except cs.SceneError:
        return "adhesion.work"
    return "loading" if pressed > LARGEST_GROWTH * length else "adhesion.work"


def _length(scene: cs.Scene) -> float:
    """The indenter's own length; infinite if it has none or ends there."""
    indenter = scene.indenter
    if isinstance(indenter, cs.Sphere):
        return indenter.radius
    return indenter.radii[-1] if isinstance(indenter, cs.TabulatedProfile) else math.inf


@np.errstate(over="ignore", under="ignore")
def scene_warnings(scene: cs.Scene) -> tuple[str, ...]:
    """What makes the answer to a scene doubtful, known before it is solved; one sentence each."""
    found = tuple(_long_zone(scene, start_radius(scene))) if scene.is_adhesive else ()
    try:
        largest = largest_contact_radius(scene)
        strained = _strained(scene, largest_penetration(scene), largest) if scene.body is not None else ()
        return (*found, *strained, *_outgrown(scene, largest, "would grow"))
    except cs.SceneError:
        return found


def trace_warnings(scene: cs.Scene, trace: cs.Trace) -> tuple[str, ...]:
    """What makes an answer doubtful, from its rows; one sentence each."""
    if len(trace) == 0:
        return ()
    row = int(np.argmax(trace.contact_radius))
    largest, when = float(trace.contact_radius[row]), f"grows by t = {trace.time[row]:.4g}"
    start = _long_zone(scene, float(trace.contact_radius[0]))
    strained = _strained(scene, float(trace.penetration.max()), largest)
    ends = *_held_at_the_rim(scene, trace), *_still_in_contact(scene, trace)
    return (*start, *strained, *_outgrown(scene, largest, when), *ends)


def _held_at_the_rim(scene: cs.Scene, trace: cs.Trace) -> Iterator[str]:
    """A sentence on a flat face whose rim bears more tension than a fresh crack needs in the glassy body."""
    adhesion, radius = scene.adhesion, scene.indenter.edge
    if adhesion is None or not scene.is_adhesive or scene.body is not None:
        return
    if not isinstance(scene.indenter, cs.FlatPunch):
        return
    work, glassy = adhesion.opening(math.inf), scene.material.glassy_plane_modulus
    elastic = JKR(scene.indenter, glassy, adhesion.work)
    released = float(elastic.energy_release_rate_from_force(radius, min(trace.force.min(), 0.0)))
    if released > work * (1.0 + adhesion.zone / radius):
        yield (
            f"the face bears {released / work:.3g} times the work of adhesion at its rim, where 1 opens a "
            "fresh crack at any speed: the surface beside a face that was pressed in keeps its shape, which "
            "the closure takes for a gap that is yet to open"
        )


def _still_in_contact(scene: cs.Scene, trace: cs.Trace) -> Iterator[str]:
    """A sentence on a test to a level, such as an approach, that does not retract until contact is lost."""
    steps = scene.loading.steps
    if not scene.loading.has_triggers or not isinstance(steps[-1], cs.Ramp) or steps[-1].trigger is not None:
        return
    pulls = trace.contact_radius[-1] > 0.0 and 0.0 > trace.force[-1] == trace.force.min()
    if pulls and trace.outcome.kind is cs.OutcomeKind.COMPLETED:
        yield (
            f"the retraction ends at {steps[-1].to:.4g} in contact, at the largest tension so far: the "
            "pull-off force is not known; retract farther (`away` of an approach, `to` of a last ramp)"
        )


def _long_zone(scene: cs.Scene, start: float) -> Iterator[str]:
    """A sentence on a process zone that is no small part of the contact at the start."""
    if scene.adhesion is None or not scene.is_adhesive or not start > 0.0:
        return
    share = scene.adhesion.zone / start
    if share > LARGEST_ZONE:
        yield (
            f"the process zone is {share:.2g} of the contact radius at the start; above {LARGEST_ZONE:g} it "
            "is no small region at the edge"
        )


def _strained(scene: cs.Scene, depth: float, radius: float) -> Iterator[str]:
    """Sentences on a layer, given the largest penetration and contact radius."""
    if scene.body is None:
        return
    layer, poisson = scene.body, scene.material.poisson
    ratio = radius / layer.thickness
    if depth > LARGEST_STRAIN * layer.thickness:
        yield (
            f"the penetration reaches {depth / layer.thickness:.2g} of the thickness; above "
            f"{LARGEST_STRAIN:.2g} the strains are not small"
        )
    if scene.adhesion is not None and scene.is_adhesive:
        share = scene.adhesion.zone / layer.thickness
        if share > LARGEST_ZONE:
            yield (
                f"the process zone is {share:.2g} of the thickness; above {LARGEST_ZONE:g} the layer is no "
                "half-space at the edge"
            )
    if ratio > THIN:
        yield (
            f"the contact radius is {ratio:.3g} times the thickness; above {THIN:g} few answers have been "
            "compared"
        )
    low, high = NEARLY_INCOMPRESSIBLE
    if layer.base == "bonded" and low < poisson < high and UNTOLD < ratio < THINNEST:
        stiff, stiffest = (
            ElasticLayer(layer, nu, cs.FlatPunch(radius)).response(radius).stiffness for nu in (poisson, high)
        )
        yield (
            f"with Poisson's ratio {poisson:g} the layer has {stiff / stiffest:.2g} of the stiffness of an "
            f"incompressible one at {ratio:.2g} thicknesses; its third digit decides"
        )


def _outgrown(scene: cs.Scene, radius: float, grows: str) -> Iterator[str]:
    """Sentences on a contact radius that is too large for the indenter or for the half-space."""
    if math.isfinite(scene.indenter.edge):
        return
    length = _length(scene)
    if isinstance(scene.indenter, cs.TabulatedProfile) and radius > length:
        end = f"the last row of the profile at {length:.3g}"
        yield f"the contact radius {grows} to {radius:.3g}, beyond {end}: it is continued straight from there"
    slope = float(scene.indenter.slope(radius))
    if slope > LARGEST_SLOPE:
        steep = f"where the slope of the indenter is {slope:.2g}"
        poor = f"above {LARGEST_SLOPE:g} a half-space is a poor model"
        yield f"the contact radius {grows} to {radius:.3g}, {steep}: {poor}"
