"""The line that tells how long a fit took."""

from __future__ import annotations

from types import SimpleNamespace

import pytest

from validation.fits.benchmark import LIMIT, FitTime

DIFFERENCES = [SimpleNamespace(root_mean_square=0.012), SimpleNamespace(root_mean_square=0.5)]


@pytest.mark.parametrize(("share", "verdict"), [(0.99, "(pass)"), (1.01, "(FAIL)")])
def test_the_time_of_a_fit_is_held_against_its_limit(share, verdict):
    result = SimpleNamespace(
        curves=(1, 2, 3), estimates=(1, 2), runs=7, check=SimpleNamespace(differences=DIFFERENCES)
    )
    told = FitTime(share * LIMIT, 2.0, result).text
    assert verdict in told
    assert "3 curves, 2 parameters, 7 runs" in told
    assert "noise: 0.012, 0.5" in told


def test_a_fit_without_a_check_says_so():
    result = SimpleNamespace(curves=(1,), estimates=(1,), runs=1, check=None)
    assert FitTime(1.0, 1.0, result).text.endswith("none")
