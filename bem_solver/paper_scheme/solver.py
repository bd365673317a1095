"""The paper's own discretisation (Appendix A) as a baseline: uniform annuli and a fixed time step.

First order in the annulus width and in the step, by construction: the contact edge moves from border to
border. One factorisation a run, one forward and one backward solution a step, whatever the control.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from itertools import islice

import numpy as np

from bem_solver.annuli import Annuli
from bem_solver.checkpoint import Place, State, goes_on, put_back, taken
from bem_solver.closure import ClosureRule
from bem_solver.creep import Chain
from bem_solver.energy import Energies, at_start
from bem_solver.loading_intervals import Piece, pieces
from bem_solver.options import Options
from bem_solver.paper_scheme.annuli import Instant, Sheet, UniformAnnuli, settled
from bem_solver.paper_scheme.energy import start_energies, step_energies
from bem_solver.paper_scheme.time_steps import step_count
from bem_solver.recorder import Recorder
from bem_solver.size_estimates import FEWEST, MOST, largest_contact
from bem_solver.start import contact_scale
from bem_solver.trial import Problem
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
from contact_scene.scene import zone_too_long

_ROOM = 1.1  # outermost contact, in estimated largest contact radii
_PER_RADIUS = 10  # annuli in the largest contact without adhesion, in resolutions


def solve_uniform(
    scene: Scene, options: Options, progress: Callable[[float], None] | None, watch: RunMonitor | None = None
) -> Trace:
    """Solve a scene on uniform annuli; parameters and result as for :func:`bem_solver.solve`.

    Raises
    ------
    UnsupportedScene
        If the annuli would be too many for one dense matrix.
    SceneError
        If the process zone does not fit into the contact at the start.
    """
    run = _Run(scene, options, watch)
    counters, recorder, penetration = run.counters, run.recorder, scene.loading.penetration
    try:
        if watch is not None and watch.kept is not None:
            run.go_on(watch.kept)
        elif not run.start():
            reason = f"no stable contact at penetration {penetration:.6g}"
            return recorder.nothing(penetration, reason, counters)
        outcome = run.through(progress)
    except FloatingPointError as error:
        if not recorder.rows:
            return recorder.nothing(penetration, str(error), counters)
        outcome = Outcome(OutcomeKind.NOT_FINITE, str(error), run.sheet.time)
    return recorder.trace(outcome, counters)


def _largest(scene: Scene, chain: Chain) -> float:
    """Estimate of the largest contact radius; any length will do where there is never contact."""
    adhesion = scene.adhesion if scene.is_adhesive else None
    zone, work = (adhesion.zone, adhesion.work) if adhesion else (0.0, 0.0)
    rule = ClosureRule.resolving(FEWEST)
    problem = Problem(scene, Annuli(FEWEST), chain, zone, work, 1.0, Counters(), rule)
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
    most = (math.ceil(_ROOM * largest / width) if edge == math.inf else round(edge / width)) + 1
    count = most + max(zone, most // 10 + 1)
    if count > MOST:
        raise UnsupportedScene(
            "adhesion.zone",
            f"{count} uniform annuli would be needed",
            f'at most {MOST}: a lower resolution, a longer zone, or annuli "graded"',
        )
    if edge != math.inf:
        most = max(most - 1, 1)
        width = edge / most
    return UniformAnnuli(width, count, zone, scene.indenter), most


class _Run:
    """A run: what stays, and the committed sheet and energies."""

    def __init__(self, scene: Scene, options: Options, watch: RunMonitor | None) -> None:
        self.scene, self.options, self.watch = scene, options, watch
        self.place = Place()
        self.chain = Chain(scene.material, options.scheme == "backward-euler")
        self.work = scene.adhesion.work if scene.adhesion else 0.0
        self.counters = Counters(factorisations=1)
        self.recorder = Recorder(self.chain, self.work)
        self.largest = _largest(scene, self.chain)
        self.annuli, self.most = _annuli(scene, options.divisions, self.largest)
        self.length = self.annuli.width * options.divisions
        self.capped = scene.indenter.edge < math.inf
        self.sheet = Sheet.untouched(self.annuli, len(self.chain), scene.loading.penetration)
        self.energies = at_start(self.chain, 0.0, relaxed=False)

    def start(self) -> bool:
        """Make the start state, glassy or relaxed; whether there is one."""
        material, penetration = self.scene.material, self.scene.loading.penetration
        relaxed = self.scene.loading.start == "relaxed"
        elastic = Chain(Material(material.modulus if relaxed else material.glassy_modulus, material.poisson))
        untouched = Sheet.untouched(self.annuli, 0, penetration)
        instant = Instant(self.annuli, elastic, untouched, 0.0, "penetration", penetration, self.counters)
        contact = settled(instant, self.most, self.most, self.capped, self.work)
        if contact is None or (contact == 0 and self.work > 0.0):
            return False
        if self.work > 0.0 and contact <= self.annuli.zone:
            raise zone_too_long(self.annuli.zone * self.annuli.width, contact * self.annuli.width)
        sheet = instant.sheet(contact, 0.0)
        strains = np.outer(sheet.load, self.chain.compliances * (1.0 if relaxed else 0.0))
        self._commit(replace(sheet, strains=strains), start_energies(self.chain, self.annuli, sheet, relaxed))
        return True

    def state(self) -> State:
        """All that changes."""
        moving = {"sheet": self.sheet, "energies": self.energies, "place": self.place}
        return taken(moving, self.recorder, self.counters)

    def go_on(self, kept: State) -> None:
        """Stand where the kept run stood."""
        moving = put_back(kept, self.recorder, self.counters)
        self.sheet, self.energies, self.place = moving["sheet"], moving["energies"], moving["place"]

    def through(self, progress: Callable[[float], None] | None) -> Outcome:
        """Carry out the loading."""
        stops, steps = self.options.profile_times, self.scene.loading.steps
        place = self.place
        if 0.0 in stops and place.fresh:
            self.recorder.profile(self._profile())
        while place.step < len(steps):
            sheet = self.sheet
            time, penetration, force = place.enter(sheet.time, sheet.penetration, sheet.force)
            segment = steps[place.step].segment(time, penetration, force)
            span = segment.end - segment.start

            def report(index: int = place.step, start: float = segment.start, span: float = span) -> None:
                if progress is not None:
                    done = (self.sheet.time - start) / span if span > 0.0 else 1.0
                    progress((index + done) / len(steps))

            reached = penetration if segment.control == "penetration" else force
            for piece in islice(pieces(segment, reached, stops), place.piece, None):
                count = step_count(self.scene, piece, segment.rate, self.options, self.largest, self.length)
                outcome = self._follow(piece, count, report)
                if self.sheet.time in stops and (outcome is None or outcome.kind is OutcomeKind.DETACHED):
                    self.recorder.profile(self._profile())
                if outcome is not None:
                    return outcome
                place.next_piece()
            place.next_step()
        return Outcome(OutcomeKind.COMPLETED, "all loading steps done", self.sheet.time)

    def _follow(self, piece: Piece, count: int, report: Callable[[], None]) -> Outcome | None:
        """Take the run through a piece in ``count`` equal steps; an outcome if it ends there."""
        if self.place.taken == 0:
            self.recorder.kink()
        for index in range(self.place.taken + 1, count + 1):
            self.place.taken = index - 1
            if not goes_on(self.watch, self.state):
                return Outcome(OutcomeKind.INTERRUPTED, "stopped from outside", self.sheet.time)
            if self.counters.steps >= self.options.max_steps:
                reason = f"{self.options.max_steps} steps were not enough"
                return Outcome(OutcomeKind.STEP_BUDGET, reason, self.sheet.time)
            outcome = self._step(piece, piece.length if index == count else piece.length * index / count)
            report()
            if outcome is not None:
                return outcome
        return None

    def _step(self, piece: Piece, parameter: float) -> Outcome | None:
        """One step; an outcome if the run ends with it.

        An edge that travels more than a process zone in a step is recorded as unstable.
        """
        before, time, value = self.sheet, piece.time(parameter), piece.prescribed(parameter)
        duration = 0.0 if piece.jump else time - before.time
        instant = Instant(self.annuli, self.chain, before, duration, piece.control, value, self.counters)
        contact = settled(instant, before.contact, self.most, self.capped, self.work)
        if contact is None:
            reason = "the contact spreads beyond the annuli"
            return Outcome(OutcomeKind.OUT_OF_RANGE, reason, before.time)
        lost = contact == 0 and before.contact > 0
        leap = self.work > 0.0 and abs(contact - before.contact) > self.annuli.zone
        if lost or leap:
            self._event("snap-in" if contact > before.contact else "pull-off")
        if lost and self.work > 0.0:
            reason = f"no stable contact at {piece.control} {value:.6g}"
            return Outcome(OutcomeKind.DETACHED, reason, before.time)
        if contact == 0 and not lost and piece.control == "force" and value < 0.0:
            return Outcome(OutcomeKind.DETACHED, "pulled without contact", before.time)
        sheet = instant.sheet(contact, time)
        energies = step_energies(self.chain, self.annuli, self.energies, before, sheet)
        self._commit(sheet, energies)
        self.counters.steps += 1
        return Outcome(OutcomeKind.DETACHED, "the contact area fell to zero", time) if lost else None

    def _commit(self, sheet: Sheet, energies: Energies) -> None:
        if not (math.isfinite(sheet.force) and math.isfinite(sheet.penetration)):
            raise FloatingPointError("force or penetration is not finite")
        self.sheet, self.energies = sheet, energies
        radius = sheet.contact * self.annuli.width
        stored, intensity = energies.stored(self.chain), sheet.stress_intensity
        state = (sheet.time, sheet.penetration, sheet.force, radius)
        self.recorder.rows.append((*state, stored, energies.dissipated, intensity))

    def _event(self, kind: str) -> None:
        sheet = self.sheet
        radius = sheet.contact * self.annuli.width
        self.recorder.events.append(Event(kind, sheet.time, sheet.penetration, sheet.force, radius))

    def _profile(self) -> SurfaceProfile:
        """The committed state at the collocation radii, as far as the annuli reach."""
        sheet, annuli, contact = self.sheet, self.annuli, self.sheet.contact
        pressure = np.zeros(annuli.count)
        pressure[:contact] = sheet.scaled / annuli.width
        displacement = sheet.displacement(self.chain)
        gap = annuli.heights - sheet.penetration + displacement
        gap[:contact] = 0.0
        return SurfaceProfile(
            sheet.time,
            sheet.penetration,
            sheet.force,
            contact * annuli.width,
            annuli.radii,
            pressure,
            displacement,
            gap,
        )
