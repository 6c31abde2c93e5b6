"""Files that a page sends: outlines in SVG, CSV and DXF, and grey pictures."""

from __future__ import annotations

from io import StringIO
from typing import Any

import ezdxf
import numpy as np
import pytest
from starlette.testclient import TestClient

from tests.asterism.studio.conftest import upload

SQUARE = [(10.0, 20.0), (110.0, 20.0), (110.0, 80.0), (10.0, 80.0)]
CENTRED = {(-50.0, -30.0), (50.0, -30.0), (50.0, 30.0), (-50.0, 30.0)}


def dxf(draw: Any, unit: int = 4) -> bytes:
    drawing = ezdxf.new(units=unit)
    draw(drawing.modelspace())
    out = StringIO()
    drawing.write(out)
    return out.getvalue().encode()


def rectangle(space: Any) -> None:
    space.add_lwpolyline(SQUARE, close=True)
    space.add_circle((60, 50), 5)


def lines_that_cross(space: Any) -> None:
    for y in (20, 80):
        space.add_line((0, y), (120, y))
    for x in (10, 110):
        space.add_line((x, 0), (x, 100))


@pytest.mark.slow
def test_an_outline_in_svg_or_dxf_is_centred(client: TestClient):
    svg = b'<svg xmlns="http://www.w3.org/2000/svg" width="200mm" height="200mm" viewBox="0 0 200 200">'
    svg += b'<rect x="10" y="20" width="100" height="60"/></svg>'
    for name, content in (("a.dxf", dxf(rectangle)), ("a.dxf", dxf(lines_that_cross)), ("a.svg", svg)):
        corners = upload(client, "outline", name, content).json()["border"]["polygon_mm"]
        assert {tuple(corner) for corner in corners} == CENTRED
    content = dxf(lambda space: space.add_circle((1, 1), 2), unit=1)  # inches
    corners = np.array(upload(client, "outline", "a.dxf", content).json()["border"]["polygon_mm"])
    np.testing.assert_allclose(np.hypot(*corners.T), 50.8, atol=0.05)
    assert 20 < len(corners) < 200
