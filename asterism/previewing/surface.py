"""The sheet in space as triangles: the shell's smooth surface, and the stars' bumps on it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from asterism.previewing.sheet import Sheet
from asterism.previewing.star_relief import relief_heights
from asterism.previewing.star_values import StarValues
from asterism.shape import Shape
from asterism.surface_fields import cell_fields
from fem.tabulation import Floats
from homogenize.relief import Waves
from pattern.design import Design
from pattern.mesh import Mesh
from pattern.meshing import mesh_layout

# coarsest edge of the triangles that are shown, over the spacing of the stars
SHOWN = 1 / 7


@dataclass(frozen=True)
class Places:
    """Of n printed points in space.

    Attributes
    ----------
    smooth : (n, 3) mm on the shell.
    normals : (n, 3) unit normals, on the plastic side.
    heights : (n,) mm of the stars' relief over it.
    mean_curvature, gaussian_curvature : (n,) of the shell, 1/mm and 1/mm^2; the mean one is positive where the plastic
        side is convex.
    """

    smooth: Floats
    normals: Floats
    heights: Floats
    mean_curvature: Floats
    gaussian_curvature: Floats

    @property
    def bumpy(self) -> Floats:
        """(n, 3) mm."""
        return self.smooth + self.heights[:, None] * self.normals


class Lens:
    """Takes shells of one sheet to a set of printed points (n, 2)."""

    def __init__(self, sheet: Sheet, waves: Waves, points: Floats) -> None:
        self.points = np.asarray(points, dtype=float)
        self._waves = waves(self.points - sheet.layout.lattice_origin)
        self._spacing = float(np.linalg.norm(sheet.layout.lattice_vectors, axis=1).min())
        self._at = sheet.space.locate(self.points)
        self.look_at_stars(sheet)

    def look_at_stars(self, sheet: Sheet) -> None:
        """Follow a change of the sheet's stars."""
        self._shares = sheet.cells.shares(self.points)

    def __call__(self, x: Floats, values: StarValues) -> Places:
        """Where positions x (N, 3) of the shell's dofs take the points."""
        first = (self._at.gradient @ x).reshape(-1, 2, 3)
        second = (self._at.hessian @ x).reshape(-1, 3, 3)
        cross = np.cross(first[:, 0], first[:, 1])
        area = np.linalg.norm(cross, axis=1)
        normals = cross / area[:, None]
        a11, a22, a12 = (np.einsum("nc,nc->n", first[:, i], first[:, j]) for i, j in ((0, 0), (1, 1), (0, 1)))
        b11, b22, b12 = np.einsum("nkc,nc->kn", second, normals)
        mean_curvature = -0.5 * (a22 * b11 + a11 * b22 - 2.0 * a12 * b12) / area**2
        weights = self._shares(values.sizes[:, 0])
        return Places(
            smooth=self._at.value @ x,
            normals=normals,
            heights=relief_heights(self._waves, values, weights, 2.0 * mean_curvature, self._spacing),
            mean_curvature=mean_curvature,
            gaussian_curvature=(b11 * b22 - b12**2) / area**2,
        )


def shown_mesh(design: Design, sheet: Sheet) -> Mesh:
    """Triangles to show, with the arms among their edges: the design's, or coarser ones if those are coarse enough."""
    edge = max(design.mesh.edge_mm, SHOWN * design.lattice.spacing_mm)
    return mesh_layout(sheet.layout, edge, design.mesh.kind, design.mesh.seed, draft=True)


def shape_of(design: Design, sheet: Sheet, mesh: Mesh, places: Places) -> Shape:
    """A shape without its summary. `bump_mm` is the vector from the smooth surface to the bumpy one.

    Normals, curvatures and strains are those of the smooth surface.
    """
    star = np.full(len(mesh.points), -1, dtype=np.int64)
    star[mesh.star_vertices] = np.arange(len(mesh.star_vertices))
    return Shape(
        printed=mesh.points,
        positions=places.bumpy,
        triangles=mesh.triangles,
        star=star,
        rods=mesh.rods,
        star_vertices=mesh.star_vertices,
        point_fields={
            "bump_mm": places.heights[:, None] * places.normals,
            "normal": places.normals,
            "mean_curvature_per_mm": places.mean_curvature,
            "gaussian_curvature_per_mm2": places.gaussian_curvature,
        },
        cell_fields=cell_fields(mesh.points, places.smooth, mesh.triangles, design.fabric.stretch_xy),
        rod_fields=_rod_fields(sheet, mesh),
    )


def _rod_fields(sheet: Sheet, mesh: Mesh) -> dict[str, np.ndarray]:
    """Of every edge of every arm: arm, star, and the section in its middle."""
    layout, counts = sheet.layout, np.array([len(path) for path in mesh.rods])
    arm = np.repeat(np.arange(len(counts)), counts)
    step = np.linalg.norm(np.diff(mesh.points[np.concatenate(mesh.rods)], axis=0), axis=1)
    within = arm[1:] == arm[:-1]  # the others lead from one arm to the next
    arms, step = arm[1:][within], step[within]
    total = np.bincount(arms, step)
    before = np.cumsum(total) - total
    part = (np.cumsum(step) - 0.5 * step - before[arms]) / total[arms]
    ends = {"thickness_mm": layout.arm_thickness, "width_mm": layout.arm_width}
    return {
        "arm": arms,
        "star": layout.arm_star[arms],
        **{name: (1.0 - part) * both[arms, 0] + part * both[arms, 1] for name, both in ends.items()},
    }
