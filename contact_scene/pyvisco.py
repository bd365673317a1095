"""Prony series as pyvisco writes them: a CSV of relaxation times and normalised moduli.

The coefficient table of pyvisco 2.1 (``df_prony.csv``, ``df_prony_min.csv``; the same columns whether the fit
was made in the time or in the frequency domain) has a row of names, a row of units and one row per branch::

    i,tau_i,alpha_i,E_0,E_i
    -,s,-,MPa,MPa
    1,0.01,0.45,10.95,4.9275
    ...

``tau_i`` is a *relaxation* time, ``E_0`` the **instantaneous** (glassy) modulus, the same in every row, and
``alpha_i = E_i/E_0``, so that ``E(t) = E_0 (1 - sum_i alpha_i + sum_i alpha_i exp(-t/tau_i))``. ``E0`` in the
paper and in this package is the relaxed modulus, ``E_0 (1 - sum_i alpha_i)``. Shear fits say ``G_0, G_i``
instead; then ``E = 2 (1 + nu) G``.

Numbers are taken as they stand: the scene's unit of time is the file's, and its unit of stress too, unless
the scene gives ``modulus``. Fits in the frequency domain usually end with ``sum_i alpha_i = 1``: nothing is
left for the relaxed modulus, and the scene has to give it.
"""

from __future__ import annotations

import math
from typing import Any

from contact_scene.errors import SceneError, cell_shown
from contact_scene.files import read_rows
from contact_scene.material import Branch
from contact_scene.separators import check_head
from contact_scene.units import check_units
from contact_scene.value_checks import number, positive

CONTRADICTION = 0.01
"""Difference of ``E_i`` from ``alpha_i E_0``, relative to ``E_0``, from which on they contradict each other:
a table rounded to two digits passes."""
EXHAUSTED = 1e-6
"""If ``1 - sum alpha_i`` is below this, it is rounding in the file, not a relaxed modulus."""


def read_pyvisco(text: str, file: str, modulus: Any, poisson: Any) -> tuple[float, tuple[Branch, ...]]:
    """Relaxed Young's modulus and branches from the text of a pyvisco coefficient file.

    Parameters
    ----------
    text : str
        Contents of the CSV: columns ``tau_i`` and ``alpha_i`` (or ``E_i`` and ``E_0``); others are ignored.
    file : str
        Its name, for errors.
    modulus : float or None
        ``None``: the scale is the file's ``E_0``, and the relaxed modulus ``E_0 (1 - sum alpha_i)``.
        Otherwise the relaxed Young's modulus, from which the instantaneous one follows as
        ``modulus/(1 - sum alpha_i)``, and ``E_0`` is not used. If ``sum alpha_i = 1`` that ratio says
        nothing: then the instantaneous modulus is ``E_0``, and the branches share ``E_0 - modulus``.
    poisson : float
        Poisson's ratio; turns shear moduli into Young's.

    Returns
    -------
    modulus : float
        Relaxed Young's modulus.
    branches : tuple of Branch
        In the order of the file.

    Raises
    ------
    SceneError
        One line naming the file, and the row and column where there is one.
    """
    times, fractions, instantaneous = _table(text, file)
    if instantaneous is not None and instantaneous[0] == "G":
        nu = number(poisson, "poisson", "0 <= nu <= 0.5", low=0.0, high=0.5)
        glassy: float | None = 2.0 * (1.0 + nu) * instantaneous[1]
    else:
        glassy = None if instantaneous is None else instantaneous[1]
    total = math.fsum(fractions)
    exhausted = 1.0 - total < EXHAUSTED

    if modulus is None:
        if glassy is None:
            raise SceneError(
                "E_0",
                "the file has no such column",
                "E_0 (or G_0) in the file, or modulus in the scene",
                file,
            )
        if exhausted:
            raise SceneError(
                "alpha_i",
                "the sum is 1, which leaves nothing for the relaxed modulus",
                "a sum below 1, or the relaxed modulus as modulus in the scene",
                file,
            )
        relaxed, scale = glassy * (1.0 - total), glassy
    else:
        relaxed = positive(modulus, "modulus")
        if not exhausted:
            scale = relaxed / (1.0 - total)
        elif glassy is None or glassy <= relaxed:
            instead = "the file has no E_0" if glassy is None else f"got {relaxed:g}, and E_0 is {glassy:g}"
            raise SceneError("modulus", instead, "a relaxed modulus below E_0, as the sum of alpha_i is 1")
        else:
            scale = (glassy - relaxed) / total
    return relaxed, tuple(Branch(scale * a, tau) for a, tau in zip(fractions, times, strict=True))


def _table(text: str, file: str) -> tuple[list[float], list[float], tuple[str, float] | None]:
    """Relaxation times, fractions, and the instantaneous modulus with its letter (E or G), if given."""
    (line, header), *rows = read_rows(text, file)
    check_head(line, header, ("tau_i",), file)
    letter = next((m for m in "EG" if f"{m}_0" in header or f"{m}_i" in header), "E")
    names = [n for n in ("tau_i", "alpha_i", f"{letter}_0", f"{letter}_i") if n in header]
    if "tau_i" not in names or not ("alpha_i" in names or {f"{letter}_0", f"{letter}_i"} <= set(names)):
        raise SceneError(
            "columns",
            f"got {cell_shown(','.join(header))}",
            "tau_i and alpha_i, E_0, E_i (or G_0, G_i), as in a pyvisco coefficient file",
            file,
        )
    if len(set(header)) < len(header):
        raise SceneError(
            "columns", f"a name comes twice: {cell_shown(','.join(header))}", "distinct names", file
        )
    if rows and _is_units(rows[0][1]):
        units = dict(zip(header, rows[0][1], strict=False))
        held = {"tau_i": "relaxation time", f"{letter}_0": "modulus", f"{letter}_i": "modulus"}
        stated = [(kind, units[name]) for name, kind in held.items() if name in units]
        check_units(stated, f"line {rows[0][0]}", file)
        rows = rows[1:]
    if not rows:
        raise SceneError("tau_i", "no rows of numbers", "one row per branch", file)

    columns: dict[str, list[float]] = {name: [] for name in names}
    for line, cells in rows:
        if len(cells) != len(header):
            raise SceneError(f"line {line}", f"{len(cells)} cells", f"{len(header)}, as in the header", file)
        for name in names:
            columns[name].append(_cell(cells[header.index(name)], name, line, file))

    modulus = columns.get(f"{letter}_0")
    if modulus is not None and max(modulus) > min(modulus):
        raise SceneError(f"{letter}_0", "differs between rows", "the same value in every row", file)
    fractions = columns.get("alpha_i")
    ratios = [m / modulus[0] for m in columns.get(f"{letter}_i", ())] if modulus else []
    if fractions is None:
        fractions = ratios
    total = math.fsum(fractions)
    if total > 1.0 + EXHAUSTED:
        raise SceneError("alpha_i", f"the sum is {total:.7g}", "fractions with a sum of at most 1", file)
    for (line, _), fraction, ratio in zip(rows, fractions, ratios, strict=False):
        if abs(fraction - ratio) > CONTRADICTION:
            wrong = f"alpha_i is {fraction:g}, but {letter}_i/{letter}_0 is {ratio:g}"
            raise SceneError(f"line {line}", wrong, f"alpha_i = {letter}_i/{letter}_0", file)
    return columns["tau_i"], fractions, None if modulus is None else (letter, modulus[0])


def _is_units(cells: list[str]) -> bool:
    """Whether no cell is a number: the row of units."""
    for cell in cells:
        try:
            float(cell)
        except ValueError:
            continue
        return False
    return True


def _cell(cell: str, name: str, line: int, file: str) -> float:
    where = f"{name}, line {line}"
    try:
        value = float(cell)
    except ValueError:
        raise SceneError(where, f"got {cell_shown(cell)}", "a number, with a decimal point", file) from None
    try:
        if name == "alpha_i":
            return number(value, where, "0 <= alpha_i <= 1", low=0.0, high=1.0)
        if name.endswith("_i") and name != "tau_i":
            return number(value, where, "a finite number >= 0", low=0.0)
        return positive(value, where)
    except SceneError as error:
        raise error.in_file(file) from None
