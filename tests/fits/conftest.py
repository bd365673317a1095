"""What fits of several files share."""

import numpy as np
import pytest
from support.synthetic_traces import COMPLETED, DETACHED, by_hand

from validation import solvers
from validation.reference import sneddon
from validation.reference.jkr import JKR
from validation.reference.ting import Ting
from validation.solvers.base import Solver

ROWS = 120
RADII = 20000  # of a branch of equilibria on a spring


class ClosedFormSolver(Solver):
    """Scenes of a sphere whose loading is one table, as fits make them."""

    name = "closed-form"
    title = "closed forms"

    def _solve(self, scene, resolution, options):
        table = scene.loading.steps[0]
        knots = np.array(table.times) - table.times[0]
        time = np.unique(np.concatenate([knots, np.linspace(0.0, knots[-1], ROWS)]))
        motion = np.interp(time, knots, table.values)
        modulus = scene.material.relaxed_plane_modulus
        if scene.loading.compliance > 0.0:
            time, motion, force, radius = on_spring(scene, time, motion)
        elif scene.is_adhesive:
            law = JKR(scene.indenter, modulus, scene.adhesion.work)
            least = law.pull_off_penetration_control()
            lost = motion < least.penetration
            end = int(np.argmax(lost)) if lost.any() else time.size
            states = [law.at_penetration(at) for at in motion[:end]]
            force = np.array([one.force for one in states])
            radius = np.array([one.contact_radius for one in states])
            if lost.any():
                at = np.interp(-least.penetration, -motion[end - 1 : end + 1], time[end - 1 : end + 1])
                time, motion = np.append(time[:end], at), np.append(motion[:end], least.penetration)
                force, radius = np.append(force, least.force), np.append(radius, least.contact_radius)
        elif scene.material.is_elastic:
            radius = np.sqrt(scene.indenter.radius * np.maximum(motion, 0.0))
            force = np.asarray(sneddon.force(scene.indenter, radius, modulus))
        else:
            rise, fall = motion[1] / time[1], -np.diff(table.values)[-1] / np.diff(knots)[-1]
            law = Ting(scene.material, scene.indenter, rise, knots[1], fall)
            force, radius = law.force(time), law.contact_radius(time)
        kind = DETACHED if radius[-1] == 0.0 or scene.is_adhesive else COMPLETED
        rows = {"penetration": motion, "force": force, "contact_radius": radius}
        return by_hand(time, kind, self.name, **rows)


def on_spring(scene, time, stage):
    """Rows of an elastic contact under a driven stage: the stable equilibria, up to where they end."""
    rows = np.unique(np.concatenate([time, np.linspace(0.0, time[-1], 8 * ROWS)]))
    time, stage = rows, np.interp(rows, time, stage)
    modulus = scene.material.relaxed_plane_modulus
    radii = np.linspace(1e-6, 2.0, RADII) * np.sqrt(scene.indenter.radius * stage.max())
    if scene.is_adhesive:
        law = JKR(scene.indenter, modulus, scene.adhesion.work)
        force, depth = law.force(radii), law.penetration(radii)
    else:
        force, depth = sneddon.force(scene.indenter, radii, modulus), radii**2 / scene.indenter.radius
    at = depth + scene.loading.compliance * force
    stable = slice(int(np.argmin(at)), None)
    least, at, radii, force = at[stable][0], at[stable], radii[stable], force[stable]
    lost = stage < least
    if scene.is_adhesive and lost.any():
        end = int(np.argmax(lost))
        time = np.append(time[:end], np.interp(-least, -stage[end - 1 : end + 1], time[end - 1 : end + 1]))
        stage = np.append(stage[:end], least)
    radius, force = np.interp(stage, at, radii), np.interp(stage, at, force)
    if not scene.is_adhesive:
        radius[stage < 0.0] = force[stage < 0.0] = 0.0
    return time, stage - scene.loading.compliance * force, force, radius


@pytest.fixture(scope="module")
def closed_form():
    """The runs of a fit are closed forms: of Hertz and elastic JKR, also on a spring, and of Ting."""
    method = ClosedFormSolver()
    solvers.register(method)
    yield
    solvers.unregister(method.name)
