"""What stands between the cells of a table, and for the point in its numbers: other signs are named.

Programs of other languages write decimal commas, and then semicolons or tabs between the cells. Such numbers
are refused, not converted: ``1,5`` may be one number or two.
"""

from __future__ import annotations

import re
from collections.abc import Collection, Sequence

from contact_scene.errors import SceneError
from contact_scene.units import without_unit

_SIGNS = {";": "semicolons", "\t": "tabs", " ": "blanks"}
_QUOTED = {'","': "commas"}
"""Between cells with decimal commas."""
_ONLY_COMMAS = "commas between cells, points in numbers"
ANY_SIGN = "points in numbers; semicolons, commas or blanks between cells"
_DECIMAL_COMMA = re.compile(r"[+-]?\d+(\.\d{3})*,\d+([eE][+-]?\d+)?")


def is_number(cell: str) -> bool:
    """Whether a cell of a table holds a number as other programs write it, without underscores."""
    try:
        float(cell)
    except ValueError:
        return False
    return "_" not in cell


def is_name(cell: str) -> bool:
    """Whether a cell may name a column: it begins with a letter and states no value."""
    return bool(re.fullmatch(r"[^\W\d_][^=:]*", cell)) and not is_number(cell)


def names_in_words(cells: Sequence[str]) -> bool:
    """Whether cells of a comment are names, of two words at most before the unit, and no sentence."""
    words = (without_unit(cell).partition("/")[0].split() for cell in cells)
    return all(map(is_name, cells)) and all(len(name) <= 2 for name in words)


def check_head(line: int, head: Sequence[str], names: Collection[str], file: str) -> None:
    """Refuse the head of a table that is one cell in which other signs than commas separate the columns.

    Parameters
    ----------
    line : int
        Number of its line.
    head : sequence of str
        Its cells.
    names : collection of str
        Columns in lower case, one of which tells that the cell is several.
    file : str

    Raises
    ------
    SceneError
        One line that names the sign.
    """
    cell = without_unit(head[0]) if len(head) == 1 else ""
    for sign, name in _SIGNS.items():
        if sign in cell and not {word.strip().lower() for word in cell.split(sign)}.isdisjoint(names):
            raise SceneError(f"line {line}", f"cells are separated by {name}", _ONLY_COMMAS, file)


def check_row(line: int, content: str, file: str, only_commas: bool = True) -> None:
    """Refuse a row of numbers with decimal commas, or with other signs than commas between them.

    Parameters
    ----------
    line : int
        Its number.
    content : str
        The row; any other text passes.
    file : str
    only_commas : bool
        Whether no other sign may stand between cells.

    Raises
    ------
    SceneError
        One line that names the signs.
    """
    for sign, name in (_SIGNS | _QUOTED).items():
        cells = [stripped for cell in content.split(sign) if (stripped := cell.strip(' \t"'))]
        decimal_commas = [bool(_DECIMAL_COMMA.fullmatch(cell)) for cell in cells]
        numbers = (comma or is_number(cell) for comma, cell in zip(decimal_commas, cells, strict=True))
        if len(cells) < 2 or not all(numbers):
            continue
        allowed = _ONLY_COMMAS if only_commas else ANY_SIGN
        if any(decimal_commas):
            problem = f"cells are separated by {name} and numbers have decimal commas"
            raise SceneError(f"line {line}", problem, allowed, file)
        if only_commas and sign in _SIGNS:
            raise SceneError(f"line {line}", f"cells are separated by {name}", allowed, file)
