"""How far a force moves an equilibrium, along itself: one solve with the factor at hand."""

from __future__ import annotations

from equilibrium.linear.factor import Factor
from fem.elements.tabulation import Floats
from fem.shell.shell import Shell


def compliance(shell: Shell, x: Floats, factor: Factor, forces: Floats) -> float:
    """`f H^-1 f`: small loads s f, f (N, 3) N on the dofs, do the work s^2 times this, in N mm, at the equilibrium x.

    Half of it is elastic energy, so that with an energy E the loads can move their places by `sqrt(2 E f H^-1 f)`,
    measured along f. The factor holds the Hessian H at x (N, 3). What of the loads would move the sheet as a whole,
    where nothing stops that, is left out.
    """
    load, rigid = shell.restrict(forces), shell.rigid_modes(x)
    load = load - rigid @ (rigid.T @ load)
    return float(load @ factor.solve(load))
