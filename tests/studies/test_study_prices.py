"""Error against run time: prices between levels, the cheapest scheme, exponents of cost, on made-up runs."""

from __future__ import annotations

import pytest

from validation.measure import skipped_work
from validation.studies.convergence import Convergence, LevelRun, read
from validation.studies.ladders import Ladder, Level
from validation.studies.schemes import Settings
from validation.studies.work_precision import (
    busy,
    cheapest,
    cost,
    growth,
    growth_in_words,
    in_words,
    left_out,
    measures,
    price,
)

MEASURE = "force, RMS"


def made_up(scheme: str, errors: list[float | None], seconds: list[float], **counters: int) -> Convergence:
    """A ladder of halved sizes; ``None`` makes a failed level."""
    levels = tuple(Level(0.5**i, str(i), Settings(4)) for i in range(len(errors)))
    runs = tuple(
        LevelRun(level, failure="fell over")
        if error is None
        else LevelRun(
            level, {}, {MEASURE: error}, {"steps": 10 * 2**i, **counters}, spent, spent, 1, "completed"
        )
        for i, (level, error, spent) in enumerate(zip(levels, errors, seconds, strict=True))
    )
    return read(Ladder(scheme, "together", "everything", levels), runs, {})


def test_a_price_lies_between_two_levels():
    found = price(made_up("bem", [1e-1, 1e-3], [1.0, 4.0]), MEASURE, 1e-2)
    assert found.seconds == pytest.approx(2.0)
    assert not found.at_most


def test_a_coarsest_level_that_is_good_enough_bounds_the_price():
    found = price(made_up("bem", [1e-3, 1e-4], [1.0, 4.0]), MEASURE, 1e-2)
    assert (found.seconds, found.at_most) == (1.0, True)


def test_what_is_not_reached_has_no_price():
    assert price(made_up("bem", [1e-1, 1e-2], [1.0, 2.0]), MEASURE, 1e-4).seconds is None
    assert price(made_up("bem", [None, None], [1.0, 2.0]), MEASURE, 1e-1).seconds is None
    assert price(made_up("bem", [1e-1], [1.0]), "no such error", 1.0).seconds is None


def test_a_lucky_coarse_level_is_no_bargain():
    found = price(made_up("bem", [1e-5, 1e-2, 1e-4], [1.0, 2.0, 4.0]), MEASURE, 1e-3)
    assert 2.0 < found.seconds < 4.0


def test_an_exact_level_costs_what_it_costs():
    assert price(made_up("bem", [1e-1, 0.0], [1.0, 4.0]), MEASURE, 1e-2).seconds == 4.0


def test_the_cheapest_scheme_is_named():
    studies = [
        made_up("bem", [1e-1, 1e-3, 1e-5], [1.0, 2.0, 4.0]),
        made_up("paper-scheme", [1e-1, 1e-2, 1e-3], [0.1, 1.0, 10.0]),
    ]
    assert cheapest(studies, MEASURE, 1e-1)[0].scheme == "paper-scheme"
    assert cheapest(studies, MEASURE, 1e-3)[0].scheme == "bem"
    assert cheapest(studies, MEASURE, 1e-9)[0] is None
    said = in_words(studies)
    assert len(said) == 4
    assert "At 1e-01 paper-scheme is cheapest: at most 0.1 s" in said[0]
    assert "At 1e-04 bem is cheapest: 2.8 s (paper-scheme does not reach it)" in said[3]
    assert "no scheme reaches" in in_words([made_up("bem", [None], [1.0])])[0]


def test_an_error_that_no_run_can_have_is_not_asked_for():
    """No pull-off force without adhesion; but where all runs failed everything stays visible."""
    assert measures([made_up("bem", [1e-1], [1.0])]) == [MEASURE]
    assert in_words([made_up("bem", [1e-1], [1.0])], "pull_off_force") == ["there is none in this scene."]
    assert len(measures([made_up("bem", [None], [1.0])])) == 6


def test_exponents_of_cost():
    study = made_up("bem", [1e-1, 1e-2, 1e-3, 1e-4], [1.0, 8.0, 64.0, 512.0])
    found = growth(study, "wall_seconds")
    assert found.with_resolution == pytest.approx(3.0)
    assert found.with_error == pytest.approx(0.90309, rel=1e-4)
    assert growth(study, "steps").with_resolution == pytest.approx(1.0)
    assert growth(study, "linear_solves").with_resolution is None
    assert busy([study]) == 1.0
    assert "resolution^3.00" in growth_in_words([study])[0]
    assert "fewer than three" in growth_in_words([made_up("bem", [1e-1, None], [1.0, 2.0])])[0]


def test_a_failed_level_has_no_cost():
    study = made_up("bem", [1e-1, None], [1.0, 2.0])
    assert [cost(run, "wall_seconds") for run in study.runs] == [1.0, None]


def test_a_scene_that_needs_everything_says_so():
    work = {"bem": {"closure_evaluations": 3, "history_updates": 1, "volume_solves": 0}, "new": {"steps": 1}}
    assert skipped_work.in_words(work).startswith("Nothing was left out")
    assert "fem: no history was carried." in skipped_work.in_words(work | {"fem": {"history_updates": 0}})


def test_what_was_left_out_comes_from_the_counters():
    lazy = made_up("fem", [1e-1], [1.0], closure_evaluations=0, volume_solves=0, history_updates=7)
    assert left_out([lazy]) == [
        "fem: no closure was evaluated; no solution in the volume within the time loop."
    ]
    assert left_out([made_up("bem", [1e-1], [1.0], closure_evaluations=3, volume_solves=0)]) == []
    assert left_out([made_up("bem", [None], [1.0])]) == []
