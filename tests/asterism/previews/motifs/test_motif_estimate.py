"""Estimated errors of previews of motifs: on low sheets the error of the height is one in mm."""

from __future__ import annotations

import pytest

from asterism.previews.motifs.motif_kind import MOTIF_ERROR
from asterism.previews.session import Preview
from tests.asterism.previews.motifs.nets import net, net_law


@pytest.mark.slow
@pytest.mark.parametrize("scale", [0.8, 0.99])
def test_the_height_is_known_to_millimetres_and_to_percent(scale: float) -> None:
    design = net(pins=[{"where": "corners", "scale": scale}])
    shape = Preview(design, net_law(design)).shape()
    percent = shape.summary["expected_height_percent"]
    least = (MOTIF_ERROR.height_percent**2 + (100.0 * MOTIF_ERROR.height_mm / shape.height_mm) ** 2) ** 0.5
    assert percent >= least and 0.01 * percent * shape.height_mm > MOTIF_ERROR.height_mm
