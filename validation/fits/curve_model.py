"""What a solver says a curve should have been: the scene under the measured motion, at the measured times.

The loading of the scene gives way to the measured motion; its start and the penetration it starts from stay:
contact begins where the motion first comes to that penetration (``jump-in``), or with the first row
(``relaxed``, or a record that begins in contact). Before, and after contact is lost, the force is zero.

A record of the stage drives the stage of a machine with the record's spring: the force follows from contact
and spring, and contact is lost at the limit point of the stage. Before contact no force bends the spring, so
that contact is made at constant stage (``snap-in``). The noise of the force is nowhere in the motion. Only a
``relaxed`` start, which prescribes the indenter, drives the indenter by stage and measured force.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from contact_scene import Machine, Scene, SceneError, Sphere, Table
from contact_scene.scene import with_values
from validation.fits.baseline import CurveFeatures, features
from validation.fits.fit_run import FitRun, sampled
from validation.fits.measured_path import straight_lines
from validation.fits.record import Array, MeasuredCurve

PATH_SHARE = 0.3
"""Force that a deviation of the straight lines from the motion may cost, over the noise of the force:
together with the noise it is 4 % more than the noise alone."""

CORNER = 0.1
"""Change of the rate over the largest from which curves are not taken as smooth across it."""


@dataclass(frozen=True)
class CurvePrediction:
    """A run at the times of a curve.

    Parameters
    ----------
    force, contact_radius : ndarray, shape (N,)
    touching : ndarray of bool, shape (N,)
        Rows in contact.
    first_contact, lost : float or None
        When contact begins and is lost, in the time of the curve.
    failure : str
        As of the run.
    """

    force: Array
    contact_radius: Array
    touching: NDArray[np.bool_]
    first_contact: float | None
    lost: float | None
    failure: str = ""


@dataclass(frozen=True)
class CurveModel:
    """A curve and the scene that is to explain it.

    Parameters
    ----------
    curve : MeasuredCurve
    scene : Scene
    features : CurveFeatures
    knots, heights : ndarray, shape (K,)
        The measured motion of indenter or stage as straight lines.
    """

    curve: MeasuredCurve
    scene: Scene
    features: CurveFeatures
    knots: Array
    heights: Array

    @classmethod
    def of(cls, curve: MeasuredCurve, scene: Scene) -> CurveModel:
        """Prepare a curve.

        Raises
        ------
        SceneError
            If it cannot be compared with the scene, one line.
        """
        seen = features(curve)
        if curve.indenter_radius is not None:
            if not isinstance(scene.indenter, Sphere):
                allowed = "a scene with a sphere, or a file without a radius"
                problem = f"stated for a {scene.indenter.shape}"
                raise SceneError("indenter_radius", problem, allowed, curve.name)
            scene = replace(scene, indenter=Sphere(curve.indenter_radius))
        scene, motion = _driven(curve, scene, seen)
        reach = float(np.ptp(curve.position))
        if reach == 0.0:
            column = "penetration" if curve.stage is None else "stage"
            raise SceneError(column, "does not move", "an approach or a retraction", curve.name)
        slope = float(np.ptp(curve.force)) / reach
        tolerance = PATH_SHARE * seen.noise / slope if slope > 0.0 else reach
        try:
            knots, heights = straight_lines(curve.time, motion, tolerance)
        except SceneError as error:
            raise error.in_file(curve.name) from None
        return cls(curve, scene, seen, knots, heights)

    def scene_of(self, values: Mapping[str, float], contact_point: float = 0.0) -> tuple[Scene, float] | None:
        """The scene to solve and the time its clock starts at; ``None`` if the motion never comes to contact.

        Parameters
        ----------
        values : mapping of str to float
            Numbers of the scene by path.
        contact_point : float
            Measured position at which the penetration is zero.

        Returns
        -------
        (Scene, float) or None

        Raises
        ------
        SceneError
            If the scene does not take the values.
        """
        scene = with_values(self.scene, values)
        heights = self.heights - contact_point
        first = scene.loading.penetration
        begin, place = float(self.knots[0]), 0
        if scene.loading.start == "relaxed" or heights[0] >= first:
            first = float(heights[0])
        else:
            above = np.flatnonzero(heights >= first)
            if not above.size:
                return None
            place = int(above[0]) - 1
            share = (first - heights[place]) / (heights[place + 1] - heights[place])
            begin += float(self.knots[place] - begin + share * (self.knots[place + 1] - self.knots[place]))
        later = self.knots > begin
        times = (begin, *self.knots[later].tolist())
        table = Table(times, (first, *heights[later].tolist()))
        return replace(scene, loading=replace(scene.loading, penetration=first, steps=(table,))), begin

    def prediction(self, run: FitRun, begin: float | None, time_offset: float = 0.0) -> CurvePrediction:
        """A run at the rows of the curve.

        Parameters
        ----------
        run : FitRun
        begin : float or None
            When the clock of the run starts; ``None`` without contact.
        time_offset : float
            By which the force is recorded later than the motion.

        Returns
        -------
        CurvePrediction
        """
        nothing = np.zeros(self.curve.time.size)
        if begin is None or run.time.size < 2:
            return CurvePrediction(nothing, nothing, nothing > 0.0, None, None, run.failure)
        at = self.curve.time - time_offset - begin
        touching = (at >= 0.0) & (at <= run.time[-1] if run.lost is not None or run.failure else True)
        inside = np.clip(at, 0.0, run.time[-1])
        corners = _corners(self.knots, self.heights) - begin
        force = np.where(touching, sampled(run.time, run.force, corners, inside), 0.0)
        radius = np.where(touching, sampled(run.time, run.contact_radius, corners, inside), 0.0)
        lost = None if run.lost is None else begin + run.lost + time_offset
        return CurvePrediction(force, radius, touching, begin + time_offset, lost, run.failure)


def _driven(curve: MeasuredCurve, scene: Scene, seen: CurveFeatures) -> tuple[Scene, Array]:
    """The scene with the machine and the start of a record, and the motion that drives it, shape (N,)."""
    loading = replace(scene.loading, machine=None)
    if curve.stage is None or curve.stiffness is None:
        return replace(scene, loading=loading), curve.motion
    if loading.start == "relaxed":
        level = seen.baseline + seen.drift * (curve.time - curve.time[0])
        return replace(scene, loading=loading), curve.motion + level / curve.stiffness
    loading = replace(loading, start="snap-in", machine=Machine(curve.stiffness))
    return replace(scene, loading=loading), curve.stage


def _corners(knots: Array, heights: Array) -> Array:
    """Times at which the rate of the motion changes by much."""
    rates = np.diff(heights) / np.diff(knots)
    return knots[1:-1][np.abs(np.diff(rates)) > CORNER * float(np.abs(rates).max())]
