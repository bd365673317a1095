"""Declared fields: an annotation says, once, what the value of a field may be, its unit and what it is.

Everything else follows from it: values are checked when an object is built, tables of a file are read and
written, errors say what is allowed, and the page of keys is made. A field is declared as ::

    rate: Annotated[Positive, Key("speed", "length time-1")]

with a :class:`Range` (``Positive``, ``Finite``, ...), words (``Literal``), another checked class, or a tuple
of these; ``| None`` where it may be left out. Numbers of a :class:`Tabulated` class may be in a CSV file.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Iterable, Sequence
from functools import cache
from pathlib import Path
from types import NoneType, UnionType
from typing import Annotated, Any, ClassVar, Literal, Union, get_args, get_origin, get_type_hints

import numpy as np

from contact_scene.errors import SceneError, shown
from contact_scene.tables import read_pairs
from contact_scene.value_checks import (
    Range,
    Rule,
    as_tuple,
    column,
    finite,
    not_negative,
    of_class,
    positive,
    zero_or_positive,
)

Finite = Annotated[float, finite]
Positive = Annotated[float, positive]
NotNegative = Annotated[float, not_negative]
ZeroOrPositive = Annotated[float, zero_or_positive]


@dataclasses.dataclass(frozen=True)
class Key:
    """What a field is, in words, and its unit as a product of powers of length, force and time."""

    text: str
    unit: str = ""


REQUIRED = object()
"""Default of a field that has none."""

_PLAIN = {str: "a string", bool: "true or false", object: "a value", dict: "a dictionary"}
"""Plain kinds of values, in words."""


class Kinds(tuple[type[Any], ...]):
    """The checked classes that a file may state for a field whose annotation is their base."""


class Words(tuple[str, ...]):
    """The words that a string may be."""


@dataclasses.dataclass(frozen=True)
class Declaration:
    """What the annotation of a field says, taken apart."""

    rule: Rule | None = None
    words: tuple[str, ...] = ()
    classes: tuple[type, ...] = ()
    kinds: tuple[type[Checked], ...] = ()
    entries: Declaration | None = None
    optional: bool = False
    key: Key = Key("")
    default: Any = REQUIRED

    def allowed(self, key: str) -> str:
        """What may stand under a key, in words."""
        if self.rule is not None:
            return self.rule.words
        if self.entries is not None:
            inner = self.entries.allowed(key)
            return (
                inner.replace("a table", "a list of tables", 1) if self.entries.kinds else f"a list: {inner}"
            )
        words = [f'"{word}"' for word in self.words]
        if self.kinds and self.kinds[0].tag:
            words.append(f"a table with a {self.kinds[0].tag}")
        elif self.kinds:
            keys = (", ".join(_keys_of_file(kind)) for kind in self.kinds)
            words.append("a table " + " or ".join(f"{{ {one} }}" for one in keys))
        else:
            words += [_PLAIN.get(one, f"a {one.__name__}") for one in self.classes]
        return " or ".join(words) if self.kinds else "one of " + ", ".join(words) if self.words else words[0]

    def check(self, value: Any, key: str, where: Path | None) -> Any:
        """The value, checked; a table becomes an object where a folder is given in which to look files up."""
        if (value is None and self.optional) or (isinstance(value, str) and value in self.words):
            return value
        if self.rule is not None:
            return self.rule(value, key)
        if self.entries is not None:
            listed = as_tuple(value, key, self.allowed(key))
            return tuple(self.entries.check(one, f"{key}[{i}]", where) for i, one in enumerate(listed))
        if self.kinds and where is not None and isinstance(value, dict):
            return under(key, lambda: from_table(self.kinds, value, where))
        allowed = self.allowed(key)
        if self.kinds and where is None:  # as Python states it
            names = [f'"{word}"' for word in self.words] + [f"a {one.__name__}" for one in self.classes]
            allowed = " or ".join([*names, *(["None"] if self.optional else [])])
        of_class(value, key, self.classes, allowed)
        return value


class Checked:
    """Base of frozen dataclasses whose fields are declared.

    ``tag`` is the key by which a file tells apart the classes that one field may hold; its value is the class
    variable of that name.
    """

    tag: ClassVar[str] = ""

    def __post_init__(self) -> None:
        for name, field in fields_of(type(self)).items():
            object.__setattr__(self, name, self.checked(name, field))
        self.rules()

    def checked(self, name: str, field: Declaration) -> Any:
        """The value of a field, checked."""
        return field.check(getattr(self, name), name, None)

    def rules(self) -> None:
        """Check what holds between several fields."""

    @classmethod
    def table_rules(cls, table: dict[str, Any]) -> None:
        """Check what holds between several keys of a table in a file."""

    def stated(self) -> dict[str, Any]:
        """The fields that state the object, by name; the others follow from them."""
        return {name: getattr(self, name) for name in fields_of(type(self))}


class Tabulated(Checked):
    """A checked class whose first two fields are columns of numbers, which a file may state.

    The first column rises; the second may be one that ``never_falls``, which are the words for it.
    """

    columns: ClassVar[tuple[str, ...]]
    """Names of the first column and of what the second may hold."""
    least_rows: ClassVar[int] = 2
    never_falls: ClassVar[str] = ""
    file: str

    def checked(self, name: str, field: Declaration) -> Any:
        position = list(fields_of(type(self))).index(name)
        if position > 1 or field.entries is None or not isinstance(rule := field.entries.rule, Range):
            return super().checked(name, field)
        given, key = getattr(self, name), self.column_names(vars(self))[position]
        entries = as_tuple(given.tolist() if isinstance(given, np.ndarray) else given, key, column.words)
        if all(type(entry) is float for entry in entries) and rule.holds(np.array(entries)).all():
            return entries
        return tuple(rule(entry, f"{key}, row {row}") for row, entry in enumerate(entries, 1))

    @classmethod
    def column_names(cls, data: dict[str, Any]) -> tuple[str, str]:
        """Names of the two columns, given the other fields."""
        return cls.columns[0], cls.columns[1]

    def rules(self) -> None:
        one, other = self.column_names(vars(self))
        first, second = (getattr(self, name) for name in list(fields_of(type(self)))[:2])
        if len(first) != len(second):
            raise SceneError(other, f"{len(second)} numbers for {len(first)} of {one}", "one for each")
        if len(first) < self.least_rows:
            allowed = f"at least {self.least_rows} rows of {one}, {other}"
            raise SceneError(one, f"got {len(first)} rows", allowed)
        rises(first, one)
        if self.never_falls:
            rises(second, other, self.never_falls)


def rises(values: Sequence[float], name: str, not_falling: str = "") -> None:
    """Refuse a column that does not rise, or falls where ``not_falling`` says what is allowed."""
    steps = np.diff(values)
    wrong = steps < 0.0 if not_falling else steps <= 0.0
    if wrong.any():
        row = int(wrong.argmax())
        before, after = values[row : row + 2]
        problem = f"falls by {before - after:.3g}" if not_falling else "does not rise"
        allowed = not_falling or "strictly rising numbers"
        raise SceneError(f"{name}, row {row + 2}", f"{problem} ({before:g} -> {after:g})", allowed)


def _declared(kind: type) -> dict[str, Declaration]:
    """Fields that the constructor takes, by name."""
    hints = get_type_hints(kind, include_extras=True)
    taken = {one.name: one.default for one in dataclasses.fields(kind) if one.init}
    given = {name: REQUIRED if value is dataclasses.MISSING else value for name, value in taken.items()}
    return {
        name: dataclasses.replace(_declaration(hints[name]), default=value) for name, value in given.items()
    }


fields_of: Callable[[type], dict[str, Declaration]] = cache(_declared)


def _declaration(hint: Any) -> Declaration:
    origin, args = get_origin(hint), get_args(hint)
    if origin is Annotated:
        found = _declaration(args[0])
        for extra in args[1:]:
            if isinstance(extra, Rule):
                found = dataclasses.replace(found, rule=extra)
            elif isinstance(extra, Key):
                found = dataclasses.replace(found, key=extra)
            elif isinstance(extra, Words):
                found = dataclasses.replace(found, words=tuple(extra), classes=())
            elif isinstance(extra, Kinds):
                found = dataclasses.replace(found, kinds=tuple(extra))
        return found
    if origin in (Union, UnionType):
        parts = [_declaration(one) for one in args if one is not NoneType]
        words = tuple(word for one in parts for word in one.words)
        kinds = tuple(kind for one in parts for kind in one.kinds)
        found = parts[0] if len(parts) == 1 else Declaration(words=words, classes=kinds, kinds=kinds)
        return dataclasses.replace(found, optional=NoneType in args)
    if origin is Literal:
        return Declaration(words=args)
    if origin is tuple:
        return Declaration(entries=_declaration(args[0]))
    if isinstance(hint, type) and issubclass(hint, Checked):
        return Declaration(classes=(hint,), kinds=(hint,))
    return Declaration(classes=(origin or hint,))


# Tables of a file


def under(prefix: str, build: Callable[[], Any]) -> Any:
    """What ``build()`` returns; an error in it, unless it names a file, is one of a key under ``prefix``."""
    try:
        return build()
    except SceneError as error:
        raise error if error.file else error.under(prefix) from None


def check_keys(data: dict[str, Any], allowed: Iterable[str]) -> None:
    """Refuse keys that are not allowed in a table."""
    names = tuple(allowed)
    for key in data:
        if key not in names:
            raise SceneError(str(key), "unknown key", ", ".join(names))


def required(data: dict[str, Any], key: str, allowed: str) -> Any:
    """The value of a key that a table must have; ``allowed``: what it may be, in words."""
    if key not in data:
        raise SceneError(key, "is missing", allowed)
    return data[key]


def beside(where: Path, name: Any) -> Path:
    """The path of a file that a scene names, in the folder ``where``."""
    if not isinstance(name, str) or not name or "\0" in name:
        raise SceneError("file", f"got {shown(name)}", "the name of a file beside the scene")
    return where / name


def from_table(kinds: Iterable[type[Checked]], data: dict[str, Any], where: Path) -> Any:
    """The object, of one of several classes, that a table states; its files are looked up in ``where``."""
    kind, data = _kind_of(tuple(kinds), data)
    taken = fields_of(kind)
    columns = list(taken)[:2] if issubclass(kind, Tabulated) else []
    from_file = bool(columns) and "file" in data
    check_keys(data, [*filter(None, [kind.tag]), *_keys_of_file(kind), *(() if from_file else columns)])
    kind.table_rules(data)
    for name, field in taken.items():
        if not from_file and name not in data and field.default is REQUIRED:
            if issubclass(kind, Tabulated):
                raise SceneError("file", "is missing", f"a CSV file of {', '.join(kind.column_names(data))}")
            keys = ", ".join(_keys_of_file(kind))
            raise SceneError(name, "is missing", f"{field.allowed(name)}; keys {keys}")
    stated = {
        key: value if key in columns else taken[key].check(value, key, where)
        for key, value in data.items()
        if key != "file"
    }
    if "file" not in data:
        return kind(**stated)
    if not issubclass(kind, Tabulated):
        return kind(**stated, file=data["file"])  # type: ignore[call-arg]
    path, names = beside(where, data["file"]), kind.column_names(stated)
    pairs = read_pairs(path, names, [one for one in kind.columns if one not in names])
    try:
        return kind(*pairs, **stated, file=data["file"])  # type: ignore[call-arg]
    except SceneError as error:
        raise error if error.key in stated else error.in_file(str(path)) from None


def _kind_of(kinds: tuple[type[Checked], ...], data: dict[str, Any]) -> tuple[type[Checked], dict[str, Any]]:
    """Which of several classes a table states, by its tag or else by its keys; and the table without it."""
    tag = kinds[0].tag
    if not tag:
        tables = (one for one in kinds if issubclass(one, Tabulated))
        stated = (one for one in tables if data.keys() & {"file", *list(fields_of(one))[:2]})
        return next(stated, kinds[0]), data
    names = {getattr(one, tag): one for one in kinds}
    if tag not in data:  # a misspelt tag is told as such, not as one that is missing
        check_keys(data, dict.fromkeys((tag, *(key for one in kinds for key in _keys_of_file(one)))))
    name = required(data, tag, ", ".join(names))
    if not isinstance(name, str) or name not in names:
        raise SceneError(tag, f"got {shown(name)}", "one of " + ", ".join(f'"{one}"' for one in names))
    return names[name], {key: value for key, value in data.items() if key != tag}


def _keys_of_file(kind: type[Checked]) -> list[str]:
    """Keys of a class in a file, the numbers of a table in a file of their own."""
    names = list(fields_of(kind))
    return ["file", *(name for name in names[2:] if name != "file")] if issubclass(kind, Tabulated) else names


def to_table(
    value: Checked,
    file: Callable[[tuple[str, ...], Tabulated], str] | None = None,
    place: tuple[str, ...] = (),
) -> dict[str, Any]:
    """The table that states an object: what is at its default is left out.

    ``file`` writes the numbers of a tabulated part and returns the name of the file; without it they stand in
    the table, and every default as well.
    """
    kind = type(value)
    table: dict[str, Any] = {kind.tag: getattr(kind, kind.tag)} if kind.tag else {}
    stated, taken = value.stated(), fields_of(kind)
    if isinstance(value, Tabulated):
        del stated["file"]
        if file is not None:
            stated = dict(list(stated.items())[2:])
            table["file"] = file(place, value)
    for name, part in stated.items():
        if part is None or (file is not None and part == taken[name].default):
            continue
        table[name] = _plain(part, file, (*place, name))
    return table


def _plain(part: Any, file: Any, place: tuple[str, ...]) -> Any:
    if isinstance(part, Checked):
        return to_table(part, file, place)
    if isinstance(part, tuple):
        return [_plain(one, file, (*place, str(index))) for index, one in enumerate(part)]
    return part


def field_at(kinds: Iterable[type[Checked]], data: Any, path: tuple[str, ...]) -> Declaration | None:
    """The declared field that a path leads to in a table of one of some classes; ``None`` without one."""
    if not path:
        return None
    for kind in kinds:
        if (
            kind.tag
            and isinstance(data, dict)
            and data.get(kind.tag, getattr(kind, kind.tag)) != getattr(kind, kind.tag)
        ):
            continue
        field = fields_of(kind).get(path[0])
        if field is not None:
            return _followed(field, data.get(path[0]) if isinstance(data, dict) else None, path[1:])
    return None


def _followed(field: Declaration, data: Any, rest: tuple[str, ...]) -> Declaration | None:
    if rest and field.entries is not None:
        index = int(rest[0]) if rest[0].isdecimal() else -1
        entry = data[index] if isinstance(data, (list, tuple)) and 0 <= index < len(data) else None
        return _followed(field.entries, entry, rest[1:])
    return field_at(field.kinds, data, rest) if rest else field
