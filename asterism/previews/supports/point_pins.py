"""What gives way around a pin that holds a single point.

A membrane that is pulled at a point gives way by the logarithm of its size over that of the spot where it is held, and
without end where that is nothing. The exact model holds a vertex, a spot of some part of its triangles' edge h; the
shell's triangles have edges L that are twenty times longer, and pull at a larger spot. A wedge of angle alpha that is
pulled at its tip (Michell 1900; E t is Young's modulus times thickness, R how far away it is held) moves by u:

    exact     u K / F = ln(R/h) + c(alpha),                      K = E t (alpha + sin alpha)/2
    shell     u K / F = ln(R/L) + d(alpha) + A g(alpha),

A of a softer spot in which the stiffness to stretching is divided by `1 + A exp(-r^2/(p L)^2)`. Both models give the
same u for `A = (ln(L/h) - (d - c))/g`. The numbers come from wedges in both models, by
`python -m benchmarks.point_pins`.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from asterism.previews.fields.stretched_fabric import stretched_fabric
from asterism.previews.model import PREVIEW_MODEL, PreviewModel
from fem.elements.tabulation import Floats, Ints
from fem.shell.density import Density
from fem.shell.fields import Fields
from pattern.geometry.planar import triangle_angles
from pattern.mesh.coarse.sheet_mesh import SheetMesh

MIN_SOFTNESS = -0.5  # a spot is at most twice as stiff as the sheet


def softness(
    mesh: SheetMesh, pins: Floats, points: Floats, edge_mm: float, model: PreviewModel = PREVIEW_MODEL
) -> Floats:
    """(...,) by how much, over 1, the stiffness to stretching is divided at printed points (..., 2).

    Parameters
    ----------
    pins : (n, 2) mm, among the points of the mesh.
    edge_mm : of the exact model's mesh.
    """
    edges, angles = around(mesh, pins)
    amounts = amounts_of(edges, angles, edge_mm, model)
    total = np.zeros(points.shape[:-1])
    for pin, edge, amount in zip(pins, edges, amounts, strict=True):
        total += amount * spot(pin, edge, points, model)
    return np.maximum(total, MIN_SOFTNESS)


def spot(pin: Floats, edge_mm: float, points: Floats, model: PreviewModel = PREVIEW_MODEL) -> Floats:
    """(...,) how much of the softness at a pin (2,) there is at points (..., 2)."""
    square = ((points - pin) ** 2).sum(axis=-1)
    return np.asarray(np.exp(-square / (model.point_spot_radius * edge_mm) ** 2))


def amounts_of(edges: Floats, angles_deg: Floats, edge_mm: float, model: PreviewModel = PREVIEW_MODEL) -> Floats:
    """(n,) the softness at pins with mean edges (n,) mm and angles (n,) of the sheet; negative where h is long."""
    lack, gain = (np.interp(angles_deg, model.point_angles_deg, of) for of in (model.point_lack, model.point_gain))
    return np.maximum((np.log(edges / edge_mm) - lack) / gain, MIN_SOFTNESS)


def around(mesh: SheetMesh, pins: Floats) -> tuple[Floats, Floats]:
    """(n,) mean length of the edges at pins (n, 2), the geometric one, in mm; and (n,) the sheet's angle there, deg."""
    corner_deg = triangle_angles(mesh.points, mesh.triangles)
    edges, angles = np.empty(len(pins)), np.empty(len(pins))
    for k, pin in enumerate(pins):
        vertex = int(((mesh.points - pin) ** 2).sum(axis=1).argmin())
        at: Ints = mesh.triangles == vertex
        others = np.setdiff1d(mesh.triangles[at.any(axis=1)], [vertex])
        edges[k] = np.exp(np.log(np.linalg.norm(mesh.points[others] - pin, axis=1)).mean())
        angles[k] = corner_deg[at].sum()
    return edges, angles


def with_point_softness(fields: Fields, soft: Floats, bare: Floats, model: PreviewModel = PREVIEW_MODEL) -> Fields:
    """The fields with the fabric's large strains, and softer to stretching by a softness (T, Q).

    `bare` (T, Q) is the share of the fabric that has no star.
    """
    density = fields.density
    assert isinstance(density, Density)
    stiffness = density.stiffness
    if model.has_point_softness:
        stiffness = softened(stiffness, 1.0 / (1.0 + soft))
    if not model.has_neo_hookean_fabric:
        return replace(fields, density=replace(density, stiffness=stiffness))
    return replace(
        fields, density=replace(density, stiffness=stiffness, term=stretched_fabric(fields, stiffness, bare))
    )


def softened(stiffness: Floats, part: Floats) -> Floats:
    """(..., 6, 6) with a part (...,) of the stiffness to stretching, and all of that to bending.

    Where the two are coupled, that to bending is what is left if the sheet may stretch as it likes.
    """
    membrane, both = stiffness[..., :3, :3], stiffness[..., :3, 3:]
    alone = np.zeros_like(stiffness)
    alone[..., 3:, 3:] = stiffness[..., 3:, 3:] - np.swapaxes(both, -1, -2) @ np.linalg.solve(membrane, both)
    share = part[..., None, None]
    return share * stiffness + (1.0 - share) * alone
