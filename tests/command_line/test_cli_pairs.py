"""Every two features of scenes, commands and options meet in a row of a table.

It has some ninety rows, not the tens of thousands of the full product.

By default with a stand-in for the solvers: what is tested is that every scene passes through every command
with every option. Slow and exhaustive tests repeat the table with the solvers themselves.
"""

from __future__ import annotations

import dataclasses
import io
import math
import tomllib
from collections.abc import Iterator
from contextlib import nullcontext
from dataclasses import dataclass, fields
from itertools import combinations, product
from pathlib import Path

import numpy as np
import pytest
from support.commands import stand_in
from support.spring_solver import SCENE, StudiedSolver, spring, stoppable
from support.table_rows import sampled

import crosscontact as cc
from contact_scene import Approach, OutcomeKind, SceneError, loading, read_scene, scene_from_dict
from contact_scene.indenter import SHAPES
from contact_scene.material import MODELS
from crosscontact.cli import main
from validation.fields import files
from validation.runs import pool, process
from validation.studies import ladders as schemes

INDENTERS = {
    "sphere": "radius = 1e-3",
    "cone": "half_angle = 89.0",
    "flat-punch": "radius = 4e-5",
    "power-law": "exponent = 4.0\ncoefficient = 1e11",
    "profile": 'file = "tip.csv"',
}
STEPS = {
    "ramp": "to = 1.1e-6\nrate = 1e-7",
    "hold": "duration = 1.0",
    "force": "value = 6e-5\nduration = 1.0",
    "force-ramp": "to = 6e-5\nrate = 1e-5",
    "oscillate": "amplitude = 5e-8\nangular_frequency = 6.283185307179586\nduration = 1.0",
    "sweep": "amplitude = 5e-8\nchirp = 6.283185307179586\nduration = 1.0",
    "table": 'file = "path.csv"',
}
RUBBER = "modulus = 1e6\nbranches = [{ modulus = 3e6, time = 0.3 }]"
MATERIALS = {
    "elastic": "modulus = 1e6",
    "branches": RUBBER,
    "file": 'file = "prony.csv"\nformat = "pyvisco"',
    "standard-linear": 'model = "standard-linear"\nrelaxed = 1e6\nglassy = 4e6\ntime = 0.3',
    "power-law-solid": 'model = "power-law"\nexponent = 0.3\nmodulus = 2e6\ntime = 0.3\nrange = [0.03, 3.0]\n'
    "error = 1e-2\nrelaxed = 1e6",
    "temperature": f"{RUBBER}\ntemperature = 305.0\n"
    'shift = { model = "Arrhenius", activation_energy = 5e4, reference_temperature = 300.0 }',
    "elastic-bulk": f'{RUBBER}\nbulk = "elastic"',
    "bulk": f"{RUBBER}\nbulk = {{ modulus = 1e6, branches = [{{ modulus = 1e6, time = 1.0 }}] }}",
}
"""All keys of a material but Poisson's ratio."""
ADHESIONS = {
    "none": "",
    "adhesive": "work = 1e-3\nzone = 3e-6",
    "hysteresis": "work = 1e-3\nwork_closing = 5e-4\nzone = 3e-6",
    "rate": "work = 1e-3\nzone = 3e-6\nrate = { speed = 1e-5, exponent = 0.5 }",
    "stress": "work = 1e-3\nstress = 1.8e4",
}
MACHINES = {"rigid": "", "spring": "[machine]\nstiffness = 200.0\n"}
LEVEL = '[[loading.steps]]\nkind = "ramp"\nto = 3e-6\nrate = 1e-6\nuntil_force = 1e-4\n'
BEFORE = {"nothing": "", "level": LEVEL}
"""What comes before the load step; when a step that waits for a level ends is known only after the run."""
COMMANDS = {
    "solve bem": ("plain", "out", "fresh", "resume", "plot", "estimate"),
    "solve fem": ("plain", "out", "fresh", "resume", "plot", "estimate"),
    "solve reference": ("plain", "out", "fresh", "resume", "plot", "estimate"),
    "compare": ("plain", "out", "fresh", "resume"),
    "study": ("plain", "out", "fresh", "resume"),
    "study --zones": ("plain", "out", "fresh", "resume"),
    "fields": ("out", "fresh", "resume"),
    "sweep": ("out", "fresh", "resume"),
    "fit": ("plain", "out", "fresh", "resume"),
    "python": ("plain", "out", "plot", "estimate"),
}
"""Commands that take a scene, and which of the options each has."""
OPTIONS = ("plain", "out", "fresh", "resume", "plot", "estimate")
SEPARATE = ("elastic-bulk", "bulk")
"""Materials that only the finite elements take."""


@dataclass(frozen=True)
class Row:
    """One row of the table: the names of its features."""

    indenter: str
    step: str
    material: str
    adhesion: str
    machine: str
    before: str
    command: str
    option: str

    def __str__(self) -> str:
        return "-".join(getattr(self, entry.name).replace(" ", "-") for entry in fields(self))

    def write(self, folder: Path) -> Path:
        """The scene file of this row, and the files that it names."""
        (folder / "tip.csv").write_text("radius,height\n0,0\n5e-5,1.25e-6\n1e-4,5e-6\n2e-4,2e-5\n")
        (folder / "path.csv").write_text("time,penetration\n0,1e-6\n0.5,1.1e-6\n1,1.05e-6\n")
        (folder / "prony.csv").write_text(PRONY)
        file = folder / "scene.toml"
        law = ADHESIONS[self.adhesion]
        adhesion = f"[adhesion]\n{law}\n" if law else ""
        file.write_text(
            f"[material]\npoisson = 0.4\n{MATERIALS[self.material]}\n"
            f'[indenter]\nshape = "{self.indenter}"\n{INDENTERS[self.indenter]}\n{adhesion}'
            f'{MACHINES[self.machine]}[loading]\nstart = "relaxed"\npenetration = 1e-6\n{BEFORE[self.before]}'
            f'[[loading.steps]]\nkind = "{self.step}"\n{STEPS[self.step]}\n'
        )
        head = (
            "# stiffness = 200.0\ntime,force,stage" if self.machine == "spring" else "time,force,penetration"
        )
        (folder / CURVE).write_text("\n".join([head, *_record()]))
        solver = "fem" if self.material in SEPARATE else "reference"
        (folder / PLAN).write_text(
            f'scene = "scene.toml"\nsolver = "{solver}"\nresolution = 4\nestimate = false\n'
            '[[coordinates]]\nkey = "loading.penetration"\nvalues = [1e-6, 1.2e-6]\n'
        )
        return file


PLAN, CURVE = "plan.toml", "curve.csv"
PRONY = "i,tau_i,alpha_i,E_0,E_i\n-,s,-,Pa,Pa\n1,0.3,0.75,4e6,3e6\n"
VALUES = (*map(tuple, (INDENTERS, STEPS, MATERIALS, ADHESIONS, MACHINES, BEFORE, COMMANDS)), OPTIONS)
COMMAND, OPTION = 6, 7
Pair = tuple[int, str, int, str]
"""Two features: column and name of each."""


def _record() -> Iterator[str]:
    """Rows of a measured triangle of motion, with a force in proportion and some noise."""
    noise = np.random.default_rng(0).standard_normal(60)
    for at, scatter in zip(np.linspace(0.0, 2.0, noise.size), noise, strict=True):
        motion = 1.2e-6 - 2e-7 * abs(at - 1.0)
        yield f"{at:.6g},{66.0 * motion + 5e-8 * scatter:.9g},{motion:.9g}"


def possible(pair: Pair) -> bool:
    """Whether the two can meet: a command may not have an option."""
    first, one, second, other = pair
    return (first, second) != (COMMAND, OPTION) or other in COMMANDS[one]


def pairs_of(values: tuple[str, ...]) -> set[Pair]:
    """All pairs within one row."""
    return {(i, values[i], j, values[j]) for i, j in combinations(range(len(values)), 2)}


def all_pairs() -> set[Pair]:
    """Every pair that can meet."""
    found = set()
    for i, j in combinations(range(len(VALUES)), 2):
        found |= {(i, one, j, other) for one, other in product(VALUES[i], VALUES[j])}
    return set(filter(possible, found))


def table() -> list[Row]:
    """Rows that hold every pair: each is begun with a missing one and completed with what brings most."""
    missing, rows = all_pairs(), []
    while missing:
        first, one, second, other = min(missing)
        chosen = {first: one, second: other}
        for column in sorted(set(range(len(VALUES))) - set(chosen), reverse=True):
            brought = {}
            for value in VALUES[column]:
                pairs = {_pair(column, value, there, name) for there, name in chosen.items()}
                if all(map(possible, pairs)):
                    brought[value] = len(pairs & missing)
            chosen[column] = max(brought, key=lambda value: brought[value])
        values = tuple(chosen[column] for column in range(len(VALUES)))
        missing -= pairs_of(values)
        rows.append(Row(*values))
    return rows


def _pair(first: int, one: str, second: int, other: str) -> Pair:
    return (first, one, second, other) if first < second else (second, other, first, one)


TABLE = table()
OF_MANY_RUNS = [row for row in TABLE if row.command in ("compare", "study", "study --zones", "sweep", "fit")]
SOLVED = [row for row in TABLE if row.command.startswith("solve") or row.command == "python"]


def test_the_table_holds_every_pair():
    held = set().union(*(pairs_of(tuple(vars(row).values())) for row in TABLE))
    assert held == all_pairs()
    assert set(VALUES[0]) == {shape.shape for shape in SHAPES}
    assert set(VALUES[1]) == {step.kind for step in loading.STEPS if step is not Approach}
    assert len(TABLE) < 1.25 * math.prod(sorted(map(len, VALUES))[-2:])  # as many at least
    assert all(row.option in COMMANDS[row.command] for row in TABLE)


def known(section: str, **entries: str) -> set[str]:
    """The keys that a section of a scene file may have, as told where one is unknown."""
    with pytest.raises(SceneError, match="unknown key") as told:
        scene_from_dict({**tomllib.loads(SCENE), section: {**entries, "unknown": 1}})
    return set(told.value.allowed.split(", "))


def test_the_table_holds_every_key_of_materials_and_adhesion():
    held = [tomllib.loads(text) for text in MATERIALS.values()]
    models = ({}, *({"model": kind.model} for kind in MODELS))
    assert {"poisson"}.union(*held) == set().union(*(known("material", **model) for model in models))
    assert {"prony", *(kind.model for kind in MODELS)} == {entry.get("model", "prony") for entry in held}
    assert set().union(*map(tomllib.loads, ADHESIONS.values())) == known("adhesion")


def by_modulus(scene, *given, **options):
    """A spring as stiff as a contact of that size: a fit of the modulus has something to find."""
    trace = spring(6e-5 * scene.material.modulus, OutcomeKind.COMPLETED)(scene, *given, **options)
    return dataclasses.replace(trace, contact_radius=np.full(len(trace), 4e-5))


@pytest.fixture
def _stand_ins(monkeypatch):
    method = StudiedSolver(stoppable(by_modulus))
    stand_in(monkeypatch, method)
    for name, scheme in schemes.SCHEMES.items():
        monkeypatch.setitem(schemes.SCHEMES, name, dataclasses.replace(scheme, solver=method))
    monkeypatch.setattr("crosscontact.commands.study.processes", lambda *given, **more: nullcontext())


@pytest.fixture
def quick_pictures(monkeypatch):
    """Figures are made, not rendered."""

    def save(figure, stream, **how):
        stream.write("<svg></svg>" if isinstance(stream, io.StringIO) else b"PNG")

    monkeypatch.setattr("matplotlib.figure.Figure.savefig", save)


def interrupted(row: Row, monkeypatch: pytest.MonkeyPatch) -> None:
    """The command stops in the middle of its work, once."""
    if row.command.startswith("solve"):
        looks, look = iter(range(4)), process.GracefulStop.monitor

        def stop_later(stop):
            stop.requested = next(looks, None) is None
            return look(stop)

        monkeypatch.setattr(process.GracefulStop, "monitor", stop_later)
        return
    owner, name = (files, "save") if row.command == "fields" else (pool, "execute")
    calls, function = iter(range(1)), getattr(owner, name)

    def stop_at_the_second(*given):
        if next(calls, None) is None:
            raise KeyboardInterrupt
        return function(*given)

    monkeypatch.setattr(owner, name, stop_at_the_second)


def numbers(folder) -> dict[str, bytes]:
    """What two folders of the same work have in common to the bit."""
    kinds = ("trace.csv", "scene.toml", "*.vtu", "*.vtp")
    return {str(path.relative_to(folder)): path.read_bytes() for kind in kinds for path in folder.rglob(kind)}


def arguments(row: Row, scene: str, out: str) -> list[str]:
    command, _, more = row.command.partition(" ")
    given = [command, str(Path(scene).with_name(PLAN)) if command == "sweep" else scene]
    if command == "fit":
        given = [command, str(Path(scene).with_name(CURVE)), scene, "--vary", "material.modulus"]
        given += ["--starts", "1", "--resolution", "4", "--jobs", "1"]
    if more == "--zones":
        given += [more, "1e-2", "1e-3"]
    if command == "solve":
        given += ["--solver", more, "--resolution", "4"]
    if command == "fields":
        given += ["--at", "0", "0.2", "--resolution", "4", "--no-figures"]
    if command in ("compare", "study", "sweep"):
        given += ["--jobs", "1"]
    if command == "compare":  # the finite elements take longest, and have rows of their own
        given += ["--solvers", f"{'fem' if row.material in SEPARATE else 'bem'},reference"]
    given += [f"--{row.option}"] if row.option in ("plot", "estimate", "fresh") else []
    return given + (["--out", out] if row.option != "plain" else [])


def carried_out(row: Row, tmp_path, capsys) -> int:
    """Exit code of the command of a row, whatever it is; no traceback, and what it writes can be read."""
    file, out = row.write(tmp_path), tmp_path / "out"
    given = arguments(row, str(file), str(out))
    if row.option == "resume":
        with pytest.MonkeyPatch.context() as stopping:
            interrupted(row, stopping)
            assert main(given) == (2 if has_no_zone(row) else 1)
    code = main(given)
    assert "Traceback" not in capsys.readouterr().err
    if code == 2:
        return code
    for written in out.rglob("scene.toml"):
        there, asked = read_scene(written), read_scene(file)
        if row.command == "fit":
            there = dataclasses.replace(
                there, material=dataclasses.replace(there.material, modulus=asked.material.modulus)
            )
        assert there == asked
    if row.option == "resume":
        whole = tmp_path / "whole"
        assert main(arguments(row, str(file), str(whole))) == code
        assert numbers(out) == numbers(whole)
    if row.command.startswith("solve") and row.option not in ("plain", "plot"):
        assert cc.load(out).scene == read_scene(file)
    return code


def same_in_python(row: Row, tmp_path) -> bool:
    """Whether what is solved, drawn, saved and loaded from Python is the same to the bit."""
    scene = read_scene(row.write(tmp_path))
    solver = "fem" if row.material in SEPARATE else "bem"
    result = cc.solve(scene, solver, 4, estimate_errors=row.option == "estimate")
    assert solver in repr(result)
    if row.option == "plot":
        assert len(result.figure().axes) == 3
    result.save(tmp_path / "saved")
    again = cc.load(tmp_path / "saved")
    columns = result.trace.columns()
    return (
        (again.scene, again.measures) == (scene, result.measures)
        and again.trace.columns().keys() == columns.keys()
        and all(np.array_equal(again.trace.columns()[name], column) for name, column in columns.items())
    )


@pytest.mark.usefixtures("_stand_ins", "quick_pictures")
@pytest.mark.parametrize("row", SOLVED, ids=str)
def test_every_scene_passes_through_the_door(row, tmp_path, capsys):
    if row.command == "python":
        assert same_in_python(row, tmp_path)
    else:
        assert carried_out(row, tmp_path, capsys) == 0


@pytest.mark.slow
@pytest.mark.usefixtures("_stand_ins", "quick_pictures")
@pytest.mark.parametrize("row", OF_MANY_RUNS, ids=str)
def test_every_scene_passes_through_the_commands_of_many_runs(row, tmp_path, capsys):
    assert carried_out(row, tmp_path, capsys) in ((2,) if has_no_zone(row) else (0, 1))


def has_no_zone(row: Row) -> bool:
    """Whether a study of zones is refused: nothing adheres, or the stress sets the zone."""
    return row.command == "study --zones" and row.adhesion in ("none", "stress")


def is_refused(row: Row) -> bool:
    """Whether the solver of a row does not take its material."""
    return row.material in SEPARATE and row.command == "solve bem"


ENDING = [
    row
    for row in TABLE
    if row.command not in ("study", "study --zones", "fit")
    and not (is_refused(row) and row.option == "resume")
]
"""Studies and fits have tests of their own with the solvers; what is refused cannot be interrupted."""


@pytest.mark.usefixtures("quick_pictures")
@pytest.mark.parametrize("row", sampled(ENDING), ids=str)
def test_every_scene_is_solved(row, tmp_path, capsys):
    if row.command == "python":
        assert same_in_python(row, tmp_path)
        return
    allowed = (2,) if is_refused(row) else (0, 1) if row.command in ("compare", "sweep") else (0,)
    assert carried_out(row, tmp_path, capsys) in allowed
