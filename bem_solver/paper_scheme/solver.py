"""The paper's own discretisation (Appendix A): uniform annuli and a fixed time step.

First order in the annulus width and in the step, by construction: the contact edge moves from border to
border. One factorisation a run, one forward and one backward solution a step, whatever the control.

The energies are exact for the discrete fields: a step makes each new branch field a combination of three
known ones, ``e_k = alpha e_k before + beta v before + gamma v after``, and with it the forms Y, X_k, W_k of
``energy``. The work a branch receives is taken with the pressure at the end of the step, as backward Euler
does: with that scheme no step then dissipates less than nothing.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from bem_solver.annuli import Annuli
from bem_solver.creep import Chain
from bem_solver.options import Options
from bem_solver.paper_scheme.annuli import (
    AnnuliState,
    ContactCandidates,
    UniformAnnuli,
    equilibrium_contact,
    step_factors,
)
from bem_solver.problem import ClosureRule, Problem
from bem_solver.recorder import RunRecord, trace_without_start
from bem_solver.size_estimates import FEWEST_ANNULI, MOST_ANNULI, largest_contact
from bem_solver.start import contact_scale
from contact_scene import (
    Counters,
    Material,
    Outcome,
    OutcomeKind,
    RunMonitor,
    Scene,
    SurfaceProfile,
    Trace,
    UnsupportedScene,
)
from contact_scene.run_control import (
    LoadingCursor,
    LoadingInterval,
    below_zone_outcome,
    budget_outcome,
    follow_loading,
    interruption,
)
from contact_scene.scene import zone_too_long

Array = NDArray[np.float64]

_MARGIN = 1.1
"""Outermost contact allowed for, relative to the estimate of the largest contact radius."""
_PER_RADIUS = 10
"""Annuli in the largest contact without adhesion, in multiples of the resolution."""
_STEPS_PER_RESOLUTION = 4.0
"""Steps per unit of the resolution in the shortest of the times to be resolved."""
_SAMPLES = 256
"""Times per interval at which the loading is sampled."""
_LONGEST_RATIO = 1000.0
"""Interval length over relaxation time above which the latter is no longer resolved."""
_HALVINGS = 8
"""Halvings of the step in which contact is lost: far below its error, which is of first order."""


def refusal_of_uniform(scene: Scene) -> UnsupportedScene | None:
    """Why uniform annuli do not take a scene; ``None`` if they do."""
    left_out = {
        "machine.stiffness": (scene.loading.compliance > 0.0, "uniform annuli know no spring"),
        "loading.steps": (scene.loading.has_triggers, "uniform annuli know no level that ends a step"),
    }
    for key in ("work_closing", "rate", "stress"):
        given = getattr(scene.adhesion, key, None) is not None
        left_out[f"adhesion.{key}"] = given, "uniform annuli know one work of adhesion and one process zone"
    left_out["body"] = scene.body is not None, "uniform annuli know no layer"
    for key, (given, why) in left_out.items():
        if given:
            return UnsupportedScene(key, why, 'annuli = "graded"')
    return None


def solve_uniform(
    scene: Scene, options: Options, progress: Callable[[float], None] | None, monitor: RunMonitor | None
) -> Trace:
    """Solve a scene on uniform annuli, as :func:`bem_solver.solve`."""
    counters, cursor = Counters(factorisations=1), LoadingCursor()
    run = _Run(scene, options, counters, monitor)
    try:
        if not run.start():
            return trace_without_start(scene.loading.without_start, counters)
        outcome = follow_loading(
            run, scene.loading, cursor, options.stop_times, options.profile_times, progress
        )
    except FloatingPointError as error:
        if not run.record.rows:
            return trace_without_start(str(error), counters)
        outcome = Outcome(OutcomeKind.NOT_FINITE, str(error), run.surface.time)
    radius, stored, heat, intensity = np.array(run.record.rows).T[3:]
    spent = -run.work * np.pi * (radius**2 - radius[0] ** 2)
    return run.record.finished(outcome, counters, run.work, (stored, spent, heat), intensity)


def _largest_radius(scene: Scene, chain: Chain) -> float:
    """Estimate of the largest contact radius; any length will do where there is never contact."""
    adhesion = scene.adhesion if scene.is_adhesive else None
    zone, work = (adhesion.zone, adhesion.work) if adhesion else (0.0, 0.0)
    rule = ClosureRule.resolving(FEWEST_ANNULI)
    problem = Problem(scene, Annuli(FEWEST_ANNULI), chain, zone, work, 1.0, Counters(), rule)
    return largest_contact(scene, problem) or contact_scale(scene, scene.loading.penetration) or 1.0


def _annuli_for(scene: Scene, divisions: int, largest: float) -> tuple[UniformAnnuli, int]:
    """The annuli, and the number of them in the largest contact that is allowed for.

    Under a flat punch the width is changed by less than one part in the number of annuli, so that its edge
    is a border. UnsupportedScene if the annuli would be too many for one dense matrix.
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


def step_count(
    scene: Scene, interval: LoadingInterval, options: Options, largest: float, length: float
) -> int:
    """Number of equal steps in which an interval is taken.

    A jump, which takes no time, is applied in ``4 resolution`` equal steps. Elsewhere, unless
    ``options.step`` is given, a step is ``1/(4 resolution)`` of the shortest of

    - the time in which, at the fastest loading, the edge of the largest contact travels ``length``, the
      process zone, or ``resolution`` annuli without adhesion;
    - the time in which that loading would sweep its range;
    - the shortest relaxation time, though not less than a thousandth of the interval: a fixed step cannot
      follow a spectrum over many decades, and both schemes are stable beyond it.
    """
    if interval.jump:
        return math.ceil(_STEPS_PER_RESOLUTION * options.divisions)
    if options.step is not None:
        return max(math.ceil(interval.length / options.step * (1.0 - 1e-12)), 1)
    # at multiples of the golden ratio, behind which no periodic loading can hide
    share = np.modf(0.5 * (math.sqrt(5.0) - 1.0) * np.arange(_SAMPLES))[0]
    times = (interval.start + interval.length * share).tolist()
    values = [interval.value(t) for t in (*times, interval.end)]
    travel = interval.length * max(abs(interval.rate(t)) for t in times)
    swing = max(values) - min(values)
    count = travel / swing if swing > 0.0 else 0.0
    slope = 2.0 * float(scene.indenter.slope(min(largest, scene.indenter.edge)))
    if interval.control == "force":
        slope *= 2.0 * scene.material.relaxed_plane_modulus * largest
    if slope > 0.0:
        count = max(count, travel / (slope * length))
    relaxation = scene.material.spectrum[1]
    if relaxation.size:
        count = max(count, interval.length / max(float(relaxation.min()), interval.length / _LONGEST_RATIO))
    return max(math.ceil(_STEPS_PER_RESOLUTION * options.divisions * count), 1)


@dataclass(frozen=True)
class _Energies:
    """Y, X (K,), W (K,), and what the branches have turned into heat."""

    load_work: float
    branch_work: Array
    branch_energy: Array
    dissipated: float

    @classmethod
    def at_start(cls, chain: Chain, annuli: UniformAnnuli, surface: AnnuliState, relaxed: bool) -> _Energies:
        """Of a start state that has relaxed, or a glassy one with no strain in the branches."""
        load_work = float(annuli.forces(surface.scaled) @ surface.load[: surface.contact])
        share = chain.compliances * (1.0 if relaxed else 0.0)
        return cls(load_work, share * load_work, share * chain.compliances * load_work, 0.0)

    def stored(self, chain: Chain) -> float:
        """Stored energy U."""
        return 0.5 * (self.load_work / chain.glassy + float(np.sum(self.branch_energy / chain.compliances)))

    def after(
        self, chain: Chain, annuli: UniformAnnuli, before: AnnuliState, after: AnnuliState
    ) -> _Energies:
        """After a step."""
        factors = step_factors(chain, after.time - before.time)
        forces, n = annuli.forces(after.scaled), after.contact
        load_work, branch_work = float(forces @ after.load[:n]), forces @ after.strains[:n]
        load_before, branch_before = float(forces @ before.load[:n]), forces @ before.strains[:n]
        energy = (
            factors.decay**2 * self.branch_energy
            + factors.before**2 * self.load_work
            + factors.after**2 * load_work
            + 2.0 * factors.decay * factors.before * self.branch_work
            + 2.0 * factors.decay * factors.after * branch_before
            + 2.0 * factors.before * factors.after * load_before
        )
        gained = 0.5 * (energy - self.branch_energy) / chain.compliances
        lost = float(np.sum(branch_work - branch_before - gained))
        return _Energies(load_work, branch_work, energy, self.dissipated + lost)


class _Run:
    """A run: what stays, and the committed state ``surface`` with its ``energies`` and ``record``.

    Rows are time, penetration, force, radius, stored energy, branch dissipation and stress intensity.
    """

    energies: _Energies

    def __init__(
        self, scene: Scene, options: Options, counters: Counters, monitor: RunMonitor | None
    ) -> None:
        self.scene, self.options, self.counters = scene, options, counters
        self.monitor = monitor
        self.chain = Chain(scene.material, options.scheme == "backward-euler")
        self.work = scene.adhesion.work if scene.adhesion else 0.0
        self.largest = _largest_radius(scene, self.chain)
        self.annuli, self.most = _annuli_for(scene, options.divisions, self.largest)
        self.length = self.annuli.width * options.divisions
        self.capped = scene.indenter.edge < math.inf
        self.surface = AnnuliState.untouched(self.annuli, len(self.chain), scene.loading.penetration)
        self.record = RunRecord()

    def reached(self) -> tuple[float, float, float]:
        """Time, penetration and force of the committed state."""
        return self.surface.time, self.surface.penetration, self.surface.force

    def reached_radius(self) -> float:
        """Contact radius of the committed state."""
        return self.surface.contact * self.annuli.width

    def start(self) -> bool:
        """Make the start state, glassy or relaxed; whether there is one."""
        material, penetration = self.scene.material, self.scene.loading.penetration
        relaxed = self.scene.loading.start == "relaxed"
        elastic = Chain(Material(material.modulus if relaxed else material.glassy_modulus, material.poisson))
        untouched = AnnuliState.untouched(self.annuli, 0, penetration)
        candidates = ContactCandidates(
            self.annuli, elastic, untouched, 0.0, "penetration", penetration, self.counters
        )
        contact = equilibrium_contact(candidates, self.most, self.most, self.capped, self.work)
        if contact is None or (contact == 0 and self.work > 0.0):
            return False
        if self.work > 0.0 and contact <= self.annuli.zone:
            raise zone_too_long(self.annuli.zone * self.annuli.width, contact * self.annuli.width)
        surface = candidates.state(contact, 0.0)
        strains = np.outer(surface.load, self.chain.compliances * (1.0 if relaxed else 0.0))
        energies = _Energies.at_start(self.chain, self.annuli, surface, relaxed)
        self._commit(replace(surface, strains=strains), energies)
        return True

    def follow(self, interval: LoadingInterval, report: Callable[[float], None]) -> Outcome | None:
        """Take the run through an interval in equal steps; an outcome if it ends there."""
        count = step_count(self.scene, interval, self.options, self.largest, self.length)
        self.record.kink()
        for index in range(1, count + 1):
            time = self.surface.time
            outcome = interruption(self.monitor, time) or budget_outcome(
                self.counters, self.options.max_steps, time
            )
            if outcome is not None:
                return outcome
            outcome = self._step(
                interval, interval.length if index == count else interval.length * index / count
            )
            report(self.surface.time)
            if outcome is not None:
                return outcome
        return None

    def _step(self, interval: LoadingInterval, parameter: float) -> Outcome | None:
        """Commit the equilibrium at a parameter of an interval; an outcome if the run ends with it.

        An edge that travels more than a process zone in a step is recorded as unstable. A contact that would
        become shorter than the zone ends with that length.
        """
        before, zone, adhesive = self.surface, self.annuli.zone, self.work > 0.0
        candidates, contact = self._equilibrium(interval, parameter)
        if contact is None:
            return Outcome(OutcomeKind.OUT_OF_RANGE, "the contact spreads beyond the annuli", before.time)
        time, value = interval.time(parameter), interval.prescribed(parameter)
        if contact == 0 < before.contact and adhesive and not interval.jump:
            last = self._last_contact(interval, parameter)
            if last is not None:
                time, contact = interval.time(last), zone
                candidates, _ = self._equilibrium(interval, last)
        lost = contact == 0 < before.contact
        below_zone = adhesive and 0 < contact <= zone
        if below_zone:
            contact = zone
        if lost or (adhesive and abs(contact - before.contact) > zone and not below_zone):
            self.record.event("snap-in" if contact > before.contact else "pull-off")
        if lost and adhesive:
            reason = f"no stable contact at {interval.control} {value:.6g}"
            return Outcome(OutcomeKind.DETACHED, reason, before.time)
        if contact == 0 and not lost and interval.control == "force" and value < 0.0:
            return Outcome(OutcomeKind.DETACHED, "pulled without contact", before.time)
        surface = candidates.state(contact, time)
        self._commit(surface, self.energies.after(self.chain, self.annuli, before, surface))
        self.counters.steps += 1
        if below_zone:
            return below_zone_outcome(self.record.forces, time)
        return Outcome(OutcomeKind.DETACHED, "the contact area fell to zero", time) if lost else None

    def _equilibrium(
        self, interval: LoadingInterval, parameter: float
    ) -> tuple[ContactCandidates, int | None]:
        """The contacts possible at a parameter, and the annuli in the stable one, if there is any."""
        before, value = self.surface, interval.prescribed(parameter)
        duration = 0.0 if interval.jump else interval.time(parameter) - before.time
        candidates = ContactCandidates(
            self.annuli, self.chain, before, duration, interval.control, value, self.counters
        )
        return candidates, equilibrium_contact(candidates, before.contact, self.most, self.capped, self.work)

    def _last_contact(self, interval: LoadingInterval, parameter: float) -> float | None:
        """Where in a step that loses it the contact is last in equilibrium.

        ``None`` if it is longer there than the process zone, by more than the annulus that is the accuracy of
        an edge: then it is lost at a limit point.
        """
        low, high = self.surface.time - interval.start, parameter
        contact = self.surface.contact
        for _ in range(_HALVINGS):
            middle = 0.5 * (low + high)
            reached = self._equilibrium(interval, middle)[1]
            if reached:
                low, contact = middle, reached
            else:
                high = middle
        return low if contact <= self.annuli.zone + 1 else None

    def _commit(self, surface: AnnuliState, energies: _Energies) -> None:
        """Take a state as the new committed one, and record its row."""
        if not (math.isfinite(surface.force) and math.isfinite(surface.penetration)):
            raise FloatingPointError("force or penetration is not finite")
        self.surface, self.energies = surface, energies
        row = (*self.reached(), self.reached_radius(), energies.stored(self.chain))
        self.record.rows.append((*row, energies.dissipated, surface.stress_intensity))

    def record_profile(self) -> None:
        """Record the surface at the collocation radii, as far as the annuli reach."""
        annuli, surface, contact = self.annuli, self.surface, self.surface.contact
        pressure = np.zeros(annuli.count)
        pressure[:contact] = surface.scaled / annuli.width
        displacement = surface.displacement(self.chain)
        gap = annuli.heights - surface.penetration + displacement
        gap[:contact] = 0.0
        reached, radius = self.reached(), self.reached_radius()
        self.record.profile(SurfaceProfile(*reached, radius, annuli.radii, pressure, displacement, gap))
