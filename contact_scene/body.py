"""The body under the indenter where it is no half-space: a layer of finite thickness on a rigid base.

A layer is bonded to its base, or lies on it without friction and is never lifted off it.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Literal

from contact_scene.checked import Checked, Key, Positive
from contact_scene.errors import SceneError

THINNEST = 30.0
"""Largest contact radius, in thicknesses, that is computed: linear theory has long ended, and the functions
that describe a layer grow in number with it."""


@dataclass(frozen=True)
class Layer(Checked):
    """A layer of a ``thickness`` on a rigid ``base``, to which it is bonded, or where it slides.

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
