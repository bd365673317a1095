"""The paper's own discretisation (Appendix A): uniform annuli and a fixed time step.

First order in the annulus width and in the step, by construction: the contact edge moves from border to
border. One factorisation a run, one forward and one backward solution a step, whatever the control.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from bem_solver.annuli import Annuli
from bem_solver.closure import ClosureRule
from bem_solver.creep import Chain
from bem_solver.energy import Energies, initial_energies
from bem_solver.loading_intervals import LoadingInterval, follow_loading
from bem_solver.options import Options
from bem_solver.paper_scheme.annuli import AnnuliState, ContactCandidates, UniformAnnuli, equilibrium_contact
from bem_solver.paper_scheme.energy import start_energies, step_energies
from bem_solver.paper_scheme.time_steps import step_count
from bem_solver.problem import Problem
from bem_solver.recorder import TraceRecorder, trace_without_contact
from bem_solver.size_estimates import FEWEST_ANNULI, MOST_ANNULI, largest_contact
from bem_solver.start import contact_scale
from contact_scene import (
    Counters,
    Event,
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
    KeptState,
    LoadingCursor,
    below_zone_outcome,
    budget_outcome,
    interruption,
    kept_state,
)
from contact_scene.scene import zone_too_long

SOLVER = "bem, uniform annuli"

_MARGIN = 1.1
"""Outermost contact allowed for, relative to the estimate of the largest contact radius."""
_HALVINGS = 8
"""Halvings of the step in which contact is lost: far below its error, which is of first order."""
_PER_RADIUS = 10
"""Annuli in the largest contact without adhesion, in multiples of the resolution."""


@dataclass
class UniformState:
    """Serialisable state of a run on uniform annuli.

    Attributes
    ----------
    surface, energies
        Committed state of the surface and its energies.
    record
        Rows, events and profiles so far.
    steps_done
        Steps of the present loading interval that are done.
    """

    surface: AnnuliState
    energies: Energies
    record: TraceRecorder
    steps_done: int = 0


def refusal_of_uniform(scene: Scene) -> UnsupportedScene | None:
    """Why uniform annuli do not take a scene; ``None`` if they do."""
    if scene.loading.compliance > 0.0:
        return UnsupportedScene("machine.stiffness", "uniform annuli know no spring", 'annuli = "graded"')
    if scene.loading.has_triggers:
        return UnsupportedScene(
            "loading.steps", "uniform annuli know no level that ends a step", 'annuli = "graded"'
        )
    return None


def solve_uniform(
    scene: Scene, options: Options, progress: Callable[[float], None] | None, monitor: RunMonitor | None
) -> Trace:
    """Solve a scene on uniform annuli.

    Parameters
    ----------
    scene, options, progress, monitor
        As for :func:`bem_solver.solve`.

    Returns
    -------
    Trace

    Raises
    ------
    UnsupportedScene
        If the annuli would be too many for one dense matrix.
    SceneError
        If the process zone does not fit into the contact at the start, or the kept state is another solver's.
    """
    kept = kept_state(monitor, SOLVER)
    counters = kept.counters if kept is not None else Counters(factorisations=1)
    cursor = kept.cursor if kept is not None else LoadingCursor()
    run = _Run(scene, options, counters, cursor, monitor)
    penetration = scene.loading.penetration
    try:
        if kept is not None:
            run.state = kept.content
        elif not run.start():
            reason = f"no stable contact at penetration {penetration:.6g}"
            return trace_without_contact(penetration, reason, counters, run.work)
        outcome = follow_loading(
            run, scene.loading, cursor, options.stop_times, options.profile_times, progress
        )
    except FloatingPointError as error:
        if not run.state.record.rows:
            return trace_without_contact(penetration, str(error), counters, run.work)
        outcome = Outcome(OutcomeKind.NOT_FINITE, str(error), run.state.surface.time)
    return run.state.record.trace(outcome, counters, run.work)


def _largest(scene: Scene, chain: Chain) -> float:
    """Estimate of the largest contact radius; any length will do where there is never contact."""
    adhesion = scene.adhesion if scene.is_adhesive else None
    zone, work = (adhesion.zone, adhesion.work) if adhesion else (0.0, 0.0)
    rule = ClosureRule.resolving(FEWEST_ANNULI)
    problem = Problem(scene, Annuli(FEWEST_ANNULI), chain, zone, work, 1.0, Counters(), rule)
    return largest_contact(scene, problem) or contact_scale(scene, scene.loading.penetration) or 1.0


def _annuli(scene: Scene, divisions: int, largest: float) -> tuple[UniformAnnuli, int]:
    """The annuli, and the number of them in the largest contact that is allowed for.

    Under a flat punch the width is changed by less than one part in the number of annuli, so that its edge
    is a border.
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


class _Run:
    """A run: what stays, and the state that changes."""

    def __init__(
        self,
        scene: Scene,
        options: Options,
        counters: Counters,
        cursor: LoadingCursor,
        monitor: RunMonitor | None,
    ) -> None:
        self.scene, self.options, self.counters = scene, options, counters
        self.cursor, self.monitor = cursor, monitor
        self.chain = Chain(scene.material, options.scheme == "backward-euler")
        self.work = scene.adhesion.work if scene.adhesion else 0.0
        self.largest = _largest(scene, self.chain)
        self.annuli, self.most = _annuli(scene, options.divisions, self.largest)
        self.length = self.annuli.width * options.divisions
        self.capped = scene.indenter.edge < math.inf
        untouched = AnnuliState.untouched(self.annuli, len(self.chain), scene.loading.penetration)
        self.state = UniformState(
            untouched, initial_energies(self.chain, 0.0, relaxed=False), TraceRecorder()
        )

    def reached(self) -> tuple[float, float, float]:
        """Time, penetration and force of the committed state."""
        surface = self.state.surface
        return surface.time, surface.penetration, surface.force

    def kept(self) -> KeptState:
        """The state to continue from."""
        return KeptState(SOLVER, self.cursor, self.counters, self.state)

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
        self._commit(
            replace(surface, strains=strains), start_energies(self.chain, self.annuli, surface, relaxed)
        )
        return True

    def reached_radius(self) -> float:
        """Contact radius of the committed state."""
        return self.state.surface.contact * self.annuli.width

    def follow(self, interval: LoadingInterval, report: Callable[[float], None]) -> Outcome | None:
        """Take the run through an interval in equal steps; an outcome if it ends there."""
        state = self.state
        count = step_count(self.scene, interval, self.options, self.largest, self.length)
        if state.steps_done == 0:
            state.record.kink()
        while state.steps_done < count:
            time = state.surface.time
            outcome = interruption(self.monitor, self.kept, time) or budget_outcome(
                self.counters, self.options.max_steps, time
            )
            if outcome is not None:
                return outcome
            index = state.steps_done + 1
            outcome = self._step(
                interval, interval.length if index == count else interval.length * index / count
            )
            report(state.surface.time)
            if outcome is not None:
                return outcome
            state.steps_done = index
        state.steps_done = 0
        return None

    def _step(self, interval: LoadingInterval, parameter: float) -> Outcome | None:
        """One step; an outcome if the run ends with it.

        An edge that travels more than a process zone in a step is recorded as unstable. A contact that would
        become shorter than the zone ends with that length.
        """
        before, time, value = self.state.surface, interval.time(parameter), interval.prescribed(parameter)
        candidates, contact = self._equilibrium(interval, parameter)
        if contact is None:
            reason = "the contact spreads beyond the annuli"
            return Outcome(OutcomeKind.OUT_OF_RANGE, reason, before.time)
        if contact == 0 < before.contact and self.work > 0.0 and not interval.jump:
            last = self._last_contact(interval, parameter)
            if last is not None:
                time, contact = interval.time(last), self.annuli.zone
                candidates, _ = self._equilibrium(interval, last)
        lost = contact == 0 and before.contact > 0
        below_zone = self.work > 0.0 and 0 < contact <= self.annuli.zone
        if below_zone:
            contact = self.annuli.zone
        jump = self.work > 0.0 and abs(contact - before.contact) > self.annuli.zone
        if lost or (jump and not below_zone):
            self._event("snap-in" if contact > before.contact else "pull-off")
        if lost and self.work > 0.0:
            reason = f"no stable contact at {interval.control} {value:.6g}"
            return Outcome(OutcomeKind.DETACHED, reason, before.time)
        if contact == 0 and not lost and interval.control == "force" and value < 0.0:
            return Outcome(OutcomeKind.DETACHED, "pulled without contact", before.time)
        surface = candidates.state(contact, time)
        energies = step_energies(self.chain, self.annuli, self.state.energies, before, surface)
        self._commit(surface, energies)
        self.counters.steps += 1
        if below_zone:
            return below_zone_outcome(self.state.record.forces, time)
        return Outcome(OutcomeKind.DETACHED, "the contact area fell to zero", time) if lost else None

    def _equilibrium(
        self, interval: LoadingInterval, parameter: float
    ) -> tuple[ContactCandidates, int | None]:
        """The contacts possible at a parameter, and the annuli in the stable one, if there is any."""
        before = self.state.surface
        duration = 0.0 if interval.jump else interval.time(parameter) - before.time
        candidates = ContactCandidates(
            self.annuli,
            self.chain,
            before,
            duration,
            interval.control,
            interval.prescribed(parameter),
            self.counters,
        )
        return candidates, equilibrium_contact(candidates, before.contact, self.most, self.capped, self.work)

    def _last_contact(self, interval: LoadingInterval, parameter: float) -> float | None:
        """Where in a step that loses it the contact is last in equilibrium.

        ``None`` if it is longer there than the process zone, by more than the annulus that is the accuracy of
        an edge: then it is lost at a limit point.
        """
        low, high = self.state.surface.time - interval.start, parameter
        contact = self.state.surface.contact
        for _ in range(_HALVINGS):
            middle = 0.5 * (low + high)
            reached = self._equilibrium(interval, middle)[1]
            if reached:
                low, contact = middle, reached
            else:
                high = middle
        return low if contact <= self.annuli.zone + 1 else None

    def _commit(self, surface: AnnuliState, energies: Energies) -> None:
        if not (math.isfinite(surface.force) and math.isfinite(surface.penetration)):
            raise FloatingPointError("force or penetration is not finite")
        self.state.surface, self.state.energies = surface, energies
        radius = surface.contact * self.annuli.width
        stored, intensity = energies.stored(self.chain), surface.stress_intensity
        row = (surface.time, surface.penetration, surface.force, radius)
        self.state.record.rows.append((*row, stored, energies.dissipated, intensity, 0.0))

    def _event(self, kind: str) -> None:
        surface = self.state.surface
        radius = surface.contact * self.annuli.width
        event = Event(kind, surface.time, surface.penetration, surface.force, radius)
        self.state.record.events.append(event)

    def record_profile(self) -> None:
        """Record the surface in the committed state."""
        self.state.record.profile(self._profile())

    def _profile(self) -> SurfaceProfile:
        """The committed state at the collocation radii, as far as the annuli reach."""
        surface, annuli, contact = self.state.surface, self.annuli, self.state.surface.contact
        pressure = np.zeros(annuli.count)
        pressure[:contact] = surface.scaled / annuli.width
        displacement = surface.displacement(self.chain)
        gap = annuli.heights - surface.penetration + displacement
        gap[:contact] = 0.0
        return SurfaceProfile(
            surface.time,
            surface.penetration,
            surface.force,
            contact * annuli.width,
            annuli.radii,
            pressure,
            displacement,
            gap,
        )
