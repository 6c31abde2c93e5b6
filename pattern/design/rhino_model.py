"""3DM files of Rhino, opened by `rhino3dm` (the extra `cad`): for lines of a design, and for targets of a fit."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

RHINO_FORMAT = ".3dm"
RHINO_NEEDED = 'needs rhino3dm: pip install "asterism-fabric[cad]"'
# larger files are refused
MAX_RHINO_BYTES = 200_000_000
# mm, by the names of `rhino3dm.UnitSystem`
RHINO_UNITS_MM = {
    "Microns": 1e-3,
    "Millimeters": 1.0,
    "Centimeters": 10.0,
    "Decimeters": 100.0,
    "Meters": 1000.0,
    "Inches": 25.4,
    "Feet": 304.8,
    "Yards": 914.4,
    "None": 1.0,
    "Unset": 1.0,
}


@dataclass(frozen=True)
class RhinoModel:
    """An open 3DM file.

    Attributes
    ----------
    file : the `rhino3dm.File3dm`.
    mm : length of its unit.
    """

    file: Any
    mm: float

    def visible(self) -> Iterator[tuple[Any, str]]:
        """The geometry of each visible object, and the full name of its layer, such as `sheet::outline`.

        Blocks are left out: their objects lie in the coordinates of the block.
        """
        for thing in self.file.Objects:
            if thing.Attributes.IsInstanceDefinitionObject:
                continue
            number = thing.Attributes.LayerIndex
            layer = self.file.Layers.FindIndex(number) if 0 <= number < len(self.file.Layers) else None
            if thing.Attributes.Visible and (layer is None or layer.Visible):
                yield thing.Geometry, "" if layer is None else layer.FullPath


def open_rhino_model(path: Path, mm: float | None, error: Callable[[str], Exception]) -> RhinoModel:
    """Open a 3DM file.

    Parameters
    ----------
    mm : length of the unit of the numbers; None for the unit that the file names.
    error : makes the error that is raised from what is wrong with the file.
    """
    if not path.is_file():
        raise error("is no file" if path.exists() else "is not there")
    if path.stat().st_size > MAX_RHINO_BYTES:
        raise error(f"is larger than {MAX_RHINO_BYTES // 1_000_000} MB")
    try:
        import rhino3dm
    except ImportError:
        raise error(f"reading 3DM {RHINO_NEEDED}") from None
    file: Any
    try:
        file = rhino3dm.File3dm.Read(str(path))
    except Exception:  # errors of the binding have no common class
        file = None
    if file is None:
        raise error("cannot be read as 3DM: the file is damaged or cut short")
    unit = file.Settings.ModelUnitSystem.name
    if mm is None and unit not in RHINO_UNITS_MM:
        raise error(f"its unit is {unit}: save it in mm, or give the unit of its numbers")
    return RhinoModel(file, RHINO_UNITS_MM[unit] if mm is None else mm)
