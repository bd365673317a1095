"""Adhesive contact on a spring: both ideal machines, the limit point, energies, frozen retraction."""

import pytest
from numpy.testing import assert_allclose
from scipy.integrate import quad
from support.closed_forms.frozen_variants import FrozenZone

from contact_scene import Cone, Sphere
from validation.cases import load
from validation.measure.scaling import unit_sizes
from validation.reference.finite_zone import FiniteZone
from validation.reference.jkr import JKR, NoEquilibrium
from validation.reference.spring import SpringContact

WORK, MODULUS = 5e-4, 1.0
LAW = JKR(Sphere(1.0), MODULUS, WORK)
STIFFNESS = 2.0 * MODULUS * LAW.pull_off_force_control().contact_radius  # of the contact at pull-off


@pytest.mark.parametrize("law", [LAW, JKR(Cone(70.0), 2.0, WORK), FiniteZone(1.0, MODULUS, WORK, 0.01)])
def test_rigid_machine_and_dead_load_are_the_limits(law):
    stiff, soft = (SpringContact(law, k).pull_off() for k in (1e9, 1e-9))
    rigid, dead = law.pull_off_penetration_control(), law.pull_off_force_control()
    assert_allclose(stiff.penetration, rigid.penetration, rtol=1e-7)
    assert_allclose(stiff.contact_radius, rigid.contact_radius, rtol=1e-6)
    assert_allclose(soft.force, dead.force, rtol=1e-7)
    assert_allclose(soft.contact_radius, dead.contact_radius, rtol=1e-6)


@pytest.mark.parametrize("law", [LAW, JKR(Cone(70.0), 2.0, WORK), FiniteZone(1.0, MODULUS, WORK, 0.01)])
@pytest.mark.parametrize("share", [1e-2, 1.0, 30.0])
def test_stage_is_least_at_the_pull_off(law, share):
    spring = SpringContact(law, share * STIFFNESS)
    limit = spring.pull_off()
    beside = [spring.stage(law.state(x * limit.contact_radius)) for x in (0.999, 1.0, 1.001)]
    assert beside[1] < min(beside[0], beside[2])
    ahead = spring.at_stage(beside[2])
    assert_allclose(ahead.contact_radius, 1.001 * limit.contact_radius, rtol=1e-7)
    with pytest.raises(NoEquilibrium):
        spring.at_stage(beside[1] - 1e-6 * abs(beside[1]))


def test_short_zone_tends_to_the_vanishing_one():
    spring, short = SpringContact(LAW, STIFFNESS), FiniteZone(1.0, MODULUS, WORK, 1e-6)
    assert_allclose(SpringContact(short, STIFFNESS).pull_off().force, spring.pull_off().force, rtol=1e-4)


def test_loss_of_the_snap_is_what_an_unloading_at_the_rigid_limit_would_give_back():
    """Energy at the limit point less that of the free state, by the work along the unstable branch.

    Along equilibria ``dU = F dD + dg dA``: from the limit point down to nothing the loss is the work ``int F
    dX`` of a stage that would follow the unstable branch, with its sign.
    """
    spring = SpringContact(LAW, STIFFNESS)
    top = spring.pull_off().contact_radius

    def power(a):
        h = 1e-6 * a
        rise = spring.stage(LAW.state(a + h)) - spring.stage(LAW.state(a - h))
        return float(LAW.force(a)) * rise / (2.0 * h)

    along = quad(power, 0.0, top, epsrel=1e-8)[0]
    assert_allclose(spring.lost_in_snap(), along, rtol=1e-5)
    assert spring.lost_in_snap() > 0.0


def stated(case):
    """Check values in SI units."""
    units = unit_sizes(case.scene)
    return {check.observable: check.value * units[check.unit] for check in case.expected}


def test_check_values_of_the_frozen_and_the_relaxed_limit_on_a_spring():
    case = load("spring-frozen-si")
    frozen = FrozenZone(case.scene.material, 1e-3, 0.5, 1.3e-5, 3e-5)
    spring = SpringContact(frozen.equivalent, 1540.0)
    lost = spring.pull_off()
    assert (
        lost.contact_radius < frozen.relaxed.contact_radius - 1.3e-5
    )  # the zone lies within what was covered
    expected = {
        "start_radius": frozen.relaxed.contact_radius,
        "pull_off_force": -spring.largest_tension().force,
        "stage_at_detachment": spring.stage(lost) + frozen.offset,
        "detachment_radius": lost.contact_radius,
        "detachment_force": lost.force,
        "instability_loss": spring.lost_in_snap(),
    }
    assert stated(case) == pytest.approx(expected, rel=1e-6)

    spring = SpringContact(FiniteZone(1e-3, 1e6, 0.5, 1.3e-5), 150.0)
    expected = {
        "start_radius": spring.law.at_penetration(2e-5).contact_radius,
        "pull_off_force": -spring.largest_tension().force,
        "stage_at_detachment": spring.stage(spring.pull_off()),
    }
    assert stated(load("spring-relaxed-si")) == pytest.approx(expected, rel=1e-6)
