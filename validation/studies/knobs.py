"""Studies that turn a knob of the model instead of refining it: the process zone, or the bulk modulus.

At each value of the knob several methods answer, and each run is subtracted from that of a base.

**Zones**: what a shorter process zone costs in steps, updates, time, memory and error, over decades of it.
Long zones come first. The zone is part of the model, so every zone has a base of its own: the reference at
twice its default resolution. A run that takes longer than ``PATIENCE`` is ended, and its solver is not asked
for shorter zones.

**Poisson**: how good a constant Poisson's ratio is. For every ratio ``K/G`` of the relaxed solid the scene
keeps its shear relaxation and gets an elastic bulk. ``full`` is nu(t) from separate bulk and shear, by the
finite elements. The base, ``surface``, is the reference, which knows the bulk by the plane modulus
``E*(t)`` that the surface feels: the same problem by another method, so the two must agree within their error
estimates, which is checked. Three assumptions of a constant ratio, by the reference: ``shear``
and ``tension``, the relaxed ratio with the modulus measured in shear or in tension, and ``incompressible``,
the paper's 0.5. What an assumption costs is its difference from the base, beside the estimates.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar

from contact_scene import Material, SceneError
from validation.cases import Case
from validation.drawing.figure import SIZE, as_files, curve_style, drawing, format_axes
from validation.measure.curves import CURVES
from validation.measure.difference import Difference, of_curves, of_numbers
from validation.reference.creep_compliance import creep_compliance
from validation.report import document as doc
from validation.report.tables import estimates
from validation.report.texts import markdown
from validation.runs.folder import to_json, write_whole
from validation.runs.pool import TaskEnding, TellProgress, run_of, run_task, run_tasks
from validation.runs.provenance import of_case
from validation.runs.run import Run, run
from validation.runs.store import Store
from validation.solvers import REFERENCE, SOLVERS, solvers
from validation.solvers.finite_elements import FiniteElements
from validation.studies.orders import fitted_slope

if TYPE_CHECKING:
    from matplotlib.figure import Figure

PATIENCE = 300.0
"""Longest processor time (s) of one run of a study of zones; the reference needs seconds at any zone, the
finite elements a minute or two at the shortest."""
COSTS = {
    "steps": ("d", "accepted steps"),
    "updates": (".0f", "updates of the history in a step"),
    "seconds": (".2f", "processor time (s)"),
    "megabytes": (".0f", "memory of the process (MB)"),
}
"""Of a run, the updates on average as each solver counts them: form of the number, and words."""
FULL, SURFACE = "full", "surface"
"""Names of the runs with separate bulk relaxation and with the modulus at the surface."""


@dataclass(frozen=True)
class KnobRun:
    """One method (``label``) at one value of a knob, and the run it is subtracted from.

    Without a ``run``, ``skipped`` says why. ``isolated``: it had a process of its own, whose memory counts.
    """

    value: float
    label: str
    case: Case
    run: Run | None = None
    base: Run | None = None
    skipped: str = ""
    isolated: bool = False

    def differences(self, names: Iterable[str]) -> dict[str, Difference]:
        """From the base, of the named observables and of the curves, as far as both runs have them."""
        if self.run is None or self.base is None:
            return {}
        found = (*of_numbers(self.run, self.base, names), *of_curves(self.run, self.base))
        return {one.quantity: one for one in found if math.isfinite(one.error)}

    @property
    def costs(self) -> dict[str, float]:
        """What the run took (:data:`COSTS`), as far as it is known."""
        found: dict[str, float] = {}
        if self.run is not None and self.run.trace is not None:
            counters = self.run.trace.counters
            found |= {"steps": counters.steps, "seconds": self.run.cpu_seconds}
            if counters.history_updates and counters.steps:
                found["updates"] = counters.history_updates / counters.steps
        return found if self.peak_memory is None else found | {"megabytes": 1e-6 * self.peak_memory}

    @property
    def peak_memory(self) -> int | None:
        """Most bytes of the process of this run alone, program included."""
        return self.run.peak_memory if self.run is not None and self.isolated else None


def write(knob: Zones | Poisson, case: Case, runs: Sequence[KnobRun], folder: Path) -> Path:
    """Write ``NAME-SCENE.json``, its tables as ``.md``, returned, and a figure of zones.

    The keys of the numbers are a fixed contract with whoever reads them.
    """
    shown, path = knob.section(case.name, runs), folder / f"{knob.name}-{case.name}.json"
    write_whole(path, to_json({"scene": case.name, "premises": of_case(case)} | knob.data(runs)))
    write_whole(path.with_suffix(".md"), markdown(doc.Document(shown.title, (), shown.parts)))
    if isinstance(knob, Zones):
        for name, content in as_files(knob.draw(runs), path.stem).items():
            write_whole(folder / name, content)
    return path.with_suffix(".md")


@dataclass(frozen=True)
class Zones:
    """Process zones over the largest contact radius that the scene reaches with its own zone.

    Isolated processes alone can end a run that takes too long, and one task a process has memory of its own.
    """

    solvers: tuple[str, ...] = ()
    """Names; none: all that are registered."""
    name: ClassVar = "zones"
    values: ClassVar = (5e-2, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 5e-9)
    observed: ClassVar = ("pull_off_force", "loop_energy")
    notes: ClassVar = """\
Errors: relative, against the reference at twice its default resolution with the same zone. Updates: of the
history, in a step on average, as each solver counts them (the reference: radii tried). Megabytes:
the most that the process of a run held, program and libraries included. Growth: exponent p of a fit by
zone^-p over all zones of a solver; 0 where a shorter zone costs no more than its logarithm."""

    def runs(
        self,
        case: Case,
        values: Sequence[float],
        progress: TellProgress | None = None,
        executor: Executor | None = None,
        store: Store | None = None,
        max_steps: int | None = None,
    ) -> list[KnobRun]:
        adhesion = case.scene.adhesion
        if adhesion is None or not case.scene.is_adhesive:
            raise SceneError("adhesion", "a study of zones needs adhesion")
        if adhesion.stress is not None:
            given = "a study of zones sets their lengths"
            raise SceneError("adhesion.stress", given, "a scene with adhesion.zone")
        own = run(case, REFERENCE)
        if own.curves is None:
            raise SceneError("scene", f"the reference has no answer to it: {own.ending}")
        radius = float(own.curves.contact_radius.max())
        names = self.solvers or tuple(one.name for one in solvers())
        made: list[KnobRun] = []
        given_up: set[str] = set()
        for ratio in sorted(values, reverse=True):
            there = replace(adhesion, zone=ratio * radius, stress=None)
            turned = replace(case, scene=replace(case.scene, adhesion=there))
            finer = run(turned, REFERENCE, 2 * SOLVERS[REFERENCE].default_resolution(turned.scene))
            for name in names:
                if progress is not None:
                    done = len(made) / (len(values) * len(names))
                    progress(done, f"{name}, zone {ratio:.0e} of the radius", "")
                one = KnobRun(ratio, name, turned, skipped="not run: too long at a longer zone")
                if name not in given_up:
                    one = _patiently(replace(one, base=finer), executor, store, max_steps)
                if one.skipped:
                    given_up.add(name)
                made.append(one)
        return made

    def data(self, runs: Sequence[KnobRun]) -> dict[str, Any]:
        return {"runs": [self._data_of(one) for one in runs]}

    def _data_of(self, one: KnobRun) -> dict[str, Any]:
        adhesion, costs = one.case.scene.adhesion, one.costs
        return {
            "zone_over_radius": one.value,
            "zone": None if adhesion is None else adhesion.zone,
            "solver": one.label,
            "outcome": None if one.run is None else one.run.ending,
            "skipped": one.skipped or None,
            "steps": costs.get("steps"),
            "history_updates_per_step": costs.get("updates"),
            "cpu_seconds": costs.get("seconds"),
            "peak_memory_bytes": one.peak_memory,
            "errors": self.errors(one),
            "error_estimates": {} if one.run is None else one.run.errors,
        }

    def errors(self, one: KnobRun) -> dict[str, float]:
        """Signed relative errors by observable."""
        found = one.differences(self.observed)
        return {name: found[name].error for name in self.observed if name in found}

    def section(self, name: str, runs: Sequence[KnobRun]) -> doc.Section:
        by_solver = {label: [one for one in runs if one.label == label] for label in _labels(runs)}
        fits = (
            {"solver": solver}
            | {
                f"growth of {n}": doc.formatted(growth(own, n), ".2f")
                for n in ("steps", "updates", "seconds")
            }
            for solver, own in by_solver.items()
        )
        tables = doc.DataTable.of(map(self._row, runs)), doc.DataTable.of(fits)
        return doc.Section(f"{name}: cost over the process zone", (*tables, doc.Paragraph(self.notes)))

    def _row(self, one: KnobRun) -> doc.Record:
        errors, finished = self.errors(one), one.run is None or one.run.finished
        return {
            "zone / radius": f"{one.value:.0e}",
            "solver": one.label,
            **{name: doc.formatted(one.costs.get(name), form) for name, (form, _) in COSTS.items()},
            **{
                f"{doc.plain(name)}: error": doc.formatted(errors.get(name), "+.1e") for name in self.observed
            },
            "not finished": one.run.ending if one.run and not finished else one.skipped or doc.ABSENT,
        }

    def failures(self, runs: Sequence[KnobRun]) -> Iterator[str]:
        for one in runs:
            if one.run is not None and not one.run.finished and not one.run.refused:
                where = f"{one.case.name}: {one.label}, zone {one.value:g} of the radius"
                yield f"not finished: {where}: {one.run.ending}"

    def draw(self, runs: Sequence[KnobRun]) -> Figure:
        """Logarithmic axes, one for each quantity; a solver's curve ends at the last zone it was run with."""
        panels = [words for _, words in COSTS.values()]
        panels += [f"error of {doc.plain(name)} (relative)" for name in self.observed]
        numbers = [one.costs | {name: abs(error) for name, error in self.errors(one).items()} for one in runs]
        figure, grid = drawing((3 * SIZE[0], 2 * SIZE[1]), 2, 3)
        names = (*COSTS, *self.observed)
        for axes, name, label in zip(grid.flat, names, panels, strict=True):
            axes.set(xscale="log", yscale="log", xlabel="process zone over contact radius", ylabel=label)
            for solver in _labels(runs):
                own = zip(runs, numbers, strict=True)
                points = [(one.value, n[name]) for one, n in own if one.label == solver and n.get(name)]
                if points:
                    axes.plot(*zip(*points, strict=True), label=solver, markersize=4.5, **curve_style(solver))
            axes.invert_xaxis()
            format_axes(axes)
        if figure.axes[0].lines:  # no solver may have answered
            figure.axes[0].legend(fontsize=8)
        return figure


def _labels(runs: Sequence[KnobRun]) -> list[str]:
    return list(dict.fromkeys(one.label for one in runs))


def growth(runs: Iterable[KnobRun], quantity: str) -> float | None:
    """Fitted exponent ``p`` of a quantity that grows as ``zone**-p``; 0: at most with the logarithm."""
    pairs = [(one.value, one.costs.get(quantity)) for one in runs]
    slope = fitted_slope([value for value, _ in pairs], [found for _, found in pairs])
    return None if slope is None else -slope


def _patiently(
    one: KnobRun, executor: Executor | None, store: Store | None, max_steps: int | None
) -> KnobRun:
    """The run, or that it took too long."""
    task = run_task(one.case, one.label, max_steps=max_steps, time_limit=PATIENCE)
    (answer,) = run_tasks([task], executor, store)
    if answer.ending is TaskEnding.TIMED_OUT:
        return replace(one, skipped=answer.failure)
    return replace(one, run=run_of(answer), isolated=executor is not None, skipped="")


def with_bulk(material: Material, ratio: float) -> Material:
    """The same ``G(t)`` with elastic bulk of ``K = ratio * G(infinity)``, ``ratio > 2/3``."""
    return replace(_with_poisson(material, (3.0 * ratio - 2.0) / (2.0 * (3.0 * ratio + 1.0))), bulk="elastic")


def incompressible(material: Material) -> Material:
    """The same ``G(t)`` with Poisson's ratio 0.5."""
    return _with_poisson(material, 0.5)


def tension(material: Material) -> Material:
    """The modulus that a tensile test measures, ``1/E^ = 1/(3 G^) + 1/(9 K)``, and the relaxed ratio."""
    creep, bulk = creep_compliance(incompressible(material)), bulk_modulus(material)
    relaxed, branches = replace(creep, glassy=creep.glassy + 1.0 / (9.0 * bulk)).relaxation()
    return Material(relaxed, material.poisson, branches)


def constant(material: Material) -> Material:
    """The same ``G(t)`` with the Poisson's ratio of the relaxed solid at all times: bulk relaxes alike."""
    return replace(material, bulk=None)


def bulk_modulus(material: Material) -> float:
    """Of the relaxed solid."""
    return material.modulus / (3.0 * (1.0 - 2.0 * material.poisson))


def glassy_poisson(material: Material) -> float:
    """Poisson's ratio at first, where the bulk does not relax."""
    shear, bulk = material.glassy_modulus / (2.0 * (1.0 + material.poisson)), bulk_modulus(material)
    return (3.0 * bulk - 2.0 * shear) / (2.0 * (3.0 * bulk + shear))


def _with_poisson(material: Material, poisson: float) -> Material:
    """The same ``G(t)`` with another constant ratio."""
    factor = (1.0 + poisson) / (1.0 + material.poisson)
    branches = tuple(replace(branch, modulus=factor * branch.modulus) for branch in material.branches)
    return Material(factor * material.modulus, poisson, branches)


ASSUMPTIONS: dict[str, Callable[[Material], Material]] = {
    "shear": constant,
    "tension": tension,
    "incompressible": incompressible,
}


@dataclass(frozen=True)
class Poisson:
    """``K/G`` of the relaxed solid; ``resolution`` is that of the finite elements."""

    resolution: int | None = None
    name: ClassVar = "poisson"
    values: ClassVar = (10.0, 30.0, 100.0, 300.0, 1000.0)
    observed: ClassVar = ("pull_off_force", "loop_energy", "approach_radius", "approach_force")
    notes: ClassVar = """\
full − E*(t): ν(t) by the finite elements against the reference on E*(t), the one modulus the surface feels;
estimates: what these two say of their own errors. The other columns are what a constant ratio costs, against
E*(t): `shear` and `tension`, the relaxed ratio with a modulus measured so; `incompressible`, ν = 0.5. All
relative; curves: root mean square over time. For K >> G the plane modulus is 4 G (1 - G/K): a constant ratio
takes the fast response too stiff by (G(0) - G(∞))/K, two thirds of it if measured in tension."""

    def runs(
        self,
        case: Case,
        values: Sequence[float],
        progress: TellProgress | None = None,
        executor: Executor | None = None,
        store: Store | None = None,
        max_steps: int | None = None,
    ) -> list[KnobRun]:
        asked, tasks = [], []
        for ratio in values:
            separate = with_bulk(case.scene.material, ratio)
            materials = {FULL: separate, SURFACE: separate}
            materials |= {name: assume(separate) for name, assume in ASSUMPTIONS.items()}
            for name, material in materials.items():
                turned = replace(case, scene=replace(case.scene, material=material))
                full = name == FULL
                solver = FiniteElements.name if full else REFERENCE
                resolution = self.resolution if full else None
                task = run_task(turned, solver, resolution, estimate=True, max_steps=max_steps)
                asked.append(KnobRun(ratio, name, turned))
                tasks.append(replace(task, label=f"K/G = {ratio:g}: {name}"))
        found = [run_of(result) for result in run_tasks(tasks, executor, store, progress)]
        bases = {one.value: run for one, run in zip(asked, found, strict=True) if one.label == SURFACE}
        return [replace(one, run=run, base=bases[one.value]) for one, run in zip(asked, found, strict=True)]

    def data(self, runs: Sequence[KnobRun]) -> dict[str, Any]:
        return {
            "compressibilities": [
                {
                    "bulk_to_shear": ratio,
                    "initial_poisson": glassy_poisson(here[FULL].case.scene.material),
                    "final_poisson": here[FULL].case.scene.material.poisson,
                    "runs": {label: self._data_of(one, one.run) for label, one in here.items() if one.run},
                }
                for ratio, here in _by_value(runs)
            ]
        }

    def _data_of(self, one: KnobRun, run: Run) -> dict[str, Any]:
        names, found = (*self.observed, *CURVES), one.differences(self.observed)
        return {
            "solver": run.solver,
            "ending": run.ending,
            "cpu_seconds": run.cpu_seconds,
            "observables": {name: run.measures.get(name) for name in self.observed},
            "error_estimates": {name: run.errors.get(name) for name in names},
            "differences": {name: found[name].error if name in found else None for name in names},
        }

    def section(self, name: str, runs: Sequence[KnobRun]) -> doc.Section:
        rows = (row for ratio, here in _by_value(runs) for row in self._rows(ratio, here))
        title = f"{name}: elastic bulk against a constant Poisson's ratio"
        return doc.Section(title, (doc.DataTable.of(rows), doc.Paragraph(self.notes)))

    def _rows(self, ratio: float, here: dict[str, KnobRun]) -> Iterator[doc.Record]:
        """One row for every quantity."""
        found = {label: one.differences(self.observed) for label, one in here.items()}
        material = here[FULL].case.scene.material
        for name in (*self.observed, *CURVES):
            full = found[FULL].get(name)
            costs = {label: found[label].get(name) for label in ASSUMPTIONS}
            yield {
                "K/G": f"{ratio:g}",
                "ν(0)": f"{glassy_poisson(material):.4f}",
                "ν(∞)": f"{material.poisson:.4f}",
                "quantity": doc.plain(name) + (" (curve)" if name in CURVES else ""),
                "full − E*(t)": doc.formatted(full.error if full else None, "+.1e"),
                "estimates": doc.ABSENT if full is None else estimates(full.own, full.known_to),
            } | {label: doc.formatted(one.error if one else None, "+.1e") for label, one in costs.items()}

    def failures(self, runs: Sequence[KnobRun]) -> Iterator[str]:
        for ratio, here in _by_value(runs):
            where = f"{here[FULL].case.name}: K/G = {ratio:g}"
            for label, one in here.items():
                if one.run is not None and not one.run.finished:
                    yield f"not finished: {where}: {label}: {one.run.ending}"
            for name, apart in here[FULL].differences(self.observed).items():
                if abs(apart.error) > (apart.own or 0.0) + (apart.known_to or 0.0):
                    yield f"failed: {where}: {name}: beyond the error estimates"


def _by_value(runs: Sequence[KnobRun]) -> Iterator[tuple[float, dict[str, KnobRun]]]:
    for value in dict.fromkeys(one.value for one in runs):
        yield value, {one.label: one for one in runs if one.value == value}
