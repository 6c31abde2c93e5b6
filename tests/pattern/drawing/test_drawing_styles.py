"""Every style in which drawing programs write a line is read to 0.01 mm of the curve that it stands for."""

from __future__ import annotations

from collections.abc import Callable
from itertools import pairwise
from pathlib import Path

import ezdxf
import numpy as np
import pytest
import shapely
from ezdxf.layouts import Modelspace
from scipy.interpolate import BSpline

from asterism.pattern.drawing.read import read_drawing
from asterism.pattern.drawing.records import FileLine
from benchmarks.fuzz.nested import difference, write_nested

CURVE_MM, WITHIN_MM = 0.005, 0.01


def distance(line: FileLine, curve: np.ndarray) -> float:
    """mm, the largest one between a line and a finely sampled curve, and between their ends."""
    apart = shapely.hausdorff_distance(shapely.LineString(line.points), shapely.LineString(curve), densify=0.1)
    ends = min(np.abs(line.points[[0, -1]] - curve[list(order)]).max() for order in ((0, -1), (-1, 0)))
    return float(max(apart, ends))


def straight(*points: tuple[float, float]) -> np.ndarray:
    corners, part = np.array(points, dtype=float), np.linspace(0.0, 1.0, 20)[:, None]
    return np.concatenate([a * (1.0 - part) + b * part for a, b in pairwise(corners)])


def ellipse(
    centre: tuple[float, float], x: float, y: float, first: float, last: float, turned: float = 0.0
) -> np.ndarray:
    t = np.radians(np.linspace(first, last, 500))
    cos, sin = np.cos(np.radians(turned)), np.sin(np.radians(turned))
    return np.asarray(np.column_stack([x * np.cos(t), y * np.sin(t)]) @ np.array([[cos, sin], [-sin, cos]]) + centre)


def bezier(*control: tuple[float, float]) -> np.ndarray:
    degree = len(control) - 1
    knots = np.repeat([0.0, 1.0], degree + 1)
    return np.asarray(BSpline(knots, np.array(control, dtype=float), degree)(np.linspace(0.0, 1.0, 500)))


def spline(space: Modelspace) -> None:
    space.add_open_spline([(0, 0), (10, 20), (30, -20), (40, 0)], degree=3)


DXF: dict[str, tuple[Callable[[Modelspace], object], np.ndarray]] = {
    "line": (lambda space: space.add_line((1, 2), (30, 5)), straight((1, 2), (30, 5))),
    "arc": (lambda space: space.add_arc((5, 6), 20, 30, 200), ellipse((5, 6), 20, 20, 30, 200)),
    "circle": (lambda space: space.add_circle((5, 6), 20), ellipse((5, 6), 20, 20, 0, 360)),
    "ellipse": (
        lambda space: space.add_ellipse((5, 6), (0, 20), 0.5, 0.0, np.pi),
        ellipse((5, 6), 20, 10, 0, 180, turned=90),
    ),
    "polyline": (lambda space: space.add_polyline2d([(0, 0), (20, 5), (30, -5)]), straight((0, 0), (20, 5), (30, -5))),
    "polyline with a bulge": (
        lambda space: space.add_lwpolyline([(20, 0, 1.0), (-20, 0, 0.0)], format="xyb"),
        ellipse((0, 0), 20, 20, 0, 180),
    ),
    "spline": (spline, bezier((0, 0), (10, 20), (30, -20), (40, 0))),
}


@pytest.mark.parametrize("kind", DXF)
def test_lines_of_cad_programs(kind: str, tmp_path: Path) -> None:
    draw, curve = DXF[kind]
    drawing = ezdxf.new(units=4)
    draw(drawing.modelspace())
    drawing.saveas(tmp_path / "one.dxf")
    (line,) = read_drawing(tmp_path / "one.dxf", CURVE_MM).lines
    assert distance(line, curve) < WITHIN_MM


# y goes down in the file
SVG: dict[str, tuple[str, np.ndarray]] = {
    "line": ('<line x1="1" y1="2" x2="30" y2="5"/>', straight((1, -2), (30, -5))),
    "polyline": ('<polyline points="0,0 20,5 30,-5"/>', straight((0, 0), (20, -5), (30, 5))),
    "polygon": ('<polygon points="0,0 20,5 30,-5"/>', straight((0, 0), (20, -5), (30, 5), (0, 0))),
    "rectangle": (
        '<rect x="1" y="2" width="30" height="10"/>',
        straight((1, -2), (31, -2), (31, -12), (1, -12), (1, -2)),
    ),
    "circle": ('<circle cx="50" cy="40" r="30"/>', ellipse((50, -40), 30, 30, 0, 360)),
    "ellipse": ('<ellipse cx="50" cy="40" rx="30" ry="10"/>', ellipse((50, -40), 30, 10, 0, 360)),
    "arc of a path": ('<path d="M 20 0 A 20 20 0 0 0 -20 0"/>', ellipse((0, 0), 20, 20, 0, 180)),
    "relative cubic": ('<path d="m 10 10 c 10 20 30 -20 40 0"/>', bezier((10, -10), (20, -30), (40, 10), (50, -10))),
    "quadratic": ('<path d="M 0 0 Q 20 30 40 0"/>', bezier((0, 0), (20, -30), (40, 0))),
    "turned and scaled": (
        '<g transform="translate(5,-6)"><path transform="rotate(-90) scale(2)" d="M 0 0 H 10 V 5"/></g>',
        straight((5, 6), (5, 26), (15, 26)),
    ),
}


@pytest.mark.parametrize("kind", SVG)
@pytest.mark.parametrize("inches", [False, True], ids=["mm", "in"])
def test_lines_of_drawing_programs(kind: str, inches: bool, tmp_path: Path) -> None:
    text, curve = SVG[kind]
    size = '3.93700787402in" height="3.93700787402in' if inches else '100mm" height="100mm'
    head = f'<svg xmlns="http://www.w3.org/2000/svg" width="{size}" viewBox="0 0 100 100">'
    (tmp_path / "one.svg").write_text(f'{head}<g fill="none" stroke="black" stroke-width="1">{text}</g></svg>')
    (line,) = read_drawing(tmp_path / "one.svg", CURVE_MM).lines
    assert distance(line, curve) < WITHIN_MM


@pytest.mark.slow
@pytest.mark.parametrize("first", [0, 40])
def test_nested_drawings_are_read_as_trees(first: int, tmp_path: Path) -> None:
    """Groups, blocks and copies at random, against a reader that walks the tree."""
    for seed in range(first, first + 40):
        assert difference(write_nested(seed, tmp_path)) == "", seed
