"""Mean fields and the candidates from them: arcs for rest curvatures, caps for curved rest metrics."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from asterism.fem.elements.argyris import Argyris
from asterism.fem.search.initial_guesses import candidate_shapes
from asterism.fem.search.mean_fields import MeanFields, mean_fields
from asterism.fem.shell.shell import Shell
from tests.fem.hexagons import FIELDS, RADIUS, hexagon

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


def test_an_unknown_side_is_refused() -> None:
    with pytest.raises(ValueError, match="side = 'sideways': must be auto, up, down"):
        candidate_shapes(MeanFields(np.zeros(2), 0.8, 0.0, 0.01, 0.3, np.inf), SIZE, "sideways")  # type: ignore[arg-type]


def test_the_metric_of_a_sphere_gives_its_cap_for_any_rest_curvature() -> None:
    gaussian = (1.0 / SIZE) ** 2
    for bend in (0.1 / SIZE, 3.0 / SIZE):
        wants = MeanFields(np.zeros(2), 0.8, gaussian, bend, 0.3, np.inf)
        caps = [shape.curvature for shape in candidate_shapes(wants, SIZE) if shape.name == "cap"]
        assert min(abs(cap - np.sqrt(gaussian)) for cap in caps) < 1e-12
        kinds = {shape.name for shape in candidate_shapes(wants, SIZE)}
        assert ("bent" in kinds) == (bend > 1.0 / SIZE)
