"""History of a run, recorded so that fields in the body can be computed afterwards.

With a constant Poisson's ratio the surface vector ``w`` of every accepted step and the step's length suffice.
Branch variables at any row, and the energy dissipated anywhere in the body up to it, follow by replaying the
recursion (see ``condensed``). Otherwise the internal variables live in the body: then only the requested
states are stored whole, and the dissipation density is summed at the quadrature points on every step,
``w_0 b.b/m + w_1 b.dx + w_2 m dx.dx`` per branch with the weights of ``Prony.loss_weights``.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fem_solver import forms
from fem_solver.condensed import CondensedHistory
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
        self.rows = 0
        self.stored: dict[int, VolumeState] = {}
        self.largest_tension: tuple[int, VolumeState] | None = None
        self._options = options
        self._lowest_force = np.inf
        self._internal = history.state
        self._dissipated: Array | float = 0.0
        self._before: tuple[Any, ...] | None = None

    @property
    def incompressible(self) -> bool:
        """Whether there is no volume strain."""
        return self.history.bulk_modulus is None

    def accept(self, dt: float, forces: Array) -> None:
        """One more row, which the history has accepted."""
        before, after = self._internal, self.history.state
        self._before = before, self._dissipated, self.largest_tension, self._lowest_force
        lost = [_loss(dt, before.shear, after.shear, shear_form)]
        if not self.incompressible:
            lost.append(_loss(dt, before.volume, after.volume, volume_form(self.history.space)))
        state = VolumeState(after, np.concatenate(lost) + self._dissipated)
        self._internal, self._dissipated = after, state.dissipated
        force, options = float(forces.sum()), self._options
        if options.record_pull_off and force <= self._lowest_force + _ROUND_OFF * abs(self._lowest_force):
            self.largest_tension = self.rows, state
            self._lowest_force = min(force, self._lowest_force)
        if self.rows in options.record_rows or (
            options.record_every and self.rows % options.record_every == 0
        ):
            self.stored[self.rows] = state
        self.rows += 1

    def drop_last(self) -> None:
        """The last row is taken back; once only until the next one."""
        if self._before is None:
            return
        self.rows -= 1
        self.stored.pop(self.rows, None)
        self._internal, self._dissipated, self.largest_tension, self._lowest_force = self._before
        self._before = None

    def store(self, row: int) -> None:
        """Store the last row, whose number this is."""
        self.stored[row] = VolumeState(self._internal, np.asarray(self._dissipated))

    def __contains__(self, row: int) -> bool:
        return row in self.stored or (self.largest_tension is not None and self.largest_tension[0] == row)

    def __getitem__(self, row: int) -> VolumeState:
        if self.largest_tension is not None and self.largest_tension[0] == row:
            return self.largest_tension[1]
        return self.stored[row]


HistoryLog = SurfaceLog | VolumeLog


def history_log(history: CondensedHistory | QuadratureHistory, options: Options) -> HistoryLog:
    """The log of a history that has not made a step."""
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
