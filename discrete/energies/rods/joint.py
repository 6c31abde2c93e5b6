"""Joints of rods: half an edge of each rod bends and twists between its end and a rotation that all rods share.

A joint has a frame R, a rotation that is an unknown of the model. Half an edge of printed direction a leaves the joint
along `R a` with the normal `R e_z` on its plastic side, and bends and twists into the edge:

    W = (B (k_b - k_b0)^2 + C k_n^2 + T (m - m0)^2)/l

with the stiffnesses B about the width, C in the plane of the sheet and T of torsion, the printed length l of the whole
edge, and half its rest angle `k_b0 = kappa l/2` and rest twist m0. Curvatures k_b, k_n and twist m are those of `bend`
and `twist`, for the stencil of `R a` and the edge. Half edges in series share the angle of a stencil: with two of them
in one line, R settles in the middle, and the sum is the energy of one stencil over both edges.
"""

from __future__ import annotations

import numpy as np

from asterism.discrete.energies.elements import Elements
from asterism.discrete.energies.kernel import combine, cross, formula, point, sub, sweep
from asterism.discrete.energies.rods.rod import (
    bend_energy,
    bend_gradient,
    bend_hessian,
    twist_energy,
    twist_gradient,
    twist_hessian,
)


@formula
def _start(q, p):  # type: ignore[no-untyped-def]
    """Direction `R a` of the half edge at the joint."""
    along, normal = point(q, 3), point(q, 4)
    return combine(p[4], along, p[5], cross(normal, along))


@formula
def _stencil(q, start):  # type: ignore[no-untyped-def]
    """Coordinates and directors of the stencil: a unit edge along `start` into the joint, then the edge of the rod."""
    x0 = point(q, 0)
    return sub(x0, start) + x0 + point(q, 1) + point(q, 4) + point(q, 2)


@formula
def _bend_params(p):  # type: ignore[no-untyped-def]
    return (p[0], p[1], p[3], 0.0 * p[3], 0.0 * p[3] + 1.0, p[6])


@formula
def _twist_params(p):  # type: ignore[no-untyped-def]
    return (p[2], 0.0 * p[2] + 1.0, p[6], p[7])


@formula
def joint_energy(q, p):  # type: ignore[no-untyped-def]
    """Energy of half an edge in N mm.

    q = (joint, other end, director, R e_x, R e_z), p = (B/l, C/l, T/l, k_b0, a_x, a_y, sign, m0).
    """
    stencil = _stencil(q, _start(q, p))
    return bend_energy(stencil, _bend_params(p)) + twist_energy(stencil, _twist_params(p))


@formula
def _stencil_gradient(stencil, p, g):  # type: ignore[no-untyped-def]
    """Gradient (11,) by the coordinates and twists of the stencil; g gives its type only."""
    bend, twist = np.zeros((11, *g.shape[1:]), g.dtype), np.zeros((11, *g.shape[1:]), g.dtype)
    bend_gradient(stencil, _bend_params(p), bend)
    twist_gradient(stencil, _twist_params(p), twist)
    return bend + twist


@formula
def joint_gradient(q, p, g):  # type: ignore[no-untyped-def]
    """Gradient by both ends, the twist of the edge and the spin of the joint."""
    start = _start(q, p)
    d = _stencil_gradient(_stencil(q, start), p, g)
    # a spin w moves the start of the stencil by -w x (R a) and turns its director by w . (R a)
    spin = cross((d[0], d[1], d[2]), start)
    for i in range(3):
        g[i] = d[i] + d[3 + i]
        g[3 + i] = d[6 + i]
        g[7 + i] = spin[i] + d[9] * start[i]
    g[6] = d[10]


@formula
def joint_hessian(q, p, blend, h):  # type: ignore[no-untyped-def]
    """The Hessian of the stencil in the coordinates of the joint, and the second order of a spin."""
    start = _start(q, p)
    stencil = _stencil(q, start)
    bend, twist = np.zeros((11, 11, *h.shape[2:]), h.dtype), np.zeros((11, 11, *h.shape[2:]), h.dtype)
    bend_hessian(stencil, _bend_params(p), blend, bend)
    twist_hessian(stencil, _twist_params(p), blend, twist)
    # motion of the stencil's coordinates and twists by those of the joint
    motion = np.zeros((11, 10, *h.shape[2:]), h.dtype)
    for i in range(3):
        motion[i, i] += 1.0
        motion[3 + i, i] += 1.0
        motion[6 + i, 3 + i] += 1.0
        motion[9, 7 + i] += start[i]
        j, k = (i + 1) % 3, (i + 2) % 3
        motion[j, 7 + k] -= start[i]
        motion[k, 7 + j] += start[i]
    motion[10, 6] += 1.0
    for c in range(10):
        column = np.zeros((11, *h.shape[2:]), h.dtype)
        for i in range(11):
            for j in range(11):
                # only the lower triangles are filled
                hi, lo = max(i, j), min(i, j)
                column[i] += (bend[hi, lo] + twist[hi, lo]) * motion[j, c]
        for r in range(c, 10):
            value = column[0] * motion[0, r]
            for i in range(1, 11):
                value = value + column[i] * motion[i, r]
            h[r, c] = value
    d = _stencil_gradient(stencil, p, h[0])
    # a spin moves `R a` to second order by w x (w x R a)/2
    half = 0.5 * (1.0 - blend)
    for r in range(3):
        for c in range(3):
            h[7 + r, 7 + c] -= half * (d[r] * start[c] + start[r] * d[c])


class RodJoint(Elements):
    """Bending and twist of the half edges at joints.

    Parameters
    ----------
    inputs : (H, 15) coordinates of the joint and of the edge's other end, the edge's director, and the images `R e_x`
        and `R e_z` of the joint's frame.
    dofs : (H, 10) coordinates of both ends, twist of the edge, spin of the joint (rotation vector in space).
    params : (H, 8) B/l, C/l and T/l (N mm), half the rest angle k_b0 (rad), the printed unit direction (a_x, a_y) from
        the joint along the edge, -1 if the edge runs towards the joint, else 1, and half the rest twist m0 (rad).

    An edge that leaves its joint at an angle of 0.1 rad out of the sheet, B/l = 5 N mm:

    >>> params = np.array([[5.0, 50.0, 5.0, 0.0, 1.0, 0.0, 1.0, 0.0]])
    >>> joint = RodJoint(np.arange(15)[None], np.arange(10)[None], params)
    >>> c, s = np.cos(0.1), np.sin(0.1)
    >>> ends, director, frame = [0, 0, 0, c, 0, -s], [s, 0, c], [1, 0, 0, 0, 0, 1]
    >>> joint.energies(np.array([*ends, *director, *frame])).round(3)
    array([0.05])
    """

    formulas = (joint_energy, joint_gradient, joint_hessian)
    sweep = staticmethod(sweep(15, 10, *formulas))
