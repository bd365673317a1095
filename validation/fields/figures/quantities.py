"""The fields of a state: what each is called, in which unit, and how it is read from the state.

Units are the scene's. Components are cylindrical and positive in tension, also left of the axis.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from validation.fields.figures.colours import ValueKind

if TYPE_CHECKING:
    from fem_solver.fields.states import FieldState

Array = NDArray[np.float64]

STRESS, DENSITY, RATE, LENGTH = "force/length^2", "energy/length^3", "energy/(length^3 time)", "length"


@dataclass(frozen=True)
class Quantity:
    """A field.

    Parameters
    ----------
    name : str
        On the command line and in the names of files and of their arrays.
    text : str
        For colour bars.
    unit : str
        In plain letters.
    kind : ValueKind
    values : callable(FieldState) -> (n,) array
        At the nodes.
    needs : str
        What a state has to hold that not every one does.
    """

    name: str
    text: str
    unit: str
    kind: ValueKind
    values: Callable[[FieldState], Array]
    needs: str = ""

    def known(self, state: FieldState) -> bool:
        """Whether a state has it."""
        return not self.needs or getattr(state, self.needs) is not None

    @property
    def label(self) -> str:
        """For colour bars, with the unit."""
        return f"{self.text} ({self.unit.replace('^2', '²').replace('^3', '³')})"

    @property
    def array(self) -> str:
        """The name of its array in a file, with the unit."""
        return f"{self.name} [{self.unit}]"

    @property
    def plain(self) -> str:
        """The label without mathematical type, for windows that have none."""
        text = self.label
        for name, letter in (("sigma", "σ"), ("varepsilon", "ε"), ("theta", "θ")):
            text = text.replace(f"\\{name}", letter)
        return re.sub(r"[$_{}]", "", text)


def _component(name: str, symbol: str, unit: str, row: int) -> Quantity:
    file, part = (("rr", "rr"), ("zz", "zz"), ("tt", r"\theta\theta"), ("rz", "rz"))[row]

    def values(state: FieldState) -> Array:
        return np.asarray(getattr(state, name))[row]

    return Quantity(f"{name}_{file}", rf"{name} ${symbol}_{{{part}}}$", unit, ValueKind.SIGNED, values)


QUANTITIES = {
    one.name: one
    for one in (
        Quantity("von_mises", "von Mises stress", STRESS, ValueKind.POSITIVE, lambda s: s.von_mises),
        Quantity("max_shear", "largest shear stress", STRESS, ValueKind.POSITIVE, lambda s: s.max_shear),
        Quantity("hydrostatic", "mean stress", STRESS, ValueKind.SIGNED, lambda s: s.hydrostatic),
        *(
            Quantity(
                f"principal_{k + 1}",
                f"principal stress {k + 1}",
                STRESS,
                ValueKind.SIGNED,
                lambda s, k=k: s.principal[k],  # type: ignore[misc]
            )
            for k in range(3)
        ),
        *(_component("stress", r"\sigma", STRESS, row) for row in range(4)),
        *(_component("strain", r"\varepsilon", "1", row) for row in range(4)),
        Quantity(
            "displacement_r", "displacement $u_r$", LENGTH, ValueKind.SIGNED, lambda s: s.displacement[:, 0]
        ),
        Quantity(
            "displacement_z", "displacement $u_z$", LENGTH, ValueKind.SIGNED, lambda s: s.displacement[:, 1]
        ),
        Quantity(
            "stored_energy", "stored energy", DENSITY, ValueKind.DECADES, lambda s: s.stored_energy_density
        ),
        Quantity(
            "dissipation_rate",
            "dissipation rate",
            RATE,
            ValueKind.DECADES,
            lambda s: s.dissipation_rate.sum(axis=0),
        ),
        Quantity(
            "dissipated_energy",
            "energy dissipated",
            DENSITY,
            ValueKind.DECADES,
            lambda s: np.asarray(s.dissipated).sum(axis=0),
            needs="dissipated",
        ),
    )
}
"""All fields by name: what can be drawn, and what the files hold, the displacement there as a vector."""
