"""Reading and writing records, what a record shows of itself, its motion as straight lines."""

from __future__ import annotations

import re
from dataclasses import replace

import numpy as np
import pytest
from support.recorded import MODULUS, elastic_scene, hertz_curve, settings_of

from contact_scene import Layer, SceneError
from contact_scene.scene import with_values
from validation.fits.data_checks import check, thickness_needed
from validation.fits.model import CurveModel, moments, straight_lines
from validation.fits.parameters import unknowns
from validation.fits.readers import read_file
from validation.fits.record import MeasuredCurve
from validation.reference import sneddon
from validation.reference.elastic_layer import ElasticLayer

pytestmark = pytest.mark.usefixtures("closed_form")


@pytest.mark.parametrize("mark", ["", "# "])  # the latter as numpy.savetxt writes it
def test_units_in_the_header_and_other_columns_are_passed_over(tmp_path, mark):
    rows = "\n".join(f"{k},{2 * k},9,{3 * k}" for k in range(30))
    (tmp_path / "a.csv").write_text(
        f"# noise: 0.5\n{mark}Time [s],Force (nN),temperature,Penetration [nm]\n{rows}\n"
    )
    [curve] = read_file(tmp_path / "a.csv")
    assert curve.time.size == 30
    assert curve.force[3] == 6.0
    assert curve.motion[3] == 9.0
    assert curve.noise == 0.5


def test_noise_and_baseline_are_those_that_were_put_in():
    seen = moments(hertz_curve(noise=1e-4, rows=400, baseline=0.02))
    assert seen.noise == pytest.approx(1e-4, rel=0.25)  # three deviations of 77 rows
    assert seen.background == pytest.approx(0.02, abs=5e-5)
    assert seen.noise_source.startswith("baseline")
    curve = hertz_curve(rows=400)
    touch = (6.0 * seen.noise * 0.75 / MODULUS * 0.75) ** (2.0 / 3.0)  # where the force leaves its noise
    assert 0.0 < curve.motion[seen.first] < 1.5 * touch
    assert 0.0 < curve.motion[seen.last - 1] < 1.5 * touch
    assert seen.pull_off is None  # the force comes to nothing continuously


def jumping(rows, begin, end, slope, tilt=0.0, ringing=0.0):
    """A contact that begins and ends in a jump, with a noise of 1e-3; it rings for 0.05."""
    time = np.linspace(0.0, 1.0, rows)
    position = 0.5 - np.abs(time - 0.5)
    held = np.where((time > begin) & (time < end), slope * (position - 0.2) - 0.5, 0.0)
    held += tilt * position + ringing * ((time > end) & (time < end + 0.05))
    return MeasuredCurve(time, held + 1e-3 * np.random.default_rng(1).standard_normal(rows), position)


@pytest.mark.parametrize("tilt", [0.0, 0.3])
@pytest.mark.parametrize("ringing", [0.0, 0.05])
def test_a_jump_is_found_in_its_interval_and_not_compared(ringing, tilt):
    """Though the spring rings down behind the loss: ten rows at a tenth of the pull-off force."""
    seen = moments(jumping(201, 0.2026, 0.8026, 4.0, tilt, ringing))
    for jump, moment in ((seen.snap_in, 0.2026), (seen.pull_off, 0.8026)):
        assert jump is not None
        assert jump.timed
        assert abs(jump.time - moment) <= 0.0025
        assert jump.deviation == pytest.approx(0.005 / np.sqrt(12.0))
        assert not seen.compared[np.argsort(np.abs(np.linspace(0.0, 1.0, 201) - jump.time))[:2]].any()


@pytest.mark.parametrize(("rows", "end"), [(75, 0.9), (63, 0.92), (52, 0.915), (71, 0.86)])
def test_fewer_rows_behind_the_loss_than_a_line_is_begun_with(rows, end):
    """A line through the jump takes it for noise: the noise came out several hundred times too large."""
    curve = jumping(rows, 0.2, end, 2.5)
    seen = moments(curve)
    assert seen.last == np.flatnonzero(curve.time >= end)[0]
    assert seen.noise == pytest.approx(1e-3, rel=0.5)


def test_a_loss_that_the_force_runs_into_is_a_jump_too():
    """The last change is less than three times the one before it, as of a bead that leaves a gel."""
    time = np.arange(70.0)
    motion = 26.0 - np.abs(time - 26.0)
    left = 61.5 - time  # rows to the loss
    held = np.where(time < 26.0, 5.0 * time, 130.0 - 7.0 * (time - 26.0))
    held = np.where(time > 50.0, -130.0 + 100.0 * 0.5 ** np.abs(left), held)
    force = np.where(left > 0.0, held, 0.0) + np.random.default_rng(0).standard_normal(70)
    seen = moments(MeasuredCurve(time, force, motion))
    assert seen.last == 62
    assert seen.noise == pytest.approx(1.0, rel=0.5)


@pytest.mark.parametrize("noise", [0.0, 1e-3])
def test_a_straight_record_is_contact_throughout(noise):
    """Of a flat punch that never leaves: one line holds all rows, and it is no baseline, for it rises."""
    time = np.linspace(0.0, 2.0, 200)
    motion = 1.0 - np.abs(time - 1.0)
    curve = MeasuredCurve(time, motion + noise * np.random.default_rng(0).standard_normal(200), motion)
    seen = moments(curve)
    assert (seen.first, seen.last) == (0, 200)


def test_a_triangle_of_motion_is_three_points_wherever_its_corner_lies():
    time = np.linspace(0.0, 4.0, 173)
    for corner in (1.7, 1.7 + 4.0 / 172 * 0.3, 2.013):
        knots, heights = straight_lines(time, 0.03 - 0.02 * np.abs(time - corner), 0.0)
        assert knots == pytest.approx([0.0, corner, 4.0], abs=1e-9)
        assert heights[1] == pytest.approx(0.03, abs=1e-9)


def test_noise_of_the_motion_makes_no_corners():
    time = np.linspace(0.0, 4.0, 400)
    motion = 0.03 - 0.02 * np.abs(time - 1.7) + 1e-5 * np.random.default_rng(2).standard_normal(400)
    knots, heights = straight_lines(time, motion, 0.0)
    assert knots.size <= 5
    assert np.interp(1.7, knots, heights) == pytest.approx(0.03, abs=3e-5)


def checked(curve, scene=None, free=()):
    scene = scene or elastic_scene()
    model = CurveModel.of(curve, scene)
    found = check([model], scene, unknowns([model], scene, settings_of("material.modulus", free=free)))
    return [text for text in found if "half-space" not in text]


def exchanged(curve):
    """The record with its columns of force and position the other way round."""
    column = "penetration" if curve.stage is None else "stage"
    return replace(curve, **{column: curve.force}, force=curve.position)


def test_columns_that_were_swapped_are_known_by_the_size_of_the_contact():
    good = hertz_curve()
    scene = with_values(elastic_scene(), {"material.modulus": 1e3, "indenter.radius": 1e-5})
    motion, force = 1e-4 * good.motion, 1e-6 * good.force  # metres, newtons
    assert checked(MeasuredCurve(good.time, force, motion), scene) == []
    with pytest.raises(SceneError, match="swapped"):
        checked(MeasuredCurve(good.time, motion, force), scene)


def afm_curve(stiffness=None):
    """A soft sphere in SI units, driven by its position or by the stage of a spring, and a scene for it."""
    time = np.linspace(0.0, 4.0, 120)
    driven, depths = 1e-6 * (3.0 - 2.0 * np.abs(time - 2.0)), np.linspace(-1e-6, 3e-6, 1000)
    force = 4.0 / 3.0 * 8e3 / 0.75 * np.sqrt(1e-4) * np.maximum(depths, 0.0) ** 1.5
    places = depths if stiffness is None else depths + force / stiffness
    recorded = np.interp(driven, places, force) + 1e-9 * np.random.default_rng(0).standard_normal(120)
    scene = with_values(elastic_scene(), {"material.modulus": 8e3, "indenter.radius": 1e-4})
    if stiffness is None:
        return MeasuredCurve(time, recorded, driven), scene
    return MeasuredCurve(time, recorded, stage=driven, stiffness=stiffness), scene


@pytest.mark.parametrize("stiffness", [None, 0.1])
@pytest.mark.parametrize("guess", [0.3, 1.0, 3.0])
@pytest.mark.parametrize("part", [(0, 120), (0, 60), (60, 120)])
def test_columns_that_were_swapped_are_known_by_the_straight_lines_of_a_drive(stiffness, guess, part):
    """Their sizes could be those of a stiffer material; approach and retraction tell each for itself."""
    curve, scene = afm_curve(stiffness)
    scene = with_values(scene, {"material.modulus": 8e3 * guess})
    curve = curve.between(*part)
    checked(curve, scene)
    with pytest.raises(SceneError) as caught:
        checked(exchanged(curve), scene)
    said = r"straight lines, the force in \d: swapped\? \(.* times the force .*, .* times if they are"
    assert re.search(said, str(caught.value))


def test_the_straight_force_of_a_press_is_not_taken_for_a_motion():
    """Under a prescribed force the position is what follows; sizes tell that the columns are right."""
    curve, scene = afm_curve()
    force = 7.4e-7 * np.maximum(1.0 - np.abs(curve.time - 2.0) / 1.5, 0.0)
    depth = 3e-6 * (force / 7.4e-7) ** (2.0 / 3.0)
    depth -= 1e-6 * np.maximum(np.abs(curve.time - 2.0) - 1.5, 0.0)
    noise = 1e-9 * np.random.default_rng(0).standard_normal(force.size)
    warned = checked(MeasuredCurve(curve.time, force + noise, depth), scene)
    assert not any("swapped" in text for text in warned)


@pytest.mark.parametrize("guess", [1e-2, 1.0, 1e2])
def test_a_force_that_relaxes_at_rest_is_not_taken_for_a_motion(guess):
    """Pressed from the first row on and held: no row is without contact, and the position rests in most."""
    time = np.linspace(0.0, 10.0, 400)
    held = np.minimum(time, 1.0)
    for noise, order in ((0.0, 1), (1e-3, 1), (1e-3, -1)):
        force = 3e-5 * held**1.5 * (0.3 + 0.7 * np.exp(-np.maximum(time - 1.0, 0.0) / 3.0))
        scatter = noise * np.random.default_rng(0).standard_normal((2, 400))
        curve = MeasuredCurve(time, force[::order] + 3e-5 * scatter[0], 3e-6 * (held[::order] + scatter[1]))
        _, scene = afm_curve()
        warned = checked(curve, with_values(scene, {"material.modulus": 8e3 * guess}))
        assert not any("swapped" in text for text in warned)


def test_a_weak_record_has_warnings_and_a_good_one_none():
    assert checked(hertz_curve()) == []
    assert any("too coarse" in text for text in checked(hertz_curve(rows=30)))
    loud = replace(hertz_curve(), noise=1e-3)
    assert any("noise is 1" in text for text in checked(loud))


def test_a_fit_without_a_body_says_how_thick_a_half_space_has_to_be():
    """The force of the thickness that is told is 10 % above Hertz's at the depth of the record."""
    curve, scene = afm_curve()
    said = thickness_needed([CurveModel.of(curve, scene)], scene)
    thickness = float(said.split("thickness ")[1].split()[0])
    seen = CurveModel.of(curve, scene).moments
    depth = float(np.ptp(curve.motion[seen.first : seen.last]))
    layer = ElasticLayer(Layer(thickness, "bonded"), scene.material.poisson, scene.indenter)
    force = layer.state(layer.radius_at(depth)).force
    radius = sneddon.contact_radius(scene.indenter, depth)
    assert force / float(sneddon.force(scene.indenter, radius, 1.0)) == pytest.approx(1.1, abs=0.01)


def test_the_force_of_a_thin_layer_is_not_taken_for_another_unit():
    """Some forty times that of a half-space at a contact of four thicknesses."""
    curve, scene = afm_curve()
    film = replace(scene, body=Layer(float(np.ptp(curve.motion)), "bonded"))
    stiff = MeasuredCurve(curve.time, 300.0 * curve.force, curve.motion)
    assert any("other units" in text for text in checked(stiff, scene))
    assert not any("other units" in text for text in checked(stiff, film))


@pytest.mark.parametrize("factor", [1e3, 1e-3])
def test_another_unit_of_force_is_hinted_at(factor):
    good = hertz_curve()
    [said] = checked(MeasuredCurve(good.time, factor * good.force, good.motion))
    assert "times that of the scene's elastic contact: other units?" in said


def test_a_long_record_becomes_means_of_its_rows():
    long = replace(hertz_curve(rows=130), noise=3e-4, contact_radius=hertz_curve(rows=130).motion)
    short, together = long.means(50)
    assert (together, short.time.size) == (3, 43)
    assert short.noise == pytest.approx(3e-4 / np.sqrt(3.0))
    for column in ("time", "force", "penetration", "contact_radius"):
        assert getattr(short, column)[1] == pytest.approx(getattr(long, column)[3:6].mean())
    assert [one.last for one in short.segments] == [one.last // 3 for one in long.segments]
    assert short.means(50) == (short, 1)


def test_segments_are_told_from_the_apex_and_cut_with_the_rows():
    time = np.linspace(0.0, 10.0, 101)
    held = MeasuredCurve(time, time, np.interp(time, [0.0, 4.0, 7.0, 10.0], [-1.0, 1.0, 1.0, -1.0]))
    assert [tuple(one) for one in held.segments] == [
        ("approach", 0, 40),
        ("pause", 40, 71),
        ("retract", 71, 101),
    ]
    assert [one.kind for one in hertz_curve().segments] == ["approach", "retract"]
    assert held.between(50, 90).segments == (("pause", 0, 21), ("retract", 21, 40))
    assert held.rows("pause").sum() == 31
    for wrong in (
        (("apporach", 0, 9),),
        (("approach", 0, 102),),
        (("approach", 0, 9), ("retract", 5, 9)),
        (3,),
    ):
        with pytest.raises(SceneError, match="segments"):
            replace(held, segments=wrong)
