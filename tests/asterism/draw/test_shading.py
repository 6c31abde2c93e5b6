"""Light on a flat sheet by hand, the outline behind its edge, and the mean over rendered pixels."""

from __future__ import annotations

import numpy as np
import pytest

from asterism.draw.shading import (
    ARMS,
    FABRIC_SIDE,
    GLOSS_TABLE,
    HALFWAY,
    KEY_LIGHT,
    KEY_TABLE,
    OUTLINE_COLOUR,
    PINS,
    PLASTIC_SIDE,
    shade,
)
from asterism.equilibrium.arrays import Floats

TOWARDS_VIEWER = np.array([0.0, 0.0, 1.0])


def shaded(
    face: np.ndarray, depth: Floats, *, front: bool = True, first_arm: int = 9, first_mark: int = 9, fineness: int = 1
) -> Floats:
    """The image of triangles that all face the viewer."""
    count = int(face.max()) + 1
    normals = np.zeros((3, count, 3))
    normals[2] = TOWARDS_VIEWER * (1.0 if front else -1.0)
    rows, columns = (size // fineness for size in face.shape)
    image = np.zeros((rows, columns, 4))
    lights = np.stack([KEY_LIGHT, [0.0, 1.0, 0.0], HALFWAY])
    around = np.full((rows, columns), -1e6)
    sides, none = np.full(count, front), np.empty((3, 0, 3))
    shade(
        face, depth, around, sides, normals, none, first_arm, first_mark, lights, KEY_TABLE, GLOSS_TABLE, 2.0, 0.1,
        image,
    )  # fmt: skip
    return image


@pytest.mark.parametrize(
    ("front", "first_arm", "first_mark", "colour", "gloss"),
    [
        (True, 9, 9, PLASTIC_SIDE, 0.03),
        (False, 9, 9, FABRIC_SIDE, 0.03),
        (True, 0, 9, ARMS, 0.10),
        (True, 0, 0, PINS, 0.10),
    ],
)
def test_the_light_on_a_flat_sheet(
    front: bool, first_arm: int, first_mark: int, colour: tuple[float, float, float], gloss: float
) -> None:
    image = shaded(np.zeros((3, 3), int), np.zeros((3, 3)), front=front, first_arm=first_arm, first_mark=first_mark)
    light = 0.36 + 0.54 * (0.5 + 0.5 * KEY_LIGHT[2]) ** 1.6 + 0.13 * 0.5
    expected = np.clip(np.array(colour) * light + gloss * HALFWAY[2] ** 40, 0.0, 1.0)
    assert np.allclose(image[1, 1, :3], expected, atol=1e-3) and (image[..., 3] == 1.0).all()


def test_the_pixel_behind_an_edge_is_its_outline_and_the_rest_is_clear() -> None:
    face, depth = np.full((3, 6), -1), np.full((3, 6), -np.inf)
    face[:, :2], depth[:, :2] = 0, 0.0
    image = shaded(face, depth)
    assert np.allclose(image[:, 2, :3], OUTLINE_COLOUR) and (image[:, 2, 3] == 1.0).all()
    assert (image[:, 3:] == 0.0).all() and not np.allclose(image[:, 1, :3], OUTLINE_COLOUR)


def test_a_pixel_is_the_mean_of_the_rendered_ones_that_show_the_sheet() -> None:
    face, depth = np.full((2, 4), -1), np.full((2, 4), -np.inf)
    face[:, :1], depth[:, :1] = 0, 0.0
    image = shaded(face, depth, fineness=2)
    whole = shaded(np.zeros((2, 2), int), np.zeros((2, 2)))[0, 0, :3]
    assert np.allclose(image[0, 0, :3], (whole + OUTLINE_COLOUR) / 2) and image[0, 0, 3] == 1.0
    assert (image[0, 1] == 0.0).all()
