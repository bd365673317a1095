"""Meshes in and out of files through meshio: VTU (for ParaView) and msh (for gmsh).

Triangles and boundary edges are cells with an integer that names their part. The parameters are stored as
JSON, in VTU as field data, in msh as a comment block, both of which other programs ignore.
"""

from __future__ import annotations

import json
import os
import re
from dataclasses import asdict
from pathlib import Path
from xml.etree import ElementTree

import numpy as np

from meshes.mesh import BOUNDARIES, HalfSpaceMesh
from meshes.parameters import MeshParameters

PARTS = {name: number for number, name in enumerate((*BOUNDARIES, "half-space"), start=1)}
"""Number of each part in files."""
FIELD = "crosscontact_parameters"


def write(mesh: HalfSpaceMesh, path: str | os.PathLike[str]) -> None:
    """Write a mesh to ``path``; the suffix, ``.vtu`` or ``.msh``, chooses the format.

    Raises
    ------
    ValueError
        For another suffix.
    """
    import meshio

    target = Path(path)
    form = _format(target)
    cells = [("triangle", mesh.triangles.T), *(("line", mesh.boundaries[name].T) for name in BOUNDARIES)]
    names = ["half-space", *BOUNDARIES]
    tags = [np.full(len(block), PARTS[name], np.int32) for name, (_, block) in zip(names, cells, strict=True)]
    points = np.column_stack([mesh.points.T, np.zeros(mesh.points.shape[1])])
    text = json.dumps(asdict(mesh.parameters))
    if form == "vtu":
        meshio.Mesh(points, cells, cell_data={"part": tags}).write(target, file_format="vtu")
        _insert_field(target, text)
        return
    dimension = {name: 2 if name == "half-space" else 1 for name in PARTS}
    physical = {name: np.array([number, dimension[name]]) for name, number in PARTS.items()}
    data = {"gmsh:physical": tags, "gmsh:geometrical": tags}
    meshio.Mesh(points, cells, cell_data=data, field_data=physical).write(target, file_format="gmsh22")
    with target.open("ab") as stream:
        stream.write(f"$Comments\n{FIELD} {text}\n$EndComments\n".encode())


def read(path: str | os.PathLike[str]) -> HalfSpaceMesh:
    """Read a mesh written by `write`.

    Raises
    ------
    ValueError
        When the file is not such a mesh.
    OSError
        When it cannot be opened.
    """
    import meshio

    source = Path(path)
    form = _format(source)
    with source.open("rb") as stream:
        content = stream.read()
    try:
        stored = meshio.read(source, file_format="vtu" if form == "vtu" else "gmsh")
        text = _field(stored) if form == "vtu" else _comment(content)
        parameters = MeshParameters(**json.loads(text))
        tags = stored.cell_data["part" if form == "vtu" else "gmsh:physical"]
        parts = {name: _part(stored.cells, tags, number) for name, number in PARTS.items()}
        triangles = parts.pop("half-space")
        return HalfSpaceMesh(stored.points[:, :2].T, triangles, parts, parameters)
    # meshio reports a broken file through its own errors, the XML and number parsers, and SystemExit
    except (Exception, SystemExit) as error:
        raise ValueError(f"{source}: not a half-space mesh written by this package ({error})") from error


def _format(path: Path) -> str:
    suffix = path.suffix.lower().lstrip(".")
    if suffix not in ("vtu", "msh"):
        raise ValueError(f"{path}: the suffix must be .vtu or .msh")
    return suffix


def _part(cells: list, tags: list, number: int) -> np.ndarray:
    chosen = [
        block.data[tag == number] for block, tag in zip(cells, tags, strict=True) if (tag == number).any()
    ]
    return np.concatenate(chosen).T


def _insert_field(path: Path, text: str) -> None:
    """Add the parameters to a VTU file as field data, the characters as small integers."""
    tree = ElementTree.parse(path)
    grid = tree.getroot().find("UnstructuredGrid")
    if grid is None:
        raise ValueError(f"{path}: has no unstructured grid")
    codes = text.encode()
    holder = ElementTree.Element("FieldData")
    attributes = {"type": "UInt8", "Name": FIELD, "NumberOfTuples": str(len(codes)), "format": "ascii"}
    ElementTree.SubElement(holder, "DataArray", attributes).text = " ".join(map(str, codes))
    grid.insert(0, holder)
    tree.write(path, xml_declaration=True, encoding="utf-8")


def _field(stored) -> str:
    return bytes(stored.field_data[FIELD].astype(np.uint8)).decode()


def _comment(content: bytes) -> str:
    match = re.search(rb"\$Comments\s+" + FIELD.encode() + rb" (\{.*?\})\s", content)
    if match is None:
        raise ValueError("no parameters in it")
    return match[1].decode()
