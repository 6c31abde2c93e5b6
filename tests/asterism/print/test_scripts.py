"""The scripts for OpenSCAD and IceSL make the solids of the STL."""

from __future__ import annotations

import ast
import re
import shutil
import subprocess
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import shapely
import trimesh

from asterism.print.formats.scripts import write_icesl, write_openscad
from asterism.print.job import Job
from asterism.print.solid import Piece
from tests.asterism.print.jobs import design, job

TAPER = {"profile": "radial", "from": 0.6, "to": 0.3, "over_mm": 30.0}


@pytest.fixture(scope="module")
def tapered() -> Job:
    stars = {"length_mm": 8.0, "thickness_mm": TAPER, "vary_along_arms": True}
    return job(design(fabric={}, stars=stars), turn_deg=20.0)


def volume(prisms: list[tuple[float, shapely.Polygon]]) -> float:
    """Volume of the union of prisms that stand on the ground."""
    heights = sorted({height for height, _ in prisms})
    return sum(
        shapely.union_all([region for h, region in prisms if h >= height]).area * (height - below)
        for height, below in zip(heights, [0.0, *heights], strict=False)
    )


def test_lua_runs_and_makes_the_stars(tapered: Job, tmp_path: Path) -> None:
    lupa = pytest.importorskip("lupa")
    write_icesl(tmp_path / "stars.lua", tapered)
    lua = lupa.LuaRuntime()
    emitted: list[Any] = []

    # what IceSL adds to Lua, as far as the script uses it
    def vector(x: float, y: float, z: float) -> tuple[float, float, float]:
        return x, y, z

    def linear_extrude(along: tuple[float, float, float], outline: Any) -> list[Any]:
        assert along[:2] == (0, 0)
        points = [outline[k] for k in range(1, len(outline) + 1)]
        assert all(z == 0 for *_, z in points)
        ring = shapely.LinearRing([point[:2] for point in points])
        assert ring.is_ccw and ring.is_simple
        return [(round(along[2], 6), shapely.Polygon(ring))]

    lua.globals().v = vector
    lua.globals().linear_extrude = linear_extrude
    lua.globals().union = lambda one, other: one + other
    lua.globals().emit = emitted.append
    lua.execute((tmp_path / "stars.lua").read_text())
    assert len(emitted) == len(tapered.plan.centres)
    solid = tapered.solids[0]
    assert volume([prism for star in emitted for prism in star]) == pytest.approx(solid.volume_mm3, rel=3e-4)
    box = shapely.union_all([region for star in emitted for _, region in star]).bounds
    assert box == pytest.approx([*solid.box[0, :2], *solid.box[1, :2]], abs=0.002)


def test_the_table_of_openscad_holds_the_stars(tapered: Job, tmp_path: Path) -> None:
    write_openscad(tmp_path / "stars.scad", tapered)
    text = (tmp_path / "stars.scad").read_text()
    table = ast.literal_eval(re.search(r"parts = (\[.*?\n\]);", text, re.DOTALL)[1])
    # one star is moved by the numbers of its centre
    centres = tapered.placement.points(tapered.plan.centres) + tapered.printer.bed_centre_mm
    assert np.array([star[:2] for star in table]) == pytest.approx(centres, abs=1e-6)
    prisms = [
        (height, Piece(0, points[:, :2], points[:, 2], height, (begin, end)).region)
        for x, y, star in table
        for height, begin, end, points in (
            (h, b == 1, e == 1, np.array(p) + np.array([x, y, 0.0])) for h, b, e, p in star
        )
    ]
    assert volume(prisms) == pytest.approx(tapered.solids[0].volume_mm3, rel=3e-4)


@pytest.mark.skipif(shutil.which("openscad") is None, reason="OpenSCAD is not installed")
def test_openscad_itself_makes_the_solid_of_the_stl(tapered: Job, tmp_path: Path) -> None:
    write_openscad(tmp_path / "stars.scad", tapered)
    command = ["openscad", "-o", str(tmp_path / "stars.off"), str(tmp_path / "stars.scad")]
    subprocess.run(command, check=True, capture_output=True, timeout=300)
    mesh, solid = trimesh.load_mesh(tmp_path / "stars.off"), tapered.solids[0]
    assert mesh.is_watertight
    assert mesh.volume == pytest.approx(solid.volume_mm3, rel=3e-4)
    assert np.abs(mesh.bounds - solid.box).max() < 0.002


def test_a_name_stays_within_its_comment(tmp_path: Path) -> None:
    one = job(design(name="ring ]] } ' \" -- //"))
    write_icesl(tmp_path / "a.lua", one)
    write_openscad(tmp_path / "a.scad", one)
    for file, sign in (("a.lua", "--"), ("a.scad", "//")):
        first, second, *_ = (tmp_path / file).read_text().splitlines()
        assert first.startswith(f"{sign} ring ]] }} ' \" -- //: stars") and second.startswith(sign)
