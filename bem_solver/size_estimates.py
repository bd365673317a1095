"""The annuli of a run, from estimates of the largest contact and the thinnest boundary layer."""

from __future__ import annotations

import math
from functools import cache

import numpy as np
from scipy.special import ellipkm1

from bem_solver.annuli import Annuli
from bem_solver.body import Compliance
from bem_solver.creep import Chain
from bem_solver.equilibrium import contact_scale, elastic_problem, equilibrium, untouched_state
from bem_solver.options import Options
from bem_solver.problem import LONG_ZONE, ClosureRule, Problem
from bem_solver.trial import TrialContact
from contact_scene import Cone, Counters, Ramp, Scene, Step

FEWEST_ANNULI, MOST_ANNULI = 16, 4000
"""Bounds on the number of annuli: interpolation at the edge needs the first, a dense matrix the second."""
_SMOOTH_SHARE = 0.01
"""Part of the largest radius that is resolved where nothing varies faster than over the radius, but for the
root at the edge, which is taken out: without adhesion, and in an elastic contact, whatever its zone."""

_FINER_OF_LONG_ZONE = 2
"""By how much annuli are finer at the centre where the zone is long: fields vary over a few zones there."""
_FINER_OF_THIN_LAYER = 1.0 / 3.0
"""The same on a layer, per thickness in the radius of the contact: pressures vary over a thickness there."""
_ANNULI_OF_ESTIMATE, _ON_LAYER = 24, 64
"""Annuli of the elastic contacts from which the largest radius is estimated, to about a percent; on a layer
it may be thirty thicknesses."""
_FINER_AT_EDGE = 8.0
"""By how much graded annuli are finer at the edge than the resolution asks of the process zone: it costs a
few annuli, and the relaxing layer behind a slowly advancing edge errs by the square of that step."""
_AT_CENTRE = 1.5
"""Graded annuli per unit of the angle, in divisions: behind a slow edge, whose steps are long, they miss more
than the steps do with fewer, and they cost next to nothing."""
_SMALLEST_GRADING = 1e-5
"""Smallest step of graded annuli at the edge over that at the centre: below it the elliptic functions lose
digits, and no process zone above 1e-10 of the radius asks for it."""
_NEGLIGIBLE_LAYER = 0.01
"""A layer that changes the closure by less than this part of the work of adhesion is not resolved."""
_UNSEEN_LAYER = 0.05
"""A layer of less than this part of the outermost annulus that the zone asks for leaves no trace on graded
annuli. A thicker one they see badly unless they resolve it, and the edge then moves in jerks."""
_NEGLIGIBLE_AT_REST = 0.03
"""The same part while the load rests and the edge slows down through every speed."""


def edge_step(divisions: int, share: float, radius: float, layer: float) -> float:
    """Step of the angle ``arcsin(r)`` at the edge that puts ``divisions`` annuli into the process zone.

    The zone is a ``share`` of the largest radius. The outermost annulus is ``3.4/divisions**2`` of a boundary
    ``layer`` (zero without): it grows with the resolution, as the annuli in the zone do.
    """
    step = float(np.arccos(1.0 - share)) / divisions
    if layer == 0.0:
        return step
    return min(step, 0.5 * np.pi / math.ceil(0.6 * divisions * math.sqrt(radius / layer)))


def graded_annuli(divisions: float, step: float) -> tuple[int, float]:
    """Number and grading of annuli with a ``step`` of the angle at the edge, ``2/(3 divisions)`` within."""
    grading = min(max(divisions * step / _FINER_AT_EDGE, _SMALLEST_GRADING), 1.0)
    return max(int(np.ceil(_AT_CENTRE * divisions * ellipkm1(grading**2))), FEWEST_ANNULI), grading


def thinnest_layer(scene: Scene, chain: Chain, radius: float, zone: float, divisions: int) -> float:
    """Thickness of the thinnest layer behind an advancing edge that has to be resolved; zero without.

    Advancing at speed v, the stress of branch k relaxes over ``v tau_k``, which changes the closure by the
    order of ``(E_k/E0) v tau_k/da``. On a ramp ``v = rate/(2 df/dr)``; while the load rests, or turns round
    and leaves it time to relax, it falls through every value, down to where the layer hardly matters. The
    layer of a rest shorter than the relaxation time is taken thicker by the square of their ratio.
    """
    slope = float(scene.indenter.slope(radius))
    penetration, slowest, rest = scene.loading.penetration, np.inf, 0.0
    for step in scene.loading.steps:
        if isinstance(step, Ramp):
            if step.to > penetration:
                slowest = min(slowest, step.rate)
            penetration = step.to
        rest = max(rest, step.longest_rest)
    strength = chain.stress_scale**2 / chain.relaxation / chain.relaxed
    layers = slowest / (2.0 * slope) * chain.relaxation if slope > 0.0 else np.full(len(chain), np.inf)
    too_short = np.maximum(chain.relaxation / rest, 1.0) if rest > 0.0 else np.inf
    layers = np.minimum(layers, _NEGLIGIBLE_AT_REST * zone / strength * too_short**2)
    outermost = zone / (_FINER_AT_EDGE * divisions) ** 2
    negligible = np.minimum(_NEGLIGIBLE_LAYER * zone / strength, _UNSEEN_LAYER * outermost)
    matter = (layers < zone) & (layers > negligible)
    return float(layers[matter].min()) if matter.any() else 0.0


def largest_contact(scene: Scene) -> float:
    """Estimate of the largest contact radius: the relaxed equilibrium at the largest load of every step."""
    annuli = Annuli(_ANNULI_OF_ESTIMATE if scene.body is None else _ON_LAYER)
    rule = ClosureRule.resolving(FEWEST_ANNULI)
    problem = Problem(scene, annuli, Chain(scene.material), 1.0, Counters(), rule)
    elastic = elastic_problem(problem, scene.material.modulus)
    radius, penetration, force = 0.0, scene.loading.penetration, 0.0

    def by_force(value: float, scale: float) -> float:
        # force over 2 E* a is a length; the profile is that high somewhere
        guess = abs(value) / (2.0 * elastic.chain.relaxed)
        return contact_scale(scene, guess / scale if scale > 0 else guess**0.5)

    @cache
    def settled(control: str, value: float, scale: float) -> TrialContact | None:
        return equilibrium(elastic, untouched_state(elastic, 0.0), control, value, scale)

    def settle(control: str, value: float) -> tuple[float, float, float]:
        deepest = penetration if control == "force" else value
        scale = max(contact_scale(scene, deepest), radius)
        if control == "force":
            scale = max(scale, by_force(value, scale))
        elif control == "stage":  # no deeper than the stage, no force beyond what moves it there
            least = max(contact_scale(scene, penetration), radius)
            scale = min(scale, max(least, by_force(value / scene.loading.compliance, least)))
        if scale == 0.0:
            return 0.0, penetration, 0.0
        trial = settled(control, value, scale)
        if trial is None:
            return 0.0, penetration if control == "force" else value, 0.0
        return trial.surface.edge, trial.motion.new_penetration, trial.surface.force

    radius, penetration, force = settle(scene.loading.start_control, penetration)

    def state(_: Step) -> tuple[float, float]:
        return penetration, force

    for _, segment in scene.loading.segments(state, own_time=True):
        times = np.unique(np.concatenate((np.linspace(segment.start, segment.end, 129), segment.kinks)))
        values = [segment.value(float(t)) for t in times]
        edge, *reached = settle(segment.control, max(values))
        trigger = segment.trigger
        if trigger is not None and trigger.quantity == "radius":
            edge = min(edge, trigger.level)
        elif trigger is not None and trigger.quantity == "force":
            limited, *under = settle("force", trigger.level)
            edge, reached = (limited, under) if limited < edge else (edge, reached)
        radius = max(radius, edge)
        if segment.control == "penetration" and trigger is None:
            penetration = values[-1]
        elif trigger is not None and segment.control != "force":
            penetration, force = reached
        else:
            _, penetration, force = settle(segment.control, values[-1])
    return min(radius, scene.indenter.edge)


def discretised(scene: Scene, options: Options, counters: Counters) -> Problem:
    """The problem on annuli that resolve process zone and boundary layer."""
    divisions, chain = options.divisions, Chain(scene.material, options.scheme == "backward-euler")
    zone = scene.adhesion.zone if scene.adhesion and scene.is_adhesive else 0.0
    initial = contact_scale(scene, scene.loading.penetration)
    largest = largest_contact(scene) or initial
    exponent = 1.0 if isinstance(scene.indenter, Cone) else getattr(scene.indenter, "exponent", 2.0)
    thin = _FINER_OF_THIN_LAYER * largest / Compliance.of(scene).thickness
    within, layer = divisions, 0.0
    if zone > 0.0 and largest > 0.0 and len(chain):
        share = min(zone / largest, 1.0)
        finer = max(1 if zone < LONG_ZONE * largest else _FINER_OF_LONG_ZONE, thin)
        layer = thinnest_layer(scene, chain, largest, zone, divisions)
        step = edge_step(divisions, share, largest, layer)
        annuli = Annuli(*graded_annuli(finer * divisions, step), exponent)
        at_edge = np.arccos(1.0 - share) / step  # more than the annuli in the zone where they resolve a layer
        within = int(max(annuli.number_within(share), at_edge))
    else:
        count = 0.5 * np.pi * divisions * max(_AT_CENTRE * thin, 1.0 / np.arccos(1.0 - _SMOOTH_SHARE))
        annuli = Annuli(min(max(math.ceil(count), FEWEST_ANNULI), MOST_ANNULI), exponent=exponent)
    length, rule, tolerance = zone or 0.01 * largest, ClosureRule.resolving(within), options.step_tolerance
    scale = max(largest, initial)
    return Problem(scene, annuli, chain, length, counters, rule, tolerance, divisions, scale, layer)
