"""Rest values of fields, and fields that are refused."""

from __future__ import annotations

import numpy as np
import pytest

from asterism.fem.shell.density import Density, isotropic
from asterism.fem.shell.fields import FieldError, Fields, of_stretch

PLATE = Density(isotropic(20.0, 10.0, 0.3))
POINTS = np.zeros((2, 3, 2))


def test_rest_values_have_the_components_of_the_strains() -> None:
    """Half of the metric, and twice both components 12."""
    rest = Fields(PLATE, (1.1, 0.9, 0.1), (0.01, 0.02, 0.003)).rest(POINTS)
    np.testing.assert_allclose(rest, np.broadcast_to([0.55, 0.45, 0.1, 0.01, 0.02, 0.006], (2, 3, 6)))


def test_curvature_is_that_of_the_contracted_sheet() -> None:
    rest = of_stretch(PLATE, 0.8, 0.02).rest(POINTS)
    np.testing.assert_allclose(rest, np.broadcast_to([0.32, 0.32, 0.0, 0.0128, 0.0128, 0.0], (2, 3, 6)))


@pytest.mark.parametrize("metric", [(-1.0, -1.0, 0.0), (1.0, 1.0, 1.0), (0.0, 0.0, 0.0), (1.0, 1.0, -1.1)])
def test_metrics_that_are_not_positive_definite_are_refused(metric: tuple[float, float, float]) -> None:
    with pytest.raises(FieldError, match="is not positive definite"):
        Fields(PLATE, metric).rest(POINTS)


@pytest.mark.parametrize("stretch", [0.0, -0.8])
def test_stretches_that_are_not_positive_are_refused(stretch: float) -> None:
    with pytest.raises(FieldError, match="is not positive definite"):
        of_stretch(PLATE, stretch).rest(POINTS)
