"""Figures of sweeps: curves of one coordinate, a map of two, small multiples of more, points of a sample."""

from __future__ import annotations

import numpy as np
import pytest
import xarray

from validation.sweeps.figures import MOST_PANELS, figures


def dataset(*sizes: int, hole: bool = False) -> xarray.Dataset:
    names = ("speed", "preload", "zone", "work")[: len(sizes)]
    force = np.sqrt(np.add.outer(1.0, np.arange(float(np.prod(sizes))))).reshape(sizes)
    if hole:
        force.flat[0] = np.nan
    log = {"units": "length time-1", "long_name": "speed V", "scale": "log"}
    coordinates = {
        name: ((name,), np.geomspace(1e-3, 10.0, size), log if name == "speed" else {"units": "length"})
        for name, size in zip(names, sizes, strict=True)
    }
    variables = {"pull_off_force": (names, force, {"units": "force", "long_name": "pull off force"})}
    return xarray.Dataset(
        variables, coordinates, {"title": "A sweep", "drawn": "pull_off_force, loop_energy"}
    )


def drawn(data):
    (figure,) = figures(data).values()
    return [axes for axes in figure.axes if axes.get_label() != "<colorbar>"]


def test_one_coordinate_gives_a_curve():
    (axes,) = drawn(dataset(5))
    assert axes.get_xlabel() == "speed V (length time⁻¹)"
    assert axes.get_ylabel() == "pull off force (force)"
    assert axes.get_xscale() == "log"
    (line,) = axes.lines
    assert line.get_linestyle() == "-"
    assert line.get_ydata().tolist() == pytest.approx(np.sqrt(np.arange(1.0, 6.0)).tolist())
    (axes,) = drawn(dataset(1))
    assert axes.lines[0].get_ydata().tolist() == [1.0]


@pytest.mark.parametrize("hole", [False, True])
def test_words_are_drawn_side_by_side_and_no_line_joins_them(hole):
    data = dataset(3, 2, hole=hole).assign_coords(speed=["jump-in", "relaxed", "snap-in"], preload=["b", "a"])
    (axes,) = drawn(data)
    assert [text.get_text() for text in axes.get_xticklabels()] == ["jump-in", "relaxed", "snap-in"]
    assert [line.get_linestyle() for line in axes.lines] == ["None", "None"]
    assert [line.get_label() for line in axes.lines] == ["preload = a", "preload = b"]
    assert len({(line.get_color(), line.get_marker()) for line in axes.lines}) == 2
    assert np.isfinite(axes.lines[1].get_ydata()).tolist() == [not hole, True, True]


def test_two_coordinates_give_a_map_with_contours_and_holes_are_said(recwarn):
    (axes,) = drawn(dataset(5, 4).isel(speed=[2, 0, 1, 2, 4]))  # in any order, and one twice
    mesh, contours = axes.collections
    assert mesh.get_array().shape == (4, 4)
    assert len(contours.get_paths()) > 3
    assert (axes.get_xlabel(), axes.get_ylabel()) == ("speed V (length time⁻¹)", "preload (length)")
    assert not [text for text in axes.texts if "no value" in text.get_text()]
    (axes,) = drawn(dataset(5, 4, hole=True))
    assert np.ma.count_masked(axes.collections[0].get_array()) == 1
    assert [text for text in axes.texts if "no value" in text.get_text()]
    assert not recwarn.list


def test_more_coordinates_give_small_multiples():
    panels = drawn(dataset(5, 4, 3))
    assert [axes.get_title() for axes in panels] == ["zone = 0.001", "zone = 0.1", "zone = 10"]
    assert len({axes.collections[0].get_clim() for axes in panels}) == 1


@pytest.mark.slow
def test_of_many_values_some_are_drawn():
    assert len(drawn(dataset(5, 4, 4, 5))) == MOST_PANELS  # of sixteen


def test_a_sample_is_drawn_over_each_coordinate():
    points = dataset(6).rename_dims(speed="run").reset_index("speed")
    panels = drawn(points.assign_coords(zone=("run", np.arange(6.0))))
    assert [axes.get_xlabel() for axes in panels] == ["speed V (length time⁻¹)", "zone"]
    assert [len(axes.collections[0].get_offsets()) for axes in panels] == [6, 6]


def test_a_measure_without_a_value_is_not_drawn():
    data = dataset(3)
    data["pull_off_force"][:] = np.nan
    assert figures(data) == {}
