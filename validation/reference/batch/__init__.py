"""Many scenes at once: the path of the edge, stepped from radius to radius on a grid that all of them share.

This is the method of :mod:`validation.reference.path`, not a fourth opinion: the same closure of the same
Prony elements in Abel space, and its kernel. What differs is who chooses the steps. There the loop does, for
one scene; here a grid of travels ``g``, in process zones since the edge set off, is the same for all scenes,
even in the root of the travel where the edge sets off and where the fields it set off with leave the zone
(``g = 1``), and coarser by a ratio from there on. At a given travel quadrature points, passing order and
interpolation do not depend on the scene, so a step costs one set-up shared by all, and each scene a root in
one scalar: the time at which its edge gets there.

With ``v`` the share of the zone, ``x = a - d (1 - v)`` behind and ``y = a + d v`` ahead of the edge, and the
openings ``D - G(y)`` less than ``w(y)``,

    I = -(1/pi^2) int_0^1 (w(y) - D + G(y)) (alpha(t) M(v) - Einf0 N(v)) dv

where ``M`` and ``N`` are what the closure makes of the stresses ``1`` and ``G(x)`` behind the edge, and
``alpha = E0 D + sum_k b_k(t)``. What the edge has let go recovers by itself,

    w(y, t) = sum_j (A_j(t_r) - J_j E0 G(y)) exp(-(t - t_r)/theta_j),    A_j = J_j E0 D + sum_k U_kj b_k,

with the time ``t_r(y)`` at which it was passed. ``t_r`` and ``A_j`` are polynomials over the rows, the last
of which is unknown: one more evaluation is as many exponentials as points, and sums. An edge that closes is
the same with sides exchanged: ``b_k = E_k M_k + E_k (D - M_k - G)(t_c) exp(-(t - t_c)/tau_k)`` behind it,
where it covered at ``t_c`` what was never touched. What it leaves is tabled where it comes to rest, at depths
that all scenes share. It has a corner at the place from which the edge closed, at another travel of each
scene: there rows are those of a second grid, whose travels count from the corner, the first of them read off
the rows before. An error is the change from half as many rows of coarser quadrature.
"""

from validation.reference.batch.solver import Solution, refusal, solve

__all__ = ["Solution", "refusal", "solve"]
