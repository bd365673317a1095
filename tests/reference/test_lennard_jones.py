"""Lennard-Jones tractions: the law itself, the sharp limit, and a process zone of fixed stress."""

import math

import numpy as np
import pytest

from benchmarks.lennard_jones import WORK, LennardJonesSphere, UniformRings, compared
from contact_scene import Material

ELASTIC = Material(0.75, 0.5)


def sphere(tabor):
    return LennardJonesSphere(ELASTIC, 1.0, WORK, math.cbrt(WORK**2) / tabor)


def test_the_law_holds_its_work_and_its_largest_tension():
    law = sphere(3.0)
    gaps = law.distance * np.geomspace(1.0, 1e3, 20001)
    pressure, slope = law.pressure(gaps)
    assert np.trapezoid(-pressure, gaps) == pytest.approx(WORK, rel=1e-5)
    assert -pressure.min() == pytest.approx(law.stress, rel=1e-6)
    assert np.abs(slope - np.gradient(pressure, gaps))[1:-1].max() < 1e-3 * np.abs(slope).max()


def test_annuli_sink_as_under_hertz():
    annuli = UniformRings(np.linspace(0.0, 2.0, 401))
    pressure = 2.0 / np.pi * np.sqrt(np.maximum(1.0 - annuli.radii**2, 0.0))
    inside = annuli.radii < 0.95
    sunk = annuli.influence @ pressure
    assert sunk[inside] == pytest.approx(1.0 - 0.5 * annuli.radii[inside] ** 2, rel=1e-3)
    assert pressure @ annuli.areas == pytest.approx(4.0 / 3.0, rel=1e-3)


@pytest.mark.slow
def test_an_elastic_sphere_lies_between_the_sharp_edge_and_a_rigid_sphere():
    """Beyond Tabor's parameter of 1 the pull-off force falls towards ``1.5 pi w R`` (Greenwood, Fig. 4)."""
    coarse = sphere(2.0).pull_off(0.032, 1e-3, 3).force / (math.pi * WORK)
    finer = sphere(2.0).pull_off(0.032, 1e-3, 6).force / (math.pi * WORK)
    shorter = sphere(3.0).pull_off(0.032, 1e-3, 3).force / (math.pi * WORK)
    assert coarse == pytest.approx(finer, rel=2e-3)
    assert 1.5 < shorter < finer < 1.65


@pytest.mark.exhaustive
def test_a_zone_of_fixed_stress_follows_lennard_jones_and_one_of_fixed_length_does_not():
    """Both models of one interface; withdrawn at two hundredths of a radius per relaxation time."""
    found = compared(3.0, 0.02, resolution=4, divisions=3)
    stress, length = found.differences
    assert abs(stress) < 0.15
    assert length > 0.25
