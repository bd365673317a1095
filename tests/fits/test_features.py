"""What a curve shows of itself: made of closed forms, and recorded by others who publish what they found."""

from __future__ import annotations

from functools import cache
from pathlib import Path

import numpy as np
import pytest
from support.unlaid_figures import without_layout

import crosscontact as cc
from crosscontact.cli import main
from validation.fits.features import common_wall

FILES = Path(__file__).parents[2] / "docs" / "data" / "curves"
RADIUS, HERTZ = 1e-5, 4.0 / 3.0 / 0.75 * np.sqrt(1e-5)
recorded = pytest.mark.usefixtures("extra_fit")


@pytest.fixture
def extra_fit():
    pytest.importorskip("afmformats", reason="the optional extra `fit` is not installed")


def approached(modulus, contact, begin, end, rows, noise, spring=None, more=0.0, seed=2):
    """A sphere pressed in at 1 um/s, with noise and more force of other origin."""
    stage, scatter = np.linspace(begin, end, rows), noise * np.random.default_rng(seed).normal(size=rows)
    depth = np.linspace(0.0, end - contact, 4000) if end > contact else np.zeros(1)
    bent = 0.0 if spring is None else HERTZ * modulus * depth**1.5 / spring
    force = HERTZ * modulus * np.interp(stage - contact, depth + bent, depth) ** 1.5 * (stage > contact)
    time = (stage - begin) / 1e-6
    if spring is None:
        return cc.MeasuredCurve(time, force + scatter + more, stage)
    return cc.MeasuredCurve(time, force + scatter + more, stage=stage, stiffness=spring)


@pytest.mark.parametrize("wave", [0.0, 1e-11, 8e-11])
def test_a_wave_on_the_baseline_moves_no_modulus(wave):
    more = wave * np.sin(2.0 * np.pi * np.linspace(-60e-6, -18e-6, 5000) / 9e-6) - 3e-10
    told = approached(5e3, -18.8e-6, -60e-6, -18e-6, 5000, 8e-12, more=more).features(RADIUS)
    assert told.modulus == pytest.approx(5e3, rel=1e-3)
    assert told.contact == pytest.approx(-18.8e-6, abs=1e-9)
    assert ("wave" in told.background) == (wave > 0.0)


def test_a_short_contact_behind_a_long_approach():
    more = 2e-10 * np.sin(2.0 * np.pi * np.linspace(-5e-6, 0.155e-6, 2000) / 3e-6)
    told = approached(1.2e4, 0.0, -5e-6, 0.155e-6, 2000, 1e-11, more=more, seed=1).features(RADIUS)
    assert told.modulus == pytest.approx(1.2e4, rel=0.01)
    assert told.depth == pytest.approx(155e-9, abs=3e-9)


def test_a_tilt_in_position_biases_nothing():
    """Of 10 % of the largest force over the record; on a spring about as soft as the contact."""
    plain = approached(1.4742e4, 4.78e-6, 0.0, 5e-6, 2000, 0.0, spring=0.0435)
    more = 0.1 * plain.force.max() * plain.stage / np.ptp(plain.stage)
    moduli = [
        approached(1.4742e4, 4.78e-6, 0.0, 5e-6, 2000, 17e-12, 0.0435, more, seed).features(RADIUS).modulus
        for seed in range(3)
    ]
    assert np.mean(moduli) == pytest.approx(1.4742e4, rel=5e-3)
    assert np.std(moduli) < 0.01 * 1.4742e4


def sticking(more):
    """DMT's contact on a spring, pulled off at 0.5 nN at once, with noise and more force of other origin: a
    function of stage, speed and the row of the loss."""
    spring, force0, rows = 0.05, 5e-10, 3000
    depth, stage = np.linspace(0.0, 2e-6, 8000), 3e-6 - 4e-6 * np.abs(np.linspace(-1.0, 1.0, 2 * rows))
    held = HERTZ * 5e3 * depth**1.5 - force0
    force = np.interp(stage, depth + held / spring, held, left=0.0)
    force[:rows][stage[:rows] < 0.0] = 0.0
    speed = np.where(np.arange(2 * rows) < rows, 1.0, -1.0) * 4e-6 / 3.0
    force += more(stage, speed, rows + int(np.argmax(force[rows:] == 0.0)))
    force += 5e-12 * np.random.default_rng(0).normal(size=2 * rows)
    curve = cc.MeasuredCurve(np.arange(2 * rows) * 1e-3, force, stage=stage, stiffness=spring)
    return curve.features(RADIUS)


def test_a_cycle_that_sticks_is_told_with_its_background():
    """Over level, tilt, and drag of either direction."""
    told = sticking(lambda stage, speed, lost: 2e-10 + 1e-5 * stage + 5e-5 * speed)
    assert told.pull_off == pytest.approx(-5e-10, rel=0.03)
    assert told.drop == pytest.approx(5e-10, rel=0.05)
    assert told.lost == pytest.approx(-1e-8, abs=5e-9)
    assert told.background["tilt"] == pytest.approx(1e-5, abs=1e-6)
    assert told.background["drag"] == pytest.approx(5e-5, abs=1e-6)
    assert told.rough == pytest.approx(5e-12, rel=0.1)


def test_a_tether_behind_the_loss_is_no_background():
    """Over sixty rows with a fifth of the pull-off force: taken for free ones they turned the tilt."""

    def tethered(stage, speed, lost):
        behind = np.arange(stage.size) - lost
        return 2e-10 + 1e-5 * stage - 1e-10 * ((behind >= 100) & (behind < 160))

    told = sticking(tethered)
    assert told.pull_off == pytest.approx(-5e-10, rel=0.02)
    assert told.background["tilt"] == pytest.approx(1e-5, abs=3e-6)


PUBLISHED = [  # file, radius, contact from the first row (um), its error, modulus (Pa), its error, loss (um)
    ("spot3.jpk-force", 1e-5, 4.7753, 0.002, 14742.0, 0.03, 4.624),
    ("flipsign.jpk-force", 1e-5, 49.698, 0.02, 9724.0, 0.05, None),
    ("force-save-example.jpk-force", 18.64e-6, 27.205, 0.02, 174.3, 0.05, None),
    ("polymergel.jpk-force", None, 28.364, 0.02, None, None, 23.61),
    ("brain.jpk-force", None, 17.15, 0.1, None, None, 3.52),
    ("silicon-nitride.ibw", None, 0.1887, 0.001, None, None, 0.1702),
    ("u3-3.ibw", None, 5.980, 0.01, None, None, 5.745),
    ("chiaro.zip", 27.5e-6, 73.25, 0.1, 117.0, 0.03, None),
]


@cache
def shown(file, *, radius=None, **stated):
    """What a recorded curve shows, and its first position."""
    curve = cc.read_curve(FILES / file, **stated)
    return curve.features(radius), curve.stage[0]


@recorded
@pytest.mark.parametrize(("file", "radius", "contact", "near", "modulus", "share", "lost"), PUBLISHED)
def test_what_recorded_curves_show(file, radius, contact, near, modulus, share, lost):
    """Of spot3 and Chiaro what their owners publish; the others by eye."""
    told, first = shown(file, radius=radius)
    assert 1e6 * (told.contact - first) == pytest.approx(contact, abs=near)
    if modulus is not None:
        assert told.modulus == pytest.approx(modulus, rel=share)
    if lost is not None:
        assert 1e6 * (told.lost - first) == pytest.approx(lost, abs=0.02)


@recorded
def test_the_radius_of_a_bead_is_that_of_its_drag_near_the_wall():
    told, _ = shown("force-save-example.jpk-force", radius=18.64e-6)
    assert told.background["wall/water"] == pytest.approx(1.0, abs=0.2)
    assert abs(told.pull_off) < 0.12e-9  # 0.19 nN with the drag
    without, _ = shown("force-save-example.jpk-force")
    assert "wall" not in without.background
    assert any("--radius" in text for text in without.warnings)


@recorded
@pytest.mark.parametrize(("file", "rough"), [("silicon-nitride.ibw", 14.6), ("polymergel.jpk-force", 6.06)])
def test_rows_beside_the_contact_are_not_taken_for_free(file, rough):
    """A spring rings behind the loss, a surface attracts: nine and two times as rough with them."""
    assert 1e12 * shown(file, radius=None)[0].rough == pytest.approx(rough, rel=0.02)


@recorded
def test_the_retraction_is_compared_with_rows_that_are_free_for_certain():
    """Three curves of one spot lose contact 102, 130 and 116 nm before they made it; 57 nm with all rows."""
    curves = [cc.read_curve(FILES / "four.jpk-qi-data", enum=number) for number in range(3)]
    told = [curve.features() for curve in curves]
    assert [1e9 * (one.contact - one.lost) for one in told] == pytest.approx([101.7, 130.4, 116.3], abs=5.0)


def walled(seed, noise):
    """An approach in water at 10 um/s of a bead of 10 um, with the drag near its wall."""
    plain = approached(300.0, 0.0, -8e-6, 1e-6, 3000, noise, spring=0.05, seed=seed)
    gap = np.clip(plain.force / 0.05 - plain.stage, 0.0, None)
    near = 6.0 * np.pi * 1e-3 * RADIUS**2 * 1e-5 / 3e-7
    force = plain.force + near / (1.0 + gap / 3e-7)
    return cc.MeasuredCurve(plain.time / 10.0, force, stage=plain.stage, stiffness=0.05)


def test_curves_of_a_map_have_one_drag_near_the_wall():
    """That of a quiet one, which a noisy one does not show by itself: its contact is 40 nm early."""
    quiet, noisy = walled(0, 1e-12), walled(3, 3e-11)
    alone = noisy.features(RADIUS)
    wall = common_wall([quiet.features(RADIUS), alone])
    assert "wall" not in alone.background
    together = noisy.features(RADIUS, wall=wall)
    assert together.background["wall"] == wall
    assert together.modulus == pytest.approx(300.0, rel=0.03)
    assert abs(together.contact) < 0.3 * abs(alone.contact)


def test_a_record_without_contact_shows_none():
    told = approached(5e3, 1.0, 0.0, 5e-6, 3000, 1e-11).features(RADIUS)
    assert (told.contact, told.pull_off, told.modulus) == (None, None, None)
    assert "no contact on the approach" in told.warnings


@pytest.mark.parametrize("seed", range(4))
def test_a_wave_alone_is_no_contact(seed):
    """A power law from its last rise on takes a part of it, which is no higher than what is left of it."""
    draw = np.random.default_rng(seed)
    angle = 2.0 * np.pi * np.linspace(0.0, 1.0, 1200) * draw.uniform(1.0, 8.0) + draw.uniform(0.0, 6.0)
    waved = approached(5e3, 1.0, 0.0, 3e-6, 1200, 1e-11, 0.05, 2e-11 * np.sin(angle), seed)
    assert waved.features().contact is None


@recorded
@pytest.mark.parametrize(
    ("file", "stated", "words"),
    [
        (
            "workshop-2020.csv",
            {"spring_constant": 0.1, "speed": 1e-6},
            "the spring bends 38.6 um over a stage of 3.38",
        ),
        ("ntmdt-gel.txt", {"spring_constant": 0.1, "sensitivity": 1e-7, "speed": 1e-6}, "3.3e-17 N in all"),
        ("chiaro.zip", {"radius": 27.5e-6}, "contact is not lost in the record"),
        ("brain.jpk-force", {"radius": None}, "of the rows are free behind the loss"),
        ("polymergel.jpk-force", {"radius": None}, "of a bead of 18 um: --radius"),
    ],
)
def test_what_is_doubtful_is_told(file, stated, words):
    assert any(words in text for text in shown(file, **stated)[0].warnings)


def test_both_signs_turned_are_told():
    good = approached(5e3, 4e-6, 0.0, 5e-6, 2000, 1e-11, spring=0.05)
    turned = cc.MeasuredCurve(good.time, -good.force, stage=-good.stage, stiffness=0.05)
    assert any("signs turned" in text for text in turned.features().warnings)


def test_the_command_prints_a_table_and_draws_each_curve(tmp_path, capsys):
    curve = approached(5e3, 4e-6, 0.0, 5e-6, 2000, 1e-11, spring=0.05)
    cc.write_curve(curve, tmp_path / "a.csv")
    with without_layout():
        assert (
            main(["curve", str(tmp_path / "a.csv"), "--radius", "1e-5", "--out", str(tmp_path / "out")]) == 0
        )
    said = capsys.readouterr().out
    assert "4 um from the first row" in said
    assert sorted(one.name for one in (tmp_path / "out").iterdir()) >= ["a.png", "a.svg", "features.csv"]
    head, row = (tmp_path / "out" / "features.csv").read_text().splitlines()
    found = dict(zip(head.split(","), row.split(","), strict=True))
    assert float(found["modulus [Pa]"]) == curve.features(1e-5).modulus
    assert main(["curve", str(tmp_path / "b.csv")]) == 2
