"""The relief of a cell as its linear response to curvature, and a sheet that carries it.

A printed point X of a cell is at `w(X)` from the place of the mean surface that the mean deformation of the cell gives
it: two components along the sheet, in mm of the print, and the height. With the curvature tensor K of the contracted
sheet in print axes, positive where the plastic side is convex, the linear response is

    w = w_0 + w_1 (K11 + K22) + w_2 (K11 - K22) + w_3 2 K12,

with w_0 from the flat cell, and the others by least squares from its natural tubes in six directions.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.interpolate import LinearNDInterpolator

from asterism.equilibrium.arrays import Floats
from asterism.homogenize.cell.corrugation_waves import MAX_WAVE_NUMBER_RATIO, WAVE_TOLERANCE
from asterism.homogenize.cell.flat_cell import relax_flat_cell
from asterism.homogenize.cell.natural_curvature import TubeBranch, trace_tubes
from asterism.homogenize.cell.rolling import Tube, roll_cell, unroll
from asterism.homogenize.cell.unit_cell import ANCHOR, UnitCell
from asterism.pattern.design.design import Design
from asterism.previews.corrugation.bumps import flattening, support_factor
from asterism.previews.edges.free_rim import beside, stars_share
from asterism.previews.edges.supported_edge import SupportedEdge
from asterism.previews.fields.star_values import StarValues
from asterism.previews.sheet import Sheet
from asterism.previews.surface.places import Places
from asterism.previews.surface.smooth_surface import SmoothSurface, smooth_surface

NATURAL_DEG = (0.0, 30.0, 60.0, 90.0, 120.0, 150.0)  # six directions determine the response without favouring an arm


@dataclass(frozen=True)
class RolledRelief:
    """A cell on a tube, with the relief (P, 3) of its points.

    `degrees` is the angle of the direction around the tube from the print's y axis, `part` the curvature over the
    natural one, `curvature` that of the contracted sheet in 1/mm, `deformation` (2, 2) of the mean surface in print
    axes.
    """

    degrees: float
    part: float
    curvature: float
    deformation: Floats
    relief: Floats

    @property
    def components(self) -> Floats:
        """(3,) 1/mm: K11 + K22, K11 - K22, 2 K12."""
        twice = 2.0 * np.radians(self.degrees)
        return self.curvature * np.array([1.0, -np.cos(twice), -np.sin(twice)])


@dataclass(frozen=True)
class CellResponse:
    """The response of a cell: `fields` (4, P, 3) w_0 to w_3 at offsets (P, 2) mm from its star, and what made it.

    `weights` (P,) are shares of the printed area, `vectors` (2, 2) mm those of the lattice, `rolled` all tubes.
    """

    points: Floats
    weights: Floats
    vectors: Floats
    fields: Floats
    deformation: Floats
    rolled: Sequence[RolledRelief]

    @property
    def natural_curvature(self) -> float:
        """1/mm, mean over the directions."""
        return float(np.mean([abs(each.curvature) for each in self.rolled if each.part == 1.0]))

    def by_points(self, offsets: Floats) -> Floats:
        """(n, 4, 3) the fields at offsets (n, 2) mm, linear between the points of the cell's mesh."""
        shifts = np.array([[i, j] for i in range(-2, 3) for j in range(-2, 3)]) @ self.vectors
        points = (shifts[:, None] + self.points).reshape(-1, 2)
        own = self.fields.transpose(1, 0, 2).reshape(len(self.points), -1)
        away = offsets - np.rint(offsets @ np.linalg.inv(self.vectors)) @ self.vectors
        return np.asarray(LinearNDInterpolator(points, np.tile(own, (len(shifts), 1)))(away)).reshape(-1, 4, 3)

    def by_waves(self, offsets: Floats) -> Floats:
        """(n, 4, 3) the fields as sums of all waves as long as those of the law's corrugation, nearest to them."""
        span = np.arange(-6, 7)
        every = np.stack(np.meshgrid(span, span), axis=-1).reshape(-1, 2)
        every = every @ (2.0 * np.pi * np.linalg.inv(self.vectors).T)
        size = np.linalg.norm(every, axis=1)
        longest = MAX_WAVE_NUMBER_RATIO * size[size > WAVE_TOLERANCE].min() * (1.0 + WAVE_TOLERANCE)
        upper = (every[:, 1] > WAVE_TOLERANCE) | ((np.abs(every[:, 1]) < WAVE_TOLERANCE) & (every[:, 0] >= 0.0))
        kept = every[upper & (size < longest)]

        def waves(at: Floats) -> Floats:
            return np.hstack([np.cos(at @ kept.T), np.sin(at @ kept.T)])

        root, own = np.sqrt(self.weights)[:, None], self.fields.transpose(1, 0, 2).reshape(len(self.points), -1)
        amplitudes = np.linalg.lstsq(root * waves(self.points), root * own, rcond=None)[0]
        return np.asarray(waves(offsets) @ amplitudes).reshape(-1, 4, 3)


def cell_response(
    design: Design, edge_mm: float, parts: Sequence[float] = (), degrees: Sequence[float] = ()
) -> CellResponse:
    """The response of the cell of a design's star, and the cell at `parts` of the natural curvature as well.

    Parameters
    ----------
    degrees : directions that do not belong to the fit.
    """
    data = design.to_dict()
    sizes = {name: value for name, value in data["stars"].items() if name.endswith("_mm")}
    alone = {name: data[name] for name in ("fabric", "plastic", "lattice")} | {"stars": sizes, "border": {"rings": 1}}
    cell = UnitCell(Design.from_dict(alone), edge_mm)
    n, flat = cell.mesh.n_base, relax_flat_cell(cell)[0]
    rest = _relief(cell, flat.state.positions[:n], flat.deformation)
    rolled, known = [], None
    for angle in (*NATURAL_DEG, *degrees):
        branch = trace_tubes(cell, flat, np.radians(angle), known)
        known = known or branch
        rolled += _rolled(cell, branch, angle, (*parts, 1.0))
    cell.close()
    fitted = [each for each in rolled if each.part == 1.0 and each.degrees in NATURAL_DEG]
    response = np.linalg.lstsq(
        np.array([each.components for each in fitted]),
        np.array([(each.relief - rest).ravel() for each in fitted]),
        rcond=None,
    )[0]
    fields = np.concatenate([rest[None], response.reshape(3, n, 3)])
    points = cell.printed[:n] - cell.printed[ANCHOR]
    return CellResponse(points, cell.weights, cell.cell_vectors, fields, flat.deformation, rolled)


def _rolled(cell: UnitCell, branch: TubeBranch, degrees: float, parts: Sequence[float]) -> list[RolledRelief]:
    """The cell at parts of its natural curvature, of which it has one."""
    natural, out, tubes = branch.natural or branch.tubes[0], [], list(branch.tubes)
    for part in parts:
        near = min(tubes, key=lambda tube: abs(tube.curvature - part * natural.curvature))
        tube: Tube = natural
        if part != 1.0:
            tube = roll_cell(cell, unroll(cell, near), part * natural.curvature, np.radians(degrees))
        sheet, n = unroll(cell, tube), cell.mesh.n_base
        flat = np.column_stack([sheet.positions[:, :2] @ cell.turn, sheet.positions[:, 2]])
        deformation = np.linalg.solve(cell.cell_vectors, flat[n:, :2]).T
        relief = _relief(cell, flat[:n], deformation)
        out.append(RolledRelief(degrees, part, tube.contracted_curvature, deformation, relief))
    return out


def _relief(cell: UnitCell, unrolled: Floats, deformation: Floats) -> Floats:
    """(P, 3) mm, from the mean surface, along the sheet in mm of the print."""
    along = np.linalg.solve(deformation, unrolled[:, :2].T).T - cell.printed[: len(unrolled)]
    relief = np.column_stack([along, unrolled[:, 2]])
    return np.asarray(relief - cell.weights @ relief)


class ResponseLens:
    """Like `asterism.previews.surface.surface.Lens`, with the linear response in place of its rules for bumps and arms.

    Stars and bare rim share a place as in `corrugation_heights`; supports act as there. Curvatures count up to that of
    the `natural` tubes (1/mm), of which the response is made: the shell's grow without limit at needles.
    """

    def __init__(self, sheet: Sheet, points: Floats, fields: Callable[[Floats], Floats], natural: float) -> None:
        layout = self.layout = sheet.layout
        self.sheet, self._rim, self._at = sheet, SupportedEdge(sheet, points), sheet.space.locate(points)
        self._fields, self._natural = fields(points - layout.lattice_origin), natural
        self._shares = sheet.stars.cells.shares(points)
        self._stays = support_factor(layout.distance_to_supports(points), layout.spacing_mm, sheet.model)

    def __call__(self, x: Floats, values: StarValues) -> Places:
        """The positions of the points for degrees of freedom x (N, 3) of the shell."""
        smooth = smooth_surface(self._at, x)
        smooth = replace(smooth, places=smooth.places + self._rim(x))
        weights = self._shares(values.sizes[:, 0])
        share = self._stays * stars_share(weights)
        curvature = curvature_components(smooth)
        size = np.abs(curvature[:, :1]) + np.linalg.norm(curvature[:, 1:], axis=1, keepdims=True)  # a tube has 2 / r
        curvature /= np.maximum(0.5 * size / self._natural, 1.0)
        relief = self._fields[:, 0] + np.einsum("nk,nkc->nc", curvature, self._fields[:, 1:])
        low, lower = beside(weights, values.tip_heights[:-1]).T
        rim = np.minimum(low + curvature[:, 0] * lower, 0.0)
        heights = share * relief[:, 2] + (self._stays - share) * rim
        if self.layout.pins:
            heights = heights * flattening(values, weights, smooth.area, self.sheet.model)
        return Places(smooth, laid(smooth, np.column_stack([share[:, None] * relief[:, :2], heights])))


def laid(smooth: SmoothSurface, relief: Floats) -> Floats:
    """(n, 3) mm, vectors in space of a relief (n, 3): components along the sheet in mm of the print, and heights."""
    return np.asarray(smooth.moved(relief[:, :2]) + relief[:, 2:] * smooth.normals)


def curvature_components(smooth: SmoothSurface) -> Floats:
    """(n, 3) 1/mm: K11 + K22, K11 - K22, 2 K12 of the sheet, in print axes turned along with it."""
    one, two, both = np.einsum("nkc,nc->kn", smooth.seconds, smooth.normals)
    frame = print_axes(smooth)
    slopes = np.linalg.inv(np.einsum("nic,njc->nij", smooth.tangents, frame))
    form = -slopes @ np.stack([[one, both], [both, two]]).transpose(2, 0, 1) @ slopes.transpose(0, 2, 1)
    return np.column_stack([form[:, 0, 0] + form[:, 1, 1], form[:, 0, 0] - form[:, 1, 1], 2.0 * form[:, 0, 1]])


def print_axes(smooth: SmoothSurface) -> Floats:
    """(n, 2, 3) orthonormal tangents nearest to the images of the print's axes."""
    left, _, right = np.linalg.svd(smooth.tangents, full_matrices=False)
    return np.asarray(left @ right)
