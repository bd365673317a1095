"""A material from a file, in any of the formats of :mod:`contact_scene.readers`."""

from __future__ import annotations

import os

from contact_scene.errors import SceneError
from contact_scene.files import as_path, read_text
from contact_scene.material import Material
from contact_scene.prony import PronyFit, fit_prony, series_material, young_over
from contact_scene.pyvisco import read_pyvisco
from contact_scene.readers import FORMATS, MEASURED, branch_table, format_of, measured_data
from contact_scene.value_checks import one_of, positive

LARGEST_MISFIT = 0.05
"""Root mean square of the relative residuals up to which measured data become a material without a look at
the fit. Rheometers scatter by less: beyond it no series meets the data."""


def read_material(
    path: str | os.PathLike[str],
    poisson: float = 0.5,
    modulus: float | None = None,
    format: str | None = None,
) -> Material:
    """A material from a Prony series or from measured moduli, which are fitted.

    Parameters
    ----------
    path : str or path
        A regular text file of at most 10 MB, in units of the scene.
    poisson : float
        Poisson's ratio; turns shear moduli into Young's.
    modulus : float, optional
        Relaxed Young's modulus. Needed where the file has none: modes of RepTate, plain tables of branches,
        measured data that go on relaxing to the end, some tables of pyvisco.
    format : str, optional
        One of ``FORMATS``; told by the columns of the file otherwise.

    Returns
    -------
    Material

    Raises
    ------
    SceneError
        One line: file, line or column, what is wrong, what is allowed.
    """
    text, file = read_text(as_path(path)), str(path)
    kind = format_of(text, file) if format is None else one_of(format, "format", FORMATS)
    if kind == "pyvisco":
        relaxed, branches = read_pyvisco(text, file, modulus, poisson)
        return Material(relaxed, poisson, branches)
    if kind in MEASURED:
        return _fitted(text, file, kind, poisson, modulus)
    table = branch_table(text, file, kind)
    if modulus is None:
        raise SceneError("modulus", f"{file} has no relaxed modulus", "the relaxed Young's modulus, > 0")
    relaxed = positive(modulus, "modulus") / young_over(table.shear, poisson)
    return series_material(relaxed, table.branches, poisson, table.shear)


def _fitted(text: str, file: str, format: str, poisson: float, modulus: float | None) -> Material:
    data = measured_data(text, file, format)
    scale = young_over(data.shear, poisson)
    try:
        fit = fit_prony(data, relaxed=None if modulus is None else positive(modulus, "modulus") / scale)
        material = fit.material(poisson)
    except SceneError as error:
        raise error if error.key == "modulus" else error.in_file(file) from None
    if fit.misfit > LARGEST_MISFIT:
        raise SceneError(
            "",
            no_series_meets(fit),
            f"a misfit of at most {LARGEST_MISFIT:g}; `crosscontact material {file} --plot` draws it",
            file,
        )
    return material


def no_series_meets(fit: PronyFit) -> str:
    """What is wrong with data that the best series misses."""
    return f"no Prony series meets the data: misfit {fit.misfit:.2g}, at most {fit.largest_residual:.2g}"
