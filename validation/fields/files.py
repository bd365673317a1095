"""Fields on disk: VTU and VTP files with time series that ParaView opens, and the numbers beside them.

``body.pvd``, ``surface.pvd`` and ``indenter.pvd`` list the files of the folder of that name by time, all of
them in the deformed configuration (see ``grid``); ``moments.json`` says what each moment is, what the
densities add up to, and what all this cost. Each file appears whole or not at all; the lists, and last the
numbers, are written when all they name is there.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Any
from xml.sax.saxutils import quoteattr

from contact_scene import Scene
from validation.fields.balance import EnergySums
from validation.runs.files import to_json, write_whole
from validation.runs.run_folder import FIELDS

if TYPE_CHECKING:
    import pyvista

    from fem_solver import FieldState

PARTS = {"body": "vtu", "surface": "vtp", "indenter": "vtp"}


class ParaViewSeries:
    """Writes states into a folder one by one.

    Parameters
    ----------
    folder : Path
    scene : Scene
    """

    def __init__(self, folder: Path, scene: Scene) -> None:
        self._folder, self._scene = folder, scene
        self._moments: list[dict[str, Any]] = []
        self._times: list[float] = []
        self.bytes = 0
        for name, kind in PARTS.items():
            (folder / f"{name}.pvd").unlink(missing_ok=True)
            (folder / name).mkdir(exist_ok=True)
            for left_over in (folder / name).glob(f"{name}_[0-9]*.{kind}"):
                left_over.unlink()
        (folder / FIELDS).unlink(missing_ok=True)

    def add(self, state: FieldState, balance: EnergySums) -> None:
        """Write one state, and what its densities add up to.

        Raises
        ------
        OSError
            If a file cannot be written.
        """
        from validation.fields.grid import grid, indenter, surface

        index = len(self._times)
        paths = [self._folder / name / _file(name, index) for name in PARTS]
        sets = grid(state), surface(state), indenter(state, self._scene)
        for data, path in zip(sets, paths, strict=True):
            save(data, path)
        self.bytes += sum(path.stat().st_size for path in paths)
        before = self._times[-1] if self._times else -math.inf
        # a jump of the load is two states at one time; a reader of the list would show only one of them
        self._times.append(state.time if state.time > before else math.nextafter(before, math.inf))
        about = ("row", "time", "label", "penetration", "force", "contact_radius")
        self._moments.append({name: getattr(state, name) for name in about} | asdict(balance))

    def close(self, numbers: dict[str, Any]) -> list[Path]:
        """Write the lists and the numbers; returns what a reader would open."""
        written = []
        for name in PARTS:
            files = [f"{name}/{_file(name, index)}" for index in range(len(self._times))]
            written.append(self._folder / f"{name}.pvd")
            write_whole(written[-1], collection(zip(self._times, files, strict=True)))
        write_whole(self._folder / FIELDS, to_json({"moments": self._moments} | numbers))
        return written


def _file(name: str, index: int) -> str:
    return f"{name}_{index:04d}.{PARTS[name]}"


def save(data: pyvista.DataSet, path: Path) -> None:
    """Write a data set whole or not at all; the writer itself would crash on a full disk."""
    from vtkmodules.vtkIOXML import vtkXMLPolyDataWriter, vtkXMLUnstructuredGridWriter

    writer = {".vtu": vtkXMLUnstructuredGridWriter, ".vtp": vtkXMLPolyDataWriter}[path.suffix]()
    writer.SetInputData(data)
    writer.SetDataModeToBinary()
    writer.WriteToOutputStringOn()
    writer.Write()
    write_whole(path, writer.GetOutputString())


def collection(files: Iterable[tuple[float, str]]) -> str:
    """A ParaView collection of files by time."""
    sets = "".join(
        f'    <DataSet timestep="{time!r}" part="0" file={quoteattr(file)}/>\n' for time, file in files
    )
    return (
        '<?xml version="1.0"?>\n<VTKFile type="Collection" version="0.1">\n'
        f"  <Collection>\n{sets}  </Collection>\n</VTKFile>\n"
    )
