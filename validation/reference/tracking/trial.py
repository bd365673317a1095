"""One trial: the radius that satisfies the edge condition after a given time, or the time for a radius."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from contact_scene import Counters, Segment
from validation.reference.path.rheology import Body
from validation.reference.tracking.control import balanced, prescribed_penetration, through_rows
from validation.reference.tracking.edge_path import (
    EdgePath,
    PathFamily,
    path_family,
    path_over_radius,
)
from validation.reference.tracking.hermite import each_once
from validation.reference.tracking.law import EdgeCondition
from validation.reference.tracking.node_placement import NodePlacement
from validation.reference.tracking.root import bracketed, rising_root
from validation.reference.tracking.row_extrapolation import RowExtrapolation
from validation.reference.tracking.surface import Surface
from validation.reference.tracking.surface_step import FieldUpdate, field_update, surface_step
from validation.reference.tracking.zone_from_turn import RootExtrapolation

Array = NDArray[np.float64]

MOST_NODES = 400
"""Most nodes left behind by an unstable edge in one step."""
FIRST_CONTACT_NODES = np.arange(1, 16) / 16.0
"""Nodes of a contact that has just begun, as fractions of the step."""
SHORTER = 1e-3
"""Ratio of durations in the search for a time that may be shorter by decades than the step."""
NARROW = 1e-14
"""Relative difference below which two radii or two times are the same."""


@dataclass(frozen=True)
class EdgeSearch:
    """End of a search for the edge: a stable radius (``stable``) or a limit of the search interval."""

    radius: float
    stable: bool
    steepness: float = 0.0


@dataclass(frozen=True)
class Trial:
    """A step of any duration from one state, under one load segment.

    Parameters
    ----------
    body : Body
    condition : EdgeCondition
    surface : Surface
        State at the start; never changed.
    segment : Segment
        Load during the step.
    time : float
        Start of the step.
    radii : RowExtrapolation or RootExtrapolation
        Radius at the rows before.
    depths : RowExtrapolation
        Penetration at the rows before.
    nodes : NodePlacement
        Where the edge leaves nodes behind, besides the end of the step.
    counters : Counters
        Counts the evaluations of the edge condition.
    largest_radius : float
        Radius of the indenter's edge; infinite without one.
    spacing : float
        Distance of the nodes that an unstable edge leaves behind.
    over_zones : bool
        Whether the step may pass over process zones; its path is then the polynomial through all rows.
    arrivals : RowExtrapolation or None
        Time over the radius at the rows before, if the path is one over the radius: towards a limit point.
    """

    body: Body
    condition: EdgeCondition
    surface: Surface
    segment: Segment
    time: float
    radii: RowExtrapolation | RootExtrapolation
    depths: RowExtrapolation
    nodes: NodePlacement
    counters: Counters
    largest_radius: float
    spacing: float
    over_zones: bool = False
    arrivals: RowExtrapolation | None = None
    _updates: dict[float, FieldUpdate] = field(default_factory=dict)
    _paths: dict[float, PathFamily] = field(default_factory=dict)
    _fractions: dict[float, Array] = field(default_factory=dict)
    _parts: dict[tuple[int, int], Surface] = field(default_factory=dict)

    def surface_at(self, duration: float, radius: float, whole: bool = True) -> Surface:
        """The surface at the end of a step.

        Parameters
        ----------
        duration : float
            Of the step, a time.
        radius : float
            Of the edge at its end.
        whole : bool
            All of the surface, with the energy that the edge released on its way; otherwise only the fields
            near the edge.

        Returns
        -------
        Surface
        """
        return self._surface_along(self._edge_path(duration, radius), duration, whole)

    def _surface_along(self, path: EdgePath, duration: float, whole: bool) -> Surface:
        start, radius = self.surface, path.start + path.travel
        fractions, update = self._node_fractions(duration, path.travel), self._update(duration)
        if self.segment.control != "penetration":
            return balanced(
                start,
                self.body,
                self.segment,
                self.segment.value(self.time + duration),
                update,
                self.depths,
                path,
                fractions,
                over_zones=self.over_zones,
                with_tip_energy=whole,
            )
        if not whole:
            reach = self.condition.reach
            start = self._part(min(radius, start.radius) - reach, max(radius, start.radius) + reach)
        return surface_step(start, self.body, update, path, fractions)(update, whole)

    def _update(self, duration: float) -> FieldUpdate:
        """Update of the fields; under a force or a stage that of a step which keeps the penetration."""
        if duration not in self._updates:
            depth, start = self.surface.penetration, self.surface
            if self.segment.control == "penetration":
                way = prescribed_penetration(self.segment, self.time, duration, start)
            else:
                way = through_rows(duration, depth, depth, self.depths, self.over_zones)
            self._updates[duration] = field_update(start, self.body, way)
        return self._updates[duration]

    def _part(self, low: float, high: float) -> Surface:
        """The surface at the start between two radii; trials that are near each other share it."""
        within = self.surface.nodes_between(low, high)
        if within not in self._parts:
            self._parts[within] = self.surface.part(*within)
        return self._parts[within]

    def _edge_path(self, duration: float, radius: float) -> EdgePath:
        if self.arrivals is not None:
            return path_over_radius(self.arrivals, duration, self.surface.radius, radius, self.over_zones)
        family = self._paths.get(duration)
        if family is None:
            family = self._paths[duration] = path_family(self.radii, duration, self.surface.radius)
        follows_speed = self.over_zones or self.condition.rated
        return family.polynomial(radius) if follows_speed else family.parabola(radius)

    def _node_fractions(self, duration: float, travel: float) -> Array:
        if travel == 0.0:
            return np.empty(0)
        if duration not in self._fractions:
            self._fractions[duration] = self.nodes.fractions(duration)
        fractions = self._fractions[duration]
        if self.surface.radius == 0.0 < travel:  # centre and edge alone do not resolve a new contact
            fractions = each_once(fractions, FIRST_CONTACT_NODES)
        if abs(travel) > 2.0 * self.spacing:  # an unstable edge leaves nodes all along its travel
            count = min(int(abs(travel) / self.spacing), MOST_NODES)
            fractions = each_once(fractions, np.arange(1, count + 1) / (count + 1))
        return fractions

    def residual(self, duration: float, radius: float, outward: bool | None = None) -> float:
        """Residual of the edge condition at the end of a step.

        Parameters
        ----------
        duration : float
            Of the step, a time.
        radius : float
            Of the edge at its end.
        outward : bool, optional
            Whether it arrives there outwards, where that does not follow from its start.

        Returns
        -------
        float
            In units of the condition; rises with the radius at a stable edge.
        """
        self.counters.closure_evaluations += 1
        path = self._edge_path(duration, radius)
        change = path.end_slope if outward is None else math.copysign(1.0, 1.0 if outward else -1.0)
        if duration > 0.0:
            velocity = change / duration
        else:
            velocity = math.copysign(math.inf, change) if change != 0.0 else 0.0
        return self.condition.residual(self._surface_along(path, duration, False), self.body, velocity)

    def forces_at_once(self, radius: float) -> tuple[float, float]:
        """Inward and outward driving force on an edge that has come to ``radius`` at fixed time."""
        self.counters.closure_evaluations += 1
        inward, outward = self.condition.driving_forces(
            self.surface_at(0.0, radius, False), self.body, at_once=True
        )
        return inward, -1.0 if radius >= self.largest_radius else outward

    def driving_forces(self, duration: float) -> tuple[float, float]:
        """Inward and outward driving force on the edge, still at rest, after ``duration``."""
        self.counters.closure_evaluations += 1
        if self.surface.radius == 0.0 and self.segment.control == "force":
            target = self.segment.value(self.time + duration)
            return -1.0, math.copysign(1.0, target) if target != 0.0 else 0.0
        inward, outward = self.condition.driving_forces(
            self.surface_at(duration, self.surface.radius, False), self.body
        )
        return inward, -1.0 if self.surface.radius >= self.largest_radius else outward

    def stable_edge(
        self, duration: float, guess: float, lowest: float, highest: float, steepness: float = 0.0
    ) -> EdgeSearch:
        """Stable edge nearest to the present one after ``duration``, within an interval.

        Parameters
        ----------
        duration : float
        guess : float
            Extrapolated radius; saves evaluations.
        lowest, highest : float
            Radii between which to search.
        steepness : float
            Slope of the residual over the radius, 0 if unknown; saves evaluations.

        Returns
        -------
        EdgeSearch
        """
        a0, tolerance = self.surface.radius, self.condition.tolerance

        def function(radius: float) -> float:
            return self.residual(duration, radius)

        if guess != a0 and lowest < guess < highest:
            quick = rising_root(function, guess, 0.01 * (guess - a0), steepness, (lowest, highest), tolerance)
            if quick is not None and (quick[0] - a0) * (guess - a0) > 0.0:
                return EdgeSearch(quick[0], True, quick[1])
        inward, outward = self.driving_forces(duration)
        if inward <= tolerance and outward <= tolerance:
            return EdgeSearch(a0, True)
        up = outward > inward
        limit = min(highest, self.largest_radius) if up else lowest
        near, at_near = a0, -outward if up else inward
        stride = abs(guess - a0) if (guess > a0) == up and guess != a0 else 1e-3 * abs(limit - a0)
        while near != limit:
            far = min(near + stride, limit) if up else max(near - stride, limit)
            at_far = function(far)
            if (at_far >= 0.0) == up or abs(at_far) <= tolerance:
                root = bracketed(function, near, at_near, far, at_far, tolerance, NARROW * a0)
                return EdgeSearch(root, True)
            near, at_near, stride = far, at_far, 3.0 * stride
        return EdgeSearch(limit, up and limit >= self.largest_radius)

    def duration_to_radius(self, radius: float, longest: float, guess: float = 0.0) -> float | None:
        """Duration after which the edge arrives at a radius.

        Parameters
        ----------
        radius : float
            Other than that at the start.
        longest : float
            Duration up to which to search, a time.
        guess : float
            Expected duration, 0 if unknown; saves evaluations.

        Returns
        -------
        float or None
            ``longest`` if it does not arrive before; ``None`` if it would be beyond at once.
        """
        outward = radius > self.surface.radius

        def function(duration: float) -> float:
            return self.residual(duration, radius)

        if 0.0 < guess < longest:
            quick = rising_root(
                (lambda duration: -function(duration)) if outward else function,
                guess,
                0.01 * guess,
                0.0,
                (0.0, longest),
                self.condition.tolerance,
            )
            if quick is not None:
                return quick[0]
        at_once, late = function(0.0), function(longest)
        if (at_once <= 0.0) if outward else (at_once >= 0.0):
            return None
        if (late >= 0.0) if outward else (late <= 0.0):
            return longest
        while self.nodes.shortest < SHORTER * longest:  # the edge may pass long before: close in by decades
            earlier = SHORTER * longest
            value = function(earlier)
            if (value >= 0.0) if outward else (value <= 0.0):
                return bracketed(
                    function, earlier, value, longest, late, self.condition.tolerance, NARROW * longest
                )
            longest, late = earlier, value
        return bracketed(function, 0.0, at_once, longest, late, self.condition.tolerance, NARROW * longest)

    def departure_time(self, longest: float) -> float | None:
        """Duration after which an edge at rest starts to move; ``None`` if it stays or moves already."""
        tolerance = self.condition.tolerance
        late = self.driving_forces(longest)
        for side in (0, 1):
            if late[side] > tolerance:
                now = self.driving_forces(0.0)[side]
                if now >= -tolerance:
                    return None
                return bracketed(
                    lambda t, side=side: self.driving_forces(t)[side],  # type: ignore[misc]
                    0.0,
                    now,
                    longest,
                    late[side],
                    tolerance,
                    NARROW * longest,
                )
        return None
