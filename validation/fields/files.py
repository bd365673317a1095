"""Fields on disk: VTU and VTP files with time series that ParaView opens, and the numbers beside them.

The section through the axis, the surface and the indenter are data sets in the deformed configuration:
``x = r``, ``y = 0``, ``z`` upwards with the undeformed surface at 0, as in the components ``rr, zz, tt, rz``.
``displacement_applied [length]`` is the vector that has led there: to warp by it again magnifies the
deformation, to warp by -1 times it takes it away. Arrays are named with what they measure, as on the command
line, in units of the scene. Cells are the finite elements cut in four; cell data (``mean_``) are means over
whole elements, so summed with ``undeformed_volume [length^3]`` (of revolution) they give integrals over the
mesh.

``body.pvd``, ``surface.pvd`` and ``indenter.pvd`` list the files of the folder of that name by time;
``moments.json`` says what each moment is, what the densities add up to, and what all this cost. Each file
appears whole or not at all; the lists, and last the numbers, are written when all they name is there.
"""

from __future__ import annotations

import math
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Any
from xml.sax.saxutils import quoteattr

import numpy as np

from contact_scene import Scene
from contact_scene.trace import Array
from validation.fields.moments import EnergySums
from validation.fields.quantities import DENSITY, QUANTITIES, RATE, STRESS
from validation.fields.section import outline, surface_nodes, triangle_areas
from validation.runs.folder import to_json, write_whole

if TYPE_CHECKING:
    import pyvista

    from fem_solver import FieldState

PARTS = {"body": "vtu", "surface": "vtp", "indenter": "vtp"}
DISPLACEMENT = "displacement_applied [length]"


def data_sets(state: FieldState, scene: Scene) -> dict[str, pyvista.DataSet]:
    """Body, surface and indenter of a state by the names of their folders."""
    import pyvista

    cells = {pyvista.CellType.TRIANGLE: state.triangles}
    body = pyvista.UnstructuredGrid(cells, _in_space(state.points + state.displacement))
    for name, array in point_data(state).items():
        body.point_data[name] = array
    for name, array in cell_data(state).items():
        body.cell_data[name] = array
    sets: dict[str, pyvista.DataSet] = {"body": body, "surface": _surface(state)}
    sets["indenter"] = _indenter(state, scene)
    values = {"TimeValue": state.time, "time [time]": state.time, "penetration [length]": state.penetration}
    values |= {"force [force]": state.force, "contact_radius [length]": state.contact_radius}
    for data in sets.values():
        for name, value in values.items():
            data.field_data[name] = np.array([value])
    return sets


def point_data(state: FieldState) -> dict[str, Array]:
    """Nodal fields by their names in a file; shape (n,), the displacement (n, 3)."""
    data = {DISPLACEMENT: _in_space(state.displacement)}
    for quantity in QUANTITIES.values():
        if not quantity.name.startswith("displacement"):
            data[quantity.array] = quantity.values(state)
    return data | _by_branch(state, state.dissipation_rate, state.dissipated)


def cell_data(state: FieldState) -> dict[str, Array]:
    """Means over the finite elements, by their names in a file; shape (4 m,)."""
    means = {f"mean_stored_energy [{DENSITY}]": state.element_stored}
    means[f"mean_dissipation_rate [{RATE}]"] = state.element_rate.sum(axis=0)
    means[f"mean_dissipated_energy [{DENSITY}]"] = state.element_dissipated.sum(axis=0)
    by_branch = _by_branch(state, state.element_rate, state.element_dissipated)
    means |= {f"mean_{name}": values for name, values in by_branch.items()}
    # of revolution: 2 pi times area times mean radius
    radii = state.points[state.triangles][:, :, 0].mean(axis=1)
    volumes = {"undeformed_volume [length^3]": 2.0 * np.pi * triangle_areas(state) * radii}
    return volumes | {name: np.tile(values, 4) for name, values in means.items()}


def _by_branch(state: FieldState, rates: Array, dissipated: Array) -> dict[str, Array]:
    """Losses of each branch by their names in a file."""
    data = {}
    for k, branch in enumerate(state.branches):
        data[f"dissipation_rate {branch} [{RATE}]"] = rates[k]
        data[f"dissipated_energy {branch} [{DENSITY}]"] = dissipated[k]
    return data


def _surface(state: FieldState) -> pyvista.PolyData:
    """The deformed surface from the axis outwards, with pressure and gap.

    The linear theory lets it meet the indenter at undeformed radii; moved sideways as well, which a
    compressible body does, it leaves the indenter by the product of slope and displacement.
    """
    profile, on_top = state.surface, surface_nodes(state)
    sideways = np.interp(profile.radius, state.points[on_top, 0], state.displacement[on_top, 0])
    moved = np.column_stack([sideways, -profile.displacement])
    result = _line(np.column_stack([profile.radius, 0.0 * profile.radius]) + moved, moved)
    result.point_data[f"pressure [{STRESS}]"] = profile.pressure
    result.point_data["gap [length]"] = profile.gap
    return result


def _indenter(state: FieldState, scene: Scene) -> pyvista.PolyData:
    """The indenter's outline where it stands, as far out as the surface."""
    points = outline(scene, state.penetration, float(state.surface.radius[-1]))
    return _line(points, np.tile([0.0, -state.penetration], (len(points), 1)))


def _line(points: Array, moved: Array) -> pyvista.PolyData:
    import pyvista

    result = pyvista.PolyData(_in_space(points), lines=[len(points), *range(len(points))])
    result.point_data[DISPLACEMENT] = _in_space(moved)
    return result


def _in_space(vectors: Array) -> Array:
    """Components (r, z) along x and z; shape (n, 3)."""
    return np.column_stack([vectors[:, 0], np.zeros(len(vectors)), vectors[:, 1]])


class ParaViewSeries:
    """Writes states into a folder one by one, in place of an earlier series."""

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
        (folder / "moments.json").unlink(missing_ok=True)

    def add(self, state: FieldState, balance: EnergySums) -> None:
        """Write one state, and what its densities add up to."""
        for name, data in data_sets(state, self._scene).items():
            path = self._folder / _file(name, len(self._times))
            save(data, path)
            self.bytes += path.stat().st_size
        before = self._times[-1] if self._times else -math.inf
        # a jump of the load is two states at one time; a reader of the list would show only one of them
        self._times.append(state.time if state.time > before else math.nextafter(before, math.inf))
        about = ("row", "time", "label", "penetration", "force", "contact_radius")
        self._moments.append({name: getattr(state, name) for name in about} | asdict(balance))

    def close(self, numbers: dict[str, Any]) -> list[Path]:
        """Write the lists and the numbers; returns what a reader would open."""
        written = []
        for name in PARTS:
            sets = "".join(
                f'    <DataSet timestep="{time!r}" part="0" file={quoteattr(_file(name, index))}/>\n'
                for index, time in enumerate(self._times)
            )
            written.append(self._folder / f"{name}.pvd")
            head = '<?xml version="1.0"?>\n<VTKFile type="Collection" version="0.1">\n'
            write_whole(written[-1], f"{head}  <Collection>\n{sets}  </Collection>\n</VTKFile>\n")
        write_whole(self._folder / "moments.json", to_json({"moments": self._moments} | numbers))
        return written


def _file(name: str, index: int) -> str:
    return f"{name}/{name}_{index:04d}.{PARTS[name]}"


def save(data: pyvista.DataSet, path: Path) -> None:
    """Write a data set whole or not at all; the writer itself would crash on a full disk."""
    from vtkmodules.vtkIOXML import vtkXMLPolyDataWriter, vtkXMLUnstructuredGridWriter

    writer = {".vtu": vtkXMLUnstructuredGridWriter, ".vtp": vtkXMLPolyDataWriter}[path.suffix]()
    writer.SetInputData(data)
    writer.SetDataModeToBinary()
    writer.WriteToOutputStringOn()
    writer.Write()
    write_whole(path, writer.GetOutputString())
