"""Scenes and commands in which every two of their features meet at least once: a table of pairs.

Every indenter, step kind, material form, law of adhesion, machine and step before with each other, with every
command and with every option that keeps or resumes. The full product has tens of thousands of rows; the table
has some ninety.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, fields
from itertools import combinations, product
from pathlib import Path

import numpy as np

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
