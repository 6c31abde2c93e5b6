"""What needles and the outline would add to star sizes as unknowns of a fit, to first order.

python -m benchmarks.fit_unknowns [NAME ...]

At the end of a fit by the preview, the residuals are linear in small changes: of the star sizes, of the places of
needles or of the corners of a held border, and of smooth normal offsets of the outline. The table has the distance that
one further step would leave, with the star sizes alone and with each of the others beside them, in % of the diameter.
The weights of the fit hold the sizes, `UNKNOWN_WEIGHT` holds the others near to their places. Derivatives by needles
are linear responses of the preview, those by the outline are differences of two previews.
"""

from __future__ import annotations

import argparse
from typing import Any

import numpy as np

from asterism.equilibrium.arrays import Floats
from asterism.fitting.bounded_step import bounded_step
from asterism.fitting.first_guess import FirstGuess, guess_design
from asterism.fitting.residual import FitPlaces, Residual
from asterism.fitting.search import CHANGE_WEIGHT, NEIGHBOUR_WEIGHT, FitSearch
from asterism.fitting.star_unknowns import StarUnknowns
from asterism.pattern.design.design import Design
from asterism.pattern.geometry.planar import inside
from asterism.pattern.layout.build import layout
from asterism.previews.default_law import paper_law
from asterism.previews.session import Preview
from asterism.shape.cell_mean import CellMean
from benchmarks.chosen_names import chosen_names
from benchmarks.fit_targets import TARGETS
from benchmarks.report import markdown, write_report

ROWS = ("cap 45 deg", "ellipsoid dome", "three-legged shell", "barrel", "saddle", "two bumps")
# mm, moves for the differences
NEEDLE_STEP_MM, OUTLINE_STEP_MM = 0.2, 0.4
# mm per mm of a needle, or of an amplitude of the outline; and mm, their largest change
UNKNOWN_WEIGHT, LARGEST_MOVE_MM = 0.05, 1.0
# waves of the offsets around the outline, besides a constant one
OUTLINE_WAVES = 4
DAMPING = 1e-4
HEADER = [
    "target",
    "stars, held by",
    "fit",
    "one step more, star sizes",
    "and needles or border",
    "largest move, rms mm",
    "and outline",
    "largest offset mm",
]


class FinishedFit:
    """A fit by the preview at its end, with the derivatives of its residuals."""

    def __init__(self, name: str) -> None:
        make, needles = TARGETS[name]
        self.target, self.law = make(), paper_law()
        self.guess: FirstGuess = guess_design(self.target, self.law, None, needles)
        self.plan = layout(self.guess.design)
        self.places = FitPlaces.of(self.guess.target_map, self.plan.outline, self.plan.lattice_vectors)
        unknowns = StarUnknowns.of(self.plan, self.guess.menu)
        self.residual = Residual(self.target, self.places, False)
        self.search = FitSearch(self.guess.design, self.law, self.residual, self.target.diameter_mm, unknowns)
        self.search.run()
        self.design = self.search.best.design(self.guess.design)
        self.values = self.search.state.values
        # the derivatives by needles edit the preview
        self.by_sizes = self.search._jacobian()
        self.sizes_at = self.search.best.difference(self.search.start)
        self.limits = self.search._bounds()

    def percent(self, values: Floats) -> float:
        """Rms distance of residuals along the normal, in % of the diameter."""
        return float(100.0 * np.linalg.norm(values[::3]) / self.target.diameter_mm)

    def by_needles(self) -> Floats:
        """(3 n, 3 k) derivatives of the residuals by the places of needles, or of corners of a held border."""
        columns = []
        for place in range(3 * len(self.design.pins[0].target_mm or ())):
            table = self.design.to_dict()
            table["pins"][0]["target_mm"][place // 3][place % 3] += NEEDLE_STEP_MM
            moved = next(self.search.preview.edit(Design.from_dict(table)))
            after = self.residual.at(self.search.preview, moved.x).values
            columns.append((after - self.values) / NEEDLE_STEP_MM)
        return np.column_stack(columns)

    def by_outline(self) -> Floats:
        """(3 n, m) derivatives of the residuals by smooth normal offsets; needles stay at their places on the rim."""
        ring = self.plan.outline
        sides = np.linalg.norm(np.roll(ring, -1, axis=0) - ring, axis=1)
        turn = 2.0 * np.pi * np.concatenate([[0.0], np.cumsum(sides)[:-1]]) / sides.sum()
        waves = range(1, OUTLINE_WAVES + 1)
        modes = [np.ones(len(ring)), *(wave(k * turn) for k in waves for wave in (np.cos, np.sin))]
        before = self._with_outline(np.zeros(len(ring)))
        inwards = [self._with_outline(-OUTLINE_STEP_MM * mode) for mode in modes]
        return np.column_stack([(before - after) / OUTLINE_STEP_MM for after in inwards])

    def _with_outline(self, offset: Floats) -> Floats:
        """Residuals of a fresh preview whose outline is moved along its normal (B,) mm."""
        ring, places, target_map = self.plan.outline, self.places, self.guess.target_map
        along = np.roll(ring, -1, axis=0) - np.roll(ring, 1, axis=0)
        normal = np.column_stack([along[:, 1], -along[:, 0]]) / np.linalg.norm(along, axis=1)[:, None]
        corners = ring + offset[:, None] * normal
        table = self.design.to_dict()
        table["border"]["polygon_mm"] = corners.tolist()
        held = table["pins"][0].get("corners", range(len(ring)))
        table["pins"][0]["target_mm"] = target_map.places(corners[list(held)]).tolist()
        fine = places.points[places.count :]
        fine = fine[inside(fine, ring - 1.5 * OUTLINE_STEP_MM * normal)]
        points = np.concatenate([places.points[: places.count - len(ring)], corners, fine])
        shares = np.concatenate([np.full(places.count, 1e-9), np.ones(len(fine))])
        mean = CellMean(points, shares, self.plan.lattice_vectors, np.arange(places.count))
        moved = FitPlaces(points, places.count, target_map.places(points), places.slide_weight, mean)
        return Residual(self.target, moved, False).at(Preview(Design.from_dict(table), self.law)).values

    def step(self, others: Floats) -> tuple[float, Floats]:
        """% of the diameter after one step of the sizes and of other unknowns (3 n, m), and the step (m,) of those."""
        count, more = self.by_sizes.shape[1], others.shape[1]
        columns = np.hstack([self.by_sizes, others])
        weight = UNKNOWN_WEIGHT**2 * np.eye(count + more)
        rough = self.search.start.roughness().toarray()
        weight[:count, :count] = NEIGHBOUR_WEIGHT**2 * rough + CHANGE_WEIGHT**2 / count * np.eye(count)
        normal = columns.T @ columns + weight
        normal += DAMPING * float(np.diag(normal).max()) * np.eye(len(normal))
        gradient = columns.T @ self.values + weight @ np.concatenate([self.sizes_at, np.zeros(more)])
        low, high = (np.concatenate([end, np.full(more, sign * LARGEST_MOVE_MM)])
                     for sign, end in zip((-1.0, 1.0), self.limits, strict=True))  # fmt: skip
        step = bounded_step(normal, gradient, low, high)
        return self.percent(self.values + columns @ step), step[count:]


def row(name: str) -> dict[str, Any]:
    """The predictions for one target."""
    fit = FinishedFit(name)
    pins = fit.design.pins[0]
    outline, offsets = fit.step(fit.by_outline())
    needles, moves = fit.step(fit.by_needles())
    return {
        "row": name,
        "stars": len(fit.plan.centres),
        "held_by": "border" if pins.where else f"{len(pins.corners or ())} needles",
        "fit_percent": fit.percent(fit.values),
        "sizes_percent": fit.step(np.empty((len(fit.values), 0)))[0],
        "needles_percent": needles,
        "largest_move_mm": float(np.abs(moves).max()),
        "rms_move_mm": float(np.sqrt((moves**2).mean())),
        "outline_percent": outline,
        "largest_offset_mm": float(np.abs(offsets).max()),
    }


def cells(data: dict[str, Any]) -> list[str]:
    """One line of the table."""
    return [
        data["row"],
        f"{data['stars']}, {data['held_by']}",
        *(f"{data[key]:.3f}" for key in ("fit_percent", "sizes_percent", "needles_percent")),
        f"{data['largest_move_mm']:.2f}, {data['rms_move_mm']:.2f}",
        f"{data['outline_percent']:.3f}",
        f"{data['largest_offset_mm']:.2f}",
    ]


def main() -> None:
    """Compute the rows; the report has those that are done."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("names", nargs="*", metavar="NAME")
    done: list[dict[str, Any]] = []
    for name in chosen_names(parser, parser.parse_args().names, ROWS):
        done.append(row(name))
        print(*cells(done[-1]), sep=" | ", flush=True)
        write_report("fit_unknowns", done, markdown(HEADER, [cells(data) for data in done]))


if __name__ == "__main__":
    main()
