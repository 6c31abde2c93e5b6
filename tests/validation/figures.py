"""The sheets of the paper's figures by both models, and what is looked at in them."""

from __future__ import annotations

from functools import cache

import numpy as np

from asterism.equilibrium.arrays import Floats
from asterism.exact.simulation import exact_shape
from asterism.homogenize.campaign.campaign import SampleRecord
from asterism.homogenize.campaign.design_plan import plan_for_design
from asterism.homogenize.campaign.fit_law import fit_law
from asterism.homogenize.cell.sample import solve_cell
from asterism.homogenize.law.law import Law
from asterism.pattern import gallery
from asterism.pattern.design.design import Design
from asterism.pattern.layout.build import layout
from asterism.pattern.layout.symmetries import symmetries
from asterism.previews.session import preview
from asterism.shape.comparison import Comparison, compare_shapes
from asterism.shape.shape import Shape

EDGE = 3.5  # mm, of the exact model's meshes
MIDDLE = 20.0  # mm of print around the middle


def figure(name: str) -> Design:
    """A design of the gallery with the paper's hinges, on a coarse mesh."""
    data = gallery.load(name).to_dict()
    if data["fabric"]["bending"] != "none":
        data["fabric"] |= {"bending": "paper"}
    return Design.from_dict(data | {"mesh": data["mesh"] | {"edge_mm": EDGE}})


@cache
def both(name: str) -> Comparison:
    """Exact model, the reference, and preview."""
    return compared(name, None)


def compared(name: str, law: Law | None) -> Comparison:
    """The same with a law of one's own."""
    design = figure(name)
    plan = layout(design)
    return compare_shapes(
        exact(name), shown(name) if law is None else preview(design, law), plan, symmetries(design, plan)
    )


@cache
def shown(name: str) -> Shape:
    return preview(figure(name))


@cache
def exact(name: str) -> Shape:
    return exact_shape(figure(name))


def middles(found: Comparison, within: float = MIDDLE) -> tuple[Floats, Floats]:
    """Principal curvatures (2,) per mm of the cell means, exact and preview, the larger one first.

    Those of the middle, `within` so many mm of the print.

    Positive where the sheet curls more: the sign of the larger one is taken out.
    """
    printed = found.reference.printed
    near = np.linalg.norm(printed, axis=1) < within
    return _curvatures(printed[near], found.reference_mean[near]), _curvatures(printed[near], found.other_mean[near])


def middle(shape: Shape) -> Floats:
    """(2,) of one shape, bumps and all."""
    near = np.linalg.norm(shape.printed, axis=1) < MIDDLE
    return _curvatures(shape.printed[near], shape.positions[near])


def _curvatures(printed: Floats, places: Floats) -> Floats:
    """(2,) of the quadratic surface nearest to n places (n, 3) over printed points (n, 2)."""
    x, y = printed.T
    table = np.column_stack([np.ones_like(x), x, y, x * x / 2, x * y, y * y / 2])
    first = np.linalg.lstsq(table, places, rcond=None)[0]
    slope, bend = first[1:3], first[3:]
    normal = np.cross(slope[0], slope[1])
    xx, xy, yy = bend @ (normal / np.linalg.norm(normal))
    both = np.linalg.eigvals(np.linalg.solve(slope @ slope.T, np.array([[xx, xy], [xy, yy]]))).real
    both = both[np.argsort(-np.abs(both))]
    return np.asarray(both * np.sign(both[0]))


def profile(found: Comparison, radii: Floats) -> tuple[Floats, Floats]:
    """Heights of the cell means over the print's radius (R,) mm, from 1 in the middle to 0 at the border."""
    radius = np.linalg.norm(found.reference.printed, axis=1)
    out = []
    for mean in (found.reference_mean, found.other_mean):
        z = mean[:, 2] * np.sign(mean[radius < 5.0, 2].mean() - mean[radius > 50.0, 2].mean())
        ring = np.array([z[np.abs(radius - r) < 4.0].mean() for r in radii])
        out.append((ring - ring[-1]) / (ring[0] - ring[-1]))
    return out[0], out[1]


def bumps(shape: Shape) -> Floats:
    """(S,) mm, star centres over the mean of their tips, towards the plastic."""
    tips: dict[int, list[int]] = {}
    for path in shape.rods:
        tips.setdefault(int(shape.star[path[0]]), []).append(int(path[-1]))
    out = np.zeros(len(shape.star_vertices))
    for star, centre in enumerate(shape.star_vertices):
        ends = sorted(tips[star], key=lambda v: np.arctan2(*(shape.printed[v] - shape.printed[centre])[::-1]))
        a, b, c = shape.positions[ends]
        normal = np.cross(b - a, c - a)
        out[star] = (shape.positions[centre] - (a + b + c) / 3.0) @ normal / np.linalg.norm(normal)
    return out


def contractions(found: Comparison, shape: Shape) -> tuple[Floats, Floats]:
    """(P,) distance of neighbouring star centres over the printed one, and (P, 2) mm, where on the print."""
    pairs, printed = found.layout.sample_pairs, found.layout.centres
    now, before = (
        np.linalg.norm(c[pairs[:, 0]] - c[pairs[:, 1]], axis=1) for c in (shape.positions[shape.star_vertices], printed)
    )
    return now / before, printed[pairs].mean(axis=1)


@cache
def own_law(name: str) -> Law:
    """The law of a design's own stars, from cells on the design's mesh."""
    plan = plan_for_design(figure(name), edge_mm=EDGE)
    records = []
    for task in plan.tasks():
        found = solve_cell(plan.cell_design(task), plan.edge_mm)
        records.append(SampleRecord(task, plan.label(task), found.to_dict(), None, False, 0.0))
    return fit_law(plan, records)
