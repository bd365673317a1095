"""Closed forms in other units: found by roots or minima, they are as good at nanometres as at metres."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
import pytest
from support.paper_scenes import ONE as MATERIAL

from contact_scene import Sphere, TabulatedProfile
from validation.reference import jkr, sneddon
from validation.reference.finite_zone import FiniteZone
from validation.reference.frozen import FrozenRetraction

WORK = 5e-4  # times the unit of length, as a work over a modulus is


def _table(length: float) -> TabulatedProfile:
    radii = np.linspace(0.0, 1.0, 21)
    return TabulatedProfile(tuple((radii * length).tolist()), tuple((0.5 * radii**2 * length).tolist()))


def _frozen(length: float) -> Sequence[float]:
    pulled = FrozenRetraction(MATERIAL, _table(length), WORK * length, 0.02 * length)
    peak = pulled.pull_off()
    return pulled.relaxed.contact_radius / length, peak.contact_radius / length, peak.force / length**2


def _finite_zone(length: float) -> Sequence[float]:
    law = FiniteZone(length, 1.0, WORK * length, 0.013 * length)
    peak, end = law.pull_off_force_control(), law.pull_off_penetration_control()
    inside = law.at_penetration(0.01 * length)
    return peak.force / length**2, end.penetration / length, inside.contact_radius / length


def _sneddon(length: float) -> Sequence[float]:
    return [sneddon.contact_radius(_table(length), 0.02 * length) / length]


def _jkr(length: float) -> Sequence[float]:
    law = jkr.JKR(Sphere(length), 1.0, WORK * length)
    at = law.at_penetration(0.02 * length)
    return at.contact_radius / length, at.force / length**2


@pytest.mark.parametrize("closed_form", [_frozen, _finite_zone, _sneddon, _jkr])
@pytest.mark.parametrize("length", [1e-9, 1e-3, 1e6])
def test_closed_form_does_not_mind_the_unit_of_length(
    closed_form: Callable[[float], Sequence[float]], length: float
) -> None:
    np.testing.assert_allclose(closed_form(length), closed_form(1.0), rtol=1e-9)


def test_tabulated_sphere_in_nanometres_is_a_sphere() -> None:
    """Not only the same in all units, but right."""
    exact = np.sqrt(0.02)  # D = a^2/R
    assert _sneddon(1e-9)[0] == pytest.approx(exact, rel=1e-2)
    assert sneddon.contact_radius(Sphere(1e-9), 0.02e-9) == pytest.approx(exact * 1e-9, rel=1e-12)
