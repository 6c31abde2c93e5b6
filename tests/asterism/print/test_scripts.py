"""The scripts for OpenSCAD and IceSL make the solids of the STL."""

from __future__ import annotations

import ast
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import shapely

from asterism.pattern.design.design import Design
from asterism.print.formats.scripts import write_icesl, write_openscad
from asterism.print.job import Job
from asterism.print.solid import Piece
from tests.asterism.print.jobs import LEAF, design, job

TAPER = {"profile": "radial", "from": 0.6, "to": 0.3, "over_mm": 30.0}


@pytest.fixture(scope="module")
def tapered() -> Job:
    stars = {"length_mm": 8.0, "thickness_mm": TAPER, "vary_along_arms": True}
    return job(design(fabric={}, stars=stars), turn_deg=20.0)


@pytest.fixture(scope="module", params=["stars", "rods"])
def one(request: pytest.FixtureRequest) -> Job:
    """Stars in layers, or drawn lines."""
    if request.param == "stars":
        return request.getfixturevalue("tapered")
    return job(Design.from_dict(LEAF), turn_deg=30.0)


def volume(prisms: list[tuple[float, shapely.Polygon]]) -> float:
    """Volume of the union of prisms that stand on the ground."""
    heights = sorted({height for height, _ in prisms})
    return sum(
        shapely.union_all([region for h, region in prisms if h >= height]).area * (height - below)
        for height, below in zip(heights, [0.0, *heights], strict=False)
    )


def check(prisms: list[tuple[float, shapely.Polygon]], one: Job) -> None:
    """They are as large as the solid, and where it is."""
    solid, accuracy = one.solids[0], 3e-4 if one.arms else 2e-3
    assert volume(prisms) == pytest.approx(solid.volume_mm3, rel=accuracy)
    box = shapely.union_all([region for _, region in prisms]).bounds
    assert box == pytest.approx([*solid.box[0, :2], *solid.box[1, :2]], abs=0.005)


def test_lua_runs_and_makes_the_plastic(one: Job, tmp_path: Path) -> None:
    lupa = pytest.importorskip("lupa")
    write_icesl(tmp_path / "a.lua", one)
    lua = lupa.LuaRuntime()
    emitted: list[Any] = []

    # what IceSL adds to Lua, as far as the script uses it
    def linear_extrude(along: tuple[float, float, float], outline: Any) -> list[Any]:
        assert along[:2] == (0, 0)
        points = [outline[k] for k in range(1, len(outline) + 1)]
        assert all(z == 0 for *_, z in points)
        ring = shapely.LinearRing([point[:2] for point in points])
        assert ring.is_ccw and ring.is_simple
        return [(round(along[2], 6), shapely.Polygon(ring))]

    lua.globals().v = lambda x, y, z: (x, y, z)
    lua.globals().linear_extrude = linear_extrude
    lua.globals().union = lambda one, other: one + other
    lua.globals().emit = emitted.append
    lua.execute((tmp_path / "a.lua").read_text())
    assert len(emitted) == (len(one.plan.centres) or len(one.plan.graph.rods))
    check([prism for part in emitted for prism in part], one)


def test_the_table_of_openscad_holds_the_plastic(one: Job, tmp_path: Path) -> None:
    write_openscad(tmp_path / "a.scad", one)
    text = (tmp_path / "a.scad").read_text()
    assert one.arms or "star" not in text
    table = ast.literal_eval(re.search(r"parts = (\[.*?\n\]);", text, re.DOTALL)[1])  # type: ignore[index]
    if one.arms:  # one star is moved by the numbers of its centre
        centres = one.placement.points(one.plan.centres) + one.printer.bed_centre_mm
        assert np.array([part[:2] for part in table]) == pytest.approx(centres, abs=1e-6)
    prisms = []
    for x, y, part in table:
        for height, begin, end, corners in part:
            points = np.array(corners) + np.array([x, y, 0.0])
            prisms.append((height, Piece(0, points[:, :2], points[:, 2], height, (begin == 1, end == 1)).region))
    check(prisms, one)


def test_a_name_stays_within_its_comment(tmp_path: Path) -> None:
    one = job(design(name="ring ]] } ' \" -- //"))
    write_icesl(tmp_path / "a.lua", one)
    write_openscad(tmp_path / "a.scad", one)
    for file, sign in (("a.lua", "--"), ("a.scad", "//")):
        first, second, *_ = (tmp_path / file).read_text().splitlines()
        assert first.startswith(f"{sign} ring ]] }} ' \" -- //: stars") and second.startswith(sign)
