"""History of a run, recorded so that fields in the body can be computed afterwards.

With a constant Poisson's ratio the surface vector ``w`` of every accepted step and the step's length suffice.
Branch variables at any row, and the energy dissipated anywhere in the body up to it, follow by replaying the
recursion (see ``condensed``); where the mesh follows the edge see ``following_log``. Otherwise the internal
variables live in the body: then only the requested states are stored whole, and the dissipation density is
summed at the quadrature points on every step,
``w_0 b.b/m + w_1 b.dx + w_2 m dx.dx`` per branch with the weights of ``Prony.loss_weights``.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from fem_solver import forms
from fem_solver.condensed import CondensedHistory
from fem_solver.fields.following_log import FollowingLog
from fem_solver.following.history import FollowingHistory
from fem_solver.halfspace import HalfSpace
from fem_solver.options import Options
from fem_solver.prony import RelaxingField
from fem_solver.quadrature import QuadratureHistory
from fem_solver.quadrature_state import QuadratureState

Array = NDArray[np.float64]
Form = Callable[[Array, Array], Array]

_ROUND_OFF = 1e-9
"""Two tensions that differ by less than this, relative to the largest one, count as equal."""


@dataclass(frozen=True)
class VolumeState:
    """Internal variables in the body at one row.

    ``dissipated`` (branches, points) is the energy per volume lost so far, branches in shear before those in
    volume.
    """

    internal: QuadratureState
    dissipated: Array


@dataclass
class VolumeContent:
    """What a :class:`VolumeLog` holds.

    Parameters
    ----------
    internal : QuadratureState
        At the last row.
    dissipated : ndarray, shape (branches, points), or float
        As of :class:`VolumeState`, there; 0 before the first row.
    rows : int
        Number of rows.
    stored : dict of int to VolumeState
        By row.
    largest_tension : (int, VolumeState) or None
        Row and state.
    lowest_force : float
        There; infinite before the first row.
    before : VolumeContent or None
        Before the last row, if that may be taken back; ``stored`` is not kept in it.
    """

    internal: QuadratureState
    dissipated: Array | float = 0.0
    rows: int = 0
    stored: dict[int, VolumeState] = field(default_factory=dict)
    largest_tension: tuple[int, VolumeState] | None = None
    lowest_force: float = np.inf
    before: VolumeContent | None = None


@dataclass
class SurfaceLog:
    """Surface history of all rows: step lengths and surface vectors ``w`` (n,), in the order of the rows."""

    history: CondensedHistory
    steps: list[tuple[float, Array]] = field(default_factory=list)

    @property
    def rows(self) -> int:
        """Number of rows."""
        return len(self.steps)

    def accept(self, dt: float, forces: Array) -> None:
        """One more row, which the history has accepted."""
        self.steps.append((dt, self.history.state.image))

    def drop_last(self) -> None:
        """The last row is taken back."""
        del self.steps[-1:]

    def store(self, row: int) -> None:
        """Nothing to do: all rows are stored."""

    def __contains__(self, row: int) -> bool:
        return 0 <= row < self.rows


class VolumeLog:
    """States of the requested rows.

    Parameters
    ----------
    history : QuadratureHistory
        Before its first step.
    options : Options
        ``record_every`` stores each n-th row, ``record_rows`` those named, ``record_pull_off`` the one of
        largest tension (of equals to round-off the last).
    """

    def __init__(self, history: QuadratureHistory, options: Options) -> None:
        self.history = history
        self.content = VolumeContent(history.state)
        self._options = options

    @property
    def rows(self) -> int:
        """Number of rows."""
        return self.content.rows

    @property
    def largest_tension(self) -> tuple[int, VolumeState] | None:
        """Row and state of the largest tension, where that is asked for."""
        return self.content.largest_tension

    @property
    def incompressible(self) -> bool:
        """Whether there is no volume strain."""
        return self.history.bulk_modulus is None

    def accept(self, dt: float, forces: Array) -> None:
        """One more row, which the history has accepted."""
        content, options = self.content, self._options
        before, after = content.internal, self.history.state
        content.before = replace(content, stored={}, before=None)
        lost = [_loss(dt, before.shear, after.shear, shear_form)]
        if not self.incompressible:
            lost.append(_loss(dt, before.volume, after.volume, volume_form(self.history.space)))
        state = VolumeState(after, np.concatenate(lost) + content.dissipated)
        content.internal, content.dissipated = after, state.dissipated
        force, lowest = float(forces.sum()), content.lowest_force
        if options.record_pull_off and force <= lowest + _ROUND_OFF * abs(lowest):
            content.largest_tension = content.rows, state
            content.lowest_force = min(force, lowest)
        if content.rows in options.record_rows or (
            options.record_every and content.rows % options.record_every == 0
        ):
            content.stored[content.rows] = state
        content.rows += 1

    def drop_last(self) -> None:
        """The last row is taken back; once only until the next one."""
        before, stored = self.content.before, self.content.stored
        if before is None:
            return
        stored.pop(before.rows, None)
        self.content = replace(before, stored=stored)

    def store(self, row: int) -> None:
        """Store the last row, whose number this is."""
        content = self.content
        content.stored[row] = VolumeState(content.internal, np.asarray(content.dissipated))

    def __contains__(self, row: int) -> bool:
        largest = self.largest_tension
        return row in self.content.stored or (largest is not None and largest[0] == row)

    def __getitem__(self, row: int) -> VolumeState:
        largest = self.largest_tension
        return largest[1] if largest is not None and largest[0] == row else self.content.stored[row]


HistoryLog = SurfaceLog | VolumeLog | FollowingLog


def history_log(
    history: CondensedHistory | QuadratureHistory | FollowingHistory, options: Options
) -> HistoryLog:
    """The log of a history that has not made a step."""
    if isinstance(history, FollowingHistory):
        return FollowingLog(history)
    return SurfaceLog(history) if isinstance(history, CondensedHistory) else VolumeLog(history, options)


def shear_form(a: Array, b: Array) -> Array:
    """``a : b/2`` for deviatoric stresses of unit shear modulus, far amplitudes behind; shape (points,)."""
    return 0.5 * np.einsum("i,ip,ip->p", forms.CONTRACTION, a[:-2].reshape(4, -1), b[:-2].reshape(4, -1))


def volume_form(space: HalfSpace) -> Form:
    """``p q`` at the quadrature points for pressures of unit bulk modulus, far amplitudes behind."""

    def form(a: Array, b: Array) -> Array:
        return at_points(space, a[:-2]) * at_points(space, b[:-2])

    return form


def at_points(space: HalfSpace, pressure: Array) -> Array:
    """Values at the quadrature points of a vector of the pressure space; shape (points,)."""
    return np.asarray(space.pressure_basis.interpolate(pressure)).ravel() if space.mixed else pressure


def _loss(dt: float, old: RelaxingField, new: RelaxingField, form: Form) -> Array:
    change = new.x - old.x
    squared = form(change, change)
    lost = np.zeros((len(old.branches), squared.size))
    if not 0.0 < dt < np.inf:
        return lost
    weights = old.modulus.loss_weights(dt)
    for k, (branch, modulus) in enumerate(zip(old.branches, old.modulus.moduli, strict=True)):
        first, second, third = weights[:, k]
        lost[k] = first / modulus * form(branch, branch) + second * form(branch, change)
        lost[k] += third * modulus * squared
    return lost
