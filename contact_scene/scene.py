"""Scene: the problem put to a solver, checked on construction, read from and written to TOML files.

Tables named in a scene file (profiles, loading tables, material data) are looked up beside it, and written
beside it as CSV.
"""

from __future__ import annotations

import os
import re
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any, Literal

import tomli_w

from contact_scene.adhesion import Adhesion
from contact_scene.approach_bound import bounded_approaches
from contact_scene.checked import (
    Checked,
    Key,
    Positive,
    Tabulated,
    check_keys,
    fields_of,
    from_table,
    to_table,
    under,
)
from contact_scene.errors import SceneError, shown
from contact_scene.files import as_path, as_target, read_text, table_text, write_whole
from contact_scene.indenter import SHAPES, Indenter
from contact_scene.loading import Loading
from contact_scene.machine import Machine
from contact_scene.material import Material
from contact_scene.material_file import material_of
from contact_scene.value_checks import a_string, of_class

_A_SCENE = "a scene: TOML tables [material], [indenter], [loading] and, if there is adhesion, [adhesion]"
_TABLES = ("units", "material", "body", "indenter", "adhesion", "machine", "loading")
PARTS = ("material", "indenter", "adhesion")
"""Parts of a scene that may be built before it."""
LONGEST_UNIT = 16
"""Characters of the name of a unit, which stands beside the axes of figures."""
THINNEST = 30.0
"""Largest contact radius, in thicknesses, that is computed: linear theory has long ended, and the functions
that describe a layer grow in number with it."""


@dataclass(frozen=True)
class Units(Checked):
    """Names of the units of a scene, which is in any consistent system: labels, nothing is converted.

    Examples
    --------
    >>> cc.Units(length="um", force="nN", time="s").force
    'nN'
    """

    length: Annotated[str, Key("unit of length")] = ""
    force: Annotated[str, Key("unit of force")] = ""
    time: Annotated[str, Key("unit of time")] = ""

    def rules(self) -> None:
        for kind, name in vars(self).items():
            if not name.isprintable() or "$" in name or len(name) > LONGEST_UNIT:
                allowed = f"a name of at most {LONGEST_UNIT} printable characters, as um or µm"
                raise SceneError(kind, f"got {shown(name)}", allowed)

    def states(self, dimension: str) -> bool:
        """Whether all units of a product of powers of length, force and time have names."""
        return all(name or kind not in dimension for kind, name in vars(self).items())

    def named(self, dimension: str) -> str:
        """The product by these names; what has none stays as it is."""
        for kind, name in vars(self).items():
            dimension = dimension.replace(kind, name or kind)
        return dimension


@dataclass(frozen=True)
class Layer(Checked):
    """A layer of finite ``thickness`` on a rigid ``base``: bonded, or without friction and never lifted off.

    Examples
    --------
    >>> cc.Layer(thickness=2e-5, base="bonded")
    Layer(thickness=2e-05, base='bonded')
    """

    thickness: Annotated[Positive, Key("thickness", "length")]
    base: Annotated[Literal["bonded", "frictionless"], Key("how it rests on its base")]

    @property
    def largest_contact(self) -> float:
        """Largest contact radius that is computed."""
        return THINNEST * self.thickness

    @property
    def outgrown(self) -> SceneError:
        """The error for a contact that is larger."""
        problem = f"the contact is wider than {THINNEST:g} thicknesses"
        return SceneError("body.thickness", problem, f"a contact of at most {THINNEST:g}")


@dataclass(frozen=True)
class Scene(Checked):
    """A rigid indenter on a viscoelastic half-space, or on a layer.

    Examples
    --------
    >>> rubber = cc.Material(1e6, 0.5, (cc.Branch(9e6, 0.1),))
    >>> pull = cc.Loading("relaxed", 1e-5, (cc.Ramp(-5e-5, 1e-6),))
    >>> scene = cc.Scene(rubber, cc.Sphere(1e-3), pull, cc.Adhesion(work=0.05, zone=1e-6))
    >>> f"{cc.solve(scene).pull_off.force:.3e}"
    '1.426e-03'
    """

    material: Annotated[Material, Key("half-space or layer")]
    indenter: Annotated[Indenter, SHAPES, Key("rigid indenter")]
    loading: Annotated[Loading, Key("what is done with it")]
    adhesion: Annotated[Adhesion | None, Key("adhesion between them, if any")] = None
    title: Annotated[str, Key("name of the scene in figures and reports")] = ""
    units: Annotated[Units | None, Key("names of its units in figures and tables")] = None
    body: Annotated[Layer | None, Key("layer, if it is no half-space")] = None

    def rules(self) -> None:
        if self.adhesion is not None:
            at_rest = self.adhesion.at_rest_on(self.material.relaxed_plane_modulus)
            object.__setattr__(self, "adhesion", at_rest)
        loading = bounded_approaches(self.loading, self.material, self.indenter, self.adhesion)
        object.__setattr__(self, "loading", loading)
        if self.is_adhesive and self.adhesion is not None and self.adhesion.zone >= self.indenter.edge:
            raise zone_too_long(self.adhesion.zone, self.indenter.edge)
        if self.body is not None:
            self._layer_rules(self.body.thickness)

    def _layer_rules(self, thickness: float) -> None:
        if self.material.bulk is not None:
            problem = "a layer takes a constant Poisson's ratio"
            raise SceneError("material.bulk", problem, "no bulk key, or no [body]: a half-space")
        if self.is_adhesive and self.adhesion is not None and self.adhesion.zone > 0.5 * thickness:
            problem = f"the process zone {self.adhesion.zone:.4g} is no small part of the layer"
            raise SceneError("adhesion.zone", problem, f"at most half its thickness, {0.5 * thickness:.4g}")

    @property
    def machine(self) -> Machine | None:
        """What holds the indenter; ``None``: rigid. Part of the loading."""
        return self.loading.machine

    @property
    def unit_names(self) -> str:
        """Its units in words."""
        names = [] if self.units is None else filter(None, vars(self.units).values())
        return ", ".join(names) or "scene units"

    @property
    def is_adhesive(self) -> bool:
        """Whether a closure is needed at all."""
        return self.adhesion is not None and self.adhesion.work > 0.0

    @property
    def bare_plane_tip(self) -> float:
        """Radius of a plane tip without adhesion, which touches, and is let go, as a whole; 0 of others."""
        return 0.0 if self.is_adhesive else self.indenter.plane_tip

    @property
    def ends_in_a_point(self) -> bool:
        """Whether contact shrinks to nothing before it is lost: without adhesion, if the tip is not plane."""
        return not self.is_adhesive and self.bare_plane_tip == 0.0


def zone_too_long(zone: float, contact_radius: float) -> SceneError:
    """The error for a process zone that does not fit into the contact it starts from."""
    return SceneError(
        "adhesion.zone",
        f"the process zone {zone:.4g} is longer than the contact radius {contact_radius:.4g}",
        "a zone shorter than the contact radius (about a tenth of it or less is usual)",
    )


def read_scene(path: str | os.PathLike[str]) -> Scene:
    """Read a scene from a TOML file.

    Raises
    ------
    SceneError
        One line: file, key, what is wrong, what is allowed.

    Examples
    --------
    >>> cc.write_scene(cc.builtin("cycle-v0.02"), "scene.toml")
    >>> cc.read_scene("scene.toml") == cc.builtin("cycle-v0.02")
    True
    """
    file = as_path(path, "", "the name of a scene file")
    text = read_text(file)
    try:
        data = tomllib.loads(text)
    except (ValueError, RecursionError) as error:  # ValueError also for integers of thousands of digits
        raise SceneError("", f"not a TOML file: {error}", _A_SCENE, str(path)) from None
    if not data:
        raise SceneError("", "the file is empty", _A_SCENE, str(path))
    try:
        return scene_from_dict(data, file.parent)
    except SceneError as error:
        raise error.in_file(str(path)) from None


def scene_from_dict(data: dict[str, Any], folder: str | os.PathLike[str] = ".") -> Scene:
    """Build a scene from the parsed contents of a scene file; tables are looked up in ``folder``.

    Of material, indenter and adhesion a part that is built already may stand for its table.

    Examples
    --------
    >>> scene = cc.scene_from_dict({
    ...     "material": {"modulus": 1e6, "poisson": 0.5},
    ...     "indenter": {"shape": "sphere", "radius": 1e-3},
    ...     "loading": {"start": "jump-in", "penetration": 0.0, "steps": [{"kind": "hold", "duration": 1.0}]},
    ... })
    >>> scene.indenter
    Sphere(radius=0.001)
    """
    where = as_path(folder, "folder", "the path of a folder")
    if not isinstance(data, dict):
        raise SceneError("", f"got {shown(data)}", _A_SCENE)
    check_keys(data, ("title", *_TABLES))
    for key in _TABLES:
        if key in data and not isinstance(data[key], (dict, Checked) if key in PARTS else dict):
            raise SceneError(key, f"got {shown(data[key])}", f"a table [{key}]")
        if key not in data and key in ("material", "indenter", "loading"):
            raise SceneError(key, "is missing", f"a table [{key}]")
    parts = {key: value for key, value in data.items() if key != "machine"}
    if isinstance(data["material"], dict):
        parts["material"] = part_of("material", data["material"], where)
    under("loading", lambda: check_keys(data["loading"], ("start", "penetration", "steps")))
    if "machine" in data:  # a table of its own in a file, part of the loading in a scene
        machine = under("machine", lambda: from_table([Machine], data["machine"], where))
        parts["loading"] = data["loading"] | {"machine": machine}
    scene: Scene = from_table([Scene], parts, where)
    return scene


def part_of(name: str, table: dict[str, Any], where: Path) -> Any:
    """The part of a scene, one of ``PARTS``, that a table states."""
    if name == "material":
        return under(name, lambda: material_of(table, where))
    return fields_of(Scene)[name].check(table, name, where)


def scene_table(scene: Scene, file: Any = None) -> dict[str, Any]:
    """The contents of a scene file; ``file`` as of :func:`contact_scene.checked.to_table`."""
    table = to_table(scene, file)
    machine = table["loading"].pop("machine", None)
    return table if machine is None else table | {"machine": machine}


def write_scene(scene: Scene, path: str | os.PathLike[str]) -> None:
    """Write a scene as TOML (tables of profiles, rates and loading go into CSV files beside it).

    Raises
    ------
    SceneError
        One line, if the path is none of a file that can be written.

    Examples
    --------
    >>> cc.write_scene(cc.builtin("cycle-v0.02"), "scene.toml")
    >>> Path("scene.toml").read_text().splitlines()[0]
    'title = "Approach and retraction at V = 0.02 (Fig. 2)"'
    """
    of_class(scene, "scene", Scene, "a Scene")
    target = as_target(path)

    def beside(place: tuple[str, ...], part: Tabulated) -> str:
        name = f"{target.stem}-{'-'.join(place)}.csv"
        columns = dict(zip(part.column_names(vars(part)), part.stated().values(), strict=False))
        write_whole(target.with_name(name), table_text(columns))
        return name

    write_whole(target, tomli_w.dumps(scene_table(scene, beside)))


def write_material(material: Material, path: str | os.PathLike[str], remark: str = "") -> None:
    """Write the table ``[material]`` of a scene file as TOML, below the lines of ``remark`` as comments.

    Raises
    ------
    SceneError
        One line, if the path is none of a file that can be written.

    Examples
    --------
    >>> cc.write_material(cc.Material(1e6, 0.5), "material.toml")
    >>> print(Path("material.toml").read_text(), end="")
    [material]
    modulus = 1000000.0
    poisson = 0.5
    """
    of_class(material, "material", Material, "a Material")
    comments = "".join(f"# {line}\n" for line in a_string(remark, "remark").splitlines())
    write_whole(as_target(path), comments + tomli_w.dumps({"material": to_table(material, _no_file)}))


def _no_file(place: tuple[str, ...], part: Tabulated) -> str:
    raise AssertionError("a material has no tabulated part")


def value_at(scene: Scene, path: str) -> float:
    """The number of a scene at a dotted path, as in a scene file: ``loading.steps[1].rate``.

    Places in lists are counted from 0, in brackets or between dots.
    """
    part, key = _place(scene_table(scene), path)
    return float(part[key])


def with_values(scene: Scene, values: Mapping[str, float]) -> Scene:
    """The scene with other numbers at some paths, put in together: it is checked once it is whole."""
    table = scene_table(scene)
    for path, value in values.items():
        part, key = _place(table, path)
        part[key] = value
    return scene_from_dict(table)


def _place(table: dict[str, Any], path: Any) -> tuple[Any, Any]:
    """The table or list, and the key or place in it, where a number is."""
    keys = re.sub(r"\[(\d+)\]", r".\1", path).split(".") if isinstance(path, str) else [""]
    if not all(re.fullmatch(r"[A-Za-z_]\w*|\d+", key) for key in keys):
        raise SceneError(shown(path), "is no path", "names joined by dots, as adhesion.work")
    at: Any = table
    part: Any = None
    place: Any = None
    for depth, key in enumerate(keys):
        part, place, name = at, key, ".".join(keys[:depth]) or "the scene"
        if isinstance(part, list):
            place = int(key) if key.isdecimal() else -1
            if not 0 <= place < len(part):
                raise SceneError(path, f"{name} has {len(part)} entries", "places counted from 0")
        elif not isinstance(part, dict) or key not in part:
            allowed = ", ".join(part) if isinstance(part, dict) else "the path of a number in the scene"
            raise SceneError(path, f"{name} has no {key}", allowed)
        at = part[place]
    if isinstance(at, bool) or not isinstance(at, (int, float)):
        raise SceneError(path, f"is no number but {shown(at)}", "the path of a number in the scene")
    return part, place
