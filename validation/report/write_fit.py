"""The folder of a fit: ``index.html``, ``fit.json``, ``scene.toml``, ``fit.png`` and ``fit.svg``."""

from __future__ import annotations

from dataclasses import asdict
from pathlib import Path
from typing import Any

from contact_scene import write_scene
from validation.drawing import export
from validation.execution.files import to_json, write_whole
from validation.execution.provenance import stamp, version
from validation.fits.fit_result import FitResult
from validation.report import html
from validation.report.sections import fit

FORMAT = 1


def of_fit(result: FitResult) -> dict[str, Any]:
    """``fit.json``: every number of a fit. The keys are a fixed contract with whoever reads it."""
    good = result.goodness
    return {
        "format": FORMAT,
        "converged": result.converged,
        "ended": result.ended,
        "explained": good.explained,
        "parameters": [asdict(one) for one in result.estimates],
        "correlations": result.correlations,
        "combinations": [asdict(one) for one in result.combinations],
        "hardly_told_apart": result.confused,
        "goodness": {
            "sum_of_squares": good.chi_squared,
            "degrees": good.degrees,
            "noise_degrees": good.noise_degrees,
            "probability": good.probability,
            "runs_tests": [asdict(one) for one in good.runs],
        },
        "profiles": [asdict(one) for one in result.profiles],
        "second_solver": None if result.check is None else asdict(result.check),
        "curves": [
            {
                "name": one.curve.name,
                "noise": one.noise,
                "noise_source": one.noise_source,
                "time": one.curve.time,
                "measured_force": one.curve.force,
                "fitted_force": one.force,
                "compared": one.compared,
            }
            for one in result.curves
        ],
        "statements": fit.statements(result),
        "settings": asdict(result.settings),
        "resolution": result.resolution,
        "step_tolerance": result.tolerance,
        "solver_error_over_noise": result.error_share,
        "starts": result.starts,
        "runs": result.runs,
        "seconds": result.seconds,
        "environment": stamp(),
        "program": version(),
        "question": result.question,
    }


def write_fit(result: FitResult, folder: Path) -> None:
    """Write everything; the page last, so that a folder with a page is complete."""
    (folder / "index.html").unlink(missing_ok=True)
    write_whole(folder / "fit.json", to_json(of_fit(result)))
    write_scene(result.scene, folder / "scene.toml")
    drawn = fit.drawings(result)
    write_whole(folder / "fit.png", export.png(drawn["curves"]))
    write_whole(folder / "fit.svg", export.svg_file(drawn["curves"]))
    write_whole(folder / "index.html", html.text(fit.document(result, drawn)))
