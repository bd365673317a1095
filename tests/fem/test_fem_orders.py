"""Whole runs converge at order two of the resolution alone, mesh and steps together (a table of the docs)."""

from __future__ import annotations

import math

import pytest

from validation.cases import load
from validation.measure.curves import distance
from validation.studies.ladders import Settings, scheme

COARSE, FINE, REFERENCE = 5, 20, 60
ORDERS = 1.6, 2.5
ALL = ("force", "contact_radius", "loop_energy", "pull_off_force")


def errors(run, reference, names):
    """Of curves in the mean square, of numbers as they are."""
    curves = {name: distance(run.trace, reference.trace, name).rms for name in names if name in ALL[:2]}
    numbers = {
        name: abs(run.measures[name] / reference.measures[name] - 1.0) for name in names[len(curves) :]
    }
    return curves | numbers


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "quantities", "largest"),
    [
        ("cycle-v0.02", ALL, 1e-5),
        ("three-branches", ALL, 2e-5),
        ("retraction-v0.02", ("contact_radius", "loop_energy"), 5e-6),
    ],
)
def test_order_two_from_five_to_twenty_elements_a_zone(name, quantities, largest):
    case = load(name)
    reference = scheme("reference").run(case, Settings(REFERENCE))
    coarse, fine = (
        errors(scheme("fem").run(case, Settings(n)), reference, quantities) for n in (COARSE, FINE)
    )
    for quantity in quantities:
        order = math.log(coarse[quantity] / fine[quantity]) / math.log(FINE / COARSE)
        assert ORDERS[0] < order < ORDERS[1], quantity
        assert fine[quantity] < largest, quantity
