"""What a run keeps of its history so that fields in the body can be had afterwards.

A constant Poisson's ratio asks for little: the surface vector ``w`` of every accepted step and the step's
length. Branch variables at any row, and the energy dissipated anywhere in the body up to it, follow by
replaying the recursion (see ``condensed``). Otherwise the internal variables live in the body: then only the
states asked for are kept whole, and the dissipation density is added up at the quadrature points on every
step, ``w_0 b.b/m + w_1 b.dx + w_2 m dx.dx`` per branch with the weights of ``Prony.loss_weights``.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from fem_solver import forms
from fem_solver.condensed import CondensedHistory, Response
from fem_solver.halfspace import HalfSpace
from fem_solver.history import History
from fem_solver.options import Options
from fem_solver.prony import Prony
from fem_solver.quadrature import QuadratureHistory, Relaxing

Array = NDArray[np.float64]
Form = Callable[[Array, Array], Array]

_ROUND_OFF = 1e-9  # of the largest tension: below it two tensions count as the same


@dataclass(frozen=True)
class VolumeState:
    """History in the body at one row.

    ``dissipated`` (branches, points) is the energy per volume lost so far, branches in shear before those in
    volume.
    """

    unknowns: Array
    shear: Relaxing
    volume: Relaxing
    dissipated: Array


@dataclass
class SurfaceLog:
    """Surface history of all rows: step lengths and surface vectors ``w`` (n,), in the order of the rows."""

    shear: Prony
    steps: list[tuple[float, Array]] = field(default_factory=list)

    @property
    def rows(self) -> int:
        """How many have been accepted."""
        return len(self.steps)

    def keep(self, row: int) -> None:
        """Nothing to do: all rows are kept."""

    def __contains__(self, row: int) -> bool:
        return 0 <= row < self.rows


@dataclass
class VolumeLog:
    """States of the rows that were asked for.

    ``every`` keeps each n-th row, ``wanted`` those named, ``pull_off`` the one of largest tension (of equals
    to round-off the last).
    """

    space: HalfSpace
    incompressible: bool
    every: int = 0
    wanted: frozenset[int] = frozenset()
    pull_off: bool = False
    kept: dict[int, VolumeState] = field(default_factory=dict)
    best: tuple[int, VolumeState] | None = None
    lowest: float = np.inf
    last: VolumeState | None = None
    rows: int = 0

    def keep(self, row: int) -> None:
        """Keep the last row."""
        if self.last is not None:
            self.kept[row] = self.last

    def accept(self, force: float, state: VolumeState) -> None:
        """One more row."""
        if self.pull_off and force <= self.lowest + _ROUND_OFF * abs(self.lowest):
            self.best, self.lowest = (self.rows, state), min(force, self.lowest)
        if self.rows in self.wanted or (self.every and self.rows % self.every == 0):
            self.kept[self.rows] = state
        self.last = state
        self.rows += 1

    def __contains__(self, row: int) -> bool:
        return row in self.kept or (self.best is not None and self.best[0] == row)

    def __getitem__(self, row: int) -> VolumeState:
        return self.best[1] if self.best is not None and self.best[0] == row else self.kept[row]


Log = SurfaceLog | VolumeLog


def watch(history: History, options: Options) -> tuple[History, Log]:
    """The same history, with a log of what it accepts as far as the options ask for it."""
    if isinstance(history, CondensedHistory):
        surface = SurfaceLog(history.shear)
        return _WatchedSurface(history, surface), surface
    if not isinstance(history, QuadratureHistory):
        raise TypeError(f"no log for a history of type {type(history).__name__}")
    volume = VolumeLog(
        history.space,
        history.bulk_modulus is None,
        options.record_every,
        frozenset(options.record_rows),
        options.record_pull_off,
    )
    return _WatchedVolume(history, volume), volume


class _Watched:
    """Passes everything on."""

    def __init__(self, history: CondensedHistory | QuadratureHistory) -> None:
        self._history = history

    def respond(self, dt: float) -> Response:
        return self._history.respond(dt)

    @property
    def dissipated(self) -> float:
        return self._history.dissipated

    @property
    def displacement(self) -> Array:
        return self._history.displacement

    @property
    def stored_energy(self) -> float:
        return self._history.stored_energy

    @property
    def state(self) -> object:
        return self._history.state


class _WatchedSurface(_Watched):
    def __init__(self, history: CondensedHistory, log: SurfaceLog) -> None:
        super().__init__(history)
        self._condensed, self._log = history, log

    def commit(self, dt: float, response: Response, forces: Array) -> None:
        self._condensed.commit(dt, response, forces)
        self._log.steps.append((dt, self._condensed.state.image))


class _WatchedVolume(_Watched):
    def __init__(self, history: QuadratureHistory, log: VolumeLog) -> None:
        super().__init__(history)
        self._body, self._log = history, log

    def commit(self, dt: float, response: Response, forces: Array) -> None:
        before = self._body.shear, self._body.volume
        self._body.commit(dt, response, forces)
        after = self._body.shear, self._body.volume
        lost = self._losses(dt, before, after)
        if self._log.last is not None:
            lost += self._log.last.dissipated
        self._log.accept(float(forces.sum()), VolumeState(self._body.unknowns, *after, lost))

    def _losses(
        self, dt: float, before: tuple[Relaxing, Relaxing], after: tuple[Relaxing, Relaxing]
    ) -> Array:
        """Energy per volume dissipated in each branch over one step; shape (branches, points)."""
        parts = [_loss(dt, before[0], after[0], shear_form)]
        if not self._log.incompressible:
            parts.append(_loss(dt, before[1], after[1], volume_form(self._log.space)))
        return np.concatenate(parts)


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


def _loss(dt: float, old: Relaxing, new: Relaxing, form: Form) -> Array:
    change = new.x - old.x
    driven = form(change, change)
    lost = np.zeros((len(old.branches), driven.size))
    if not 0.0 < dt < np.inf:
        return lost
    weights = old.modulus.loss_weights(dt)
    for k, (branch, modulus) in enumerate(zip(old.branches, old.modulus.moduli, strict=True)):
        first, second, third = weights[:, k]
        lost[k] = first / modulus * form(branch, branch) + second * form(branch, change)
        lost[k] += third * modulus * driven
    return lost
