"""Boundary-first flattening: angles are kept, developable surfaces keep their lengths, caps have the known ratio."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from asterism.equilibrium.arrays import Floats
from asterism.fitting.disk import disk_of
from asterism.fitting.flatten import FlatDisk, Flattener, least_ratio_border
from benchmarks.fit_targets import rectangle_mesh
from tests.asterism.fitting.surfaces import cylinder_part, spherical_cap


def singular_values(flat: FlatDisk) -> Floats:
    """(T, 2) principal scale factors of each triangle, the larger first."""
    disk = flat.disk
    a, b, c = (disk.vertices[disk.triangles[:, k]] for k in range(3))
    first = (b - a) / np.linalg.norm(b - a, axis=1, keepdims=True)
    normal = np.cross(b - a, c - a)
    second = np.cross(normal / np.linalg.norm(normal, axis=1, keepdims=True), first)
    frame = np.stack([first, second], axis=1)
    on_surface = np.stack([np.einsum("tfc,tc->tf", frame, edge) for edge in (b - a, c - a)], axis=-1)
    p, q, r = (flat.points[disk.triangles[:, k]] for k in range(3))
    on_plane = np.stack([q - p, r - p], axis=-1)
    return np.linalg.svd(on_plane @ np.linalg.inv(on_surface), compute_uv=False)


@pytest.mark.parametrize("half_angle", [20.0, 85.0])
def test_the_ratio_of_a_cap_is_the_known_one(half_angle: float) -> None:
    flat = Flattener(disk_of(*spherical_cap(half_angle), "cap")).flatten()
    assert flat.ratio == pytest.approx(1.0 / np.cos(np.deg2rad(half_angle) / 2.0) ** 2, rel=1e-3)
    assert flat.flipped == 0


def test_angles_are_kept_better_on_finer_meshes_and_the_scale_is_that_of_the_equation() -> None:
    errors = []
    for rings in (8, 16, 32):
        flat = Flattener(disk_of(*spherical_cap(50.0, rings=rings), "cap")).flatten()
        values = singular_values(flat)
        errors.append(np.sqrt((np.log(values[:, 0] / values[:, 1]) ** 2).mean()))
    assert errors[-1] < 0.02
    assert errors[0] > 1.6 * errors[1] > 1.6**2 * errors[2]
    triangle_scale = np.exp(flat.log_scale[flat.disk.triangles].mean(axis=1))
    assert values.mean(axis=1) == pytest.approx(triangle_scale, rel=0.02)


@given(st.floats(15.0, 80.0), st.floats(0.2, 2.0), st.floats(10.0, 200.0))
@settings(max_examples=10)
def test_a_developable_surface_is_flattened_isometrically(radius: float, turn: float, depth: float) -> None:
    disk = disk_of(*cylinder_part(radius, turn, depth), "cylinder")
    values = singular_values(Flattener(disk).flatten())
    assert np.abs(values - 1.0).max() < 1e-6


def test_border_values_are_taken_and_close_the_outline() -> None:
    disk = disk_of(*spherical_cap(40.0), "cap")
    flattener = Flattener(disk)
    around = np.linspace(0.0, 2.0 * np.pi, len(disk.border), endpoint=False)
    given_scale = 0.1 * np.cos(2.0 * around)
    flat = flattener.flatten(given_scale)
    assert flat.log_scale[disk.border] == pytest.approx(given_scale)
    ring = flat.points[disk.border]
    lengths = np.linalg.norm(np.roll(ring, -1, axis=0) - ring, axis=1)
    wanted = flattener.border_lengths * np.exp(0.5 * (given_scale + np.roll(given_scale, -1)))
    assert lengths == pytest.approx(wanted, rel=0.01)


def test_the_programme_is_never_above_constant_border_values() -> None:
    # the upper part of a torus: its Gauss curvature is positive outside and negative inside
    plane, triangles = rectangle_mesh(1.6, 1.8, 21, 25)
    around, across = plane.T
    radius = 90.0 + 30.0 * np.sin(across)
    vertices = np.column_stack([radius * np.sin(around), radius * np.cos(around), 30.0 * np.cos(across)])
    flattener = Flattener(disk_of(vertices, triangles, "torus"))
    constant, least = flattener.flatten(), flattener.flatten(least_ratio_border(flattener))
    assert least.ratio < 1.0 + 0.9 * (constant.ratio - 1.0)
    cap = Flattener(disk_of(*spherical_cap(35.0, rings=12), "cap"))
    assert cap.flatten(least_ratio_border(cap)).ratio == pytest.approx(cap.flatten().ratio, rel=1e-4)
