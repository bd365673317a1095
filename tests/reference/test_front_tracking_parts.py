"""The parts of the front tracking against definitions, brute force and independent integrators."""

import math
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.linalg import expm

from contact_scene import Branch, Cone, FlatPunch, Indenter, Material, PowerLaw, Sphere, TabulatedProfile
from contact_scene.loading import pieces
from validation.reference.path.rheology import Body, rheology
from validation.reference.sneddon import transform
from validation.reference.tracking import hermite
from validation.reference.tracking.closure import EdgeFields, closure_integral
from validation.reference.tracking.control import freedom
from validation.reference.tracking.edge_path import ParabolicPath, PolynomialPath, path_family
from validation.reference.tracking.estimate import estimated_errors
from validation.reference.tracking.penetration_path import BranchGain, cubic, phi
from validation.reference.tracking.root import bracketed, rising_root
from validation.reference.tracking.row_extrapolation import RowExtrapolation

RADII = np.linspace(0.0, 1.0, 41)
SHAPES = [
    Sphere(2.0),
    Cone(75.0),
    FlatPunch(3.0),
    PowerLaw(2.7, 0.4),
    TabulatedProfile((0.0, 0.2, 0.5, 1.0), (0.0, 0.01, 0.3, 0.5)),
]
SPREAD = Material(0.75, 0.3, (Branch(2.0, 1e-3), Branch(1.0, 1.0), Branch(0.5, 1.5), Branch(3.0, 1e4)))


def _kinks(shape: Indenter, x: float) -> list[float]:
    table = shape.radii if isinstance(shape, TabulatedProfile) else ()
    return [math.asin(r / x) for r in table if 0.0 < r < x]


@pytest.mark.parametrize("shape", SHAPES, ids=lambda s: s.shape)
@pytest.mark.parametrize("x", [0.1, 0.37, 1.4])
def test_transform_is_its_integral(shape: Indenter, x: float) -> None:
    ends = [0.0, *_kinks(shape, x), 0.5 * math.pi]
    pieces = [
        quad(lambda angle: float(shape.slope(x * math.sin(angle))), a, b, epsabs=1e-13)[0]
        for a, b in pairwise(ends)
    ]
    assert float(transform(shape)(np.array(x))) == pytest.approx(x * sum(pieces), rel=1e-10, abs=1e-14)


@pytest.mark.parametrize("shape", SHAPES, ids=lambda s: s.shape)
def test_integral_of_transform(shape: Indenter) -> None:
    g = transform(shape)
    ends = [0.0, 0.2, 0.5, 0.9]
    total = sum(quad(lambda x: float(g(np.array(x))), a, b, epsabs=1e-13)[0] for a, b in pairwise(ends))
    assert g.integral(0.9) == pytest.approx(total, rel=1e-8, abs=1e-14)


def test_transform_of_a_tabulated_paraboloid() -> None:
    g = transform(TabulatedProfile(tuple(RADII), tuple(RADII**2 / 2.0)))
    x = np.array([0.0, 0.1, 0.33, 0.77])
    np.testing.assert_allclose(g(x), x**2, atol=1e-12)


def test_interpolation_is_exact_for_parabolas_and_bounded_at_steps() -> None:
    x = np.array([0.0, 0.3, 0.35, 0.9, 1.0, 1.6])
    at = np.linspace(0.0, 1.6, 50)
    y = 1.0 + 2.0 * x - 0.4 * x**2
    np.testing.assert_allclose(
        hermite.evaluate(x, y, hermite.slopes(x, y), at), 1.0 + 2.0 * at - 0.4 * at**2, atol=1e-14
    )
    assert hermite.integral(x, y) == pytest.approx(1.6 + 1.6**2 - 0.4 * 1.6**3 / 3.0, rel=1e-14)
    x = np.array([0.0, 0.5, 0.5 + 1e-11, 1.0])
    step = np.array([0.0, 0.0, 1.0, 1.0])
    values = hermite.evaluate(x, step, hermite.slopes(x, step), np.linspace(0.0, 1.0, 101))
    assert values.min() >= -1e-12
    assert values.max() <= 1.0 + 1e-12


@pytest.mark.parametrize("y", [0.0, 1e-9, 0.05, 0.1999, 0.2001, 3.0, 1e6])
def test_phi_functions(y: float) -> None:
    values = phi(np.array([y]))
    for m, value in enumerate(values, 1):

        def integrand(v: float, m: int = m) -> float:
            return math.exp(-y * (1.0 - v)) * v ** (m - 1) / math.factorial(m - 1)

        layer = [1.0 - 30.0 / y, 1.0 - 1.0 / y] if y > 30.0 else None
        exact = quad(integrand, 0.0, 1.0, points=layer, epsabs=1e-15)[0]
        assert float(value[0]) == pytest.approx(exact, rel=1e-9)


def test_memory_of_a_cubic_penetration() -> None:
    depth = cubic(2.0, 0.1, 0.4, 0.3, -0.2)
    times = np.array([1e-3, 0.7, 1e5])
    begin, until = np.array([0.0, 0.5]), np.array([2.0, 1.7])
    got = BranchGain(begin, until, times).under(depth)
    c1, c2, c3 = depth.rates
    for i in range(2):
        for k, tau in enumerate(times):
            nodes = [until[i] - 10.0 * tau] if until[i] - 10.0 * tau > begin[i] else None
            exact = quad(
                lambda s, tau=tau, i=i: math.exp(-(until[i] - s) / tau) * (c1 + 2 * c2 * s + 3 * c3 * s * s),
                begin[i], until[i], points=nodes, epsabs=1e-15, limit=200,
            )[0]  # fmt: skip
            assert got[i, k] == pytest.approx(exact, rel=1e-8)
    assert depth.penetration(2.0) == pytest.approx(0.4)


def test_both_representations_are_one_material() -> None:
    law = rheology(SPREAD)
    rng = np.random.default_rng(7)
    branches, strain = rng.normal(size=(5, 4)) * law.moduli, rng.normal(size=5)
    units = law.release(branches, strain)
    q = law.stress(branches, strain)
    np.testing.assert_allclose(strain, q / law.glassy + units.sum(axis=1), rtol=1e-10)
    back = units @ law.branches_of_units + np.outer(q, law.moduli) / law.glassy
    np.testing.assert_allclose(back, branches, rtol=1e-9, atol=1e-12)
    creep_energy = 0.5 * q**2 / law.glassy + law.stored_outside(units)
    np.testing.assert_allclose(law.stored_in_contact(branches, strain), creep_energy, rtol=1e-10)


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


@pytest.mark.parametrize(("ratio", "accuracy"), [(0.05, 1e-10), (0.2, 1e-8), (0.5, 1e-5)])
def test_closure_against_the_double_integral(ratio: float, accuracy: float) -> None:
    """The double integral over ``q'``, before integration by parts, for smooth ``q`` and ``d``."""
    a, depth = 0.2, 0.03
    da = ratio * a
    inside, outside = np.linspace(0.0, a, 300), np.linspace(a, a + 1.5 * da, 40)
    got = closure_integral(
        EdgeFields(inside, 0.0 * inside, outside, 0.0 * outside, depth), da, 1.0, transform(Sphere(1.0))
    )
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


def test_path_and_its_inverse() -> None:
    path = ParabolicPath(0.3, -0.01, 0.004)
    f = np.linspace(0.0, 1.0, 21)
    np.testing.assert_allclose(path.passing(path(f)), f, atol=1e-12)
    assert path(np.array([1.0]))[0] == pytest.approx(0.29)


def test_path_over_zones_is_the_polynomial_through_the_rows() -> None:
    """Exact for a quartic through four rows and the end, whatever their spacing; never reversing."""
    quartic = np.polynomial.Polynomial([0.3, -0.02, -0.006, -0.002, -0.001])
    times = (0.0, -0.3, -0.55, -1.2)
    rows = RowExtrapolation(times, tuple(float(quartic(t)) for t in times))
    path = path_family(rows, 0.7, 0.3).polynomial(float(quartic(0.7)))
    f = np.linspace(0.0, 1.0, 21)
    np.testing.assert_allclose(path(f), quartic(0.7 * f), atol=1e-15)
    np.testing.assert_allclose(path.passing(path(f)), f, atol=1e-12)
    assert isinstance(path, PolynomialPath)
    wild = path_family(rows, 0.7, 0.3).polynomial(0.2999)
    assert (np.diff(wild(np.linspace(0.0, 1.0, 400))) < 0.0).all()
    np.testing.assert_allclose(wild.passing(wild(f)), f, atol=1e-9)


def test_path_within_a_zone_meets_the_polynomial_in_the_middle() -> None:
    """What is left changes sign there: over the step it nearly cancels."""
    quartic = np.polynomial.Polynomial([0.3, -0.02, -0.006, -0.002, -0.001])
    times = (0.0, -0.3, -0.55, -1.2)
    rows = RowExtrapolation(times, tuple(float(quartic(t)) for t in times))
    path = path_family(rows, 0.7, 0.3).parabola(float(quartic(0.7)))
    f = np.array([0.0, 0.5, 1.0])
    np.testing.assert_allclose(path(f), quartic(0.7 * f), atol=1e-15)
    missed = path(np.array([0.25, 0.75])) - quartic(0.7 * np.array([0.25, 0.75]))
    assert missed[0] * missed[1] < 0.0
    assert abs(missed.sum()) < 0.3 * abs(missed).max()
    assert path_family(rows, 0.7, 0.3).parabola(0.2999).bend == pytest.approx(0.99e-4, rel=1e-9)
    assert path_family(RowExtrapolation((0.0,), (0.3,)), 0.7, 0.3).parabola(0.2).bend == 0.0


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
    assert errors["force"] == pytest.approx(1e-4 / 3.0, rel=0.15)
    assert errors["contact_radius"] == pytest.approx(1e-4 / 3.0, rel=0.15)


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


def test_roots() -> None:
    def steep(x: float) -> float:
        return math.expm1(30.0 * (x - 0.31))

    root = bracketed(steep, 0.0, steep(0.0), 1.0, steep(1.0), 1e-13, 1e-15)
    assert root == pytest.approx(0.31, abs=1e-12)
    found = rising_root(steep, 0.3, 0.01, 0.0, (0.2, 0.4), 1e-12)
    assert found is not None
    assert found[0] == pytest.approx(0.31, abs=1e-12)
    assert rising_root(lambda x: -steep(x), 0.3, 0.01, 0.0, (0.2, 0.4), 1e-12) is None


def test_a_root_close_to_its_guess_is_corrected_by_the_known_slope() -> None:
    """No further evaluation; several such roots differ by what they really differ."""
    asked: list[float] = []

    def line(x: float) -> float:
        asked.append(x)
        return 3.0 * (x - 0.31)

    found = rising_root(line, 0.31 + 1e-11, 0.01, 3.0, (0.2, 0.4), 1e-10)
    assert found is not None
    assert found[0] == pytest.approx(0.31, abs=1e-16)
    assert len(asked) == 1
    assert rising_root(line, 0.31 + 1e-11, 0.01, 3.0, (0.31, 0.4), 1e-10) == (0.31 + 1e-11, 3.0)


def test_penetration_is_as_free_as_the_load_leaves_it() -> None:
    body = Body(rheology(SPREAD), transform(Sphere(2.0)))
    stage = pieces("stage", (0.0, 1.0), (0.0, 1.0))
    half = 0.5 / (body.rheology.glassy * 0.1)
    stiff, even, soft = (
        freedom(replace(stage, compliance=c), body, 0.1) for c in (1e-6 * half, half, 1e6 * half)
    )
    assert freedom(pieces("penetration", (0.0, 1.0), (0.0, 1.0)), body, 0.1) == 0.0
    assert freedom(pieces("force", (0.0, 1.0), (0.0, 1.0)), body, 0.1) == 1.0
    assert even == pytest.approx(0.5)
    assert 0.0 < stiff < 2e-6
    assert 1.0 - 2e-6 < soft < 1.0
