"""Plans of sweeps: what they vary, and what is refused in one line before anything runs."""

from __future__ import annotations

import numpy as np
import pytest

from contact_scene import SceneError
from validation.sweeps.plan import plan_from_dict, plan_names, read_plan
from validation.sweeps.samples import shares
from validation.sweeps.scene_table import put
from validation.sweeps.units import of_coordinate, of_measure

RATE = {"key": "loading.steps.0.rate", "values": [0.1, 0.2]}


def plan(*coordinates, folder, **more):
    return plan_from_dict({"scene": "retraction-fast", "coordinates": list(coordinates)} | more, folder)


def test_a_path_changes_one_key_and_shares_the_rest():
    table = {"a": [{"b": 1, "c": [2]}], "d": {"e": 3}}
    changed = put(table, "a[0].b", 7)
    assert changed == {"a": [{"b": 7, "c": [2]}], "d": {"e": 3}}
    assert table["a"][0]["b"] == 1
    assert changed["d"] is table["d"]
    assert put(table, "f.g", 1)["f"] == {"g": 1}  # the reader of scenes knows which tables there may be


def test_a_grid_ties_keys_together(tmp_path):
    zone = {"name": "zone", "key": "adhesion.zone", "linspace": [0.01, 0.02, 3]}
    depth = {"keys": ["loading.penetration", "loading.steps.0.to"], "factors": [1.0, -2.0], "values": [0.01]}
    grid = plan(RATE, zone, depth, folder=tmp_path)
    scenes = [grid.scene(rows) for rows in grid.rows()]
    assert grid.shape == (2, 3, 1)
    assert [scene.loading.steps[0].rate for scene in scenes] == [0.1] * 3 + [0.2] * 3
    assert [scene.adhesion.zone for scene in scenes] == [0.01, 0.015, 0.02] * 2
    assert {(s.loading.penetration, s.loading.steps[0].to) for s in scenes} == {(0.01, -0.02)}
    each = {"keys": ["adhesion.work", "adhesion.zone"], "values": [[4e-4, 0.01], [5e-4, 0.02]]}
    points = plan(RATE, each, folder=tmp_path, design="points")
    scenes = map(points.scene, points.rows())
    found = [(scene.loading.steps[0].rate, scene.adhesion.work, scene.adhesion.zone) for scene in scenes]
    assert found == [(0.1, 4e-4, 0.01), (0.2, 5e-4, 0.02)]


def test_a_sample_covers_its_ranges_and_a_longer_one_begins_with_a_shorter_one(tmp_path):
    speed = {"key": "loading.steps.0.rate", "range": [1e-4, 1e4], "scale": "log"}
    depth = {"key": "loading.penetration", "range": [0.0, 0.1]}
    for design in ("sobol", "latin-hypercube"):
        sample = plan(speed, depth, folder=tmp_path, design=design, points=100, seed=3)
        rates, depths = np.array([[row[0] for row in rows] for rows in sample.rows()]).T
        assert 45 <= np.sum(rates < 1.0) <= 55
        assert 45 <= np.sum(depths < 0.05) <= 55
        assert rates.min() > 1e-4
        assert depths.max() < 0.1
    assert np.array_equal(shares("sobol", 3, 70, 1)[:50], shares("sobol", 3, 50, 1))
    assert not np.array_equal(shares("sobol", 3, 50, 2), shares("sobol", 3, 50, 1))


@pytest.mark.parametrize(
    ("coordinate", "more", "problem"),
    [
        ({"key": "adhesion.wrok", "values": [1.0]}, {}, "adhesion.wrok at adhesion.wrok = 1.0: unknown key"),
        ({"key": "loading.steps.3.rate", "values": [1.0]}, {}, "no entry '3'; allowed: an index from 0 to 0"),
        ({"key": "adhesion.work.x", "values": [1.0]}, {}, "has no keys"),
        ({"key": "adhesion.zone", "values": [0.1, -1.0]}, {}, "at adhesion.zone = -1.0: got -1.0"),
        ({"key": "adhesion.zone", "values": []}, {}, "coordinates[0].values: got []"),
        ({"key": "adhesion.zone", "linspace": [1.0, 1.0, 4]}, {}, "linspace: an empty range"),
        ({"key": "adhesion.zone", "geomspace": [0.0, 1.0, 4]}, {}, "geomspace[0]: got 0.0"),
        ({"key": "adhesion.zone", "linspace": [0.1, 1.0, 0]}, {}, "linspace[2]: got 0"),
        ({"key": "adhesion.zone"}, {}, "no values"),
        ({"key": "adhesion.zone", "valeus": [1.0]}, {}, "coordinates[0].valeus: unknown key"),
        ({"keys": ["adhesion.zone", "adhesion.work"], "values": [[1.0]]}, {}, "lists of 2, a value a key"),
        ({"key": "adhesion.zone", "values": [1.0, "a"]}, {}, "values: got [1.0, 'a']"),
        ({"name": "run", "key": "adhesion.zone", "values": [1.0]}, {}, "name: got 'run'"),
        ({"key": "adhesion.zone", "range": [0.2, 0.1]}, {"design": "sobol", "points": 2}, "empty range"),
        ({"key": "adhesion.zone", "range": [0.1, 0.2]}, {"design": "sobol"}, "points: got 0"),
        (RATE, {"points": 3}, "points: given with design"),
        (RATE, {"design": "random"}, "design: got 'random'"),
        (RATE, {"solver": "nobody"}, "solver: got 'nobody'"),
        (RATE, {"resolution": 2}, "resolution: got 2"),
        (RATE, {"measures": ["pull_of_force"]}, "measures: no measure 'pull_of_force'"),
        (RATE, {"traces": "csv"}, "traces: got 'csv'"),
        (RATE, {"units": {"mass": "kg"}}, "units.mass: unknown key"),
        (RATE, {"soler": "bem"}, "soler: unknown key"),
        (RATE, {"title": 3}, "title: got 3"),
        (RATE | {"name": "pull_off_force"}, {}, "has the name of a measure"),
        (RATE | {"name": "loop_energy_error"}, {}, "has the name of a measure"),
        (RATE | {"name": "warnings"}, {}, "name: got 'warnings'"),
        (RATE | {"name": "a\nb"}, {}, "name: got 'a\\nb'"),
        ({"key": "adhesion.zone", "linspace": [0.1, 1.0, 10**9]}, {}, "linspace[2]: got 1000000000 values"),
        ({"key": "adhesion.zone", "range": [0.1, 0.2]}, {"design": "sobol", "points": 10**9}, "at most 100"),
        ({"key": "adhesion.zone", "values": [0.01, float("nan")]}, {}, "must be finite, got nan"),
    ],
)  # fmt: skip
def test_a_bad_plan_is_refused(tmp_path, coordinate, more, problem):
    with pytest.raises(SceneError) as refusal:
        plan(coordinate, folder=tmp_path, **more).check()
    assert problem in str(refusal.value)
    assert "\n" not in str(refusal.value)


def test_coordinates_that_do_not_fit_are_refused(tmp_path):
    with pytest.raises(SceneError, match=r"the key loading\.steps\.0\.rate comes twice"):
        plan(RATE, RATE | {"name": "other"}, folder=tmp_path)
    with pytest.raises(SceneError, match=r"the key loading\.steps\.0\.rate comes twice"):
        plan(RATE, RATE | {"name": "other", "key": "loading.steps[0].rate"}, folder=tmp_path)
    many = [
        {"key": f"loading.{key}", "linspace": [0.1, 0.2, 10**5]} for key in ("penetration", "steps.0.rate")
    ]
    with pytest.raises(SceneError, match="make 10000000000 runs; allowed: at most 10000000"):
        plan(*many, folder=tmp_path)
    with pytest.raises(SceneError, match=r"got 2 of loading\.steps\.0\.rate, 1 of adhesion\.zone"):
        plan(RATE, {"key": "adhesion.zone", "values": [0.1]}, folder=tmp_path, design="points")


def test_a_plan_file_names_itself_in_a_refusal(tmp_path):
    file = tmp_path / "plan.toml"
    file.write_text('scene = "nowhere.toml"\n[[coordinates]]\nkey = "a"\nvalues = [1]\n')
    with pytest.raises(
        SceneError, match=r"plan\.toml: scene: 'nowhere\.toml' is no built-in scene and no file"
    ):
        read_plan(str(file))
    file.write_text("scene = ")
    with pytest.raises(SceneError, match="not a TOML file"):
        read_plan(str(file))
    with pytest.raises(SceneError, match="PLAN: 'speed-prelod' is no file and no built-in plan"):
        read_plan("speed-prelod")


def test_every_scene_of_the_built_in_plans_can_be_built():
    counts = {name: read_plan(name).count for name in plan_names()}
    assert counts["speed-preload"] == 1000
    assert counts["surrogate"] == 2000


def test_units_follow_the_key_and_the_measure(tmp_path):
    keys = {
        "loading.steps.0.rate": "mm time-1",
        "adhesion.work": "force mm-1",
        "material.branches.0.modulus": "force mm-2",
        "loading.penetration": "mm",
    }
    values = {key: [0.5, 0.6] for key in keys}
    grid = plan(*({"key": key, "values": v} for key, v in values.items()), folder=tmp_path)
    names = {"length": "mm"}
    assert [of_coordinate(c, grid.base, names) for c in grid.coordinates] == list(keys.values())
    assert of_measure("pull_off_force", names) == "force"
    assert of_measure("loop_energy", names) == "force mm"
    assert of_measure("counters.steps", names) == "1"
