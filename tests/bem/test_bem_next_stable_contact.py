"""Search for the next stable contact of an edge that moves unstably."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pytest
from numpy.testing import assert_allclose

from bem_solver.equilibrium import first_stable


@dataclass(frozen=True)
class Contact:
    residual: float


class Residual:
    """Driven on by ``excess`` at every radius, in the direction ``way``; the radii that were tried."""

    def __init__(self, excess, way):
        self.excess, self.way, self.tried = excess, way, []

    def __call__(self, radius):
        self.tried.append(radius)
        return Contact(-self.way * float(self.excess(radius)))


WAYS = pytest.mark.parametrize(("edge", "end"), [(1.0, 0.01), (0.01, 1.0)])


@WAYS
def test_a_smooth_way_without_rest_costs_a_third(edge, end):
    way = np.sign(end - edge)
    residual = Residual(lambda r: 1.0 - (edge / r) ** (0.4 * way), way)
    assert first_stable(residual, edge, end, 1.02, 4, 1e-9, ()) is None
    assert len(residual.tried) < 0.36 * np.log(100.0) / np.log(1.02)
    assert residual.tried[-1] == end


@WAYS
def test_where_the_way_begins_far_from_zero_it_is_passed_over_as_elsewhere(edge, end):
    way = np.sign(end - edge)
    residual = Residual(lambda r: (end / r) ** (3.0 * way) - 1.1, way)
    near, stable = first_stable(residual, edge, end, 1.02, 4, 1e-9, ())
    assert residual.excess(near) > 0.0 > residual.excess(stable)
    assert_allclose(np.sort(residual.tried)[:: int(way)][:3], edge * 1.02 ** (4.0 * way * np.arange(3)))


@WAYS
@pytest.mark.parametrize("place", [0.02, 0.11, 0.5])
@pytest.mark.parametrize("width", [0.12, 0.5])
@pytest.mark.parametrize("depth", [1.02, 1.5])
def test_a_dip_is_found_where_it_begins(edge, end, place, width, depth):
    """A depth of 1 reaches zero; widths in parts of the radius."""

    def excess(radius):
        return 1.0 - depth * np.exp(-((np.log(radius / place) / width) ** 2))

    way = np.sign(end - edge)
    near, stable = first_stable(Residual(excess, way), edge, end, 1.02, 4, 1e-9, ())
    assert excess(near) > 0.0 > excess(stable)
    begins = place * np.exp(-way * width * np.sqrt(np.log(depth)))
    assert min(near, stable) <= begins <= max(near, stable)


@WAYS
def test_a_narrow_dip_where_the_edge_has_rested_is_found(edge, end):
    def excess(radius):
        return 1.0 - 1.5 * np.exp(-(((radius - 0.1) / 0.002) ** 2))

    found = first_stable(Residual(excess, np.sign(end - edge)), edge, end, 1.02, 4, 1e-9, (0.1,))
    assert found is not None
    assert excess(found[1]) < 0.0


@WAYS
def test_rounding_is_no_stable_contact(edge, end):
    way = np.sign(end - edge)
    assert first_stable(Residual(lambda _: -1e-12, way), edge, end, 1.02, 4, 1e-9, ()) is None
