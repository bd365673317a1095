"""What a run has become between two steps, taken out of it and put back."""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import TYPE_CHECKING, Any

from contact_scene import SurfaceProfile

if TYPE_CHECKING:
    from validation.reference.tracking.stepping import Run

# What follows from scene and options is made anew, and so is who listens.
_MADE_ANEW = (
    "scene", "body", "law", "options", "fineness", "record", "on_profile", "straight", "progress", "goes_on",
)  # fmt: skip


@dataclass
class Place:
    """Where a run stands in its loading.

    ``origin`` is time, penetration and force where the loading step began; ``begun``: its jump is behind;
    ``stop`` counts its declared times that are reached; ``under_way``: a step towards the next, ``proposed``,
    has been thought of.
    """

    step: int = 0
    origin: tuple[float, float, float] | None = None
    begun: bool = False
    stop: int = 0
    under_way: bool = False
    proposed: float = 0.0

    @property
    def fresh(self) -> bool:
        """Whether no loading step has been begun."""
        return self.step == 0 and self.origin is None

    def enter(self, time: float, penetration: float, force: float) -> tuple[float, float, float]:
        """Begin a loading step here, unless it has been begun before."""
        if self.origin is None:
            self.origin = (time, penetration, force)
        return self.origin

    def next_stop(self) -> None:
        """A declared time is reached."""
        self.stop, self.under_way = self.stop + 1, False

    def leave(self) -> None:
        """The loading step is done."""
        self.step, self.origin, self.begun, self.stop, self.proposed = self.step + 1, None, False, 0, 0.0


@dataclass(frozen=True)
class State:
    """All that changes in a run: by name, what its record has gathered, and its profiles."""

    moving: dict[str, Any]
    rows: list[tuple[float, ...]]
    kinks: list[int]
    inner: list[tuple[int, float, float | None]]
    profiles: list[SurfaceProfile]


def taken(run: Run, profiles: list[SurfaceProfile]) -> State:
    """The state of a run; it shares what will change."""
    names = [entry.name for entry in fields(run) if entry.name not in _MADE_ANEW]
    moving = {name: getattr(run, name) for name in names}
    return State(moving, run.record.rows, run.record.kinks, run.record.inner, profiles)


def put_back(state: State, run: Run, profiles: list[SurfaceProfile]) -> None:
    """Make a fresh run stand where the kept one stood."""
    for name, value in state.moving.items():
        setattr(run, name, value)
    run.record.rows, run.record.kinks, run.record.inner = state.rows, state.kinks, state.inner
    profiles[:] = state.profiles
