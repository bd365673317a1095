"""Scenes and commands in which every two of their features meet at least once: a table of pairs.

Every indenter, step kind, material form, adhesion and step before with each other, with every command and
with every option that keeps or resumes. The full product has thousands of rows; the table has some sixty.
"""

from __future__ import annotations

from dataclasses import dataclass, fields
from itertools import combinations, product
from pathlib import Path

INDENTERS = {
    "sphere": "radius = 1e-3",
    "cone": "half_angle = 89.0",
    "flat-punch": "radius = 4e-5",
    "power-law": "exponent = 4.0\ncoefficient = 1e9",
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
MATERIALS = {
    "elastic": "",
    "branches": "branches = [{ modulus = 3e6, time = 0.3 }]",
    "file": 'file = "prony.csv"\nformat = "pyvisco"',
    "elastic-bulk": 'branches = [{ modulus = 3e6, time = 0.3 }]\nbulk = "elastic"',
    "bulk": "branches = [{ modulus = 3e6, time = 0.3 }]\n"
    "bulk = { modulus = 1e6, branches = [{ modulus = 1e6, time = 1.0 }] }",
}
ADHESIONS = {"none": "", "adhesive": "[adhesion]\nwork = 1e-3\nzone = 3e-6\n"}
BEFORE = {"nothing": "", "level": '[[loading.steps]]\nkind = "hold"\nduration = 0.1\nuntil_force = 1.0\n'}
"""What comes before the load step; when a step that waits for a level ends is known only after the run."""
COMMANDS = {
    "solve bem": ("plain", "out", "fresh", "resume", "plot", "estimate"),
    "solve fem": ("plain", "out", "fresh", "resume", "plot", "estimate"),
    "solve reference": ("plain", "out", "fresh", "resume", "plot", "estimate"),
    "compare": ("plain", "out", "fresh", "resume"),
    "study": ("plain", "out", "fresh", "resume"),
    "fields": ("out", "fresh", "resume"),
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
        modulus = "" if self.material == "file" else "modulus = 1e6\n"
        file.write_text(
            f"[material]\n{modulus}poisson = 0.4\n{MATERIALS[self.material]}\n"
            f'[indenter]\nshape = "{self.indenter}"\n{INDENTERS[self.indenter]}\n{ADHESIONS[self.adhesion]}'
            f'[loading]\nstart = "relaxed"\npenetration = 1e-6\n{BEFORE[self.before]}'
            f'[[loading.steps]]\nkind = "{self.step}"\n{STEPS[self.step]}\n'
        )
        return file


PRONY = "i,tau_i,alpha_i,E_0,E_i\n-,s,-,Pa,Pa\n1,0.3,0.75,4e6,3e6\n"
VALUES = (*map(tuple, (INDENTERS, STEPS, MATERIALS, ADHESIONS, BEFORE, COMMANDS)), OPTIONS)
COMMAND, OPTION = 5, 6
Pair = tuple[int, str, int, str]
"""Two features: column and name of each."""


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
