"""Single faults for the boundary elements."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from scipy.special import ellipk
from support.faults.injection import registry

from bem_solver.nodal_variables import NodalVariables
from bem_solver.surface_points import load_inside

FAULTS, fault = registry("bem", "bem_solver")
SHORT = ("pdms-retraction-100nm",)
"""Where steps pass over many process zones."""


@fault("the half of the closure dropped", "closure:ClosureRule.integral")
def _(true):
    return lambda *given: 2.0 * true(*given)


@fault("tension and compression swapped", "surface:ContactSurface.tension")
def _(true):
    return lambda *given: -true(*given)


@fault("1 - nu^2 lost", "creep:Chain.__init__")
def _(true):
    return lambda self, material, euler=False: true(self, replace(material, poisson=0.0), euler)


@fault("relaxation and retardation times swapped", "creep:Chain.__init__")
def _(true):
    def init(self, *given):
        true(self, *given)
        self.relaxation, self.retardation = self.retardation, self.relaxation

    return init


@fault("a branch dropped", "creep:Chain.__init__")
def _(true):
    return lambda self, material, euler=False: true(
        self, replace(material, branches=material.branches[1:]), euler
    )


@fault("backward Euler in place of the exact update", "creep:Chain.__init__")
def _(true):
    return lambda self, material, euler=False: true(self, material, True)


@fault("energy without a branch", "energy:Energies.stored")
def _(true):
    def stored(self, chain):
        lost = self.branch_energy[:1] / chain.compliances[:1]
        return true(self, chain) - 0.5 * float(lost.sum())

    return stored


@fault("internal variables one step late", "load_control:LoadControl._required_load")
def _(true):
    def required_load(self, motion):
        wanted = motion.new_penetration - self.points.height
        return load_inside(self.problem.chain, self.points.variables, wanted)

    return required_load


@fault("E and K of the kernel swapped", "kernel:ellipe")
def _(true):
    return lambda m: ellipk(np.minimum(m, 1.0 - 1e-9))


@fault("annulus areas without pi", "annuli:Annuli.__init__")
def _(true):
    def init(self, *given, **named):
        true(self, *given, **named)
        self.areas = self.areas / np.pi

    return init


@fault("annulus areas as 2 pi r dr at the collocation radius", "annuli:Annuli.__init__")
def _(true):
    def init(self, *given, **named):
        true(self, *given, **named)
        self.areas = 2.0 * np.pi * self.radii * np.diff(self.borders)

    return init


@fault("gap of the wrong sign", "trial_closure:gap_outside")
def _(true):
    return lambda *given: -true(*given)


@fault("process zone measured from the wrong side", "trial_closure:gap_outside")
def _(true):
    def gap(problem, state, motion, surface, radius, *creep):
        mirrored = 2.0 * surface.edge + problem.zone - radius
        return true(problem, state, motion, surface, np.maximum(mirrored, surface.edge), *creep)

    return gap


@fault("every start relaxed", "start:start_state")
def _(true):
    def start(problem, scale):
        loading = replace(problem.scene.loading, start="relaxed")
        return true(replace(problem, scene=replace(problem.scene, loading=loading)), scale)

    return start


@fault("covered points without their glassy jump", "surface_points:covered")
def _(true):
    return lambda chain, points, motion, passage: 0.0 * points.variables


@fault("released points forget their relaxation", "surface_points:released")
def _(true):
    return lambda chain, points, *given: 0.0 * points.variables


@fault("released surface does not creep", "surface_points:free")
def _(true):
    return lambda chain, points, motion, new_load: points.variables


@fault("history read one node off", "history:NodalVariables.at")
def _(true):
    def at(self, radius):
        return true(NodalVariables(self.radius, np.roll(self.values, 1, axis=0), self.kinks), radius)

    return at


@fault("surface energy of the wrong sign in the balance", "recorder:TraceRecorder.trace")
def _(true):
    return lambda self, outcome, counters, work, *rest: true(self, outcome, counters, -work, *rest)


@fault("branch energies advanced by half the step", "energy:updated_energies")
def _(true):
    return lambda chain, before, increment, duration: true(chain, before, increment, 0.5 * duration)


@fault("closure 0.5 % too large", "closure:ClosureRule.integral", ("elastic-relaxed", "elastic-glassy"))
def _(true):
    return lambda *given: 1.005 * true(*given)


@fault(
    "influence of an annulus 0.3 % too large",
    "kernel:annulus_influence",
    ("punch-programme", "elastic-glassy"),
)
def _(true):
    return lambda *given: 1.003 * true(*given)


@fault("what is left of a branch by the trapezoidal rule", "creep:Chain.decay", ("cycle-v0.002",))
def _(true):
    return lambda self, y: (1.0 - 0.5 * y) / (1.0 + 0.5 * y)


@fault("increments of a step at its end", "creep:Chain.spread", ("punch-programme",))
def _(true):
    return lambda self, y: np.ones_like(y)


@fault("gap longer by a length of 1e-6", "trial_closure:gap_outside", ("cycle-si-small",))
def _(true):
    return lambda *given: true(*given) + 1e-6


@fault("the stage taken for the indenter", "trial:evaluate", ("spring-elastic",))
def _(true):
    def evaluate(problem, state, duration, edge, control, value, earlier=None, within=None):
        rigid = "penetration" if control == "stage" else control
        return true(problem, state, duration, edge, rigid, value, earlier, within)

    return evaluate


@fault(
    "an earlier row's stage taken for its penetration",
    "step_trials:StepTrials._earlier",
    ("spring-approach",),
)
def _(true):
    def earlier(self, duration):
        row = true(self, duration)
        if row is None or self.interval.control != "stage":
            return row
        deflection = self.problem.scene.loading.compliance * self.state.accepted.rows[-2][2]
        return replace(row, penetration=row.penetration + deflection)

    return earlier


@fault("the edge takes up 1 % more", "edge_energy:energy_taken", ("hysteresis-si",))
def _(true):
    return lambda *given: 1.01 * true(*given)


@fault("the edge 2 % too fast for its law", "edge_energy:end_velocity", ("rated-edge-si",))
def _(true):
    return lambda *given: 1.02 * true(*given)


@fault("external work 0.5 % too large", "external_work:external_work", ("adhesionless-cycle",))
def _(true):
    return lambda *given: 1.005 * true(*given)


@fault("closure over a zone 1 % too short", "trial:_zone", ("cone-pull",))
def _(true):
    return lambda *given: 0.99 * true(*given)


@fault("points of a step over zones released a tenth too early", "bent_path:BentPath.left", SHORT)
def _(true):
    return lambda path, radius: 1.1 * true(path, radius)


@fault("path of a step over zones straight", "bent_path:BentPath.through", SHORT)
def _(true):
    return lambda cls, rows, edge, duration, end, of_travel=False: cls.straight(edge, end)


@fault("wake of earlier steps over zones recovers half as fast", "surface_points:free", SHORT)
def _(true):
    def free(chain, points, motion, new_load):
        return true(chain, points, replace(motion, duration=0.5 * motion.duration), new_load)

    return free
