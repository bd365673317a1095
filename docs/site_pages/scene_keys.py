"""Keys of a scene file, from the classes that a scene is made of."""

from __future__ import annotations

import inspect
from collections.abc import Iterator, Mapping
from dataclasses import MISSING, Field, fields

from contact_scene import Approach, Indenter
from contact_scene.adhesion import Adhesion
from contact_scene.load_steps import STEPS
from contact_scene.material_models import MODELS

TABULATED = {"profile": "`file`: CSV of radius, height", "table": "`file`: CSV of time, penetration"}
"""Kinds whose numbers come from a file."""


def page() -> str:
    """Tables of the shapes, load steps and material laws with their keys."""
    shapes = {kind.shape: kind for kind in _subclasses(Indenter)}
    lines = ["# Keys by kind", "", "Written from the classes that a scene is made of.", ""]
    lines += _section("`indenter.shape`", "shape", shapes)
    lines += _section("`kind` of a load step", "kind", STEPS | {Approach.kind: Approach})
    lines += _section("`material.model`", "model", MODELS)
    lines += _section("`[adhesion]`", "", {"": Adhesion})
    return "\n".join(lines) + "\n"


def _subclasses(base: type) -> Iterator[type]:
    for kind in base.__subclasses__():
        if hasattr(kind, "shape"):
            yield kind
        yield from _subclasses(kind)


def _section(title: str, head: str, kinds: Mapping[str, type]) -> Iterator[str]:
    yield from (f"## {title}", "", f"| {head} | keys | |", "|---|---|---|")
    for name, kind in kinds.items():
        yield f"| {f'`{name}`' if name else ''} | {_keys(name, kind)} | {_first_paragraph(kind)} |"
    yield ""


def _keys(name: str, kind: type) -> str:
    if name in TABULATED:
        return TABULATED[name]
    return ", ".join(_key(entry) for entry in fields(kind) if entry.init) or "none"


def _key(entry: Field) -> str:
    return f"`{entry.name}`" if entry.default is MISSING else f"`{entry.name}` = {entry.default!r}"


def _first_paragraph(kind: type) -> str:
    doc = (inspect.getdoc(kind) or "").split("\n\n")[0]
    return " ".join(doc.replace("``", "`").split()).replace("|", "\\|")
