"""The paper's own discretisation (Appendix A): uniform annuli and a fixed time step.

First order in the annulus width and in the step, by construction: the contact edge moves from border to
border. One factorisation a run, one forward and one backward solution a step, whatever the control.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np

from bem_solver.creep import Chain
from bem_solver.energy import initial_energies
from bem_solver.loading_intervals import LoadingInterval, follow_loading
from bem_solver.options import Options
from bem_solver.paper_scheme.annuli import AnnuliState, ContactCandidates, equilibrium_contact
from bem_solver.paper_scheme.energy import start_energies, step_energies
from bem_solver.paper_scheme.run_state import UniformState, annuli_profile
from bem_solver.paper_scheme.size_estimates import annuli_for, estimated_largest_radius
from bem_solver.paper_scheme.step import UniformStep
from bem_solver.paper_scheme.time_steps import step_count
from bem_solver.recorder import TraceRecorder, trace_without_start
from contact_scene import Counters, Material, Outcome, OutcomeKind, RunMonitor, Scene, Trace, UnsupportedScene
from contact_scene.run_control import LoadingCursor, below_zone_outcome, budget_outcome, interruption
from contact_scene.scene import zone_too_long


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
        If the process zone does not fit into the contact at the start.
    """
    counters, cursor = Counters(factorisations=1), LoadingCursor()
    run = _Run(scene, options, counters, monitor)
    try:
        if not run.start():
            return trace_without_start(scene.loading.without_start, counters)
        outcome = follow_loading(
            run, scene.loading, cursor, options.stop_times, options.profile_times, progress
        )
    except FloatingPointError as error:
        if not run.state.record.rows:
            return trace_without_start(str(error), counters)
        outcome = Outcome(OutcomeKind.NOT_FINITE, str(error), run.state.surface.time)
    return run.state.record.trace(outcome, counters, run.work)


class _Run:
    """A run: what stays, and the state that changes."""

    def __init__(
        self,
        scene: Scene,
        options: Options,
        counters: Counters,
        monitor: RunMonitor | None,
    ) -> None:
        self.scene, self.options, self.counters = scene, options, counters
        self.monitor = monitor
        self.chain = Chain(scene.material, options.scheme == "backward-euler")
        self.work = scene.adhesion.work if scene.adhesion else 0.0
        self.largest = estimated_largest_radius(scene, self.chain)
        self.annuli, self.most = annuli_for(scene, options.divisions, self.largest)
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
        energies = start_energies(self.chain, self.annuli, surface, relaxed)
        self.state.commit(self.chain, self.annuli, replace(surface, strains=strains), energies)
        return True

    def reached_radius(self) -> float:
        """Contact radius of the committed state."""
        return self.state.surface.contact * self.annuli.width

    def follow(self, interval: LoadingInterval, report: Callable[[float], None]) -> Outcome | None:
        """Take the run through an interval in equal steps; an outcome if it ends there."""
        state = self.state
        count = step_count(self.scene, interval, self.options, self.largest, self.length)
        state.record.kink()
        for index in range(1, count + 1):
            time = state.surface.time
            outcome = interruption(self.monitor, time) or budget_outcome(
                self.counters, self.options.max_steps, time
            )
            if outcome is not None:
                return outcome
            outcome = self._step(
                interval, interval.length if index == count else interval.length * index / count
            )
            report(state.surface.time)
            if outcome is not None:
                return outcome
        return None

    def _step(self, interval: LoadingInterval, parameter: float) -> Outcome | None:
        """Commit one step; an outcome if the run ends with it."""
        state, before = self.state, self.state.surface
        step = UniformStep(
            self.annuli, self.chain, self.work, self.counters, self.most, self.capped, before, interval
        )
        end = step.end(parameter)
        if end.event is not None:
            state.event(end.event, self.annuli.width)
        if end.surface is None:
            return end.outcome
        energies = step_energies(self.chain, self.annuli, state.energies, before, end.surface)
        state.commit(self.chain, self.annuli, end.surface, energies)
        self.counters.steps += 1
        if end.below_zone:
            return below_zone_outcome(state.record.forces, end.surface.time)
        return end.outcome

    def record_profile(self) -> None:
        """Record the surface in the committed state."""
        state = self.state
        state.record.profile(annuli_profile(self.chain, self.annuli, state.surface))
