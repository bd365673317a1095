"""The paper's own discretisation (Appendix A) as a baseline: uniform annuli and a fixed time step.

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
from bem_solver.energy import Energies, at_start, stepped
from bem_solver.extent import FEWEST, MOST, largest_contact
from bem_solver.options import Options
from bem_solver.pieces import Piece, pieces
from bem_solver.recorder import Recorder
from bem_solver.start import contact_scale
from bem_solver.trial import Problem
from bem_solver.uniform import Instant, Sheet, UniformAnnuli, settled
from scene import Counters, Event, Material, Outcome, OutcomeKind, Profile, Scene, Segment, Trace
from scene import UnsupportedScene
from scene.scene import zone_too_long

_ROOM = 1.1  # outermost contact, in estimated largest contact radii
_PER_RADIUS = 10  # annuli in the largest contact without adhesion, in resolutions


def solve_uniform(scene: Scene, options: Options, progress: Callable[[float], None] | None) -> Trace:
    """Solve a scene on uniform annuli; parameters and result as for :func:`bem_solver.solve`.

    Raises
    ------
    UnsupportedScene
        If the annuli would be too many for one dense matrix.
    SceneError
        If the process zone does not fit into the contact at the start.
    """
    chain = Chain(scene.material, options.scheme == "backward-euler")
    counters = Counters(factorisations=1)
    recorder = Recorder(chain, scene.adhesion.work if scene.adhesion else 0.0)
    largest = _largest(scene, chain)
    annuli, most = _annuli(scene, options.divisions, largest)
    run = _Run(scene, chain, annuli, most, largest, options, recorder, counters)
    outcome = run.start()
    if outcome is not None:
        return recorder.nothing(scene.loading.penetration, outcome.reason, counters, outcome.kind)
    try:
        outcome = run.through(progress)
    except FloatingPointError as error:
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

    Under a flat punch the width is changed by less than one part in the number of annuli so that its edge is
    a border.
    """
    adhesion = scene.adhesion if scene.is_adhesive else None
    zone = divisions if adhesion else 0
    width = adhesion.zone / divisions if adhesion else largest / (_PER_RADIUS * divisions)
    edge = scene.indenter.edge
    most = math.ceil(_ROOM * largest / width) if edge == math.inf else max(round(edge / width), 1)
    count = most + max(zone, most // 10 + 1)
    if count > MOST:
        raise UnsupportedScene(
            "adhesion.zone",
            f"{count} uniform annuli would be needed",
            f'at most {MOST}: a lower resolution, a longer zone, or annuli = "graded"',
        )
    if edge != math.inf:
        width = edge / most
    return UniformAnnuli(width, count, zone, scene.indenter), most


@dataclass
class _Run:
    """State of a run: committed sheet and energies."""

    scene: Scene
    chain: Chain
    annuli: UniformAnnuli
    most: int
    largest: float
    options: Options
    recorder: Recorder
    counters: Counters
    sheet: Sheet = field(init=False)
    energies: Energies = field(init=False)

    def start(self) -> Outcome | None:
        """Make the start state; an outcome if there is none."""
        scene, annuli, chain = self.scene, self.annuli, self.chain
        relaxed = scene.loading.start == "relaxed"
        penetration = scene.loading.penetration
        modulus = scene.material.modulus if relaxed else scene.material.glassy_modulus
        elastic = Chain(Material(modulus, scene.material.poisson))
        untouched = Sheet.untouched(annuli, 0, penetration)
        instant = Instant(annuli, elastic, untouched, 0.0, "penetration", penetration, self.counters)
        contact = self._settled(instant, self.most)
        if contact is None:
            return self._too_far(0.0)
        if contact == 0 and self.recorder.work > 0.0:
            reason = f"no stable contact at penetration {penetration:.6g}"
            return Outcome(OutcomeKind.NO_EQUILIBRIUM, reason, 0.0)
        if self.scene.is_adhesive and contact <= annuli.zone:
            raise zone_too_long(annuli.zone * annuli.width, contact * annuli.width)
        sheet = instant.sheet(contact, 0.0)
        strains = np.outer(sheet.load, chain.compliances * (1.0 if relaxed else 0.0))
        self.sheet = replace(sheet, strains=strains)
        self.energies = at_start(chain, self._work(self.sheet), relaxed)
        self._record()
        return None

    def through(self, progress: Callable[[float], None] | None) -> Outcome:
        """Carry out all loading steps."""
        stops, steps = self.options.profile_times, self.scene.loading.steps
        if 0.0 in stops:
            self._profile()
        for index, step in enumerate(steps):
            sheet = self.sheet
            segment = step.segment(sheet.time, sheet.penetration, sheet.force)
            reached = sheet.penetration if segment.control == "penetration" else sheet.force
            for piece in pieces(segment, reached, stops):
                outcome = self._follow(piece, self._steps(piece, segment))
                if self.sheet.time in stops and (outcome is None or outcome.kind is OutcomeKind.DETACHED):
                    self._profile()
                if outcome is not None:
                    return outcome
                if progress is not None:
                    span = segment.end - segment.start
                    done = (self.sheet.time - segment.start) / span if span > 0.0 else 1.0
                    progress((index + done) / len(steps))
        return Outcome(OutcomeKind.COMPLETED, "all loading steps done", self.sheet.time)
