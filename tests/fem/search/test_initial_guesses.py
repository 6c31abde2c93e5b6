"""Selection of initial guesses: which are compared, and which are left out; the derivatives of simple shapes."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from asterism.equilibrium.arrays import Floats
from asterism.fem.elements.argyris import Argyris
from asterism.fem.elements.deformation import affine
from asterism.fem.search.initial_guesses import (
    SYMMETRY_BREAKING_ANGLE,
    candidate_shapes,
    distinct_shapes,
    energy_minima,
    initial_guesses,
)
from asterism.fem.search.mean_fields import MeanFields, mean_fields
from asterism.fem.search.relax import relax
from asterism.fem.search.simple_shapes import SimpleShape, similar
from asterism.fem.shell.density import Density, isotropic
from asterism.fem.shell.fields import of_stretch
from asterism.fem.shell.shell import Shell
from asterism.fem.supports.conditions import EdgeSupport
from tests.fem.hexagons import FIELDS, RADIUS, density, hexagon
from tests.fem.meshes import facets_where, rectangle


def test_a_single_arc_is_taken_without_comparison() -> None:
    shell = Shell(Argyris(hexagon(1)), FIELDS["rolled"])
    arcs = [shape for shape in candidate_shapes(mean_fields(shell), 2.0 * RADIUS) if shape.name in ("arc", "flat")]
    turns = [np.array([[np.cos(a), -np.sin(a)], [np.sin(a), np.cos(a)]]) for a in np.arange(6) * np.pi / 3.0]
    kinds, turned = initial_guesses(shell, shell.factor(), candidates=arcs, symmetries=turns)
    assert [start.shape.name for start in kinds] == ["arc"] and not turned
    # without a symmetry the other axes are guesses too
    kinds, turned = initial_guesses(shell, shell.factor(), candidates=arcs)
    assert kinds[0].shape.name == "arc" and len(turned) == 2


@pytest.mark.parametrize("axis", [0, 1, 2])
@pytest.mark.parametrize("degrees", [90.0, 180.0])
def test_guesses_follow_rotated_supports(axis: int, degrees: float) -> None:
    """A single clamped edge: its positions alone leave the rotation about it undetermined."""
    mesh = rectangle(2, 2, 50.0, 50.0)
    turn = Rotation.from_rotvec(np.radians(degrees) * np.eye(3)[axis]).as_matrix()
    edge = EdgeSupport(facets_where(mesh, lambda x, y: x < 1e-9), affine(turn[:, :2], [5.0, 6.0, 7.0]), clamped=True)
    found = relax(Shell(Argyris(mesh), of_stretch(Density(isotropic(20.0, 10.0, 0.3)), 1.0), [edge]))
    assert found.is_minimum and found.energy < 1e-9


FAMILY = [SimpleShape("arc", 0.015, np.pi * number / 12) for number in range(12)]
THIRD = 2.0 * np.pi / 3.0
TURN = np.array([[np.cos(THIRD), -np.sin(THIRD)], [np.sin(THIRD), np.cos(THIRD)]])


@pytest.mark.parametrize(("sixfold", "angles"), [(100.0, (30.0, 90.0, 150.0)), (-100.0, (0.0, 60.0, 120.0))])
def test_every_axis_of_the_lattice_is_an_energy_minimum(sixfold: float, angles: tuple[float, ...]) -> None:
    shell = Shell(Argyris(hexagon(1)), of_stretch(density(sixfold), 0.8, 0.015))
    found = [np.degrees(shape.angle) for shape in energy_minima(shell, 0.8, FAMILY)]
    assert sorted(found) == pytest.approx(angles)


def test_an_isotropic_sheet_is_bent_away_from_symmetry_axes() -> None:
    shell = Shell(Argyris(hexagon(1)), of_stretch(density(), 0.8, 0.015))
    (only,) = energy_minima(shell, 0.8, FAMILY)
    assert only.angle == SYMMETRY_BREAKING_ANGLE


def test_equal_axes_count_once() -> None:
    first, *others = (SimpleShape("arc", 0.015, np.radians(angle)) for angle in (30.0, 90.0, 150.0))
    assert distinct_shapes(first, others, []) == others
    assert distinct_shapes(first, others, [TURN, TURN.T]) == []
    # the mirror y -> -y maps 30 to 150 degrees, and 90 to itself
    assert distinct_shapes(first, others, [np.diag([1.0, -1.0])]) == [others[0]]


def test_other_axes_are_other_forms() -> None:
    """A sheet that prefers lattice lines may roll about three axes; the lowest minimum is taken."""
    fields = of_stretch(density(100.0), 0.8, lambda p: 0.015 + 0.004 * (p @ np.array([0.8, 0.6])) / RADIUS)
    shell = Shell(Argyris(hexagon(1)), fields)
    lowest = relax(shell)
    energies = [trial.energy for trial in lowest.trials if trial.is_minimum]
    assert len(energies) == 3
    assert np.ptp(energies) > 1e-3 * lowest.energy
    for trial in lowest.trials:
        assert shell.energy(trial.x) == pytest.approx(trial.energy)
    assert lowest.energy == min(trial.energy for trial in lowest.trials)
    assert lowest.is_minimum and len(lowest.soft_modes) == 3


SIZE = 2.0 * RADIUS


def test_a_modulus_of_gaussian_curvature_does_not_change_arcs() -> None:
    plain = mean_fields(Shell(Argyris(hexagon(1)), FIELDS["rolled"]))
    bending = float(np.asarray(FIELDS["rolled"].density.stiffness)[3, 3])  # type: ignore[union-attr]
    saving = mean_fields(Shell(Argyris(hexagon(1)), replace(FIELDS["rolled"], gaussian=-0.7 * bending)))
    assert saving.poisson == pytest.approx(plain.poisson)
    arcs = [
        [shape.curvature for shape in candidate_shapes(wants, SIZE) if shape.name == "arc"] for wants in (plain, saving)
    ]
    assert arcs[0] and arcs[1] == pytest.approx(arcs[0])


def test_mean_curvature_of_a_sheared_metric() -> None:
    """The mean curvature is half the trace of `a^-1 b` in any coordinates."""
    a, b = np.array([[0.7, 0.15], [0.15, 0.6]]), np.array([[0.02, 0.012], [0.012, -0.005]])
    fields = replace(FIELDS["rolled"], metric=a[[0, 1, 0], [0, 1, 1]], curvature=b[[0, 1, 0], [0, 1, 1]])
    wants = mean_fields(Shell(Argyris(hexagon(1)), fields))
    assert wants.curvature == pytest.approx(0.5 * np.trace(np.linalg.solve(a, b)))
    assert wants.stretch == pytest.approx(np.linalg.det(a) ** 0.25)


def test_the_metric_of_a_sphere_gives_its_cap_for_any_rest_curvature() -> None:
    gaussian = (1.0 / SIZE) ** 2
    for bend in (0.1 / SIZE, 3.0 / SIZE):
        wants = MeanFields(np.zeros(2), 0.8, gaussian, bend, 0.3, np.inf)
        caps = [shape.curvature for shape in candidate_shapes(wants, SIZE) if shape.name == "cap"]
        assert min(abs(cap - np.sqrt(gaussian)) for cap in caps) < 1e-12
        kinds = {shape.name for shape in candidate_shapes(wants, SIZE)}
        assert ("bent" in kinds) == (bend > 1.0 / SIZE)


SHAPES = [
    SimpleShape("flat"),
    SimpleShape("cap", -0.9),
    SimpleShape("arc", 1.1, 0.4),
    SimpleShape("saddle", 0.8, -0.7, -0.5),
    SimpleShape("bent", -1.2, 2.0, -0.4),
]
POINTS = np.random.default_rng(0).uniform(-1.2, 1.2, (40, 2))
STEP = 1e-4


def on(points: Floats) -> Any:
    """In place of a space, the jets at points (n, 2)."""
    return SimpleNamespace(interpolate=lambda jets: np.asarray(jets(points)))


def moved(points: Floats) -> Floats:
    """(n, 6, 2) a plane that is stretched, rotated, sheared and nonlinearly deformed within itself."""
    x, y = points.T
    zero, one = np.zeros_like(x), np.ones_like(x)
    return np.array(
        [
            [0.8 * x + 0.1 * y + 0.05 * x * y, 0.9 * y - 0.2 * x + 0.1 * x**2],
            [0.8 + 0.05 * y, -0.2 + 0.2 * x],
            [0.1 + 0.05 * x, 0.9 * one],
            [zero, 0.2 * one],
            [zero, zero],
            [0.05 * one, zero],
        ]
    ).transpose(2, 0, 1)


def places(shape: SimpleShape, points: Floats) -> Floats:
    """(n, 3) of points (n, 2)."""
    return shape.over(on(points), moved)[:, 0]


@pytest.mark.parametrize("shape", SHAPES, ids=lambda shape: shape.name)
def test_derivatives(shape: SimpleShape) -> None:
    jets = shape.over(on(POINTS), moved)
    one, two = STEP * np.eye(2)
    middle = places(shape, POINTS)
    first = [(places(shape, POINTS + d) - places(shape, POINTS - d)) / (2.0 * STEP) for d in (one, two)]
    second = [(places(shape, POINTS + d) + places(shape, POINTS - d) - 2.0 * middle) / STEP**2 for d in (one, two)]
    corners = [places(shape, POINTS + s * one + t * two) * s * t for s in (-1, 1) for t in (-1, 1)]
    second.append(np.sum(corners, axis=0) / (4.0 * STEP**2))
    assert np.abs(jets[:, 1:3] - np.stack(first, axis=1)).max() < 1e-7
    assert np.abs(jets[:, 3:] - np.stack(second, axis=1)).max() < 1e-6


@pytest.mark.parametrize("shape", SHAPES, ids=lambda shape: shape.name)
def test_curvatures_in_the_middle(shape: SimpleShape) -> None:
    """At the centre the sheet keeps its lengths and has both curvatures; positive ones lift the edges."""
    at = shape.over(on(np.zeros((1, 2))), similar(np.zeros(2), 1.0))[0]
    cos, sin = np.cos(shape.angle), np.sin(shape.angle)
    across = shape.curvature if shape.name == "cap" else shape.across
    along, side = np.array([cos, sin]), np.array([-sin, cos])
    bend = shape.curvature * np.outer(along, along) + across * np.outer(side, side)
    assert np.allclose(at[0], 0.0)
    assert np.allclose(at[1:3], np.eye(3)[:2], atol=1e-12)
    assert np.allclose(at[3:, 2], [bend[0, 0], bend[1, 1], bend[0, 1]], atol=1e-12)


def test_an_arc_lies_on_its_cylinder_and_a_cap_on_its_sphere() -> None:
    flat = similar(np.zeros(2), 1.0)
    arc, cap = (SimpleShape(name, 0.7).over(on(POINTS), flat)[:, 0] for name in ("arc", "cap"))
    assert np.allclose(np.hypot(arc[:, 0], arc[:, 2] - 1 / 0.7), 1 / 0.7)
    assert np.allclose(np.linalg.norm(cap - [0.0, 0.0, 1 / 0.7], axis=1), 1 / 0.7)
