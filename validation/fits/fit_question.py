"""What a fit was asked, by which a folder of results is known as its own or another's."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from contact_scene import Scene, SceneError
from contact_scene.files import read_text
from validation.fits.fit_settings import FitSettings
from validation.fits.measured_curve import MeasuredCurve
from validation.runs.files import from_json
from validation.runs.provenance import canonical
from validation.runs.report_folder import FIT
from validation.runs.run_folder import check_unused, occupied


def question(curves: Sequence[MeasuredCurve], scene: Scene, settings: FitSettings) -> dict[str, str]:
    """Hashes of curves, first guess and parameters; not of how the fit is carried out."""
    varied = settings.vary, settings.tie, settings.per_curve, settings.free, settings.prony
    return {
        "curves": _hash([replace(curve, name="") for curve in curves]),
        "first guess": _hash(scene),
        "parameters": _hash(varied),
    }


def check_folder(folder: Path, asked: dict[str, str], scene: Scene, key: str = "--out") -> None:
    """Refuse a folder whose files belong to another fit, to a run, or to another program.

    Parameters
    ----------
    folder : Path
        That a fit is to be written to.
    asked : dict of str to str
        Of :func:`question`.
    scene : Scene
        First guess.
    key : str
        What named the folder.

    Raises
    ------
    SceneError
    """
    file = folder / FIT
    if not file.exists():
        check_unused(folder, scene, key)
        return
    try:
        there = from_json(read_text(file))["question"]
        differing = [name for name, value in asked.items() if there[name] != value]
    except (SceneError, ValueError, TypeError, KeyError):
        holds = f"a {FIT} that is not of a fit of this program"
    else:
        if not differing:
            return
        holds = f"another fit (other {' and '.join(differing)})"
    raise occupied(folder, holds, key)


def _hash(value: object) -> str:
    return hashlib.sha256(json.dumps(canonical(value), sort_keys=True).encode()).hexdigest()
