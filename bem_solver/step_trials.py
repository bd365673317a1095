"""Trials of one step on graded annuli: its end for any edge, and any shorter step.

Nothing is committed here.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import NamedTuple

from bem_solver.bent_path import EarlierRow
from bem_solver.outer_fall import OuterFall
from bem_solver.run_state import StepStart
from bem_solver.step_control import AcceptedRow
from bem_solver.step_error import least_bent_travel
from bem_solver.trial import EDGE_ACCURACY, TrialContact, evaluate

_CLOSURE_ACCURACY = 1e-2
"""Accuracy of the closure, in step tolerances of the work of adhesion: far below the step error."""
_SHARE_OF_STEP = 0.4
"""Least time between the rows of a parabola, in the step it is to tell of: steps double at most."""


class _StepEnd(NamedTuple):
    """End of a trial step but for the edge, as :func:`~bem_solver.trial.evaluate` takes it."""

    duration: float
    value: float
    earlier: EarlierRow | None
    within: tuple[float, float] | None


@dataclass(frozen=True)
class StepTrials(StepStart):
    """A step of length ``step`` from the committed state along a loading interval."""

    step: float
    _ends: dict[float, _StepEnd] = field(init=False, compare=False, default_factory=dict)

    @property
    def end(self) -> float:
        """Parameter at the end; that of the interval exactly."""
        parameter, length = self.state.parameter, self.interval.length
        return length if self.step == length - parameter else parameter + self.step

    @property
    def edge_accuracy(self) -> float:
        """Accuracy of the edge."""
        return EDGE_ACCURACY * self.settings.tolerance * self.problem.length_at(self.state.contact.edge)

    @property
    def closure_accuracy(self) -> float:
        """Accuracy of the closure, relative to the work of adhesion."""
        return _CLOSURE_ACCURACY * self.settings.tolerance

    @property
    def residual_accuracy(self) -> float:
        """Accuracy of the residual; without adhesion it has none."""
        return self.closure_accuracy * self.problem.work or math.inf

    def trial(self, parameter: float, edge: float) -> TrialContact:
        """The trial that ends at a parameter within the step, with the edge at ``edge``."""
        if parameter not in self._ends:
            self._ends[parameter] = self._end(parameter)
        end, control = self._ends[parameter], self.interval.control
        return evaluate(
            self.problem, self.state.contact, end.duration, edge, control, end.value, end.earlier, end.within
        )

    def _end(self, parameter: float) -> _StepEnd:
        """What trials that end at a parameter have in common."""
        interval = self.interval
        duration = 0.0 if interval.jump else interval.time(parameter) - self.state.contact.time
        within = None
        if interval.control == "penetration" and duration > 0.0:
            share = self.problem.chain.share_to_meet(duration)
            start = self.state.parameter
            within = share * duration, interval.prescribed(start + share * (parameter - start))
        return _StepEnd(duration, interval.prescribed(parameter), self._earlier(duration), within)

    def _earlier(self, duration: float) -> EarlierRow | None:
        """The row before the last, with its edge where the step takes the edge far enough for a curved path.

        Over less its path is straight: the condition at the end of the step is then one on the place of the
        edge, and a parabola through earlier rows carries their errors on. Not so a penetration that creeps
        and is sought at the end of the step, and the load ahead of the edge: they always are parabolas.
        """
        rows, edge = self.state.accepted.rows, self.state.contact.edge
        if duration == 0.0 or len(rows) < 2 or not self.problem.viscoelastic:
            return None
        before, last = rows[-2:]
        travel = abs(last.edge - before.edge) / (last.parameter - before.parameter) * duration
        if not self.problem.curves or travel < least_bent_travel(self, edge):
            return self._as_earlier(self.state.accepted.earlier(_SHARE_OF_STEP * duration))
        further = None
        if len(rows) > 2 and last.edge < before.edge < rows[-3].edge:
            further = last.parameter - rows[-3].parameter, rows[-3].edge
        curved = self._as_earlier(before)
        return replace(
            curved,
            load=before.edge_load,
            ahead=0.0,
            fall=self._fall,
            further=further,
            of_travel=self.state.accepted.time_is_smoother,
        )

    def _as_earlier(self, row: AcceptedRow) -> EarlierRow:
        """An accepted row as the earlier one of a parabola."""
        interval, time = self.interval, self.state.accepted.rows[-1].parameter - row.parameter
        penetration = row.load if interval.control == "force" else interval.prescribed(row.parameter)
        if interval.control == "stage":
            penetration -= self.problem.scene.loading.compliance * row.load
        if not self.problem.curves:
            return EarlierRow(time, penetration)
        return EarlierRow(time, penetration, row.edge, row.load_ahead, self.problem.ahead)

    @cached_property
    def _fall(self) -> OuterFall:
        """Fall of the load outside the edge at the start."""
        return OuterFall.outside(self.state.contact.surface, self.problem.nearest)
