"""Fields as PyVista data sets: the section through the axis, the deformed surface and the indenter.

Axes: ``x = r``, ``y = z`` (upwards, the body below 0), third coordinate 0. Arrays are named with what they
measure in units of the scene, ``stress_zz [force/length^2]``; warping by ``displacement [length]`` gives the
deformed body. Cells are the finite elements cut in four; cell data are means over whole elements, so summed
with ``volume [length^3]`` (of revolution) they give integrals over the mesh.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from contact_scene import Scene
from fem_solver.fields.states import COMPONENTS, FieldState
from validation.fields.section_mesh import surface_nodes, triangle_areas

if TYPE_CHECKING:
    import pyvista

Array = NDArray[np.float64]

STRESS, DENSITY, RATE = "force/length^2", "energy/length^3", "energy/(length^3 time)"
DISPLACEMENT = "displacement [length]"
_OUTLINE = 400
"""Points of the indenter's outline."""


def grid(state: FieldState) -> pyvista.UnstructuredGrid:
    """The undeformed section ``r >= 0, z <= 0`` with all fields at its nodes and in its cells."""
    import pyvista

    cells = {pyvista.CellType.TRIANGLE: state.triangles}
    result = pyvista.UnstructuredGrid(cells, _in_plane(state.points))
    for name, values in point_data(state).items():
        result.point_data[name] = values
    for name, values in cell_data(state).items():
        result.cell_data[name] = values
    _attach_scalars(result, state)
    return result


def point_data(state: FieldState) -> dict[str, Array]:
    """Nodal fields by their names in a file; shape (n,), the displacement (n, 3)."""
    data = {DISPLACEMENT: _in_plane(state.displacement)}
    for index, part in enumerate(COMPONENTS):
        data[f"stress_{part} [{STRESS}]"] = state.stress[index]
    for index, values in enumerate(state.principal, 1):
        data[f"principal_{index} [{STRESS}]"] = values
    data[f"von_mises [{STRESS}]"] = state.von_mises
    data[f"max_shear [{STRESS}]"] = state.max_shear
    data[f"hydrostatic [{STRESS}]"] = state.hydrostatic
    for index, part in enumerate(COMPONENTS):
        data[f"strain_{part} [1]"] = state.strain[index]
    data[f"stored_energy [{DENSITY}]"] = state.stored_energy_density
    for branch, rate, lost in zip(state.branches, state.dissipation_rate, state.dissipated, strict=True):
        data[f"dissipation_rate {branch} [{RATE}]"] = rate
        data[f"dissipated {branch} [{DENSITY}]"] = lost
    return data


def cell_data(state: FieldState) -> dict[str, Array]:
    """Means over the finite elements, by their names in a file; shape (4 m,)."""
    volumes, quarters = triangle_volumes(state), 4
    data = {"volume [length^3]": volumes}
    data[f"stored_energy [{DENSITY}]"] = np.tile(state.element_stored, quarters)
    for branch, rate, lost in zip(state.branches, state.element_rate, state.element_dissipated, strict=True):
        data[f"dissipation_rate {branch} [{RATE}]"] = np.tile(rate, quarters)
        data[f"dissipated {branch} [{DENSITY}]"] = np.tile(lost, quarters)
    return data


def triangle_volumes(state: FieldState) -> Array:
    """Volume of revolution of each triangle, ``2 pi`` times area times mean radius; shape (4 m,)."""
    return 2.0 * np.pi * triangle_areas(state) * state.points[state.triangles][:, :, 0].mean(axis=1)


def surface(state: FieldState) -> pyvista.PolyData:
    """The deformed surface from the axis outwards, with pressure and gap.

    The linear theory lets it meet the indenter at undeformed radii; moved sideways as well, which a
    compressible body does, it leaves the indenter by the product of slope and displacement.
    """
    profile, on_top = state.surface, surface_nodes(state)
    sideways = np.interp(profile.radius, state.points[on_top, 0], state.displacement[on_top, 0])
    moved = np.column_stack([sideways, -profile.displacement])
    result = _line(np.column_stack([profile.radius, np.zeros_like(profile.radius)]) + moved)
    result.point_data[DISPLACEMENT] = _in_plane(moved)
    result.point_data[f"pressure [{STRESS}]"] = profile.pressure
    result.point_data["gap [length]"] = profile.gap
    _attach_scalars(result, state)
    return result


def indenter(state: FieldState, scene: Scene) -> pyvista.PolyData:
    """The indenter's outline where it stands, as far out as the surface; a flat punch has its side."""
    reach, edge = float(state.surface.radius[-1]), scene.indenter.edge
    r = np.linspace(0.0, min(reach, edge), _OUTLINE)
    outline = np.column_stack([r, scene.indenter.height(r) - state.penetration])
    if math.isfinite(edge) and edge < reach:
        outline = np.vstack([outline, [edge, outline[-1, 1] + reach]])
    result = _line(outline)
    _attach_scalars(result, state)
    return result


def _line(points: Array) -> pyvista.PolyData:
    import pyvista

    return pyvista.PolyData(_in_plane(points), lines=[len(points), *range(len(points))])


def _in_plane(vectors: Array) -> Array:
    return np.column_stack([vectors, np.zeros(len(vectors))])


def _attach_scalars(data: pyvista.DataSet, state: FieldState) -> None:
    """Attach what holds for the whole state; numbers only, since not every reader takes text."""
    for name, value in (
        ("TimeValue", state.time),
        ("time [time]", state.time),
        ("penetration [length]", state.penetration),
        ("force [force]", state.force),
        ("contact_radius [length]", state.contact_radius),
    ):
        data.field_data[name] = np.array([value])
