"""Prony series as pyvisco writes them: a CSV of relaxation times and normalised moduli.

pyvisco's coefficient table has one row per branch with the relaxation time (``tau_i`` or ``tau``) and the
modulus as a fraction of the glassy one (``alpha_i`` / ``E_i/E_0`` ...) or in units (``E_i`` / ``G_i``).
``E0`` there is the *instantaneous* modulus. A second line may carry units; extra columns are ignored.
"""

from __future__ import annotations

from typing import Any

from scene.errors import SceneError
from scene.material import Branch


def read_pyvisco(text: str, file: str, modulus: Any, poisson: Any) -> tuple[float, tuple[Branch, ...]]:
    """Relaxed modulus and branches from the text of a pyvisco coefficient file.

    Placeholder signature; see the module head.
    """
    raise SceneError("", "not read yet", "", file)
