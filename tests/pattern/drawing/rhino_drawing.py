"""Small drawings in 3DM files."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest


class Drawing:
    """A 3DM file that is drawn by a few words."""

    def __init__(self, unit: str = "Millimeters") -> None:
        self._rhino: Any = pytest.importorskip("rhino3dm")
        self.file = self._rhino.File3dm()
        self.file.Settings.ModelUnitSystem = getattr(self._rhino.UnitSystem, unit)
        self.layers: dict[str, int] = {}

    def on(self, name: str, visible: bool = True) -> Any:
        if name not in self.layers:
            above, _, last = name.rpartition("::")
            layer = self._rhino.Layer()
            layer.Name, layer.Visible = last, visible
            if above:
                self.on(above)
                layer.ParentLayerId = self.file.Layers[self.layers[above]].Id
            self.layers[name] = self.file.Layers.Add(layer)
        attributes = self._rhino.ObjectAttributes()
        attributes.LayerIndex = self.layers[name]
        return attributes

    def polyline(self, points: list[tuple[float, float]], layer: str, visible: bool = True) -> None:
        line = self._rhino.Polyline(len(points))
        for x, y in points:
            line.Add(float(x), float(y), 0.0)
        self.file.Objects.AddPolyline(line, self.on(layer, visible))

    def circle(self, x: float, y: float, radius: float, layer: str) -> None:
        self.file.Objects.AddCircle(self._rhino.Circle(self._rhino.Point3d(x, y, 0.0), radius), self.on(layer))

    def saved(self, folder: Path, name: str = "x.3dm") -> Path:
        assert self.file.Write(str(folder / name), 7)
        return folder / name
