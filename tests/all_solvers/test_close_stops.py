"""A run that stops twice at nearly the same time finds what it finds without.

Such rows differ by what the solver does not know of its columns: that is no slope, no turn and no pull-off.
"""

from __future__ import annotations

from itertools import product

import pytest

from validation.cases import load
from validation.measure.observables import observe
from validation.solvers import solver

APART = 1e-9
"""Distance of the two stops of a pair, in times at which they are."""


SCENES = ("cycle-v0.1", "elastic-relaxed", "spring-approach")
QUICK = {("spring-approach", "reference")}
RARELY = {
    ("cycle-v0.1", "fem"),
    ("spring-approach", "fem"),
    ("elastic-relaxed", "bem"),
    ("spring-approach", "bem"),
}
"""Every solver and every scene stay with the others, finite elements in the cheapest scene."""


def marks(pair):
    if pair in QUICK:
        return ()
    return pytest.mark.exhaustive if pair in RARELY else pytest.mark.slow


@pytest.mark.parametrize(
    ("scene", "name"),
    [pytest.param(*pair, marks=marks(pair)) for pair in product(SCENES, ("bem", "fem", "reference"))],
)
def test_pairs_of_stops_change_neither_pull_off_nor_loop(name, scene):
    question, resolution = load(scene).scene, None if name == "fem" else 4
    plain = solver(name).solve(question, resolution)
    stops = [share * plain.time[-1] for share in (0.11, 0.23, 0.51, 0.77, 0.9)]
    pairs = tuple(time for stop in stops for time in (stop, stop * (1.0 + APART)))
    stopped = solver(name).solve(question, resolution, stop_times=pairs)
    assert len(stopped) > len(plain)
    seen, expected = observe(stopped), observe(plain)
    assert (seen.pull_off_force is None) == (expected.pull_off_force is None)
    if expected.pull_off_force is not None:
        assert seen.pull_off_force == pytest.approx(expected.pull_off_force, rel=5e-4)
    assert seen.loop_energy == pytest.approx(expected.loop_energy, rel=5e-4)
