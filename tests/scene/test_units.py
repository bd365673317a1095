"""Units: labels in headers of files and in scenes; nothing is converted, and what cannot be is refused."""

from __future__ import annotations

import dataclasses
import re
import tomllib

import pytest
from support.scene_text import GOOD

import crosscontact as cc
from contact_scene.tables import read_pairs
from contact_scene.value_checks import finite
from validation.measure.scaling import unit_name

MATERIAL = {"modulus": 1.0, "poisson": 0.3}
LOADING = {"start": "relaxed", "penetration": 0.01}
RISING = "".join(f"{k},{k}\n" for k in range(30))
MODULI = "".join(f"{k},{1.0 + 1.0 / k}\n" for k in range(1, 9))
DYNAMIC = "".join(f"{k},{k},{k}\n" for k in range(1, 9))


def scene(folder, **tables):
    given = {"material": MATERIAL, "indenter": {"shape": "sphere", "radius": 1.0}, "loading": LOADING}
    return cc.scene_from_dict(given | tables, folder)


def profile(folder):
    return scene(folder, indenter={"shape": "profile", "file": "x.csv"}).indenter


def table(quantity):
    def read(folder):
        step = {"kind": "table", "file": "x.csv", "quantity": quantity}
        return scene(folder, loading=LOADING | {"steps": [step]}).loading.steps

    return read


def rate(folder):
    law = {"work": 0.5, "zone": 1e-3, "rate": {"file": "x.csv"}}
    return scene(folder, adhesion=law).adhesion


def material(form):
    def read(folder):
        return cc.read_material(folder / "x.csv", modulus=1.0, format=form)

    return read


def shift(folder):
    return cc.read_shift_factors(folder / "x.csv")


def measured(folder):
    return cc.read_measured(folder / "x.csv")


def curve(folder):
    return cc.read_curves(folder / "x.csv")


RATES = "1,1\n2,2\n"
THREE = "".join(f"{k},{k},{k}\n" for k in range(30))
PYVISCO = "1,0.01,0.5,2,1\n"

TAKEN = [
    (profile, "radius [mm],height [mm]", RISING),
    (profile, "r (µm), h (um)", RISING),
    (profile, "# height\n# radius [mm], height [mm]\n# made in 3 [s], by 2 [N]", RISING),
    (rate, "speed [m/s],work [J/m^2]", RATES),
    (shift, "T [°C],a_T [-]", RATES),
    (measured, "f [Hz],E' [MPa],E'' [MPa]", DYNAMIC),
    (material("branches"), "tau,E\ns,Pa", MODULI),
    (material("pyvisco"), "i,tau_i,alpha_i,E_0,E_i\n-,s,-,MPa,MPa", PYVISCO),
    (curve, "time (t),penetration (d),force (F)", THREE),
]


@pytest.mark.parametrize(("read", "header", "rows"), TAKEN)
def test_plain_names_and_units_that_can_be_the_scenes_are_taken(tmp_path, read, header, rows):
    (tmp_path / "x.csv").write_text(f"{header}\n{rows}")
    assert read(tmp_path)


def of_pairs(path):
    return read_pairs(path, ("time", "penetration"), (finite, finite), ("force",))


def of_branches(path):
    branches = cc.read_material(path, modulus=1.0, format="branches").branches
    return [branch.time for branch in branches], [branch.modulus for branch in branches]


def of_moduli(path):
    data = cc.read_measured(path)
    return data.times, data.moduli


HEADS = ["{0}\n{1}\n", "# {0}\n", "\ufeff# of a rig\n\n{0}\n", "a rig of ours: name\n// {0}\n// {1}\n"]


@pytest.mark.parametrize(
    ("end", "remark"),  # rows without remarks are read at once, those with one by one
    [("\n", ""), ("\r\n", "% a remark, of 3 words\n"), ("\r", "")],
)
@pytest.mark.parametrize("sign", [",", ";", "\t", " "])
@pytest.mark.parametrize("head", HEADS)
@pytest.mark.parametrize(
    ("read", "names", "units"),
    [
        (of_pairs, ("time", "penetration"), ("s", "mm")),
        (of_branches, ("tau", "E"), ("s", "MPa")),
        (of_moduli, ("t", "E"), ("s", "MPa")),
    ],
)
def test_a_table_is_read_the_same_in_any_signs_ends_of_lines_and_heads(
    tmp_path, read, names, units, head, sign, end, remark
):
    first, second = (0.5, 1.0, 2.0, 4.0), (8.0, 4.0, 2.5, 1.25)
    rows = [sign.join(map(repr, row)) + "\n" for row in zip(first, second, strict=True)]
    text = head.format(sign.join(names), sign.join(units)) + remark.join(rows)
    (tmp_path / "x.csv").write_bytes(text.replace("\n", end).encode())
    assert tuple(map(tuple, read(tmp_path / "x.csv"))) == (first, second)


@pytest.mark.parametrize("text", ["(", "a[", "="])
def test_the_time_for_a_line_grows_with_its_length_only(tmp_path, text):
    """With its square this test would not end, nor would the reading of 10 MB that a scene names."""
    (tmp_path / "x.csv").write_text(f"{300_000 * text}b c d\n0 0 0\n")
    for read in (of_pairs, of_moduli):
        with pytest.raises(cc.SceneError):
            read(tmp_path / "x.csv")


# Units that a scene states

STATED = {"length": "um", "force": "nN", "time": "s"}


def test_figures_and_tables_name_the_units_of_a_scene(tmp_path):
    """Labels alone: the same numbers, in the scene's units instead of dimensionless ones."""
    table = tomllib.loads(GOOD)
    plain, named = cc.scene_from_dict(table), cc.scene_from_dict(table | {"units": STATED})
    cc.write_scene(named, tmp_path / "scene.toml")
    assert cc.read_scene(tmp_path / "scene.toml") == named
    assert named.units == cc.Units("um", "nN", "s")
    one, other = cc.solve(plain, "bem", 4), cc.solve(named, "bem", 4)
    assert one.measures["pull_off_force"] == other.measures["pull_off_force"]
    axes = [(panel.get_xlabel(), panel.get_ylabel()) for panel in other.figure().axes]
    assert axes[0] == ("time t", "force F (nN)")
    assert axes[1:] == [("penetration Δ (um)", "force F (nN)"), ("force F (nN)", "contact radius a (um)")]
    drawn = other.figure().axes[1].lines[0].get_xdata()
    assert max(drawn) == pytest.approx(other.trace.penetration.max())
    assert "in um, nN, s" in repr(other)
    assert "in scene units" in repr(one)
    assert other.to_xarray()["stored_energy"].attrs["units"] == "nN um"
    assert one.to_xarray()["force"].attrs["units"] == "force in scene units"


def test_axes_in_units_of_the_si_have_prefixes():
    si = cc.builtin("cycle-si")
    result = cc.solve(dataclasses.replace(si, units=cc.Units("m", "N", "s")), resolution=4)
    figure = result.figure()
    result.plot(figure.axes[1:])  # a second run in the same axes
    figure.draw_without_rendering()
    (depth, force), (across, up) = ((panel.xaxis, panel.yaxis) for panel in figure.axes[1:])
    assert [axis.get_label_text() for axis in (depth, up)] == ["penetration Δ", "contact radius a"]
    for axis, unit in ((depth, "m"), (force, "N"), (across, "N"), (up, "m")):
        numbers = [text.get_text() for text in axis.get_ticklabels()]
        assert all(re.fullmatch(rf"−?\d+(\.\d+)? [fpnµm]?{unit}", number) for number in numbers), numbers


def test_units_that_are_not_stated_stay_those_of_the_scene():
    some = cc.scene_from_dict(tomllib.loads(GOOD) | {"units": {"length": "um"}})
    assert [unit_name(some, name) for name in ("penetration", "force")] == ["um", "scene units"]
    with pytest.raises(cc.SceneError, match=r"^units\.mass: unknown key; allowed: length, force, time"):
        cc.scene_from_dict(tomllib.loads(GOOD) | {"units": {"mass": "kg"}})
    for wrong in ("$x$", "a\nb", 17 * "m", 3):
        with pytest.raises(cc.SceneError, match=r"^units\.force: got .*; allowed: "):
            cc.scene_from_dict(tomllib.loads(GOOD) | {"units": {"force": wrong}})
