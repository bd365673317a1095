"""``crosscontact material``: a file of material data as the table ``[material]`` of a scene."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING

from contact_scene import Material, SceneError
from contact_scene.files import read_text
from contact_scene.material_file import LARGEST_MISFIT, no_series_meets, read_material
from contact_scene.measured_moduli import RelaxationData
from contact_scene.prony import TOLERANCE, PronyFit, fit_prony, young_over
from contact_scene.readers import FORMATS, MEASURED, format_of, measured_data
from contact_scene.scene import write_material
from contact_scene.value_checks import one_of, positive
from crosscontact.commands.failures import warn
from crosscontact.tables import aligned
from validation.drawing.export import png, svg_file
from validation.drawing.material_figure import draw_fit, draw_series
from validation.execution.files import output_folder, write_whole

if TYPE_CHECKING:
    from matplotlib.figure import Figure

DOTS_PER_INCH = 110
"""Resolution of ``material.png``."""


def run(
    file: str,
    out: str | None,
    *,
    format: str | None = None,
    poisson: float = 0.5,
    modulus: float | None = None,
    tolerance: float | None = None,
    plot: bool = False,
) -> int:
    """Read a Prony series, or fit one to measured moduli; print it, write and draw what is asked for.

    Parameters
    ----------
    file : str
        In one of the formats of :mod:`contact_scene.readers`.
    out : str or None
        Folder of ``material.toml``, if it is to be written.
    format : str or None
        One of ``FORMATS``; ``None``: told by the columns.
    poisson : float
        Poisson's ratio, for the table and to turn shear moduli into Young's.
    modulus : float or None
        Relaxed Young's modulus, where the file has none.
    tolerance : float or None
        As of :func:`contact_scene.prony.fit_prony`; ``None``: ``TOLERANCE``.
    plot : bool
        Whether ``material.png`` and ``material.svg`` are drawn, into ``out`` or the current folder.

    Returns
    -------
    int
        1 if no series meets the data, or they do not determine it, else 0; bad input raises.
    """
    text = read_text(Path(file))
    kind = format_of(text, file) if format is None else one_of(format, "--format", FORMATS)
    if tolerance is not None and kind not in MEASURED:
        raise SceneError("--tolerance", f"given for a Prony series ({kind})", "with measured data only", file)
    folder = None if out is None else output_folder(out)
    drawn = (output_folder(".", "--plot") if folder is None else folder) if plot else None
    fit: PronyFit | None = None
    material: Material | None = None
    doubts: list[str] = []
    if kind in MEASURED:
        allowed_misfit = TOLERANCE if tolerance is None else tolerance
        fit = _fit(text, file, kind, poisson, modulus, allowed_misfit)
        material = fit.material(poisson) if fit.modulus else None
        lines = _fit_lines(file, fit)
        doubts = _doubts(fit, allowed_misfit)
    else:
        material = read_material(file, poisson, modulus, kind)
        lines = [f"{file}: Prony series ({kind}) of {len(material.branches)} branches"]
    print("\n".join([*lines, *_series_lines(material)]))
    if drawn is not None and fit is not None:
        _draw(draw_fit(fit), drawn)
    elif drawn is not None and material is not None:
        _draw(draw_series(material), drawn)
    if folder is not None:
        if material is None:
            allowed = "the relaxed Young's modulus, > 0"
            raise SceneError("--modulus", "is missing: the data show no relaxed modulus", allowed, file)
        write_material(material, folder / "material.toml", "\n".join([*lines, *doubts]))
        print(f"written to {folder / 'material.toml'}")
    for doubt in doubts:
        print(f"crosscontact: {file}: {doubt}", file=sys.stderr)
    return 1 if doubts else 0


def _fit(
    text: str, file: str, kind: str, poisson: float, modulus: float | None, tolerance: float
) -> PronyFit:
    """The series fitted to measured moduli.

    Parameters
    ----------
    text, file : str
        Contents and name of the file.
    kind : str
        One of ``MEASURED``.
    poisson : float
    modulus : float or None
        Relaxed Young's modulus, if given.
    tolerance : float
        As of :func:`contact_scene.prony.fit_prony`.

    Returns
    -------
    PronyFit
    """
    data = measured_data(text, file, kind)
    scale = young_over(data.shear, poisson)
    relaxed = None if modulus is None else positive(modulus, "--modulus") / scale
    least = scale * float((data.moduli if isinstance(data, RelaxationData) else data.storage).min())
    if modulus is not None and modulus > least:
        warn([f"--modulus {modulus:g} is above the smallest Young's modulus of {file}, {least:g}"])
    try:
        return fit_prony(data, relaxed=relaxed, tolerance=tolerance)
    except SceneError as error:
        raise error if error.key else error.in_file(file) from None


def _doubts(fit: PronyFit, tolerance: float) -> list[str]:
    """Why the series is not one of the data, a line each: a misfit above what a scene or the user allows, or
    more numbers than were measured."""
    largest, found = max(LARGEST_MISFIT, tolerance), []
    if fit.misfit > largest:
        found.append(f"{no_series_meets(fit)}; allowed: a misfit of at most {largest:g}")
    if not fit.determined:
        few = f"{fit.residuals.size} measured moduli do not determine {fit.unknowns} numbers of the series"
        found.append(f"{few}; allowed: at least as many moduli, or a coarser --tolerance")
    return found


def _fit_lines(file: str, fit: PronyFit) -> list[str]:
    """What was read, how the series meets it, and what was dropped, in lines."""
    letter, data = "shear modulus" if fit.data.shear else "Young's modulus", fit.data
    if isinstance(data, RelaxationData):
        read, rows = f"relaxation {letter} over time", data.times.size
    else:
        read, rows = f"storage and loss {letter} over angular frequency", data.storage.size
    lines = [f"{file}: {read}, {rows} rows"]
    lines += aligned(
        [
            ("misfit", f"{fit.misfit:.3e}", "root mean square of fit/measured - 1"),
            ("largest residual", f"{fit.largest_residual:.3e}", ""),
            ("times tried", f"{fit.grid.size}", f"from {fit.grid[0]:.4g} to {fit.grid[-1]:.4g}"),
            ("branches", f"{len(fit.branches)}", f"{fit.used} times in use, joined to {fit.joined}"),
            ("dropped", f"{len(fit.dropped)}", ""),
        ]
    )
    for one in fit.dropped:
        of, change = one.branch, f"misfit {one.misfit_before:.3e} -> {one.misfit_after:.3e}"
        lines.append(f"  dropped: time {of.time:.6g}, {letter} {of.modulus:.6g}: {change}")
    if fit.modulus == 0.0:
        lines.append("  the data show no relaxed modulus; a scene needs one: --modulus")
    return lines


def _series_lines(material: Material | None) -> list[str]:
    """The series as a scene takes it, in lines."""
    if material is None:
        return []
    rows: list[tuple[str, ...]] = [
        ("poisson", f"{material.poisson:.8g}", ""),
        ("relaxed modulus", f"{material.modulus:.8g}", ""),
        ("glassy modulus", f"{material.glassy_modulus:.8g}", ""),
        ("", "branch modulus", "time"),
    ]
    rows += [
        (str(number), f"{branch.modulus:.8g}", f"{branch.time:.8g}")
        for number, branch in enumerate(material.branches, 1)
    ]
    return aligned(rows)


def _draw(figure: Figure, folder: Path) -> None:
    """``material.png`` and ``material.svg``."""
    write_whole(folder / "material.png", png(figure, DOTS_PER_INCH))
    write_whole(folder / "material.svg", svg_file(figure))
    print(f"drawn in {folder / 'material.png'} and {folder / 'material.svg'}")
