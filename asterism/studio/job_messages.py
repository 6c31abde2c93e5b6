"""What the processes of jobs send to the server over a pipe; arrays as in `messages`."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from asterism.equilibrium.arrays import Array
from asterism.studio.messages import Frame, ShapeSummary, ShownMesh

# end of the name of a verification's directory
VERIFIED = "-verified"


@dataclass(frozen=True)
class JobProgress:
    """How far a job is: `done` of `of` steps of a stage, after so many seconds."""

    job: int
    stage: str
    done: int
    of: int
    seconds: float


@dataclass(frozen=True)
class Verified:
    """The end of a verification: both shapes at the vertices of one mesh, and their distance (V,) mm."""

    job: int
    summary: dict[str, Any]
    mesh: ShownMesh
    exact: Array
    preview: Array
    distance: Array
    files: tuple[str, ...]


@dataclass(frozen=True)
class Computed:
    """The end of an exact computation of a pattern without a preview: its shape takes the place of the preview's."""

    job: int
    summary: dict[str, Any]
    mesh: ShownMesh
    frame: Frame
    shown: ShapeSummary
    files: tuple[str, ...]


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
