"""How far the finite elements' fields can be trusted: ``python -m benchmarks.fields_accuracy``.

Static contacts are compared with closed forms at all nodes within ``REACH`` contact radii of the centre, but
those nearer than ``EDGE`` contact radii to the edge (the stress is infinite there, or its slope is); errors
are relative to the largest stress component among these nodes. Closed forms belong to the radius and the
penetration of the finite elements, so that what is measured is the field.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from contact_scene import Adhesion, FlatPunch, Indenter, Layer, Loading, Material, Scene, Sphere, Trace
from validation import cases
from validation.fields.moments import EnergySums, FieldRequest, balance, record_fields
from validation.fields.section import surface_nodes
from validation.measure.events import end_of_approach
from validation.reference import layer_subsurface, subsurface
from validation.reference.elastic_layer import ElasticLayer

if TYPE_CHECKING:
    from fem_solver import FieldState

Array = NDArray[np.float64]

REACH, EDGE = 3.0, 0.1
"""Largest distance from the centre and least distance from the edge of compared nodes, in contact radii."""
CONTACTS: dict[str, tuple[Indenter, Adhesion | None]] = {
    "flat punch": (FlatPunch(0.1), None),
    "Hertz": (Sphere(1.0), None),
    "JKR": (Sphere(1.0), Adhesion(1e-4, 0.004)),
}
RATIOS = (0.3, 0.5)
"""Poisson's ratios of the static contacts."""
CYCLES = ("cycle-v0.02", "three-branches")
"""Built-in scenes whose dissipated energy is compared."""


@dataclass(frozen=True)
class Deviation:
    """Largest errors of a static field, of the largest stress: below the surface, on it inside and beside the
    contact; ``traction``: of recovered normal stress from nodal reactions over area, of the mean pressure;
    ``force``: of their sums.
    """

    below: float
    inside: float
    beside: float
    traction: float
    force: float

    @property
    def worst(self) -> float:
        """Against the closed form."""
        return max(self.below, self.inside, self.beside)


def static(
    name: str, poisson: float, resolution: int | None = None, body: Layer | None = None
) -> tuple[FieldState, Deviation]:
    """Field of a static contact by name, and its errors."""
    indenter, adhesion = CONTACTS[name]
    scene = Scene(Material(1.0, poisson), indenter, Loading("relaxed", 0.01), adhesion, body=body)
    (state,) = record_fields(scene, FieldRequest((0.0,)), resolution).states()
    return state, deviation(state, scene)


def deviation(state: FieldState, scene: Scene) -> Deviation:
    """Errors of the stress of an elastic scene."""
    a, (r, z) = state.contact_radius, state.points.T
    near = (np.hypot(r, z) < REACH * a) & (np.hypot(r - a, z) > EDGE * a)
    given, nu = (a, state.penetration, scene.material.relaxed_plane_modulus), scene.material.poisson
    if scene.body is None:
        exact = subsurface.contact(r[near], z[near], scene.indenter, *given, nu).stress
    else:
        elastic = ElasticLayer(scene.body, nu, scene.indenter)
        exact = layer_subsurface.contact(elastic, r[near], z[near], *given).stress
    errors = np.abs(state.stress[:, near] - exact).max(axis=0) / np.abs(exact).max()
    deep, inner = z[near] < 0.0, r[near] < a
    return Deviation(
        float(errors[deep].max()),
        float(errors[~deep & inner].max()),
        float(errors[~deep & ~inner].max()),
        *traction_errors(state),
    )


def traction_errors(state: FieldState) -> tuple[float, float]:
    """Recovered normal stress on the surface against the nodal reactions (see :class:`Deviation`)."""
    a, surface = state.contact_radius, state.surface
    radius, pressure = on_surface(state, -state.stress[1])
    at = surface.radius < (1.0 - EDGE) * a
    recovered = np.interp(surface.radius[at], radius, pressure)
    mean = abs(state.force) / (np.pi * a**2)
    within = radius < (1.0 + EDGE) * a
    total = quadratic_sum(radius[within], pressure[within])
    return float(np.abs(recovered - surface.pressure[at]).max() / mean), total / state.force - 1.0


def on_surface(state: FieldState, values: Array) -> tuple[Array, Array]:
    """Radii of the surface nodes, rising, and nodal values there."""
    top = surface_nodes(state)
    return state.points[top, 0], values[top]


def quadratic_sum(radius: Array, values: Array) -> float:
    """``int values 2 pi r dr`` by Simpson's rule over vertices and mid-side nodes in turn."""
    last = len(radius) - 1 - (len(radius) - 1) % 2
    f, length = 2.0 * np.pi * radius * values, radius[2 : last + 1 : 2] - radius[: last - 1 : 2]
    return float(np.sum(length * (f[: last - 1 : 2] + 4.0 * f[1:last:2] + f[2 : last + 1 : 2])) / 6.0)


def deepest_shear(state: FieldState) -> tuple[float, float]:
    """Depth over contact radius, and value, of the largest shear stress on the axis.

    The top of the parabola through the three nodes at the maximum.
    """
    axis = np.flatnonzero(state.points[:, 0] == 0.0)
    axis = axis[np.argsort(-state.points[axis, 1])]
    depth, shear = -state.points[axis, 1] / state.contact_radius, state.max_shear[axis]
    k = int(np.argmax(shear))
    curve = np.polyfit(depth[k - 1 : k + 2] - depth[k], shear[k - 1 : k + 2], 2)
    shift = -curve[1] / (2.0 * curve[0])
    return float(depth[k] + shift), float(np.polyval(curve, shift))


def exact_shear(poisson: float) -> tuple[float, float]:
    """The same under a Hertz contact, value over the largest pressure (Johnson 1985, Eq. 3.45)."""
    depth = np.linspace(0.01, 2.0, 200_001)
    radial = -(1.0 + poisson) * (1.0 - depth * np.arctan2(1.0, depth)) + 0.5 / (1.0 + depth**2)
    shear = 0.5 * (radial + 1.0 / (1.0 + depth**2))
    return float(depth[np.argmax(shear)]), float(shear.max())


def states_and_sums(name: str, resolution: int | None = None) -> list[tuple[FieldState, EnergySums]]:
    """A built-in cycle when its approach ends and at pull-off, with what its densities add up to."""
    scene = cases.load(name).scene
    fields = record_fields(scene, FieldRequest(pull_off=True, picked=_turn), resolution)
    return [(state, balance(state, fields.recording.trace)) for state in fields.states()]


def _turn(trace: Trace, scene: Scene) -> dict[int, str]:
    return {end_of_approach(trace): "end of approach"}


def main() -> None:
    """Measure and print."""
    print(
        f"static contacts, of the largest stress; {EDGE:g} a around the edge and beyond {REACH:g} a left out"
    )
    print(f"{'':<24}{'below':>10}{'inside':>10}{'beside':>10}{'traction':>10}{'force':>10}")
    for name in CONTACTS:
        for poisson in RATIOS:
            state, errors = static(name, poisson)
            values = (errors.below, errors.inside, errors.beside, errors.traction, errors.force)
            print(f"{name + f', nu = {poisson:g}':<24}" + "".join(f"{value:10.1e}" for value in values))
            if name == "Hertz":
                largest = 1.5 * state.force / (np.pi * state.contact_radius**2)
                depth, shear = deepest_shear(state)
                exact = exact_shear(poisson)
                print(f"  largest shear {shear / largest:.4f} p0 at {depth:.4f} a, exact ", end="")
                print(f"{exact[1]:.4f} p0 at {exact[0]:.4f} a")
    for name in CYCLES:
        print(f"{name}: energy dissipated in the branches, sum over the mesh")
        for state, sums in states_and_sums(name):
            print(f"  {state.label:<18}against the trace's integral {sums.error or 0.0:+.2e}", end="")
            beyond = (sums.dissipated or 0.0) / sums.work_less_stored - 1.0
            print(f", against work less stored energy {beyond:+.2e}")


if __name__ == "__main__":
    main()
