"""What is asked: a folder for each scene, which holds it as TOML, as plain JSON and as a page in words.

``scene.json`` needs no reader of ours: its keys are those of a scene file, every default is filled in and
every table that a scene file names is a list. ``adhesion``, ``body``, ``machine`` and ``material.bulk`` are
``null`` where a scene has none; ``derived`` follows from the rest. The tags of a scene tell what a code has
to cover to answer it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, replace
from functools import cache
from pathlib import Path
from typing import Any

from jinja2 import Environment, PackageLoader, StrictUndefined

import contact_scene as cs
from contact_scene.errors import shown
from contact_scene.files import read_text
from contact_scene.loading import STEPS
from contact_scene.scene import scene_table
from validation.cases import Case, load
from validation.runs import provenance
from validation.runs.folder import from_json, to_json, write_whole
from validation.scenes import names
from validation.scenes import suite as of_suite

EXAM = "exam.json"
"""File that lists the scenes of an exam."""
FORMAT = 1
ALWAYS = ("adhesionless-force", "elastic-press")
"""Scenes that are in every exam, for codes that answer nothing else."""
COLUMNS = {
    "time": "time, 0 at the start state; never falls, two rows of equal time are a jump",
    "penetration": "D, positive downwards: the lowest point of the indenter is at D below the free surface",
    "force": "F, compression positive, tension negative",
    "contact_radius": "a, a radius; 0 once contact is lost",
    "stored_energy": "elastic energy of the half-space, in all branches of the material",
    "external_work": "integral of F dD from the start, jumps included; 0 in the first row",
    "dissipated_energy": "viscous loss from the start: external work + work of adhesion * change of contact "
    "area - change of stored energy",
}
DERIVED = "derived"
TAGS = {"force": "force-control", "force-ramp": "force-control", "oscillate": "oscillation"}
TAGS |= {"flat-punch": "punch"}
"""Tags of load steps and shapes of indenters; any other kind is its own tag."""
_ALWAYS_STATED = {"title", "material", "indenter", "loading", "adhesion", "work", "zone"}
_SHAPES = (cs.Sphere, cs.Cone, cs.FlatPunch, cs.PowerLaw, cs.TabulatedProfile)
POSSIBLE = {
    *("adhesive", "adhesionless", "elastic", "viscoelastic", "spectrum", "separate-bulk", "relaxed-start"),
    *("spring", "trigger"),
    *(TAGS.get(kind, kind) for kind in (*(s.kind for s in STEPS), *(s.shape for s in _SHAPES))),
}
"""Tags a scene can have, those for further parts of a scene aside."""


def tags(scene: cs.Scene) -> tuple[str, ...]:
    """All tags of a scene, in alphabetical order."""
    material, loading, adhesive = scene.material, scene.loading, scene.is_adhesive
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
    } | {name: value is not None for name, value in stated.items() if name not in _ALWAYS_STATED}
    kinds = {scene.indenter.shape, *(step.kind for step in loading.steps)}
    found = {TAGS.get(kind, kind) for kind in kinds} | {tag for tag, is_so in given.items() if is_so}
    return tuple(sorted(tag.replace("_", "-") for tag in found))


def expanded(scene: cs.Scene) -> dict[str, Any]:
    """The scene as in ``scene.json``."""
    data, material = scene_table(scene), scene.material
    data["material"] = {"bulk": None} | data["material"]
    data[DERIVED] = {
        "glassy_modulus": material.glassy_modulus,
        "relaxed_plane_modulus": material.relaxed_plane_modulus,
        "glassy_plane_modulus": material.glassy_plane_modulus,
    }
    return {"adhesion": None, "body": None, "machine": None} | data


def scene_of(data: Any) -> cs.Scene:
    """The scene of such data; a ``SceneError`` where they are those of no scene."""
    if not isinstance(data, dict):
        raise cs.SceneError("scene", f"got {shown(data)}", "an object with the keys of a scene file")
    return cs.scene_from_dict(_without_null({key: value for key, value in data.items() if key != DERIVED}))


def _without_null(value: Any) -> Any:
    if isinstance(value, dict):
        return {key: _without_null(entry) for key, entry in value.items() if entry is not None}
    return [_without_null(entry) for entry in value] if isinstance(value, list) else value


def difference(stated: Any, asked: Any, key: str = "") -> str:
    """The first key where two expanded scenes differ, as far as both say something, in words; or nothing."""
    if isinstance(stated, dict) and isinstance(asked, dict):
        common = [name for name in asked if name in stated and name not in (DERIVED, "title")]
        parts = [(name, stated[name], asked[name]) for name in common]
    elif isinstance(stated, list) and isinstance(asked, list) and len(stated) == len(asked):
        parts = [(str(index), *both) for index, both in enumerate(zip(stated, asked, strict=True))]
    else:
        return "" if stated == asked else f"{key} is {shown(stated)} there, {shown(asked)} here"
    inner = (difference(one, other, f"{key}.{name}".lstrip(".")) for name, one, other in parts)
    return next(filter(None, inner), "")


def page(case: Case) -> str:
    """The page of a scene in words, as Markdown."""
    scene = case.scene
    stated = {} if scene.adhesion is None else asdict(scene.adhesion)
    about = {"name": case.name, "statement": case.statement, "tags": tags(scene), "stated": stated}
    return _rendered("page.md", scene=scene, **about)


@cache
def _templates() -> Environment:
    loader = PackageLoader("validation.exam")
    return Environment(loader=loader, undefined=StrictUndefined, trim_blocks=True, lstrip_blocks=True)


def _rendered(template: str, **values: Any) -> str:
    return _templates().get_template(template).render(columns=COLUMNS, **values).rstrip() + "\n"


def exam_cases(suite: str) -> list[Case]:
    """Scenes of a suite that the reference has an answer to, and those of every exam."""
    chosen = {*of_suite(suite), *ALWAYS}
    return [replace(load(name), profile_times=()) for name in names() if name in chosen]


def export_scenes(folder: Path, cases: Sequence[Case]) -> None:
    """Write ``exam.json``, ``README.md`` and, for each scene, ``scene.toml``, ``scene.json``, ``page.md``."""
    of_scene = {case.name: tags(case.scene) for case in cases}
    for case in cases:
        (folder / case.name).mkdir(parents=True, exist_ok=True)
        cs.write_scene(case.scene, folder / case.name / "scene.toml")
        data = {"name": case.name, "tags": of_scene[case.name]} | expanded(case.scene)
        write_whole(folder / case.name / "scene.json", to_json(data | {"columns": COLUMNS}))
        write_whole(folder / case.name / "page.md", page(case))
    write_whole(folder / "README.md", _rendered("README.md", scenes=of_scene))
    listed = [{"name": case.name, "tags": of_scene[case.name], "title": case.scene.title} for case in cases]
    write_whole(folder / EXAM, to_json({"format": FORMAT, "program": provenance.version(), "scenes": listed}))


def listed_cases(folder: Path) -> tuple[Case, ...]:
    """The scenes of an exported exam: built-in ones, unless the folder states another under their name."""
    text, file = read_text(folder / EXAM), str(folder / EXAM)
    try:
        listed = dict.fromkeys(entry["name"] for entry in from_json(text)["scenes"])
    except (ValueError, KeyError, TypeError):
        allowed = "a file written by `crosscontact exam export`"
        raise cs.SceneError("scenes", "is no list of scenes", allowed, file) from None
    cases = []
    for name in listed:
        if not isinstance(name, str) or not name or Path(name).name != name:
            raise cs.SceneError("scenes", f"got {shown(name)}", "names of folders", file)
        case = Case(name, cs.read_scene(folder / name / "scene.toml"))
        built_in = load(name) if name in names() else case
        same = expanded(built_in.scene) == expanded(case.scene)
        cases.append(replace(built_in, profile_times=()) if same else case)
    return tuple(cases)
