"""Fields as PyVista data sets: the section through the axis, the surface and the indenter, all deformed.

Points are where the body is under load: ``x = r``, ``y = 0``, ``z`` upwards with the undeformed surface at 0,
as in the components ``rr, zz, tt, rz``. ``displacement_applied [length]`` is the vector that has led there:
to warp by it again magnifies the deformation, to warp by -1 times it takes it away. Arrays are named with
what they measure, as on the command line, in units of the scene. Cells are the finite elements cut in four;
cell data are means over whole elements, so summed with ``undeformed_volume [length^3]`` (of revolution) they
give integrals over the mesh.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from contact_scene import Scene
from fem_solver.fields.states import FieldState
from validation.fields.figures.quantities import DENSITY, QUANTITIES, RATE, STRESS
from validation.fields.section_mesh import surface_nodes, triangle_areas

if TYPE_CHECKING:
    import pyvista

Array = NDArray[np.float64]

DISPLACEMENT = "displacement_applied [length]"
_OUTLINE = 400
"""Points of the indenter's outline."""


def grid(state: FieldState) -> pyvista.UnstructuredGrid:
    """The deformed section ``r >= 0`` with all fields at its nodes and in its cells."""
    import pyvista

    cells = {pyvista.CellType.TRIANGLE: state.triangles}
    result = pyvista.UnstructuredGrid(cells, _in_space(state.points + state.displacement))
    for name, values in point_data(state).items():
        result.point_data[name] = values
    for name, values in cell_data(state).items():
        result.cell_data[name] = values
    _attach_scalars(result, state)
    return result


def point_data(state: FieldState) -> dict[str, Array]:
    """Nodal fields by their names in a file; shape (n,), the displacement (n, 3)."""
    data = {DISPLACEMENT: _in_space(state.displacement)}
    for quantity in QUANTITIES.values():
        if not quantity.name.startswith("displacement") and quantity.known(state):
            data[quantity.array] = quantity.values(state)
    return data | _by_branch(state, state.dissipation_rate, state.dissipated)


def cell_data(state: FieldState) -> dict[str, Array]:
    """Means over the finite elements, by their names in a file; shape (4 m,)."""
    quarters = 4
    means = {
        f"stored_energy [{DENSITY}]": state.element_stored,
        f"dissipation_rate [{RATE}]": state.element_rate.sum(axis=0),
    }
    if state.element_dissipated is not None:
        means[f"dissipated_energy [{DENSITY}]"] = state.element_dissipated.sum(axis=0)
    means |= _by_branch(state, state.element_rate, state.element_dissipated)
    volumes = {"undeformed_volume [length^3]": triangle_volumes(state)}
    return volumes | {name: np.tile(values, quarters) for name, values in means.items()}


def _by_branch(state: FieldState, rates: Array, dissipated: Array | None) -> dict[str, Array]:
    """Losses of each branch by their names in a file, energies where they are known."""
    data = {}
    for k, branch in enumerate(state.branches):
        data[f"dissipation_rate {branch} [{RATE}]"] = rates[k]
        if dissipated is not None:
            data[f"dissipated_energy {branch} [{DENSITY}]"] = dissipated[k]
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
    result.point_data[DISPLACEMENT] = _in_space(moved)
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
    result.point_data[DISPLACEMENT] = _in_space(np.tile([0.0, -state.penetration], (len(outline), 1)))
    _attach_scalars(result, state)
    return result


def _line(points: Array) -> pyvista.PolyData:
    import pyvista

    return pyvista.PolyData(_in_space(points), lines=[len(points), *range(len(points))])


def _in_space(vectors: Array) -> Array:
    """Components (r, z) along x and z; shape (n, 3)."""
    return np.column_stack([vectors[:, 0], np.zeros(len(vectors)), vectors[:, 1]])


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
