"""Declared fields: an annotation says, once, what the value of a field may be, its unit and what it is.

Everything else follows from it: values are checked when an object is built, tables of a file are read and
written, errors say what is allowed, and the page of keys is made. A field is declared as ::

    rate: Annotated[Positive, Key("speed", "length time-1")]

with a :class:`Range` (``Positive``, ``Finite``, ...), words (``Literal``), another checked class, or a tuple
of these; ``| None`` where it may be left out. Numbers of a :class:`Tabulated` class may be in a CSV file.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Iterable, Iterator
from functools import cache
from pathlib import Path
from types import NoneType, UnionType
from typing import Annotated, Any, ClassVar, Literal, Union, get_args, get_origin, get_type_hints

from contact_scene.errors import SceneError, shown
from contact_scene.tables import read_pairs
from contact_scene.value_checks import (
    Range,
    as_tuple,
    finite,
    finite_column,
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


_PLAIN = {str: "a string", bool: "true or false", object: "a value"}
"""Plain kinds of values, in words."""


class Kinds(tuple[type[Any], ...]):
    """The checked classes that a file may state for a field whose annotation is their base."""


class Words(tuple[str, ...]):
    """The words that a string may be."""


@dataclasses.dataclass(frozen=True)
class Field:
    """An annotation, taken apart."""

    range: Range | None = None
    words: tuple[str, ...] = ()
    base: tuple[type, ...] = ()
    kinds: tuple[type[Checked], ...] = ()
    entries: Field | None = None
    plain: type | None = None
    optional: bool = False
    key: Key = Key("")

    def allowed(self, key: str) -> str:
        """What may stand under a key, in words."""
        if self.range is not None:
            return self.range.words
        if self.entries is not None:
            inner = self.entries.allowed(key)
            return (
                inner.replace("a table", "a list of tables", 1) if self.entries.kinds else f"a list: {inner}"
            )
        words = [f'"{word}"' for word in self.words]
        if self.kinds:
            words.append(f"a table {_some_keys(self.kinds)}")
        elif self.plain is not None:
            words.append(_PLAIN.get(self.plain, f"a {self.plain.__name__}"))
        return " or ".join(words) if self.kinds else "one of " + ", ".join(words) if self.words else words[0]

    def check(self, value: Any, key: str, where: Path | None) -> Any:
        """The value, checked; a table becomes an object where a folder is given in which to look files up."""
        if value is None and self.optional:
            return None
        if isinstance(value, str) and value in self.words:
            return value
        if self.base:
            if where is not None and isinstance(value, dict):
                return under(key, lambda: from_table(self.kinds, value, where))
            allowed = self.allowed(key) if where is not None else _python_words(self)
            of_class(value, key, self.base, allowed)
            return value
        if self.entries is not None:
            listed = as_tuple(value, key, self.allowed(key))
            return tuple(self.entries.check(one, f"{key}[{i}]", where) for i, one in enumerate(listed))
        if self.range is not None:
            return self.range(value, key)
        if self.plain is None:
            raise SceneError(key, f"got {shown(value)}", self.allowed(key))
        of_class(value, key, self.plain, self.allowed(key))
        return value


def _python_words(field: Field) -> str:
    names = [f'"{word}"' for word in field.words] + [f"a {one.__name__}" for one in field.base]
    return " or ".join([*names, *(["None"] if field.optional else [])])


def _some_keys(kinds: tuple[type[Checked], ...]) -> str:
    """Keys of a table: the tag that tells classes apart, or those of the class."""
    if kinds[0].tag:
        return f"with a {kinds[0].tag}"
    return " or ".join(f"{{ {', '.join(_keys_of_file(kind))} }}" for kind in kinds)


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

    def checked(self, name: str, field: Field) -> Any:
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
    """A checked class whose first two fields are columns of numbers, which a file may state."""

    columns: ClassVar[tuple[str, ...]]
    """Names of the first column and of what the second may hold."""
    file: str

    def checked(self, name: str, field: Field) -> Any:
        position = list(fields_of(type(self))).index(name)
        if position > 1 or field.entries is None or field.entries.range is None:
            return super().checked(name, field)
        column = self.column_names(vars(self))[position]
        return finite_column(getattr(self, name), column, field.entries.range)

    @classmethod
    def column_names(cls, data: dict[str, Any]) -> tuple[str, str]:
        """Names of the two columns, given the other fields."""
        return cls.columns[0], cls.columns[1]


def _declared(kind: type) -> dict[str, Field]:
    """Fields that the constructor takes, by name."""
    hints = get_type_hints(kind, include_extras=True)
    return {one.name: _field(hints[one.name]) for one in dataclasses.fields(kind) if one.init}


fields_of: Callable[[type], dict[str, Field]] = cache(_declared)


def _field(hint: Any) -> Field:
    origin, args = get_origin(hint), get_args(hint)
    if origin is Annotated:
        field = _field(args[0])
        for extra in args[1:]:
            if isinstance(extra, Range):
                field = dataclasses.replace(field, range=extra, plain=None)
            elif isinstance(extra, Key):
                field = dataclasses.replace(field, key=extra)
            elif isinstance(extra, Words):
                field = dataclasses.replace(field, words=tuple(extra), plain=None)
            elif isinstance(extra, Kinds):
                field = dataclasses.replace(
                    field, base=(field.plain or object,), kinds=tuple(extra), plain=None
                )
        return field
    if origin in (Union, UnionType):
        parts = [_field(one) for one in args if one is not NoneType]
        if len(parts) == 1:
            return dataclasses.replace(parts[0], optional=NoneType in args)
        return Field(
            next((one.range for one in parts if one.range), None),
            tuple(word for one in parts for word in one.words),
            tuple(kind for one in parts for kind in one.base),
            tuple(kind for one in parts for kind in one.kinds),
            optional=NoneType in args,
        )
    if origin is Literal:
        return Field(words=args)
    if origin is tuple:
        return Field(entries=_field(args[0]))
    if isinstance(hint, type) and issubclass(hint, Checked):
        return Field(base=(hint,), kinds=(hint,))
    return Field(plain=hint)


def optional_keys(kind: type) -> dict[str, Any]:
    """Fields that may be left out, with their defaults."""
    taken = fields_of(kind)
    return {
        one.name: one.default
        for one in dataclasses.fields(kind)
        if one.name in taken and one.default is not dataclasses.MISSING
    }


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
    classes = tuple(kinds)
    tag, kind = classes[0].tag, classes[0]
    if tag:
        names = {getattr(one, tag): one for one in classes}
        if tag not in data:  # a misspelt tag is told as such, not as one that is missing
            check_keys(data, dict.fromkeys((tag, *(key for one in classes for key in _keys_of_file(one)))))
        name = required(data, tag, ", ".join(names))
        if not isinstance(name, str) or name not in names:
            raise SceneError(tag, f"got {shown(name)}", "one of " + ", ".join(f'"{one}"' for one in names))
        kind = names[name]
        data = {key: value for key, value in data.items() if key != tag}
    elif len(classes) > 1:
        kind = next((one for one in classes if data.keys() & _tabulated_keys(one)), kind)
    if issubclass(kind, Tabulated) and "file" in data:
        return _from_file(kind, data, where)
    taken, defaults = fields_of(kind), optional_keys(kind)
    check_keys(data, [*([tag] if tag else []), *_keys_of_file(kind), *_tabulated_keys(kind)])
    kind.table_rules(data)
    for name, field in taken.items():
        if name not in data and name not in defaults:
            if issubclass(kind, Tabulated):
                raise SceneError("file", "is missing", f"a CSV file of {', '.join(kind.column_names(data))}")
            keys = ", ".join(_keys_of_file(kind))
            raise SceneError(name, "is missing", f"{field.allowed(name)}; keys {keys}")
    return kind(**{key: taken[key].check(value, key, where) for key, value in data.items()})


def _tabulated_keys(kind: type[Checked]) -> tuple[str, ...]:
    return ("file", *list(fields_of(kind))[:2]) if issubclass(kind, Tabulated) else ()


def _keys_of_file(kind: type[Checked]) -> list[str]:
    """Keys of a class in a file, the numbers of a table in a file of their own."""
    names = list(fields_of(kind))
    return ["file", *(name for name in names[2:] if name != "file")] if issubclass(kind, Tabulated) else names


def _from_file(kind: type[Tabulated], data: dict[str, Any], where: Path) -> Tabulated:
    check_keys(data, [*([kind.tag] if kind.tag else []), *_keys_of_file(kind)])
    taken = fields_of(kind)
    options = {key: taken[key].check(value, key, where) for key, value in data.items() if key != "file"}
    path, names = beside(where, data["file"]), kind.column_names(options)
    first, second = read_pairs(path, names, [one for one in kind.columns if one not in names])
    try:
        return kind(first, second, **options, file=data["file"])  # type: ignore[call-arg]
    except SceneError as error:
        raise error if error.key in options else error.in_file(str(path)) from None


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
    stated, defaults = value.stated(), optional_keys(kind)
    if isinstance(value, Tabulated):
        del stated["file"]
        if file is not None:
            stated = dict(list(stated.items())[2:])
            table["file"] = file(place, value)
    for name, part in stated.items():
        if part is None or (file is not None and name in defaults and part == defaults[name]):
            continue
        table[name] = _plain(part, file, (*place, name))
    return table


def _plain(part: Any, file: Any, place: tuple[str, ...]) -> Any:
    if isinstance(part, Checked):
        return to_table(part, file, place)
    if isinstance(part, tuple):
        return [_plain(one, file, (*place, str(index))) for index, one in enumerate(part)]
    return part


def field_at(kinds: Iterable[type[Checked]], data: Any, path: tuple[str, ...]) -> Field | None:
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


def _followed(field: Field, data: Any, rest: tuple[str, ...]) -> Field | None:
    if rest and field.entries is not None:
        index = int(rest[0]) if rest[0].isdecimal() else -1
        entry = data[index] if isinstance(data, (list, tuple)) and 0 <= index < len(data) else None
        return _followed(field.entries, entry, rest[1:])
    return field_at(field.kinds, data, rest) if rest else field


def all_kinds(field: Field) -> Iterator[type[Checked]]:
    """The classes that a field, or the entries of its list, may hold."""
    yield from field.kinds
    if field.entries is not None:
        yield from all_kinds(field.entries)
