"""Layouts made by hand, for tests of the meshes."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from pattern.layout import Floats, Layout, PinSet

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
    border: Floats,
    centres: Floats,
    length: float | Floats = 10.0,
    directions: Sequence[float] = THREE,
    pins: tuple[PinSet, ...] = (),
    vectors: Floats | None = None,
) -> Layout:
    """Stars at `centres`, with arms of one length, or one a star, in the given directions (degrees)."""
    centres = np.asarray(centres, dtype=float)
    vectors = D * unit([30.0, 90.0]) if vectors is None else np.asarray(vectors, dtype=float)
    star = np.repeat(np.arange(len(centres)), len(directions))
    lengths = np.broadcast_to(length, (len(centres),))[star]
    tip = centres[star] + lengths[:, None] * np.tile(unit(directions), (len(centres), 1))
    i, j = np.triu_indices(len(centres), 1)
    apart = np.linalg.norm(centres[i] - centres[j], axis=1)
    near = apart < 1.01 * np.linalg.norm(vectors, axis=1).min()
    return Layout(
        border=np.asarray(border, dtype=float),
        centres=centres,
        arm_star=star,
        arm_tip=tip,
        arm_thickness=np.full((len(star), 2), 0.3),
        arm_width=np.full((len(star), 2), 1.2),
        neighbours=np.column_stack([i[near], j[near]]),
        pins=pins,
        lattice_vectors=vectors,
        lattice_origin=np.zeros(2),
    )


def rings(
    n: int,
    length: float | Floats = 10.0,
    directions: Sequence[float] = THREE,
    pins: tuple[PinSet, ...] = (),
) -> Layout:
    """A hexagon of n rings of stars around the central one."""
    centres = lattice_points(n, D * unit([30.0, 90.0]))
    away = np.abs(centres @ unit([0.0, 60.0, 120.0]).T).max(axis=1)
    return layout(hexagon(n), centres[away < (n + 0.1) * 15], length, directions, pins)


def pin(points: object = (), edges: tuple[int, ...] = ()) -> PinSet:
    """Points and border edges held fixed."""
    return PinSet(np.asarray(points, dtype=float).reshape(-1, 2), edges, (True, True, True))
