"""Fits from Python: curves read or made, and what a fit found."""

from __future__ import annotations

import os
from argparse import Namespace
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import Executor
from contextlib import contextmanager
from dataclasses import dataclass
from html import escape
from pathlib import Path
from typing import TYPE_CHECKING, Any

from contact_scene import Scene, SceneError
from contact_scene.errors import shown
from contact_scene.files import as_target
from contact_scene.value_checks import as_tuple, function_or_none, of_class
from crosscontact import arguments
from crosscontact.arguments import case_of, checked_path
from crosscontact.result import html_table
from validation.fits import fit as fits
from validation.fits import page, readers
from validation.fits.parameters import FitSettings, question
from validation.fits.readers import Given, write_csv
from validation.fits.record import MeasuredCurve
from validation.fits.result import Estimate, FitResult, InterruptedFit
from validation.report.texts import aligned
from validation.runs.folder import claim, output_folder
from validation.runs.store import Store

if TYPE_CHECKING:
    from matplotlib.figure import Figure

Curve = MeasuredCurve | str | os.PathLike[str]
"""A curve, or the path of a file that holds some."""
_CURVES = "one or several MeasuredCurve, or paths of files"


class Fit:
    """What a fit found.

    Parameters
    ----------
    result : FitResult
        Everything, as it stands in ``fit.json``.

    Examples
    --------
    >>> curve = cc.synthetic(cc.builtin("cycle-v0.02"), noise=0.01)
    >>> found = cc.fit(curve, "cycle-v0.02", ["adhesion.work"], starts=1, check_solver=None)
    >>> found.scene.adhesion.work == found["adhesion.work"].value
    True
    """

    def __init__(self, result: FitResult) -> None:
        of_class(result, "result", FitResult, "a FitResult")
        self.result = result

    @property
    def scene(self) -> Scene:
        """The scene with the fitted numbers."""
        return self.result.scene

    @property
    def explained(self) -> bool:
        """Whether the model explains the data within their noise."""
        return self.result.goodness.explained

    @property
    def statements(self) -> list[str]:
        """What to know before using a number."""
        return page.statements(self.result)

    def __getitem__(self, name: str) -> Estimate:
        """A parameter by name: ``value``, ``deviation``, ``low`` and ``high`` of its 95 % interval.

        The standard deviation ``deviation`` is that of the logarithm, a share of ``value``, where
        ``logarithmic``, as of positive numbers of the scene; else it has the unit of ``value``.
        """
        for one in self.result.estimates:
            if one.name == name:
                return one
        names = ", ".join(one.name for one in self.result.estimates)
        raise SceneError("name", f"no parameter {shown(name)}", names)

    def figure(self) -> Figure:
        """Data, fit and residuals."""
        return page.draw_curves(self.result)

    def save(self, folder: str | os.PathLike[str]) -> None:
        """Write ``index.html``, ``fit.json``, ``scene.toml``, ``fit.png`` and ``fit.svg``."""
        page.write_fit(self.result, output_folder(checked_path(folder), "folder"))

    def __repr__(self) -> str:
        rows = aligned(page.table(self.result).texts)
        return "\n".join([page.lead(self.result).text, *rows, *(f"  {one}" for one in self.statements)])

    def _repr_html_(self) -> str:
        notes = "".join(f"<li>{escape(one)}</li>" for one in self.statements)
        rows = html_table(page.table(self.result).texts)
        return f"<p><b>{escape(page.lead(self.result).text)}</b></p>{rows}<ul>{notes}</ul>"


def fit(
    curves: Curve | Sequence[Curve],
    scene: Scene | str | os.PathLike[str],
    vary: Sequence[str] = (),
    *,
    tie: Sequence[str] = (),
    per_curve: Sequence[str] = (),
    free: Sequence[str] = (),
    prony: Sequence[float] = (),
    regularisation: float | None = None,
    starts: int = 3,
    seed: int = 0,
    profile: Sequence[str] = (),
    solver: str = arguments.REFERENCE,
    resolution: int | None = None,
    check_solver: str | None = "bem",
    max_steps: int | None = None,
    within: float | None = None,
    posterior: bool = False,
    executor: Executor | None = None,
    out: str | os.PathLike[str] | None = None,
    progress: Callable[[str], None] | None = None,
) -> Fit:
    """Fit numbers of a scene to measured curves.

    Parameters
    ----------
    curves : MeasuredCurve, path, or several of them
        Paths as of :func:`read_curves`.
    scene : Scene, str or path
        First guess and all that is known; its loading steps give way to the measured motions.
    vary : sequence of str
        Numbers of the scene by dotted path, each with bounds if wanted: ``"adhesion.work=0.01:1"``.
    tie : sequence of str
        ``"PATH=OTHER"``: the first keeps the ratio to the second that it has in the scene.
    per_curve : sequence of str
        Like ``vary``, with a value of its own for each curve.
    free : sequence of str
        Of each curve: ``contact_point``, ``time_offset``, and what the force is linear in: ``baseline``,
        ``drift``, or ``background`` (level, tilt over the position, drag with the speed, a wave).
    prony : sequence of float
        Relaxation times of a fixed grid whose moduli are fitted.
    regularisation : float, optional
        Weight of the bending of these moduli.
    starts, seed : int
        Starts of the search, and the seed of those that are drawn.
    profile : sequence of str
        Parameters whose profile likelihood is worked out; ``["all"]`` for all.
    solver : str
    resolution : int, optional
        By default the coarsest steps with an error of a twentieth of the noise.
    check_solver : str or None
        Solves the fitted curves once more.
    max_steps : int, optional
        Bounds accepted and rejected steps together; by default a bound that no sound run comes near.
    within : float, optional
        Share of the range of the force that the model may miss, where a white noise is no yardstick: 0.01.
    posterior : bool
        Sample the posterior about the best point: intervals of walkers beside those of the least squares.
    executor : Executor, optional
        Any of ``concurrent.futures``; carries out the runs of a derivative side by side.
    out : path, optional
        Folder of the results, from which an interrupted fit goes on.
    progress : callable, optional
        Called with a line of text at each point of the search.

    Returns
    -------
    Fit

    Raises
    ------
    SceneError
        One line, if data or arguments are no good.

    Examples
    --------
    >>> curve = cc.synthetic(cc.builtin("cycle-v0.02"), noise=0.01)
    >>> found = cc.fit(curve, "cycle-v0.02", ["adhesion.work"], starts=1, check_solver=None)
    >>> work = found["adhesion.work"]
    >>> work.low < 5.026548e-4 < work.high
    True
    """
    asked = locals()
    settings = FitSettings(**{name: asked[name] for name in FitSettings.__dataclass_fields__})
    return Fit(_work(curves, scene, settings, executor, out, progress).fit())


def fit_each(
    curves: Curve | Sequence[Curve],
    scene: Scene | str | os.PathLike[str],
    vary: Sequence[str] = (),
    *,
    executor: Executor | None = None,
    out: str | os.PathLike[str] | None = None,
    progress: Callable[[str], None] | None = None,
    **options: Any,
) -> Any:
    """Fit each curve by itself, from the answer of the explained one before it.

    Parameters
    ----------
    curves, scene, vary, executor, progress
        As of :func:`fit`.
    out : path, optional
        Folder of ``table.csv``, ``map.nc`` and the page.
    **options
        The others of :func:`fit`; by default without a second solver and further starts.

    Returns
    -------
    xarray.Dataset
        ``value``, ``deviation``, ``low`` and ``high`` over ``curve`` and ``parameter``; ``explained``,
        ``misfit_over_noise``, ``rms_over_range`` and ``failure`` over ``curve``.

    Raises
    ------
    SceneError
        One line, if arguments are no good or no curve can be fitted.

    Examples
    --------
    >>> curves = [cc.synthetic(cc.builtin("cycle-v0.02"), seed=seed, name=f"{seed}") for seed in (1, 2)]
    >>> table = cc.fit_each(curves, "cycle-v0.02", ["adhesion.work"])
    >>> table.value.shape
    (2, 1)
    """
    for name in options:
        if name not in FitSettings.__dataclass_fields__:
            raise SceneError(name, "is no option of a fit", ", ".join(FitSettings.__dataclass_fields__))
    asked: dict[str, Any] = {"vary": vary, "starts": 1, "check_solver": None}
    settings = FitSettings(**asked | options)
    return fits.dataset(_work(curves, scene, settings, executor, out, progress).each())


def _work(
    curves: Curve | Sequence[Curve],
    scene: Scene | str | os.PathLike[str],
    settings: FitSettings,
    executor: Executor | None,
    out: str | os.PathLike[str] | None,
    progress: Callable[[str], None] | None,
) -> FitWork:
    """What is given, checked, with the curves of files read."""
    alone = isinstance(curves, (MeasuredCurve, str, os.PathLike))
    measured: list[MeasuredCurve] = []
    for curve in (curves,) if alone else as_tuple(curves, "curves", _CURVES):
        of_class(curve, "curves", (MeasuredCurve, str, os.PathLike), _CURVES)
        measured += [curve] if isinstance(curve, MeasuredCurve) else read_curves(curve)
    of_class(executor, "executor", (Executor, type(None)), "an Executor of concurrent.futures, or None")
    function_or_none(progress, "progress", "a line of text")
    folder = None if out is None else output_folder(checked_path(out, "out"), "out")
    return FitWork(measured, case_of(scene).scene, settings, folder, executor, progress)


@dataclass(frozen=True)
class FitWork:
    """Curves, first guess and settings of a fit; who carries it out; and the folder of its results, if any,
    which the argument or option ``key`` names: it belongs to what is asked until all is done."""

    curves: list[MeasuredCurve]
    guess: Scene
    settings: FitSettings
    folder: Path | None = None
    executor: Executor | None = None
    progress: Callable[[str], None] | None = None
    key: str = "out"
    fresh: bool = False

    @contextmanager
    def _asked(self, kind: str) -> Iterator[tuple[Any, ...]]:
        """Arguments of a fit, with what is stored in the folder."""
        asked = self.curves, self.guess, self.settings
        if self.folder is not None:
            claim(self.folder, kind, question(*asked), self.key, self.fresh)
        store = Store(self.folder, self.fresh)
        yield *asked, self.executor, self.progress, store
        store.clear()

    def fit(self) -> FitResult:
        """Search; the result is written, of a stopped search too."""
        with self._asked("a fit") as asked:
            try:
                result = fits.fit_curves(*asked)
            except InterruptedFit as interrupted:
                if self.folder is not None and interrupted.result is not None:
                    page.write_fit(interrupted.result, self.folder)
                raise
            if self.folder is not None:
                page.write_fit(result, self.folder)
        return result

    def each(self) -> list[fits.EachFit]:
        """Fit each curve; what there is when it ends or is stopped is written."""
        found: list[fits.EachFit] = []
        with self._asked("fits of each curve") as asked:
            try:
                found.extend(fits.fit_each(*asked))
            finally:
                fitted = any(one.result for one in found)
                if self.folder is not None and fitted:
                    page.write_each(found, self.folder)
            if not fitted and found[0].refusal is not None:
                raise found[0].refusal
        return found


def read_curves(path: str | os.PathLike[str]) -> list[MeasuredCurve]:
    """All curves of a file as :func:`fit` takes them: tables in units of the scene, others in SI units.

    Examples
    --------
    >>> cc.write_curve(cc.synthetic(cc.builtin("elastic-relaxed")), "curve.csv")
    >>> [curve] = cc.read_curves("curve.csv")
    >>> curve.stage is None
    True
    """
    return readers.read_file(checked_path(path, "path"))


def read_curve(
    path: str | os.PathLike[str],
    *,
    spring_constant: float | None = None,
    sensitivity: float | None = None,
    sampling_rate: float | None = None,
    speed: float | None = None,
    enum: int | None = None,
    segment: str | None = None,
    columns: str | Mapping[str, Any] | None = None,
) -> MeasuredCurve:
    """One curve of an instrument's file, in SI units.

    Read are JPK (``.jpk-force``, ``-force-map``, ``-qi-data``, ``-qi-series``), Asylum ``.ibw``, ``.h5``,
    ``.tab``, AFM Workshop, NT-MDT (extra ``fit``), Nanoscope (where ``pyfmreader`` is installed), Chiaro and
    other tables of text, and ``.zip`` of these. What is stated here goes before what the file says.

    Parameters
    ----------
    path : str or path
    spring_constant : float, optional
        In N/m.
    sensitivity : float, optional
        Deflection over signal, in m/V.
    sampling_rate, speed : float, optional
        Rows a second, or the speed of the stage in m/s, where a file has no times.
    enum : int, optional
        Number of the curve, from 0; needed where the file holds several.
    segment : str, optional
        Only the longest ``approach``, ``pause`` or ``retract``; or ``"I:J"``, segments I to J - 1.
    columns : str or mapping, optional
        Of a table: ``"time=3,stage=1:1e-6,deflection=2:1e-9"``, number (from 1) or name of a column and the
        factor to SI; as a mapping ``{"stage": (1, 1e-6), ...}``.

    Returns
    -------
    MeasuredCurve

    Raises
    ------
    SceneError
        One line: what is wrong, or which of the arguments states what the file does not.
    ImportError
        If the package that reads such files is not installed.

    Examples
    --------
    >>> rows = "\\n".join(f"{t} {t - 9} {max(0, t - 9)}" for t in range(20))
    >>> _ = Path("a.txt").write_text(rows)
    >>> cc.read_curve("a.txt", spring_constant=0.1, columns="time=1,stage=2:1e-7,deflection=3:1e-9").stiffness
    0.1
    """
    asked = Namespace(**locals())
    curves = read_given(path, asked, si=True)
    if len(curves) > 1:
        raise SceneError("enum", f"{len(curves)} curves", f"one from 0 to {len(curves) - 1}", str(path))
    return curves[0]


def read_given(path: str | os.PathLike[str], options: Namespace, si: bool) -> list[MeasuredCurve]:
    """The curves of a file, as the options of a command read it: in SI units at least where they state
    something in these."""
    file = checked_path(path, "path")
    given = Given(**{name: getattr(options, name) for name in Given.__dataclass_fields__})
    curves = readers.read_file(file, given, si or given != Given())
    return readers.choose(curves, options.enum, options.segment, file)


def read_all(files: list[str], options: Namespace, si: bool) -> list[list[MeasuredCurve]]:
    """The curves of each of some files, as the options of a command read them."""
    try:
        return [read_given(file, options, si) for file in files]
    except ImportError as error:
        raise SceneError("", str(error), "a table of text, or the package") from None


def write_curve(curve: MeasuredCurve, path: str | os.PathLike[str]) -> None:
    """Write a curve: as CSV, or by its ending (``.h5``, ``.tab``) as a file that AFM programs open.

    Raises
    ------
    SceneError
        One line, if the path is none of a file that can be written.

    Examples
    --------
    >>> cc.write_curve(cc.synthetic(cc.builtin("elastic-relaxed")), "curve.csv")
    >>> Path("curve.csv").read_text().splitlines()[0]
    'time,penetration,force'
    """
    of_class(curve, "curve", MeasuredCurve, "a MeasuredCurve")
    file = as_target(path)
    if file.suffix.lower() in (*readers.READERS, ".spm", ".zip", ".txt"):
        readers.write_afm(curve, file)
    else:
        write_csv(curve, file)
