"""Peers, against the real packages: what each answers, and how it does in the exam."""

from __future__ import annotations

import numpy as np
import pytest
from support.exam_answers import hertz_run

from contact_scene import COLUMNS
from validation.cases import load
from validation.exam.answer import Answer
from validation.exam.grading import grade
from validation.exam.griffith_limit import tracks, zone_of
from validation.exam.header import Header
from validation.exam.judge import GradedAnswer
from validation.execution.runs import run
from validation.reference.jkr import JKR
from validation.solvers import PEERS


def peer(name: str):
    """The peer, if its package is installed."""
    method = PEERS[name]
    if not method.installed:
        pytest.skip(f"{method.distribution} is not installed: pip install 'crosscontact[peers]'")
    return method


def answer(name: str, scene: str, resolution: int) -> Answer:
    method = peer(name)
    found = run(load(scene), name, resolution)
    assert found.trace is not None, found.failure
    columns = {column: getattr(found.trace, column) for column in method.columns}
    header = Header(name, scene=scene, outcome="", transition=method.transition(resolution))
    return Answer(header, "x", columns)


@pytest.mark.parametrize("name", PEERS)
def test_each_declines_in_words_what_it_does_not_cover(name):
    method = peer(name)
    taken = {"tamaas": "adhesionless-force", "contact-mechanics": "elastic-press"}.get(
        name, "elastic-relaxed"
    )
    scenes = ("adhesionless-force", "elastic-press", "elastic-relaxed", "cycle-v0.02", "bulk-punch")
    refused = {scene for scene in scenes if method.refusal(load(scene).scene) is not None}
    assert refused == set(scenes) - {taken}
    assert f'"{name}" does not cover' in str(method.refusal(load("cycle-v0.02").scene))
    assert set(method.columns) <= set(COLUMNS)
    assert method.version


@pytest.mark.slow
def test_jkr_of_adhesion_is_ours():
    scene = load("elastic-relaxed").scene
    given = answer("adhesion-jkr", "elastic-relaxed", 400)
    ours = JKR(scene.indenter, scene.material.relaxed_plane_modulus, scene.adhesion.work)
    assert -given.columns["force"].min() == pytest.approx(1.5 * np.pi * scene.adhesion.work, rel=1e-4)
    assert given.columns["penetration"].min() == pytest.approx(
        ours.pull_off_penetration_control().penetration, rel=1e-4
    )


@pytest.mark.slow
def test_the_cohesive_ring_converges_to_the_griffith_limit():
    graded = [GradedAnswer(answer("maugis-dugdale", "elastic-relaxed", size), None) for size in (5, 10, 20)]
    track = tracks(graded, load("elastic-relaxed"))
    assert track is not None
    assert track.converges
    assert track.order == pytest.approx(1.0, abs=0.15)
    scene = load("elastic-relaxed").scene
    stated = scene.indenter.radius, scene.material.relaxed_plane_modulus, scene.adhesion.work
    assert [point.zone for point in track.points] == [zone_of(size, *stated) for size in (5, 10, 20)]


@pytest.mark.slow
def test_pixels_of_contact_mechanics_find_the_force_of_hertz():
    coarse = grade(answer("contact-mechanics", "elastic-press", 16), load("elastic-press").scene, hertz_run())
    assert coarse.error("approach_force") < 3e-3
    assert coarse.error("force, curve") < 1e-2
    assert 1e-3 < coarse.error("contact_radius, curve") < 0.1


@pytest.mark.slow
def test_tamaas_answers_under_force_control():
    """Its first step is that of the glassy body; later ones leave the closed form, as the exam tells."""
    given = answer("tamaas", "adhesionless-force", 48)
    time, force, radius = (given.columns[name] for name in ("time", "force", "contact_radius"))
    material = load("adhesionless-force").scene.material
    step = time[1]
    modulus = material.relaxed_plane_modulus + sum(
        branch.modulus / 0.75 / (1.0 + step / branch.time) for branch in material.branches
    )
    assert radius[1] == pytest.approx(np.cbrt(0.75 * force[1] / modulus), rel=0.05)
    assert np.all(np.diff(radius) >= 0.0)
    assert force[-1] == 0.01
