"""What must hold for any scene: one body for all solvers.

Each function takes a solver at its coarsest and random arguments, and raises ``AssertionError`` where it does
not hold.

The loss of the energy balance, ``dissipated_energy``, cannot fall without adhesion only: a process zone of
finite length takes more than the work of adhesion to open and gives as much back as it closes, so that the
balance shows a reversible gain or loss. What the branches dissipate never falls, with adhesion or without.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from support.invariants.coarse_solvers import CoarseSolver

import contact_scene as cs
from benchmarks.trace_invariants import (
    CLEAR,
    ROUND_OFF,
    broken,
    effort,
    energy_gained,
    in_contact,
)

ROOTS = 0.01
"""Accuracy of roots, in what a run promises of a step."""
ENERGIES = ("stored_energy", "external_work", "dissipated_energy")  # each the difference of the others


def answered(solver: CoarseSolver, scene: cs.Scene, **asked) -> cs.Trace | None:
    """A trace, or ``None`` for a refusal, which has to be one line."""
    try:
        return solver.solve(scene, **asked)
    except cs.SceneError as error:
        refusal = str(error)
    assert refusal
    assert "\n" not in refusal
    return None


def profiled(solver: CoarseSolver, scene: cs.Scene) -> cs.Trace | None:
    """The answer with profiles at the start, within and at the end of the first load step.

    The same for all invariants of the same scenes, so that these are solved once.
    """
    first = scene.loading.steps[0].segment(0.0, scene.loading.penetration, 0.0)
    return answered(solver, scene, times=(0.0, first.start + 0.4 * (first.end - first.start), first.end))


def answers_or_refuses(solver: CoarseSolver, scene: cs.Scene) -> None:
    """Nothing but finite numbers, time that never runs back, a typed outcome, the load reached."""
    trace = profiled(solver, scene)
    if trace is None:
        return
    assert isinstance(trace.outcome, cs.Outcome)
    assert isinstance(trace.outcome.kind, cs.OutcomeKind)
    assert trace.outcome.finished or trace.outcome.kind in CLEAR
    assert broken(scene, trace) == []


def accounts_for_the_interface(solver: CoarseSolver, scene: cs.Scene) -> None:
    """Opening takes up at least the work of adhesion, closing gives its energy back; the rest is balanced."""
    trace = answered(solver, scene)
    if trace is None or len(trace) == 0 or scene.adhesion is None:
        return
    assert trace.outcome.finished or trace.outcome.kind in CLEAR
    spent = trace.extra["separation_energy"]
    stored = trace.stored_energy + trace.extra.get("machine_energy", 0.0)
    stored = stored - stored[0]
    lost = trace.external_work - stored - spent
    terms = np.abs([trace.external_work, stored, spent]).max()
    assert np.abs(lost - trace.dissipated_energy).max() <= 1e-12 * terms
    area = np.pi * trace.contact_radius**2
    exact = scene.adhesion.rate is None or solver.name != "reference"  # whose rows between steps are cubics
    rounding = (1e-9 if exact else 1e-3) * scene.adhesion.work * area.max(initial=0.0)
    opened, change = -np.diff(area), np.diff(spent)
    closes = opened <= 0.0
    assert np.abs(change - scene.adhesion.closing * opened)[closes].max(initial=0.0) <= rounding
    assert np.all(change[~closes] >= scene.adhesion.work * opened[~closes] - rounding)


def stays_within_the_step_budget(solver: CoarseSolver, scene: cs.Scene, budget: int) -> None:
    """A run stops at its budget of steps and says so."""
    trace = answered(solver, scene, budget=budget)
    if trace is None:
        return
    spent = trace.counters.steps + trace.counters.rejected_steps
    assert spent <= budget
    if spent < budget:
        assert trace.outcome.kind is not cs.OutcomeKind.STEP_BUDGET
    assert all(np.isfinite(column).all() for column in trace.columns().values())


def gains_no_energy(solver: CoarseSolver, scene: cs.Scene) -> None:
    """Branches only dissipate; no energy is stored that is negative; without adhesion nothing is gained."""
    trace = profiled(solver, scene)
    if trace is None or len(trace) == 0:
        return
    assert "branch_dissipation" in trace.extra
    assert energy_gained(scene, trace, solver.declared(scene)) == []


def closes_the_energy_balance(solver: CoarseSolver, scene: cs.Scene) -> None:
    """What the branches dissipate is the work done, less what is stored and the tip takes; it takes time.

    A sharp edge takes the glassy ``K^2/(2 Einf*)`` per area; as soon as an edge that rested or receded
    advances, that is the one of the ground it has just covered. The finite elements do without ``K`` and give
    the residual of their own balance. The boundary elements are asked without adhesion only: ``K`` is that of
    their annuli, which do not reach into the layer that an edge leaves behind.
    """
    trace = profiled(solver, scene)
    if trace is None or len(trace) == 0 or trace.events or (solver.name == "bem" and scene.is_adhesive):
        return
    columns = {name: column[in_contact(trace)] for name, column in trace.columns().items()}
    flows = np.diff(columns["time"]) > 0.0
    dissipated = np.diff(columns["branch_dissipation"])
    assert np.abs(dissipated[~flows]).max(initial=0.0) <= ROUND_OFF * effort(scene, trace)
    if "balance_residual" in columns:
        residual = columns["balance_residual"]
    else:
        stored = columns["stored_energy"] + columns.get("machine_energy", 0.0)
        work, unknown = _tip_work(scene, columns)
        missed = np.diff(columns["external_work"] - stored) + work - dissipated
        missed -= np.clip(missed, -unknown, unknown)
        residual = np.cumsum(np.where(flows, missed, 0.0))
    assert np.abs(residual).max(initial=0.0) <= solver.declared(scene) * effort(scene, trace)


def _tip_work(scene: cs.Scene, columns: dict[str, np.ndarray]) -> tuple[np.ndarray, np.ndarray]:
    """What the tip releases in each step, and what rows cannot tell of that.

    The latter where its rate jumps within the step, as an edge comes to ground where it has been before. The
    rate between two rows is the cubic with the slopes of Fritsch and Butland, where they go one way.
    """
    rate = columns["stress_intensity_factor"] ** 2 / (2.0 * scene.material.glassy_plane_modulus)
    one, two = rate[:-1], rate[1:]
    swept = np.pi * np.diff(columns["contact_radius"] ** 2)
    advances = swept > 0.0
    sets_out = advances & ~np.concatenate(([False], advances))[: len(advances)]
    jumps = advances & ~sets_out & (np.maximum(one, two) > 2.0 * np.minimum(one, two))
    work = np.where(sets_out, two, 0.5 * (two + one)) * swept
    chord = np.divide(two - one, swept, out=np.zeros_like(swept), where=swept != 0.0)
    before, after, near, far = chord[:-1], chord[1:], np.abs(swept[:-1]), np.abs(swept[1:])
    smooth = (swept[1:] * swept[:-1] > 0.0) & (before * after > 0.0)
    slope = np.full(len(rate), np.nan)
    weights = (2.0 * far + near) * after + (far + 2.0 * near) * before
    product = 3.0 * (near + far) * before * after
    np.divide(product, weights, out=slope[1:-1], where=smooth)
    work -= np.nan_to_num((slope[1:] - slope[:-1]) * swept**2 / 12.0)
    return work, np.where(jumps, 0.5 * np.abs(two - one) * swept, 0.0)


def separates_contact_from_gap(solver: CoarseSolver, scene: cs.Scene) -> None:
    """No pressure outside the contact; no gap inside; outside none that is negative beyond one division."""
    trace = profiled(solver, scene)
    if trace is None:
        return
    for profile in trace.profiles:
        for name in ("radius", "pressure", "displacement", "gap"):
            assert np.isfinite(getattr(profile, name)).all(), name
        a = profile.contact_radius
        if a == 0.0:
            assert not profile.pressure.any()
            continue
        assert np.all(np.diff(profile.radius) > 0.0)
        zone = scene.adhesion.zone if scene.adhesion is not None and scene.is_adhesive else 0.02 * a
        near = zone / solver.resolution
        inside, outside = profile.radius < a - near, profile.radius > a + near
        assert not profile.pressure[outside].any()
        assert not profile.gap[inside].any()
        under = profile.radius <= scene.indenter.edge  # nothing is above the surface beyond a sharp edge
        scale = float(np.abs(profile.gap).max())
        assert profile.gap[outside & under].min(initial=0.0) >= -ROUND_OFF * scale
        assert profile.gap[under].min() >= -solver.declared(scene) * scale


def is_relaxed_when_slow(solver: CoarseSolver, scene: cs.Scene, depth: float) -> None:
    """A ramp far slower than every relaxation time ends as an elastic contact of ``E0``."""
    slowest = max((branch.time for branch in scene.material.branches), default=1.0)
    _same_as_elastic(solver, scene, depth, scene.material.modulus, 1e10 * slowest)


def is_glassy_when_fast(solver: CoarseSolver, scene: cs.Scene, depth: float) -> None:
    """A ramp far faster than every relaxation time ends as an elastic contact of ``Einf``."""
    fastest = min((branch.time for branch in scene.material.branches), default=1.0)
    _same_as_elastic(solver, scene, depth, scene.material.glassy_modulus, 1e-10 * fastest)


def _same_as_elastic(
    solver: CoarseSolver, scene: cs.Scene, depth: float, modulus: float, span: float
) -> None:
    start = scene.loading.penetration
    ramp = cs.Table((0.0, span), (start, depth))
    ramped = solver.end(replace(scene, loading=cs.Loading("jump-in", start, (ramp,))))
    elastic = cs.Material(modulus, scene.material.poisson)
    still = solver.end(replace(scene, material=elastic, loading=cs.Loading("relaxed", depth)))
    _agree(ramped, still)


def _agree(one: dict[str, tuple[float, float]], two: dict[str, tuple[float, float]]) -> None:
    for name, (value, error) in one.items():
        other, its_error = two[name]
        assert abs(value - other) <= error + its_error, f"{name}: {value} +- {error}, {other} +- {its_error}"


def dissipates_over_a_closed_cycle(solver: CoarseSolver, scene: cs.Scene) -> None:
    """From a relaxed state around and back: the work done is what is lost, and never negative."""
    trace = answered(solver, scene)
    if trace is None or trace.outcome.kind is not cs.OutcomeKind.COMPLETED:
        return
    assert trace.penetration[-1] == trace.penetration[0]
    assert trace.external_work[-1] >= -solver.declared(scene) * effort(scene, trace)
    if not scene.material.is_elastic and np.ptp(trace.penetration) > 0.0:
        assert trace.extra["branch_dissipation"][-1] > 0.0


def is_independent_of_units(
    solver: CoarseSolver, scene: cs.Scene, other: cs.Scene, units: dict[str, float]
) -> None:
    """The same scene in other units: the same answer (see :func:`differences_in_units`)."""
    found = differences_in_units(solver, scene, other, units)
    assert not found, found


def differences_in_units(
    solver: CoarseSolver, scene: cs.Scene, other: cs.Scene, units: dict[str, float]
) -> list[str]:
    """What differs where a scene is stated in other units: the rows beyond 1e-9, energies of the effort.

    At a given moment the half-space is glassy: what an edge is off counts ``Einf/E0``-fold in a soft force.
    A root is sought to a tolerance, a step chosen by differences that magnify rounding. Where rounding turned
    such a decision the counters of work or the times of the rows differ: then the same end, as closely as a
    step is held to. One trial more for one root and one less for another leave them as they are: then rows
    may be as far apart as a root is sought, if most are the same to rounding.

    Parameters
    ----------
    solver : CoarseSolver
    scene, other : Scene
        The same in two systems of units.
    units : dict of str to float
        By column, the size of a unit of ``scene`` in units of ``other``.

    Returns
    -------
    list of str
        Columns, "outcome", or "refusal" if one of the two is refused; empty if the answers are the same.
    """
    trace, twin = answered(solver, scene), answered(solver, other)
    if trace is None or twin is None:
        return [] if trace is twin else ["refusal"]
    if twin.outcome.kind is not trace.outcome.kind:
        return ["outcome"]
    same = len(twin) == len(trace) and twin.counters == trace.counters
    if same:
        apart = np.abs(twin.time / units["time"] - trace.time)
        same = apart.max(initial=0.0) <= 1e-9 * trace.time.max(initial=0.0)
    exactly = 1e-9 * scene.material.glassy_modulus / scene.material.modulus
    rows, close = (slice(None), exactly) if same else (slice(-1, None), solver.declared(scene))
    apart = {}
    for name, unit in units.items():
        column = trace.columns()[name]
        scale = effort(scene, trace) if name in ENERGIES else np.abs(column).max(initial=0.0)
        missed = np.abs(twin.columns()[name][rows] / unit - column[rows])
        apart[name] = missed / scale if scale > 0.0 else missed
    states = [apart[name] for name in units if name not in ENERGIES]
    to_rounding = all(np.median(missed) <= 1e-3 * exactly for missed in states)
    if same and to_rounding and any(missed.max() > exactly for missed in states):
        close = max(exactly, ROOTS * solver.declared(scene))
    return [name for name, missed in apart.items() if not missed.max(initial=0.0) <= close]


def is_independent_of_a_relaxed_hold(solver: CoarseSolver, scene: cs.Scene, rest: float) -> None:
    """A relaxed state held before the loading begins changes nothing but the time."""
    steps = scene.loading.steps
    held = replace(scene, loading=replace(scene.loading, steps=(cs.Hold(rest), *steps)))
    _agree(solver.end(scene), solver.end(held))


def superposes_at_fixed_radius(
    solver: CoarseSolver, material: cs.Material, histories: tuple, start: str
) -> None:
    """At a fixed contact radius the force is linear in the history of the penetration."""
    times, first, second, shares = histories
    both = [shares[0] * a + shares[1] * b for a, b in zip(first, second, strict=True)]
    forces = []
    for depths in (first, second, both):
        loading = cs.Loading(start, depths[0], (cs.Table(times, tuple(depths)),))
        # held so strongly that it never lets go
        trace = solver.solve(cs.Scene(material, cs.FlatPunch(0.2), loading, cs.Adhesion(1e6, 0.02)))
        assert trace.outcome.kind is cs.OutcomeKind.COMPLETED
        assert np.all(trace.contact_radius == 0.2)
        rows = [np.flatnonzero(trace.time == time)[-1] for time in times]
        forces.append(trace.force[rows])
    sum_of_both = shares[0] * forces[0] + shares[1] * forces[1]
    scale = max(np.abs(force).max() for force in forces)
    assert np.abs(forces[2] - sum_of_both).max() <= 1e-9 * scale


def ignores_a_branch_without_modulus(solver: CoarseSolver, scene: cs.Scene, time: float, place: int) -> None:
    """Of no modulus, or of one below rounding: the same bits."""
    plain = answered(solver, scene)
    for modulus in (0.0, 1e-32 * scene.material.modulus):
        branches = list(scene.material.branches)
        branches.insert(place, cs.Branch(modulus, time))
        more = answered(solver, replace(scene, material=replace(scene.material, branches=tuple(branches))))
        assert (plain is None) == (more is None)
        if plain is None or more is None:
            return
        assert more.outcome == plain.outcome
        for name, column in plain.columns().items():
            assert np.array_equal(more.columns()[name], column), name
