"""``crosscontact material``: a file of material data as the table ``[material]`` of a scene."""

from __future__ import annotations

import argparse
from functools import partial

from contact_scene import Material, SceneError, material_file
from contact_scene.prony import TOLERANCE, DynamicData, PronyFit, RelaxationData, fit_prony, young_over
from contact_scene.scene import write_material
from contact_scene.value_checks import positive
from crosscontact.commands import shared
from crosscontact.commands.shared import flag, value
from validation.drawing.material_figure import draw_fit, draw_series
from validation.report.texts import aligned
from validation.runs.folder import output_folder

OPTIONS = {
    "file": value("FILE", "a series (pyvisco, RepTate, columns tau, E) or data (columns t, E or w, E', E'')"),
    "--format": value("NAME", "of FILE; default: told by its columns"),
    "--poisson": value("NU", "default: %(default)s", type=float, default=0.5),
    "--modulus": value("E0", "relaxed Young's modulus, where FILE has none", type=float),
    "--tolerance": value(
        "X",
        "drop branches as long as the misfit (relative, root mean square) stays below X; of data that "
        "scatter by more, as long as Schwarz' criterion prefers the shorter series; default: 0.001",
        type=float,
    ),
    "--out": value("DIR", "write material.toml, the table of a scene, there"),
    "--plot": flag("draw material.png and .svg, into --out or the current folder"),
}


def run(options: argparse.Namespace, jobs: int) -> int:
    """Read a Prony series, or fit one to measured moduli; 1 if none meets the data, or they do not determine
    it."""
    file, poisson, modulus = options.file, options.poisson, options.modulus
    text, file, kind = material_file.text_and_format(file, options.format, "--format")
    if options.tolerance is not None and kind not in material_file.MEASURED:
        raise SceneError("--tolerance", f"given for a Prony series ({kind})", "with measured data only", file)
    folder = None if options.out is None else output_folder(options.out)
    drawn = (folder or output_folder(".", "--plot")) if options.plot else None
    doubts: list[str] = []
    if kind in material_file.MEASURED:
        tolerance = TOLERANCE if options.tolerance is None else options.tolerance
        fit = _fit(material_file.measured_data(text, file, kind), file, poisson, modulus, tolerance)
        material = fit.material(poisson) if fit.modulus else None
        lines, doubts, figure = _fit_lines(file, fit), _doubts(fit, tolerance), partial(draw_fit, fit)
    else:
        material = material_file.read_material(file, poisson, modulus, kind)
        lines = [f"{file}: Prony series ({kind}) of {len(material.branches)} branches"]
        figure = partial(draw_series, material)
    print("\n".join([*lines, *_series_lines(material)]))
    if drawn is not None:
        shared.draw(figure(), drawn, "material")
    if folder is not None and material is None:
        problem = "is missing: the data show no relaxed modulus"
        raise SceneError("--modulus", problem, "the relaxed Young's modulus, > 0", file)
    if folder is not None and material is not None:
        write_material(material, folder / "material.toml", "\n".join([*lines, *doubts]))
        print(f"written to {folder / 'material.toml'}")
    return shared.failed([f"crosscontact: {file}: {doubt}" for doubt in doubts])


def _fit(
    data: RelaxationData | DynamicData, file: str, poisson: float, modulus: float | None, tolerance: float
) -> PronyFit:
    """The series fitted to measured moduli."""
    scale = young_over(data.shear, poisson)
    relaxed = None if modulus is None else positive(modulus, "--modulus") / scale
    least = scale * float((data.moduli if isinstance(data, RelaxationData) else data.storage).min())
    if modulus is not None and modulus > least:
        shared.warn([f"--modulus {modulus:g} is above the smallest Young's modulus of {file}, {least:g}"])
    try:
        return fit_prony(data, relaxed=relaxed, tolerance=tolerance)
    except SceneError as error:
        raise error if error.key else error.in_file(file) from None


def _doubts(fit: PronyFit, tolerance: float) -> list[str]:
    """Why the series is not one of the data, a line each: a misfit above what a scene or the user allows, or
    more numbers than were measured."""
    largest, found = max(material_file.LARGEST_MISFIT, tolerance), []
    if fit.misfit > largest:
        found.append(f"{material_file.no_series_meets(fit)}; allowed: a misfit of at most {largest:g}")
    if not fit.determined:
        few = f"{fit.residuals.size} measured moduli do not determine {fit.unknowns} numbers of the series"
        found.append(f"{few}; allowed: at least as many moduli, or a coarser --tolerance")
    return found


def _fit_lines(file: str, fit: PronyFit) -> list[str]:
    """What was read, how the series meets it, and what was dropped, in lines."""
    letter = "shear modulus" if fit.data.shear else "Young's modulus"
    what, over = "storage and loss", "angular frequency"
    if isinstance(fit.data, RelaxationData):
        what, over = "relaxation", "time"
    rows = [
        ("misfit", f"{fit.misfit:.3e}", "root mean square of fit/measured - 1"),
        ("largest residual", f"{fit.largest_residual:.3e}", ""),
        ("times tried", f"{fit.grid.size}", f"from {fit.grid[0]:.4g} to {fit.grid[-1]:.4g}"),
        ("branches", f"{len(fit.branches)}", f"{fit.used} times in use, joined to {fit.joined}"),
        ("dropped", f"{len(fit.dropped)}", ""),
    ]
    lines = [f"{file}: {what} {letter} over {over}, {fit.data.points.size} rows", *aligned(rows)]
    for one in fit.dropped:
        of, change = one.branch, f"misfit {one.misfit_before:.3e} -> {one.misfit_after:.3e}"
        lines.append(f"  dropped: time {of.time:.6g}, {letter} {of.modulus:.6g}: {change}")
    missing = ["  the data show no relaxed modulus; a scene needs one: --modulus"]
    return [*lines, *(missing if fit.modulus == 0.0 else [])]


def _series_lines(material: Material | None) -> list[str]:
    """The series as a scene takes it, in lines."""
    if material is None:
        return []
    stated = {
        "poisson": material.poisson,
        "relaxed modulus": material.modulus,
        "glassy modulus": material.glassy_modulus,
    }
    rows = [(name, f"{value:.8g}", "") for name, value in stated.items()]
    rows.append(("", "branch modulus", "time"))
    for number, branch in enumerate(material.branches, 1):
        rows.append((str(number), f"{branch.modulus:.8g}", f"{branch.time:.8g}"))
    return aligned(rows)
