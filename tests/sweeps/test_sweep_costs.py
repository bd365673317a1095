"""The plan by which the cost of sweeps is measured: runs that differ and share nothing with another plan."""

from __future__ import annotations

from validation.sweeps.benchmark import plan_of


def test_every_run_is_another_scene(tmp_path):
    plan, other = plan_of(5, tmp_path), plan_of(5, tmp_path, first=3.0)
    radii = [plan.scene(rows).indenter.radius for rows in plan.rows()]
    assert len(set(radii)) == plan.count == 5
    assert not set(radii) & {other.scene(rows).indenter.radius for rows in other.rows()}
