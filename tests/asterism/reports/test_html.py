"""Pictures of the report."""

from __future__ import annotations

from io import BytesIO

import numpy as np
import pytest
from PIL import Image

from asterism.draw.shading import FABRIC_SIDE, PINS, PLASTIC_SIDE
from asterism.reports.html import png


@pytest.mark.slow
def test_colours_of_few_pixels_are_kept() -> None:
    """A cream sheet in all shades, with a corner of its back and a red point where it is held."""
    shade = np.linspace(0.5, 1.0, 400)[:, None] * np.linspace(0.8, 1.0, 600)
    image = np.ones((400, 600, 4))
    image[..., :3] = shade[..., None] * PLASTIC_SIDE
    image[:8, :8, :3] = PINS
    image[-8:, -8:, :3] = FABRIC_SIDE
    image[200:, :50, 3] = 0.0  # white
    found = np.asarray(Image.open(BytesIO(png(image))).convert("RGB"), dtype=float)[::-1] / 255.0
    assert np.abs(found[2:6, 2:6] - PINS).max() < 0.04
    assert np.abs(found[-6:-2, -6:-2] - FABRIC_SIDE).max() < 0.04
    assert (found[210:, :40] == 1.0).all()
    assert np.abs(found - np.where(image[..., 3:] > 0.0, image[..., :3], 1.0)).max() < 0.05
