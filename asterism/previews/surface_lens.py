"""The sheet in space as triangles: the shell's smooth surface, and the stars' bumps on it."""

from __future__ import annotations

from copy import copy
from dataclasses import replace

import numpy as np
from scipy.spatial import cKDTree

from asterism.equilibrium.arrays import Floats
from asterism.homogenize.cell.corrugation_waves import CorrugationWaves
from asterism.pattern.mesh.mesh import Mesh
from asterism.previews.arm_shares import arm_shares
from asterism.previews.bumps import corrugation_heights, flattening, support_factor
from asterism.previews.fields.star_values import StarValues
from asterism.previews.fields.supported_edge import SupportedEdge
from asterism.previews.places import Places, smooth_surface
from asterism.previews.sheet import Sheet
from asterism.previews.shown_shape import mesh_to_show, shape_on_mesh
from asterism.shape.shape import Shape

# largest edge of the triangles of a preview's shape, over the spacing of the stars
MAX_SHOWN_EDGE = 1 / 6


class Lens:
    """Computes the positions of a fixed set of printed points (n, 2) mm for shells of one sheet.

    Attributes
    ----------
    sheet, points : as given.

    Raises
    ------
    ValueError
        A point is outside of the sheet.
    """

    def __init__(self, sheet: Sheet, waves: CorrugationWaves, points: Floats) -> None:
        self.points = np.atleast_2d(np.asarray(points, dtype=float))
        self._model = sheet.model
        self._waves = waves(self.points - sheet.layout.lattice_origin)
        self._spacing, self._held = sheet.layout.spacing_mm, bool(sheet.layout.pins)
        self._stays = support_factor(sheet.layout.distance_to_supports(self.points), self._spacing, sheet.model)
        self._at = sheet.space.locate(self.points)
        self._follow_stars(sheet)

    def _follow_stars(self, sheet: Sheet) -> None:
        """Compute everything that depends on the stars or on the positions of the pins in space."""
        self.sheet, self._rim = sheet, SupportedEdge(sheet, self.points)
        self._shares = sheet.stars.cells.shares(self.points)
        self._nearest = cKDTree(sheet.layout.centres).query(self.points)[1]
        self._arms, self._arm_shares = sheet.arms, arm_shares(sheet.arms, self.points)

    def renewed(self, sheet: Sheet) -> Lens:
        """The lens of the same points on a sheet after an edit that keeps the print; unchanged parts are shared.

        Raises
        ------
        ValueError
            The sheet has another print.
        """
        if sheet is self.sheet:
            return self
        if sheet.space is not self.sheet.space:
            raise ValueError("the sheet has another print: make a new lens")
        lens = copy(self)
        if sheet.stars is not self.sheet.stars or not self.sheet.has_pins_of(sheet.layout):
            lens._follow_stars(sheet)
            return lens
        lens.sheet = sheet
        if self.sheet.has_rods_of(sheet.layout):
            lens._arms = sheet.arms
        else:
            lens._arms, lens._arm_shares = sheet.arms, arm_shares(sheet.arms, self.points, self._arm_shares)
        return lens

    def __call__(self, x: Floats, values: StarValues) -> Places:
        """The positions of the points for degrees of freedom x (N, 3) of the shell."""
        smooth = smooth_surface(self._at, x)
        smooth = replace(smooth, places=smooth.places + self._rim(x))
        if not self._model.has_bumps:
            return Places(smooth, np.zeros_like(smooth.places))
        weights = self._shares(values.sizes[:, 0])
        curvature = 2.0 * smooth.mean_curvature
        rim = self._nearest, self._spacing, self._model
        heights = self._stays * corrugation_heights(self._waves, values, weights, curvature, *rim)
        out, lift = self._arms.moves(x, values.value["kappa"])
        heights += self._arm_shares.lifted @ lift
        if self._held:
            heights *= flattening(values, weights, smooth.area, self._model)
        return Places(smooth, smooth.moved(self._arm_shares.along @ out) + heights[:, None] * smooth.normals)


def shown_mesh(sheet: Sheet) -> Mesh:
    """The mesh of a preview's shape, see `mesh_to_show`."""
    return mesh_to_show(sheet, MAX_SHOWN_EDGE)


def shape_of(sheet: Sheet, mesh: Mesh, places: Places) -> Shape:
    """The shape with bumps, without a summary; see `shape_on_mesh`."""
    star = np.full(len(mesh.points), -1, dtype=np.int64)
    star[mesh.star_vertices] = sheet.layout.star_number
    return shape_on_mesh(sheet, mesh, places, star, _rod_fields(sheet, mesh))


def _rod_fields(sheet: Sheet, mesh: Mesh) -> dict[str, np.ndarray]:
    """Fields of the rod edges: arm, star, and thickness and width at the middle of the edge."""
    layout, counts = sheet.layout, np.array([len(path) for path in mesh.rods])
    arm = np.repeat(np.arange(len(counts)), counts)
    step = np.linalg.norm(np.diff(mesh.points[np.concatenate(mesh.rods)], axis=0), axis=1)
    within = arm[1:] == arm[:-1]  # false for steps from one arm to the next
    arms, step = arm[1:][within], step[within]
    total = np.bincount(arms, step)
    before = np.cumsum(total) - total
    part = (np.cumsum(step) - 0.5 * step - before[arms]) / total[arms]
    ends = {"thickness_mm": layout.arm_thickness, "width_mm": layout.arm_width}
    return {
        "arm": arms,
        "star": layout.star_number[layout.arm_star[arms]],
        **{name: (1.0 - part) * both[arms, 0] + part * both[arms, 1] for name, both in ends.items()},
    }
