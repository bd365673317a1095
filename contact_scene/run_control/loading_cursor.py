"""The position of a run in its loading, and the times it has to step onto. No step size is chosen here."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass

from contact_scene.loading import Loading
from contact_scene.segment import Segment, passed


@dataclass(frozen=True)
class Stop:
    """A time inside or at the end of a load step that the run steps onto exactly.

    ``kink``: the rate of the load jumps there, or the load step ends. ``requested``: a time of
    ``stop_times`` or ``profile_times``.
    """

    time: float
    kink: bool
    requested: bool


def stops_within(segment: Segment, requested: Collection[float]) -> tuple[Stop, ...]:
    """Kinks of a load step, requested times strictly inside it, and its end, merged and ascending."""
    kinks = {*segment.kinks, segment.end}
    inside = {time for time in requested if segment.start < time < segment.end}
    return tuple(Stop(time, time in kinks, time in requested) for time in sorted(kinks | inside))


@dataclass
class LoadingCursor:
    """Position of a run in its loading: ``step`` load steps are done.

    ``trigger_side`` is the side of the level of its trigger, if any, on which the present load step is (see
    ``segment.passed``); ``None`` before it begins.
    """

    step: int = 0
    trigger_side: float | None = None

    def segment(self, loading: Loading, time: float, penetration: float, force: float) -> Segment:
        """The present load step on the time axis; it begins at the given state."""
        return loading.segment(loading.steps[self.step], time, penetration, force)

    def triggered(self, segment: Segment, penetration: float, force: float, radius: float) -> bool:
        """Whether a state has reached the level that ends the present load step.

        The first state asked about is that from which the load step begins.
        """
        if segment.trigger is None:
            return False
        excess = segment.trigger.excess(penetration, force, radius)
        if self.trigger_side is None:
            self.trigger_side = segment.trigger.side(excess)
        return passed(self.trigger_side, excess)

    def done(self, loading: Loading) -> bool:
        """Whether all load steps are done."""
        return self.step >= len(loading.steps)

    def level_reached(self) -> None:
        """The level that ends the present load step is reached, whatever rounding says."""
        self.trigger_side = 0.0

    def step_done(self) -> None:
        """The present load step is done."""
        self.step, self.trigger_side = self.step + 1, None

    def share(self, loading: Loading, segment: Segment, time: float) -> float:
        """Share of the loading that is done, 0 to 1, at a time within the present load step."""
        length = segment.end - segment.start
        return (self.step + ((time - segment.start) / length if length > 0.0 else 1.0)) / len(loading.steps)
