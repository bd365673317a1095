"""The parts of the reference against definitions, brute force and independent integrators."""

import math

import numpy as np
import pytest
from scipy.linalg import expm

from contact_scene import Branch, Material
from validation.reference.path.closure import LONGEST, closure, zone_length
from validation.reference.path.fields import Points
from validation.reference.path.memory import ConstantRate, collocated
from validation.reference.path.numerics import bracketed, dip, inverse
from validation.reference.path.rheology import rheology
from validation.reference.path.solver import estimated_errors

SPREAD = Material(0.75, 0.3, (Branch(2.0, 1e-3), Branch(1.0, 1.0), Branch(0.5, 1.5), Branch(3.0, 1e4)))


def test_both_representations_are_one_material() -> None:
    law = rheology(SPREAD)
    rng = np.random.default_rng(7)
    branches, strain = rng.normal(size=(5, 4)) * law.moduli, rng.normal(size=5)
    units = law.release(branches, strain)
    q = law.stress(branches, strain)
    np.testing.assert_allclose(strain, q / law.glassy + units.sum(axis=1), rtol=1e-10)
    back = units @ law.branches_of_units + np.outer(q, law.moduli) / law.glassy
    np.testing.assert_allclose(back, branches, rtol=1e-9, atol=1e-12)
    creep_energy = q**2 / law.glassy + units**2 @ (1.0 / law.compliances)
    stored = law.relaxed * strain**2 + branches**2 @ (1.0 / law.moduli)
    np.testing.assert_allclose(stored, creep_energy, rtol=1e-10)


@pytest.mark.parametrize("span", [1e-4, 0.3, 40.0, 1e5])
def test_free_recovery_is_exact_for_any_length(span: float) -> None:
    """Against the branch equations with ``q = 0`` as a constraint, by the exponential of their matrix."""
    law = rheology(SPREAD)
    start = np.array([0.3, -0.2, 0.5, 0.1]) * law.moduli
    strain = -start.sum() / law.relaxed
    units = law.release(start[None, :], np.array([strain]))[0]

    # q = 0: E0 w' + sum b' = 0 with b' = -b/tau + E w', hence w' = sum(b/tau)/glassy
    matrix = np.outer(law.moduli, 1.0 / law.times) / law.glassy - np.diag(1.0 / law.times)
    exact = expm(span * matrix) @ start
    later = units * np.exp(-span / law.retardation)
    np.testing.assert_allclose(later @ law.branches_of_units, exact, rtol=1e-6, atol=1e-9)
    np.testing.assert_allclose(later.sum(), -exact.sum() / law.relaxed, rtol=1e-6, atol=1e-9)


def test_covering_and_releasing_are_glassy() -> None:
    law = rheology(SPREAD)
    covered = law.cover(np.zeros((1, 4)), np.array([0.2]))
    np.testing.assert_allclose(covered[0], 0.2 * law.moduli)
    np.testing.assert_allclose(law.release(covered, np.array([0.2])), 0.0, atol=1e-12)


def test_a_collapse_that_comes_a_little_later_is_no_error_of_its_curve() -> None:
    """A thousand rows of a nearly vertical fall, later by a thousandth of it."""
    fall = np.linspace(1.0, 0.0, 1000)
    columns = [
        {
            "time": np.concatenate(([0.0], 1.0 + later - 1e-5 * fall)),
            "force": np.concatenate(([0.0], fall)),
            "contact_radius": np.concatenate(([1.0], fall)),
            "external_work": np.concatenate(([0.0], 1.0 - fall)),
        }
        for later in (0.0, 1e-4)
    ]
    errors = estimated_errors(*columns)
    assert errors["force"] == pytest.approx(1e-4, rel=0.15)
    assert errors["contact_radius"] == pytest.approx(1e-4, rel=0.15)


@pytest.mark.parametrize("pull", [0.0, 1e-17, 1e-10])
def test_rounding_where_contact_without_adhesion_ends_is_no_tension(pull: float) -> None:
    """Its error would be relative to nothing: 91 for -1.9e-17, and the largest of all estimates."""
    columns = [
        {
            "time": np.linspace(0.0, 1.0, 5),
            "force": np.array([1.0, 0.75, 0.5, 0.25, -tension]),
            "contact_radius": np.ones(5),
            "external_work": np.linspace(0.0, 1.0, 5),
        }
        for tension in (pull, 300.0 * pull)
    ]
    errors = estimated_errors(*columns)
    assert "pull_off_force" not in errors
    assert max(errors.values()) < 1e-6
    columns[0]["force"][-1] = -0.5
    columns[1]["force"][-1] = -0.53
    assert estimated_errors(*columns)["pull_off_force"] == pytest.approx(0.06)


@pytest.mark.parametrize(("ratio", "accuracy"), [(0.05, 1e-10), (0.2, 1e-10), (0.5, 1e-6)])
def test_closure_against_the_double_integral(ratio: float, accuracy: float) -> None:
    """The double integral over ``q'``, before integration by parts, for the smooth fields of a sphere."""
    a, depth = 0.2, 0.03
    da = ratio * a
    here = closure(a, da, da * np.linspace(0.0, 1.0, 17))
    got = here.between(depth - (a - da + here.s) ** 2, (a + here.s) ** 2 - depth)
    nodes, weights = np.polynomial.legendre.leggauss(24)
    nodes, weights = 0.5 * (nodes + 1.0), 0.5 * weights
    ring = np.cos(math.pi * (np.arange(60) + 0.5) / 60)

    def kernel(x: float, y: float) -> float:
        r = 0.5 * (x + y - da) + 0.5 * (x - y + da) * ring
        return math.pi * float(np.mean(1.0 / np.sqrt((x + r) * (r + da + y))))

    total = 0.0
    for s, weight in zip(nodes, weights, strict=True):
        y = a + da * s
        width = a + da - y
        inner = sum(
            w * width * (-2.0 * (y - da + width * u)) * kernel(y - da + width * u, y)
            for u, w in zip(nodes, weights, strict=True)
        )
        total += weight * da * (y * y - depth) * (-(depth - a * a) * kernel(a, y) + inner)
    assert got == pytest.approx(2.0 / math.pi**2 * total / (2.0 * da), rel=accuracy)


@pytest.mark.parametrize("time", [1e-6, 0.03, 1.0, 1e4])
def test_memory_by_collocation_is_that_of_a_ramp(time: float) -> None:
    times, moduli, clock = np.array([time]), np.array([0.3]), np.array([0.0, 0.5, 0.4, 0.1, 0.0])
    exact = ConstantRate(times, clock, moduli, 0.1, 0.7).end
    depths = 0.7 * clock[:, None]
    depths[0] = 0.1
    end = collocated(times, clock, moduli, depths).end
    assert end[1] == pytest.approx(exact[1], rel=1e-12)
    assert end[0] == pytest.approx(exact[0], rel=1e-6, abs=1e-7)


@pytest.mark.parametrize(
    "way", [[0.0, 1.0, 0.0, 0.0, 0.0], [0.0, 0.0, -1.0, 0.0, 0.0], [0.0, 2.0, -1.0, 0.0, 0.0]]
)
def test_inverse_of_a_path_that_may_turn_at_an_end(way: list[float]) -> None:
    u = np.linspace(0.0, 1.0, 11)
    rise = sum(coefficient * u**order for order, coefficient in enumerate(way))
    assert inverse(np.array(way), rise) == pytest.approx(u, abs=1e-7)


@pytest.mark.parametrize("height", [1.0, -1e-9])
def test_the_lowest_place_of_a_dip(height: float) -> None:
    place, value = dip(lambda x: height + (x - 0.3) ** 2, 1.0, 0.0, 1e-7)
    assert value <= max(height + 1e-13, 0.0)
    assert abs(place - 0.3) < 1e-4


def test_a_bracketed_root() -> None:
    def steep(x: float) -> float:
        return math.expm1(30.0 * (x - 0.31))

    assert bracketed(steep, 0.0, 1.0) == pytest.approx(0.31, abs=1e-15)
    assert bracketed(steep, 0.31, 1.0) == 0.31
    with pytest.raises(ValueError, match="no change of sign"):
        bracketed(steep, 0.4, 1.0)


def test_no_points_are_points():
    """A zone of fixed stress may lie within what the edge has not passed (``instruments:633``)."""
    points = Points(np.zeros((0, 9)), np.zeros((0, 3)), np.zeros(0), np.zeros((0, 2)))
    motion = collocated(np.ones(2), np.linspace(0.0, 1.0, 5), np.ones(2), np.ones((5, 3)))
    gained, depth = motion.during(points, np.zeros((0, 1)), np.zeros((0, 2)))
    assert (gained.shape, depth.shape) == ((0, 2), (0,))


@pytest.mark.parametrize("radius", [1e-9, 0.0331, 0.7, 41.0])
def test_a_zone_that_fills_the_contact_is_told_by_its_length(radius: float) -> None:
    """To the last bit: else an edge about to be lost is a stable one (``instruments:21030``)."""
    radii = radius * np.linspace(1.0, 1.1, 100)
    zones = [
        zone_length(lambda x: np.full_like(x, -1e6), np.zeros(0), a, 1.0, 0.1 * a, 0.5 * a) for a in radii
    ]
    assert (zones >= LONGEST * radii).all()


def test_the_loss_of_a_contact_that_ends_in_a_point_is_no_better_than_its_curves() -> None:
    """Two runs may agree by accident in the time (``plain:218``)."""
    fall, alike = np.linspace(1.0, 0.0, 101), ("time", "penetration", "contact_radius", "external_work")
    fine = dict.fromkeys(alike, fall) | {"time": 1.0 - fall, "force": fall}
    coarse = fine | {"force": np.where(fall > 0.7, 1.001, 1.0) * fall}
    assert estimated_errors(fine, coarse, True)["detachment_time"] > 1e-4
