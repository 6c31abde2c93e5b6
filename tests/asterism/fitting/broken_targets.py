"""Files that are no target, each with the words that its message must hold."""

from __future__ import annotations

import io
import os
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import trimesh
from PIL import Image

from asterism.fitting.disk import height_mesh
from tests.asterism.fitting import surfaces as wrong
from tests.asterism.fitting.surfaces import cylinder_part, spherical_cap

PICTURE = ("--heights-mm", "0", "12", "--extent-mm", "90")
FIELD = ("--extent-mm", "90")


@dataclass(frozen=True)
class BrokenTarget:
    """A file, what is wrong with it, and how the command ends.

    Attributes
    ----------
    name : of the file.
    write : writes it.
    problem : words of the message.
    options : further words of the command.
    status : 2 for a wrong file, 1 for a surface out of reach.
    """

    name: str
    write: Callable[[Path], Any]
    problem: str
    options: tuple[str, ...] = ()
    status: int = 2


def meshed(mesh: wrong.Mesh) -> bytes:
    return bytes(trimesh.Trimesh(*mesh, process=False).export(file_type="stl"))


def data(content: bytes | str) -> Callable[[Path], Any]:
    return lambda path: path.write_bytes(content if isinstance(content, bytes) else content.encode())


def surface(make: Callable[[], wrong.Mesh]) -> Callable[[Path], Any]:
    return lambda path: trimesh.Trimesh(*make(), process=False).export(path)


def sparse(size: int) -> Callable[[Path], Any]:
    return lambda path: (path.touch(), os.truncate(path, size))


def array(values: Any) -> Callable[[Path], Any]:
    return lambda path: np.save(path, np.asarray(values), allow_pickle=True)


def picture(values: Any, mode: str | None = None, **options: Any) -> Callable[[Path], Any]:
    return lambda path: Image.fromarray(np.asarray(values), mode).save(path, **options)


def dome(width: float = 80.0, rise: float = 10.0, points: int = 41) -> wrong.Mesh:
    x = np.linspace(-0.5 * width, 0.5 * width, points)
    return height_mesh(rise * (1.0 - (2.0 * x[None] / width) ** 2) * (1.0 - (2.0 * x[:, None] / width) ** 2), x, x)


def scaled(mesh: wrong.Mesh, factor: float) -> wrong.Mesh:
    return factor * mesh[0], mesh[1]


def flat_triangles() -> wrong.Mesh:
    """A dome with triangles whose corners lie on a line."""
    vertices, triangles = dome()
    middles = 0.5 * (vertices[:60] + vertices[1:61])
    number = np.arange(60)
    flat = np.column_stack([number, number + 1, len(vertices) + number])
    return np.concatenate([vertices, middles]), np.concatenate([triangles, flat])


def apart(gap: float) -> wrong.Mesh:
    """Two halves of a dome with a gap between."""
    vertices, triangles = dome()
    is_left = vertices[triangles].mean(axis=1)[:, 0] < 0.0
    other = np.concatenate([vertices, vertices + np.array([gap, 0.0, 0.0])])
    return other, np.concatenate([triangles[is_left], triangles[~is_left] + len(vertices)])


def spike() -> wrong.Mesh:
    vertices, triangles = dome()
    heights = vertices[:, 2] + 9.0 * np.exp(-((np.linalg.norm(vertices[:, :2], axis=1) / 8.0) ** 2))
    return np.column_stack([vertices[:, :2], heights]), triangles


def finger(height: float = 80.0) -> wrong.Mesh:
    """A plate with a tube on it that is closed at its end: flat, the end would be a millionth of the plate."""
    turns = 24
    rings = np.concatenate([[[60.0 - 2.0 * k, 0.0] for k in range(25)], [[10.0, 4.0 * k] for k in range(21)]])
    rings = np.concatenate([rings, [[10.0 - 2.0 * k, height] for k in range(1, 5)]])
    angle = 2.0 * np.pi * np.arange(turns) / turns
    ring = np.column_stack([np.cos(angle), np.sin(angle), np.ones(turns)])
    vertices = np.concatenate([*(ring * [radius, radius, z] for radius, z in rings), [[0.0, 0.0, height]]])
    row, along = (part.ravel() for part in np.meshgrid(np.arange(len(rings) - 1), np.arange(turns), indexing="ij"))
    a, b = row * turns + along, row * turns + (along + 1) % turns
    top = (len(rings) - 1) * turns + np.arange(turns)
    cap = np.column_stack([top, np.roll(top, -1), np.full(turns, len(vertices) - 1)])
    return vertices, np.concatenate(
        [np.column_stack([a, b, b + turns]), np.column_stack([a, b + turns, a + turns]), cap]
    )


def obj(*lines: str) -> Callable[[Path], Any]:
    return data("\n".join(lines) + "\n")


GREYS = np.round(255 * np.clip(dome()[0][:, 2].reshape(41, 41) / 10.0, 0.0, 1.0)).astype(np.uint8)
ISLANDS = np.where(np.arange(26) == 10, np.nan, np.zeros((6, 1)))
WINDOW = np.where(np.hypot(*np.meshgrid(np.arange(-9, 10), np.arange(-9, 10))) < 4.0, np.nan, 0.0)
CLEAR = np.dstack([GREYS, GREYS, GREYS, np.zeros_like(GREYS)])


def png_bytes() -> bytes:
    stream = io.BytesIO()
    Image.fromarray(GREYS).save(stream, format="PNG")
    return stream.getvalue()


BROKEN_FILES = (
    # nothing there
    BrokenTarget("missing.obj", lambda path: None, "is not there"),
    BrokenTarget("folder.stl", lambda path: path.mkdir(), "is a folder, not a file"),
    BrokenTarget("thing.step", data("ISO-10303-21;"), "must end in .obj"),
    BrokenTarget("empty.obj", data(""), "holds no points"),
    BrokenTarget("empty.stl", data(b""), "cannot be read as STL"),
    BrokenTarget("empty.csv", data(b"\n\n"), "is empty", FIELD),
    # too large to be read in a minute
    BrokenTarget("huge.stl", sparse(61_000_000), "is larger than 60 MB: simplify it"),
    BrokenTarget("huge.npy", sparse(201_000_000), "is larger than 200 MB", FIELD),
    BrokenTarget("huge.png", sparse(51_000_000), "must be at most 50 MB", PICTURE),
    # cut short, or something else
    BrokenTarget("cut.stl", lambda path: path.write_bytes(meshed(dome())[:5000]), "is the file cut short?"),
    BrokenTarget("cut.png", data(png_bytes()[:300]), "is not a picture", PICTURE),
    BrokenTarget("binary.obj", data(b"v 0 0 0\0\1\2"), "it is not text"),
    BrokenTarget("text.npy", data("heights"), "cannot be read as an array", FIELD),
    BrokenTarget("pickle.npy", array(np.array([{}, None])), "cannot be read as an array", FIELD),
    # wrong numbers
    BrokenTarget("nan.obj", obj("v nan 0 0", "v 9 0 0", "v 0 9 0", "f 1 2 3"), "not finite"),
    BrokenTarget("word.obj", obj("v zero 0 0", "v 9 0 0", "v 0 9 0", "f 1 2 3"), "'zero' is not a number"),
    BrokenTarget("far.obj", obj("v 1e300 0 0", "v 9 0 0", "v 0 9 0", "f 1 2 3"), "too far away"),
    BrokenTarget("corner.obj", obj("v 0 0 0", "v 9 0 0", "v 0 9 0", "f 1 2 7"), "vertices are numbered from 1 to 3"),
    BrokenTarget("cloud.obj", obj("v 0 0 0", "v 9 0 0", "v 0 9 0"), "points without triangles"),
    BrokenTarget("word.csv", data("1,2,3\n4,high,6\n"), "row 2, column 2: 'high' is no number", FIELD),
    BrokenTarget("ragged.csv", data("1,2,3\n4,5\n"), "row 2 has 2 values, the first row has 3", FIELD),
    BrokenTarget("row.csv", data("1,2,3,4\n"), "has 4 x 1 values", FIELD),
    BrokenTarget("inf.npy", array(np.full((9, 9), np.inf)), "infinite heights", FIELD),
    BrokenTarget("cube.npy", array(np.zeros((5, 5, 5))), "heights have two axes", FIELD),
    BrokenTarget("complex.npy", array(np.ones((5, 5), dtype=complex)), "in place of numbers", FIELD),
    # pictures
    BrokenTarget("even.png", picture(np.full((40, 40), 90, dtype=np.uint8)), "has no contrast", PICTURE),
    BrokenTarget("clear.png", picture(CLEAR), "every value is empty", PICTURE),
    BrokenTarget("grey.png", picture(GREYS), "heights_mm (--heights-mm) is missing", FIELD),
    BrokenTarget("grey.png", picture(GREYS), "extent_mm (--extent-mm) is missing", PICTURE[:3]),
    BrokenTarget("grey.png", picture(GREYS), "must be two different numbers", ("--heights-mm", "5", "5", *FIELD)),
    BrokenTarget("grey.png", picture(GREYS), "of mm above 0", ("--heights-mm", "0", "5", "--extent-mm", "-3")),
    BrokenTarget("grey.png", picture(GREYS), "mm large, allowed are", ("--heights-mm", "0", "1", "--extent-mm", "1")),
    BrokenTarget("dome.stl", surface(dome), "belongs to pictures and arrays", PICTURE),
    BrokenTarget("field.npy", array(dome()[0]), "belongs to pictures", PICTURE),
    # no disk
    BrokenTarget("ball.stl", surface(wrong.sphere), "is closed: cut it open"),
    BrokenTarget("tube.stl", surface(lambda: cylinder_part(20.0, 2.0 * np.pi, 60.0)), "has 1 hole"),
    BrokenTarget("holes.ply", surface(lambda: wrong.plate_with_hole(3)), "has 3 holes"),
    BrokenTarget("moebius.ply", surface(wrong.moebius_strip), "has one side only"),
    BrokenTarget("handle.ply", surface(wrong.open_torus), "has a handle"),
    BrokenTarget("fin.ply", surface(wrong.fin), "3 triangles share the edge at"),
    BrokenTarget("degenerate.ply", surface(flat_triangles), "60 of 3260 triangles have no area, the first at"),
    BrokenTarget("apart.stl", surface(lambda: apart(0.01)), "corners are 0.01 mm apart at (0.0, "),
    BrokenTarget("crossing.ply", surface(wrong.crossing_sheet), "passes through itself"),
    BrokenTarget("islands.npy", array(ISLANDS), "has 2 pieces", FIELD),
    BrokenTarget("window.npy", array(WINDOW), "has 1 hole", FIELD),
    # wrong unit, or out of reach
    BrokenTarget("inches.stl", surface(dome), "mm large, allowed are 10 to 4000 mm", ("--unit", "m")),
    BrokenTarget("small.stl", surface(lambda: scaled(dome(), 0.5)), "has room for", status=1),
    BrokenTarget("spike.stl", surface(spike), "the target curves by 1/", status=1),
    BrokenTarget("hall.stl", surface(lambda: scaled(dome(), 18.0)), "make the target 1.7 times smaller", status=1),
    BrokenTarget("finger.stl", surface(finger), "must differ by a ratio", ("--nearest",), status=1),
    BrokenTarget("hemisphere.stl", surface(lambda: spherical_cap(88.0, 110.0)), "must differ by a ratio", status=1),
)  # fmt: skip
