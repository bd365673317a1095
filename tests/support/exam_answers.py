"""Answers to an exam without a solver: an elastic sphere by Hertz, and files made of columns."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from support.synthetic_traces import DETACHED, by_hand

from contact_scene import COLUMNS, Trace
from validation.cases import Case, load
from validation.exam.answer import Answer, Header
from validation.measure.observables import measure
from validation.runs.run import Run

SCENE = "elastic-press"


def case() -> Case:
    """The scene that Hertz answers."""
    return load(SCENE)


def hertz(rows: int = 200) -> dict[str, np.ndarray]:
    """Columns of its exact answer: pressed to 0.03 and back at speed 0.01, unit sphere and modulus."""
    x = np.linspace(0.0, 1.0, rows)
    time = np.concatenate((3.0 * x**2, 6.0 - 3.0 * (1.0 - x[1:]) ** 2))
    depth = np.maximum(0.01 * np.minimum(time, 6.0 - time), 0.0)
    energy = 8.0 / 15.0 * depth**2.5
    return {
        "time": time,
        "penetration": depth,
        "force": 4.0 / 3.0 * depth**1.5,
        "contact_radius": np.sqrt(depth),
        "stored_energy": energy,
        "external_work": energy,
        "dissipated_energy": np.zeros_like(time),
    }


def hertz_run() -> Run:
    """The same as a run of the reference whose errors are known."""
    columns = hertz(800)
    trace = by_hand(columns.pop("time"), DETACHED, "reference", **columns)
    known = {"force": 1e-6, "contact_radius": 1e-6, "loop_energy": 1e-6, "dissipated_energy": 1e-6}
    return Run(SCENE, "reference", trace, measures=measure(trace, case().scene, 0.0), errors=known)


def answer_of(trace: Trace) -> Answer:
    """A run as an answer."""
    return Answer(Header(trace.solver), "x", {name: getattr(trace, name) for name in COLUMNS})


def text(columns: dict[str, np.ndarray], code: str = "a code", **header: object) -> str:
    """The text of a trace file."""
    lines = [f"# code: {code}", *(f"# {key}: {value}" for key, value in header.items()), ",".join(columns)]
    rows = zip(*(column.tolist() for column in columns.values()), strict=True)
    return "\n".join([*lines, *(",".join(map(repr, row)) for row in rows)]) + "\n"


def put(folder: Path, content: str, name: str = "trace.csv", scene: str = SCENE) -> Path:
    """Write a file into the folder of a scene."""
    (folder / scene).mkdir(parents=True, exist_ok=True)
    path = folder / scene / name
    path.write_text(content, encoding="utf-8")
    return path
