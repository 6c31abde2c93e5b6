"""The target surface that a page has sent, and its pose beside the sheet."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np

from asterism.equilibrium.arrays import Floats, Ints
from asterism.fitting.rhino_file import read_rhino
from asterism.measure.compare.scan import MM, read_surface
from asterism.pattern.drawing.rhino import RHINO_FORMAT
from asterism.studio import frames
from asterism.studio.messages import Surface, TargetPose

TARGET = 4  # kind of the binary frame of a target


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
        return frames.pack(TARGET, {}, {"positions": surface.vertices, "triangles": surface.triangles})

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
