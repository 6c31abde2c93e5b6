"""Scans of known shapes, moved in a known way."""

from __future__ import annotations

import numpy as np
from scipy.spatial.transform import Rotation

from asterism.equilibrium.arrays import Floats
from asterism.measure.scan import surface_samples
from asterism.shape.shape import Shape
from tests.asterism.sheets import sheet


def bent(points: Floats) -> Floats:
    """A sheet without any symmetry."""
    x, y = points.T
    return np.column_stack([x, y, 8 * np.sin(x / 25) + y**2 / 150 + x * y / 400])


def bent_sheet(edge: float = 3.0) -> Shape:
    """As a shape."""
    return sheet(bent, edge=edge)


def motion(seed: int) -> tuple[Floats, Floats]:
    """A rotation (3, 3) and a shift (3,) of some hundred mm."""
    rng = np.random.default_rng(seed)
    return Rotation.random(random_state=rng).as_matrix(), 200 * rng.normal(size=3)


def scanned(
    shape: Shape, seed: int, noise_mm: float = 0.2, part: float = 1.0, other: float = 0.05, count: int = 2500
) -> tuple[Floats, Floats]:
    """Points on a shape with noise, only those of a part of its width, and points of other things at the end.

    Returns
    -------
    points : (n, 3) mm, where they should be laid again; the scan is `points @ rotation.T + shift`.
    of_sheet : (n,) bool.
    """
    rng = np.random.default_rng(seed)
    points = surface_samples(shape.positions, shape.triangles, count, rng)[0]
    points = points[points[:, 0] < np.quantile(points[:, 0], part)]
    points = points + noise_mm * rng.normal(size=points.shape)
    things = rng.uniform(-60, 60, (int(other * len(points)), 3))
    return np.concatenate([points, things]), np.arange(len(points) + len(things)) < len(points)
