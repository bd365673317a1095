"""Tags of a scene: what a code has to cover to answer it; and what codes decline.

A code declines scenes by tag in ``code.toml``, or one scene with a reason in ``declined.txt``.
"""

from __future__ import annotations

import tomllib
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path

from contact_scene import Cone, FlatPunch, PowerLaw, Scene, SceneError, Sphere, TabulatedProfile
from contact_scene.checked import Checked, from_table
from contact_scene.errors import shown
from contact_scene.files import read_text
from contact_scene.load_steps import STEPS
from validation.cases import Case
from validation.exam.answer import A_CODE, CODE

BY_TAG, BY_REASON = "code.toml", "declined.txt"
LONGEST_REASON = 200
"""Characters of a reason: it becomes a line of a report."""
OTHER_TAGS = {"force": "force-control", "force-ramp": "force-control", "oscillate": "oscillation"}
OTHER_TAGS |= {"flat-punch": "punch"}
"""Tags of load steps and shapes of indenters; any other kind is its own tag."""
_ALWAYS = {"title", "material", "indenter", "loading", "adhesion", "work", "zone"}
_SHAPES = (Sphere, Cone, FlatPunch, PowerLaw, TabulatedProfile)
POSSIBLE = {
    *("adhesive", "adhesionless", "elastic", "viscoelastic", "spectrum", "separate-bulk", "relaxed-start"),
    *("spring", "trigger"),
    *(OTHER_TAGS.get(kind, kind) for kind in (*(s.kind for s in STEPS), *(s.shape for s in _SHAPES))),
}
"""Tags a scene can have, those for further parts of a scene aside."""

Declined = dict[tuple[str, str], str]
"""Why a code (first) does not answer a scene (second)."""


def tags(scene: Scene) -> tuple[str, ...]:
    """All tags of a scene, in alphabetical order."""
    material, loading, adhesive = scene.material, scene.loading, scene.is_adhesive
    kinds = {scene.indenter.shape, *(step.kind for step in loading.steps)}
    stated = scene.stated()
    if adhesive and scene.adhesion is not None:
        stated |= scene.adhesion.stated()
    given = {
        "adhesive" if adhesive else "adhesionless": True,
        "elastic" if material.is_elastic else "viscoelastic": True,
        "spectrum": material.spectrum[0].size > 1,
        "separate-bulk": material.bulk is not None,
        "relaxed-start": loading.start == "relaxed",
        "spring": loading.compliance > 0.0,
        "trigger": loading.has_triggers,
    } | {name: value is not None for name, value in stated.items() if name not in _ALWAYS}
    found = {OTHER_TAGS.get(kind, kind) for kind in kinds} | {tag for tag, is_so in given.items() if is_so}
    return tuple(sorted(tag.replace("_", "-") for tag in found))


@dataclass(frozen=True)
class CodeFile(Checked):
    """The contents of a ``code.toml``."""

    code: str
    declines: tuple[str, ...] = ()

    def rules(self) -> None:
        if not CODE.fullmatch(self.code):
            raise SceneError("code", f"got {shown(self.code)}", A_CODE)


def read_declined(files: Iterable[tuple[Path, str]], cases: Sequence[Case], remarks: list[str]) -> Declined:
    """All that is declined in some files, each with its name in messages; remarks on them are added."""
    declined: Declined = {}
    for path, name in files:
        read = _by_tag if path.name == BY_TAG else _by_reason
        try:
            declined |= read(path, name, cases, remarks)
        except SceneError as error:
            remarks.append(str(error.in_file(name)).replace(str(path), name))
    return declined


def _by_tag(path: Path, name: str, cases: Sequence[Case], remarks: list[str]) -> Declined:
    """Scenes that a ``code.toml`` declines, each with the tags for which."""
    text = read_text(path)
    try:
        data = tomllib.loads(text)
    except (ValueError, RecursionError) as error:
        raise SceneError("", f"not a TOML file: {error}", "code and declines") from None
    stated = {key: value for key, value in data.items() if key in ("code", "declines")}
    code: CodeFile = from_table((CodeFile,), stated, path.parent)
    by_scene = {case.name: tags(case.scene) for case in cases}
    known = POSSIBLE.union(*by_scene.values())
    odd = [tag for tag in code.declines if tag not in known]
    if odd:
        allowed = ", ".join(sorted(known))
        remarks.append(f"{name}: {shown(odd[0])} is no tag of a scene here; allowed: {allowed}")
    common = {scene: [tag for tag in found if tag in code.declines] for scene, found in by_scene.items()}
    return {(code.code, scene): f"by tag: {', '.join(found)}" for scene, found in common.items() if found}


def _by_reason(path: Path, name: str, cases: Sequence[Case], remarks: list[str]) -> Declined:
    """The scene that a ``declined.txt`` declines: ``CODE: reason``."""
    code, colon, reason = read_text(path).partition(":")
    if not colon or not CODE.fullmatch(code.strip()) or path.parent.name not in {one.name for one in cases}:
        raise SceneError("", "declines no scene", "a line CODE: REASON in the folder of a scene")
    return {(code.strip(), path.parent.name): " ".join(reason.split())[:LONGEST_REASON]}
