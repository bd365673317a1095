"""Swings of the contact edge over few nodes of a mesh are told."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from support.synthetic_traces import trace

from contact_scene import Branch, Hold, Loading, Material, Oscillate, Ramp, Scene, Sphere
from contact_scene.scene import write_scene
from crosscontact.cli import main
from validation.cases import Case
from validation.measure.warnings import swing_warnings
from validation.runs.run import run
from validation.solvers import solver

CYCLES = 3
OSCILLATION = Oscillate(1e-3, 2.0 * math.pi / 20.0, 20.0 * CYCLES)
AMPLITUDE = 0.01
WAY = np.linspace(0.1, 0.2, 61)
SOFT = Scene(
    Material(1e6, 0.5, (Branch(3e6, 0.1),)),
    Sphere(1e-3),
    Loading("relaxed", 2e-5, (Oscillate(1.5e-7, 10.0, 1.2),)),
)


def swinging(radius_swing: float = AMPLITUDE, depth_swing: float = 1e-3):
    """A run of as many cycles with 20 rows each."""
    wave = np.sin(2.0 * math.pi / 20.0 * np.arange(20 * CYCLES + 1))
    return trace(0.1 + depth_swing * wave, wave, 0.2 + radius_swing * wave)


@pytest.mark.parametrize(("spacing", "nodes"), [(0.0, ""), (2.0 * AMPLITUDE / 7.9, "7.9"), (1.0, "0.02")])
def test_the_swing_is_told_in_nodes(spacing, nodes):
    found = swing_warnings(swinging(), Loading("relaxed", 0.1, (OSCILLATION,)), spacing)
    assert [f"over {nodes} nodes" in text for text in found] == [True] * bool(nodes)


def test_a_wide_swing_is_none_of_few_nodes():
    assert swing_warnings(swinging(), Loading("relaxed", 0.1, (OSCILLATION,)), 2.0 * AMPLITUDE / 8.1) == ()


def test_the_smallest_swing_counts():
    """Of cycles that grow, the first."""
    grown = np.linspace(0.1, 1.0, 20 * CYCLES + 1)
    wave = np.sin(2.0 * math.pi / 20.0 * np.arange(20 * CYCLES + 1))
    run = trace(0.1 + 1e-3 * wave, wave, 0.2 + AMPLITUDE * grown * wave)
    (text,) = swing_warnings(run, Loading("relaxed", 0.1, (OSCILLATION,)), AMPLITUDE / 4.0)
    assert text.startswith("from t = 0 to 20 ")


@pytest.mark.parametrize(
    ("step", "made"),
    [
        pytest.param(Hold(60.0), swinging(depth_swing=0.0), id="rounding in a hold"),
        pytest.param(Ramp(0.2, 0.1 / 60.0), trace(WAY, WAY, 0.1 + WAY), id="a way"),
        pytest.param(OSCILLATION, swinging(radius_swing=0.0), id="an edge that stays"),
    ],
)
def test_what_does_not_go_to_and_fro_is_none(step, made):
    assert swing_warnings(made, Loading("relaxed", 0.1, (step,)), 1.0) == ()


@pytest.mark.parametrize(("name", "warned"), [("bem", False), ("fem", True), ("reference", False)])
def test_solvers_that_know_the_edge_everywhere_do_not_warn(name, warned):
    found = run(Case("swing", SOFT), name)
    assert any("to and fro" in text for text in found.warnings) is warned
    assert found.trace is not None


@pytest.mark.slow
def test_an_elastic_solid_and_a_finer_mesh_are_not_in_doubt():
    elastic = replace(SOFT, material=Material(1e6, 0.5))
    assert run(Case("swing", elastic), "fem").warnings == ()
    fem = solver("fem")
    assert fem.edge_spacing(elastic) == 0.0
    assert fem.edge_spacing(SOFT, 8) == pytest.approx(0.5 * fem.edge_spacing(SOFT))
    assert run(Case("swing", SOFT), "fem", 8).warnings == ()


def test_the_spacing_is_that_of_the_nodes_on_the_surface():
    elements = solver("fem").mesh(SOFT, None).parameters.fine_size
    assert solver("fem").edge_spacing(SOFT) == pytest.approx(0.5 * elements, rel=0.02)


def test_solve_says_it_once(capsys, tmp_path):
    scene = tmp_path / "swing.toml"
    write_scene(SOFT, scene)
    assert main(["solve", str(scene), "--solver", "fem"]) == 0
    assert capsys.readouterr().err.count("to and fro") == 1
