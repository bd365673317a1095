"""Declared fields: an annotation says, once, what the value of a field may be, its unit and what it is.

Everything else follows from it: values are checked when an object is built, tables of a file are read and
written, errors say what is allowed, and the page of keys is made. A field is declared as ::

    rate: Annotated[Positive, Key("speed", "length time-1")]

with a :class:`Range` (``Positive``, ``Finite``, ...), words (``Literal``), another checked class, or a tuple
of these; ``| None`` where it may be left out. ``Annotated[Step, STEPS]`` names the classes that a file may
state for an abstract one, ``Annotated[str, Literal[...]]`` the words that a string may be. Numbers of a
:class:`Tabulated` class may be in a CSV file.
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

_PLAIN: dict[Any, str] = {str: "a string", bool: "true or false", object: "a value", dict: "a dictionary"}
_PLAIN[Callable] = "a function"
"""Plain kinds of values, in words."""


@dataclasses.dataclass(frozen=True)
class Declaration:
    """What the annotation of a field says, taken apart.

    Allowed is what a ``rule`` takes, a list of what ``entries`` say, or else ``words`` and objects of
    ``classes``; those of ``kinds`` are tables in a file.
    """

    rule: Rule | None = None
    words: tuple[str, ...] = ()
    classes: tuple[type, ...] = ()
    kinds: tuple[type[Checked], ...] = ()
    entries: Declaration | None = None
    optional: bool = False
    key: Key = Key("")
    default: Any = REQUIRED

    def allowed(self, key: str, in_python: bool = False) -> str:
        """What may stand under a key, in words."""
        if self.rule is not None:
            return self.rule.words
        if self.entries is not None:
            inner = self.entries.allowed(key)
            return (
                inner.replace("a table", "a list of tables", 1) if self.entries.kinds else f"a list: {inner}"
            )
        words = [f'"{word}"' for word in self.words]
        if in_python and self.kinds:
            words += [f"a {one.__name__}" for one in self.classes] + ["None"] * self.optional
        elif self.kinds and self.kinds[0].tag:
            words.append(f"a table with a {self.kinds[0].tag}")
        elif self.kinds:
            words.append("a table " + " or ".join(f"{{ {', '.join(keys_of(kind))} }}" for kind in self.kinds))
        elif self.words:
            return "one of " + ", ".join(words)
        else:
            words += [_PLAIN.get(one, f"a {one.__name__}") for one in self.classes[:1]]
        return " or ".join(words)

    def check(self, value: Any, key: str, where: Path | None = None) -> Any:
        """The value, checked; a table becomes an object where a folder is given in which to look files up."""
        if (value is None and self.optional) or (isinstance(value, str) and value in self.words):
            return value
        if self.rule is not None:
            return self.rule(value, key)
        if self.entries is not None:
            listed = value.tolist() if isinstance(value, np.ndarray) else value
            listed, rule = as_tuple(listed, key, self.allowed(key)), self.entries.rule
            if type(rule) is Range and {*map(type, listed)} == {float} and rule.holds(np.array(listed)).all():
                return listed
            return tuple(self.entries.check(one, f"{key}[{i}]", where) for i, one in enumerate(listed))
        if self.kinds and where is not None and isinstance(value, dict):
            return under(key, lambda: from_table(self.kinds, value, where))
        of_class(value, key, self.classes, self.allowed(key, in_python=where is None))
        return value


class Checked:
    """Base of frozen dataclasses whose fields are declared.

    ``tag`` is the key by which a file tells apart the classes that one field may hold; its value is the class
    variable of that name.
    """

    tag: ClassVar[str] = ""

    def __post_init__(self) -> None:
        for name, field in fields_of(type(self)).items():
            object.__setattr__(self, name, field.check(getattr(self, name), name))
        self.rules()

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

    @classmethod
    def column_names(cls, data: dict[str, Any]) -> tuple[str, str]:
        """Names of the two columns, given the other fields."""
        return cls.columns[0], cls.columns[1]

    @classmethod
    def read(cls, file: Path, data: dict[str, Any]) -> tuple[Sequence[float], Sequence[float]]:
        """The two columns of a file, given the other fields."""
        names, fields = cls.column_names(data), list(fields_of(cls).values())
        rules = [field.entries.rule for field in fields[:2] if field.entries is not None]
        return read_pairs(file, names, rules, [one for one in cls.columns if one not in names])

    def rules(self) -> None:
        names = list(fields_of(type(self)))[:2]
        first, second = (getattr(self, name) for name in names)
        one, other = self.column_names(vars(self)) if self.file else names
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
    hints, found = get_type_hints(kind, include_extras=True), {}
    for one in filter(lambda one: one.init, dataclasses.fields(kind)):
        default = REQUIRED if one.default is dataclasses.MISSING else one.default
        found[one.name] = dataclasses.replace(_declaration(hints[one.name]), default=default)
    return found


fields_of: Callable[[type], dict[str, Declaration]] = cache(_declared)


def _declaration(hint: Any) -> Declaration:
    origin, args = get_origin(hint), get_args(hint)
    if origin is Annotated:
        given, stated = {"rule": Rule, "key": Key, "kinds": tuple}, dict[str, Any]()
        for one in args[1:]:
            stated |= {name: one for name, kind in given.items() if isinstance(one, kind)}
            stated |= {"words": get_args(one), "classes": ()} if get_origin(one) is Literal else {}
        return dataclasses.replace(_declaration(args[0]), **stated)
    if origin in (Union, UnionType):
        parts = [_declaration(one) for one in args if one is not NoneType]
        names = ("words", "classes", "kinds")
        joined: dict[str, Any] = {name: sum((getattr(one, name) for one in parts), ()) for name in names}
        return dataclasses.replace(parts[0], **joined, optional=NoneType in args)
    if origin is Literal:
        return Declaration(words=args)
    if origin is tuple:
        return Declaration(entries=_declaration(args[0]))
    is_checked = isinstance(hint, type) and issubclass(hint, Checked)
    return Declaration(classes=(origin or hint,), kinds=(hint,) if is_checked else ())


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


def beside(where: Path, name: Any) -> Path:
    """The path of a file that a scene names, in the folder ``where``."""
    if not isinstance(name, str) or not name or "\0" in name:
        raise SceneError("file", f"got {shown(name)}", "the name of a file beside the scene")
    return where / name


def keys_of(kind: type[Checked]) -> list[str]:
    """Keys of a class in a file, the numbers of a table in a file of their own."""
    names = list(fields_of(kind))
    return ["file", *(name for name in names[2:] if name != "file")] if issubclass(kind, Tabulated) else names


def from_table(kinds: Iterable[type[Checked]], data: dict[str, Any], where: Path) -> Any:
    """The object, of one of several classes, that a table states; its files are looked up in ``where``."""
    kind, data = _kind_of(tuple(kinds), data)
    fields, keys = fields_of(kind), keys_of(kind)
    tabulated = issubclass(kind, Tabulated)
    in_file = tabulated and "file" in data
    check_keys(data, [*filter(None, [kind.tag]), *(keys if in_file else dict.fromkeys((*keys, *fields)))])
    kind.table_rules(data)
    for name, field in fields.items():
        if name not in data and field.default is REQUIRED and not in_file:
            if issubclass(kind, Tabulated):
                raise SceneError("file", "is missing", f"a CSV file of {', '.join(kind.column_names(data))}")
            raise SceneError(name, "is missing", f"{field.allowed(name)}; keys {', '.join(keys)}")
    path = beside(where, data["file"]) if in_file else where
    stated = {key: fields[key].check(value, key, where) for key, value in data.items()}
    if not issubclass(kind, Tabulated) or not in_file:
        return kind(**stated)
    stated |= zip(fields, kind.read(path, stated), strict=False)
    try:
        return kind(**stated)
    except SceneError as error:
        raise error if error.key in data else error.in_file(str(path)) from None


def _kind_of(kinds: tuple[type[Checked], ...], data: dict[str, Any]) -> tuple[type[Checked], dict[str, Any]]:
    """Which of several classes a table states, by its tag or else by its keys; and the table without it."""
    tag = kinds[0].tag
    if not tag:
        tables = (one for one in kinds if issubclass(one, Tabulated))
        stated = (one for one in tables if data.keys() & {"file", *list(fields_of(one))[:2]})
        return next(stated, kinds[0]), data
    names = {getattr(one, tag): one for one in kinds}
    if tag not in data:  # a misspelt tag is told as such, not as one that is missing
        check_keys(data, dict.fromkeys((tag, *(key for one in kinds for key in keys_of(one)))))
        raise SceneError(tag, "is missing", ", ".join(names))
    name = data[tag]
    if not isinstance(name, str) or name not in names:
        raise SceneError(tag, f"got {shown(name)}", "one of " + ", ".join(f'"{one}"' for one in names))
    return names[name], {key: value for key, value in data.items() if key != tag}


def to_table(
    value: Checked,
    file: Callable[[tuple[str, ...], Tabulated], str] | None = None,
    place: tuple[str, ...] = (),
) -> dict[str, Any]:
    """The table that states an object: what is at its default is left out.

    ``file`` writes the numbers of a tabulated part and returns the name of the file; without it they stand in
    the table, and every default as well.
    """

    def plain(part: Any, place: tuple[str, ...]) -> Any:
        if isinstance(part, tuple):
            return [plain(one, (*place, str(index))) for index, one in enumerate(part)]
        return to_table(part, file, place) if isinstance(part, Checked) else part

    kind = type(value)
    table: dict[str, Any] = {kind.tag: getattr(kind, kind.tag)} if kind.tag else {}
    stated, fields = value.stated(), fields_of(kind)
    if isinstance(value, Tabulated):
        del stated["file"]
        if file is not None:
            stated = dict(list(stated.items())[2:])
            table["file"] = file(place, value)
    for name, part in stated.items():
        if part is not None and (file is None or part != fields[name].default):
            table[name] = plain(part, (*place, name))
    return table


def field_at(kinds: Iterable[type[Checked]], data: Any, path: Sequence[str]) -> Declaration | None:
    """The declared field that a path leads to in a table of one of some classes; ``None`` without one."""
    field: Declaration | None = Declaration(kinds=tuple(kinds))
    for name in path:
        if field is None:
            return None
        inside = isinstance(data, list) and name.isdecimal() and int(name) < len(data)
        if field.entries is not None:
            field, data = field.entries, data[int(name)] if inside else None
            continue
        table = data if isinstance(data, dict) else {}
        told = (one for one in field.kinds if table.get(one.tag) in (None, getattr(one, one.tag, None)))
        found = (fields_of(one)[name] for one in told if name in fields_of(one))
        field, data = next(found, None), table.get(name)
    return field
