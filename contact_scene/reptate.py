"""Files of RepTate: modes, and the stress after a step of strain (RepTate 1.3, ``data/``)."""

from __future__ import annotations

import re
from dataclasses import replace

from contact_scene.errors import SceneError, cell_shown
from contact_scene.material import Branch
from contact_scene.named_columns import NamedColumns, cells_of_line, checked_in_line, kind_of, number_in_line
from contact_scene.value_checks import not_negative, positive


def reptate_modes(text: str, file: str) -> tuple[Branch, ...]:
    """Rows of number, time and modulus after their count, which files written by hand may leave out."""
    _check_order(text, file)
    rows = [
        (line, cells)
        for line, content in enumerate(text.split("\n"), 1)
        if (cells := cells_of_line(content.partition("#")[0], line, file))
    ]
    if not rows:
        raise SceneError("", "the file is empty", "a mode file: number of modes, then i, tau_i, G_i", file)
    announced = None
    if len(rows[0][1]) == 1:
        line, (cell,) = rows.pop(0)
        if not cell.isdecimal() or len(cell) > 6:
            raise SceneError(f"line {line}", f"got {cell_shown(cell)}", "the number of modes", file)
        announced = int(cell)
    branches = []
    for line, cells in rows:
        if len(cells) != 3:
            raise SceneError(f"line {line}", f"{len(cells)} cells", "three: i, tau_i, G_i", file)
        if not cells[0].isdecimal():
            allowed = "the number i of the mode, then tau_i, G_i"
            raise SceneError(f"line {line}", f"got {cell_shown(cells[0])} first", allowed, file)
        time, modulus = (number_in_line(cell, line, file) for cell in cells[1:])
        branches.append(
            Branch(
                checked_in_line(not_negative, modulus, "G_i", line, file),
                checked_in_line(positive, time, "tau_i", line, file),
            )
        )
    if not branches:
        raise SceneError("tau_i", "no rows of numbers", "a row i, tau_i, G_i for each mode", file)
    if announced not in (None, len(branches)):
        raise SceneError(
            "number of modes", f"is {announced}, but there are {len(branches)} rows", "as many rows", file
        )
    return tuple(branches)


def _check_order(text: str, file: str) -> None:
    """Refuse a comment that names the columns in another order."""
    for line, content in enumerate(text.split("\n"), 1):
        if content.lstrip().startswith("#"):
            cells = cells_of_line(content.lstrip().lstrip("#"), line, file, strict=False)
            _, second, third = map(kind_of, cells) if len(cells) == 3 else ("", "", "")
            if second == "modulus" or third == "relaxation time":
                raise SceneError(f"line {line}", f"got {cell_shown(','.join(cells))}", "i, tau_i, G_i", file)


def shear_moduli(table: NamedColumns, text: str, file: str) -> NamedColumns:
    """The stress ``sxy`` over the strain ``gamma``, as a shear modulus; any other table is itself.

    Parameters
    ----------
    table : NamedColumns
    text : str
        What it was read from; parameters such as ``gamma=0.1;`` come before the first row.
    file : str
        Its name, for errors.

    Returns
    -------
    NamedColumns
    """
    if table.names not in (("t", "sxy"), ("t", "Gt")):
        return table
    stated = re.search(r"\bgamma\s*=\s*([^;\s]*)", "\n".join(text.split("\n")[: table.lines[0]]))
    strain = 1.0
    if stated is not None and table.names[1] == "sxy":
        line = text[: stated.start()].count("\n") + 1
        strain = checked_in_line(positive, number_in_line(stated.group(1), line, file), "gamma", line, file)
    return replace(
        table, names=("t", "G"), rows=tuple((time, stress / strain) for time, stress in table.rows)
    )
