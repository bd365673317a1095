"""Single faults for the boundary elements."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from scipy.special import ellipk
from support.faults.injection import by, changed, gives, rest, table, takes, times

from bem_solver.history import NodalVariables
from bem_solver.surface_points import load_inside

SHORT = "pdms-retraction-100nm"
"""Where steps pass over many process zones."""
PUNCH, GLASSY = "punch-programme", "elastic-glassy"


def _times_swapped(true):
    def init(self, *given):
        true(self, *given)
        self.relaxation, self.retardation = self.retardation, self.relaxation

    return init


def _variables_one_step_late(true):
    def required_load(self, motion):
        wanted = motion.new_penetration - self.points.height
        return load_inside(self.problem.chain, self.points.variables, wanted)

    return required_load


def _areas(of):
    def broken(true):
        def init(self, *given, **named):
            true(self, *given, **named)
            self.areas = of(self)

        return init

    return broken


def _zone_from_the_wrong_side(true):
    def gap(problem, state, motion, surface, radius, *creep):
        mirrored = 2.0 * surface.edge + problem.zone - radius
        return true(problem, state, motion, surface, np.maximum(mirrored, surface.edge), *creep)

    return gap


def _relaxed_start(problem):
    loading = replace(problem.scene.loading, start="relaxed")
    return replace(problem, scene=replace(problem.scene, loading=loading))


def _one_node_off(true):
    def at(self, radius):
        return true(NodalVariables(self.radius, np.roll(self.values, 1, axis=0), self.kinks), radius)

    return at


def _stage_for_indenter(control):
    return "penetration" if control == "stage" else control


def _stage_for_penetration(true):
    def earlier(self, duration):
        row = true(self, duration)
        if row is None or self.interval.control != "stage":
            return row
        deflection = self.problem.scene.loading.compliance * self.state.accepted.rows[-2][2]
        return replace(row, penetration=row.penetration + deflection)

    return earlier


FAULTS = table("bem", "bem_solver", [
    ("the half of the closure dropped", "trial:closure_integral", times(2.0)),
    ("tension and compression swapped", "surface:ContactSurface.tension", times(-1.0)),
    ("1 - nu^2 lost", "creep:Chain.__init__", takes(material=changed(poisson=by(0.0)))),
    ("relaxation and retardation times swapped", "creep:Chain.__init__", _times_swapped),
    ("a branch dropped", "creep:Chain.__init__", takes(material=changed(branches=rest))),
    ("backward Euler in place of the exact update", "creep:Chain.__init__",
     takes(backward_euler=lambda _: True)),
    ("energy without a branch", "recorder:stored_energy",
     takes(branch_work=lambda work: work * (np.arange(work.shape[1]) > 0))),
    ("internal variables one step late", "trial:LoadControl._required_load", _variables_one_step_late),
    ("E and K of the kernel swapped", "annuli:ellipe",
     lambda true: lambda m: ellipk(np.minimum(m, 1.0 - 1e-9))),
    ("annulus areas without pi", "annuli:Annuli.__init__", _areas(lambda made: made.areas / np.pi)),
    ("annulus areas as 2 pi r dr at the collocation radius", "annuli:Annuli.__init__",
     _areas(lambda made: 2.0 * np.pi * made.radii * np.diff(made.borders))),
    ("gap of the wrong sign", "trial:gap_outside", times(-1.0)),
    ("process zone measured from the wrong side", "trial:gap_outside", _zone_from_the_wrong_side),
    ("every start relaxed", "state:start_state", takes(problem=_relaxed_start)),
    ("covered points without their glassy jump", "surface_points:covered",
     lambda true: lambda chain, points, motion, passage: 0.0 * points.variables),
    ("released points forget their relaxation", "surface_points:released",
     lambda true: lambda chain, points, *given: 0.0 * points.variables),
    ("released surface does not creep", "surface_points:free",
     lambda true: lambda chain, points, motion, new_load: points.variables),
    ("history read one node off", "history:NodalVariables.at", _one_node_off),
    ("surface energy of the wrong sign in the balance", "recorder:RunRecord.finished",
     takes(energies=lambda kinds: (kinds[0], -kinds[1], kinds[2]))),
    ("branch energies advanced by half the step", "recorder:stored_energy", takes(time=by(0.5))),
    ("closure 0.5 % too large", "trial:closure_integral", times(1.005), "elastic-relaxed", GLASSY),
    ("influence of an annulus 0.3 % too large", "annuli:annulus_influence", times(1.003), PUNCH, GLASSY),
    ("what is left of a branch by the trapezoidal rule", "creep:Chain.decay",
     lambda true: lambda self, y: (1.0 - 0.5 * y) / (1.0 + 0.5 * y), "cycle-v0.002"),
    ("increments of a step at its end", "creep:Chain.spread", gives(np.ones_like), PUNCH),
    ("gap longer by a length of 1e-6", "trial:gap_outside", gives(lambda gap: gap + 1e-6),
     "cycle-si-small"),
    ("the stage taken for the indenter", "trial:evaluate", takes(control=_stage_for_indenter),
     "spring-elastic"),
    ("an earlier row's stage taken for its penetration", "step:TrialStep._earlier",
     _stage_for_penetration, "spring-approach"),
    ("the edge takes up 1 % more", "problem:energy_taken", times(1.01), "hysteresis-si"),
    ("the edge 2 % too fast for its law", "problem:end_velocity", times(1.02), "rated-edge-si"),
    ("external work 0.5 % too large", "recorder:RowPath.integral", times(1.005), "adhesionless-cycle"),
    ("closure over a zone 1 % too short", "trial:_zone", times(0.99), "cone-pull"),
    ("points of a step over zones released a tenth too early", "motion:BentPath.left", times(1.1),
     SHORT),
    ("path of a step over zones straight", "motion:BentPath.through",
     lambda true: lambda cls, rows, edge, duration, end, *_: cls.straight(edge, end), SHORT),
    ("wake of earlier steps over zones recovers half as fast", "surface_points:free",
     takes(motion=changed(duration=by(0.5))), SHORT),
])  # fmt: skip
