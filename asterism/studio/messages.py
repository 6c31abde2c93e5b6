"""What the server and the processes of the studio send to each other over pipes: orders, then answers.

Arrays are in mm, rows of lattice sites are [i, j]. The server reads these classes, so this file imports numpy and
nothing heavier.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from typing import Any
from zlib import crc32

import numpy as np

from asterism.equilibrium.arrays import Array


@dataclass(frozen=True)
class Edit:
    """Show this design.

    Attributes
    ----------
    seq : increases; every answer carries the number that it belongs to.
    design : the table of the design file, without what follows.
    sites, sizes_mm : (n, 2) and (n, L), all stars with sizes of their own; nan keeps the size of the design's profile.
    removed : (m, 2), all removed stars.
    is_dragging : the pointer is down: coarse mesh, linear response first, no summary.
    is_opened : the design does not follow from the shown one by an edit: its form does not depend on that.
    snapshot : of an opened design, the form to go back to, as in a frame; without one, the form is searched for.
    folder : of the design file, for pictures.
    """

    seq: int
    design: dict[str, Any]
    sites: Array = field(default_factory=lambda: np.empty((0, 2), dtype=np.int64))
    sizes_mm: Array = field(default_factory=lambda: np.empty((0, 0)))
    removed: Array = field(default_factory=lambda: np.empty((0, 2), dtype=np.int64))
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
class Ready:
    """The engine has loaded everything."""


@dataclass(frozen=True)
class Sign:
    """The engine computes; `is_stuck` in a loop that does not seem to end."""

    is_stuck: bool = False


@dataclass(frozen=True)
class Limits:
    """What the law covers.

    Attributes
    ----------
    law : ranges of sizes (mm) at the fabric's stretch; empty if its cells are solved when they are needed.
    stretches : those that the law of the design's material is calibrated for.
    """

    seq: int
    law: dict[str, tuple[float, float]]
    stretches: tuple[float, ...]


@dataclass(frozen=True)
class TargetPose:
    """The motion that lays the target on the shape: `vertices @ rotation.T + shift`.

    Attributes
    ----------
    rotation : (3, 3), proper.
    shift : (3,) mm.
    """

    seq: int
    rotation: Array
    shift: Array


@dataclass(frozen=True)
class Frame:
    """A sheet on a mesh, complete as pages draw it.

    Attributes
    ----------
    stage : `printed`, `linear`, `equilibrium` or `exact`.
    arrays : by their names on the page. `positions` (V, 3) mm. `arms`, `arm_normals` (A, K, 3, 3) left and right upper
        edges of the arms, their middle on the fabric, (A, K, 3). `needles` (N, 2, 3) foot and tip; of the tube along a
        held curve, both ends of a piece. `curvature` (V,) 1/mm, mean curvature of the smooth surface. `strain` (V,)
        area of the smooth surface over that of the released sheet, minus 1. If `Parts` asks for them: `smooth`,
        `smooth_arms`, ... of the sheet without its bumps, and `target` (V,) mm, distances from the target. Of an exact
        shape also `before`, `before_arms`, ... of the preview of its design, at the same vertices and in the same pose.
    mesh_arrays : of the mesh: `printed` (V, 2) mm; `triangles` (T, 3); `outline` (E, 2) edges around
        the sheet and its holes; `arm_site` (A,) row of the star's site in the plan, for each ribbon.
    target : `rms_mm` and `max_mm` of the distances over the sheet, each place by its printed area, and the `version` of
        the target, as in `Parts`.
    form : index in the last summary, of a form that is not the shown one.
    is_again : a shape that was shown before, with other parts.
    snapshot : the form, to come back to; None for linear stages. It is pickled, since only an engine can read it.
    """

    seq: int
    stage: str
    arrays: dict[str, Array]
    mesh_arrays: dict[str, Array]
    is_minimum: bool = False
    height_mm: float = 0.0
    target: dict[str, float] | None = None
    form: int | None = None
    is_again: bool = False
    snapshot: bytes | None = None

    @cached_property
    def mesh(self) -> int:
        """A number that only meshes with these arrays have."""
        return crc32(b"".join(values.tobytes() for values in self.mesh_arrays.values()))

    @property
    def header(self) -> dict[str, Any]:
        """What pages get with the arrays."""
        return {"stage": self.stage, "height_mm": self.height_mm, **({"target": self.target} if self.target else {})}


@dataclass(frozen=True)
class Notice:
    """A warning, with the sites of the stars and the printed place (mm) that it is about."""

    text: str
    stars: tuple[tuple[int, int], ...] = ()
    at_mm: tuple[float, float] | None = None


@dataclass(frozen=True)
class Form:
    """One of several minima: its number, its name, and its energy above that of the form shown."""

    index: int
    name: str
    energy_percent: float
    is_shown: bool


@dataclass(frozen=True)
class ShapeSummary:
    """Numbers, warnings and minima of the shape of an edit, when the engine has rested."""

    seq: int
    numbers: dict[str, Any]
    warnings: tuple[Notice, ...] = ()
    forms: tuple[Form, ...] = ()


@dataclass(frozen=True)
class StudioProblem:
    """An edit or a job that has no answer; the last good shape stays.

    Attributes
    ----------
    kind : `design`, `law`, `mesh`, `no minimum`, `too long`, `cancelled`, `no other side`, `search ended`,
        `output`.
    field, value, allowed : of a mistake in the design; empty otherwise.
    text : one line.
    """

    seq: int
    kind: str
    text: str
    field: str = ""
    value: str = ""
    allowed: str = ""
    stars: tuple[tuple[int, int], ...] = ()
    at_mm: tuple[float, float] | None = None

    @property
    def data(self) -> dict[str, Any]:
        """The message `problem` for pages."""
        return {"type": "problem", **{name: value for name, value in vars(self).items() if name != "seq"}}


@dataclass(frozen=True)
class Busy:
    """What a long computation is doing; also a sign of life."""

    seq: int
    what: str


def mistake_parts(error: Exception, rows: Array) -> dict[str, Any]:
    """The parts of a `StudioProblem` that say where an error is: field, value, allowed, stars and place.

    Parameters
    ----------
    rows : (P, 2) lattice sites of the sheet, in the order of the stars' numbers.
    """
    value, place = getattr(error, "value", ""), getattr(error, "place_mm", None)
    return {
        "field": str(getattr(error, "field", "")),
        "value": str(value)[:100] if isinstance(value, str | int | float | list | tuple) else "",
        "allowed": str(getattr(error, "allowed", "")),
        "stars": sites_of(rows, getattr(error, "stars", ())),
        "at_mm": None if place is None else (float(place[0]), float(place[1])),
    }


def sites_of(rows: Array, stars: tuple[int, ...]) -> tuple[tuple[int, int], ...]:
    """Lattice sites of stars by their numbers; numbers beyond the list are left out."""
    count = len(rows)
    return tuple((int(i), int(j)) for i, j in np.asarray(rows)[[star for star in stars if 0 <= star < count]])


@dataclass(frozen=True)
class JobProgress:
    """How far a job is: `done` of `of` steps of a stage, after so many seconds."""

    job: int
    stage: str
    done: int
    of: int
    seconds: float


@dataclass(frozen=True)
class Rested:
    """A design is at rest: the exact model can go on from here.

    Attributes
    ----------
    shape : the preview; None if the design has none. It is pickled, since the server cannot read it.
    seconds : that the exact shape takes, estimated.
    """

    seq: int
    shape: bytes | None
    seconds: float


@dataclass(frozen=True)
class Settle:
    """Compute the exact shape of a design.

    Attributes
    ----------
    job : number of the answer.
    near : the preview, pickled as in `Rested`; without one the sheet is released from the flat print.
    pose : printed (V, 2) and shown (V, 3) places of the sheet that pages show, mm.
    parts : that the frames hold besides the shape.
    release : whether the release from the flat print follows.
    """

    job: int
    table: dict[str, Any]
    folder: str
    near: bytes | None
    pose: tuple[Array, Array] | None
    parts: Parts
    release: bool = False


@dataclass(frozen=True)
class Settled:
    """An exact shape: it takes the place of the preview from which it was computed.

    Attributes
    ----------
    shape : for a report or an export, pickled.
    summary, files : of a verification.
    """

    job: int
    frame: Frame
    shown: ShapeSummary
    shape: bytes
    summary: dict[str, Any] = field(default_factory=dict)
    files: tuple[str, ...] = ()


@dataclass(frozen=True)
class Released:
    """Where the release from the flat print ends: it follows what a print does.

    Attributes
    ----------
    is_same : whether that is the exact shape that followed the preview; None if the release ends in no minimum.
    other : the shape, if it is another one.
    energy_percent : its energy above that of the exact shape that followed the preview, in % of that.
    apart_percent : rms distance of the two in % of the diameter.
    """

    job: int
    is_same: bool | None
    other: Settled | None = None
    energy_percent: float = 0.0
    apart_percent: float = 0.0


@dataclass(frozen=True)
class Fitted:
    """The end of a fit to the target.

    Attributes
    ----------
    table : of the design file.
    rotation, shift : (3, 3) and (3,) mm, from the target's file to its pose in the fit.
    """

    job: int
    summary: dict[str, Any]
    table: dict[str, Any]
    rotation: Array
    shift: Array


@dataclass(frozen=True)
class Written:
    """The end of a job that writes files."""

    job: int
    summary: dict[str, Any]
    folder: str
    files: tuple[str, ...]
    warnings: tuple[str, ...] = ()
