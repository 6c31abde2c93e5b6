"""Checks of the mesh and of the density of a sheet."""

from __future__ import annotations

import numpy as np
import pytest
from skfem import MeshTri, MeshTri2

from asterism.fem.elements.argyris import Argyris, checked_mesh
from asterism.fem.shell.density import Density, isotropic
from asterism.fem.shell.fields import FieldError, Fields
from asterism.fem.shell.shell import Shell
from tests.fem.meshes import rectangle

SQUARE = rectangle(2, 2, amount=0.2)
FAR = np.array([[5.0], [5.0]])


def with_nan() -> MeshTri:
    points = SQUARE.p.copy()
    points[0, 4] = np.nan
    return MeshTri(points, SQUARE.t)


@pytest.mark.parametrize(
    ("mesh", "word"),
    [
        (lambda: MeshTri2.from_mesh(SQUARE), "straight"),
        (lambda: MeshTri(SQUARE.p, np.empty((3, 0), dtype=int)), "no triangles"),
        (with_nan, "not finite"),
        (lambda: MeshTri(np.hstack([SQUARE.p, FAR]), SQUARE.t), "vertex 9 belongs to no triangle"),
        (lambda: MeshTri(np.array([[0, 1, 2, 0.0], [0, 0, 0, 1.0]]), np.array([[0, 1, 2], [0, 2, 3]]).T), "no area"),
        (lambda: MeshTri(SQUARE.p, np.hstack([SQUARE.t, SQUARE.t[:, :1]])), "more than two"),
        (lambda: MeshTri(np.hstack([SQUARE.p, SQUARE.p + FAR]), np.hstack([SQUARE.t, SQUARE.t + 9])), "2 pieces"),
    ],
    ids=["curved", "empty", "nan", "unused", "flat", "crowded", "pieces"],
)
def test_invalid_meshes_are_refused(mesh, word: str) -> None:
    with pytest.raises(ValueError, match=f"^mesh: .*{word}"):
        checked_mesh(mesh())


@pytest.mark.parametrize(
    ("density", "words"),
    [
        (Density(np.full((6, 6), np.nan)), r"stiffness at .* \(nan\) is not finite"),
        (Density(isotropic(2.0, 1.0, 0.3) + 0.1 * np.eye(6, k=1)), "stiffness at .* is not symmetric"),
        (Density(isotropic(2.0, 1.0, 0.3), sixfold=np.nan), "sixfold at .* is not finite"),
        (Density(isotropic(2.0, 1.0, 0.3), sixfold=1.0, saturation=0.0), "saturation at .* is not positive"),
    ],
    ids=["nan", "unsymmetric", "sixfold", "saturation"],
)
def test_invalid_densities_are_refused(density: Density, words: str) -> None:
    with pytest.raises(FieldError, match=words) as caught:
        Shell(Argyris(SQUARE), Fields(density))
    assert "\n" not in str(caught.value) and len(str(caught.value)) < 120
