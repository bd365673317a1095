"""Plans of sweeps: a scene, what varies of it and how, the solver, what is kept; read from TOML.

::

    scene = "retraction-fast"        # built-in, or a file beside the plan
    solver = "reference"             # default
    resolution = 4                   # default: the solver's choice
    design = "grid"                  # default | "points" | "latin-hypercube" | "sobol"

    [[coordinates]]
    name = "speed"                   # default: the key
    key = "loading.steps.0.rate"     # or keys = [...], with factors = [...] or with a list of values for each
    geomspace = [1e-5, 100.0, 40]    # or linspace, values; of a sample: range = [low, high], scale = "log"

The keys are the declared fields of :class:`SweepPlan` and :class:`Coordinate`. A path into the scene is
dotted, with indices of lists: ``loading.steps.1.rate`` and ``loading.steps[1].rate`` are the same.
"""

from __future__ import annotations

import itertools
import math
import os
import re
import tomllib
from collections import Counter
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from functools import cached_property, reduce
from pathlib import Path
from typing import Annotated, Any, Literal

import numpy as np
from scipy.stats import qmc

import contact_scene as cs
from contact_scene.checked import Checked, Finite, Key, Positive, check_keys, field_at, fields_of, from_table
from contact_scene.errors import SceneError, shown
from contact_scene.files import read_text
from contact_scene.material import MODELS
from contact_scene.run_control import whole_number
from contact_scene.scene import PARTS, part_of, scene_table
from contact_scene.value_checks import one_of, positive, whole_from
from validation import scenes, solvers
from validation.measure.observables import measure
from validation.sweeps import batch_runs
from validation.sweeps.batch_runs import BATCH

PLANS = Path(__file__).with_name("plans")
"""Folder of the built-in plans."""
MOST_RUNS = 10_000_000
"""Runs of a plan, and values of a coordinate: their fingerprints alone take a gigabyte and an hour."""
RESERVED = ("run", "outcome", "reason", "warnings", "solved_by")
"""Names that a data set of runs has of itself."""
SAMPLES = ("latin-hypercube", "sobol")
DESIGNS = ("grid", "points", *SAMPLES)
DRAWN = ("pull_off_force", "pull_off_penetration", "dissipated_energy")
"""Measures that are drawn unless the plan names others."""
WAYS = ("values", "linspace", "geomspace", "range")
"""Keys by one of which a coordinate states its values."""
UNNAMED = cs.Units()
Row = tuple[Any, ...]
"""Values of the keys of a coordinate; the first one labels it."""


@dataclass(frozen=True)
class SceneTable:
    """The contents of a scene file; tables that it names are looked up in ``folder``."""

    name: str
    data: dict[str, Any]
    folder: Path
    _built: dict[str, Any] = field(default_factory=dict, init=False, repr=False, compare=False)

    def with_values(self, settings: Mapping[str, Any]) -> cs.Scene:
        """The scene with other values at some paths, without its title: equal scenes compare equal."""
        data = reduce(lambda table, item: put(table, *item), settings.items(), self.data) | {"title": ""}
        unvaried = (name for name in PARTS if name in data and data[name] is self.data.get(name))
        built = {name: self._part(name) for name in unvaried if isinstance(data[name], dict)}
        return cs.scene_from_dict(data | built, self.folder)

    def _part(self, name: str) -> Any:
        """A part that the table states, built once."""
        if name not in self._built:
            self._built[name] = part_of(name, self.data[name], self.folder)
        return self._built[name]

    def unit(self, path: str) -> str:
        """Unit of what the scene declares at a path; empty where it declares nothing."""
        place = parts(path)
        if place[0] == "machine":  # a table of its own in a file
            found = field_at([cs.Machine], {}, place[1:])
        else:
            found = field_at([cs.Scene], self.data, place)
        if found is None and place[0] == "material":
            found = field_at(MODELS, self.data.get("material"), place[1:])
        return "" if found is None else found.key.unit


def parts(path: str) -> tuple[str, ...]:
    """Keys and indices along a path."""
    return tuple(re.sub(r"\[(\d+)\]", r".\1", path).split("."))


def put(table: Any, path: str, value: Any) -> Any:
    """A copy of nested tables and lists with another value at a path, to which missing tables are made."""

    def changed(table: Any, rest: tuple[str, ...]) -> Any:
        if not rest:
            return value
        key, after = rest[0], rest[1:]
        if isinstance(table, list):
            if not key.isdecimal() or int(key) >= len(table):
                allowed = f"an index from 0 to {len(table) - 1}" if table else "a path that exists"
                raise SceneError(path, f"the list has no entry {shown(key)}", allowed)
            return [*table[: int(key)], changed(table[int(key)], after), *table[int(key) + 1 :]]
        if not isinstance(table, dict):
            raise SceneError(path, f"{shown(table)} has no keys", "a path to a value of the scene")
        if not key:
            raise SceneError(path, "has an empty part", "names and indices with dots between them")
        return {**table, key: changed(table.get(key, {}), after)}

    return changed(table, parts(path))


def builtin_or_file(name: Any, folder: Path) -> SceneTable:
    """The table of a built-in scene or of a scene file, looked up in ``folder``."""
    if not isinstance(name, str) or not name:
        raise SceneError("scene", f"got {shown(name)}", "the name of a built-in scene or of a scene file")
    known = name in scenes.names()
    file = scenes.FOLDER / f"{name}.toml" if known else folder / name
    if not known and not os.path.isfile(file):
        raise SceneError("scene", f"{shown(name)} is no built-in scene and no file", "either of them")
    cs.read_scene(file)
    return SceneTable(name if known else file.stem, tomllib.loads(file.read_text("utf-8")), file.parent)


def of_scene(scene: cs.Scene) -> SceneTable:
    """The table of a scene built in Python, its tables of numbers in it."""
    return SceneTable(scene.title or "scene", scene_table(scene), Path())


@dataclass(frozen=True)
class Coordinate(Checked):
    """What a sweep varies: ``paths`` into the scene, and ``count`` rows of their values, 0 of a sample."""

    key: Annotated[str | None, Key("dotted path of the scene")] = None
    keys: Annotated[tuple[str, ...] | None, Key("several of them, which change together")] = None
    name: Annotated[str, Key("in the data set; by default the first key")] = ""
    label: Annotated[str, Key("on the axes of figures")] = ""
    unit: Annotated[str, Key("of the values; by default as the scene declares it")] = ""
    factors: Annotated[tuple[Finite, ...] | None, Key("by which each key multiplies the value")] = None
    values: Annotated[tuple[object, ...] | None, Key("numbers, or strings, or lists for several keys")] = None
    linspace: Annotated[tuple[Finite, ...] | None, Key("first, last, how many, evenly spaced")] = None
    geomspace: Annotated[tuple[Positive, ...] | None, Key("the same, in equal ratios")] = None
    range: Annotated[tuple[Finite, ...] | None, Key("lowest and highest value, of a sample")] = None
    scale: Annotated[Literal["linear", "log"], Key("in which a sample is even")] = "linear"
    paths: tuple[str, ...] = field(init=False)
    count: int = field(init=False)

    def rules(self) -> None:
        if (self.key is None) == (self.keys is None):
            raise SceneError("key", "is missing" if self.key is None else "given beside keys", "key or keys")
        paths = (self.key or "",) if self.keys is None else self.keys
        if not all(paths) or not paths:
            key = "key" if self.keys is None else "keys"
            raise SceneError(key, f"got {shown(list(paths))}", "dotted paths of the scene")
        name = self.name or paths[0]
        if name in RESERVED or "/" in name or not name.isprintable():
            allowed = f"printable, without /, any other than {', '.join(RESERVED)}"
            raise SceneError("name", f"got {shown(name)}", allowed)
        if self.factors is not None and len(self.factors) != len(paths):
            raise SceneError("factors", f"got {shown(list(self.factors))}", f"one number a key: {len(paths)}")
        stated = [way for way in WAYS if getattr(self, way) is not None]
        if len(stated) != 1:
            problem = f"got {' and '.join(stated)}" if stated else "no values"
            raise SceneError("", problem, f"one of {', '.join(WAYS)}")
        if self.scale != "linear" and self.range is None:
            raise SceneError("scale", "given without range", "scale and range together")
        object.__setattr__(self, "name", name)
        object.__setattr__(self, "paths", paths)
        object.__setattr__(self, "count", self._checked_count(stated[0]))

    @cached_property
    def rows(self) -> tuple[Row, ...]:
        """Values of the keys, row by row; none of a sample."""
        if self.values is not None:
            return self._stated(self.values)
        spaced = self.geomspace or self.linspace
        if spaced is None:
            return ()
        space = np.linspace if self.geomspace is None else np.geomspace
        first, last, _ = spaced
        return tuple(self._row(value) for value in space(first, last, self.count).tolist())

    @property
    def logarithmic(self) -> bool:
        """Whether its values are spaced, and drawn, in the logarithm."""
        return self.geomspace is not None or self.scale == "log"

    def sampled(self, share: float) -> Row:
        """The row at a share of the range, 0 to 1."""
        assert self.range is not None
        low, high = self.range
        if self.logarithmic:
            return self._row(math.exp(math.log(low) + share * math.log(high / low)))
        return self._row(low + share * (high - low))

    def _row(self, value: Any) -> Row:
        factors = self.factors or (1.0,) * len(self.paths)
        return tuple(value if factor == 1.0 else factor * value for factor in factors)

    def _checked_count(self, way: str) -> int:
        asked = getattr(self, way)
        if way == "values":
            return len(self.rows)
        wanted = "[lowest, highest]" if way == "range" else "[first, last, count]"
        if len(asked) != wanted.count(",") + 1:
            raise SceneError(way, f"got {shown(list(asked))}", wanted)
        first, last = asked[:2]
        if way == "range":
            if self.scale == "log":
                positive(first, f"{way}[0]")
            if not first < last:
                raise SceneError(way, f"an empty range, from {first:g} to {last:g}", "lowest < highest")
            return 0
        count = whole_number(asked[2], f"{way}[2]", 1)
        if count > MOST_RUNS:
            raise SceneError(f"{way}[2]", f"got {count} values", f"at most {MOST_RUNS}")
        if first == last and count > 1:
            problem = f"an empty range, {count} values from {first:g} to {last:g}"
            raise SceneError(way, problem, "two different ends")
        return count

    def _stated(self, given: tuple[Any, ...]) -> tuple[Row, ...]:
        """Rows of stated values; an entry for several keys may state a value for each."""
        entries = [one.item() if isinstance(one, np.generic) else one for one in given]
        lists = [tuple(entry) for entry in entries if isinstance(entry, (list, tuple))]
        several = {len(entry) for entry in lists} == {len(self.paths)} and len(lists) == len(entries)
        if lists and not (several and self.factors is None):
            allowed = f"lists of {len(self.paths)}, a value a key"
            raise SceneError("values", f"got {shown(entries)}", allowed)
        first = [entry[0] for entry in lists] or entries
        numeric = all(isinstance(entry, (int, float)) and not isinstance(entry, bool) for entry in first)
        words = all(isinstance(entry, str) for entry in first) and self.factors is None
        if not first or not (numeric or words):
            allowed = "numbers, or strings, or lists for several keys"
            raise SceneError("values", f"got {shown(entries)}", allowed)
        return tuple(lists) or tuple(map(self._row, entries))


@dataclass(frozen=True)
class SweepPlan(Checked):
    """What is to be run."""

    scene: Annotated[SceneTable, Key("built-in scene, or a scene file beside the plan")]
    coordinates: Annotated[tuple[Coordinate, ...], Key("what is varied of it")]
    title: Annotated[str, Key("of data set and figures")] = ""
    solver: Annotated[str, Key("name of a solver, or batch")] = solvers.REFERENCE
    resolution: Annotated[int | None, whole_from(1), Key("by default the solver's choice")] = None
    max_steps: Annotated[int | None, whole_from(1), Key("most steps of a run")] = None
    design: Annotated[
        Literal["grid", "points", "latin-hypercube", "sobol"],
        Key("all values with all, the first values of all, the second, ..., or a sample"),
    ] = "grid"
    points: Annotated[int | None, whole_from(1), Key("runs of a sample")] = None
    seed: Annotated[int, whole_from(0), Key("of a sample: which")] = 0
    estimate: Annotated[bool, Key("whether errors are estimated")] = True
    measures: Annotated[tuple[str, ...], Key("those that the data set holds; by default all")] = ()
    traces: Annotated[Literal["hdf5", "parquet"] | None, Key("files of the time series")] = None
    drawn: Annotated[tuple[str, ...], Key("measures of the figures")] = DRAWN
    units: Annotated[cs.Units, Key("names of the scene's units; by default as it states them")] = UNNAMED

    def rules(self) -> None:
        one_of(self.solver, "solver", (*solvers.SOLVERS, BATCH))
        least = batch_runs.LEAST_RESOLUTION
        if self.solver != BATCH:
            least = solvers.SOLVERS[self.solver].least_resolution  # one that cannot be loaded says so here
        if self.resolution is not None:
            whole_number(self.resolution, "resolution", least)
        is_sample = self.design in SAMPLES
        if (self.points is None) == is_sample:
            problem = f'given with design = "{self.design}"' if self.points else "is missing"
            raise SceneError("points", problem, f"a whole number >= 1, for {', '.join(SAMPLES)} only")
        if not self.coordinates:
            raise SceneError("coordinates", "got []", "at least one table [[coordinates]]")
        for index, coordinate in enumerate(self.coordinates):
            if (coordinate.range is None) == is_sample:
                problem = "no range" if coordinate.range is None else "got range"
                allowed = "for a sample range; for a grid or points values, linspace or geomspace"
                raise SceneError(f"coordinates[{index}]", problem, allowed)
        unvaried = self.scene.with_values({})
        if self.units == UNNAMED and unvaried.units is not None:
            object.__setattr__(self, "units", unvaried.units)
        known = measure_names(unvaried)
        names = [coordinate.name for coordinate in self.coordinates]
        keys = [".".join(parts(path)) for coordinate in self.coordinates for path in coordinate.paths]
        for what, listed in (("name", names), ("key", keys)):
            for one, count in Counter(listed).items():
                if count > 1:
                    raise SceneError("coordinates", f"the {what} {one} comes twice", f"every {what} once")
        for name in names:
            if name.removesuffix("_error") in known:
                problem = f"the coordinate {name} has the name of a measure"
                raise SceneError("coordinates", problem, "another name")
        lengths = [coordinate.count for coordinate in self.coordinates]
        if self.design == "points" and len(set(lengths)) > 1:
            problem = "got " + ", ".join(f"{n} of {name}" for n, name in zip(lengths, names, strict=True))
            raise SceneError("coordinates", problem, "as many values of each, for a list of points")
        for key, asked in (("measures", self.measures), ("drawn", self.drawn)):
            for name in asked:
                if name not in known and asked is not DRAWN:
                    raise SceneError(key, f"no measure {shown(name)}", ", ".join(known))
                if self.solver == BATCH and key == "measures" and not batch_runs.given(name):
                    problem = f"the batch solver gives no {shown(name)}"
                    raise SceneError(key, problem, ", ".join(filter(batch_runs.given, known)))
        if self.count > MOST_RUNS:
            raise SceneError("coordinates", f"make {self.count} runs", f"at most {MOST_RUNS}")

    @property
    def shape(self) -> tuple[int, ...]:
        """Runs along each dimension of the data set."""
        if self.design == "grid":
            return tuple(coordinate.count for coordinate in self.coordinates)
        return (self.points or self.coordinates[0].count,)

    @property
    def count(self) -> int:
        """Number of runs."""
        return math.prod(self.shape)

    def rows(self) -> Iterator[tuple[Row, ...]]:
        """For each run, in the order of the data set, the row of every coordinate."""
        if self.points is None:
            join = itertools.product if self.design == "grid" else zip
            yield from join(*(coordinate.rows for coordinate in self.coordinates))
        else:
            for point in sample(self.design, len(self.coordinates), self.points, self.seed):
                pairs = zip(self.coordinates, point.tolist(), strict=True)
                yield tuple(coordinate.sampled(share) for coordinate, share in pairs)

    def scene_of(self, rows: tuple[Row, ...]) -> cs.Scene:
        """The scene of a run; a refusal says at which values."""
        pairs = zip(self.coordinates, rows, strict=True)
        settings = {path: value for c, row in pairs for path, value in zip(c.paths, row, strict=True)}
        try:
            return self.scene.with_values(settings)
        except SceneError as error:
            key = f"{error.key or 'scene'} at {self._at(rows)}"
            raise SceneError(key, error.problem, error.allowed) from None

    def _at(self, rows: tuple[Row, ...]) -> str:
        """Which run it is, in words."""
        pairs = zip(self.coordinates, rows, strict=True)
        return ", ".join(f"{coordinate.name} = {shown(row[0])}" for coordinate, row in pairs)

    def check(self) -> None:
        """Build every scene, so that a bad value is refused before anything runs."""
        for rows in self.rows():
            scene = self.scene_of(rows)
            if self.solver == BATCH:
                batch_runs.check(scene, f" at {self._at(rows)}")


def measure_names(scene: cs.Scene) -> list[str]:
    """Names of all measures of a run: those of one that gave no row."""
    columns: Any = dict.fromkeys(cs.COLUMNS, np.empty(0))
    trace = cs.Trace(
        "", **columns, outcome=cs.Outcome(cs.OutcomeKind.COMPLETED, "", 0.0), counters=cs.Counters()
    )
    return list(measure(trace, scene, 0.0))


def sample(kind: str, dimensions: int, count: int, seed: int) -> np.ndarray:
    """A sample of the unit cube, shape (count, dimensions); a longer one of Sobol begins with a shorter."""
    random = np.random.default_rng(seed)
    if kind == "sobol":
        return np.asarray(qmc.Sobol(dimensions, seed=random).random_base2((count - 1).bit_length())[:count])
    return np.asarray(qmc.LatinHypercube(dimensions, seed=random).random(count))


def plan_names() -> list[str]:
    """Names of the built-in plans."""
    return sorted(file.stem for file in PLANS.glob("*.toml"))


def plan_from_dict(data: dict[str, Any], folder: Path, scene: SceneTable | None = None) -> SweepPlan:
    """A plan from the contents of its file, of a scene in place of the one that is named."""
    check_keys(data, fields_of(SweepPlan))
    found = builtin_or_file(data.get("scene"), folder) if scene is None else scene
    plan: SweepPlan = from_table([SweepPlan], data | {"scene": found}, folder)
    return plan


def read_plan(name: str) -> SweepPlan:
    """A plan file, or a built-in plan by name; every scene of it is one that can be built."""
    file = PLANS / f"{name}.toml" if name in plan_names() else Path(name)
    if not os.path.isfile(file):
        allowed = f"a TOML file, or one of {', '.join(plan_names())}"
        raise SceneError("PLAN", f"{shown(name)} is no file and no built-in plan", allowed)
    try:
        plan = plan_from_dict(tomllib.loads(read_text(file)), file.parent)
        plan.check()
    except SceneError as error:
        raise error.in_file(str(file)) from None
    except ValueError as error:
        raise SceneError("", f"not a TOML file: {error}", "a plan of a sweep", str(file)) from None
    return plan
