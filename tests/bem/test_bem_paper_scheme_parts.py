"""Parts of the paper scheme: factors of all leading blocks, and the paper's equations as written."""

from __future__ import annotations

import numpy as np
import pytest
from support.paper_scenes import ONE as RUBBER

from bem_solver.annuli import disc_displacement
from bem_solver.creep import Chain
from bem_solver.paper_scheme import AnnuliState, ContactCandidates, LeadingBlocks, UniformAnnuli
from contact_scene import Branch, Counters, Material, Sphere

TWO_BRANCHES = Material(0.75, 0.5, (Branch(2.0, 0.1), Branch(4.75, 1.0)))


def uniform(count=40):
    return UniformAnnuli(0.01, count, 6, Sphere(1.0))


def test_one_factorisation_solves_every_leading_block():
    matrix = uniform(80).blocks
    whole = np.tril(matrix.factors, -1) @ np.triu(matrix.factors) + np.triu(matrix.factors)
    b, c = np.random.default_rng(1).normal(size=(2, 80))
    y, z = matrix.forward(b), matrix.adjoint(c)
    for n in (1, 2, 37, 80):
        x = np.linalg.solve(whole[:n, :n], b[:n])
        np.testing.assert_allclose(matrix.backward(y[:n]), x, rtol=1e-11, atol=1e-12)
        np.testing.assert_allclose(matrix.last(y[:n], min(n, 5)), x[-5:], rtol=1e-11, atol=1e-12)
        np.testing.assert_allclose(matrix.beyond(y[:n], 80), whole[n:, :n] @ x, rtol=1e-11, atol=1e-12)
        assert z[:n] @ y[:n] == pytest.approx(c[:n] @ x, rel=1e-10)


@pytest.mark.parametrize(
    "matrix", [[[0.0, 1.0], [1.0, 0.0]], [[1.0, 2.0], [2.0, 1.0]], [[1.0, 1.0], [1.0, 1.0]]]
)
def test_a_matrix_that_needs_row_exchanges_is_refused(matrix):
    with pytest.raises(ArithmeticError, match="without exchanging rows"):
        LeadingBlocks(np.array(matrix))


# --- the paper's equations as written


def test_annuli_are_those_of_the_paper():
    annuli, width = uniform(), 0.01
    q = np.arange(40)
    np.testing.assert_allclose(annuli.radii, np.where(q > 0, (q + 0.5) * width, 0.0))
    np.testing.assert_allclose(annuli.areas.cumsum(), np.pi * (q + 1.0) ** 2)
    # Eqs. Kernel and Ghq: unit pressure everywhere is the disc
    uniform_pressure = np.full(40, width)
    factors = annuli.blocks.factors
    load = np.tril(factors, -1) @ (np.triu(factors) @ uniform_pressure) + np.triu(factors) @ uniform_pressure
    np.testing.assert_allclose(load, disc_displacement(annuli.radii, 40 * width), rtol=1e-12)


def influence(annuli):
    """Displacement under unit pressure on each annulus, at unit plane modulus."""
    factors = annuli.blocks.factors
    return annuli.width * (np.tril(factors, -1) @ np.triu(factors) + np.triu(factors))


def stepped(
    material, control="penetration", values=(0.02, 0.015), contacts=(15, 13), scheme="backward-euler"
):
    """Two steps of 0.1 with the given contacts; annuli, chain, states, the last candidates."""
    annuli, chain = uniform(), Chain(material, scheme == "backward-euler")
    states, candidates = [AnnuliState.untouched(annuli, len(chain), 0.0)], None
    for index, (value, contact) in enumerate(zip(values, contacts, strict=True), 1):
        candidates = ContactCandidates(annuli, chain, states[-1], 0.1, control, value, Counters())
        states.append(candidates.state(contact, 0.1 * index))
    return annuli, chain, states, candidates


def test_backward_euler_is_the_papers_linear_system():
    annuli, chain, (_, before, after), _ = stepped(RUBBER)
    matrix, step = influence(annuli), 0.1 / chain.retardation[0]
    assert chain.retardation[0] == pytest.approx(10.0)  # the appendix's tau
    pressure = [np.zeros(40), np.zeros(40)]
    for into, surface in zip(pressure, (before, after), strict=True):
        into[: surface.contact] = surface.scaled / annuli.width
    known = before.displacement(chain) - matrix @ pressure[0] / chain.glassy  # Eq. knownterm
    left = (1.0 + step) * after.displacement(chain)  # Eq. linear system
    right = (1.0 / chain.glassy + step / chain.relaxed) * (matrix @ pressure[1]) + known
    np.testing.assert_allclose(left, right, rtol=1e-12, atol=1e-16)
    inside = slice(0, after.contact)
    np.testing.assert_allclose(
        after.displacement(chain)[inside], 0.015 - annuli.heights[inside], rtol=1e-12, atol=1e-16
    )


@pytest.mark.parametrize("scheme", ["backward-euler", "exponential"])
@pytest.mark.parametrize(("control", "values"), [("penetration", (0.02, 0.015)), ("force", (0.02, 0.004))])
def test_closure_and_force_of_a_candidate_are_those_of_the_state(scheme, control, values):
    annuli, chain, (_, _, after), candidates = stepped(TWO_BRANCHES, control, values, scheme=scheme)
    pressure = after.scaled / annuli.width
    n, zone = after.contact, annuli.zone
    gap = annuli.heights - after.penetration + after.displacement(chain)
    plain = sum(-pressure[n - 1 - i] * gap[n - 1 - i + zone] for i in range(zone)) / (
        2.0 * zone
    )  # Eq. closure
    assert candidates.closure(n) == pytest.approx(plain if pressure[-1] < 0 else -abs(plain), rel=1e-9)
    assert after.force == pytest.approx(annuli.width**2 * annuli.areas[:n] @ pressure, rel=1e-12)
    assert (after.force if control == "force" else after.penetration) == pytest.approx(values[-1], rel=1e-10)
    assert np.sign(candidates.edge_pressure(n)) == np.sign(pressure[-1])


def test_a_compressive_edge_over_an_overlap_counts_negative():
    """Pressure and gap both have the wrong sign there: their product must not pass for tension."""
    annuli, _, (_, _, after), candidates = stepped(RUBBER, contacts=(15, 5))
    assert after.scaled[-1] > 0.0
    assert candidates.closure(after.contact) < -0.01 * annuli.width
