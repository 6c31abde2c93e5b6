"""VALIDATION V18: an isotropic rest curvature rolls a flat sheet up, a thick one less than a thin one."""

import numpy as np
import pytest
from scipy.interpolate import BSpline
from scipy.optimize import least_squares

from asterism.fem.elements.argyris import Argyris
from asterism.fem.search.relax import follow
from asterism.fem.search.simple_shapes import SimpleShape
from asterism.fem.shell.density import Density
from asterism.fem.shell.fields import Fields
from asterism.fem.shell.shell import Shell
from tests.fem.meshes import graded
from tests.validation.shells import material, rate

DEGREE = 5


def turn(thickness: float, poisson: float, curvature: float, width: float, spans: int = 24) -> float:
    """Turn per length of an endless free sheet with an isotropic rest curvature; its modulus does not matter."""
    breaks = 0.5 * width * (1.0 - (1.0 - np.linspace(0.0, 1.0, spans + 1)) ** 2)
    knots = np.r_[[breaks[0]] * DEGREE, breaks, [breaks[-1]] * DEGREE]
    count = len(knots) - DEGREE - 1
    spline = BSpline(knots, np.eye(count), DEGREE)
    roots, shares = np.polynomial.legendre.leggauss(7)
    y = (breaks[:-1, None] + 0.5 * np.diff(breaks)[:, None] * (roots + 1.0)).ravel()
    weight = np.sqrt(0.5 * np.diff(breaks)[:, None] * shares).ravel()
    zeroth, first, second = spline(y), spline.derivative(1)(y), spline.derivative(2)(y)
    middle = spline.derivative(1)(0.0), spline(0.0)
    law = np.linalg.cholesky(np.array([[1.0, poisson], [poisson, 1.0]])).T

    def residuals(q: np.ndarray) -> np.ndarray:
        w, r, z = q[0], q[1 : count + 1], q[count + 1 :]
        radius, r1, r2, z1, z2 = zeroth @ r, first @ r, second @ r, first @ z, second @ z
        length = np.hypot(r1, z1)
        strain = 0.5 * np.stack([(w * radius) ** 2 - 1.0, length**2 - 1.0])
        bend = np.stack([w**2 * radius * z1, z2 * r1 - r2 * z1]) / length - curvature
        # symmetric about its middle, which stays where it is
        held = [middle[0] @ r, middle[1] @ z]
        return np.concatenate(
            [(weight * (law @ strain)).ravel(), thickness / np.sqrt(12) * (weight * (law @ bend)).ravel(), held]
        )

    start = curvature * (1.0 + poisson)
    greville = np.array([knots[i + 1 : i + DEGREE + 1].mean() for i in range(count)])
    q = np.r_[start, np.full(count, 1.0 / start), greville]
    found = least_squares(residuals, q, xtol=1e-14, ftol=1e-14, gtol=1e-14)
    return float(found.x[0])


CURVATURE, POISSON = 1.5, 0.3
ROLLED = CURVATURE * (1.0 + POISSON)


def _shell(thickness: float, cells: tuple[int, int], length: float) -> Shell:
    space = Argyris(graded(*cells, length, 2.0))
    fields = Fields(Density(material(1.0, thickness, POISSON)), curvature=(CURVATURE, CURVATURE, 0.0))
    return Shell(space, fields)


def _rolled(shell: Shell) -> np.ndarray:
    found = follow(shell, SimpleShape("arc", ROLLED).positions(shell.space, np.zeros(2), 1.0), shell.factor())
    assert found.is_minimum
    return found.x


def _turn(shell: Shell, x: np.ndarray) -> float:
    """Per length, over the middle of the sheet's middle line."""
    line = np.column_stack([np.linspace(-0.5, 0.5, 101), np.zeros(101)])
    along = shell.space.locate(line).jets(x)[:, 1]
    angles = np.unwrap(np.arctan2(along[:, 2], along[:, 0]))
    return float(angles[-1] - angles[0])


@pytest.mark.parametrize("thickness", [0.02, 0.0025])
def test_long_sheet_rolls_as_an_endless_one(thickness: float) -> None:
    shell = _shell(thickness, (18, 10), 6.0)
    expected = turn(thickness, POISSON, CURVATURE, 2.0)
    assert _turn(shell, _rolled(shell)) == pytest.approx(expected, rel=3e-4)


def test_long_sheet_converges() -> None:
    """Better than fourth order, on meshes that are finer towards the edges and their layers."""
    expected = turn(0.02, POISSON, CURVATURE, 2.0)
    errors = []
    for fine in (1, 2):
        shell = _shell(0.02, (fine * 9, fine * 5), 6.0)
        errors.append(_turn(shell, _rolled(shell)) / expected - 1.0)
    assert rate(*errors) > 4.0


def test_endless_sheet_reaches_the_cylinder_as_its_edge_layer_shrinks() -> None:
    """The edges curl in a layer of width sqrt(t/kappa): that is how the deficit goes to zero."""
    deficits = [1.0 - turn(t, POISSON, CURVATURE, 2.0) / ROLLED for t in (0.02, 0.005, 0.00125)]
    assert np.allclose(np.log2(np.array(deficits[:-1]) / deficits[1:]) / 2.0, 0.5, atol=0.02)


@pytest.mark.slow
def test_square_sheet_loses_energy_at_its_edges() -> None:
    """Below that of the cylinder, D kappa^2 (1 - nu^2)/2 per area, by the edge layers on all sides."""
    shell = _shell(0.02, (12, 12), 2.0)
    assert 0.9 < shell.energy(_rolled(shell)) / (0.5 * 0.02**3 / 12.0 * CURVATURE**2 * 4.0) < 0.93
