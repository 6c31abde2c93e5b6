"""The inverse crime of `python -m benchmarks.fit`: the target is the preview of another design of the same print."""

from __future__ import annotations

from typing import Any

import numpy as np

from asterism.equilibrium.arrays import Floats
from asterism.fitting.correction import ExactCorrection
from asterism.fitting.distance import target_distance
from asterism.fitting.flattening.boundary_first import FlatDisk
from asterism.fitting.residual import FitPlaces, Residual
from asterism.fitting.search import FitSearch
from asterism.fitting.star_menu import StarMenu
from asterism.fitting.star_unknowns import StarUnknowns
from asterism.fitting.target import TargetSurface
from asterism.fitting.target_map import TargetMap
from asterism.pattern.design.design import Design
from asterism.pattern.layout.build import layout
from asterism.pattern.layout.layout import Layout
from asterism.pattern.layout.painted_stars import with_painted_stars
from asterism.previews.default_law import paper_law
from asterism.previews.run import preview
from asterism.previews.session import Preview
from asterism.shape.cell_mean import CellMean
from asterism.verification.run import verify
from benchmarks.fit_targets import RINGS, round_mesh

RADIUS_MM, CORNERS, NEEDLES, SCALE = 56.0, 48, 16, 0.8
CORRECTIONS = 5


def own_shape(border: bool) -> dict[str, Any]:
    """Fit the shape of a design, with its outline, supports and scale given; sizes start from equal stars.

    Parameters
    ----------
    border : the border is held along its curve, in place of needles.
    """
    law, base = paper_law(), _print(border)
    plan = layout(base)
    true = _with_lengths(base, plan, _true_lengths(plan.centres))
    plane, triangles = round_mesh(RINGS)
    printed = 0.999 * RADIUS_MM * np.cos(np.pi / CORNERS) * plane
    shown = Preview(true, law).lens(printed)()
    weights = np.ones(len(printed))
    surface = shown.smooth + CellMean(printed, weights, plan.lattice_vectors)(shown.bumps)
    target = TargetSurface.of_triangles(surface, triangles, "own shape")
    # supports in the pose of the target
    where = _where(border)
    corner = plan.outline if border else plan.outline[where["corners"]]
    places = np.column_stack([SCALE * corner, np.zeros(len(corner))]) @ target.motion.T + target.shift_mm
    held = Design.from_dict(base.to_dict() | {"pins": [where | {"target_mm": places.tolist()}]})
    flat = TargetMap(FlatDisk(target.disk, printed, np.zeros(len(printed))), printed, plan.spacing_mm)
    fit_places = FitPlaces.of(flat, plan.outline, plan.lattice_vectors)
    unknowns = StarUnknowns.of(layout(held), StarMenu.of(law, 1.35, 1.2))
    search = FitSearch(held, law, Residual(target, fit_places, False), target.diameter_mm, unknowns)
    first = 100.0 * search.best_rms / target.diameter_mm
    search.run()
    found = 100.0 * search.best_rms / target.diameter_mm
    correction = ExactCorrection(search, target, plan.lattice_vectors)
    correction.run(held, CORRECTIONS)
    design = search.best.design(held)
    shape = preview(design, law)
    verification = verify(design, law, ready=shape, near=correction.exact)
    exact = verification.exact[verification.result]
    distance = target_distance(exact, target, fit_places, plan.lattice_vectors)
    return {
        "first_rms_percent": first,
        "preview_rms_percent": found,
        "exact_mean_percent": distance.mean_percent,
        "exact_largest_percent": distance.largest_percent,
        "exact_is_minimum": bool(exact.summary["is_minimum"]),
        "corrections": [vars(step) for step in correction.done],
    }


def _where(border: bool) -> dict[str, Any]:
    return {"where": "border"} if border else {"corners": list(range(0, CORNERS, CORNERS // NEEDLES))}


def _print(held: bool) -> Design:
    turn = 2.0 * np.pi * np.arange(CORNERS) / CORNERS
    ring = RADIUS_MM * np.column_stack([np.cos(turn), np.sin(turn)])
    pins = [_where(held) | {"scale": SCALE}]
    stars = {"length_mm": 8.0, "thickness_mm": 0.45, "width_mm": 1.2}
    border = {"polygon_mm": ring.tolist(), "star_margin_mm": 3.0}
    data = {"stars": stars, "border": border, "pins": pins, "mesh": {"edge_mm": paper_law().edge_mm}}
    return Design.from_dict(data)


def _true_lengths(centres: Floats) -> Floats:
    """(S,) mm, longer arms in the middle than at the rim, and a slope."""
    return np.asarray(10.0 - 4.0 * (np.linalg.norm(centres, axis=1) / RADIUS_MM) ** 2 + 0.02 * centres[:, 0])


def _with_lengths(base: Design, plan: Layout, lengths_mm: Floats) -> Design:
    sizes = np.full((len(lengths_mm), 3), np.nan)
    sizes[:, 0] = lengths_mm
    return with_painted_stars(base, plan.sites, sizes)
