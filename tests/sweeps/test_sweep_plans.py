"""Plans of sweeps: what they vary, and what is refused in one line before anything runs."""

from __future__ import annotations

import copy
import tomllib

import numpy as np
import pytest
from support.scene_text import GOOD
from support.wrong_values import WRONG, refusal

from contact_scene import SceneError, Units
from contact_scene.checked import fields_of
from contact_scene.scene import value_at
from validation.sweeps.dataset import dimension_of
from validation.sweeps.plan import (
    Coordinate,
    SceneTable,
    SweepPlan,
    plan_from_dict,
    plan_names,
    read_plan,
    sample,
)

RATE = {"key": "loading.steps.0.rate", "values": [0.1, 0.2]}


def plan(*coordinates, folder, **more):
    return plan_from_dict({"scene": "retraction-fast", "coordinates": list(coordinates)} | more, folder)


def test_a_grid_ties_keys_together(tmp_path):
    zone = {"name": "zone", "key": "adhesion.zone", "linspace": [0.01, 0.02, 3]}
    depth = {"keys": ["loading.penetration", "loading.steps.0.to"], "factors": [1.0, -2.0], "values": [0.01]}
    grid = plan(RATE, zone, depth, folder=tmp_path)
    scenes = [grid.scene_of(rows) for rows in grid.rows()]
    assert grid.shape == (2, 3, 1)
    assert [scene.loading.steps[0].rate for scene in scenes] == [0.1] * 3 + [0.2] * 3
    assert [scene.adhesion.zone for scene in scenes] == [0.01, 0.015, 0.02] * 2
    assert {(s.loading.penetration, s.loading.steps[0].to) for s in scenes} == {(0.01, -0.02)}
    each = {"keys": ["adhesion.work", "adhesion.zone"], "values": [[4e-4, 0.01], [5e-4, 0.02]]}
    points = plan(RATE, each, folder=tmp_path, design="points")
    scenes = map(points.scene_of, points.rows())
    found = [(scene.loading.steps[0].rate, scene.adhesion.work, scene.adhesion.zone) for scene in scenes]
    assert found == [(0.1, 4e-4, 0.01), (0.2, 5e-4, 0.02)]


BAD_PARTS = {
    "material.modulus": ("material", {"modulus": -1.0, "poisson": 0.5}),
    "indenter.radius": ("indenter", {"shape": "sphere"}),
    "adhesion.work": ("adhesion", {"work": -1.0, "zone": 0.013}),
}
"""Parts that one value makes good, by the path of that value."""


@pytest.mark.parametrize("path", BAD_PARTS)
def test_a_bad_value_of_the_base_is_told_by_its_path_unless_another_takes_its_place(tmp_path, path):
    name, part = BAD_PARTS[path]
    table = SceneTable("base", tomllib.loads(GOOD) | {name: part}, tmp_path)
    assert refusal(table.with_values, {"title": "varied"}).key == path
    assert value_at(table.with_values({path: 0.01}), path) == 0.01


@pytest.mark.parametrize("name", ["material", "indenter", "adhesion", "loading"])
@pytest.mark.parametrize("part", [3, None])
def test_a_part_of_the_base_that_is_no_table_is_told_by_its_key(tmp_path, name, part):
    table = SceneTable("base", tomllib.loads(GOOD) | {name: part}, tmp_path)
    assert refusal(table.with_values, {}).key == name
    missing = {key: value for key, value in table.data.items() if key != name}
    if name != "adhesion":
        assert refusal(SceneTable("base", missing, tmp_path).with_values, {}).key == name


def test_what_nothing_varies_is_built_once(tmp_path):
    table = SceneTable("base", tomllib.loads(GOOD), tmp_path)
    one, other = (table.with_values({"loading.penetration": depth, "title": "x"}) for depth in (0.01, 0.02))
    assert one.material is other.material
    assert one.indenter is other.indenter
    assert one.title == ""


def test_a_sample_covers_its_ranges_and_a_longer_one_begins_with_a_shorter_one(tmp_path):
    speed = {"key": "loading.steps.0.rate", "range": [1e-4, 1e4], "scale": "log"}
    depth = {"key": "loading.penetration", "range": [0.0, 0.1]}
    for design in ("sobol", "latin-hypercube"):
        drawn = plan(speed, depth, folder=tmp_path, design=design, points=100, seed=3)
        rates, depths = np.array([[row[0] for row in rows] for rows in drawn.rows()]).T
        assert 45 <= np.sum(rates < 1.0) <= 55
        assert 45 <= np.sum(depths < 0.05) <= 55
        assert rates.min() > 1e-4
        assert depths.max() < 0.1
    assert np.array_equal(sample("sobol", 3, 70, 1)[:50], sample("sobol", 3, 50, 1))
    assert not np.array_equal(sample("sobol", 3, 50, 2), sample("sobol", 3, 50, 1))


ZONE = {"key": "adhesion.zone"}
RANGE = ZONE | {"range": [0.1, 0.2]}
COORDINATE = {"label": "a", "factors": [1.0], "name": "z", "unit": "m", "scale": "log"} | RANGE
PLAN = {"coordinates": [COORDINATE], "points": 4, "design": "sobol", "scene": "retraction-fast", "units": {}}
DECLARED = {"": SweepPlan, "units": Units, "coordinates[0]": Coordinate}


FITS = {
    "estimate": {"truth value"},
    "keys": {"texts"},
    "measures": {"empty array"},
    "drawn": {"empty array"},
    "units": {"mapping"},
    "values": {"array", "list", "texts"},
    "range": {"array", "list"},
} | {name: {"text"} for name in ("title", "key", "name", "label", "unit", "length", "force", "time")}
"""Values of the wrong ones that a field may have after all."""


def in_a_plan(place, name, value):
    """A plan in one of whose tables a key has a value."""
    table = copy.deepcopy(PLAN)
    of = {"": table, "units": table["units"], "coordinates[0]": table["coordinates"][0]}[place]
    if name in ("values", "linspace", "geomspace"):  # of a grid
        del of["range"], of["scale"], table["points"], table["design"]
    if name == "keys":
        del of["key"]
    of[name] = value
    return table


@pytest.mark.parametrize(
    ("place", "name"), [(place, name) for place, kind in DECLARED.items() for name in fields_of(kind)]
)
def test_what_a_field_of_a_plan_cannot_be_is_one_line_with_its_key(tmp_path, place, name):
    assert fields_of(DECLARED[place])[name].key.text
    for word, wrong in WRONG.items():
        if wrong is not None and word not in FITS.get(name, ()):
            error = refusal(plan_from_dict, in_a_plan(place, name, wrong), tmp_path)
            assert error.key.startswith(f"{place}.{name}".lstrip("."))


@pytest.mark.parametrize("place", DECLARED)
def test_an_unknown_key_is_refused_beside_those_there_are(tmp_path, place):
    error = refusal(plan_from_dict, in_a_plan(place, "valeus", 1.0), tmp_path)
    assert "valeus: unknown key" in str(error)
    assert error.allowed == ", ".join(fields_of(DECLARED[place]))


@pytest.mark.parametrize(
    ("coordinate", "more", "problem"),
    [
        ({"key": "adhesion.wrok", "values": [1.0]}, {}, "adhesion.wrok at adhesion.wrok = 1.0: unknown key"),
        ({"key": "loading.steps.3.rate", "values": [1.0]}, {}, "no entry '3'; allowed: an index from 0 to 0"),
        (ZONE | {"values": [0.1, -1.0]}, {}, "at adhesion.zone = -1.0: got -1.0"),
        (ZONE | {"values": []}, {}, "coordinates[0].values: got []"),
        (ZONE | {"linspace": [1.0, 1.0, 4]}, {}, "linspace: an empty range"),
        (ZONE | {"linspace": [0.1, 1.0, 10**9]}, {}, "linspace[2]: got 1000000000 values"),
        (ZONE | {"linspace": [0.1, 1.0]}, {}, "linspace: got [0.1, 1.0]; allowed: [first, last, count]"),
        (ZONE, {}, "no values"),
        (ZONE | {"values": [1.0], "linspace": [1.0, 2.0, 2]}, {}, "got values and linspace"),
        (RANGE, {}, "got range"),
        (RATE, {"design": "sobol", "points": 2}, "no range"),
        (RATE | {"scale": "log"}, {}, "scale: given without range"),
        (RATE | {"keys": ["adhesion.zone"]}, {}, "key: given beside keys"),
        (RATE | {"factors": [1.0, 2.0]}, {}, "factors: got [1.0, 2.0]; allowed: one number a key: 1"),
        ({"keys": ["adhesion.zone", "adhesion.work"], "values": [[1.0]]}, {}, "lists of 2, a value a key"),
        (RANGE | {"range": [-0.2, 0.1], "scale": "log"}, {"design": "sobol", "points": 2}, "range[0]: got"),
        (RANGE, {"design": "sobol"}, "points: is missing"),
        (RATE, {"points": 3}, "points: given with design"),
        (RATE, {"measures": ["pull_of_force"]}, "measures: no measure 'pull_of_force'"),
        (RATE | {"name": "run"}, {}, "name: got 'run'"),
        (RATE | {"name": "pull_off_force"}, {}, "has the name of a measure"),
    ],
)  # fmt: skip
def test_what_does_not_fit_together_is_refused_in_one_line(tmp_path, coordinate, more, problem):
    assert problem in str(refusal(lambda: plan(coordinate, folder=tmp_path, **more).check()))


@pytest.mark.parametrize(
    ("second", "more", "problem"),
    [
        (RATE | {"name": "other"}, {}, "the key loading.steps.0.rate comes twice"),
        (
            RATE | {"name": "a", "key": "loading.steps[0].rate"},
            {},
            "the key loading.steps.0.rate comes twice",
        ),
        (ZONE | {"linspace": [0.1, 0.2, 10**7]}, {}, "make 20000000 runs; allowed: at most 10000000"),
        (ZONE | {"values": [0.1]}, {"design": "points"}, "got 2 of loading.steps.0.rate, 1 of adhesion.zone"),
    ],
)
def test_coordinates_that_do_not_fit_each_other_are_refused(tmp_path, second, more, problem):
    assert problem in str(refusal(plan, RATE, second, folder=tmp_path, **more))


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
    units = Units(length="mm")
    assert [units.named(grid.scene.unit(c.paths[0])) for c in grid.coordinates] == list(keys.values())
    measures = {
        "pull_off_force": "force",
        "loop_energy": "force mm",
        "loss_fall": "force mm",
        "stage_at_detachment": "mm",
        "peak_cycle_frequency": "time-1",
        "counters.steps": "1",
    }
    assert {name: units.named(dimension_of(name)) for name in measures} == measures
