"""Scene: the problem put to a solver, checked on construction."""

from __future__ import annotations

from dataclasses import dataclass

from contact_scene.adhesion import Adhesion
from contact_scene.approach_bound import bounded_approaches
from contact_scene.errors import SceneError, shown
from contact_scene.indenter import Indenter
from contact_scene.loading import Loading
from contact_scene.machine import Machine
from contact_scene.material import Material
from contact_scene.value_checks import a_string


@dataclass(frozen=True)
class Scene:
    """A rigid indenter on a viscoelastic half-space.

    Parameters
    ----------
    material, indenter, loading : Material, Indenter, Loading
    adhesion : Adhesion, optional
        ``None`` (or zero work of adhesion) for adhesionless contact.
    title : str
    """

    material: Material
    indenter: Indenter
    loading: Loading
    adhesion: Adhesion | None = None
    title: str = ""

    def __post_init__(self) -> None:
        for name, kind in (("material", Material), ("indenter", Indenter), ("loading", Loading)):
            if not isinstance(getattr(self, name), kind):
                raise SceneError(name, f"got {shown(getattr(self, name))}", f"a {kind.__name__}")
        if self.adhesion is not None and not isinstance(self.adhesion, Adhesion):
            raise SceneError("adhesion", f"got {shown(self.adhesion)}", "an Adhesion or None")
        if self.adhesion is not None and self.adhesion.stress is not None:
            at_rest = self.adhesion.at_rest_on(self.material.relaxed_plane_modulus)
            object.__setattr__(self, "adhesion", at_rest)
        loading = bounded_approaches(self.loading, self.material, self.indenter, self.adhesion)
        object.__setattr__(self, "loading", loading)
        a_string(self.title, "title")
        if self.is_adhesive and self.adhesion is not None and self.adhesion.zone >= self.indenter.edge:
            raise zone_too_long(self.adhesion.zone, self.indenter.edge)

    @property
    def machine(self) -> Machine | None:
        """What holds the indenter; ``None``: rigid. Part of the loading."""
        return self.loading.machine

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
