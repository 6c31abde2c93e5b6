"""Which guesses are compared, and which cannot win."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from fem.argyris import Argyris
from fem.conditions import HeldEdge
from fem.density import Density, isotropic
from fem.fields import of_stretch
from fem.placement import affine, flat
from fem.seeds import shapes, trends
from fem.shapes import Shape
from fem.shell import Shell
from fem.slide import Frame
from fem.solve import relax
from fem.starts import HELD_DEAR, starts
from tests.fem.hexagons import FIELDS, RADIUS, hexagon
from tests.fem.meshes import facets_where, rectangle


@pytest.fixture
def slid(monkeypatch: pytest.MonkeyPatch) -> list[tuple[float, float]]:
    """Energies of all guesses that were moved within themselves, and the least one known by then."""
    seen: list[tuple[float, float]] = []
    before = Frame.slid

    def noted(self: Frame, start, least=np.inf):  # type: ignore[no-untyped-def]
        seen.append((start.energy, least))
        return before(self, start, least)

    monkeypatch.setattr(Frame, "slid", noted)
    return seen


def test_an_arc_alone_is_compared_with_nothing(slid: list[tuple[float, float]]) -> None:
    shell = Shell(Argyris(hexagon(1)), FIELDS["rolled"])
    arcs = [shape for shape in shapes(trends(shell), 2.0 * RADIUS) if shape.name in ("arc", "flat")]
    turns = [np.array([[np.cos(a), -np.sin(a)], [np.sin(a), np.cos(a)]]) for a in np.arange(6) * np.pi / 3.0]
    kinds, turned = starts(shell, shell.factor(), candidates=arcs, turns=turns)
    assert [start.shape.name for start in kinds] == ["arc"] and not turned and not slid
    # without symmetry the other axes are guesses too
    kinds, turned = starts(shell, shell.factor(), candidates=arcs)
    assert kinds[0].shape.name == "arc" and len(turned) == 2 and slid


@pytest.mark.parametrize("axis", [0, 1, 2])
@pytest.mark.parametrize("degrees", [90.0, 180.0])
def test_a_sheet_follows_what_holds_it_wherever_that_was_turned(axis: int, degrees: float) -> None:
    """By a single clamped edge: its places alone say nothing of the turn about it."""
    mesh = rectangle(2, 2, 50.0, 50.0)
    turn = Rotation.from_rotvec(np.radians(degrees) * np.eye(3)[axis]).as_matrix()
    edge = HeldEdge(facets_where(mesh, lambda x, y: x < 1e-9), affine(turn[:, :2], [5.0, 6.0, 7.0]), clamped=True)
    found = relax(Shell(Argyris(mesh), of_stretch(Density(isotropic(20.0, 10.0, 0.3)), 1.0), [edge]))
    assert found.is_minimum and found.energy < 1e-9


def test_held_guesses_that_are_far_too_dear_are_left_out(slid: list[tuple[float, float]]) -> None:
    mesh = hexagon(1)
    shell = Shell(Argyris(mesh), FIELDS["dome"], [HeldEdge(mesh.boundary_facets(), flat(0.8))])
    angles = np.pi * np.arange(12) / 12
    gentle, tight = ([Shape("arc", curvature, angle) for angle in angles] for curvature in (1e-3, 0.03))
    caps = [Shape("flat"), Shape("cap", 2e-3)]
    kinds, _ = starts(shell, shell.factor(), candidates=[*caps, *gentle])
    assert {start.shape.name for start in kinds} == {"flat", "cap", "arc"}
    assert kinds == sorted(kinds, key=lambda start: start.energy)
    kinds, _ = starts(shell, shell.factor(), candidates=[*caps, *tight])
    assert {start.shape.name for start in kinds} == {"flat", "cap"}
    assert all(energy <= HELD_DEAR * least for energy, least in slid)
