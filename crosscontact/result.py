"""What a solver found on a scene: trace, measures, error estimates; as tables, figure, files."""

from __future__ import annotations

import base64
import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields, replace
from html import escape
from typing import TYPE_CHECKING, Any

from contact_scene import Outcome, Scene, Units
from contact_scene.value_checks import of_class, true_or_false
from crosscontact.arguments import checked_path
from validation.drawing import run_figures
from validation.drawing.figure import png
from validation.measure.scaling import SYMBOLS, kind_of, unit_name, unit_sizes
from validation.report.texts import aligned
from validation.runs.folder import output_folder
from validation.runs.run import Run, read_run, write_run

if TYPE_CHECKING:
    import pandas
    import xarray
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

INK: dict[str, Any] = {"color": "#0a0a0a", "linestyle": "-", "linewidth": 1.5}
"""Line of a figure that shows this result alone: black, whichever solver it comes from."""

KEY_MEASURES = (
    "approach_force",
    "approach_radius",
    "peak_force",
    "peak_time",
    "pull_off_force",
    "pull_off_penetration",
    "pull_off_radius",
    "detachment_time",
    "detachment_penetration",
    "loop_energy",
    "dissipated_energy",
)
"""Measures shown for every run."""
MACHINE_MEASURES = ("stage_at_detachment", "instability_loss")
"""Those shown after them where the machine is a spring: the last is the energy lost at snaps."""

SCALES_IN_WORDS = (
    "penetrations to the largest of the run, losses at least to the largest energy, else to the value"
)
"""What an error estimate is relative to, in short; in full: ``validation.measure.scaling``."""


@dataclass(frozen=True)
class ContactState:
    """Contact at one moment of a run, in units of the scene; ``None`` where the run has no such moment.

    Parameters
    ----------
    time, penetration, radius : float or None
        Penetration positive downwards.
    force : float or None
        Positive in compression; at pull-off the largest tension, positive.

    Examples
    --------
    >>> result = cc.solve("cycle-v0.02")
    >>> f"{result.pull_off.time:.2f}", f"{result.pull_off.radius:.4f}"
    ('2.47', '0.1285')
    """

    time: float | None
    penetration: float | None
    force: float | None
    radius: float | None


class Result:
    """What one solver found on one scene.

    Parameters
    ----------
    scene : Scene
    run : Run
        With a trace.

    Attributes
    ----------
    trace : Trace
        Time series, one row per accepted step, with profiles where asked for.
    name, solver : str
        Names of scene and solver.
    measures : dict
        Every scalar by name, as in ``summary.json``; ``None`` where it does not apply.
    errors : dict
        Relative error estimates by measure and by column; empty unless asked for.

    Examples
    --------
    >>> result = cc.solve("cycle-v0.02")
    >>> f"{result.measures['loop_energy']:.3e}", result.trace.time.shape == result.trace.force.shape
    ('4.745e-04', True)
    """

    def __init__(self, scene: Scene, run: Run) -> None:
        of_class(scene, "scene", Scene, "a Scene")
        of_class(run, "run", Run, "a Run")
        if run.trace is None:
            raise ValueError(f"{run.solver} gave no answer: {run.failure}")
        self.scene, self.run, self.trace = scene, run, run.trace
        self.name, self.solver = run.scene, run.solver
        self.measures, self.errors = run.measures, run.errors

    @property
    def outcome(self) -> Outcome:
        """How the run ended and why; ``outcome.finished`` tells a full answer from a partial one."""
        return self.trace.outcome

    @property
    def warnings(self) -> tuple[str, ...]:
        """Where the model comes to its limits in this run, one sentence each."""
        return self.run.warnings

    @property
    def approach(self) -> ContactState:
        """End of the approach: largest penetration of the run."""
        return self._state("approach")

    @property
    def pull_off(self) -> ContactState:
        """Largest tension."""
        return self._state("pull_off")

    @property
    def detachment(self) -> ContactState:
        """Last state in contact of a run that lost contact."""
        return self._state("detachment")

    @property
    def final(self) -> ContactState:
        """Last row of the trace; of a run that lost contact without force and radius."""
        return self._state("final")

    def _state(self, moment: str) -> ContactState:
        return ContactState(*(self.measures.get(f"{moment}_{entry.name}") for entry in fields(ContactState)))

    def to_pandas(self) -> pandas.DataFrame:
        """The trace as a table, one row per step; units and names in ``attrs``."""
        try:
            import pandas
        except ImportError:
            raise _missing("pandas") from None
        frame = pandas.DataFrame(self.trace.columns())
        frame.attrs |= self._attributes() | {"units": {name: self._unit(name) for name in frame.columns}}
        return frame

    def to_xarray(self) -> xarray.Dataset:
        """The trace over ``step``, with the time as a coordinate; units and names in ``attrs``."""
        try:
            import xarray
        except ImportError:
            raise _missing("xarray") from None
        variables = {
            name: ("step", column, {"units": self._unit(name), "long_name": name.replace("_", " ")})
            for name, column in self.trace.columns().items()
        }
        return xarray.Dataset(variables, attrs=self._attributes()).set_coords("time")

    def _unit(self, column: str) -> str:
        name, kind = unit_name(self.scene, column), kind_of(column)
        return f"{kind} in {name}" if kind and name == "scene units" else name

    def _attributes(self) -> dict[str, Any]:
        return {
            "scene": self.name,
            "title": self.scene.title,
            "solver": self.solver,
            "outcome": str(self.outcome.kind),
            "reason": self.outcome.reason,
        }

    def plot(
        self,
        axes: Axes | Sequence[Axes] | None = None,
        *,
        quantity: str | None = None,
        units: bool = False,
        data: Any = None,
        **line: Any,
    ) -> tuple[Axes, ...]:
        """Draw force against penetration and contact radius against force; the pull-off is marked.

        On a spring force against stage stands between them, and every instability is marked.

        Parameters
        ----------
        axes : two Axes, on a spring two or three, of a quantity one, optional
            Where to draw, e.g. what another result's ``plot`` returned; by default a new figure.
        quantity : str, optional
            Only this panel: ``"F(t)"``, ``"F(D)"``, ``"a(F)"``, or any other two of force ``F``, penetration
            ``D``, contact radius ``a``, time ``t`` and, on a spring, stage ``X``.
        units : bool
            In units of the scene, of a sphere too, whether the scene names them or not.
        data : MeasuredCurve, optional
            A record in the units of the scene, as :func:`crosscontact.read_curve` gives one: its rows stand
            behind the run, or before a line as broad as they are, in each panel whose quantities it holds,
            its times and positions as they are.
        **line
            Line properties of Matplotlib, e.g. ``color``; ``label`` and colour are by default the solver's;
            where the axes hold another run of that solver, the scene's name stands before it, and the colour
            is the next.

        Returns
        -------
        tuple of Axes
            Spheres in the paper's dimensionless quantities, unless the scene names its units, other shapes in
            units of the scene.
        """
        with_stage = run_figures.has_stage(self.trace)
        pairs = run_figures.drawn_pairs(quantity, with_stage)
        scene = self.scene
        if true_or_false(units, "units") and scene.units is None:
            scene = replace(scene, units=Units())
        if axes is None:
            axes = run_figures.new_figure(len(pairs)).axes
        panels = run_figures.checked_axes(axes, len(pairs))
        style = run_figures.run_line(panels[0], self.solver, self.name) | line
        pairs = pairs if len(panels) == len(pairs) else run_figures.side_by_side(False)
        if data is not None:
            run_figures.draw_measured(panels, data, scene, pairs)
        run_figures.draw_side_by_side(panels, self.trace, scene, style, pairs)
        return panels

    def figure(self) -> Figure:
        """Force over time and the panels of :meth:`plot` as a figure that no window shows, to be saved."""
        pairs = run_figures.side_by_side(run_figures.has_stage(self.trace))
        figure = run_figures.new_figure(1 + len(pairs), shown=False)
        over_time, *others = figure.axes
        self.plot(over_time, quantity="F(t)", **INK)
        self.plot(others, **INK)
        return figure

    def __repr__(self) -> str:
        rows = key_numbers(self.scene, self.measures, self.errors)
        return "\n".join([self._heading(), *aligned(rows), *(f"  warning: {text}" for text in self.warnings)])

    def _heading(self) -> str:
        return f"{self.name} by {self.solver}: {self.outcome.kind}: {self.outcome.reason}"

    def _repr_html_(self) -> str:
        rows = key_numbers(self.scene, self.measures, self.errors)
        in_words = [(name.replace("_", " "), *numbers) for name, *numbers in rows]
        picture = base64.b64encode(png(self.figure(), 80)).decode()
        return (
            f"<p><b>{escape(self._heading())}</b></p>"
            f'<img alt="{run_figures.in_words(run_figures.has_stage(self.trace))}" '
            f'src="data:image/png;base64,{picture}">'
            f"{html_table(in_words)}"
        )

    def save(self, folder: str | os.PathLike[str]) -> None:
        """Write ``scene.toml``, ``trace.csv`` and ``summary.json`` as the command line does.

        Profiles are not written. :func:`load` reads the folder back.
        """
        write_run(output_folder(checked_path(folder), "folder"), self.scene, self.run)


def _missing(package: str) -> ImportError:
    return ImportError(f"{package} is not installed: pip install 'crosscontact[data]'")


def key_numbers(
    scene: Scene, measures: Mapping[str, float | None], errors: Mapping[str, float]
) -> list[tuple[str, ...]]:
    """The key numbers of a run as rows under a head; columns in which there is nothing are left out."""
    units = unit_sizes(scene)
    rows = [("", f"in {scene.unit_names}", "dimensionless", "F/F_JKR", "error estimate")]
    for name in (*KEY_MEASURES, *(MACHINE_MEASURES if scene.loading.compliance > 0.0 else ())):
        kind, value = kind_of(name), measures.get(name)
        jkr = units.get("jkr-force") if kind == "force" else None
        if value is None:
            rows.append((name, "-", "", "", ""))
            continue
        scaled = f"{value / units[kind]:.6g} {SYMBOLS[kind]}" if kind in units else ""
        error = f"{errors[name]:.1e}" if name in errors else ""
        rows.append((name, f"{value:.8g}", scaled, "" if jkr is None else f"{value / jkr:.6g}", error))
    filled = [column for column in range(len(rows[0])) if any(row[column] for row in rows[1:])]
    return [tuple(row[column] for column in filled) for row in rows]


def html_table(rows: Sequence[Sequence[str]]) -> str:
    """The rows of a table as HTML; the first is its heading."""
    head, *body = rows
    cells = "".join(f"<th>{escape(name)}</th>" for name in head)
    lines = "".join(f"<tr>{''.join(f'<td>{escape(text)}</td>' for text in row)}</tr>" for row in body)
    return f"<table><thead><tr>{cells}</tr></thead><tbody>{lines}</tbody></table>"


def load(folder: str | os.PathLike[str]) -> Result:
    """Read what :meth:`Result.save` or ``crosscontact solve --out`` wrote, bit for bit.

    Raises
    ------
    SceneError
        One line, if a file is missing or damaged, or the run gave no answer.

    Examples
    --------
    >>> cc.solve("elastic-relaxed").save("out")
    >>> cc.load("out").pull_off == cc.solve("elastic-relaxed").pull_off
    True
    """
    return Result(*read_run(checked_path(folder)))
