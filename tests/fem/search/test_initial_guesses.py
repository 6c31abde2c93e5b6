"""Selection of initial guesses: which are compared, and which are left out."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from asterism.fem.elements.argyris import Argyris
from asterism.fem.elements.deformation import affine, flat
from asterism.fem.search.guess_builder import GuessBuilder
from asterism.fem.search.initial_guesses import (
    MAX_ENERGY_RATIO,
    candidate_shapes,
    initial_guesses,
)
from asterism.fem.search.mean_fields import mean_fields
from asterism.fem.search.relax import relax
from asterism.fem.search.simple_shapes import SimpleShape
from asterism.fem.shell.density import Density, isotropic
from asterism.fem.shell.fields import of_stretch
from asterism.fem.shell.shell import Shell
from asterism.fem.supports.conditions import EdgeSupport
from tests.fem.hexagons import FIELDS, RADIUS, hexagon
from tests.fem.meshes import facets_where, rectangle


@pytest.fixture
def relaxed(monkeypatch: pytest.MonkeyPatch) -> list[tuple[float, float]]:
    """Energies of all guesses that are relaxed in plane, each with the lowest energy before it."""
    seen: list[tuple[float, float]] = []
    before = GuessBuilder.relax_in_plane

    def noted(self: GuessBuilder, start, least=np.inf):  # type: ignore[no-untyped-def]
        seen.append((start.energy, least))
        return before(self, start, least)

    monkeypatch.setattr(GuessBuilder, "relax_in_plane", noted)
    return seen


def test_a_single_arc_is_taken_without_comparison(relaxed: list[tuple[float, float]]) -> None:
    shell = Shell(Argyris(hexagon(1)), FIELDS["rolled"])
    arcs = [shape for shape in candidate_shapes(mean_fields(shell), 2.0 * RADIUS) if shape.name in ("arc", "flat")]
    turns = [np.array([[np.cos(a), -np.sin(a)], [np.sin(a), np.cos(a)]]) for a in np.arange(6) * np.pi / 3.0]
    kinds, turned = initial_guesses(shell, shell.factor(), candidates=arcs, symmetries=turns)
    assert [start.shape.name for start in kinds] == ["arc"] and not turned and not relaxed
    # without a symmetry the other axes are guesses too
    kinds, turned = initial_guesses(shell, shell.factor(), candidates=arcs)
    assert kinds[0].shape.name == "arc" and len(turned) == 2 and relaxed


@pytest.mark.parametrize("axis", [0, 1, 2])
@pytest.mark.parametrize("degrees", [90.0, 180.0])
def test_guesses_follow_rotated_supports(axis: int, degrees: float) -> None:
    """A single clamped edge: its positions alone leave the rotation about it undetermined."""
    mesh = rectangle(2, 2, 50.0, 50.0)
    turn = Rotation.from_rotvec(np.radians(degrees) * np.eye(3)[axis]).as_matrix()
    edge = EdgeSupport(facets_where(mesh, lambda x, y: x < 1e-9), affine(turn[:, :2], [5.0, 6.0, 7.0]), clamped=True)
    found = relax(Shell(Argyris(mesh), of_stretch(Density(isotropic(20.0, 10.0, 0.3)), 1.0), [edge]))
    assert found.is_minimum and found.energy < 1e-9


def test_supported_guesses_of_high_energy_are_left_out(relaxed: list[tuple[float, float]]) -> None:
    mesh = hexagon(1)
    shell = Shell(Argyris(mesh), FIELDS["dome"], [EdgeSupport(mesh.boundary_facets(), flat(0.8))])
    angles = np.pi * np.arange(12) / 12
    gentle, tight = ([SimpleShape("arc", curvature, angle) for angle in angles] for curvature in (1e-3, 0.03))
    caps = [SimpleShape("flat"), SimpleShape("cap", 2e-3)]
    kinds, _ = initial_guesses(shell, shell.factor(), candidates=[*caps, *gentle])
    assert {start.shape.name for start in kinds} == {"flat", "cap", "arc"}
    assert kinds == sorted(kinds, key=lambda start: start.energy)
    kinds, _ = initial_guesses(shell, shell.factor(), candidates=[*caps, *tight])
    assert {start.shape.name for start in kinds} == {"flat", "cap"}
    assert all(energy <= MAX_ENERGY_RATIO * least for energy, least in relaxed)
