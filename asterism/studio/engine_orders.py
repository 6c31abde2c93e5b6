"""What the server asks of the engine, over a pipe; arrays are in mm, rows of lattice sites are [i, j]."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from asterism.equilibrium.arrays import Array


@dataclass(frozen=True)
class Edit:
    """Show this design. Whatever is None stays as in the last edit that gave it.

    Attributes
    ----------
    seq : increases; every answer carries the number that it belongs to.
    design : the table of the design file.
    sites, sizes_mm : (n, 2) and (n, 3), all stars with sizes of their own; nan keeps the size of the design's profile.
    removed : (m, 2), all removed stars.
    is_dragging : the pointer is down: coarse mesh, linear response first, no summary.
    is_opened : the design does not follow from the shown one by an edit: its form does not depend on that.
    snapshot : of an opened design, the form to go back to, as in a frame; without one, the form is searched for.
    folder : of the design file, for pictures.
    """

    seq: int
    design: dict[str, Any] | None = None
    sites: Array | None = None
    sizes_mm: Array | None = None
    removed: Array | None = None
    is_dragging: bool = False
    is_opened: bool = False
    snapshot: bytes | None = None
    folder: str = "."


@dataclass(frozen=True)
class Flip:
    """Show the form that bends to the other side."""

    seq: int


@dataclass(frozen=True)
class ShowForm:
    """Show another minimum of the last summary."""

    seq: int
    index: int


@dataclass(frozen=True)
class Surface:
    """Triangles (T, 3) in space with their vertices (V, 3) mm."""

    vertices: Array
    triangles: Array


@dataclass(frozen=True)
class Parts:
    """What frames of a sheet at rest hold besides the shape. It holds until the next message of its kind.

    Attributes
    ----------
    smooth : the sheet without its bumps; also while the pointer is down.
    target : the surface that the sheet is compared with.
    version : of the target and its pose.
    """

    seq: int
    smooth: bool = False
    target: Surface | None = None
    version: int = 0


@dataclass(frozen=True)
class FitTarget:
    """Lay the target on the shape; `TargetPose` is the answer."""

    seq: int


@dataclass(frozen=True)
class Cancel:
    """Break off the work on edits up to `seq`; the last good shape stays."""

    seq: int


@dataclass(frozen=True)
class Stop:
    """End the process."""
