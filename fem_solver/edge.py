"""Where the contact edge settles: by the closure with adhesion, by vanishing singularity without.

At a fixed instant the response is glassy and reversible in the edge position ``s``, so the closure is one
function of it. The edge recedes where ``I > dg`` and advances where ``I < dg``; it rests at the first root it
meets, where ``I`` rises through ``dg``. Beyond the last root the contact is unstable.
"""

from __future__ import annotations

import math
from collections.abc import Callable

from scipy.optimize import brentq

from contact_scene import Adhesion
from fem_solver.contact_problem import ContactProblem
from fem_solver.edge_path import NO_CONTACT, EdgeGeometry, EdgeMotion, EdgePosition

_WIDEST_STRIDE = 0.5
"""Widest stride of a search, in shortest zones: the closure, a mean over a zone, hardly turns within it."""
_FIRST_STRIDE = 2.0**-5
"""First stride from where the edge is expected, relative to its way to there: mostly it misses by less."""
_NARROW_STRIDE = 2.0**-12
"""Shortest first stride, in node spacings: the interval between two roots is narrow next to the last one."""
_LEAST_PRESSED = -1.0 + 1e-6
"""Least edge position without adhesion: of contact in a point, a millionth of the first node's radius."""


def root_between(function: Callable[[float], float], ends: dict[float, float], xtol: float = 2e-12) -> float:
    """The root between two places, given with the values there, within ``xtol``.

    Where the function is convex, or concave, it is no farther from a place than the value there over the
    smaller of the slopes to the nearest places on either side.
    """
    known, sign = dict(ends), math.copysign(1.0, ends[max(ends)])

    def value(at: float) -> float:
        if at not in known:
            beside = max(x for x in known if x < at), min(x for x in known if x > at)
            known[at] = excess = function(at)
            slope = min(sign * (known[x] - excess) / (x - at) for x in beside)
            if abs(excess) <= xtol * slope:
                known[at] = 0.0
        return known[at]

    # SciPy's wrapper of a function refers to itself: what it holds would wait for the garbage collection
    held = [value]
    try:
        return float(brentq(lambda at: held[0](at), min(ends), max(ends), xtol=xtol))
    finally:
        held.clear()


class AdhesiveEdge:
    """Closure integral equal to the work of adhesion.

    A search makes strides of at most ``widest`` nodes, the first one of at least ``first``.
    """

    def __init__(self, geometry: EdgeGeometry, work: float) -> None:
        self.geometry, self.work = geometry, work
        # contact of less than one element cannot be distinguished from no contact
        self.lowest = 2.0
        self.widest = _WIDEST_STRIDE * max((geometry.shortest or 0.0) / geometry.spacing, 1.0)
        self.first = _NARROW_STRIDE

    def taken(self, problem: ContactProblem, s: float) -> float:
        """Energy per area that the edge takes up on its way to ``s``."""
        return self.work

    def _excess(self, problem: ContactProblem, s: float) -> float:
        value = problem.closure(s) / self.taken(problem, s) - 1.0
        return value if value > -1.0 else -1.0

    def start(self, problem: ContactProblem) -> EdgePosition:
        """Scan inwards from the largest contact for the first stable root.

        A root below one process zone is returned as well: the caller names it in its error.
        """
        last = self.geometry.last
        beyond = self._excess(problem, last)
        if beyond <= 0.0:
            return EdgePosition(EdgeMotion.ADVANCING, float(last))
        for node in range(last - 1, 0, -1):
            excess = self._excess(problem, node)
            if excess < 0.0:
                ends = {float(node): excess, node + 1.0: beyond}
                return EdgePosition(EdgeMotion.RESTING, self._root(problem, ends))
            beyond = excess
        if problem.penetration(1.0) >= 0.0:  # in compression, but smaller than the mesh resolves
            return EdgePosition(EdgeMotion.RESTING, 1.0)
        return EdgePosition(EdgeMotion.RECEDING, self.lowest)

    def seek(self, problem: ContactProblem, s: float, low: float, high: float) -> EdgePosition:
        """Expand a bracket from ``s`` in the direction in which the closure moves the edge."""
        low, high = max(low, self.lowest), min(high, float(self.geometry.last))
        here = min(max(s, low), high)
        stride = max(_FIRST_STRIDE * abs(here - problem.state.edge), self.first)
        return self._towards(problem, here, self._excess(problem, here), (low, high), stride)

    def _towards(
        self,
        problem: ContactProblem,
        here: float,
        excess: float,
        limits: tuple[float, float],
        stride: float,
    ) -> EdgePosition:
        """The first root on the way on which the excess drives the edge, or the limit there."""
        way = -1.0 if excess > 0.0 else 1.0
        limit = limits[0] if way < 0.0 else limits[1]
        while here != limit:
            stride = min(stride, self.widest)
            ahead = here + way * stride
            if (limit - ahead) * way <= 0.0:
                ahead = limit
            beyond = self._excess(problem, ahead)
            if beyond * way >= 0.0:
                return EdgePosition(EdgeMotion.RESTING, self._root(problem, {here: excess, ahead: beyond}))
            # on by a quarter more than the slope asks for
            gained = (beyond - excess) * way
            stride *= max(-1.25 * way * beyond / gained, _FIRST_STRIDE) if gained > 0.0 else 4.0
            here, excess = ahead, beyond
        return EdgePosition(EdgeMotion.ADVANCING if way > 0.0 else EdgeMotion.RECEDING, limit)

    def _root(self, problem: ContactProblem, ends: dict[float, float]) -> float:
        """The root between two positions, given with their excess."""
        return root_between(lambda s: self._excess(problem, s), ends, _NARROW_STRIDE**2)


class PressedEdge(AdhesiveEdge):
    """Without adhesion: nothing presses at the edge, nor beyond it; a plane tip touches as a whole."""

    def __init__(self, geometry: EdgeGeometry, plane_tip: float) -> None:
        super().__init__(geometry, 0.0)
        self.lowest, self.widest = NO_CONTACT, math.inf
        self._least = max(geometry.position(plane_tip), _LEAST_PRESSED)
        self._inside = False

    def _excess(self, problem: ContactProblem, s: float) -> float:
        return -problem.pressed_in(s, self._inside)

    def seek(self, problem: ContactProblem, s: float, low: float, high: float) -> EdgePosition:
        """Follow the edge from where it is: outwards if it presses there, inwards if it pulls.

        The residual beyond it is another one than within, and it is sought first where it is expected.
        """
        before, pressed = problem.state.edge, problem.control == "force" and problem.value > 0.0
        if problem.control == "force" and not pressed:  # bears nothing
            rests = before == NO_CONTACT and problem.value == 0.0
            return EdgePosition(EdgeMotion.RESTING if rests else EdgeMotion.RECEDING, NO_CONTACT)
        if before == NO_CONTACT and not pressed and problem.pressed_in(self._least) <= 0.0:
            return EdgePosition(EdgeMotion.RESTING, NO_CONTACT)
        low, high = max(low, self._least), min(high, float(self.geometry.last))
        for self._inside in (s < before, s >= before):
            ends = (low, min(before, high)) if self._inside else (max(before, low), high)
            if ends[0] > ends[1]:
                continue
            here = min(max(s, ends[0]), ends[1])
            stride = max(_FIRST_STRIDE * abs(s - before), self.first) if s != before else 1.0
            found = self._towards(problem, here, self._excess(problem, here), ends, stride)
            if found.motion is EdgeMotion.RESTING or found.s != before:
                break
        else:  # neither beyond nor within; the least contact is over where nothing presses it
            there = problem.pressed_in(before, inside=True)
            rests = there > 0.0 or (there == 0.0 and before > self._least)
            found = EdgePosition(EdgeMotion.RESTING if rests else EdgeMotion.RECEDING, before)
        if found.motion is not EdgeMotion.RECEDING or found.s > self._least:
            return found
        if pressed:  # some contact bears it
            return EdgePosition(EdgeMotion.RESTING, self._least)
        return EdgePosition(EdgeMotion.RECEDING, NO_CONTACT)


class IrreversibleEdge(AdhesiveEdge):
    """Closure integral equal to what the edge takes up in its direction, at its speed."""

    def __init__(self, geometry: EdgeGeometry, adhesion: Adhesion) -> None:
        super().__init__(geometry, adhesion.work)
        self.adhesion = adhesion

    def taken(self, problem: ContactProblem, s: float) -> float:
        """Energy per area that the edge takes up on its way to ``s``; at rest that at which it opens."""
        begin = problem.state
        if begin.edge <= NO_CONTACT or s > begin.edge:
            return self.adhesion.closing
        if s == begin.edge or self.adhesion.rate is None:
            return self.adhesion.work
        speed = begin.opening_speed(self.geometry.radius(s), problem.dt)
        return self.adhesion.opening(max(speed, 0.0))

    def departure(self, problem: ContactProblem, s: float) -> EdgeMotion:
        """Which way the edge leaves the position ``s`` where a step begins, or whether it is pinned there."""
        closure = problem.closure(s)
        opening = self.adhesion.opening(math.inf) if problem.dt <= 0.0 else self.work
        if closure > opening:
            return EdgeMotion.RECEDING
        return EdgeMotion.ADVANCING if closure < self.adhesion.closing else EdgeMotion.RESTING


def edge_law(geometry: EdgeGeometry, adhesion: Adhesion | None, plane_tip: float) -> AdhesiveEdge:
    """The law of an edge."""
    if adhesion is None:
        return PressedEdge(geometry, plane_tip)
    return (
        AdhesiveEdge(geometry, adhesion.work) if adhesion.reversible else IrreversibleEdge(geometry, adhesion)
    )


def energy_spent(adhesion: Adhesion, radii: tuple[float, float], closures: tuple[float, float]) -> float:
    """Energy that the interface takes up in a step of the edge; negative where it closes."""
    before, after = radii
    area = math.pi * (before**2 - after**2)
    if area <= 0.0:
        return adhesion.closing * area
    if adhesion.rate is None:
        return adhesion.work * area
    most = adhesion.opening(math.inf)
    energies = [min(max(closure, adhesion.work), most) for closure in closures]
    return 0.5 * (energies[0] + energies[1]) * area
