"""Energies of the paper scheme, exact for its discrete fields.

The quadratic forms of ``energy`` (Y, X_k, W_k: products of a displacement field with the pressures behind
another) follow a step without approximation, since a step makes each new branch field a combination of three
known ones, ``e_k = alpha e_k before + beta v before + gamma v after``. The work a branch receives is taken
with the pressure at the end of the step, as backward Euler does: with that scheme no step then dissipates
less than nothing.
"""

from __future__ import annotations

import numpy as np

from bem_solver.creep import Chain
from bem_solver.energy import Energies, initial_energies
from bem_solver.paper_scheme.annuli import AnnuliState, UniformAnnuli, step_factors


def start_energies(chain: Chain, annuli: UniformAnnuli, surface: AnnuliState, relaxed: bool) -> Energies:
    """Energies of the start state.

    Parameters
    ----------
    chain : Chain
    annuli : UniformAnnuli
    surface : AnnuliState
    relaxed : bool
        Whether the start state is the relaxed equilibrium rather than the glassy one.

    Returns
    -------
    Energies
    """
    load_work = float(annuli.forces(surface.scaled) @ surface.load[: surface.contact])
    return initial_energies(chain, load_work, relaxed)


def step_energies(
    chain: Chain, annuli: UniformAnnuli, energies: Energies, before: AnnuliState, after: AnnuliState
) -> Energies:
    """Energies after a step.

    Parameters
    ----------
    chain : Chain
    annuli : UniformAnnuli
    energies : Energies
        Before the step.
    before, after : AnnuliState

    Returns
    -------
    Energies
    """
    factors = step_factors(chain, after.time - before.time)
    forces, n = annuli.forces(after.scaled), after.contact
    load_work, branch_work = float(forces @ after.load[:n]), forces @ after.strains[:n]
    load_before, branch_before = float(forces @ before.load[:n]), forces @ before.strains[:n]
    energy = (
        factors.decay**2 * energies.branch_energy
        + factors.before**2 * energies.load_work
        + factors.after**2 * load_work
        + 2.0 * factors.decay * factors.before * energies.branch_work
        + 2.0 * factors.decay * factors.after * branch_before
        + 2.0 * factors.before * factors.after * load_before
    )
    gained = 0.5 * (energy - energies.branch_energy) / chain.compliances
    lost = float(np.sum(branch_work - branch_before - gained))
    return Energies(load_work, branch_work, energy, energies.dissipated + lost)
