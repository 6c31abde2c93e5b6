"""An animated picture of the release: the printed, flat sheet becomes its shape in space."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from io import BytesIO

import numpy as np
import scipy.sparse as sp
from PIL import Image
from scipy.sparse.linalg import factorized
from scipy.spatial.transform import Rotation

from asterism.draw.picture import fitting_scale, view_image
from asterism.draw.scene import View
from asterism.equilibrium.arrays import Floats
from asterism.pattern.geometry.normals import triangle_normals
from asterism.shape.shape import Shape

FRAMES = 24


def release_gif(shape: Shape, view: View, size_px: tuple[int, int], plain: bool, title: str) -> bytes:
    """A GIF of the release of a shape. All pictures have the largest scale at which the largest sheet fits."""
    shape = shape if shape.held else shape.aligned()
    shapes = [replace(shape, positions=places, held=True) for places in released(shape, FRAMES)]
    scale = fitting_scale([shapes[0], shapes[-1]], view, size_px, plain)
    images = [view_image(one, view, size_px, scale, plain, title) for one in shapes]
    colours = images[-1].quantize(256, Image.Quantize.MAXCOVERAGE)  # the same in all pictures: none flickers
    first, *others = (image.quantize(palette=colours, dither=Image.Dither.NONE) for image in images)
    stream = BytesIO()
    # ms, longest for the flat sheet and for the shape
    pauses = [900, *[70] * (FRAMES - 2), 1800]
    first.save(stream, "GIF", save_all=True, append_images=others, duration=pauses, loop=0)
    return stream.getvalue()


def released(shape: Shape, count: int) -> Iterator[Floats]:
    """Positions (V, 3) mm from the flat sheet to the shape; those between are interpolated, not computed.

    Each triangle turns and stretches evenly from print to space; the sheet fits these motions best (least squares).
    """
    printed, triangles = np.pad(shape.printed, ((0, 0), (0, 1))), shape.triangles
    turn, _ = Rotation.align_vectors(shape.positions - shape.positions.mean(0), printed - printed.mean(0))
    flat = [(printed[triangles[:, k]] - printed[triangles[:, 0]])[:, :2] for k in (1, 2)]
    inverse = np.linalg.inv(np.stack(flat, axis=2))  # of the edges (T, 2, 2) in print
    places = turn.inv().apply(shape.positions)
    edges = np.stack([places[triangles[:, k]] - places[triangles[:, 0]] for k in (1, 2)], axis=2)
    normals = triangle_normals(places, triangles)
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    whole = np.concatenate([edges @ inverse, normals[:, :, None]], axis=2)
    left, _, right = np.linalg.svd(whole)
    rotation = Rotation.from_matrix(left @ right)
    stretch = np.swapaxes(rotation.as_matrix(), 1, 2) @ whole
    # gradients (2 T, V) of values at the vertices, with respect to the print
    weights = np.stack([-inverse.sum(axis=1), inverse[:, 0], inverse[:, 1]], axis=2).reshape(-1, 3)
    rows = np.repeat(np.arange(2 * len(triangles)), 3)
    columns = np.repeat(triangles, 2, axis=0).ravel()
    gradient = sp.csr_matrix((weights.ravel(), (rows, columns)), (2 * len(triangles), len(printed)))
    areas = np.repeat(0.5 / np.abs(np.linalg.det(inverse)), 2)
    fitted = gradient.T @ sp.diags(areas)
    solve = factorized((fitted @ gradient + 1e-9 * sp.eye(len(printed))).tocsc())
    low, lowest = (points[:, 2].min() for points in (printed, shape.positions))
    for share in 0.5 - 0.5 * np.cos(np.linspace(0.0, np.pi, count)):
        motion = Rotation.from_rotvec(share * rotation.as_rotvec()).as_matrix() @ (
            np.eye(3) + share * (stretch - np.eye(3))
        )
        target = np.swapaxes(motion[:, :, :2], 1, 2).reshape(-1, 3)
        found = turn.apply(np.column_stack([solve(part) for part in (fitted @ target).T]))
        found += (1 - share) * printed.mean(0) + share * shape.positions.mean(0) - found.mean(0)
        found[:, 2] += (1 - share) * low + share * lowest - found[:, 2].min()
        yield found
