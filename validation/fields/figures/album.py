"""All figures of a run that were asked for, into one folder.

``sections/QUANTITY_NNNN.png`` one a state, ``strip_QUANTITY.png`` the key moments, ``cycle_QUANTITY.gif`` the
whole run, ``revolution_QUANTITY_NNNN.png`` the body in three dimensions.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from scene import Scene, Trace
from validation.fields.figures import animation, moments, revolution, sections, strip
from validation.fields.figures.geometry import magnification, section
from validation.fields.figures.quantities import QUANTITIES, Quantity
from validation.files import write_whole
from validation.report.figures import png

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from fem_solver.fields import FieldState

USUAL = ("von-mises", "stress-zz", "dissipation-rate")
FRAMES = 60
Progress = Callable[[float, str], None]


@dataclass(frozen=True)
class Album:
    """What is to be drawn.

    Parameters
    ----------
    quantities : tuple of str
        Names in ``QUANTITIES``.
    strip : bool
        The key moments side by side.
    animate : bool
        An animation of the whole run, of the first quantity.
    revolve : bool
        The body in three dimensions at each state drawn, of the first quantity.
    frames : int
        Of the animation.
    """

    quantities: tuple[str, ...] = USUAL
    strip: bool = False
    animate: bool = False
    revolve: bool = False
    frames: int = FRAMES

    def rows(self, trace: Trace, scene: Scene) -> dict[int, str]:
        """Rows of a trace whose fields the figures need, and their labels."""
        found = dict.fromkeys(moments.in_contact(trace, self.frames), "") if self.animate else {}
        return dict(sorted((found | (moments.key_moments(trace, scene) if self.strip else {})).items()))

    def write(
        self, folder: Path, states: Sequence[FieldState], trace: Trace, scene: Scene, progress: Progress
    ) -> list[Path]:
        """Draw; states in contact only, in the order of time.

        Raises
        ------
        NoRendering
            If VTK cannot draw here.
        """
        touching = [state for state in states if state.contact_radius > 0.0]
        key = moments.key_moments(trace, scene)
        chosen = [QUANTITIES[name] for name in self.quantities]
        moving = set(moments.in_contact(trace, self.frames)) if self.animate else set()
        single = [state for state in touching if state.row in key or state.row not in moving]
        written: list[Path] = []

        def keep(name: str, drawn: Figure) -> None:
            path = folder / name
            path.parent.mkdir(parents=True, exist_ok=True)
            write_whole(path, png(drawn))
            written.append(path)

        todo = len(single) * len(chosen)
        for count, state in enumerate(single):
            for number, quantity in enumerate(chosen):
                progress((count * len(chosen) + number) / todo, f"{quantity.name}, time {state.time:.6g}")
                keep(f"sections/{quantity.name}_{state.row:06d}.png", one_section(state, scene, quantity))
            if self.revolve:
                drawn = revolution.figure(state, scene, chosen[0])
                keep(f"revolution/{chosen[0].name}_{state.row:06d}.png", drawn)
        if self.strip:
            named = [state for state in touching if state.row in key]
            for quantity in chosen:
                keep(f"strip_{quantity.name}.png", strip.figure(named, scene, quantity))
        if self.animate:
            frames = [state for state in touching if state.row in moving]
            path = folder / f"cycle_{chosen[0].name}.gif"
            animation.write(path, frames, trace, scene, chosen[0], lambda done: progress(done, "animation"))
            written.append(path)
        progress(1.0, "figures drawn")
        return written


def one_section(state: FieldState, scene: Scene, quantity: Quantity) -> Figure:
    """The section of one state, with caption and a magnification of its own."""
    import numpy as np

    scale = magnification(float(np.abs(state.displacement).max()), state.contact_radius)
    length = moments.zone(scene, state.contact_radius)
    return sections.figure(section(state, scene, scale), quantity, length, strip.caption(state))
