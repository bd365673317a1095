"""The figures of a run that a command requests, into one folder.

``sections/QUANTITY_NNNN.png`` one a state, ``strip_QUANTITY.png`` the key moments, ``cycle_QUANTITY.gif`` the
whole run, ``revolution_QUANTITY_NNNN.png`` the body in three dimensions.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from contact_scene import Scene, SceneError, Trace
from validation.drawing.export import png
from validation.fields.figures import animation, moment_panels, moments, revolution
from validation.fields.figures.quantities import QUANTITIES, Quantity
from validation.fields.figures.rendering import NoRendering
from validation.fields.figures.single_section import alike, single_section
from validation.runs.files import in_words, write_whole

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from fem_solver.fields.states import FieldState

USUAL = ("von_mises", "stress_zz", "dissipation_rate")
"""Quantities drawn where none is named."""
FRAMES = 60
"""Of an animation."""
Progress = Callable[[float], None]


@dataclass(frozen=True)
class FigureSet:
    """What is to be drawn.

    Parameters
    ----------
    quantities : tuple of str
        Names in ``QUANTITIES``; animation, body of revolution and window show the first.
    moments : bool
        The key moments side by side.
    animate : bool
        An animation of the whole run.
    revolve : bool
        The body in three dimensions, of every state that gets a section.
    show : bool
        The last state in a window, where there is a screen.
    alike : bool
        One magnification, view and range of colours for all sections and bodies of revolution of the run.
    frames : int
        Of the animation.
    """

    quantities: tuple[str, ...] = USUAL
    moments: bool = False
    animate: bool = False
    revolve: bool = False
    show: bool = False
    alike: bool = False
    frames: int = FRAMES

    def __post_init__(self) -> None:
        for name in self.quantities:
            if name not in QUANTITIES:
                raise SceneError("--quantity", f"got {name!r:.40}", ", ".join(QUANTITIES))

    def check_without_history(self) -> None:
        """Refuse what a run does not know whose mesh follows the edge.

        Raises
        ------
        SceneError
            If such a quantity is to be drawn.
        """
        for name in self.quantities:
            if QUANTITIES[name].needs:
                problem = (
                    f"{name} is not known where the mesh follows the edge, as with so short a process zone"
                )
                allowed = ", ".join(other for other, one in QUANTITIES.items() if not one.needs)
                raise SceneError("--quantity", problem, allowed)

    @property
    def chooses_moments(self) -> bool:
        """Whether the figures choose moments of their own."""
        return self.moments or self.animate

    def rows(self, trace: Trace, scene: Scene) -> dict[int, str]:
        """Rows of a trace whose fields the figures need, and their labels."""
        frames = dict.fromkeys(moments.in_contact(trace, self.frames), "") if self.animate else {}
        key = moments.key_moments(trace, scene) if self.moments else {}
        return dict(sorted((frames | key).items()))

    def draw(
        self,
        folder: Path,
        states: Sequence[FieldState],
        trace: Trace,
        scene: Scene,
        progress: Progress,
        requested: Collection[int] = (),
    ) -> list[str]:
        """Draw, and report what was drawn, or why not.

        Parameters
        ----------
        folder : Path
        states : sequence of FieldState
            In order of time.
        trace : Trace
        scene : Scene
        progress : callable(float)
        requested : collection of int
            Rows of the trace that get a section although the animation shows them.

        Returns
        -------
        list of str
            Lines for a reader.

        Raises
        ------
        NoRendering
            If VTK cannot draw here, and more was requested than the sections drawn by default.
        """
        try:
            written = self._write(folder, states, trace, scene, progress, requested)
            lines = [f"drawn: {path} ({in_words(path.stat().st_size)})" for path in written]
            if (
                self.show
                and states
                and not revolution.interactive(_touching(states)[-1], scene, self._chosen[0])
            ):
                lines.append("no window: there is no screen")
        except NoRendering as error:
            if self.chooses_moments or self.revolve or self.show:
                raise
            return [f"no figures: {error}"]
        return lines

    def _write(
        self,
        folder: Path,
        states: Sequence[FieldState],
        trace: Trace,
        scene: Scene,
        progress: Progress,
        requested: Collection[int],
    ) -> list[Path]:
        """Draw everything but the window; states in contact only.

        Frames of the animation get a section only if labelled or requested.

        Parameters
        ----------
        folder, states, trace, scene, progress, requested
            As of :meth:`draw`.

        Returns
        -------
        list of Path
            What was written.
        """
        touching, key, first = _touching(states), moments.key_moments(trace, scene), self._chosen[0]
        moving = set(moments.in_contact(trace, self.frames)) if self.animate else set()
        single = [
            state for state in touching if state.label or state.row in requested or state.row not in moving
        ]
        common = {
            one.name: alike(single, scene, one) if self.alike and single else None for one in self._chosen
        }
        drawings: list[tuple[str, Callable[[], Figure]]] = []
        for state in single:
            for one in self._chosen:
                name = f"sections/{one.name}_{state.row:06d}.png"
                drawings.append((name, partial(single_section, state, scene, one, common[one.name])))
            if self.revolve:
                name = f"revolution/{first.name}_{state.row:06d}.png"
                shared = common[first.name]
                drawings.append((name, partial(revolution.figure, state, scene, first, shared)))
        named = [state for state in touching if state.row in key] if self.moments else []
        if named:
            drawings += [
                (f"strip_{one.name}.png", partial(moment_panels.figure, named, scene, one))
                for one in self._chosen
            ]
        written = []
        frames = [state for state in touching if state.row in moving]
        total = len(drawings) + len(frames)
        for count, (name, draw) in enumerate(drawings, 1):
            path = folder / name
            path.parent.mkdir(parents=True, exist_ok=True)
            write_whole(path, png(draw()))
            written.append(path)
            progress(count / total)
        if frames:
            path = folder / f"cycle_{first.name}.gif"
            begun = len(drawings) / total
            rest = partial(_rest, progress, begun)
            write_whole(path, animation.film(frames, trace, scene, first, rest))
            written.append(path)
        return written

    @property
    def _chosen(self) -> list[Quantity]:
        return [QUANTITIES[name] for name in self.quantities]


def _rest(progress: Progress, begun: float, done: float) -> None:
    progress(begun + (1.0 - begun) * done)


def _touching(states: Sequence[FieldState]) -> list[FieldState]:
    return [state for state in states if state.contact_radius > 0.0]
