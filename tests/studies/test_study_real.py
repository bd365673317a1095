"""A study of the real solvers: the orders that the method promises come out of the ladders."""

from __future__ import annotations

from dataclasses import replace

import pytest

from validation.cases import load
from validation.runs.progress import Progress
from validation.studies import study
from validation.studies.ladders import ladders

ASKED = {"bem": (1.8, 3.2), "paper-scheme": (0.7, 1.2), "fem": (1.8, 4.5)}
"""Annuli are of second order, the path of an opening edge of third."""


@pytest.fixture(scope="module")
def found():
    """The ladders that refine everything, three or four levels, run once: run times are not looked at."""

    def short(scene):
        kept = [ladder for ladder in ladders(scene) if ladder.timed and ladder.scheme != "fem-volume"]
        return [replace(one, levels=one.levels[: 3 if one.scheme == "bem" else 4]) for one in kept]

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(study, "ladders", short)
        patch.setattr(study, "REPEATS", 1)
        return study.study([load("cycle-v0.02")], 1, Progress("test")).scenes[0]


@pytest.mark.exhaustive
def test_every_level_has_an_answer(found):
    assert [(entry.ladder.scheme, run.level.label) for entry, run in found.failed] == []
    assert found.reference.startswith("front tracking")


@pytest.mark.exhaustive
@pytest.mark.parametrize("scheme", ASKED)
def test_the_loop_integral_converges_as_promised(found, scheme):
    low, high = ASKED[scheme]
    entry = next(e for e in found.ladders if e.ladder.scheme == scheme)
    row = next(row for row in entry.rows if row.observable == "loop_energy")
    assert low <= row.fitted <= high
    assert abs(row.errors[-1]) <= {"bem": 5e-5, "paper-scheme": 3e-3, "fem": 5e-5}[scheme]


@pytest.mark.exhaustive
def test_the_front_tracking_is_of_second_order_or_better_by_its_values_alone(found):
    entry = next(e for e in found.ladders if e.ladder.scheme == "reference")
    rows = {row.observable: row for row in entry.rows}
    alone = rows["loop_energy"].alone
    known = [order for order in alone.orders if order is not None]  # none where differences change their sign
    assert known, alone
    assert min(known) >= 1.8, alone  # a single one is large where a difference happens to be small
    assert 1.8 <= rows["loop_energy"].fitted <= 5.0
    assert 1.8 <= rows["pull_off_force"].fitted <= 5.0


@pytest.mark.exhaustive
def test_the_bound_from_values_alone_covers_the_error_of_the_loop(found):
    for entry in found.ladders:
        row = next(row for row in entry.rows if row.observable == "loop_energy")
        assert abs(row.errors[-1]) <= row.alone.bound
