"""Instantaneous events: where an edge comes to rest at a fixed time, unstable motion, first contact.

Jumps of the load are in ``load_jump``.
"""

from __future__ import annotations

from dataclasses import replace

from contact_scene import Segment
from validation.reference.tracking.arrest import arrest_radius
from validation.reference.tracking.law import Griffith, NoTension
from validation.reference.tracking.problem import FrontProblem
from validation.reference.tracking.state import FrontState
from validation.reference.tracking.step_outcome import FrontCandidate
from validation.reference.tracking.surface import Surface
from validation.reference.tracking.trial import Trial

ADHESIVE_STRIDE = 0.15
"""Search interval for the arrest of an unstable edge, in process zones."""
ELASTIC_STRIDE = 0.02
"""The same for an elastic half-space, in radii: no field varies there within a process zone."""
ADHESIONLESS_STRIDE = 0.02
"""The same without adhesion, in radii."""
TOUCHING_STRESS = 1e-12
"""Edge stress, relative to the largest, below which two plane faces just touch."""
LOST_FORCE = 1e-11
"""Contact that is being lost counts as lost below this fraction of the peak force."""
VANISHED = 1e-7
"""Radius without adhesion, in the largest one, below which a contact is over: that of an indenter which comes
back to where it has touched goes as a root of the depth, of which rounding is left."""
FINER_REACH = 32.0
"""Finer intervals searched, of a sixteenth: two whole ones, in one of which the stable radius must be."""


def at_rest(segment: Segment, value: float) -> Segment:
    """The control of a segment, held at a value."""
    return replace(segment, value=lambda time: value, rate=lambda time: 0.0, kinks=(), linear=True)


def forces_at_once(trial: Trial, radius: float) -> tuple[float, float]:
    """Inward and outward driving force on an edge that has come to ``radius`` at fixed time."""
    if isinstance(trial.condition, Griffith):
        return trial.forces_at_once(radius)
    if radius == trial.surface.radius:
        return trial.driving_forces(0.0)
    inward = trial.residual(0.0, radius)
    return inward, -inward if radius < trial.largest_radius else -1.0


def equilibrium_radius(
    problem: FrontProblem, state: FrontState, trial: Trial, begin: float, finer: float
) -> float | None:
    """Radius at which an edge that is at ``begin`` comes to rest at fixed time.

    Parameters
    ----------
    problem, state : FrontProblem, FrontState
        Present state.
    trial : Trial
        Trial step from it, whose duration will be zero.
    begin : float
        Radius from which to search.
    finer : float
        Search intervals, relative to the usual ones.

    Returns
    -------
    float or None
        ``None`` if contact is lost.
    """
    without_adhesion = isinstance(problem.condition, NoTension) and trial.segment.control == "force"
    if without_adhesion and trial.segment.value(state.time) <= 0.0:
        return None
    inward, outward = forces_at_once(trial, begin)
    if max(inward, outward) <= problem.condition.tolerance:
        return begin
    return _arrest(problem, state, trial, begin, outward > inward, finer)


def _arrest(
    problem: FrontProblem, state: FrontState, trial: Trial, begin: float, outward: bool, finer: float = 1.0
) -> float | None:
    """The next stable radius of an unstable edge at fixed time; ``None`` if contact is lost."""
    far = 1e3 * max(begin, state.largest_radius)
    limit = min(problem.edge_radius, far) if outward else min(problem.condition.smallest_radius, begin)
    if isinstance(problem.condition, Griffith):
        stride = ADHESIVE_STRIDE * problem.condition.zone_length
        if problem.elastic:
            stride = max(stride, ELASTIC_STRIDE * begin)
    else:
        stride = ADHESIONLESS_STRIDE * max(begin, state.largest_radius)
    if finer < 1.0 and not outward:
        limit = max(limit, begin - FINER_REACH * finer * stride)
    radius = arrest_radius(trial, begin, finer * stride, outward, limit)
    return None if radius is None or radius == 0.0 else radius


def unstable_edge(
    problem: FrontProblem, state: FrontState, trial: Trial, outward: bool
) -> FrontCandidate | None:
    """State after unstable motion of the edge at fixed time and load.

    Parameters
    ----------
    problem, state : FrontProblem, FrontState
        Present state.
    trial : Trial
        Trial step from it.
    outward : bool
        Whether the edge runs outward.

    Returns
    -------
    FrontCandidate or None
        ``None`` if contact is lost.
    """
    radius = _arrest(problem, state, trial, state.surface.radius, outward)
    if radius is None:
        return None
    end = problem.candidate(state.time, trial.surface_at(0.0, radius))
    bears = isinstance(problem.condition, Griffith) or end.force > LOST_FORCE * state.largest_force
    return end if outward or bears else None  # a plane face releases at once; else it holds by round-off only


def is_over(problem: FrontProblem, state: FrontState, end: FrontCandidate) -> bool:
    """Whether a contact without adhesion ends: its edge recedes to a point, or a plane tip lets go.

    Parameters
    ----------
    problem, state : FrontProblem, FrontState
        Present state.
    end : FrontCandidate
        Where the way ends, of a step or of a jump of the load.

    Returns
    -------
    bool
    """
    before, after = state.surface.radius, end.surface.radius
    if not isinstance(problem.condition, NoTension) or before == 0.0:
        return False
    if before <= problem.scene.bare_plane_tip:
        return end.force < state.force and end.force <= LOST_FORCE * state.largest_force
    return after < min(before, VANISHED * state.largest_radius)


def contact_of_plane_tip(problem: FrontProblem, state: FrontState, segment: Segment) -> FrontCandidate | None:
    """Contact over the whole of a plane tip that has just come to touch; ``None`` if it has not.

    Parameters
    ----------
    problem, state : FrontProblem, FrontState
        Present state.
    segment : Segment
        Load step.

    Returns
    -------
    FrontCandidate or None
    """
    edge = problem.scene.bare_plane_tip
    if edge == 0.0 or state.surface.radius > 0.0:
        return None
    load = at_rest(segment, segment.present(state.surface.penetration, 0.0))
    touching = problem.trial(state, load).surface_at(0.0, edge)
    largest = problem.body.rheology.glassy * (problem.depth or 1.0)
    if abs(touching.edge_stress(problem.body)) > TOUCHING_STRESS * largest:
        return None
    return problem.candidate(state.time, touching)


def force_without_contact(segment: Segment, surface: Surface) -> tuple[Segment, Surface] | None:
    """Load and surface when a force begins to act on an indenter that touches nothing.

    Pressing lowers the indenter until it touches; no force leaves it where it is, at a held penetration.
    ``None`` if the force pulls.
    """
    force, rate = segment.value(segment.start), segment.rate(segment.start)
    if force < 0.0 or (force == 0.0 and rate < 0.0):
        return None
    if force == rate == 0.0:
        return replace(at_rest(segment, surface.penetration), control="penetration"), surface
    return segment, replace(surface, penetration=float(surface.units[0].sum()))
