"""The target surface that a page has sent: its pose beside the sheet, and the weights of its places in a fit."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from asterism.equilibrium.arrays import Array, Floats, Ints
from asterism.fitting.target_files import read_rhino
from asterism.measure.scan import MM, read_surface
from asterism.pattern.drawing.rhino import RHINO_FORMAT
from asterism.pattern.layout.layout import Layout
from asterism.studio import frames
from asterism.studio.messages import Surface, TargetPose
from asterism.studio.requests import RequestError
from asterism.studio.star_sizes import PLAIN_WEIGHT, weights_by_site

if TYPE_CHECKING:
    from asterism.fitting.target import TargetSurface


@dataclass(frozen=True)
class Target:
    """A surface to compare the sheet with.

    Attributes
    ----------
    name : of its file.
    vertices, triangles : (V, 3) and (T, 3) as in the file.
    unit : of the file's numbers.
    rotation, shift : (3, 3) and (3,) mm, from the file to the shown pose.
    is_fitted : it is laid on the sheet.
    """

    name: str
    vertices: Floats
    triangles: Ints
    unit: str = "mm"
    rotation: Floats = field(default_factory=lambda: np.eye(3))
    shift: Floats = field(default_factory=lambda: np.zeros(3))
    is_fitted: bool = False

    @property
    def surface_of_file(self) -> Surface:
        """The triangles in the pose of the file, mm."""
        return Surface(MM[self.unit] * self.vertices, self.triangles)

    @property
    def surface(self) -> Surface:
        """The triangles in the shown pose, mm."""
        placed = MM[self.unit] * self.vertices @ self.rotation.T + self.shift
        return Surface(placed.astype(np.float32), self.triangles.astype(np.uint32))

    def moved(self, pose: TargetPose) -> Target:
        """The target after a further motion."""
        turn = np.asarray(pose.rotation)
        return replace(self, rotation=turn @ self.rotation, shift=turn @ self.shift + pose.shift, is_fitted=True)

    def as_in_file(self, unit: str | None = None) -> Target:
        """The target in the pose of its file; `unit` is a new unit of the file's numbers."""
        return Target(self.name, self.vertices, self.triangles, unit or self.unit)

    def packed(self) -> bytes:
        """The binary frame for the page."""
        surface = self.surface
        return frames.pack(frames.TARGET, {}, {"positions": surface.vertices, "triangles": surface.triangles})

    def data(self) -> dict[str, Any]:
        """Name, size and placement for the page."""
        size = MM[self.unit] * np.ptp(self.vertices[np.unique(self.triangles)], axis=0)
        return {
            "name": self.name,
            "unit": self.unit,
            "triangles": len(self.triangles),
            "size_mm": [float(extent) for extent in size],
            "is_fitted": self.is_fitted,
        }


def read_target(path: Path, name: str) -> Target:
    """The target in a file of triangles, or in a 3DM file, whose unit is converted to mm.

    Raises
    ------
    ScanError, TargetError
        The file holds no surface.
    """
    is_rhino = path.suffix.lower() == RHINO_FORMAT
    vertices, triangles = read_rhino(path, None) if is_rhino else read_surface(path)
    return Target(name or path.name, vertices, triangles)


@dataclass(frozen=True)
class SheetWeights:
    """Weights of a shown sheet beside its target, for the process of a fit.

    Attributes
    ----------
    centres : (S, 2) mm, printed lattice sites.
    weight : (S,) of the cells around them.
    printed : (V, 2) mm, vertices of the shown sheet.
    positions : (V, 3) mm, the same in space, in the pose of the target's file.
    """

    centres: Array
    weight: Array
    printed: Array
    positions: Array

    def at_vertices(self, target: TargetSurface) -> Floats:
        """(V,) weights at the vertices of the target: each has that of the nearest place of the sheet."""
        from scipy.spatial import cKDTree  # the server does not need it

        of_sheet = self.weight[cKDTree(self.centres).query(self.printed)[1]]
        posed = self.positions @ target.motion.T + target.shift_mm
        return np.asarray(of_sheet[cKDTree(posed).query(target.disk.vertices)[1]], dtype=float)


def sheet_weights(
    table: Mapping[str, Any], layout: Layout, shown: tuple[Array, Array] | None, target: Target
) -> SheetWeights | None:
    """The weights of a design on the shown sheet; None if all places have the same.

    Parameters
    ----------
    shown : printed (V, 2) and shown (V, 3) places of the sheet, mm; None without a shape.

    Raises
    ------
    RequestError
        There are weights, but no shape.
    """
    weights = weights_by_site(table)
    weight = np.array([weights.get(tuple(site), PLAIN_WEIGHT) for site in layout.sheet_sites.tolist()])
    if (weight == PLAIN_WEIGHT).all():
        return None
    if shown is None:
        raise RequestError("fit: wait until the sheet is shown: weights are those of its places")
    printed, positions = (np.asarray(part, dtype=float) for part in shown)
    centres = layout.lattice.place(layout.sheet_sites)
    return SheetWeights(centres, weight, printed, (positions - target.shift) @ target.rotation)
