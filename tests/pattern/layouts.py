"""Layouts made by hand, for tests of the meshes."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike

from asterism.equilibrium.arrays import Floats
from asterism.pattern.geometry.planar import distance_to_outline, inside
from asterism.pattern.layout.layout import Layout
from asterism.pattern.layout.supports import PinSet

D = 10 * np.sqrt(3)
THREE = (-90.0, 30.0, 150.0)
SIX = tuple(30.0 + 60 * q for q in range(6))


def unit(degrees: float | Sequence[float]) -> Floats:
    """Unit vectors in the plane."""
    angle = np.radians(degrees)
    return np.stack([np.cos(angle), np.sin(angle)], axis=-1)


def hexagon(rings: int) -> Floats:
    """Border of a sheet of some rings of stars."""
    return (rings * np.sqrt(3) + 1.5) * 10 * unit(SIX)


def lattice_points(reach: int, vectors: Floats) -> Floats:
    """Lattice points around the origin."""
    span = np.arange(-reach, reach + 1)
    return np.stack(np.meshgrid(span, span, indexing="ij"), axis=-1).reshape(-1, 2) @ vectors


def layout(
    border: ArrayLike,
    centres: ArrayLike,
    length: float | Floats = 10.0,
    directions: Sequence[float] = THREE,
    pins: tuple[PinSet, ...] = (),
    vectors: ArrayLike | None = None,
) -> Layout:
    """Stars at `centres`, with arms of one length, or one a star, in the given directions (degrees)."""
    centres = np.asarray(centres, dtype=float).reshape(-1, 2)
    vectors = D * unit([30.0, 90.0]) if vectors is None else np.asarray(vectors, dtype=float)
    star = np.repeat(np.arange(len(centres)), len(directions))
    lengths = np.broadcast_to(length, (len(centres),))[star]
    tip = centres[star] + lengths[:, None] * np.tile(unit(directions), (len(centres), 1))
    return Layout(
        outline=np.asarray(border, dtype=float),
        centres=centres,
        arm_star=star,
        arm_tip=tip,
        arm_sections=np.tile([0.3, 1.2], (len(star), 2, 1)),
        pins=pins,
        lattice_vectors=vectors,
        lattice_origin=np.zeros(2),
    )


def rings(
    n: int, length: float | Floats = 10.0, directions: Sequence[float] = THREE, pins: tuple[PinSet, ...] = ()
) -> Layout:
    """A hexagon of n rings of stars around the central one."""
    centres = lattice_points(n, D * unit([30.0, 90.0]))
    away = np.abs(centres @ unit([0.0, 60.0, 120.0]).T).max(axis=1)
    return layout(hexagon(n), centres[away < (n + 0.1) * 15], length, directions, pins)


def pin(points: ArrayLike = (), edges: tuple[int, ...] = ()) -> PinSet:
    """Points and border edges held fixed."""
    return PinSet(np.asarray(points, dtype=float).reshape(-1, 2), edges, (True, True, True))


def stars_on(
    border: Floats,
    length: float,
    directions: Sequence[float] = THREE,
    margin: float = 0.0,
    pins: tuple[PinSet, ...] = (),
) -> Layout:
    """Stars wherever whole stars fit on a sheet, `margin` mm from its outline."""
    centres = lattice_points(6, D * unit([30.0, 90.0]))
    ends = [centres, *(centres + length * direction for direction in unit(directions))]
    fits = np.all([inside(e, border) & (distance_to_outline(e, border) > margin) for e in ends], axis=0)
    return layout(border, centres[fits], length, directions, pins)


# with a reentrant corner; with no two sides parallel; with many short sides
L_SHAPE = np.array([[-45, -45], [45, -45], [45, 0], [0, 0], [0, 45], [-45, 45]], dtype=float)
SLANTED = np.array([[-50, -35], [50, -30], [40, 40], [-45, 35]], dtype=float)
ROUND = 45 * unit([6.0 * q for q in range(60)])
RECTANGLE = np.array([[-40, -32], [40, -32], [40, 32], [-40, 32]], dtype=float)
