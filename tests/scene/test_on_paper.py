"""What all solvers share, against numbers worked out on paper: a comparison never sees a common error."""

from __future__ import annotations

import math

import numpy as np
import pytest
from support.closed_forms.separate_bulk import equivalent_material

import contact_scene as cs
from contact_scene.adhesion import Adhesion
from validation.measure.observables import observe
from validation.measure.scaling import unit_sizes
from validation.measure.windows import cycle_times
from validation.solvers import SOLVERS

E = math.e
THREE = cs.Material(1.0, 0.25, (cs.Branch(3.0, 2.0), cs.Branch(4.0, 4.0)))


def test_relaxation_modulus():
    """E(t) = 1 + 3 exp(-t/2) + 4 exp(-t/4)."""
    assert THREE.glassy_modulus == 8.0
    assert THREE.relaxed_plane_modulus == pytest.approx(16.0 / 15.0)
    assert THREE.glassy_plane_modulus == pytest.approx(128.0 / 15.0)
    assert THREE.relaxation_modulus([-1.0, 0.0, 4.0]) == pytest.approx([0.0, 8.0, 1.0 + 3.0 / E**2 + 4.0 / E])


@pytest.mark.parametrize("apart", [1e-13, 1e-6, 1e-3, 0.05, 0.3])
def test_relaxation_times_close_together_are_not_joined(apart):
    moduli, times = cs.Material(1.0, 0.5, (cs.Branch(2.0, 1.0 + apart), cs.Branch(3.0, 1.0))).spectrum
    assert times.tolist() == [1.0, 1.0 + apart]
    assert moduli.tolist() == [3.0, 2.0]
    same = cs.Material(1.0, 0.5, (cs.Branch(2.0, 1.0), cs.Branch(3.0, 1.0))).spectrum
    assert [part.tolist() for part in same] == [[5.0], [1.0]]


def test_bulk_apart_from_shear():
    """Shear E/(2 (1 + nu)) relaxes from 4 to 1, bulk stays: 4 G (3 K + G)/(3 K + 4 G) is felt by the surface.

    nu = 0.25, E0 = 2.5: G0 = 1, K = 2.5/(3 * 0.5) = 5/3, hence 4 * 6/9 = 8/3 relaxed, 4 * 4 * 9/21 glassy.
    """
    shear = (cs.Branch(7.5, 1.0),)
    elastic = equivalent_material(cs.Material(2.5, 0.25, shear, "elastic"))
    assert elastic.relaxed_plane_modulus == pytest.approx(8.0 / 3.0)
    assert elastic.glassy_plane_modulus == pytest.approx(48.0 / 7.0)


def test_profiles():
    """Cotangent of 60 degrees, paraboloid, power law, at radius 3."""
    shapes = cs.Cone(60.0), cs.Cone(30.0), cs.Sphere(4.0), cs.PowerLaw(3.0, 0.5), cs.FlatPunch(5.0)
    heights = [math.sqrt(3.0), 3.0 * math.sqrt(3.0), 9.0 / 8.0, 13.5, 0.0]
    slopes = [1.0 / math.sqrt(3.0), math.sqrt(3.0), 0.75, 13.5, 0.0]
    assert [float(shape.height(3.0)) for shape in shapes] == pytest.approx(heights)
    assert [float(shape.slope(3.0)) for shape in shapes] == pytest.approx(slopes)


def test_a_table_with_curved_slopes():
    """Rows of r^2 + 5 at uneven radii are followed exactly, and beyond the last row the curve is straight."""
    rows = (0.0, 1.0, 3.0, 4.0)
    table = cs.TabulatedProfile(rows, tuple(r**2 + 5.0 for r in rows))
    assert table.height([0.5, 2.0, 3.5, 6.0]) == pytest.approx([0.25, 4.0, 12.25, 32.0])
    assert table.slope([0.5, 2.0, 3.5, 6.0]) == pytest.approx([1.0, 4.0, 7.0, 8.0])


def test_a_table_that_begins_flat_does_not_fall():
    """Slopes 0, 0 and 3/2 at the rows: halfway up 1/2 - 3/2 * 1/8, where the slope is 3/2 - 3/8."""
    table = cs.TabulatedProfile((0.0, 1.0, 2.0), (0.0, 0.0, 1.0))
    assert table.height([0.5, 1.5]) == pytest.approx([0.0, 0.3125])
    assert float(table.slope(1.5)) == pytest.approx(1.125)


STEPS = (
    cs.Ramp(0.03, 0.002),  # 15
    cs.Hold(10.0),  # 25
    cs.Ramp(-0.01, 0.01),  # 29
    cs.Oscillate(0.02, math.pi, 1.5, drift=0.04),  # 30.5
    cs.Sweep(0.02, math.pi, 2.0),  # 32.5
    cs.Table((5.0, 6.0, 8.0), (0.5, 0.1, 0.3)),  # 35.5
    cs.Hold(0.5),  # 36
)


def test_times_and_penetrations_of_load_steps():
    """The oscillation ends at -0.01 + 0.02 sin(1.5 pi) - 0.06 = -0.09; the sweep at sin(2 pi)."""
    segments = [segment for _, segment in cs.Loading("relaxed", 0.0, STEPS).segments()]
    assert [segment.end for segment in segments] == pytest.approx([15.0, 25.0, 29.0, 30.5, 32.5, 35.5, 36.0])
    assert [segment.start for segment in segments] == pytest.approx([0.0, 15.0, 25.0, 29.0, 30.5, 32.5, 35.5])
    halfway = [0.015, 0.03, 0.01, -0.01 + 0.02 * math.sin(0.75 * math.pi) - 0.03, -0.07, 0.15, 0.3]
    found = [segment.value(0.5 * (segment.start + segment.end)) for segment in segments]
    assert found == pytest.approx(halfway)
    rates = [0.002, 0.0, -0.01, 0.02 * math.pi * math.cos(0.75 * math.pi) - 0.04, 0.0, 0.1, 0.0]
    found = [segment.rate(0.5 * (segment.start + segment.end)) for segment in segments]
    assert found == pytest.approx(rates, abs=1e-12)
    assert segments[5].kinks == pytest.approx((33.5,))


def test_force_steps_begin_at_the_force_that_is_there():
    """From a force of 4 to 1 at 0.5 takes 6; a prescribed force is there at once."""
    ramp = cs.ForceRamp(1.0, 0.5).segment(2.0, 0.1, 4.0)
    assert (ramp.control, ramp.end, ramp.value(4.0), ramp.rate(4.0)) == ("force", 8.0, 3.0, -0.5)
    dead = cs.Force(-2.0, 3.0).segment(2.0, 0.1, 4.0)
    assert (dead.control, dead.end, dead.value(2.0), dead.rate(2.0)) == ("force", 5.0, -2.0, 0.0)


def test_cycles_begin_with_their_load_step():
    """Period 2 from t = 4 on, two and a half of them; a sweep reaches phase 2 pi n at sqrt(4 n)."""
    shaken = cs.Loading("relaxed", 0.0, (cs.Ramp(0.04, 0.01), cs.Oscillate(0.01, math.pi, 5.0)))
    assert cycle_times(shaken) == pytest.approx((4.0, 6.0, 8.0))
    assert cycle_times(cs.Loading("relaxed", 0.0, (cs.Sweep(0.01, math.pi, 4.0),))) == pytest.approx(
        (0.0, 2.0, math.sqrt(8.0), math.sqrt(12.0), 4.0)
    )


def test_units():
    """E0/(1 - nu^2) = 4/3, R = 3, work 0.2: pi 4/3 9, pi 4/3 27, 1.5 pi 0.2 3."""
    scene = cs.Scene(cs.Material(1.0, 0.5), cs.Sphere(3.0), cs.Loading("relaxed", 0.1), Adhesion(0.2, 0.1))
    units = unit_sizes(scene)
    expected = {
        "": 1.0,
        "length": 3.0,
        "force": 12.0 * math.pi,
        "energy": 36.0 * math.pi,
        "jkr-force": 0.9 * math.pi,
    }
    assert units == pytest.approx(expected)


PUNCH = cs.Scene(
    cs.Material(1.0, 0.5, (cs.Branch(2.0, 1.0), cs.Branch(5.0, 1.05))), cs.FlatPunch(0.3),
    cs.Loading("jump-in", 0.01, (cs.Hold(1.0), cs.Hold(0.75), cs.Ramp(0.02, 1e3), cs.Hold(1.0))),
)  # fmt: skip


@pytest.mark.parametrize("name", ["reference", "bem"])
def test_holds_of_a_punch_last_as_long_as_they_say(name):
    """F = 2 a E*(t) D of a jump at t = 0, E* = E/0.75: close branches, and holds of 1 and 1.75 in all.

    The ramp to 0.02 takes 1e-5: to that accuracy a second jump, at the end of which the approach ends.
    """

    def modulus(t):
        return (1.0 + 2.0 * math.exp(-t) + 5.0 * math.exp(-t / 1.05)) / 0.75

    run = SOLVERS[name].solve(PUNCH)
    assert run.time[-1] == pytest.approx(2.75 + 1e-5, rel=1e-12)
    at = [int(np.argmin(np.abs(run.time - t))) for t in (0.0, 1.0, 1.75)]
    found = [float(run.force[row]) for row in at]
    assert found == pytest.approx([0.006 * modulus(t) for t in (0.0, 1.0, 1.75)], rel=1e-6)
    last = 0.006 * (modulus(2.75) + modulus(1.0))
    assert run.force[-1] == pytest.approx(last, rel=2e-5)
    seen = observe(run)
    assert seen.approach_time == pytest.approx(1.75 + 1e-5, rel=1e-12)
    assert seen.approach_force == pytest.approx(0.006 * (modulus(1.75) + modulus(0.0)), rel=2e-5)
    assert seen.final_force == run.force[-1]


@pytest.mark.parametrize("name", ["reference", "bem"])
@pytest.mark.parametrize(
    ("indenter", "radius", "force"),
    [
        (cs.Sphere(4.0), 0.2, 4.0 * 0.008 / 12.0),  # D = a^2/R, F = 4 E* a^3/(3 R)
        (cs.Cone(70.0), 0.02 / math.pi / math.tan(math.radians(20.0)), None),  # D = (pi/2) a cot, F = E* a D
        (cs.PowerLaw(1.0, 0.5), 0.02 / (0.5 * math.pi), None),
        (
            cs.TabulatedProfile((0.0, 0.05, 0.15, 0.3), (0.0, 0.0003125, 0.0028125, 0.01125)),
            0.2,
            4.0 * 0.008 / 12.0,
        ),
    ],
)
def test_elastic_contacts_of_every_shape(name, indenter, radius, force):
    """Sneddon, E* = 1, D = 0.01: sphere, cone of 70 degrees, cone of slope 1/2, table of a sphere."""
    run = SOLVERS[name].solve(cs.Scene(cs.Material(0.75, 0.5), indenter, cs.Loading("relaxed", 0.01)))
    assert run.contact_radius[0] == pytest.approx(radius, rel=1e-4)
    assert run.force[0] == pytest.approx(radius * 0.01 if force is None else force, rel=1e-4)
