"""The paper's own discretisation (Appendix A): uniform annuli and a fixed time step.

First order in the annulus width and in the step, by construction: the contact edge moves from border to
border. A disc ``C_0`` of radius ``lambda`` is collocated at its centre, annulus ``C_q`` from ``q lambda`` to
``(q + 1) lambda`` at ``(q + 1/2) lambda``. Every annulus has a history, in contact or not: its displacement
per unit modulus ``v`` and the strains ``e_k`` of its Voigt branches, ``w = v/Einf + sum e_k`` (Eq. knownterm:
``A = sum e_k``). One step of any scheme then reads ``w = C v + A`` at every radius, the same C everywhere.
Lengths in scene units, ``scaled`` pressure is pressure times ``lambda`` at unit plane modulus.

One factorisation of the influence matrix without row exchanges serves every contact. With ``K = L U``, for
every n ``K[:n, :n] = L[:n, :n] U[:n, :n]`` and ``K[n:, :n] = L[n:, :n] U[:n, :n]``: so ``y = L^-1 b`` holds
the forward solutions of all leading blocks, and ``K[n:, :n] K[:n, :n]^-1 b[:n]`` is ``L[n:, :n] y[:n]``.

The energies are exact for the discrete fields: a step makes each new branch field a combination of three
known ones, and with it the forms Y, X_k, W_k of ``recorder``. The work a branch receives is taken with the
pressure at the end of the step, as backward Euler does: no step then dissipates less than nothing.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import solve_triangular
from scipy.linalg.blas import dtpsv
from scipy.linalg.lapack import dgetrf

from bem_solver.annuli import annulus_influence
from bem_solver.creep import Chain
from bem_solver.equilibrium import contact_scale
from bem_solver.options import Options
from bem_solver.recorder import RunRecord, trace_without_start
from bem_solver.size_estimates import MOST_ANNULI, largest_contact
from contact_scene import (
    Counters,
    Indenter,
    Material,
    Outcome,
    OutcomeKind,
    RunMonitor,
    Scene,
    SurfaceProfile,
    Trace,
    UnsupportedScene,
)
from contact_scene.run_control import (
    LoadingCursor,
    LoadingInterval,
    below_zone_outcome,
    budget_outcome,
    follow_loading,
    interruption,
)
from contact_scene.scene import zone_too_long

Array = NDArray[np.float64]


def _packed(triangle: Array) -> Array:
    """Rows of a lower triangle one after another: storage of which every leading block is a prefix."""
    return np.concatenate([triangle[j, : j + 1] for j in range(len(triangle))])


class LeadingBlocks:
    """LU factors of a matrix (N, N) for solutions with any leading block.

    In ``factors`` (N, N) L, with unit diagonal, is below the diagonal, U on and above it. ArithmeticError if
    the matrix is singular or needs row exchanges.
    """

    def __init__(self, matrix: Array) -> None:
        factors, rows, info = dgetrf(matrix)
        if info or np.any(rows != np.arange(len(rows))):
            raise ArithmeticError("the matrix cannot be factorised without exchanging rows")
        self.factors = np.ascontiguousarray(factors)
        self._lower = _packed(self.factors)
        self._upper = _packed(self.factors.T)

    def forward(self, values: Array) -> Array:
        """``L^-1 b`` for b (n,), any n <= N."""
        return dtpsv(len(values), self._lower, values, trans=1, diag=1)

    def backward(self, values: Array) -> Array:
        """``U^-1 y`` for y (n,): the solution with the leading block of that size."""
        return dtpsv(len(values), self._upper, values)

    def adjoint(self, values: Array) -> Array:
        """``U^-T c`` for c (n,): ``c[:m] @ K[:m, :m]^-1 b[:m]`` is ``(U^-T c)[:m] @ (L^-1 b)[:m]``."""
        return dtpsv(len(values), self._upper, values, trans=1)

    def last(self, forward: Array, count: int) -> Array:
        """The last ``count`` entries of ``U^-1 y`` for y (n,)."""
        n = len(forward)
        corner = self.factors[n - count : n, n - count : n]
        return solve_triangular(corner, forward[n - count :], check_finite=False)

    def beyond(self, forward: Array, end: int) -> Array:
        """Rows n to ``end`` of ``K[:, :n] K[:n, :n]^-1 b`` from ``y = L^-1 b`` (n,)."""
        n = len(forward)
        return self.factors[n:end, :n] @ forward


class UniformAnnuli:
    """``count`` annuli of equal ``width`` under an indenter, ``zone`` of them (0 without adhesion) the zone.

    ``radii``, ``heights`` and ``areas`` (N,) are the collocation radii, the indenter there, and areas in
    squared widths; ``blocks`` the factors for annuli of width one; ``unit`` is ``L^-1 1``, and the force of n
    annuli the product of ``force_weights``, ``U^-T areas``, with ``y = L^-1 v``.
    """

    def __init__(self, width: float, count: int, zone: int, indenter: Indenter) -> None:
        borders = np.arange(count + 1.0)
        middles = borders[:-1] + 0.5
        middles[0] = 0.0
        self.width, self.count, self.zone = width, count, zone
        self.radii = width * middles
        self.heights = indenter.height(self.radii)
        self.areas = np.pi * np.diff(borders**2)
        self.blocks = LeadingBlocks(annulus_influence(middles, borders))
        self.unit = self.blocks.forward(np.ones(count))
        self.force_weights = self.blocks.adjoint(self.areas)

    def forces(self, scaled: Array) -> Array:
        """Force on each annulus of a contact from its scaled pressures, (n,)."""
        return self.width * self.areas[: len(scaled)] * scaled

    def stress_intensity(self, forward: Array) -> float:
        """``K_I`` (tension opens) from ``y = L^-1 v`` (n,): the edge annulus against the flat punch's.

        The punch of unit displacement has ``K_I = -1/sqrt(pi a)``; the ratio of last pressures is that of the
        last entries of y.
        """
        n = len(forward)
        if n == 0:
            return 0.0
        return -float(forward[-1] / self.unit[n - 1] / np.sqrt(np.pi * n * self.width))


@dataclass(frozen=True)
class AnnuliState:
    """Committed state of the surface.

    ``contact`` annuli touch under the ``scaled`` pressure (n,); ``load`` (N,) is ``v``, and ``strains``
    (N, K) are the displacements of the Voigt branches.
    """

    time: float
    penetration: float
    contact: int
    load: Array
    strains: Array
    scaled: Array
    force: float
    stress_intensity: float

    @classmethod
    def untouched(cls, annuli: UniformAnnuli, branches: int, penetration: float) -> AnnuliState:
        """No contact and no past, at time zero."""
        zero = np.zeros(annuli.count)
        return cls(0.0, penetration, 0, zero, np.zeros((annuli.count, branches)), zero[:0], 0.0, 0.0)

    def displacement(self, chain: Chain) -> Array:
        """Surface displacement (N,)."""
        return self.load / chain.glassy + self.strains.sum(axis=1)


def step_factors(chain: Chain, duration: float) -> tuple[Array, Array, Array]:
    """Factors (K,) of a step of either scheme, ``e_k = one e_k + two v before + three v after``."""
    y = duration / chain.retardation
    decay, spread = chain.decay(y), chain.spread(y)
    return decay, chain.compliances * (spread - decay), chain.compliances * (1.0 - spread)


class ContactCandidates:
    """All contacts that are possible at the end of a step, from one triangular solution.

    Penetration enters ``v = (D - f - A)/C`` linearly, so ``y = L^-1 v`` is ``base + D rise``, for contacts of
    any number of annuli, and so is the force. Of the two the ``control`` has ``value`` at the end.
    """

    def __init__(
        self,
        annuli: UniformAnnuli,
        chain: Chain,
        before: AnnuliState,
        duration: float,
        control: str,
        value: float,
        counters: Counters,
    ) -> None:
        self.annuli, self.before = annuli, before
        self.control, self.value, self.counters = control, value, counters
        decay, of_before, self._new_share = step_factors(chain, duration)
        self._decayed = before.strains * decay + np.outer(before.load, of_before)
        self._known = self._decayed.sum(axis=1)
        self._compliance = 1.0 / chain.glassy + float(self._new_share.sum())
        self._base = annuli.blocks.forward(-(annuli.heights + self._known) / self._compliance)
        self._rise = annuli.unit / self._compliance
        if control == "force":
            self._force_base = annuli.width * np.cumsum(annuli.force_weights * self._base)
            self._force_rise = annuli.width * np.cumsum(annuli.force_weights * self._rise)
        counters.linear_solves += 1
        counters.history_updates += 1

    def penetration(self, contact: int) -> float:
        """Penetration of a contact of that many annuli (at least one)."""
        if self.control == "penetration":
            return self.value
        return float((self.value - self._force_base[contact - 1]) / self._force_rise[contact - 1])

    def forward(self, contact: int) -> Array:
        """``L^-1 v`` (n,)."""
        return self._base[:contact] + self.penetration(contact) * self._rise[:contact]

    def closure(self, contact: int) -> float:
        """Closure integral (Eq. closure), a plain sum over the annuli of the process zone.

        The tension s inside the edge meets the gap ``zone - s`` outside it, which is the gap ``zone`` annuli
        further out. The zone is cut at the centre. A compressive edge counts negative.
        """
        self.counters.closure_evaluations += 1
        annuli, zone = self.annuli, self.annuli.zone
        y, inside = self.forward(contact), min(zone, contact)
        pressure = annuli.blocks.last(y, inside)
        end = contact + zone
        outside = slice(end - inside, end)
        load = annuli.blocks.beyond(y, end)[-inside:]
        lowered = self._compliance * load + self._known[outside] - self.penetration(contact)
        value = -float(pressure @ (annuli.heights[outside] + lowered)) / (2.0 * zone * annuli.width)
        if not math.isfinite(value):
            raise FloatingPointError(
                f"the closure is not finite at contact radius {contact * annuli.width:.6g}"
            )
        return -abs(value) if pressure[-1] > 0.0 else value

    def edge_pressure(self, contact: int) -> float:
        """Pressure of the outermost annulus of a contact, in units of its own (positive: compression)."""
        n = contact - 1
        return float(self._base[n] + self.penetration(contact) * self._rise[n])

    def state(self, contact: int, time: float) -> AnnuliState:
        """The state with that many annuli in contact."""
        annuli = self.annuli
        if contact == 0:
            penetration = self.value if self.control == "penetration" else self.before.penetration
            load, y, scaled = np.zeros(annuli.count), self._base[:0], self._base[:0]
        else:
            penetration, y = self.penetration(contact), self.forward(contact)
            inside = (penetration - annuli.heights[:contact] - self._known[:contact]) / self._compliance
            load = np.concatenate((inside, annuli.blocks.beyond(y, annuli.count)))
            scaled = annuli.blocks.backward(y)
        force = float(annuli.forces(scaled).sum())
        strains = self._decayed + np.outer(load, self._new_share)
        intensity = annuli.stress_intensity(y)
        return AnnuliState(time, penetration, contact, load, strains, scaled, force, intensity)


def equilibrium_contact(
    candidates: ContactCandidates, start: int, most: int, capped: bool, work: float
) -> int | None:
    """Number of annuli in contact at equilibrium, next to ``start``.

    With adhesion, the stable edge lies where the closure rises through the work of adhesion; of the two
    borders around it the one whose closure comes closer is taken. Without adhesion, tensile edge annuli are
    released and overlapping ones covered. Zero where no stable contact is left; ``None`` where it would
    spread beyond the largest, ``most``, unless the indenter ends there (``capped``).
    """
    n, above = start, None
    if work > 0.0:
        residual = candidates.closure(n) - work if n > 0 else -work
        while residual > 0.0:
            n, above = n - 1, residual
            if n == 0:
                return 0
            residual = candidates.closure(n) - work
        while above is None and n < most:
            beyond = candidates.closure(n + 1) - work
            if beyond > 0.0:
                above = beyond
            else:
                n, residual = n + 1, beyond
        if above is not None:
            return n + 1 if above < -residual else n
    else:
        while n > 0 and candidates.edge_pressure(n) < 0.0:
            n -= 1
        while n < most and candidates.edge_pressure(n + 1) > 0.0:
            n += 1
    return n if n < most or capped else None


_MARGIN = 1.1
"""Outermost contact allowed for, relative to the estimate of the largest contact radius."""
_PER_RADIUS = 10
"""Annuli in the largest contact without adhesion, in multiples of the resolution."""
_STEPS_PER_RESOLUTION = 4.0
"""Steps per unit of the resolution in the shortest of the times to be resolved."""
_SAMPLES = 256
"""Times per interval at which the loading is sampled."""
_LONGEST_RATIO = 1000.0
"""Interval length over relaxation time above which the latter is no longer resolved."""
_HALVINGS = 8
"""Halvings of the step in which contact is lost: far below its error, which is of first order."""


def refusal_of_uniform(scene: Scene) -> UnsupportedScene | None:
    """Why uniform annuli do not take a scene; ``None`` if they do."""
    left_out = {
        "machine.stiffness": (scene.loading.compliance > 0.0, "uniform annuli know no spring"),
        "loading.steps": (scene.loading.has_triggers, "uniform annuli know no level that ends a step"),
    }
    for key in ("work_closing", "rate", "stress"):
        given = getattr(scene.adhesion, key, None) is not None
        left_out[f"adhesion.{key}"] = given, "uniform annuli know one work of adhesion and one process zone"
    left_out["body"] = scene.body is not None, "uniform annuli know no layer"
    for key, (given, why) in left_out.items():
        if given:
            return UnsupportedScene(key, why, 'annuli = "graded"')
    return None


def solve_uniform(
    scene: Scene, options: Options, progress: Callable[[float], None] | None, monitor: RunMonitor | None
) -> Trace:
    """Solve a scene on uniform annuli, as :func:`bem_solver.solve`."""
    counters, cursor = Counters(factorisations=1), LoadingCursor()
    run = _Run(scene, options, counters, monitor)
    try:
        if not run.start():
            return trace_without_start(scene.loading.without_start, counters)
        outcome = follow_loading(
            run, scene.loading, cursor, options.stop_times, options.profile_times, progress
        )
    except FloatingPointError as error:
        if not run.record.rows:
            return trace_without_start(str(error), counters)
        outcome = Outcome(OutcomeKind.NOT_FINITE, str(error), run.surface.time)
    radius, stored, heat, intensity = np.array(run.record.rows).T[3:]
    spent = -run.work * np.pi * (radius**2 - radius[0] ** 2)
    return run.record.finished(outcome, counters, run.work, (stored, spent, heat), intensity)


def _annuli_for(scene: Scene, divisions: int, largest: float) -> tuple[UniformAnnuli, int]:
    """The annuli, and the number of them in the largest contact that is allowed for.

    Under a flat punch the width is changed a little, so that its edge is a border.
    """
    zone = divisions if scene.is_adhesive else 0
    width = largest / (_PER_RADIUS * divisions)
    if scene.adhesion is not None and zone:
        width = scene.adhesion.zone / divisions
    edge = scene.indenter.edge
    most = (math.ceil(_MARGIN * largest / width) if edge == math.inf else round(edge / width)) + 1
    count = most + max(zone, most // 10 + 1)
    if count > MOST_ANNULI:
        raise UnsupportedScene(
            "adhesion.zone",
            f"{count} uniform annuli would be needed",
            f'at most {MOST_ANNULI}: a lower resolution, a longer zone, or annuli "graded"',
        )
    if edge != math.inf:
        most = max(most - 1, 1)
        width = edge / most
    return UniformAnnuli(width, count, zone, scene.indenter), most


def step_count(
    scene: Scene, interval: LoadingInterval, options: Options, largest: float, length: float
) -> int:
    """Number of equal steps in which an interval is taken (``Options.step``); of a jump ``4 resolution``.

    A zone stands for ``resolution`` annuli without adhesion. A fixed step cannot follow a spectrum over many
    decades, and both schemes are stable beyond it.
    """
    if interval.jump:
        return math.ceil(_STEPS_PER_RESOLUTION * options.divisions)
    if options.step is not None:
        return max(math.ceil(interval.length / options.step * (1.0 - 1e-12)), 1)
    # at multiples of the golden ratio, behind which no periodic loading can hide
    share = np.modf(0.5 * (math.sqrt(5.0) - 1.0) * np.arange(_SAMPLES))[0]
    times = (interval.start + interval.length * share).tolist()
    values = [interval.value(t) for t in (*times, interval.end)]
    travel = interval.length * max(abs(interval.rate(t)) for t in times)
    swing = max(values) - min(values)
    count = travel / swing if swing > 0.0 else 0.0
    slope = 2.0 * float(scene.indenter.slope(min(largest, scene.indenter.edge)))
    if interval.control == "force":
        slope *= 2.0 * scene.material.relaxed_plane_modulus * largest
    if slope > 0.0:
        count = max(count, travel / (slope * length))
    relaxation = scene.material.spectrum[1]
    if relaxation.size:
        count = max(count, interval.length / max(float(relaxation.min()), interval.length / _LONGEST_RATIO))
    return max(math.ceil(_STEPS_PER_RESOLUTION * options.divisions * count), 1)


@dataclass(frozen=True)
class _Energies:
    """Y, X (K,), W (K,), and what the branches have turned into heat."""

    load_work: float
    branch_work: Array
    branch_energy: Array
    dissipated: float

    @classmethod
    def at_start(cls, chain: Chain, annuli: UniformAnnuli, surface: AnnuliState, relaxed: bool) -> _Energies:
        """Of a start state that has relaxed, or a glassy one with no strain in the branches."""
        load_work = float(annuli.forces(surface.scaled) @ surface.load[: surface.contact])
        share = chain.compliances * (1.0 if relaxed else 0.0)
        return cls(load_work, share * load_work, share * chain.compliances * load_work, 0.0)

    def stored(self, chain: Chain) -> float:
        """Stored energy U."""
        return 0.5 * (self.load_work / chain.glassy + float(np.sum(self.branch_energy / chain.compliances)))

    def after(
        self, chain: Chain, annuli: UniformAnnuli, before: AnnuliState, after: AnnuliState
    ) -> _Energies:
        """After a step."""
        decay, one, two = step_factors(chain, after.time - before.time)
        forces, n = annuli.forces(after.scaled), after.contact
        load_work, branch_work = float(forces @ after.load[:n]), forces @ after.strains[:n]
        load_before, branch_before = float(forces @ before.load[:n]), forces @ before.strains[:n]
        energy = decay**2 * self.branch_energy + one**2 * self.load_work + two**2 * load_work
        energy += 2.0 * (decay * (one * self.branch_work + two * branch_before) + one * two * load_before)
        gained = 0.5 * (energy - self.branch_energy) / chain.compliances
        lost = float(np.sum(branch_work - branch_before - gained))
        return _Energies(load_work, branch_work, energy, self.dissipated + lost)


class _Run:
    """A run: what stays, and the committed state ``surface`` with its ``energies`` and ``record``.

    Rows are time, penetration, force, radius, stored energy, branch dissipation and stress intensity.
    """

    energies: _Energies

    def __init__(
        self, scene: Scene, options: Options, counters: Counters, monitor: RunMonitor | None
    ) -> None:
        self.scene, self.options, self.counters = scene, options, counters
        self.monitor = monitor
        self.chain = Chain(scene.material, options.scheme == "backward-euler")
        self.work = scene.adhesion.work if scene.adhesion else 0.0
        at_start = contact_scale(scene, scene.loading.penetration)
        self.largest = largest_contact(scene) or at_start or 1.0  # any length where there is never contact
        self.annuli, self.most = _annuli_for(scene, options.divisions, self.largest)
        self.length = self.annuli.width * options.divisions
        self.capped = scene.indenter.edge < math.inf
        self.surface = AnnuliState.untouched(self.annuli, len(self.chain), scene.loading.penetration)
        self.record = RunRecord()

    def reached(self) -> tuple[float, float, float]:
        """Time, penetration and force of the committed state."""
        return self.surface.time, self.surface.penetration, self.surface.force

    def reached_radius(self) -> float:
        """Contact radius of the committed state."""
        return self.surface.contact * self.annuli.width

    def start(self) -> bool:
        """Make the start state, glassy or relaxed; whether there is one."""
        material, penetration = self.scene.material, self.scene.loading.penetration
        relaxed = self.scene.loading.start == "relaxed"
        elastic = Chain(Material(material.modulus if relaxed else material.glassy_modulus, material.poisson))
        untouched = AnnuliState.untouched(self.annuli, 0, penetration)
        candidates = ContactCandidates(
            self.annuli, elastic, untouched, 0.0, "penetration", penetration, self.counters
        )
        contact = equilibrium_contact(candidates, self.most, self.most, self.capped, self.work)
        if contact is None or (contact == 0 and self.work > 0.0):
            return False
        if self.work > 0.0 and contact <= self.annuli.zone:
            raise zone_too_long(self.annuli.zone * self.annuli.width, contact * self.annuli.width)
        surface = candidates.state(contact, 0.0)
        strains = np.outer(surface.load, self.chain.compliances * (1.0 if relaxed else 0.0))
        energies = _Energies.at_start(self.chain, self.annuli, surface, relaxed)
        self._commit(replace(surface, strains=strains), energies)
        return True

    def follow(self, interval: LoadingInterval, report: Callable[[float], None]) -> Outcome | None:
        """Take the run through an interval in equal steps; an outcome if it ends there."""
        count = step_count(self.scene, interval, self.options, self.largest, self.length)
        self.record.kink()
        for index in range(1, count + 1):
            time = self.surface.time
            outcome = interruption(self.monitor, time) or budget_outcome(
                self.counters, self.options.max_steps, time
            )
            if outcome is not None:
                return outcome
            outcome = self._step(
                interval, interval.length if index == count else interval.length * index / count
            )
            report(self.surface.time)
            if outcome is not None:
                return outcome
        return None

    def _step(self, interval: LoadingInterval, parameter: float) -> Outcome | None:
        """Commit the equilibrium at a parameter of an interval; an outcome if the run ends with it.

        An edge that travels more than a process zone in a step is recorded as unstable. A contact that would
        become shorter than the zone ends with that length.
        """
        before, zone, adhesive = self.surface, self.annuli.zone, self.work > 0.0
        candidates, contact = self._equilibrium(interval, parameter)
        if contact is None:
            return Outcome(OutcomeKind.OUT_OF_RANGE, "the contact spreads beyond the annuli", before.time)
        time, value = interval.time(parameter), interval.prescribed(parameter)
        if contact == 0 < before.contact and adhesive and not interval.jump:
            last = self._last_contact(interval, parameter)
            if last is not None:
                time, contact = interval.time(last), zone
                candidates, _ = self._equilibrium(interval, last)
        lost = contact == 0 < before.contact
        below_zone = adhesive and 0 < contact <= zone
        if below_zone:
            contact = zone
        if lost or (adhesive and abs(contact - before.contact) > zone and not below_zone):
            self.record.event("snap-in" if contact > before.contact else "pull-off")
        if lost and adhesive:
            reason = f"no stable contact at {interval.control} {value:.6g}"
            return Outcome(OutcomeKind.DETACHED, reason, before.time)
        if contact == 0 and not lost and interval.control == "force" and value < 0.0:
            return Outcome(OutcomeKind.DETACHED, "pulled without contact", before.time)
        surface = candidates.state(contact, time)
        self._commit(surface, self.energies.after(self.chain, self.annuli, before, surface))
        self.counters.steps += 1
        if below_zone:
            return below_zone_outcome(self.record.forces, time)
        return Outcome(OutcomeKind.DETACHED, "the contact area fell to zero", time) if lost else None

    def _equilibrium(
        self, interval: LoadingInterval, parameter: float
    ) -> tuple[ContactCandidates, int | None]:
        """The contacts possible at a parameter, and the annuli in the stable one, if there is any."""
        before, value = self.surface, interval.prescribed(parameter)
        duration = 0.0 if interval.jump else interval.time(parameter) - before.time
        candidates = ContactCandidates(
            self.annuli, self.chain, before, duration, interval.control, value, self.counters
        )
        return candidates, equilibrium_contact(candidates, before.contact, self.most, self.capped, self.work)

    def _last_contact(self, interval: LoadingInterval, parameter: float) -> float | None:
        """Where in a step that loses it the contact is last in equilibrium.

        ``None`` if it is longer there than the process zone, by more than the annulus that is the accuracy of
        an edge: then it is lost at a limit point.
        """
        low, high = self.surface.time - interval.start, parameter
        contact = self.surface.contact
        for _ in range(_HALVINGS):
            middle = 0.5 * (low + high)
            reached = self._equilibrium(interval, middle)[1]
            if reached:
                low, contact = middle, reached
            else:
                high = middle
        return low if contact <= self.annuli.zone + 1 else None

    def _commit(self, surface: AnnuliState, energies: _Energies) -> None:
        """Take a state as the new committed one, and record its row."""
        if not (math.isfinite(surface.force) and math.isfinite(surface.penetration)):
            raise FloatingPointError("force or penetration is not finite")
        self.surface, self.energies = surface, energies
        row = (*self.reached(), self.reached_radius(), energies.stored(self.chain))
        self.record.rows.append((*row, energies.dissipated, surface.stress_intensity))

    def record_profile(self) -> None:
        """Record the surface at the collocation radii, as far as the annuli reach."""
        annuli, surface, contact = self.annuli, self.surface, self.surface.contact
        pressure = np.zeros(annuli.count)
        pressure[:contact] = surface.scaled / annuli.width
        displacement = surface.displacement(self.chain)
        gap = annuli.heights - surface.penetration + displacement
        gap[:contact] = 0.0
        reached, radius = self.reached(), self.reached_radius()
        self.record.profile(SurfaceProfile(*reached, radius, annuli.radii, pressure, displacement, gap))
