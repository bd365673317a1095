"""Poisson's ratio that depends on time: the modulus the surface feels, and what a constant ratio costs."""

import json
from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose

from contact_scene import Branch, BulkRelaxation, Counters, Material, Outcome, OutcomeKind, Trace
from crosscontact.cli import main
from validation import cases
from validation.measure.norms import CURVES
from validation.measure.scalars import measure
from validation.runs import pool
from validation.runs.run import Run, run
from validation.studies import poisson, poisson_material

GLASSY = 9.0  # G(0)/G(infinity) - 1
RUBBER = Material(3.0, 0.45, (Branch(5.0, 0.2), Branch(7.0, 3.0)))
BULKS = {
    "elastic": "elastic",
    "stiff": BulkRelaxation(300.0),
    "relaxing": BulkRelaxation(8.0, (Branch(4.0, 0.1), Branch(3.0, 3.0))),
}


def carson(modulus, branches, s):
    """``s`` times the Laplace transform of a relaxation modulus."""
    return modulus + sum(b.modulus * s * b.time / (1.0 + s * b.time) for b in branches)


def moduli(material, s):
    """Shear and bulk modulus at ``s``, from the definition of the scene file."""
    shear = carson(material.modulus, material.branches, s) / (2.0 * (1.0 + material.poisson))
    implied = material.modulus / (3.0 * (1.0 - 2.0 * material.poisson))
    if material.bulk == "elastic":
        return shear, implied
    return shear, carson(material.bulk.modulus or implied, material.bulk.branches, s)


@pytest.mark.parametrize("bulk", BULKS.values(), ids=BULKS)
def test_moduli_are_those_of_the_correspondence_principle(bulk):
    material = replace(RUBBER, bulk=bulk)
    s = np.geomspace(1e-4, 1e4, 17)
    g, k = moduli(material, s)
    surface = poisson_material.on_the_surface(material)
    felt = carson(surface.modulus, surface.branches, s) / (1.0 - surface.poisson**2)
    assert_allclose(felt, 4.0 * g * (3.0 * k + g) / (3.0 * k + 4.0 * g), rtol=1e-12)
    pulled = poisson_material.tension(material)
    assert_allclose(carson(pulled.modulus, pulled.branches, s), 9.0 * k * g / (3.0 * k + g), rtol=1e-12)
    ratio = (3.0 * k - 2.0 * g) / (2.0 * (3.0 * k + g))
    glassy, relaxed = poisson_material.poisson_range(material)
    assert_allclose(np.broadcast_to(ratio, s.shape)[[-1, 0]], [glassy, relaxed], atol=1e-3)
    assert_allclose(surface.poisson, relaxed)


def test_bulk_that_relaxes_like_shear_changes_nothing():
    factor = 1.0 / (3.0 * (1.0 - 2.0 * 0.45))
    scaled = tuple(Branch(factor * b.modulus, b.time) for b in RUBBER.branches)
    alike = replace(RUBBER, bulk=BulkRelaxation(None, scaled))
    assert_allclose(poisson_material.poisson_range(alike), 0.45)
    for made in (poisson_material.on_the_surface(alike), poisson_material.tension(alike)):
        assert_allclose(made.modulus, RUBBER.modulus, rtol=1e-12)
        found = [(b.modulus, b.time) for b in made.branches if b.modulus > 1e-9]
        assert_allclose(found, [(b.modulus, b.time) for b in RUBBER.branches], rtol=1e-9)


def test_all_assumptions_have_the_same_shear_and_what_they_say():
    separate = poisson_material.with_bulk(RUBBER, 40.0)
    shear = poisson_material.shear_of(RUBBER)
    assert_allclose(poisson_material.shear_of(separate).modulus, shear.modulus)
    assert_allclose(moduli(separate, 1e-9)[1], 40.0 * shear.modulus)
    assert poisson_material.constant(separate).bulk is None
    soft = poisson_material.incompressible(separate)
    assert soft.poisson == 0.5
    assert_allclose(soft.glassy_modulus, 3.0 * shear.glassy_modulus)
    with pytest.raises(ValueError, match="alike"):
        poisson_material.on_the_surface(RUBBER)


def answered(case, solver, resolution=None, progress=None, estimate=False, max_steps=None, **others):
    """A run as stiff as its material is at first; compressible ones know the modulus of the surface."""
    material = case.scene.material
    if material.bulk is not None:
        material = poisson_material.on_the_surface(material)
    steps = np.arange(3.0)
    force = material.glassy_plane_modulus * np.array([0.0, 2.0, -1.0])
    radius = np.array([1.0, 2.0, 0.5])
    trace = Trace(
        solver, steps, 1.0 - (steps - 1.0) ** 2, force, radius, *3 * [0.0 * steps],
        Outcome(OutcomeKind.DETACHED, "done", 2.0), Counters(),
    )  # fmt: skip
    errors = dict.fromkeys((*poisson.OBSERVED, *CURVES), 1e-6)
    return Run(case.name, solver, trace, measures=measure(trace, case.scene, 0.0), errors=errors)


def careless(case, solver, resolution=None, progress=None, estimate=False, max_steps=None, **others):
    """Finite elements that overlook the bulk modulus."""
    material = case.scene.material
    wrong = poisson_material.incompressible(material) if solver == "fem" else material
    return answered(replace(case, scene=replace(case.scene, material=wrong)), solver)


def test_command_prints_a_table_and_leaves_every_number(monkeypatch, capsys, tmp_path):
    monkeypatch.setattr(pool, "run", answered)
    assert main(["study", "cycle-v0.02", "--poisson", "100", "--jobs", "1", "--out", str(tmp_path)]) == 0
    printed = capsys.readouterr().out
    assert "pull off force" in printed
    assert "+0.0e+00" in printed
    kept = json.loads((tmp_path / "poisson-cycle-v0.02.json").read_text("utf-8"))
    (only,) = kept["compressibilities"]
    assert only["bulk_to_shear"] == 100.0
    assert set(only["runs"]) == {"full", "surface", *poisson.ASSUMPTIONS}
    cost = {name: run["differences"]["pull_off_force"] for name, run in only["runs"].items()}
    assert cost["full"] == 0.0
    assert_allclose(cost["shear"], GLASSY / 100.0, rtol=0.1)
    assert_allclose(cost["tension"], GLASSY / 150.0, rtol=0.1)
    assert_allclose(cost["incompressible"], (GLASSY + 1.0) / 100.0, rtol=0.12)
    assert (tmp_path / "poisson-cycle-v0.02.md").read_text("utf-8").count("| 100 |") == 6


def test_disagreement_and_failure_are_exit_code_1(monkeypatch, capsys):
    monkeypatch.setattr(pool, "run", careless)
    assert main(["study", "cycle-v0.02", "--jobs", "1", "--poisson", "10"]) == 1
    said = capsys.readouterr().err
    assert "failed: cycle-v0.02: K/G = 10: approach_force: beyond the error estimates" in said
    assert "radius: beyond" not in said
    monkeypatch.setattr(pool, "run", lambda of, solver, *rest, **named: Run("x", solver, failure="no"))
    assert main(["study", "cycle-v0.02", "--jobs", "1", "--poisson"]) == 1
    assert capsys.readouterr().err.count("full: failed: no") == len(poisson.RATIOS)


@pytest.mark.parametrize("ratio", ["0.5", "nan", "soft", "1e7"])
def test_impossible_bulk_is_bad_input(ratio, capsys):
    with pytest.raises(SystemExit, match="2"):
        main(["study", "cycle-v0.02", "--poisson", ratio])
    assert "above 2/3" in capsys.readouterr().err


@pytest.mark.exhaustive
@pytest.mark.parametrize("ratio", [10.0, 100.0])
def test_finite_elements_with_elastic_bulk_meet_the_modulus_of_the_surface(ratio):
    """Two methods for nu(t): internal variables in the body, and a constant ratio with ``E*(t)``."""
    case = cases.load("cycle-v0.02")
    for one in poisson.compare_ratios(case, (ratio,), resolution=4):
        assert one.finished
        assert one.disagreements == []
        for name in (*poisson.OBSERVED, *CURVES):
            assert abs(one.difference(poisson.FULL, name).error) < 2e-4, name
        # a constant ratio takes the fast response too stiff, far beyond any error
        cost = {name: one.difference(name, "pull_off_force").error for name in poisson.ASSUMPTIONS}
        assert 0.0 < cost["tension"] < cost["shear"] < cost["incompressible"]
        assert cost["tension"] > 20.0 * one.difference(poisson.FULL, "pull_off_force").own
        assert 0.5 < cost["shear"] / (GLASSY / one.ratio) < 1.1


@pytest.mark.slow
def test_what_a_constant_ratio_costs_falls_like_the_compressibility():
    case = cases.load("cycle-v0.02")
    for ratio in (300.0, 1000.0):
        asked = poisson.ratio_runs(case, ratio)
        done = {name: run(*task, resolution=6) for name, task in asked.items() if task[1] != "fem"}
        one = poisson.CompressibilityComparison(ratio, 0.0, 0.0, done)
        first = GLASSY / ratio
        assert_allclose(one.difference("shear", "pull_off_force").error, first, rtol=0.1)
        assert_allclose(one.difference("tension", "pull_off_force").error, first * 2.0 / 3.0, rtol=0.15)
        assert abs(one.difference("shear", "approach_radius").error) < 0.1 * first
