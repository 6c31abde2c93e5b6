"""VALIDATION V14 and V15: strips bent by an end force, by their rest curvature and by an end moment."""

import numpy as np
import pytest

from asterism.equilibrium.arrays import Floats
from asterism.fem.elements.argyris import Argyris
from asterism.fem.search.relax import relax
from asterism.fem.shell.density import Density, EnergyTerm
from asterism.fem.shell.fields import Fields
from asterism.fem.shell.shell import Shell
from asterism.fem.supports.conditions import EdgeSupport
from tests.fem.loads import edge_load
from tests.fem.meshes import facets_where, rectangle
from tests.validation.shells import at, material, rate, stepped

PLATE = material(1.2e6, 0.1, 0.0)
MESHES = (2, 4, 8)  # cells along the strip from which the errors are measured
LIMIT = (3.28954, 6.69989)


def _strip(cells: int, length: float, **of_shell) -> Shell:
    mesh = rectangle(cells, 1, length, 1.0)
    space = Argyris(mesh)
    left, right = (facets_where(mesh, lambda x, y, e=e: abs(x - e) < 1e-9) for e in (0.0, length))
    fields = Fields(Density(PLATE), curvature=(of_shell.get("curvature", 0.0), 0.0, 0.0))
    force = edge_load(space, right, (0.0, 0.0, of_shell.get("force", 0.0)))
    held = [EdgeSupport(left, clamped=True)]
    if "sides" in of_shell:  # slide in their planes
        held.append(EdgeSupport(facets_where(mesh, of_shell["sides"]), directions=np.array([[0.0, 1.0, 0.0]])))
    return Shell(space, fields, held, force)


def test_end_shear() -> None:
    """V14: the thin limit of a Kirchhoff-Love shell, and the table of Sze, Liu and Lo (2004) within half a percent."""
    errors = []
    for cells in MESHES:
        shell = _strip(cells, 10.0, force=4.0)
        *_, x = stepped(shell, shell.flat, [1.0])
        tip = at(shell, x, (10.0, 0.5))[0]
        errors.append(np.hypot(10.0 - tip[0] - LIMIT[0], tip[2] - LIMIT[1]))
    assert errors[-1] < 2e-4
    assert rate(errors[0], errors[1]) > 3.0
    shell = _strip(MESHES[-1], 10.0, force=4.0)
    table = [(0.563, 3.015), (1.604, 4.933), (2.541, 6.031), (3.286, 6.698)]
    for x, (u, w) in zip(stepped(shell, shell.flat, [0.25, 0.5, 0.75, 1.0]), table, strict=True):
        tip = at(shell, x, (10.0, 0.5))[0]
        assert tip[2] == pytest.approx(w, rel=0.005)
        assert 10.0 - tip[0] == pytest.approx(u, rel=0.005)


def test_rest_curvature_closes_the_strip() -> None:
    """V15: a full circle, without energy; what is left of it falls with twice the order of the curvature."""
    energies = []
    for count in (6, 12):
        shell = _strip(count, 12.0, curvature=2.0 * np.pi / 12.0)
        found = relax(shell)
        assert found.is_minimum
        energies.append(found.energy)
    tip, middle = at(shell, found.x, (12.0, 0.5), (6.0, 0.5))
    assert np.allclose(tip, [0.0, 0.5, 0.0], atol=1e-4)
    assert np.allclose(middle, [0.0, 0.5, 12.0 / np.pi], atol=1e-4)
    assert rate(*energies) > 7.7


@pytest.mark.parametrize(("turns", "steps"), [(3, 0), (4, 4)])
def test_coils_of_many_turns_come_in_load_steps(turns: int, steps: int) -> None:
    """Newton's method leads from flat to a coil of three turns; to one of four neither it nor the way down does."""
    shell = _strip(6 * turns, 12.0, curvature=2.0 * turns * np.pi / 12.0)
    found = relax(shell)
    assert found.is_minimum and found.load_steps == steps and shell.progress == 1.0
    assert found.trials[0].is_minimum == (steps == 0)
    tip, half = at(shell, found.x, (12.0, 0.5), (6.0 / turns, 0.5))
    assert np.allclose([tip, half], [[0.0, 0.5, 0.0], [0.0, 0.5, 12.0 / turns / np.pi]], atol=1e-4)


def _moment(amount: float) -> EnergyTerm:
    """The potential `-m psi` of an end moment, as a density: the turn per printed length is `b11/sqrt(a11)`."""

    def term(e: Floats) -> tuple[Floats, Floats, Floats]:
        square, bend = 1.0 + 2.0 * e[:, 0], e[:, 3]
        gradient, hessian = np.zeros((len(e), 6)), np.zeros((len(e), 6, 6))
        gradient[:, 0], gradient[:, 3] = -bend * square**-1.5, square**-0.5
        hessian[:, 0, 0], hessian[:, 0, 3] = 3.0 * bend * square**-2.5, -(square**-1.5)
        hessian[:, 3, 0] = hessian[:, 0, 3]
        return -amount * bend * square**-0.5, -amount * gradient, -amount * hessian

    return term


def test_end_moment_rolls_the_strip_up() -> None:
    """V15: the moment 50 pi/3 makes a full circle, but for the shortening that goes with it in Koiter's energy.

    With `b = l k'` on a strip of stretch l the energy `EA (l^2 - 1)^2/8 + EI l^2 k'^2/2 - m k' L`, k' the turn per
    printed length, has its minimum at `l^2 = 1 - 2 EI k'^2/EA`, `k' = m/(EI l^2)`.
    """
    shell, full = _strip(MESHES[-1], 12.0, sides=lambda x, y: (y < 1e-9) | (y > 1.0 - 1e-9)), 50.0 * np.pi / 3.0
    x = shell.flat
    for share in np.arange(1, 9) / 8:
        shell = shell.with_fields(Fields(Density(PLATE, term=_moment(share * full))))
        (x,) = stepped(shell, x, [1.0])
    square, turn = 1.0, 0.0
    for _ in range(20):
        turn = full / (100.0 * square)
        square = 1.0 - 2.0 * 100.0 * turn**2 / 1.2e5
    radius = np.sqrt(square) / turn
    expected = [radius * np.sin(12.0 * turn), 0.5, radius * (1.0 - np.cos(12.0 * turn))]
    tip = at(shell, x, (12.0, 0.5))[0]
    assert np.allclose(tip[[0, 2]], [0.0, 0.0], atol=0.01)
    assert np.allclose(tip, expected, atol=1.5e-3)
