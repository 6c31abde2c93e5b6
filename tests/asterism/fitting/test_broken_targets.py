"""Files that are no target: one line each, with the file's name, and nothing is written."""

from __future__ import annotations

import io
import os
from collections.abc import Callable
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import pytest
import trimesh
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import array_shapes, arrays
from PIL import Image

from asterism import Error, load_target
from asterism.equilibrium.arrays import Floats
from tests.asterism.commands import Cli
from tests.asterism.fitting.surfaces import (
    Mesh,
    crossing_sheet,
    cylinder_part,
    dome,
    fin,
    moebius_strip,
    open_torus,
    plate_with_hole,
    sphere,
)

PICTURE = ("--heights-mm", "0", "12", "--extent-mm", "90")
FIELD = ("--extent-mm", "90")


class BrokenTarget(NamedTuple):
    """A file, what is wrong with it, and how the command ends."""

    name: str
    write: Callable[[Path], Any]
    problem: str  # words of the message
    options: tuple[str, ...] = ()  # further words of the command
    status: int = 2  # 2 for a wrong file, 1 for a surface out of reach


def meshed(mesh: Mesh) -> bytes:
    return bytes(trimesh.Trimesh(*mesh, process=False).export(file_type="stl"))


def data(content: bytes | str) -> Callable[[Path], Any]:
    return lambda path: path.write_bytes(content if isinstance(content, bytes) else content.encode())


def surface(make: Callable[[], Mesh]) -> Callable[[Path], Any]:
    return lambda path: trimesh.Trimesh(*make(), process=False).export(path)


def sparse(size: int) -> Callable[[Path], Any]:
    return lambda path: (path.touch(), os.truncate(path, size))


def array(values: Any) -> Callable[[Path], Any]:
    return lambda path: np.save(path, np.asarray(values), allow_pickle=True)


def picture(values: Any, mode: str | None = None, **options: Any) -> Callable[[Path], Any]:
    return lambda path: Image.fromarray(np.asarray(values), mode).save(path, **options)


def scaled(mesh: Mesh, factor: float) -> Mesh:
    return factor * mesh[0], mesh[1]


def flat_triangles() -> Mesh:
    """A dome with triangles whose corners lie on a line."""
    vertices, triangles = dome()
    middles = 0.5 * (vertices[:60] + vertices[1:61])
    number = np.arange(60)
    flat = np.column_stack([number, number + 1, len(vertices) + number])
    return np.concatenate([vertices, middles]), np.concatenate([triangles, flat])


def apart(gap: float) -> Mesh:
    """Two halves of a dome with a gap between."""
    vertices, triangles = dome()
    is_left = vertices[triangles].mean(axis=1)[:, 0] < 0.0
    other = np.concatenate([vertices, vertices + np.array([gap, 0.0, 0.0])])
    return other, np.concatenate([triangles[is_left], triangles[~is_left] + len(vertices)])


def finger(height: float = 80.0) -> Mesh:
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
    BrokenTarget("empty.csv", data(b"\n\n"), "is empty", FIELD),
    # too large to be read in a minute
    BrokenTarget("huge.stl", sparse(61_000_000), "is larger than 60 MB: simplify it"),
    BrokenTarget("huge.npy", sparse(201_000_000), "is larger than 200 MB", FIELD),
    BrokenTarget("huge.png", sparse(51_000_000), "must be at most 50 MB", PICTURE),
    # cut short, or something else
    BrokenTarget("cut.stl", lambda path: path.write_bytes(meshed(dome())[:5000]), "is the file cut short?"),
    BrokenTarget("cut.png", data(png_bytes()[:300]), "is not a picture", PICTURE),
    BrokenTarget("text.npy", data("heights"), "cannot be read as an array", FIELD),
    BrokenTarget("pickle.npy", array(np.array([{}, None])), "cannot be read as an array", FIELD),
    # wrong numbers
    BrokenTarget("nan.obj", obj("v nan 0 0", "v 9 0 0", "v 0 9 0", "f 1 2 3"), "not finite"),
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
    BrokenTarget("dome.stl", surface(dome), "belongs to pictures and arrays", PICTURE),
    BrokenTarget("field.npy", array(dome()[0]), "belongs to pictures", PICTURE),
    # no disk
    BrokenTarget("ball.stl", surface(sphere), "is closed: cut it open"),
    BrokenTarget("tube.stl", surface(lambda: cylinder_part(20.0, 2.0 * np.pi, 60.0)), "has 1 hole"),
    BrokenTarget("holes.ply", surface(lambda: plate_with_hole(3)), "has 3 holes"),
    BrokenTarget("moebius.ply", surface(moebius_strip), "has one side only"),
    BrokenTarget("handle.ply", surface(open_torus), "has a handle"),
    BrokenTarget("fin.ply", surface(fin), "3 triangles share the edge at"),
    BrokenTarget("degenerate.ply", surface(flat_triangles), "60 of 3260 triangles have no area, the first at"),
    BrokenTarget("apart.stl", surface(lambda: apart(0.01)), "corners are 0.01 mm apart at (0.0, "),
    BrokenTarget("crossing.ply", surface(crossing_sheet), "passes through itself"),
    BrokenTarget("islands.npy", array(ISLANDS), "has 2 pieces", FIELD),
    BrokenTarget("window.npy", array(WINDOW), "has 1 hole", FIELD),
    # wrong unit, or out of reach
    BrokenTarget("inches.stl", surface(dome), "mm large, allowed are 10 to 4000 mm", ("--unit", "m")),
    BrokenTarget("hall.stl", surface(lambda: scaled(dome(), 18.0)), "make the target 1.7 times smaller", status=1),
    BrokenTarget("finger.stl", surface(finger), "must differ by a ratio", ("--nearest",), status=1),
)  # fmt: skip


IN_ONE_FOLDER = settings(
    max_examples=30, suppress_health_check=[HealthCheck.function_scoped_fixture, HealthCheck.too_slow]
)


@pytest.mark.slow
@pytest.mark.parametrize("broken", BROKEN_FILES, ids=[f"{one.name}: {one.problem}" for one in BROKEN_FILES])
def test_the_command_ends_with_one_line(broken: BrokenTarget, tmp_path: Path, cli: Cli) -> None:
    path = tmp_path / broken.name
    broken.write(path)
    before = sorted(tmp_path.iterdir())
    outcome = cli(["fit", str(path), "--quiet", "--no-exact", *broken.options])
    assert broken.problem in outcome.line and broken.name in outcome.line
    assert outcome.status == broken.status
    assert sorted(tmp_path.iterdir()) == before


def refused_in_one_line(path: Path, **options: float | tuple[float, float]) -> bool:
    """Whether a file is refused; every other error fails the test."""
    try:
        target = load_target(path, **options)  # type: ignore[arg-type]
    except Error as error:
        assert "\n" not in str(error) and path.name in str(error)
        return True
    assert np.isfinite(target.disk.vertices).all()
    return False


SOUND = {"dome.stl": meshed(dome(points=9)), "dome.png": png_bytes()}


@pytest.mark.slow
@pytest.mark.parametrize("name", SOUND)
@given(data=st.data())
@IN_ONE_FOLDER
def test_damaged_files_are_refused_in_one_line(name: str, tmp_path: Path, data: st.DataObject) -> None:
    content = bytearray(SOUND[name])
    for _ in range(data.draw(st.integers(0, 3))):
        content[data.draw(st.integers(0, len(content) - 1))] = data.draw(st.integers(0, 255))
    path = tmp_path / name
    path.write_bytes(bytes(content[: data.draw(st.integers(0, len(content)))]))
    heights = {} if name.endswith(".stl") else {"heights_mm": (0.0, 12.0), "extent_mm": 90.0}
    refused_in_one_line(path, **heights)


@pytest.mark.slow
@given(arrays(float, array_shapes(max_dims=3, max_side=9), elements=st.floats(allow_nan=True, width=32)))
@IN_ONE_FOLDER
def test_random_arrays_are_targets_or_refused_in_one_line(tmp_path: Path, heights: Floats) -> None:
    path = tmp_path / "heights.npy"
    np.save(path, heights)
    refused_in_one_line(path, extent_mm=90.0)


@given(st.text(max_size=60))
@IN_ONE_FOLDER
def test_random_tables_are_targets_or_refused_in_one_line(tmp_path: Path, text: str) -> None:
    path = tmp_path / "heights.csv"
    path.write_text(text, encoding="utf-8", errors="surrogatepass")
    refused_in_one_line(path, extent_mm=90.0)
