"""Prints of drawn rods: solids, scripts, sheets, needles, and middle lines that are read again."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import shapely
import trimesh

from asterism import Design, ExportSettings, export, load_design
from asterism.pattern import gallery
from asterism.pattern.drawing.read import read_drawing
from asterism.pattern.layout.build import layout
from asterism.pattern.rods.graph import RodGraph
from asterism.print.export import PrintExport
from asterism.print.formats.drawings import write_dxf
from asterism.print.job import Job
from asterism.print.needles import needles_near_edge
from asterism.print.rounding import tiny_pieces
from asterism.print.sheets import middle_lines
from tests.asterism.commands import Cli
from tests.asterism.print.jobs import LEAF, job

TAPERED: dict[str, Any] = {
    "rods": {
        "thickness_mm": {"profile": "radial", "from": 0.6, "to": 0.2, "over_mm": 20.0},
        "draw": [{"name": "bow", "arc_mm": {"radius": 15.0, "from_deg": 0.0, "to_deg": 90.0, "centre": (-10.0, 0.0)}}],
    },
    "border": {"rectangle_mm": (50.0, 50.0)},
}


def drawn(data: dict[str, Any] = LEAF, **options: Any) -> Job:
    return job(Design.from_dict(data), **options)


def test_names_of_layers_that_every_dxf_has(tmp_path: Path) -> None:
    lines = [{"name": name, "line_mm": [(-20, y), (20, y)]} for y, name in ((-5, "0"), (5, "Defpoints"))]
    one = drawn({"rods": {"draw": lines}, "border": {"rectangle_mm": (60, 40)}})
    write_dxf(tmp_path / "lines.dxf", middle_lines(one))
    assert {"0", "Defpoints"} <= {line.layer for line in read_drawing(tmp_path / "lines.dxf", 0.005).lines}


@pytest.fixture(scope="module")
def leaf(tmp_path_factory: pytest.TempPathFactory) -> tuple[PrintExport, Path]:
    """The export of the leaf, and its folder."""
    folder = tmp_path_factory.mktemp("leaf")
    return export(Design.from_dict(LEAF), folder), folder


@pytest.mark.slow
def test_solids_are_closed_and_as_large_as_the_lines(leaf: tuple[PrintExport, Path]) -> None:
    exported, folder = leaf
    mesh = trimesh.load_mesh(folder / "rods.stl")
    graph = exported.job.plan.graph
    lines = sum(rod.length * rod.width[0] * rod.thickness[0] for rod in graph.rods)
    assert mesh.is_watertight and mesh.volume == pytest.approx(lines, rel=0.05)  # lines overlap where they meet
    assert exported.summary.solids["rods"].volume_mm3 == pytest.approx(mesh.volume, rel=1e-4)
    assert "border" not in exported.summary.solids and not exported.summary.printed_border
    assert "Cut along" not in (text := (folder / "instructions.txt").read_text()) and "outer edge of the" in text


def test_a_straight_line_is_a_box_of_its_size() -> None:
    line = {"draw": [{"line_mm": [(-10, 0), (10, 0)]}], "thickness_mm": 0.4}
    (rods,) = drawn({"rods": line, "border": {"rectangle_mm": (40.0, 20.0)}}, border=False).solids
    np.testing.assert_allclose(np.ptp(rods.box, axis=0), [20.0, 1.2, 0.4], atol=1e-3)


def test_a_rim_is_cut_along_its_outer_edge() -> None:
    one = drawn()
    inside, cut = shapely.Polygon(one.plan.outline), shapely.Polygon(one.cut[0])
    assert len(one.cut) == 1 and cut.buffer(1e-3).covers(inside) and cut.is_valid
    assert shapely.hausdorff_distance(cut.exterior, inside.exterior) == pytest.approx(0.8, abs=0.02)
    assert cut.buffer(1e-3).covers(shapely.union_all([rod.region for rod in one.rods if rod.number in one.plan.rim]))


def test_tapered_rods_are_printed_in_layers() -> None:
    one = drawn(TAPERED)
    rod = one.plan.graph.rods[0]
    assert [step.height_mm for step in one.pattern] == sorted(set(rod.thickness)) and one.is_rounded
    assert len(one.pattern) == 2
    volume = np.trapezoid(rod.thickness, rod.arc_lengths) * 1.2
    assert one.solids[0].volume_mm3 == pytest.approx(volume, rel=0.01)
    assert one.size_changes["thickness"].rods_changed == 1 and one.size_changes["thickness"].stars_changed == 0


def same_graph(one: RodGraph, other: RodGraph, shift: np.ndarray) -> float:
    """mm, the largest distance of nodes and of lines of two drawings; infinite if they differ in kind."""
    if len(one.rods) != len(other.rods) or len(one.joints) != len(other.joints):
        return np.inf
    lines = [shapely.LineString(rod.points) for rod in one.rods]
    moved = [shapely.LineString(rod.points + shift) for rod in other.rods]
    return max(min(shapely.hausdorff_distance(a, b) for b in moved) for a in lines)


@pytest.mark.slow
@pytest.mark.parametrize("suffix", ["svg", "dxf"])
def test_middle_lines_are_read_again_within_a_micrometre(leaf: tuple[PrintExport, Path], suffix: str) -> None:
    _, folder = leaf
    layers = {"rim": {"thickness_mm": 0.6}, "rib": {"thickness_mm": 0.4}, "vein": {"thickness_mm": 0.4}}
    drawing = {"file": f"middle-lines.{suffix}", "width": "stroke", "layers": layers}
    rods = {"import": [drawing], "curve_mm": 0.0005}
    again = layout(Design.from_dict({"rods": rods, "border": {"rectangle_mm": (90, 50)}}, folder)).graph
    first = layout(load_design(folder / "rounded.toml")).graph
    corners = np.concatenate([rod.points for rod in first.rods])
    middle = 0.5 * (corners.min(axis=0) + corners.max(axis=0))
    assert same_graph(first, again, middle) < 1e-3
    widths = [sorted({(round(rod.width[0], 3), rod.thickness[0]) for rod in one.rods}) for one in (first, again)]
    assert widths[0] == widths[1]


def test_needles_on_a_curved_outline_are_evenly_spaced() -> None:
    ring = {"draw": [{"name": "rim", "circle_mm": {"radius": 20.0}}]}
    one = drawn({"rods": ring, "border": {"rods": "rim"}, "pins": [{"where": "border"}]}, needle_spacing_mm=20.0)
    printed = np.array([needle.printed for needle in one.needles])
    steps = np.linalg.norm(printed - np.roll(printed, -1, axis=0), axis=1)
    assert len(printed) == 7 and np.ptp(steps) < 0.01
    assert one.needles_in_plastic == needles_near_edge(one.plan, one.needles) == list(range(1, 8))


def test_islands_that_may_jump_off_are_named() -> None:
    dot = {"line_mm": [(0, 10), (2, 10)]}
    cross = [{"line_mm": [(-10, 0), (10, 0)]}, {"line_mm": [(0, -1), (0, 1)]}]
    one = drawn({"rods": {"draw": [dot, *cross]}, "border": {"rectangle_mm": (40.0, 40.0)}})
    assert tiny_pieces(one.plan, 3.0) == [{"at_mm": [1.0, 10.0], "arm_mm": 2.0}]


@pytest.mark.slow
def test_the_command_exports_a_drawing_and_says_that_no_preview_is_known(here: Path, cli: Cli) -> None:
    (here / "bow.toml").write_text(
        'name = "bow"\n[rods]\nthickness_mm = 0.33\n[[rods.draw]]\nline_mm = [[-10, 0], [0, 5], [10, 0]]\n'
        "[border]\nrectangle_mm = [40, 30]\n"
    )
    printed = cli(["export", "bow.toml"]).done.out
    assert "2 of 2 rods rounded" in printed and "use --simulate" in printed
    files = {"rods.stl", "border.stl", "print.3mf", "rods.scad", "middle-lines.svg", "start.gcode"}
    assert files <= {file.name for file in (here / "bow-print").iterdir()}


def test_holes_have_cut_lines_and_a_printed_line_to_cut_along() -> None:
    window = {"name": "window", "circle_mm": {"centre": (12.0, 0.0), "radius": 5.0}}
    holes = [{"circle_mm": {"centre": (-12.0, 0.0), "radius": 5.0}}, {"rods": "window"}]
    lines = [window, {"line_mm": [(-20, 9), (20, 9)]}]
    one = drawn({"rods": {"draw": lines}, "border": {"rectangle_mm": (50.0, 30.0), "holes": holes}})
    plain, inner = (shapely.Polygon(line) for line in sorted(one.cut[1:], key=lambda line: float(line[:, 0].mean())))
    np.testing.assert_allclose(shapely.Polygon(one.cut[0]).area, 1500.0)  # no plastic beyond it counts
    assert len(one.cut) == 3 and plain.area == pytest.approx(25 * np.pi, rel=1e-3)
    assert inner.area == pytest.approx(4.4**2 * np.pi, rel=5e-3)  # along the inner edge of the rim
    assert one.border is not None and one.border.region.intersection(plain).area > 5.0
    assert one.border.region.intersection(shapely.Point(12.0, 0.0).buffer(5.6)).area < 1e-6


@pytest.mark.slow
def test_a_supported_sheet_with_a_rim_has_its_needles_and_its_outline_in_space(tmp_path: Path) -> None:
    """The mesh has chords of the rim, off which the printed outline lies."""
    ring = {"draw": [{"name": "rim", "circle_mm": {"radius": 14.0}}], "thickness_mm": 0.55}
    pins = [{"points_mm": [(14, 0), (0, 14), (-14, 0)], "slide": "z", "scale": 0.9}]
    design = Design.from_dict({"rods": ring, "border": {"rods": "rim"}, "pins": pins, "mesh": {"edge_mm": 4.0}})
    exported = export(design, tmp_path, ExportSettings(simulate=True))
    assert exported.summary.shape_change is not None and exported.summary.shape_change.star_distance_mm > 0.0
    heights = [needle.height_mm for needle in exported.job.needles]
    assert len(heights) == 3 and min(heights) == 0.0
    assert {"needles.svg", "shape.glb", "rods.vtu"} <= set(exported.files)


@pytest.mark.slow
@pytest.mark.parametrize("name", gallery.pattern_names())
def test_the_drawn_patterns_of_the_gallery_fit_the_papers_printer(name: str) -> None:
    one = job(gallery.load(name))
    assert one.too_large == "" and not one.is_rounded
    expected = sum(rod.length * rod.width[0] * rod.thickness[0] for rod in one.plan.drawn_rods)
    assert one.solids[0].volume_mm3 == pytest.approx(expected, rel=0.15)  # lines overlap where they meet
