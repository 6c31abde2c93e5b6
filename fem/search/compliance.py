"""Compliance of an equilibrium under a load: one solve with its factorised Hessian."""

from __future__ import annotations

from asterism.equilibrium.arrays import Floats
from asterism.equilibrium.linear.factor import Factor
from asterism.fem.shell.shell import Shell


def compliance(shell: Shell, x: Floats, factor: Factor, forces: Floats) -> float:
    """`f . H^-1 f` in N mm: the work of small loads s f, with f (N, 3) N on the dofs, is s^2 times this.

    Half of the work is elastic energy. So a disturbance of energy E moves the loaded points by up to
    `sqrt(2 E f . H^-1 f)` along f. The factor holds the Hessian H at the equilibrium x (N, 3). The part of the loads
    along free rigid motions is left out.
    """
    load, rigid = shell.restrict(forces), shell.rigid_modes(x)
    load = load - rigid @ (rigid.T @ load)
    return float(load @ factor.solve(load))
